//! Streets that would mend the network: where they end, what they cost, and the cheapest that fits.

use super::canvas::Maker;
use super::draft::Draft;
use super::proposal::Join;
use super::rules::Limits;
use crate::network::VertexIx;
use crate::space::math::angle_of;
use glam::DVec2;
use std::f64::consts::FRAC_PI_2;

/// A street that would mend something, and what it costs.
pub struct Mend {
    /// What it costs: metres, more for what is not wanted.
    pub cost: f64,
    /// Its points; two of them where it is straight.
    pub line: [DVec2; 3],
    /// Number of its points.
    pub points: usize,
    /// How it begins.
    pub first: Join,
    /// How it ends.
    pub last: Join,
}

impl Mend {
    /// The mend along a straight street.
    pub fn straight(cost: f64, from: DVec2, to: DVec2, first: Join, last: Join) -> Self {
        Self { cost, line: [from, to, to], points: 2, first, last }
    }
}

/// Where a street from `from` in `direction` first meets a local street within `reach`: there, or at a vertex next
/// to it, with its distance, the greater the more aslant it lands. `line` is a buffer.
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

/// What it costs more that the street from `from` to `end` does not follow the field: 1 for one that does.
fn off_field(draft: &Draft<'_>, from: DVec2, end: DVec2) -> f64 {
    off_by(draft, angle_of(end - from) - draft.brief.field.angle(from.midpoint(end)))
}

/// The same for a street that heads at this angle to the field.
pub fn off_by(draft: &Draft<'_>, off: f64) -> f64 {
    let off = off - (off / FRAC_PI_2).round() * FRAC_PI_2;
    1.0 + 2.5 * draft.rules.field_pull * off.abs()
}

/// Builds the cheapest of the given streets that keeps to `limits`; so many are tried.
pub fn build_best(draft: &mut Draft<'_>, mut mends: Vec<Mend>, limits: &Limits, tries: usize) -> bool {
    mends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    for m in mends.into_iter().take(tries) {
        draft.trial.proposal.line(&m.line[..m.points], m.first, m.last);
        if draft.build_if_fits(limits, Maker::Repair) {
            return true;
        }
    }
    false
}
