//! The graph whose faces are the main cells: main streets, the outline, and cuts that divide the fringe between them.

use super::border::BorderStreets;
use super::river::River;
use super::sketch::Sketch;
use crate::network::{EdgeIx, Face, PlanarGraph, StreetClass, VertexIx};
use crate::space::{Bounds, closest_on_segment, pole};
use glam::DVec2;

/// Least angle between a cut and what it meets, in radians.
const CUT_ANGLE: f64 = 0.65;
/// Distance that cuts keep from streets and from the outline, in metres.
const CUT_GAP: f64 = 30.0;
/// Fringe cells larger than this many cells of regular growth are divided.
const LARGE: f64 = 1.25;
/// Least length of main streets along both parts of a divided fringe cell, in metres and as a share of the length of a
/// street: land without a street stays empty.
const LEAST_FRONTAGE: (f64, f64) = (140.0, 0.75);
/// Fringe cells whose largest inscribed circle has a smaller radius than this are merged with a neighbour, in metres.
const SLIM: f64 = 26.0;
/// Fringe cells with less than this share of the area of a cell of regular growth are merged with a neighbour.
const SMALL: f64 = 0.12;
/// Greatest area of a merged fringe cell, in cells of regular growth.
const MERGED: f64 = 2.0;
/// Number of cuts that are tried in one face.
const MOST_TRIES: usize = 120;
/// Least width of a cell of regular growth, in metres: the first anywhere, since villages have short streets; the second where
/// one street runs through, so that there is room for lanes between the street and the fields.
const LEAST_WIDTH: (f64, f64) = (170.0, 260.0);

/// A graph of cell boundaries. Edges of main streets carry the class; edges of the outline and of cuts carry `None`. The
/// vertices and edges of the sketch come first, in their order, then the vertices of the outline that are not gates.
type BoundaryGraph = PlanarGraph<Option<StreetClass>>;

/// Main streets, outline and cuts: every inner face is a main cell.
pub(super) struct CellGraph {
    pub graph: BoundaryGraph,
    /// The sketch's edges that the first edges of `graph` are copies of.
    pub edges: Vec<EdgeIx>,
}

/// A cut that could divide a face.
struct Cut {
    cost: f64,
    from: VertexIx,
    to: VertexIx,
}

/// Joins the network and the outline, and cuts the fringe into cells. No cut starts at a street along a border, since the
/// neighbour has the same street.
pub(super) fn cell_graph(sketch: &Sketch, borders: &BorderStreets) -> CellGraph {
    let mut graph = BoundaryGraph::new();
    for v in sketch.graph.vertices() {
        graph.add_vertex(sketch.graph.at(v));
    }
    let mut edges = Vec::new();
    for (e, edge) in sketch.graph.edges() {
        graph.add_edge(edge.a, edge.b, Some(edge.data));
        edges.push(e);
    }
    let streets = graph.vertex_count() as VertexIx;
    let site = &sketch.site;
    let ring: Vec<VertexIx> = (0..site.outline.len())
        .map(|i| {
            let gate = site.gates.iter().position(|g| g.vertex == i);
            let known = borders.vertex(i).or_else(|| gate.and_then(|g| sketch.gate_vertices[g]));
            known.unwrap_or_else(|| graph.add_vertex(site.outline[i]))
        })
        .collect();
    for i in 0..ring.len() {
        let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
        if graph.edge_between(a, b).is_none() {
            graph.add_edge(a, b, None);
        }
    }
    if let Some(river) = &site.river {
        add_bank_lines(&mut graph, sketch, river, &ring);
    }
    let fringe = Fringe { sketch, borders, streets, ring };
    fringe.join(&mut graph);
    let first_cut = graph.edges().map(|(e, _)| e + 1).max().unwrap_or(0);
    fringe.divide(&mut graph);
    fringe.merge(&mut graph, first_cut);
    CellGraph { graph, edges }
}

/// Adds the bank lines, which bound the cells beside a river where there is no quay.
fn add_bank_lines(graph: &mut BoundaryGraph, sketch: &Sketch, river: &River, ring: &[VertexIx]) {
    for side in 0..2 {
        let streets = sketch.graph.vertices().filter(|v| sketch.graph.degree(*v) > 0);
        let on_line = streets.map(|v| (sketch.graph.at(v), v)).filter(|(p, _)| river.way.bank_at(*p) == Some(side));
        let ends = river.way.ends[side].map(|i| (sketch.site.outline[i], ring[i]));
        let mut before = None;
        for (p, known) in river.bank_points(side, on_line.chain(ends)) {
            let v = known.unwrap_or_else(|| graph.add_vertex(p));
            if let Some(u) = before
                && graph.edge_between(u, v).is_none()
            {
                graph.add_edge(u, v, None);
            }
            before = Some(v);
        }
    }
}

