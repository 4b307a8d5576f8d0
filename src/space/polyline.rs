//! Polylines and simple polygons as slices of points. A polygon is open (its last point is not its first); one with
//! positive area runs counter-clockwise.

use crate::space::{closest_on_segment, orient, segment_crossing, segment_distance};
use glam::DVec2;

/// The segments of a polyline, in order.
pub fn segments(line: &[DVec2]) -> impl DoubleEndedIterator<Item = (DVec2, DVec2)> + Clone + '_ {
    line.windows(2).map(|w| (w[0], w[1]))
}

/// Length of a polyline in metres.
pub fn line_length(line: &[DVec2]) -> f64 {
    segments(line).map(|(a, b)| a.distance(b)).sum()
}

/// Position and unit direction `at` metres along a polyline, clamped to its ends. The direction is zero for a line without
/// length.
pub fn point_at(line: &[DVec2], at: f64) -> (DVec2, DVec2) {
    place_on(line, segments(line).map(|(a, b)| a.distance(b)), at)
}

/// [`point_at`] for a line whose segments have the given lengths.
fn place_on(line: &[DVec2], lengths: impl Iterator<Item = f64>, at: f64) -> (DVec2, DVec2) {
    let mut left = at;
    let mut last = None;
    for (i, length) in lengths.enumerate().filter(|(_, length)| *length != 0.0) {
        let direction = || (line[i + 1] - line[i]) / length;
        if left <= length {
            return (line[i] + direction() * left.max(0.0), direction());
        }
        left -= length;
        last = Some((i, length));
    }
    last.map_or((line.first().copied().unwrap_or_default(), DVec2::ZERO), |(i, length)| {
        (line[i + 1], (line[i + 1] - line[i]) / length)
    })
}

/// A polyline with the lengths of its segments, for many calls of [`point_at`].
pub struct Measured<'a> {
    line: &'a [DVec2],
    lengths: Vec<f64>,
}

impl<'a> Measured<'a> {
    /// Measures a line.
    pub fn new(line: &'a [DVec2]) -> Self {
        Self { line, lengths: segments(line).map(|(a, b)| a.distance(b)).collect() }
    }

    /// Length of the line in metres.
    pub fn length(&self) -> f64 {
        self.lengths.iter().sum()
    }

    /// Position `at` metres along the line, as [`point_at`] gives it.
    pub fn point_at(&self, at: f64) -> DVec2 {
        place_on(self.line, self.lengths.iter().copied(), at).0
    }
}

/// The part of a polyline between `from` and `to` metres along it (`from < to`), both clamped to its length.
pub fn cut_line(line: &[DVec2], from: f64, to: f64) -> Vec<DVec2> {
    let mut out = vec![point_at(line, from).0];
    let mut along = 0.0;
    for (a, b) in segments(line) {
        along += a.distance(b);
        if along > from && along < to && b != out[out.len() - 1] {
            out.push(b);
        }
    }
    let end = point_at(line, to).0;
    if end != out[out.len() - 1] {
        out.push(end);
    }
    out
}

/// The polyline with points added so that neighbours are at most `step` metres apart.
pub fn resample(line: &[DVec2], step: f64) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = line.first().copied().into_iter().collect();
    for (a, b) in segments(line) {
        let parts = (a.distance(b) / step).ceil().max(1.0) as usize;
        out.extend((1..=parts).map(|i| if i == parts { b } else { a.lerp(b, i as f64 / parts as f64) }));
    }
    out
}

/// The polyline without the points that lie at most `tolerance` metres from the line that is left (Douglas and Peucker 1973). Both
/// ends stay.
pub fn simplify_line(line: &[DVec2], tolerance: f64) -> Vec<DVec2> {
    let mut keep = vec![false; line.len()];
    let mut spans = vec![(0, line.len().saturating_sub(1))];
    while let Some((from, to)) = spans.pop() {
        let (Some(&a), Some(&b)) = (line.get(from), line.get(to)) else { continue };
        (keep[from], keep[to]) = (true, true);
        let off = |i: &usize| closest_on_segment(line[*i], a, b).1.distance_squared(line[*i]);
        let farthest = (from + 1..to).max_by(|i, k| off(i).total_cmp(&off(k)));
        if let Some(i) = farthest.filter(|i| off(i) > tolerance * tolerance) {
            spans.extend([(from, i), (i, to)]);
        }
    }
    line.iter().zip(keep).filter(|(_, keep)| *keep).map(|(p, _)| *p).collect()
}

/// The point of a polyline nearest to `p`: metres along the line, and position.
pub fn closest_on_line(p: DVec2, line: &[DVec2]) -> (f64, DVec2) {
    let mut along = 0.0;
    let mut best = (0.0, line.first().copied().unwrap_or_default());
    let mut best_d = f64::INFINITY;
    for (a, b) in segments(line) {
        let (t, q) = closest_on_segment(p, a, b);
        let d = q.distance_squared(p);
        if d < best_d {
            (best_d, best) = (d, (along + t * a.distance(b), q));
        }
        along += a.distance(b);
    }
    best
}

/// Distance in metres from `p` to a polyline.
pub fn distance_to_line(p: DVec2, line: &[DVec2]) -> f64 {
    closest_on_line(p, line).1.distance(p)
}

