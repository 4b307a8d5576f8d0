//! Rivers that a settlement spreads over, traced through sampled water, with a bank line on either side.
//!
//! A river is water between two banks that are nowhere farther apart than a settlement may bridge. A lake or the sea is not a
//! river, and ends a settlement. Along the middle of the water lie *stations*, each with a point on both bank lines, opposite
//! each other, so that a bridge between them is perpendicular to the river.

use crate::region::settlement::ray::{Detail, Ray, SHORE};
use crate::space::math::{angle_between, angle_of, direction, rotate};
use crate::space::{closest_on_line, left_normal, line_length, point_at, quantize, segment_crossing, segments};
use crate::terrain::Scan;
use glam::DVec2;
use std::f64::consts::PI;

/// Distance of bank lines from the water, in metres: room for the bank and half a street.
const BANK: f64 = 20.0;
/// Least radius of a settlement that spreads over a river, in metres.
pub(super) const LEAST_RADIUS: f64 = 320.0;
/// Distance between stations, in metres.
const STATION: f64 = 30.0;
/// Step in metres along the water while it is traced.
const STEP: f64 = 15.0;
/// Step in metres across the water while a bank is searched.
const ACROSS: f64 = 4.0;
/// Greatest number of steps past the mouth of another river. There one bank is missing, and the last known width is used.
const MOUTH: usize = 6;
/// Distance in metres beyond the radius up to which a river is traced.
const BEYOND: f64 = 120.0;
/// Greatest turn of the river from one station to the next, in radians.
const BEND: f64 = 0.3;
/// Least length of a bank line between two stations, in metres.
const SHORTEST: f64 = 14.0;
/// Greatest number of places from which a river is traced.
const TRIES: usize = 4;
/// Land that a ray must find beyond the far bank line, in metres.
const ROOM: f64 = 75.0;
/// Most oblique crossing, in widths of the river between its bank lines.
const OBLIQUE: f64 = 2.6;
/// Least ground on the far bank: in square metres, and as a share of the ground on the near bank.
const LEAST_GROUND: (f64, f64) = (30_000.0, 0.06);

/// A river near a settlement, local to the settlement's centre.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::region) struct River {
    /// Middle of the water at each station.
    pub middle: Vec<DVec2>,
    /// Points of the left and right bank line at each station.
    pub banks: [Vec<DVec2>; 2],
    /// The station nearest to the settlement's centre, where the settlement crosses first.
    pub first: usize,
}

/// The middle of the water at a place, and half the distance between the banks.
#[derive(Clone, Copy)]
struct Section {
    middle: DVec2,
    half: f64,
}

/// Tells whether a local point lies in water.
type Wet<'a> = dyn FnMut(DVec2) -> bool + 'a;

/// The river that a settlement spreads over, with the reach of the settlement's rays when they cross it. `ways`, `reach` and
/// `limits` describe the rays on dry ground; `widest` is the greatest width in metres.
pub(super) fn find(
    ground: &mut Scan<'_>,
    centre: DVec2,
    (ways, reach, limits): (&[DVec2], &[f64], &[f64]),
    max_slope: f64,
    widest: f64,
) -> Option<(River, Vec<f64>)> {
    let limit = limits.iter().fold(0.0, |a: f64, b| a.max(*b)) + BEYOND;
    let mut ended: Vec<usize> = (0..ways.len()).filter(|i| reach[*i] < limits[*i]).collect();
    ended.sort_by(|a, b| reach[*a].total_cmp(&reach[*b]).then(a.cmp(b)));
    let (mut tried, mut best) = (Vec::<Vec<DVec2>>::new(), None::<(f64, River, Vec<f64>)>);
    for i in ended {
        let mut wet = |p: DVec2| ground(centre + p).depth() > 0.0;
        let shore = |k: usize| ways[i] * (reach[i] + SHORE + k as f64 * 3.0);
        let Some(water) = (0..6).map(shore).find(|p| wet(*p)) else { continue };
        if tried.iter().any(|line| closest_on_line(water, line).1.distance(water) < widest) {
            continue;
        }
        if tried.len() == TRIES {
            break;
        }
        let found = follow(&mut wet, water, widest, limit);
        tried.push(found.iter().map(|s| s.middle).chain([water, water + DVec2::X]).collect());
        let Some(mut river) = stations(&mut wet, &found) else { continue };
        let Some((land, over)) = across(ground, centre, (ways, reach, limits), max_slope, &mut river) else { continue };
        if best.as_ref().is_none_or(|b| land > b.0) {
            best = Some((land, river, over));
        }
    }
    best.map(|(_, river, over)| (river, over))
}

