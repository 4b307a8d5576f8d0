//! Distances between settlements over the ground, and the proximity rule that keeps some of their pairs.
//!
//! Coarse to fine: a way on the wide lattice first, then the geodesic on the fine one in a corridor around it.

use super::control::Wish;
use super::field::{Field, Strip};
use super::geodesic::{Stop, geodesic};
use super::lattice::{kernel, node_at, stencil_distance};
use super::search::{Task, Window, search};
use super::wide::{Wide, way};
use super::{TierSettings, Work};
use crate::layer::{Cancel, LayerError, Weigh};
use crate::network::SizeClass;
use crate::region::Settlement;
use crate::space::{Bounds, math};
use glam::{DVec2, I64Vec2};
use std::sync::Arc;

/// Pairs that a third settlement would rule out by beelines even if their road were this much shorter than the beeline
/// are not tried at all. Where a detour makes a road dearer than its beeline, that alone could never save them.
const HOPELESS: f64 = 0.87;
/// Extra cost per metre, a kilometre off the beeline: of ways that cost the same, the straightest is taken.
const OFF_BEELINE: f64 = 0.01;
/// Share by which ratios of distances on the wide lattice must differ to be taken as they are; most are off by less.
const DOUBT: f64 = 0.015;
/// Distance from its circle within which a settlement repels roads that do not serve it, in metres.
const REPEL: f64 = 500.0;

/// The cheapest way between two settlements on the wide lattice.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    /// Cost in metres of flat open ground, infinite where there is no way.
    pub cost: f64,
    /// The way on the wide lattice in plan metres, its bends evened out; empty where there is none.
    pub line: Vec<DVec2>,
}

/// A distance over the ground, in metres of flat open ground.
pub(super) struct Distance(pub f64);

/// Whether a pair is tried.
pub(super) struct Tried(bool);

impl Weigh for Tried {
    fn bytes(&self) -> usize {
        size_of::<Self>() + 16
    }
}

impl Weigh for Distance {
    fn bytes(&self) -> usize {
        size_of::<Self>() + 16
    }
}

impl Weigh for Pair {
    fn bytes(&self) -> usize {
        size_of::<Self>() + self.line.len() * size_of::<DVec2>()
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
pub(super) fn ellipse_bounds(a: DVec2, b: DVec2, sum: f64) -> Bounds {
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
            return Ok(Pair { cost: length, line: spine([a, b], &[from], step) });
        }
        let across = (to - from).as_dvec2().length();
        let limit = t.detour * line;
        let mut wide = Wide::new(work, tier, [a, b], [from, to], step)?;
        let bridge_limit = t.bridge_limit + step as f64;
        let task = Task { window: wide.window, step, from, to, limit, bridge_limit, least: wide.least };
        let found = search(&task, cancel, |node, index, heading, metres| {
            let next = node + super::lattice::STENCIL[heading];
            let off = ((next - from).perp_dot(to - from) as f64 * step as f64 / across / 1000.0).abs();
            wide.edge((node, index), next, metres, OFF_BEELINE * off)
        })?;
        // Roads are not bound to the headings of the stencil: on open ground the cost is the beeline.
        Ok(found.map_or(Pair { cost: f64::INFINITY, line: Vec::new() }, |f| Pair {
            cost: f.cost * length / line,
            line: spine([a, b], &f.nodes, step),
        }))
    })
}

/// The line between two settlements along nodes of the lattice of spacing `step`, its bends evened out.
fn spine([a, b]: [&Settlement; 2], nodes: &[I64Vec2], step: i64) -> Vec<DVec2> {
    let mut out = vec![a.centre.plan()];
    // The first and the last node are the centres themselves, rounded.
    let inner = nodes.len().saturating_sub(1).max(1);
    out.extend(nodes[1.min(nodes.len())..inner.min(nodes.len())].iter().map(|n| node_at(*n, step)));
    out.push(b.centre.plan());
    smooth(&mut out);
    out
}

