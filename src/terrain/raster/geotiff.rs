//! Reading of GeoTIFF (OGC 19-008r4): one band of numbers, with its place in the file.

use super::band::Band;
use super::grid::{MOST_CELLS, Raster, cell_name, count};
use super::holes::Holes;
use crate::layer::{FileError, quoted};
use glam::DVec2;
use std::fmt::Display;
use std::io::Cursor;
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

/// Greatest ratio by which compression can shrink a picture.
const MOST_RATIO: usize = 4_000;

/// Geo keys: kind of coordinates, whether these are those of corners or of middles, system of metres, units.
const MODEL_TYPE: u16 = 1024;
const RASTER_TYPE: u16 = 1025;
const ANGULAR_UNITS: u16 = 2054;
const PROJECTED_SYSTEM: u16 = 3072;
const PROJECTED_UNITS: u16 = 3076;
const VERTICAL_UNITS: u16 = 4099;
/// Values of geo keys.
const PROJECTED: u16 = 1;
const IN_DEGREES: u16 = 2;
const PIXEL_IS_POINT: u16 = 2;
const METRE: u16 = 9001;
const DEGREE: u16 = 9102;
/// Systems of web maps, whose metres are longer than those on the ground the farther from the equator they are.
const WEB_MERCATOR: [u16; 4] = [3857, 3785, 900, 41001];

/// What the coordinates of a GeoTIFF are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeoUnits {
    /// Metres of some projection.
    Metres,
    /// Longitude and latitude.
    Degrees,
    /// The file does not say.
    Unknown,
}

/// The geo keys of a file.
struct GeoKeys(Vec<u16>);

impl GeoKeys {
    /// The value of a key that is kept in the directory itself.
    fn get(&self, key: u16) -> Option<u16> {
        self.0.get(4..)?.chunks_exact(4).find(|entry| entry[0] == key && entry[1] == 0).map(|entry| entry[3])
    }
}

impl Raster {
    /// Reads a GeoTIFF of one band (8 to 64 bits, whole or floating), compressed with deflate, LZW or PackBits or not at all. Gives
    /// the raster and what its coordinates are; one in degrees is to be [`projected`](Self::projected). `file` is only named in
    /// errors.
    ///
    /// Cells have no value where they hold NaN or what GDAL's tag for it (42113) says, and among heights -32768 and -32767, the
    /// marks of voids in surveys.
    ///
    /// # Errors
    ///
    /// Fails on other pictures, without a place, on rotated ones, on feet and on the metres of web maps, on values out of the range
    /// of the `band`, and on cells without a value unless `holes` says how to fill them. Errors have no line, but name row and
    /// column.
    pub fn from_geotiff(file: &str, content: &[u8], band: Band, holes: Holes) -> Result<(Self, GeoUnits), FileError> {
        let wrong = |reason: &dyn Display| FileError::unreadable(file, reason);
        let broken = |e: tiff::TiffError| wrong(&format!("not a readable TIFF: {e}"));
        let mut limits = Limits::default();
        (limits.decoding_buffer_size, limits.intermediate_buffer_size) = (8 * MOST_CELLS, 8 * MOST_CELLS);
        let mut decoder = Decoder::new(Cursor::new(content)).map_err(broken)?.with_limits(limits);
        let (columns, rows) = decoder.dimensions().map_err(broken)?;
        let (columns, rows) = (columns as usize, rows as usize);
        let cells = count(columns, rows).map_err(|e| wrong(&e))?;
        if cells / MOST_RATIO > content.len() {
            let reason = format!("the file is truncated: {} bytes cannot hold {columns} x {rows} cells", content.len());
            return Err(wrong(&reason));
        }
        let colours = decoder.colortype().map_err(broken)?;
        if matches!(colours, ColorType::Palette(_)) {
            return Err(wrong(&format!("the file has a palette of colours; it must hold {}s", band.name())));
        }
        let bands = colours.num_samples();
        if bands != 1 {
            return Err(wrong(&format!("the file has {bands} bands; it must have one, of {}s", band.name())));
        }
        let keys = GeoKeys(decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap_or_default());
        let units = units(&keys).map_err(|e| wrong(&e))?;
        let (corner, step) = place(&mut decoder, &keys, rows).map_err(|e| wrong(&e))?;
        let missing = decoder.get_tag_ascii_string(Tag::GdalNodata).ok();
        let missing: Option<f64> = match missing.as_ref().map(|m| m.trim_matches(['\0', ' ', '\n'])) {
            None | Some("") => None,
            Some(text) => Some(text.parse().map_err(|_| {
                wrong(&format!("its mark of cells without a value is {}, which is no number", quoted(text.as_bytes())))
            })?),
        };
        let numbers = decoder.read_image().map_err(broken)?;
        let numbers: Vec<f64> = match numbers {
            DecodingResult::U8(v) => v.into_iter().map(f64::from).collect(),
            DecodingResult::U16(v) => v.into_iter().map(f64::from).collect(),
            DecodingResult::U32(v) => v.into_iter().map(f64::from).collect(),
            DecodingResult::U64(v) => v.into_iter().map(|n| n as f64).collect(),
            DecodingResult::F16(v) => v.into_iter().map(f64::from).collect(),
            DecodingResult::F32(v) => v.into_iter().map(f64::from).collect(),
            DecodingResult::F64(v) => v,
            DecodingResult::I8(v) => v.into_iter().map(f64::from).collect(),
            DecodingResult::I16(v) => v.into_iter().map(f64::from).collect(),
            DecodingResult::I32(v) => v.into_iter().map(f64::from).collect(),
            DecodingResult::I64(v) => v.into_iter().map(|n| n as f64).collect(),
        };
        let mut values = Vec::with_capacity(cells);
        for (i, value) in numbers.into_iter().enumerate() {
            if value.is_nan() || band.is_void(value) || missing.is_some_and(|m| m as f32 == value as f32) {
                values.push(f32::NAN);
                continue;
            }
            band.check(value).map_err(|e| wrong(&format!("{}: {e}", cell_name(i, columns))))?;
            values.push(value as f32);
        }
        let raster = Self::new(columns, rows, corner, step, values).map_err(|e| wrong(&e))?;
        Ok((raster.turned_north(band, holes).map_err(|e| wrong(&e))?, units))
    }
}

