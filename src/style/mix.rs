//! Values between two values.

use crate::space::Stream;
use crate::space::math::mix;

/// How far a mixture is on the way from a first style to a second, and the stream that draws choices without a middle.
pub(super) struct Blend<'a> {
    t: f64,
    stream: &'a mut Stream,
}

impl<'a> Blend<'a> {
    /// A mixture that is `t` (0 to 1) of the way to the second style.
    pub fn new(t: f64, stream: &'a mut Stream) -> Self {
        Self { t, stream }
    }

    pub fn number(&self, a: f64, b: f64) -> f64 {
        // Exact at both ends.
        if self.t >= 1.0 { b } else { mix(a, b, self.t) }
    }

    pub fn pair(&self, a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
        (self.number(a.0, b.0), self.number(a.1, b.1))
    }

    pub fn counts(&self, a: (u32, u32), b: (u32, u32)) -> (u32, u32) {
        let whole = |a: u32, b: u32| self.number(a.into(), b.into()).round() as u32;
        (whole(a.0, b.0), whole(a.1, b.1))
    }

    pub fn choice<T: Clone>(&mut self, a: &T, b: &T) -> T {
        if self.stream.chance(self.t) { b.clone() } else { a.clone() }
    }
}
