//! The graph around a tile, as crossings of highways see it.

use super::dimensions::{CLEAR, NEARER, RUN_OUT};
use crate::layer::Cancel;
use crate::layer::LayerError;
use crate::network::StreetClass;
use crate::region::road::crossing::Hindrance;
use crate::region::road::graph::Graphs;
use crate::region::road::inputs::Inputs;
use crate::region::road::merge::{Net, Rules};
use crate::region::road::routes::Routes;
use crate::region::road::vertex::{Key, Vertex};
use crate::space::math::angle_between;
use crate::space::{Bounds, point_in_polygon, segment_distance, segments};
use glam::DVec2;
use std::collections::BTreeMap;

/// Greatest bend of a road at the crossing, in radians.
const MOST_BEND: f64 = 0.6;
/// Least angle between the two roads, in radians.
const LEAST_ANGLE: f64 = 0.7;

/// The graph around a tile, and what decisions about crossings read besides.
pub(super) struct Surroundings<'a> {
    pub inputs: &'a Inputs,
    pub routes: &'a Routes,
    pub graphs: &'a Graphs,
    pub rules: Rules<'a>,
    /// The merged graph that the net was made from.
    pub vertices: BTreeMap<Key, &'a Vertex>,
    pub cancel: &'a Cancel,
}

/// A vertex where a road crosses a highway.
#[derive(Clone, Copy)]
pub(super) struct Cross {
    pub node: usize,
    /// Edges of the highway.
    pub highway: [usize; 2],
    /// Edges of the other road, which passes over; the better first.
    pub upper: [usize; 2],
}

/// A vertex along a road.
pub(super) struct RunVertex {
    pub node: usize,
    /// The edge that leads there.
    pub edge: usize,
    /// Distance in metres along the road.
    pub along: f64,
    /// Whether the road continues there and no other road joins it.
    pub plain: bool,
}

