//! The face of the generator, layers 1 to 9.

mod area;
mod assets;
mod settings;

pub use area::{Area, Owned};
pub use assets::WorldAssets;
pub use settings::{CacheSettings, Settings};

use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError, RangeError};
use crate::network::Street;
use crate::region::{Roads, Settlement, Settlements};
use crate::space::{Bounds, ChunkCoord, Origin, Seed};
use crate::terrain::Terrain;
use crate::town::Town;
use glam::DVec2;
use std::sync::Arc;

/// An endless world, a pure function of seed, settings and assets. Cheap to clone; clones share their caches.
#[derive(Clone)]
pub struct World {
    #[allow(dead_code)]
    inner: Arc<Inner>,
}

struct Inner {}

/// The street nearest to a point.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestStreet {
    /// The street, local to `origin`.
    pub street: Street,
    /// Origin of its line.
    pub origin: Origin,
    /// Nearest point of its centre line, in plan metres.
    pub at: DVec2,
    /// Distance to that point in metres.
    pub distance: f64,
}

impl World {
    /// A world on the default terrain. Fails on settings outside their ranges, and on styles that the settings name and
    /// the assets lack.
    pub fn new(_seed: Seed, _settings: Settings, _assets: WorldAssets) -> Result<Self, RangeError> {
        todo!()
    }

    /// Settings it was made with.
    pub fn settings(&self) -> &Settings {
        todo!()
    }

    /// The seed it was made with.
    pub fn seed(&self) -> Seed {
        todo!()
    }

    /// The ground.
    pub fn terrain(&self) -> &Arc<dyn Terrain> {
        todo!()
    }

    /// Its settlements.
    pub fn settlements(&self) -> &Settlements {
        todo!()
    }

    /// Its roads.
    pub fn roads(&self) -> &Roads {
        todo!()
    }

    /// Main streets and main cells of a settlement.
    pub fn town(&self, _settlement: &Arc<Settlement>, _cancel: &Cancel) -> Result<Arc<Town>, LayerError> {
        todo!()
    }

    /// What a chunk owns.
    pub fn chunk(&self, _coord: ChunkCoord, _cancel: &Cancel) -> Result<Arc<Chunk>, LayerError> {
        todo!()
    }

    /// Everything that overlaps a box (plan metres), streets whole and with both their junctions.
    pub fn area(&self, _bounds: Bounds, _cancel: &Cancel) -> Result<Area, LayerError> {
        todo!()
    }

    /// Height of the drawn ground at a plan point, in metres.
    pub fn height_at(&self, _p: DVec2) -> f64 {
        todo!()
    }

    /// The settlement whose outline holds a plan point.
    pub fn settlement_at(&self, _p: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
        todo!()
    }

    /// The street nearest to a plan point, within `reach` metres.
    pub fn nearest_street(
        &self,
        _p: DVec2,
        _reach: f64,
        _cancel: &Cancel,
    ) -> Result<Option<NearestStreet>, LayerError> {
        todo!()
    }
}
