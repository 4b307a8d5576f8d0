//! Samples of the terrain at lattice nodes, remembered tile by tile.

use super::lattice::node_at;
use super::window::Window;
use crate::layer::{LayerCache, LayerError, Weigh};
use crate::terrain::{Terrain, TerrainSample};
use glam::I64Vec2;
use std::sync::Arc;

/// Edge length of a tile of samples, in nodes.
const TILE: i64 = 8;

/// The ground at a node, as a road sees it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ground {
    /// Height of the ground or the water, whichever is higher.
    pub surface: f32,
    pub depth: f32,
    pub vegetation: f32,
}

impl Ground {
    pub fn of(s: &TerrainSample) -> Self {
        Self { surface: s.height.max(s.water_level) as f32, depth: s.depth() as f32, vegetation: s.vegetation as f32 }
    }
}

/// Samples of 8 by 8 nodes.
pub(super) struct SampleTile([Ground; (TILE * TILE) as usize]);

impl Weigh for SampleTile {
    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}

/// Key of a tile of samples: the spacing of its nodes, its column and its row.
pub(super) type TileKey = (i64, i64, i64);

/// Samples at the nodes of a window, fetched tile by tile when they are needed.
pub(super) struct Samples<'a> {
    cache: &'a LayerCache<TileKey, SampleTile>,
    terrain: &'a dyn Terrain,
    step: i64,
    first: I64Vec2,
    columns: usize,
    tiles: Vec<Option<Arc<SampleTile>>>,
}

impl<'a> Samples<'a> {
    pub fn new(
        cache: &'a LayerCache<TileKey, SampleTile>,
        terrain: &'a dyn Terrain,
        step: i64,
        window: &Window,
    ) -> Self {
        let tile = I64Vec2::splat(TILE);
        let first = window.min.div_euclid(tile);
        let count = (window.min + window.size - 1).div_euclid(tile) - first + 1;
        let tiles = vec![None; (count.x * count.y).max(0) as usize];
        Self { cache, terrain, step, first, columns: count.x as usize, tiles }
    }

    /// The ground at a node of the window.
    pub fn at(&mut self, node: I64Vec2) -> Result<Ground, LayerError> {
        let tile = node.div_euclid(I64Vec2::splat(TILE));
        let inside = node - tile * TILE;
        let local = tile - self.first;
        let slot = &mut self.tiles[local.y as usize * self.columns + local.x as usize];
        let held = match slot {
            Some(held) => held,
            None => {
                let (terrain, step) = (self.terrain, self.step);
                let made = self.cache.get(&(step, tile.x, tile.y), || Ok(sample_tile(terrain, step, tile)))?;
                slot.insert(made)
            }
        };
        Ok(held.0[(inside.y * TILE + inside.x) as usize])
    }
}

fn sample_tile(terrain: &dyn Terrain, step: i64, tile: I64Vec2) -> SampleTile {
    let mut out = [Ground::default(); (TILE * TILE) as usize];
    let mut scan = terrain.scan();
    for (i, ground) in out.iter_mut().enumerate() {
        let node = tile * TILE + I64Vec2::new(i as i64 % TILE, i as i64 / TILE);
        *ground = Ground::of(&scan(node_at(node, step)));
    }
    SampleTile(out)
}