/// What the coordinates are.
fn units(keys: &GeoKeys) -> Result<GeoUnits, String> {
    let in_metres = |key: u16| keys.get(key).is_none_or(|unit| unit == METRE || unit == 0);
    if !in_metres(VERTICAL_UNITS) {
        return Err("its heights are not in metres; convert them first".into());
    }
    match keys.get(MODEL_TYPE) {
        Some(IN_DEGREES) if keys.get(ANGULAR_UNITS).is_none_or(|unit| unit == DEGREE || unit == 0) => {
            Ok(GeoUnits::Degrees)
        }
        Some(IN_DEGREES) => Err("its coordinates are angles, but not degrees; convert them first".into()),
        Some(PROJECTED) if !in_metres(PROJECTED_UNITS) => {
            Err("its coordinates are not in metres; project it to a system of metres first, such as UTM".into())
        }
        Some(PROJECTED) => match keys.get(PROJECTED_SYSTEM).filter(|s| WEB_MERCATOR.contains(s)) {
            Some(system) => Err(format!(
                "its coordinates are those of web maps (EPSG:{system}), whose metres are not those of the ground; project it to \
                 a system of true metres first, such as UTM"
            )),
            None => Ok(GeoUnits::Metres),
        },
        Some(other) if other != 0 => {
            Err(format!("its kind of coordinates ({other}) is not known; allowed are projected and geographic"))
        }
        _ => Ok(GeoUnits::Unknown),
    }
}

/// The south-west corner, and the width and height of a cell.
fn place(decoder: &mut Decoder<Cursor<&[u8]>>, keys: &GeoKeys, rows: usize) -> Result<(DVec2, DVec2), String> {
    let mut numbers = |tag: Tag| decoder.get_tag_f64_vec(tag).ok();
    // A place in the picture, the same place on the plan, and the width and height of a cell.
    let (pixel, at, step) = if let Some(matrix) = numbers(Tag::ModelTransformationTag).filter(|m| m.len() >= 8) {
        if matrix[1] != 0.0 || matrix[4] != 0.0 {
            return Err("the picture is rotated; turn its rows to the east first".into());
        }
        (DVec2::ZERO, DVec2::new(matrix[3], matrix[7]), DVec2::new(matrix[0], -matrix[5]))
    } else {
        let scale = numbers(Tag::ModelPixelScaleTag).filter(|s| s.len() >= 2);
        let tie = numbers(Tag::ModelTiepointTag).filter(|t| t.len() >= 6);
        let (Some(scale), Some(tie)) = (scale, tie) else {
            return Err("the picture does not say where it lies; allowed is a GeoTIFF with a place".into());
        };
        (DVec2::new(tie[0], tie[1]), DVec2::new(tie[3], tie[4]), DVec2::new(scale[0], scale[1]))
    };
    if step.y < 0.0 {
        return Err("the first row of the picture lies in the south; it must lie in the north".into());
    }
    // Coordinates of middles are half a cell off those of corners.
    let middle = if keys.get(RASTER_TYPE) == Some(PIXEL_IS_POINT) { 0.5 } else { 0.0 };
    let pixel = pixel + middle;
    Ok((DVec2::new(at.x - pixel.x * step.x, at.y + (pixel.y - rows as f64) * step.y), step))
}
