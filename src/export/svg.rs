//! A map as SVG: shaded relief, water, blocks, lots, buildings, streets by class, names and a scale bar.

use crate::export::relief::Relief;
use crate::export::{ExportError, Plan, glyphs, narrowest_first};
use crate::network::{Street, StreetClass};
use crate::parcel::BlockUse;
use crate::region::{Settlement, SizeClass};
use crate::space::Bounds;
use crate::streets::MadeBy;
use glam::DVec2;
use std::fmt::Write;
use std::sync::Arc;
use svg::Document;
use svg::node::element::{Circle, Group, Image, Path, Rectangle, Title};

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
}

impl Default for MapStyle {
    fn default() -> Self {
        Self { pixels: 1600, colouring: Colouring::Class }
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
    Ok(document(plan, style, &relief, Some(picture)).to_string())
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
    };
    let mut groups = vec![sheet.ground(relief)];
    groups.extend(sheet.parcels(plan));
    groups.push(sheet.streets(plan));
    if plan.area.blocks.is_empty() {
        groups.push(sheet.symbols(plan));
    }
    groups.push(sheet.names(plan));
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
            groups.push(fill(rings, "towns", "#e3d5c3", Some("#c2a98c")).set("fill-opacity", 0.85));
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
            let tall = [(0, 3, "#d2bfa8"), (3, 6, "#c6ad93"), (6, u32::MAX, "#b59b82")];
            for (from, to, colour) in tall {
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
                        // A bridge's casing ends square, and is darker.
                        let bridge = Pen { width: pen.width + 1.6, colour: "#5f574c", cap: "butt", ..pen };
                        let (over, plain): (Vec<_>, Vec<_>) =
                            of.partition(|s| s.street.bridge && layer == Layer::Casing);
                        group = self.stroke(group, over.into_iter().map(|s| &s.street), bridge);
                        if layer == Layer::Carriageway && self.colouring == Colouring::Origin {
                            for (made_by, colour) in ORIGINS {
                                let of = plain.iter().filter(|s| origin_name(s.made_by) == made_by);
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

    fn pen(&self, class: StreetClass, layer: Layer, tunnel: bool) -> Option<Pen> {
        use StreetClass::{Arterial, Highway, Local, Main, Major, Minor};
        // Least width in pixels, colours of carriageway and casing.
        let (least, inner, casing) = match class {
            Highway => (2.4, "#f0a160", "#a4602b"),
            Major => (1.8, "#f7cf86", "#b3853b"),
            Minor => (1.2, "#fdf4cf", "#a99b74"),
            Arterial => (1.7, "#fbe29d", "#bd9648"),
            Main => (1.2, "#fff6d6", "#b9a678"),
            Local => (0.7, "#ffffff", "#b4aa9b"),
        };
        let width = (class.carriageway() * self.scale).max(least);
        let edge = (0.35 * self.scale).clamp(0.35, 1.2);
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

    /// A ring for each settlement that would be hardly seen at its size; villages first, so that cities lie on top.
    fn symbols(&self, plan: &Plan<'_>) -> Group {
        let mut group = Group::new().set("id", "symbols").set("fill", "#fffdf6").set("stroke", "#3c372f");
        for size in SizeClass::ALL.into_iter().rev() {
            let radius = symbol(size) * self.longer / 1600.0;
            let small = |s: &&Arc<Settlement>| s.size == size && s.radius * self.scale < 1.3 * radius;
            for settlement in plan.area.settlements.iter().filter(small) {
                let at = self.place(plan.area.origin.to_local(settlement.centre.plan()));
                let ring = Circle::new().set("cx", round(at.x)).set("cy", round(at.y)).set("r", round(radius));
                group = group.add(ring.set("stroke-width", round(0.32 * radius)));
            }
        }
        group
    }

    /// Names of settlements, the largest first; one that would lie on another is left out.
    fn names(&self, plan: &Plan<'_>) -> Group {
        let mut group = Group::new().set("id", "names");
        // The scale bar's corner.
        let mut taken = vec![Bounds::new(DVec2::new(0.0, 0.9), DVec2::new(0.25, 1.0))];
        taken.iter_mut().for_each(|b| *b = Bounds::new(b.min * self.size, b.max * self.size));
        let mut settlements: Vec<_> = plan.area.settlements.iter().collect();
        settlements.sort_by(|a, b| b.size.cmp(&a.size).then(b.radius.total_cmp(&a.radius)).then(a.id.cmp(&b.id)));
        for settlement in &settlements {
            let height = self.longer / 1600.0
                * match settlement.size {
                    SizeClass::City => 19.0,
                    SizeClass::Town => 14.0,
                    SizeClass::Village => 10.0,
                };
            let (lines, width) = glyphs::write(&settlement.name.to_uppercase(), height);
            let shown = settlement.radius * self.scale;
            let radius = shown.max(symbol(settlement.size) * self.longer / 1600.0);
            if settlement.size == SizeClass::Village && shown < 7.0 && settlements.len() > MANY {
                continue;
            }
            // In the middle of a town that holds it, above one that does not.
            let up = if width < radius { 0.0 } else { radius + height };
            let centre = self.place(plan.area.origin.to_local(settlement.centre.plan())) - DVec2::Y * up;
            let corner = centre + DVec2::new(-width, height) / 2.0;
            let half = DVec2::new(width, height) / 2.0;
            let around = Bounds::new(centre - half, centre + half);
            let sheet = Bounds::new(DVec2::ZERO, self.size);
            let around = around.grown(height / 2.0);
            if sheet.encloses(around) && !taken.iter().any(|t| t.overlaps(around)) {
                taken.push(around);
                group = group.add(lettering(&settlement.name, &lines, corner, height));
            }
        }
        group
    }

    /// A bar of a round length at the lower left, a legend of colours above it where they need one, and a frame.
    fn scale_bar(&self) -> Group {
        let unit = self.longer / 1600.0;
        let metres = nice((self.size.x / self.scale / 6.0).max(1.0));
        let (from, length) = (DVec2::new(40.0 * unit, self.size.y - 40.0 * unit), metres * self.scale);
        let mut group = Group::new().set("id", "scale");
        let box_of = |at: DVec2, size: DVec2| {
            Rectangle::new().set("x", at.x).set("y", at.y).set("width", size.x).set("height", size.y)
        };
        for part in 0..4 {
            let piece = box_of(
                from + DVec2::new(length / 4.0 * f64::from(part), -6.0 * unit),
                DVec2::new(length / 4.0, 6.0 * unit),
            );
            let fill = if part % 2 == 0 { "#3c372f" } else { "#ffffff" };
            group = group.add(piece.set("fill", fill).set("stroke", "#3c372f").set("stroke-width", unit));
        }
        let label = if metres >= 1000.0 { format!("{} km", metres / 1000.0) } else { format!("{metres} m") };
        let write = |text: &str, at: DVec2| {
            let (lines, _) = glyphs::write(text, 13.0 * unit);
            lettering(text, &lines, at, 13.0 * unit)
        };
        group = group.add(write(&label, from + DVec2::new(0.0, -16.0 * unit)));
        if self.colouring == Colouring::Origin {
            for (i, (name, colour)) in ORIGINS.iter().enumerate() {
                let at = from - DVec2::new(0.0, (60.0 + 26.0 * i as f64) * unit);
                group =
                    group.add(box_of(at - DVec2::Y * 11.0 * unit, DVec2::new(28.0, 9.0) * unit).set("fill", *colour));
                group = group.add(write(&name.to_uppercase(), at + DVec2::X * 40.0 * unit));
            }
        }
        let frame = box_of(DVec2::ZERO, self.size).set("fill", "none");
        group.add(frame.set("stroke", "#5f574c").set("stroke-width", 2.0 * unit))
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Layer {
    Pavement,
    Casing,
    Carriageway,
}

/// What makes streets, and the colour for it.
const ORIGINS: [(&str, &str); 4] =
    [("main", "#8d8779"), ("patch", "#3f7fbf"), ("growth", "#e8963a"), ("repair", "#d03a3a")];

fn origin_name(made_by: Option<MadeBy>) -> &'static str {
    match made_by {
        None => "main",
        Some(MadeBy::Patch(_)) => "patch",
        Some(MadeBy::Growth) => "growth",
        Some(MadeBy::Repair) => "repair",
    }
}

/// Maps with more settlements than this leave out the names of small villages.
const MANY: usize = 120;

/// Radius of the ring that stands for a settlement, on a map of 1600 pixels.
fn symbol(size: SizeClass) -> f64 {
    match size {
        SizeClass::City => 6.5,
        SizeClass::Town => 4.6,
        SizeClass::Village => 2.9,
    }
}

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

/// Strokes of a text with a pale halo; `corner` is the left end of its base line.
fn lettering(text: &str, lines: &[Vec<DVec2>], corner: DVec2, height: f64) -> Group {
    let mut data = String::new();
    for line in lines {
        let line: Vec<DVec2> = line.iter().map(|p| corner + DVec2::new(p.x, -p.y)).collect();
        trace(&mut data, &line, false);
    }
    let group = Group::new().set("fill", "none").set("stroke-linecap", "round").set("stroke-linejoin", "round");
    [("#fffdf6", 0.5, 0.8), ("#2f2b26", 0.14, 1.0)].into_iter().fold(
        group.add(Title::new(text)),
        |group, (colour, width, opacity)| {
            let path = Path::new().set("d", data.as_str()).set("stroke", colour).set("stroke-opacity", opacity);
            group.add(path.set("stroke-width", height * width))
        },
    )
}

/// The largest of 1, 2, 5, 10, 20, ... that is at most `x` (`x` at least 1).
fn nice(x: f64) -> f64 {
    let mut unit = 1.0;
    while unit * 10.0 <= x {
        unit *= 10.0;
    }
    [5.0, 2.0].into_iter().find(|m| unit * m <= x).map_or(unit, |m| unit * m)
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
        let text = write(&town.plan(), &MapStyle { pixels: 400, colouring: Colouring::Class }).unwrap();
        let pens = text.matches("stroke=\"#ffffff\"").count();
        assert!(pens >= 1 && text.contains("Sample &amp; Sons"), "{pens}");
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }
}
