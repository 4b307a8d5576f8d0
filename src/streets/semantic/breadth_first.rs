//! Breadth-first: a patch between the end of a street and another loose end in sight (Teng 2017, algorithm 2).

use super::coarse::roughly_fits;
use super::panorama::Panorama;
use super::placement::Placement;
use super::placer::Placer;
use crate::network::VertexIx;
use crate::patch::{Connectable, LEAST_ARM, Passage, Patch, STRETCH};
use crate::space::math::turn;
use crate::streets::cell::Draft;
use glam::DVec2;

/// Number of loose ends that are tried, the nearest first.
const TARGETS: usize = 4;

/// Least length of a patch whose arms are extended, as a share of the distance to bridge.
const LEAST_CORE: f64 = 0.3;

/// Greatest angle between a patch whose arms are extended and the line that it lies on, in radians.
const STRAIGHT: f64 = 0.12;

/// Number of passages that are rated, of all that suit the distance and the headings.
const LOOKED_AT: usize = 8;

/// Share of the patches with extended arms that are rated; there are far more of them than places.
const SAMPLED: f64 = 0.2;

/// Share by which every further loose end that a placement meets raises its rating.
const MET: f64 = 0.5;

/// Number of placements that are checked exactly.
const CHECKED: usize = 14;

/// A placement of a patch between two vertices.
struct Bridge {
    rating: f64,
    placement: Placement,
    /// The vertex of the patch at the far end, and the vertex of the graph that it falls on.
    end: (usize, VertexIx),
}

/// Looks for patches between two vertices; keeps its buffers from one search to the next.
#[derive(Default)]
pub struct BreadthFirst {
    /// Placements to choose from.
    bridges: Vec<Bridge>,
    /// Loose ends that may be reached, with their distances in metres.
    targets: Vec<(f64, VertexIx)>,
}

impl BreadthFirst {
    /// Builds a patch that connects `v` with another loose end in sight; returns whether there is one.
    pub fn attach(
        &mut self,
        draft: &mut Draft<'_>,
        placer: &mut Placer<'_>,
        v: VertexIx,
        at: DVec2,
        around: &Panorama,
    ) -> bool {
        let Some(onward) = draft.canvas.onward(v) else { return false };
        let mut targets = std::mem::take(&mut self.targets);
        targets.clear();
        for tip in draft.trial.near.loose_ends.iter().filter(|t| t.open && t.v != v) {
            let d = tip.at.distance(at);
            if d < placer.farthest && around.may_see(tip.at - at, d) {
                targets.push((d, tip.v));
            }
        }
        targets.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut found = std::mem::take(&mut self.bridges);
        found.clear();
        let mut bridged = 0;
        for &(_, w) in &targets {
            bridged += usize::from(find_bridges(draft, placer, v, at, onward, w, &mut found));
            if bridged == TARGETS {
                break;
            }
        }
        let mut built = false;
        for _ in 0..CHECKED {
            let best = (0..found.len()).reduce(|a, b| if found[b].rating > found[a].rating { b } else { a });
            let Some(Bridge { placement, end, .. }) = best.map(|best| found.swap_remove(best)) else { break };
            built = placer.build_patch(draft, &placement, &[(placement.start, v), end]);
            if built {
                placer.after_patch(draft, placement.patch);
                break;
            }
        }
        (self.targets, self.bridges) = (targets, found);
        built
    }
}

/// Collects placements of patches between `v`, whose street leads `onward`, and the loose end `w`. False if no patch has
/// suitable headings or `w` is not in sight.
fn find_bridges(
    draft: &mut Draft<'_>,
    placer: &Placer<'_>,
    v: VertexIx,
    at: DVec2,
    onward: DVec2,
    w: VertexIx,
    found: &mut Vec<Bridge>,
) -> bool {
    let patches = placer.patches;
    let target = draft.canvas.graph.at(w);
    let Some(beyond) = draft.canvas.onward(w) else { return false };
    let d = at.distance(target);
    let line = (target - at) / d;
    let in_line = onward.dot(line) > draft.rules.straightness && beyond.dot(-line) > draft.rules.straightness;
    let wanted = [turn(line, onward), turn(line, -beyond)];
    let passages = patches.passages_near(d, STRETCH * d, wanted, placer.bending.reach());
    let mut all: Vec<&Passage> = Vec::with_capacity(4 * LOOKED_AT);
    all.extend(passages);
    if !in_line && all.is_empty() || draft.landing().ray(at, target, v).is_some_and(|(s, _, _)| !s.ends_at(w)) {
        return false;
    }
    if in_line {
        stretched(draft, placer, v, at, w, target, found);
    }
    // Some are enough to choose from.
    let step = all.len().div_ceil(LOOKED_AT).max(1);
    for passage in all.into_iter().skip(draft.rng.index(step)).step_by(step) {
        let weight = placer.weight(passage.patch);
        // The street must go on at both ends without a sharp bend.
        let bending = placer.bending.of(&patches.facts(passage.patch).shape);
        let bend = bending.bend([passage.leaves, passage.arrives], wanted.map(Some));
        let Some((slopes, bends)) = bend.filter(|_| weight > 0.0) else { continue };
        let p = &patches.patches[passage.patch];
        let (a, b) = (p.connectables[passage.from].vertex, p.connectables[passage.to].vertex);
        let (pa, pb) = (p.vertices[a], p.vertices[b]);
        let placement = Placement::new((passage.patch, a, pa), pb - pa, passage.mirrored, at, target - at);
        let placement = placement.bent(at, target, slopes);
        if roughly_fits(draft, placer.patches, &placement, at, Some(target)) {
            let others = p.connectables.iter().filter(|c| c.vertex != a && c.vertex != b);
            let met = others.filter(|c| meets_loose_end(draft, &placement, p, c, [v, w])).count() as f64;
            // Equation 1 of the paper, times what makes the choice vary.
            let rating = (1.0 - (passage.distance - d).abs() / d) * weight * draft.rng.range(0.7, 1.3);
            let kept = if placement.is_bent() { 0.85 } else { 1.0 };
            let rating = rating * kept * (0.5 + 0.5 * bends) * (1.0 + MET * met);
            found.push(Bridge { rating, placement, end: (b, w) });
        }
    }
    true
}

