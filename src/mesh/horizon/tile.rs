//! Tiles of the horizon, and which of them are seen from a place.

use crate::space::{Bounds, Origin};
use glam::{DVec2, I64Vec2, IVec2};

/// A square tile of the land: `2^level` chunks a side. Tiles of a level fill the plan, as chunks do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct HorizonTile {
    /// Level, 1 to [`HorizonTile::LEVELS`].
    pub level: u8,
    /// Column.
    pub x: i32,
    /// Row.
    pub y: i32,
}

/// Distance, in edges of a tile, within which the tile is seen in the detail of smaller tiles.
const SPLIT: f64 = 0.75;

impl HorizonTile {
    /// Number of levels.
    pub const LEVELS: u8 = 5;

    /// The tile of a level that holds a plan point, for chunks of edge `chunk_size` metres.
    pub fn containing(level: u8, plan: DVec2, chunk_size: i64) -> Self {
        let at = (plan / (chunk_size << level) as f64).floor().as_ivec2();
        Self { level, x: at.x, y: at.y }
    }

    /// Edge in metres.
    pub fn size(self, chunk_size: i64) -> i64 {
        chunk_size << self.level
    }

    /// South-west corner.
    pub fn origin(self, chunk_size: i64) -> Origin {
        let size = self.size(chunk_size);
        Origin(I64Vec2::new(i64::from(self.x), i64::from(self.y)) * size)
    }

    /// The square, in plan metres.
    pub fn bounds(self, chunk_size: i64) -> Bounds {
        let corner = self.origin(chunk_size).plan();
        Bounds::new(corner, corner + self.size(chunk_size) as f64)
    }

    /// The four tiles of the level below that fill this one; of level 0, which are chunks, for a tile of level 1.
    fn children(self) -> [Self; 4] {
        let (level, x, y) = (self.level - 1, 2 * self.x, 2 * self.y);
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, up)| Self { level, x: x + right, y: y + up })
    }
}

/// The tiles seen from a plan point out to `far` metres, each place in one tile, sorted. The nearer, the smaller they are.
pub fn horizon_tiles(from: DVec2, far: f64, chunk_size: i64) -> Vec<HorizonTile> {
    let mut out = Vec::new();
    let corner = |by: f64| HorizonTile::containing(HorizonTile::LEVELS, from + by, chunk_size);
    let (low, high) = (corner(-far), corner(far));
    for (x, y) in (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| (x, y))) {
        collect(HorizonTile { level: HorizonTile::LEVELS, x, y }, from, far, chunk_size, &mut out);
    }
    out.sort_unstable();
    out
}

fn collect(tile: HorizonTile, from: DVec2, far: f64, chunk_size: i64, out: &mut Vec<HorizonTile>) {
    let bounds = tile.bounds(chunk_size);
    let distance = from.distance(from.clamp(bounds.min, bounds.max));
    if distance > far {
        return;
    }
    if tile.level > 1 && distance < SPLIT * tile.size(chunk_size) as f64 {
        tile.children().into_iter().for_each(|child| collect(child, from, far, chunk_size, out));
    } else {
        out.push(tile);
    }
}

/// Number of squares of ground along the edge of a tile.
pub(super) const CELLS: usize = 32;

/// Edge of a square of ground, in metres.
pub(super) fn step(tile: HorizonTile, chunk_size: i64) -> f64 {
    tile.size(chunk_size) as f64 / CELLS as f64
}

/// The plan point at a column and row of a tile's ground.
pub(super) fn vertex(tile: HorizonTile, chunk_size: i64, at: IVec2) -> DVec2 {
    // From the plan's own lattice, so that tiles beside each other give the same bits.
    let first = IVec2::new(tile.x, tile.y).as_i64vec2() * CELLS as i64;
    (first + at.as_i64vec2()).as_dvec2() * step(tile, chunk_size)
}
