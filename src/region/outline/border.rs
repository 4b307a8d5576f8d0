//! Borders of settlements that touch: the stretch of the power line that both settlements reach, and the gates on it.
//!
//! Two settlements divide the ground between them along a straight line, the line of their power diagram. Where ground and
//! noise let both reach that line, their outlines have the same vertices, and between its first and last gate the border is
//! a main street of both. A border depends on the profiles of its two settlements and on the settlements near them, but on
//! no decision of either side, so both sides find the same border.

use super::profile::Profile;
use crate::network::{JunctionId, SizeClass, Street, StreetClass, StreetId};
use crate::region::settlement::spacing::power_line;
use crate::region::settlement::{Settlement, SettlementId};
use crate::space::{Origin, Seed, left_normal, math, quantize};
use crate::terrain::Terrain;
use glam::DVec2;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Least length of a border, in metres.
const LEAST_LENGTH: f64 = 150.0;
/// Step in metres at which the ground along the line is sampled.
const STEP: f64 = 10.0;
/// Desired distance between vertices, in metres.
const SPACING: f64 = 60.0;
/// Desired distance between gates, in metres.
const GATE_SPACING: f64 = 230.0;
/// Distance that a border keeps from the ground of a third settlement, in metres.
const CORNER: f64 = 45.0;
/// Greatest tangent of the angle between the perpendicular from a centre to the line and the ray to the border's end.
const OBLIQUE: f64 = 1.35;
/// Least sine of the angle between a border and the ray from a centre to it.
const GRAZING: f64 = 0.35;
/// Greatest deviation of a border from the straight line: as a share of its length, and in metres.
const DEVIATION: (f64, f64) = (0.035, 24.0);
/// Width in metres of the dry ground on both sides of a border.
const BANK: f64 = 14.0;
/// Greatest grade along a border.
const MAX_GRADE: f64 = 0.14;
/// Distinguishes the ids of junctions and streets on borders from other hashes.
const WORD: u64 = 0x626f_7264_6572;

/// The border of two settlements that touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Border {
    /// Origin that `line` is local to, near the middle between the settlements.
    pub origin: Origin,
    /// The two settlements, the lower id first. The first lies left of the line, the second right of it.
    pub sides: [SettlementId; 2],
    /// Vertices that both outlines have, on the quantum grid.
    pub line: Vec<DVec2>,
    /// Vertices where main streets of both settlements meet, as indices into `line`, in order. There is at least one, and
    /// neither the first nor the last vertex is a gate. The border is a street between the first gate and the last.
    pub gates: Vec<usize>,
    /// Class of that street.
    pub class: StreetClass,
}

/// One of the two settlements as the border sees it.
struct Side<'a> {
    profile: &'a Profile,
    /// Centre, local to the border.
    centre: DVec2,
    radius: f64,
    /// Distance from the centre to the line.
    line: f64,
}

impl Side<'_> {
    /// Power of a point: negative inside the settlement's circle.
    fn power(&self, p: DVec2) -> f64 {
        p.distance_squared(self.centre) - self.radius * self.radius
    }
}

impl Border {
    /// The border of `pair`, or `None` if the two settlements do not touch. The settlement with the lower id comes first.
    /// `others` must include every other settlement whose circle overlaps the circle of one of the two.
    pub(in crate::region) fn between(
        seed: Seed,
        terrain: &dyn Terrain,
        pair: [(&Settlement, &Profile); 2],
        others: &[Arc<Settlement>],
    ) -> Option<Self> {
        let [(a, profile_a), (b, profile_b)] = pair;
        let apart = b.centre.offset_to(a.centre);
        let (toward, distance) = (apart.normalize_or_zero(), apart.length());
        let foot = power_line(distance, a.radius, b.radius);
        let chord = a.radius * a.radius - foot * foot;
        if foot <= 0.0 || foot >= distance || chord < LEAST_LENGTH * LEAST_LENGTH / 4.0 {
            return None;
        }
        let origin = Origin(a.centre.0 + (toward * foot).round().as_i64vec2());
        let side = |s: &Settlement, profile, line| Side {
            profile,
            centre: s.centre.offset_to(origin),
            radius: s.radius,
            line,
        };
        let sides = [side(a, profile_a, foot), side(b, profile_b, distance - foot)];
        let middle = sides[0].centre + toward * foot;
        let along = left_normal(toward);
        let thirds: Vec<(DVec2, f64)> =
            others.iter().map(|c| (c.centre.offset_to(origin), c.radius * c.radius)).collect();
        let open = |t: f64| {
            let p = middle + along * t;
            let reached = |s: &Side| s.profile.reaches(p - s.centre) && t.abs() <= OBLIQUE * s.line;
            let off_thirds = || {
                thirds.iter().all(|(c, r2)| {
                    let power = p.distance_squared(*c) - r2;
                    let off = |s: &Side| (power - s.power(p)) / (2.0 * s.centre.distance(*c));
                    off(&sides[0]).max(off(&sides[1])) >= CORNER
                })
            };
            sides.iter().all(reached) && off_thirds() && ground_suits(terrain, origin.to_plan(p), along)
        };
        let (from, to) = longest_run((chord.sqrt() / STEP).floor() as i64, |k| open(k as f64 * STEP))?;
        let (from, length) = (from as f64 * STEP, (to - from) as f64 * STEP);
        if length < LEAST_LENGTH {
            return None;
        }
        let mut stream = seed.stream("border", &[a.id.0, b.id.0]);
        let deviation = stream.signed() * (DEVIATION.0 * length).min(DEVIATION.1);
        let (turns, phase) = (stream.range(0.6, 1.4), stream.range(0.0, TAU));
        let parts = (length / SPACING).round();
        let bent = |deviation: f64| -> Vec<DVec2> {
            let point = |i: usize| {
                let t = i as f64 / parts;
                // Straight at its ends, where the border with a third settlement may come near.
                let hold = math::sin(PI * t);
                let off = deviation * hold * hold * math::sin(TAU * turns * t + phase);
                quantize(middle + along * (from + t * length) + toward * off)
            };
            (0..=parts as usize).map(point).collect()
        };
        let fits = |line: &[DVec2]| {
            let dry = |p: DVec2| ground_suits(terrain, origin.to_plan(p), along);
            line.windows(2).all(|w| {
                let seen = |s: &Side, p: DVec2, q: DVec2| {
                    let (ray, edge) = (p - s.centre, q - p);
                    ray.length() <= s.radius && ray.perp_dot(edge) >= GRAZING * ray.length() * edge.length()
                };
                seen(&sides[0], w[0], w[1])
                    && seen(&sides[1], w[1], w[0])
                    && dry(w[0])
                    && dry(w[1])
                    && dry(w[0].lerp(w[1], 0.5))
            })
        };
        let line = [deviation, deviation / 2.0, 0.0].into_iter().map(bent).find(|line| fits(line))?;
        let class = if a.size.min(b.size) >= SizeClass::Town { StreetClass::Arterial } else { StreetClass::Main };
        let gates = place_gates(line.len(), length / parts);
        Some(Self { origin, sides: [a.id, b.id], line, gates, class })
    }

