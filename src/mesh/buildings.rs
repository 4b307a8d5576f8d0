//! Buildings: closed solids of walls, roof and floor on each footprint.

use crate::chunk::Chunk;
use crate::mesh::buffers::{MeshBuffers, Rgb, blend};
use crate::mesh::drape::Surface;
use crate::mesh::roofs::{Roof, cap, roof};
use crate::parcel::{Footprint, Lot};
use crate::space::stable_hash;
use glam::DVec2;

/// Height of a storey, and what walls stand above the last one, in metres.
const STOREY: f64 = 3.0;
const TOP: f64 = 0.5;

/// Storeys from which the windows of a building are drawn as bands.
const BANDED: u32 = 4;

/// Plaster, brick and stone.
const WALLS: [Rgb; 10] = [
    [0.640, 0.560, 0.430],
    [0.700, 0.660, 0.580],
    [0.560, 0.420, 0.270],
    [0.330, 0.130, 0.085],
    [0.420, 0.190, 0.120],
    [0.520, 0.490, 0.440],
    [0.610, 0.480, 0.330],
    [0.440, 0.400, 0.350],
    [0.720, 0.690, 0.640],
    [0.500, 0.370, 0.300],
];

/// Tiles and slate.
const ROOFS: [Rgb; 6] = [
    [0.330, 0.095, 0.050],
    [0.250, 0.085, 0.055],
    [0.095, 0.095, 0.105],
    [0.150, 0.120, 0.105],
    [0.290, 0.130, 0.075],
    [0.060, 0.065, 0.075],
];

const FLAT_ROOF: Rgb = [0.210, 0.205, 0.195];
const GLASS: Rgb = [0.055, 0.075, 0.095];

/// All buildings of a chunk; without `full` they are boxes.
pub(super) fn buildings(chunk: &Chunk, surface: &mut Surface<'_>, full: bool) -> MeshBuffers {
    let mut out = MeshBuffers::default();
    let mut lots: Vec<&Lot> = chunk.lots.iter().collect();
    lots.sort_by_key(|l| l.id);
    for footprint in &chunk.footprints {
        let lot = lots.binary_search_by_key(&footprint.lot, |l| l.id).ok().map(|i| lots[i]);
        building(&mut out, footprint, lot, surface, full);
    }
    out
}

fn building(out: &mut MeshBuffers, of: &Footprint, lot: Option<&Lot>, surface: &mut Surface<'_>, full: bool) {
    let plan = &of.polygon;
    let grounds = plan.iter().map(|p| surface.height(*p));
    let (low, high) = grounds.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), g| (l.min(g), h.max(g)));
    // The ground floor is entered from the uphill side, unless that would bury it.
    let floor = high.min(low + 2.0);
    let base = low - if full { 0.6 } else { 3.0 };
    let eaves = floor + f64::from(of.storeys) * STOREY + TOP;
    let pick = |salt: u64, n: usize| (stable_hash(&[of.id, salt]) % n as u64) as usize;
    // Neighbours of a block share a taste.
    let block = lot.map_or(of.id, |l| l.block);
    let taste = (stable_hash(&[block, 7]) % WALLS.len() as u64) as usize;
    let wall = WALLS[if pick(1, 3) == 0 { pick(2, WALLS.len()) } else { (taste + pick(3, 3)) % WALLS.len() }];
    let wall = blend(wall, [0.5; 3], pick(4, 20) as f32 / 100.0);
    let tiles = ROOFS[(stable_hash(&[block, 8]) as usize % 3 * 2 + pick(5, 2)) % ROOFS.len()];

    let rows =
        if full && of.storeys >= BANDED { bands(base, floor, eaves, of.storeys) } else { vec![(base, eaves, false)] };
    for (low, high, glass) in rows {
        let colour = if glass { blend(wall, GLASS, 0.75) } else { wall };
        walls(out, plan, low, high, colour);
    }
    let shape = if full { roof(plan, of.storeys, lot.map(|l| &l.polygon[..2]), of.id) } else { Roof::Flat };
    let colour = if shape == Roof::Flat { FLAT_ROOF } else { tiles };
    shape.build(out, plan, eaves, colour, wall);
    cap(out, plan, base, false, wall);
}

/// Rows of wall from the base to the eaves, and which of them are windows.
fn bands(base: f64, floor: f64, eaves: f64, storeys: u32) -> Vec<(f64, f64, bool)> {
    let (mut rows, mut at) = (Vec::new(), base);
    for storey in 0..storeys {
        let sill = floor + f64::from(storey) * STOREY + 0.95;
        rows.push((at, sill, false));
        rows.push((sill, sill + 1.45, true));
        at = sill + 1.45;
    }
    rows.push((at, eaves, false));
    rows
}

fn walls(out: &mut MeshBuffers, plan: &[DVec2], low: f64, high: f64, colour: Rgb) {
    for (i, &a) in plan.iter().enumerate() {
        let b = plan[(i + 1) % plan.len()];
        out.face(&[a.extend(low), b.extend(low), b.extend(high), a.extend(high)], colour);
    }
}
