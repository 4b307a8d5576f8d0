//! From the coordinates of a file to plan metres.

use crate::map::error::MapError;
use crate::space::{Bounds, Geographic};
use glam::DVec2;

/// Greatest distance from the plan's origin along an axis, in metres.
const FARTHEST: f64 = 1e10;

/// What the coordinates of a file are, and where they lie on the plan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum MapCoordinates {
    /// Longitude and latitude. The middle of the map becomes the plan's origin: half of the points of its streets lie on
    /// either side of it, so that ways which reach far out of an extract do not move it.
    #[default]
    Degrees,
    /// Longitude and latitude, projected in a given way.
    DegreesAround(Geographic),
    /// Plan metres already, in GeoJSON alone.
    Metres,
}

/// Places points of a file on the plan.
pub(super) struct Projector<'a> {
    file: &'a str,
    /// `None` for metres.
    pub projection: Option<Geographic>,
}

impl<'a> Projector<'a> {
    /// For a file whose streets have these points.
    pub fn new(file: &'a str, coordinates: MapCoordinates, points: &[DVec2]) -> Result<Self, MapError> {
        let projection = match coordinates {
            MapCoordinates::Metres => None,
            MapCoordinates::DegreesAround(projection) => Some(projection),
            MapCoordinates::Degrees => Some(around_middle(file, points)?),
        };
        Ok(Self { file, projection })
    }

    /// Plan metres of a point of the file.
    pub fn to_plan(&self, at: DVec2) -> Result<DVec2, MapError> {
        let file = || self.file.to_owned();
        match &self.projection {
            Some(projection) => {
                check_degrees(self.file, at)?;
                Ok(projection.to_plan(at))
            }
            None if at.is_finite() && at.abs().max_element() <= FARTHEST => Ok(at),
            None => Err(MapError::TooFar { file: file(), at, limit: FARTHEST }),
        }
    }

    /// What may be wrong with a map none of whose points lies in a box.
    pub fn hint_outside(&self, points: &[DVec2], bounds: Bounds) -> &'static str {
        let swapped = |p: &DVec2| self.to_plan(DVec2::new(p.y, p.x)).is_ok_and(|p| bounds.contains(p));
        if self.projection.is_some() && points.iter().any(swapped) {
            "; some would with longitude and latitude swapped"
        } else {
            ""
        }
    }
}

fn check_degrees(file: &str, at: DVec2) -> Result<(), MapError> {
    if at.x.abs() <= 360.0 && at.y.abs() <= 90.0 {
        return Ok(());
    }
    let reason = match at.x.abs() <= 90.0 && at.y.abs() <= 180.0 {
        true => "latitude is at most 90, and comes second",
        false => "longitude is at most 360 and latitude at most 90; a map in metres?",
    };
    Err(MapError::NotDegrees { file: file.to_owned(), at, reason })
}

/// The projection around the middle of some points.
fn around_middle(file: &str, points: &[DVec2]) -> Result<Geographic, MapError> {
    points.iter().try_for_each(|p| check_degrees(file, *p))?;
    let median = |of: fn(&DVec2) -> f64| {
        let mut all: Vec<f64> = points.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or_default()
    };
    let middle = DVec2::new(median(|p| p.x), median(|p| p.y));
    let reason = "maps within 5 degrees of a pole are not read";
    Geographic::around(middle).ok_or_else(|| MapError::NotDegrees { file: file.to_owned(), at: middle, reason })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_where_half_of_the_points_lie_on_either_side() {
        let points: Vec<DVec2> = [8.0, 8.001, 8.002, 8.003, 99.0].map(|x| DVec2::new(x, 49.0)).to_vec();
        let projector = Projector::new("f", MapCoordinates::Degrees, &points).unwrap();
        assert_eq!(projector.projection.map(|p| p.middle()), Some(DVec2::new(8.002, 49.0)));
        assert_eq!(projector.to_plan(DVec2::new(8.002, 49.0)), Ok(DVec2::ZERO));
    }

    #[test]
    fn places_that_cannot_be_are_explained() {
        let refused = |coordinates, x: f64, y: f64| {
            let points = [DVec2::new(x, y)];
            let projector = Projector::new("f", coordinates, &points).and_then(|p| p.to_plan(points[0]));
            projector.unwrap_err().to_string()
        };
        assert!(refused(MapCoordinates::Degrees, 47.0, 109.0).contains("f: 47,109 is no longitude and latitude"));
        assert!(refused(MapCoordinates::Degrees, 47.0, 109.0).ends_with("latitude is at most 90, and comes second"));
        assert!(refused(MapCoordinates::Degrees, 5e5, 5e6).ends_with("a map in metres?"));
        assert!(refused(MapCoordinates::Degrees, 5.0, 89.0).contains("pole"));
        assert!(refused(MapCoordinates::Metres, 1e300, 0.0).contains("too far out"));
        assert!(refused(MapCoordinates::Metres, f64::NAN, 0.0).contains("too far out"));
    }

    #[test]
    fn a_map_elsewhere_may_have_longitude_and_latitude_swapped() {
        let around = Geographic::around(DVec2::new(9.0, 47.0)).unwrap();
        let projector = Projector::new("f", MapCoordinates::DegreesAround(around), &[]).unwrap();
        let bounds = Bounds::square(DVec2::ZERO, 1_000.0);
        assert!(projector.hint_outside(&[DVec2::new(47.0, 9.0)], bounds).contains("swapped"));
        assert_eq!(projector.hint_outside(&[DVec2::new(40.0, 9.0)], bounds), "");
    }
}
