//! A map as PNG: the drawing of [`svg`](crate::export::svg) in pixels.

use crate::export::svg::{MapStyle, document, relief};
use crate::export::{ExportError, Plan};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg;

/// Draws a plan as a PNG file.
pub fn write(plan: &Plan<'_>, style: &MapStyle) -> Result<Vec<u8>, ExportError> {
    let relief = relief(plan, style);
    let mut pixels = relief.raster(style.pixels)?;
    draw(&document(plan, style, &relief, None).to_string(), &mut pixels)?;
    encode(&pixels)
}

/// Draws any SVG text as a PNG file, on white. It may use neither fonts nor pictures.
pub fn from_svg(text: &str) -> Result<Vec<u8>, ExportError> {
    let size = tree(text)?.size().to_int_size();
    let mut pixels = Pixmap::new(size.width(), size.height())
        .ok_or_else(|| ExportError::Format("the drawing has no size".into()))?;
    pixels.fill(Color::WHITE);
    draw(text, &mut pixels)?;
    encode(&pixels)
}

fn tree(text: &str) -> Result<usvg::Tree, ExportError> {
    usvg::Tree::from_str(text, &usvg::Options::default()).map_err(|e| ExportError::Format(e.to_string()))
}

fn draw(text: &str, pixels: &mut Pixmap) -> Result<(), ExportError> {
    resvg::render(&tree(text)?, Transform::identity(), &mut pixels.as_mut());
    Ok(())
}

fn encode(pixels: &Pixmap) -> Result<Vec<u8>, ExportError> {
    pixels.encode_png().map_err(|e| ExportError::Format(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::sample;
    use glam::DVec2;

    #[test]
    fn a_picture_has_its_size_and_its_colours() {
        let town = sample::town(DVec2::new(900.0, 900.0));
        let file = write(&town.plan(), &MapStyle { pixels: 300, ..Default::default() }).unwrap();
        let back = Pixmap::decode_png(&file).unwrap();
        assert_eq!((back.width(), back.height()), (300, 300));
        let colours: std::collections::BTreeSet<_> =
            back.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect();
        assert!(colours.len() > 200, "{}", colours.len());
        assert!(back.pixels().iter().all(|p| p.alpha() == 255));
    }
}
