//! Distances between settlements over the ground: first a path on the coarse lattice, then the geodesic on the fine lattice in
//! a corridor around that path.

use super::budget::Budget;
use super::coarse::CoarseGround;
use super::field::{Corridor, Field};
use super::geodesic::{Stop, geodesic};
use super::inputs::{Inputs, Way};
use super::landmass::Landmasses;
use super::lattice::{STENCIL, node_at, node_near, stencil_distance};
use super::padding::REPULSION;
use super::repulsion::{repulsion, repulsion_radius};
use super::search::{Query, search};
use super::tier::beeline;
use crate::layer::{Cancel, LayerCache, LayerError, Reach, Weigh};
use crate::network::SizeClass;
use crate::region::settlement::{Settlement, SettlementId};
use crate::space::Bounds;
use glam::{DVec2, I64Vec2};
use std::sync::{Arc, OnceLock};

/// Extra cost per metre, for each kilometre off the beeline: of paths that cost the same, the straightest is taken.
const OFF_BEELINE: f64 = 0.01;

/// The cheapest path between two settlements on the coarse lattice.
#[derive(Clone, Debug)]
pub(super) struct CoarsePath {
    /// Cost in metres of flat open ground, infinite where there is no path.
    pub cost: f64,
    /// The path in plan metres, its bends evened out. Empty where there is no path.
    pub line: Vec<DVec2>,
}

impl CoarsePath {
    /// No path.
    const NONE: Self = Self { cost: f64::INFINITY, line: Vec::new() };
}

impl Weigh for CoarsePath {
    fn bytes(&self) -> usize {
        size_of::<Self>() + self.line.len() * size_of::<DVec2>()
    }
}

/// A distance over the ground, in metres of flat open ground.
struct Distance(f64);

impl Weigh for Distance {
    fn bytes(&self) -> usize {
        size_of::<Self>() + 16
    }
}

/// Key of a pair: the tier of the roads, and both ids, the lower one first.
type PairKey = (u8, SettlementId, SettlementId);

/// Paths and distances of pairs, remembered.
pub(super) struct Distances {
    inputs: Arc<Inputs>,
    coarse: LayerCache<PairKey, CoarsePath>,
    /// Paths that are found only for settlements that would get no road.
    costlier: LayerCache<PairKey, CoarsePath>,
    fine: LayerCache<PairKey, Distance>,
    /// In a finite domain: the landmasses of each tier, made when the first search fails.
    landmasses: [OnceLock<Landmasses>; 3],
}

/// A pair in the order of its ids.
fn ordered<'a>(a: &'a Settlement, b: &'a Settlement) -> [&'a Settlement; 2] {
    if a.id < b.id { [a, b] } else { [b, a] }
}

impl Distances {
    pub fn new(inputs: Arc<Inputs>, budget: Budget) -> Self {
        let (coarse, costlier, fine) = (budget.cache(3), budget.cache(1), budget.cache(1));
        Self { inputs, coarse, costlier, fine, landmasses: Default::default() }
    }

    /// Whether it is known that no road of a tier can lead from one node of the coarse lattice to another.
    fn are_separate(&self, tier: SizeClass, from: I64Vec2, to: I64Vec2) -> bool {
        self.landmasses[tier as usize].get().is_some_and(|l| !l.may_join(from, to))
    }

    /// Makes the landmasses of a tier in a finite domain, if there are none yet.
    fn make_landmasses(&self, tier: SizeClass) -> Result<(), LayerError> {
        let held = &self.landmasses[tier as usize];
        if let (Some(domain), None) = (self.inputs.domain, held.get()) {
            let t = self.inputs.tier(tier);
            let made = Landmasses::new(&self.inputs, domain.0, t, self.inputs.step() * t.coarse_step)?;
            // Another thread may have been faster; its landmasses are the same.
            held.get_or_init(|| made);
        }
        Ok(())
    }

