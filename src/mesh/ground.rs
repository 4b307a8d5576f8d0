//! The ground and the water on it.

use crate::chunk::Chunk;
use crate::mesh::buffers::{MeshBuffers, Rgb, blend};
use crate::mesh::drape::Drape;
use crate::terrain::{GROUND_STEP, TerrainSample};
use glam::{DVec2, DVec3, IVec2};

const GRASS: Rgb = [0.125, 0.205, 0.052];
const MEADOW: Rgb = [0.215, 0.240, 0.082];
const WOOD: Rgb = [0.036, 0.088, 0.026];
const ROCK: Rgb = [0.205, 0.185, 0.160];
const SNOW: Rgb = [0.800, 0.820, 0.850];
const SAND: Rgb = [0.480, 0.395, 0.240];
const BED: Rgb = [0.085, 0.090, 0.070];
const WATER: Rgb = [0.020, 0.105, 0.165];

/// Opacity of water.
const WATER_ALPHA: f32 = 0.72;

/// Edge of a square of water or of coarse ground, in squares of the ground.
pub(super) const COARSE: usize = 4;

/// Colour of the ground by water, slope, vegetation and height, each passing smoothly into the next.
fn colour(sample: &TerrainSample, gradient: DVec2) -> Rgb {
    let step = |low: f64, high: f64, x: f64| crate::space::math::smoothstep(low, high, x) as f32;
    let above = sample.height - sample.water_level;
    let green =
        blend(blend(MEADOW, GRASS, step(0.0, 0.35, sample.vegetation)), WOOD, step(0.4, 0.85, sample.vegetation));
    let high = blend(green, SNOW, step(900.0, 1200.0, sample.height));
    let steep = blend(high, ROCK, step(0.45, 0.8, gradient.length()));
    let shore = blend(SAND, steep, step(0.4, 2.0, above));
    blend(BED, shore, step(-3.0, -0.2, above))
}

/// The chunk's ground: every square, or coarse squares with a fine border.
pub(super) fn ground(chunk: &Chunk, drape: &mut Drape<'_>, coarse: bool) -> MeshBuffers {
    let mut out = MeshBuffers::default();
    let cells = chunk.ground.cells;
    let wanted = |c: usize, r: usize| {
        let border = c == 0 || r == 0 || c == cells || r == cells;
        !coarse || border || (c.is_multiple_of(COARSE) && r.is_multiple_of(COARSE))
    };
    let mut index = vec![u32::MAX; (cells + 1) * (cells + 1)];
    for row in 0..=cells {
        for column in 0..=cells {
            if !wanted(column, row) {
                continue;
            }
            let (height, gradient) = drape.corner(IVec2::new(column as i32, row as i32));
            let at = DVec3::new(column as f64 * GROUND_STEP, row as f64 * GROUND_STEP, height);
            let normal = DVec3::new(-gradient.x, -gradient.y, 1.0).normalize();
            let colour = colour(chunk.ground.vertex(column, row), gradient);
            index[row * (cells + 1) + column] = out.vertex(at, normal, colour, 1.0);
        }
    }
    let at = |c: usize, r: usize| index[r * (cells + 1) + c];
    let step = if coarse { COARSE } else { 1 };
    for row in (0..cells).step_by(step) {
        for column in (0..cells).step_by(step) {
            let (east, north) = (column + step, row + step);
            if coarse && (column == 0 || row == 0 || east == cells || north == cells) {
                // A fan over the vertices around the square, from a corner inside the chunk if there is one.
                let south_side = (column..east).map(|c| (c, row));
                let east_side = (row..north).map(|r| (east, r));
                let north_side = (column + 1..=east).rev().map(|c| (c, north));
                let west_side = (row + 1..=north).rev().map(|r| (column, r));
                let mut ring: Vec<(usize, usize)> = south_side
                    .chain(east_side)
                    .chain(north_side)
                    .chain(west_side)
                    .filter(|p| wanted(p.0, p.1))
                    .collect();
                let inner = |v: usize| if v == 0 || v == cells { step } else { 0 };
                let apex = [(column, row), (east, row), (east, north), (column, north)]
                    .into_iter()
                    .min_by_key(|(c, r)| inner(*c) + inner(*r))
                    .and_then(|apex| ring.iter().position(|p| *p == apex));
                ring.rotate_left(apex.unwrap_or(0));
                for i in 1..ring.len() - 1 {
                    out.triangle([ring[0], ring[i], ring[i + 1]].map(|(c, r)| at(c, r)));
                }
                continue;
            }
            out.triangle([at(column, row), at(east, row), at(east, north)]);
            out.triangle([at(column, row), at(east, north), at(column, north)]);
        }
    }
    out
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
                    *slot = out.vertex(at.extend(level), DVec3::Z, WATER, WATER_ALPHA);
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
