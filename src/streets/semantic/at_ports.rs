//! Patches at ports: where the side streets of a patch meet a main street, there are ports for them.

use super::coarse::roughly_fits;
use super::placement::Placement;
use super::placer::{Placer, build};
use crate::network::VertexIx;
use crate::patch::{PatchDatabase, STRETCH, keeps_rules};
use crate::seam::CellPort;
use crate::streets::cell::{Draft, Join, NONE, RemovedStubs, has_stub};
use crate::streets::filler::CellBrief;
use glam::DVec2;

/// Greatest distance from a port to where the drawing has the side street between two others that stand at ports, in metres.
const OFF_PORT: f64 = 8.0;

/// Distance within which vertices of two elements that share a street are the same, in metres.
const SAME: f64 = 7.0;

/// The ports of a cell in the order in which they lie along its sides.
pub struct PortOrder(Vec<usize>);

impl PortOrder {
    /// The order of the ports of this cell.
    pub fn of(brief: &CellBrief<'_>) -> Self {
        let n = brief.border.len();
        let place = |port: &CellPort| {
            let on = |k: &usize| {
                let (a, b) = (brief.border[*k], brief.border[(k + 1) % n]);
                crate::space::distance_to_segment(port.at, a, b)
            };
            let edge = (0..n).min_by(|a, b| on(a).total_cmp(&on(b))).unwrap_or(0);
            (edge, brief.border.get(edge).map_or(0.0, |a| a.distance(port.at)))
        };
        let places: Vec<(usize, f64)> = brief.ports.iter().map(place).collect();
        let mut order: Vec<usize> = (0..places.len()).collect();
        order.sort_by(|a, b| {
            let (p, q) = (places[*a], places[*b]);
            p.0.cmp(&q.0).then(p.1.total_cmp(&q.1)).then(a.cmp(b))
        });
        Self(order)
    }

    /// Runs of ports next to each other along straight sides, in order; only ports whose stubs are not built on.
    pub fn runs(&self, draft: &Draft<'_>) -> Vec<Vec<usize>> {
        let ports = draft.brief.ports;
        let mut runs: Vec<Vec<usize>> = Vec::new();
        for &i in self.0.iter().filter(|i| has_stub(&draft.canvas, ports.len(), **i)) {
            let goes_on = runs.last().and_then(|r| r.last()).is_some_and(|&before: &usize| {
                let (p, q) = (&ports[before], &ports[i]);
                let step = q.at - p.at;
                p.inward.dot(q.inward) > 0.9 && step.dot(p.inward).abs() < 0.3 * step.length()
            });
            match runs.last_mut() {
                Some(run) if goes_on => run.push(i),
                _ => runs.push(vec![i]),
            }
        }
        runs
    }
}

/// A patch whose side streets stand at ports.
pub struct AtPorts {
    /// Where it lies.
    pub placement: Placement,
    /// Each root of it with its port.
    pub roots: Vec<(usize, usize)>,
    /// How much it is drawn out along the main street.
    pub along: f64,
}

/// The placement of a patch with its `roots`, in order along its main street, at `ports`: the first and the last meet theirs, and the
/// others nearly so. Mirrored where the ports are in clockwise order. Across the main street it has the given scale, else about
/// that along it. `None` if a root lies too far from its port.
pub fn across_ports(
    draft: &Draft<'_>,
    patches: &PatchDatabase,
    patch: usize,
    (roots, ports): (&[usize], &[usize]),
    across: Option<f64>,
) -> Option<AtPorts> {
    let drawn = &patches.patches[patch];
    let (a, b) = (drawn.vertices[*roots.first()?], drawn.vertices[*roots.last()?]);
    let (here, there) = (draft.brief.ports[*ports.first()?], draft.brief.ports[*ports.last()?]);
    let (from, to) = (b - a, there.at - here.at);
    let along = to.length() / from.length();
    // What is round stays so.
    let round = patches.facts(patch).shape.round;
    let across = if round { along } else { across.unwrap_or(along.clamp(1.0 - STRETCH, 1.0 + STRETCH)) };
    // The patch lies to the left of the line from its first root to its last, as drawn.
    let side = to.perp().dot(here.inward).signum();
    let placement = Placement::drawn_out((patch, roots[0], a), from, here.at, to, side * across);
    let off = |(root, port): (&usize, &usize)| {
        placement.map(drawn.vertices[*root]).distance(draft.brief.ports[*port].at) > OFF_PORT
    };
    let roots: Vec<(usize, usize)> = roots.iter().copied().zip(ports.iter().copied()).collect();
    (!roots.iter().any(|(root, port)| off((root, port)))).then_some(AtPorts { placement, roots, along })
}

