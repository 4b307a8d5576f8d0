//! What the values of a raster mean.

use crate::edits::STRENGTHS;
use crate::layer::RangeError;

/// What the values of a raster mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Band {
    /// Heights in metres: -100,000 to 100,000.
    Height,
    /// Depths of water in metres, 0 on land: 0 to 100,000.
    Depth,
    /// Vegetation densities: 0 (bare) to 1 (dense wood).
    Vegetation,
    /// Extra cost of roads: -10 to 100.
    Influence,
}

impl Band {
    /// Least and greatest value.
    pub fn range(self) -> (f64, f64) {
        match self {
            Self::Height => (-1e5, 1e5),
            Self::Depth => (0.0, 1e5),
            Self::Vegetation => (0.0, 1.0),
            Self::Influence => STRENGTHS,
        }
    }

    /// What a value of the band is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Height => "height",
            Self::Depth => "water depth",
            Self::Vegetation => "vegetation density",
            Self::Influence => "influence",
        }
    }

    /// Whether a value stands for no value although the file does not say so: heights 33 km deep are voids of surveys.
    pub(super) fn is_void(self, value: f64) -> bool {
        self == Self::Height && (value == -32_768.0 || value == -32_767.0)
    }

    /// Fails if a value is out of range or NaN.
    pub(super) fn check(self, value: f64) -> Result<(), RangeError> {
        let (low, high) = self.range();
        RangeError::check(self.name(), value, low, high)
    }
}
