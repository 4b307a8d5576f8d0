//! Real roads to compare with, within the domain of a network.

use crate::fail::Fail;
use bevy_sprawl::export::RoadLine;
use bevy_sprawl::map::{Map, MapCoordinates, MapError, MapOptions, MaskOptions};
use bevy_sprawl::space::{Bounds, Geographic};
use std::path::Path;

/// Reads the roads of some classes (values of the tag `highway`) from a map, clipped to a domain. The map is in degrees
/// with a projection, and in plan metres without one; the middle of a picture is that of the domain.
pub fn read(
    path: &Path,
    classes: &[String],
    projection: Option<&Geographic>,
    domain: Bounds,
    mask: MaskOptions,
) -> Result<Map, Fail> {
    let coordinates = projection.map_or(MapCoordinates::Metres, |p| MapCoordinates::DegreesAround(*p));
    let bounds = Some(domain);
    let mask = MaskOptions { middle: domain.centre(), ..mask };
    let options = MapOptions { coordinates, classes: classes.to_vec(), bounds, mask, ..MapOptions::default() };
    Map::read(path, &options).map_err(|error| match error {
        MapError::NeedsDegrees { .. } => {
            Fail::file(path, "OpenStreetMap has degrees; the ground must be in degrees too, with --geographic")
        }
        MapError::Outside { streets, hint, .. } => {
            Fail::file(path, format!("none of its {streets} roads lies in the domain{hint}"))
        }
        other => other.into(),
    })
}

/// The streets of a map as roads between settlements.
pub fn roads(map: &Map) -> impl Iterator<Item = RoadLine> + '_ {
    map.streets.iter().map(|street| RoadLine {
        class: street.tags.road_class(),
        bridge: street.tags.bridge,
        tunnel: street.tags.tunnel,
        line: map.line(street),
    })
}
