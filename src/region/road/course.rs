//! Courses of the roads that are kept, on the fine lattice: from gate to gate, along roads of higher classes where that
//! is cheaper.

use super::field::{Field, Strip, roughness};
use super::geodesic::{Stop, geodesic};
use super::lattice::{kernel, node_at};
use super::led::through;
use super::pairs::{beeline, is_tried, kept, tier_of};
use super::site::{SITE_STEPS, Site, TIE_REACH, Tie, gate_in_plan};
use super::wide::way;
use super::{Work, class_of};
use crate::layer::{Cancel, LayerError, Reach, Weigh};
use crate::network::SizeClass;
use crate::network::{StreetClass, StreetId};
use crate::region::{Settlement, SettlementId};
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

/// What a road keeps off of the settlements that it does not serve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Beside {
    /// Discs around all that they might fill, and their ties.
    Discs,
    /// Outlines and ties as they are, which takes much more work.
    Outlines,
}

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

/// A bridge or a tunnel along a course: a straight line over or under what lies between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    /// Index of the node where it begins.
    pub first: usize,
    /// Index of the node where it ends.
    pub last: usize,
    pub tunnel: bool,
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
    /// Bridges and tunnels, in order.
    pub spans: Vec<Span>,
    /// Box in plan metres, gates included.
    pub bounds: Bounds,
}

/// A course, if the land lets one through.
pub(super) struct Found(pub Option<Arc<Course>>);

/// Two settlements whose road, if there is one, may pass through a tile: it keeps near the line.
struct Candidate {
    ends: [Arc<Settlement>; 2],
    /// The way on the wide lattice, in plan metres.
    line: Vec<DVec2>,
}

/// The roads that may pass through a tile.
pub(super) struct Listed(Vec<Candidate>);

impl Weigh for Found {
    fn bytes(&self) -> usize {
        self.0.as_ref().map_or(0, |c| c.bytes()) + 16
    }
}

impl Weigh for Listed {
    fn bytes(&self) -> usize {
        self.0.iter().map(|c| size_of::<Candidate>() + c.line.len() * size_of::<DVec2>()).sum::<usize>() + 24
    }
}

impl Candidate {
    /// Whether the road may come into `bounds` (plan metres).
    fn nears(&self, bounds: Bounds, work: &Work) -> bool {
        let t = work.settings.tier(tier_of(&self.ends[0], &self.ends[1]));
        let room = bounds.grown(t.corridor + 2.0 * work.settings.step as f64);
        segments(&self.line).any(|(p, q)| Bounds::of([p, q]).overlaps(room))
    }
}

impl Course {
    fn bytes(&self) -> usize {
        size_of::<Self>() + self.nodes.len() * size_of::<I64Vec2>() + self.spans.len() * size_of::<Span>()
    }

    /// Level of the edge after a node: 1 on a bridge, -1 in a tunnel.
    pub fn level(&self, edge: usize) -> i8 {
        let span = self.spans.iter().find(|s| (s.first..s.last).contains(&edge));
        span.map_or(0, |s| if s.tunnel { -1 } else { 1 })
    }

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
const LISTED_BY: f64 = 1_024.0;

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
    let (min, max) = ((bounds.min / LISTED_BY).floor().as_i64vec2(), (bounds.max / LISTED_BY).floor().as_i64vec2());
    let mut tiles = Vec::new();
    for y in min.y..=max.y {
        for x in min.x..=max.x {
            tiles.push(work.listed.get(&(tier as u8, x, y), || {
                let corner = DVec2::new(x as f64, y as f64) * LISTED_BY;
                list(work, tier, Bounds::new(corner, corner + LISTED_BY), cancel).map(Listed)
            })?);
        }
    }
    let mut candidates: Vec<&Candidate> = tiles.iter().flat_map(|t| &t.0).collect();
    candidates.sort_by_key(|c| [c.ends[0].id, c.ends[1].id]);
    candidates.dedup_by_key(|c| [c.ends[0].id, c.ends[1].id]);
    let mut out: Vec<Arc<Course>> = Vec::new();
    // A road is made only where it may come in.
    for c in candidates.into_iter().filter(|c| c.nears(bounds, work)) {
        let course = course(work, &c.ends[0], &c.ends[1], cancel)?;
        out.extend(course.filter(|c| c.passes(bounds, work.settings.step)));
    }
    out.sort_by_key(|c| c.id);
    Ok(out)
}

