//! The ground as it is drawn: triangles over a grid.

use crate::layer::{LayerCache, Weigh};
use crate::terrain::{Terrain, TerrainSample};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Distance between the vertices of the drawn ground, in metres. They lie at the multiples of it.
pub const GROUND_STEP: f64 = 8.0;

/// Heights of the drawn ground at plan points. Each square of its grid is two triangles, split from the square's south-west to its
/// north-east corner.
pub struct DrawnGround<'a> {
    /// Height at a vertex, given in steps from the plan's origin.
    vertex: Box<dyn FnMut(I64Vec2) -> f64 + 'a>,
}

impl<'a> DrawnGround<'a> {
    /// The drawn ground of a terrain. Vertices are sampled once each.
    pub fn new(terrain: &'a dyn Terrain) -> Self {
        let (mut scan, mut known) = (terrain.scan_ground(), BTreeMap::new());
        let vertex =
            move |at: I64Vec2| *known.entry((at.x, at.y)).or_insert_with(|| scan(at.as_dvec2() * GROUND_STEP).height);
        Self { vertex: Box::new(vertex) }
    }

    /// The drawn ground of a terrain, raised to `freeboard` metres above the water where it lies lower.
    pub fn dry(terrain: &'a dyn Terrain, freeboard: f64) -> Self {
        let mut scan = terrain.scan_ground();
        Self { vertex: Box::new(move |at| dry_height(scan(at.as_dvec2() * GROUND_STEP), freeboard)) }
    }

    /// Height at a plan point, in metres.
    pub fn height(&mut self, p: DVec2) -> f64 {
        let square = (p / GROUND_STEP).floor();
        let corners = [I64Vec2::ZERO, I64Vec2::X, I64Vec2::Y, I64Vec2::ONE];
        height_in_square(corners.map(|corner| (self.vertex)(square.as_i64vec2() + corner)), p / GROUND_STEP - square)
    }
}

fn dry_height(sample: TerrainSample, freeboard: f64) -> f64 {
    sample.height.max(sample.water_level + freeboard)
}

/// Height in a square of the grid at `f` (0 to 1 each way) from its corners SW, SE, NW, NE.
pub(crate) fn height_in_square([sw, se, nw, ne]: [f64; 4], f: DVec2) -> f64 {
    if f.x >= f.y { sw + (se - sw) * f.x + (ne - se) * f.y } else { sw + (nw - sw) * f.y + (ne - nw) * f.x }
}

/// Vertices along an edge of a tile.
const TILE: i64 = 16;

/// The vertices of the drawn ground, kept in tiles, so that all that stands on the ground shares its samples.
pub struct GroundTiles {
    terrain: Arc<dyn Terrain>,
    tiles: LayerCache<(i64, i64), Tile>,
}

struct Tile(Vec<TerrainSample>);

impl Weigh for Tile {
    fn bytes(&self) -> usize {
        self.0.len() * size_of::<TerrainSample>() + 24
    }
}

impl GroundTiles {
    /// The tiles of a terrain, within about `bytes` bytes of memory.
    pub fn new(terrain: Arc<dyn Terrain>, bytes: usize) -> Self {
        Self { terrain, tiles: LayerCache::new(bytes) }
    }

    /// The ground.
    pub fn terrain(&self) -> &Arc<dyn Terrain> {
        &self.terrain
    }

    /// Reads samples at vertices, given in steps from the plan's origin.
    pub fn vertices(&self) -> impl FnMut(I64Vec2) -> TerrainSample + '_ {
        let mut last: Option<((i64, i64), Arc<Tile>)> = None;
        move |at| {
            let (key, within) = ((at.x.div_euclid(TILE), at.y.div_euclid(TILE)), at.rem_euclid(I64Vec2::splat(TILE)));
            let tile = match last.take().filter(|(known, _)| *known == key) {
                Some((_, tile)) => tile,
                None => self.tile(key),
            };
            last.insert((key, tile)).1.0[(within.y * TILE + within.x) as usize]
        }
    }

    /// Heights of the drawn ground.
    pub fn drawn(&self) -> DrawnGround<'_> {
        let mut sample = self.vertices();
        DrawnGround { vertex: Box::new(move |at| sample(at).height) }
    }

    /// Heights of the drawn ground, raised to `freeboard` metres above the water where it lies lower.
    pub fn dry(&self, freeboard: f64) -> DrawnGround<'_> {
        let mut sample = self.vertices();
        DrawnGround { vertex: Box::new(move |at| dry_height(sample(at), freeboard)) }
    }

    fn tile(&self, key: (i64, i64)) -> Arc<Tile> {
        let make = || {
            let (corner, mut scan) = (I64Vec2::from(key) * TILE, self.terrain.scan());
            let places = (0..TILE * TILE).map(|i| corner + I64Vec2::new(i % TILE, i / TILE));
            Tile(places.map(|at| scan(at.as_dvec2() * GROUND_STEP)).collect())
        };
        self.tiles.get(&key, || Ok(make())).unwrap_or_else(|_| Arc::new(make()))
    }

    /// Bytes that the tiles hold now.
    pub fn bytes(&self) -> u64 {
        self.tiles.bytes()
    }

    /// Forgets all tiles.
    pub fn clear(&self) {
        self.tiles.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Countryside;

    #[test]
    fn tiles_are_the_terrain_at_every_vertex() {
        let terrain: Arc<dyn Terrain> = Arc::new(Countryside { flat: false, river: 40.0 });
        // Room for a few tiles only, so that some are made again.
        let tiles = GroundTiles::new(terrain.clone(), 40_000);
        let (mut vertex, mut drawn, mut direct) = (tiles.vertices(), tiles.drawn(), DrawnGround::new(&*terrain));
        for k in 0..2000i64 {
            let at = I64Vec2::new((k * 37) % 101 - 50, (k * 53) % 89 - 44);
            assert_eq!(vertex(at), terrain.sample(at.as_dvec2() * GROUND_STEP));
            let p = at.as_dvec2() * 5.3;
            assert_eq!(drawn.height(p), direct.height(p));
        }
    }
}
