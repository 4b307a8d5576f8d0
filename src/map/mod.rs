//! Real maps read into streets that keep their topology, and buildings.
//!
//! Makes a [`Map`] in plan metres from OpenStreetMap (XML, PBF, answers of Overpass), GeoJSON or a road mask: streets with their nodes,
//! classes, widths, directions and levels, buildings with courtyards and heights, clipped to a box, and a [`MapReport`] of
//! what was used and what was left out. Part of the ground floor: reads `space`, `network` and `layer`, and knows no layer.
//!
//! Each reader (`osm_xml`, `pbf`, `overpass`, `geojson`, `mask`) turns a file into the same `elements`; `tags` says what these are,
//! `build` places them on the plan.

mod build;
mod coordinates;
mod elements;
mod error;
mod extract;
#[cfg(test)]
mod fixtures;
mod geojson;
mod limits;
mod mask;
mod model;
mod network;
mod osm_xml;
mod overpass;
mod pbf;
mod read;
mod report;
mod rings;
mod tags;
#[cfg(test)]
mod tests;
mod wire;

pub use coordinates::MapCoordinates;
pub use error::MapError;
pub use extract::{ExtractError, ExtractOptions, Extracted, MapPatches, NoPatch, PatchKind, extract, select};
pub use limits::MapLimits;
pub use mask::MaskOptions;
pub use model::{Map, MapBuilding, MapNode, MapStreet};
pub use read::MapOptions;
pub use report::{LeftOut, MapReport};
pub use tags::{BuildingTags, OneWay, StreetTags, TOWN_STREETS};
