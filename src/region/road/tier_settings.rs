//! Settings of one class of roads, and what a file says of them.

use super::crossing::Crossing;
use super::given::Given;
use crate::layer::{RangeError, Walk};
use serde::{Deserialize, Serialize};

/// How much steeper a way may be, and how much deeper cut, that is tried where a settlement would get no road.
const STEEPER: f64 = 1.6;
/// Greatest depth of water, and greatest length of a bridge and of a tunnel there, in metres, if the class allows less.
const COSTLIER_DEPTH: f64 = 15.0;
const COSTLIER_BRIDGE: f64 = 1_000.0;
const COSTLIER_TUNNEL: f64 = 1_600.0;

/// Shows a number of a class to a walk, with a range.
type WalkNumber = fn(&mut TierSettings, &mut Walk<'_>, (f64, f64)) -> Result<(), RangeError>;

/// A number of [`TierSettings`] with its range.
pub(super) struct TierNumber {
    pub name: &'static str,
    pub low: f64,
    pub high: f64,
    walk: WalkNumber,
}

/// Declares the fields once, for the settings, for what a file may say of them, and for their ranges.
macro_rules! tier_settings {
    (
        numbers { $($(#[$of_number:meta])* $number:ident: $kind:ident, $low:literal to $high:literal;)* }
        words { $($(#[$of_word:meta])* $word:ident: $type:ty;)* }
    ) => {
        /// Settings of one class of roads. Costs are in metres of flat open ground (Galin 2011, section 4.1).
        ///
        /// There is no default for all classes: [`RoadSettings::default`](super::RoadSettings::default) has one for each.
        #[derive(Clone, Debug, PartialEq, Serialize)]
        #[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
        pub struct TierSettings {
            $($(#[$of_number])* pub $number: $kind,)*
            $($(#[$of_word])* pub $word: $type,)*
        }

        /// What a file says of one class of roads.
        #[derive(Clone, Debug, Default, PartialEq, Deserialize)]
        #[serde(default, deny_unknown_fields, rename = "TierSettings")]
        pub(super) struct TierOverrides {
            $($(#[$of_number])* $number: Given<$kind>,)*
            $($(#[$of_word])* $word: Given<$type>,)*
        }

        impl TierOverrides {
            /// These settings with what is given in their place.
            pub fn over(&self, base: TierSettings) -> TierSettings {
                TierSettings {
                    $($number: self.$number.or(base.$number),)*
                    $($word: self.$word.or(base.$word),)*
                }
            }
        }

        /// All numbers of [`TierSettings`].
        const NUMBERS: &[TierNumber] = &[$(TierNumber {
            name: stringify!($number),
            low: $low,
            high: $high,
            walk: |t, walk, (low, high)| walk.number(stringify!($number), &mut t.$number, low, high),
        }),*];

        impl TierSettings {
            /// Walks over what is no number.
            fn walk_words(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
                $(walk.choice(stringify!($word), &mut self.$word)?;)*
                Ok(())
            }
        }
    };
}

tier_settings! {
    numbers {
        /// Greatest beeline in metres between the settlements of a pair: 500 to 60,000.
        reach: f64, 500.0 to 60_000.0;
        /// Exponent of the proximity rule (Galin 2011, section 5): 1.01 to 20. The value 2 gives a Gabriel graph, a large value a
        /// relative neighbour graph.
        gamma: f64, 1.01 to 20.0;
        /// Greatest ratio of a road's cost to its beeline: 1.1 to 3. More expensive roads are not built.
        detour: f64, 1.1 to 3.0;
        /// Spacing of the coarse lattice, on which paths are searched first, in steps of the fine lattice: 1 to 8.
        #[serde(alias = "wide_step")]
        coarse_step: i64, 1.0 to 8.0;
        /// Greatest distance in metres of the road from its path on the coarse lattice: 200 to 3000.
        corridor: f64, 200.0 to 3000.0;
        /// Extra cost per metre at the steepest slope allowed: 0 to 100. The cost grows with the square of the slope.
        slope: f64, 0.0 to 100.0;
        /// Steepest slope (rise over run) in the direction of travel, between lattice points: 0.01 to 1.
        slope_limit: f64, 0.01 to 1.0;
        /// Greatest difference in metres between the ground and the straight line between lattice points: 1 to 100. This much is
        /// cut or filled.
        earthwork: f64, 1.0 to 100.0;
        /// Extra cost per metre of a bridge over land or shallow water: 0 to 100. It grows with the depth of the water and
        /// doubles at the greatest depth.
        water: f64, 0.0 to 100.0;
        /// Greatest depth of water that is bridged, in metres: 0 to 200.
        depth_limit: f64, 0.0 to 200.0;
        /// Fixed extra cost of a bridge: 0 to 10,000.
        bridge: f64, 0.0 to 10_000.0;
        /// Greatest length of a bridge in metres: 0 to 5000. Below two steps of the lattice, only brooks are crossed.
        bridge_limit: f64, 0.0 to 5000.0;
        /// Extra cost per metre of a tunnel: 0 to 100.
        tunnel_metre: f64, 0.0 to 100.0;
        /// Fixed extra cost of a tunnel: 0 to 10,000.
        tunnel: f64, 0.0 to 10_000.0;
        /// Greatest length of a tunnel in metres: 0 (no tunnels) to 5000.
        tunnel_limit: f64, 0.0 to 5000.0;
        /// Extra cost per metre in dense wood: 0 to 20.
        vegetation: f64, 0.0 to 20.0;
        /// Extra cost per metre at the centre of a settlement that the road does not serve: 0 to 100.
        settlement: f64, 0.0 to 100.0;
        /// Extra cost per metre of a new road: 0 to 5. The use of an existing road of a higher class is free of it.
        building: f64, 0.0 to 5.0;
        /// Extra cost per metre directly beside an existing road of a higher class: 0 to 20.
        #[serde(alias = "beside")]
        beside_roads: f64, 0.0 to 20.0;
        /// Cost of a bend of 22 degrees: 0 to 1000. The cost grows with the square of the angle.
        turn: f64, 0.0 to 1000.0;
        /// Least radius of bends in metres, except at junctions: 10 to 1000. A bend to the next heading, whose radius is 270 m on
        /// a lattice of 128 m, is always allowed.
        radius: f64, 10.0 to 1000.0;
        /// Greatest random extra cost per metre, which varies from place to place independently of the terrain: 0 to 1. It makes
        /// roads wind a little and share stretches.
        #[serde(alias = "rough")]
        roughness: f64, 0.0 to 1.0;
    }
    words {
        /// Whether the roads are toll roads. Roads of other classes then join them only in settlements, at interchanges and
        /// where a crossing stays a junction; they do not run along them or merge with them (Galin 2011, section 6).
        toll: bool;
        /// How roads of the class cross highways.
        #[serde(alias = "over_highways")]
        highway_crossings: Crossing;
    }
}

impl TierSettings {
    /// The default settings of minor roads.
    pub(super) fn minor() -> Self {
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
            toll: false,
            roughness: 0.08,
        }
    }

    /// The default settings of major roads.
    pub(super) fn major() -> Self {
        Self {
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
            highway_crossings: Crossing::Diamond,
            ..Self::minor()
        }
    }

    /// The default settings of highways.
    pub(super) fn highway() -> Self {
        Self {
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
            highway_crossings: Crossing::Diamond,
            ..Self::minor()
        }
    }

    /// The settings of a way that is tried only where a settlement would get no road: steeper, cut deeper, over wider water and
    /// through longer tunnels. Slopes that usual roads may have cost the same. Roads reach no farther.
    pub(super) fn costlier(&self) -> Self {
        Self {
            slope: self.slope * STEEPER * STEEPER,
            slope_limit: self.slope_limit * STEEPER,
            earthwork: self.earthwork * STEEPER,
            depth_limit: self.depth_limit.max(COSTLIER_DEPTH),
            bridge_limit: self.bridge_limit.max(COSTLIER_BRIDGE),
            tunnel_limit: self.tunnel_limit.max(COSTLIER_TUNNEL),
            ..self.clone()
        }
    }

    /// Walks over all fields; `range` may widen the range of a number.
    pub(super) fn walk(
        &mut self,
        walk: &mut Walk<'_>,
        range: impl Fn(&TierNumber) -> (f64, f64),
    ) -> Result<(), RangeError> {
        NUMBERS.iter().try_for_each(|number| (number.walk)(self, walk, range(number)))?;
        self.walk_words(walk)
    }

    /// Greatest sum of the distances in metres from a point of a road to both of its settlements, which are `length` apart: both
    /// lie on an ellipse around each point.
    pub(super) fn longest(&self, step: i64, length: f64) -> f64 {
        let cell = (step * self.coarse_step) as f64;
        1.03 * self.detour * (length + 2.0 * cell) + 2.0 * self.corridor
    }

    /// Distance in metres from a place beyond which no settlement has a road of this class that passes there: both ends of a
    /// road are at most the reach apart.
    pub(super) fn listing_padding(&self, step: i64) -> f64 {
        (self.longest(step, self.reach) + self.reach) / 2.0
    }

    /// Distance in metres from any point of a road of this class, within which one of its two settlements has its centre. A path
    /// on the coarse lattice is at most `detour` times as long as the distance on the stencil, which is at most 1.03 beelines,
    /// and it begins half a cell from the centre. The route keeps within the corridor around that path.
    pub(super) fn padding(&self, step: i64) -> f64 {
        let cell = (step * self.coarse_step) as f64;
        self.detour * (0.515 * self.reach + cell) + cell + self.corridor
    }
}
