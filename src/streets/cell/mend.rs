//! Mends: streets that would repair the network. The cheapest that fits is built.

use super::canvas::Maker;
use super::draft::Draft;
use super::proposal::Join;
use super::rules::Limits;
use crate::network::VertexIx;
use crate::space::math::angle_of;
use glam::DVec2;
use std::f64::consts::FRAC_PI_2;

/// A street that would repair the network, with its cost.
pub struct Mend {
    /// Its cost: the length in metres, times penalties.
    pub cost: f64,
    /// Its points; a straight street uses two of them.
    pub line: [DVec2; 3],
    /// Number of points.
    pub points: usize,
    /// How its first point joins the network.
    pub first: Join,
    /// How its last point joins the network.
    pub last: Join,
}

impl Mend {
    /// A straight street.
    pub fn straight(cost: f64, from: DVec2, to: DVec2, first: Join, last: Join) -> Self {
        Self { cost, line: [from, to, to], points: 2, first, last }
    }

    /// A street with a bend.
    pub fn bent(cost: f64, line: [DVec2; 3], first: Join, last: Join) -> Self {
        Self { cost, line, points: 3, first, last }
    }

    /// Cosine of the angle between both parts of the street at its bend; -1 where it has none.
    fn bend_cosine(&self) -> f64 {
        let [from, bend, to] = self.line;
        if self.points < 3 { -1.0 } else { (from - bend).normalize_or_zero().dot((to - bend).normalize_or_zero()) }
    }
}

/// Where a street from `from` in `direction` ends if it meets a local street within `reach` metres: the position, how it joins
/// the network, and its length with penalties for landing aslant and for leaving the field. `line` is a buffer.
pub fn landing(
    draft: &Draft<'_>,
    from: DVec2,
    direction: DVec2,
    reach: f64,
    leaving: VertexIx,
    line: &mut Vec<DVec2>,
) -> Option<(DVec2, Join, f64)> {
    let ahead = draft.rules.local.snap_radius.max(draft.rules.repair.gap);
    let to = from + direction * (reach - ahead).max(1.0);
    line.clear();
    line.extend([from, to]);
    let join = draft.landing().settle(line, leaving, &draft.rules.repair)?;
    let end = line[line.len() - 1];
    // Streets meet rather square than aslant.
    let met = match join {
        Join::On(e) => Some(draft.canvas.graph.segment(e)),
        Join::At(_) => None,
        Join::Free(_) => return None,
    };
    let along = met.map_or(DVec2::ZERO, |(a, b)| (b - a).normalize_or_zero());
    let slant = along.dot((end - from).normalize_or_zero()).abs();
    Some((end, join, from.distance(end) * (1.0 + slant) * off_field(draft, from, end)))
}

/// The penalty of the street from `from` to `end` for not following the field: 1 if it does.
pub fn off_field(draft: &Draft<'_>, from: DVec2, end: DVec2) -> f64 {
    off_by(draft, angle_of(end - from) - draft.brief.field.angle(from.midpoint(end)))
}

/// The penalty of a street at the angle `off` to the field, in radians: 1 if it follows the field.
pub fn off_by(draft: &Draft<'_>, off: f64) -> f64 {
    let off = off - (off / FRAC_PI_2).round() * FRAC_PI_2;
    1.0 + 2.5 * draft.rules.field_pull * off.abs()
}

/// Builds the cheapest of `mends` that keeps to `limits`, after at most `tries` checks; returns whether one was built.
pub fn build_best(draft: &mut Draft<'_>, mut mends: Vec<Mend>, limits: &Limits, tries: usize, maker: Maker) -> bool {
    mends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    // Where a street lands may turn its bend sharper than it was aimed.
    mends.retain(|m| m.bend_cosine() <= limits.junction_cosine);
    for m in mends.into_iter().take(tries) {
        draft.trial.proposal.line(&m.line[..m.points], m.first, m.last);
        if draft.build_if_fits(limits, maker) {
            return true;
        }
    }
    false
}
