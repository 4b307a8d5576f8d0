//! The pixels of a mask: road, building or neither.

use super::options::MaskOptions;
use crate::layer::FileError;
use crate::map::error::MapError;
use png::{DecodingError, Limits, Transformations};
use std::collections::BTreeMap;
use std::io::Cursor;

/// Greatest number of pixels.
const MOST_PIXELS: usize = 64 << 20;
/// Greatest ratio by which compression can shrink an image.
const MOST_RATIO: usize = 1040;
/// Greatest difference of a channel from a colour at which a pixel still has that colour: what JPEG adds.
const NEAR: u8 = 48;
/// Least share of the pixels that has one of the three colours of a mask. The others are mixed where the colours meet.
const LEAST_CLEAR: f64 = 0.72;
/// Greatest share of the pixels that are road; more is a picture of something else.
const MOST_ROAD: f64 = 0.7;

/// What a pixel is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pixel {
    Road,
    Building,
    Neither,
}

/// A mask.
pub(super) struct Picture {
    pub width: usize,
    pub height: usize,
    /// Row by row from the north.
    pub pixels: Vec<Pixel>,
}

type Colour = [u8; 3];

fn difference(a: Colour, b: Colour) -> u8 {
    (0..3).map(|i| a[i].abs_diff(b[i])).max().unwrap_or(0)
}

impl Picture {
    /// Reads a PNG of any kind. What is transparent shows white behind it.
    pub fn read(file: &str, content: &[u8], options: &MaskOptions) -> Result<Self, MapError> {
        let (width, height, colours) = decode(file, content)?;
        let background = background(&colours, options);
        let kind = |colour: &Colour| {
            let off = [options.roads, options.buildings, background].map(|c| distance(*colour, c));
            match () {
                () if off[0] < off[1] && off[0] < off[2] => Pixel::Road,
                () if off[1] < off[2] => Pixel::Building,
                () => Pixel::Neither,
            }
        };
        let picture = Self { width, height, pixels: colours.iter().map(kind).collect() };
        picture.check(file, &colours, background, options)?;
        Ok(picture)
    }

    /// The pixel at a column and row, `Neither` outside.
    pub fn at(&self, x: i64, y: i64) -> Pixel {
        let inside = x >= 0 && y >= 0 && x < self.width as i64 && y < self.height as i64;
        if inside { self.pixels[y as usize * self.width + x as usize] } else { Pixel::Neither }
    }

    /// Refuses what is no mask, with the colours that were found.
    fn check(&self, file: &str, colours: &[Colour], background: Colour, options: &MaskOptions) -> Result<(), MapError> {
        let all = colours.len().max(1) as f64;
        let known = [options.roads, options.buildings, background];
        let clear = colours.iter().filter(|c| known.iter().any(|k| difference(**c, *k) <= NEAR)).count() as f64 / all;
        let roads = self.pixels.iter().filter(|p| **p == Pixel::Road).count() as f64 / all;
        let reason = match () {
            () if clear < LEAST_CLEAR => format!(
                "only {:.0} % of its pixels have the colour of roads {}, of buildings {} or of the background; a photo?",
                100.0 * clear,
                name(options.roads),
                name(options.buildings)
            ),
            () if roads == 0.0 => format!("no pixel has the colour of roads, {}", name(options.roads)),
            () if roads > MOST_ROAD => format!("{:.0} % of its pixels are road", 100.0 * roads),
            () => return Ok(()),
        };
        Err(MapError::NoMask { file: file.into(), reason, colours: most_common(colours) })
    }
}

/// Square of the distance between two colours.
fn distance(a: Colour, b: Colour) -> u32 {
    (0..3).map(|i| u32::from(a[i].abs_diff(b[i])).pow(2)).sum()
}

/// The most common colour that is neither that of roads nor that of buildings.
fn background(colours: &[Colour], options: &MaskOptions) -> Colour {
    let is_other = |c: &Colour| [options.roads, options.buildings].iter().all(|k| difference(*c, *k) > NEAR);
    counted(colours.iter().filter(|c| is_other(c))).first().map_or([255; 3], |(colour, _)| *colour)
}

/// Colours by how often they come up, the most common first. Colours that differ little count as one.
fn counted<'a>(colours: impl Iterator<Item = &'a Colour>) -> Vec<(Colour, usize)> {
    let mut counts: BTreeMap<Colour, (usize, Colour)> = BTreeMap::new();
    for colour in colours {
        counts.entry(colour.map(|c| c / 32)).or_insert((0, *colour)).0 += 1;
    }
    let mut out: Vec<(Colour, usize)> = counts.into_values().map(|(count, colour)| (colour, count)).collect();
    out.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    out
}

fn name([red, green, blue]: Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The most common colours with their shares, for people.
fn most_common(colours: &[Colour]) -> String {
    let share = |count: usize| 100.0 * count as f64 / colours.len().max(1) as f64;
    let named = counted(colours.iter()).into_iter().take(4).map(|(c, n)| format!("{} {:.0} %", name(c), share(n)));
    named.collect::<Vec<_>>().join(", ")
}

/// Width, height and colours of a PNG.
fn decode(file: &str, content: &[u8]) -> Result<(usize, usize, Vec<Colour>), MapError> {
    let wrong = |reason: &dyn std::fmt::Display| MapError::File(FileError::unreadable(file, reason));
    let broken = |e: DecodingError| match e {
        DecodingError::LimitsExceeded => wrong(&"the image is too large"),
        e => wrong(&format!("not a readable PNG: {e}")),
    };
    let limits = Limits { bytes: 8 * MOST_PIXELS };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(content), limits);
    decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
    let info = decoder.read_header_info().map_err(broken)?;
    let (width, height) = (info.width as usize, info.height as usize);
    let pixels = width.saturating_mul(height);
    if pixels > MOST_PIXELS {
        return Err(MapError::TooLarge { file: file.into(), what: "pixels", limit: MOST_PIXELS as u64 });
    }
    if pixels / 8 / MOST_RATIO > content.len() {
        let reason = format!("the file is truncated: {} bytes cannot hold {width} x {height} pixels", content.len());
        return Err(wrong(&reason));
    }
    let mut reader = decoder.read_info().map_err(broken)?;
    let samples = reader.output_color_type().0.samples();
    let mut bytes = vec![0; pixels * samples];
    if reader.output_buffer_size() != Some(bytes.len()) {
        return Err(wrong(&"the image has not the size that its header says"));
    }
    reader.next_frame(&mut bytes).map_err(broken)?;
    let over_white = |c: u8, alpha: u8| 255 - ((255 - u16::from(c)) * u16::from(alpha) / 255) as u8;
    let colour = |pixel: &[u8]| match *pixel {
        [grey] => [grey; 3],
        [grey, alpha] => [over_white(grey, alpha); 3],
        [r, g, b, alpha] => [r, g, b].map(|c| over_white(c, alpha)),
        _ => [pixel[0], pixel[1], pixel[2]],
    };
    Ok((width, height, bytes.chunks_exact(samples).map(colour).collect()))
}
