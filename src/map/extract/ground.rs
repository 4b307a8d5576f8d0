//! The streets of a map as one plane graph, turned so that most streets run along the axes.

use super::tidy::tidy;
use crate::map::model::Map;
use crate::network::{EdgeIx, PlanarGraph, StreetClass, VertexIx};
use crate::space::math::{angle_of, rotate};
use crate::space::{Bounds, centroid, distance_to_segment, is_simple, segment_crossing};
use glam::DVec2;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

/// Places this near to each other are one, in metres.
const WELD: f64 = 0.5;
/// Width in metres of the bands of a map in which the numbers of junctions are compared.
const BAND: f64 = 50.0;
/// Number of bands on either side with which a band is compared.
const SMOOTH: i64 = 3;
/// Share of the usual number of junctions around a band below which the band lies outside of the map.
const THIN: f64 = 0.25;
/// Maps with fewer junctions are taken as a whole.
const FEW: usize = 12;
/// Greatest number of bands from one that lies in the map to the next.
const WIDEST_GAP: i64 = 6;
/// Edge of the squares by which buildings are found, in metres.
const SQUARE: f64 = 100.0;
/// Corners of buildings this near to the line between those beside them do not show, in metres.
const FLAT_CORNER: f64 = 0.05;
/// Least share of the streets' length that must agree on a direction for it to be that of the map.
const AGREED: f64 = 0.12;

/// The streets of a map.
pub(super) struct Ground {
    /// Streets by class, in a frame with the middle of the map as its origin, turned by `turned` against the map.
    pub graph: PlanarGraph<StreetClass>,
    /// What the map covers, in that frame: its box there is turned, so this holds for a point of the map's own frame.
    covered: Bounds,
    /// Whether the map itself says what it covers.
    is_stated: bool,
    /// The origin of the frame, in the map's metres.
    pub middle: DVec2,
    /// Angle of the frame's x axis in the map, in radians.
    pub turned: f64,
    /// Buildings by the squares of [`SQUARE`] metres that their middles lie in.
    buildings: BTreeMap<(i64, i64), Vec<GroundBuilding>>,
}

/// A building, in the frame of a [`Ground`].
pub(super) struct GroundBuilding {
    pub outline: Vec<DVec2>,
    /// Centre of its area.
    pub middle: DVec2,
    pub height: Option<f64>,
    pub storeys: Option<u32>,
}

impl Ground {
    /// The streets of a map; without an angle in degrees the frame is turned as most streets are.
    pub fn of(map: &Map, turn_deg: Option<f64>) -> Self {
        let covered = map.stated_bounds.unwrap_or_else(|| dense_bounds(map));
        let middle = covered.centre().round();
        let turned = turn_deg.map_or_else(|| main_direction(map), f64::to_radians);
        let place = |i: u32| rotate(map.nodes[i as usize].at - middle, -turned);
        let mut weld = Weld::default();
        let mut graph = PlanarGraph::new();
        for street in &map.streets {
            let Some(class) = class(street.tags.class, &street.tags.highway).filter(|_| !street.tags.tunnel) else {
                continue;
            };
            let line: Vec<VertexIx> = street.nodes.iter().map(|i| weld.vertex(&mut graph, place(*i))).collect();
            for &[a, b] in line.array_windows() {
                if a != b {
                    add_planar(&mut graph, a, b, class);
                }
            }
        }
        let mut buildings: BTreeMap<(i64, i64), Vec<GroundBuilding>> = BTreeMap::new();
        for building in &map.buildings {
            let outline: Vec<DVec2> = building.outline.iter().map(|p| rotate(*p - middle, -turned)).collect();
            let outline = without_flat_corners(&outline);
            let at = centroid(&outline);
            let (height, storeys) = (building.height, building.storeys);
            buildings.entry(square_of(at)).or_default().push(GroundBuilding { outline, middle: at, height, storeys });
        }
        let is_stated = map.stated_bounds.is_some();
        Self { graph: tidy(&graph), covered, is_stated, middle, turned, buildings }
    }

    /// The buildings whose middles lie in a box, in a fixed order.
    pub fn buildings_in(&self, bounds: Bounds) -> impl Iterator<Item = &GroundBuilding> {
        let (low, high) = (square_of(bounds.min), square_of(bounds.max));
        let squares = (low.1..=high.1).flat_map(move |y| (low.0..=high.0).map(move |x| (x, y)));
        let near = squares.filter_map(|square| self.buildings.get(&square)).flatten();
        near.filter(move |building| bounds.contains(building.middle))
    }

