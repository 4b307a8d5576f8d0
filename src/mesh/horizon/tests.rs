use super::*;
use crate::mesh::MeshBuffers;
use crate::space::{Seed, math};
use crate::style::ParcelRules;
use crate::terrain::TerrainSample;
use crate::testing::{Ground, any_settlement};
use glam::DVec2;
use std::collections::BTreeMap;

const CHUNK: i64 = 512;

fn hills() -> impl Terrain {
    Ground(|p: DVec2| {
        let height = 80.0 * math::sin(p.x / 900.0) * math::cos(p.y / 700.0) + 6.0 * math::sin((p.x + p.y) / 90.0);
        TerrainSample { height, water_level: -20.0, vegetation: 0.5 }
    })
}

fn of(tile: HorizonTile, towns: &[HorizonTown<'_>]) -> ChunkMesh {
    horizon(tile, CHUNK, &hills(), towns, &Cancel::new()).expect("nothing is cancelled")
}

/// Heights of the ground along a side of a tile's square, by plan position, skirts aside.
fn side(tile: HorizonTile, axis: usize, at: f64) -> BTreeMap<u64, u32> {
    let mesh = of(tile, &[]);
    let origin = tile.origin(CHUNK).plan();
    let (ground, mut out) = (&mesh[ChunkPart::Ground], BTreeMap::new());
    for [x, y, z] in &ground.positions {
        let plan = origin + DVec2::new(f64::from(*x), f64::from(-*z));
        if plan[axis] == at {
            let highest = out.entry(plan[1 - axis].to_bits()).or_insert(f32::NEG_INFINITY);
            *highest = y.max(*highest);
        }
    }
    out.into_iter().map(|(along, height): (u64, f32)| (along, height.to_bits())).collect()
}

#[test]
fn tiles_meet_their_neighbours() {
    for (level, x, y) in [(1, 3, -7), (2, -1, 0), (5, -40, 71)] {
        let tile = HorizonTile { level, x, y };
        let bounds = tile.bounds(CHUNK);
        let [east, north] = [(1, 0), (0, 1)].map(|(right, up)| HorizonTile { level, x: x + right, y: y + up });
        assert_eq!(side(tile, 0, bounds.max.x), side(east, 0, bounds.max.x));
        assert_eq!(side(tile, 1, bounds.max.y), side(north, 1, bounds.max.y));
        assert_eq!(side(tile, 0, bounds.min.x).len(), tile::CELLS + 1);
    }
}

#[test]
fn quarters_of_a_tile_show_what_it_shows() {
    let case = any_settlement(3);
    let parcels = ParcelRules::default();
    let town = HorizonTown { settlement: &case.settlement, outline: &case.outline, parcels: &parcels };
    let mesh = |tile| horizon(tile, CHUNK, &case.terrain, &[town], &Cancel::new()).expect("nothing is cancelled");
    // Vertices in the plan with their heights, skirts aside since they hang below other vertices.
    let tops = |tile: HorizonTile| {
        let (mesh, origin) = (mesh(tile), tile.origin(CHUNK).plan());
        let mut out: BTreeMap<[u64; 2], f32> = BTreeMap::new();
        for [x, y, z] in &mesh[ChunkPart::Ground].positions {
            let plan = origin + DVec2::new(f64::from(*x), f64::from(-*z));
            let top = out.entry(plan.to_array().map(f64::to_bits)).or_insert(f32::NEG_INFINITY);
            *top = y.max(*top);
        }
        (out, mesh[ChunkPart::Buildings].positions.len(), mesh[ChunkPart::Water].indices.len())
    };
    let mut boxes = 0;
    for tile in tiles_around(1) {
        assert!(tile.children().iter().all(|child| child.parent() == tile));
        let whole = tops(tile);
        let mut quarters = (BTreeMap::new(), 0, 0);
        for (vertices, buildings, water) in tile.children().map(tops) {
            quarters.0.extend(vertices);
            quarters.1 += buildings;
            quarters.2 += water;
        }
        assert_eq!(whole, quarters);
        boxes += whole.1;
    }
    assert!(boxes > 0);
}

#[test]
fn every_place_around_is_in_one_tile_and_the_nearer_the_finer() {
    let mut rng = Seed(4).stream("horizon", &[]);
    for _ in 0..40 {
        let from = DVec2::new(rng.range(-9e5, 9e5), rng.range(-9e5, 9e5));
        let tiles = horizon_tiles(from, 16_000.0, CHUNK);
        // Ground and skirts of all of them.
        let triangles = tiles.len() * (2 * tile::CELLS * tile::CELLS + 8 * tile::CELLS);
        assert!(triangles < 190_000, "{} tiles", tiles.len());
        for _ in 0..100 {
            let p = from + math::direction(rng.range(0.0, 6.3)) * rng.range(0.0, 15_999.0);
            let holding = tiles.iter().filter(|t| **t == HorizonTile::containing(t.level, p, CHUNK));
            let levels: Vec<u8> = holding.map(|t| t.level).collect();
            assert_eq!(levels.len(), 1, "{p} from {from}");
            let size = (CHUNK << levels[0]) as f64;
            assert!(levels[0] == 1 || p.distance(from) >= 0.75 * size, "{p} from {from}: level {}", levels[0]);
        }
    }
}

#[test]
fn boxes_stand_in_the_outline_and_once() {
    let mut boxes = 0;
    for number in 0..12 {
        let case = any_settlement(number);
        let parcels = ParcelRules::default();
        let town = HorizonTown { settlement: &case.settlement, outline: &case.outline, parcels: &parcels };
        let count = |tile: HorizonTile| {
            let mesh = horizon(tile, CHUNK, &case.terrain, &[town], &Cancel::new()).expect("nothing is cancelled");
            let buildings: &MeshBuffers = &mesh[ChunkPart::Buildings];
            assert_eq!(buildings.positions.len() % 20, 0);
            for solid in buildings.positions.chunks(20) {
                let middle =
                    solid.iter().map(|[x, _, z]| DVec2::new(f64::from(*x), f64::from(-*z))).sum::<DVec2>() / 20.0;
                let plan = tile.origin(CHUNK).plan() + middle;
                assert!(case.outline.clearance(plan) > 11.0 && case.terrain.sample(plan).depth() <= 0.0, "{plan}");
            }
            buildings.positions.len() / 20
        };
        // One tile of level 3 around the corner at the origin has what four of any of these have.
        let whole: usize = tiles_around(3).into_iter().map(count).sum();
        let again: usize = tiles_around(3).into_iter().rev().map(count).sum();
        assert_eq!(whole, again);
        let wanted = case.outline.area() / (46.0 * 46.0 * 5.0625);
        assert!((0.2..1.1).contains(&(whole as f64 / wanted)) || wanted < 20.0, "{number}: {whole} of {wanted}");
        boxes += whole;
    }
    assert!(boxes > 200, "{boxes}");
}

/// The four tiles of a level around the origin.
fn tiles_around(level: u8) -> Vec<HorizonTile> {
    [(-1, -1), (0, -1), (-1, 0), (0, 0)].map(|(x, y)| HorizonTile { level, x, y }).to_vec()
}
