//! The ground and the water on it.

use crate::chunk::Chunk;
use crate::mesh::buffers::{MeshBuffers, Rgb, blend};
use crate::mesh::coarse;
use crate::surface::Finish;
use crate::terrain::{GROUND_STEP, Terrain, TerrainSample};
use crate::texture::Texture;
use glam::{DVec2, DVec3, IVec2};

const GRASS: Rgb = [0.125, 0.205, 0.052];
const MEADOW: Rgb = [0.215, 0.240, 0.082];
const WOOD: Rgb = [0.036, 0.088, 0.026];
const ROCK: Rgb = [0.205, 0.185, 0.160];
const SNOW: Rgb = [0.800, 0.820, 0.850];
const SAND: Rgb = [0.480, 0.395, 0.240];
const BED: Rgb = [0.085, 0.090, 0.070];
pub(super) const WATER: Rgb = [0.020, 0.105, 0.165];

/// Opacity of water.
pub(super) const WATER_ALPHA: f32 = 0.72;

/// Edge of a square of water, in squares of the ground.
const COARSE: usize = 4;

/// Colour of the ground by water, slope, vegetation and height, each passing smoothly into the next.
pub(super) fn colour(sample: &TerrainSample, gradient: DVec2) -> Rgb {
    let step = |low: f64, high: f64, x: f64| crate::space::math::smoothstep(low, high, x) as f32;
    let above = sample.height - sample.water_level;
    let green =
        blend(blend(MEADOW, GRASS, step(0.0, 0.35, sample.vegetation)), WOOD, step(0.4, 0.85, sample.vegetation));
    let high = blend(green, SNOW, step(900.0, 1200.0, sample.height));
    let steep = blend(high, ROCK, step(0.45, 0.8, gradient.length()));
    let shore = blend(SAND, steep, step(0.4, 2.0, above));
    blend(BED, shore, step(-3.0, -0.2, above))
}

/// The texture of the ground, by its [place](Texture::between) on the list, each passing smoothly into the next.
pub(super) fn texture(sample: &TerrainSample) -> f32 {
    let step = |low: f64, high: f64, x: f64| crate::space::math::smoothstep(low, high, x) as f32;
    let place = |texture: Texture| f32::from(texture as u8);
    let green = step(0.0, 0.35, sample.vegetation) + step(0.4, 0.85, sample.vegetation);
    let bare = step(0.4, 2.0, sample.height - sample.water_level) * (1.0 - step(900.0, 1200.0, sample.height));
    Texture::between((place(Texture::Meadow) + green) * bare + place(Texture::Sand) * (1.0 - bare))
}

/// The chunk's ground. `terrain` is the terrain that the chunk's ground was sampled from. Unless `full`, it is coarse where no
/// street is near, and without the height of kerbs.
pub(super) fn ground(chunk: &Chunk, terrain: &dyn Terrain, full: bool) -> MeshBuffers {
    let tin = &chunk.tin;
    let mut out = MeshBuffers::default();
    let coarse = if full { Vec::new() } else { coarse::triangles(tin) };
    let fine = tin.triangles.iter().filter(|t| full && t.1 == Finish::Ground).map(|t| t.0);
    let triangles = || fine.clone().chain(coarse.iter().copied());
    out.reserve(tin.points.len(), tin.triangles.len());
    let mut normals = vec![DVec3::ZERO; tin.points.len()];
    for corners in triangles() {
        let [a, b, c] = corners.map(|v| tin.points[v as usize]);
        let normal = (b - a).cross(c - a);
        corners.iter().for_each(|v| normals[*v as usize] += normal);
    }
    let rim = Rim::new(chunk, terrain);
    let mut slots = vec![u32::MAX; tin.points.len()];
    for corners in triangles() {
        let corners = corners.map(|v| {
            let slot = &mut slots[v as usize];
            if *slot == u32::MAX {
                let p = tin.points[v as usize].truncate();
                let own = normals[v as usize];
                let gradient = rim.gradient(p).unwrap_or(-own.truncate() / own.z.max(1e-9));
                let normal = DVec3::new(-gradient.x, -gradient.y, 1.0).normalize();
                let of = |value: fn(&TerrainSample) -> f64| chunk.ground.value(p, value).unwrap_or_default();
                let sample = TerrainSample {
                    height: if full { tin.height_of(v, Finish::Ground) } else { tin.points[v as usize].z },
                    water_level: of(|s| s.water_level),
                    vegetation: of(|s| s.vegetation),
                };
                let at = p.extend(sample.height);
                *slot = out.coloured(at, normal, colour(&sample, gradient), texture(&sample));
            }
            *slot
        });
        out.indices.extend(corners);
    }
    out.shrink();
    out
}

