//! A map as SVG: shaded relief, water, blocks, lots, buildings, streets by class, names and a scale bar.

mod furniture;

use crate::export::relief::Relief;
use crate::export::{ExportError, Plan, narrowest_first};
use crate::network::{Street, StreetClass};
use crate::parcel::BlockUse;
use crate::space::Bounds;
use crate::stack::PlacedStreet;
use crate::streets::MadeBy;
use furniture::nice;
use glam::DVec2;
use std::fmt::Write;
use svg::Document;
use svg::node::element::{Group, Image, Path};

/// What the colour of a street says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colouring {
    /// Its class.
    #[default]
    Class,
    /// What made it: main street, patch, growth or repair.
    Origin,
}

/// How a map is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapStyle {
    /// Longer side in pixels (in an SVG: units of its coordinates).
    pub pixels: u32,
    /// What colours say.
    pub colouring: Colouring,
    /// Whether a map of a region explains its signs.
    pub legend: bool,
    /// What the map is of, written at its upper left; empty for nothing.
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

/// Draws a plan; `picture` is the land that all else is drawn on.
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

/// Where plan points lie on the drawing.
struct Sheet {
    /// Width and height in pixels, and the longer of the two.
    size: DVec2,
    longer: f64,
    /// Pixels per metre.
    scale: f64,
    /// North-west corner, local to the area.
    corner: DVec2,
    colouring: Colouring,
    /// Whether settlements and roads are all there is.
    region: bool,
}

/// How a stroke is drawn.
#[derive(Clone, Copy)]
struct Pen {
    width: f64,
    colour: &'static str,
    cap: &'static str,
    dashed: bool,
}

impl Sheet {
    fn place(&self, local: DVec2) -> DVec2 {
        let d = (local - self.corner) * self.scale;
        DVec2::new(d.x, -d.y)
    }

    /// The local point that lies at a pixel.
    fn unplaced(&self, at: DVec2) -> DVec2 {
        self.corner + DVec2::new(at.x, -at.y) / self.scale
    }

    fn placed(&self, line: &[DVec2]) -> Vec<DVec2> {
        line.iter().map(|p| self.place(*p)).collect()
    }

    fn ground(&self, relief: &Relief) -> Group {
        let mut group = Group::new().set("id", "ground").set("fill", "none");
        if let Some((low, high)) = relief.heights() {
            let step = nice(((high - low) / 14.0).max(2.0));
            let mut level = (low / step).ceil() * step;
            while level < high {
                let index = (level / step).round() as i64 % 5 == 0;
                let mut data = String::new();
                relief.rings(self.longer, level, |s| s.height).iter().for_each(|r| trace(&mut data, r, true));
                let width = if index { 0.9 } else { 0.45 };
                let contour = Path::new().set("d", data).set("stroke", "#8a6f4a").set("stroke-width", width);
                group = group.add(contour.set("stroke-opacity", if index { 0.4 } else { 0.28 }));
                level += step;
            }
        }
        for (depth, fill) in [(0.0, "#a9cfe6"), (3.0, "#9cc5df"), (10.0, "#8eb9d7"), (30.0, "#80accc")] {
            let (rings, shore) = match depth {
                0.0 => (relief.shores(self.longer), "#6c9dbf"),
                _ => (relief.rings(self.longer, depth, |s| s.water_level - s.height), "none"),
            };
            let mut data = String::new();
            rings.iter().for_each(|r| trace(&mut data, r, true));
            let water = Path::new().set("d", data).set("fill", fill).set("fill-rule", "evenodd");
            group = group.add(water.set("stroke", shore).set("stroke-width", 1.2));
        }
        group
    }

