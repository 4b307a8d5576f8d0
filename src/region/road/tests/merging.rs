//! What merging leaves of the roads.

use super::*;
use crate::region::SettlementSettings;
use crate::space::Seed;
use crate::space::{distance_to_line, math::angle_between, point_at, polygon_distance, resample};
use crate::terrain::{NoiseTerrain, TerrainSettings};

/// A merge distance.
fn with(merge: f64) -> RoadSettings {
    RoadSettings { merge, ..RoadSettings::default() }
}

/// The default merge distance.
const MERGE: f64 = 275.0;

/// Roads of a world as it is by default.
pub fn world(seed: u64, merge: f64) -> Roads {
    let terrain = Arc::new(NoiseTerrain::new(Seed(seed), &TerrainSettings::default()));
    let settlements = Settlements::new(Seed(seed), &SettlementSettings::default(), terrain.clone(), 32 << 20);
    Roads::new(&with(merge), terrain, Arc::new(settlements), 256 << 20)
}

/// A world and a place in it, drawn.
pub fn drawn(i: u64) -> (u64, DVec2) {
    let mut stream = Seed(2026).stream("merging", &[i]);
    let seed = stream.range(0.0, 1e9) as u64;
    (seed, DVec2::new(stream.range(-4e5, 4e5), stream.range(-4e5, 4e5)).round())
}

/// What a reader of the map would frown at, and where.
#[derive(Debug, Default)]
struct Flaws {
    /// Pairs of pieces that keep closer than the merge distance over more than 2.5 times that.
    twins: Vec<DVec2>,
    /// Pairs of pieces that leave a junction at less than 30 degrees.
    sharp: Vec<DVec2>,
    /// Length of all pieces in kilometres.
    km: f64,
}

/// Length of the longest stretch of `a` that keeps near `b`, where `counts` holds.
fn longest_run(a: &[DVec2], b: &[DVec2], limit: f64, counts: impl Fn(DVec2) -> bool) -> f64 {
    const STEP: f64 = 20.0;
    let (mut run, mut longest) = (0.0, 0.0f64);
    for p in resample(a, STEP) {
        run = if distance_to_line(p, b) < limit && counts(p) { run + STEP } else { 0.0 };
        longest = longest.max(run);
    }
    longest
}

/// Flaws in a box, but within `town` metres of an outline.
fn flaws(roads: &Roads, bounds: Bounds, limit: f64, town: f64) -> Flaws {
    let origin = Origin::at(bounds.centre());
    let pieces = all(roads, bounds);
    assert_planar(&pieces, origin);
    let outlines: Vec<Vec<DVec2>> = roads
        .work
        .places
        .overlapping(bounds.grown(1_000.0))
        .unwrap()
        .iter()
        .map(|s| {
            let outline = roads.work.places.outline(s).unwrap();
            let shift = outline.origin.offset_to(origin);
            outline.polygon.iter().map(|p| *p + shift).collect()
        })
        .collect();
    let in_town = |p: DVec2| outlines.iter().any(|o| point_in_polygon(p, o) || polygon_distance(p, p, o) < town);
    let lines: Vec<Vec<DVec2>> =
        pieces.iter().map(|r| r.street.line.iter().map(|p| *p + r.origin.offset_to(origin)).collect()).collect();
    let mut out =
        Flaws { km: lines.iter().map(|l| crate::space::line_length(l)).sum::<f64>() / 1000.0, ..Flaws::default() };
    for (i, a) in lines.iter().enumerate() {
        let near = Bounds::of(a.iter().copied()).grown(limit);
        for b in lines[i + 1..].iter().filter(|b| near.overlaps(Bounds::of(b.iter().copied()))) {
            let run = |a, b| longest_run(a, b, limit, |p| !in_town(p));
            if run(a, b) > 2.5 * limit && run(b, a) > 2.5 * limit {
                out.twins.push(origin.to_plan(point_at(a, crate::space::line_length(a) / 2.0).0));
            }
        }
    }
    let mut leaving: BTreeMap<JunctionId, Vec<(DVec2, DVec2)>> = BTreeMap::new();
    for (r, line) in pieces.iter().zip(&lines) {
        let back: Vec<DVec2> = line.iter().rev().copied().collect();
        for (id, line) in [(r.street.from, line), (r.street.to, &back)] {
            leaving.entry(id).or_default().push((line[0], point_at(line, 60.0).0 - line[0]));
        }
    }
    for ways in leaving.values().filter(|w| !in_town(w[0].0)) {
        for (i, (_, a)) in ways.iter().enumerate() {
            for (_, b) in &ways[i + 1..] {
                if angle_between(*a, *b) < 0.52 {
                    out.sharp.push(origin.to_plan(ways[i].0));
                }
            }
        }
    }
    out
}

/// Flaws of windows of 10 km, in as many worlds.
fn flaws_of(seeds: std::ops::Range<u64>, merge: f64, town: f64) -> Flaws {
    let mut sum = Flaws::default();
    for seed in seeds {
        let centre = DVec2::new((seed - 100) as f64 * 31_000.0, -7_000.0);
        let found = flaws(&world(seed, merge), Bounds::square(centre, 10_000.0), MERGE, town);
        sum.twins.extend(found.twins);
        sum.sharp.extend(found.sharp);
        sum.km += found.km;
    }
    sum
}

#[test]
fn no_twins_are_left() {
    // Nearer to a settlement roads lead to gates of their own.
    let after = flaws_of(100..108, MERGE, 200.0);
    assert!(after.twins.is_empty() && after.km > 500.0, "{after:?}");
}

#[test]
fn most_sharp_forks_go() {
    // What stays are forks at ties, which lead straight to their gates.
    let (before, after) = (flaws_of(100..105, 0.0, 0.0), flaws_of(100..105, MERGE, 0.0));
    assert!(before.sharp.len() > 8 && after.sharp.len() * 2 < before.sharp.len(), "{before:?} {after:?}");
    assert!(after.twins.len() <= before.twins.len() && after.km > 0.95 * before.km, "{before:?} {after:?}");
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
fn what_was_connected_stays_connected() {
    for (seed, centre) in [(107, DVec2::new(215_300.0, -8_300.0)), (1, DVec2::ZERO), (3, DVec2::new(5e8, -3e8))] {
        let window = Bounds::square(centre, 9_000.0);
        let unmerged = world(seed, 0.0);
        let mut before = components(&all(&unmerged, window));
        let towns = unmerged.work.places.of_tier(window, SizeClass::Village).unwrap();
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

/// The component of each junction of a graph of pieces.
fn components(pieces: &[Arc<Road>]) -> BTreeMap<u64, u64> {
    let mut parent: BTreeMap<JunctionId, JunctionId> = BTreeMap::new();
    fn root(parent: &mut BTreeMap<JunctionId, JunctionId>, id: JunctionId) -> JunctionId {
        let mut at = id;
        while let Some(up) = parent.get(&at).copied().filter(|up| *up != at) {
            at = up;
        }
        parent.insert(id, at);
        at
    }
    for r in pieces {
        let (a, b) = (root(&mut parent, r.street.from), root(&mut parent, r.street.to));
        parent.insert(b, a);
    }
    let ids: Vec<JunctionId> = parent.keys().copied().collect();
    ids.into_iter().map(|id| (id.0, root(&mut parent, id).0)).collect()
}
