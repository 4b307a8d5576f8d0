//! Where roads may enter a settlement, and where they may not pass beside it.
//!
//! A settlement offers a few *ties*: straight lines from a vertex of its outline to a lattice node outside. Every road begins
//! and ends with a tie; otherwise the lattice near the outline is closed. So no road crosses an outline or another
//! settlement's tie, and gates keep their distance, whichever roads are built.

use super::budget::Budget;
use super::inputs::Inputs;
use super::lattice::{DIRECTIONS, STENCIL, node_at, node_near};
use super::padding::SITE_STEPS;
use super::window::Window;
use crate::layer::{LayerCache, LayerError, Reach, Weigh};
use crate::region::outline::Outline;
use crate::region::settlement::{Settlement, SettlementId};
use crate::space::math::angle_between;
use crate::space::{
    Bounds, Origin, distance_to_segment, left_normal, point_in_polygon, polygon_distance, segment_crossing,
    segment_distance, segments, signed_area,
};
use glam::{DVec2, I64Vec2};
use std::f64::consts::{FRAC_PI_3, FRAC_PI_4};
use std::sync::Arc;

/// Greatest number of ties that a settlement offers.
const MOST_TIES: usize = 28;
/// Least distance between two gates along the outline, in metres.
const GATE_SPACING: f64 = 170.0;
/// Distance that ties keep from each other and from outlines, in metres.
const TIE_CLEARANCE: f64 = 18.0;
/// Distance that ties keep from borders with settlements that touch, in metres.
const BORDER_CLEARANCE: f64 = 70.0;
/// Greatest length of a tie, in steps.
const LONGEST_TIE: f64 = 2.0;

/// A straight line from a gate to the lattice.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tie {
    /// Index of the gate's vertex in the outline.
    pub vertex: usize,
    /// Position of the gate, local to the settlement.
    pub gate: DVec2,
    /// The node outside.
    pub node: I64Vec2,
    /// Distance in metres from the settlement's centre over the gate to the node.
    pub way: f64,
}

/// The ties of a settlement, and the edges of the lattice that it closes.
#[derive(Clone, Debug)]
pub(super) struct Site {
    pub ties: Vec<Tie>,
    pub window: Window,
    /// Closed edges: one bit per heading for each node of the window.
    pub closed: Vec<u16>,
}

/// The ties of a settlement on its own, before its neighbours are considered.
struct Candidates(Vec<Tie>);

impl Weigh for Site {
    fn bytes(&self) -> usize {
        size_of::<Self>() + self.ties.len() * size_of::<Tie>() + self.closed.len() * 2
    }
}

impl Weigh for Candidates {
    fn bytes(&self) -> usize {
        size_of::<Self>() + self.0.len() * size_of::<Tie>()
    }
}

/// The sites of settlements, remembered.
pub(super) struct Sites {
    inputs: Arc<Inputs>,
    candidates: LayerCache<SettlementId, Candidates>,
    sites: LayerCache<SettlementId, Site>,
}

impl Sites {
    pub fn new(inputs: Arc<Inputs>, budget: Budget) -> Self {
        Self { inputs, candidates: budget.cache(1), sites: budget.cache(4) }
    }

    /// Site of a settlement.
    pub fn site(&self, s: &Settlement) -> Result<Arc<Site>, LayerError> {
        self.sites.get(&s.id, || match self.inputs.nodes.node(s, self.inputs.step()) {
            Some(node) => Ok(Site::of_node(s, node, self.inputs.step())),
            None => self.make(s),
        })
    }

    fn candidates(&self, s: &Settlement) -> Result<Arc<Candidates>, LayerError> {
        self.candidates.get(&s.id, || candidates(&self.inputs, s))
    }
}

impl Site {
    /// The site of a settlement that is a node: roads end at the node, and no edges are closed.
    fn of_node(s: &Settlement, node: I64Vec2, step: i64) -> Self {
        let gate = Origin(node * step).offset_to(s.centre);
        let window = Window { min: I64Vec2::ZERO, size: I64Vec2::ZERO };
        Self { ties: vec![Tie { vertex: 0, gate, node, way: 0.0 }], window, closed: Vec::new() }
    }
}

