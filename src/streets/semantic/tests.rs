//! The promises of a filled cell, checked by brute force on its final streets.

use super::SemanticPatches;
use super::sample::{Kit, Sample};
use crate::layer::{Cancel, LayerError};
use crate::network::{JunctionId, Street};
use crate::seam::STUB_LENGTH;
use crate::space::{
    cut_line, distance_to_line, line_length, math::angle_between, point_in_polygon, quantize, segment_crossing,
    segment_distance, segments,
};
use crate::streets::{CellFiller, CellStreets, MadeBy};
use crate::style::FieldKind;
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

/// Fills a cell.
pub(super) fn fill(cell: &Sample<'_>) -> CellStreets {
    SemanticPatches.fill(&cell.brief(), &Cancel::new()).expect("nobody cancelled")
}

fn line_distance(a: &[DVec2], b: &[DVec2]) -> f64 {
    segments(a).flat_map(|x| segments(b).map(move |y| segment_distance(x.0, x.1, y.0, y.1))).fold(f64::MAX, f64::min)
}

/// Everything that is wrong with a filled cell.
pub(super) fn defects(cell: &Sample<'_>, out: &CellStreets) -> Vec<String> {
    let mut bad = Vec::new();
    let mut places: BTreeMap<JunctionId, DVec2> = BTreeMap::new();
    for j in &out.junctions {
        if places.insert(j.id, j.at).is_some() {
            bad.push(format!("junction {:?} twice", j.id));
        }
    }
    let ports: BTreeMap<JunctionId, DVec2> = cell.ports.iter().map(|p| (p.junction, p.at)).collect();
    for (id, at) in &ports {
        if places.insert(*id, *at).is_some() {
            bad.push("port among the junctions".into());
        }
    }
    let streets: Vec<&Street> = out.streets.iter().map(|s| &s.street).collect();
    if streets.iter().map(|s| s.id).collect::<BTreeSet<_>>().len() != streets.len() {
        bad.push("street id twice".into());
    }
    if !out.unmet.is_empty() {
        bad.push(format!("{} unmet ports", out.unmet.len()));
    }
    let mut degree: BTreeMap<JunctionId, Vec<DVec2>> = BTreeMap::new();
    for s in &streets {
        let n = s.line.len();
        if places.get(&s.from) != Some(&s.line[0]) || places.get(&s.to) != Some(&s.line[n - 1]) || s.from == s.to {
            bad.push(format!("street ends {:?} are not its junctions", s.line));
        }
        if s.line.iter().any(|p| quantize(*p) != *p) || segments(&s.line).any(|(a, b)| a == b) {
            bad.push("line off the grid or with a point twice".into());
        }
        degree.entry(s.from).or_default().push(s.line[1] - s.line[0]);
        degree.entry(s.to).or_default().push(s.line[n - 2] - s.line[n - 1]);
        if s.length() < 12.0 {
            bad.push(format!("street of {:.1} m at {}", s.length(), s.line[0]));
        }
        for w in s.line.windows(3) {
            if angle_between(w[0] - w[1], w[2] - w[1]) < 0.6 {
                bad.push(format!("hairpin at {}", w[1]));
            }
        }
        for p in &s.line[1..n - 1] {
            if !point_in_polygon(*p, &cell.border) {
                bad.push(format!("{p} outside"));
            }
        }
    }
    for p in &cell.ports {
        let met = streets.iter().any(|s| {
            let n = s.line.len();
            [(s.from, s.line[0], s.line[1]), (s.to, s.line[n - 1], s.line[n - 2])]
                .iter()
                .any(|(id, at, next)| *id == p.junction && (*next - *at).normalize().dot(p.inward) > 0.7)
        });
        if !met {
            bad.push(format!("port at {} not met from its side", p.at));
        }
    }
    for (id, around) in &degree {
        for (i, a) in around.iter().enumerate() {
            if around[..i].iter().any(|b| angle_between(*a, *b) < 35f64.to_radians()) {
                bad.push(format!("sharp angle at {}", places[id]));
            }
        }
    }
    let dead = |s: &Street| {
        [(s.from, s.line[0]), (s.to, s.line[s.line.len() - 1])]
            .into_iter()
            .filter(|(id, _)| degree[id].len() == 1 && !ports.contains_key(id))
            .map(|(_, at)| at)
            .collect::<Vec<_>>()
    };
    let joined = |a: &Street, b: &Street| [a.from, a.to].iter().any(|j| *j == b.from || *j == b.to);
    for (i, a) in streets.iter().enumerate() {
        for b in &streets[..i] {
            if joined(a, b) {
                // They share junctions and nothing else.
                let shared: Vec<DVec2> =
                    [a.from, a.to].iter().filter(|j| **j == b.from || **j == b.to).map(|j| places[j]).collect();
                for x in segments(&a.line) {
                    for y in segments(&b.line) {
                        if let Some(c) = segment_crossing(x.0, x.1, y.0, y.1)
                            && !shared.contains(&c.at)
                        {
                            bad.push(format!("joined streets cross at {}", c.at));
                        }
                    }
                }
            } else if line_distance(&a.line, &b.line) < 14.0 - 0.01 {
                bad.push(format!(
                    "{:.1} m between streets at {} and {}",
                    line_distance(&a.line, &b.line),
                    a.line[0],
                    b.line[0]
                ));
            }
            for (x, y) in [(a, b), (b, a)] {
                for end in dead(x) {
                    if distance_to_line(end, &y.line) < 12.0 {
                        bad.push(format!("dead end {end} is {:.1} m from a street", distance_to_line(end, &y.line)));
                    }
                }
            }
        }
        // A street may cross itself no more than others.
        let own: Vec<_> = segments(&a.line).collect();
        for k in 0..own.len() {
            for l in 0..k.saturating_sub(1) {
                if segment_crossing(own[k].0, own[k].1, own[l].0, own[l].1).is_some() {
                    bad.push("street crosses itself".into());
                }
            }
        }
        for k in 0..cell.border.len() {
            let (c, d) = (cell.border[k], cell.border[(k + 1) % cell.border.len()]);
            let least = cell.half[k].map_or(14.0, |h| h + 5.0 + 4.0) - 0.01;
            for (p, q) in segments(&a.line) {
                let on_own_wall = |at: DVec2| c.distance(at) + d.distance(at) - c.distance(d) < 0.01;
                let port = ports.values().find(|at| **at == p || **at == q);
                if port.is_none_or(|at| !on_own_wall(*at)) && segment_crossing(p, q, c, d).is_some() {
                    bad.push(format!("crosses the border at {p}"));
                }
            }
            // The seam answers for the distance of stubs and their ends from the border.
            let off = |id: JunctionId, at: DVec2| {
                let stub_end = cell.ports.iter().any(|x| (x.at + x.inward * STUB_LENGTH).distance(at) < 0.01);
                if ports.contains_key(&id) { STUB_LENGTH + 8.0 } else { f64::from(u8::from(stub_end)) * 8.0 }
            };
            let n = a.line.len();
            let (from, to) = (off(a.from, a.line[0]), a.length() - off(a.to, a.line[n - 1]));
            if from < to {
                let line = cut_line(&a.line, from, to);
                let room = line_distance(&line, &[c, d]);
                if room < least {
                    bad.push(format!("{room:.1} m from the border near {}", line[0]));
                }
            }
        }
    }
    // Every junction is connected to a port.
    let mut reached: BTreeSet<JunctionId> = ports.keys().copied().collect();
    loop {
        let before = reached.len();
        for s in &streets {
            if reached.contains(&s.from) || reached.contains(&s.to) {
                reached.extend([s.from, s.to]);
            }
        }
        if reached.len() == before {
            break;
        }
    }
    if reached.len() != places.len() {
        bad.push(format!("{} junctions float", places.len() - reached.len()));
    }
    bad
}

