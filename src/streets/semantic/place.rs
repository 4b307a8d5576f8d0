//! Laying a patch on the plan, and settling its loose ends on what is there: the snap and clip operations of Teng 2017,
//! section 3.

use super::Work;
use super::bend::Bend;
use super::joint::joint_angle_fits;
use super::near::{NONE, Seg, nearest};
use super::proposal::{Join, Limits, Proposal};
use crate::network::VertexIx;
use crate::patch::{LEAST_ARM, STREET_FLOOR, keeps_rules};
use crate::space::{Bounds, point_at, segment_crossing};
use crate::streets::MadeBy;
use glam::DVec2;

/// A street that meets another this near to a point of inflexion meets it there, in metres.
const AT_INFLEXION: f64 = 5.0;

/// A patch laid on the plan: mirrored if so, scaled and turned about the origin, moved, then bent a little.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// Index into the database.
    pub patch: usize,
    /// Vertex of the patch that the current vertex becomes.
    pub start: usize,
    x_axis: DVec2,
    y_axis: DVec2,
    offset: DVec2,
    bend: Option<Bend>,
}

impl Placement {
    /// The placement that puts `start`, which lies at `start_at` in the patch, at `at`, and turns and scales the patch
    /// vector `from` into `to`.
    pub fn new(
        (patch, start, start_at): (usize, usize, DVec2),
        from: DVec2,
        mirrored: bool,
        at: DVec2,
        to: DVec2,
    ) -> Self {
        // A mirrored patch is turned over its x axis before it is turned.
        let from = if mirrored { DVec2::new(from.x, -from.y) } else { from };
        let x_axis = DVec2::new(from.dot(to), from.perp_dot(to)) / from.length_squared();
        let y_axis = if mirrored { -x_axis.perp() } else { x_axis.perp() };
        let offset = at - x_axis * start_at.x - y_axis * start_at.y;
        Self { patch, start, x_axis, y_axis, offset, bend: None }
    }

    /// The placement that puts `start`, at `start_at` in the patch, at `at`, turns and scales the patch vector `from` into
    /// `to`, and scales what lies square to `from` by `across`; negative mirrors the patch at that vector.
    pub fn drawn_out(
        (patch, start, start_at): (usize, usize, DVec2),
        from: DVec2,
        at: DVec2,
        to: DVec2,
        across: f64,
    ) -> Self {
        let along = from / from.length_squared();
        let (u, v) = (to, to.normalize_or_zero().perp() * (across / from.length()));
        let (x_axis, y_axis) = (u * along.x - v * from.y, u * along.y + v * from.x);
        Self { patch, start, x_axis, y_axis, offset: at - x_axis * start_at.x - y_axis * start_at.y, bend: None }
    }

    /// The same, bent so that the street that it has between `from` and `to` changes its slopes there by `slopes`.
    pub fn bent(self, from: DVec2, to: DVec2, slopes: [f64; 2]) -> Self {
        let bend = if slopes == [0.0; 2] { None } else { Some(Bend::new(from, to, slopes)) };
        Self { bend, ..self }
    }

    /// Whether it is more than turned, scaled and moved.
    pub fn is_bent(&self) -> bool {
        self.bend.is_some()
            || self.x_axis.dot(self.y_axis).abs() + (self.x_axis.length() - self.y_axis.length()).abs() > 1e-6
    }

    /// Where a patch position comes to lie.
    pub fn map(&self, p: DVec2) -> DVec2 {
        let p = self.offset + self.x_axis * p.x + self.y_axis * p.y;
        self.bend.map_or(p, |b| p + b.shift(p))
    }
}

