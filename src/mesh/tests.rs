//! Meshes of hand-made chunks on hilly ground.

use crate::chunk::{Chunk, Ground, tin};
use crate::layer::Cancel;
use crate::mesh::{ChunkMesh, ChunkPart, Detail, MeshBuffers, build};
use crate::network::{Junction, JunctionId, Side, Street, StreetClass, StreetId};
use crate::space::{ChunkCoord, Seed, distance_to_line, math, point_at, signed_area};
use crate::stack::PlacedStreet;
use crate::style::ParcelRules;
use crate::surface::{Deck, FREEBOARD, Graded, LONGEST_PIECE, Profile, SurfaceKind};
use crate::terrain::{DrawnGround, Terrain, TerrainSample};
use crate::testing::{Flat, block_cell, divided};
use glam::{DVec2, Vec3};
use std::collections::BTreeMap;

/// Hills with water in the hollows.
struct Hills;

impl Terrain for Hills {
    fn sample(&self, p: DVec2) -> TerrainSample {
        let height = 20.0 + 9.0 * math::sin(p.x / 140.0) * math::cos(p.y / 110.0) + 4.0 * math::sin(p.y / 60.0 + 1.0);
        TerrainSample { height, water_level: 12.5, vegetation: 0.5 + 0.5 * math::sin(p.x / 97.0 + p.y / 71.0) }
    }
}

fn empty(coord: ChunkCoord, terrain: &dyn Terrain) -> Chunk {
    let size = 512;
    Chunk::empty(coord, size, Ground::new(terrain, coord.origin(size), size))
}

/// A chunk that owns a random cell of `pitch` metres between streets, with every street's junctions.
fn town(seed: u64, pitch: f64, rules: &ParcelRules) -> Chunk {
    let mut rng = Seed(seed).stream("mesh test", &[]);
    let count = (440.0 / pitch) as usize;
    let cell = block_cell(&mut rng, count, count, pitch);
    let offset = DVec2::new(-870.0, 330.0);
    let parcels = divided(seed, &cell, rules);
    let mut chunk = empty(ChunkCoord::new(3, -2), &Hills);
    let mut junctions = BTreeMap::new();
    let mut bed = DrawnGround::dry(&Hills, FREEBOARD);
    let mut graded = Vec::new();
    for street in &cell.streets {
        let street = street.moved(offset);
        let profile = Profile::new(&street, chunk.origin, |p| bed.height(p));
        graded.push(Graded { street: street.clone(), profile });
        junctions.insert(street.from, street.line[0]);
        junctions.insert(street.to, street.line[street.line.len() - 1]);
        chunk.streets.push(PlacedStreet { street, made_by: None });
    }
    graded.sort_by_key(|g| g.street.id);
    chunk.tin = tin(&chunk, &graded, Side::Right);
    chunk.junctions = junctions.into_iter().map(|(id, at)| Junction { id, at }).collect();
    chunk.blocks = parcels.blocks.iter().map(|b| b.moved(offset)).collect();
    chunk.lots = parcels.lots.iter().map(|l| l.moved(offset)).collect();
    chunk.footprints = parcels.footprints.iter().map(|f| f.moved(offset)).collect();
    chunk
}

fn meshes(chunk: &Chunk, detail: Detail) -> ChunkMesh {
    build(chunk, &Hills, detail, &Cancel::new()).unwrap()
}

fn corners(mesh: &MeshBuffers) -> impl Iterator<Item = [Vec3; 3]> + '_ {
    mesh.indices.chunks(3).map(|t| [0, 1, 2].map(|i| Vec3::from(mesh.positions[t[i] as usize])))
}

