//! The contract of [`CellFiller`], held against every filler in many cells, by brute force on their final streets.

use super::filler::{Cause, CellFiller, CellStreets, CellToFill, Exception, PinnedPiece, Rule};
use super::fillers::Fillers;
use crate::layer::{Cancel, LayerError, Ranged};
use crate::network::{JunctionId, Street};
use crate::patch::{Patch, PatchBuilding};
use crate::seam::{APPROACH_LENGTH, CellPort};
use crate::space::{
    Seed, closest_on_segment, common_parts, cut_line, distance_to_line, is_simple, math::angle_between,
    point_in_polygon, quantize, segment_crossing, segment_distance, segments, signed_area,
};
use crate::style::{Filler, LocalRules, PatchCityRules, Style};
use crate::testing::{PortCell, patch_sets, styles};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Cells that every filler is tried in.
const CELLS: u64 = 200;

/// Cells that every filler is tried in with random rules.
const RANDOM: u64 = 600;

fn line_distance(a: &[DVec2], b: &[DVec2]) -> f64 {
    segments(a).flat_map(|x| segments(b).map(move |y| segment_distance(x.0, x.1, y.0, y.1))).fold(f64::MAX, f64::min)
}

/// Everything that is wrong with a filled cell.
pub fn defects(cell: &PortCell<'_>, out: &CellStreets) -> Vec<String> {
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
    for (i, building) in out.buildings.iter().enumerate() {
        if !is_simple(&building.outline) || building.outline.iter().any(|p| quantize(*p) != *p) {
            bad.push("building off the grid, or with an outline that crosses itself".into());
        }
        let shared = |other: &PatchBuilding| -> f64 {
            common_parts(&building.outline, &other.outline).iter().map(|part| signed_area(part)).sum()
        };
        if out.buildings[..i].iter().any(|other| shared(other) > 1.0) {
            bad.push(format!("two buildings at {}", building.outline[0]));
        }
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
                // A straight street may lead from one port to another.
                let mut at_ports = ports.values().filter(|at| **at == p || **at == q);
                if !at_ports.any(|at| on_own_wall(*at)) && segment_crossing(p, q, c, d).is_some() {
                    bad.push(format!("crosses the border at {p}"));
                }
            }
            // The seam answers for the distance of stubs and their ends from the border.
            let off = |id: JunctionId, at: DVec2| {
                let stub_end = cell.ports.iter().any(|x| (x.at + x.inward * APPROACH_LENGTH).distance(at) < 0.01);
                if ports.contains_key(&id) { APPROACH_LENGTH + 8.0 } else { f64::from(u8::from(stub_end)) * 8.0 }
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

/// Some of the bundled styles, all of which name a filler, with the fillers of a world that has no others.
fn with_filler(filler: Filler) -> (Vec<Style>, Fillers) {
    let mut styles = styles();
    for style in &mut styles {
        style.filler = filler;
        if matches!(filler, Filler::PatchCity(_)) {
            style.patch_sets = vec!["patchwork".into()];
        }
    }
    let by_name = styles.iter().map(|style| (style.name.clone(), Arc::new(style.clone()))).collect();
    let fillers = Fillers::new(&by_name, &patch_sets(&styles));
    (styles, fillers)
}

/// The filler of a cell, prepared as for a town that has no other cell.
fn prepared(fillers: &Fillers, cell: &PortCell<'_>, pinned: Vec<PinnedPiece>) -> Arc<dyn CellFiller> {
    let styles = [(Arc::new(cell.style.clone()), 1.0)];
    let to_fill = CellToFill { brief: cell.brief(), style: cell.style, styles: &styles, pinned };
    let mut prepared = fillers.prepare(&[cell.style], vec![to_fill]).expect("every style is there");
    prepared.fillers.pop().expect("one for each cell")
}

fn fill(fillers: &Fillers, cell: &PortCell<'_>) -> CellStreets {
    prepared(fillers, cell, Vec::new()).fill(&cell.brief(), &Cancel::new()).expect("nobody cancelled")
}

#[test]
fn every_cell_keeps_every_promise() {
    for filler in Filler::ALL {
        let (styles, fillers) = with_filler(filler);
        let mut failures = Vec::new();
        let mut streets = 0;
        for seed in 0..CELLS {
            let cell = PortCell::new(seed, &styles);
            let out = fill(&fillers, &cell);
            streets += out.streets.len() as u64;
            failures.extend(defects(&cell, &out).into_iter().map(|d| format!("cell {seed}: {d}")));
        }
        let some = failures[..failures.len().min(40)].join("\n");
        assert!(failures.is_empty(), "{filler:?} has {} defects:\n{some}", failures.len());
        assert!(streets > 10 * CELLS, "{filler:?}: {streets} streets");
    }
}

/// Streets, junctions and pairs of streets that break a rule of the cell's style, found by brute force, each with a place; the
/// clearance only of streets that are far from each other along the network, and from a port of the main street.
fn breaks(cell: &PortCell<'_>, out: &CellStreets) -> Vec<(Rule, DVec2)> {
    let rules = &cell.style.local;
    let least_angle = rules.min_angle_deg.to_radians() - 0.01;
    let mut found = Vec::new();
    let streets: Vec<&Street> = out.streets.iter().map(|s| &s.street).collect();
    let mut around: BTreeMap<JunctionId, Vec<(DVec2, DVec2)>> = BTreeMap::new();
    for s in &streets {
        let n = s.line.len();
        around.entry(s.from).or_default().push((s.line[0], s.line[1] - s.line[0]));
        around.entry(s.to).or_default().push((s.line[n - 1], s.line[n - 2] - s.line[n - 1]));
        if s.length() < rules.min_length - 0.2 {
            found.push((Rule::Length, s.line[0]));
        }
        for w in s.line.windows(3).filter(|w| angle_between(w[0] - w[1], w[2] - w[1]) < least_angle) {
            found.push((Rule::Angle, w[1]));
        }
    }
    for ways in around.values() {
        if ways.len() > 2 && ways.len() > rules.degree.1 as usize {
            found.push((Rule::Degree, ways[0].0));
        }
        if (0..ways.len()).any(|i| ways[..i].iter().any(|b| angle_between(ways[i].1, b.1) < least_angle)) {
            found.push((Rule::Angle, ways[0].0));
        }
    }
    for (i, a) in streets.iter().enumerate() {
        let close: Vec<_> =
            streets[..i].iter().filter(|b| line_distance(&a.line, &b.line) < rules.clearance - 0.2).collect();
        let ends = [(a.from, 0.0), (a.to, 0.0)];
        // Three times as far as streets may be, and where points were checked.
        let far = 3.0 * rules.clearance + 6.5;
        let near = if close.is_empty() { BTreeMap::new() } else { reached(&streets, ends, far) };
        for b in close.into_iter().filter(|b| !near.contains_key(&b.from) && !near.contains_key(&b.to)) {
            let points = b
                .line
                .iter()
                .copied()
                .min_by(|p, q| distance_to_line(*p, &a.line).total_cmp(&distance_to_line(*q, &a.line)));
            found.extend(points.map(|p| (Rule::Clearance, p)));
        }
        // Each street is counted once, where it is nearest to one of its main streets.
        let is_counted = |e: &Exception| e.rule == Rule::Clearance && distance_to_line(e.at, &a.line) < 0.1;
        let at_border = break_at_border(cell, &streets, a).filter(|_| !out.exceptions.iter().any(is_counted));
        found.extend(at_border.map(|at| (Rule::Clearance, at)));
    }
    found
}

/// The junctions that ways along the streets lead to from `ends`, each with the length of the way so far, if they are shorter than
/// `far` metres.
fn reached(streets: &[&Street], ends: [(JunctionId, f64); 2], far: f64) -> BTreeMap<JunctionId, f64> {
    let mut reached: BTreeMap<JunctionId, f64> = BTreeMap::new();
    for (end, way) in ends.into_iter().filter(|(_, way)| *way < far) {
        let known = reached.entry(end).or_insert(way);
        *known = known.min(way);
    }
    for _ in 0..streets.len() {
        for s in streets {
            for (a, b) in [(s.from, s.to), (s.to, s.from)] {
                let way = reached.get(&a).map_or(far, |d| d + s.length());
                if way < far && reached.get(&b).is_none_or(|d| way < *d) {
                    reached.insert(b, way);
                }
            }
        }
    }
    reached
}

/// Where a street is nearer to a main street around the cell than the clearance, although no port is near along the streets.
fn break_at_border(cell: &PortCell<'_>, streets: &[&Street], street: &Street) -> Option<DVec2> {
    let clearance = cell.style.local.clearance;
    let n = cell.border.len();
    let length = street.length();
    let mut along = 0.0;
    for (p, q) in segments(&street.line) {
        for k in (0..n).filter(|k| cell.half[*k].is_some()) {
            let (c, d) = (cell.border[k], cell.border[(k + 1) % n]);
            let corners = [c, d].map(|at| closest_on_segment(at, p, q).1);
            for x in [p, q].into_iter().chain(corners) {
                let y = closest_on_segment(x, c, d).1;
                if x.distance(y) >= clearance - 0.2 {
                    continue;
                }
                // The main street may come as near as a third of the way to it, measured at points some metres apart.
                let far = 3.0 * x.distance(y) + 8.0;
                let before = along + p.distance(x);
                let near = reached(streets, [(street.from, before), (street.to, length - before)], far);
                let leads =
                    |port: &CellPort| near.get(&port.junction).is_some_and(|way| way + port.at.distance(y) < far);
                if !cell.ports.iter().any(leads) {
                    return Some(x);
                }
            }
        }
        along += p.distance(q);
    }
    None
}

/// Cells of some styles whose local rules are drawn from all that they may be.
fn with_random_rules(filler: Filler, mut each: impl FnMut(&PortCell<'_>, &CellStreets)) {
    let (styles, fillers) = with_filler(filler);
    for seed in 0..RANDOM {
        let mut s = Seed(seed).stream("random rules", &[]);
        let mut local = LocalRules::default();
        local.draw(0.9, &mut s).expect("no range is empty");
        let styles: Vec<Style> = styles.iter().map(|style| Style { local, ..style.clone() }).collect();
        let cell = PortCell::new(seed + 5000, &styles);
        each(&cell, &fill(&fillers, &cell));
    }
}

#[test]
fn rules_hold_whatever_they_are_but_at_ports_and_in_drawings() {
    for filler in Filler::ALL {
        let (mut failures, mut counts) = (Vec::new(), BTreeMap::new());
        with_random_rules(filler, |cell, out| {
            let rules = &cell.style.local;
            let name = format!("cell {} of {} with {rules:?}", cell.seed, cell.style.name);
            failures.extend(defects(cell, out).into_iter().map(|d| format!("{name}: {d}")));
            for e in &out.exceptions {
                *counts.entry((e.rule.name(), e.cause.name())).or_insert(0) += 1;
                let allowed = match e.cause {
                    // What the style wants in any case.
                    Cause::Pin => filler == Filler::SemanticPatches && !cell.style.patches.is_empty(),
                    Cause::Port | Cause::Drawing | Cause::Cell => matches!(e.rule, Rule::Length | Rule::Clearance),
                    Cause::Defect => false,
                };
                if !allowed {
                    failures.push(format!("{name}: {e:?}"));
                }
            }
            for (rule, at) in breaks(cell, out) {
                // The nearest points of two streets may be found at another place along them.
                let off = if rule == Rule::Clearance { 2.0 * rules.clearance } else { 1.0 };
                let known = out.exceptions.iter().any(|e| e.rule == rule && e.at.distance(at) < off);
                if !known {
                    failures.push(format!("{name}: {rule:?} at {at} is not counted"));
                }
            }
        });
        let some = failures[..failures.len().min(12)].join("\n");
        assert!(failures.is_empty(), "{filler:?} breaks {} rules: {counts:?}\n{some}", failures.len());
    }
}

#[test]
fn the_same_brief_gives_the_same_streets() {
    for filler in Filler::ALL {
        let (styles, fillers) = with_filler(filler);
        for seed in [3, 14, 159] {
            let cell = PortCell::new(seed, &styles);
            assert_eq!(fill(&fillers, &cell), fill(&fillers, &cell));
            let again = with_filler(filler).1;
            assert_eq!(fill(&fillers, &cell), fill(&again, &cell));
        }
    }
}

#[test]
fn streets_say_which_filler_made_them() {
    for filler in Filler::ALL {
        let (styles, fillers) = with_filler(filler);
        let out = fill(&fillers, &PortCell::new(3, &styles));
        assert!(out.streets.iter().all(|s| s.made_by.filler == filler.name()));
    }
}

#[test]
fn cancelling_stops() {
    let cancel = Cancel::new();
    cancel.cancel();
    for filler in Filler::ALL {
        let (styles, fillers) = with_filler(filler);
        let cell = PortCell::new(5, &styles);
        let out = prepared(&fillers, &cell, Vec::new()).fill(&cell.brief(), &cancel);
        assert_eq!(out, Err(LayerError::Cancelled));
    }
}

#[test]
fn cells_without_room_or_ports_are_fine() {
    for filler in Filler::ALL {
        let (styles, fillers) = with_filler(filler);
        let mut cell = PortCell::new(7, &styles);
        cell.ports.clear();
        assert_eq!(fill(&fillers, &cell), CellStreets::default());
        cell.border.truncate(2);
        assert_eq!(fill(&fillers, &cell), CellStreets::default());
        cell.border.clear();
        assert_eq!(fill(&fillers, &cell), CellStreets::default());
    }
}

#[test]
fn pieces_that_there_are_not_are_left_out() {
    for filler in Filler::ALL {
        let (styles, fillers) = with_filler(filler);
        let cell = PortCell::new(11, &styles);
        let at = crate::space::centroid(&cell.border);
        let pin = |piece: &str| PinnedPiece { piece: piece.into(), at, turned: 0.0, mirrored: false };
        let pinned = vec![pin("no such piece"), pin("nor this one")];
        assert!(pinned.iter().all(|p| !fillers.has_piece(&p.piece)));
        let out = prepared(&fillers, &cell, pinned).fill(&cell.brief(), &Cancel::new()).expect("nobody cancelled");
        assert_eq!(out.left_out.iter().map(|l| l.piece).collect::<Vec<_>>(), [0, 1]);
        assert_eq!(out.streets, fill(&fillers, &cell).streets);
    }
}

#[test]
fn pinned_patches_stand_whole_among_tiles() {
    let all = styles();
    let (tiled, _) = with_filler(Filler::PatchCity(PatchCityRules::default()));
    let by_name = tiled.iter().map(|style| (style.name.clone(), Arc::new(style.clone()))).collect();
    let sets = patch_sets(&[all, tiled.clone()].concat());
    let fillers = Fillers::new(&by_name, &sets);
    let drawn: Vec<&Patch> = sets.values().flat_map(|set| &set.patches).filter(|p| p.window.is_none()).collect();
    let (mut stand, mut tried) = (0, 0);
    for seed in 0..60 {
        let cell = PortCell::new(seed, &tiled);
        let mut rng = Seed(seed).stream("pins", &[]);
        let patch = drawn[rng.index(drawn.len())];
        let (at, turned) = (quantize(crate::space::centroid(&cell.border)), rng.range(0.0, 6.0));
        let pin = PinnedPiece { piece: patch.name.clone(), at, turned, mirrored: false };
        let out = prepared(&fillers, &cell, vec![pin]).fill(&cell.brief(), &Cancel::new()).expect("nobody cancelled");
        assert_eq!(defects(&cell, &out), [""; 0], "cell {seed}");
        tried += 1;
        if out.left_out.is_empty() {
            stand += 1;
            for edge in patch.edges.iter().filter(|e| !e.main) {
                let middle = patch.vertices[edge.a].midpoint(patch.vertices[edge.b]);
                let p = at + crate::space::math::rotate(middle, turned);
                let off = out.streets.iter().map(|s| distance_to_line(p, &s.street.line)).fold(f64::MAX, f64::min);
                assert!(off < 4.0, "cell {seed}: a street of `{}` is missing at {p}, {off:.1} m", patch.name);
            }
        }
    }
    assert!(stand * 3 > tried, "{stand} of {tried}");
}

#[test]
fn rounding_takes_sharp_bends_and_leaves_ends_where_they_are() {
    let sharp = |out: &CellStreets| {
        let turns = |s: &Street| s.line.windows(3).filter(|w| angle_between(w[1] - w[0], w[2] - w[1]) > 0.3).count();
        out.streets.iter().map(|s| turns(&s.street)).sum::<usize>()
    };
    let ends = |out: &CellStreets| -> Vec<_> {
        let end = |s: &Street| (s.id, s.line[0], s.line[s.line.len() - 1]);
        out.streets.iter().map(|s| end(&s.street)).collect()
    };
    for filler in Filler::ALL {
        let (mut styles, fillers) = with_filler(filler);
        let (mut before, mut after) = (0, 0);
        for style in &mut styles {
            for seed in 0..20 {
                style.local.rounding = 0.0;
                let plain = fill(&fillers, &PortCell::new(seed, std::slice::from_ref(style)));
                style.local.rounding = 26.0;
                let round = fill(&fillers, &PortCell::new(seed, std::slice::from_ref(style)));
                assert_eq!(plain.junctions, round.junctions);
                assert_eq!(ends(&plain), ends(&round));
                (before, after) = (before + sharp(&plain), after + sharp(&round));
            }
        }
        assert!(before > 50 && after * 4 < before, "{filler:?}: {before} sharp bends, {after} after rounding");
    }
}