/// Distance from a wet point to the bank in a direction; `None` if it exceeds `most`.
fn bank(wet: &mut Wet<'_>, from: DVec2, way: DVec2, most: f64) -> Option<f64> {
    let mut dry = ACROSS;
    while wet(from + way * dry) {
        dry += ACROSS;
        if dry > most {
            return None;
        }
    }
    let mut last = dry - ACROSS;
    while dry - last > 0.5 {
        let middle = (dry + last) / 2.0;
        if wet(from + way * middle) { last = middle } else { dry = middle }
    }
    Some(dry)
}

/// Sections of the water that holds `from`, one every [`STEP`] metres, as far as the water is a river.
fn follow(wet: &mut Wet<'_>, from: DVec2, widest: f64, limit: f64) -> Vec<Section> {
    let Some((at, across)) = narrowest(wet, from, widest).and_then(|(p, _)| narrowest(wet, p, widest)) else {
        return Vec::new();
    };
    let mut out = walk(wet, at, -left_normal(across), widest, limit);
    out.reverse();
    out.pop();
    out.extend(walk(wet, at, left_normal(across), widest, limit));
    out
}

/// The middle of the shortest line across the water at a place, and the direction of that line.
fn narrowest(wet: &mut Wet<'_>, at: DVec2, widest: f64) -> Option<(DVec2, DVec2)> {
    let mut best: Option<(f64, DVec2, DVec2)> = None;
    for i in 0..12 {
        let way = direction(f64::from(i) / 12.0 * PI);
        let (Some(a), Some(b)) = (bank(wet, at, way, widest), bank(wet, at, -way, widest)) else { continue };
        if a + b <= widest && best.is_none_or(|(width, ..)| a + b < width) {
            best = Some((a + b, at + way * ((a - b) / 2.0), way));
        }
    }
    best.map(|(_, p, way)| (p, way)).filter(|(p, _)| wet(*p))
}

/// Traces the water in one direction from the middle of a section.
fn walk(wet: &mut Wet<'_>, from: DVec2, heading: DVec2, widest: f64, limit: f64) -> Vec<Section> {
    let (mut at, mut way, mut out) = (from, heading, Vec::<Section>::new());
    let (mut mouths, mut last) = (0, None::<f64>);
    while at.length() < limit && out.len() < (6.0 * limit / STEP) as usize {
        let normal = left_normal(way);
        let sides = [bank(wet, at, normal, widest), bank(wet, at, -normal, widest)];
        // Where another river flows in, a bank is missing or far away.
        let kept = |i: usize| match (sides[i], last) {
            (Some(d), Some(l)) if d > 1.5 * l + 12.0 => (l, true),
            (Some(d), _) => (d, false),
            (None, Some(l)) => (l, true),
            (None, None) => (widest, true),
        };
        let ((left, lost), (right, lost_too)) = (kept(0), kept(1));
        mouths = if lost || lost_too { mouths + 1 } else { 0 };
        if (lost && lost_too) || mouths > MOUTH || left + right > widest {
            break;
        }
        let middle = at + normal * ((left - right) / 2.0);
        last = Some((left + right) / 2.0);
        if let Some(before) = out.last() {
            let moved = (middle - before.middle).normalize_or(way);
            way = (way + moved * 2.0).normalize_or(way);
        }
        out.push(Section { middle, half: (left + right) / 2.0 });
        let next = [0.0, 0.3, -0.3, 0.6, -0.6, 0.9, -0.9]
            .map(|turn| rotate(way, turn))
            .into_iter()
            .find(|w| wet(middle + *w * STEP));
        let Some(next) = next else { break };
        (at, way) = (middle + next * STEP, next);
    }
    out
}

