//! Layer 3: roads between settlements (Galin et al. 2011).
use crate::layer::{Cancel, LayerError, RangeError};
use crate::network::{JunctionId, Street, StreetClass, StreetId};
use crate::region::{Settlement, SettlementId, Settlements};
use crate::space::{Bounds, Origin};
use crate::terrain::Terrain;
use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Settings of roads.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RoadSettings {}

impl RoadSettings {
    /// Checks ranges.
    pub fn check(&self) -> Result<(), RangeError> {
        Ok(())
    }
}

/// A piece of road between two junctions (gates, forks, crossings, ends of bridges).
#[derive(Clone, Debug, PartialEq)]
pub struct Road {
    /// Origin that `street.line` is local to.
    pub origin: Origin,
    /// The piece, in the classes highway, major and minor.
    pub street: Street,
}

/// Where roads enter a settlement.
#[derive(Clone, Debug, PartialEq)]
pub struct Gate {
    /// The junction where the roads end and the main street begins.
    pub junction: JunctionId,
    /// Index of the gate's vertex in the settlement's outline.
    pub vertex: usize,
    /// Position, local to the settlement: that vertex.
    pub at: DVec2,
    /// Unit direction in which the widest road arrives, into the settlement.
    pub inward: DVec2,
    /// Class of the widest road that ends here.
    pub class: StreetClass,
}

/// A connection of two settlements that the proximity rule keeps.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Stable name.
    pub id: StreetId,
    /// The settlement with the lower id.
    pub from: SettlementId,
    /// The settlement with the higher id.
    pub to: SettlementId,
    /// Class tau = min(sigma, sigma).
    pub class: StreetClass,
    /// Length of the geodesic in metres.
    pub length_m: f64,
    /// Its cost, in metres of flat open ground.
    pub cost: f64,
    /// Number of bridges.
    pub bridges: usize,
    /// Number of tunnels.
    pub tunnels: usize,
}

/// All roads of a world, found by place.
pub struct Roads {}

impl Roads {
    /// Roads between `settlements` over `terrain`. `cache_bytes` bounds the memory of what is remembered.
    pub fn new(
        _settings: &RoadSettings,
        _terrain: Arc<dyn Terrain>,
        _settlements: Arc<Settlements>,
        _cache_bytes: usize,
    ) -> Self {
        Self {}
    }

    /// Pieces of road whose centre line's box overlaps `bounds` (plan metres), sorted by id.
    pub fn overlapping(&self, _bounds: Bounds, _cancel: &Cancel) -> Result<Vec<Arc<Road>>, LayerError> {
        todo!()
    }

    /// Gates of a settlement, by vertex.
    pub fn gates(&self, _settlement: &Settlement, _cancel: &Cancel) -> Result<Vec<Gate>, LayerError> {
        todo!()
    }

    /// Connections with at least one end in `bounds` (plan metres), sorted by id.
    pub fn links(&self, _bounds: Bounds, _cancel: &Cancel) -> Result<Vec<Arc<Link>>, LayerError> {
        todo!()
    }
}
