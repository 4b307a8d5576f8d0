//! Rivers that run through outlines: the two bank lines that cut an outline in two, and where bridges may stand.

use super::river::River;
use crate::space::math::{angle_between, angle_of};
use crate::space::{
    distance_to_segment, line_length, point_in_polygon, quantize, segment_crossing, segments, signed_area,
};
use glam::DVec2;

/// Least length of a bank line within an outline, in metres.
const LEAST_LENGTH: f64 = 180.0;
/// Least area on either side, in square metres.
const LEAST_AREA: f64 = 45_000.0;
/// Least area on either side per metre of bank line: the mean depth of the ground in metres.
const LEAST_DEPTH: f64 = 110.0;
/// Least number of places for bridges.
const LEAST_SPANS: usize = 4;
/// Least distance along the outline from the end of a bank line to another vertex, in metres.
const CORNER: f64 = 18.0;
/// Least length of the first and last piece of a bank line, in metres.
const LAST_PIECE: f64 = 10.0;
/// Least angle between a bank line and the outline, in radians.
const LEAST_ANGLE: f64 = 0.35;
/// Distance in metres from the end of a bank line within which the outline has no gate.
const GATE_ROOM: f64 = 45.0;

/// A river that runs through an outline. The water lies between two bank lines, which cut the outline into three parts: one on
/// each side, and the river's bed. Positions are local to the settlement.
#[derive(Clone, Debug, PartialEq)]
pub struct Waterway {
    /// Middle of the water, from before the river enters the outline to after it has left it.
    pub middle: Vec<DVec2>,
    /// Bank lines to the left and right along the middle, on the quantum grid, about 20 m from the water. They begin and end at
    /// vertices of the outline.
    pub banks: [Vec<DVec2>; 2],
    /// The outline's vertices at which each bank line begins and ends.
    pub ends: [[usize; 2]; 2],
    /// Pairs of places opposite each other, in order: an index into each bank line. A bridge between them is perpendicular
    /// to the river.
    pub spans: Vec<[usize; 2]>,
    /// The span nearest to the settlement's centre, as an index into `spans`.
    pub first: usize,
}

/// An outline that a river runs through.
pub(super) struct Cut {
    pub polygon: Vec<DVec2>,
    /// Index in the new polygon of each old vertex, `None` for vertices that were dropped.
    pub moved: Vec<Option<usize>>,
    pub waterway: Waterway,
}

/// Where a bank line leaves an outline.
#[derive(Clone, Copy)]
struct Exit {
    /// Edge of the outline, by its first vertex.
    edge: usize,
    at: DVec2,
    /// The last station inside the outline.
    station: usize,
}

impl Waterway {
    /// Direction of the river where it is nearest to the settlement's centre, in radians.
    pub fn heading(&self) -> f64 {
        let [a, b] = self.spans[self.first];
        angle_of((self.banks[1][b] - self.banks[0][a]).perp())
    }

    /// The bank line that a point lies on, 0 for left and 1 for right; `None` if it lies on neither.
    pub fn bank_at(&self, p: DVec2) -> Option<usize> {
        (0..2).find(|side| segments(&self.banks[*side]).any(|(a, b)| distance_to_segment(p, a, b) < 0.05))
    }

    /// Whether the straight line from `a` to `b` crosses the water.
    pub fn crosses(&self, a: DVec2, b: DVec2) -> bool {
        segments(&self.middle).any(|(c, d)| segment_crossing(a, b, c, d).is_some())
    }

    /// Whether a point lies between the bank lines or on one of them.
    pub fn holds(&self, p: DVec2) -> bool {
        self.bank_at(p).is_some() || point_in_polygon(p, &self.bed())
    }

    /// The river's bed within the outline: the polygon between the bank lines.
    pub fn bed(&self) -> Vec<DVec2> {
        self.banks[1].iter().chain(self.banks[0].iter().rev()).copied().collect()
    }

