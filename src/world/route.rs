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

/// A walk along a street, from junction to junction, or from where the way begins or to where it ends.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Walk {
    street: usize,
    forward: bool,
    begins: bool,
    ends: bool,
}

/// An end of the wanted way: a point on a street.
struct Stop {
    street: usize,
    along: f64,
}

impl Route {
    /// The shortest way along streets between two plan points, along ramps only in their direction. Only streets within `margin` metres of the box around both
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
        let mut around: BTreeMap<JunctionId, Vec<usize>> = BTreeMap::new();
        for (i, s) in streets.iter().enumerate() {
            around.entry(s.from).or_default().push(i);
            if s.to != s.from {
                around.entry(s.to).or_default().push(i);
            }
        }
        let lengths: Vec<f64> = streets.iter().map(|s| line_length(&s.line)).collect();
        // Costs are whole millimetres, so that they add exactly.
        let cost = |metres: f64| (metres * 1000.0).round() as u64;
        let exit = |walk: &Walk| {
            let s = &streets[walk.street];
            if walk.forward { (s.to, s.line[s.line.len() - 1]) } else { (s.from, s.line[0]) }
        };
        let end_street = end.street;
        let end_at = point_at(&streets[end.street].line, end.along).0;
        // Where a walk begins and ends, in metres along its street.
        let stretch = |walk: &Walk| {
            let whole = [0.0, lengths[walk.street]];
            let [first, last] = if walk.forward { whole } else { [whole[1], whole[0]] };
            (if walk.begins { start.along } else { first }, if walk.ends { end.along } else { last })
        };
        // The walks along a street in one direction: to the end of the way, if it lies ahead, and to the junction.
        let walks = |street: usize, forward: bool, begins: bool| {
            let on = Walk { street, forward, begins, ends: false };
            let end = Walk { ends: true, ..on.clone() };
            let (from, to) = stretch(&end);
            let is_ahead = street == end_street && if forward { to >= from } else { to <= from };
            is_ahead.then_some(end).into_iter().chain([on])
        };
        let successors = |place: &Option<Walk>| -> Vec<(Option<Walk>, u64)> {
            let mut next = Vec::new();
            match place {
                None => {
                    next.extend(walks(start.street, true, true));
                    if !streets[start.street].class.is_one_way() {
                        next.extend(walks(start.street, false, true));
                    }
                }
                Some(walk) if walk.ends => {}
                Some(walk) => {
                    let junction = exit(walk).0;
                    for &i in around[&junction].iter().filter(|i| **i != walk.street) {
                        if streets[i].from == junction {
                            next.extend(walks(i, true, false));
                        }
                        if streets[i].to == junction && !streets[i].class.is_one_way() {
                            next.extend(walks(i, false, false));
                        }
                    }
                }
            }
            let length = |walk: &Walk| (stretch(walk).1 - stretch(walk).0).abs();
            next.into_iter().map(|walk| (cost(length(&walk)), walk)).map(|(cost, walk)| (Some(walk), cost)).collect()
        };
        // A metre less than the beeline, because each cost is rounded.
        let beeline = |place: &Option<Walk>| match place {
            Some(walk) if !walk.ends => cost((exit(walk).1.distance(end_at) - 1.0).max(0.0)),
            _ => 0,
        };
        let arrived = |place: &Option<Walk>| place.as_ref().is_some_and(|walk| walk.ends);
        let Some((way, _)) = astar(&None, successors, beeline, arrived) else { return Ok(None) };
        let mut points: Vec<DVec2> = Vec::new();
        let way: Vec<Walk> = way.into_iter().flatten().collect();
        for walk in &way {
            let (from, to) = stretch(walk);
            let mut part = cut_line(&streets[walk.street].line, from.min(to), from.max(to));
            if !walk.forward {
                part.reverse();
            }
            points.extend(part.into_iter().skip(usize::from(!points.is_empty())));
        }
        Ok(Some(Self::of(origin, points, way.iter().map(|walk| streets[walk.street].id).collect())))
    }

    fn of(origin: Origin, local: Vec<DVec2>, streets: Vec<StreetId>) -> Self {
        let length = line_length(&local);
        Self { points: local.into_iter().map(|p| origin.to_plan(p)).collect(), streets, length }
    }
}
