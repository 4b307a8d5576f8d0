//! Axis-aligned boxes.

use glam::DVec2;

/// An axis-aligned box, borders included.
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
}