    /// The box around the covered part of the map, in this frame.
    pub fn bounds(&self) -> Bounds {
        let b = self.covered;
        let corners = [b.min, DVec2::new(b.max.x, b.min.y), b.max, DVec2::new(b.min.x, b.max.y)];
        Bounds::of(corners.map(|p| rotate(p - self.middle, -self.turned)))
    }

    /// Whether the map covers a point of this frame.
    pub fn covers(&self, p: DVec2) -> bool {
        self.covered.grown(1.0).contains(self.in_map(p))
    }

    /// Whether the map has all streets at a point of this frame. A map that says what it covers may leave some out beyond its box;
    /// any other map is taken at its word.
    pub fn has_all_streets_at(&self, p: DVec2) -> bool {
        !self.is_stated || self.covers(p)
    }

    /// A point of this frame in the map's metres.
    pub fn in_map(&self, p: DVec2) -> DVec2 {
        self.middle + rotate(p, self.turned)
    }

    /// Length of all streets, in metres.
    pub fn length(&self) -> f64 {
        self.graph.edges().map(|(e, _)| self.graph.edge_length(e)).sum()
    }

    /// Number of junctions of three streets or more.
    pub fn junctions(&self) -> usize {
        self.graph.vertices().filter(|v| self.graph.degree(*v) > 2).count()
    }
}

/// The square of [`Ground::buildings`] in which a point lies.
fn square_of(p: DVec2) -> (i64, i64) {
    let square = (p / SQUARE).floor().as_i64vec2();
    (square.x, square.y)
}

/// An outline without the corners at which it does not turn.
fn without_flat_corners(outline: &[DVec2]) -> Vec<DVec2> {
    let n = outline.len();
    let is_corner = |i: &usize| {
        let (before, after) = (outline[(i + n - 1) % n], outline[(i + 1) % n]);
        distance_to_segment(outline[*i], before, after) > FLAT_CORNER
    };
    let corners: Vec<DVec2> = (0..n).filter(is_corner).map(|i| outline[i]).collect();
    if is_simple(&corners) { corners } else { outline.to_vec() }
}

/// The class that a street has in a town; `None` for motorways, which are none of its streets.
fn class(class: StreetClass, highway: &str) -> Option<StreetClass> {
    match class {
        _ if highway.starts_with("motorway") => None,
        StreetClass::Highway | StreetClass::Major => Some(StreetClass::Arterial),
        StreetClass::Minor => Some(StreetClass::Main),
        StreetClass::Ramp => None,
        class => Some(class),
    }
}

/// The box that a map covers: along each axis, where junctions are about as dense as in most of the map. Ways that reach far out of an
/// extract meet no others there.
fn dense_bounds(map: &Map) -> Bounds {
    let mut degrees = vec![0u32; map.nodes.len()];
    for street in &map.streets {
        for &[a, b] in street.nodes.array_windows() {
            degrees[a as usize] += 1;
            degrees[b as usize] += 1;
        }
    }
    let junctions: Vec<DVec2> =
        map.nodes.iter().zip(degrees).filter(|(_, d)| *d > 2).map(|(node, _)| node.at).collect();
    if junctions.len() < FEW {
        return map.bounds;
    }
    let range = |axis: usize| {
        let mut counts: BTreeMap<i64, f64> = BTreeMap::new();
        for at in &junctions {
            *counts.entry((at[axis] / BAND).floor() as i64).or_default() += 1.0;
        }
        let around = |band: i64| counts.range(band - SMOOTH..=band + SMOOTH).map(|(_, count)| count).sum::<f64>();
        let mut sorted: Vec<(f64, f64)> = counts.iter().map(|(band, count)| (around(*band), *count)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut sum, half) = (0.0, counts.values().sum::<f64>() / 2.0);
        let usual = sorted.into_iter().find(|(_, count)| {
            sum += count;
            sum >= half
        });
        let least = THIN * usual.map_or(0.0, |(around, _)| around);
        let dense: Vec<i64> = counts.keys().copied().filter(|band| around(*band) >= least).collect();
        // The longest run of dense bands without a wide gap.
        let mut runs: Vec<(i64, i64)> = Vec::new();
        for band in dense {
            match runs.last_mut() {
                Some(run) if band - run.1 <= WIDEST_GAP => run.1 = band,
                _ => runs.push((band, band)),
            }
        }
        let mut longest = runs.into_iter().max_by_key(|run| run.1 - run.0).unwrap_or((0, 0));
        // Bands at its ends are dense for what lies beside them.
        let mut own: Vec<f64> = counts.range(longest.0..=longest.1).map(|(_, count)| *count).collect();
        own.sort_by(f64::total_cmp);
        let least = THIN * own.get(own.len() / 2).copied().unwrap_or(0.0);
        let is_thin = |band: i64| counts.get(&band).is_none_or(|count| *count < least);
        while longest.0 < longest.1 && is_thin(longest.0) {
            longest.0 += 1;
        }
        while longest.1 > longest.0 && is_thin(longest.1) {
            longest.1 -= 1;
        }
        (longest.0 as f64 * BAND, (longest.1 + 1) as f64 * BAND)
    };
    let (x, y) = (range(0), range(1));
    Bounds::new(DVec2::new(x.0, y.0), DVec2::new(x.1, y.1))
}