/// Evens the bends of a line out; its ends stay.
pub(super) fn smooth(line: &mut [DVec2]) {
    for _ in 0..6 {
        let before = line.to_vec();
        for (p, w) in line[1..].iter_mut().zip(before.windows(3)) {
            *p = (w[0] + w[1] * 2.0 + w[2]) / 4.0;
        }
    }
}

/// Distance d(a, b) of two settlements over the ground in metres of flat open ground, infinite where there is no way: the
/// cost of the geodesic between their centres on the fine lattice, within the corridor around the way on the wide one,
/// without roads and gates.
pub(super) fn distance(
    work: &Work,
    tier: SizeClass,
    a: &Settlement,
    b: &Settlement,
    cancel: &Cancel,
) -> Result<f64, LayerError> {
    let (a, b) = if a.id < b.id { (a, b) } else { (b, a) };
    let found = work.distances.get(&(tier as u8, a.id, b.id), || {
        let t = work.settings.tier(tier);
        let wide = pair(work, tier, a, b, cancel)?;
        if !wide.cost.is_finite() {
            return Ok(Distance(f64::INFINITY));
        }
        over_ground(work, tier, [a, b], work.strip(&wide.line, t.corridor), cancel).map(Distance)
    })?;
    Ok(found.0)
}

/// Cost of the geodesic between two settlements' centres within a strip.
pub(super) fn over_ground(
    work: &Work,
    tier: SizeClass,
    ends: [&Settlement; 2],
    strip: Strip,
    cancel: &Cancel,
) -> Result<f64, LayerError> {
    let step = work.settings.step;
    let mut field = open_ground(work, tier, ends, strip)?;
    let [from, to] = ends.map(|s| work.centre_node(s, step));
    let line = stencil_distance(to - from) * step as f64;
    let length = beeline(ends[0], ends[1]);
    if from == to {
        return Ok(length);
    }
    let stops = [stops(&mut field, ends[0], from)?, stops(&mut field, ends[1], to)?];
    let found = geodesic(&mut field, &stops[0], &stops[1], cancel)?;
    // Roads are not bound to the headings of the stencil: on open ground the cost is the beeline.
    Ok(found.map_or(f64::INFINITY, |f| f.cost * length / line))
}

/// Where a way from a settlement begins: at the node of its centre, or all around it if that is under water.
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

/// The ground between two settlements without roads and gates, but with the settlements that a road would keep off.
pub(super) fn open_ground<'a>(
    work: &'a Work,
    tier: SizeClass,
    ends: [&Settlement; 2],
    strip: Strip,
) -> Result<Field<'a>, LayerError> {
    let t = work.settings.tier(tier);
    let step = work.settings.step;
    let near = Bounds::of(strip.nodes.iter().map(|n| node_at(*n, step))).grown(REPEL);
    let mut field = work.field(t, strip);
    let repelling = |s: &&Arc<Settlement>| repels(s) > 0.0 && ends.iter().all(|e| e.id != s.id);
    for s in work.places.overlapping_of(near, tier)?.iter().filter(repelling) {
        field.add(|_, node| repelled(t, s, node_at(node, step)));
    }
    work.control.influence(tier, &mut field);
    Ok(field)
}

/// Extra cost per metre beside a settlement that a road does not serve.
fn repelled(t: &TierSettings, s: &Settlement, at: DVec2) -> f64 {
    t.settlement * kernel(at.distance(s.centre.plan()), repels(s))
}

/// Distance in metres at which a settlement repels; 0 for a way point, which roads may pass.
fn repels(s: &Settlement) -> f64 {
    if s.radius > 0.0 { s.radius + REPEL } else { 0.0 }
}