    /// Approximate size in bytes, heap included.
    pub(in crate::region) fn bytes(&self) -> usize {
        size_of::<Self>() + self.line.len() * size_of::<DVec2>() + self.gates.len() * 8
    }

    /// Id of the junction at a gate, given by its index in [`Border::gates`].
    pub fn junction(&self, gate: usize) -> JunctionId {
        JunctionId::of(&[WORD, self.sides[0].0, self.sides[1].0, gate as u64])
    }

    /// The streets between neighbouring gates, local to the border's origin, in order along the line.
    pub fn streets(&self) -> Vec<Street> {
        let street = |(k, ends): (usize, &[usize])| {
            let id = StreetId::of(&[WORD, self.sides[0].0, self.sides[1].0, k as u64]);
            let line = self.line[ends[0]..=ends[1]].to_vec();
            Street::new(id, self.class, self.junction(k), self.junction(k + 1), line)
        };
        self.gates.windows(2).enumerate().map(street).collect()
    }

    /// Whether a settlement lies on the left of the line.
    pub fn is_left(&self, of: SettlementId) -> bool {
        self.sides[0] == of
    }

    /// The vertices as the outline of one of the settlements has them: counter-clockwise around its `centre`, local to it.
    pub(super) fn around(&self, of: SettlementId, centre: Origin) -> Vec<DVec2> {
        let shift = self.origin.offset_to(centre);
        let mut out: Vec<DVec2> = self.line.iter().map(|p| *p + shift).collect();
        if !self.is_left(of) {
            out.reverse();
        }
        out
    }
}

/// First and last number of the longest run in -`most`..=`most` for which `open` holds.
fn longest_run(most: i64, open: impl Fn(i64) -> bool) -> Option<(i64, i64)> {
    let mut best: Option<(i64, i64)> = None;
    let mut start = None;
    for k in -most..=most + 1 {
        if k <= most && open(k) {
            start = start.or(Some(k));
        } else if let Some(from) = start.take()
            && best.is_none_or(|(a, b)| k - 1 - from > b - a)
        {
            best = Some((from, k - 1));
        }
    }
    best
}

/// Whether a street may run in the direction `way` at a plan point: dry ground on both sides, and no steep grade.
fn ground_suits(terrain: &dyn Terrain, p: DVec2, way: DVec2) -> bool {
    let aside = left_normal(way) * BANK;
    let (before, after) = (terrain.sample(p - way * BANK), terrain.sample(p + way * BANK));
    (after.height - before.height).abs() <= MAX_GRADE * 2.0 * BANK
        && [p, p + aside, p - aside].into_iter().all(|q| terrain.sample(q).depth() == 0.0)
        && before.depth().max(after.depth()) == 0.0
}

/// Indices of the gates of a border with `vertices` vertices that are `edge` metres apart, spread evenly over all vertices but
/// the first and the last.
fn place_gates(vertices: usize, edge: f64) -> Vec<usize> {
    let inner = vertices - 3;
    let room = inner as f64 * edge;
    if room < 0.55 * GATE_SPACING {
        return vec![vertices / 2];
    }
    let count = (room / GATE_SPACING).round().max(1.0) as usize;
    (0..=count).map(|i| 1 + (i * inner + count / 2) / count).collect()
}

#[cfg(test)]
mod tests;
