//! From the drawing of a patch to the patch: what a drawing may not hold, the centre, the connectable vertices.

use crate::network::PlanarGraph;
use crate::patch::file::{Line, Name, PatchDrawing, Tag, Weight};
use crate::patch::{Connectable, Pair, Patch, PatchEdge};
use crate::space::{math::angle_between, quantize, segment_distance};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// Greatest number of vertices of a patch: it is a small example, and the checks compare all its edges.
const MOST_VERTICES: usize = 512;
/// Positions and edges nearer than this, in metres, count as the same place.
const TOUCH: f64 = 0.25;
/// Least angle between two edges at a vertex, in degrees.
const LEAST_ANGLE: f64 = 20.0;

/// What is wrong with the drawing of a patch, and what is allowed.
#[derive(Debug, PartialEq, thiserror::Error)]
pub(super) enum Defect {
    #[error("it has {0} vertices; allowed is 2 to {MOST_VERTICES}")]
    VertexCount(usize),
    #[error("it has no local streets (main ones are not built); draw one in `streets`, such as (0, 1)")]
    NoStreets,
    #[error("{what} names vertex {index}, but there are {count} vertices, 0 to {}", count - 1)]
    DanglingIndex { what: &'static str, index: usize, count: usize },
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

/// The patch that a drawing describes.
pub(super) fn check_patch(drawing: PatchDrawing) -> Result<Patch, String> {
    let name = drawing.name.0.clone();
    build(drawing).map_err(|defect| format!("patch `{name}`: {defect}"))
}

fn build(drawing: PatchDrawing) -> Result<Patch, Defect> {
    let PatchDrawing { name: Name(name), vertices, streets, main, dead_ends, tags, weight: Weight(weight), at_most } =
        drawing;
    let places: Vec<DVec2> = vertices.iter().map(|p| p.0).collect();
    if !(2..=MOST_VERTICES).contains(&places.len()) {
        return Err(Defect::VertexCount(places.len()));
    }
    for (i, a) in places.iter().enumerate() {
        if let Some(j) = places[..i].iter().position(|b| b.distance(*a) < TOUCH) {
            return Err(Defect::SamePlace(j, i));
        }
    }
    let edges = edges(&streets, &main, places.len())?;
    let around = around(places.len(), &edges);
    if let Some(v) = around.iter().position(Vec::is_empty) {
        return Err(Defect::UnusedVertex(v));
    }
    for &index in &dead_ends {
        match around.get(index) {
            None => return Err(Defect::DanglingIndex { what: "`dead_ends`", index, count: places.len() }),
            Some(edges) if edges.len() != 1 => return Err(Defect::NoDeadEnd(index, edges.len())),
            Some(_) => {}
        }
    }
    check_geometry(&places, &edges, &around)?;

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
        pairs: pairs(&vertices, &connectables),
        vertices,
        edges,
        tags: tags.into_iter().map(|Tag(t)| t).collect(),
        weight,
        at_most,
        connectables,
    };
    let found = patch.find_tags();
    patch.tags.extend(found.into_iter().map(str::to_owned));
    Ok(patch)
}

/// The edges of the drawn lines, those of `streets` first.
fn edges(streets: &[Line], main: &[Line], count: usize) -> Result<Vec<PatchEdge>, Defect> {
    let mut edges: Vec<PatchEdge> = Vec::new();
    let mut known: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let lines = streets.iter().map(|l| (l, false)).chain(main.iter().map(|l| (l, true)));
    for (Line(line), main) in lines {
        if let Some(&index) = line.iter().find(|v| **v >= count) {
            let what = if main { "`main`" } else { "a street" };
            return Err(Defect::DanglingIndex { what, index, count });
        }
        for w in line.windows(2) {
            let (a, b) = (w[0], w[1]);
            match known.get(&(a.min(b), a.max(b))) {
                Some(&e) if main && !edges[e].main => edges[e].main = true,
                Some(_) => return Err(Defect::DuplicateEdge(a, b)),
                None => {
                    known.insert((a.min(b), a.max(b)), edges.len());
                    edges.push(PatchEdge { a, b, main });
                }
            }
        }
    }
    if edges.iter().all(|e| e.main) { Err(Defect::NoStreets) } else { Ok(edges) }
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

fn check_geometry(places: &[DVec2], edges: &[PatchEdge], around: &[Vec<usize>]) -> Result<(), Defect> {
    for (at, here) in around.iter().enumerate() {
        for (i, e) in here.iter().enumerate() {
            let a = edges[*e].other(at);
            for f in &here[..i] {
                let b = edges[*f].other(at);
                let angle = angle_between(places[a] - places[at], places[b] - places[at]).to_degrees();
                // Half a thousandth of a degree for the rounding of positions.
                if angle < LEAST_ANGLE - 5e-4 {
                    return Err(Defect::SharpAngle { at, a: b, b: a, angle });
                }
            }
        }
    }
    for (i, e) in edges.iter().enumerate() {
        for f in &edges[..i] {
            let meet = [f.a, f.b].iter().any(|v| *v == e.a || *v == e.b);
            if !meet && segment_distance(places[e.a], places[e.b], places[f.a], places[f.b]) < TOUCH {
                return Err(Defect::Crossing((f.a, f.b), (e.a, e.b)));
            }
        }
    }
    let mut reached = BTreeSet::from([0]);
    let mut stack = vec![0];
    while let Some(v) = stack.pop() {
        stack.extend(around[v].iter().map(|e| edges[*e].other(v)).filter(|w| reached.insert(*w)));
    }
    match (0..places.len()).find(|v| !reached.contains(v)) {
        Some(v) => Err(Defect::Unconnected(0, v)),
        None => Ok(()),
    }
}

/// Pairs of connectable vertices, nearest first.
fn pairs(vertices: &[DVec2], connectables: &[Connectable]) -> Vec<Pair> {
    let at = |i: usize| vertices[connectables[i].vertex];
    let mut pairs: Vec<Pair> = (0..connectables.len())
        .flat_map(|b| (0..b).map(move |a| Pair { a, b, distance: at(a).distance(at(b)) }))
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
