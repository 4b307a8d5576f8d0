//! Tiles of the horizon, and which of them are seen from a place.

use crate::space::{Bounds, ChunkCoord, Origin};
use glam::{DVec2, I64Vec2, IVec2};

/// A square tile of the land: `2^level` chunks a side. Tiles of a level fill the plan, as chunks do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[cfg_attr(feature = "bevy", reflect(Debug, PartialEq, Hash, Clone))]
pub struct HorizonTile {
    /// Level, 0 to [`HorizonTile::LEVELS`]. A tile of level 0 is a quarter of one of level 1, as large as a chunk and with the same
    /// squares of ground.
    pub level: u8,
    /// Column.
    pub x: i32,
    /// Row.
    pub y: i32,
}

/// Distance, in edges of a tile, within which the tile is seen in the detail of smaller tiles.
const SPLIT: f64 = 0.65;

/// Number of squares of ground along the edge of a tile of level 1 or more.
pub(super) const CELLS: usize = 32;

impl HorizonTile {
    /// Number of levels.
    pub const LEVELS: u8 = 5;

    /// Greatest level of tiles that show roads. On larger ones, which are farther away, a road is narrower than a pixel.
    pub const ROADS: u8 = 3;

    /// The tile of level 0 in the place of a chunk.
    pub fn of_chunk(chunk: ChunkCoord) -> Self {
        Self { level: 0, x: chunk.0.x, y: chunk.0.y }
    }

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

    /// The four tiles of the level below that fill this one, which is at least of level 1.
    pub fn children(self) -> [Self; 4] {
        let (level, x, y) = (self.level - 1, 2 * self.x, 2 * self.y);
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, up)| Self { level, x: x + right, y: y + up })
    }

    /// The tile of the level above that this one lies in.
    pub fn parent(self) -> Self {
        Self { level: self.level + 1, x: self.x.div_euclid(2), y: self.y.div_euclid(2) }
    }

    /// The largest tiles that overlap a box (plan metres).
    pub fn largest_in(bounds: Bounds, chunk_size: i64) -> impl Iterator<Item = Self> {
        let [low, high] = [bounds.min, bounds.max].map(|p| Self::containing(Self::LEVELS, p, chunk_size));
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| Self { x, y, ..low }))
    }

    /// Distance in metres from a plan point to the nearest point of the tile.
    pub fn distance(self, from: DVec2, chunk_size: i64) -> f64 {
        let bounds = self.bounds(chunk_size);
        from.distance(from.clamp(bounds.min, bounds.max))
    }

    /// Distance in metres within which the tile is seen in the detail of the level below.
    pub fn split_distance(self, chunk_size: i64) -> f64 {
        SPLIT * self.size(chunk_size) as f64
    }

    /// Number of squares of ground along the edge.
    pub(super) fn cells(self) -> usize {
        if self.level == 0 { CELLS / 2 } else { CELLS }
    }

    /// Edge of a square of ground, in metres.
    pub(super) fn step(self, chunk_size: i64) -> f64 {
        self.size(chunk_size) as f64 / self.cells() as f64
    }

    /// The plan point at a column and row of the ground.
    pub(super) fn vertex(self, chunk_size: i64, at: IVec2) -> DVec2 {
        // From the plan's own lattice, so that tiles beside each other give the same bits.
        let first = IVec2::new(self.x, self.y).as_i64vec2() * self.cells() as i64;
        (first + at.as_i64vec2()).as_dvec2() * self.step(chunk_size)
    }
}

/// The tiles of level 1 and more seen from a plan point out to `far` metres, each place in one tile, sorted. The nearer, the smaller
/// they are.
pub fn horizon_tiles(from: DVec2, far: f64, chunk_size: i64) -> Vec<HorizonTile> {
    let mut out = Vec::new();
    for tile in HorizonTile::largest_in(Bounds::square(from, 2.0 * far), chunk_size) {
        collect(tile, from, far, chunk_size, &mut out);
    }
    out.sort_unstable();
    out
}

fn collect(tile: HorizonTile, from: DVec2, far: f64, chunk_size: i64, out: &mut Vec<HorizonTile>) {
    let distance = tile.distance(from, chunk_size);
    if distance > far {
        return;
    }
    if tile.level > 1 && distance < tile.split_distance(chunk_size) {
        tile.children().into_iter().for_each(|child| collect(child, from, far, chunk_size, out));
    } else {
        out.push(tile);
    }
}