/// Everything that a renderer relies on.
fn check(mesh: &MeshBuffers, what: &str) {
    assert!(mesh.indices.len().is_multiple_of(3));
    assert!(mesh.normals.len() == mesh.positions.len() && mesh.colours.len() == mesh.positions.len());
    assert!(mesh.indices.iter().all(|i| (*i as usize) < mesh.positions.len()), "{what}: index");
    assert!(mesh.positions.iter().flatten().all(|v| v.is_finite()), "{what}");
    assert!((0..mesh.normals.len() as u32).all(|v| (mesh.normal(v).length() - 1.0).abs() < 0.01), "{what}: normals");
    for (t, [a, b, c]) in mesh.indices.chunks(3).zip(corners(mesh)) {
        let cross = (b - a).cross(c - a);
        assert!(cross.length() > 5e-7, "{what}: triangle without area {a} {b} {c}");
        for i in t {
            let normal = mesh.normal(*i);
            assert!(cross.normalize().dot(normal) > 0.0, "{what}: winding {a} {b} {c} {normal}");
        }
    }
}

/// Every edge of the mesh is walked once each way.
fn check_closed(mesh: &MeshBuffers) {
    let mut edges: BTreeMap<[[u32; 3]; 2], i32> = BTreeMap::new();
    for t in corners(mesh) {
        for i in 0..3 {
            let [a, b] = [t[i], t[(i + 1) % 3]].map(|p| p.to_array().map(f32::to_bits));
            let (key, by) = if a < b { ([a, b], 1) } else { ([b, a], 1000) };
            *edges.entry(key).or_default() += by;
        }
    }
    let open = edges.iter().find(|(_, n)| **n != 1001);
    assert!(open.is_none(), "open edge {:?}", open.map(|(e, n)| (e.map(|p| p.map(f32::from_bits)), n)));
}

#[test]
fn meshes_are_sound_and_buildings_closed() {
    let mut built = 0;
    for (seed, pitch, setback, storeys) in [(1, 70.0, 3.0, (1, 3)), (2, 90.0, 0.0, (2, 6)), (3, 110.0, 0.0, (3, 9))] {
        let rules =
            ParcelRules { setback_front: setback, setback_side: setback / 2.0, storeys, ..ParcelRules::default() };
        let chunk = town(seed, pitch, &rules);
        built += chunk.footprints.len();
        for detail in [Detail::Full, Detail::Reduced] {
            let mesh = meshes(&chunk, detail);
            assert_eq!(mesh, meshes(&chunk, detail));
            for (part, buffers) in mesh.parts() {
                let empty = part == ChunkPart::Windows && detail == Detail::Reduced;
                assert_eq!(buffers.indices.is_empty(), empty, "{part:?}");
                check(buffers, part.material().name);
            }
            check_closed(&mesh[ChunkPart::Buildings]);
        }
    }
    assert!(built > 400, "{built}");
}

/// Triangles that face up, by 16 m squares of the plan.
struct Tops(BTreeMap<(i32, i32), Vec<[Vec3; 3]>>);

fn plan(p: Vec3) -> DVec2 {
    DVec2::new(f64::from(p.x), f64::from(-p.z))
}

impl Tops {
    fn of(mesh: &MeshBuffers) -> Self {
        let mut near: BTreeMap<(i32, i32), Vec<[Vec3; 3]>> = BTreeMap::new();
        for t in corners(mesh) {
            let at = t.map(plan);
            if signed_area(&at) < 1e-9 {
                continue;
            }
            let bounds = crate::space::Bounds::of(at);
            let (low, high) = ((bounds.min / 16.0).floor().as_ivec2(), (bounds.max / 16.0).floor().as_ivec2());
            for x in low.x..=high.x {
                (low.y..=high.y).for_each(|y| near.entry((x, y)).or_default().push(t));
            }
        }
        Self(near)
    }

    /// Heights of all triangles over a point.
    fn heights(&self, p: DVec2) -> Vec<f64> {
        let cell = (p / 16.0).floor().as_ivec2();
        let over = |t: &[Vec3; 3]| {
            let [a, b, c] = t.map(plan);
            let area = crate::space::cross(b - a, c - a);
            let weights = [(b, c), (c, a), (a, b)].map(|(q, r)| crate::space::cross(r - q, p - q) / area);
            let height = (0..3).map(|i| f64::from(t[i].y) * weights[i]).sum::<f64>();
            weights.iter().all(|w| *w >= 0.0).then_some(height)
        };
        self.0.get(&(cell.x, cell.y)).into_iter().flatten().filter_map(over).collect()
    }
}

