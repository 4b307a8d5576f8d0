//! Rasters from files of any format, in one file or in tiles.

use crate::fail::Fail;
use crate::raster::{self, is_picture};
use bevy_sprawl::space::Bounds;
use bevy_sprawl::terrain::{Band, Disagreement, Holes, JoinError, PngPlace, Raster};
use glam::DVec2;
use std::path::{Path, PathBuf};

/// Where pictures lie, and what their grey means; other formats say it themselves.
#[derive(Clone, Copy)]
pub enum Picture {
    /// The flags say it.
    Placed { corner: DVec2, cell: Option<f64>, black: f64, white: Option<f64> },
    /// Over all of a box, black being 0.
    Over { bounds: Bounds, white: f64 },
}

impl Picture {
    fn place(self, path: &Path, content: &[u8]) -> Result<PngPlace, Fail> {
        match self {
            Self::Placed { corner, cell: Some(cell), black, white: Some(white) } => {
                Ok(PngPlace { corner, step: DVec2::splat(cell), black, white })
            }
            Self::Placed { .. } => {
                let needed = "a picture needs --cell and --white: the edge of a pixel, and the height of white";
                Err(Fail::file(path, needed))
            }
            Self::Over { bounds, white } => {
                let failed = |e: &dyn std::fmt::Display| Fail::file(path, format!("not a readable PNG: {e}"));
                let mut decoder = png::Decoder::new(std::io::Cursor::new(content));
                let info = decoder.read_header_info().map_err(|e| failed(&e))?;
                let pixels = DVec2::new(f64::from(info.width), f64::from(info.height));
                Ok(PngPlace { corner: bounds.min, step: bounds.size() / pixels, black: 0.0, white })
            }
        }
    }
}

/// One raster, in one file or in tiles.
pub struct Tiles<'a> {
    pub files: &'a [PathBuf],
    pub band: Band,
    pub holes: Holes,
    pub picture: Picture,
    /// Whether coordinates are to be degrees.
    pub in_degrees: bool,
}

/// What was read of a raster.
pub struct Read {
    pub tiles: usize,
    pub columns: usize,
    pub rows: usize,
    /// Cells without a value, and what they were filled with.
    pub filled: usize,
    pub fill: Option<f64>,
    /// Where tiles overlap with different values.
    pub disagreement: Option<Disagreement>,
}

impl Tiles<'_> {
    /// Reads the files and joins them.
    pub fn read(&self) -> Result<(Raster, Read), Fail> {
        let raster = match self.files {
            [one] => self.file(one, self.holes)?,
            files => {
                let tiles = files.iter().map(|f| self.file(f, Holes::Keep)).collect::<Result<Vec<_>, _>>()?;
                Raster::join(&tiles, self.band, self.holes).map_err(|e| match &e {
                    JoinError::Step { tile, .. } | JoinError::Off { tile, .. } => Fail::file(&files[*tile], e),
                    _ => Fail::file(&files[0], format!("with {} more tiles: {e}", files.len() - 1)),
                })?
            }
        };
        let fill = if let Holes::Value(value) = self.holes { Some(value) } else { None };
        let read = Read {
            tiles: self.files.len(),
            columns: raster.columns(),
            rows: raster.rows(),
            filled: raster.filled(),
            fill,
            disagreement: raster.disagreement(),
        };
        Ok((raster, read))
    }

    fn file(&self, path: &Path, holes: Holes) -> Result<Raster, Fail> {
        if is_picture(path) && self.files.len() > 1 {
            return Err(Fail::file(path, "a picture does not say where it lies, and cannot be one of several tiles"));
        }
        raster::read(path, self.band, holes, self.in_degrees, |content| self.picture.place(path, content))
    }
}
