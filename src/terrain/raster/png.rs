//! Reading grey PNG pictures as rasters.

use super::band::Band;
use super::grid::{MOST_CELLS, Raster, cell_name, count};
use super::holes::Holes;
use crate::layer::FileError;
use glam::DVec2;
use png::{BitDepth, ColorType, DecodingError, Limits, Transformations};
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
    /// Reads a grey PNG of any kind: grey of 16, 8 or fewer bits, or colours and palettes whose channels are equal. The 256 steps
    /// of 8 bits are enough for a mask, but turn heights into terraces; heights of fewer bits are refused. Transparent pixels
    /// have no value. The first row of pixels is the northernmost.
    ///
    /// # Errors
    ///
    /// Fails if the file is no such PNG, if a pixel has a colour or is half transparent, if a value is out of the range of the
    /// `band`, and on pixels without a value unless `holes` says how to fill them. Errors have no line, because an image has none,
    /// but name row and column.
    pub fn from_png(file: &str, content: &[u8], band: Band, holes: Holes, place: PngPlace) -> Result<Self, FileError> {
        let wrong = |reason: &dyn std::fmt::Display| FileError::unreadable(file, reason);
        let broken = |e: DecodingError| match e {
            DecodingError::LimitsExceeded => wrong(&"the image is too large"),
            e => wrong(&format!("not a readable PNG: {e}")),
        };
        band.check(place.black).and_then(|()| band.check(place.white)).map_err(|e| wrong(&e))?;
        let limits = Limits { bytes: 8 * MOST_CELLS };
        let mut decoder = png::Decoder::new_with_limits(Cursor::new(content), limits);
        decoder.set_transformations(Transformations::EXPAND);
        let info = decoder.read_header_info().map_err(broken)?;
        let (columns, rows) = (info.width as usize, info.height as usize);
        let bits = info.bit_depth as u8;
        if band == Band::Height && bits < 8 {
            return Err(wrong(&format!("the image has {bits} bits; heights need 8, or better 16")));
        }
        let cells = count(columns, rows).map_err(|e| wrong(&e))?;
        let in_file = (cells / 8 * usize::from(bits)).saturating_mul(info.color_type.samples());
        if in_file / MOST_RATIO > content.len() {
            let reason =
                format!("the file is truncated: {} bytes cannot hold {columns} x {rows} pixels", content.len());
            return Err(wrong(&reason));
        }
        let mut reader = decoder.read_info().map_err(broken)?;
        // Palettes and fewer bits are colours or grey of 8 bits by now.
        let (colour, depth) = reader.output_color_type();
        let channel = if depth == BitDepth::Sixteen { 2 } else { 1 };
        let bytes = colour.samples() * channel;
        let mut pixels = vec![0; cells * bytes];
        if reader.output_buffer_size() != Some(pixels.len()) {
            return Err(wrong(&"the image has not the size that its header says"));
        }
        reader.next_frame(&mut pixels).map_err(broken)?;
        let most = if channel == 2 { 65_535.0 } else { 255.0 };
        let number = |channel: &[u8]| match *channel {
            [high, low] => f64::from(u16::from_be_bytes([high, low])),
            _ => f64::from(channel[0]),
        };
        let has_alpha = matches!(colour, ColorType::GrayscaleAlpha | ColorType::Rgba);
        let mut values = Vec::with_capacity(cells);
        for (i, pixel) in pixels.chunks_exact(bytes).enumerate() {
            let (grey, alpha) = if has_alpha { pixel.split_at(bytes - channel) } else { (pixel, &pixel[..0]) };
            if alpha.iter().any(|b| *b != 0xff) {
                if alpha.iter().any(|b| *b != 0) {
                    return Err(wrong(&format!("{} is half transparent", cell_name(i, columns))));
                }
                values.push(f32::NAN);
                continue;
            }
            let mut channels = grey.chunks_exact(channel);
            let first = channels.next().unwrap_or_default();
            if channels.any(|c| c != first) {
                let colours: Vec<String> = grey.chunks_exact(channel).map(|c| number(c).to_string()).collect();
                let reason = format!(
                    "{} has the colour {}; allowed is grey: red, green and blue alike",
                    cell_name(i, columns),
                    colours.join(" ")
                );
                return Err(wrong(&reason));
            }
            values.push((place.black + (place.white - place.black) * (number(first) / most)) as f32);
        }
        let raster = Self::new(columns, rows, place.corner, place.step, values).map_err(|e| wrong(&e))?;
        raster.turned_north(band, holes).map_err(|e| wrong(&e))
    }
}
