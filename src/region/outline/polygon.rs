//! Outlines of settlements: star-shaped polygons, shaped by noise, water, steep ground and neighbours.

use super::border::Border;
use super::profile::Profile;
use super::waterway::Waterway;
use crate::layer::Weigh;
use crate::network::StreetClass;
use crate::region::gate::Gate;
use crate::region::settlement::Settlement;
use crate::region::settlement::radii::even_out_free;
use crate::region::settlement::ray::SHORE;
use crate::region::settlement::spacing::{SETBACK, power_line};
use crate::space::{Bounds, Origin, distance_to_segment, left_normal, math, point_in_polygon, quantize, signed_area};
use crate::terrain::Terrain;
use glam::DVec2;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Beyond the end of a border, an outline draws back from the power line by this many metres per metre.
const TAPER: f64 = 0.6;
/// Desired distance between vertices, in metres.
const SPACING: f64 = 60.0;
/// Least and greatest distance between neighbouring vertices, in metres.
const VERTEX_DISTANCE: (f64, f64) = (40.0, 90.0);

/// The outline of a settlement: a polygon, star-shaped about the centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Origin that the polygon is local to: the settlement's centre.
    pub origin: Origin,
    /// Counter-clockwise, on the quantum grid, star-shaped about (0, 0). Neighbouring vertices are 40 to 90 m apart. The
    /// distance may be smaller or larger between two borders that end near each other, where water draws the outline in,
    /// and where a river leaves it.
    pub polygon: Vec<DVec2>,
    /// Borders with settlements that this one touches, in order along the polygon.
    pub shared: Vec<SharedBorder>,
    /// A river that runs through the settlement.
    pub river: Option<Waterway>,
}

/// A border as part of an outline.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedBorder {
    /// The border.
    pub border: Arc<Border>,
    /// Index in the polygon of the border's first vertex, counter-clockwise. The border's other vertices follow without a gap.
    pub first: usize,
    /// Whether the polygon runs along the border's line (with the settlement on its left) or against it.
    pub forward: bool,
}

impl SharedBorder {
    /// Index in the outline's polygon of a vertex of the border's line.
    pub fn vertex(&self, of_line: usize) -> usize {
        self.first + if self.forward { of_line } else { self.border.line.len() - 1 - of_line }
    }
}

