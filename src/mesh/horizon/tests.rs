use super::*;
use crate::mesh::MeshBuffers;
use crate::network::{JunctionId, Street, StreetClass, StreetId};
use crate::space::{Origin, Seed, math};
use crate::style::ParcelRules;
use crate::surface::CrossSection;
use crate::terrain::TerrainSample;
use crate::testing::{Ground, any_settlement};
use glam::{DVec2, DVec3, I64Vec2};
use std::collections::BTreeMap;

const CHUNK: i64 = 512;

fn hills() -> impl Terrain {
    Ground(|p: DVec2| {
        let height = 80.0 * math::sin(p.x / 900.0) * math::cos(p.y / 700.0) + 6.0 * math::sin((p.x + p.y) / 90.0);
        TerrainSample { height, water_level: -20.0, vegetation: 0.5 }
    })
}

fn made(tile: HorizonTile, terrain: &dyn Terrain, features: &HorizonFeatures<'_>) -> ChunkMesh {
    horizon(tile, CHUNK, terrain, features, &Cancel::new()).expect("nothing is cancelled")
}

/// Heights of the ground along a side of a tile's square, by plan position, skirts aside.
fn side(tile: HorizonTile, axis: usize, at: f64) -> BTreeMap<u64, u32> {
    let mesh = made(tile, &hills(), &HorizonFeatures::default());
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
    let features = HorizonFeatures { towns: vec![town], ..Default::default() };
    let mesh = |tile| made(tile, &case.terrain, &features);
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
        assert!(triangles < 165_000, "{} tiles", tiles.len());
        for _ in 0..100 {
            let p = from + math::direction(rng.range(0.0, 6.3)) * rng.range(0.0, 15_999.0);
            let holding = tiles.iter().filter(|t| **t == HorizonTile::containing(t.level, p, CHUNK));
            let levels: Vec<u8> = holding.map(|t| t.level).collect();
            assert_eq!(levels.len(), 1, "{p} from {from}");
            let size = (CHUNK << levels[0]) as f64;
            assert!(levels[0] == 1 || p.distance(from) >= 0.65 * size, "{p} from {from}: level {}", levels[0]);
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
        let features = HorizonFeatures { towns: vec![town], ..Default::default() };
        let count = |tile: HorizonTile| {
            let mesh = made(tile, &case.terrain, &features);
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

/// A road of a class through plan points.
fn road(class: StreetClass, line: &[(f64, f64)]) -> Arc<RoadSection> {
    let origin = Origin(I64Vec2::new(3 * CHUNK, -CHUNK));
    let line = line.iter().map(|p| origin.to_local(DVec2::from(*p))).collect();
    let street = Street::new(StreetId(1), class, JunctionId(1), JunctionId(2), line);
    Arc::new(RoadSection { origin, street })
}

#[test]
fn roads_lie_on_the_ground_that_is_drawn_and_in_one_tile_each() {
    let line = [(-1900.0, -300.0), (-200.0, 431.0), (140.0, 400.0), (1500.0, -1300.0)];
    let features = HorizonFeatures { roads: vec![road(StreetClass::Highway, &line)], ..HorizonFeatures::default() };
    for level in 1..=HorizonTile::ROADS {
        let mut area = 0.0;
        for tile in tiles_around(level) {
            let mesh = made(tile, &hills(), &features);
            let roads = &mesh[ChunkPart::Roads];
            let land = ground::Land::new(tile, CHUNK, &hills());
            for triangle in roads.indices.chunks_exact(3) {
                let corners = [0, 1, 2].map(|i| {
                    let [x, y, z] = roads.positions[triangle[i] as usize].map(f64::from);
                    DVec3::new(x, -z, y)
                });
                let [a, b, c] = corners;
                area += (b - a).cross(c - a).z / 2.0;
                // Nowhere under the ground, also between the corners.
                for p in [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0] {
                    let drawn = land.surface(p.truncate());
                    let above = p.z - drawn.height.max(drawn.water_level);
                    assert!((0.0..3.0).contains(&above), "{above} m above {tile:?}");
                }
            }
        }
        let length: f64 = line.windows(2).map(|w| DVec2::from(w[0]).distance(DVec2::from(w[1]))).sum();
        // The tiles of level 1 hold a part of the road only.
        let size = (CHUNK << level) as f64;
        let inside = |p: &(f64, f64)| p.0.abs() < size && p.1.abs() < size;
        let wanted = 2.0 * CrossSection::of(StreetClass::Highway).carriageway * length;
        if line.iter().all(inside) {
            assert!((area / wanted - 1.0).abs() < 0.02, "level {level}: {area} of {wanted} m2");
        } else {
            assert!(area > 0.3 * wanted && area < wanted, "level {level}: {area} of {wanted} m2");
        }
    }
}

#[test]
fn narrow_rivers_colour_the_ground_and_wide_ones_are_water() {
    // A river to the north, `width` metres wide.
    let river = |width: f64| {
        Ground(move |p: DVec2| {
            let middle = 60.0 * math::sin(p.y / 200.0);
            let height = if (p.x - middle).abs() < width / 2.0 { -2.0 } else { 3.0 };
            TerrainSample { height, water_level: 0.0, vegetation: 0.0 }
        })
    };
    for level in 1..=HorizonTile::LEVELS {
        let step = (CHUNK << level) as f64 / tile::CELLS as f64;
        let mut tinted = 0;
        for tile in tiles_around(level) {
            let of = |width: f64| made(tile, &river(width), &HorizonFeatures::default());
            let [dry, narrow, wide] = [0.0, 0.3 * step, 2.5 * step].map(of);
            assert!(narrow[ChunkPart::Water].indices.is_empty() && !wide[ChunkPart::Water].indices.is_empty());
            let lowest = |mesh: &ChunkMesh| {
                let ground = &mesh[ChunkPart::Ground].positions[..(tile::CELLS + 1).pow(2)];
                ground.iter().map(|p| p[1]).fold(f32::INFINITY, f32::min)
            };
            assert!(lowest(&narrow) == 3.0 && lowest(&wide) == -2.0, "level {level}");
            let colours = [&dry, &narrow].map(|mesh| &mesh[ChunkPart::Ground].colours);
            tinted += colours[0].iter().zip(colours[1]).filter(|(a, b)| a != b).count();
        }
        // All along the river, from the south to the north.
        assert!(tinted >= 2 * tile::CELLS, "level {level}: {tinted}");
    }
}
