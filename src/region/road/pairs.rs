//! Distances between settlements over the ground, and the proximity rule that keeps some of their pairs.

use super::lattice::{Samples, cost_per_metre, kernel, node_at, stencil_distance};
use super::search::{Task, Window, search};
use super::{TierSettings, Work};
use crate::layer::{Cancel, LayerError, Weigh};
use crate::region::{Settlement, SizeClass};
use crate::space::{Bounds, math};
use glam::{DVec2, I64Vec2};
use std::sync::Arc;

/// Pairs that a third settlement would rule out by beelines even if their road were this much shorter than the beeline
/// are not tried at all. Where a detour makes a road dearer than its beeline, that alone could never save them.
const HOPELESS: f64 = 0.87;
/// Extra cost per metre, a kilometre off the beeline: of ways that cost the same, the straightest is taken.
const OFF_BEELINE: f64 = 0.01;
/// Greatest distance at which a settlement repels roads that do not serve it, in metres.
const MOST_REPEL: f64 = 4_000.0;

/// The cheapest way between two settlements on the wide lattice.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    /// Cost in metres of flat open ground, infinite where there is no way.
    pub cost: f64,
    /// Nodes of the wide lattice.
    pub nodes: Vec<I64Vec2>,
}

impl Weigh for Pair {
    fn bytes(&self) -> usize {
        size_of::<Self>() + self.nodes.len() * size_of::<I64Vec2>()
    }
}

/// Class tau = min(sigma, sigma) of a pair (Galin 2011, section 3).
pub(super) fn tier_of(a: &Settlement, b: &Settlement) -> SizeClass {
    a.size.min(b.size)
}

/// Beeline between two settlements, in metres.
pub(super) fn beeline(a: &Settlement, b: &Settlement) -> f64 {
    a.centre.offset_to(b.centre).length()
}

/// Box around the points whose distances to `a` and `b` sum to at most `sum`.
fn ellipse_bounds(a: DVec2, b: DVec2, sum: f64) -> Bounds {
    let (middle, half) = ((a + b) / 2.0, (b - a) / 2.0);
    let long = (sum / 2.0).max(half.length());
    let short2 = long * long - half.length_squared();
    let u = half.normalize_or(DVec2::X);
    let extent = |along: f64, across: f64| (long * long * along * along + short2 * across * across).sqrt();
    let size = DVec2::new(extent(u.x, u.y), extent(u.y, u.x));
    Bounds::new(middle - size, middle + size)
}

/// The way between two settlements as roads of class `tier` see it. A function of the unordered pair.
pub(super) fn pair(
    work: &Work,
    tier: SizeClass,
    a: &Settlement,
    b: &Settlement,
    cancel: &Cancel,
) -> Result<Arc<Pair>, LayerError> {
    let (a, b) = if a.id < b.id { (a, b) } else { (b, a) };
    work.pairs.get(&(tier as u8, a.id, b.id), || {
        cancel.check()?;
        let t = work.settings.tier(tier);
        let step = work.settings.step * t.wide_step;
        let length = beeline(a, b);
        let (from, to) = (work.centre_node(a, step), work.centre_node(b, step));
        let line = stencil_distance(to - from) * step as f64;
        if from == to {
            return Ok(Pair { cost: length, nodes: vec![from] });
        }
        let across = (to - from).as_dvec2().length();
        let limit = t.detour * line;
        let bounds = ellipse_bounds(node_at(from, step), node_at(to, step), limit);
        let window = work.window(bounds, step);
        let repel = repulsion(work, t, tier, [a, b], &window, step)?;
        let mut samples = Samples::new(&work.samples, &*work.terrain, step, &window);
        let task = Task {
            window,
            step,
            from: &[(from, 0.0)],
            to: &[(to, 0.0)],
            goal: node_at(to, step),
            limit,
            bridge_limit: t.bridge_limit + step as f64,
            turn: 0.0,
        };
        let found = search(&task, cancel, |node, index, heading, metres| {
            let next = node + super::lattice::STENCIL[heading];
            let Some((cost, wet)) = cost_per_metre(samples.at(node)?, samples.at(next)?, metres, t) else {
                return Ok(None);
            };
            let control = f64::from(repel[index] + repel[window.index(next)]) / 2.0;
            let off = ((next - from).perp_dot(to - from) as f64 * step as f64 / across / 1000.0).abs();
            Ok(Some((metres * (cost + control + OFF_BEELINE * off), wet)))
        })?;
        // Roads are not bound to the headings of the stencil: on open ground the cost is the beeline.
        Ok(found.map_or(Pair { cost: f64::INFINITY, nodes: Vec::new() }, |f| Pair {
            cost: f.cost * length / line,
            nodes: f.nodes,
        }))
    })
}

