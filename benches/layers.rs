//! Each layer by itself, and a whole chunk in the middle of a city, on one thread.

mod clock;

use bevy_sprawl::chunk::Ground;
use bevy_sprawl::layer::{Cancel, Reach};
use bevy_sprawl::mesh::{self, Detail};
use bevy_sprawl::network::SizeClass;
use bevy_sprawl::network::Street;
use bevy_sprawl::region::Settlement;
use bevy_sprawl::space::{Bounds, ChunkCoord, Seed};
use bevy_sprawl::surface::{Earthworks, Graded, Profile, SURFACE_REACH, Tin, cover, shapes};
use bevy_sprawl::world::{World, WorldAssets, WorldSource};
use bevy_sprawl::{seam, town};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use glam::DVec2;
use spade::{DelaunayTriangulation, Point2, Triangulation};
use std::hint::black_box;
use std::sync::Arc;

/// Worlds in which the region work for a first chunk is timed.
const COLD: u64 = 16;

fn world(seed: u64) -> World {
    World::new(WorldSource::new(Seed(seed))).expect("the bundled world is valid")
}

/// The settlement of a size nearest to the world's origin, which every seed has within some lattice cells.
fn nearest(world: &World, size: SizeClass) -> Arc<Settlement> {
    let bounds = Bounds::square(DVec2::ZERO, 100_000.0);
    let all = world.settlements().centred_in_of(bounds, size).expect("never cancelled");
    let from_origin = |s: &Arc<Settlement>| s.centre.plan().length();
    all.into_iter().min_by(|a, b| from_origin(a).total_cmp(&from_origin(b))).expect("a settlement within 50 km")
}

/// A place in a world: by its seed in a city, a town, a village, or anywhere.
fn place(seed: u64) -> DVec2 {
    match SizeClass::ALL.get(seed as usize % 4) {
        Some(size) => nearest(&world(seed), *size).centre.plan(),
        None => {
            let mut random = Seed(seed).stream("bench", &[]);
            DVec2::new(random.signed(), random.signed()) * 30_000.0
        }
    }
}

/// What a new world takes until the roads of its first chunk are there, in places of all kinds, each in a world of its own.
fn cold(_: &mut Criterion) {
    let assets = WorldAssets::bundled();
    let time = |seed: u64| {
        let at = place(seed);
        let once = || {
            let world = World::new(WorldSource { assets: assets.clone(), ..WorldSource::new(Seed(seed)) });
            let world = world.expect("the bundled world is valid");
            let size = world.settings().chunk_size;
            let bounds = ChunkCoord::containing(at, size).bounds(size);
            world.roads().overlapping(bounds, &Cancel::new()).expect("never cancelled").len()
        };
        // The best of three: other work on the machine counts less.
        (0..3).map(|_| clock::timed(once).0.as_secs_f64() * 1e3).fold(f64::INFINITY, f64::min)
    };
    let mut times: Vec<f64> = (1..=COLD).map(time).collect();
    times.sort_by(f64::total_cmp);
    let (mean, middle) = (times.iter().sum::<f64>() / COLD as f64, times.len() / 2);
    let (median, slowest) = ((times[middle - 1] + times[middle]) / 2.0, times[times.len() - 1]);
    println!(
        "region/cold, one chunk: mean {mean:.0} ms, median {median:.0} ms, slowest {slowest:.0} ms of {COLD} worlds"
    );
}

