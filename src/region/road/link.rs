//! Links: which settlements a road connects, and what the connection costs.

use super::distance::Distances;
use super::inputs::{Inputs, Way};
use super::route::Route;
use super::tier::tier_of;
use super::water_bridges;
use crate::layer::{Cancel, LayerError};
use crate::network::{StreetClass, StreetId};
use crate::region::settlement::SettlementId;
use crate::space::line_length;

/// A connection between two settlements or way points that a road serves. Settlements that touch have none.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Stable id.
    pub id: StreetId,
    /// The settlement or way point with the lower id.
    pub from: SettlementId,
    /// The settlement or way point with the higher id.
    pub to: SettlementId,
    /// Class tau = min(sigma, sigma) (Galin 2011, section 3).
    pub class: StreetClass,
    /// Length of the geodesic in metres.
    pub length_m: f64,
    /// Cost of the geodesic, in metres of flat open ground.
    pub cost: f64,
    /// Number of bridges.
    pub bridges: usize,
    /// Number of tunnels.
    pub tunnels: usize,
}

/// The link of a route.
pub(super) fn link(inputs: &Inputs, distances: &Distances, route: &Route, cancel: &Cancel) -> Result<Link, LayerError> {
    let settlement = |i: usize| inputs.settlement(route.ends[i].settlement, route.ends[i].centre.plan());
    let cost = match (settlement(0)?, settlement(1)?) {
        (Some(a), Some(b)) => {
            let tier = tier_of(&a, &b);
            match distances.distance(tier, &a, &b, cancel)? {
                cost if cost.is_finite() => cost,
                _ => distances.coarse_path((tier, Way::Costlier), &a, &b, cancel)?.cost,
            }
        }
        _ => f64::INFINITY,
    };
    let tunnels = route.spans.iter().filter(|s| s.tunnel).count();
    Ok(Link {
        id: route.id,
        from: route.ends[0].settlement,
        to: route.ends[1].settlement,
        class: route.class,
        length_m: line_length(&route.line(inputs.step())),
        cost,
        bridges: route.spans.len() - tunnels + water_bridges::count(inputs, route),
        tunnels,
    })
}
