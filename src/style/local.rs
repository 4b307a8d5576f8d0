//! Rules of local streets.

use super::mix::Blend;
use crate::layer::RangeError;
use serde::{Deserialize, Serialize};

/// Growth of local streets where no patch fits (Teng 2017, Fig. 3). Lengths in metres, angles in degrees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LocalRules {
    /// Length of a street segment.
    pub length: f64,
    /// Greatest deviation from that length.
    pub deviation: f64,
    /// Least length.
    pub min_length: f64,
    /// Least and greatest number of streets at a junction.
    pub degree: (u32, u32),
    /// Least angle between two streets at a junction.
    pub min_angle_deg: f64,
    /// Greatest deviation from the straight direction.
    pub angle_deviation_deg: f64,
    /// Distance within which an end snaps to a junction or street.
    pub snap_radius: f64,
    /// Least distance between streets that do not meet.
    pub clearance: f64,
    /// Share (0 to 1) of the dead ends that stay, of those that could be led on to another street.
    pub dead_ends: f64,
    /// Greatest distance from a sharp bend at which the curve begins that takes its place; bends stay sharp at 0.
    pub rounding: f64,
}

impl Default for LocalRules {
    fn default() -> Self {
        Self {
            length: 75.0,
            deviation: 15.0,
            min_length: 30.0,
            degree: (3, 4),
            min_angle_deg: 55.0,
            angle_deviation_deg: 6.0,
            snap_radius: 25.0,
            clearance: 26.0,
            dead_ends: 0.0,
            rounding: 0.0,
        }
    }
}

impl LocalRules {
    /// Checks that every value lies in its range; the error names the field.
    pub(super) fn check(&self) -> Result<(), RangeError> {
        let range = RangeError::check;
        range("length", self.length, 20.0, 500.0)?;
        range("deviation", self.deviation, 0.0, self.length / 2.0)?;
        range("min_length", self.min_length, 10.0, self.length)?;
        RangeError::check_pair("degree", (self.degree.0.into(), self.degree.1.into()), 2.0, 8.0)?;
        range("min_angle_deg", self.min_angle_deg, 15.0, 90.0)?;
        range("angle_deviation_deg", self.angle_deviation_deg, 0.0, 45.0)?;
        range("snap_radius", self.snap_radius, 5.0, 200.0)?;
        range("clearance", self.clearance, 15.0, 200.0)?;
        range("dead_ends", self.dead_ends, 0.0, 1.0)?;
        range("rounding", self.rounding, 0.0, 100.0)
    }

    /// The rules between `a` and `b`.
    pub(super) fn mix(a: &Self, b: &Self, blend: &mut Blend) -> Self {
        Self {
            length: blend.number(a.length, b.length),
            deviation: blend.number(a.deviation, b.deviation),
            min_length: blend.number(a.min_length, b.min_length),
            degree: blend.counts(a.degree, b.degree),
            min_angle_deg: blend.number(a.min_angle_deg, b.min_angle_deg),
            angle_deviation_deg: blend.number(a.angle_deviation_deg, b.angle_deviation_deg),
            snap_radius: blend.number(a.snap_radius, b.snap_radius),
            clearance: blend.number(a.clearance, b.clearance),
            dead_ends: blend.number(a.dead_ends, b.dead_ends),
            rounding: blend.number(a.rounding, b.rounding),
        }
    }
}
