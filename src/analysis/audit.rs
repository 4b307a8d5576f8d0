//! Checks of what the design promises about streets and buildings, on any area: what `sprawl soak` and the tests run over
//! many seeds.

use crate::network::{JunctionId, Street, StreetId, crossings};
use crate::space::{
    Bounds, DisjointSets, Origin, distance_to_segment, point_at, point_in_polygon, polygon_distance, segments,
};
use crate::streets::{Cause, Rule};
use crate::world::Area;
use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use std::collections::BTreeMap;

/// Dead ends nearer than this to a street that they do not join are near misses, in metres.
pub const NEAR_MISS: f64 = 5.0;

/// A broken promise.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What is wrong.
    pub what: Fault,
    /// Where, in plan metres.
    pub at: DVec2,
}

/// Ways in which an area can be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// Two things have one id.
    RepeatedId,
    /// A street's end is not at the junction that it names.
    LooseEnd,
    /// Two streets of one level share a point that is no junction of both.
    Crossing,
    /// A dead end stops short of a street that it does not join.
    NearMiss,
    /// The streets of a settlement, or of settlements that touch, are in several pieces.
    Disconnected,
    /// A port that no street meets.
    UnmetPort,
    /// A building reaches into a street.
    BuildingOnStreet,
    /// A local street breaks a rule of its style, and neither a port, a pin nor the drawing of a patch makes it do so.
    BrokenRule,
}

/// How often local streets break a rule of their style, by rule and cause. Those that have a cause are no findings.
pub type Exceptions = BTreeMap<(Rule, Cause), usize>;

/// Counts where the local streets of an area break a rule of their style, as far as that is in its box.
pub fn exceptions(area: &Area) -> Exceptions {
    let inside = area.bounds.moved(-area.origin.plan());
    let mut counted = Exceptions::new();
    for exception in area.exceptions.iter().filter(|e| inside.contains(e.at)) {
        *counted.entry((exception.rule, exception.cause)).or_default() += 1;
    }
    counted
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?} at {:.3},{:.3}", self.what, self.at.x, self.at.y)
    }
}

type Piece = GeomWithData<Rectangle<[f64; 2]>, (usize, usize)>;

/// All findings in an area, an empty list when every promise is kept. What depends on things outside the area's box (dead
/// ends and settlements at its border) is left out.
pub fn audit(area: &Area) -> Vec<Finding> {
    let streets: Vec<&Street> = area.streets.iter().map(|s| &s.item.street).collect();
    let pieces = streets.iter().enumerate().flat_map(|(i, s)| {
        segments(&s.line).enumerate().map(move |(k, (a, b))| {
            Piece::new(Rectangle::from_corners(a.min(b).to_array(), a.max(b).to_array()), (i, k))
        })
    });
    let mut audit = Audit { area, tree: RTree::bulk_load(pieces.collect()), streets, found: Vec::new() };
    audit.ids();
    audit.ends();
    audit.crossings();
    audit.near_misses();
    audit.components();
    audit.buildings();
    for exception in area.exceptions.iter().filter(|e| e.cause == Cause::Defect) {
        audit.report(Fault::BrokenRule, exception.at);
    }
    for _ in 0..area.unmet_ports {
        audit.report(Fault::UnmetPort, DVec2::ZERO);
    }
    audit.found
}

struct Audit<'a> {
    area: &'a Area,
    streets: Vec<&'a Street>,
    tree: RTree<Piece>,
    found: Vec<Finding>,
}