    fn parcels(&self, plan: &Plan<'_>) -> Vec<Group> {
        let area = plan.area;
        let mut groups = Vec::new();
        if area.blocks.is_empty() {
            let rings = plan.outlines.iter().map(|o| {
                let offset = o.origin.offset_to(area.origin);
                o.polygon.iter().map(|p| self.place(*p + offset)).collect()
            });
            groups.push(fill(rings, "towns", "#dcc3a6", Some("#8d6f4f")).set("fill-opacity", 0.85));
        }
        for (used_as, id, colour) in [(BlockUse::Built, "blocks", "#ece6da"), (BlockUse::Park, "parks", "#bfdca6")] {
            let of = area.blocks.iter().filter(|b| b.it.used_as == used_as);
            groups.push(fill(of.map(|b| self.placed(&b.it.polygon)), id, colour, None));
        }
        if self.scale > 0.25 {
            let lots = area.lots.iter().map(|l| self.placed(&l.it.polygon));
            let thin = (0.12 * self.scale).clamp(0.15, 1.0);
            groups.push(fill(lots, "lots", "#f1ecdf", Some("#d3c8b4")).set("stroke-width", thin));
        }
        if self.scale > 0.08 {
            let buildings = || area.footprints.iter();
            let shadow = |storeys: u32| DVec2::new(0.45, 0.45) * (f64::from(storeys) + 0.6) * self.scale;
            let shadows = buildings().map(|b| {
                let offset = shadow(b.it.storeys);
                self.placed(&b.it.polygon).into_iter().map(|p| p + offset).collect()
            });
            groups.push(fill(shadows, "shadows", "#5b5348", None).set("fill-opacity", 0.3));
            for (from, to, colour) in BUILDINGS {
                let of = buildings().filter(|b| (from..to).contains(&b.it.storeys));
                let edge = (self.scale > 0.3).then_some("#8f7a64");
                let thin = (0.15 * self.scale).clamp(0.2, 1.0);
                groups.push(
                    fill(of.map(|b| self.placed(&b.it.polygon)), "buildings", colour, edge).set("stroke-width", thin),
                );
            }
        }
        groups
    }

    /// Streets from the lowest level up; in a level all casings lie under all carriageways, so that these join.
    fn streets(&self, plan: &Plan<'_>) -> Group {
        let mut group = Group::new().set("id", "streets").set("fill", "none").set("stroke-linejoin", "round");
        let streets = || plan.area.streets.iter().map(|s| &s.it);
        let levels: std::collections::BTreeSet<i8> = streets().map(|s| s.street.level).collect();
        for level in levels {
            let here = || streets().filter(move |s| s.street.level == level);
            for layer in [Layer::Pavement, Layer::Casing, Layer::Carriageway] {
                for class in narrowest_first() {
                    for tunnel in [true, false] {
                        let of = here().filter(|s| s.street.class == class && s.street.tunnel == tunnel);
                        let Some(pen) = self.pen(class, layer, tunnel) else { continue };
                        let bridge = self.bridge_pen(pen);
                        let (over, plain): (Vec<_>, Vec<_>) =
                            of.partition(|s| s.street.bridge && layer == Layer::Casing);
                        group = self.stroke(group, over.into_iter().map(|s| &s.street), bridge);
                        if layer == Layer::Carriageway && self.colouring == Colouring::Origin {
                            for (made_by, colour) in ORIGINS {
                                let of = plain.iter().filter(|s| origin_name(s) == made_by);
                                group = self.stroke(group, of.map(|s| &s.street), Pen { colour, ..pen });
                            }
                        } else {
                            group = self.stroke(group, plain.into_iter().map(|s| &s.street), pen);
                        }
                    }
                }
            }
        }
        group
    }

    /// A bridge's casing ends square, and is darker.
    fn bridge_pen(&self, casing: Pen) -> Pen {
        let wider = if self.region { 3.6 * self.longer / 1600.0 } else { 1.6 };
        let colour = if self.region { "#221d18" } else { "#5f574c" };
        Pen { width: casing.width + wider, colour, cap: "butt", ..casing }
    }

    fn pen(&self, class: StreetClass, layer: Layer, tunnel: bool) -> Option<Pen> {
        use StreetClass::{Arterial, Highway, Local, Main, Major, Minor};
        // Least width in pixels, colours of carriageway and casing. From far off roads are drawn far wider than they are.
        let (least, inner, casing) = match class {
            Highway if self.region => (4.6, "#e2683f", "#7d2a12"),
            Major if self.region => (3.5, "#f6b545", "#86571a"),
            Minor if self.region => (2.3, "#fff2a6", "#6f6338"),
            Highway => (2.4, "#f0a160", "#a4602b"),
            Major => (1.8, "#f7cf86", "#b3853b"),
            Minor => (1.2, "#fdf4cf", "#a99b74"),
            Arterial => (1.7, "#fbe29d", "#bd9648"),
            Main => (1.2, "#fff6d6", "#b9a678"),
            Local => (0.7, "#ffffff", "#b4aa9b"),
        };
        let least = if self.region { least * self.longer / 1600.0 } else { least };
        let width = (class.carriageway() * self.scale).max(least);
        let edge = if self.region { 0.8 * self.longer / 1600.0 } else { (0.35 * self.scale).clamp(0.35, 1.2) };
        let (width, colour) = match layer {
            Layer::Pavement if self.scale < 0.4 || class.pavement() == 0.0 => return None,
            Layer::Pavement => (2.0 * class.half_width() * self.scale, "#ddd6c8"),
            // Streets thinner than a pixel and a half are a line without edges.
            Layer::Casing if width < 1.5 && class == Local => (width, "#968d80"),
            Layer::Carriageway if width < 1.5 && class == Local && self.colouring == Colouring::Class => return None,
            Layer::Casing => (width + 2.0 * edge, casing),
            Layer::Carriageway => (width, inner),
        };
        let colour = if tunnel && layer == Layer::Carriageway { "#efe9e0" } else { colour };
        Some(Pen { width, colour, cap: "round", dashed: tunnel && layer == Layer::Casing })
    }

