//! Reading grey PNG pictures as rasters.

use super::grid::{MOST_CELLS, count};
use super::{Band, Raster};
use crate::layer::FileError;
use glam::DVec2;
use png::{BitDepth, ColorType, DecodingError, Limits};
use std::io::Cursor;

/// The most that compression can shrink a picture.
const MOST_RATIO: usize = 1040;

/// Where a picture lies, and what its grey means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PngPlace {
    /// South-west corner of the picture, in plan metres (or degrees, to be projected).
    pub corner: DVec2,
    /// Width and height of a pixel.
    pub step: DVec2,
    /// The number at black: 0.
    pub black: f64,
    /// The number at white: 65,535, or 255 in a picture of 8 bits.
    pub white: f64,
}

impl Raster {
    /// Reads a grey PNG of 16 bits, or of 8, whose 256 steps are enough for a mask but make terraces of heights. The first
    /// row of pixels is the northernmost. Errors have no line, for a picture has none.
    pub fn from_png(file: &str, content: &[u8], band: Band, place: PngPlace) -> Result<Self, FileError> {
        let wrong = |reason: &dyn std::fmt::Display| FileError::unreadable(file, reason);
        let broken = |e: DecodingError| match e {
            DecodingError::LimitsExceeded => wrong(&"the picture is too large"),
            e => wrong(&format!("no readable PNG: {e}")),
        };
        band.check(place.black).and_then(|()| band.check(place.white)).map_err(|e| wrong(&e))?;
        let limits = Limits { bytes: 4 * MOST_CELLS };
        let mut decoder = png::Decoder::new_with_limits(Cursor::new(content), limits);
        let info = decoder.read_header_info().map_err(broken)?;
        let (columns, rows) = (info.width as usize, info.height as usize);
        let (colour, bits) = (info.color_type, info.bit_depth);
        let bytes = match (colour, bits) {
            (ColorType::Grayscale, BitDepth::Sixteen) => 2,
            (ColorType::Grayscale, BitDepth::Eight) => 1,
            _ => {
                let has = format!("{colour:?} of {} bits", bits as u8);
                return Err(wrong(&format!("the picture is {has}; allowed is Grayscale of 16 or 8 bits")));
            }
        };
        let cells = count(columns, rows).map_err(|e| wrong(&e))?;
        if cells * bytes / MOST_RATIO > content.len() {
            let reason = format!("the file ends early: {} bytes cannot hold {columns} x {rows} pixels", content.len());
            return Err(wrong(&reason));
        }
        let mut reader = decoder.read_info().map_err(broken)?;
        let mut pixels = vec![0; cells * bytes];
        if reader.output_buffer_size() != Some(pixels.len()) {
            return Err(wrong(&"the picture has another size than its header says"));
        }
        reader.next_frame(&mut pixels).map_err(broken)?;
        let number = |pixel: &[u8]| {
            let grey = match *pixel {
                [high, low] => f64::from(u16::from_be_bytes([high, low])) / 65_535.0,
                _ => f64::from(pixel[0]) / 255.0,
            };
            (place.black + (place.white - place.black) * grey) as f32
        };
        let values = pixels.chunks_exact(columns * bytes).rev().flat_map(|row| row.chunks_exact(bytes).map(number));
        Self::new(columns, rows, place.corner, place.step, values.collect()).map_err(|e| wrong(&e))
    }
}