impl Weigh for Outline {
    fn bytes(&self) -> usize {
        // A border lives as long as an outline holds it.
        let borders = self.shared.iter().map(|s| 200 + size_of::<DVec2>() * s.border.line.len());
        size_of::<Self>() + size_of::<DVec2>() * self.polygon.len() + borders.sum::<usize>()
    }
}
impl Outline {
    /// Box around the outline, in plan metres.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.polygon.iter().copied()).moved(self.origin.plan())
    }

    /// Whether a plan point lies inside.
    pub fn contains(&self, plan: DVec2) -> bool {
        point_in_polygon(self.origin.to_local(plan), &self.polygon)
    }

    /// Distance in metres from a plan point to the outline: positive inside, negative outside.
    pub fn clearance(&self, plan: DVec2) -> f64 {
        let p = self.origin.to_local(plan);
        let n = self.polygon.len();
        let edges = (0..n).map(|i| distance_to_segment(p, self.polygon[i], self.polygon[(i + 1) % n]));
        let distance = edges.fold(f64::INFINITY, f64::min);
        if point_in_polygon(p, &self.polygon) { distance } else { -distance }
    }

    /// Area in square metres.
    pub fn area(&self) -> f64 {
        signed_area(&self.polygon)
    }

    /// The gates on the borders, sorted by vertex: where main streets of two settlements meet. The middle gate of each border
    /// has the class of an arterial, the others have the class of a main street.
    pub fn border_gates(&self) -> Vec<Gate> {
        let n = self.polygon.len();
        let gate = |shared: &SharedBorder, i: usize| {
            let border = &shared.border;
            let vertex = shared.vertex(border.gates[i]);
            let (before, after) = (self.polygon[(vertex + n - 1) % n], self.polygon[(vertex + 1) % n]);
            let class = if i == border.gates.len() / 2 { StreetClass::Arterial } else { StreetClass::Main };
            let inward = left_normal(after - before).normalize_or_zero();
            Gate { junction: border.junction(i), vertex, at: self.polygon[vertex], inward, class }
        };
        let mut out = Vec::new();
        for shared in &self.shared {
            out.extend((0..shared.border.gates.len()).map(|i| gate(shared, i)));
        }
        out.sort_by_key(|g| g.vertex);
        out
    }

    /// Whether a gate of a road may stand at a vertex: vertices beside a river that runs through may have none.
    pub(in crate::region) fn has_room_for_gate(&self, vertex: usize) -> bool {
        self.river.as_ref().is_none_or(|river| river.leaves_room(self.polygon[vertex]))
    }

    /// The outline of `settlement` among its `neighbours`. These must include every settlement whose circle comes within twice
    /// [`SETBACK`] of its own, each with the border that the two share.
    pub(in crate::region) fn new(
        terrain: &dyn Terrain,
        settlement: &Settlement,
        profile: &Profile,
        neighbours: &[(Arc<Settlement>, Option<Arc<Border>>)],
    ) -> Self {
        if let Some((river, reach)) = &profile.across_river {
            let mut whole = Self::around(terrain, settlement, &profile.directions, reach.clone(), neighbours);
            let mut held = vec![false; whole.polygon.len()];
            for shared in &whole.shared {
                held[shared.first..shared.first + shared.border.line.len()].fill(true);
            }
            if let Some(cut) = Waterway::cut(&whole.polygon, &held, river) {
                for shared in &mut whole.shared {
                    shared.first = cut.moved[shared.first].unwrap_or(shared.first);
                }
                (whole.polygon, whole.river) = (cut.polygon, Some(cut.waterway));
                return whole;
            }
        }
        Self::around(terrain, settlement, &profile.directions, profile.reach.clone(), neighbours)
    }

    /// The outline whose rays reach as far as `reach` says and as the neighbours leave room.
    fn around(
        terrain: &dyn Terrain,
        settlement: &Settlement,
        ways: &[DVec2],
        mut reach: Vec<f64>,
        neighbours: &[(Arc<Settlement>, Option<Arc<Border>>)],
    ) -> Self {
        let (centre, radius) = (settlement.centre, settlement.radius);
        let mut held: Vec<bool> = vec![false; reach.len()];
        let mut chains: Vec<Chain> = Vec::new();
        for (other, border) in neighbours.iter().filter(|(n, _)| n.id != settlement.id) {
            let offset = other.centre.offset_to(centre);
            let line = power_line(offset.length(), radius, other.radius);
            let toward = offset.normalize_or_zero();
            let chain = border.as_ref().map(|border| Chain {
                points: border.around(settlement.id, centre),
                shared: SharedBorder { border: border.clone(), first: 0, forward: border.is_left(settlement.id) },
            });
            for (r, way) in reach.iter_mut().zip(ways) {
                let facing = way.dot(toward);
                let gap = chain.as_ref().map_or(SETBACK, |c| c.gap(toward, line, *way));
                let limit = line - gap;
                if facing * *r > limit {
                    *r = limit.max(0.0) / facing;
                }
            }
            chains.extend(chain);
        }
        for chain in &chains {
            for (i, way) in ways.iter().enumerate() {
                if let Some(r) = chain.met_by(*way) {
                    (reach[i], held[i]) = (r, true);
                }
            }
        }
        even_out_free(&mut reach, &held);
        let curve: Vec<DVec2> = ways.iter().zip(&reach).map(|(way, r)| *way * *r).collect();
        if chains.is_empty() {
            let polygon = vertices(terrain, centre, &curve, true);
            return Self { origin: centre, polygon, shared: Vec::new(), river: None };
        }
        chains.sort_by(|a, b| math::angle_of(a.points[0]).total_cmp(&math::angle_of(b.points[0])));
        let (mut polygon, mut shared) = (Vec::new(), Vec::new());
        for (i, chain) in chains.iter().enumerate() {
            let next = chains[(i + 1) % chains.len()].points[0];
            let last = chain.points[chain.points.len() - 1];
            shared.push(SharedBorder { first: polygon.len(), ..chain.shared.clone() });
            polygon.extend_from_slice(&chain.points);
            let arc = free_arc(&curve, &held, last, next);
            polygon.extend(vertices(terrain, centre, &arc, false));
        }
        Self { origin: centre, polygon, shared, river: None }
    }
}

/// A border seen from the centre of one of its settlements.
struct Chain {
    /// Vertices, counter-clockwise.
    points: Vec<DVec2>,
    shared: SharedBorder,
}

impl Chain {
    /// Distance in metres that a ray keeps from the power line, which lies `line` metres away in the direction `toward`: 0
    /// along the border, more the farther the ray is from the border's ends.
    fn gap(&self, toward: DVec2, line: f64, way: DVec2) -> f64 {
        let facing = way.dot(toward);
        if facing <= 0.0 {
            return SETBACK;
        }
        let across = left_normal(toward);
        let (low, high) = (self.points[0].dot(across), self.points[self.points.len() - 1].dot(across));
        let at = way.dot(across) / facing * line;
        SETBACK.min(TAPER * (low - at).max(at - high).max(0.0))
    }

