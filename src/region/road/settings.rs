//! Settings of roads.

use crate::layer::RangeError;
use crate::network::{SizeClass, StreetClass};
use serde::{Deserialize, Serialize};

/// Settings of roads, one set per class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(default, deny_unknown_fields)]
pub struct RoadSettings {
    /// Spacing in metres of the lattice that roads are searched on: 64 to 512.
    pub step: i64,
    /// Distance in metres below which roads that run beside each other merge: 0 (never) to 400.
    pub merge: f64,
    /// Roads between cities.
    pub highway: TierSettings,
    /// Roads between a town and a town or city.
    pub major: TierSettings,
    /// Roads between a village and any settlement.
    pub minor: TierSettings,
}

/// How a road crosses a highway where the ground and the surroundings allow it. Elsewhere it crosses at a junction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub enum Crossing {
    /// At a junction.
    Junction,
    /// On a bridge without a connection. Where a road turns from one to the other, at a junction.
    Bridge,
    /// On a bridge, with a ramp that connects both.
    Interchange,
}

/// Settings of one class of roads. Costs are in metres of flat open ground (Galin 2011, section 4.1).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(default, deny_unknown_fields)]
pub struct TierSettings {
    /// Greatest beeline in metres between the settlements of a pair: 500 to 60,000.
    pub reach: f64,
    /// Exponent of the proximity rule (Galin 2011, section 5): 1.01 to 20. The value 2 gives a Gabriel graph, a large value a
    /// relative neighbour graph.
    pub gamma: f64,
    /// Greatest ratio of a road's cost to its beeline: 1.1 to 3. More expensive roads are not built.
    pub detour: f64,
    /// Spacing of the coarse lattice, on which paths are searched first, in steps of the fine lattice: 1 to 8.
    #[serde(alias = "wide_step")]
    pub coarse_step: i64,
    /// Greatest distance in metres of the road from its path on the coarse lattice: 200 to 3000.
    pub corridor: f64,
    /// Extra cost per metre at the steepest slope allowed: 0 to 100. The cost grows with the square of the slope.
    pub slope: f64,
    /// Steepest slope (rise over run) in the direction of travel, between lattice points: 0.01 to 1.
    pub slope_limit: f64,
    /// Greatest difference in metres between the ground and the straight line between lattice points: 1 to 100. This much is cut
    /// or filled.
    pub earthwork: f64,
    /// Extra cost per metre of a bridge over land or shallow water: 0 to 100. It grows with the depth of the water and doubles at
    /// the greatest depth.
    pub water: f64,
    /// Greatest depth of water that is bridged, in metres: 0 to 200.
    pub depth_limit: f64,
    /// Fixed extra cost of a bridge: 0 to 10,000.
    pub bridge: f64,
    /// Greatest length of a bridge in metres: 0 to 5000. Below two steps of the lattice, only brooks are crossed.
    pub bridge_limit: f64,
    /// Extra cost per metre of a tunnel: 0 to 100.
    pub tunnel_metre: f64,
    /// Fixed extra cost of a tunnel: 0 to 10,000.
    pub tunnel: f64,
    /// Greatest length of a tunnel in metres: 0 (no tunnels) to 5000.
    pub tunnel_limit: f64,
    /// Extra cost per metre in dense wood: 0 to 20.
    pub vegetation: f64,
    /// Extra cost per metre at the centre of a settlement that the road does not serve: 0 to 100.
    pub settlement: f64,
    /// Extra cost per metre of a new road: 0 to 5. The use of an existing road of a higher class is free of it.
    pub building: f64,
    /// Extra cost per metre directly beside an existing road of a higher class: 0 to 20.
    #[serde(alias = "beside")]
    pub beside_roads: f64,
    /// Cost of a bend of 22 degrees: 0 to 1000. The cost grows with the square of the angle.
    pub turn: f64,
    /// Least radius of bends in metres, except at junctions: 10 to 1000. A bend to the next heading, whose radius is 270 m on a
    /// lattice of 128 m, is always allowed.
    pub radius: f64,
    /// How roads of the class cross highways.
    #[serde(alias = "over_highways")]
    pub highway_crossings: Crossing,
    /// Greatest random extra cost per metre, which varies from place to place independently of the terrain: 0 to 1. It makes roads
    /// wind a little and share stretches.
    #[serde(alias = "rough")]
    pub roughness: f64,
}

impl Default for TierSettings {
    fn default() -> Self {
        Self {
            reach: 4_900.0,
            gamma: 2.2,
            detour: 1.7,
            coarse_step: 2,
            corridor: 600.0,
            slope: 2.5,
            slope_limit: 0.14,
            earthwork: 14.0,
            water: 5.0,
            depth_limit: 10.0,
            bridge: 150.0,
            bridge_limit: 600.0,
            tunnel_metre: 8.0,
            tunnel: 400.0,
            tunnel_limit: 0.0,
            vegetation: 0.2,
            settlement: 4.0,
            building: 0.5,
            beside_roads: 1.0,
            turn: 4.0,
            radius: 50.0,
            highway_crossings: Crossing::Bridge,
            roughness: 0.08,
        }
    }
}