#[test]
fn every_cell_keeps_every_promise() {
    let kits = Kit::all();
    let mut failures = Vec::new();
    let mut streets = 0;
    for seed in 0..150 {
        let cell = Sample::new(seed, &kits);
        let out = fill(&cell);
        streets += out.streets.len();
        for d in defects(&cell, &out) {
            failures.push(format!("cell {seed}: {d}"));
        }
    }
    assert!(failures.is_empty(), "{} defects:\n{}", failures.len(), failures[..failures.len().min(40)].join("\n"));
    assert!(streets > 1500, "{streets} streets");
}

/// Turns of streets between their ends, in radians, with how far each street is from straight, in metres.
fn turns(kit: &Kit) -> (Vec<f64>, Vec<f64>) {
    let (mut turns, mut off) = (Vec::new(), Vec::new());
    for seed in 2000..2040 {
        for s in &fill(&Sample::new(seed, std::slice::from_ref(kit))).streets {
            let line = &s.street.line;
            let chord = [line[0], line[line.len() - 1]];
            off.push(line.iter().map(|p| distance_to_line(*p, &chord)).fold(0.0, f64::max));
            turns.extend(line.windows(3).map(|w| PI - angle_between(w[0] - w[1], w[2] - w[1])));
        }
    }
    (turns, off)
}

