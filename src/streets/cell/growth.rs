//! Network propagation (Teng 2017, algorithm 1) and parametric growth (Fig. 3), the way to go on that is always there.

use super::canvas::Maker;
use super::draft::Draft;
use super::proposal::Join;
use crate::layer::{Cancel, LayerError};
use crate::network::VertexIx;
use crate::space::{
    Bounds,
    math::{self, rotate},
};
use glam::DVec2;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Greatest angle by which a street bends at once to follow the field, in radians.
const FIELD_BEND: f64 = 0.16;

/// Goes on from every candidate vertex, in turn, until none is left. `attach` may build something on the end of a street:
/// it is given the vertex, its place and the direction in which the street leads on. Where it returns false, and at
/// vertices that several streets meet in, a street grows.
pub fn propagate(
    draft: &mut Draft<'_>,
    cancel: &Cancel,
    mut attach: impl FnMut(&mut Draft<'_>, VertexIx, DVec2, DVec2) -> bool,
) -> Result<(), LayerError> {
    let mut steps = 0usize;
    while let Some(v) = draft.candidates.pop_front() {
        steps += 1;
        if steps.is_multiple_of(16) {
            cancel.check()?;
        }
        let degree = draft.canvas.graph.degree(v);
        if degree == 0 || degree >= draft.rules.growth.max_degree || !draft.canvas.nodes[v as usize].open {
            continue;
        }
        let Some(direction) = direction(draft, v) else { continue };
        let at = draft.canvas.graph.at(v);
        if degree != 1 || !attach(draft, v, at, direction) {
            grow(draft, v, at, direction);
        }
    }
    Ok(())
}

/// Propagation direction of a vertex: the bisector of the largest angle between its streets (Teng 2017, Fig. 6), drawn
/// towards the nearest direction of the field. `None` where no street fits between the others.
fn direction(draft: &Draft<'_>, v: VertexIx) -> Option<DVec2> {
    let (g, rules) = (&draft.canvas.graph, &draft.rules);
    let at = g.at(v);
    let mut angles: Vec<f64> = g.neighbours(v).map(|w| math::angle_of(g.at(w) - at)).collect();
    angles.sort_by(f64::total_cmp);
    let n = angles.len();
    let gap = |i: usize| if i + 1 < n { angles[i + 1] - angles[i] } else { angles[0] + TAU - angles[i] };
    let widest = (0..n).max_by(|a, b| gap(*a).total_cmp(&gap(*b)))?;
    if gap(widest) < 2.0 * rules.min_angle {
        return None;
    }
    let bisector = angles[widest] + gap(widest) / 2.0;
    let off = draft.brief.field.angle(at) - bisector;
    let off = off - (off / FRAC_PI_2).round() * FRAC_PI_2;
    let most = if n == 1 { FIELD_BEND } else { gap(widest) / 2.0 - rules.min_angle };
    Some(math::direction(bisector + (off * rules.field_pull).clamp(-most.min(PI / 4.0), most.min(PI / 4.0))))
}

/// Grows a street from `v`, and makes its end a candidate. The vertex itself stays one while it has fewer streets than it
/// should.
fn grow(draft: &mut Draft<'_>, v: VertexIx, at: DVec2, direction: DVec2) {
    let (local, limits) = (draft.rules.local, draft.rules.growth);
    let (degree, snap) = (local.degree, local.snap_radius);
    let length = local.length + draft.rng.signed() * local.deviation;
    let off = draft.rng.signed() * local.angle_deviation_deg.to_radians();
    // A shorter street or one that turns aside, where the first choice does not fit.
    let bend = draft.rules.most_turn;
    let far = length.max(local.min_length) + snap.max(limits.gap);
    let sideways = far * (bend + off.abs()).min(1.0) + limits.reach();
    draft.canvas.gather(Bounds::of([at, at + direction * far]), sideways, &mut draft.trial.near);
    let tries = [(1.0, off), (0.65, off), (1.0, 0.5 * bend), (1.0, -0.5 * bend), (0.65, bend), (0.65, -bend)];
    for (share, angle) in tries {
        let to = at + rotate(direction, angle) * (length * share).max(local.min_length);
        let mut line = std::mem::take(&mut draft.trial.line);
        line.clear();
        line.extend([at, to]);
        let join = draft.landing().settle(&mut line, v, &limits);
        if let Some(join) = join {
            draft.trial.proposal.line(&line, Join::At(v), join);
        }
        draft.trial.line = line;
        let Some(join) = join.filter(|_| draft.build_if_fits(&limits, Maker::Growth)) else {
            continue;
        };
        if join == Join::Free(true) {
            let wanted = degree.0 as usize + draft.rng.index((degree.1.saturating_sub(degree.0) + 1) as usize);
            let end = draft.trial.built[1];
            draft.canvas.nodes[end as usize].wanted_degree = wanted;
            draft.candidates.push_back(end);
        }
        draft.cross_over();
        if draft.canvas.graph.degree(v) < draft.canvas.nodes[v as usize].wanted_degree {
            draft.candidates.push_back(v);
        }
        return;
    }
}
