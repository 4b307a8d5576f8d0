//! A map as SVG: shaded relief, water, blocks, lots, buildings, streets by class, names and a scale bar.

mod furniture;
mod label;
mod layers;
mod sheet;

pub use self::sheet::Colouring;
pub(super) use self::sheet::trace;

use crate::export::relief::Relief;
use crate::export::{ExportError, Plan};
use crate::space::Bounds;
use glam::DVec2;
use sheet::Sheet;
use svg::Document;
use svg::node::element::Image;

/// How a map is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapStyle {
    /// Longer side in pixels (in an SVG: units of its coordinates).
    pub pixels: u32,
    /// What the colours of streets show.
    pub colouring: Colouring,
    /// Whether the map has a legend of its signs.
    pub legend: bool,
    /// Title, written at the upper left; none if empty.
    pub title: &'static str,
}

impl Default for MapStyle {
    fn default() -> Self {
        Self { pixels: 1600, colouring: Colouring::Class, legend: false, title: "" }
    }
}

impl MapStyle {
    /// Width and height of the picture of a box, in pixels.
    pub(super) fn size(&self, bounds: Bounds) -> [u32; 2] {
        let size = bounds.size() / bounds.size().max_element() * f64::from(self.pixels);
        size.to_array().map(|n| n.round().max(1.0) as u32)
    }
}

/// Draws a plan as an SVG document, the shaded relief embedded as a picture.
pub fn write(plan: &Plan<'_>, style: &MapStyle) -> Result<String, ExportError> {
    Ok(with_relief(plan, style)?.to_string())
}

/// Draws two plans beside each other as one SVG document.
pub fn write_pair(plans: [(&Plan<'_>, &MapStyle); 2]) -> Result<String, ExportError> {
    let [left, right] = plans.map(|(plan, style)| (style.size(plan.area.bounds), with_relief(plan, style)));
    let (width, height) = (left.0[0] + right.0[0], left.0[1].max(right.0[1]));
    let whole = Document::new().set("viewBox", (0, 0, width, height)).set("width", width).set("height", height);
    Ok(whole.add(left.1?).add(right.1?.set("x", left.0[0])).to_string())
}

fn with_relief(plan: &Plan<'_>, style: &MapStyle) -> Result<Document, ExportError> {
    let relief = relief(plan, style);
    let small = MapStyle { pixels: style.pixels.min(800), ..*style };
    let png =
        relief.raster(small.size(plan.area.bounds))?.encode_png().map_err(|e| ExportError::Format(e.to_string()))?;
    let [width, height] = style.size(plan.area.bounds);
    let picture = Image::new()
        .set("width", width)
        .set("height", height)
        .set("preserveAspectRatio", "none")
        .set("href", format!("data:image/png;base64,{}", base64(&png)));
    Ok(document(plan, style, &relief, Some(picture)))
}

/// The ground of a plan, a sample for every second pixel.
pub(super) fn relief(plan: &Plan<'_>, style: &MapStyle) -> Relief {
    Relief::new(plan.terrain, plan.area.bounds, (style.pixels as usize / 2).clamp(64, 1000))
}

/// Draws a plan on `picture`, the shaded land.
pub(super) fn document(plan: &Plan<'_>, style: &MapStyle, relief: &Relief, picture: Option<Image>) -> Document {
    let bounds = plan.area.bounds;
    let size = DVec2::from_array(style.size(bounds).map(f64::from));
    let longer = f64::from(style.pixels);
    let sheet = Sheet {
        size,
        longer,
        scale: longer / bounds.size().max_element(),
        corner: plan.area.origin.to_local(DVec2::new(bounds.min.x, bounds.max.y)),
        colouring: style.colouring,
        region: plan.area.blocks.is_empty(),
        // What turns drawings into pixels knows no fonts.
        has_text: picture.is_some(),
    };
    let mut taken = vec![sheet.scale_box()];
    let mut cards = Vec::new();
    if !style.title.is_empty() {
        let (group, around) = sheet.title(style.title);
        cards.push(group);
        taken.push(around);
    }
    if style.legend {
        let (group, around) = sheet.legend(plan, relief.has_water(), relief.has_wood(), &taken);
        cards.push(group);
        taken.push(around);
    }
    let mut groups = vec![sheet.ground(relief)];
    groups.extend(sheet.parcels(plan));
    if let Some(real) = plan.real {
        groups.push(sheet.real(real, real.origin.offset_to(plan.area.origin)));
    }
    groups.push(sheet.streets(plan));
    if sheet.region {
        groups.push(sheet.junctions(plan));
        groups.push(sheet.symbols(plan));
    }
    groups.push(sheet.names(plan, taken));
    groups.extend(cards);
    groups.push(sheet.scale_bar());
    let whole = Document::new().set("viewBox", (0.0, 0.0, size.x, size.y)).set("width", size.x).set("height", size.y);
    groups.into_iter().fold(picture.into_iter().fold(whole, Document::add), Document::add)
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let word = three.iter().fold(0u32, |w, b| w << 8 | u32::from(*b)) << (8 * (3 - three.len()));
        for digit in 0..4 {
            let at = (word >> (18 - 6 * digit) & 63) as usize;
            out.push(if digit <= three.len() { DIGITS[at] as char } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::png::spelled_in_latin;
    use crate::testing;

    #[test]
    fn base64_pads() {
        assert_eq!(
            ["Ma", "Man", "M", "light w"].map(|s| base64(s.as_bytes())),
            ["TWE=", "TWFu", "TQ==", "bGlnaHQgdw=="]
        );
    }

    #[test]
    fn names_in_any_script_stand_on_the_map() {
        let mut town = testing::area(DVec2::ZERO);
        let mut settlement = (*town.area.settlements[0]).clone();
        settlement.name = "\u{6771}\u{4eac}".into();
        let spelled = Plan { area: &town.area.clone(), ..town.plan() };
        assert!(spelled_in_latin(&spelled).is_empty());
        town.area.settlements = vec![std::sync::Arc::new(settlement)];
        let text = write(&town.plan(), &MapStyle { pixels: 400, ..MapStyle::default() }).unwrap();
        assert!(text.contains("<text") && text.matches("\u{6771}\u{4eac}").count() == 2, "as text, and as title");
        assert_eq!(spelled_in_latin(&town.plan()), [("\u{6771}\u{4eac}".to_owned(), "Dong Jing".to_owned())]);
    }

    #[test]
    fn the_drawing_has_every_street_once_in_each_of_its_layers() {
        let town = testing::area(DVec2::new(-5000.0, 77.0));
        let text = write(&town.plan(), &MapStyle { pixels: 400, ..MapStyle::default() }).unwrap();
        let pens = text.matches("stroke=\"#ffffff\"").count();
        assert!(pens >= 1 && text.contains("Sample &amp; Sons"), "{pens}");
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }
}
