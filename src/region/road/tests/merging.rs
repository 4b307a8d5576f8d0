//! What merging leaves of the roads.

use super::*;
use crate::space::{distance_to_line, math::angle_between, point_at, polygon_distance, resample};

/// A merge distance.
fn with(merge: f64) -> RoadSettings {
    RoadSettings { merge, ..RoadSettings::default() }
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
    let outlines: Vec<Vec<DVec2>> = roads.work.places.overlapping(bounds.grown(1_000.0)).unwrap().iter().map(|s| {
        let outline = roads.work.places.outline(s).unwrap();
        let shift = outline.origin.offset_to(origin);
        outline.polygon.iter().map(|p| *p + shift).collect()
    }).collect();
    let in_town = |p: DVec2| outlines.iter().any(|o| point_in_polygon(p, o) || polygon_distance(p, p, o) < 330.0);
    let lines: Vec<Vec<DVec2>> =
        pieces.iter().map(|r| r.street.line.iter().map(|p| *p + r.origin.offset_to(origin)).collect()).collect();
    let mut out = Flaws { km: lines.iter().map(|l| crate::space::line_length(l)).sum::<f64>() / 1000.0, ..Flaws::default() };
    for (i, a) in lines.iter().enumerate() {
        let near = Bounds::of(a.iter().copied()).grown(limit);
        for b in lines[i + 1..].iter().filter(|b| near.overlaps(Bounds::of(b.iter().copied()))) {
            if longest_run(a, b, limit) > 2.5 * limit && longest_run(b, a, limit) > 2.5 * limit {
                out.twins += 1;
                if std::env::var("SHOW").is_ok() {
                    let k = resample(a, 20.0).into_iter().find(|p| distance_to_line(*p, b) < limit).unwrap();
                    eprintln!("twin {:.0} {:.0} at {}", longest_run(a, b, limit), longest_run(b, a, limit), origin.to_plan(k));
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
            let roads = roads(100 + seed, false, &with(merge));
            let t = std::time::Instant::now();
            let f = flaws(&roads, Bounds::square(DVec2::new(seed as f64 * 31_000.0, -7_000.0), 10_000.0), 300.0);
            eprintln!("{seed} {merge} {f:?} {:?}", t.elapsed());
            sum.twins += f.twins;
            sum.sharp += f.sharp;
            sum.km += f.km;
        }
    }
    eprintln!("{sums:?}");
}