impl Surroundings<'_> {
    pub fn net(&self) -> &Net {
        &self.rules.net
    }

    /// Vector from a vertex along an edge to its other end.
    pub fn towards(&self, node: usize, edge: usize) -> DVec2 {
        self.net().step(node, self.net().far(edge, node))
    }

    pub fn class(&self, edge: usize) -> StreetClass {
        self.net().edges[edge].rank.class
    }

    /// The class of the road that crosses a highway at a vertex on the ground, if one does. Where several do, it is the best.
    pub fn crossing_class(&self, node: usize) -> Option<StreetClass> {
        let n = &self.net().nodes[node];
        if n.ways.len() < 4 || n.key.ground_parts().is_none() {
            return None;
        }
        let mut classes: Vec<StreetClass> = n.ways.iter().map(|e| self.class(*e)).collect();
        classes.sort_unstable();
        (classes[1] == StreetClass::Highway).then(|| classes[2])
    }

    /// The crossing at a vertex, if its shape allows a bridge.
    pub fn cross(&self, node: usize) -> Result<Cross, Hindrance> {
        let n = &self.net().nodes[node];
        let mut ways: [usize; 4] = n.ways.as_slice().try_into().map_err(|_| Hindrance::Roads)?;
        if n.key.ground_parts().is_none() || ways.iter().any(|e| self.net().edges[*e].fixed) {
            return Err(Hindrance::Junction);
        }
        let key = |e: usize| (self.net().edges[e].rank, self.net().nodes[self.net().far(e, node)].key);
        ways.sort_by_key(|e| key(*e));
        let [a, rest @ ..] = ways;
        let bend = |e: usize, f: usize| angle_between(-self.towards(node, e), self.towards(node, f));
        let straight = rest.into_iter().min_by(|x, y| bend(a, *x).total_cmp(&bend(a, *y)));
        let b = straight.ok_or(Hindrance::Roads)?;
        let mut others = rest.into_iter().filter(|e| *e != b);
        let (Some(c), Some(d)) = (others.next(), others.next()) else { return Err(Hindrance::Roads) };
        let highway = self.class(a) == StreetClass::Highway && self.class(b) == StreetClass::Highway;
        if !highway {
            return Err(Hindrance::Roads);
        }
        let least = [(a, c), (a, d), (b, c), (b, d)]
            .map(|(e, f)| angle_between(self.towards(node, e), self.towards(node, f)))
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        if bend(a, b) >= MOST_BEND || bend(c, d) >= MOST_BEND || least <= LEAST_ANGLE {
            return Err(Hindrance::Angle);
        }
        Ok(Cross { node, highway: [a, b], upper: [c, d] })
    }

    /// Whether the road that passes over is of another class on one side of the crossing. Only ramps make a place for the change.
    pub fn is_mixed(&self, cross: &Cross) -> bool {
        self.class(cross.upper[0]) != self.class(cross.upper[1])
    }

    /// The vertices of a road from a vertex along an edge, up to the first one at a distance of at least `length`, or to a
    /// junction.
    pub fn run(&self, node: usize, edge: usize, length: f64) -> Vec<RunVertex> {
        let (mut at, mut via, mut along) = (node, edge, 0.0);
        let mut out: Vec<RunVertex> = Vec::new();
        while along < length {
            let next = self.net().far(via, at);
            along += self.net().apart(at, next);
            let n = &self.net().nodes[next];
            let goes_on = |e: &usize| !self.net().edges[*e].fixed && self.class(*e) == self.class(edge);
            let on = n.ways.iter().copied().find(|e| *e != via).filter(goes_on);
            let plain = n.ways.len() == 2 && n.key.ground_parts().is_some() && next != node;
            let on = on.filter(|_| plain);
            out.push(RunVertex { node: next, edge: via, along, plain: on.is_some() });
            match on {
                Some(on) => (at, via) = (next, on),
                None => break,
            }
        }
        out
    }

    /// The run to `length`, if the road has no junction up to [`RUN_OUT`] beyond it.
    pub fn clear_run(&self, node: usize, edge: usize, length: f64) -> Result<Vec<RunVertex>, Hindrance> {
        let run = self.run(node, edge, length + RUN_OUT);
        let clear = run.last().is_some_and(|last| last.along >= length + RUN_OUT);
        if clear { Ok(run) } else { Err(Hindrance::Junction) }
    }

    /// Whether points, relative to a crossing, are nearer to it than to any other crossing that may be separated.
    pub fn are_own(&self, node: usize, points: &[DVec2]) -> Result<bool, LayerError> {
        let net = self.net();
        let farthest = points.iter().map(|p| p.length()).fold(0.0, f64::max);
        let around = Bounds::square(net.nodes[node].at, 2.0 * (2.0 * farthest + NEARER));
        for other in net.nodes_in(around)? {
            let by = net.step(node, other);
            let nearer = |p: &DVec2| p.length() + NEARER < p.distance(by);
            if other != node && !points.iter().all(nearer) && self.cross(other).is_ok() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether no edge but those of `own` comes near a line (relative to a vertex) or lies in the polygon that the line makes with
    /// the vertices `corners` of own edges.
    pub fn is_free(&self, node: usize, line: &[DVec2], corners: &[DVec2], own: &[usize]) -> Result<bool, LayerError> {
        let net = self.net();
        let polygon: Vec<DVec2> = corners.iter().chain(line).copied().collect();
        let bounds = Bounds::of(polygon.iter().copied()).moved(net.nodes[node].at).grown(CLEAR);
        for e in net.edges_in(bounds)? {
            if own.contains(&e) {
                continue;
            }
            let [p, q] = net.edges[e].ends.map(|n| net.step(node, n));
            let near = segments(line).any(|(a, b)| segment_distance(a, b, p, q) < CLEAR);
            if near || point_in_polygon(p, &polygon) || point_in_polygon(q, &polygon) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}
