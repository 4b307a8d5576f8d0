//! Turns: the ways from lanes that arrive at a junction to lanes that leave it.

use super::control::{Approach, Control, controls};
use super::curve::curve;
use super::layout::{Lane, LaneId, lanes_of};
use crate::network::{JunctionId, Side, Street, StreetClass};
use crate::space::{math, segment_crossing, segments, stable_hash};
use glam::DVec2;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Where a turn leads, as seen by the driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurnKind {
    /// Straight on.
    Straight,
    /// To the left.
    Left,
    /// To the right.
    Right,
    /// Back into the street that the driver came from.
    Back,
}

impl TurnKind {
    /// Lower-case name, as in exported files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Straight => "straight",
            Self::Left => "left",
            Self::Right => "right",
            Self::Back => "back",
        }
    }
}

impl Turn {
    /// Stable name: the same in every run and in every chunk.
    pub fn id(&self) -> u64 {
        stable_hash(&[self.from.0, self.to.0])
    }
}

/// A way through a junction from the end of a lane to the start of another.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// The lane that arrives.
    pub from: LaneId,
    /// The lane that leaves.
    pub to: LaneId,
    /// Where it leads.
    pub kind: TurnKind,
    /// What the driver must do before the junction.
    pub control: Control,
    /// Centre line, from the last point of the lane `from` to the first point of the lane `to`.
    pub line: Vec<DVec2>,
    /// The turns through the same junction, as indices into its turns, that cross this one or end in the same lane. Turns from
    /// the same lane are none of them.
    pub conflicts: Vec<usize>,
}

/// Deviations from straight on up to which a turn counts as straight on, in radians.
const STRAIGHT: f64 = 0.7;

/// Deviation from straight on beyond which no turn leads between a ramp and a road, in radians: ramps join highways one way.
const SHARPEST_AT_RAMP: f64 = 2.2;

/// The end of a street at a junction, with its lanes.
struct Arm {
    approach: Approach,
    /// The lanes that arrive and those that leave, from the middle of the street outwards.
    arriving: Vec<Lane>,
    leaving: Vec<Lane>,
}

impl Arm {
    fn new(of: &Street, begins: bool, driving: Side) -> Option<Self> {
        let lanes = lanes_of(of, driving);
        let mut ends = segments(&of.line).filter(|(a, b)| a != b);
        let (a, b) = if begins { ends.next()? } else { ends.next_back().map(|(a, b)| (b, a))? };
        let approach = Approach { class: of.class, out: (b - a).normalize_or_zero(), ring: of.island.is_some() };
        let (leaving, arriving) = lanes.into_iter().partition(|lane| lane.along == begins);
        Some(Self { approach, arriving, leaving })
    }
}

/// The streets at each junction, each with whether it begins there, as [`turns_at`] reads them.
pub fn ends_by_junction<'a>(
    streets: impl IntoIterator<Item = &'a Street>,
) -> BTreeMap<JunctionId, Vec<(&'a Street, bool)>> {
    let mut ends: BTreeMap<JunctionId, Vec<(&Street, bool)>> = BTreeMap::new();
    for street in streets {
        ends.entry(street.from).or_default().push((street, true));
        ends.entry(street.to).or_default().push((street, false));
    }
    ends
}

/// A turn from one arm into another, before its lanes are chosen.
#[derive(Clone, Copy)]
struct Way {
    from: usize,
    to: usize,
    /// Deviation from straight on, positive to the left, in radians.
    bend: f64,
    kind: TurnKind,
}

/// The turns through a junction.
#[derive(Clone, Debug, PartialEq)]
pub struct JunctionTurns {
    /// The junction.
    pub junction: JunctionId,
    /// The turns, sorted by the lanes that they come from and lead to.
    pub turns: Vec<Turn>,
}

