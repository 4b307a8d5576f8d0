//! Settings of roads in a finite domain: defaults, and wider ranges than in an endless world.

use crate::layer::{RangeError, Ranged, Walk};
use crate::region::road::settings::RoadSettings;
use crate::region::road::tier_settings::TierSettings;

/// Least and greatest spacing of the lattice in metres.
const STEPS: (i64, i64) = (10, 20_000);
/// Steepest slope of any road. Slopes beyond the limits of an endless world are expensive but allowed, so that no limit alone
/// cuts a settlement off.
const STEEPEST: f64 = 1.0;
/// Distance in steps within which roads that run beside each other merge.
const MERGE: f64 = 2.0;
/// Greatest ratio of the cost of a road to its beeline.
const DETOUR: f64 = 40.0;

impl RoadSettings {
    /// Settings for a [`RoadNetwork`](crate::region::RoadNetwork) on a lattice of `step` metres.
    ///
    /// They differ from the defaults so that every settlement gets a road if land leads to it: every pair is a candidate, paths
    /// are searched on the fine lattice only, and a road may cost 40 times its beeline. Slopes beyond the usual limit cost what
    /// the square of the slope gives. Lengths that depend on the lattice grow with it. Bridges and tunnels are tried where the
    /// ground is steeper than 0.14, and are themselves at most 0.2 steep.
    pub fn finite(step: i64) -> Self {
        let steps = step as f64;
        let tier = |t: TierSettings| TierSettings {
            reach: f64::INFINITY,
            detour: DETOUR,
            coarse_step: 1,
            corridor: t.corridor.max(6.0 * steps),
            slope: t.slope * (STEEPEST / t.slope_limit) * (STEEPEST / t.slope_limit),
            slope_limit: STEEPEST,
            earthwork: f64::INFINITY,
            // Two edges of the longest heading.
            bridge_limit: t.bridge_limit.max(4.5 * steps),
            radius: t.radius.min(2.0 * steps).max(10.0),
            turn: t.turn * steps / 128.0,
            ..t
        };
        let Self { highway, major, minor, .. } = Self::default();
        Self { step, merge: MERGE * steps, highway: tier(highway), major: tier(major), minor: tier(minor) }
    }

    /// Checks the ranges for a finite domain. They are the ranges of [`check`](Self::check), except for `step` (10 to 20,000),
    /// `reach` (500 to infinity), `gamma` (1.01 to infinity, which gives the relative neighbour graph), `detour` (1.1 to 1,000),
    /// `corridor` and `bridge_limit` (up to 1,000,000), `earthwork` (1 to infinity), `slope` and `turn` (up to 10,000), and
    /// `merge` (0 to 4 steps).
    pub fn check_finite(&self) -> Result<(), RangeError> {
        Finite(self.clone()).check_ranges()
    }
}

/// Settings with the ranges of a finite domain.
#[derive(Clone)]
struct Finite(RoadSettings);

impl Ranged for Finite {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let RoadSettings { step, merge, highway: _, major: _, minor: _ } = &mut self.0;
        walk.number("step", step, STEPS.0 as f64, STEPS.1 as f64)?;
        walk.number("merge", merge, 0.0, 4.0 * *step as f64)?;
        self.0.walk_tiers(walk, |number| match number.name {
            "reach" | "gamma" | "earthwork" => (number.low, f64::INFINITY),
            "detour" => (number.low, 1_000.0),
            "corridor" | "bridge_limit" => (number.low, 1e6),
            "slope" | "turn" => (number.low, 10_000.0),
            _ => (number.low, number.high),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_in_range_for_every_step() {
        for step in [10, 128, 400, 781, 4_000, 20_000] {
            assert_eq!(RoadSettings::finite(step).check_finite(), Ok(()));
        }
        let mut s = RoadSettings::finite(400);
        (s.minor.gamma, s.major.detour) = (f64::INFINITY, 0.5);
        assert_eq!(s.check_finite().unwrap_err().field, "major.detour");
        assert_eq!(RoadSettings::finite(5).check_finite().unwrap_err().field, "step");
    }
}
