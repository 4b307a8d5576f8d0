//! Layer 3: roads between settlements (Galin et al. 2011). Makes sections of road between gates and junctions, and tells which
//! settlements they connect. Reads the terrain, settlements, their outlines, and roads of higher tiers.
//!
//! # Steps
//!
//! Each step is a pure function of its key, is remembered in a bounded cache, and reads only what lies nearby. A step is a small
//! type that holds its cache and the steps that it reads (`steps` puts them together):
//!
//! 1. `partners` lists the pairs of settlements that are worth a search. `distance` finds, for such a pair, the cheapest path on a coarse lattice (`search` on `coarse` ground) within the
//!    ellipse that the longest allowed road spans, and where needed the `geodesic` on the fine lattice. From these costs
//!    `proximity` decides which pairs get a road.
//! 2. `site` finds where roads may enter a settlement, and which lattice edges it closes.
//! 3. `routes` finds the route of a kept pair on the fine lattice, within a corridor around its coarse path: a `geodesic` over
//!    positions and headings on a `field` of costs, with bridges and tunnels as edges. It avoids discs around the settlements
//!    that it does not serve or, where these leave no path, their outlines. Routes of lower tiers read routes of higher tiers,
//!    never of their own tier, so no order among equals matters.
//!    A settlement to which no way is cheap enough gets a costlier one (`last_resort`).
//! 4. `graph` joins all routes into a planar graph, in tiles of 8 steps.
//! 5. `merge` merges stretches that run beside each other and moves forks at sharp angles outwards. Then it realigns minor legs, so
//!    that lesser roads meet better ones at blunter angles and cross them at one place.
//! 6. `overpass` lets roads that cross highways pass over them on a bridge. One or four ramps join both roads if the settings ask
//!    for it.
//! 7. `shape` smooths lines.
//! 8. `sections` follows lines between junctions from tile to tile and cuts them at the ends of bridges and tunnels.
//!
//! # Padding
//!
//! Reads of settlements and roads that could go too far are checked with [`Reach`](crate::layer::Reach):
//!
//! - A pair reads within `padding::pair_padding` of the box around its two centres. Its path is at most `detour` beelines long, so
//!   every point has an end within half of that. Settlements that may rule the pair out lie within the tier's reach of both ends.
//! - A tile's routes are found from settlements whose distances from the tile sum to at most the longest road, and which are at
//!   most the tier's reach apart. Every point of a route has one of its settlements within `TierSettings::padding`.
//! - A site reads 6 steps around its outline. A tile of the graph reads routes 2 steps around it.
//! - Merging reads within `merge::padding` of its tile (about 2 km with the default settings), crossings of highways within
//!   `overpass::padding` (about 2 km), smoothing the graphs of two rings of tiles and outlines 16 steps around its tile.
//!
//! Terrain is sampled at points inside the same boxes; a sample cannot fail. Edits change none of this: paths that influences
//! make cheap, and paths through given points, stay within the ellipse of their pair. A way point is one more settlement,
//! without an outline (`way_points`, `nodes`). `change` tells how far roads change when something that they read changes.
//!
//! # Guarantees
//!
//! Roads of one level meet only at junctions; bridges and tunnels that a search chose are levels of their own. Routes meet only
//! at lattice nodes and crossings of lattice edges, which are vertices of the graph. Connectors of merged roads are split where
//! they meet others, and smoothing moves a line only where nothing is near. Roads touch an outline only in their gate, because
//! the lattice is closed around the outline. Every route ends in gates or way points, and merging leaves no dead ends, so no
//! road ends in a field except at a way point. Settlements that touch have no route: their border joins them, and no tie or
//! route comes near it.

mod budget;
mod change;
mod coarse;
mod cost;
mod crossing;
mod distance;
mod domain;
mod effort;
mod field;
mod geodesic;
mod given;
mod graph;
mod influence;
mod inputs;
mod landmass;
mod last_resort;
mod lattice;
mod link;
mod merge;
mod network;
mod nodes;
mod overpass;
mod overrides;
mod padding;
mod painted;
mod partners;
mod proximity;
mod repulsion;
mod roads;
mod route;
mod routes;
mod samples;
mod search;
mod sections;
mod settings;
mod shape;
mod site;
mod source;
mod steps;
#[cfg(test)]
mod tests;
mod tier;
mod tier_settings;
mod tile;
mod unfulfilled;
mod vertex;
mod via;
mod water_bridges;
mod way_points;
mod window;
mod wishes;

pub use crossing::{Crossing, HighwayCrossing, Hindrance};
pub use link::Link;
pub use network::{NetworkError, NetworkTask, RoadNetwork};
pub(crate) use overpass::{OVERPASS_CLEARANCE, overpass_profile};
pub use overrides::RoadOverrides;
pub use roads::Roads;
pub use sections::RoadSection;
pub use settings::RoadSettings;
pub use tier_settings::TierSettings;
