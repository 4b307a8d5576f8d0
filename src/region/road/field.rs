//! What a search for a course reads: the nodes of a corridor, what the edges between them cost, and where bridges and
//! tunnels could run.
//!
//! Cost per metre is 1 on flat open ground, more by slope along the heading, vegetation and control terms (Galin 2011,
//! section 4.1), but never less than a share. Water is crossed on bridges only, straight along one heading, or on an edge
//! whose ends are both dry.

mod hop;
mod strip;

use super::TierSettings;
use super::control::LEAST_SHARE;
use super::lattice::{DIRECTIONS, Ground, STENCIL, Samples, cost_per_metre, heading, node_at};
use super::search::Window;
use super::site::Site;
use crate::layer::LayerError;
use crate::space::{Bounds, stable_hash};
use crate::terrain::{Scan, Terrain};
use glam::{DVec2, I64Vec2};
use hop::Existing;
use std::collections::BTreeMap;

pub(super) use hop::Hop;
pub(super) use strip::Strip;

/// Share of the steepest slope from which on a bridge or tunnel is tried instead.
const DEAR: f64 = 0.7;
/// Spacing in metres of the variation of the ground that the terrain does not know.
const ROUGH_SPACING: i64 = 450;

/// The ground of one search.
pub(super) struct Field<'a> {
    pub strip: Strip,
    t: &'a TierSettings,
    step: i64,
    /// The ground anywhere.
    scan: Scan<'a>,
    samples: Samples<'a>,
    grounds: Vec<Option<Ground>>,
    lengths: [f64; DIRECTIONS],
    /// Extra cost per metre of new road, by slot.
    extra: Vec<f32>,
    /// Least cost per metre of any edge.
    least: f64,
    /// A bit per heading, by slot: edges that roads may not take, that existing roads take on the ground, and on bridges
    /// or in tunnels.
    closed: Vec<u16>,
    existing: Vec<u16>,
    spanned: Vec<u16>,
    spans: Vec<Existing>,
    /// A bit per heading, by slot, of edges that were asked for: the ground does not let them on, or is so steep that they are
    /// better left.
    bad: Vec<u16>,
    /// Cost of edges from what their ends are, by slot and heading below 8; not a number if not asked yet.
    rough: Vec<f32>,
    /// The same with what lies between their ends.
    exact: Vec<f32>,
    /// A bit per heading, by slot: whether hops were looked for, and whether there are any.
    tried: Vec<u16>,
    hopping: Vec<u16>,
    hops: BTreeMap<(usize, usize), Vec<Hop>>,
}

impl<'a> Field<'a> {
    /// Open ground for a class of roads. `samples` are of the lattice of spacing `step`.
    pub fn new(
        strip: Strip,
        t: &'a TierSettings,
        step: i64,
        terrain: &'a dyn Terrain,
        samples: impl FnOnce(&Window) -> Samples<'a>,
    ) -> Self {
        let count = strip.nodes.len();
        Self {
            t,
            step,
            scan: terrain.scan_ground(),
            samples: samples(&strip.window),
            lengths: STENCIL.map(|s| s.as_dvec2().length() * step as f64),
            grounds: vec![None; count],
            extra: vec![0.0; count],
            least: 1.0,
            closed: vec![0; count],
            existing: vec![0; count],
            spanned: vec![0; count],
            spans: Vec::new(),
            bad: vec![0; count],
            rough: vec![f32::NAN; count * DIRECTIONS / 2],
            exact: vec![f32::NAN; count * DIRECTIONS / 2],
            tried: vec![0; count],
            hopping: vec![0; count],
            hops: BTreeMap::new(),
            strip,
        }
    }