/// Stations along the sections: the longest stretch where, after evening out, the bank lines are dry and run beside the
/// water without corners.
fn stations(wet: &mut Wet<'_>, sections: &[Section]) -> Option<River> {
    if sections.len() < 8 {
        return None;
    }
    let mut line: Vec<DVec2> = sections.iter().map(|s| s.middle).collect();
    for _ in 0..6 {
        let before = line.clone();
        for i in 1..line.len() - 1 {
            line[i] = (before[i - 1] + before[i] * 2.0 + before[i + 1]) / 4.0;
        }
    }
    let count = (line_length(&line) / STATION).floor();
    let mut middle: Vec<DVec2> = (0..=count as usize).map(|i| point_at(&line, i as f64 * STATION).0).collect();
    let n = middle.len();
    if n < 5 {
        return None;
    }
    let normals: Vec<DVec2> = (0..n)
        .map(|i| left_normal(middle[(i + 1).min(n - 1)] - middle[i.saturating_sub(1)]).normalize_or_zero())
        .collect();
    // Distance of the water's edge on both sides, from the sections near each station.
    let mut edge = [vec![0.0; n], vec![0.0; n]];
    for s in sections {
        let (along, _) = closest_on_line(s.middle, &middle);
        let i = ((along / STATION).round() as usize).min(n - 1);
        let off = (s.middle - middle[i]).dot(normals[i]);
        for (side, offset) in [s.half + off, s.half - off].into_iter().enumerate() {
            edge[side][i] = f64::max(edge[side][i], offset);
        }
    }
    let banks = edge.map(|edge| {
        let most: Vec<f64> =
            (0..n).map(|i| (i.saturating_sub(1)..(i + 2).min(n)).map(|k| edge[k]).fold(0.0, f64::max)).collect();
        let mean = |i: usize| {
            let near = i.saturating_sub(2)..(i + 3).min(n);
            near.clone().map(|k| most[k]).sum::<f64>() / near.count() as f64
        };
        (0..n).map(mean).collect::<Vec<f64>>()
    });
    let bank_at = |i: usize, side: usize| {
        let sign = if side == 0 { 1.0 } else { -1.0 };
        middle[i] + normals[i] * (sign * (banks[side][i] + BANK))
    };
    let lines = [0, 1].map(|side| (0..n).map(|i| quantize(bank_at(i, side))).collect::<Vec<_>>());
    let good = |i: usize, wet: &mut Wet<'_>| {
        let bends = i > 0 && i + 1 < n && angle_between(middle[i] - middle[i - 1], middle[i + 1] - middle[i]) > BEND;
        !bends
            && (0..2).all(|side| {
                let (p, way) = (lines[side][i], (middle[i] - lines[side][i]).normalize_or_zero());
                let next = lines[side][(i + 1).min(n - 1)];
                let short = i + 1 < n && (p.distance(next) < SHORTEST || p.distance(next) > 2.5 * STATION);
                let mid = p.lerp(next, 0.5);
                !short && [p, p + way * (BANK * 0.45), p - way * 6.0, mid, mid + way * 5.0].into_iter().all(|q| !wet(q))
            })
    };
    let fine: Vec<bool> = (0..n).map(|i| good(i, wet)).collect();
    let (mut best, mut start) = (0..0, 0);
    for (i, fine) in fine.into_iter().chain([false]).enumerate() {
        if !fine {
            if i - start > best.len() {
                best = start..i;
            }
            start = i + 1;
        }
    }
    if best.len() < 5 {
        return None;
    }
    middle = middle[best.clone()].to_vec();
    let banks = lines.map(|line| line[best.clone()].to_vec());
    Some(River { middle, banks, first: 0 })
}

