//! Laying a patch on the plan, and settling its loose ends on what is there: the snap and clip operations of Teng 2017,
//! section 3.

use super::Work;
use super::canvas::{NONE, nearest};
use super::proposal::{Join, Limits};
use crate::network::VertexIx;
use crate::space::segment_crossing;
use glam::DVec2;

/// Least length that is left of a patch's end street when it is cut back.
const LEAST_END: f64 = 18.0;

/// Distance over which a patch is not held against the coarse grid around the vertex that it is attached to.
const GRID_BLIND: f64 = 34.0;

/// A patch laid on the plan: mirrored if so, scaled and turned about the origin, then moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// Index into the database.
    pub patch: usize,
    /// Vertex of the patch that the current vertex becomes.
    pub start: usize,
    x_axis: DVec2,
    y_axis: DVec2,
    offset: DVec2,
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
        Self { patch, start, x_axis, y_axis, offset: at - x_axis * start_at.x - y_axis * start_at.y }
    }

    /// Where a patch position comes to lie.
    pub fn map(&self, p: DVec2) -> DVec2 {
        self.offset + self.x_axis * p.x + self.y_axis * p.y
    }
}

impl Work<'_> {
    /// Quick and coarse: false when the placement surely comes too near something away from its start and `end`.
    pub(super) fn roughly_fits(&self, placement: &Placement, start: DVec2, end: Option<DVec2>) -> bool {
        let patch = &self.brief.patches.patches[placement.patch];
        let loose = |v: usize| v != placement.start && patch.connectables.iter().any(|c| c.vertex == v);
        let blind = |p: DVec2| {
            p.distance_squared(start) < GRID_BLIND * GRID_BLIND
                || end.is_some_and(|e| p.distance_squared(e) < GRID_BLIND * GRID_BLIND)
        };
        // A little less than the gap: near the vertices it joins the distance along the network decides.
        let need = self.limits.gap.min(self.limits.wall_gap) - 1.0;
        let blocked = |p: DVec2| self.canvas.free.surely_nearer(p, need) && !blind(p);
        for (v, p) in patch.vertices.iter().enumerate() {
            if !loose(v) && blocked(placement.map(*p)) {
                return false;
            }
        }
        for e in patch.edges.iter().filter(|e| !e.main && !loose(e.a) && !loose(e.b)) {
            let (a, b) = (placement.map(patch.vertices[e.a]), placement.map(patch.vertices[e.b]));
            let parts = (a.distance(b) / 12.0).ceil();
            let mut i = 1.0;
            while i < parts {
                if blocked(a.lerp(b, i / parts)) {
                    return false;
                }
                i += 1.0;
            }
        }
        true
    }

    /// Makes the placement the proposal, with its ends settled. `start` says how the start vertex meets what is there;
    /// `end` is the vertex of the patch that falls on a vertex of the graph, when there is one.
    pub(super) fn propose_patch(&mut self, placement: &Placement, start: Join, end: Option<(usize, VertexIx)>) -> bool {
        let patch = self.brief.patches.patches[placement.patch].clone();
        self.proposal.clear();
        // Vertices that only carry main edges are not built; the others keep their order.
        let mut slot = vec![usize::MAX; patch.vertices.len()];
        for e in patch.edges.iter().filter(|e| !e.main) {
            for v in [e.a, e.b] {
                if slot[v] == usize::MAX {
                    slot[v] = self.proposal.points.len();
                    self.proposal.push(placement.map(patch.vertices[v]), Join::Free(false));
                }
            }
            self.proposal.edges.push((slot[e.a], slot[e.b]));
        }
        let Some(&start_slot) = slot.get(placement.start).filter(|s| **s != usize::MAX) else { return false };
        self.proposal.joins[start_slot] = start;
        if let Join::At(v) = start {
            self.proposal.points[start_slot] = self.canvas.graph.at(v);
        }
        if let Some((vertex, target)) = end {
            self.proposal.joins[slot[vertex]] = Join::At(target);
            self.proposal.points[slot[vertex]] = self.canvas.graph.at(target);
        }
        for c in &patch.connectables {
            let point = slot[c.vertex];
            if point == usize::MAX || point == start_slot || end.is_some_and(|(v, _)| v == c.vertex) {
                continue;
            }
            let Some(&(a, b)) = self.proposal.edges.iter().find(|(a, b)| *a == point || *b == point) else { continue };
            let inner = if a == point { b } else { a };
            let (from, to) = (self.proposal.points[inner], self.proposal.points[point]);
            let Some((at, join)) = self.settle(from, to, NONE, &self.limits) else { return false };
            self.proposal.points[point] = crate::space::quantize(at);
            self.proposal.joins[point] = join;
        }
        self.ends_keep_apart(start_slot)
    }

    /// Where a street from `from` towards `to` ends: on a street or vertex that it meets or comes near, cut back from
    /// the border, or at `to`. `None` when nothing is left of it. What ends at the vertex `leaving` is ignored.
    pub(super) fn settle(&self, from: DVec2, to: DVec2, leaving: VertexIx, limits: &Limits) -> Option<(DVec2, Join)> {
        let local = &self.brief.style.local;
        let length = from.distance(to);
        let direction = (to - from) / length.max(1e-9);
        let snap = local.snap_radius;
        let reach = length + snap.max(limits.gap);
        if let Some((i, t, at)) = self.near.ray(from, from + direction * reach, leaving) {
            let s = self.near.segs[i];
            let distance = reach * t;
            if s.is_wall() {
                let sine = ((s.b - s.a).normalize_or_zero().perp_dot(direction)).abs().max(0.2);
                let room = distance - limits.wall_gap.max(s.floor) / sine - 0.1;
                let cut = room.min(length);
                return (cut >= LEAST_END).then(|| (from + direction * cut, Join::Free(true)));
            }
            // Rather a vertex than a new junction next to it.
            let weld = limits.min_piece;
            let vertex = [(s.va, s.a), (s.vb, s.b)]
                .into_iter()
                .filter(|(v, p)| p.distance(at) < weld && self.canvas.nodes[*v as usize].port.is_none())
                .min_by(|x, y| x.1.distance(at).total_cmp(&y.1.distance(at)));
            return Some(match vertex {
                Some((v, p)) => (p, Join::At(v)),
                None => (at, Join::On(s.edge)),
            });
        }
        // Nothing ahead: a loose end or junction beside the end, near enough to bend to.
        let mut best: Option<(VertexIx, DVec2, f64)> = None;
        for s in self.near.segs.iter().filter(|s| !s.is_wall()) {
            for (v, p) in [(s.va, s.a), (s.vb, s.b)] {
                let d = p.distance(to);
                if v != leaving
                    && d < snap
                    && self.canvas.is_dead_end(v)
                    && (p - from).dot(direction) > 0.6 * length
                    && best.is_none_or(|b| d < b.2)
                {
                    best = Some((v, p, d));
                }
            }
        }
        Some(best.map_or((to, Join::Free(true)), |(v, p, _)| (p, Join::At(v))))
    }

    /// Whether the ends of the proposal, which may have been moved, keep the rules towards the rest of it.
    fn ends_keep_apart(&self, start: usize) -> bool {
        let p = &self.proposal;
        for (i, &(a, b)) in p.edges.iter().enumerate() {
            let end = [(a, b), (b, a)]
                .into_iter()
                .find(|(x, _)| *x != start && p.edges.iter().filter(|e| e.0 == *x || e.1 == *x).count() == 1);
            let Some((end, inner)) = end else { continue };
            let (e, f) = (p.points[end], p.points[inner]);
            if e.distance(f) < 8.0 {
                return false;
            }
            for (k, &(c, d)) in p.edges.iter().enumerate() {
                if k == i {
                    continue;
                }
                let (s, t) = (p.points[c], p.points[d]);
                if c == inner || d == inner {
                    let other = if c == inner { t } else { s };
                    if (e - f).normalize_or_zero().dot((other - f).normalize_or_zero()) > 0.74 {
                        return false;
                    }
                    if nearest(e, s, t).distance(e) < 13.0 && p.edges.len() > 2 {
                        return false;
                    }
                    continue;
                }
                if segment_crossing(e, f, s, t).is_some() {
                    return false;
                }
                for (q, r) in [(e, nearest(e, s, t)), (nearest(s, e, f), s), (nearest(t, e, f), t)] {
                    if q.distance(r) < (0.5 * (q.distance(f) + f.distance(r))).min(super::proposal::STREET_FLOOR) {
                        return false;
                    }
                }
            }
        }
        true
    }
}
