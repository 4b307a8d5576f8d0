//! A map as PNG: the drawing of [`svg`](crate::export::svg) in pixels.

use crate::export::svg::{MapStyle, document, relief, trace};
use crate::export::{ExportError, Plan, glyphs};
use glam::DVec2;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, Writer, XmlVersion};
use resvg::tiny_skia::{Color, Pixmap, PixmapPaint, Transform};
use resvg::usvg;
use std::collections::BTreeMap;

/// Draws a plan as a PNG file.
pub fn write(plan: &Plan<'_>, style: &MapStyle) -> Result<Vec<u8>, ExportError> {
    encode(&drawn(plan, style)?)
}

/// The names of settlements that a PNG spells in Latin letters because they are in another script, and their spellings. An SVG
/// has them as they are, as text.
pub fn spelled_in_latin(plan: &Plan<'_>) -> Vec<(String, String)> {
    let names = plan.area.settlements.iter().map(|s| &s.name).filter(|name| !glyphs::is_latin(name));
    names.map(|name| (name.clone(), glyphs::spelled(name))).collect()
}

/// Draws two plans beside each other as one PNG file.
pub fn write_pair(plans: [(&Plan<'_>, &MapStyle); 2]) -> Result<Vec<u8>, ExportError> {
    let [left, right] = plans.map(|(plan, style)| drawn(plan, style));
    let (left, right) = (left?, right?);
    let (width, height) = (left.width() + right.width(), left.height().max(right.height()));
    let mut both = Pixmap::new(width, height)
        .ok_or_else(|| ExportError::Format(format!("a picture of {width} by {height} pixels is not possible")))?;
    both.fill(Color::WHITE);
    for (x, part) in [(0, &left), (left.width() as i32, &right)] {
        both.draw_pixmap(x, 0, part.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
    }
    encode(&both)
}

fn drawn(plan: &Plan<'_>, style: &MapStyle) -> Result<Pixmap, ExportError> {
    let relief = relief(plan, style);
    let mut pixels = relief.raster(style.size(plan.area.bounds))?;
    draw(&document(plan, style, &relief, None).to_string(), &mut pixels)?;
    Ok(pixels)
}

/// Draws any SVG without embedded pictures as a PNG file, on white. Words are drawn as capitals of plain strokes, so that the
/// result does not depend on the fonts of the machine.
pub fn from_svg(text: &str) -> Result<Vec<u8>, ExportError> {
    let text = &words_as_strokes(text)?;
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

/// The same drawing with a path in place of every `text` element.
fn words_as_strokes(text: &str) -> Result<String, ExportError> {
    let unreadable = |e: &dyn std::fmt::Display| ExportError::Format(format!("the drawing is not SVG: {e}"));
    let mut reader = Reader::from_str(text);
    let mut writer = Writer::new(Vec::new());
    let mut open: Option<(BTreeMap<String, String>, String)> = None;
    loop {
        let event = reader.read_event().map_err(|e| unreadable(&e))?;
        match (&event, &mut open) {
            (Event::Eof, _) => break,
            (Event::Start(start), None) if start.name().as_ref() == "text" => {
                let mut attributes = BTreeMap::new();
                for attribute in start.attributes() {
                    let attribute = attribute.map_err(|e| unreadable(&e))?;
                    let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|e| unreadable(&e))?;
                    attributes.insert(attribute.key.as_ref().to_owned(), value.into_owned());
                }
                open = Some((attributes, String::new()));
            }
            (Event::Text(words), Some((_, all))) => *all += &words.xml_content(XmlVersion::Implicit1_0),
            (Event::GeneralRef(name), Some((_, all))) => all.push(match name.as_ref() {
                "amp" => '&',
                "quot" => '"',
                "apos" => '\'',
                // The others have no strokes.
                _ => ' ',
            }),
            (Event::End(end), Some((attributes, words))) if end.name().as_ref() == "text" => {
                writer.write_event(Event::Empty(strokes(attributes, words)))?;
                open = None;
            }
            (_, Some(_)) => {}
            (_, None) => writer.write_event(event)?,
        }
    }
    String::from_utf8(writer.into_inner()).map_err(|e| unreadable(&e))
}

/// The path for a `text` element.
fn strokes(attributes: &BTreeMap<String, String>, words: &str) -> BytesStart<'static> {
    let number = |name: &str, default: f64| attributes.get(name).and_then(|v| v.parse().ok()).unwrap_or(default);
    let height = 0.5 * number("font-size", 16.0);
    let (lines, width) = glyphs::write(words.trim(), height);
    let before = match attributes.get("text-anchor").map(String::as_str) {
        Some("middle") => width / 2.0,
        Some("end") => width,
        _ => 0.0,
    };
    let from = DVec2::new(number("x", 0.0) - before, number("y", 0.0));
    let mut data = String::new();
    for line in &lines {
        let line: Vec<DVec2> = line.iter().map(|p| from + DVec2::new(p.x, -p.y)).collect();
        trace(&mut data, &line, false);
    }
    let mut path = BytesStart::new("path");
    path.push_attribute(("d", data.as_str()));
    path.push_attribute(("fill", "none"));
    path.push_attribute(("stroke", attributes.get("fill").map_or("#000000", String::as_str)));
    path.push_attribute(("stroke-width", format!("{:.2}", height * 0.15).as_str()));
    path.push_attribute(("stroke-linecap", "round"));
    path
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn a_picture_has_its_size_and_its_colours() {
        let town = testing::area(DVec2::new(900.0, 900.0));
        let file = write(&town.plan(), &MapStyle { pixels: 300, ..Default::default() }).unwrap();
        let back = Pixmap::decode_png(&file).unwrap();
        assert_eq!((back.width(), back.height()), (300, 300));
        let colours: std::collections::BTreeSet<_> =
            back.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect();
        assert!(colours.len() > 200, "{}", colours.len());
        assert!(back.pixels().iter().all(|p| p.alpha() == 255));
    }

    #[test]
    fn words_become_ink() {
        let sheet = |words: &str| {
            let text = format!("<text x=\"5\" y=\"30\" font-size=\"20\" fill=\"#ff0000\">{words}</text>");
            format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"90\" height=\"40\">{text}</svg>")
        };
        let red = |words: &str| {
            let file = from_svg(&sheet(words)).unwrap();
            let back = Pixmap::decode_png(&file).unwrap();
            back.pixels().iter().filter(|p| p.red() > 200 && p.green() < 60).count()
        };
        assert_eq!(red(" "), 0);
        assert!(red("a &amp; b") > 10 && red("a &amp; b") > red("a"));
        assert!(from_svg("<svg><text></svg>").is_err());
    }
}
