//! Parametric growth on empty ground, by the rules of Teng 2017 alone (Fig. 3; connect, clip and discard of section 3.3).
//!
//! Main and local streets of towns follow these rules too, and also respect room between streets, borders and the ground.
//! This module serves to study the parameters themselves.

use crate::network::{EdgeIx, PlanarGraph, VertexIx};
use crate::space::math::{acos, angle_of, direction};
use crate::space::{Bounds, Stream, closest_on_segment};
use glam::DVec2;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Parameters of growth (Teng 2017, Fig. 3). Lengths are in metres. The defaults are the values that section 4.2 of the paper
/// keeps fixed, and the middles of the ranges that it varies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrowthRules {
    /// Length of a street segment: more than 0.
    pub length: f64,
    /// Greatest deviation of a segment from `length`.
    pub deviation: f64,
    /// Least length of a segment, and of both parts of a divided segment.
    pub min_length: f64,
    /// Least and greatest number of segments at a vertex; each vertex aims at a number between them.
    pub degree: (usize, usize),
    /// Least angle between two segments at a vertex, in radians.
    pub min_angle: f64,
    /// Greatest deviation of a segment's direction, as a share of the angle between neighbours that are spread evenly.
    pub angle_deviation: f64,
    /// Distance within which the end of a segment snaps to a vertex or a segment.
    pub snap_radius: f64,
}

impl Default for GrowthRules {
    fn default() -> Self {
        Self {
            length: 50.0,
            deviation: 10.0,
            min_length: 20.0,
            degree: (3, 4),
            min_angle: 70f64.to_radians(),
            angle_deviation: 0.1,
            snap_radius: 20.0,
        }
    }
}

/// How much rounding to the quantum grid may reduce an angle, in radians: a right angle still counts as one.
const ROUNDING: f64 = 1e-3;

/// What the end of a proposed segment meets.
#[derive(Clone, Copy)]
enum Meets {
    Vertex(VertexIx),
    Edge(EdgeIx),
    Nothing,
}

/// Grows streets from the middle of a box until none fits any more. Every segment ends in the box. A pure function of the
/// arguments and of the state of the stream.
pub fn grow(rules: &GrowthRules, bounds: Bounds, stream: &mut Stream) -> PlanarGraph<()> {
    let rules = &GrowthRules { min_angle: rules.min_angle - ROUNDING, ..*rules };
    let mut graph = PlanarGraph::new();
    let first = graph.add_vertex(bounds.centre());
    let mut queue = VecDeque::from([first]);
    while let Some(v) = queue.pop_front() {
        let target = rules.degree.0 + stream.index(rules.degree.1.saturating_sub(rules.degree.0) + 1);
        let at = graph.at(v);
        // Streets spread evenly around the vertex, beginning with the first one there.
        let base = match graph.neighbours(v).next() {
            Some(w) => angle_of(graph.at(w) - at),
            None => TAU * stream.unit(),
        };
        let step = TAU / target as f64;
        for k in usize::from(graph.degree(v) > 0)..target {
            let heading = direction(base + step * (k as f64 + rules.angle_deviation * stream.signed()));
            let length = rules.length + rules.deviation * stream.signed();
            if graph.degree(v) >= target || graph.smallest_angle(v, heading) < rules.min_angle {
                continue;
            }
            if let Some(end) = propose(&mut graph, rules, bounds, v, at + heading * length) {
                queue.push_back(end);
            }
        }
    }
    graph
}

