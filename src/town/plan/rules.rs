//! The rules of a style fitted to a settlement, and the limits that a proposed street must keep to.

use crate::style::MainRules;

/// The rules for main streets of a style, fitted to the size of the settlement. Metres and radians.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    pub length: f64,
    pub deviation: f64,
    pub min_length: f64,
    /// Least and greatest number of streets at a junction.
    pub degree: (usize, usize),
    pub min_angle: f64,
    pub angle_deviation: f64,
    pub snap_radius: f64,
    /// Least distance between streets away from their common junction.
    pub gap: f64,
    /// Least distance to the outline, except at gates.
    pub margin: f64,
}

impl Rules {
    /// Rules of a settlement whose outline has the area of a circle of `radius` metres.
    pub fn new(rules: &MainRules, radius: f64) -> Self {
        let length = rules.length.min(0.55 * radius).max(60.0);
        let scale = length / rules.length;
        let min_length = rules.min_length.min(0.7 * length);
        Self {
            length,
            deviation: rules.deviation * scale,
            min_length,
            degree: (rules.degree.0 as usize, rules.degree.1 as usize),
            min_angle: rules.min_angle_deg.to_radians(),
            angle_deviation: rules.angle_deviation_deg.to_radians(),
            snap_radius: rules.snap_radius * scale,
            gap: (0.36 * length).clamp(50.0, 100.0),
            margin: (0.3 * length).clamp(60.0, 120.0),
        }
    }

    /// The limits that follow from the rules.
    pub fn limits(&self) -> Limits {
        Limits {
            gap: self.gap,
            min_angle: self.min_angle,
            min_length: self.min_length,
            min_part: self.min_length,
            margin: self.margin,
            max_turn: 0.5,
            checks_ground: true,
        }
    }
}

/// What a proposed street must keep to. Metres and radians.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Least distance to other streets away from a common junction.
    pub gap: f64,
    /// Least angle to the streets at its ends.
    pub min_angle: f64,
    /// Least length.
    pub min_length: f64,
    /// Least length of both parts of a street that the proposal splits.
    pub min_part: f64,
    /// Least distance to the outline, except at gates.
    pub margin: f64,
    /// Greatest turn at a point of inflexion.
    pub max_turn: f64,
    /// Whether the street must keep off water and steep ground.
    pub checks_ground: bool,
}
