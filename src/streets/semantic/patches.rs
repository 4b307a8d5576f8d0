//! The choice of patches: breadth-first between two vertices, depth-first from one (Teng 2017, algorithms 2 and 3).

use super::Work;
use super::coarse::Surroundings;
use super::near::{Tip, nearest};
use super::place::Placement;
use super::proposal::{Join, Proposal};
use crate::network::VertexIx;
use crate::patch::{Connectable, LEAST_ARM, Passage, Patch, PatchView, STRETCH};
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

/// Greatest angle between a patch whose arms are led on and the line that it lies on, in radians.
const STRAIGHT: f64 = 0.12;

/// Passages between two vertices that are looked at, of all that suit the distance and the headings.
const LOOKED_AT: usize = 8;

/// Share of the patches whose arms are led on that are looked at; there are far more of them than places.
const SAMPLED: f64 = 0.2;

/// What a loose end more that a placement meets adds to its rating, as a share.
const MET: f64 = 0.5;

/// Placements between two vertices that are checked exactly.
const CHECKED: usize = 14;

/// Placements of which it is found where their ends come to lie, and of these the ones that are rated, for one current
/// vertex.
const PROPOSED: usize = 10;

const RATED: usize = 4;

/// Placements of one patch that are tried.
const TRIED: usize = 2;

/// A proposal of a patch with its rating.
#[derive(Default)]
pub(super) struct Ranked {
    rating: f64,
    patch: usize,
    proposal: Proposal,
}

