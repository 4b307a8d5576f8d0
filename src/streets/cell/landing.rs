//! Landing: how a new street ends among existing ones. These are the snap and clip operations of Teng 2017, section 3.

use super::canvas::Canvas;
use super::obstacle::{NONE, Neighbourhood, Obstacle, nearest};
use super::proposal::Join;
use super::rules::Limits;
use crate::network::VertexIx;
use crate::patch::LEAST_ARM;
use crate::space::point_at;
use glam::DVec2;

/// A street that meets another within this distance of a point of inflexion is led to that point, in metres.
const AT_INFLEXION: f64 = 5.0;

/// Finds where a street ends among the obstacles near it.
#[derive(Clone, Copy)]
pub struct Landing<'a> {
    /// The streets that are built.
    pub canvas: &'a Canvas,
    /// The obstacles that a street may meet.
    pub near: &'a Neighbourhood,
    /// Distance over which the end of a street is drawn to another, in metres.
    pub snap_radius: f64,
    /// Least cosine of the bend where a street goes on as another.
    pub straightness: f64,
}

impl Landing<'_> {
    /// The first obstacle that the segment `from`-`to` meets, with the parameter and the position of the meeting point on the
    /// segment. What ends at the vertex `leaving` is ignored.
    pub fn ray(&self, from: DVec2, to: DVec2, leaving: VertexIx) -> Option<(Obstacle, f64, DVec2)> {
        if self.near.obstacles.is_empty() {
            // Only dead ends were gathered.
            self.canvas.ray(from, to, leaving, self.near.within)
        } else {
            self.near.ray(from, to, leaving)
        }
    }

    /// Settles the end of a street along `line`: on a street or vertex that it meets or comes near to, cut back from the
    /// border, or at the end of the line. `line` is changed accordingly. `None` if too little is left of the street. Streets
    /// that end at the vertex `leaving` are ignored.
    pub fn settle(&self, line: &mut Vec<DVec2>, leaving: VertexIx, limits: &Limits) -> Option<Join> {
        let snap = self.snap_radius;
        let mut before = 0.0;
        for k in 0..line.len().saturating_sub(1) {
            let (from, to) = (line[k], line[k + 1]);
            let length = from.distance(to);
            let direction = (to - from) / length.max(1e-9);
            let last = k + 2 == line.len();
            // Most of a street lies in the open.
            if !last && self.canvas.is_clear(from, length) {
                before += length;
                continue;
            }
            // What lies less far ahead than the gap must be met or kept away from.
            let reach = length + if last { snap.max(limits.gap) } else { 0.0 };
            let leaving = if k == 0 { leaving } else { NONE };
            let hit = self.ray(from, from + direction * reach, leaving);
            let ahead = hit.map_or(reach, |h| h.1 * reach);
            if last && let Some((v, p)) = self.facing_end(from, direction, length, ahead, leaving) {
                line.truncate(k + 1);
                line.push(p);
                return Some(Join::At(v));
            }
            let Some((s, _, at)) = hit else {
                before += length;
                continue;
            };
            if s.is_wall() {
                let sine = (s.b - s.a).normalize_or_zero().perp_dot(direction).abs().max(0.2);
                let room = before + ahead - limits.wall_gap.max(s.floor) / sine - 0.1;
                let cut = room.min(before + length);
                if cut < LEAST_ARM {
                    return None;
                }
                cut_back(line, cut);
                return Some(Join::Free(true));
            }
            let (end, join) = landing_place(self.canvas, &s, at, limits);
            line.truncate(k + 1);
            line.push(end);
            return Some(join);
        }
        Some(Join::Free(true))
    }

    /// Where a street that ends in the open at `end` can be led instead: to the nearest street within the snap radius. What
    /// meets the vertex `leaving` does not count.
    pub fn snap(&self, end: DVec2, leaving: VertexIx, limits: &Limits) -> Option<(DVec2, Join)> {
        let streets = self.near.obstacles.iter().filter(|s| !s.is_wall() && !s.ends_at(leaving));
        let places = streets.map(|s| (s, nearest(end, s.a, s.b))).map(|(s, p)| (s, p, p.distance(end)));
        let found = places.filter(|x| x.2 <= self.snap_radius).min_by(|x, y| x.2.total_cmp(&y.2));
        found.map(|(s, p, _)| landing_place(self.canvas, s, p, limits))
    }

    /// Where a street from `from` that meets another at `end` can be led so that it meets it square, if that is within the snap
    /// radius.
    pub fn square(&self, from: DVec2, end: DVec2, limits: &Limits) -> Option<(DVec2, Join)> {
        let met = self.near.obstacles.iter().filter(|s| !s.is_wall() && nearest(end, s.a, s.b).distance(end) < 0.01);
        let foot = |s: &Obstacle| nearest(from, s.a, s.b);
        let found = met.map(|s| (s, foot(s))).find(|(_, p)| p.distance(end) <= self.snap_radius);
        found.map(|(s, p)| landing_place(self.canvas, s, p, limits))
    }

    /// The loose end to which a street from `from` can be led with only a slight bend at either end. It lies about where a
    /// street of `length` metres ends, or beyond, and at most `ahead` metres away.
    fn facing_end(
        &self,
        from: DVec2,
        direction: DVec2,
        length: f64,
        ahead: f64,
        leaving: VertexIx,
    ) -> Option<(VertexIx, DVec2)> {
        let snap = self.snap_radius;
        let mut best: Option<(VertexIx, DVec2, f64)> = None;
        for tip in &self.near.loose_ends {
            let (p, off) = (tip.at, direction.perp_dot(tip.at - from).abs());
            let along = (p - from).dot(direction);
            if tip.v == leaving || along < 0.5 * length || along > ahead.min(length + snap) {
                continue;
            }
            let far = from.distance(p);
            let faces = tip.onward.dot(from - p) >= 0.7 * far;
            let first = |w: VertexIx| self.canvas.graph.edges_at(w).first().copied();
            let better = |b: (VertexIx, DVec2, f64)| off < b.2 || (off == b.2 && first(tip.v) < first(b.0));
            if along >= self.straightness * far && faces && best.is_none_or(better) {
                best = Some((tip.v, p, off));
            }
        }
        best.map(|(v, p, _)| (v, p))
    }
}

/// Where a street that meets the street `s` at `at` ends: at a vertex close by if there is one, else in a new junction.
pub fn landing_place(canvas: &Canvas, s: &Obstacle, at: DVec2, limits: &Limits) -> (DVec2, Join) {
    let next_to = |v: VertexIx| if canvas.is_end(v) { limits.min_piece } else { AT_INFLEXION };
    let vertex = [(s.va, s.a), (s.vb, s.b)]
        .into_iter()
        .filter(|(v, p)| p.distance(at) < next_to(*v) && canvas.nodes[*v as usize].port.is_none())
        .min_by(|x, y| x.1.distance(at).total_cmp(&y.1.distance(at)));
    vertex.map_or((at, Join::On(s.edge)), |(v, p)| (p, Join::At(v)))
}

/// Shortens a line to its first `length` metres.
fn cut_back(line: &mut Vec<DVec2>, length: f64) {
    let end = point_at(line, length).0;
    let mut along = 0.0;
    let mut kept = 1;
    while kept < line.len() {
        along += line[kept - 1].distance(line[kept]);
        if along >= length {
            break;
        }
        kept += 1;
    }
    line.truncate(kept);
    if line[kept - 1] != end {
        line.push(end);
    }
}
