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
const MERGE: f64 = 300.0;

/// Roads of a world as it is by default.
fn world(seed: u64, merge: f64) -> Roads {
    let terrain = Arc::new(NoiseTerrain::new(Seed(seed), &TerrainSettings::default()));
    let settlements = Settlements::new(Seed(seed), &SettlementSettings::default(), terrain.clone(), 32 << 20);
    Roads::new(&with(merge), terrain, Arc::new(settlements), 256 << 20)
}

/// What a reader of the map would frown at.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Flaws {
    /// Pairs of pieces that keep closer than the merge distance over more than 2.5 times that.
    twins: usize,
    /// Pairs of pieces that leave a junction at less than 30 degrees.
    sharp: usize,
    /// Length of all pieces in kilometres.
    km: f64,
}

fn longest_run(a: &[DVec2], b: &[DVec2], limit: f64) -> f64 {
    const STEP: f64 = 20.0;
    let (mut run, mut longest) = (0.0, 0.0f64);
    for p in resample(a, STEP) {
        run = if distance_to_line(p, b) < limit { run + STEP } else { 0.0 };
        longest = longest.max(run);
    }
    longest
}

fn flaws(roads: &Roads, bounds: Bounds, limit: f64) -> Flaws {
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
    let in_town = |p: DVec2| outlines.iter().any(|o| point_in_polygon(p, o) || polygon_distance(p, p, o) < 330.0);
    let lines: Vec<Vec<DVec2>> =
        pieces.iter().map(|r| r.street.line.iter().map(|p| *p + r.origin.offset_to(origin)).collect()).collect();
    let mut out =
        Flaws { km: lines.iter().map(|l| crate::space::line_length(l)).sum::<f64>() / 1000.0, ..Flaws::default() };
    for (i, a) in lines.iter().enumerate() {
        let near = Bounds::of(a.iter().copied()).grown(limit);
        for b in lines[i + 1..].iter().filter(|b| near.overlaps(Bounds::of(b.iter().copied()))) {
            if longest_run(a, b, limit) > 2.5 * limit && longest_run(b, a, limit) > 2.5 * limit {
                out.twins += 1;
                if std::env::var("SHOW").is_ok() {
                    let k = resample(a, 20.0).into_iter().find(|p| distance_to_line(*p, b) < limit).unwrap();
                    eprintln!(
                        "twin {:.0} {:.0} at {}",
                        longest_run(a, b, limit),
                        longest_run(b, a, limit),
                        origin.to_plan(k)
                    );
                }
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
        for (i, (at, a)) in ways.iter().enumerate() {
            for (_, b) in &ways[i + 1..] {
                if angle_between(*a, *b) < 0.52 {
                    out.sharp += 1;
                    if std::env::var("SHOW").is_ok() {
                        eprintln!("sharp {:.0} deg at {}", angle_between(*a, *b).to_degrees(), origin.to_plan(*at));
                    }
                }
            }
        }
    }
    out
}

#[test]
fn measure() {
    let mut sums = [Flaws::default(); 2];
    for seed in 0..std::env::var("SEEDS").map_or(3, |s| s.parse().unwrap()) {
        for (merge, sum) in [0.0, 300.0].into_iter().zip(&mut sums) {
            let roads = world(100 + seed, merge);
            let t = std::time::Instant::now();
            all(&roads, Bounds::square(DVec2::new(seed as f64 * 31_000.0, -7_000.0), 4_000.0));
            let t = t.elapsed();
            let f = flaws(&roads, Bounds::square(DVec2::new(seed as f64 * 31_000.0, -7_000.0), 10_000.0), 300.0);
            eprintln!("{seed} {merge} {f:?} {t:?}");
            sum.twins += f.twins;
            sum.sharp += f.sharp;
            sum.km += f.km;
        }
    }
    eprintln!("{sums:?}");
}

#[test]
fn the_same_where_roads_merge_whatever_was_asked_before() {
    // Two roads become one for a while in each of these.
    for (seed, centre) in [(107, DVec2::new(215_300.0, -8_300.0)), (100, DVec2::new(2_113.0, -5_330.0))] {
        let kilometres = |merge: f64| flaws(&world(seed, merge), Bounds::square(centre, 2_500.0), MERGE).km;
        assert!(kilometres(MERGE) < kilometres(0.0) - 0.4);
        assert_same_whatever_was_asked(|| world(seed, MERGE), centre);
    }
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
