//! From the drawing of a patch to the patch: what a drawing may not hold, the centre, the connectable vertices.

use crate::network::{PlanarGraph, StreetClass};
use crate::patch::file::{BuildingDrawing, Line, PatchDrawing, WindowDrawing};
use crate::patch::{Connectable, Pair, Patch, PatchBuilding, PatchEdge, PatchWindow};
use crate::space::{DisjointSets, is_simple, math::angle_between, quantize, segment_distance, signed_area};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// Greatest number of vertices of a patch: it is a small example, and the checks compare all its edges.
const MOST_VERTICES: usize = 512;
/// Positions and edges nearer than this, in metres, count as the same place.
const TOUCH: f64 = 0.25;
/// Least angle between two edges at a vertex, in degrees.
const LEAST_ANGLE: f64 = 20.0;
/// Greatest coordinate of a vertex, in metres.
const REACH: f64 = 2000.0;
/// Edges of windows, in metres.
const WINDOWS: std::ops::RangeInclusive<f64> = 20.0..=1000.0;
/// Corners of a building's outline.
const CORNERS: std::ops::RangeInclusive<usize> = 3..=500;
/// Least area of a building, in square metres.
const LEAST_BUILDING: f64 = 1.0;
/// Heights of buildings, in metres, and their storeys.
const HEIGHTS: std::ops::RangeInclusive<f64> = 0.5..=1000.0;
const STOREYS: std::ops::RangeInclusive<u32> = 1..=500;
/// Greatest weight.
const MOST_WEIGHT: f64 = 1e6;

/// What is wrong with the drawing of a patch, and what is allowed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum Defect {
    #[error("the name is empty; give it one that is not used twice in the file")]
    NoName,
    #[error("a vertex has the coordinate {0}; allowed is -{REACH} to {REACH} metres")]
    Coordinate(f64),
    #[error("the tag {0:?} is not lower-case words joined by `-`, such as \"river-side\"")]
    Tag(String),
    #[error("the weight is {0}; allowed is 0 to {MOST_WEIGHT}")]
    Weight(f64),
    #[error("it has {0} classes of {1} streets; give each street one, in their order, or none")]
    ClassCount(usize, usize),
    #[error("the window's {0} is {1}; allowed is {low} to {high} metres", low = .2.0, high = .2.1)]
    Window(&'static str, f64, (f64, f64)),
    #[error("building {0} has {1} corners; allowed is {low} to {high}", low = CORNERS.start(), high = CORNERS.end())]
    Corners(usize, usize),
    #[error("building {0} has the coordinate {1}; allowed is -{REACH} to {REACH} metres")]
    BuildingAt(usize, f64),
    #[error("the outline of building {0} crosses itself, or has less than {LEAST_BUILDING} square metre in it")]
    NoOutline(usize),
    #[error("building {0} has the {1} {2}; allowed is {low} to {high}", low = .3.0, high = .3.1)]
    BuildingValue(usize, &'static str, f64, (f64, f64)),
    #[error("a street runs through {0} vertices; it needs two or more, such as (0, 1) or [0, 4, 5, 1]")]
    ShortStreet(usize),
    #[error("{0} names no vertex; they are numbered from 0")]
    NegativeIndex(i64),
    #[error("a street runs from vertex {0} to itself; its vertices must differ")]
    StreetToItself(i64),
    #[error("it has {0} vertices; allowed is 2 to {MOST_VERTICES}")]
    VertexCount(usize),
    #[error("it has no local streets (main ones are not built); draw one in `streets`, such as (0, 1)")]
    NoStreets,
    #[error("{what} names vertex {index}, but there are {count} vertices, 0 to {}", count - 1)]
    DanglingIndex { what: &'static str, index: i64, count: usize },
    #[error("the street {0}-{1} is drawn twice; draw it once")]
    DuplicateEdge(usize, usize),
    #[error("vertices {0} and {1} are at the same place; use one of them for both streets")]
    SamePlace(usize, usize),
    #[error("vertex {0} is on no street; draw one to it, or leave it out")]
    UnusedVertex(usize),
    #[error("dead end {0} is not an end: {1} streets meet there; a dead end has one")]
    NoDeadEnd(usize, usize),
    #[error("the streets {}-{} and {}-{} cross or touch without a vertex; give them one that they share", .0.0, .0.1, .1.0, .1.1)]
    Crossing((usize, usize), (usize, usize)),
    #[error("at vertex {at} the streets to {a} and {b} are {angle:.0} degrees apart; allowed is {LEAST_ANGLE} or more")]
    SharpAngle { at: usize, a: usize, b: usize, angle: f64 },
    #[error("no street leads from vertex {0} to vertex {1}; a patch is one connected piece")]
    Unconnected(usize, usize),
}

/// Why a drawing makes no patch.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{reason}")]
pub struct DrawingError {
    /// What is wrong.
    pub kind: DrawingErrorKind,
    /// What is wrong, in words, and what is allowed.
    pub reason: String,
}

/// What may be wrong with a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingErrorKind {
    /// Streets cross or touch where they have no vertex in common, or two vertices are at one place.
    Touching,
    /// Two streets leave a vertex at too small an angle.
    SharpAngle,
    /// There are too many vertices.
    TooManyVertices,
    /// Something else: values out of range, names, indices.
    Other,
}

impl DrawingError {
    pub(super) fn of(defect: &Defect) -> Self {
        let kind = match defect {
            Defect::Crossing(..) | Defect::SamePlace(..) | Defect::DuplicateEdge(..) => DrawingErrorKind::Touching,
            Defect::SharpAngle { .. } => DrawingErrorKind::SharpAngle,
            Defect::VertexCount(count) if *count > MOST_VERTICES => DrawingErrorKind::TooManyVertices,
            _ => DrawingErrorKind::Other,
        };
        Self { kind, reason: defect.to_string() }
    }
}

/// A defect, and the path to its place in the drawing, such as `vertices[3]`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Refused {
    pub path: String,
    pub defect: Defect,
}