    /// Whether a gate may stand at a point of the outline, because the river is far enough away.
    pub(super) fn leaves_room(&self, at: DVec2) -> bool {
        let ends = self.banks.iter().flat_map(|b| [b[0], b[b.len() - 1]]);
        ends.into_iter().all(|p| p.distance(at) >= GATE_ROOM)
    }

    /// Cuts an outline in two along a river. `None` if no two useful parts remain. Vertices that are `held` stay.
    pub(super) fn cut(polygon: &[DVec2], held: &[bool], river: &River) -> Option<Cut> {
        let n = polygon.len();
        let stations = river.middle.len();
        let exit = |side: usize, back: bool| -> Option<Exit> {
            let line = &river.banks[side];
            let mut at = river.first;
            if !point_in_polygon(line[at], polygon) {
                return None;
            }
            loop {
                let next = if back { at.checked_sub(1)? } else { at + 1 };
                let to = *line.get(next)?;
                let hits = (0..n).filter_map(|edge| {
                    let x = segment_crossing(line[at], to, polygon[edge], polygon[(edge + 1) % n])?;
                    Some(Exit { edge, at: quantize(x.at), station: at })
                });
                let nearest = hits.min_by(|a, b| line[at].distance(a.at).total_cmp(&line[at].distance(b.at)));
                if nearest.is_some() {
                    return nearest;
                }
                at = next;
            }
        };
        // Counter-clockwise, the outline passes the right bank before the left one where the river leaves, and the left bank
        // before the right one where it enters.
        let [out_right, out_left] = [exit(1, false)?, exit(0, false)?];
        let [in_left, in_right] = [exit(0, true)?, exit(1, true)?];
        let mut gone = vec![false; n];
        for (a, b) in [(out_right, out_left), (in_left, in_right)] {
            let count = (b.edge + n - a.edge) % n;
            if count > n / 3 || (count == 0 && polygon[a.edge].distance(a.at) >= polygon[a.edge].distance(b.at)) {
                return None;
            }
            (0..count).for_each(|k| gone[(a.edge + 1 + k) % n] = true);
            // Vertices too near the new ends would leave tiny edges.
            for (from, at, ahead) in [(a.edge, a.at, false), ((b.edge + 1) % n, b.at, true)] {
                let mut v = from;
                while !held[v] && polygon[v].distance(at) < CORNER {
                    gone[v] = true;
                    v = if ahead { (v + 1) % n } else { (v + n - 1) % n };
                }
            }
        }
        let on_border = |exit: &Exit| held[exit.edge] && held[(exit.edge + 1) % n];
        if [out_right, out_left, in_left, in_right].iter().any(on_border) || (0..n).any(|i| gone[i] && held[i]) {
            return None;
        }
        let (mut out, mut moved) = (Vec::with_capacity(n + 4), vec![None; n]);
        let mut ends = [[0; 2]; 2];
        for i in 0..n {
            if !gone[i] {
                moved[i] = Some(out.len());
                out.push(polygon[i]);
            }
            for (exit, side, end) in [(out_right, 1, 1), (out_left, 0, 1), (in_left, 0, 0), (in_right, 1, 0)] {
                if exit.edge == i {
                    ends[side][end] = out.len();
                    out.push(exit.at);
                }
            }
        }
        let bank = |side: usize, first: &Exit, last: &Exit| {
            let mut range = first.station..=last.station;
            let line = &river.banks[side];
            while !range.is_empty() && line[*range.start()].distance(first.at) < LAST_PIECE {
                range = range.start() + 1..=*range.end();
            }
            while !range.is_empty() && line[*range.end()].distance(last.at) < LAST_PIECE {
                range = *range.start()..=range.end().checked_sub(1)?;
            }
            (range.end() > range.start()).then_some(range)
        };
        let ranges = [bank(0, &in_left, &out_left)?, bank(1, &in_right, &out_right)?];
        let banks = [0, 1].map(|side| {
            let (first, last) = (out[ends[side][0]], out[ends[side][1]]);
            let inner = river.banks[side][ranges[side].clone()].iter().copied();
            std::iter::once(first).chain(inner).chain([last]).collect::<Vec<_>>()
        });
        let (low, high) = (ranges[0].start().max(ranges[1].start()), ranges[0].end().min(ranges[1].end()));
        let spans: Vec<[usize; 2]> =
            (*low..=*high).map(|k| [k - ranges[0].start() + 1, k - ranges[1].start() + 1]).collect();
        let first = river.first.checked_sub(*low).filter(|i| *i < spans.len())?;
        let lowest = ranges[0].start().min(ranges[1].start()).saturating_sub(2);
        let highest = (ranges[0].end().max(ranges[1].end()) + 2).min(stations - 1);
        let waterway = Waterway { middle: river.middle[lowest..=highest].to_vec(), banks, ends, spans, first };
        waterway.is_decent(&out).then_some(Cut { polygon: out, moved, waterway })
    }

