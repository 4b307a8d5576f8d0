//! Reading rasters of any format.

use crate::fail::Fail;
use bevy_sprawl::layer::read_file;
use bevy_sprawl::terrain::{Band, GeoUnits, Holes, PngPlace, Raster};
use std::path::Path;

/// Rasters are read up to this size, in bytes: as text, 64 Mi cells of 15 characters.
const LARGEST: u64 = 1 << 30;

/// Whether a file is a picture by its name.
pub fn is_picture(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"))
}

/// Reads a raster of any format, whose coordinates are degrees or metres; `place` says where a picture of some content lies and
/// what its grey means.
pub fn read(
    path: &Path,
    band: Band,
    holes: Holes,
    in_degrees: bool,
    place: impl FnOnce(&[u8]) -> Result<PngPlace, Fail>,
) -> Result<Raster, Fail> {
    let name = path.to_string_lossy();
    let kind = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let content = match kind.as_str() {
        "asc" | "png" | "tif" | "tiff" => read_file(path, LARGEST)?,
        _ => return Err(Fail::file(path, "unknown kind of file; the name must end in .asc .tif .tiff .png")),
    };
    match kind.as_str() {
        "asc" => Ok(Raster::from_ascii(&name, &content, band, holes)?),
        "png" => Ok(Raster::from_png(&name, &content, band, holes, place(&content)?)?),
        _ => {
            let (raster, units) = Raster::from_geotiff(&name, &content, band, holes)?;
            match (units, in_degrees) {
                (GeoUnits::Degrees, false) => Err(Fail::file(
                    path,
                    "is in degrees; places here are in metres (`sprawl roads --geographic` takes degrees)",
                )),
                (GeoUnits::Metres, true) => {
                    Err(Fail::file(path, "is in metres; with --geographic all places are in degrees"))
                }
                _ => Ok(raster),
            }
        }
    }
}
