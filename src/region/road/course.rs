//! Courses of the roads that are kept, on the fine lattice: from gate to gate, along roads of higher classes where that
//! is cheaper.

use super::lattice::{STENCIL, Samples, cost_per_metre, heading, kernel, node_at};
use super::pairs::{Pair, beeline, hopeless, kept, pair, tier_of};
use super::search::{Task, Window, search};
use super::site::{SITE_STEPS, gate_in_plan};
use super::{TierSettings, Work, class_of};
use crate::layer::{Cancel, LayerError, Reach, Weigh};
use crate::network::{StreetClass, StreetId};
use crate::region::{Settlement, SettlementId, SizeClass};
use crate::space::{Bounds, Origin, segments};
use glam::{DVec2, I64Vec2};
use std::sync::Arc;

/// Distance in metres from an existing road within which new ones are kept off.
const BESIDE: f64 = 420.0;
/// Length in metres of the stretches in which a course looks for what lies along it.
const STRETCH: f64 = 3_000.0;
/// Extra cost per metre, a kilometre off the way found on the wide lattice: of ways that cost the same it takes the one
/// that heads for its aim all along.
const OFF_SPINE: f64 = 0.12;

/// One end of a course.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct End {
    pub settlement: SettlementId,
    pub centre: Origin,
    /// Vertex of the outline.
    pub vertex: usize,
    /// Position of the gate, local to the settlement.
    pub gate: DVec2,
}

/// The course of a kept pair.
#[derive(Clone, Debug)]
pub(super) struct Course {
    pub id: StreetId,
    pub class: StreetClass,
    /// At the first node, and at the last. The first has the lower id.
    pub ends: [End; 2],
    /// Nodes of the fine lattice, each joined to the next by an edge of the stencil.
    pub nodes: Vec<I64Vec2>,
    /// Cost of the pair in metres of flat open ground.
    pub cost: f64,
    /// Box in plan metres, gates included.
    pub bounds: Bounds,
}

/// A course, if the land lets one through.
pub(super) struct Found(pub Option<Arc<Course>>);

/// Courses that pass through a tile.
pub(super) struct Listed(pub Vec<Arc<Course>>);

impl Weigh for Found {
    fn bytes(&self) -> usize {
        self.0.as_ref().map_or(0, |c| size_of::<Course>() + c.nodes.len() * size_of::<I64Vec2>()) + 16
    }
}

impl Weigh for Listed {
    fn bytes(&self) -> usize {
        // The courses themselves live as long as a tile names them.
        self.0.iter().map(|c| 8 + size_of::<Course>() + c.nodes.len() * size_of::<I64Vec2>()).sum::<usize>() + 24
    }
}

impl Course {
    /// Whether any segment's box overlaps `bounds` (plan metres).
    fn passes(&self, bounds: Bounds, step: i64) -> bool {
        self.bounds.overlaps(bounds) && segments(&self.line(step)).any(|(a, b)| Bounds::of([a, b]).overlaps(bounds))
    }

    /// The whole way in plan metres, gates included.
    pub fn line(&self, step: i64) -> Vec<DVec2> {
        let mut out = vec![self.ends[0].centre.to_plan(self.ends[0].gate)];
        out.extend(self.nodes.iter().map(|n| node_at(*n, step)));
        out.push(self.ends[1].centre.to_plan(self.ends[1].gate));
        out
    }
}

/// Edge of the tiles by which courses are listed, in metres.
const LISTED_BY: f64 = 4_096.0;

/// Courses of one class that pass through `bounds` (plan metres), sorted by id.
pub(super) fn courses(
    work: &Work,
    tier: SizeClass,
    bounds: Bounds,
    cancel: &Cancel,
) -> Result<Vec<Arc<Course>>, LayerError> {
    if let Some(finite) = &work.finite {
        let found = finite.courses(tier).iter().filter(|c| c.passes(bounds, work.settings.step));
        return Ok(found.cloned().collect());
    }
    let size = LISTED_BY;
    let (min, max) = ((bounds.min / size).floor().as_i64vec2(), (bounds.max / size).floor().as_i64vec2());
    let mut out: Vec<Arc<Course>> = Vec::new();
    for y in min.y..=max.y {
        for x in min.x..=max.x {
            let listed = work.listed.get(&(tier as u8, x, y), || {
                let corner = DVec2::new(x as f64, y as f64) * size;
                list(work, tier, Bounds::new(corner, corner + size), cancel).map(Listed)
            })?;
            out.extend(listed.0.iter().filter(|c| c.passes(bounds, work.settings.step)).cloned());
        }
    }
    out.sort_by_key(|c| c.id);
    out.dedup_by_key(|c| c.id);
    Ok(out)
}

/// Distance from a point to a box, 0 inside.
fn distance_to_box(p: DVec2, b: Bounds) -> f64 {
    (b.min - p).max(p - b.max).max(DVec2::ZERO).length()
}

