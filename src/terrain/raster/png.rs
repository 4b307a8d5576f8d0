//! Reading grey PNG pictures as rasters.

use super::grid::{Band, MOST_CELLS, Raster, count};
use crate::layer::FileError;
use glam::DVec2;
use png::{BitDepth, ColorType, DecodingError, Limits};
use std::io::Cursor;

/// Greatest ratio by which compression can shrink an image.
const MOST_RATIO: usize = 1040;

/// The position of an image, and the meaning of its grey values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PngPlace {
    /// South-west corner of the image, in plan metres (or in degrees, if the raster is projected later).
    pub corner: DVec2,
    /// Width and height of a pixel.
    pub step: DVec2,
    /// The value of black pixels: 0.
    pub black: f64,
    /// The value of white pixels: 65,535, or 255 in an image of 8 bits.
    pub white: f64,
}

impl Raster {
    /// Reads a greyscale PNG of 16 or 8 bits. The 256 steps of 8 bits are enough for a mask, but turn heights into terraces. The
    /// first row of pixels is the northernmost.
    ///
    /// # Errors
    ///
    /// Fails if the file is no such PNG, or if a value is out of the range of the `band`. Errors have no line, because an image
    /// has none.
    pub fn from_png(file: &str, content: &[u8], band: Band, place: PngPlace) -> Result<Self, FileError> {
        let wrong = |reason: &dyn std::fmt::Display| FileError::unreadable(file, reason);
        let broken = |e: DecodingError| match e {
            DecodingError::LimitsExceeded => wrong(&"the image is too large"),
            e => wrong(&format!("not a readable PNG: {e}")),
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
                return Err(wrong(&format!("the image is {has}; it must be Grayscale of 16 or 8 bits")));
            }
        };
        let cells = count(columns, rows).map_err(|e| wrong(&e))?;
        if cells * bytes / MOST_RATIO > content.len() {
            let reason =
                format!("the file is truncated: {} bytes cannot hold {columns} x {rows} pixels", content.len());
            return Err(wrong(&reason));
        }
        let mut reader = decoder.read_info().map_err(broken)?;
        let mut pixels = vec![0; cells * bytes];
        if reader.output_buffer_size() != Some(pixels.len()) {
            return Err(wrong(&"the image has not the size that its header says"));
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