/// Edges of a polygon, the closing one last.
fn polygon_edges(polygon: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

/// Area of a polygon in square metres, positive when counter-clockwise.
pub fn signed_area(polygon: &[DVec2]) -> f64 {
    let Some(&o) = polygon.first() else { return 0.0 };
    polygon_edges(polygon).map(|(a, b)| (a - o).perp_dot(b - o)).sum::<f64>() / 2.0
}

/// Centre of mass of a polygon; the mean of its points when it has no area.
pub fn centroid(polygon: &[DVec2]) -> DVec2 {
    let Some(&o) = polygon.first() else { return DVec2::ZERO };
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for (a, b) in polygon_edges(polygon) {
        let (a, b) = (a - o, b - o);
        let w = a.perp_dot(b);
        area += w;
        sum += (a + b) * w;
    }
    if area == 0.0 {
        return polygon.iter().copied().sum::<DVec2>() / polygon.len() as f64;
    }
    o + sum / (3.0 * area)
}

/// Whether `p` lies inside a polygon by the even-odd rule. A point on the border may count as inside or outside.
pub fn point_in_polygon(p: DVec2, polygon: &[DVec2]) -> bool {
    let mut inside = false;
    for (a, b) in polygon_edges(polygon) {
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    inside
}

/// Whether the border of a polygon crosses and touches itself nowhere.
pub fn is_simple(polygon: &[DVec2]) -> bool {
    let edges: Vec<(DVec2, DVec2)> = polygon_edges(polygon).collect();
    let n = edges.len();
    let meets = |i: usize, k: usize| {
        let ((a, b), (c, d)) = (edges[i], edges[k]);
        if k == i + 1 || (i == 0 && k + 1 == n) {
            // Edges side by side share a corner; one may fold back on the other.
            let (before, at, after) = if k == i + 1 { (a, b, d) } else { (c, d, b) };
            return orient(before, at, after) == 0.0 && (before - at).dot(after - at) >= 0.0;
        }
        segment_crossing(a, b, c, d).is_some()
    };
    n > 2 && (0..n).all(|i| (i + 1..n).all(|k| !meets(i, k)))
}

/// Distance in metres from segment `a`-`b` to the border of a polygon, 0 when they meet.
pub fn polygon_distance(a: DVec2, b: DVec2, polygon: &[DVec2]) -> f64 {
    polygon_edges(polygon).map(|(c, d)| segment_distance(a, b, c, d)).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_that_cross_or_touch_themselves_are_not_simple() {
        let simple = |points: &[(f64, f64)]| is_simple(&points.iter().map(|p| DVec2::from(*p)).collect::<Vec<_>>());
        assert!(simple(&[(0., 0.), (4., 0.), (4., 4.)]) && simple(&[(0., 0.), (4., 0.), (1., 1.), (0., 4.)]));
        assert!(simple(&[(0., 0.), (2., 0.), (4., 0.), (4., 4.), (0., 4.)]), "a point on a straight edge");
        assert!(!simple(&[(0., 0.), (4., 4.), (4., 0.), (0., 4.)]), "a bow tie");
        assert!(!simple(&[(0., 0.), (8., 0.), (8., 4.), (4., 0.), (0., 4.)]), "a corner on another edge");
        assert!(!simple(&[(0., 0.), (8., 0.), (4., 0.), (4., 4.)]), "an edge that folds back");
        assert!(!simple(&[(4., 0.), (4., 4.), (0., 0.), (8., 0.)]), "the same at the seam of the list");
        assert!(!simple(&[(0., 0.), (4., 0.)]) && !simple(&[]));
    }

    #[test]
    fn lines_and_polygons() {
        let square = [DVec2::ZERO, DVec2::X * 4.0, DVec2::splat(4.0), DVec2::Y * 4.0];
        assert_eq!(signed_area(&square), 16.0);
        assert_eq!(centroid(&square), DVec2::splat(2.0));
        assert!(point_in_polygon(DVec2::splat(1.0), &square) && !point_in_polygon(DVec2::splat(5.0), &square));
        assert_eq!(line_length(&square), 12.0);
        assert_eq!(point_at(&square, 6.0), (DVec2::new(4.0, 2.0), DVec2::Y));
        assert_eq!(cut_line(&square, 2.0, 6.0), vec![DVec2::new(2., 0.), DVec2::new(4., 0.), DVec2::new(4., 2.)]);
        assert_eq!(closest_on_line(DVec2::new(5.0, 1.0), &square), (5.0, DVec2::new(4.0, 1.0)));
        assert_eq!(resample(&square, 2.0).len(), 7);
        let bent: Vec<DVec2> = [(0., 0.), (2., 0.2), (4., 0.), (4., 3.), (4.1, 6.)].map(DVec2::from).to_vec();
        assert_eq!(simplify_line(&bent, 0.3), [bent[0], bent[2], bent[4]]);
        assert_eq!(simplify_line(&bent, 0.1), [bent[0], bent[1], bent[2], bent[4]]);
        assert_eq!((simplify_line(&[], 1.0), simplify_line(&bent[..1], 1.0)), (vec![], vec![bent[0]]));
    }
}
