//! The wide lattice: what searches on it read, and the line there that the course of a pair follows.

use super::control::Terms;
use super::lattice::{STENCIL, Samples, cost_over_water, node_at, node_near, stencil_distance};
use super::pairs::{ellipse_bounds, pair, repulsion, smooth};
use super::search::{Task, Window, search};
use super::{TierSettings, Work};
use crate::layer::{Cancel, LayerError};
use crate::network::SizeClass;
use crate::region::Settlement;
use glam::{DVec2, I64Vec2};

/// The ground within the ellipse of a pair.
pub(super) struct Wide<'a> {
    pub window: Window,
    /// Least cost per metre.
    pub least: f64,
    t: &'a TierSettings,
    step: i64,
    samples: Samples<'a>,
    /// Extra cost per metre, by node of the window.
    extra: Vec<f32>,
    /// Centres, and the greatest sum of distances to them, in metres.
    ellipse: ([DVec2; 2], f64),
}

impl<'a> Wide<'a> {
    /// The ground of a pair, whose centres are at two nodes of spacing `step`.
    pub fn new(
        work: &'a Work,
        tier: SizeClass,
        pair: [&Settlement; 2],
        nodes: [I64Vec2; 2],
        step: i64,
    ) -> Result<Self, LayerError> {
        let t = work.settings.tier(tier);
        let foci = nodes.map(|n| node_at(n, step));
        let limit = t.detour * (stencil_distance(nodes[1] - nodes[0]) * step as f64);
        let bounds = ellipse_bounds(foci[0], foci[1], limit);
        let window = work.window(bounds, step);
        let terms: Terms = work.control.terms(tier, bounds);
        let mut extra = repulsion(work, t, tier, pair, &window, step)?;
        if !terms.is_empty() {
            extra.iter_mut().zip(window.nodes()).for_each(|(e, node)| *e += terms.at(node_at(node, step)) as f32);
        }
        let samples = Samples::new(&work.samples, &*work.terrain, step, &window);
        Ok(Self { window, least: terms.least(), t, step, samples, extra, ellipse: (foci, limit) })
    }

    fn holds(&self, node: I64Vec2) -> bool {
        let (p, (foci, most)) = (node_at(node, self.step), self.ellipse);
        p.distance(foci[0]) + p.distance(foci[1]) <= most
    }

    /// Cost of an edge with `more` per metre, and the share of it that is a bridge.
    pub fn edge(
        &mut self,
        (node, index): (I64Vec2, usize),
        next: I64Vec2,
        metres: f64,
        more: f64,
    ) -> Result<Option<(f64, f64)>, LayerError> {
        // Where no edge costs less than its length, the greatest cost alone keeps ways in the ellipse.
        if self.least < 1.0 && !self.holds(next) {
            return Ok(None);
        }
        let Some((cost, wet)) = cost_over_water(self.samples.at(node)?, self.samples.at(next)?, metres, self.t) else {
            return Ok(None);
        };
        let control = f64::from(self.extra[index] + self.extra[self.window.index(next)]) / 2.0;
        Ok(Some((metres * (cost + control + more).max(self.least), wet)))
    }
}

/// The line on the wide lattice that the course of a pair follows: the way found, or where the user leads the road through
/// points, the ways from each to the next; of the pair alone if there are none. `None` where there is no way at all.
pub(super) fn way(
    work: &Work,
    tier: SizeClass,
    a: &Settlement,
    b: &Settlement,
    cancel: &Cancel,
) -> Result<Option<Vec<DVec2>>, LayerError> {
    let (a, b) = if a.id < b.id { (a, b) } else { (b, a) };
    let via = work.control.via(a, b);
    if !via.is_empty()
        && let Some(led) = led(work, tier, [a, b], via, cancel)?
    {
        return Ok(Some(led));
    }
    let wide = pair(work, tier, a, b, cancel)?;
    Ok(wide.cost.is_finite().then(|| wide.line.clone()))
}

/// The line through points, within the ellipse of the pair. However dear it is, the user wants it.
fn led(
    work: &Work,
    tier: SizeClass,
    [a, b]: [&Settlement; 2],
    via: &[DVec2],
    cancel: &Cancel,
) -> Result<Option<Vec<DVec2>>, LayerError> {
    let t = work.settings.tier(tier);
    let step = work.settings.step * t.wide_step;
    let ends = [a, b].map(|s| work.centre_node(s, step));
    let mut wide = Wide::new(work, tier, [a, b], ends, step)?;
    let (window, least) = (wide.window, wide.least);
    let bridge_limit = t.bridge_limit + step as f64;
    let stops: Vec<DVec2> = [a.centre.plan()].into_iter().chain(via.iter().copied()).chain([b.centre.plan()]).collect();
    let mut out = vec![stops[0]];
    for leg in stops.windows(2) {
        let [from, to] = [leg[0], leg[1]].map(|p| node_near(p, step));
        let mut line = vec![leg[0]];
        if from != to {
            let task = Task { window, step, from, to, limit: f64::INFINITY, bridge_limit, least };
            let found = search(&task, cancel, |node, index, heading, metres| {
                let next = node + STENCIL[heading];
                if wide.holds(next) { wide.edge((node, index), next, metres, 0.0) } else { Ok(None) }
            })?;
            let Some(found) = found else { return Ok(None) };
            let last = found.nodes.len() - 1;
            line.extend(found.nodes[1..last.max(1)].iter().map(|n| node_at(*n, step)));
        }
        line.push(leg[1]);
        smooth(&mut line);
        out.extend(&line[1..]);
    }
    Ok(Some(out))
}