/// A patch between two vertices.
pub(super) struct Bridge {
    rating: f64,
    placement: Placement,
    /// Vertex of the patch at its far end, and that of the graph there.
    end: (usize, VertexIx),
}

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
        if self.largest == 0.0 {
            return false;
        }
        let reach = 2.0 * self.largest * (1.0 + STRETCH) + self.limits.gap;
        let around = self.surroundings(at, direction, reach);
        if around.ahead() < self.limits.min_piece {
            return false;
        }
        self.canvas.gather_tips(Bounds::of([at]), reach, &mut self.near);
        self.breadth_first(v, at, &around) || self.depth_first(v, at, direction, &around)
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
    fn breadth_first(&mut self, v: VertexIx, at: DVec2, around: &Surroundings) -> bool {
        let Some(onward) = self.canvas.onward(v) else { return false };
        let mut targets = std::mem::take(&mut self.targets);
        targets.clear();
        for tip in self.near.tips.iter().filter(|t| t.open && t.v != v) {
            let d = tip.at.distance(at);
            if d < self.farthest && around.may_see(tip.at - at, d) {
                targets.push((d, tip.v));
            }
        }
        targets.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut found = std::mem::take(&mut self.bridges);
        found.clear();
        let mut bridged = 0;
        for &(_, w) in &targets {
            bridged += usize::from(self.find_bridges(v, at, onward, w, &mut found));
            if bridged == TARGETS {
                break;
            }
        }
        let mut built = false;
        for _ in 0..CHECKED {
            let best = (0..found.len()).reduce(|a, b| if found[b].rating > found[a].rating { b } else { a });
            let Some(Bridge { placement, end, .. }) = best.map(|best| found.swap_remove(best)) else { break };
            built = self.build_patch(&placement, &[(placement.start, v), end]);
            if built {
                self.after_patch(placement.patch);
                break;
            }
        }
        (self.targets, self.bridges) = (targets, found);
        built
    }

    /// Collects the placements of patches between `v`, from where its street leads `onward`, and the loose end `w`; false
    /// where no patch has the headings for that, or `w` is not in sight.
    fn find_bridges(&mut self, v: VertexIx, at: DVec2, onward: DVec2, w: VertexIx, found: &mut Vec<Bridge>) -> bool {
        let patches = self.brief.patches;
        let target = self.canvas.graph.at(w);
        let Some(beyond) = self.canvas.onward(w) else { return false };
        let d = at.distance(target);
        let line = (target - at) / d;
        let in_line = onward.dot(line) > self.straightness && beyond.dot(-line) > self.straightness;
        let wanted = [turn(line, onward), turn(line, -beyond)];
        let passages = patches.passages_near(d, STRETCH * d, wanted, self.bending + self.most_turn);
        let mut all: Vec<&Passage> = Vec::with_capacity(4 * LOOKED_AT);
        all.extend(passages);
        if !in_line && all.is_empty() || self.ray(at, target, v).is_some_and(|(s, _, _)| !s.ends_at(w)) {
            return false;
        }
        if in_line {
            self.stretched(v, at, w, target, found);
        }
        // Some are enough to choose from.
        let step = all.len().div_ceil(LOOKED_AT).max(1);
        for passage in all.into_iter().skip(self.rng.index(step)).step_by(step) {
            let weight = self.weight(passage.patch);
            // The street must go on at both ends without a sharp bend.
            let bend = self.bend([passage.leaves, passage.arrives], wanted.map(Some));
            let Some((slopes, bends)) = bend.filter(|_| weight > 0.0) else { continue };
            let p = &patches.patches[passage.patch];
            let (a, b) = (p.connectables[passage.from].vertex, p.connectables[passage.to].vertex);
            let (pa, pb) = (p.vertices[a], p.vertices[b]);
            let placement = Placement::new((passage.patch, a, pa), pb - pa, passage.mirrored, at, target - at);
            let placement = placement.bent(at, target, slopes);
            if self.roughly_fits(&placement, at, Some(target)) {
                let others = p.connectables.iter().filter(|c| c.vertex != a && c.vertex != b);
                let met = others.filter(|c| self.meets_tip(&placement, p, c, [v, w])).count() as f64;
                // Equation 1 of the paper, times what makes the choice vary.
                let rating = (1.0 - (passage.distance - d).abs() / d) * weight * self.rng.range(0.7, 1.3);
                let kept = if placement.is_bent() { 0.85 } else { 1.0 };
                let rating = rating * kept * (0.5 + 0.5 * bends) * (1.0 + MET * met);
                found.push(Bridge { rating, placement, end: (b, w) });
            }
        }
        true
    }

    /// Collects the placements of patches that run straight between `v` and `w` and are too short for it: their arms are
    /// led on. Such a patch may be moved along the line, and is, to where its other arms face loose ends.
    fn stretched(&mut self, v: VertexIx, at: DVec2, w: VertexIx, target: DVec2, found: &mut Vec<Bridge>) {
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
        let mut arms: Vec<(f64, f64)> = Vec::new();
        let shortest = LEAST_CORE * d;
        let longest = (1.0 - STRETCH) * d;
        for passage in patches.passages_near((shortest + longest) / 2.0, (longest - shortest) / 2.0, [0.0; 2], STRAIGHT)
        {
            let weight = self.weight(passage.patch);
            if weight <= 0.0 || !self.rng.chance(SAMPLED) {
                continue;
            }
            let p = &patches.patches[passage.patch];
            let spare = d - passage.distance;
            let (a, b) = (p.connectables[passage.from].vertex, p.connectables[passage.to].vertex);
            let (pa, pb) = (p.vertices[a], p.vertices[b]);
            // Where the other arms meet the tips that they face, else anywhere.
            let (along, side) = ((pb - pa) / passage.distance, if passage.mirrored { -1.0 } else { 1.0 });
            let others =
                p.connectables.iter().filter(|c| c.vertex != a && c.vertex != b).map(|c| p.vertices[c.vertex] - pa);
            arms.clear();
            arms.extend(others.map(|arm| (along.dot(arm), side * along.perp_dot(arm))));
            let mut best = (0, self.rng.range(0.0, spare));
            for (arm, tip) in arms.iter().flat_map(|arm| tips.iter().map(move |tip| (arm, tip))) {
                let shift = tip.0 - arm.0;
                if !(0.0..=spare).contains(&shift) || tip.1 * arm.1 <= 0.0 {
                    continue;
                }
                let meets =
                    |arm: &&(f64, f64)| tips.iter().any(|t| (t.0 - arm.0 - shift).abs() < 8.0 && t.1 * arm.1 > 0.0);
                let met = arms.iter().filter(meets).count();
                if met > best.0 {
                    best = (met, shift);
                }
            }
            let (start, to) = ((passage.patch, a, pa), line * passage.distance);
            let placement = Placement::new(start, pb - pa, passage.mirrored, at + line * best.1, to);
            if self.roughly_fits(&placement, at, Some(target)) {
                let rating = (0.7 + 0.3 * best.0 as f64) * weight * self.rng.range(0.7, 1.3);
                found.push(Bridge { rating, placement, end: (b, w) });
            }
        }
    }

    /// Looks for a patch that goes on from `v` in the given direction.
    fn depth_first(&mut self, v: VertexIx, at: DVec2, direction: DVec2, around: &Surroundings) -> bool {
        let patches = self.brief.patches;
        let variation = 0.5 * self.brief.style.local.angle_deviation_deg.to_radians();
        let ways = [0.0, -0.5, 0.5, -1.0, 1.0].map(|share| rotate(direction, share * variation));
        // The best last; of two alike the first. As whole numbers they are in order in a quarter of the time.
        let mut order = std::mem::take(&mut self.order);
        order.clear();
        for patch in 0..self.used.len() {
            let weight = self.weight(patch);
            let facts = patches.facts(patch);
            let holds = |view: &PatchView| around.may_hold(&view.reach, false) || around.may_hold(&view.reach, true);
            if weight > 0.0 && around.may_hold(&facts.least_reach, false) && facts.views.iter().any(holds) {
                let key = (weight * self.rng.range(0.5, 1.5)) as f32;
                order.push(u64::from(key.to_bits()) << 32 | u64::from(!(patch as u32)));
            }
        }
        order.sort_unstable();
        let mut ranked = std::mem::take(&mut self.ranked);
        let (mut tried, mut count) = (0, 0);
        'patches: for entry in order.iter().copied().rev() {
            let (key, patch) = (f64::from(f32::from_bits((entry >> 32) as u32)), !(entry as u32) as usize);
            let p = &patches.patches[patch];
            let views = &patches.facts(patch).views;
            let n = 2 * p.connectables.len();
            let first = self.rng.index(n * ways.len());
            // Ends, each as drawn and mirrored, and directions in turn.
            let mut of_patch = 0;
            for k in first..first + n {
                let (end, mirrored, way) = (k % n / 2, k % 2 == 1, ways[k % ways.len()]);
                let view = &views[end];
                if !around.may_hold(&view.reach, mirrored)
                    || !self.view_roughly_fits(view, self.overlay(at, way, mirrored))
                {
                    continue;
                }
                let c = &p.connectables[end];
                let start = (patch, c.vertex, p.vertices[c.vertex]);
                let placement = Placement::new(start, c.inward, mirrored, at, way);
                (tried, of_patch) = (tried + 1, of_patch + 1);
                let fits = self.propose_patch(&placement, &[(c.vertex, v)]);
                if fits {
                    if count == ranked.len() {
                        ranked.push(Ranked::default());
                    }
                    let slot = &mut ranked[count];
                    (slot.patch, slot.rating) = (patch, key * self.rate());
                    std::mem::swap(&mut slot.proposal, &mut self.proposal);
                    count += 1;
                }
                if tried == PROPOSED || count == RATED {
                    break 'patches;
                }
                if fits || of_patch == TRIED {
                    break;
                }
            }
        }
        self.order = order;
        ranked[..count].sort_by(|a, b| b.rating.total_cmp(&a.rating));
        let built = ranked[..count].iter_mut().find_map(|r| {
            std::mem::swap(&mut r.proposal, &mut self.proposal);
            self.build_focused(MadeBy::Patch(r.patch as u32)).then_some(r.patch)
        });
        self.ranked = ranked;
        if let Some(patch) = built {
            self.after_patch(patch);
        }
        built.is_some()
    }

    /// What is nearer than this to a street of a patch counts in its rating, in metres.
    pub(super) fn nearby(&self) -> f64 {
        1.5 * self.brief.style.local.snap_radius.max(self.limits.gap)
    }

    /// Rating of the proposal by the three heuristics of Teng 2017, section 3.3, and for the streets that it connects.
    pub(super) fn rate(&self) -> f64 {
        let nearby = self.nearby();
        let p = &self.proposal;
        let bounds = Bounds::of(p.points.iter().copied()).grown(nearby);
        let tips: Vec<&Tip> = self.near.tips.iter().filter(|t| bounds.contains(t.at)).collect();
        let mut rating: f64 = 1.0;
        for (i, at) in p.points.iter().enumerate() {
            let mut edges = p.edges.iter().filter(|(a, b)| *a == i || *b == i);
            match p.joins[i] {
                Join::Free(true) => {
                    // A connectable vertex that faces the end of a cul-de-sac leads nowhere.
                    let blocked = tips.iter().any(|t| !t.open && t.at.distance(*at) < nearby);
                    rating -= if blocked { 0.2 } else { 0.0 };
                }
                Join::Free(false) => {
                    let (Some((a, b)), None) = (edges.next(), edges.next()) else { continue };
                    // A cul-de-sac fills a small place, and hinders in a wide one.
                    let onward = (*at - p.points[if *a == i { *b } else { *a }]).normalize_or_zero();
                    let rays = [onward, onward.perp(), -onward.perp()].map(|way| (*at, way));
                    let fills = self.canvas.free.ahead(rays, nearby).iter().any(|far| *far < nearby);
                    rating += if fills { 0.1 } else { -0.2 };
                }
                Join::At(_) => rating += 0.3,
                Join::On(_) => rating += 0.1,
            }
        }
        for (a, b) in &p.edges {
            let (a, b) = (p.points[*a], p.points[*b]);
            let hinders = tips
                .iter()
                .any(|t| t.open && nearest(t.at, a, b).distance(t.at) < nearby && !p.joins.contains(&Join::At(t.v)));
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
