//! What a patch means for growth, found from its geometry (Teng 2017, section 3.1 and Table 1).

use crate::network::{Face, VertexIx, is_round};
use crate::patch::{Patch, tag};
use crate::space::math::turn;
use crate::space::{cross, distance_to_segment};
use glam::DVec2;

/// Distance from a line, in metres, up to which vertices still lie on it.
const STRAIGHT: f64 = 0.5;

/// The straight main street that an initial patch is attached to.
#[derive(Clone, Debug, PartialEq)]
pub struct MainLine {
    /// End of the main street with the attachment on the left, going to `to`; index into [`Patch::vertices`].
    pub from: usize,
    /// The other end.
    pub to: usize,
    /// Vertices on it from which local streets leave, in order from `from` to `to`.
    pub attachments: Vec<usize>,
}

impl Patch {
    /// Whether the tags of the patch let it be used: it has at least one tag of `allow`, unless that is empty, and none of
    /// `exclude`.
    pub fn is_allowed(&self, allow: &[String], exclude: &[String]) -> bool {
        (allow.is_empty() || allow.iter().any(|t| self.tags.contains(t)))
            && !exclude.iter().any(|t| self.tags.contains(t))
    }

    /// Whether the streets of the patch do not hang together ([`tag::IN_PIECES`]).
    pub fn is_in_pieces(&self) -> bool {
        self.tags.contains(tag::IN_PIECES)
    }

