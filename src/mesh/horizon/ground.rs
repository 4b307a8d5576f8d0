//! Ground and water of a tile.

use super::massing::HorizonTown;
use super::tile::HorizonTile;
use crate::mesh::buffers::{MeshBuffers, Rgb, blend};
use crate::mesh::ground::{WATER, WATER_ALPHA, colour};
use crate::terrain::{Terrain, TerrainSample};
use glam::{DVec2, DVec3, IVec2};

/// Depth to which skirts hang, in edges of a square of ground, and more in metres.
const SKIRT: (f64, f64) = (0.4, 6.0);

/// Mean colour of the land of a town: gardens, yards and streets.
const TOWN: Rgb = [0.170, 0.175, 0.120];

/// How much of the ground of a town has that colour.
const TOWN_SHARE: f32 = 0.6;

/// The terrain at the vertices of a tile and one beyond.
pub(super) struct Land {
    tile: HorizonTile,
    chunk_size: i64,
    samples: Vec<TerrainSample>,
}

/// Vertices along an edge of a tile, one more on either side.
fn row_length(tile: HorizonTile) -> usize {
    tile.cells() + 3
}

impl Land {
    pub fn new(tile: HorizonTile, chunk_size: i64, terrain: &dyn Terrain) -> Self {
        let row = row_length(tile);
        let sample = |i: usize| {
            let at = IVec2::new((i % row) as i32 - 1, (i / row) as i32 - 1);
            terrain.sample(tile.vertex(chunk_size, at))
        };
        Self { tile, chunk_size, samples: (0..row * row).map(sample).collect() }
    }

    /// The sample at a column and row, from -1.
    fn at(&self, column: i32, row: i32) -> &TerrainSample {
        &self.samples[(row + 1) as usize * row_length(self.tile) + (column + 1) as usize]
    }

    fn step(&self) -> f64 {
        self.tile.step(self.chunk_size)
    }

    fn gradient(&self, column: i32, row: i32) -> DVec2 {
        let x = self.at(column + 1, row).height - self.at(column - 1, row).height;
        let y = self.at(column, row + 1).height - self.at(column, row - 1).height;
        DVec2::new(x, y) / (2.0 * self.step())
    }

    /// The ground with its skirts.
    pub fn ground(&self, towns: &[HorizonTown<'_>]) -> MeshBuffers {
        let mut out = MeshBuffers::default();
        let (n, step) = (self.tile.cells() as i32, self.step());
        for (row, column) in (0..=n).flat_map(|row| (0..=n).map(move |column| (row, column))) {
            let (sample, gradient) = (self.at(column, row), self.gradient(column, row));
            let plan = self.tile.vertex(self.chunk_size, IVec2::new(column, row));
            let wild = colour(sample, gradient);
            let in_town = sample.depth() <= 0.0 && towns.iter().any(|town| town.contains(plan));
            let colour = if in_town { blend(wild, TOWN, TOWN_SHARE) } else { wild };
            let at = DVec3::new(f64::from(column) * step, f64::from(row) * step, sample.height);
            out.vertex(at, DVec3::new(-gradient.x, -gradient.y, 1.0).normalize(), colour, 1.0);
        }
        let index = |column: i32, row: i32| (row * (n + 1) + column) as u32;
        for (row, column) in (0..n).flat_map(|row| (0..n).map(move |column| (row, column))) {
            let [sw, se] = [column, column + 1].map(|c| index(c, row));
            let [nw, ne] = [column, column + 1].map(|c| index(c, row + 1));
            out.indices.extend([sw, se, ne, sw, ne, nw]);
        }
        let border = (0..n).map(|i| index(i, 0)).chain((0..n).map(|i| index(n, i)));
        let border = border.chain((1..=n).rev().map(|i| index(i, n))).chain((1..=n).rev().map(|i| index(0, i)));
        let border: Vec<u32> = border.collect();
        self.hang_skirts(&mut out, &border);
        out
    }

    /// Adds walls down from a closed line of vertices, counter-clockwise, which face outwards.
    fn hang_skirts(&self, out: &mut MeshBuffers, border: &[u32]) {
        let depth = (SKIRT.0 * self.step() + SKIRT.1) as f32;
        let first = out.positions.len() as u32;
        for v in border {
            let v = *v as usize;
            let [x, y, z] = out.positions[v];
            out.positions.push([x, y - depth, z]);
            out.normals.push(out.normals[v]);
            out.colours.push(out.colours[v]);
        }
        let count = border.len() as u32;
        for i in 0..count {
            let next = (i + 1) % count;
            let (a, b) = (border[i as usize], border[next as usize]);
            out.indices.extend([a, first + i, first + next, a, first + next, b]);
        }
    }

    /// The surface of the water, in every square with ground below it at a corner.
    pub fn water(&self) -> MeshBuffers {
        let mut out = MeshBuffers::default();
        let (n, step) = (self.tile.cells() as i32, self.step());
        let mut index = vec![u32::MAX; (self.tile.cells() + 1).pow(2)];
        for (row, column) in (0..n).flat_map(|row| (0..n).map(move |column| (row, column))) {
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(c, r)| (column + c, row + r));
            if corners.iter().all(|(c, r)| self.at(*c, *r).depth() <= 0.0) {
                continue;
            }
            let [sw, se, ne, nw] = corners.map(|(c, r)| {
                let slot = &mut index[(r * (n + 1) + c) as usize];
                if *slot == u32::MAX {
                    let at = DVec2::new(f64::from(c), f64::from(r)) * step;
                    *slot = out.vertex(at.extend(self.at(c, r).water_level), DVec3::Z, WATER, WATER_ALPHA);
                }
                *slot
            });
            out.indices.extend([sw, se, ne, sw, ne, nw]);
        }
        out
    }
}
