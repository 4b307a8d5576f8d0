//! Buildings: closed solids of walls, roof and floor on each footprint.

use crate::chunk::Chunk;
use crate::mesh::buffers::{Coat, MeshBuffers};
use crate::mesh::footing::Footing;
use crate::mesh::roofs::{Roof, cap, roof};
use crate::mesh::windows::{Facade, windows};
use crate::parcel::{Footprint, Lot, STOREY_HEIGHT};
use crate::space::{Bounds, stable_hash};
use crate::texture::Texture;
use glam::DVec2;

/// Depth of walls below the ground floor, in metres, in full detail: the ground floor lies at most 2 m above the ground.
const FOOT: f64 = 2.6;
/// The same in reduced detail: the coarse ground may lie lower.
const FAR_FOOT: f64 = 4.0;

/// Height of the block that stands for a pitched roof in reduced detail, in metres.
const FAR_ROOF: f64 = 1.2;

/// Plaster, brick and stone.
pub(super) const WALLS: [Coat; 10] = [
    Coat::new(Texture::Plaster, [0.640, 0.560, 0.430]),
    Coat::new(Texture::Plaster, [0.700, 0.660, 0.580]),
    Coat::new(Texture::Plaster, [0.560, 0.420, 0.270]),
    Coat::new(Texture::Brick, [0.330, 0.130, 0.085]),
    Coat::new(Texture::Brick, [0.420, 0.190, 0.120]),
    Coat::new(Texture::Stone, [0.520, 0.490, 0.440]),
    Coat::new(Texture::Plaster, [0.610, 0.480, 0.330]),
    Coat::new(Texture::Brick, [0.440, 0.400, 0.350]),
    Coat::new(Texture::Plaster, [0.720, 0.690, 0.640]),
    Coat::new(Texture::Brick, [0.500, 0.370, 0.300]),
];

/// Tiles and slate.
pub(super) const ROOFS: [Coat; 6] = [
    Coat::new(Texture::Tiles, [0.330, 0.095, 0.050]),
    Coat::new(Texture::Tiles, [0.250, 0.085, 0.055]),
    Coat::new(Texture::Tiles, [0.095, 0.095, 0.105]),
    Coat::new(Texture::Tiles, [0.150, 0.120, 0.105]),
    Coat::new(Texture::Tiles, [0.290, 0.130, 0.075]),
    Coat::new(Texture::Tiles, [0.060, 0.065, 0.075]),
];

const FLAT_ROOF: Coat = Coat::new(Texture::Felt, [0.210, 0.205, 0.195]);

/// All buildings of a chunk, and their windows. Unless `full`, buildings are boxes without windows.
pub(super) fn buildings(chunk: &Chunk, footing: &mut Footing<'_>, full: bool) -> (MeshBuffers, MeshBuffers) {
    let (mut solids, mut panes) = (MeshBuffers::default(), MeshBuffers::default());
    let mut lots: Vec<&Lot> = chunk.lots.iter().collect();
    lots.sort_by_key(|l| l.id);
    let lot_of = |f: &Footprint| lots.binary_search_by_key(&f.lot, |l| l.id).ok().map(|i| lots[i]);
    let mut ordered: Vec<(u64, &Footprint)> =
        chunk.footprints.iter().map(|f| (lot_of(f).map_or(0, |l| l.block), f)).collect();
    ordered.sort_by_key(|(block, f)| (*block, f.id));
    for row in ordered.chunk_by(|a, b| a.0 == b.0) {
        let neighbours: Vec<(Bounds, &[DVec2])> =
            row.iter().map(|(_, f)| (Bounds::of(f.polygon.iter().copied()), &*f.polygon)).collect();
        for (_, footprint) in row {
            let lot = lot_of(footprint);
            building(&mut solids, footprint, lot, full);
            if full {
                let facade = Facade {
                    plan: &footprint.polygon,
                    floor: footprint.base,
                    storeys: footprint.storeys,
                    storey_height: STOREY_HEIGHT,
                    street: lot.map(|l| (l.polygon[1] - l.polygon[0]).normalize_or_zero()),
                    id: footprint.id,
                };
                windows(&mut panes, &facade, &neighbours, footing);
            }
        }
    }
    (solids, panes)
}

/// Adds a building.
fn building(out: &mut MeshBuffers, footprint: &Footprint, lot: Option<&Lot>, full: bool) {
    let plan = &footprint.polygon;
    let foot = footprint.base - if full { FOOT } else { FAR_FOOT };
    let eaves = footprint.base + footprint.height;
    let pick = |salt: u64, n: usize| (stable_hash(&[footprint.id, salt]) % n as u64) as usize;
    // The buildings of a block have similar colours.
    let block = lot.map_or(footprint.id, |l| l.block);
    let shared = (stable_hash(&[block, 7]) % WALLS.len() as u64) as usize;
    let wall = WALLS[if pick(1, 3) == 0 { pick(2, WALLS.len()) } else { (shared + pick(3, 3)) % WALLS.len() }];
    let wall = wall.tinted([0.5; 3], pick(4, 20) as f32 / 100.0);
    let tiles = ROOFS[(stable_hash(&[block, 8]) as usize % 3 * 2 + pick(5, 2)) % ROOFS.len()];

    let shape = roof(plan, footprint.storeys, lot.map(|l| &l.polygon[..2]), footprint.id);
    let cover = if shape == Roof::Flat { FLAT_ROOF } else { tiles };
    // In reduced detail a box keeps the colour of the roof and some of its height.
    let (shape, eaves) = if full || shape == Roof::Flat { (shape, eaves) } else { (Roof::Flat, eaves + FAR_ROOF) };
    walls(out, plan, foot, eaves, wall);
    shape.build(out, plan, eaves, cover, wall);
    cap(out, plan, foot, false, wall);
}

/// The walls of a building from height `low` to `high`.
fn walls(out: &mut MeshBuffers, plan: &[DVec2], low: f64, high: f64, coat: Coat) {
    for (i, &a) in plan.iter().enumerate() {
        let b = plan[(i + 1) % plan.len()];
        out.face(&[a.extend(low), b.extend(low), b.extend(high), a.extend(high)], coat);
    }
}