#[test]
fn streets_and_ground_cover_the_square_once_at_the_height_that_one_walks_at() {
    for seed in 0..4 {
        let chunk = town(seed + 20, 80.0 + 10.0 * seed as f64, &ParcelRules::default());
        let mesh = meshes(&chunk, Detail::Full);
        let (roads, ground) = (Tops::of(&mesh[ChunkPart::Roads]), Tops::of(&mesh[ChunkPart::Ground]));
        let mut rng = Seed(seed).stream("cover", &[]);
        let streets: Vec<&Street> = chunk.streets.iter().map(|s| &s.street).collect();
        for k in 0..4000 {
            let p = if k % 2 == 0 {
                DVec2::new(rng.range(0.0, 512.0), rng.range(0.0, 512.0))
            } else {
                let street = streets[rng.index(streets.len())];
                let (at, along) = point_at(&street.line, rng.range(0.0, street.length()));
                at + along.perp() * (rng.signed() * street.class.half_width())
            };
            let Some(surface) = chunk.tin.at(p) else { continue };
            let heights = [roads.heights(p), ground.heights(p)];
            assert_eq!(heights[0].len() + heights[1].len(), 1, "seed {seed}: {p} is covered {heights:?}");
            let street = surface.kind != SurfaceKind::Ground;
            let drawn = heights[usize::from(!street)].first().expect("streets are drawn as streets");
            assert!((drawn - surface.height).abs() < 0.001, "seed {seed}: {p}: {drawn} {surface:?}");
            if k % 2 == 1 && streets.iter().any(|s| distance_to_line(p, &s.line) < s.class.carriageway() / 2.0 - 0.05) {
                assert!(surface.kind >= SurfaceKind::Carriageway, "seed {seed}: {p}: {surface:?}");
            }
        }
    }
}

#[test]
fn neighbouring_ground_meets_to_the_bit_at_any_detail() {
    let border = |mesh: &ChunkMesh, x: f32, shift: f32| {
        let on = |(p, n): (&[f32; 3], &[i8; 4])| (p[0] == x).then_some(([p[0] - shift, p[1], p[2]], *n));
        let ground = &mesh[ChunkPart::Ground];
        let mut points: Vec<_> = ground.positions.iter().zip(&ground.normals).filter_map(on).collect();
        points.sort_by(|a, b| a.0[2].total_cmp(&b.0[2]));
        points
    };
    let [west, east] = [ChunkCoord::new(-1, 0), ChunkCoord::new(0, 0)].map(|c| empty(c, &Hills));
    for (a, b) in [(Detail::Full, Detail::Full), (Detail::Full, Detail::Reduced), (Detail::Reduced, Detail::Full)] {
        let west_side = border(&meshes(&west, a), 512.0, 512.0);
        assert_eq!(west_side.len(), 65);
        assert_eq!(west_side, border(&meshes(&east, b), 0.0, 0.0));
    }
    for detail in [Detail::Full, Detail::Reduced] {
        let mesh = meshes(&east, detail);
        let area: f64 = corners(&mesh[ChunkPart::Ground])
            .map(|t| signed_area(&t.map(|p| DVec2::new(f64::from(p.x), f64::from(-p.z)))))
            .sum();
        assert!((area - 512.0 * 512.0).abs() < 1e-3, "the square is covered once");
    }
}

#[test]
fn an_empty_chunk_has_ground_alone() {
    let mesh = build(&empty(ChunkCoord::new(0, 0), &Flat), &Flat, Detail::Full, &Cancel::new()).unwrap();
    for (part, buffers) in mesh.parts() {
        assert_eq!(buffers.indices.len(), if part == ChunkPart::Ground { 64 * 64 * 6 } else { 0 });
    }
}

