//! Ways through points that the user gives.

use super::course::Span;
use super::field::Field;
use super::geodesic::{Geodesic, Stop, geodesic};
use super::lattice::{node_at, node_near};
use crate::layer::{Cancel, LayerError};
use glam::{DVec2, I64Vec2};

/// A point is met within so many steps of the lattice.
pub(super) const VIA_STEPS: f64 = 3.0;

/// The cheapest way through the points in order, leg by leg, that never comes back to a node; `None` if the ground has none.
pub(super) fn through(
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
            // On in the direction in which it arrived, and never back.
            start = vec![Stop { node: *last, cost: 0.0, beyond: node_at(*before - *last, step) }];
            field.bar(behind);
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

/// The node nearest to a point that is dry and open all around.
fn free_node(field: &mut Field, p: DVec2) -> Result<Option<I64Vec2>, LayerError> {
    let step = field.step();
    let middle = node_near(p, step);
    let mut near: Vec<(f64, I64Vec2)> = (-2..=2)
        .flat_map(|y| (-2..=2).map(move |x| middle + I64Vec2::new(x, y)))
        .map(|n| (node_at(n, step).distance(p), n))
        .filter(|(d, _)| *d <= (VIA_STEPS - 1.0) * step as f64)
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1.y, a.1.x).cmp(&(b.1.y, b.1.x))));
    for (_, node) in near {
        if field.is_free(node)? {
            return Ok(Some(node));
        }
    }
    Ok(None)
}
