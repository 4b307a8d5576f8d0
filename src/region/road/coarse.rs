//! The ground of a pair on the coarse lattice.

use super::cost::cost_over_water;
use super::inputs::{Inputs, Way};
use super::lattice::{node_at, stencil_distance};
use super::padding::REPULSION;
use super::repulsion::{repulsion, repulsion_radius};
use super::samples::Samples;
use super::tier_settings::TierSettings;
use super::window::Window;
use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::region::settlement::Settlement;
use crate::space::Bounds;
use glam::{DVec2, I64Vec2};

/// The ground within the ellipse of a pair: the points whose distances to both centres sum to no more than the longest road
/// that is built.
pub(super) struct CoarseGround<'a> {
    pub window: Window,
    /// Least cost per metre of any edge.
    pub least_cost: f64,
    t: &'a TierSettings,
    step: i64,
    samples: Samples<'a>,
    /// Extra cost per metre, by node of the window.
    extra: Vec<f32>,
    /// The foci, and the greatest sum of distances from them, in metres.
    ellipse: ([DVec2; 2], f64),
}

/// Box around the points whose distances from `a` and `b` sum to at most `sum`.
fn ellipse_bounds(a: DVec2, b: DVec2, sum: f64) -> Bounds {
    let (middle, half) = ((a + b) / 2.0, (b - a) / 2.0);
    let long = (sum / 2.0).max(half.length());
    let short2 = long * long - half.length_squared();
    let u = half.normalize_or(DVec2::X);
    let extent = |along: f64, across: f64| (long * long * along * along + short2 * across * across).sqrt();
    let size = DVec2::new(extent(u.x, u.y), extent(u.y, u.x));
    Bounds::new(middle - size, middle + size)
}

impl<'a> CoarseGround<'a> {
    /// The ground of a pair whose centres are at two nodes of the lattice of spacing `step`.
    pub fn new(
        inputs: &'a Inputs,
        (tier, way): (SizeClass, Way),
        pair: [&Settlement; 2],
        nodes: [I64Vec2; 2],
        step: i64,
    ) -> Result<Self, LayerError> {
        let t = inputs.tier_for(tier, way);
        let foci = nodes.map(|n| node_at(n, step));
        let limit = t.detour * (stencil_distance(nodes[1] - nodes[0]) * step as f64);
        let bounds = ellipse_bounds(foci[0], foci[1], limit);
        let window = inputs.window(bounds, step);
        let terms = inputs.influences.terms(tier, bounds);
        let mut extra = window_repulsion(inputs, tier, pair, &window, step)?;
        if !terms.is_empty() {
            extra.iter_mut().zip(window.nodes()).for_each(|(e, node)| *e += terms.at(node_at(node, step)) as f32);
        }
        let samples = inputs.samples(&window, step);
        Ok(Self { window, least_cost: terms.least_cost(), t, step, samples, extra, ellipse: (foci, limit) })
    }

    /// Whether a node lies in the ellipse.
    pub fn holds(&self, node: I64Vec2) -> bool {
        let (p, (foci, most)) = (node_at(node, self.step), self.ellipse);
        p.distance(foci[0]) + p.distance(foci[1]) <= most
    }

    /// Cost of an edge, with `more` per metre added, and the share of it that is a bridge. `None` where no road may run.
    pub fn edge(
        &mut self,
        (node, index): (I64Vec2, usize),
        next: I64Vec2,
        metres: f64,
        more: f64,
    ) -> Result<Option<(f64, f64)>, LayerError> {
        // Where every edge costs at least its length, the limit on the cost alone keeps paths in the ellipse.
        if self.least_cost < 1.0 && !self.holds(next) {
            return Ok(None);
        }
        let Some((cost, wet)) = cost_over_water(self.samples.at(node)?, self.samples.at(next)?, metres, self.t) else {
            return Ok(None);
        };
        let control = f64::from(self.extra[index] + self.extra[self.window.index(next)]) / 2.0;
        Ok(Some((metres * (cost + control + more).max(self.least_cost), wet)))
    }
}

/// Repulsion at the nodes of a window by the settlements of the road's tier or above that it does not serve. Smaller
/// settlements are avoided on the fine lattice, where all outlines are closed.
fn window_repulsion(
    inputs: &Inputs,
    tier: SizeClass,
    ends: [&Settlement; 2],
    window: &Window,
    step: i64,
) -> Result<Vec<f32>, LayerError> {
    let t = inputs.tier(tier);
    let mut out = vec![0f32; window.len()];
    let bounds = Bounds::new(node_at(window.min, step), node_at(window.min + window.size - 1, step));
    let near = inputs.pair_reach(tier, ends, t.corridor).check(bounds.grown(REPULSION))?;
    for s in inputs.settlements.overlapping_of(near, tier)? {
        if repulsion_radius(&s) == 0.0 || ends.iter().any(|e| e.id == s.id) {
            continue;
        }
        let part = Window::around(Bounds::square(s.centre.plan(), 2.0 * repulsion_radius(&s)), step);
        for node in part.nodes() {
            if window.contains(node) {
                out[window.index(node)] += repulsion(t, &s, node_at(node, step)) as f32;
            }
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

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