#[test]
fn streets_of_grids_have_no_doglegs_and_those_of_old_towns_no_kinks() {
    for kit in &Kit::all() {
        let (turns, off) = turns(kit);
        if kit.style.main.field == FieldKind::Grid {
            let bent = off.iter().filter(|d| (0.5..16.0).contains(*d)).count();
            assert!(bent * 12 < off.len(), "{bent} of {} streets are nearly straight", off.len());
        } else if kit.style.local.rounding > 0.0 {
            let kinks = turns.iter().filter(|t| **t > 0.7).count();
            assert!(kinks * 12 < off.len(), "{}: {kinks} kinks in {} streets", kit.style.name, off.len());
        }
    }
}

#[test]
fn the_same_brief_gives_the_same_streets() {
    let kits = Kit::all();
    for seed in [3, 14, 159] {
        let cell = Sample::new(seed, &kits);
        assert_eq!(fill(&cell), fill(&cell));
    }
}

#[test]
fn patches_make_half_of_the_streets() {
    let kits = Kit::all();
    for kit in &kits {
        let (mut patched, mut all, mut from_patches, mut streets) = (0.0, 0.0, 0, 0);
        for seed in 1000..1040 {
            for s in &fill(&Sample::new(seed, std::slice::from_ref(kit))).streets {
                let is = matches!(s.made_by, MadeBy::Patch(_));
                let length = line_length(&s.street.line);
                all += length;
                patched += if is { length } else { 0.0 };
                from_patches += u32::from(is);
                streets += 1;
            }
        }
        let share = (patched / all, f64::from(from_patches) / f64::from(streets));
        assert!(share.0 > 0.5, "{}: {:.2} of the length is from patches", kit.style.name, share.0);
    }
}

#[test]
fn rounding_takes_sharp_bends_and_leaves_ends_where_they_are() {
    let mut kits = Kit::all();
    let sharp = |out: &CellStreets| {
        let turns = |s: &Street| s.line.windows(3).filter(|w| angle_between(w[1] - w[0], w[2] - w[1]) > 0.3).count();
        out.streets.iter().map(|s| turns(&s.street)).sum::<usize>()
    };
    let (mut before, mut after) = (0, 0);
    for kit in &mut kits {
        for seed in 0..20 {
            kit.style.local.rounding = 0.0;
            let plain = fill(&Sample::new(seed, std::slice::from_ref(kit)));
            kit.style.local.rounding = 26.0;
            let round = fill(&Sample::new(seed, std::slice::from_ref(kit)));
            assert_eq!(plain.junctions, round.junctions);
            let ends = |out: &CellStreets| -> Vec<_> {
                out.streets
                    .iter()
                    .map(|s| (s.street.id, s.street.line[0], s.street.line[s.street.line.len() - 1]))
                    .collect()
            };
            assert_eq!(ends(&plain), ends(&round));
            (before, after) = (before + sharp(&plain), after + sharp(&round));
        }
    }
    assert!(before > 50 && after * 4 < before, "{before} sharp bends, {after} after rounding");
}

#[test]
fn cancelling_stops() {
    let kits = Kit::all();
    let cancel = Cancel::new();
    cancel.cancel();
    let cell = Sample::new(5, &kits);
    assert_eq!(SemanticPatches.fill(&cell.brief(), &cancel), Err(LayerError::Cancelled));
}

#[test]
fn cells_without_room_or_ports_are_fine() {
    let kits = Kit::all();
    let mut cell = Sample::new(7, &kits);
    cell.ports.clear();
    assert_eq!(fill(&cell), CellStreets::default());
    cell.border.truncate(2);
    assert_eq!(fill(&cell), CellStreets::default());
    cell.border.clear();
    assert_eq!(fill(&cell), CellStreets::default());
}