/// Builds a patch whose roots fall on ports, in place of their stubs, and returns whether it fits. A side street that it shares
/// with the element before is not built again.
pub fn lay_at_ports(
    draft: &mut Draft<'_>,
    placer: &mut Placer<'_>,
    placement: Placement,
    roots: &[(usize, usize)],
) -> bool {
    let size = placer.patches.patches[placement.patch].radius * placement.scale();
    // It may have been used as often as it may be, and one that is larger than the cell cannot stand in it.
    if placer.weight(placement.patch) <= 0.0 || size > draft.canvas.size() {
        return false;
    }
    let centre = placement.map(DVec2::ZERO);
    let (mut stubs, ports) = (RemovedStubs::default(), draft.brief.ports.len());
    let kept = roots.iter().filter(|(_, port)| !stubs.remove(&mut draft.canvas, ports, *port)).count();
    // Where more is built than the stub, the patch may share it, but not if it begins nowhere else.
    if roots.len() == 1 && kept == 1 {
        return false;
    }
    let anchors: Vec<(usize, VertexIx)> = roots.iter().map(|(v, port)| (*v, *port as VertexIx)).collect();
    draft.gather(centre, 1.5 * size + draft.rules.growth.gap + draft.rules.growth.min_piece);
    let start = draft.brief.ports[roots[0].1].at;
    let end = roots.get(1).map(|r| draft.brief.ports[r.1].at);
    // What is shared is there already: only the exact check can tell it from what is in the way.
    let shares = roots.iter().any(|r| draft.canvas.graph.degree(r.1 as VertexIx) > 0);
    let fits = (shares || roughly_fits(draft, placer.patches, &placement, start, end))
        && placer.propose(draft, &placement, &anchors, false)
        && share_streets(draft, roots)
        && build(draft, placement.patch);
    if fits {
        placer.after_patch(draft, placement.patch);
    } else {
        stubs.restore(&mut draft.canvas);
    }
    fits
}

/// Removes from the proposal the streets that exist already. False if nothing is left or the rest breaks a rule.
fn share_streets(draft: &mut Draft<'_>, roots: &[(usize, usize)]) -> bool {
    let g = &draft.canvas.graph;
    if roots.iter().all(|r| g.degree(r.1 as VertexIx) == 0) {
        return true;
    }
    let p = &mut draft.trial.proposal;
    for i in 0..p.points.len() {
        let loose_ends = p.joins[i];
        if !matches!(loose_ends, Join::Free(_)) {
            continue;
        }
        let ends = draft.trial.near.obstacles.iter().flat_map(|s| [(s.va, s.a), (s.vb, s.b)]);
        let same = ends.filter(|(v, q)| *v != NONE && q.distance(p.points[i]) < SAME).map(|(v, _)| v);
        if let Some(v) = same.min() {
            p.joins[i] = Join::At(v);
            p.points[i] = g.at(v);
        }
    }
    let joins = &p.joins;
    p.edges.retain(|(a, b)| match (joins[*a], joins[*b]) {
        (Join::At(v), Join::At(w)) => g.edge_between(v, w).is_none(),
        _ => true,
    });
    p.drop_unused_points();
    !p.edges.is_empty() && keeps_rules(&p.points, &p.edges, 1.0, &draft.rules.drawings)
}
