//! Edits of roads that the ground does not allow.

use super::inputs::Inputs;
use super::routes::Routes;
use super::via::TOLERANCE_STEPS;
use super::wishes::Wish;
use crate::edits::{EditList, RejectedEdit};
use crate::layer::{Cancel, LayerError};
use crate::network::SizeClass;
use crate::space::distance_to_line;

/// The edits that turn out to be impossible when their roads are searched, in addition to those rejected at once.
pub(super) fn unfulfilled(inputs: &Inputs, routes: &Routes, cancel: &Cancel) -> Result<Vec<RejectedEdit>, LayerError> {
    let mut out = Vec::new();
    let step = inputs.step();
    for (index, [a, b], wish) in inputs.wishes.wanted() {
        let route = routes.between(a, b, cancel)?;
        let reason = match (route, wish) {
            (None, Wish::Via { keep: false, .. }) => format!(
                "the road from {} to {} through these points costs too much or is dropped by the proximity rule; \
                 keep: true builds it all the same",
                a.name, b.name
            ),
            (None, _) => format!("the ground allows no road between {} and {}", a.name, b.name),
            (Some(route), Wish::Via { points, .. }) => {
                let line = route.line(step);
                let missed = points.iter().find(|p| distance_to_line(**p, &line) > TOLERANCE_STEPS * step as f64);
                let Some(p) = missed else { continue };
                format!("the ground allows no road through {},{}; the road takes another route", p.x, p.y)
            }
            _ => continue,
        };
        out.push(RejectedEdit { list: EditList::Roads, index, reason });
    }
    for point in &inputs.way_points {
        let mut reached = false;
        for tier in SizeClass::ALL.into_iter().filter(|t| *t <= point.settlement.size) {
            reached = reached || !routes.of(tier, &point.settlement, cancel)?.is_empty();
        }
        if !reached {
            let reason =
                format!("no road can reach {}; move it to ground that a road can reach", point.settlement.name);
            out.push(RejectedEdit { list: EditList::WayPoints, index: point.edit, reason });
        }
    }
    Ok(out)
}