impl Defect {
    fn at(self, path: impl Into<String>) -> Refused {
        Refused { path: path.into(), defect: self }
    }
}

/// The patch that a drawing describes.
pub(super) fn check_patch(drawing: PatchDrawing) -> Result<Patch, Refused> {
    let PatchDrawing { name, vertices, streets, main, classes, dead_ends, tags, weight, at_most, window } = drawing;
    if name.trim().is_empty() {
        return Err(Defect::NoName.at("name"));
    }
    if let Some(i) = tags.iter().position(|t| !is_tag(t)) {
        return Err(Defect::Tag(tags[i].clone()).at(format!("tags[{i}]")));
    }
    if !(0.0..=MOST_WEIGHT).contains(&weight) {
        return Err(Defect::Weight(weight).at("weight"));
    }
    if !classes.is_empty() && classes.len() != streets.len() {
        return Err(Defect::ClassCount(classes.len(), streets.len()).at("classes"));
    }
    let buildings = window.as_ref().map(|window| check_window(window).and_then(|()| buildings(&window.buildings)));
    let buildings = buildings.transpose()?.unwrap_or_default();
    let places = places(&vertices)?;
    let edges = edges(&streets, &main, &classes, places.len())?;
    let around = around(places.len(), &edges);
    if let Some(v) = around.iter().position(Vec::is_empty) {
        return Err(Defect::UnusedVertex(v).at(format!("vertices[{v}]")));
    }
    for (i, &index) in dead_ends.iter().enumerate() {
        let defect = match around.get(index) {
            None => Defect::DanglingIndex { what: "`dead_ends`", index: index as i64, count: places.len() },
            Some(edges) if edges.len() != 1 => Defect::NoDeadEnd(index, edges.len()),
            Some(_) => continue,
        };
        return Err(defect.at(format!("dead_ends[{i}]")));
    }
    check_geometry(&places, &edges, &around)?;
    if window.is_none() {
        check_connected(&edges, &around)?;
    }

    let centre = quantize(bounding_circle(&places));
    let vertices: Vec<DVec2> = places.iter().map(|p| *p - centre).collect();
    let connectables: Vec<Connectable> = (0..vertices.len())
        .filter(|v| !dead_ends.contains(v))
        .filter_map(|v| match around[v][..] {
            [e] if !edges[e].main => {
                let next = edges[e].other(v);
                Some(Connectable { vertex: v, inward: (vertices[next] - vertices[v]).normalize() })
            }
            _ => None,
        })
        .collect();
    let mut patch = Patch {
        name,
        radius: vertices.iter().map(|v| v.length()).fold(0.0, f64::max),
        pairs: pairs(&vertices, &connectables, &edges),
        vertices,
        edges,
        tags: tags.into_iter().collect(),
        weight,
        at_most,
        connectables,
        window: window.map(|w| PatchWindow {
            size: w.size,
            margin: w.margin,
            middle: -centre,
            map: w.map,
            at: w.at.into(),
            turned: w.turned_deg.to_radians(),
            buildings,
        }),
    };
    let found = patch.find_tags();
    patch.tags.extend(found.into_iter().map(str::to_owned));
    Ok(patch)
}