    /// Distance from the centre at which a ray meets the border.
    fn met_by(&self, way: DVec2) -> Option<f64> {
        self.points.windows(2).find_map(|w| {
            let (p, q) = (w[0], w[1]);
            let between = p.perp_dot(way) >= 0.0 && way.perp_dot(q) >= 0.0 && way.dot(p + q) > 0.0;
            between.then(|| p.perp_dot(q - p) / way.perp_dot(q - p))
        })
    }
}

/// The part of a curve that lies counter-clockwise between two borders, from the end of one to the start of the next; both
/// ends are included. The curve is given by its points on evenly spread rays.
fn free_arc(curve: &[DVec2], held: &[bool], from: DVec2, to: DVec2) -> Vec<DVec2> {
    let angle = |p: DVec2| (math::angle_of(p) - math::angle_of(from)).rem_euclid(TAU);
    let span = angle(to);
    let mut between: Vec<(f64, DVec2)> = curve
        .iter()
        .zip(held)
        .filter(|(p, held)| !**held && p.length() > 0.0)
        .map(|(p, _)| (angle(*p), *p))
        .filter(|(a, _)| *a > 0.0 && *a < span)
        .collect();
    between.sort_by(|a, b| a.0.total_cmp(&b.0));
    std::iter::once(from).chain(between.into_iter().map(|b| b.1)).chain([to]).collect()
}

/// Vertices along a curve, evenly spaced, and moved inwards to dry ground where a chord cuts a bay. For a `closed` curve they
/// go all around; for an open curve they lie between its ends, which are vertices already.
fn vertices(terrain: &dyn Terrain, origin: Origin, curve: &[DVec2], closed: bool) -> Vec<DVec2> {
    let sides = if closed { curve.len() } else { curve.len() - 1 };
    let mut along = vec![0.0];
    for i in 0..sides {
        along.push(along[i] + curve[i].distance(curve[(i + 1) % curve.len()]));
    }
    let length = along[sides];
    let least = if closed { 3.0 } else { 1.0 };
    let wanted = (length / SPACING).round().max(least);
    let mut best: Option<(f64, Vec<DVec2>)> = None;
    // Tries numbers of edges: the wanted number first, then smaller and larger ones in turn.
    for k in 0..24 {
        let n = wanted + f64::from(k / 2 + k % 2) * if k % 2 == 1 { 1.0 } else { -1.0 };
        if n < least {
            continue;
        }
        let point = |i: usize| dry_point(terrain, origin, on_curve(curve, &along, i as f64 / n * length));
        let mut polygon: Vec<DVec2> = (usize::from(!closed)..n as usize).map(point).collect();
        if !closed {
            polygon.insert(0, curve[0]);
            polygon.push(curve[sides]);
        }
        let last = polygon.len() - usize::from(!closed);
        let edges = (0..last).map(|i| polygon[i].distance(polygon[(i + 1) % polygon.len()]));
        let (least, greatest) = edges.fold((f64::INFINITY, 0.0f64), |(l, g), d| (l.min(d), g.max(d)));
        let off = (VERTEX_DISTANCE.0 - least).max(greatest - VERTEX_DISTANCE.1);
        if best.as_ref().is_none_or(|b| off < b.0) {
            best = Some((off, polygon));
        }
        if off <= 0.0 {
            break;
        }
    }
    let mut out = best.map(|b| b.1).unwrap_or_default();
    if !closed {
        out.pop();
        out.remove(0);
    }
    out
}

/// The point `at` metres along the curve. Its points lie at the lengths `along`.
fn on_curve(curve: &[DVec2], along: &[f64], at: f64) -> DVec2 {
    let i = (along.partition_point(|a| *a <= at).max(1) - 1).min(curve.len() - 1);
    let length = along[i + 1] - along[i];
    let t = if length > 0.0 { (at - along[i]) / length } else { 0.0 };
    curve[i].lerp(curve[(i + 1) % curve.len()], t)
}

/// `local`, moved towards the centre until it is dry.
fn dry_point(terrain: &dyn Terrain, origin: Origin, local: DVec2) -> DVec2 {
    let way = local.normalize_or_zero();
    let mut p = quantize(local);
    for _ in 0..40 {
        if terrain.sample(origin.to_plan(p)).depth() == 0.0 {
            break;
        }
        p = quantize(p - way * (SHORE / 5.0).min(p.length() / 2.0));
    }
    p
}
