//! A map of the walk, as SVG.

use crate::tour::Tour;
use bevy::math::DVec2;
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::StreetClass;
use bevy_sprawl::space::Bounds;
use bevy_sprawl::world::World;
use std::error::Error;
use std::fmt::Write;

/// Width of the land that the map shows around the way, in metres.
const MARGIN: f64 = 300.0;

/// Longest edge of the picture in pixels.
const PIXELS: f64 = 1600.0;

/// Draws the walk on the streets, buildings and ground around it.
pub fn draw(world: &World, tour: &Tour, seed: u64) -> Result<String, Box<dyn Error>> {
    let bounds = Bounds::of(tour.way.iter().copied()).grown(MARGIN);
    let area = world.area(bounds, &Cancel::new())?;
    let size = bounds.size();
    let scale = PIXELS / size.max_element();
    let (width, height) = (size.x * scale, size.y * scale);
    // North is up.
    let place = |p: DVec2| ((p.x - bounds.min.x) * scale, (bounds.max.y - p.y) * scale);
    let local = |p: &DVec2| place(area.origin.to_plan(*p));
    let path = |points: &mut dyn Iterator<Item = (f64, f64)>, close: bool| {
        let mut d = String::new();
        for (i, (x, y)) in points.enumerate() {
            let _ = write!(d, "{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" });
        }
        if close { d + "Z" } else { d }
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" viewBox=\"0 0 {width:.1} \
         {height:.1}\" font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"#dfe6d2\"/>\n"
    );
    ground(&mut svg, world, bounds, scale)?;
    let mut buildings = String::new();
    for building in &area.footprints {
        buildings += &path(&mut building.item.polygon.iter().map(local), true);
    }
    writeln!(svg, "<path d=\"{buildings}\" fill=\"#b9aa9c\" stroke=\"#9c8c7d\" stroke-width=\"0.4\"/>")?;
    // Casings first, then the carriageways, narrow streets below wide ones.
    for (casing, colour) in [(2.0, "#8d8d87"), (0.0, "")] {
        for class in StreetClass::ALL.into_iter().rev() {
            let mut d = String::new();
            for street in area.streets.iter().filter(|s| s.item.street.class == class && !s.item.street.tunnel) {
                d += &path(&mut street.item.street.line.iter().map(local), false);
            }
            let fill = if casing > 0.0 { colour } else { fill(class) };
            let stroke = class.carriageway() * scale + casing;
            writeln!(
                svg,
                "<path d=\"{d}\" fill=\"none\" stroke=\"{fill}\" stroke-width=\"{stroke:.2}\" stroke-linecap=\"round\" \
                 stroke-linejoin=\"round\"/>"
            )?;
        }
    }
    let way = path(&mut tour.way.iter().map(|p| place(*p)), false);
    writeln!(svg, "<path d=\"{way}\" fill=\"none\" stroke=\"#d12f2f\" stroke-width=\"3\" stroke-opacity=\"0.85\"/>")?;
    for (p, colour) in [(tour.way.first(), "#1c7c3c"), (tour.way.last(), "#d12f2f")] {
        let Some((x, y)) = p.map(|p| place(*p)) else { continue };
        writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"7\" fill=\"{colour}\" stroke=\"#fff\" stroke-width=\"2\"/>"
        )?;
    }
    for town in &area.settlements {
        let (x, y) = place(town.centre.plan());
        writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"26\" text-anchor=\"middle\" stroke=\"#fff\" stroke-width=\"5\" \
             paint-order=\"stroke\" fill=\"#333\">{}</text>",
            town.name
        )?;
    }
    let (bar, bottom) = (500.0 * scale, height - 18.0);
    writeln!(
        svg,
        "<path d=\"M18 {bottom:.1}h{bar:.1}\" stroke=\"#222\" stroke-width=\"4\"/><text x=\"18\" y=\"{:.1}\" \
         font-size=\"16\" fill=\"#222\">500 m, seed {seed}, walked {:.0} m</text>\n</svg>",
        bottom - 10.0,
        tour.walked
    )?;
    Ok(svg)
}

fn fill(class: StreetClass) -> &'static str {
    match class {
        StreetClass::Highway | StreetClass::Ramp => "#f2b552",
        StreetClass::Major | StreetClass::Arterial => "#f8d98c",
        StreetClass::Minor | StreetClass::Main => "#fdf3c4",
        StreetClass::Local => "#ffffff",
    }
}

/// Draws water and woods as squares of 8 m or more.
fn ground(svg: &mut String, world: &World, bounds: Bounds, scale: f64) -> std::fmt::Result {
    let step = (bounds.size().max_element() / 160.0).max(8.0);
    let (mut water, mut wood) = (String::new(), String::new());
    let (columns, rows) = ((bounds.size().x / step).ceil() as u32, (bounds.size().y / step).ceil() as u32);
    for (row, column) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
        let corner = bounds.min + DVec2::new(f64::from(column), f64::from(row)) * step;
        let sample = world.terrain().sample(corner + step / 2.0);
        let into = if sample.depth() > 0.0 {
            &mut water
        } else if sample.vegetation > 0.55 {
            &mut wood
        } else {
            continue;
        };
        let (x, y) = ((corner.x - bounds.min.x) * scale, (bounds.max.y - corner.y - step) * scale);
        write!(into, "M{x:.1} {y:.1}h{0:.1}v{0:.1}h-{0:.1}z", step * scale + 0.3)?;
    }
    writeln!(svg, "<path d=\"{wood}\" fill=\"#bfd3a6\"/>\n<path d=\"{water}\" fill=\"#9fc4e0\"/>")
}