    /// Indices of the edges at a vertex, in the order of the file.
    pub fn edges_at(&self, vertex: usize) -> impl Iterator<Item = usize> + '_ {
        self.edges.iter().enumerate().filter(move |(_, e)| e.a == vertex || e.b == vertex).map(|(i, _)| i)
    }

    /// Number of edges at a vertex.
    pub fn degree(&self, vertex: usize) -> usize {
        self.edges_at(vertex).count()
    }

    /// Whether the network may go on at a vertex ([`tag::CONNECTABLE`]).
    pub fn is_connectable(&self, vertex: usize) -> bool {
        self.connectables.iter().any(|c| c.vertex == vertex)
    }

    /// Whether three or more edges meet at a vertex ([`tag::INTERSECTION`]).
    pub fn is_intersection(&self, vertex: usize) -> bool {
        self.degree(vertex) >= 3
    }

    /// Whether an edge is local and ends without a connectable vertex ([`tag::DEAD_END`]).
    pub fn is_dead_end(&self, edge: usize) -> bool {
        let e = self.edges[edge];
        !e.main && [e.a, e.b].iter().any(|v| self.degree(*v) == 1 && !self.is_connectable(*v))
    }

    /// Whether an edge is local and at an intersection ([`tag::SNAPPABLE`]).
    pub fn is_snappable(&self, edge: usize) -> bool {
        let e = self.edges[edge];
        !e.main && (self.is_intersection(e.a) || self.is_intersection(e.b))
    }

    /// Tags of a vertex.
    pub fn vertex_tags(&self, vertex: usize) -> Vec<&'static str> {
        let tags = [(tag::CONNECTABLE, self.is_connectable(vertex)), (tag::INTERSECTION, self.is_intersection(vertex))];
        tags.into_iter().filter(|(_, is)| *is).map(|(tag, _)| tag).collect()
    }

    /// Tags of an edge.
    pub fn edge_tags(&self, edge: usize) -> Vec<&'static str> {
        let main = self.edges[edge].main;
        let (dead_end, snappable) = (self.is_dead_end(edge), self.is_snappable(edge));
        let tags = [(tag::DEAD_END, dead_end), (tag::SNAPPABLE, snappable), (tag::MAIN, main), (tag::LOCAL, !main)];
        tags.into_iter().filter(|(_, is)| *is).map(|(tag, _)| tag).collect()
    }

    /// The streets, each as the vertices that it runs through: from one end, intersection, or change between main and
    /// local, to the next. A loop without any begins and ends at its first vertex.
    pub fn streets(&self) -> Vec<Vec<usize>> {
        let graph = self.graph();
        let ends = |v: VertexIx| match graph.edges_at(v) {
            [e, f] => graph.edge(*e).data != graph.edge(*f).data,
            _ => true,
        };
        let chains = graph.chains(ends);
        chains.iter().map(|c| graph.chain_vertices(c).iter().map(|v| *v as usize).collect()).collect()
    }

    /// The main street of a patch that can stand along one: a straight line, with local streets that hang together and lie on one
    /// side of it. With a connectable vertex, it is fit to start the growth of a cell from ([`tag::INITIAL`]).
    pub fn main_line(&self) -> Option<MainLine> {
        let on_main = |v: usize| self.edges_at(v).any(|e| self.edges[e].main);
        let main: Vec<usize> = (0..self.vertices.len()).filter(|v| on_main(*v)).collect();
        // The two ends of the main street are the two vertices on it that are farthest apart.
        let (from, to) = main
            .iter()
            .flat_map(|a| main.iter().filter(move |b| a < *b).map(move |b| (*a, *b)))
            .max_by(|x, y| self.distance(x.0, x.1).total_cmp(&self.distance(y.0, y.1)))?;
        let (start, end) = (self.vertices[from], self.vertices[to]);
        let straight = |v: &usize| distance_to_segment(self.vertices[*v], start, end) <= STRAIGHT;
        let length: f64 = self.edges.iter().filter(|e| e.main).map(|e| self.distance(e.a, e.b)).sum();
        if !main.iter().all(straight) || (length - start.distance(end)).abs() > STRAIGHT {
            return None;
        }

        let along = (end - start).normalize();
        let side = |v: usize| cross(along, self.vertices[v] - start);
        let off: Vec<usize> = (0..self.vertices.len()).filter(|v| !on_main(*v)).collect();
        let left = off.iter().all(|v| side(*v) > STRAIGHT);
        let right = off.iter().all(|v| side(*v) < -STRAIGHT);
        if off.is_empty() || !(left || right) || !self.locals_hang_together() {
            return None;
        }
        let (from, to, along) = if left { (from, to, along) } else { (to, from, -along) };
        let mut attachments: Vec<usize> =
            main.into_iter().filter(|v| self.edges_at(*v).any(|e| !self.edges[e].main)).collect();
        attachments.sort_by(|a, b| along.dot(self.vertices[*a]).total_cmp(&along.dot(self.vertices[*b])));
        Some(MainLine { from, to, attachments })
    }

    /// Where the next element of a pattern continues: from the first position to the second, when the patch is repeated.
    /// The ends of its main street, or else its two connectable vertices that are farthest apart. `None` when it has
    /// neither.
    pub fn repeat_line(&self) -> Option<(DVec2, DVec2)> {
        if let Some(main) = self.main_line() {
            return Some((self.vertices[main.from], self.vertices[main.to]));
        }
        let pair = self.pairs.last()?;
        let at = |c: usize| self.vertices[self.connectables[c].vertex];
        Some((at(pair.a), at(pair.b)))
    }

    /// Whether the patch can be the element of a pattern; else why it cannot, as the rest of a sentence about it.
    pub(super) fn may_repeat(&self) -> Result<(), String> {
        if self.repeat_line().is_none() {
            let needs =
                "a straight main street with streets on one side of it, or two ends at which the network goes on";
            return Err(format!("cannot be repeated: it needs {needs}"));
        }
        let local = |v: &usize| self.edges_at(*v).filter(|e| !self.edges[*e].main).count();
        let roots = self.main_line().map_or(Vec::new(), |main| main.attachments);
        match roots.iter().map(|v| (*v, local(v))).find(|(_, streets)| *streets > 1) {
            Some((v, streets)) => Err(format!(
                "cannot stand along a main street: {streets} streets leave that at vertex {v}; allowed is one at a place"
            )),
            None => Ok(()),
        }
    }

    fn distance(&self, a: usize, b: usize) -> f64 {
        self.vertices[a].distance(self.vertices[b])
    }

    pub(super) fn locals_hang_together(&self) -> bool {
        let Some(first) = self.edges.iter().find(|e| !e.main) else { return false };
        let mut reached = vec![false; self.vertices.len()];
        let mut stack = vec![first.a];
        while let Some(v) = stack.pop() {
            if !std::mem::replace(&mut reached[v], true) {
                stack.extend(self.edges_at(v).map(|e| &self.edges[e]).filter(|e| !e.main).map(|e| e.other(v)));
            }
        }
        self.edges.iter().all(|e| e.main || reached[e.a])
    }

    /// The tags of the patch as a whole.
    pub(super) fn find_tags(&self) -> Vec<&'static str> {
        let roundabout = self.roundabouts().next().is_some();
        let pieces = self.graph().components().into_iter().flatten().max().map_or(0, |last| last as usize + 1);
        let curved = roundabout || self.streets().iter().any(|s| self.is_curve(s));
        let tags = [
            (tag::ROUNDABOUT, roundabout),
            // A connected graph with as many edges as vertices has a cycle.
            (tag::LOOP, self.edges.len() + pieces > self.vertices.len()),
            (tag::CUL_DE_SAC, (0..self.edges.len()).any(|e| self.is_dead_end(e))),
            (tag::CURVED, curved),
            (tag::STRAIGHT, !curved),
            (tag::TERMINAL, self.connectables.len() == 1),
            (tag::INITIAL, self.main_line().is_some() && !self.connectables.is_empty()),
            (tag::IN_PIECES, pieces > 1),
        ];
        tags.into_iter().filter(|(_, is)| *is).map(|(tag, _)| tag).collect()
    }

    /// The rings of its roundabouts, as vertices.
    fn roundabouts(&self) -> impl Iterator<Item = Vec<VertexIx>> + '_ {
        self.graph().faces().into_iter().filter(|f| self.is_roundabout(f)).map(|f| f.vertices)
    }

    /// For each vertex whether it is on a roundabout, or on a curved street and no connectable end of that.
    pub(super) fn shaped_vertices(&self) -> Vec<bool> {
        let mut shaped = vec![false; self.vertices.len()];
        let curves = self.streets().into_iter().filter(|s| self.is_curve(s)).flatten().filter(|v| self.degree(*v) > 1);
        let rings = self.roundabouts().flatten().map(|v| v as usize);
        rings.chain(curves).for_each(|v| shaped[v] = true);
        shaped
    }

    fn is_roundabout(&self, face: &Face) -> bool {
        let ring = &face.polygon;
        let n = ring.len();
        let mut distinct = face.vertices.clone();
        distinct.sort_unstable();
        distinct.dedup();
        let arms = face.vertices.iter().filter(|v| self.is_intersection(**v as usize)).count();
        let main = face.walk.iter().any(|h| self.edges[h.edge as usize].main);
        if face.area() <= 0.0 || distinct.len() < n || arms < 2 || main {
            return false;
        }
        is_round(ring)
    }

    fn is_curve(&self, street: &[usize]) -> bool {
        let closed = street.len() > 3 && street.first() == street.last();
        let first = if closed { &street[1..2] } else { &[] };
        let line: Vec<DVec2> = street.iter().chain(first).map(|v| self.vertices[*v]).collect();
        let turns: Vec<f64> = line.windows(3).map(|w| turn(w[1] - w[0], w[2] - w[1]).to_degrees()).collect();
        (0..turns.len()).any(|from| {
            let (mut total, mut most) = (0.0f64, 0.0f64);
            turns[from..].iter().take_while(|t| t.abs() <= 60.0).any(|t| {
                (total, most) = (total + t, most.max(t.abs()));
                total.abs() >= 15.0 && most <= 0.75 * total.abs()
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::PatchSet;

    fn patch(fields: &str) -> Patch {
        let text = format!("(patches: [(name: \"p\", {fields})])");
        PatchSet::from_ron("p.ron", &text).unwrap().patches.remove(0)
    }

    /// A ring of `n` vertices of this radius, vertex 0 in the east, with a street out of each of `arms`.
    fn ring(n: usize, radius: f64, arms: &[usize]) -> Patch {
        let at = |i: usize, r: f64| crate::space::math::direction(i as f64 / n as f64 * std::f64::consts::TAU) * r;
        let mut vertices: Vec<DVec2> = (0..n).map(|i| at(i, radius)).collect();
        vertices.extend(arms.iter().map(|i| at(*i, radius + 50.0)));
        let vertices: Vec<String> = vertices.iter().map(|v| format!("({}, {})", v.x, v.y)).collect();
        let mut streets: Vec<String> = arms.iter().enumerate().map(|(k, i)| format!("({i}, {})", n + k)).collect();
        streets.push(format!("{:?}", (0..=n).map(|i| i % n).collect::<Vec<_>>()));
        patch(&format!("vertices: [{}], streets: [{}]", vertices.join(", "), streets.join(", ")))
    }

    fn assert_tags(patch: &Patch, expected: &[&str]) {
        let found: Vec<&str> = patch.tags.iter().map(String::as_str).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn roundabouts_are_small_round_dense_and_joined() {
        assert_tags(&ring(12, 16.0, &[0, 3, 6, 9]), &["curved", "loop", "roundabout"]);
        assert_tags(&ring(6, 40.0, &[0, 3]), &["curved", "loop", "roundabout"]);
        assert!(!ring(12, 44.0, &[0, 3, 6]).tags.contains(tag::ROUNDABOUT), "too wide");
        assert_tags(&ring(4, 20.0, &[0, 1, 2]), &["loop", "straight"]);
        assert_tags(&ring(12, 16.0, &[0]), &["curved", "loop", "terminal"]);
        // Six vertices round an oblong: no circle.
        let oblong = "vertices: [(0, 0), (30, 0), (60, 0), (60, 20), (30, 20), (0, 20), (-40, 0), (100, 20)],
            streets: [[0, 1, 2, 3, 4, 5, 0], (0, 6), (3, 7)]";
        assert_tags(&patch(oblong), &["loop", "straight"]);
        // A street inside: the ring is no longer a face without anything in it.
        let circle = ring(12, 30.0, &[0, 6]);
        let points: Vec<String> = circle.vertices.iter().map(|v| format!("({}, {})", v.x, v.y)).collect();
        let ring = format!("{:?}", (0..=12).map(|i| i % 12).collect::<Vec<_>>());
        let inside = format!(
            "vertices: [{}, (0, 5)], streets: [{ring}, (0, 12), (6, 13), (3, 14)], dead_ends: [14]",
            points.join(", ")
        );
        assert_tags(&patch(&inside), &["cul-de-sac", "curved", "loop"]);
    }

    #[test]
    fn curves_turn_one_way_more_than_once() {
        let line = |points: &str| {
            let n = points.matches('(').count();
            patch(&format!("vertices: [{points}], streets: [{:?}]", (0..n).collect::<Vec<_>>()))
        };
        assert_tags(&line("(0, 0), (15, 0), (29, 4), (42, 12)"), &["curved"]);
        assert_tags(&line("(0, 0), (40, 0)"), &["straight"]);
        assert_tags(&line("(0, 0), (40, 0), (40, 40)"), &["straight"]);
        assert_tags(&line("(0, 0), (40, 0), (70, 15)"), &["straight"]);
        assert_tags(&line("(0, 0), (40, 0), (80, 20), (120, 20), (160, 0)"), &["curved"]);
        assert_tags(&line("(0, 0), (40, 0), (80, 20), (120, 20), (160, 40)"), &["straight"]);
        assert_tags(&line("(0, 0), (40, 0), (80, 4), (120, 10), (160, 16)"), &["straight"]);
    }

    #[test]
    fn loops_culs_de_sac_and_terminals() {
        let square = "vertices: [(0, 0), (60, 0), (60, 60), (0, 60), (-50, 0), (110, 60)]";
        let with = |rest: &str| patch(&format!("{square}, {rest}"));
        assert_tags(&with("streets: [[0, 1, 2, 3, 0], (0, 4), (2, 5)]"), &["loop", "straight"]);
        assert_tags(&with("streets: [[4, 0, 1, 2, 5], (0, 3)]"), &["straight"]);
        let closed = with("streets: [[4, 0, 1, 2, 5], (0, 3)], dead_ends: [3]");
        assert_tags(&closed, &["cul-de-sac", "straight"]);
        let last = with("streets: [[4, 0, 1, 2, 5], (0, 3)], dead_ends: [3, 5]");
        assert_tags(&last, &["cul-de-sac", "straight", "terminal"]);
    }

    #[test]
    fn initial_patches_hang_on_one_side_of_one_straight_main_street() {
        let with = |rest: &str| {
            let vertices = "vertices: [(0, 0), (80, 0), (160, 0), (80, 70), (20, 75), (150, 80)]";
            patch(&format!("{vertices}, {rest}"))
        };
        let fork = with("main: [[0, 1, 2]], streets: [(1, 3), [4, 3, 5]]");
        assert_tags(&fork, &["initial", "straight"]);
        assert_eq!(fork.main_line(), Some(MainLine { from: 0, to: 2, attachments: vec![1] }));
        assert_eq!(fork.repeat_line().map(|(a, b)| b - a), Some(DVec2::new(160.0, 0.0)));
        let closed = with("main: [[0, 1, 2]], streets: [(1, 3), [4, 3, 5]], dead_ends: [4, 5]");
        assert_tags(&closed, &["cul-de-sac", "straight"]);
        let two = with("main: [[2, 1, 0]], streets: [(1, 3), (3, 4), (2, 5), (0, 4)], dead_ends: []");
        assert_tags(&two, &["loop", "straight", "terminal"]);
        let both =
            "vertices: [(0, 0), (80, 0), (160, 0), (80, 70), (80, -70)], main: [[0, 1, 2]], streets: [[3, 1, 4]]";
        assert_tags(&patch(both), &["straight"]);
        let bent = "vertices: [(0, 0), (80, 0), (160, 30), (80, 70)], main: [[0, 1, 2]], streets: [[3, 1]]";
        assert_tags(&patch(bent), &["straight", "terminal"]);
        let below = "vertices: [(0, 0), (80, 0), (160, 0), (60, -70), (120, -60)], main: [[0, 1, 2]],
            streets: [(3, 1), (1, 4)]";
        let below = patch(below);
        assert_eq!(below.main_line(), Some(MainLine { from: 2, to: 0, attachments: vec![1] }));
        assert!(patch("vertices: [(0, 0), (80, 0)], streets: [(0, 1)]").main_line().is_none());
    }

    #[test]
    fn vertices_and_edges_have_tags() {
        let p = patch(
            "vertices: [(0, 0), (80, 0), (160, 0), (80, 70), (20, 75), (150, 80), (200, 90)],
            main: [[0, 1, 2]], streets: [(1, 3), [4, 3, 5, 6]], dead_ends: [4]",
        );
        assert_eq!(p.vertex_tags(6), [tag::CONNECTABLE]);
        assert_eq!(p.vertex_tags(3), [tag::INTERSECTION]);
        assert!([0, 2, 4, 5].iter().all(|v| p.vertex_tags(*v).is_empty()), "main ends, dead end, inflexion");
        let edge = |a: usize, b: usize| p.edge_tags(p.edges.iter().position(|e| (e.a, e.b) == (a, b)).unwrap());
        assert_eq!(edge(0, 1), [tag::MAIN]);
        assert_eq!(edge(4, 3), [tag::DEAD_END, tag::SNAPPABLE, tag::LOCAL]);
        assert_eq!(edge(3, 5), [tag::SNAPPABLE, tag::LOCAL]);
        assert_eq!(edge(5, 6), [tag::LOCAL]);
        let mut streets = p.streets();
        streets.sort();
        assert_eq!(streets, [vec![0, 1], vec![1, 2], vec![1, 3], vec![3, 4], vec![3, 5, 6]]);
    }
}
