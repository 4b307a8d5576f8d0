//! Costs of the edges in a corridor, found when they are asked for.

use super::corridor::Corridor;
use super::existing::Existing;
use super::ground::CorridorGround;
use crate::layer::LayerError;
use crate::region::road::cost::{LEAST_COST, cost_per_metre};
use crate::region::road::lattice::{DIRECTIONS, STENCIL};
use crate::region::road::samples::Ground;
use crate::region::road::tier_settings::TierSettings;

/// From this share of the steepest slope of a span on, a bridge or tunnel is tried instead of an edge on the ground.
const STEEP_SHARE: f64 = 0.7;
/// Steepest slope of a bridge or tunnel, whatever the limit for roads is.
const STEEPEST_SPAN: f64 = 0.2;

/// The edges of a corridor for one class of roads.
///
/// The cost of an edge comes in two steps: a lower bound from its two ends, and the whole cost, which also looks at the ground
/// between them.
pub(super) struct Edges<'a> {
    pub corridor: Corridor,
    pub ground: CorridorGround<'a>,
    pub existing: Existing,
    pub t: &'a TierSettings,
    pub step: i64,
    /// Length in metres of an edge along each heading.
    pub lengths: [f64; DIRECTIONS],
    /// Extra cost per metre of new road, by slot.
    pub extra: Vec<f32>,
    /// Least cost per metre of any edge.
    pub least_cost: f64,
    /// By slot, one bit per heading: edges already asked for that the ground does not allow, or that are so steep that a span
    /// may be better.
    bad: Vec<u16>,
    /// Lower bounds, by slot and heading below 8; NaN until they are asked for.
    bounds: Vec<f32>,
    /// Whole costs, in the same order.
    costs: Vec<f32>,
}

impl<'a> Edges<'a> {
    pub fn new(corridor: Corridor, ground: CorridorGround<'a>, t: &'a TierSettings, step: i64) -> Self {
        let count = corridor.nodes.len();
        Self {
            ground,
            existing: Existing::new(count),
            t,
            step,
            lengths: STENCIL.map(|s| s.as_dvec2().length() * step as f64),
            extra: vec![0.0; count],
            least_cost: 1.0,
            bad: vec![0; count],
            bounds: vec![f32::NAN; count * DIRECTIONS / 2],
            costs: vec![f32::NAN; count * DIRECTIONS / 2],
            corridor,
        }
    }

    /// Forgets the costs that were found, after edges were closed.
    pub fn forget(&mut self) {
        self.bounds.fill(f32::NAN);
        self.costs.fill(f32::NAN);
    }

    pub fn ground_at(&mut self, slot: usize) -> Result<Ground, LayerError> {
        self.ground.at_slot(&self.corridor, slot)
    }

    /// The ground at a point some `edges` along a heading from a slot.
    pub fn ground_along(&mut self, slot: usize, heading: usize, edges: f64) -> Ground {
        self.ground.along(self.corridor.nodes[slot], heading, edges)
    }

    /// Both ends of an edge (in the same order from either end), its heading from the first end, and its index.
    fn edge(&self, slot: usize, next: usize, heading: usize) -> ([usize; 2], usize, usize) {
        if heading < 8 {
            ([slot, next], heading, slot * 8 + heading)
        } else {
            ([next, slot], heading - 8, next * 8 + heading - 8)
        }
    }

    /// The neighbour along a heading, and a lower bound of the cost of the edge to it; infinite where no road may run.
    #[inline]
    pub fn lower_bound(&mut self, slot: usize, heading: usize) -> Result<Option<(usize, f32)>, LayerError> {
        let Some(next) = self.corridor.next(slot, heading) else { return Ok(None) };
        let ([a, b], h, index) = self.edge(slot, next, heading);
        if self.bounds[index].is_nan() {
            self.bounds[index] = self.find_lower_bound([a, b], h)?;
        }
        Ok(Some((next, self.bounds[index])))
    }

    fn find_lower_bound(&mut self, [a, b]: [usize; 2], h: usize) -> Result<f32, LayerError> {
        let (bit, back) = (1u16 << h, 1u16 << (h + 8));
        let length = self.lengths[h];
        let existing = &self.existing;
        let blocked = |slot: usize| existing.closed[slot] | existing.on_spans[slot];
        if blocked(a) & bit | blocked(b) & back != 0 {
            return Ok(f32::INFINITY);
        }
        if existing.on_ground[a] & bit != 0 {
            return Ok(length as f32);
        }
        let (ga, gb) = (self.ground_at(a)?, self.ground_at(b)?);
        let steep = f64::from((ga.surface - gb.surface).abs()) > STEEP_SHARE * self.steepest_span() * length;
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
        Ok(cost.map_or(f32::INFINITY, |c| (length * (c + extra).max(LEAST_COST)) as f32))
    }

    /// The whole cost of an edge, infinite where no road may run.
    fn cost(&mut self, slot: usize, heading: usize) -> Result<f32, LayerError> {
        let Some((next, bound)) = self.lower_bound(slot, heading)? else { return Ok(f32::INFINITY) };
        let ([a, b], h, index) = self.edge(slot, next, heading);
        if self.costs[index].is_nan() {
            self.costs[index] = if bound.is_infinite() || self.existing.on_ground[a] >> h & 1 == 1 {
                bound
            } else {
                let (ga, gb) = (self.ground_at(a)?, self.ground_at(b)?);
                let middle = self.ground_along(a, h, 0.5);
                let brook = if middle.depth > 0.0 {
                    self.extra_of_bridge(self.lengths[h] / 2.0, middle.depth.into())
                } else {
                    0.0
                };
                let off = (middle.surface - (ga.surface + gb.surface) / 2.0).abs();
                let fits = if middle.depth > 0.0 {
                    // Water wider than a step takes a bridge along several edges.
                    let wide = self.lengths[h] > 1.5 * self.step as f64
                        && self.ground_along(a, h, 0.25).depth > 0.0
                        && self.ground_along(a, h, 0.75).depth > 0.0;
                    !wide && f64::from(middle.depth) <= self.t.depth_limit
                } else {
                    f64::from(off) <= self.t.earthwork
                };
                if fits { bound + brook as f32 } else { f32::INFINITY }
            };
        }
        Ok(self.costs[index])
    }

    /// The difference between the whole cost of an edge and its [lower bound](Self::lower_bound); infinite where no road may
    /// run.
    pub fn surcharge(&mut self, slot: usize, heading: usize) -> Result<f32, LayerError> {
        let cost = self.cost(slot, heading)?;
        let bound = self.lower_bound(slot, heading)?.map_or(f32::INFINITY, |e| e.1);
        Ok(if bound.is_finite() { cost - bound } else { f32::INFINITY })
    }

    /// Whether the ground does not allow an edge, or is so steep that a span may be better. Never for edges that are closed or
    /// belong to an existing road.
    pub fn is_bad(&mut self, slot: usize, heading: usize) -> Result<bool, LayerError> {
        self.lower_bound(slot, heading)?;
        Ok(self.bad[slot] >> heading & 1 == 1)
    }

    /// Steepest slope of a bridge or tunnel.
    pub fn steepest_span(&self) -> f64 {
        self.t.slope_limit.min(STEEPEST_SPAN)
    }

    /// Extra cost of a bridge over a road of the same length on the ground.
    pub fn extra_of_bridge(&self, length: f64, depth: f64) -> f64 {
        self.t.bridge + length * self.t.water * (1.0 + depth / self.t.depth_limit.max(1e-3))
    }
}
