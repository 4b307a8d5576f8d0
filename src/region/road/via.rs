//! Geodesics through points that the user gives.

use super::field::Field;
use super::geodesic::{Geodesic, Stop, geodesic};
use super::lattice::{node_at, node_near, nodes_around};
use super::route::Span;
use crate::layer::{Cancel, LayerError};
use glam::{DVec2, I64Vec2};

/// A road passes a given point within this many steps of the lattice.
pub(super) const TOLERANCE_STEPS: f64 = 3.0;

/// The cheapest path through the points in order, leg by leg, that never returns to a node. `None` if the ground allows none.
pub(super) fn geodesic_via(
    field: &mut Field,
    from: &[Stop],
    via: &[DVec2],
    to: &[Stop],
    cancel: &Cancel,
) -> Result<Option<Geodesic>, LayerError> {
    let step = field.step();
    let mut points = Vec::new();
    for p in via {
        let Some(node) = free_node(field, *p)? else { return Ok(None) };
        points.push(node);
    }
    points.dedup();
    let mut start = from.to_vec();
    let mut whole: Option<Geodesic> = None;
    for i in 0..=points.len() {
        let end = points.get(i).map(|node| vec![Stop { node: *node, cost: 0.0, beyond: DVec2::ZERO }]);
        let Some(leg) = geodesic(field, &start, end.as_deref().unwrap_or(to), cancel)? else { return Ok(None) };
        let [behind @ .., last] = leg.nodes.as_slice() else { return Ok(None) };
        if let Some(before) = behind.last() {
            // The next leg goes on in the direction in which this one arrived, and never back.
            start = vec![Stop { node: *last, cost: 0.0, beyond: node_at(*before - *last, step) }];
            field.close_nodes(behind);
        }
        whole = Some(match whole {
            None => leg,
            Some(mut all) => {
                let first = all.nodes.len() - 1;
                let moved = |s: &Span| Span { first: s.first + first, last: s.last + first, ..*s };
                all.spans.extend(leg.spans.iter().map(moved));
                all.nodes.extend(&leg.nodes[1..]);
                Geodesic { cost: all.cost + leg.cost, to: leg.to, ..all }
            }
        });
    }
    Ok(whole)
}

/// The node nearest to a point that is dry and whose edges are all open.
fn free_node(field: &mut Field, p: DVec2) -> Result<Option<I64Vec2>, LayerError> {
    let step = field.step();
    let mut near: Vec<(f64, I64Vec2)> = nodes_around(node_near(p, step), 2)
        .map(|n| (node_at(n, step).distance(p), n))
        .filter(|(d, _)| *d <= (TOLERANCE_STEPS - 1.0) * step as f64)
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1.y, a.1.x).cmp(&(b.1.y, b.1.x))));
    for (_, node) in near {
        if field.is_free(node)? {
            return Ok(Some(node));
        }
    }
    Ok(None)
}
