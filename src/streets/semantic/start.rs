//! Cell initialization (Teng 2017, section 3.2): patterns along main streets, and an initial patch in the
//! place of some of the stubs.

use super::coarse::roughly_fits;
use super::pattern::{lay_at_ports, start_with_patterns};
use super::placement::Placement;
use super::placer::{Placer, build};
use crate::network::VertexIx;
use crate::patch::{PatchDatabase, STRETCH, tag};
use crate::streets::cell::{Draft, RemovedStubs, has_stub, stub_end};
use glam::DVec2;

/// Lays patterns, and initial patches in place of some stubs. Their ends and those of the other stubs become the first
/// candidate vertices.
pub fn start(draft: &mut Draft<'_>, placer: &mut Placer<'_>) {
    start_with_patterns(draft, placer);
    let ports = draft.brief.ports.len();
    let patches = placer.patches;
    let initial: Vec<usize> =
        patches.tagged(tag::INITIAL).iter().copied().filter(|p| patches.facts(*p).main.is_some()).collect();
    for i in 0..ports {
        // The stub is there, unless a pinned patch took its place.
        if !has_stub(&draft.canvas, ports, i) {
            continue;
        }
        // One port in three begins with an initial patch; more would leave no room between them.
        if initial.is_empty() || !draft.rng.chance(0.34) || !start_with_patch(draft, placer, i, &initial) {
            draft.candidates.push_back(stub_end(ports, i));
        }
    }
    draft.canvas.stamp_stubs(draft.brief.ports);
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
fn start_with_patch(draft: &mut Draft<'_>, placer: &mut Placer<'_>, port: usize, initial: &[usize]) -> bool {
    let (at, inward) = (draft.brief.ports[port].at, draft.brief.ports[port].inward);
    let weights: Vec<f64> = initial.iter().map(|p| placer.weight(*p)).collect();
    let Some(pick) = draft.rng.weighted(&weights).map(|i| initial[i]) else { return false };
    let Some((root, side)) = initial_root(placer.patches, pick) else {
        return start_with_two(draft, placer, port, pick);
    };
    let radius = placer.patches.patches[pick].radius;
    let root_at = placer.patches.patches[pick].vertices[root];
    let mut removed = RemovedStubs::default();
    removed.remove(&mut draft.canvas, port as VertexIx);
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

/// Lays an initial patch that leaves its main street twice, at a port and at the next one along the street; it is stretched or
/// shortened a little to meet both. Returns whether it fits.
fn start_with_two(draft: &mut Draft<'_>, placer: &mut Placer<'_>, port: usize, pick: usize) -> bool {
    let patches = placer.patches;
    let patch = patches.patches[pick].clone();
    let Some(&[a, b]) = patches.facts(pick).main.as_ref().map(|m| m.attachments.as_slice()) else { return false };
    let from = patch.vertices[b] - patch.vertices[a];
    let here = draft.brief.ports[port];
    for (other, there) in draft.brief.ports.iter().enumerate().filter(|(i, _)| *i != port) {
        let to = there.at - here.at;
        let scale = to.length() / from.length();
        let in_line = there.inward.dot(here.inward) > 0.9 && to.dot(here.inward).abs() < 0.3 * to.length();
        if !in_line || !(0.8..=1.25).contains(&scale) || !has_stub(&draft.canvas, draft.brief.ports.len(), other) {
            continue;
        }
        // The attachment lies to the left of the line from `a` to `b`, as drawn; else it is mirrored.
        let inward = to.perp().dot(here.inward).signum();
        let across = inward * scale.clamp(1.0 - STRETCH, 1.0 + STRETCH);
        let (one, two) = ((a, port), (b, other));
        let placement = Placement::drawn_out((pick, a, patch.vertices[a]), from, here.at, to, across);
        if lay_at_ports(draft, placer, placement, &patch, &[one, two]) {
            return true;
        }
    }
    false
}