fn check_window(window: &WindowDrawing) -> Result<(), Refused> {
    let sizes = (*WINDOWS.start(), *WINDOWS.end());
    let values = [
        ("size", window.size, sizes),
        ("margin", window.margin, (0.0, window.size)),
        ("at[0]", window.at.0, (-1e10, 1e10)),
        ("at[1]", window.at.1, (-1e10, 1e10)),
        ("turned_deg", window.turned_deg, (-360.0, 360.0)),
    ];
    match values.into_iter().find(|(_, value, (low, high))| !(low..=high).contains(&value)) {
        Some((field, value, allowed)) => Err(Defect::Window(field, value, allowed).at(format!("window.{field}"))),
        None => Ok(()),
    }
}

/// The buildings of a window.
fn buildings(drawings: &[BuildingDrawing]) -> Result<Vec<PatchBuilding>, Refused> {
    let building = |(i, drawing): (usize, &BuildingDrawing)| {
        let BuildingDrawing { outline, height, storeys } = drawing;
        let refused = |field: &str, defect: Defect| Err(defect.at(format!("window.buildings[{i}].{field}")));
        if !CORNERS.contains(&outline.len()) {
            return refused("outline", Defect::Corners(i, outline.len()));
        }
        if let Some(far) = outline.iter().flat_map(|p| [p.0, p.1]).find(|x| !(-REACH..=REACH).contains(x)) {
            return refused("outline", Defect::BuildingAt(i, far));
        }
        let mut outline: Vec<DVec2> = outline.iter().map(|p| DVec2::from(*p)).collect();
        let area = signed_area(&outline);
        if area.abs() < LEAST_BUILDING || !is_simple(&outline) {
            return refused("outline", Defect::NoOutline(i));
        }
        if area < 0.0 {
            outline.reverse();
        }
        if let Some(height) = height.filter(|height| !HEIGHTS.contains(height)) {
            let allowed = (*HEIGHTS.start(), *HEIGHTS.end());
            return refused("height", Defect::BuildingValue(i, "height", height, allowed));
        }
        if let Some(storeys) = storeys.filter(|storeys| !STOREYS.contains(storeys)) {
            let allowed = (f64::from(*STOREYS.start()), f64::from(*STOREYS.end()));
            return refused("storeys", Defect::BuildingValue(i, "storeys", f64::from(storeys), allowed));
        }
        Ok(PatchBuilding { outline, height: *height, storeys: *storeys })
    };
    drawings.iter().enumerate().map(building).collect()
}

/// Whether a tag is lower-case words joined by `-`.
fn is_tag(tag: &str) -> bool {
    let is_word = |w: &str| !w.is_empty() && w.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit());
    tag.split('-').all(is_word)
}

/// The positions of the vertices, each its own place.
fn places(vertices: &[(f64, f64)]) -> Result<Vec<DVec2>, Refused> {
    for (i, (x, y)) in vertices.iter().enumerate() {
        if let Some(c) = [*x, *y].into_iter().find(|c| !(-REACH..=REACH).contains(c)) {
            return Err(Defect::Coordinate(c).at(format!("vertices[{i}]")));
        }
    }
    if !(2..=MOST_VERTICES).contains(&vertices.len()) {
        return Err(Defect::VertexCount(vertices.len()).at("vertices"));
    }
    let places: Vec<DVec2> = vertices.iter().map(|(x, y)| quantize(DVec2::new(*x, *y))).collect();
    for (i, a) in places.iter().enumerate() {
        if let Some(j) = places[..i].iter().position(|b| b.distance(*a) < TOUCH) {
            return Err(Defect::SamePlace(j, i).at(format!("vertices[{i}]")));
        }
    }
    Ok(places)
}

