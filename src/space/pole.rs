//! Poles of inaccessibility of polygons.

use crate::space::{Bounds, distance_to_segment, point_in_polygon};
use glam::DVec2;

/// The pole of inaccessibility of a simple polygon of three points or more: the inner point farthest from the border, and its
/// distance from the border, to within `precision` metres (more than 0).
///
/// This is Agafonkin's quadtree search ("polylabel"). Square roots are its only inexact function, so every platform finds the
/// same point.
pub fn pole(polygon: &[DVec2], precision: f64) -> (DVec2, f64) {
    let depth = |p: DVec2| {
        let border = (0..polygon.len())
            .map(|i| distance_to_segment(p, polygon[i], polygon[(i + 1) % polygon.len()]))
            .fold(f64::INFINITY, f64::min);
        if point_in_polygon(p, polygon) { border } else { -border }
    };
    let bounds = Bounds::of(polygon.iter().copied());
    let size = bounds.size();
    let half = (size.min_element() / 2.0).max(precision);
    // A square of the search: the greatest depth that it could contain, its middle, half of its edge, the depth of its middle.
    let square = |p: DVec2, half: f64| {
        let d = depth(p);
        (d + half * std::f64::consts::SQRT_2, p, half, d)
    };
    let mut open = Vec::new();
    let count = (size / (2.0 * half)).ceil();
    for x in 0..count.x as usize {
        for y in 0..count.y as usize {
            open.push(square(bounds.min + DVec2::new(x as f64, y as f64) * (2.0 * half) + half, half));
        }
    }
    let mut best = (polygon[0], f64::NEG_INFINITY);
    for (_, p, _, d) in &open {
        if *d > best.1 {
            best = (*p, *d);
        }
    }
    while let Some(i) = (0..open.len()).max_by(|a, b| open[*a].0.total_cmp(&open[*b].0).then(b.cmp(a))) {
        let (most, p, half, _) = open.swap_remove(i);
        if most - best.1 <= precision {
            break;
        }
        let h = half / 2.0;
        for corner in [DVec2::new(-h, -h), DVec2::new(h, -h), DVec2::new(-h, h), DVec2::new(h, h)] {
            let next = square(p + corner, h);
            if next.3 > best.1 {
                best = (next.1, next.3);
            }
            if next.0 - best.1 > precision {
                open.push(next);
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pole_of_an_l_is_in_its_knee() {
        let l = [(0., 0.), (300., 0.), (300., 100.), (100., 100.), (100., 300.), (0., 300.)].map(DVec2::from);
        let (p, d) = pole(&l, 0.5);
        assert!(point_in_polygon(p, &l) && d > 57.5 && d <= 59.0, "{p} {d}");
    }
}
