//! Ways along the streets.

use crate::layer::{Cancel, LayerError, Reach};
use crate::network::{JunctionId, StreetId};
use crate::space::{Bounds, Origin, closest_on_line, cut_line, line_length, point_at};
use crate::stack::Stack;
use glam::DVec2;
use pathfinding::directed::astar::astar;
use std::collections::BTreeMap;

/// A way along streets.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// Points along the centre lines, in plan metres. The first and last are the points of streets nearest to the wanted ends.
    pub points: Vec<DVec2>,
    /// The streets of the way, in order.
    pub streets: Vec<StreetId>,
    /// Length in metres.
    pub length: f64,
}

/// An end of the wanted way: a point on a street.
struct Stop {
    street: usize,
    along: f64,
}

impl Route {
    /// The shortest way along streets between two plan points. Only streets within `margin` metres of the box around both
    /// points are looked at. `None` when no street is near enough or none leads there.
    pub(super) fn find(
        stack: &Stack,
        from: DVec2,
        to: DVec2,
        margin: f64,
        cancel: &Cancel,
    ) -> Result<Option<Self>, LayerError> {
        let bounds = Bounds::of([from, to]).grown(margin);
        let overlap = stack.overlapping(bounds, &Reach::new("route", bounds, 0.0), cancel)?;
        let origin = Origin::at(from);
        let streets: Vec<_> = overlap.streets.iter().map(|f| f.item.street.moved(f.origin.offset_to(origin))).collect();
        let nearest = |p: DVec2| {
            let stops = streets.iter().enumerate().map(|(i, s)| {
                let (along, at) = closest_on_line(p, &s.line);
                (at.distance(p), Stop { street: i, along })
            });
            stops.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(d, _)| *d <= margin).map(|(_, stop)| stop)
        };
        let (Some(start), Some(end)) = (nearest(origin.to_local(from)), nearest(origin.to_local(to))) else {
            return Ok(None);
        };
        if start.street == end.street {
            let line = &streets[start.street].line;
            let mut points = cut_line(line, start.along.min(end.along), start.along.max(end.along));
            if start.along > end.along {
                points.reverse();
            }
            return Ok(Some(Self::of(origin, points, vec![streets[start.street].id])));
        }
        let mut around: BTreeMap<JunctionId, Vec<usize>> = BTreeMap::new();
        for (i, s) in streets.iter().enumerate() {
            around.entry(s.from).or_default().push(i);
            around.entry(s.to).or_default().push(i);
        }
        // A node is a street and whether the way leaves it at its last point. Costs are whole millimetres, so that they add
        // exactly.
        let lengths: Vec<f64> = streets.iter().map(|s| line_length(&s.line)).collect();
        let cost = |metres: f64| (metres * 1000.0).round() as u64;
        let exit = |(street, forward): (usize, bool)| {
            let s = &streets[street];
            if forward { (s.to, s.line[s.line.len() - 1]) } else { (s.from, s.line[0]) }
        };
        let goal = point_at(&streets[end.street].line, end.along).0;
        let first = (usize::MAX, true);
        let successors = |node: &(usize, bool)| -> Vec<((usize, bool), u64)> {
            if *node == first {
                let left = lengths[start.street] - start.along;
                return vec![((start.street, true), cost(left)), ((start.street, false), cost(start.along))];
            }
            let junction = exit(*node).0;
            let onward = around[&junction].iter().filter(|i| **i != node.0);
            onward.map(|&i| ((i, streets[i].from == junction), cost(lengths[i]))).collect()
        };
        let reached = |node: &(usize, bool)| node.0 == end.street;
        let beeline =
            |node: &(usize, bool)| if *node == first { 0 } else { cost((exit(*node).1.distance(goal) - 1.0).max(0.0)) };
        // The last street is entered at one of its ends, so its whole length may be counted; the estimate stays below that.
        let Some((nodes, _)) = astar(&first, successors, |n| if reached(n) { 0 } else { beeline(n) }, reached) else {
            return Ok(None);
        };
        let mut points: Vec<DVec2> = Vec::new();
        for (street, forward) in &nodes[1..] {
            let line = &streets[*street].line;
            let mut part = match (*street == start.street, *street == end.street) {
                (true, _) if *forward => cut_line(line, start.along, lengths[*street]),
                (true, _) => cut_line(line, 0.0, start.along),
                (_, true) if *forward => cut_line(line, 0.0, end.along),
                (_, true) => cut_line(line, end.along, lengths[*street]),
                _ => line.clone(),
            };
            if !forward {
                part.reverse();
            }
            points.extend(part.into_iter().skip(usize::from(!points.is_empty())));
        }
        Ok(Some(Self::of(origin, points, nodes[1..].iter().map(|(i, _)| streets[*i].id).collect())))
    }

    fn of(origin: Origin, local: Vec<DVec2>, streets: Vec<StreetId>) -> Self {
        let length = line_length(&local);
        Self { points: local.into_iter().map(|p| origin.to_plan(p)).collect(), streets, length }
    }
}