    /// The cheapest path between two settlements on the coarse lattice, for roads of class `tier`. The order of the settlements
    /// does not matter. The costlier way is for a settlement that would get no road: any cost will do.
    pub fn coarse_path(
        &self,
        (tier, way): (SizeClass, Way),
        a: &Settlement,
        b: &Settlement,
        cancel: &Cancel,
    ) -> Result<Arc<CoarsePath>, LayerError> {
        let [a, b] = ordered(a, b);
        let held = if way == Way::Usual { &self.coarse } else { &self.costlier };
        held.get(&(tier as u8, a.id, b.id), || {
            cancel.check()?;
            let inputs = &*self.inputs;
            let t = inputs.tier_for(tier, way);
            let step = inputs.step() * t.coarse_step;
            let length = beeline(a, b);
            let (from, to) = (inputs.centre_node(a, step), inputs.centre_node(b, step));
            let shortest = stencil_distance(to - from) * step as f64;
            if from == to {
                return Ok(CoarsePath { cost: length, line: smooth_line([a, b], &[from], step) });
            }
            if way == Way::Usual && self.are_separate(tier, from, to) {
                return Ok(CoarsePath::NONE);
            }
            let across = (to - from).as_dvec2().length();
            let limit = if way == Way::Usual { t.detour * shortest } else { f64::INFINITY };
            let mut ground = CoarseGround::new(inputs, (tier, way), [a, b], [from, to], step)?;
            let bridge_limit = t.bridge_limit + step as f64;
            let (window, least) = (ground.window, ground.least_cost);
            let query = Query { window, step, from, to, limit, bridge_limit, least };
            let found = search(&query, cancel, |node, index, heading, metres| {
                let next = node + STENCIL[heading];
                if way == Way::Costlier && !ground.holds(next) {
                    return Ok(None);
                }
                let off = ((next - from).perp_dot(to - from) as f64 * step as f64 / across / 1000.0).abs();
                ground.edge((node, index), next, metres, OFF_BEELINE * off)
            })?;
            let Some(found) = found else {
                if way == Way::Usual {
                    self.make_landmasses(tier)?;
                }
                return Ok(CoarsePath::NONE);
            };
            // Roads are not bound to the headings of the stencil: on open ground the cost is the beeline.
            Ok(CoarsePath { cost: found.cost * length / shortest, line: smooth_line([a, b], &found.nodes, step) })
        })
    }

    /// Distance d(a, b) of two settlements over the ground, in metres of flat open ground; infinite where there is no path. It
    /// is the cost of the geodesic between the centres on the fine lattice, within the corridor around the coarse path,
    /// without existing roads and gates.
    pub fn distance(
        &self,
        tier: SizeClass,
        a: &Settlement,
        b: &Settlement,
        cancel: &Cancel,
    ) -> Result<f64, LayerError> {
        let [a, b] = ordered(a, b);
        let found = self.fine.get(&(tier as u8, a.id, b.id), || {
            let coarse = self.coarse_path((tier, Way::Usual), a, b, cancel)?;
            if !coarse.cost.is_finite() {
                return Ok(Distance(f64::INFINITY));
            }
            let inputs = &*self.inputs;
            let corridor = Corridor::around(&coarse.line, inputs.tier(tier).corridor, inputs.step(), inputs.range());
            geodesic_cost(inputs, tier, [a, b], corridor, cancel).map(Distance)
        })?;
        Ok(found.0)
    }

    /// The path that the corridor of a pair follows: on the coarse lattice, or through the points that the user gave, unless the
    /// ground lets no road through there.
    pub fn corridor_path(
        &self,
        tier: SizeClass,
        a: &Settlement,
        b: &Settlement,
        cancel: &Cancel,
    ) -> Result<Arc<CoarsePath>, LayerError> {
        let [a, b] = ordered(a, b);
        let via = self.inputs.wishes.via(a, b);
        if !via.is_empty()
            && let Some(path) = coarse_path_via(&self.inputs, tier, [a, b], via, cancel)?
        {
            return Ok(Arc::new(path));
        }
        self.coarse_path((tier, Way::Usual), a, b, cancel)
    }

    /// The line of that path. `None` where there is no path at all.
    pub fn corridor_line(
        &self,
        tier: SizeClass,
        a: &Settlement,
        b: &Settlement,
        cancel: &Cancel,
    ) -> Result<Option<Vec<DVec2>>, LayerError> {
        let path = self.corridor_path(tier, a, b, cancel)?;
        Ok(path.cost.is_finite().then(|| path.line.clone()))
    }
}

/// The path through points, leg by leg, within the ellipse of the pair. Its cost has no limit, because the user wants it.
fn coarse_path_via(
    inputs: &Inputs,
    tier: SizeClass,
    [a, b]: [&Settlement; 2],
    via: &[DVec2],
    cancel: &Cancel,
) -> Result<Option<CoarsePath>, LayerError> {
    let t = inputs.tier(tier);
    let step = inputs.step() * t.coarse_step;
    let ends = [a, b].map(|s| inputs.centre_node(s, step));
    let mut ground = CoarseGround::new(inputs, (tier, Way::Usual), [a, b], ends, step)?;
    let (window, least) = (ground.window, ground.least_cost);
    let bridge_limit = t.bridge_limit + step as f64;
    let stops: Vec<DVec2> = [a.centre.plan()].into_iter().chain(via.iter().copied()).chain([b.centre.plan()]).collect();
    let mut out = CoarsePath { cost: 0.0, line: vec![stops[0]] };
    for leg in stops.windows(2) {
        let [from, to] = [leg[0], leg[1]].map(|p| node_near(p, step));
        let mut line = vec![leg[0]];
        let length = leg[0].distance(leg[1]);
        let mut cost = length;
        if from != to {
            let query = Query { window, step, from, to, limit: f64::INFINITY, bridge_limit, least };
            let found = search(&query, cancel, |node, index, heading, metres| {
                let next = node + STENCIL[heading];
                if ground.holds(next) { ground.edge((node, index), next, metres, 0.0) } else { Ok(None) }
            })?;
            let Some(found) = found else { return Ok(None) };
            cost = found.cost * length / (stencil_distance(to - from) * step as f64);
            let last = found.nodes.len() - 1;
            line.extend(found.nodes[1..last.max(1)].iter().map(|n| node_at(*n, step)));
        }
        line.push(leg[1]);
        smooth(&mut line);
        out.cost += cost;
        out.line.extend(&line[1..]);
    }
    Ok(Some(out))
}