    /// Settings of the class of roads.
    pub fn class(&self) -> &'a TierSettings {
        self.t
    }

    /// Spacing of the nodes in metres.
    pub fn step(&self) -> i64 {
        self.step
    }

    /// Adds an extra cost per metre at each slot.
    pub fn add(&mut self, cost: impl Fn(usize, I64Vec2) -> f64) {
        for (slot, node) in self.strip.nodes.iter().enumerate() {
            self.extra[slot] += cost(slot, *node) as f32;
        }
    }

    /// Least cost per metre of any edge.
    pub fn least(&self) -> f64 {
        self.least
    }

    /// Lets extra costs be negative, down to that cost per metre.
    pub fn lessen(&mut self, least: f64) {
        self.least = self.least.min(least);
    }

    /// Closes every edge at the nodes of a disc (plan metres).
    pub fn close_disc(&mut self, centre: DVec2, radius: f64) {
        let part = Window::around(Bounds::square(centre, 2.0 * radius), self.step);
        for node in part.nodes() {
            if node_at(node, self.step).distance(centre) <= radius {
                self.close(node, u16::MAX);
            }
        }
    }

    /// Closes edges at a node, a bit per heading.
    pub fn close(&mut self, node: I64Vec2, headings: u16) {
        if let Some(slot) = self.strip.slot(node) {
            self.closed[slot] |= headings;
        }
    }

    /// Closes edges at the nodes around a settlement that its site closes.
    pub fn close_site(&mut self, site: &Site) {
        for (node, bits) in site.window.nodes().zip(&site.closed).filter(|(_, bits)| **bits != 0) {
            self.close(node, *bits);
        }
    }

    /// Closes every edge at some nodes, also after edges were asked for.
    pub fn bar(&mut self, nodes: &[I64Vec2]) {
        for node in nodes {
            self.close(*node, u16::MAX);
            for (heading, s) in STENCIL.iter().enumerate() {
                self.close(*node + *s, 1 << ((heading + 8) % DIRECTIONS));
            }
        }
        self.rough.fill(f32::NAN);
        self.exact.fill(f32::NAN);
        self.tried.fill(0);
        self.hopping.fill(0);
        self.hops.clear();
    }

    /// Lays the edge between two nodes of an existing road, which costs no more than its length.
    pub fn lay(&mut self, a: I64Vec2, b: I64Vec2, level: i8) {
        let Some(h) = heading(a, b) else { return };
        let held = if level == 0 { &mut self.existing } else { &mut self.spanned };
        for (node, h) in [(a, h), (b, (h + 8) % 16)] {
            if let Some(slot) = self.strip.slot(node) {
                held[slot] |= 1 << h;
            }
        }
    }

    /// Names a bridge or tunnel of an existing road, whose edges are laid.
    pub fn lay_span(&mut self, nodes: &[I64Vec2], tunnel: bool) {
        let [first, second, ..] = *nodes else { return };
        let (Some(h), Some(last)) = (heading(first, second), nodes.last()) else { return };
        let edges = nodes.len() - 1;
        self.spans.push(Existing { first, heading: h, edges, tunnel });
        self.spans.push(Existing { first: *last, heading: (h + 8) % 16, edges, tunnel });
    }

    /// Whether a node is inside and not under water.
    pub fn is_dry(&mut self, node: I64Vec2) -> Result<bool, LayerError> {
        match self.strip.slot(node) {
            Some(slot) => Ok(self.ground(slot)?.depth <= 0.0),
            None => Ok(false),
        }
    }

    /// Whether a node is dry and none of its edges closed.
    pub fn is_free(&mut self, node: I64Vec2) -> Result<bool, LayerError> {
        let open = self.strip.slot(node).is_some_and(|s| self.closed[s] == 0);
        Ok(open && self.is_dry(node)?)
    }

    fn ground(&mut self, slot: usize) -> Result<Ground, LayerError> {
        if let Some(held) = self.grounds[slot] {
            return Ok(held);
        }
        let ground = self.samples.at(self.strip.nodes[slot])?;
        self.grounds[slot] = Some(ground);
        Ok(ground)
    }

    /// Both ends of an edge, the same from either, and its index.
    fn edge(&self, slot: usize, next: usize, heading: usize) -> ([usize; 2], usize, usize) {
        if heading < 8 {
            ([slot, next], heading, slot * 8 + heading)
        } else {
            ([next, slot], heading - 8, next * 8 + heading - 8)
        }
    }

    /// Neighbour along a heading and a lower bound of the edge's cost, infinite where there is no way.
    #[inline]
    pub fn rough(&mut self, slot: usize, heading: usize) -> Result<Option<(usize, f32)>, LayerError> {
        let Some(next) = self.strip.next(slot, heading) else { return Ok(None) };
        let ([a, b], h, index) = self.edge(slot, next, heading);
        if self.rough[index].is_nan() {
            self.rough[index] = self.find_rough([a, b], h)?;
        }
        Ok(Some((next, self.rough[index])))
    }

    fn find_rough(&mut self, [a, b]: [usize; 2], h: usize) -> Result<f32, LayerError> {
        let (bit, back) = (1u16 << h, 1u16 << (h + 8));
        let length = self.lengths[h];
        if (self.closed[a] | self.spanned[a]) & bit | (self.closed[b] | self.spanned[b]) & back != 0 {
            return Ok(f32::INFINITY);
        }
        if self.existing[a] & bit != 0 {
            return Ok(length as f32);
        }
        let (ga, gb) = (self.ground(a)?, self.ground(b)?);
        let steep = f64::from((ga.surface - gb.surface).abs()) > DEAR * self.steepest_span() * length;
        for (slot, bit, far) in [(a, bit, gb), (b, back, ga)] {
            if steep || far.depth > 0.0 {
                self.bad[slot] |= bit;
            }
        }
        if ga.depth > 0.0 || gb.depth > 0.0 {
            return Ok(f32::INFINITY);
        }
        let extra = f64::from(self.extra[a] + self.extra[b]) / 2.0;
        let cost = cost_per_metre(ga, gb, length, self.t);
        Ok(cost.map_or(f32::INFINITY, |c| (length * (c + extra).max(LEAST_SHARE)) as f32))
    }

    /// The cost of an edge, infinite where there is no way.
    fn exact(&mut self, slot: usize, heading: usize) -> Result<f32, LayerError> {
        let Some((next, rough)) = self.rough(slot, heading)? else { return Ok(f32::INFINITY) };
        let ([a, b], h, index) = self.edge(slot, next, heading);
        if self.exact[index].is_nan() {
            self.exact[index] = if rough.is_infinite() || self.existing[a] >> h & 1 == 1 {
                rough
            } else {
                let (ga, gb) = (self.ground(a)?, self.ground(b)?);
                let middle = self.between(a, h, 0.5);
                let brook =
                    if middle.depth > 0.0 { self.bridge(self.lengths[h] / 2.0, middle.depth.into()) } else { 0.0 };
                let off = (middle.surface - (ga.surface + gb.surface) / 2.0).abs();
                let fits = if middle.depth > 0.0 {
                    // Wider than a step, it takes a bridge.
                    let wide = self.lengths[h] > 1.5 * self.step as f64
                        && self.between(a, h, 0.25).depth > 0.0
                        && self.between(a, h, 0.75).depth > 0.0;
                    !wide && f64::from(middle.depth) <= self.t.depth_limit
                } else {
                    f64::from(off) <= self.t.earthwork
                };
                if fits { rough + brook as f32 } else { f32::INFINITY }
            };
        }
        Ok(self.exact[index])
    }

    /// What an edge along a heading costs more than [`Field::rough`] says, infinite where there is no way.
    pub fn hidden(&mut self, slot: usize, heading: usize) -> Result<f32, LayerError> {
        let exact = self.exact(slot, heading)?;
        let rough = self.rough(slot, heading)?.map_or(f32::INFINITY, |e| e.1);
        Ok(if rough.is_finite() { exact - rough } else { f32::INFINITY })
    }
    /// The ground some edges along a heading.
    fn between(&mut self, slot: usize, heading: usize, edges: f64) -> Ground {
        let at = node_at(self.strip.nodes[slot], self.step) + node_at(STENCIL[heading], self.step) * edges;
        Ground::of(&(self.scan)(at))
    }
}

/// Variation of the ground between 0 and 1, the same for all classes of roads, at a node.
pub(super) fn roughness(node: I64Vec2, step: i64) -> f64 {
    let spacing = I64Vec2::splat(ROUGH_SPACING);
    let cell = (node * step).div_euclid(spacing);
    let part = (node * step - cell * spacing).as_dvec2() / ROUGH_SPACING as f64;
    let at = |x: i64, y: i64| {
        let word = stable_hash(&[0x0072_6f75_6768, (cell.x + x) as u64, (cell.y + y) as u64]);
        (word >> 40) as f64 / (1u64 << 24) as f64
    };
    let mix = crate::space::math::mix;
    mix(mix(at(0, 0), at(1, 0), part.x), mix(at(0, 1), at(1, 1), part.x), part.y)
}