fn layers(c: &mut Criterion) {
    let world = world(1);
    let never = Cancel::new();
    let city = nearest(&world, SizeClass::City);
    let size = world.settings().chunk_size;
    let centre = city.centre.plan();
    let coord = ChunkCoord::containing(centre, size);
    let seamed = world.town(&city, &never).expect("never cancelled");
    let kit = &world.assets().styles[&city.style];

    c.bench_function("terrain/sample", |b| {
        let mut p = DVec2::ZERO;
        b.iter(|| {
            p += DVec2::new(13.7, 7.1);
            black_box(world.terrain().sample(p))
        })
    });
    c.bench_function("region/cold 4 km box", |b| {
        let bounds = Bounds::square(centre, 4000.0);
        b.iter_batched(
            || self::world(1),
            |w| black_box(w.roads().overlapping(bounds, &never).expect("never cancelled").len()),
            BatchSize::PerIteration,
        )
    });
    c.bench_function("region/512 m on, 3 km around", |b| {
        // A flight at 100 m/s takes 5.12 s for it; 5 % of a core are 256 ms.
        let world = self::world(2);
        let mut at = centre;
        let mut go = || {
            at.x += 512.0;
            black_box(world.roads().overlapping(Bounds::square(at, 3000.0), &never).expect("never cancelled").len());
        };
        (0..20).for_each(|_| go());
        b.iter(go)
    });
    c.bench_function("town/plan a city", |b| {
        let (outline, gates) = (&seamed.town.outline, &seamed.town.gates);
        b.iter(|| town::plan(world.seed(), &city, outline, gates.clone(), kit, &**world.terrain(), &never))
    });
    let styles = vec![&**kit; seamed.town.cells.len()];
    c.bench_function("seam/all of a city", |b| b.iter(|| seam::seams(world.seed(), &seamed.town, &styles, &[])));
    c.bench_function("streets/all cells of a city", |b| {
        b.iter_batched(
            || world.forget_chunks(),
            |()| {
                (0..seamed.town.cells.len())
                    .map(|i| world.stack().streets(&seamed, i, &never).expect("never cancelled").streets.len())
                    .sum::<usize>()
            },
            BatchSize::PerIteration,
        )
    });
    let streets_of_cells = || {
        (0..seamed.town.cells.len())
            .map(|i| world.stack().streets(&seamed, i, &never).expect("never cancelled"))
            .collect::<Vec<_>>()
    };
    c.bench_function("surface/cover, all cells of a city", |b| {
        let cells = streets_of_cells();
        let cells: Vec<Vec<&Street>> = cells
            .iter()
            .map(|cell| cell.streets.iter().map(|s| &s.street).chain(&seamed.mains.streets).collect())
            .collect();
        b.iter(|| cells.iter().map(|streets| cover(streets, 0.0).len()).sum::<usize>())
    });
    c.bench_function("parcel/all cells of a city", |b| {
        b.iter_batched(
            || {
                world.forget_chunks();
                streets_of_cells()
            },
            |_| {
                (0..seamed.town.cells.len())
                    .map(|i| world.stack().parcels(&seamed, i, &never).expect("never cancelled").lots.len())
                    .sum::<usize>()
            },
            BatchSize::PerIteration,
        )
    });
    c.bench_function("chunk/ground", |b| b.iter(|| Ground::new(&**world.terrain(), coord.origin(size), size)));
    surfaces(c, &world, coord);
    c.bench_function("chunk/dense, town planned", |b| {
        b.iter_batched(
            || world.forget_chunks(),
            |()| world.chunk(coord, &never).expect("never cancelled"),
            BatchSize::PerIteration,
        )
    });
    c.bench_function("chunk/first in a new world", |b| {
        b.iter_batched(|| self::world(1), |w| w.chunk(coord, &never).expect("never cancelled"), BatchSize::PerIteration)
    });
    let chunk = world.chunk(coord, &never).expect("never cancelled");
    for detail in [Detail::Full, Detail::Reduced] {
        c.bench_function(&format!("mesh/{detail:?}"), |b| {
            b.iter(|| mesh::build(&chunk, &**world.terrain(), detail, &never).expect("never cancelled"))
        });
    }
}

/// Each step of a chunk's ground and streets, and the floor: triangulating as many points once.
fn surfaces(c: &mut Criterion, world: &World, coord: ChunkCoord) {
    let never = Cancel::new();
    let size = world.settings().chunk_size;
    let (origin, bounds) = (coord.origin(size), coord.bounds(size));
    let square = Bounds::new(DVec2::ZERO, DVec2::splat(size as f64));
    let reach = Reach::new("bench", bounds, SURFACE_REACH);
    let overlap = world.stack().overlapping(bounds.grown(SURFACE_REACH), &reach, &never).expect("never cancelled");
    let streets: Vec<Street> =
        overlap.streets.iter().map(|s| s.item.street.moved(s.origin.offset_to(origin))).collect();
    let mut bed = world.stack().road_bed();
    let mut grade = || -> Vec<Graded> {
        let graded = |s: &Street| Graded { street: s.clone(), profile: Profile::new(s, origin, |p| bed.height(p)) };
        streets.iter().map(graded).collect()
    };
    let graded = grade();
    let elements = shapes(&graded, square, world.settings().driving);
    let chunk = world.chunk(coord, &never).expect("never cancelled");
    let tin = || {
        let works = Earthworks::new(graded.iter().map(|g| (&g.street, &g.profile)), square);
        Tin::new(&elements, size, |column, row| {
            works.height(DVec2::new(column as f64, row as f64) * 8.0, chunk.ground.vertex(column, row).height)
        })
    };
    let made = tin();
    let (points, triangles) = (made.points.len(), made.triangles.len());
    println!("surface of a dense chunk: {} streets, {points} points, {triangles} triangles", streets.len());
    c.bench_function("surface/profiles of a dense chunk", |b| b.iter(|| grade().len()));
    c.bench_function("surface/shapes of a dense chunk", |b| {
        b.iter(|| shapes(&graded, square, world.settings().driving).len())
    });
    c.bench_function("surface/ground and streets of a dense chunk", |b| b.iter(|| tin().triangles.len()));
    c.bench_function("surface/floor: its points triangulated once", |b| {
        let points: Vec<Point2<f64>> = made.points.iter().map(|p| Point2::new(p.x, p.y)).collect();
        b.iter(|| DelaunayTriangulation::<Point2<f64>>::bulk_load(points.clone()).map(|t| t.num_vertices()))
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = cold, layers
}
criterion_main!(benches);
