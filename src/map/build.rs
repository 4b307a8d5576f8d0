//! From what a file holds to a map in plan metres: places projected, streets clipped, outlines closed.

use crate::map::coordinates::{MapCoordinates, Projector};
use crate::map::elements::{Elements, Way};
use crate::map::error::MapError;
use crate::map::model::{Map, MapBuilding, MapNode, MapStreet};
use crate::map::report::{LeftOut, MapReport};
use crate::map::rings::rings;
use crate::map::tags::{BuildingTags, ElementKind, StreetTags};
use crate::space::{Bounds, ClippedPoint, clip_line, is_simple, line_length, point_in_polygon, segments, signed_area};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// The map of a file's elements, with its streets clipped to `bounds` and the buildings that overlap `bounds`. Fails where no
/// street is left; `classes` are the classes that were asked for.
pub(super) fn build(
    file: &str,
    elements: &Elements,
    coordinates: MapCoordinates,
    bounds: Option<Bounds>,
    classes: &[String],
) -> Result<Map, MapError> {
    let mut report = MapReport { file: file.into(), left_out: elements.left_out.clone(), ..MapReport::default() };
    let members = elements.member_ways(|_| true);
    for (_, way) in elements.ways.iter().filter(|(id, _)| !members.contains(id)) {
        if let ElementKind::Other(reason) = way.kind {
            report.leave_out(reason);
        }
    }
    let streets = elements.ways.values().filter(|w| matches!(w.kind, ElementKind::Street(_)));
    let points: Vec<DVec2> = streets.flat_map(|w| &w.nodes).filter_map(|id| elements.position(*id)).collect();
    if points.is_empty() {
        return Err(no_streets(file, classes, &report));
    }
    let projector = Projector::new(file, coordinates, &points)?;
    let (nodes, streets) = StreetBuilder::new(elements, &projector, bounds, &mut report).build()?;
    if streets.is_empty() {
        let outside = report.left_out.get(&LeftOut::OutsideBox).copied().unwrap_or(0);
        return Err(match bounds {
            Some(bounds) if outside > 0 => {
                MapError::Outside { file: file.into(), streets: outside, hint: projector.hint_outside(&points, bounds) }
            }
            _ => no_streets(file, classes, &report),
        });
    }
    let buildings =
        BuildingBuilder { elements, projector: &projector, bounds, report: &mut report, out: Vec::new() }.build()?;
    let corner = |p: DVec2| projector.to_plan(p).ok();
    let stated_bounds = elements.stated.and_then(|b| Some(Bounds::of([corner(b.min)?, corner(b.max)?])));
    let bounds = bounds.unwrap_or_else(|| Bounds::of(nodes.iter().map(|n| n.at)));
    Ok(Map { projection: projector.projection, bounds, stated_bounds, nodes, streets, buildings, report })
}

fn no_streets(file: &str, classes: &[String], report: &MapReport) -> MapError {
    let left_out = report.left_out_in_words();
    let left_out = if left_out.is_empty() { left_out } else { format!("; left out: {left_out}") };
    MapError::NoStreets { file: file.into(), classes: classes.to_vec(), left_out }
}

/// Puts streets on the plan, one after another.
struct StreetBuilder<'a> {
    elements: &'a Elements,
    projector: &'a Projector<'a>,
    bounds: Option<Bounds>,
    report: &'a mut MapReport,
    /// Indices of the nodes that are used already, by their ids.
    index: BTreeMap<i64, u32>,
    nodes: Vec<MapNode>,
    streets: Vec<MapStreet>,
    /// The nodes of every street, from the end with the lesser id.
    seen: BTreeSet<Vec<i64>>,
}

impl<'a> StreetBuilder<'a> {
    fn new(
        elements: &'a Elements,
        projector: &'a Projector<'a>,
        bounds: Option<Bounds>,
        report: &'a mut MapReport,
    ) -> Self {
        let (index, nodes, streets, seen) = Default::default();
        Self { elements, projector, bounds, report, index, nodes, streets, seen }
    }

    /// Adds every street, and gives the nodes and the streets.
    fn build(mut self) -> Result<(Vec<MapNode>, Vec<MapStreet>), MapError> {
        for (id, way) in &self.elements.ways {
            if let ElementKind::Street(tags) = &way.kind {
                self.add(*id, way, tags)?;
            }
        }
        Ok((self.nodes, self.streets))
    }

    /// Adds a street, parted where nodes are missing and clipped to the box.
    fn add(&mut self, id: i64, way: &Way, tags: &StreetTags) -> Result<(), MapError> {
        let mut nodes = way.nodes.clone();
        nodes.dedup();
        let backwards = || nodes.iter().rev().copied().collect::<Vec<i64>>();
        let key = if nodes.first() > nodes.last() { backwards() } else { nodes.clone() };
        if !self.seen.insert(key) {
            self.report.leave_out(LeftOut::Repeated);
            return Ok(());
        }
        let lacks_nodes = nodes.iter().any(|n| self.elements.position(*n).is_none());
        if lacks_nodes {
            self.report.leave_out(LeftOut::MissingNodes);
        }
        let (mut is_long_enough, mut is_inside) = (false, false);
        for part in nodes.split(|n| self.elements.position(*n).is_none()).filter(|p| p.len() > 1) {
            let places = part.iter().filter_map(|n| self.elements.position(*n)).map(|p| self.projector.to_plan(p));
            let line: Vec<DVec2> = places.collect::<Result<_, _>>()?;
            is_long_enough = true;
            self.report.length += line_length(&line);
            let clipped = match self.bounds {
                Some(bounds) => clip_line(&line, bounds),
                None => vec![(0..line.len()).map(ClippedPoint::Own).collect()],
            };
            for points in clipped {
                is_inside = true;
                let nodes: Vec<u32> = points.iter().map(|p| self.node(part, &line, *p)).collect();
                let at = |i: &u32| self.nodes[*i as usize].at;
                self.report.length_inside += line_length(&nodes.iter().map(at).collect::<Vec<_>>());
                self.streets.push(MapStreet { id, nodes, tags: tags.clone() });
            }
        }
        match (is_long_enough, is_inside) {
            (_, true) => self.report.streets += 1,
            (true, false) => self.report.leave_out(LeftOut::OutsideBox),
            (false, false) if lacks_nodes => {}
            (false, false) => self.report.leave_out(LeftOut::TooFewPoints),
        }
        Ok(())
    }