#[test]
fn long_roads_and_bridges_are_drawn_once_by_the_chunks_in_which_they_lie() {
    let at = |x: f64, y: f64| DVec2::new(x, y);
    let ends = [at(-900.0, 40.0), at(200.0, 60.0), at(620.0, 90.0), at(1400.0, 300.0)];
    let id = |k: u64| JunctionId::of(&[k]);
    let mut streets: Vec<Street> = (0..3)
        .map(|k| {
            let line = vec![ends[k], ends[k].lerp(ends[k + 1], 0.4) + at(3.0, 9.0), ends[k + 1]];
            let ends = [id(k as u64), id(k as u64 + 1)];
            let bridge = k == 1;
            Street { bridge, ..Street::new(StreetId::of(&[k as u64]), StreetClass::Major, ends[0], ends[1], line) }
        })
        .collect();
    streets.sort_by_key(|s| s.id);
    let chunk = |coord: ChunkCoord| {
        let mut chunk = empty(coord, &Hills);
        let here = |street: &Street| street.moved(-chunk.origin.plan());
        chunk.passing = streets.iter().map(here).collect();
        let mut bed = DrawnGround::dry(&Hills, FREEBOARD);
        let mut graded = Vec::new();
        for street in chunk.passing.clone() {
            let profile = if street.bridge {
                chunk.decks.push(Deck::new(&street, chunk.origin, &[], |p| bed.height(p)));
                chunk.decks[0].profile.clone()
            } else {
                Profile::new(&street, chunk.origin, |p| bed.height(p))
            };
            graded.push(Graded { street, profile });
        }
        chunk.tin = tin(&chunk, &graded, Side::Right);
        chunk
    };
    let reach = (LONGEST_PIECE / 2.0 + StreetClass::Major.half_width()) as f32 + 10.0;
    for detail in [Detail::Full, Detail::Reduced] {
        let mut area = 0.0;
        for (x, y) in (-3..4).flat_map(|x| (-1..2).map(move |y| (x, y))) {
            let chunk = chunk(ChunkCoord::new(x, y));
            let mesh = meshes(&chunk, detail);
            let roads = &mesh[ChunkPart::Roads];
            check(roads, "roads");
            let near = |p: &[f32; 3]| [p[0], -p[2]].iter().all(|c| (-reach..512.0 + reach).contains(c));
            assert!(roads.positions.iter().all(near), "{detail:?} {x},{y}");
            let tops = corners(roads).filter(|t| {
                let normal = (t[1] - t[0]).cross(t[2] - t[0]).normalize();
                // Not the tops of abutments and piers, which lie under the deck.
                let middle = (t[0] + t[1] + t[2]) / 3.0;
                let at = DVec2::new(f64::from(middle.x), f64::from(-middle.z));
                let decks = chunk.decks.iter().filter_map(|d| d.height(at));
                normal.y > 0.5 && decks.fold(f64::NEG_INFINITY, f64::max) < f64::from(middle.y) + 0.5
            });
            let plan = |t: [Vec3; 3]| t.map(|p| DVec2::new(f64::from(p.x), f64::from(-p.z)));
            area += tops.map(|t| signed_area(&plan(t))).sum::<f64>();
        }
        let drawn = |s: &Street| s.length() * 2.0 * s.class.half_width();
        let expected: f64 = streets.iter().map(drawn).sum();
        assert!((area / expected - 1.0).abs() < 0.005, "{detail:?}: {area} of {expected} square metres");
    }
    let cancel = Cancel::new();
    cancel.cancel();
    assert!(build(&chunk(ChunkCoord::new(0, 0)), &Hills, Detail::Full, &cancel).is_err());
}

#[test]
fn kerbs_face_the_lower_side() {
    let chunk = town(31, 90.0, &ParcelRules::default());
    let mesh = meshes(&chunk, Detail::Full);
    let roads = &mesh[ChunkPart::Roads];
    let (mut walls, mut wrong) = (0, 0);
    for (t, index) in corners(roads).zip(roads.indices.chunks(3)) {
        let normal = roads.normal(index[0]);
        if normal.y.abs() > 0.1 {
            continue;
        }
        let middle = (t[0] + t[1] + t[2]) / 3.0;
        let at = |by: f32| chunk.tin.at(plan(middle + normal * by)).map_or(f64::NAN, |s| s.height);
        walls += 1;
        wrong += usize::from(at(0.02) + 0.06 > at(-0.02));
    }
    assert!(walls > 1000 && wrong * 100 < walls, "{wrong} of {walls} walls face the wrong way");
}