impl Work<'_> {
    /// Collects the obstacles that matter to the proposal; [`unfocus`](Self::unfocus) takes that back.
    fn focus(&mut self) {
        let reach = self.limits.reach() + 1.0;
        let bounds = Bounds::of(self.proposal.points.iter().copied()).grown(reach);
        std::mem::swap(&mut self.near, &mut self.around);
        self.canvas.gather_segs(bounds, &mut self.near);
        self.near.tips.clear();
        self.near.tips.extend(self.around.tips.iter().filter(|t| bounds.contains(t.at)));
    }

    /// Goes back to all the obstacles that were gathered.
    pub(super) fn unfocus(&mut self) {
        std::mem::swap(&mut self.near, &mut self.around);
    }

    /// Builds the placement if it fits.
    pub(super) fn build_patch(&mut self, placement: &Placement, anchors: &[(usize, VertexIx)]) -> bool {
        self.propose_patch(placement, anchors) && self.build_focused(MadeBy::Patch(placement.patch as u32))
    }

    /// Builds the proposal if it fits, held against the obstacles around it.
    pub(super) fn build_focused(&mut self, made_by: MadeBy) -> bool {
        self.focus();
        let fits = self.build_if_fits(&self.limits.clone(), made_by);
        self.unfocus();
        fits
    }

    /// Makes the placement the proposal, with its ends settled. `anchors` are the vertices of the patch that fall on
    /// vertices of the graph.
    pub(super) fn propose_patch(&mut self, placement: &Placement, anchors: &[(usize, VertexIx)]) -> bool {
        self.propose(placement, anchors, true)
    }

    /// The same; with `check`, false as well as soon as an arm meets a street at an angle that may not be.
    pub(super) fn propose(&mut self, placement: &Placement, anchors: &[(usize, VertexIx)], check: bool) -> bool {
        let anchor = |v: usize| anchors.iter().find(|a| a.0 == v).map(|a| a.1);
        let patch = &self.brief.patches.patches[placement.patch];
        let shape = &self.brief.patches.facts(placement.patch).shape;
        let mut p = std::mem::take(&mut self.proposal);
        p.clear();
        let mut slots = std::mem::take(&mut self.slots);
        slots.clear();
        slots.resize(patch.vertices.len(), NONE);
        let mut slot = |p: &mut Proposal, v: usize| {
            if slots[v] == NONE {
                slots[v] = p.points.len() as u32;
                let (at, join) = match anchor(v) {
                    Some(target) => (self.canvas.graph.at(target), Join::At(target)),
                    None => (placement.map(patch.vertices[v]), Join::Free(false)),
                };
                p.push(at, join);
            }
            slots[v] as usize
        };
        let mut line = std::mem::take(&mut self.line);
        let settled = |c: usize| anchor(c).is_none();
        for e in &shape.core {
            let edge = (slot(&mut p, e.0), slot(&mut p, e.1));
            p.edges.push(edge);
        }
        let mut fits = true;
        for arm in &shape.arms {
            let tip = arm[arm.len() - 1];
            // A street between two ends is an arm of both.
            let inner = arm[0];
            if shape.is_end[inner] && (inner > tip && settled(inner) || inner < tip && !settled(tip)) {
                continue;
            }
            if !settled(tip) {
                for w in arm.windows(2) {
                    let edge = (slot(&mut p, w[0]), slot(&mut p, w[1]));
                    p.edges.push(edge);
                }
                continue;
            }
            line.clear();
            line.extend(arm.iter().map(|v| placement.map(patch.vertices[*v])));
            let leaving = anchor(inner).unwrap_or(NONE);
            let Some(join) = self.settle(&mut line, leaving, &self.limits) else {
                fits = false;
                break;
            };
            let mut before = slot(&mut p, inner);
            let mut last = [before; 2];
            for (i, at) in line.iter().enumerate().skip(1) {
                p.push(*at, if i + 1 == line.len() { join } else { Join::Free(false) });
                p.edges.push((before, p.points.len() - 1));
                last = [before, p.points.len() - 1];
                before = last[1];
            }
            let (from, end) = (p.points[last[0]], p.points[last[1]]);
            fits = !check || joint_angle_fits(&self.canvas, join, end, from - end, &self.limits);
            if !fits {
                break;
            }
        }
        (self.proposal, self.slots, self.line) = (p, slots, line);
        fits && self.ends_keep_apart()
            && (!placement.is_bent() || keeps_rules(&self.proposal.points, &self.proposal.edges, 1.0))
    }

    /// How a street along `line` ends: on a street or vertex that it meets or comes near, cut back from the border, or
    /// at the end of the line, which is changed to that. `None` when too little is left of it. What ends at the vertex
    /// `leaving` is ignored.
    pub(super) fn settle(&self, line: &mut Vec<DVec2>, leaving: VertexIx, limits: &Limits) -> Option<Join> {
        let snap = self.brief.style.local.snap_radius;
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
            let (end, join) = self.landing_place(&s, at, limits);
            line.truncate(k + 1);
            line.push(end);
            return Some(join);
        }
        Some(Join::Free(true))
    }

    /// Where a street that meets the street `s` at `at` is led to: rather to a vertex than to a new junction next to it.
    pub(super) fn landing_place(&self, s: &Seg, at: DVec2, limits: &Limits) -> (DVec2, Join) {
        let next_to = |v: VertexIx| if self.canvas.is_end(v) { limits.min_piece } else { AT_INFLEXION };
        let vertex = [(s.va, s.a), (s.vb, s.b)]
            .into_iter()
            .filter(|(v, p)| p.distance(at) < next_to(*v) && self.canvas.nodes[*v as usize].port.is_none())
            .min_by(|x, y| x.1.distance(at).total_cmp(&y.1.distance(at)));
        vertex.map_or((at, Join::On(s.edge)), |(v, p)| (p, Join::At(v)))
    }

    /// The loose end that a street from `from` can be led to with no more than a slight bend at either end: up to `ahead`
    /// metres away, about where a street of `length` metres ends or beyond.
    fn facing_end(
        &self,
        from: DVec2,
        direction: DVec2,
        length: f64,
        ahead: f64,
        leaving: VertexIx,
    ) -> Option<(VertexIx, DVec2)> {
        let snap = self.brief.style.local.snap_radius;
        let mut best: Option<(VertexIx, DVec2, f64)> = None;
        for tip in &self.near.tips {
            let (p, off) = (tip.at, direction.perp_dot(tip.at - from).abs());
            let along = (p - from).dot(direction);
            if tip.v == leaving || along < 0.5 * length || along > ahead.min(length + snap) {
                continue;
            }
            let far = from.distance(p);
            let faces = tip.lead.dot(from - p) >= 0.7 * far;
            let first = |w: VertexIx| self.canvas.graph.edges_at(w).first().copied();
            let better = |b: (VertexIx, DVec2, f64)| off < b.2 || (off == b.2 && first(tip.v) < first(b.0));
            if along >= self.straightness * far && faces && best.is_none_or(better) {
                best = Some((tip.v, p, off));
            }
        }
        best.map(|(v, p, _)| (v, p))
    }

    /// Whether the last edges of the proposal's arms, which may have been moved, keep the rules towards the rest of it.
    fn ends_keep_apart(&self) -> bool {
        let p = &self.proposal;
        let degree = |x: usize| p.edges.iter().filter(|e| e.0 == x || e.1 == x).count();
        for (i, &(a, b)) in p.edges.iter().enumerate() {
            // Ends that meet nothing lie where the patch has them, or nearer.
            let moved = |x: usize| matches!(p.joins[x], Join::At(_) | Join::On(_)) && degree(x) == 1;
            let Some((end, inner)) = [(a, b), (b, a)].into_iter().find(|(x, _)| moved(*x)) else { continue };
            let (e, f) = (p.points[end], p.points[inner]);
            if e.distance(f) < 2.0 {
                return false;
            }
            let crossing = degree(inner) > 2;
            let (low, high) = (e.min(f) - STREET_FLOOR, e.max(f) + STREET_FLOOR);
            for (k, &(c, d)) in p.edges.iter().enumerate() {
                if k == i {
                    continue;
                }
                let (s, t) = (p.points[c], p.points[d]);
                if c == inner || d == inner {
                    let other = if c == inner { t } else { s };
                    let cosine = (e - f).normalize_or_zero().dot((other - f).normalize_or_zero());
                    if cosine > if crossing { 0.74 } else { 0.0 } {
                        return false;
                    }
                    continue;
                }
                if s.max(t).cmplt(low).any() || s.min(t).cmpgt(high).any() {
                    continue;
                }
                if segment_crossing(e, f, s, t).is_some() {
                    return false;
                }
                for (q, r) in [(e, nearest(e, s, t)), (nearest(s, e, f), s), (nearest(t, e, f), t)] {
                    if q.distance(r) < (0.5 * (q.distance(f) + f.distance(r))).min(STREET_FLOOR) {
                        return false;
                    }
                }
            }
        }
        true
    }
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