/// Ties that the outline and the ground allow, spread around the outline.
fn candidates(inputs: &Inputs, s: &Settlement) -> Result<Candidates, LayerError> {
    let outline = inputs.settlements.outline(s)?;
    let step = inputs.step();
    let polygon = &outline.polygon;
    let count = polygon.len();
    let around: f64 = (0..count).map(|i| polygon[i].distance(polygon[(i + 1) % count])).sum();
    let sectors = ((around / GATE_SPACING) as usize).clamp(3, MOST_TIES);
    let mut possible: Vec<Vec<(f64, Tie)>> = vec![Vec::new(); sectors];
    let mut along = 0.0;
    for (vertex, gate) in polygon.iter().enumerate() {
        let sector = ((along / around * sectors as f64) as usize).min(sectors - 1);
        // Only in the middle of a sector, so that gates of neighbouring sectors keep their distance.
        let off_middle = (along / around * sectors as f64 - sector as f64 - 0.5).abs();
        along += gate.distance(polygon[(vertex + 1) % count]);
        if off_middle > 0.3 || !outline.has_room_for_gate(vertex) {
            continue;
        }
        for (score, node) in nodes_outside(&outline, vertex, step) {
            let score = score + off_middle * 0.5;
            let end = outline.origin.to_local(node_at(node, step));
            if !clears_borders(&outline, *gate, end) {
                continue;
            }
            let way = gate.length() + gate.distance(end);
            possible[sector].push((score, Tie { vertex, gate: *gate, node, way }));
        }
    }
    let mut out: Vec<Tie> = Vec::new();
    for mut ties in possible {
        // A stable sort: of equal ties, the first stays first.
        ties.sort_by(|a, b| a.0.total_cmp(&b.0));
        let dry = ties.into_iter().find(|(_, t)| is_dry(inputs, &outline, t.gate, t.node));
        let Some((_, tie)) = dry else { continue };
        let end = outline.origin.to_local(node_at(tie.node, step));
        let clear = |o: &Tie| {
            let other = outline.origin.to_local(node_at(o.node, step));
            o.node != tie.node && segment_distance(o.gate, other, tie.gate, end) > TIE_CLEARANCE
        };
        if out.iter().all(clear) {
            out.push(tie);
        }
    }
    Ok(Candidates(out))
}

/// Whether a tie from `gate` to `end` keeps its distance from the outline's borders, where a neighbour begins at once.
fn clears_borders(outline: &Outline, gate: DVec2, end: DVec2) -> bool {
    outline.shared.iter().all(|shared| {
        let count = shared.border.line.len();
        let chain = &outline.polygon[shared.first..shared.first + count];
        segments(chain).all(|(a, b)| segment_distance(gate, end, a, b) > BORDER_CLEARANCE)
    })
}

/// Nodes outside an outline that a straight tie from one of its vertices could lead to, each with a penalty.
fn nodes_outside(outline: &Outline, vertex: usize, step: i64) -> Vec<(f64, I64Vec2)> {
    let polygon = &outline.polygon;
    let count = polygon.len();
    let (before, at, after) = (polygon[(vertex + count - 1) % count], polygon[vertex], polygon[(vertex + 1) % count]);
    let sign = if signed_area(polygon) > 0.0 { -1.0 } else { 1.0 };
    let outward = |a: DVec2, b: DVec2| left_normal(b - a).normalize_or_zero() * sign;
    let normal = (outward(before, at) + outward(at, after)).normalize_or_zero();
    if normal == DVec2::ZERO {
        return Vec::new();
    }
    let s = step as f64;
    let middle = node_near(outline.origin.to_plan(at + normal * s * 1.2), step);
    // Edges of the outline that a tie from here could come near.
    let edge = |i: usize| (polygon[i], polygon[(i + 1) % count]);
    let beside: Vec<usize> =
        (0..count).filter(|i| distance_to_segment(at, edge(*i).0, edge(*i).1) < (LONGEST_TIE + 0.6) * s).collect();
    let mut out = Vec::new();
    for dy in -1..=1 {
        for dx in -1..=1 {
            let node = middle + I64Vec2::new(dx, dy);
            let end = outline.origin.to_local(node_at(node, step));
            let (length, angle) = (at.distance(end), angle_between(end - at, normal));
            if length < 0.7 * s || length > LONGEST_TIE * s || angle > FRAC_PI_4 {
                continue;
            }
            let near = |a: DVec2, b: DVec2, margin: f64| {
                beside.iter().any(|i| segment_distance(a, b, edge(*i).0, edge(*i).1) < margin)
            };
            // Beyond a short first part, the tie must keep its distance from the outline. The first part must not cross it.
            let out_there = at + (end - at) * (TIE_CLEARANCE * 1.5 / length);
            let crosses = beside.iter().any(|i| {
                let own = *i == vertex || (i + 1) % count == vertex;
                !own && segment_crossing(at, out_there, edge(*i).0, edge(*i).1).is_some()
            });
            let inside = point_in_polygon(out_there, polygon) || point_in_polygon(end, polygon);
            if inside || crosses || near(out_there, end, TIE_CLEARANCE * 0.8) || near(end, end, 0.6 * s) {
                continue;
            }
            out.push((angle + (length / s - 1.2).abs() * 0.3, node));
        }
    }
    out
}

fn is_dry(inputs: &Inputs, outline: &Outline, gate: DVec2, node: I64Vec2) -> bool {
    let end = node_at(node, inputs.step());
    let gate = outline.origin.to_plan(gate);
    [0.0, 0.5, 1.0].iter().all(|t| inputs.terrain.sample(gate.lerp(end, *t)).depth() == 0.0)
}

