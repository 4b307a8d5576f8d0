//! The sheet that maps are drawn on: where plan points lie on it, pens, and path data.

use crate::network::{Street, StreetClass};
use glam::DVec2;
use std::fmt::Write;
use svg::node::element::{Group, Path};

/// What the colour of a street shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colouring {
    /// The class of the street.
    #[default]
    Class,
    /// What made the street: main street, patch, growth or repair.
    Origin,
}

/// Where plan points lie on the drawing.
pub(super) struct Sheet {
    /// Width and height in pixels.
    pub size: DVec2,
    /// The longer of width and height, in pixels.
    pub longer: f64,
    /// Pixels per metre.
    pub scale: f64,
    /// North-west corner, local to the area.
    pub corner: DVec2,
    pub colouring: Colouring,
    /// Whether the map shows only settlements and roads.
    pub region: bool,
    /// Whether words may be text, drawn in a font of the viewer.
    pub has_text: bool,
}

/// How a stroke is drawn.
#[derive(Clone, Copy)]
pub(super) struct Pen {
    pub width: f64,
    pub colour: &'static str,
    pub cap: &'static str,
    pub dashed: bool,
}

impl Sheet {
    pub fn place(&self, local: DVec2) -> DVec2 {
        let d = (local - self.corner) * self.scale;
        DVec2::new(d.x, -d.y)
    }

    /// The local point that lies at a pixel.
    pub fn unplaced(&self, at: DVec2) -> DVec2 {
        self.corner + DVec2::new(at.x, -at.y) / self.scale
    }

    pub fn placed(&self, line: &[DVec2]) -> Vec<DVec2> {
        line.iter().map(|p| self.place(*p)).collect()
    }

    /// A bridge's casing ends square, and is darker.
    pub fn bridge_pen(&self, casing: Pen) -> Pen {
        let wider = if self.region { 3.6 * self.longer / 1600.0 } else { 1.6 };
        let colour = if self.region { "#221d18" } else { "#5f574c" };
        Pen { width: casing.width + wider, colour, cap: "butt", ..casing }
    }

    pub fn pen(&self, class: StreetClass, layer: Layer, tunnel: bool) -> Option<Pen> {
        use StreetClass::{Arterial, Highway, Local, Main, Major, Minor, Ramp};
        // Least width in pixels, colours of carriageway and casing. From far off roads are drawn far wider than they are.
        let (least, inner, casing) = match class {
            Highway if self.region => (4.6, "#e2683f", "#7d2a12"),
            Major if self.region => (3.5, "#f6b545", "#86571a"),
            Minor if self.region => (2.3, "#fff2a6", "#6f6338"),
            Ramp if self.region => (1.2, "#e2683f", "#7d2a12"),
            Highway => (2.4, "#f0a160", "#a4602b"),
            Major => (1.8, "#f7cf86", "#b3853b"),
            Minor => (1.2, "#fdf4cf", "#a99b74"),
            Ramp => (1.0, "#f0a160", "#a4602b"),
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

    pub fn stroke<'a>(&self, group: Group, streets: impl Iterator<Item = &'a Street>, pen: Pen) -> Group {
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
pub(super) enum Layer {
    Pavement,
    Casing,
    Carriageway,
}

/// The origins of streets with their colours. Local streets without an origin come from a real map.
pub(super) const ORIGINS: [(&str, &str); 5] = [
    ("main", "#8d8779"),
    ("patch", "#3f7fbf"),
    ("growth", "#e8963a"),
    ("repair", "#d03a3a"),
    ("real local", "#ffffff"),
];

/// Fill of buildings from the first number of storeys to below the second.
pub(super) const BUILDINGS: [(u32, u32, &str); 3] = [(0, 3, "#d2bfa8"), (3, 6, "#c6ad93"), (6, u32::MAX, "#b59b82")];

/// A number rounded to hundredths.
pub(super) fn round(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}

/// Adds a polyline or ring to path data, in hundredths of a pixel.
pub(in crate::export) fn trace(data: &mut String, points: &[DVec2], close: bool) {
    for (i, p) in points.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(data, "{}{:.2} {:.2}", if i == 0 { "M" } else { "L" }, p.x, p.y);
    }
    if close {
        data.push('Z');
    }
}

/// Path data of many lines, a few hundred in each path, since rasterizers are slow with very large paths.
pub(super) fn paths(lines: impl Iterator<Item = Vec<DVec2>>, close: bool) -> Vec<String> {
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

/// The largest of 1, 2, 5, 10, 20, ... that is at most `x` (`x` at least 1).
pub(super) fn nice(x: f64) -> f64 {
    let mut unit = 1.0;
    while unit * 10.0 <= x {
        unit *= 10.0;
    }
    [5.0, 2.0].into_iter().find(|m| unit * m <= x).map_or(unit, |m| unit * m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_lengths() {
        assert_eq!([1.0, 1.9, 2.0, 49.0, 333.0, 6000.0].map(nice), [1.0, 1.0, 2.0, 20.0, 200.0, 5000.0]);
    }
}