fn list(work: &Work, tier: SizeClass, tile: Bounds, cancel: &Cancel) -> Result<Vec<Arc<Course>>, LayerError> {
    let t = work.settings.tier(tier);
    let step = work.settings.step;
    let padding = t.padding(step);
    let reach = Reach::new("roads", tile, padding + t.reach);
    let all = work.places.of_tier(reach.check(tile.grown(padding + t.reach))?, tier)?;
    let near: Vec<bool> = all.iter().map(|s| distance_to_box(s.centre.plan(), tile) <= padding).collect();
    let mut out = Vec::new();
    for (i, a) in all.iter().enumerate() {
        for (j, b) in all.iter().enumerate().skip(i + 1) {
            let length = beeline(a, b);
            let sum = distance_to_box(a.centre.plan(), tile) + distance_to_box(b.centre.plan(), tile);
            // At least one end is near every point of the road, and no point is off both ends by more than the detour.
            let apart = sum > 1.03 * t.detour * (length + 2.0 * (step * t.wide_step) as f64) + 2.0 * t.corridor;
            if tier_of(a, b) != tier || length > t.reach || !(near[i] || near[j]) || apart || hopeless(t, a, b, &all) {
                continue;
            }
            let wide = pair(work, tier, a, b, cancel)?;
            let room = tile.grown(t.corridor + 2.0 * step as f64);
            let passes = segments(&spine(work, t, a, b, &wide)).any(|(p, q)| Bounds::of([p, q]).overlaps(room));
            if wide.cost.is_finite() && passes && kept(work, a, b, &all, cancel)? {
                out.extend(course(work, a, b, cancel)?.filter(|c| c.passes(tile, step)));
            }
        }
    }
    Ok(out)
}

/// Courses of one class that begin or end at a settlement, sorted by id.
pub(super) fn courses_of(
    work: &Work,
    tier: SizeClass,
    s: &Settlement,
    cancel: &Cancel,
) -> Result<Vec<Arc<Course>>, LayerError> {
    let t = work.settings.tier(tier);
    let own = Bounds::of([s.centre.plan()]);
    let reach = Reach::new("roads", own, 2.0 * t.reach);
    let all = work.places.of_tier(reach.check(own.grown(2.0 * t.reach))?, tier)?;
    let mut out = Vec::new();
    for other in &all {
        let candidate = other.id != s.id && tier_of(s, other) == tier && beeline(s, other) <= t.reach;
        if candidate && !hopeless(t, s, other, &all) && kept(work, s, other, &all, cancel)? {
            out.extend(course(work, s, other, cancel)?);
        }
    }
    out.sort_by_key(|c: &Arc<Course>| c.id);
    Ok(out)
}

/// The course between two settlements whose pair is kept.
fn course(work: &Work, a: &Settlement, b: &Settlement, cancel: &Cancel) -> Result<Option<Arc<Course>>, LayerError> {
    let (a, b) = if a.id < b.id { (a, b) } else { (b, a) };
    let found = work.courses.get(&(a.id, b.id), || Ok(Found(find(work, a, b, cancel)?.map(Arc::new))))?;
    Ok(found.0.clone())
}