/// Control term h of the settlements of the road's class or above that it does not serve: kernels around them (Galin
/// 2011, section 4.1). Smaller ones are passed on the fine lattice, where all outlines are closed.
pub(super) fn repulsion(
    work: &Work,
    t: &TierSettings,
    tier: SizeClass,
    ends: [&Settlement; 2],
    window: &Window,
    step: i64,
) -> Result<Vec<f32>, LayerError> {
    let mut out = vec![0f32; window.len()];
    let bounds = Bounds::new(node_at(window.min, step), node_at(window.min + window.size - 1, step));
    for s in work.places.overlapping_of(bounds.grown(REPEL), tier)? {
        if repels(&s) == 0.0 || ends.iter().any(|e| e.id == s.id) {
            continue;
        }
        let part = Window::around(Bounds::square(s.centre.plan(), 2.0 * repels(&s)), step);
        for node in part.nodes() {
            if window.contains(node) {
                out[window.index(node)] += repelled(t, &s, node_at(node, step)) as f32;
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

/// Settlements of a pair's class or above nearer than `most` to both of its ends, as the beeline goes; there may be more.
fn within(work: &Work, a: &Settlement, b: &Settlement, most: f64) -> Result<Vec<Arc<Settlement>>, LayerError> {
    let [near_a, near_b] = [a, b].map(|s| Bounds::square(s.centre.plan(), 2.0 * most));
    let both = Bounds::new(near_a.min.max(near_b.min), near_a.max.min(near_b.max));
    work.places.of_tier(both, tier_of(a, b))
}

/// Whether a pair is worth a search: whether no settlement makes it [`hopeless`]. `known` are some settlements, to begin with.
pub(super) fn is_tried(
    work: &Work,
    a: &Settlement,
    b: &Settlement,
    known: &[Arc<Settlement>],
) -> Result<bool, LayerError> {
    let found = work.tried.get(&(a.id.min(b.id), a.id.max(b.id)), || {
        let t = work.settings.tier(tier_of(a, b));
        let tried = work.control.wants(a, b)
            || !(hopeless(t, a, b, known) || hopeless(t, a, b, &within(work, a, b, HOPELESS * beeline(a, b))?));
        Ok(Tried(tried))
    })?;
    Ok(found.0)
}

/// Whether the proximity rule keeps a pair.
///
/// The rule is about distances over the ground. Those on the wide lattice are close to them: they decide where they leave
/// no doubt, and only the others are measured on the fine one.
pub(super) fn kept(work: &Work, a: &Settlement, b: &Settlement, cancel: &Cancel) -> Result<bool, LayerError> {
    let tier = tier_of(a, b);
    let t = work.settings.tier(tier);
    let wide = |a: &Settlement, b: &Settlement| Ok::<f64, LayerError>(pair(work, tier, a, b, cancel)?.cost);
    match work.control.wish(a, b) {
        Some(Wish::Ban) => return Ok(false),
        Some(Wish::Keep | Wish::Via(_)) => return Ok(way(work, tier, a, b, cancel)?.is_some()),
        None => {}
    }
    let ab = wide(a, b)?;
    if !ab.is_finite() {
        return Ok(false);
    }
    // All that lies in the ellipse of a pair with one of these ends.
    let ends = Bounds::of([a.centre.plan(), b.centre.plan()]);
    let around = ends.grown(2.0 * t.padding(work.settings.step));
    let least = work.control.terms(tier, around).least();
    // A cost is at least the beeline, or that share of it, so only these can rule the pair out; the most likely first.
    let others = within(work, a, b, t.reach.min(ab * (1.0 + DOUBT) / least))?;
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
    near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.id.cmp(&y.1.id)));
    let (least, most) = (ab * (1.0 - DOUBT), ab * (1.0 + DOUBT));
    let mut doubtful = Vec::new();
    for (_, c) in near {
        let ac = wide(a, c)?;
        let bc = if ac < most { wide(b, c)? } else { continue };
        if rules_out(ac, bc, least, t.gamma) {
            return Ok(false);
        }
        if rules_out(ac, bc, most, t.gamma) {
            doubtful.push(c);
        }
    }
    for c in doubtful {
        let fine = |a: &Settlement, b: &Settlement| distance(work, tier, a, b, cancel);
        if rules_out(fine(a, c)?, fine(b, c)?, fine(a, b)?, t.gamma) {
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