/// Connects, clips or discards the segment from `v` to `to`, and adds what is left; returns its end if that is a new vertex at
/// which nothing else ends.
fn propose(
    graph: &mut PlanarGraph<()>,
    rules: &GrowthRules,
    bounds: Bounds,
    v: VertexIx,
    to: DVec2,
) -> Option<VertexIx> {
    let at = graph.at(v);
    let own = |graph: &PlanarGraph<()>, e: EdgeIx| graph.edge(e).a == v || graph.edge(e).b == v;
    let hit = graph.first_hit(at, to, |e| own(graph, e));
    let tip = hit.map_or(to, |h| h.at);
    let vertex = graph.nearest_vertex(tip, rules.snap_radius, |w| w == v);
    let near = || graph.nearest_edge(tip, rules.snap_radius, |e| own(graph, e));
    let (meets, end) = match (vertex, hit) {
        (Some((w, _)), _) => (Meets::Vertex(w), graph.at(w)),
        (None, Some(hit)) => (Meets::Edge(hit.edge), hit.at),
        (None, None) => match near() {
            Some((e, _)) => {
                let (a, b) = graph.segment(e);
                (Meets::Edge(e), closest_on_segment(tip, a, b).1)
            }
            None => (Meets::Nothing, tip),
        },
    };
    let line = end - at;
    let fits = line.length() >= rules.min_length
        && bounds.contains(end)
        && graph.smallest_angle(v, line) >= rules.min_angle
        && meets_well(graph, rules, meets, end, -line);
    let met = |e: EdgeIx| match meets {
        Meets::Vertex(w) => graph.edge(e).a == w || graph.edge(e).b == w,
        Meets::Edge(edge) => e == edge,
        Meets::Nothing => false,
    };
    if !fits || graph.first_hit(at, end, |e| own(graph, e) || met(e)).is_some() {
        return None;
    }
    match meets {
        Meets::Vertex(w) => {
            graph.add_edge(v, w, ());
            None
        }
        Meets::Edge(e) => {
            let w = graph.split_edge(e, end);
            graph.add_edge(v, w, ());
            None
        }
        Meets::Nothing => {
            let w = graph.add_vertex(end);
            graph.add_edge(v, w, ());
            Some(w)
        }
    }
}

/// Whether a segment that leaves `end` in the direction `back` may meet the vertex or edge there: constraints 2 to 4 of Teng
/// 2017, section 3.3.
fn meets_well(graph: &PlanarGraph<()>, rules: &GrowthRules, meets: Meets, end: DVec2, back: DVec2) -> bool {
    match meets {
        Meets::Vertex(w) => graph.degree(w) < rules.degree.1 && graph.smallest_angle(w, back) >= rules.min_angle,
        Meets::Edge(e) => {
            let (a, b) = graph.segment(e);
            let leaves = |to: DVec2| {
                let part = to - end;
                let length = part.length();
                let cosine = part.dot(back) / (length * back.length()).max(f64::MIN_POSITIVE);
                length >= rules.min_length && acos(cosine.clamp(-1.0, 1.0)) >= rules.min_angle
            };
            rules.degree.1 >= 3 && leaves(a) && leaves(b)
        }
        Meets::Nothing => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;
    use crate::space::math::angle_between;

    #[test]
    fn what_grows_keeps_the_rules() {
        let bounds = Bounds::square(DVec2::new(300.0, -40.0), 500.0);
        for seed in 0..60 {
            let mut stream = Seed(seed).stream("growth test", &[]);
            let low = 2 + stream.index(3);
            let rules = GrowthRules {
                degree: (low, low + stream.index(3)),
                min_angle: stream.range(0.6, 1.6),
                ..GrowthRules::default()
            };
            let graph = grow(&rules, bounds, &mut stream);
            let parts: std::collections::BTreeSet<u32> = graph.components().into_iter().flatten().collect();
            assert!(parts.len() <= 1, "one piece");
            for (e, edge) in graph.edges() {
                let (a, b) = graph.segment(e);
                assert!(a.distance(b) > rules.min_length - 0.01 && bounds.contains(a) && bounds.contains(b));
                let touches = |o: EdgeIx| {
                    graph.edge(o).a == edge.a
                        || graph.edge(o).b == edge.a
                        || graph.edge(o).a == edge.b
                        || graph.edge(o).b == edge.b
                };
                assert!(graph.first_hit(a, b, touches).is_none(), "seed {seed}: a crossing without a vertex");
            }
            for v in graph.vertices() {
                let ways: Vec<DVec2> = graph.neighbours(v).map(|w| graph.at(w) - graph.at(v)).collect();
                assert!(ways.len() <= rules.degree.1.max(2));
                for (i, a) in ways.iter().enumerate() {
                    assert!(ways[i + 1..].iter().all(|b| angle_between(*a, *b) > rules.min_angle - 0.01));
                }
            }
        }
    }
}