/// The indices of the vertices of a drawn line.
fn indices(Line(line): &Line, what: &'static str, count: usize) -> Result<Vec<usize>, Defect> {
    if line.len() < 2 {
        return Err(Defect::ShortStreet(line.len()));
    }
    if let Some(w) = line.windows(2).find(|w| w[0] == w[1]) {
        return Err(Defect::StreetToItself(w[0]));
    }
    let index = |i: &i64| match usize::try_from(*i) {
        Err(_) => Err(Defect::NegativeIndex(*i)),
        Ok(index) if index >= count => Err(Defect::DanglingIndex { what, index: *i, count }),
        Ok(index) => Ok(index),
    };
    line.iter().map(index).collect()
}

/// The edges of the drawn lines, edges of `streets` first.
fn edges(streets: &[Line], main: &[Line], classes: &[StreetClass], count: usize) -> Result<Vec<PatchEdge>, Refused> {
    let mut edges: Vec<PatchEdge> = Vec::new();
    let mut known: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let streets = streets.iter().enumerate().map(|(i, l)| (i, l, false));
    for (i, line, main) in streets.chain(main.iter().enumerate().map(|(i, l)| (i, l, true))) {
        let (what, field) = if main { ("`main`", "main") } else { ("a street", "streets") };
        let usual = if main { StreetClass::Main } else { StreetClass::Local };
        let class = classes.get(i).copied().filter(|_| !main).unwrap_or(usual);
        let here = |defect: Defect| defect.at(format!("{field}[{i}]"));
        for w in indices(line, what, count).map_err(here)?.windows(2) {
            let (a, b) = (w[0], w[1]);
            match known.get(&(a.min(b), a.max(b))) {
                Some(&e) if main && !edges[e].main => (edges[e].main, edges[e].class) = (true, class),
                Some(_) => return Err(here(Defect::DuplicateEdge(a, b))),
                None => {
                    known.insert((a.min(b), a.max(b)), edges.len());
                    edges.push(PatchEdge { a, b, main, class });
                }
            }
        }
    }
    if edges.iter().all(|e| e.main) { Err(Defect::NoStreets.at("streets")) } else { Ok(edges) }
}

/// Indices of the edges at each vertex.
fn around(count: usize, edges: &[PatchEdge]) -> Vec<Vec<usize>> {
    let mut around = vec![Vec::new(); count];
    for (i, e) in edges.iter().enumerate() {
        around[e.a].push(i);
        around[e.b].push(i);
    }
    around
}

fn check_geometry(places: &[DVec2], edges: &[PatchEdge], around: &[Vec<usize>]) -> Result<(), Refused> {
    for (at, here) in around.iter().enumerate() {
        for (i, e) in here.iter().enumerate() {
            let a = edges[*e].other(at);
            for f in &here[..i] {
                let b = edges[*f].other(at);
                let angle = angle_between(places[a] - places[at], places[b] - places[at]).to_degrees();
                // Half a thousandth of a degree for the rounding of positions.
                if angle < LEAST_ANGLE - 5e-4 {
                    return Err(Defect::SharpAngle { at, a: b, b: a, angle }.at(format!("vertices[{at}]")));
                }
            }
        }
    }
    for (i, e) in edges.iter().enumerate() {
        for f in &edges[..i] {
            let meet = [f.a, f.b].iter().any(|v| *v == e.a || *v == e.b);
            if !meet && segment_distance(places[e.a], places[e.b], places[f.a], places[f.b]) < TOUCH {
                let field = if e.main { "main" } else { "streets" };
                return Err(Defect::Crossing((f.a, f.b), (e.a, e.b)).at(field));
            }
        }
    }
    Ok(())
}