/// The turns through a junction where traffic drives on the side `driving`. `ends` are all the streets there, each with whether
/// it begins at the junction.
///
/// Every lane that arrives goes on, and every lane that leaves is reached, unless all streets lead one way only. Drivers turn
/// back only where there is no other way on. From streets with several lanes, turns to the near side begin in the outermost
/// lane and turns to the far side in the lane at the middle.
pub fn turns_at(junction: JunctionId, ends: &[(&Street, bool)], driving: Side) -> JunctionTurns {
    let arms: Vec<Arm> = ends.iter().filter_map(|(s, begins)| Arm::new(s, *begins, driving)).collect();
    let controls = controls(&arms.iter().map(|arm| arm.approach).collect::<Vec<_>>());
    let near = if driving == Side::Right { TurnKind::Right } else { TurnKind::Left };
    let mut pairs: Vec<(Way, usize, usize)> = Vec::new();
    for from in 0..arms.len() {
        let ways = ways_from(&arms, from);
        for way in ways.iter().filter(|way| !is_sharp_at_ramp(&arms, way)) {
            let (n, m) = (arms[from].arriving.len(), arms[way.to].leaving.len());
            pairs.extend(lane_pairs(way.kind, near, n, m).map(|(lane, into)| (*way, lane, into)));
        }
        // A lane that no turn leaves goes on the straightest way.
        let straightest = ways.iter().min_by(|a, b| a.bend.abs().total_cmp(&b.bend.abs()));
        for lane in 0..arms[from].arriving.len() {
            let goes_on = pairs.iter().any(|(way, l, _)| way.from == from && *l == lane);
            if let Some(way) = straightest.filter(|_| !goes_on) {
                pairs.push((*way, lane, lane.min(arms[way.to].leaving.len() - 1)));
            }
        }
    }
    for to in 0..arms.len() {
        let ways = (0..arms.len()).flat_map(|from| ways_from(&arms, from)).filter(|way| way.to == to);
        let straightest = ways.min_by(|a, b| a.bend.abs().total_cmp(&b.bend.abs())).or_else(|| back(&arms, to));
        for into in 0..arms[to].leaving.len() {
            let reached = pairs.iter().any(|(way, _, i)| way.to == to && *i == into);
            if let Some(way) = straightest.filter(|_| !reached) {
                pairs.push((way, into.min(arms[way.from].arriving.len() - 1), into));
            }
        }
    }
    let mut turns: Vec<Turn> = pairs
        .into_iter()
        .map(|(way, lane, into)| {
            let (a, b) = (&arms[way.from], &arms[way.to]);
            let (from, to) = (&a.arriving[lane], &b.leaving[into]);
            let line = join(from, to);
            let (kind, control) = (way.kind, controls[way.from]);
            Turn { from: from.id, to: to.id, kind, control, line, conflicts: Vec::new() }
        })
        .collect();
    turns.sort_by_key(|turn| (turn.from, turn.to));
    find_conflicts(&mut turns);
    JunctionTurns { junction, turns }
}

/// The ways from an arm into the others; back into the same arm if there is none.
fn ways_from(arms: &[Arm], from: usize) -> Vec<Way> {
    if arms[from].arriving.is_empty() {
        return Vec::new();
    }
    let bend = |to: usize| math::turn(-arms[from].approach.out, arms[to].approach.out);
    let others = (0..arms.len()).filter(|to| *to != from && !arms[*to].leaving.is_empty());
    let mut ways: Vec<Way> = others.map(|to| Way { from, to, bend: bend(to), kind: TurnKind::Straight }).collect();
    let straightest = ways.iter().map(|way| way.bend.abs()).fold(f64::INFINITY, f64::min);
    for way in &mut ways {
        if way.bend.abs() > STRAIGHT || way.bend.abs() > straightest {
            way.kind = if way.bend > 0.0 { TurnKind::Left } else { TurnKind::Right };
        }
    }
    if ways.is_empty() {
        ways.extend(back(arms, from));
    }
    ways
}

/// The way back into an arm, if traffic goes both ways there.
fn back(arms: &[Arm], arm: usize) -> Option<Way> {
    let both = !arms[arm].arriving.is_empty() && !arms[arm].leaving.is_empty();
    both.then_some(Way { from: arm, to: arm, bend: PI, kind: TurnKind::Back })
}

/// Whether a way would turn sharply between a ramp and another street.
fn is_sharp_at_ramp(arms: &[Arm], way: &Way) -> bool {
    let is_ramp = |arm: usize| arms[arm].approach.class == StreetClass::Ramp;
    is_ramp(way.from) != is_ramp(way.to) && way.bend.abs() > SHARPEST_AT_RAMP
}

/// Which of `n` lanes lead into which of `m` lanes by a turn of a kind, where `near` is the kind to the near side.
fn lane_pairs(kind: TurnKind, near: TurnKind, n: usize, m: usize) -> impl Iterator<Item = (usize, usize)> {
    let all = match kind {
        TurnKind::Straight | TurnKind::Back => 0..n,
        _ if kind == near => n - 1..n,
        _ => 0..1,
    };
    all.map(move |lane| match kind {
        TurnKind::Straight | TurnKind::Back => (lane, lane.min(m - 1)),
        _ if kind == near => (lane, m - 1),
        _ => (lane, 0),
    })
}

/// The centre line of a turn.
fn join(from: &Lane, to: &Lane) -> Vec<DVec2> {
    let direction = |pair: Option<(DVec2, DVec2)>| pair.map_or(DVec2::ZERO, |(a, b)| (b - a).normalize_or_zero());
    let (out, on) = (direction(segments(&from.line).next_back()), direction(segments(&to.line).next()));
    curve(from.line[from.line.len() - 1], out, to.line[0], on)
}

/// Finds the turns that cross each other or end in the same lane.
fn find_conflicts(turns: &mut [Turn]) {
    for i in 0..turns.len() {
        for k in 0..i {
            let (a, b) = (&turns[i], &turns[k]);
            let crosses = || {
                segments(&a.line).any(|(p, q)| segments(&b.line).any(|(r, s)| segment_crossing(p, q, r, s).is_some()))
            };
            if a.from != b.from && (a.to == b.to || crosses()) {
                turns[i].conflicts.push(k);
                turns[k].conflicts.push(i);
            }
        }
    }
    turns.iter_mut().for_each(|turn| turn.conflicts.sort_unstable());
}