/// The line between two settlements along nodes of the lattice of spacing `step`, its bends evened out.
fn smooth_line([a, b]: [&Settlement; 2], nodes: &[I64Vec2], step: i64) -> Vec<DVec2> {
    let mut out = vec![a.centre.plan()];
    // The first and the last node are the centres themselves, rounded.
    let inner = nodes.len().saturating_sub(1).max(1);
    out.extend(nodes[1.min(nodes.len())..inner.min(nodes.len())].iter().map(|n| node_at(*n, step)));
    out.push(b.centre.plan());
    smooth(&mut out);
    out
}

/// Evens out the bends of a line. Its ends stay.
fn smooth(line: &mut [DVec2]) {
    for _ in 0..6 {
        let before = line.to_vec();
        for (p, w) in line[1..].iter_mut().zip(before.windows(3)) {
            *p = (w[0] + w[1] * 2.0 + w[2]) / 4.0;
        }
    }
}

/// Cost of the geodesic between the centres of two settlements within a corridor.
pub(super) fn geodesic_cost(
    inputs: &Inputs,
    tier: SizeClass,
    ends: [&Settlement; 2],
    corridor: Corridor,
    cancel: &Cancel,
) -> Result<f64, LayerError> {
    let step = inputs.step();
    let reach = inputs.pair_reach(tier, ends, inputs.tier(tier).corridor);
    let mut field = open_field(inputs, tier, ends, corridor, &reach)?;
    let [from, to] = ends.map(|s| inputs.centre_node(s, step));
    let shortest = stencil_distance(to - from) * step as f64;
    let length = beeline(ends[0], ends[1]);
    if from == to {
        return Ok(length);
    }
    let stops = [stops(&mut field, ends[0], from)?, stops(&mut field, ends[1], to)?];
    let found = geodesic(&mut field, &stops[0], &stops[1], cancel)?;
    // Roads are not bound to the headings of the stencil: on open ground the cost is the beeline.
    Ok(found.map_or(f64::INFINITY, |f| f.cost * length / shortest))
}

/// Where a path from a settlement begins: at the node of its centre, or all around it if that node is under water.
fn stops(field: &mut Field, s: &Settlement, centre: I64Vec2) -> Result<Vec<Stop>, LayerError> {
    let step = field.step();
    let stop = |node: I64Vec2, cost: f64| Stop { node, cost, beyond: DVec2::ZERO };
    if field.is_dry(centre)? {
        return Ok(vec![stop(centre, 0.0)]);
    }
    let mut out = Vec::new();
    let r = (s.radius / step as f64).ceil() as i64;
    for y in -r..=r {
        for x in -r..=r {
            let by = I64Vec2::new(x, y);
            let cost = node_at(by, step).length();
            if cost <= s.radius + step as f64 && field.is_dry(centre + by)? {
                out.push(stop(centre + by, cost));
            }
        }
    }
    Ok(out)
}

/// The ground between two settlements without roads and gates, but with the repulsion of other settlements within `reach`.
pub(super) fn open_field<'a>(
    inputs: &'a Inputs,
    tier: SizeClass,
    ends: [&Settlement; 2],
    corridor: Corridor,
    reach: &Reach,
) -> Result<Field<'a>, LayerError> {
    let t = inputs.tier(tier);
    let step = inputs.step();
    let near = Bounds::of(corridor.nodes.iter().map(|n| node_at(*n, step))).grown(REPULSION);
    let near = reach.check(near)?;
    let mut field = Field::new(corridor, t, step, &*inputs.terrain, |w| inputs.samples(w, step));
    for s in inputs.settlements.overlapping_of(near, tier)? {
        if repulsion_radius(&s) > 0.0 && ends.iter().all(|e| e.id != s.id) {
            field.add(|_, node| repulsion(t, &s, node_at(node, step)));
        }
    }
    field.add_influences(&inputs.influences, tier);
    Ok(field)
}
