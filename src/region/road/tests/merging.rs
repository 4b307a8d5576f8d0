//! What merging leaves of the roads.

use super::overpass;
use super::*;
use crate::region::road::budget::Budget;
use crate::region::road::graph::Graphs;
use crate::region::road::merge::MergedGraphs;
use crate::region::road::tile;
use crate::space::{DisjointSets, distance_to_line, math::angle_between, point_at, polygon_distance, resample};

/// What a reader of the map would frown at, and where.
#[derive(Debug, Default)]
struct Flaws {
    /// Pairs of sections that keep closer than the merge distance over more than 2.5 times that.
    parallel: Vec<DVec2>,
    /// Pairs of sections that leave a junction at less than 30 degrees, or 26 where one is a ramp.
    sharp: Vec<DVec2>,
    /// Those of them further than 330 m from outlines.
    sharp_outside: Vec<DVec2>,
    /// Pieces that turn by more than 80 degrees within 60 m.
    spikes: Vec<DVec2>,
    /// Length of all sections in kilometres.
    km: f64,
}

/// Length of the longest stretch of `a` that keeps near `b`.
fn longest_run(a: &[DVec2], b: &[DVec2], limit: f64) -> f64 {
    let (mut run, mut longest) = (0.0, 0.0f64);
    for (p, q) in segments(&resample(a, 20.0)) {
        let near = |p: DVec2| distance_to_line(p, b) < limit;
        run = if near(p) && near(q) { run + p.distance(q) } else { 0.0 };
        longest = longest.max(run);
    }
    longest
}

