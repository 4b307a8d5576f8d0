//! How a road mask is read.

use crate::map::error::MapError;
use glam::DVec2;

/// How a road mask is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaskOptions {
    /// Edge of a pixel in metres, 0.01 to 100. A mask cannot be read without.
    pub metres_per_pixel: Option<f64>,
    /// Plan metres of the middle of the picture.
    pub middle: DVec2,
    /// Colour of roads: red, green, blue.
    pub roads: [u8; 3],
    /// Colour of buildings: red, green, blue.
    pub buildings: [u8; 3],
    /// Radius in pixels of the circle that is drawn around each pixel of a thinned road, 2 to 50. Where three roads or more
    /// leave the circle lies an intersection, where one does an end.
    pub circle: f64,
    /// Angle in degrees at which a road bends so sharply that its bend is a point of its own, 0 to 180.
    pub turn_deg: f64,
    /// Distance in pixels between intersections, up to which they are one, 0 to 200.
    pub apart: f64,
}

impl Default for MaskOptions {
    /// The plan's origin in the middle, blue roads, red buildings, and the circle of Paduraru 2022. Intersections are one up to 12 pixels; the paper discards the
    /// second up to 30, and with it the streets between.
    fn default() -> Self {
        let (roads, buildings) = ([0, 0, 255], [255, 0, 0]);
        let middle = DVec2::ZERO;
        Self { metres_per_pixel: None, middle, roads, buildings, circle: 5.0, turn_deg: 90.0, apart: 12.0 }
    }
}

impl MaskOptions {
    /// The edge of a pixel, if all values lie in their ranges.
    pub(super) fn check(&self, file: &str) -> Result<f64, MapError> {
        let Some(edge) = self.metres_per_pixel else { return Err(MapError::NeedsScale { file: file.into() }) };
        let values = [
            ("metres_per_pixel", edge, 0.01, 100.0),
            ("circle", self.circle, 2.0, 50.0),
            ("turn_deg", self.turn_deg, 0.0, 180.0),
            ("apart", self.apart, 0.0, 200.0),
        ];
        match values.into_iter().find(|(_, value, low, high)| !(low..=high).contains(&value)) {
            Some((option, value, low, high)) => {
                Err(MapError::MaskOption { file: file.into(), option, value, allowed: (low, high) })
            }
            None => Ok(edge),
        }
    }
}
