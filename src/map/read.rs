//! Reading a map from a file.

use crate::layer::{decode_text, read_file};
use crate::map::build::build;
use crate::map::coordinates::MapCoordinates;
use crate::map::error::MapError;
use crate::map::limits::MapLimits;
use crate::map::mask::{self, MaskOptions};
use crate::map::model::Map;
use crate::map::tags::TOWN_STREETS;
use crate::map::{geojson, osm_xml, overpass, pbf};
use crate::space::Bounds;
use std::path::Path;

/// What is read of a map, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct MapOptions {
    /// What the file's coordinates are.
    pub coordinates: MapCoordinates,
    /// Values of `highway` that are streets, each with its `_link`.
    pub classes: Vec<String>,
    /// Box in plan metres that streets are clipped to; buildings that overlap it are kept whole. `None` reads all.
    pub bounds: Option<Bounds>,
    /// How much is read at most.
    pub limits: MapLimits,
    /// How road masks are read.
    pub mask: MaskOptions,
}

impl Default for MapOptions {
    /// Degrees, the streets of towns, without a box.
    fn default() -> Self {
        Self {
            coordinates: MapCoordinates::Degrees,
            classes: TOWN_STREETS.map(String::from).to_vec(),
            bounds: None,
            limits: MapLimits::default(),
            mask: MaskOptions::default(),
        }
    }
}

/// Formats of maps.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Xml,
    Pbf,
    Json,
    Mask,
}

impl Format {
    fn of(file: &str) -> Result<Self, MapError> {
        let name = file.to_ascii_lowercase();
        let ends = |endings: &[&str]| endings.iter().any(|e| name.ends_with(e));
        match () {
            () if ends(&[".osm", ".xml"]) => Ok(Self::Xml),
            () if ends(&[".pbf"]) => Ok(Self::Pbf),
            () if ends(&[".geojson", ".json"]) => Ok(Self::Json),
            () if ends(&[".png"]) => Ok(Self::Mask),
            () => Err(MapError::UnknownFormat { file: file.to_owned() }),
        }
    }
}

impl Map {
    /// Reads a map from a file whose name says its format: OpenStreetMap XML (`.osm`, `.xml`) or PBF (`.pbf`), GeoJSON or an
    /// answer of Overpass (`.geojson`, `.json`), or a road mask (`.png`, [`MaskOptions`]). All streets of a mask are
    /// wanted.
    ///
    /// Fails on a file that cannot be read, on one beyond the limits, on a picture that is no mask, and on a file without a
    /// street of the wanted classes in the box.
    pub fn read(path: &Path, options: &MapOptions) -> Result<Self, MapError> {
        let file = path.to_string_lossy();
        Format::of(&file)?;
        Self::parse(&file, &read_file(path, options.limits.file_bytes)?, options)
    }

    /// Reads a map from the content of a file, as [`Map::read`] does.
    pub fn parse(file: &str, content: &[u8], options: &MapOptions) -> Result<Self, MapError> {
        let (classes, limits) = (&options.classes, options.limits);
        let format = Format::of(file)?;
        let coordinates = match (format, options.coordinates) {
            (Format::Mask, MapCoordinates::DegreesAround(_)) => {
                return Err(MapError::NoDegrees { file: file.to_owned() });
            }
            (Format::Mask, _) => MapCoordinates::Metres,
            (_, coordinates) => coordinates,
        };
        let in_degrees = coordinates != MapCoordinates::Metres;
        let is_osm_json = format == Format::Json && overpass::is_answer(decode_text(file, content)?);
        if !in_degrees && (matches!(format, Format::Xml | Format::Pbf) || is_osm_json) {
            return Err(MapError::NeedsDegrees { file: file.to_owned() });
        }
        let elements = match format {
            Format::Pbf => pbf::read(file, content, classes, limits)?,
            Format::Xml => osm_xml::read(file, decode_text(file, content)?, classes, limits)?,
            Format::Json if is_osm_json => overpass::read(file, decode_text(file, content)?, classes, limits)?,
            Format::Mask => mask::read(file, content, &options.mask, limits)?,
            Format::Json => geojson::read(file, decode_text(file, content)?, classes, in_degrees, limits)?,
        };
        build(file, &elements, coordinates, options.bounds, classes)
    }
}
