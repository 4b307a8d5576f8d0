//! Ground and streets of chunks as one surface.

use bevy_sprawl::chunk::Chunk;
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::SizeClass;
use bevy_sprawl::space::{Bounds, ChunkCoord, Seed, line_length, point_at};
use bevy_sprawl::surface::{Finish, SurfaceKind};
use bevy_sprawl::world::{World, WorldSource};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

fn world(seed: u64) -> World {
    World::new(WorldSource::new(Seed(seed))).unwrap()
}

fn chunk(world: &World, x: i32, y: i32) -> Arc<Chunk> {
    world.chunk(ChunkCoord::new(x, y), &Cancel::new()).unwrap()
}

/// Chunks around the largest town within 15 km, and in the middle of a road out of it.
fn places(world: &World) -> Vec<ChunkCoord> {
    let mut towns = world.settlements().overlapping(Bounds::square(DVec2::ZERO, 30_000.0)).unwrap();
    towns.retain(|t| t.size != SizeClass::Village);
    towns.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    let Some(town) = towns.first() else { return Vec::new() };
    let size = world.settings().chunk_size;
    let middle = ChunkCoord::containing(town.centre.plan(), size).0;
    let edge = ChunkCoord::containing(town.centre.plan() + DVec2::X * town.radius, size).0;
    [(middle.x, middle.y), (middle.x + 1, middle.y), (middle.x, middle.y + 1), (edge.x, edge.y)]
        .map(|(x, y)| ChunkCoord::new(x, y))
        .to_vec()
}

/// What a chunk has on one side of its square: plan position along the side, height, finish and whether the ground is raised.
fn border(chunk: &Chunk, axis: usize, at: f64) -> BTreeSet<(u32, u32, Finish)> {
    let tin = &chunk.tin;
    let mut out = BTreeSet::new();
    for (corners, finish) in &tin.triangles {
        for i in 0..3 {
            let ends = [corners[i], corners[(i + 1) % 3]];
            if ends.iter().all(|v| tin.points[*v as usize][axis] == at) {
                for v in ends {
                    let along = tin.points[v as usize][1 - axis] as f32;
                    out.insert((along.to_bits(), (tin.height_of(v, *finish) as f32).to_bits(), *finish));
                }
            }
        }
    }
    out
}

#[test]
fn the_surface_covers_a_chunk_once_and_meets_the_next_to_the_bit() {
    let mut streets = 0;
    for seed in [7, 31, 42] {
        let world = world(seed);
        for coord in places(&world) {
            let here = chunk(&world, coord.0.x, coord.0.y);
            let (tin, edge) = (&here.tin, here.size as f64);
            let mut sides: BTreeMap<[u32; 2], [u32; 2]> = BTreeMap::new();
            let mut area = 0.0;
            for (corners, finish) in &tin.triangles {
                let [a, b, c] = corners.map(|v| tin.points[v as usize].truncate());
                let own = (b - a).perp_dot(c - a) / 2.0;
                assert!(own > 0.0, "{seed} {coord}: a triangle is flipped or empty at {a}");
                area += own;
                streets += usize::from(*finish != Finish::Ground);
                for i in 0..3 {
                    let (a, b) = (corners[i], corners[(i + 1) % 3]);
                    sides.entry([a.min(b), a.max(b)]).or_default()[usize::from(a < b)] += 1;
                }
            }
            // Triangles that all run the same way, have every inner edge in common with one other, and have the area of the
            // square together overlap nowhere.
            assert!((area - edge * edge).abs() < 1e-6, "{seed} {coord}: {area}");
            for (ends, count) in sides {
                let [a, b] = ends.map(|v| tin.points[v as usize].truncate());
                let on_border = (0..2).any(|k| a[k] == b[k] && (a[k] == 0.0 || a[k] == edge));
                let open = if on_border { count[0] + count[1] != 1 } else { count != [1, 1] };
                assert!(!open, "{seed} {coord}: an edge is open from {a} to {b}: {count:?}");
            }
            for (x, y, axis) in [(1, 0, 0), (0, 1, 1)] {
                let next = chunk(&world, coord.0.x + x, coord.0.y + y);
                assert_eq!(border(&here, axis, edge), border(&next, axis, 0.0), "{seed} {coord}");
            }
        }
    }
    assert!(streets > 20_000, "{streets}");
}

