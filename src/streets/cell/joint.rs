//! Joints: the points where a proposal meets the graph, and distances from them along the network.

use super::canvas::Canvas;
use super::obstacle::{NONE, Neighbourhood, Obstacle, nearest};
use super::proposal::Join;
use super::rules::Limits;
use crate::network::{EdgeIx, STREET_FLOOR, VertexIx};
use glam::DVec2;

/// An edge near a joint, with the distances of its ends from the joint along the network, in metres.
#[derive(Clone, Copy)]
pub struct Reached {
    pub edge: EdgeIx,
    pub va: VertexIx,
    pub from_a: f64,
    pub from_b: f64,
}

/// A point where a proposal meets the graph, and what is near to it along the network.
#[derive(Default)]
pub struct Joint {
    pub point: usize,
    pub at: DVec2,
    pub vertex: VertexIx,
    pub edge: EdgeIx,
    pub is_port: bool,
    pub reached: Vec<Reached>,
    pub shared: Vec<EdgeIx>,
    pub ports: Vec<(DVec2, f64)>,
}

impl Joint {
    pub fn incident(&self, s: &Obstacle) -> bool {
        !s.is_wall() && ((self.vertex != NONE && s.ends_at(self.vertex)) || self.edge == s.edge)
    }

    /// Distance to another joint along local streets or along the main street between two ports, in metres; infinite if the
    /// other joint is out of reach.
    pub fn way_to(&self, other: &Joint, canvas: &Canvas) -> f64 {
        let around = self.ports.iter().flat_map(|(p, d)| other.ports.iter().map(move |(q, e)| d + e + p.distance(*q)));
        let around = around.fold(f64::INFINITY, f64::min);
        let through = self.reached.iter().filter(|x| {
            let (va, vb) = (canvas.graph.edge(x.edge).a, canvas.graph.edge(x.edge).b);
            x.edge == other.edge || (other.vertex != NONE && (va == other.vertex || vb == other.vertex))
        });
        let through = through.map(|x| {
            let e = canvas.graph.edge(x.edge);
            let (da, db) = if x.va == e.a { (x.from_a, x.from_b) } else { (x.from_b, x.from_a) };
            (da + canvas.graph.at(e.a).distance(other.at)).min(db + canvas.graph.at(e.b).distance(other.at))
        });
        through.fold(around, f64::min)
    }

    /// Distance along the network from the joint to the point `r` of an obstacle, in metres; infinite if it is out of reach.
    pub fn along(&self, s: &Obstacle, r: DVec2) -> f64 {
        if s.is_wall() {
            return self.ports.iter().map(|(p, d)| d + p.distance(r)).fold(f64::INFINITY, f64::min);
        }
        if self.edge == s.edge {
            return self.at.distance(r);
        }
        self.reached.binary_search_by_key(&s.edge, |x| x.edge).map_or(f64::INFINITY, |x| {
            let x = &self.reached[x];
            let (da, db) = if x.va == s.va { (x.from_a, x.from_b) } else { (x.from_b, x.from_a) };
            (da + s.a.distance(r)).min(db + s.b.distance(r))
        })
    }
}

/// Whether a street may leave `at` in `direction` there, where it meets the graph by `join`: the angles to the other streets are
/// wide enough, and the junction has room for one street more.
pub fn joint_angle_fits(canvas: &Canvas, join: Join, at: DVec2, direction: DVec2, limits: &Limits) -> bool {
    let g = &canvas.graph;
    let length = direction.length();
    let turns = |other: DVec2, most: f64| direction.dot(other) <= most * length * other.length();
    match join {
        Join::At(v) => {
            let (degree, at) = (g.degree(v), g.at(v));
            if canvas.nodes[v as usize].port.is_some() {
                return degree == 0;
            }
            let most = if degree == 1 { limits.bend_cosine } else { limits.junction_cosine };
            degree > 0 && degree < limits.max_degree && g.neighbours(v).all(|w| turns(g.at(w) - at, most))
        }
        Join::On(e) => {
            let e = g.edge(e);
            limits.max_degree > 2 && [e.a, e.b].into_iter().all(|end| turns(g.at(end) - at, limits.junction_cosine))
        }
        Join::Free(_) => true,
    }
}

/// Whether the street that a joint divides may become two. Each part must keep its distance from the streets that the whole
/// street met at its other end.
pub fn parts_stay_apart(joint: &Joint, near: &Neighbourhood) -> bool {
    near.obstacles.iter().all(|s| {
        s.is_wall()
            || joint.shared.contains(&s.edge)
            || nearest(joint.at, s.a, s.b).distance_squared(joint.at) >= STREET_FLOOR * STREET_FLOOR
    })
}

/// Whether a joint on a street, which may be the stub of a port, is far enough from the border for a junction.
pub fn keeps_off_walls(joint: &Joint, near: &Neighbourhood) -> bool {
    near.obstacles.iter().all(|s| !s.is_wall() || nearest(joint.at, s.a, s.b).distance(joint.at) >= s.floor)
}

/// Whether two joints lie on one street, which they divide.
pub fn on_one_street(canvas: &Canvas, a: &Joint, b: &Joint) -> bool {
    let mut edges = Vec::new();
    street_edges(canvas, a, &mut edges);
    edges.contains(&b.edge) || b.vertex != NONE && canvas.graph.edges_at(b.vertex).iter().any(|e| edges.contains(e))
}

/// Adds the edges of the streets that a joint lies on.
fn street_edges(canvas: &Canvas, joint: &Joint, edges: &mut Vec<EdgeIx>) {
    let g = &canvas.graph;
    if joint.vertex != NONE {
        for &e in g.edges_at(joint.vertex) {
            canvas.follow(joint.vertex, e, |x| edges.push(x));
        }
        return;
    }
    let e = g.edge(joint.edge);
    edges.push(joint.edge);
    for end in [e.a, e.b].into_iter().filter(|end| !canvas.is_end(*end)) {
        for &next in g.edges_at(end).iter().filter(|x| **x != joint.edge) {
            canvas.follow(end, next, |x| edges.push(x));
        }
    }
}

/// Finds the edges of the street that a joint lies on, and of the streets that it meets at the ends from which the proposal
/// goes on.
pub fn find_shared(canvas: &Canvas, joint: &mut Joint) {
    let g = &canvas.graph;
    let mut shared = std::mem::take(&mut joint.shared);
    shared.clear();
    street_edges(canvas, joint, &mut shared);
    if joint.vertex != NONE && g.degree(joint.vertex) == 1 {
        // The proposal goes on with this street, and so meets what meets it at its other end.
        let (end, _) = canvas.follow(joint.vertex, g.edges_at(joint.vertex)[0], |_| {});
        for &other in g.edges_at(end) {
            canvas.follow(end, other, |x| shared.push(x));
        }
    }
    joint.shared = shared;
}