/// Gradients of the natural ground along the border of a chunk's square: both chunks at a border know them, but not the triangles
/// on the other side.
struct Rim {
    size: f64,
    /// Gradients at the vertices of the ground along the south, the north, the west and the east side.
    sides: [Vec<DVec2>; 4],
}

impl Rim {
    fn new(chunk: &Chunk, terrain: &dyn Terrain) -> Self {
        let ground = &chunk.ground;
        let cells = ground.cells as i32;
        let mut scan = terrain.scan_ground();
        let mut height = |at: IVec2| {
            let inside = at.min_element() >= 0 && at.max_element() <= cells;
            match inside {
                true => ground.vertex(at.x as usize, at.y as usize).height,
                false => scan(chunk.origin.to_plan(at.as_dvec2() * GROUND_STEP)).height,
            }
        };
        let mut gradient = |at: IVec2| {
            let mut along = |d: IVec2| (height(at + d) - height(at - d)) / (2.0 * GROUND_STEP);
            DVec2::new(along(IVec2::X), along(IVec2::Y))
        };
        let sides = [(0, None), (cells, None), (0, Some(())), (cells, Some(()))].map(|(edge, upright)| {
            (0..=cells)
                .map(|i| gradient(if upright.is_some() { IVec2::new(edge, i) } else { IVec2::new(i, edge) }))
                .collect()
        });
        Self { size: chunk.size as f64, sides }
    }

    /// The gradient at a point on the border; `None` elsewhere.
    fn gradient(&self, p: DVec2) -> Option<DVec2> {
        let (side, along) = match p {
            DVec2 { y: 0.0, x } => (0, x),
            DVec2 { y, x } if y == self.size => (1, x),
            DVec2 { x: 0.0, y } => (2, y),
            DVec2 { x, y } if x == self.size => (3, y),
            _ => return None,
        };
        let at = along / GROUND_STEP;
        let i = (at as usize).min(self.sides[side].len() - 2);
        Some(self.sides[side][i].lerp(self.sides[side][i + 1], at - i as f64))
    }
}

/// The surface of the water, in every square with ground below the water level in it or on its edges.
pub(super) fn water(chunk: &Chunk) -> MeshBuffers {
    let mut out = MeshBuffers::default();
    let ground = &chunk.ground;
    let columns = ground.cells / COARSE;
    let wet = |column: usize, row: usize| {
        (row * COARSE..=(row + 1) * COARSE)
            .any(|r| (column * COARSE..=(column + 1) * COARSE).any(|c| ground.vertex(c, r).depth() > 0.0))
    };
    let mut index = vec![u32::MAX; (columns + 1) * (columns + 1)];
    for row in 0..columns {
        for column in 0..columns {
            if !wet(column, row) {
                continue;
            }
            let mut vertex = |c: usize, r: usize| {
                let slot = &mut index[r * (columns + 1) + c];
                if *slot == u32::MAX {
                    let at = DVec2::new(c as f64, r as f64) * GROUND_STEP * COARSE as f64;
                    let level = ground.vertex(c * COARSE, r * COARSE).water_level;
                    *slot = out.coloured(at.extend(level), DVec3::Z, WATER, WATER_ALPHA);
                }
                *slot
            };
            let (sw, se) = (vertex(column, row), vertex(column + 1, row));
            let (nw, ne) = (vertex(column, row + 1), vertex(column + 1, row + 1));
            out.triangle([sw, se, ne]);
            out.triangle([sw, ne, nw]);
        }
    }
    out
}
