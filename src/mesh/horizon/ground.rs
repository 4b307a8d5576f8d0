//! Ground and water of a tile.

use super::massing::HorizonTown;
use super::tile::HorizonTile;
use crate::mesh::buffers::{MeshBuffers, Rgb, blend};
use crate::mesh::ground::{WATER, WATER_ALPHA, colour, texture};
use crate::terrain::{Scan, Terrain, TerrainSample};
use glam::{DVec2, DVec3, IVec2};

/// Depth to which skirts hang, in edges of a square of ground, and more in metres.
const SKIRT: (f64, f64) = (0.4, 6.0);

/// Mean colour of the land of a town: gardens, yards and streets.
const TOWN: Rgb = [0.170, 0.175, 0.120];

/// How much of the ground of a town has that colour.
const TOWN_SHARE: f32 = 0.6;

/// Height above the water, in metres, above which no water is looked for between vertices.
const DRY: f64 = 10.0;

/// Height above the water, in metres, from which the ground has the colour of what grows there.
const NO_SAND: f64 = 2.0;

/// Points along each side of the square around a vertex at which water is looked for.
const PROBES: i32 = 4;

/// Colour of water too narrow to be drawn, as it looks over its bed.
const STREAM: Rgb = [0.038, 0.101, 0.138];

/// The land around a vertex.
#[derive(Clone, Copy)]
struct Vertex {
    sample: TerrainSample,
    /// Share of the square around the vertex that lies under water, if the vertex itself is dry.
    stream: f32,
}

/// The terrain at the vertices of a tile and one beyond.
///
/// A vertex stands for the square around it. It is under water if most of the square is. Elsewhere water only colours the ground:
/// a river much narrower than the squares would come and go between them.
pub(super) struct Land {
    tile: HorizonTile,
    chunk_size: i64,
    vertices: Vec<Vertex>,
}

/// Vertices along an edge of a tile, one more on either side.
fn row_length(tile: HorizonTile) -> usize {
    tile.cells() + 3
}

/// The vertex at a plan point, for squares of edge `step` metres.
fn vertex(scan: &mut Scan<'_>, plan: DVec2, step: f64) -> Vertex {
    let sample = scan(plan);
    if sample.height - sample.water_level > DRY {
        return Vertex { sample, stream: 0.0 };
    }
    let mut sums = [(0u32, TerrainSample { height: 0.0, water_level: 0.0, vegetation: 0.0 }); 2];
    for (row, column) in (0..PROBES).flat_map(|row| (0..PROBES).map(move |column| (row, column))) {
        let by = DVec2::new(f64::from(column), f64::from(row)) - f64::from(PROBES - 1) / 2.0;
        let probe = scan(plan + by * (step / f64::from(PROBES)));
        let (count, sum) = &mut sums[usize::from(probe.depth() > 0.0)];
        *count += 1;
        sum.height += probe.height;
        sum.water_level += probe.water_level;
        sum.vegetation += probe.vegetation;
    }
    let wet = sums[1].0 as f32 / (PROBES * PROBES) as f32;
    let (count, sum) = sums[usize::from(wet > 0.5)];
    let mean = |sum: f64| sum / f64::from(count);
    let sample = TerrainSample {
        height: mean(sum.height),
        water_level: mean(sum.water_level),
        vegetation: mean(sum.vegetation),
    };
    Vertex { sample, stream: if wet > 0.5 { 0.0 } else { wet } }
}

impl Land {
    pub fn new(tile: HorizonTile, chunk_size: i64, terrain: &dyn Terrain) -> Self {
        let (row, step) = (row_length(tile), tile.step(chunk_size));
        let mut scan = terrain.scan();
        let vertex = |i: usize| {
            let at = IVec2::new((i % row) as i32 - 1, (i / row) as i32 - 1);
            vertex(&mut scan, tile.vertex(chunk_size, at), step)
        };
        Self { tile, chunk_size, vertices: (0..row * row).map(vertex).collect() }
    }

    /// The vertex at a column and row, from -1.
    fn vertex(&self, column: i32, row: i32) -> &Vertex {
        &self.vertices[(row + 1) as usize * row_length(self.tile) + (column + 1) as usize]
    }

    /// The sample at a column and row, from -1.
    fn at(&self, column: i32, row: i32) -> &TerrainSample {
        &self.vertex(column, row).sample
    }

    /// Edge of a square of ground, in metres.
    pub fn step(&self) -> f64 {
        self.tile.step(self.chunk_size)
    }

    /// Edge of the tile, in metres.
    pub fn size(&self) -> f64 {
        self.tile.size(self.chunk_size) as f64
    }

    /// South-west corner of the tile, in plan metres.
    pub fn corner(&self) -> DVec2 {
        self.tile.origin(self.chunk_size).plan()
    }

    /// The ground and the water as they are drawn at a point, in metres from the corner. A point outside counts as the nearest
    /// one inside. The vegetation is of the square's south-west corner.
    pub fn surface(&self, local: DVec2) -> TerrainSample {
        let at = (local / self.step()).clamp(DVec2::ZERO, DVec2::splat(self.tile.cells() as f64));
        let square = at.floor().min(DVec2::splat(self.tile.cells() as f64 - 1.0));
        let (t, corner) = (at - square, square.as_ivec2());
        let [sw, se, nw, ne] = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(c, r)| self.at(corner.x + c, corner.y + r));
        let of = |value: fn(&TerrainSample) -> f64| {
            let [sw, se, nw, ne] = [sw, se, nw, ne].map(value);
            match t.x > t.y {
                true => sw + (se - sw) * t.x + (ne - se) * t.y,
                false => sw + (ne - nw) * t.x + (nw - sw) * t.y,
            }
        };
        TerrainSample { height: of(|s| s.height), water_level: of(|s| s.water_level), vegetation: sw.vegetation }
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
            let (Vertex { sample, stream }, gradient) = (self.vertex(column, row), self.gradient(column, row));
            let plan = self.tile.vertex(self.chunk_size, IVec2::new(column, row));
            // From afar no sand shows along the water: between vertices it would be far wider than it is.
            let dry = TerrainSample { height: sample.height.max(sample.water_level + NO_SAND), ..*sample };
            let land = if sample.depth() > 0.0 { sample } else { &dry };
            let wild = blend(colour(land, gradient), STREAM, *stream);
            let in_town = sample.depth() <= 0.0 && towns.iter().any(|town| town.contains(plan));
            let colour = if in_town { blend(wild, TOWN, TOWN_SHARE) } else { wild };
            let at = DVec3::new(f64::from(column) * step, f64::from(row) * step, sample.height);
            out.coloured(at, DVec3::new(-gradient.x, -gradient.y, 1.0).normalize(), colour, texture(land));
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
                    *slot = out.coloured(at.extend(self.at(c, r).water_level), DVec3::Z, WATER, WATER_ALPHA);
                }
                *slot
            });
            out.indices.extend([sw, se, ne, sw, ne, nw]);
        }
        out
    }
}
