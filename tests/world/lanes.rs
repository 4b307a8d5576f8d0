//! Lanes of a whole town, across chunks.

use crate::world;
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::{JunctionId, Side, SizeClass, Traffic};
use bevy_sprawl::space::{Bounds, ChunkCoord, Seed, line_length};
use bevy_sprawl::surface::{Lane, LaneId, Turn, TurnKind};
use bevy_sprawl::world::{Settings, World};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// Lanes and turns of many chunks, all local to one origin.
#[derive(Default)]
struct Lanes {
    lanes: BTreeMap<LaneId, Lane>,
    turns: BTreeMap<LaneId, Vec<Turn>>,
    /// Junctions whose streets, and their other ends, are all known.
    inner: BTreeSet<JunctionId>,
    /// The junctions where each lane begins and ends.
    ends: BTreeMap<LaneId, (JunctionId, JunctionId)>,
}

fn lanes_around(world: &World, centre: DVec2, chunks: i32, driving: Side) -> Lanes {
    let size = world.settings().chunk_size;
    let middle = ChunkCoord::containing(centre, size);
    let origin = middle.origin(size);
    let mut out = Lanes::default();
    for (x, y) in (-chunks..=chunks).flat_map(|y| (-chunks..=chunks).map(move |x| (x, y))) {
        let coord = ChunkCoord::new(middle.0.x + x, middle.0.y + y);
        let chunk = world.chunk(coord, &Cancel::new()).expect("nothing is cancelled");
        let shift = chunk.origin.offset_to(origin);
        let moved = |line: Vec<DVec2>| line.into_iter().map(|p| p + shift).collect();
        let lanes = chunk.lanes(driving);
        let ends: BTreeMap<_, _> = chunk.streets.iter().map(|s| (s.street.id, (s.street.from, s.street.to))).collect();
        for lane in lanes.lanes {
            let (from, to) = ends[&lane.street];
            out.ends.insert(lane.id, if lane.along { (from, to) } else { (to, from) });
            let lane = Lane { line: moved(lane.line), ..lane };
            assert!(out.lanes.insert(lane.id, lane).is_none(), "a lane is owned once");
        }
        for junction in lanes.junctions {
            out.inner.insert(junction.junction);
            for turn in junction.turns {
                let turn = Turn { line: moved(turn.line), ..turn };
                out.turns.entry(turn.from).or_default().push(turn);
            }
        }
    }
    out
}

/// A city of the world.
fn city(world: &World) -> Option<DVec2> {
    let found = world.settlements().centred_in(Bounds::square(DVec2::ZERO, 40_000.0)).expect("nothing is cancelled");
    found.iter().find(|s| s.size == SizeClass::City).map(|s| s.centre.plan())
}

#[test]
fn traffic_never_jumps_and_never_ends_but_where_streets_do() {
    let mut rng = Seed(20).stream("drives", &[]);
    let (mut driven, mut ended) = (0, 0);
    for seed in [40_117, 977] {
        let world = world(seed, &Settings::default());
        let Some(centre) = city(&world) else { continue };
        let driving = if seed % 2 == 0 { Side::Left } else { Side::Right };
        let all = lanes_around(&world, centre, 2, driving);
        let reached: BTreeSet<LaneId> = all.turns.values().flatten().map(|t| t.to).collect();
        for (id, lane) in &all.lanes {
            let (begins, ends) = all.ends[id];
            assert!(!all.inner.contains(&ends) || all.turns.contains_key(id), "{lane:?} leads nowhere");
            assert!(!all.inner.contains(&begins) || reached.contains(id), "nothing leads to {lane:?}");
        }
        let ids: Vec<LaneId> = all.lanes.keys().copied().collect();
        for _ in 0..300 {
            let mut lane = &all.lanes[&ids[rng.index(ids.len())]];
            let (mut way, mut at) = (0.0, lane.line[0]);
            while way < 2000.0 {
                assert_eq!(at, lane.line[0]);
                way += line_length(&lane.line);
                at = lane.line[lane.line.len() - 1];
                let Some(turns) = all.turns.get(&lane.id) else { break };
                let turn = &turns[rng.index(turns.len())];
                ended += usize::from(turn.kind == TurnKind::Back);
                assert_eq!(at, turn.line[0], "a turn begins where its lane ends");
                way += line_length(&turn.line);
                at = turn.line[turn.line.len() - 1];
                let Some(next) = all.lanes.get(&turn.to) else { break };
                lane = next;
            }
            driven += usize::from(way >= 2000.0);
        }
    }
    assert!(driven > 300 && ended > 20, "{driven} drives, {ended} turned back");
}

#[test]
fn roundabouts_of_towns_are_driven_one_way() {
    let mut rings = 0;
    for seed in 30..36 {
        let world = world(seed, &Settings::default());
        let Some(centre) = city(&world) else { continue };
        let size = world.settings().chunk_size;
        let middle = ChunkCoord::containing(centre, size);
        // How many streets of rings lead away from each junction, and how many to it.
        let mut ways: BTreeMap<JunctionId, [usize; 2]> = BTreeMap::new();
        for (x, y) in (-2..=2).flat_map(|y| (-2..=2).map(move |x| (x, y))) {
            let coord = ChunkCoord::new(middle.0.x + x, middle.0.y + y);
            let chunk = world.chunk(coord, &Cancel::new()).expect("nothing is cancelled");
            for street in chunk.streets.iter().map(|s| &s.street).filter(|s| s.island.is_some()) {
                let along = street.traffic(Side::Right) == Traffic::Along;
                let (from, to) = if along { (street.from, street.to) } else { (street.to, street.from) };
                ways.entry(from).or_default()[0] += 1;
                ways.entry(to).or_default()[1] += 1;
            }
        }
        // A ring across the border of the outermost chunks is not whole.
        rings += ways.values().filter(|ways| **ways == [1, 1]).count();
        assert!(ways.values().all(|[out, back]| *out <= 1 && *back <= 1), "seed {seed}: {ways:?}");
    }
    assert!(rings > 12, "{rings} junctions on rings");
}