impl Audit<'_> {
    fn report(&mut self, what: Fault, local: DVec2) {
        self.found.push(Finding { what, at: self.area.origin.to_plan(local) });
    }

    fn near(&self, bounds: Bounds) -> Vec<(usize, usize)> {
        let envelope = AABB::from_corners(bounds.min.to_array(), bounds.max.to_array());
        self.tree.locate_in_envelope_intersecting(envelope).map(|p| p.data).collect()
    }

    fn segment(&self, (street, k): (usize, usize)) -> (DVec2, DVec2) {
        let line = &self.streets[street].line;
        (line[k], line[k + 1])
    }

    fn ids(&mut self) {
        let mut by_id: BTreeMap<StreetId, usize> = BTreeMap::new();
        for i in 0..self.streets.len() {
            if by_id.insert(self.streets[i].id, i).is_some() {
                self.report(Fault::RepeatedId, self.streets[i].line[0]);
            }
        }
    }

    fn ends(&mut self) {
        let at: BTreeMap<JunctionId, DVec2> = self.area.junctions.iter().map(|j| (j.item.id, j.item.at)).collect();
        let by_place: BTreeMap<[u64; 2], JunctionId> =
            at.iter().map(|(id, p)| ([p.x.to_bits(), p.y.to_bits()], *id)).collect();
        if by_place.len() != at.len() {
            self.report(Fault::RepeatedId, DVec2::ZERO);
        }
        for i in 0..self.streets.len() {
            let s = self.streets[i];
            for (id, end) in [(s.from, s.line[0]), (s.to, s.line[s.line.len() - 1])] {
                if at.get(&id) != Some(&end) {
                    self.report(Fault::LooseEnd, end);
                }
            }
        }
    }

    fn crossings(&mut self) {
        for at in crossings(&self.streets) {
            self.report(Fault::Crossing, at);
        }
    }

    fn near_misses(&mut self) {
        let mut degree: BTreeMap<JunctionId, usize> = BTreeMap::new();
        for s in &self.streets {
            *degree.entry(s.from).or_default() += 1;
            *degree.entry(s.to).or_default() += 1;
        }
        let inside = self.area.bounds.grown(-2.0 * NEAR_MISS).moved(-self.area.origin.plan());
        for junction in &self.area.junctions {
            let (id, p) = (junction.item.id, junction.item.at);
            if degree.get(&id) != Some(&1) || !inside.contains(p) {
                continue;
            }
            for (j, m) in self.near(Bounds::square(p, 2.0 * NEAR_MISS)) {
                let (c, d) = self.segment((j, m));
                let own = self.streets[j].from == id || self.streets[j].to == id;
                if !own && distance_to_segment(p, c, d) < NEAR_MISS {
                    self.report(Fault::NearMiss, p);
                }
            }
        }
    }

    /// The streets of a settlement, and of all that it touches directly or by way of others, are one piece.
    fn components(&mut self) {
        let area = self.area;
        let whole: Vec<usize> = (0..area.settlements.len().min(area.outlines.len()))
            .filter(|i| {
                let s = &area.settlements[*i];
                area.bounds.encloses(Bounds::square(s.centre.plan(), 2.0 * s.radius))
            })
            .collect();
        let mut joined = DisjointSets::new();
        // Junctions of each settlement; the junctions on a border belong to both.
        let mut junctions: Vec<(usize, JunctionId)> = Vec::new();
        for &i in &whole {
            let (settlement, outline) = (&area.settlements[i], &area.outlines[i]);
            let shift = area.origin.offset_to(outline.origin);
            let reach = Bounds::square(area.origin.to_local(settlement.centre.plan()), 2.0 * settlement.radius);
            let inside = |p: DVec2| {
                let p = p + shift;
                let on_border = || polygon_distance(p, p, &outline.polygon) < 0.01;
                point_in_polygon(p, &outline.polygon) || on_border()
            };
            for s in self.streets.iter().filter(|s| !s.class.is_road() && reach.encloses(s.bounds())) {
                if s.line.iter().all(|p| inside(*p)) {
                    joined.union(s.from, s.to);
                    junctions.push((i, s.from));
                }
            }
        }
        let mut groups = DisjointSets::new();
        for &i in &whole {
            for shared in &area.outlines[i].shared {
                let touched =
                    whole.iter().find(|j| **j != i && shared.border.sides.contains(&area.settlements[**j].id));
                if let Some(&j) = touched {
                    groups.union(i, j);
                }
            }
        }
        // The piece of the first street of each group of settlements.
        let mut pieces: BTreeMap<usize, JunctionId> = BTreeMap::new();
        let mut loose = Vec::new();
        for (i, junction) in junctions {
            let piece = joined.find(junction);
            if *pieces.entry(groups.find(i)).or_insert(piece) != piece {
                loose.push(i);
            }
        }
        loose.sort_unstable();
        loose.dedup();
        for i in loose {
            self.report(Fault::Disconnected, area.origin.to_local(area.settlements[i].centre.plan()));
        }
    }

    fn buildings(&mut self) {
        for footprint in &self.area.footprints {
            let polygon = &footprint.item.polygon;
            let bounds = Bounds::of(polygon.iter().copied());
            let on_street = self.near(bounds.grown(10.0)).into_iter().any(|piece| {
                let (a, b) = self.segment(piece);
                let width = self.streets[piece.0].class.half_width();
                polygon_distance(a, b, polygon) < width - 0.01 || point_in_polygon(a, polygon)
            });
            if on_street {
                self.report(Fault::BuildingOnStreet, bounds.centre());
            }
        }
    }
}

/// The junctions of an area where a settlement's gates should be: ends of roads on the settlement's outline that no main
/// street shares.
pub fn unreached_gates(area: &Area, origin: Origin, outline: &[DVec2]) -> Vec<DVec2> {
    let offset = origin.offset_to(area.origin);
    let mut ends: BTreeMap<JunctionId, (bool, bool, DVec2)> = BTreeMap::new();
    for s in area.streets.iter().map(|s| &s.item.street) {
        for (id, at) in [(s.from, s.line[0]), (s.to, point_at(&s.line, f64::INFINITY).0)] {
            let entry = ends.entry(id).or_insert((false, false, at));
            if s.class.is_road() { entry.0 = true } else { entry.1 = true }
        }
    }
    let on_outline = |p: DVec2| outline.iter().any(|v| *v + offset == p);
    ends.into_values().filter(|(road, main, at)| *road && !*main && on_outline(*at)).map(|(.., at)| at).collect()
}
