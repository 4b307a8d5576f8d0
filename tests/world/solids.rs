//! Ground and streets as solids: what is drawn is whole, fits between chunks, and lies where one walks.

use crate::world;
use bevy_sprawl::chunk::Chunk;
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::mesh::{ChunkPart, Detail, MeshBuffers, build};
use bevy_sprawl::space::{Bounds, ChunkCoord, Seed, Stream, point_at};
use bevy_sprawl::surface::{CrossSection, Profile, SurfaceKind, has_surface};
use bevy_sprawl::world::{Settings, World};
use glam::{DVec2, IVec2, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// A random chunk: in a town, on a road, or at a bridge.
fn place(world: &World, rng: &mut Stream) -> ChunkCoord {
    let at = DVec2::new(rng.signed(), rng.signed()) * 90_000.0;
    let within = Bounds::square(at, 14_000.0);
    let towns = world.settlements().centred_in(within).unwrap();
    let mut roads = world.roads().overlapping(within, &Cancel::new()).unwrap();
    if rng.chance(0.3) {
        roads.retain(|road| road.street.bridge);
    }
    let p = if rng.chance(0.5) && !towns.is_empty() {
        let town = &towns[rng.index(towns.len())];
        town.centre.plan() + DVec2::new(rng.signed(), rng.signed()) * town.radius * 0.7
    } else if !roads.is_empty() {
        let road = &roads[rng.index(roads.len())];
        road.origin.to_plan(point_at(&road.street.line, rng.range(0.0, road.street.length())).0)
    } else {
        at
    };
    ChunkCoord::containing(p, world.settings().chunk_size)
}

/// A chunk without what stands on the ground and over it.
fn bare(world: &World, coord: ChunkCoord) -> Chunk {
    let mut chunk = (*world.chunk(coord, &Cancel::new()).unwrap()).clone();
    chunk.footprints.clear();
    chunk.decks.clear();
    chunk
}

type Corner = [u32; 3];

/// The edges of a chunk's ground and streets that are not the edge of another triangle the other way around, moved by whole
/// chunks.
fn open_edges(world: &World, chunk: &Chunk, by: IVec2) -> BTreeSet<[Corner; 2]> {
    let mesh = build(chunk, &**world.terrain(), Detail::Full, &Cancel::new()).unwrap();
    let shift = by.as_vec2() * chunk.size as f32;
    let corner = |p: [f32; 3]| [p[0] + shift.x, p[1], p[2] - shift.y].map(|x| (x + 0.0).to_bits());
    let mut edges: BTreeMap<[Corner; 2], i32> = BTreeMap::new();
    for part in [ChunkPart::Ground, ChunkPart::Roads] {
        let MeshBuffers { positions, indices, .. } = &mesh[part];
        for t in indices.chunks_exact(3) {
            for i in 0..3 {
                let [a, b] = [t[i], t[(i + 1) % 3]].map(|v| corner(positions[v as usize]));
                let (ends, count) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
                *edges.entry(ends).or_default() += count;
            }
        }
    }
    let open = edges.into_iter().filter(|(_, count)| *count != 0);
    open.map(|([a, b], count)| if count > 0 { [a, b] } else { [b, a] }).collect()
}

fn at(corner: Corner) -> Vec3 {
    Vec3::from_array(corner.map(f32::from_bits))
}

#[test]
fn ground_and_streets_have_no_open_edge_in_a_chunk_or_towards_the_next() {
    let (mut rng, mut streets) = (Seed(71).stream("solids", &[]), 0);
    for seed in 300..308 {
        let world = world(seed, &Settings::default());
        let coord = place(&world, &mut rng);
        let chunk = bare(&world, coord);
        let size = chunk.size as f32;
        streets += chunk.streets.len();
        let own = open_edges(&world, &chunk, IVec2::ZERO);
        let on = |edge: &[Corner; 2], axis: usize, line: f32| edge.iter().all(|corner| at(*corner)[axis] == line);
        let inner =
            own.iter().find(|e| ![(0, 0.0), (0, size), (2, 0.0), (2, -size)].iter().any(|(k, l)| on(e, *k, *l)));
        assert!(inner.is_none(), "seed {seed}, {coord}: open at {:?}", inner.map(|e| e.map(at)));
        for (by, axis, line) in [(IVec2::X, 0, size), (IVec2::Y, 2, -size)] {
            let next = bare(&world, ChunkCoord(coord.0 + by));
            let theirs: BTreeSet<_> = open_edges(&world, &next, by).into_iter().map(|[a, b]| [b, a]).collect();
            let [here, there] =
                [&own, &theirs].map(|edges| -> BTreeSet<_> { edges.iter().filter(|e| on(e, axis, line)).collect() });
            let differ = here.symmetric_difference(&there).next();
            assert!(differ.is_none(), "seed {seed}, {coord} and {by}: {:?}", differ.map(|e| e.map(at)));
        }
    }
    assert!(streets > 50, "{streets}");
}

/// Triangles that face up, with the part that they belong to.
type Faces = Vec<(ChunkPart, [Vec3; 3])>;

/// These triangles by squares of 8 m.
struct Tops(BTreeMap<(i32, i32), Faces>);

impl Tops {
    fn of(world: &World, chunk: &Chunk) -> Self {
        let mesh = build(chunk, &**world.terrain(), Detail::Full, &Cancel::new()).unwrap();
        let mut out: BTreeMap<(i32, i32), Faces> = BTreeMap::new();
        for part in [ChunkPart::Ground, ChunkPart::Roads] {
            for t in mesh[part].indices.chunks_exact(3) {
                let corners = [0, 1, 2].map(|i| Vec3::from(mesh[part].positions[t[i] as usize]));
                let bounds = Bounds::of(corners.map(plan));
                let [low, high] = [bounds.min, bounds.max].map(|p| (p / 8.0).floor().as_ivec2());
                for y in low.y..=high.y {
                    (low.x..=high.x).for_each(|x| out.entry((x, y)).or_default().push((part, corners)));
                }
            }
        }
        Self(out)
    }

    /// What a ray from above hits at a local point: the part and the height.
    fn hit(&self, p: DVec2) -> Option<(ChunkPart, f64)> {
        let over = |(part, corners): &(ChunkPart, [Vec3; 3])| {
            let [a, b, c] = corners.map(plan);
            let area = (b - a).perp_dot(c - a);
            let weights = [(b, c), (c, a), (a, b)].map(|(q, r)| (r - q).perp_dot(p - q) / area);
            let height = (0..3).map(|i| f64::from(corners[i].y) * weights[i]).sum::<f64>();
            (area > 0.0 && weights.iter().all(|w| *w >= 0.0)).then_some((*part, height))
        };
        let cell = (p / 8.0).floor().as_ivec2();
        let near = self.0.get(&(cell.x, cell.y))?;
        near.iter().filter_map(over).max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

fn plan(p: Vec3) -> DVec2 {
    DVec2::new(f64::from(p.x), f64::from(-p.z))
}

#[test]
fn a_ray_from_above_hits_a_street_at_the_height_that_one_walks_at() {
    let (mut rng, mut rays) = (Seed(72).stream("solids", &[]), 0);
    for seed in 320..328 {
        let world = world(seed, &Settings::default());
        let coord = place(&world, &mut rng);
        let chunk = bare(&world, coord);
        let tops = Tops::of(&world, &chunk);
        let streets: Vec<_> = chunk.streets_here().filter(|s| has_surface(s) && !s.bridge).collect();
        for _ in 0..if streets.is_empty() { 0 } else { 2500 } {
            let street = streets[rng.index(streets.len())];
            let (p, along) = point_at(&street.line, rng.range(0.0, street.length()));
            let p = p + along.perp() * rng.signed() * (street.class.carriageway() / 2.0 - 0.7);
            let Some(surface) = chunk.surface_at(p) else { continue };
            let height = world.height_at(chunk.origin.to_plan(p), &Cancel::new()).unwrap();
            let hit = tops.hit(p);
            let near = hit.is_some_and(|(part, top)| part == ChunkPart::Roads && (top - height).abs() < 0.01);
            assert!(near, "seed {seed}, {coord}: {p} is hit at {hit:?} and lies at {height}");
            assert!(surface.kind >= SurfaceKind::Carriageway, "seed {seed}, {coord}: {p} is {surface:?}");
            rays += 1;
        }
    }
    assert!(rays > 8000, "{rays}");
}

#[test]
fn streets_keep_the_grade_and_the_crests_of_their_class() {
    let mut rng = Seed(73).stream("solids", &[]);
    let (mut streets, mut steep) = (0, 0);
    for seed in 340..352 {
        let world = world(seed, &Settings::default());
        let chunk = bare(&world, place(&world, &mut rng));
        let mut bed = world.stack().road_bed();
        for street in chunk.streets_here().filter(|s| has_surface(s) && !s.bridge) {
            let profile = Profile::new(street, chunk.origin, |p| bed.height(p));
            streets += 1;
            if profile.is_steep() {
                steep += 1;
                continue;
            }
            let step = 2.0;
            let heights: Vec<f64> =
                (0..(street.length() / step) as usize).map(|i| profile.height(i as f64 * step)).collect();
            for w in heights.windows(2) {
                let grade = (w[1] - w[0]).abs() / step;
                let most = CrossSection::of(street.class).grade;
                assert!(grade < most + 1e-9, "seed {seed}: a grade of {grade} on a {}", street.class.name());
            }
        }
    }
    assert!(streets > 150 && steep * 20 < streets, "{steep} of {streets} streets are too steep");
}