/// The land between the network and the outline.
struct Fringe<'a> {
    sketch: &'a Sketch<'a>,
    borders: &'a BorderStreets,
    /// Vertices below this index are the sketch's.
    streets: VertexIx,
    /// Vertices of the outline.
    ring: Vec<VertexIx>,
}

impl Fringe<'_> {
    /// Joins the network to the outline by the best cut, if no gate and no river does.
    fn join(&self, graph: &mut BoundaryGraph) {
        let joined = graph.components().into_iter().flatten().all(|c| c == 0);
        if joined || self.sketch.gate_vertices.iter().any(Option::is_some) {
            return;
        }
        let mut cuts = Vec::new();
        for from in (0..self.streets).filter(|v| graph.degree(*v) > 0) {
            for &to in &self.ring {
                let cost = graph.at(from).distance(graph.at(to)) + self.vertex_cost(graph, from);
                cuts.push(Cut { cost, from, to });
            }
        }
        cuts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        // A triangulation of the fringe has an edge from the network to the outline, so the second search finds one.
        let found = cuts.iter().find(|c| fits(graph, c, true)).or_else(|| cuts.iter().find(|c| fits(graph, c, false)));
        if let Some(cut) = found {
            graph.add_edge(cut.from, cut.to, None);
        }
    }

    /// Cuts fringe faces until none is too large and none walks along both sides of a street or cut.
    fn divide(&self, graph: &mut BoundaryGraph) {
        let regular = self.regular();
        // Faces without a good cut, named by the first half-edge and the length of their walk, which cuts elsewhere keep.
        let mut uncut = Vec::new();
        for _ in 0..8 {
            let mut changed = false;
            for face in graph.faces() {
                let area = face.area();
                let river = self.sketch.site.river.as_ref();
                if area <= 0.0 || river.is_some_and(|river| river.is_water(graph, &face)) {
                    continue;
                }
                let twice = walked_twice(&face);
                let on_outline = face.walk.iter().any(|h| {
                    let e = graph.edge(h.edge);
                    e.data.is_none() && e.a >= self.streets && e.b >= self.streets
                });
                if twice.is_none() && (!on_outline || area < LARGE * regular) {
                    continue;
                }
                let name = (face.walk[0], face.walk.len());
                if !uncut.contains(&name) {
                    let cut = self.cut(graph, &face, twice, regular);
                    changed |= cut;
                    if !cut {
                        uncut.push(name);
                    }
                }
            }
            if !changed {
                break;
            }
        }
    }

    /// Merges faces that are small, slim or short of streets with a neighbour, by removing a cut between them. Only cuts whose
    /// index is `first_cut` or more may be removed.
    fn merge(&self, graph: &mut BoundaryGraph, first_cut: EdgeIx) {
        let (regular, frontage) = (self.regular(), self.least_frontage());
        // Each round removes a cut, so this ends. The bound only limits the time.
        for _ in 0..200 {
            let faces = graph.faces();
            let is_cut = |e: EdgeIx| e >= first_cut && graph.edge(e).data.is_none();
            let poor = |f: &&Face| {
                let streets = f.walk.iter().filter(|h| graph.edge(h.edge).data.is_some());
                let street: f64 = streets.map(|h| graph.edge_length(h.edge)).sum();
                f.area() > 0.0
                    && f.walk.iter().any(|h| is_cut(h.edge))
                    && (street < frontage || f.area() < SMALL * regular || pole(&f.polygon, 2.0).1 < SLIM)
            };
            let merges = |f: &Face, cut: EdgeIx| {
                let other = faces.iter().find(|o| o.walk[0] != f.walk[0] && o.walk.iter().any(|h| h.edge == cut));
                other.is_some_and(|o| {
                    let common = o.walk.iter().filter(|h| f.walk.iter().any(|k| k.edge == h.edge)).count();
                    o.area() > 0.0 && common == 1 && o.area() + f.area() < MERGED * regular
                })
            };
            let found = faces.iter().filter(poor).find_map(|f| {
                let mut cuts: Vec<EdgeIx> = f.walk.iter().map(|h| h.edge).filter(|e| is_cut(*e)).collect();
                cuts.sort_by(|a, b| graph.edge_length(*b).total_cmp(&graph.edge_length(*a)).then(a.cmp(b)));
                cuts.into_iter().find(|cut| merges(f, *cut))
            });
            match found {
                Some(cut) => graph.remove_edge(cut),
                None => break,
            };
        }
    }

    /// Area of a cell of regular growth, in square metres.
    fn regular(&self) -> f64 {
        let rules = &self.sketch.rules;
        let least = if rules.degree.1 == 2 { LEAST_WIDTH.1 } else { LEAST_WIDTH.0 };
        let length = rules.length.max(least);
        length * length
    }

    fn least_frontage(&self) -> f64 {
        LEAST_FRONTAGE.0.max(LEAST_FRONTAGE.1 * self.sketch.rules.length)
    }

    /// Cuts one face; returns whether there is a cut that fits.
    fn cut(&self, graph: &mut BoundaryGraph, face: &Face, twice: Option<(usize, usize)>, regular: f64) -> bool {
        let (n, area, length) = (face.walk.len(), face.area(), self.sketch.rules.length);
        let separates = |i: usize, j: usize| {
            twice.is_none_or(|(p, q)| {
                let within = |k: usize| k > i.min(j) && k < i.max(j);
                within(p) != within(q) && ![p, q].contains(&i) && ![p, q].contains(&j)
            })
        };
        // For each point of the walk, twice the area swept so far as seen from the first point, and the length of streets so far.
        let o = face.polygon[0];
        let (mut swept, mut front) = (vec![0.0; n], vec![0.0; n + 1]);
        for i in 0..n {
            let street = graph.edge(face.walk[i].edge).data.is_some();
            let length = face.polygon[i].distance(face.polygon[(i + 1) % n]);
            front[i + 1] = front[i] + if street { length } else { 0.0 };
        }
        for i in 1..n {
            swept[i] = swept[i - 1] + (face.polygon[i - 1] - o).perp_dot(face.polygon[i] - o);
        }
        let part =
            |i: usize, j: usize| (swept[j] - swept[i] + (face.polygon[j] - o).perp_dot(face.polygon[i] - o)) / 2.0;
        let mut cuts = Vec::new();
        for i in 0..n {
            let from = face.vertices[i];
            if from >= self.streets || self.sketch.is_gate(from) || self.borders.passes(from) {
                continue;
            }
            for j in (0..n).filter(|j| face.vertices[*j] >= self.streets && separates(i, *j)) {
                let to = face.vertices[j];
                let distance = graph.at(from).distance(graph.at(to));
                if twice.is_none() && distance > 2.0 * length {
                    continue;
                }
                let part = part(i.min(j), i.max(j));
                let least = part.min(area - part);
                let frontage = front[i.max(j)] - front[i.min(j)];
                let frontage = frontage.min(front[n] - frontage);
                if twice.is_none() && (least < 0.3 * regular || frontage < self.least_frontage()) {
                    continue;
                }
                let balance = (least / area).max(0.02);
                let cost = distance + self.vertex_cost(graph, from) + 0.35 * length * (0.5 / balance - 1.0);
                cuts.push(Cut { cost, from, to });
            }
        }
        cuts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let tries = if twice.is_some() { cuts.len() } else { MOST_TRIES };
        let mut found = cuts.iter().take(tries).find(|c| fits(graph, c, true));
        if found.is_none() && twice.is_some() {
            found = cuts.iter().find(|c| fits(graph, c, false));
        }
        if let Some(cut) = found {
            graph.add_edge(cut.from, cut.to, None);
        }
        found.is_some()
    }

    /// Cost of a cut from a vertex, in metres: a cut from a point of inflexion divides a street.
    fn vertex_cost(&self, graph: &BoundaryGraph, v: VertexIx) -> f64 {
        if graph.degree(v) == 2 { 60.0 } else { 0.0 }
    }
}

