//! The street network of a map.

use crate::map::model::{Map, MapNode, MapStreet};
use crate::network::{Junction, JunctionId, Network, Street, StreetId};
use crate::space::{Origin, QUANTUM, quantize};
use glam::DVec2;
use std::collections::BTreeMap;

impl Map {
    /// The streets of the map, parted where they share a node, in metres relative to [`Map::origin`].
    ///
    /// Junctions are the ends of streets and the nodes that streets share; what lies between are points of a line. Ids of
    /// junctions come from the ids of nodes, or from places where nodes have none, so that networks of maps that overlap
    /// agree.
    pub fn network(&self) -> Network {
        let origin = self.origin();
        let degree = self.degrees();
        let mut out = Network::default();
        let mut junctions = BTreeMap::new();
        let (mut way, mut part) = (None, 0);
        for street in &self.streets {
            if way != Some(street.id) {
                (way, part) = (Some(street.id), 0);
            }
            for nodes in parts(&street.nodes, &degree) {
                let ids = nodes.iter().filter_map(|i| self.nodes.get(*i as usize));
                let Some((from, to, line)) = placed(ids, origin) else { continue };
                let id = StreetId::of(&[street.id as u64, part]);
                part += 1;
                for (end, at) in [(from, line.first()), (to, line.last())] {
                    junctions.extend(at.map(|at| (end, *at)));
                }
                out.streets.push(with_tags(Street::new(id, street.tags.class, from, to, line), street));
            }
        }
        out.junctions = junctions.into_iter().map(|(id, at)| Junction { id, at }).collect();
        out
    }

    /// How many streets leave each node: one at the end of a street, two along it.
    pub fn degrees(&self) -> Vec<u32> {
        let mut degree = vec![0; self.nodes.len()];
        for street in &self.streets {
            for pair in street.nodes.windows(2) {
                for node in pair {
                    if let Some(count) = degree.get_mut(*node as usize) {
                        *count += 1;
                    }
                }
            }
        }
        degree
    }
}

/// A street's nodes, parted at those that other streets (or other parts of this one) share.
fn parts<'a>(nodes: &'a [u32], degree: &'a [u32]) -> impl Iterator<Item = &'a [u32]> {
    let is_shared = |i: &usize| degree.get(nodes[*i] as usize).is_some_and(|d| *d > 2);
    let last = nodes.len().saturating_sub(1);
    let mut ends: Vec<usize> = (1..last).filter(is_shared).collect();
    ends.push(last);
    let mut from = 0;
    ends.into_iter().map(move |to| {
        let part = &nodes[from..=to];
        from = to;
        part
    })
}

/// Ids of both ends and points in a local frame; `None` for a line without length.
fn placed<'a>(
    nodes: impl Iterator<Item = &'a MapNode> + Clone,
    origin: Origin,
) -> Option<(JunctionId, JunctionId, Vec<DVec2>)> {
    let mut line: Vec<DVec2> = nodes.clone().map(|n| quantize(origin.to_local(n.at))).collect();
    line.dedup();
    let (first, last) = (nodes.clone().next()?, nodes.last()?);
    (line.len() > 1).then(|| (junction(first), junction(last), line))
}

fn junction(node: &MapNode) -> JunctionId {
    let place = || (node.at / QUANTUM).round().as_i64vec2();
    match node.id {
        Some(id) => JunctionId::of(&[0, id as u64]),
        None => JunctionId::of(&[1, place().x as u64, place().y as u64]),
    }
}

fn with_tags(street: Street, from: &MapStreet) -> Street {
    Street { level: from.tags.level, bridge: from.tags.bridge, tunnel: from.tags.tunnel, ..street }
}