pub(super) fn find(work: &Work, a: &Settlement, b: &Settlement, cancel: &Cancel) -> Result<Option<Course>, LayerError> {
    cancel.check()?;
    let tier = tier_of(a, b);
    let t = work.settings.tier(tier);
    let step = work.settings.step;
    let wide = pair(work, tier, a, b, cancel)?;
    let spine = spine(work, t, a, b, &wide);
    let bounds = Bounds::of(spine.iter().copied()).grown(t.corridor);
    let window = work.window(bounds, step);

    let off = corridor(&spine, &window, step, t.corridor);
    let (mut sites, mut roads) = (Vec::new(), Vec::new());
    for stretch in stretches(&spine) {
        let room = stretch.grown(t.corridor);
        sites.extend(work.places.overlapping(room.grown(SITE_STEPS * step as f64))?);
        for above in [SizeClass::City, SizeClass::Town] {
            if above > tier {
                roads.extend(courses(work, above, room, cancel)?);
            }
        }
    }
    sites.sort_by_key(|s| s.id);
    sites.dedup_by_key(|s| s.id);
    roads.sort_by_key(|c| c.id);
    roads.dedup_by_key(|c| c.id);
    let mut closed = vec![0u16; window.len()];
    for s in sites {
        let site = work.site(&s)?;
        for (i, bits) in site.closed.iter().enumerate().filter(|(_, bits)| **bits != 0) {
            let node = site.window.node(i);
            if window.contains(node) {
                closed[window.index(node)] |= bits;
            }
        }
    }
    let mut existing = vec![0u16; window.len()];
    let mut beside = vec![0f32; window.len()];
    for road in &roads {
        lay(&road.nodes, &window, step, &mut existing, &mut beside);
    }

    let (site_a, site_b) = (work.site(a)?, work.site(b)?);
    let from: Vec<_> = site_a.ties.iter().map(|t| (t.node, t.way)).collect();
    let to: Vec<_> = site_b.ties.iter().map(|t| (t.node, t.way)).collect();
    let mut samples = Samples::new(&work.samples, &*work.terrain, step, &window);
    let task = Task {
        window,
        step,
        from: &from,
        to: &to,
        goal: b.centre.plan(),
        limit: f64::INFINITY,
        bridge_limit: t.bridge_limit,
        turn: t.turn,
    };
    let found = search(&task, cancel, |node, index, heading, length| {
        let next = node + STENCIL[heading];
        let next_index = window.index(next);
        if off[next_index] > t.corridor as f32 || closed[index] >> heading & 1 == 1 {
            return Ok(None);
        }
        if existing[index] >> heading & 1 == 1 {
            return Ok(Some((length, 0.0)));
        }
        let ground = cost_per_metre(samples.at(node)?, samples.at(next)?, length, t);
        let control = t.building
            + t.beside * f64::from(beside[index] + beside[next_index]) / 2.0
            + OFF_SPINE * f64::from(off[next_index]) / 1000.0;
        Ok(ground.map(|(cost, wet)| (length * (cost + control), wet)))
    })?;
    let Some(found) = found else { return Ok(None) };
    let (tie_a, tie_b) = (&site_a.ties[found.from], &site_b.ties[found.to]);
    let end = |s: &Settlement, tie: &super::site::Tie| End {
        settlement: s.id,
        centre: s.centre,
        vertex: tie.vertex,
        gate: tie.gate,
    };
    let gates = [gate_in_plan(a, tie_a), gate_in_plan(b, tie_b)];
    Ok(Some(Course {
        id: StreetId::of(&[0x636f_7572_7365, a.id.0, b.id.0]),
        class: class_of(tier),
        ends: [end(a, tie_a), end(b, tie_b)],
        bounds: Bounds::of(found.nodes.iter().map(|n| node_at(*n, step)).chain(gates)),
        nodes: found.nodes,
        cost: wide.cost,
    }))
}

/// The way found on the wide lattice, its bends evened out.
fn spine(work: &Work, t: &TierSettings, a: &Settlement, b: &Settlement, wide: &Pair) -> Vec<DVec2> {
    let (a, b) = if a.id < b.id { (a, b) } else { (b, a) };
    let step = work.settings.step * t.wide_step;
    let mut out = vec![a.centre.plan()];
    // The first and the last node are the centres themselves, rounded.
    let inner = wide.nodes.len().saturating_sub(1).max(1);
    out.extend(wide.nodes[1.min(wide.nodes.len())..inner.min(wide.nodes.len())].iter().map(|n| node_at(*n, step)));
    out.push(b.centre.plan());
    for _ in 0..6 {
        let before = out.clone();
        for (p, w) in out[1..].iter_mut().zip(before.windows(3)) {
            *p = (w[0] + w[1] * 2.0 + w[2]) / 4.0;
        }
    }
    out
}

/// Boxes around the stretches of a line.
fn stretches(line: &[DVec2]) -> Vec<Bounds> {
    let mut out = Vec::new();
    let mut held = Bounds::EMPTY;
    for (a, b) in segments(line) {
        held = held.union(Bounds::of([a, b]));
        if held.size().max_element() > STRETCH {
            out.push(held);
            held = Bounds::EMPTY;
        }
    }
    out.push(held.union(Bounds::of(line.last().copied())));
    out
}

/// Distance of each node from the spine, infinite beyond `width`.
fn corridor(spine: &[DVec2], window: &Window, step: i64, width: f64) -> Vec<f32> {
    let mut off = vec![f32::INFINITY; window.len()];
    for (a, b) in segments(spine) {
        let part = Window::around(Bounds::of([a, b]).grown(width), step);
        for i in 0..part.len() {
            let node = part.node(i);
            if window.contains(node) {
                let distance = crate::space::distance_to_segment(node_at(node, step), a, b);
                if distance <= width {
                    let held = &mut off[window.index(node)];
                    *held = held.min(distance as f32);
                }
            }
        }
    }
    off
}

/// Marks the edges of an existing road, and how close the nodes around it are.
fn lay(nodes: &[I64Vec2], window: &Window, step: i64, existing: &mut [u16], beside: &mut [f32]) {
    for pair in nodes.windows(2) {
        let Some(h) = heading(pair[0], pair[1]) else { continue };
        for (node, h) in [(pair[0], h), (pair[1], (h + 8) % 16)] {
            if window.contains(node) {
                existing[window.index(node)] |= 1 << h;
            }
        }
        let r = (BESIDE / step as f64).ceil() as i64;
        for y in -r..=r {
            for x in -r..=r {
                let node = pair[1] + I64Vec2::new(x, y);
                let k = kernel(node_at(I64Vec2::new(x, y), step).length(), BESIDE) as f32;
                if window.contains(node) && k > 0.0 {
                    let held = &mut beside[window.index(node)];
                    *held = held.max(k);
                }
            }
        }
    }
}