#[test]
fn streets_are_carriageway_where_they_run_and_no_order_changes_a_surface() {
    let (one, other) = (world(31), world(31));
    let coords = places(&one);
    for coord in coords.iter().rev() {
        chunk(&other, coord.0.x, coord.0.y);
    }
    for coord in coords {
        let here = chunk(&one, coord.0.x, coord.0.y);
        let there = chunk(&other, coord.0.x, coord.0.y);
        assert_eq!((&here.tin.points, &here.tin.triangles), (&there.tin.points, &there.tin.triangles), "{coord}");
        for street in here.streets.iter().map(|s| &s.street).filter(|s| !s.bridge && !s.tunnel) {
            for k in 0..20 {
                let (p, along) = point_at(&street.line, line_length(&street.line) * (f64::from(k) + 0.5) / 20.0);
                let p = p + along.perp() * street.class.carriageway() * 0.4 * f64::from(k % 3 - 1);
                if let Some(surface) = here.surface_at(p) {
                    assert!(surface.kind >= SurfaceKind::Carriageway, "{coord}: {p} is {surface:?}");
                    let height = one.height_at(here.origin.to_plan(p), &Cancel::new()).unwrap();
                    assert!((height - surface.height).abs() < 1e-6, "{coord}: {height} {surface:?}");
                }
            }
        }
    }
}

/// Walks a line through loaded chunks as the plugin's walkers do; returns the largest step between two points 0.25 m apart.
fn walk(world: &World, line: &[DVec2]) -> f64 {
    let mut feet: Option<f64> = None;
    let mut largest = 0.0f64;
    for k in 0..(line_length(line) / 0.25) as usize {
        let p = point_at(line, k as f64 * 0.25).0;
        let coord = ChunkCoord::containing(p, world.settings().chunk_size);
        let here = world.chunk(coord, &Cancel::new()).unwrap();
        let below = feet.map_or(f64::INFINITY, |y| y + 0.5);
        let height = here.surface(here.origin.to_local(p), below).unwrap();
        largest = largest.max(feet.map_or(0.0, |y| (height - y).abs()));
        feet = Some(height);
    }
    largest
}

#[test]
fn one_walks_over_bridges_without_a_fall() {
    let (mut bridges, mut worst) = (0, 0.0f64);
    for seed in [42, 5] {
        let world = world(seed);
        let roads = world.roads().overlapping(Bounds::square(DVec2::ZERO, 12_000.0), &Cancel::new()).unwrap();
        for road in roads.iter().filter(|r| r.street.bridge).take(8) {
            // The roads that go on at both ends.
            let beyond = |end, at: DVec2| -> Vec<DVec2> {
                let next =
                    roads.iter().find(|r| r.street.id != road.street.id && [r.street.from, r.street.to].contains(&end));
                let Some(next) = next else { return vec![at] };
                let mut line: Vec<DVec2> = next.street.line.iter().map(|p| next.origin.to_plan(*p)).collect();
                if next.street.to == end {
                    line.reverse();
                }
                bevy_sprawl::space::cut_line(&line, 0.0, 30.0)
            };
            let own: Vec<DVec2> = road.street.line.iter().map(|p| road.origin.to_plan(*p)).collect();
            let mut line = beyond(road.street.from, own[0]);
            line.reverse();
            line.extend(&own);
            line.extend(beyond(road.street.to, own[own.len() - 1]));
            line.dedup();
            bridges += 1;
            worst = worst.max(walk(&world, &line));
        }
    }
    assert!(bridges > 8 && worst < 0.2, "{bridges} bridges, a step of {worst} m");
}