/// Control term h of the settlements of the road's class or above that it does not serve: kernels around them (Galin
/// 2011, section 4.1). Smaller ones are passed on the fine lattice, where all outlines are closed.
fn repulsion(
    work: &Work,
    t: &TierSettings,
    tier: SizeClass,
    ends: [&Settlement; 2],
    window: &Window,
    step: i64,
) -> Result<Vec<f32>, LayerError> {
    let mut out = vec![0f32; window.len()];
    let bounds = Bounds::new(node_at(window.min, step), node_at(window.min + window.size - 1, step));
    for s in work.places.of_tier(bounds.grown(MOST_REPEL), tier)? {
        if ends.iter().any(|e| e.id == s.id) {
            continue;
        }
        let radius = (1.6 * s.radius + 200.0).min(MOST_REPEL);
        let centre = s.centre.plan();
        let part = Window::around(Bounds::square(centre, 2.0 * radius), step);
        for i in 0..part.len() {
            let node = part.node(i);
            if window.contains(node) {
                let h = t.settlement * kernel(node_at(node, step).distance(centre), radius);
                out[window.index(node)] += h as f32;
            }
        }
    }
    Ok(out)
}

/// Whether `c` lies in the empty region of a pair at distance `ab`: Galin 2011, section 5.1, with the inequality turned
/// so that an edge is kept when no such settlement exists.
fn rules_out(ac: f64, bc: f64, ab: f64, gamma: f64) -> bool {
    ac < ab && bc < ab && math::pow(ac / ab, gamma) + math::pow(bc / ab, gamma) < 1.0
}

/// Whether a pair is not worth a search: see [`HOPELESS`].
pub(super) fn hopeless(t: &TierSettings, a: &Settlement, b: &Settlement, others: &[Arc<Settlement>]) -> bool {
    let ab = beeline(a, b) * HOPELESS;
    others.iter().any(|c| {
        c.id != a.id && c.id != b.id && {
            let (ac, bc) = (beeline(a, c), beeline(b, c));
            ac < ab && bc < ab && rules_out(ac, bc, ab, t.gamma)
        }
    })
}

/// Whether the proximity rule keeps a pair. `others` holds every settlement of the pair's class or above within reach of
/// both ends; it may hold more.
pub(super) fn kept(
    work: &Work,
    a: &Settlement,
    b: &Settlement,
    others: &[Arc<Settlement>],
    cancel: &Cancel,
) -> Result<bool, LayerError> {
    let tier = tier_of(a, b);
    let t = work.settings.tier(tier);
    let ab = pair(work, tier, a, b, cancel)?.cost;
    if !ab.is_finite() {
        return Ok(false);
    }
    // A cost is at least the beeline, so only these can rule the pair out; the most likely first.
    let mut near: Vec<(f64, &Arc<Settlement>)> = Vec::new();
    for c in others {
        let (ac, bc) = (beeline(a, c), beeline(b, c));
        if c.id != a.id && c.id != b.id && ac.max(bc) <= t.reach && rules_out(ac, bc, ab, t.gamma) {
            near.push((ac + bc, c));
        }
    }
    near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.id.cmp(&y.1.id)));
    for (_, c) in near {
        let ac = pair(work, tier, a, c, cancel)?.cost;
        if ac < ab && rules_out(ac, pair(work, tier, b, c, cancel)?.cost, ab, t.gamma) {
            return Ok(false);
        }
    }
    Ok(true)
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

    #[test]
    fn the_box_of_an_ellipse_holds_its_points() {
        let (a, b, sum) = (DVec2::new(3.0, 1.0), DVec2::new(11.0, 7.0), 13.0);
        let bounds = ellipse_bounds(a, b, sum);
        let mut most = Bounds::EMPTY;
        for x in -100..300 {
            for y in -100..300 {
                let p = DVec2::new(f64::from(x), f64::from(y)) / 10.0;
                if p.distance(a) + p.distance(b) <= sum {
                    assert!(bounds.contains(p));
                    most = most.union(Bounds::of([p]));
                }
            }
        }
        assert!((most.size() - bounds.size()).abs().max_element() < 0.3);
    }
}