/// The area of land that rays find beyond the river, and the reach of all rays when the best run of rays crosses. Sets the
/// river's first station.
fn across(
    ground: &mut Scan<'_>,
    centre: DVec2,
    (ways, reach, limits): (&[DVec2], &[f64], &[f64]),
    max_slope: f64,
    river: &mut River,
) -> Option<(f64, Vec<f64>)> {
    let n = ways.len();
    let near = |line: &[DVec2], way: DVec2, least: f64, most: f64| {
        let hit = |(a, b): (DVec2, DVec2)| segment_crossing(way * least, way * most, a, b).map(|x| x.at.length());
        segments(line).filter_map(hit).min_by(f64::total_cmp)
    };
    let over: Vec<Option<(f64, f64)>> = (0..n)
        .map(|i| {
            let (way, limit) = (ways[i], limits[i]);
            let from = (reach[i] - BANK).max(0.0);
            let middle = near(&river.middle, way, from, limit)?;
            let banks = [0, 1].map(|side| near(&river.banks[side], way, from, limit));
            let (Some(a), Some(b)) = (banks[0], banks[1]) else { return None };
            let (first, last) = (a.min(b), a.max(b));
            let width = river_width(river, way * middle);
            // The ray must have ended at this river.
            let ended_here = first < reach[i] + SHORE + 12.0 && middle > first && middle < last;
            if !ended_here || last - first > OBLIQUE * width || last + ROOM > limit {
                return None;
            }
            let ray = Ray { centre, direction: way, from: last, limit, detail: Detail::Full };
            let end = ray.cast(ground, max_slope).reach;
            (end >= last + ROOM).then_some((last, end))
        })
        .collect();
    let land = |i: usize| over[i].map_or(0.0, |(from, to)| (to * to - from * from) / 2.0);
    let mut best: Option<(f64, usize, usize)> = None;
    for start in (0..n).filter(|i| over[*i].is_some() && over[(i + n - 1) % n].is_none()) {
        let count = (0..n).take_while(|k| over[(start + k) % n].is_some()).count();
        let sum: f64 = (0..count).map(|k| land((start + k) % n)).sum();
        if best.is_none_or(|b| sum > b.0) {
            best = Some((sum, start, count));
        }
    }
    let (sum, start, count) = best?;
    let turn = 2.0 * PI / n as f64;
    let own: f64 = reach.iter().map(|r| r * r / 2.0).sum();
    if sum * turn < LEAST_GROUND.0 || sum < LEAST_GROUND.1 * own {
        return None;
    }
    let mut out = reach.to_vec();
    for i in (0..count).map(|k| (start + k) % n) {
        out[i] = over[i].map_or(out[i], |o| o.1);
    }
    let by_centre = |a: &usize, b: &usize| {
        let nearest = |i: usize| river.middle[i].length();
        nearest(*a).total_cmp(&nearest(*b)).then(a.cmp(b))
    };
    let crossed = |i: &usize| {
        let at = angle_of(river.middle[*i]).rem_euclid(2.0 * PI) / turn;
        (at - start as f64).rem_euclid(n as f64) <= (count - 1) as f64
    };
    river.first = (1..river.middle.len() - 1).filter(crossed).min_by(by_centre)?;
    Some((sum * turn, out))
}

/// Distance between the bank lines of a river near a point.
fn river_width(river: &River, p: DVec2) -> f64 {
    let i = (0..river.middle.len())
        .min_by(|a, b| p.distance_squared(river.middle[*a]).total_cmp(&p.distance_squared(river.middle[*b])))
        .unwrap_or(0);
    river.banks[0][i].distance(river.banks[1][i])
}
