//! Lines moved sideways, and outlines around the ends of streets. Radii and distances are in metres.

use glam::DVec2;

/// The points of `line` moved sideways by `by` metres, positive to the left. A point between two segments becomes their mitred
/// corner, which is limited where the line doubles back.
pub fn offset_line(line: &[DVec2], by: f64) -> Vec<DVec2> {
    let direction = |i: usize| (line[i + 1] - line[i]).normalize_or_zero();
    let Some(last) = line.len().checked_sub(1).filter(|last| *last > 0) else { return line.to_vec() };
    let moved = |i: usize| {
        let (before, after) = (direction(i.max(1) - 1), direction(i.min(last - 1)));
        let mitre = (before + after).perp() / (1.0 + before.dot(after)).max(0.3);
        line[i] + mitre * by
    };
    (0..=last).map(moved).collect()
}

/// The corner, relative to the centre, of two tangents to a circle that touch it in the unit normals `a` and `b`.
pub(super) fn mitre(a: DVec2, b: DVec2, radius: f64) -> DVec2 {
    (a + b) * (radius / (1.0 + a.dot(b)))
}

/// The corners, relative to the centre, of a polygon around the sector of a circle from unit normal `from` counter-clockwise
/// to `to`, at most half a turn: one corner up to a quarter turn, two beyond.
pub(super) fn sector_corners(from: DVec2, to: DVec2, radius: f64) -> impl DoubleEndedIterator<Item = DVec2> {
    let corners = if from.dot(to) >= 0.0 {
        [Some(mitre(from, to, radius)), None]
    } else {
        let middle = if from.dot(to) < -0.999_999 { from.perp() } else { (from + to).normalize() };
        [Some(mitre(from, middle, radius)), Some(mitre(middle, to, radius))]
    };
    corners.into_iter().flatten()
}

/// Unit normals of half an octagon around an end of a line, which leaves the end in the unit direction `d`: from the line's
/// left side around the end to its right side.
pub(super) fn end_normals(d: DVec2) -> [DVec2; 5] {
    let (left, behind) = (d.perp(), -d);
    [left, (left + behind).normalize(), behind, (behind - left).normalize(), -left]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bend_is_mitred_on_both_sides() {
        let line = [DVec2::ZERO, DVec2::X * 10.0, DVec2::new(10.0, 10.0)];
        assert_eq!(offset_line(&line, 2.0), [DVec2::new(0.0, 2.0), DVec2::new(8.0, 2.0), DVec2::new(8.0, 10.0)]);
        assert_eq!(offset_line(&line, -2.0)[1], DVec2::new(12.0, -2.0));
        assert_eq!(offset_line(&line[..1], 2.0), line[..1]);
    }

    #[test]
    fn polygons_around_a_circle_hold_it() {
        let (from, to) = (DVec2::X, -DVec2::X);
        let corners: Vec<DVec2> = sector_corners(from, to, 3.0).collect();
        assert_eq!(corners, [DVec2::new(3.0, 3.0), DVec2::new(-3.0, 3.0)]);
        let normals = end_normals(DVec2::Y);
        assert_eq!((normals[0], normals[2], normals[4]), (-DVec2::X, -DVec2::Y, DVec2::X));
        for w in normals.windows(2) {
            assert!((mitre(w[0], w[1], 3.0).dot(w[0]) - 3.0).abs() < 1e-12, "a corner lies on both tangents");
        }
    }
}