    /// Whether the bank lines cut `polygon` into parts that are large enough, and meet neither the polygon nor each other.
    fn is_decent(&self, polygon: &[DVec2]) -> bool {
        let n = polygon.len();
        let star = (0..n).all(|i| polygon[i].perp_dot(polygon[(i + 1) % n]) > 0.0);
        let adjacent = |v: usize, e: usize| e == v || (e + 1) % n == v;
        let meets_outline = |side: usize| {
            let (bank, ends) = (&self.banks[side], self.ends[side]);
            let last = bank.len() - 2;
            segments(bank).enumerate().any(|(i, (a, b))| {
                (0..n).any(|e| {
                    let own = (i == 0 && adjacent(ends[0], e)) || (i == last && adjacent(ends[1], e));
                    !own && segment_crossing(a, b, polygon[e], polygon[(e + 1) % n]).is_some()
                })
            }) || !bank[1..=last].iter().all(|p| point_in_polygon(*p, polygon))
        };
        let slanted = |side: usize| {
            let bank = &self.banks[side];
            [(self.ends[side][0], bank[1]), (self.ends[side][1], bank[bank.len() - 2])].into_iter().any(|(v, inner)| {
                let at = polygon[v];
                [polygon[(v + 1) % n], polygon[(v + n - 1) % n]]
                    .into_iter()
                    .any(|p| angle_between(p - at, inner - at) < LEAST_ANGLE)
            })
        };
        let meets_itself = || {
            let all: Vec<(usize, usize, DVec2, DVec2)> = (0..2)
                .flat_map(|side| segments(&self.banks[side]).enumerate().map(move |(i, (a, b))| (side, i, a, b)))
                .collect();
            all.iter().enumerate().any(|(k, (side, i, a, b))| {
                all[k + 1..].iter().any(|(other, j, c, d)| {
                    let joined = side == other && i.abs_diff(*j) <= 1;
                    !joined && segment_crossing(*a, *b, *c, *d).is_some()
                })
            })
        };
        star && self.banks.iter().all(|b| line_length(b) >= LEAST_LENGTH)
            && (0..2).all(|side| !meets_outline(side) && !slanted(side))
            && !meets_itself()
            && self.spans.len() >= LEAST_SPANS
            && self
                .parts(polygon)
                .iter()
                .zip(&self.banks)
                .all(|(part, bank)| signed_area(part) >= LEAST_AREA.max(LEAST_DEPTH * line_length(bank)))
            && signed_area(&self.bed()) > 0.0
    }

    /// The ground to the left and right of the river, as polygons.
    fn parts(&self, polygon: &[DVec2]) -> [Vec<DVec2>; 2] {
        let n = polygon.len();
        let around = |from: usize, to: usize| (1..(to + n - from) % n).map(move |k| polygon[(from + k) % n]);
        let left = self.banks[0].iter().copied().chain(around(self.ends[0][1], self.ends[0][0]));
        let right = self.banks[1].iter().rev().copied().chain(around(self.ends[1][0], self.ends[1][1]));
        [left.collect(), right.collect()]
    }
}
