//! Rules of main streets.

use super::mix::Blend;
use crate::layer::{Choice, RangeError, Ranged, Walk};
use serde::{Deserialize, Serialize};

/// Directions that the streets of a style prefer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum FieldKind {
    /// One heading for the whole settlement.
    #[default]
    Grid,
    /// Towards and around the centre.
    Radial,
    /// A heading that wanders.
    Organic,
    /// Along and across the slope of the ground.
    Contours,
}

impl FieldKind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Grid, Self::Radial, Self::Organic, Self::Contours];
}

/// Parametric growth of main streets (Teng 2017, Fig. 3). Lengths in metres, angles in degrees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MainRules {
    /// Directions they follow.
    pub field: FieldKind,
    /// Length of a street between junctions; sets the size of main cells.
    pub length: f64,
    /// Greatest deviation from that length.
    pub deviation: f64,
    /// Least length.
    pub min_length: f64,
    /// Least and greatest number of streets at a junction. With at most 2, a street runs through from gate to gate, and those of
    /// other gates join it.
    pub degree: (u32, u32),
    /// Least angle between two streets at a junction.
    pub min_angle_deg: f64,
    /// Greatest deviation from the field's direction.
    pub angle_deviation_deg: f64,
    /// Distance within which a street's end snaps to a junction or street.
    pub snap_radius: f64,
    /// Share (0 to 1) of the big junctions that become roundabouts: rings of main streets around an island.
    pub roundabouts: f64,
    /// Share (0 to 1) of them that become squares: main streets around an open place. With `roundabouts` at most 1.
    pub squares: f64,
    /// Distance between the bridges over a river that runs through.
    pub bridges: f64,
}

impl Default for MainRules {
    fn default() -> Self {
        Self {
            field: FieldKind::Grid,
            length: 260.0,
            deviation: 40.0,
            min_length: 110.0,
            degree: (3, 4),
            min_angle_deg: 55.0,
            angle_deviation_deg: 6.0,
            snap_radius: 90.0,
            roundabouts: 0.0,
            squares: 0.0,
            bridges: 420.0,
        }
    }
}

impl Choice for FieldKind {
    const CHOICES: &'static [Self] = &Self::ALL;
}

impl Ranged for MainRules {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self {
            field,
            length,
            deviation,
            min_length,
            degree,
            min_angle_deg,
            angle_deviation_deg,
            snap_radius,
            roundabouts,
            squares,
            bridges,
        } = self;
        walk.choice("field", field)?;
        walk.number("length", length, 60.0, 2000.0)?;
        walk.number("deviation", deviation, 0.0, *length / 2.0)?;
        walk.number("min_length", min_length, 40.0, *length)?;
        walk.pair("degree", degree, 2.0, 8.0)?;
        walk.number("min_angle_deg", min_angle_deg, 15.0, 90.0)?;
        walk.number("angle_deviation_deg", angle_deviation_deg, 0.0, 45.0)?;
        walk.number("snap_radius", snap_radius, 10.0, *length)?;
        walk.number("roundabouts", roundabouts, 0.0, 1.0)?;
        walk.number("squares", squares, 0.0, 1.0 - *roundabouts)?;
        walk.number("bridges", bridges, 150.0, 10_000.0)
    }
}

impl MainRules {
    /// The rules between `a` and `b`.
    pub(super) fn mix(a: &Self, b: &Self, blend: &mut Blend) -> Self {
        let roundabouts = blend.number(a.roundabouts, b.roundabouts);
        Self {
            field: blend.choice(&a.field, &b.field),
            length: blend.number(a.length, b.length),
            deviation: blend.number(a.deviation, b.deviation),
            min_length: blend.number(a.min_length, b.min_length),
            degree: blend.counts(a.degree, b.degree),
            min_angle_deg: blend.number(a.min_angle_deg, b.min_angle_deg),
            angle_deviation_deg: blend.number(a.angle_deviation_deg, b.angle_deviation_deg),
            snap_radius: blend.number(a.snap_radius, b.snap_radius),
            roundabouts,
            // Both lie in range, but rounding may lift their sum over 1.
            squares: blend.number(a.squares, b.squares).min(1.0 - roundabouts),
            bridges: blend.number(a.bridges, b.bridges),
        }
    }
}
