//! The choice of patches: breadth-first between two vertices, depth-first from one (Teng 2017, algorithms 2 and 3).

use super::Work;
use super::near::nearest;
use super::place::Placement;
use super::proposal::{Join, Proposal};
use crate::network::VertexIx;
use crate::patch::{Connectable, LEAST_ARM, Patch, STRETCH};
use crate::space::{
    Bounds,
    math::{rotate, turn},
};
use crate::streets::{CellBrief, MadeBy};
use glam::DVec2;

/// Vertices that breadth-first tries to reach, the nearest first.
const TARGETS: usize = 4;

/// Least length of a patch whose arms are led on, as a share of the distance to bridge.
const LEAST_CORE: f64 = 0.3;

/// What a loose end more that a placement meets adds to its rating, as a share.
const MET: f64 = 0.5;

/// Placements that are checked exactly, and valid ones that are rated, for one current vertex.
const CHECKED: usize = 14;

const RATED: usize = 3;

/// Placements of one patch that are checked exactly.
const TRIED: usize = 2;

impl Work<'_> {
    /// Weight of a patch in choices.
    pub(super) fn weight(&self, patch: usize) -> f64 {
        self.weights[patch]
    }

    /// Takes into account that a patch was used once more.
    pub(super) fn count_use(&mut self, patch: usize) {
        self.used[patch] += 1;
        self.weights[patch] = weight(self.brief, patch, self.used[patch]);
    }

    /// Counts the patch that was just built and makes its connectable ends candidates.
    pub(super) fn after_patch(&mut self, patch: usize) {
        self.count_use(patch);
        for (i, v) in self.built.iter().enumerate() {
            if self.proposal.joins[i] == Join::Free(true) {
                self.canvas.nodes[*v as usize].target = 2;
                self.queue.push_back(*v);
            }
        }
        self.cross_over();
    }

    /// Attaches a patch to the vertex `v` at `at`, breadth-first where possible.
    pub(super) fn attach_patch(&mut self, v: VertexIx, at: DVec2, direction: DVec2) -> bool {
        let largest = self.brief.patches.patches.iter().map(|p| p.radius).fold(0.0, f64::max);
        if largest == 0.0 {
            return false;
        }
        let reach = 2.0 * largest * (1.0 + STRETCH) + self.limits.gap;
        self.canvas.gather_tips(Bounds::of([at]), reach, &mut self.near);
        let ahead = self.ray(at, at + direction * 400.0, v).map_or(400.0, |h| h.1 * 400.0);
        if ahead < self.limits.min_piece {
            return false;
        }
        self.breadth_first(v, at) || self.depth_first(v, at, direction)
    }

    /// Whether a connectable vertex of a placed patch falls about where a loose end is or would be led on to.
    fn meets_tip(&self, placement: &Placement, patch: &Patch, c: &Connectable, from: [VertexIx; 2]) -> bool {
        let at = placement.map(patch.vertices[c.vertex]);
        let out = (placement.map(DVec2::ZERO) - placement.map(c.inward)).normalize_or_zero();
        let reach = self.brief.style.local.snap_radius + LEAST_ARM;
        self.near.tips.iter().any(|tip| {
            let to = tip.at - at;
            let along = to.dot(out);
            tip.open
                && along.abs() < reach
                && tip.lead.dot(out) < -0.9
                && out.perp_dot(to).abs() < 3.0 + 0.15 * (along + LEAST_ARM).max(0.0)
                && !from.contains(&tip.v)
        })
    }

    /// Looks for a patch that connects `v` with another loose end in sight.
    fn breadth_first(&mut self, v: VertexIx, at: DVec2) -> bool {
        let Some(onward) = self.canvas.onward(v) else { return false };
        let patches = self.brief.patches;
        let longest = patches.patches.iter().filter_map(|p| p.pairs.last()).map(|p| p.distance);
        let farthest = longest.fold(0.0, f64::max) * (1.0 + STRETCH);
        let mut targets: Vec<(f64, VertexIx)> = Vec::new();
        for tip in self.near.tips.iter().filter(|t| t.open && t.v != v) {
            let d = tip.at.distance(at);
            if d < farthest {
                targets.push((d, tip.v));
            }
        }
        targets.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let in_sight = |(_, w): &(f64, VertexIx)| {
            let p = self.canvas.graph.at(*w);
            self.ray(at, p, v).is_none_or(|(s, _, _)| s.ends_at(*w))
        };
        let targets: Vec<(f64, VertexIx)> = targets.into_iter().filter(in_sight).take(TARGETS).collect();
        let mut found: Vec<(f64, Placement, usize, VertexIx)> = Vec::new();
        for (d, w) in targets {
            let target = self.canvas.graph.at(w);
            let Some(beyond) = self.canvas.onward(w) else { continue };
            let line = (target - at) / d;
            if onward.dot(line) > self.straightness && beyond.dot(-line) > self.straightness {
                self.stretched(v, at, w, target, &mut found);
            }
            let wanted = [Some(turn(line, onward)), Some(turn(line, -beyond))];
            for entry in patches.pair_entries_near(d, STRETCH * d) {
                let weight = self.weight(entry.patch);
                if weight <= 0.0 {
                    continue;
                }
                let varied = self.rng.range(0.7, 1.3);
                // Both ways round, and mirrored each.
                let (there, back) = ([entry.leaves, entry.arrives], [entry.arrives, entry.leaves]);
                let four = [there, there.map(|angle| -angle), back, back.map(|angle| -angle)];
                if !four.iter().any(|is| self.may_bend(*is, wanted)) {
                    continue;
                }
                let p = &patches.patches[entry.patch];
                let pair = p.pairs[entry.pair];
                // Equation 1 of the paper, times what makes the choice vary.
                let rating = (1.0 - (pair.distance - d).abs() / d) * weight * varied;
                let (a, b) = (p.connectables[pair.a], p.connectables[pair.b]);
                for (a, b, is) in [(a, b, there), (b, a, back)] {
                    let (pa, pb) = (p.vertices[a.vertex], p.vertices[b.vertex]);
                    for (mirrored, is) in [(false, is), (true, is.map(|angle| -angle))] {
                        // The street must go on at both ends without a sharp bend.
                        let Some((slopes, bends)) = self.bend(is, wanted) else { continue };
                        let start = (entry.patch, a.vertex, pa);
                        let placement = Placement::new(start, pb - pa, mirrored, at, target - at);
                        let placement = placement.bent(at, target, slopes);
                        if self.roughly_fits(&placement, at, Some(target)) {
                            let others = p.connectables.iter().filter(|c| c.vertex != a.vertex && c.vertex != b.vertex);
                            let met = others.filter(|c| self.meets_tip(&placement, p, c, [v, w])).count() as f64;
                            let kept = if placement.is_bent() { 0.85 } else { 1.0 };
                            let rating = rating * kept * (0.5 + 0.5 * bends) * (1.0 + MET * met);
                            found.push((rating, placement, b.vertex, w));
                        }
                    }
                }
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, placement, end, w) in found.into_iter().take(CHECKED) {
            if self.build_patch(&placement, &[(placement.start, v), (end, w)]) {
                self.after_patch(placement.patch);
                return true;
            }
        }
        false
    }

    /// Collects the placements of patches that run straight between `v` and `w` and are too short for it: their arms are
    /// led on. Such a patch may be moved along the line, and is, to where its other arms face loose ends.
    fn stretched(
        &mut self,
        v: VertexIx,
        at: DVec2,
        w: VertexIx,
        target: DVec2,
        found: &mut Vec<(f64, Placement, usize, VertexIx)>,
    ) {
        let patches = self.brief.patches;
        let d = at.distance(target);
        let line = (target - at) / d;
        let mut tips: Vec<(f64, f64)> = Vec::new();
        for tip in self.near.tips.iter().filter(|t| t.v != v && t.v != w) {
            let place = (line.dot(tip.at - at), line.perp_dot(tip.at - at));
            let faces = line.perp_dot(tip.lead) * place.1 < -0.9 * place.1.abs();
            if place.0 > 0.0 && place.0 < d && faces {
                tips.push(place);
            }
        }
        let shortest = LEAST_CORE * d;
        let longest = (1.0 - STRETCH) * d;
        let entries = patches.pair_entries_near((shortest + longest) / 2.0, (longest - shortest) / 2.0);
        for entry in entries.iter().filter(|e| e.leaves.abs() < 0.12 && e.arrives.abs() < 0.12) {
            let weight = self.weight(entry.patch);
            if weight <= 0.0 {
                continue;
            }
            let p = &patches.patches[entry.patch];
            let pair = p.pairs[entry.pair];
            let (a, b) = (p.connectables[pair.a], p.connectables[pair.b]);
            let spare = d - pair.distance;
            for (a, b) in [(a, b), (b, a)] {
                let (pa, pb) = (p.vertices[a.vertex], p.vertices[b.vertex]);
                for mirrored in [false, true] {
                    let laid = |shift: f64| {
                        Placement::new(
                            (entry.patch, a.vertex, pa),
                            pb - pa,
                            mirrored,
                            at + line * shift,
                            line * pair.distance,
                        )
                    };
                    // Where the other arms meet the tips that they face, else anywhere.
                    let arm = |c: &Connectable| laid(0.0).map(p.vertices[c.vertex]) - at;
                    let others =
                        p.connectables.iter().filter(|c| c.vertex != a.vertex && c.vertex != b.vertex).map(arm);
                    let mut best = (0.0, self.rng.range(0.0, spare));
                    for arm in others.clone() {
                        for tip in &tips {
                            let shift = tip.0 - line.dot(arm);
                            if !(0.0..=spare).contains(&shift) {
                                continue;
                            }
                            let met = others.clone().filter(|o| {
                                let (x, y) = (line.dot(*o) + shift, line.perp_dot(*o));
                                tips.iter().any(|t| (t.0 - x).abs() < 8.0 && t.1 * y > 0.0)
                            });
                            let met = met.count() as f64;
                            if met > best.0 {
                                best = (met, shift);
                            }
                        }
                    }
                    let placement = laid(best.1);
                    if self.roughly_fits(&placement, at, Some(target)) {
                        let rating = (0.7 + 0.3 * best.0) * weight * self.rng.range(0.7, 1.3);
                        found.push((rating, placement, b.vertex, w));
                    }
                }
            }
        }
    }

    /// Looks for a patch that goes on from `v` in the given direction.
    fn depth_first(&mut self, v: VertexIx, at: DVec2, direction: DVec2) -> bool {
        let patches = self.brief.patches;
        let variation = 0.5 * self.brief.style.local.angle_deviation_deg.to_radians();
        let ways = [0.0, -0.5, 0.5, -1.0, 1.0].map(|share| rotate(direction, share * variation));
        // The best last; of two alike the first. As whole numbers they are in order in a quarter of the time.
        let mut order: Vec<u64> = Vec::with_capacity(self.used.len());
        for patch in 0..self.used.len() {
            let weight = self.weight(patch);
            if weight > 0.0 {
                let key = (weight * self.rng.range(0.5, 1.5)) as f32;
                order.push(u64::from(key.to_bits()) << 32 | u64::from(!(patch as u32)));
            }
        }
        order.sort_unstable();
        let mut best: Option<(f64, usize)> = None;
        let mut found = Proposal::default();
        let (mut checked, mut rated) = (0, 0);
        for entry in order.into_iter().rev() {
            let (key, patch) = (f64::from(f32::from_bits((entry >> 32) as u32)), !(entry as u32) as usize);
            let p = &patches.patches[patch];
            let views = &patches.facts(patch).views;
            let n = 2 * p.connectables.len();
            let first = self.rng.index(n * ways.len());
            let mut tried = 0;
            // Ends, each as drawn and mirrored, and directions in turn.
            let (mut slot, mut turn) = (first % n, first % ways.len());
            for _ in 0..n {
                let (end, mirrored, way) = (slot / 2, slot % 2 == 1, ways[turn]);
                (slot, turn) = (slot + 1, turn + 1);
                slot = if slot == n { 0 } else { slot };
                turn = if turn == ways.len() { 0 } else { turn };
                if !self.view_roughly_fits(&views[end], at, way, mirrored) {
                    continue;
                }
                let c = &p.connectables[end];
                let start = (patch, c.vertex, p.vertices[c.vertex]);
                let placement = Placement::new(start, c.inward, mirrored, at, way);
                (checked, tried) = (checked + 1, tried + 1);
                if let Some(rating) = self.rate_patch(&placement, &[(c.vertex, v)]) {
                    rated += 1;
                    if best.is_none_or(|b| rating * key > b.0) {
                        best = Some((rating * key, patch));
                        std::mem::swap(&mut found, &mut self.proposal);
                    }
                    break;
                }
                if checked == CHECKED || tried == TRIED {
                    break;
                }
            }
            if checked == CHECKED || rated == RATED {
                break;
            }
        }
        let Some((_, patch)) = best else { return false };
        self.proposal = found;
        self.canvas.build(&self.proposal, MadeBy::Patch(patch as u32), &mut self.built);
        self.after_patch(patch);
        true
    }

    /// What is nearer than this to a street of a patch counts in its rating, in metres.
    pub(super) fn nearby(&self) -> f64 {
        1.5 * self.brief.style.local.snap_radius.max(self.limits.gap)
    }

    /// Rating of the proposal by the three heuristics of Teng 2017, section 3.3, and for the streets that it connects.
    pub(super) fn rate(&self) -> f64 {
        let nearby = self.nearby();
        let p = &self.proposal;
        let mut rating: f64 = 1.0;
        for (i, at) in p.points.iter().enumerate() {
            let ends = || p.edges.iter().filter(|(a, b)| *a == i || *b == i).count() == 1;
            match p.joins[i] {
                Join::Free(true) => {
                    // A connectable vertex that faces the end of a cul-de-sac leads nowhere.
                    let blocked = self.near.tips.iter().any(|t| !t.open && t.at.distance(*at) < nearby);
                    rating -= if blocked { 0.2 } else { 0.0 };
                }
                Join::Free(false) if ends() => {
                    // A cul-de-sac fills a small place, and hinders in a wide one.
                    let fills = self.near.segs.iter().any(|s| nearest(*at, s.a, s.b).distance(*at) < nearby);
                    rating += if fills { 0.1 } else { -0.2 };
                }
                Join::At(_) => rating += 0.3,
                Join::On(_) => rating += 0.1,
                Join::Free(false) => {}
            }
        }
        for (a, b) in &p.edges {
            let (a, b) = (p.points[*a], p.points[*b]);
            let hinders =
                self.near.tips.iter().any(|t| {
                    t.open && nearest(t.at, a, b).distance(t.at) < nearby && !p.joins.contains(&Join::At(t.v))
                });
            rating -= if hinders { 0.2 } else { 0.0 };
        }
        rating.max(0.05)
    }
}

/// Weight of a patch in choices after `count` uses: less with every use, 0 once it was used as often as it may be or if it
/// breaks the rules inside itself.
pub(super) fn weight(brief: &CellBrief<'_>, patch: usize, count: u32) -> f64 {
    let most = brief.patches.patches[patch].at_most;
    if most.is_some_and(|most| count >= most) || !brief.patches.facts(patch).shape.sound {
        0.0
    } else {
        brief.weights[patch] / (1.0 + 0.5 * f64::from(count))
    }
}
