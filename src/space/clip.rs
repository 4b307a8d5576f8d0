//! Lines cut at the border of a box.

use crate::space::bounds::Bounds;
use glam::DVec2;

/// A point of a clipped line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClippedPoint {
    /// A point of the line, by its index.
    Own(usize),
    /// Where the border of the box cuts a segment of the line, by the segment's index.
    Border(usize, DVec2),
}

/// A cut this close to a point of the line, in metres, is that point.
const CLOSE: f64 = 1e-6;

/// The parts of a line that lie in a box, in order. A part that only touches the box from outside is none.
pub fn clip_line(line: &[DVec2], bounds: Bounds) -> Vec<Vec<ClippedPoint>> {
    let mut out = Vec::new();
    let mut part: Vec<ClippedPoint> = Vec::new();
    for (i, pair) in line.windows(2).enumerate() {
        let (a, b) = (pair[0], pair[1]);
        let Some((from, to)) = bounds.clip_segment(a, b) else {
            out.push(std::mem::take(&mut part));
            continue;
        };
        let point = |t: f64| match a.lerp(b, t) {
            p if t <= 0.0 || p.distance(a) < CLOSE => ClippedPoint::Own(i),
            p if t >= 1.0 || p.distance(b) < CLOSE => ClippedPoint::Own(i + 1),
            p => ClippedPoint::Border(i, p.clamp(bounds.min, bounds.max)),
        };
        let (start, end) = (point(from), point(to));
        if part.last() != Some(&start) {
            out.push(std::mem::take(&mut part));
            part.push(start);
        }
        part.push(end);
        if end != ClippedPoint::Own(i + 1) {
            out.push(std::mem::take(&mut part));
        }
    }
    out.push(part);
    out.retain(|p| p.len() > 1 && p[0] != p[1]);
    out
}

#[cfg(test)]
mod tests {
    use super::ClippedPoint::{Border, Own};
    use super::*;

    #[test]
    fn a_line_is_cut_where_it_enters_and_leaves() {
        let bounds = Bounds::square(DVec2::ZERO, 10.0);
        let clip =
            |points: &[(f64, f64)]| clip_line(&points.iter().map(|p| DVec2::from(*p)).collect::<Vec<_>>(), bounds);
        let at = |i: usize, x: f64, y: f64| Border(i, DVec2::new(x, y));
        assert_eq!(clip(&[(0., 0.), (1., 0.), (1., 4.)]), [[Own(0), Own(1), Own(2)]]);
        assert_eq!(clip(&[(-9., 0.), (9., 0.)]), [[at(0, -5., 0.), at(0, 5., 0.)]]);
        let there_and_back = clip(&[(0., 0.), (9., 0.), (9., 1.), (0., 1.)]);
        assert_eq!(there_and_back, [[Own(0), at(0, 5., 0.)], [at(2, 5., 1.), Own(3)]]);
        // A point on the border is itself, also where the line goes on outside.
        assert_eq!(clip(&[(0., 0.), (5., 0.), (9., 0.)]), [[Own(0), Own(1)]]);
        assert_eq!(clip(&[(0., 0.), (5., 0.), (5., 3.)]), [[Own(0), Own(1), Own(2)]]);
        assert!(clip(&[(9., 0.), (9., 4.)]).is_empty() && clip(&[]).is_empty());
    }

    #[test]
    fn a_line_of_three_points_far_out_keeps_few_points() {
        let line = [DVec2::splat(-1e10), DVec2::splat(1e10), DVec2::new(-1e10, 1e10)];
        assert_eq!(clip_line(&line, Bounds::square(DVec2::ZERO, 2_000.0)).concat().len(), 2);
    }
}