    /// The index of a point of a street with these nodes at these places.
    fn node(&mut self, ids: &[i64], line: &[DVec2], point: ClippedPoint) -> u32 {
        let next = self.nodes.len() as u32;
        match point {
            ClippedPoint::Own(i) => {
                let index = *self.index.entry(ids[i]).or_insert(next);
                if index == next {
                    self.nodes.push(MapNode { id: Elements::id_in_file(ids[i]), at: line[i] });
                }
                index
            }
            ClippedPoint::Border(_, at) => {
                self.nodes.push(MapNode { id: None, at });
                next
            }
        }
    }
}

/// Puts buildings on the plan, one after another.
struct BuildingBuilder<'a> {
    elements: &'a Elements,
    projector: &'a Projector<'a>,
    bounds: Option<Bounds>,
    report: &'a mut MapReport,
    out: Vec<MapBuilding>,
}

impl BuildingBuilder<'_> {
    /// Adds every building: closed ways, and outlines of several lines.
    fn build(mut self) -> Result<Vec<MapBuilding>, MapError> {
        let elements = self.elements;
        let outer = elements.member_ways(|member| !member.is_inner);
        for (id, way) in elements.ways.iter().filter(|(id, _)| !outer.contains(id)) {
            if let ElementKind::Building(tags) = way.kind {
                self.add(*id, tags, vec![way.nodes.clone()], Vec::new())?;
            }
        }
        for (id, outline) in &elements.outlines {
            let lines = |inner: bool| {
                let members = outline.members.iter().filter(|m| m.is_inner == inner);
                members.map(|m| elements.member_nodes(m)).collect()
            };
            self.add(*id, outline.tags, lines(false), lines(true))?;
        }
        Ok(self.out)
    }

    /// Adds the buildings within some outer lines, with the courtyards within some inner ones.
    fn add(&mut self, id: i64, tags: BuildingTags, outer: Vec<Vec<i64>>, inner: Vec<Vec<i64>>) -> Result<(), MapError> {
        let is_missing = |lines: &[Vec<i64>]| lines.iter().flatten().any(|n| self.elements.position(*n).is_none());
        if is_missing(&outer) || is_missing(&inner) {
            self.report.leave_out(LeftOut::MissingNodes);
            return Ok(());
        }
        let (Some(outer), Some(inner)) = (rings(outer), rings(inner)) else {
            self.report.leave_out(LeftOut::OpenOutline);
            return Ok(());
        };
        let outer = self.placed(&outer, 1.0)?;
        let mut inner = self.placed(&inner, -1.0)?;
        if outer.is_empty() {
            self.report.leave_out(LeftOut::OpenOutline);
        }
        for outline in outer {
            if !is_simple(&outline) {
                self.report.leave_out(LeftOut::CrossesItself);
                continue;
            }
            let (holes, rest) = inner.into_iter().partition(|hole: &Vec<DVec2>| lies_in(hole, &outline));
            inner = rest;
            if self.bounds.is_some_and(|b| !Bounds::of(outline.iter().copied()).overlaps(b)) {
                self.report.leave_out(LeftOut::OutsideBox);
                continue;
            }
            self.report.buildings += 1;
            self.out.push(MapBuilding { id, outline, holes, height: tags.height, storeys: tags.storeys });
        }
        Ok(())
    }

    /// Rings on the plan, counter-clockwise for a `turn` of 1 and clockwise for -1, without those that have no area.
    fn placed(&self, rings: &[Vec<i64>], turn: f64) -> Result<Vec<Vec<DVec2>>, MapError> {
        let mut out = Vec::with_capacity(rings.len());
        for ring in rings {
            let places = ring.iter().filter_map(|n| self.elements.position(*n)).map(|p| self.projector.to_plan(p));
            let mut polygon: Vec<DVec2> = places.collect::<Result<_, _>>()?;
            polygon.dedup();
            let area = signed_area(&polygon);
            if area == 0.0 || !area.is_finite() {
                continue;
            }
            if area * turn < 0.0 {
                polygon.reverse();
            }
            out.push(polygon);
        }
        Ok(out)
    }
}

/// Whether a ring lies in another, which it may touch.
fn lies_in(ring: &[DVec2], outline: &[DVec2]) -> bool {
    let inside = segments(ring).filter(|(a, b)| point_in_polygon(a.midpoint(*b), outline)).count();
    2 * inside > segments(ring).count()
}
