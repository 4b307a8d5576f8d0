//! Longitude and latitude to plan metres.

use crate::space::math;
use glam::DVec2;

/// Semi-major axis of the WGS84 ellipsoid, in metres.
const SEMI_MAJOR: f64 = 6_378_137.0;
/// Square of the first eccentricity of the WGS84 ellipsoid.
const ECCENTRICITY_2: f64 = 0.006_694_379_990_141_316;
/// Greatest latitude of a projection's origin, in degrees: near the poles a degree of longitude has no width.
const MOST_LATITUDE: f64 = 85.0;

/// A local equirectangular projection around the plan's origin: everywhere a degree has the length in metres that it has at
/// the origin on the WGS84 ellipsoid.
///
/// One degree of latitude away from the origin, north-south distances are off by less than 0.02 %, and east-west distances by
/// `tan(latitude)` times the angle, which is 1.6 % at 42 degrees. The projection suits domains up to about 200 km.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geographic {
    /// Longitude and latitude of the plan's origin, in degrees.
    middle: DVec2,
    /// Metres per degree of longitude and of latitude.
    scale: DVec2,
}

impl Geographic {
    /// The projection around a longitude (east) and latitude (north) in degrees. `None` unless the longitude lies in -180 to 360
    /// and the latitude in -85 to 85.
    pub fn around(middle: DVec2) -> Option<Self> {
        if !(-180.0..=360.0).contains(&middle.x) || !(-MOST_LATITUDE..=MOST_LATITUDE).contains(&middle.y) {
            return None;
        }
        let latitude = middle.y.to_radians();
        let sine = math::sin(latitude);
        let root = (1.0 - ECCENTRICITY_2 * sine * sine).sqrt();
        // Radii of curvature along the parallel and along the meridian.
        let parallel = SEMI_MAJOR / root * math::cos(latitude);
        let meridian = SEMI_MAJOR * (1.0 - ECCENTRICITY_2) / (root * root * root);
        Some(Self { middle, scale: DVec2::new(parallel, meridian) * 1f64.to_radians() })
    }

    /// Longitude and latitude of the plan's origin, in degrees.
    pub fn middle(&self) -> DVec2 {
        self.middle
    }

    /// Metres per degree of longitude and of latitude.
    pub fn metres_per_degree(&self) -> DVec2 {
        self.scale
    }

    /// Plan metres of a longitude and latitude in degrees, measured along the shorter way around the globe: longitudes of -180 to
    /// 180 and of 0 to 360 mean the same.
    pub fn to_plan(&self, degrees: DVec2) -> DVec2 {
        let mut offset = degrees - self.middle;
        offset.x -= 360.0 * (offset.x / 360.0).round();
        offset * self.scale
    }

    /// Longitude and latitude in degrees of a plan point.
    pub fn to_degrees(&self, plan: DVec2) -> DVec2 {
        self.middle + plan / self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_degree_has_its_length_on_the_ellipsoid() {
        // Lengths of a degree as published for WGS84, in metres.
        for (latitude, east, north) in
            [(0.0, 111_319.5, 110_574.3), (45.0, 78_846.8, 111_131.8), (60.0, 55_800.0, 111_412.3)]
        {
            let scale = Geographic::around(DVec2::new(7.0, latitude)).unwrap().metres_per_degree();
            assert!((scale - DVec2::new(east, north)).abs().max_element() < 0.5, "{latitude}: {scale}");
        }
    }

    #[test]
    fn there_and_back_and_across_the_date_line() {
        let g = Geographic::around(DVec2::new(179.9, -17.0)).unwrap();
        let p = DVec2::new(179.31, -17.25);
        assert!(g.to_degrees(g.to_plan(p)).distance(p) < 1e-12);
        assert!(g.to_plan(DVec2::new(-179.9, -17.0)).distance(g.to_plan(DVec2::new(180.1, -17.0))) < 1e-6);
        assert_eq!(g.to_plan(g.middle()), DVec2::ZERO);
        for bad in [DVec2::new(0.0, 86.0), DVec2::new(400.0, 0.0), DVec2::new(f64::NAN, 0.0)] {
            assert_eq!(Geographic::around(bad), None);
        }
    }
}