fn check_connected(edges: &[PatchEdge], around: &[Vec<usize>]) -> Result<(), Refused> {
    let mut reached = BTreeSet::from([0]);
    let mut stack = vec![0];
    while let Some(v) = stack.pop() {
        stack.extend(around[v].iter().map(|e| edges[*e].other(v)).filter(|w| reached.insert(*w)));
    }
    match (0..around.len()).find(|v| !reached.contains(v)) {
        Some(v) => Err(Defect::Unconnected(0, v).at(format!("vertices[{v}]"))),
        None => Ok(()),
    }
}

/// Pairs of connectable vertices that local streets connect, nearest first.
fn pairs(vertices: &[DVec2], connectables: &[Connectable], edges: &[PatchEdge]) -> Vec<Pair> {
    let at = |i: usize| vertices[connectables[i].vertex];
    let mut parts = DisjointSets::new();
    for e in edges.iter().filter(|e| !e.main) {
        parts.union(e.a, e.b);
    }
    let part: Vec<usize> = connectables.iter().map(|c| parts.find(c.vertex)).collect();
    let mut pairs: Vec<Pair> = (0..connectables.len())
        .flat_map(|b| (0..b).map(move |a| Pair { a, b, distance: at(a).distance(at(b)) }))
        .filter(|pair| part[pair.a] == part[pair.b])
        .collect();
    pairs.sort_by(|x, y| x.distance.total_cmp(&y.distance).then((x.a, x.b).cmp(&(y.a, y.b))));
    pairs
}

/// Centre of the smallest circle around `points` (at least one): each point that the circle so far leaves out lies on the
/// border of the next one.
fn bounding_circle(points: &[DVec2]) -> DVec2 {
    let outside = |(centre, radius): (DVec2, f64), p: DVec2| centre.distance(p) > radius * (1.0 + 1e-12);
    let across = |a: DVec2, b: DVec2| ((a + b) / 2.0, a.distance(b) / 2.0);
    let mut circle = (points[0], 0.0);
    for (i, &a) in points.iter().enumerate() {
        if !outside(circle, a) {
            continue;
        }
        circle = (a, 0.0);
        for (j, &b) in points[..i].iter().enumerate() {
            if !outside(circle, b) {
                continue;
            }
            circle = across(a, b);
            for &c in &points[..j] {
                if outside(circle, c) {
                    circle = through(a, b, c).unwrap_or(circle);
                }
            }
        }
    }
    circle.0
}

/// Centre and radius of the circle through three points, unless they lie on a line.
fn through(a: DVec2, b: DVec2, c: DVec2) -> Option<(DVec2, f64)> {
    let (ab, ac) = (b - a, c - a);
    let twice = 2.0 * ab.perp_dot(ac);
    if twice == 0.0 {
        return None;
    }
    let (bb, cc) = (ab.length_squared(), ac.length_squared());
    let to_centre = DVec2::new(ac.y * bb - ab.y * cc, ab.x * cc - ac.x * bb) / twice;
    Some((a + to_centre, to_centre.length()))
}

impl Patch {
    /// The patch as a planar graph; its edges carry whether they are main, and vertices and edges keep their indices.
    pub(super) fn graph(&self) -> PlanarGraph<bool> {
        let mut graph = PlanarGraph::new();
        let vertices: Vec<_> = self.vertices.iter().map(|v| graph.add_vertex(*v)).collect();
        for e in &self.edges {
            graph.add_edge(vertices[e.a], vertices[e.b], e.main);
        }
        graph
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;

    #[test]
    fn the_bounding_circle_holds_all_points_and_is_the_least() {
        let mut s = Seed(11).stream("test", &[]);
        for n in 2..40 {
            let points: Vec<DVec2> = (0..n).map(|_| DVec2::new(s.range(-100.0, 90.0), s.range(-50.0, 120.0))).collect();
            let centre = bounding_circle(&points);
            let radius = |c: DVec2| points.iter().map(|p| p.distance(c)).fold(0.0, f64::max);
            for _ in 0..30 {
                let other = centre + DVec2::new(s.signed(), s.signed());
                assert!(radius(other) >= radius(centre) - 1e-9, "{points:?}");
            }
        }
        assert_eq!(bounding_circle(&[DVec2::ZERO, DVec2::X * 2.0, DVec2::X * 8.0]), DVec2::X * 4.0);
    }
}
