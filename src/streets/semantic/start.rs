//! Cell initialization (Teng 2017, section 3.2): patterns along main streets, and an initial patch in the
//! place of some of the stubs.

use super::at_ports::{PortOrder, across_ports, lay_at_ports};
use super::coarse::roughly_fits;
use super::pattern::{Row, start_with_patterns};
use super::placement::Placement;
use super::placer::{Placer, build};
use crate::network::VertexIx;
use crate::patch::{PatchDatabase, tag};
use crate::streets::cell::{Draft, RemovedStubs, has_stub, stub_end};
use crate::style::StartRules;
use glam::DVec2;
use std::ops::RangeInclusive;

/// How much an initial patch may be drawn out along its main street.
pub const STRETCHED: RangeInclusive<f64> = 0.8..=1.25;

/// Lays patterns, and initial patches in place of some stubs. Their ends and those of the other stubs become the first
/// candidate vertices.
pub fn start(draft: &mut Draft<'_>, placer: &mut Placer<'_>, rules: &StartRules) {
    let order = PortOrder::of(draft.brief);
    let row = start_with_patterns(draft, placer, rules, &order);
    let ports = draft.brief.ports.len();
    let patches = placer.patches;
    let initial: Vec<usize> =
        patches.tagged(tag::INITIAL).iter().copied().filter(|p| patches.facts(*p).main.is_some()).collect();
    let mut must_begin: Vec<usize> =
        row.filter(|row| row.is_closed).map_or(Vec::new(), |row| opposite(draft, &order, &row));
    for i in 0..ports {
        // The stub is there, unless a patch took its place.
        if !has_stub(&draft.canvas, ports, i) {
            continue;
        }
        let chosen = !initial.is_empty() && (must_begin.contains(&i) || draft.rng.chance(rules.initial_patches));
        if chosen && start_with_patch(draft, placer, &order, i, &initial) {
            must_begin.clear();
        } else {
            draft.candidates.push_back(stub_end(ports, i));
        }
    }
    draft.canvas.stamp_stubs(draft.brief.ports);
}

/// The ports along the main street that lies farthest from a row: from a closed pattern the network cannot go on, and so it begins
/// there (Teng 2017, Fig. 5.3).
fn opposite(draft: &Draft<'_>, order: &PortOrder, row: &Row) -> Vec<usize> {
    let middle = |ports: &[usize]| ports.iter().map(|i| draft.brief.ports[*i].at).sum::<DVec2>() / ports.len() as f64;
    let from = middle(&row.ports);
    let far = |run: &Vec<usize>| middle(run).distance(from);
    order.runs(draft).into_iter().max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or_default()
}

/// The vertex at which an initial patch leaves its main street, and the direction into the patch; `None` if the patch has no
/// main street or leaves it more than once.
fn initial_root(patches: &PatchDatabase, patch: usize) -> Option<(usize, DVec2)> {
    let main = patches.facts(patch).main.as_ref()?;
    let patch = &patches.patches[patch];
    let &[root] = main.attachments.as_slice() else { return None };
    let along = patch.vertices[main.to] - patch.vertices[main.from];
    (patch.edges_at(root).filter(|e| !patch.edges[*e].main).count() == 1)
        .then(|| (root, along.perp().normalize_or_zero()))
}

/// Lays an initial patch at a port in place of its stub; returns whether one fits.
fn start_with_patch(
    draft: &mut Draft<'_>,
    placer: &mut Placer<'_>,
    order: &PortOrder,
    port: usize,
    initial: &[usize],
) -> bool {
    let (at, inward) = (draft.brief.ports[port].at, draft.brief.ports[port].inward);
    let weights: Vec<f64> = initial.iter().map(|p| placer.weight(*p)).collect();
    let Some(pick) = draft.rng.weighted(&weights).map(|i| initial[i]) else { return false };
    let Some((root, side)) = initial_root(placer.patches, pick) else {
        return start_with_row(draft, placer, order, port, pick);
    };
    let radius = placer.patches.patches[pick].radius;
    let root_at = placer.patches.patches[pick].vertices[root];
    let mut removed = RemovedStubs::default();
    removed.remove(&mut draft.canvas, draft.brief.ports.len(), port);
    draft.gather(at, 2.0 * radius + draft.rules.growth.gap + draft.rules.growth.min_piece);
    let first_mirrored = draft.rng.chance(0.5);
    for mirrored in [first_mirrored, !first_mirrored] {
        let placement = Placement::new((pick, root, root_at), side, mirrored, at, inward);
        if roughly_fits(draft, placer.patches, &placement, at, None)
            && placer.propose_patch(draft, &placement, &[(root, port as VertexIx)])
            && build(draft, pick)
        {
            placer.after_patch(draft, pick);
            return true;
        }
    }
    removed.restore(&mut draft.canvas);
    false
}

/// Lays an initial patch that leaves its main street several times, at a port and at those next to it along the street; it is
/// stretched or shortened a little to meet them. Returns whether it fits.
fn start_with_row(draft: &mut Draft<'_>, placer: &mut Placer<'_>, order: &PortOrder, port: usize, pick: usize) -> bool {
    let patches = placer.patches;
    let Some(main) = &patches.facts(pick).main else { return false };
    let roots = main.attachments.as_slice();
    if roots.len() < 2 {
        return false;
    }
    for run in order.runs(draft) {
        for ports in run.windows(roots.len()).filter(|ports| ports.contains(&port)) {
            let back: Vec<usize> = ports.iter().rev().copied().collect();
            for ports in [ports, &back] {
                let placed = across_ports(draft, patches, pick, (roots, ports), None);
                if let Some(at) = placed.filter(|at| STRETCHED.contains(&at.along))
                    && lay_at_ports(draft, placer, at.placement, &at.roots)
                {
                    return true;
                }
            }
        }
    }
    false
}