/// Distance from a point to a box, 0 inside.
fn distance_to_box(p: DVec2, b: Bounds) -> f64 {
    (b.min - p).max(p - b.max).max(DVec2::ZERO).length()
}

fn list(work: &Work, tier: SizeClass, tile: Bounds, cancel: &Cancel) -> Result<Vec<Candidate>, LayerError> {
    let t = work.settings.tier(tier);
    let step = work.settings.step;
    // Both ends of a road lie on an ellipse around each of its points, no more than the reach from each other.
    let sum = |length: f64| 1.03 * t.detour * (length + 2.0 * (step * t.wide_step) as f64) + 2.0 * t.corridor;
    let farthest = (sum(t.reach) + t.reach + tile.size().length()) / 2.0;
    let reach = Reach::new("roads", tile, farthest);
    let all = work.places.of_tier(reach.check(tile.grown(farthest))?, tier)?;
    let off: Vec<f64> = all.iter().map(|s| distance_to_box(s.centre.plan(), tile)).collect();
    let mut out = Vec::new();
    for (i, a) in all.iter().enumerate() {
        for (j, b) in all.iter().enumerate().skip(i + 1) {
            let length = beeline(a, b);
            if tier_of(a, b) != tier
                || length > t.reach
                || off[i] + off[j] > sum(length)
                || !is_tried(work, a, b, &all)?
            {
                continue;
            }
            let Some(line) = way(work, tier, a, b, cancel)? else { continue };
            let candidate = Candidate { ends: [a.clone(), b.clone()], line };
            if candidate.nears(tile, work) {
                out.push(candidate);
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
    let reach = Reach::new("roads", own, t.reach);
    let all = work.places.of_tier(reach.check(own.grown(t.reach))?, tier)?;
    let mut out = Vec::new();
    for other in &all {
        let candidate = other.id != s.id && tier_of(s, other) == tier && beeline(s, other) <= t.reach;
        if candidate && is_tried(work, s, other, &all)? {
            out.extend(course(work, s, other, cancel)?);
        }
    }
    out.sort_by_key(|c: &Arc<Course>| c.id);
    Ok(out)
}

/// The course between two settlements, if the proximity rule keeps their pair; settlements that touch need none.
pub(super) fn course(
    work: &Work,
    a: &Settlement,
    b: &Settlement,
    cancel: &Cancel,
) -> Result<Option<Arc<Course>>, LayerError> {
    let (a, b) = if a.id < b.id { (a, b) } else { (b, a) };
    let found = work.courses.get(&(a.id, b.id), || {
        let built = kept(work, a, b, cancel)? && !work.places.touch(a, b)?;
        let course = if built { find(work, a, b, cancel)? } else { None };
        Ok(Found(course.map(Arc::new)))
    })?;
    Ok(found.0.clone())
}

pub(super) fn find(work: &Work, a: &Settlement, b: &Settlement, cancel: &Cancel) -> Result<Option<Course>, LayerError> {
    cancel.check()?;
    let tier = tier_of(a, b);
    let step = work.settings.step;
    let Some(spine) = way(work, tier, a, b, cancel)? else { return Ok(None) };

    let (site_a, site_b) = (work.site(a)?, work.site(b)?);
    let stops = |site: &Site, s: &Settlement| -> Vec<Stop> {
        let stop = |t: &Tie| {
            let out = s.centre.to_local(node_at(t.node, step));
            Stop { node: t.node, cost: t.way, beyond: t.gate - out }
        };
        site.ties.iter().map(stop).collect()
    };
    let (from, to) = (stops(&site_a, a), stops(&site_b, b));
    let land = |beside: Beside| -> Result<Field, LayerError> {
        let mut field = land(work, tier, [a, b], beside, &spine, cancel)?;
        field.close_site(&site_a);
        field.close_site(&site_b);
        Ok(field)
    };
    let via = work.control.via(a, b);
    let mut found = None;
    if !via.is_empty() {
        found = through(&mut land(Beside::Outlines)?, &from, via, &to, cancel)?;
    }
    // Where discs of settlements fill a valley or an isthmus, roads squeeze past.
    let beside = if work.finite.is_none() { [Beside::Discs, Beside::Outlines].as_slice() } else { &[Beside::Outlines] };
    for beside in beside {
        if found.is_none() {
            found = geodesic(&mut land(*beside)?, &from, &to, cancel)?;
        }
    }
    let Some(found) = found else { return Ok(None) };
    let (tie_a, tie_b) = (&site_a.ties[found.from], &site_b.ties[found.to]);
    let end =
        |s: &Settlement, tie: &Tie| End { settlement: s.id, centre: s.centre, vertex: tie.vertex, gate: tie.gate };
    let gates = [gate_in_plan(a, tie_a), gate_in_plan(b, tie_b)];
    Ok(Some(Course {
        id: StreetId::of(&[0x636f_7572_7365, a.id.0, b.id.0]),
        class: class_of(tier),
        ends: [end(a, tie_a), end(b, tie_b)],
        bounds: Bounds::of(found.nodes.iter().map(|n| node_at(*n, step)).chain(gates)),
        nodes: found.nodes,
        spans: found.spans,
    }))
}

/// The ground of the corridor around a line: settlements closed, roads of higher classes laid, influences added.
fn land<'a>(
    work: &'a Work,
    tier: SizeClass,
    ends: [&Settlement; 2],
    off: Beside,
    spine: &[DVec2],
    cancel: &Cancel,
) -> Result<Field<'a>, LayerError> {
    let t = work.settings.tier(tier);
    let step = work.settings.step;
    let (mut sites, mut roads) = (Vec::new(), Vec::new());
    for stretch in stretches(spine) {
        let room = stretch.grown(t.corridor);
        let margin = if off == Beside::Discs { TIE_REACH } else { SITE_STEPS };
        sites.extend(work.places.overlapping(room.grown(margin * step as f64))?);
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
    let mut field = work.field(t, work.strip(spine, t.corridor));
    for s in sites.iter().filter(|s| ends.iter().all(|e| e.id != s.id)) {
        match off {
            Beside::Discs if s.radius == 0.0 => {}
            Beside::Discs => field.close_disc(s.centre.plan(), s.radius + TIE_REACH * step as f64),
            Beside::Outlines => field.close_site(&*work.site(s)?),
        }
    }
    let mut beside = vec![0f64; field.strip.nodes.len()];
    for road in &roads {
        for (i, pair) in road.nodes.windows(2).enumerate() {
            field.lay(pair[0], pair[1], road.level(i));
        }
        for span in &road.spans {
            field.lay_span(&road.nodes[span.first..=span.last], span.tunnel);
        }
        keep_off(&road.nodes, &field.strip, step, &mut beside);
    }
    let off: Vec<f64> = field.strip.off.iter().map(|off| OFF_SPINE * f64::from(*off) / 1000.0).collect();
    field.add(|slot, node| t.building + t.beside * beside[slot] + off[slot] + t.rough * roughness(node, step));
    work.control.influence(tier, &mut field);
    Ok(field)
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

/// How close the nodes around an existing road are, from 1 at the road to 0.
fn keep_off(nodes: &[I64Vec2], strip: &Strip, step: i64, beside: &mut [f64]) {
    let r = (BESIDE / step as f64).ceil() as i64;
    for at in nodes {
        for y in -r..=r {
            for x in -r..=r {
                let by = I64Vec2::new(x, y);
                if let Some(slot) = strip.slot(*at + by) {
                    beside[slot] = beside[slot].max(kernel(node_at(by, step).length(), BESIDE));
                }
            }
        }
    }
}
