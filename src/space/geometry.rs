//! Points and segments.

use glam::DVec2;
use robust::{Coord, orient2d};

/// z of the cross product: positive when `b` is to the left of `a`.
pub fn cross(a: DVec2, b: DVec2) -> f64 {
    a.perp_dot(b)
}

/// `v` turned a quarter to the left.
pub fn left_normal(v: DVec2) -> DVec2 {
    v.perp()
}

/// Exact side test: positive when `c` lies to the left of the line from `a` to `b`, 0 when it lies on the line.
pub fn orient(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Where two segments meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentCrossing {
    /// Parameter along the first segment, 0..=1.
    pub t: f64,
    /// Parameter along the second segment, 0..=1.
    pub u: f64,
    /// The point where the segments meet.
    pub at: DVec2,
}

/// The point that the segments `a`-`b` and `c`-`d` share, touching ends included. The decision is exact, the position is
/// rounded. Collinear segments that overlap meet at their shared point nearest to `a`.
pub fn segment_crossing(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<SegmentCrossing> {
    let (ab, cd) = (b - a, d - c);
    let (min1, max1, min2, max2) = (a.min(b), a.max(b), c.min(d), c.max(d));
    if min1.cmpgt(max2).any() || min2.cmpgt(max1).any() {
        return None;
    }
    let (oc, od) = (orient(a, b, c), orient(a, b, d));
    if (oc > 0.0 && od > 0.0) || (oc < 0.0 && od < 0.0) {
        return None;
    }
    let (oa, ob) = (orient(c, d, a), orient(c, d, b));
    if oc == 0.0 && od == 0.0 {
        // Collinear: the shared stretch, as parameters along a-b.
        let len2 = ab.length_squared();
        if len2 == 0.0 {
            return (cd.length_squared() == 0.0 || oa == 0.0).then_some(SegmentCrossing { t: 0.0, u: 0.0, at: a });
        }
        let (tc, td) = ((c - a).dot(ab) / len2, (d - a).dot(ab) / len2);
        let (low, high) = (tc.min(td).max(0.0), tc.max(td).min(1.0));
        if low > high {
            return None;
        }
        let at = a + ab * low;
        let u = if cd.length_squared() == 0.0 { 0.0 } else { (at - c).dot(cd) / cd.length_squared() };
        return Some(SegmentCrossing { t: low, u: u.clamp(0.0, 1.0), at });
    }
    if (oa > 0.0 && ob > 0.0) || (oa < 0.0 && ob < 0.0) {
        return None;
    }
    let t = (oa / (oa - ob)).clamp(0.0, 1.0);
    let u = (oc / (oc - od)).clamp(0.0, 1.0);
    let at = if oc == 0.0 {
        c
    } else if od == 0.0 {
        d
    } else if oa == 0.0 {
        a
    } else if ob == 0.0 {
        b
    } else {
        a + ab * t
    };
    Some(SegmentCrossing { t, u, at })
}

/// Parameter 0..=1 and position of the point of segment `a`-`b` nearest to `p`.
pub fn closest_on_segment(p: DVec2, a: DVec2, b: DVec2) -> (f64, DVec2) {
    let ab = b - a;
    let len2 = ab.length_squared();
    let t = if len2 == 0.0 { 0.0 } else { ((p - a).dot(ab) / len2).clamp(0.0, 1.0) };
    (t, a + ab * t)
}

/// Distance from `p` to segment `a`-`b`.
pub fn distance_to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    closest_on_segment(p, a, b).1.distance(p)
}

/// Distance between segments `a`-`b` and `c`-`d`, 0 when they meet.
pub fn segment_distance(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> f64 {
    if segment_crossing(a, b, c, d).is_some() {
        return 0.0;
    }
    let squared = |p: DVec2, a: DVec2, b: DVec2| closest_on_segment(p, a, b).1.distance_squared(p);
    squared(a, c, d).min(squared(b, c, d)).min(squared(c, a, b)).min(squared(d, a, b)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    #[test]
    fn crossings_touches_and_overlaps() {
        let c = segment_crossing(v(0., 0.), v(2., 2.), v(0., 2.), v(2., 0.)).unwrap();
        assert_eq!((c.t, c.u, c.at), (0.5, 0.5, v(1., 1.)));
        assert_eq!(segment_crossing(v(0., 0.), v(2., 0.), v(1., 0.), v(1., 5.)).unwrap().at, v(1., 0.));
        assert_eq!(segment_crossing(v(0., 0.), v(2., 0.), v(3., 0.), v(1., 0.)).unwrap().at, v(1., 0.));
        assert!(segment_crossing(v(0., 0.), v(2., 0.), v(2.1, 0.), v(3., 0.)).is_none());
        assert!(segment_crossing(v(0., 0.), v(2., 0.), v(0., 1.), v(2., 1.)).is_none());
        assert_eq!(segment_distance(v(0., 0.), v(2., 0.), v(3., 4.), v(9., 4.)), 17f64.sqrt());
    }
}