impl Sites {
    /// The ties of a settlement that keep clear of its neighbours' outlines and ties, and the edges that it closes.
    fn make(&self, s: &Settlement) -> Result<Site, LayerError> {
        let settlements = &self.inputs.settlements;
        let outline = settlements.outline(s)?;
        let step = self.inputs.step();
        let own = outline.bounds();
        let reach = Reach::new("roads", own, SITE_STEPS * step as f64);
        let read = reach.check(own.grown(4.0 * step as f64))?;
        let mut ties = self.candidates(s)?.0.clone();
        for other in settlements.overlapping(read)? {
            // The ties of both settlements reach out of their circles.
            let room = (2.0 * LONGEST_TIE + 0.2) * step as f64;
            if other.id == s.id || s.centre.offset_to(other.centre).length() > s.radius + other.radius + room {
                continue;
            }
            let there = settlements.outline(&other)?;
            if !there.bounds().overlaps(read) {
                continue;
            }
            let shift = outline.origin.offset_to(there.origin);
            // Of two ties in each other's way, the settlement with the higher id drops its own.
            let theirs = if other.id < s.id { self.candidates(&other)?.0.clone() } else { Vec::new() };
            ties.retain(|t| {
                let (gate, end) = (t.gate + shift, there.origin.to_local(node_at(t.node, step)));
                let free = polygon_distance(gate, end, &there.polygon) > TIE_CLEARANCE * 0.5
                    && polygon_distance(end, end, &there.polygon) > 0.6 * step as f64
                    && !point_in_polygon(end, &there.polygon);
                free && theirs.iter().all(|o| {
                    let other_end = there.origin.to_local(node_at(o.node, step));
                    segment_distance(gate, end, o.gate, other_end) > TIE_CLEARANCE || o.node == t.node
                })
            });
        }
        let window = Window::around(own.grown((SITE_STEPS - 1.0) * step as f64), step);
        let closed = closed_edges(&outline, &ties, &window, step);
        Ok(Site { ties, window, closed })
    }
}

/// Edges that come near the outline, end near or inside it, or meet a tie elsewhere than at its node.
fn closed_edges(outline: &Outline, ties: &[Tie], window: &Window, step: i64) -> Vec<u16> {
    let local = |node: I64Vec2| outline.origin.to_local(node_at(node, step));
    let polygon = &outline.polygon;
    let margin = 0.33 * step as f64;
    let mut closed = vec![0u16; window.len()];
    let close = |closed: &mut [u16], node: I64Vec2, heading: usize| {
        for (node, heading) in [(node, heading), (node + STENCIL[heading], (heading + 8) % DIRECTIONS)] {
            if window.contains(node) {
                closed[window.index(node)] |= 1 << heading;
            }
        }
    };
    for (i, a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let side = Bounds::of([*a, b]).grown(margin);
        let part = Window::around(side.moved(outline.origin.plan()), step);
        // The nearest point of an edge lies within half the edge's length of one of its ends.
        let (min, max) = (part.min - 1, part.min + part.size + 1);
        for y in min.y..max.y {
            for x in min.x..max.x {
                let node = I64Vec2::new(x, y);
                let p = local(node);
                let off = distance_to_segment(p, *a, b);
                let node_near = off < 0.5 * step as f64;
                let known = if window.contains(node) { closed[window.index(node)] } else { 0 };
                for (heading, s) in STENCIL.iter().enumerate().filter(|(heading, _)| known >> heading & 1 == 0) {
                    let q = p + s.as_dvec2() * step as f64;
                    let passes = || Bounds::of([p, q]).overlaps(side) && segment_distance(p, q, *a, b) < margin;
                    // The same edge is also tested from its other end.
                    let asked = || heading >= 8 && part.contains(node + *s);
                    if node_near || (!asked() && passes()) {
                        close(&mut closed, node, heading);
                    }
                }
            }
        }
    }
    for node in Window::around(outline.bounds(), step).nodes() {
        if point_in_polygon(local(node), polygon) {
            (0..DIRECTIONS).for_each(|heading| close(&mut closed, node, heading));
        }
    }
    for tie in ties {
        let end = local(tie.node);
        let near = Bounds::of([tie.gate, end]).grown(TIE_CLEARANCE);
        for y in -4..=4 {
            for x in -4..=4 {
                let node = tie.node + I64Vec2::new(x, y);
                for (heading, s) in STENCIL.iter().enumerate().take(8) {
                    let ends_there = node == tie.node || node + *s == tie.node;
                    let (p, q) = (local(node), local(node + *s));
                    let meets = if ends_there {
                        leads_back(tie, end, if node == tie.node { q } else { p })
                    } else {
                        Bounds::of([p, q]).overlaps(near) && segment_distance(p, q, tie.gate, end) < TIE_CLEARANCE
                    };
                    if meets {
                        close(&mut closed, node, heading);
                    }
                }
            }
        }
    }
    closed
}

/// Whether an edge from the node of a tie at `end` to `far` turns back beside the tie.
fn leads_back(tie: &Tie, end: DVec2, far: DVec2) -> bool {
    angle_between(tie.gate - end, far - end) < FRAC_PI_3
}
