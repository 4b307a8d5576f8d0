//! Depth-first: a patch that goes on from the end of a street (Teng 2017, algorithm 3), chosen by its rating.

use super::coarse::{Overlay, view_roughly_fits};
use super::panorama::Panorama;
use super::placement::Placement;
use super::placer::{Placer, build_narrowed};
use crate::network::VertexIx;
use crate::patch::PatchView;
use crate::space::{Bounds, math::rotate};
use crate::streets::cell::{Draft, Join, LooseEnd, Proposal, nearest};
use glam::DVec2;

/// Greatest number of placements whose ends are settled, for one vertex.
const PROPOSED: usize = 10;

/// Greatest number of these placements that are rated.
const RATED: usize = 4;

/// Greatest number of placements of one patch.
const TRIED: usize = 2;

/// A proposal of a patch, with its rating.
#[derive(Default)]
struct RatedProposal {
    rating: f64,
    patch: usize,
    proposal: Proposal,
}

/// Looks for patches that go on from a vertex; keeps its buffers from one search to the next.
#[derive(Default)]
pub struct DepthFirst {
    /// Proposals to choose from.
    ranked: Vec<RatedProposal>,
    /// Patches to propose, each with a key that grows with its weight.
    order: Vec<u64>,
}

impl DepthFirst {
    /// Builds a patch that goes on from `v` in the given direction; returns whether one fits.
    pub fn attach(
        &mut self,
        draft: &mut Draft<'_>,
        placer: &mut Placer<'_>,
        (v, at, direction): (VertexIx, DVec2, DVec2),
        around: &Panorama,
    ) -> bool {
        let patches = placer.patches;
        let variation = 0.5 * draft.rules.local.angle_deviation_deg.to_radians();
        let ways = [0.0, -0.5, 0.5, -1.0, 1.0].map(|share| rotate(direction, share * variation));
        // The best last; of two alike the first. As whole numbers they are in order in a quarter of the time.
        let mut order = std::mem::take(&mut self.order);
        order.clear();
        for patch in 0..patches.patches.len() {
            let weight = placer.weight(patch);
            let facts = patches.facts(patch);
            let holds = |view: &PatchView| around.may_hold(&view.reach, false) || around.may_hold(&view.reach, true);
            if weight > 0.0 && around.may_hold(&facts.least_reach, false) && facts.views.iter().any(holds) {
                let key = (weight * draft.rng.range(0.5, 1.5)) as f32;
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
            let first = draft.rng.index(n * ways.len());
            // Ends, each as drawn and mirrored, and directions in turn.
            let mut of_patch = 0;
            for k in first..first + n {
                let (end, mirrored, way) = (k % n / 2, k % 2 == 1, ways[k % ways.len()]);
                let view = &views[end];
                if !around.may_hold(&view.reach, mirrored)
                    || !view_roughly_fits(draft, view, Overlay::new(draft, at, way, mirrored))
                {
                    continue;
                }
                let c = &p.connectables[end];
                let start = (patch, c.vertex, p.vertices[c.vertex]);
                let placement = Placement::new(start, c.inward, mirrored, at, way);
                (tried, of_patch) = (tried + 1, of_patch + 1);
                let fits = placer.propose_patch(draft, &placement, &[(c.vertex, v)]);
                if fits {
                    if count == ranked.len() {
                        ranked.push(RatedProposal::default());
                    }
                    let slot = &mut ranked[count];
                    (slot.patch, slot.rating) = (patch, key * rating(draft));
                    std::mem::swap(&mut slot.proposal, &mut draft.trial.proposal);
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
            std::mem::swap(&mut r.proposal, &mut draft.trial.proposal);
            build_narrowed(draft, r.patch).then_some(r.patch)
        });
        self.ranked = ranked;
        if let Some(patch) = built {
            placer.after_patch(draft, patch);
        }
        built.is_some()
    }
}

/// Rates the proposal by the three heuristics of Teng 2017, section 3.3, and by the streets that it connects.
fn rating(draft: &Draft<'_>) -> f64 {
    // What is nearer than this to a street of a patch counts.
    let nearby = 1.5 * draft.rules.local.snap_radius.max(draft.rules.growth.gap);
    let p = &draft.trial.proposal;
    let bounds = Bounds::of(p.points.iter().copied()).grown(nearby);
    let loose_ends: Vec<&LooseEnd> = draft.trial.near.loose_ends.iter().filter(|t| bounds.contains(t.at)).collect();
    let mut rating: f64 = 1.0;
    for (i, at) in p.points.iter().enumerate() {
        let mut edges = p.edges.iter().filter(|(a, b)| *a == i || *b == i);
        match p.joins[i] {
            Join::Free(true) => {
                // A connectable vertex that faces the end of a cul-de-sac leads nowhere.
                let blocked = loose_ends.iter().any(|t| !t.open && t.at.distance(*at) < nearby);
                rating -= if blocked { 0.2 } else { 0.0 };
            }
            Join::Free(false) => {
                let (Some((a, b)), None) = (edges.next(), edges.next()) else { continue };
                // A cul-de-sac fills a small place, and hinders in a wide one.
                let onward = (*at - p.points[if *a == i { *b } else { *a }]).normalize_or_zero();
                let rays = [onward, onward.perp(), -onward.perp()].map(|way| (*at, way));
                let fills = draft.canvas.free.ahead(rays, nearby).iter().any(|far| *far < nearby);
                rating += if fills { 0.1 } else { -0.2 };
            }
            Join::At(_) => rating += 0.3,
            Join::On(_) => rating += 0.1,
        }
    }
    for (a, b) in &p.edges {
        let (a, b) = (p.points[*a], p.points[*b]);
        let hinders = loose_ends
            .iter()
            .any(|t| t.open && nearest(t.at, a, b).distance(t.at) < nearby && !p.joins.contains(&Join::At(t.v)));
        rating -= if hinders { 0.2 } else { 0.0 };
    }
    rating.max(0.05)
}
