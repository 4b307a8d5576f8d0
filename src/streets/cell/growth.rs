//! Network propagation (Teng 2017, algorithm 1) and parametric growth (Fig. 3), the way to go on that is always there.

use super::canvas::Maker;
use super::draft::Draft;
use super::proposal::Join;
use crate::layer::{Cancel, LayerError};
use crate::network::VertexIx;
use crate::space::{
    Bounds,
    math::{self, direction, rotate},
};
use glam::DVec2;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Greatest angle by which a street bends at once to follow the field, in radians.
const FIELD_BEND: f64 = 0.16;

/// Up to this number of streets at a junction, one goes straight on and the others leave square. More are spread evenly.
const MOST_SQUARE: usize = 4;

/// What is left of a street's length where the whole does not fit.
const SHORTER: f64 = 0.65;

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
        let at = draft.canvas.graph.at(v);
        let wanted = draft.canvas.nodes[v as usize].wanted_degree;
        // What is built on the end of a street goes straight on.
        let mut open = ways(draft, v, if degree == 1 { wanted.min(MOST_SQUARE) } else { wanted });
        if degree == 1 {
            if open.first().is_some_and(|way| attach(draft, v, at, direction(way.angle))) {
                continue;
            }
            if wanted > MOST_SQUARE {
                open = ways(draft, v, wanted);
            }
        }
        // The widest gap first.
        for way in open {
            if grow(draft, v, at, &way) {
                break;
            }
        }
    }
    Ok(())
}

/// A way in which a street may leave a vertex, between two streets or around one.
struct Way {
    /// Its angle, in radians.
    angle: f64,
    /// Greatest angles by which it may turn right and left, in radians.
    room: (f64, f64),
}

/// The ways in which a street may leave `v`, which shall have `wanted` streets: one into each gap between its streets, the
/// widest first. Up to four streets bisect the gaps (Teng 2017, Fig. 6) and are drawn towards the nearest direction of the
/// field.
fn ways(draft: &Draft<'_>, v: VertexIx, wanted: usize) -> Vec<Way> {
    let (g, rules) = (&draft.canvas.graph, &draft.rules);
    let at = g.at(v);
    let mut angles: Vec<f64> = g.neighbours(v).map(|w| math::angle_of(g.at(w) - at)).collect();
    angles.sort_by(f64::total_cmp);
    let n = angles.len();
    let gap = |i: usize| if i + 1 < n { angles[i + 1] - angles[i] } else { angles[0] + TAU - angles[i] };
    let mut gaps: Vec<(f64, f64)> = (0..n).rev().map(|i| (angles[i], gap(i))).collect();
    gaps.sort_by(|a, b| b.1.total_cmp(&a.1));
    let way = |(from, gap): (f64, f64)| {
        let even = if wanted > MOST_SQUARE { (gap * wanted as f64 / TAU).round() } else { 0.0 };
        let parts = even.max(2.0).min((gap / rules.min_angle).floor());
        if parts < 2.0 {
            return None;
        }
        let angle = from + gap * (parts / 2.0).floor() / parts;
        let right = (angle - from - rules.min_angle).max(0.0);
        let left = (from + gap - angle - rules.min_angle).max(0.0);
        let most = if n == 1 { FIELD_BEND } else { PI / 4.0 };
        let off = draft.brief.field.angle(at) - angle;
        let off = off - (off / FRAC_PI_2).round() * FRAC_PI_2;
        let pull = if wanted > MOST_SQUARE { 0.0 } else { rules.field_pull };
        let turn = (off * pull).clamp(-most.min(right), most.min(left));
        Some(Way { angle: angle + turn, room: (right + turn, left - turn) })
    };
    gaps.into_iter().filter_map(way).collect()
}

/// Grows a street from `v`, and makes its end a candidate; returns whether one fits. The vertex itself stays a candidate while
/// it has fewer streets than it should.
fn grow(draft: &mut Draft<'_>, v: VertexIx, at: DVec2, way: &Way) -> bool {
    let (local, limits) = (draft.rules.local, draft.rules.growth);
    let (degree, snap) = (local.degree, local.snap_radius);
    let length = local.length + draft.rng.signed() * local.deviation;
    let turn = local.angle_deviation_deg.to_radians();
    let off = draft.rng.signed() * turn;
    // A shorter street or one that turns aside, where the first choice does not fit.
    let far = length.max(local.min_length) + snap.max(limits.gap);
    let sideways = far * turn.min(1.0) + limits.reach().max(snap);
    let onward = direction(way.angle);
    draft.canvas.gather(Bounds::of([at, at + onward * far]), sideways, &mut draft.trial.near);
    let tries = [(1.0, off), (SHORTER, off), (1.0, 0.5 * turn), (1.0, -0.5 * turn), (SHORTER, turn), (SHORTER, -turn)];
    for (share, angle) in tries {
        let angle = angle.clamp(-way.room.0, way.room.1);
        let to = at + rotate(onward, angle) * (length * share).max(local.min_length);
        let mut line = std::mem::take(&mut draft.trial.line);
        line.clear();
        line.extend([at, to]);
        let landing = draft.landing();
        let open = landing.settle(&mut line, v, &limits).map(|join| (line[line.len() - 1], join));
        let (snapped, square) = match open {
            Some((end, Join::Free(_))) => (landing.snap(end, v, &limits), None),
            Some((end, Join::On(_))) => (None, landing.square(at, end, &limits)),
            _ => (None, None),
        };
        draft.trial.line = line;
        let built = [snapped, open, square].into_iter().flatten().find(|(end, join)| {
            draft.trial.proposal.line(&[at, *end], Join::At(v), *join);
            draft.build_if_fits(&limits, Maker::Growth)
        });
        let Some((_, join)) = built else { continue };
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
        return true;
    }
    false
}