/// Collects placements of straight patches that are too short for the distance between `v` and `w`, so that their arms are
/// extended. Such a patch is shifted along the line to where its other arms face loose ends.
fn stretched(
    draft: &mut Draft<'_>,
    placer: &Placer<'_>,
    v: VertexIx,
    at: DVec2,
    w: VertexIx,
    target: DVec2,
    found: &mut Vec<Bridge>,
) {
    let patches = placer.patches;
    let d = at.distance(target);
    let line = (target - at) / d;
    let mut loose_ends: Vec<(f64, f64)> = Vec::new();
    for tip in draft.trial.near.loose_ends.iter().filter(|t| t.v != v && t.v != w) {
        let place = (line.dot(tip.at - at), line.perp_dot(tip.at - at));
        let faces = line.perp_dot(tip.onward) * place.1 < -0.9 * place.1.abs();
        if place.0 > 0.0 && place.0 < d && faces {
            loose_ends.push(place);
        }
    }
    let mut arms: Vec<(f64, f64)> = Vec::new();
    let shortest = LEAST_CORE * d;
    let longest = (1.0 - STRETCH) * d;
    for passage in patches.passages_near((shortest + longest) / 2.0, (longest - shortest) / 2.0, [0.0; 2], STRAIGHT) {
        let weight = placer.weight(passage.patch);
        if weight <= 0.0 || !draft.rng.chance(SAMPLED) {
            continue;
        }
        let p = &patches.patches[passage.patch];
        let spare = d - passage.distance;
        let (a, b) = (p.connectables[passage.from].vertex, p.connectables[passage.to].vertex);
        let (pa, pb) = (p.vertices[a], p.vertices[b]);
        // Where the other arms meet the loose_ends that they face, else anywhere.
        let (along, side) = ((pb - pa) / passage.distance, if passage.mirrored { -1.0 } else { 1.0 });
        let others =
            p.connectables.iter().filter(|c| c.vertex != a && c.vertex != b).map(|c| p.vertices[c.vertex] - pa);
        arms.clear();
        arms.extend(others.map(|arm| (along.dot(arm), side * along.perp_dot(arm))));
        let mut best = (0, draft.rng.range(0.0, spare));
        for (arm, tip) in arms.iter().flat_map(|arm| loose_ends.iter().map(move |tip| (arm, tip))) {
            let shift = tip.0 - arm.0;
            if !(0.0..=spare).contains(&shift) || tip.1 * arm.1 <= 0.0 {
                continue;
            }
            let meets =
                |arm: &&(f64, f64)| loose_ends.iter().any(|t| (t.0 - arm.0 - shift).abs() < 8.0 && t.1 * arm.1 > 0.0);
            let met = arms.iter().filter(meets).count();
            if met > best.0 {
                best = (met, shift);
            }
        }
        let (start, to) = ((passage.patch, a, pa), line * passage.distance);
        let placement = Placement::new(start, pb - pa, passage.mirrored, at + line * best.1, to);
        if roughly_fits(draft, placer.patches, &placement, at, Some(target)) {
            let rating = (0.7 + 0.3 * best.0 as f64) * weight * draft.rng.range(0.7, 1.3);
            found.push(Bridge { rating, placement, end: (b, w) });
        }
    }
}

/// Whether a connectable vertex of a placed patch falls near a loose end, or near where that end would be extended to.
fn meets_loose_end(
    draft: &Draft<'_>,
    placement: &Placement,
    patch: &Patch,
    c: &Connectable,
    from: [VertexIx; 2],
) -> bool {
    let at = placement.map(patch.vertices[c.vertex]);
    let out = (placement.map(DVec2::ZERO) - placement.map(c.inward)).normalize_or_zero();
    let reach = draft.rules.local.snap_radius + LEAST_ARM;
    draft.trial.near.loose_ends.iter().any(|tip| {
        let to = tip.at - at;
        let along = to.dot(out);
        tip.open
            && along.abs() < reach
            && tip.onward.dot(out) < -0.9
            && out.perp_dot(to).abs() < 3.0 + 0.15 * (along + LEAST_ARM).max(0.0)
            && !from.contains(&tip.v)
    })
}