    fn stroke<'a>(&self, group: Group, streets: impl Iterator<Item = &'a Street>, pen: Pen) -> Group {
        let lines = streets.map(|s| self.placed(&s.line));
        paths(lines, false).into_iter().fold(group, |group, data| {
            let path = Path::new()
                .set("d", data)
                .set("stroke", pen.colour)
                .set("stroke-width", round(pen.width))
                .set("stroke-linecap", if pen.dashed { "butt" } else { pen.cap });
            group.add(if pen.dashed { path.set("stroke-dasharray", (4, 3)) } else { path })
        })
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Layer {
    Pavement,
    Casing,
    Carriageway,
}

/// What makes streets, and the colour for it. Local streets that nothing here made are those of a real map.
const ORIGINS: [(&str, &str); 5] = [
    ("main", "#8d8779"),
    ("patch", "#3f7fbf"),
    ("growth", "#e8963a"),
    ("repair", "#d03a3a"),
    ("real local", "#ffffff"),
];

fn origin_name(placed: &PlacedStreet) -> &'static str {
    match placed.made_by {
        None if placed.street.class == StreetClass::Local => "real local",
        None => "main",
        Some(MadeBy::Patch(_)) => "patch",
        Some(MadeBy::Growth) => "growth",
        Some(MadeBy::Repair) => "repair",
    }
}

/// The fill of buildings up to a number of storeys.
const BUILDINGS: [(u32, u32, &str); 3] = [(0, 3, "#d2bfa8"), (3, 6, "#c6ad93"), (6, u32::MAX, "#b59b82")];

/// A number in hundredths.
fn round(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}

/// Adds a polyline or ring to path data, in hundredths of a pixel.
pub(super) fn trace(data: &mut String, points: &[DVec2], close: bool) {
    for (i, p) in points.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(data, "{}{:.2} {:.2}", if i == 0 { "M" } else { "L" }, p.x, p.y);
    }
    if close {
        data.push('Z');
    }
}

/// Path data of many lines, some hundreds to a path: rasterizers slow down on paths with a great many edges.
fn paths(lines: impl Iterator<Item = Vec<DVec2>>, close: bool) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for (i, line) in lines.enumerate() {
        if i % 400 == 0 {
            out.push(String::new());
        }
        if let Some(data) = out.last_mut() {
            trace(data, &line, close);
        }
    }
    out
}

fn fill(rings: impl Iterator<Item = Vec<DVec2>>, id: &str, colour: &str, edge: Option<&str>) -> Group {
    let group = Group::new().set("class", id).set("fill", colour).set("stroke", edge.unwrap_or("none"));
    paths(rings, true).into_iter().fold(group, |group, data| group.add(Path::new().set("d", data)))
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
    use crate::export::sample;

    #[test]
    fn base64_pads() {
        assert_eq!(
            ["Ma", "Man", "M", "light w"].map(|s| base64(s.as_bytes())),
            ["TWE=", "TWFu", "TQ==", "bGlnaHQgdw=="]
        );
    }

    #[test]
    fn round_lengths() {
        assert_eq!([1.0, 1.9, 2.0, 49.0, 333.0, 6000.0].map(nice), [1.0, 1.0, 2.0, 20.0, 200.0, 5000.0]);
    }

    #[test]
    fn the_drawing_has_every_street_once_in_each_of_its_layers() {
        let town = sample::town(DVec2::new(-5000.0, 77.0));
        let text = write(&town.plan(), &MapStyle { pixels: 400, ..MapStyle::default() }).unwrap();
        let pens = text.matches("stroke=\"#ffffff\"").count();
        assert!(pens >= 1 && text.contains("Sample &amp; Sons"), "{pens}");
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }
}