/// Where a line turns most within 60 m, and by how much.
fn sharpest_turn(line: &[DVec2]) -> Option<(DVec2, f64)> {
    let even = resample(line, 5.0);
    let turns = even.windows(13).map(|w| (w[6], angle_between(w[6] - w[0], w[12] - w[6])));
    turns.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Flaws in a box.
fn flaws(roads: &Roads, bounds: Bounds) -> Flaws {
    let origin = Origin::at(bounds.centre());
    let sections = all(roads, bounds);
    assert_planar(&sections, origin);
    let outlines: Vec<Vec<DVec2>> = roads
        .searches
        .inputs
        .settlements
        .overlapping(bounds.grown(1_000.0))
        .unwrap()
        .iter()
        .map(|s| {
            let outline = roads.searches.inputs.settlements.outline(s).unwrap();
            let shift = outline.origin.offset_to(origin);
            outline.polygon.iter().map(|p| *p + shift).collect()
        })
        .collect();
    let in_town = |p: DVec2| outlines.iter().any(|o| point_in_polygon(p, o) || polygon_distance(p, p, o) < 330.0);
    let lines: Vec<Vec<DVec2>> =
        sections.iter().map(|r| r.street.line.iter().map(|p| *p + r.origin.offset_to(origin)).collect()).collect();
    let mut out =
        Flaws { km: lines.iter().map(|l| crate::space::line_length(l)).sum::<f64>() / 1000.0, ..Flaws::default() };
    for (i, a) in lines.iter().enumerate() {
        let near = Bounds::of(a.iter().copied()).grown(MERGE);
        for b in lines[i + 1..].iter().filter(|b| near.overlaps(Bounds::of(b.iter().copied()))) {
            if longest_run(a, b, MERGE).min(longest_run(b, a, MERGE)) > 2.5 * MERGE {
                out.parallel.push(origin.to_plan(point_at(a, crate::space::line_length(a) / 2.0).0));
            }
        }
        let turn = sharpest_turn(a).filter(|t| t.1 > 1.4);
        out.spikes.extend(turn.map(|t| origin.to_plan(t.0)));
    }
    let mut leaving: BTreeMap<JunctionId, Vec<(DVec2, DVec2, f64)>> = BTreeMap::new();
    // A ramp leaves a highway at a sharper angle on purpose.
    let least = |class| if class == StreetClass::Ramp { 0.45 } else { 0.52 };
    for (r, line) in sections.iter().zip(&lines) {
        let back: Vec<DVec2> = line.iter().rev().copied().collect();
        for (id, line) in [(r.street.from, line), (r.street.to, &back)] {
            leaving.entry(id).or_default().push((line[0], point_at(line, 60.0).0 - line[0], least(r.street.class)));
        }
    }
    for ways in leaving.values() {
        for (i, (at, a, least_a)) in ways.iter().enumerate() {
            for (_, b, least_b) in &ways[i + 1..] {
                if angle_between(*a, *b) < least_a.min(*least_b) {
                    out.sharp.push(origin.to_plan(*at));
                    out.sharp_outside.extend((!in_town(*at)).then(|| origin.to_plan(*at)));
                }
            }
        }
    }
    out
}

/// Flaws of windows of 10 km, in as many worlds.
fn flaws_of(windows: impl Iterator<Item = (u64, DVec2)>, merge: f64) -> Flaws {
    let mut sum = Flaws::default();
    for (seed, centre) in windows {
        let found = flaws(&world(seed, merge), Bounds::square(centre, 10_000.0));
        sum.parallel.extend(found.parallel);
        sum.sharp.extend(found.sharp);
        sum.sharp_outside.extend(found.sharp_outside);
        sum.spikes.extend(found.spikes);
        sum.km += found.km;
    }
    sum
}

/// Panics unless windows are without flaws.
fn assert_flawless(windows: impl Iterator<Item = (u64, DVec2)>, km: f64) {
    let found = flaws_of(windows, MERGE);
    assert!(found.parallel.is_empty() && found.spikes.is_empty() && found.sharp_outside.is_empty(), "{found:?}");
    // Near settlements a fork may have no room.
    assert!(found.sharp.len() <= 2 && found.km > km, "{found:?}");
}

#[test]
fn no_parallel_roads_sharp_forks_or_spikes_are_left_in_random_places() {
    assert_flawless((0..12).map(random_place), 800.0);
}

#[test]
fn nor_in_others() {
    assert_flawless((12..24).map(random_place), 600.0);
}

#[test]
fn nor_along_a_line_of_worlds() {
    let centre = |seed: u64| DVec2::new((seed - 100) as f64 * 31_000.0, -7_000.0);
    assert_flawless((100..109).map(|seed| (seed, centre(seed))), 600.0);
}

#[test]
fn no_road_crosses_another_to_come_back_to_it() {
    let found = flaws_of([random_place(70)].into_iter(), MERGE);
    assert!(found.spikes.is_empty() && found.km > 50.0, "{found:?}");
}

#[test]
fn flaws_are_there_without_merging() {
    let (before, after) = (flaws_of((0..8).map(random_place), 0.0), flaws_of((0..8).map(random_place), MERGE));
    assert!(before.sharp.len() > 8 && !before.parallel.is_empty(), "{before:?}");
    assert!(after.km > 0.95 * before.km, "{before:?} {after:?}");
}

#[test]
fn the_same_where_roads_merge_whatever_was_asked_before() {
    let mut places = 0;
    for seed in 100..110 {
        // Where a road has gone because another runs beside it.
        let window = Bounds::square(DVec2::new(-7_000.0, 31_000.0), 5_000.0);
        let merged = all(&world(seed, MERGE), window);
        let unmerged = all(&world(seed, 0.0), window);
        let gone = unmerged.iter().find(|r| !merged.iter().any(|m| m.street.line == r.street.line));
        let Some(gone) = gone else { continue };
        let centre = gone.origin.to_plan(point_at(&gone.street.line, gone.street.length() / 2.0).0);
        assert_same_whatever_was_asked(|| world(seed, MERGE), centre, 1_000.0);
        places += 1;
        if places == 2 {
            return;
        }
    }
    panic!("nothing merges");
}

#[test]
fn the_same_where_legs_are_realigned_whatever_was_asked_before() {
    let mut places = 0;
    for (seed, centre) in (0..24).map(random_place) {
        let roads = world(seed, MERGE);
        let cancel = Cancel::new();
        let middle = (centre / (tile::TILE_STEPS * roads.searches.inputs.step()) as f64).as_i64vec2();
        let (inputs, budget) = (&roads.searches.inputs, Budget::new(256 << 20));
        let graphs = Arc::new(Graphs::new(inputs.clone(), roads.routes.clone(), budget));
        let merged = MergedGraphs::new(inputs.clone(), graphs, budget);
        // Where a vertex is new.
        let moved = tile::tiles_around(middle, 3).find_map(|tile| {
            let before = merged.merged(tile, &cancel).unwrap();
            let after = merged.realigned(tile, &cancel).unwrap();
            after.vertices.iter().find(|(k, _)| !before.vertices.contains_key(k)).map(|(_, v)| v.position)
        });
        let Some(position) = moved else { continue };
        assert_same_whatever_was_asked(|| world(seed, MERGE), position.plan(), 1_000.0);
        places += 1;
        if places == 2 {
            return;
        }
    }
    panic!("nothing moves");
}

#[test]
fn what_was_connected_stays_connected() {
    // But for crossings on two levels, which join nothing.
    let world = |seed, merge| overpass::all_cross_by(&world(seed, merge), Crossing::Junction);
    for (seed, centre) in [(107, DVec2::new(215_300.0, -8_300.0)), (1, DVec2::ZERO), (3, DVec2::new(5e8, -3e8))] {
        let window = Bounds::square(centre, 9_000.0);
        let unmerged = world(seed, 0.0);
        let mut before = components(&all(&unmerged, window));
        let towns = unmerged.searches.inputs.settlements.centred_in(window, SizeClass::Village).unwrap();
        let gates = towns.iter().flat_map(|s| unmerged.gates(s, &Cancel::new()).unwrap());
        let gates: Vec<u64> = gates.map(|g| g.junction.0).collect();
        before.retain(|id, _| gates.contains(id));
        // The way round by which a way goes may leave the window.
        let after = components(&all(&world(seed, MERGE), window.grown(1_500.0)));
        let mut image: BTreeMap<u64, u64> = BTreeMap::new();
        for (gate, component) in &before {
            assert_eq!(image.entry(*component).or_insert(after[gate]), &after[gate], "{gate:?}");
        }
        assert!(before.len() > 20);
    }
}

/// The component of each junction of a graph of sections, as the id of one of its junctions.
fn components(sections: &[Arc<RoadSection>]) -> BTreeMap<u64, u64> {
    let mut sets = DisjointSets::new();
    for r in sections {
        sets.union(r.street.from.0, r.street.to.0);
    }
    let ids = sections.iter().flat_map(|r| [r.street.from.0, r.street.to.0]);
    ids.map(|id| (id, sets.find(id))).collect()
}
