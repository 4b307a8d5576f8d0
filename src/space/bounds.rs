//! Axis-aligned boxes.

use glam::DVec2;

/// An axis-aligned box in metres, borders included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// South-west corner.
    pub min: DVec2,
    /// North-east corner.
    pub max: DVec2,
}

impl Bounds {
    /// The empty box: its union with another box is that box.
    pub const EMPTY: Self = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };

    /// The box from its south-west to its north-east corner.
    pub fn new(min: DVec2, max: DVec2) -> Self {
        Self { min, max }
    }

    /// The square of edge `size` around `centre`.
    pub fn square(centre: DVec2, size: f64) -> Self {
        Self { min: centre - size / 2.0, max: centre + size / 2.0 }
    }

    /// The smallest box around `points`.
    pub fn of(points: impl IntoIterator<Item = DVec2>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The box with `margin` metres more on every side, or less if `margin` is negative.
    pub fn grown(self, margin: f64) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// The box moved by `offset`.
    pub fn moved(self, offset: DVec2) -> Self {
        Self { min: self.min + offset, max: self.max + offset }
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Middle of the box.
    pub fn centre(self) -> DVec2 {
        (self.min + self.max) / 2.0
    }

    /// Width and height.
    pub fn size(self) -> DVec2 {
        self.max - self.min
    }

    /// Whether `p` lies in the box.
    pub fn contains(self, p: DVec2) -> bool {
        p.cmpge(self.min).all() && p.cmple(self.max).all()
    }

    /// Whether all of `other` lies in the box.
    pub fn encloses(self, other: Self) -> bool {
        self.contains(other.min) && self.contains(other.max)
    }

    /// Whether the boxes share a point.
    pub fn overlaps(self, other: Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// The part of the segment from `a` to `b` that lies in the box, as parameters along it (0 is `a`, 1 is `b`; Liang and
    /// Barsky 1984). `None` where the segment shares no more than a point with the box.
    pub fn clip_segment(self, a: DVec2, b: DVec2) -> Option<(f64, f64)> {
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for axis in 0..2 {
            let (start, along, low, high) = (a[axis], b[axis] - a[axis], self.min[axis], self.max[axis]);
            if along == 0.0 {
                if start < low || start > high {
                    return None;
                }
                continue;
            }
            let (enter, leave) = ((low - start) / along, (high - start) / along);
            from = from.max(enter.min(leave));
            to = to.min(enter.max(leave));
        }
        (from < to).then_some((from, to))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_clipped_to_a_box() {
        let bounds = Bounds::square(DVec2::ZERO, 10.0);
        let clip = |a: [f64; 2], b: [f64; 2]| bounds.clip_segment(a.into(), b.into());
        assert_eq!(clip([-10.0, 0.0], [10.0, 0.0]), Some((0.25, 0.75)));
        assert_eq!(clip([0.0, 0.0], [3.0, 4.0]), Some((0.0, 1.0)));
        assert_eq!(clip([0.0, 0.0], [0.0, 20.0]), Some((0.0, 0.25)));
        for (a, b) in [([-9.0, 7.0], [9.0, 7.0]), ([0.0, 10.0], [10.0, 0.0]), ([6.0, 0.0], [9.0, 0.0])] {
            assert_eq!(clip(a, b), None);
        }
    }
}
