//! Reading rasters of any format.

use crate::fail::Fail;
use bevy_sprawl::terrain::{Band, Holes, PngPlace, Raster};
use std::path::Path;

/// Whether a file is a picture by its name.
pub fn is_picture(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"))
}

/// Reads a raster of any format; `place` says where a picture lies and what its grey means.
pub fn read(
    path: &Path,
    band: Band,
    holes: Holes,
    place: impl FnOnce() -> Result<PngPlace, Fail>,
) -> Result<Raster, Fail> {
    let name = path.to_string_lossy();
    let content = std::fs::read(path).map_err(|e| Fail::file(path, e))?;
    match path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).as_deref() {
        Some("asc") => Ok(Raster::from_ascii(&name, &content, band, holes)?),
        Some("png") => Ok(Raster::from_png(&name, &content, band, place()?)?),
        _ => Err(Fail::file(path, "unknown kind of file; the name must end in .asc .png")),
    }
}
