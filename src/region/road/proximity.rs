//! The proximity rule (Galin 2011, section 5.1): which pairs of settlements get a road.
//!
//! A pair is kept unless some settlement is, over the ground, nearer to both of its ends in the sense of `gamma`.

use super::distance::Distances;
use super::inputs::{Inputs, Way};
use super::tier::{beeline, tier_of};
use super::wishes::Wish;
use crate::layer::{Cancel, LayerError, Reach};
use crate::region::settlement::Settlement;
use crate::space::{Bounds, math};
use std::sync::Arc;

/// Relative error of ratios of distances on the coarse lattice; most errors are smaller.
const DOUBT: f64 = 0.015;

/// Relative error of distances on the stencil; a search allows for it, too.
const STENCIL_ERROR: f64 = 0.03;

/// The proximity rule.
pub(super) struct Proximity {
    inputs: Arc<Inputs>,
    distances: Arc<Distances>,
}

/// Whether `c` lies in the empty region of a pair at distance `ab`. Galin 2011, section 5.1, prints the inequality the other
/// way round; an edge is kept if no such settlement exists.
pub(super) fn rules_out(ac: f64, bc: f64, ab: f64, gamma: f64) -> bool {
    ac < ab && bc < ab && math::pow(ac / ab, gamma) + math::pow(bc / ab, gamma) < 1.0
}

impl Proximity {
    pub fn new(inputs: Arc<Inputs>, distances: Arc<Distances>) -> Self {
        Self { inputs, distances }
    }

    /// Settlements of the pair's tier or above that may be nearer than `most` to both ends, by beeline.
    fn between(&self, a: &Settlement, b: &Settlement, most: f64) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let [near_a, near_b] = [a, b].map(|s| Bounds::square(s.centre.plan(), 2.0 * most));
        let both = Bounds::new(near_a.min.max(near_b.min), near_a.max.min(near_b.max));
        let tier = tier_of(a, b);
        // A pair is decided by settlements within the reach of its tier from both ends.
        let ends = Bounds::of([a.centre.plan(), b.centre.plan()]);
        let reach = Reach::new("roads", ends, self.inputs.tier(tier).reach + 1.0);
        self.inputs.settlements.centred_in(reach.check(both)?, tier)
    }

    /// Whether the proximity rule keeps a pair.
    ///
    /// The rule compares distances over the ground. Distances on the coarse lattice are close to these: they decide where they
    /// leave no doubt, and only the other distances are measured on the fine lattice.
    pub fn keeps(&self, a: &Settlement, b: &Settlement, cancel: &Cancel) -> Result<bool, LayerError> {
        let tier = tier_of(a, b);
        let t = self.inputs.tier(tier);
        let coarse = |a: &Settlement, b: &Settlement| -> Result<f64, LayerError> {
            Ok(self.distances.coarse_path((tier, Way::Usual), a, b, cancel)?.cost)
        };
        let mut led = false;
        match self.inputs.wishes.of(a, b) {
            Some(Wish::Ban) => return Ok(false),
            Some(Wish::Keep | Wish::Via { keep: true, .. }) => {
                return Ok(self.distances.corridor_line(tier, a, b, cancel)?.is_some());
            }
            Some(Wish::Via { keep: false, .. }) => led = true,
            None => {}
        }
        // A road through points costs what it costs there (Galin 2011, section 4.3).
        let ab = if led { self.distances.corridor_path(tier, a, b, cancel)?.cost } else { coarse(a, b)? };
        if !ab.is_finite() || ab > t.detour * beeline(a, b) * (1.0 + STENCIL_ERROR) {
            return Ok(false);
        }
        // Everything that lies in the ellipse of a pair with one of these ends.
        let ends = Bounds::of([a.centre.plan(), b.centre.plan()]);
        let around = ends.grown(2.0 * t.padding(self.inputs.step()));
        let least = self.inputs.influences.terms(tier, around).least_cost();
        // A cost is at least the beeline times the least cost per metre, so only these settlements can rule the pair out.
        let others = self.between(a, b, t.reach.min(ab * (1.0 + DOUBT) / least))?;
        let mut near: Vec<(f64, &Arc<Settlement>)> = Vec::new();
        for c in &others {
            let (ac, bc) = (beeline(a, c), beeline(b, c));
            if c.id != a.id
                && c.id != b.id
                && ac.max(bc) <= t.reach
                && rules_out(least * ac, least * bc, ab * (1.0 + DOUBT), t.gamma)
            {
                near.push((ac + bc, c));
            }
        }
        // The most likely ones first.
        near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.id.cmp(&y.1.id)));
        let (least, most) = (ab * (1.0 - DOUBT), ab * (1.0 + DOUBT));
        let mut doubtful = Vec::new();
        for (_, c) in near {
            let ac = coarse(a, c)?;
            let bc = if ac < most { coarse(b, c)? } else { continue };
            if rules_out(ac, bc, least, t.gamma) {
                return Ok(false);
            }
            if rules_out(ac, bc, most, t.gamma) && !led {
                doubtful.push(c);
            }
        }
        for c in doubtful {
            let fine = |a: &Settlement, b: &Settlement| self.distances.distance(tier, a, b, cancel);
            if rules_out(fine(a, c)?, fine(b, c)?, fine(a, b)?, t.gamma) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gamma_two_is_the_disc_and_large_gamma_the_lune() {
        assert!(rules_out(0.7, 0.7, 1.0, 2.0) && !rules_out(0.72, 0.72, 1.0, 2.0));
        assert!(rules_out(0.72, 0.72, 1.0, 3.0) && rules_out(0.95, 0.95, 1.0, 20.0));
        assert!(!rules_out(1.0, 0.1, 1.0, 20.0));
    }
}