impl Default for RoadSettings {
    fn default() -> Self {
        let minor = TierSettings::default();
        let major = TierSettings {
            reach: 11_500.0,
            gamma: 2.4,
            detour: 1.6,
            corridor: 800.0,
            slope: 3.0,
            slope_limit: 0.11,
            bridge_limit: 700.0,
            tunnel_limit: 700.0,
            turn: 5.0,
            radius: 120.0,
            highway_crossings: Crossing::Interchange,
            ..minor.clone()
        };
        let highway = TierSettings {
            reach: 26_000.0,
            gamma: 2.4,
            detour: 1.5,
            coarse_step: 4,
            corridor: 1_000.0,
            slope: 4.0,
            slope_limit: 0.08,
            earthwork: 20.0,
            water: 4.0,
            depth_limit: 15.0,
            bridge_limit: 1_000.0,
            tunnel_metre: 5.0,
            tunnel_limit: 1_600.0,
            turn: 6.0,
            radius: 250.0,
            highway_crossings: Crossing::Interchange,
            ..minor.clone()
        };
        Self { step: 128, merge: 275.0, highway, major, minor }
    }
}

impl TierSettings {
    fn check(&self) -> Result<(), RangeError> {
        let range = RangeError::check;
        range("reach", self.reach, 500.0, 60_000.0)?;
        range("gamma", self.gamma, 1.01, 20.0)?;
        range("detour", self.detour, 1.1, 3.0)?;
        range("coarse_step", self.coarse_step as f64, 1.0, 8.0)?;
        range("corridor", self.corridor, 200.0, 3000.0)?;
        range("slope", self.slope, 0.0, 100.0)?;
        range("slope_limit", self.slope_limit, 0.01, 1.0)?;
        range("earthwork", self.earthwork, 1.0, 100.0)?;
        range("water", self.water, 0.0, 100.0)?;
        range("depth_limit", self.depth_limit, 0.0, 200.0)?;
        range("bridge", self.bridge, 0.0, 10_000.0)?;
        range("bridge_limit", self.bridge_limit, 0.0, 5000.0)?;
        range("tunnel_metre", self.tunnel_metre, 0.0, 100.0)?;
        range("tunnel", self.tunnel, 0.0, 10_000.0)?;
        range("tunnel_limit", self.tunnel_limit, 0.0, 5000.0)?;
        range("vegetation", self.vegetation, 0.0, 20.0)?;
        range("settlement", self.settlement, 0.0, 100.0)?;
        range("building", self.building, 0.0, 5.0)?;
        range("beside_roads", self.beside_roads, 0.0, 20.0)?;
        range("turn", self.turn, 0.0, 1000.0)?;
        range("radius", self.radius, 10.0, 1000.0)?;
        range("roughness", self.roughness, 0.0, 1.0)
    }

    /// Distance in metres from any point of a road of this class, within which one of its two settlements has its centre. A path
    /// on the coarse lattice is at most `detour` times as long as the distance on the stencil, which is at most 1.03 beelines,
    /// and it begins half a cell from the centre. The route keeps within the corridor around that path.
    pub(super) fn padding(&self, step: i64) -> f64 {
        let cell = (step * self.coarse_step) as f64;
        self.detour * (0.515 * self.reach + cell) + cell + self.corridor
    }
}

impl RoadSettings {
    /// Checks that every value lies in its range.
    ///
    /// # Errors
    ///
    /// Names the first field whose value is out of range or NaN.
    pub fn check(&self) -> Result<(), RangeError> {
        RangeError::check("step", self.step as f64, 64.0, 512.0)?;
        RangeError::check("merge", self.merge, 0.0, 400.0)?;
        self.highway.check().map_err(|e| e.within("highway"))?;
        self.major.check().map_err(|e| e.within("major"))?;
        self.minor.check().map_err(|e| e.within("minor"))
    }

    /// Settings of the roads of a street class.
    pub(super) fn class(&self, class: StreetClass) -> &TierSettings {
        match class {
            StreetClass::Highway => &self.highway,
            StreetClass::Major => &self.major,
            _ => &self.minor,
        }
    }

    /// Settings of the roads of a tier.
    pub(super) fn tier(&self, tier: SizeClass) -> &TierSettings {
        match tier {
            SizeClass::City => &self.highway,
            SizeClass::Town => &self.major,
            SizeClass::Village => &self.minor,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_in_range_and_errors_name_the_field() {
        assert_eq!(RoadSettings::default().check(), Ok(()));
        let mut s = RoadSettings::default();
        s.major.gamma = f64::NAN;
        assert_eq!(s.check().unwrap_err().field, "major.gamma");
    }
}