/// Two visits of a walk to one vertex, as indices: of all such pairs the pair farthest apart.
fn walked_twice(face: &Face) -> Option<(usize, usize)> {
    let mut visits: Vec<(VertexIx, usize)> = face.vertices.iter().copied().zip(0..).collect();
    visits.sort_unstable();
    let n = face.walk.len();
    // The pair farthest apart leaves the most room for a cut.
    let pairs = visits.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| (w[0].1, w[1].1));
    pairs.max_by_key(|(p, q)| ((q - p).min(n - (q - p)), std::cmp::Reverse(*p)))
}

/// Whether a cut crosses nothing. If `strict`, it also keeps the least angle and the least distance to everything else.
fn fits(graph: &BoundaryGraph, cut: &Cut, strict: bool) -> bool {
    let (a, b) = (graph.at(cut.from), graph.at(cut.to));
    let at_end = |e: EdgeIx| {
        let edge = graph.edge(e);
        [edge.a, edge.b].iter().any(|v| *v == cut.from || *v == cut.to)
    };
    let least = if strict { CUT_ANGLE } else { 0.05 };
    if graph.edge_between(cut.from, cut.to).is_some()
        || graph.smallest_angle(cut.from, b - a) < least
        || graph.smallest_angle(cut.to, a - b) < least
        || graph.first_hit(a, b, at_end).is_some()
    {
        return false;
    }
    let length = a.distance(b);
    let gap = CUT_GAP.min(0.25 * length);
    // The distance to other edges may be less near both ends.
    let clear = |e: EdgeIx| {
        let (c, d) = graph.segment(e);
        let near = |p: DVec2| {
            let (t, q) = closest_on_segment(p, a, b);
            q.distance(p) >= gap.min(0.5 * length * t.min(1.0 - t))
        };
        at_end(e) || (near(c) && near(d))
    };
    !strict || graph.edges_near(Bounds::of([a, b]).grown(gap)).into_iter().all(clear)
}