/// The direction that most streets have, in radians within an eighth of a turn of east; 0 where they have none in common.
fn main_direction(map: &Map) -> f64 {
    let (mut sum, mut length) = (DVec2::ZERO, 0.0);
    for street in &map.streets {
        for &[a, b] in map.line(street).array_windows() {
            let along = b - a;
            let far = along.length();
            if far > 0.0 {
                // Four times the angle is the same for all streets of a grid.
                let unit = along / far;
                let twice = unit.rotate(unit);
                sum += twice.rotate(twice) * far;
                length += far;
            }
        }
    }
    let angle = angle_of(sum) / 4.0;
    if sum.length() > AGREED * length { angle.clamp(-FRAC_PI_2 / 2.0, FRAC_PI_2 / 2.0) } else { 0.0 }
}

/// Vertices by place, so that places near each other are one vertex.
#[derive(Default)]
struct Weld(BTreeMap<(i64, i64), Vec<VertexIx>>);

impl Weld {
    fn vertex(&mut self, graph: &mut PlanarGraph<StreetClass>, at: DVec2) -> VertexIx {
        let cell = (at / WELD).floor().as_i64vec2();
        for (x, y) in (-1..=1).flat_map(|x| (-1..=1).map(move |y| (cell.x + x, cell.y + y))) {
            let near = self.0.get(&(x, y)).into_iter().flatten();
            if let Some(v) = near.copied().find(|v| graph.at(*v).distance(at) < WELD) {
                return v;
            }
        }
        let v = graph.add_vertex(at);
        self.0.entry((cell.x, cell.y)).or_default().push(v);
        v
    }
}

/// Adds an edge, with a vertex wherever it meets another edge.
fn add_planar(graph: &mut PlanarGraph<StreetClass>, a: VertexIx, b: VertexIx, class: StreetClass) {
    let (from, to) = (graph.at(a), graph.at(b));
    let mut via: Vec<(f64, VertexIx)> = vec![(0.0, a), (1.0, b)];
    for e in graph.edges_near(Bounds::of([from, to]).grown(WELD)) {
        let edge = graph.edge(e).clone();
        if [edge.a, edge.b].iter().any(|v| *v == a || *v == b) {
            continue;
        }
        let (c, d) = graph.segment(e);
        let ends = [(edge.a, c), (edge.b, d)];
        // What nearly meets does.
        let near = |p: DVec2, q: DVec2, r: DVec2| crate::space::distance_to_segment(p, q, r) < WELD;
        if let Some((v, at)) = ends.into_iter().find(|(_, at)| near(*at, from, to)) {
            via.push(((at - from).dot(to - from) / from.distance_squared(to), v));
        } else if let Some((v, _)) = [(a, from), (b, to)].into_iter().find(|(_, at)| near(*at, c, d)) {
            divide(graph, e, v);
        } else if let Some(crossing) = segment_crossing(from, to, c, d) {
            via.push((crossing.t, graph.split_edge(e, crossing.at)));
        }
    }
    via.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    via.dedup_by_key(|x| x.1);
    for &[(_, v), (_, w)] in via.array_windows() {
        if v != w && graph.edge_between(v, w).is_none() {
            graph.add_edge(v, w, class);
        }
    }
}

/// Leads an edge through a vertex beside it.
pub(super) fn divide(graph: &mut PlanarGraph<StreetClass>, e: EdgeIx, v: VertexIx) {
    let Some(edge) = graph.remove_edge(e) else { return };
    for end in [edge.a, edge.b] {
        if end != v && graph.edge_between(end, v).is_none() {
            graph.add_edge(end, v, edge.data);
        }
    }
}
