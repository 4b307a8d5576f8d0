//! The contact sheet: patch sets drawn for people to look at.

use crate::network::StreetClass;
use crate::patch::{Patch, PatchSet, PatchWindow, Pattern};
use crate::space::math::{angle_of, mix};
use glam::DVec2;
use svg::node::element::{Circle, Group, Line, Polyline, Rectangle, Text};

/// Size of a patch's box and of its picture's part, in pixels.
const BOX: DVec2 = DVec2::new(240.0, 286.0);
const PICTURE: f64 = 224.0;
/// Boxes in a row.
const COLUMNS: usize = 6;
const MARGIN: f64 = 16.0;
/// Height of a set's heading, and of a pattern's strip.
const HEADING: f64 = 44.0;
const STRIP: f64 = 190.0;
/// Most pixels per metre, and metres of the scale bar.
const SCALE: f64 = 1.1;
const BAR: f64 = 50.0;

const LOCAL: &str = "#2f6db5";
const MAIN: &str = "#c8372d";
const DEAD: &str = "#7a4a1e";
const INK: &str = "#22262b";
const FAINT: &str = "#6b727b";

/// Draws all patches of `sets` with names and tags, then their patterns, as one SVG image.
///
/// Main streets are red, local ones blue, windows of maps grey squares; a dot with a tick is a connectable vertex and the way it goes on, a brown bar a
/// dead end. Large patches are drawn smaller: the grey bar is 50 m. A pattern is drawn with a middling scale and number.
pub fn draw_sheet(sets: &[&PatchSet]) -> String {
    let width = BOX.x * COLUMNS as f64 + 2.0 * MARGIN;
    let mut body = Group::new();
    let mut top = MARGIN;
    for set in sets {
        let about = format!("{} patches, {} patterns", set.patches.len(), set.patterns.len());
        body = body.add(text(&set.name, DVec2::new(MARGIN, top + 26.0), 22.0, INK).set("font-weight", "bold"));
        body = body.add(text(&about, DVec2::new(width - MARGIN, top + 26.0), 12.0, FAINT).set("text-anchor", "end"));
        top += HEADING;
        for (i, patch) in set.patches.iter().enumerate() {
            let at = DVec2::new((i % COLUMNS) as f64, (i / COLUMNS) as f64) * BOX + DVec2::new(MARGIN, top);
            body = body.add(patch_box(patch, at));
        }
        top += set.patches.len().div_ceil(COLUMNS) as f64 * BOX.y;
        for pattern in &set.patterns {
            if let Some(element) = set.patches.iter().find(|p| p.name == pattern.element) {
                body = body.add(pattern_strip(pattern, element, DVec2::new(MARGIN, top), width - 2.0 * MARGIN));
                top += STRIP;
            }
        }
        top += MARGIN;
    }
    let paper = Rectangle::new().set("width", width).set("height", top).set("fill", "#ffffff");
    svg::Document::new()
        .set("viewBox", (0, 0, width, top))
        .set("width", width)
        .set("height", top)
        .set("font-family", "sans-serif")
        .add(paper)
        .add(body)
        .to_string()
}

fn patch_box(patch: &Patch, at: DVec2) -> Group {
    let frame = Rectangle::new().set("width", BOX.x - 8.0).set("height", BOX.y - 8.0).set("rx", 6);
    let around = |w: &PatchWindow| w.middle.abs().max_element() + w.size / 2.0;
    let radius = patch.window.as_ref().map_or(0.0, around).max(patch.radius);
    let scale = (PICTURE / (2.0 * radius + 40.0)).min(SCALE);
    let middle = DVec2::new((BOX.x - 8.0) / 2.0, PICTURE / 2.0 + 2.0);
    let bar = DVec2::new(BOX.x - 18.0, PICTURE + 48.0);
    let tags: Vec<&str> = patch.tags.iter().map(String::as_str).collect();
    let mut about = format!("{:.0} m", 2.0 * patch.radius);
    if patch.weight != 1.0 {
        about += &format!(", weight {}", patch.weight);
    }
    if let Some(most) = patch.at_most {
        about += &format!(", at most {most}");
    }
    Group::new()
        .set("transform", format!("translate({:.1} {:.1})", at.x, at.y))
        .add(frame.set("fill", "#f7f8fa").set("stroke", "#d6dae0"))
        .add(picture(patch, middle, scale, 0.0))
        .add(line(bar - DVec2::X * BAR * scale, bar, "#9aa1ab", 2.0))
        .add(text(&patch.name, DVec2::new(10.0, PICTURE + 14.0), 13.0, INK).set("font-weight", "bold"))
        .add(text(&tags.join("  "), DVec2::new(10.0, PICTURE + 30.0), 10.5, FAINT))
        .add(text(&about, DVec2::new(10.0, PICTURE + 45.0), 10.5, FAINT))
}

fn pattern_strip(pattern: &Pattern, element: &Patch, at: DVec2, width: f64) -> Group {
    let (size, times) = (mix(pattern.scale.0, pattern.scale.1, 0.5), pattern.repeat.0.midpoint(pattern.repeat.1));
    let about = format!(
        "{} {} to {} times, scale {} to {}",
        pattern.element, pattern.repeat.0, pattern.repeat.1, pattern.scale.0, pattern.scale.1
    );
    let mut strip = Group::new()
        .set("transform", format!("translate({:.1} {:.1})", at.x, at.y))
        .add(text(&pattern.name, DVec2::new(10.0, 20.0), 13.0, INK).set("font-weight", "bold"))
        .add(text(&about, DVec2::new(10.0, 36.0), 10.5, FAINT));
    let Some((from, to)) = element.repeat_line() else { return strip };
    let (step, turned) = (from.distance(to) * size, -angle_of(to - from));
    let length = step * f64::from(times);
    let scale = ((width - 240.0) / length).min((STRIP - 30.0) / (2.0 * element.radius * size)).min(SCALE);
    for k in 0..times {
        let along = (f64::from(k) - f64::from(times - 1) / 2.0) * step;
        // The middle of the line that it is repeated on, not of the patch, goes on the strip's axis.
        let offset = crate::space::math::rotate((from + to) / 2.0, turned) * size;
        let middle = DVec2::new(width / 2.0 + (along - offset.x) * scale, STRIP - 24.0 + offset.y * scale);
        strip = strip.add(picture(element, middle, scale * size, turned));
    }
    strip
}

/// The patch around `middle`, turned, y up.
fn picture(patch: &Patch, middle: DVec2, scale: f64, turned: f64) -> Group {
    let at = |v: usize| {
        let p = crate::space::math::rotate(patch.vertices[v], turned) * scale;
        middle + DVec2::new(p.x, -p.y)
    };
    let mut group = Group::new().set("fill", "none").set("stroke-linecap", "round").set("stroke-linejoin", "round");
    if let Some(window) = &patch.window {
        let half = window.size / 2.0 * scale;
        let middle = middle + DVec2::new(window.middle.x, -window.middle.y) * scale;
        let frame = Rectangle::new().set("x", px(middle.x - half)).set("y", px(middle.y - half));
        group = group.add(frame.set("width", px(2.0 * half)).set("height", px(2.0 * half)).set("stroke", "#c4cad2"));
    }
    for street in patch.streets() {
        let is_main = |e: usize| patch.edges[e].class != StreetClass::Local;
        let main = patch.edges_at(street[0]).any(|e| is_main(e) && patch.edges[e].other(street[0]) == street[1]);
        let points: Vec<String> = street.iter().map(|v| format!("{:.1},{:.1}", at(*v).x, at(*v).y)).collect();
        let street = Polyline::new().set("points", points.join(" "));
        group = group.add(
            street.set("stroke", if main { MAIN } else { LOCAL }).set("stroke-width", if main { 6.0 } else { 3.5 }),
        );
    }
    for (e, edge) in patch.edges.iter().enumerate().filter(|(e, _)| patch.is_dead_end(*e)) {
        let ends = [edge.a, edge.b].into_iter().filter(|v| patch.degree(*v) == 1 && !patch.is_connectable(*v));
        for v in ends {
            let across = (at(v) - at(patch.edges[e].other(v))).normalize_or_zero().perp() * 5.0;
            group = group.add(line(at(v) - across, at(v) + across, DEAD, 3.0));
        }
    }
    for c in &patch.connectables {
        let inward = crate::space::math::rotate(c.inward, turned);
        let tip = at(c.vertex) - DVec2::new(inward.x, -inward.y) * 12.0;
        group = group.add(line(at(c.vertex), tip, INK, 1.5));
        let dot = Circle::new().set("cx", px(at(c.vertex).x)).set("cy", px(at(c.vertex).y)).set("r", 4);
        group = group.add(dot.set("fill", INK));
    }
    group
}

fn px(value: f64) -> String {
    format!("{value:.1}")
}

fn line(a: DVec2, b: DVec2, colour: &str, width: f64) -> Line {
    let line = Line::new().set("x1", px(a.x)).set("y1", px(a.y)).set("x2", px(b.x)).set("y2", px(b.y));
    line.set("stroke", colour).set("stroke-width", width)
}

fn text(words: &str, at: DVec2, size: f64, colour: &str) -> Text {
    Text::new(words).set("x", px(at.x)).set("y", px(at.y)).set("font-size", size).set("fill", colour)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_shows_every_patch_and_pattern() {
        let set = r#"(
            patches: [
                (name: "a & b", vertices: [(0, 0), (90, 0), (90, 60)], streets: [[0, 1, 2]], dead_ends: [2]),
                (name: "tee", vertices: [(0, 0), (50, 0), (90, 0), (50, 60)], main: [[0, 1, 2]], streets: [(1, 3)]),
            ],
            patterns: [(name: "row", element: "tee", scale: (0.8, 1.2), repeat: (2, 4))],
        )"#;
        let set = PatchSet::from_ron("s.ron", set).unwrap();
        let sheet = draw_sheet(&[&set, &set]);
        assert!(sheet.contains("a &amp; b") && sheet.contains("cul-de-sac"), "{sheet}");
        assert_eq!(sheet.matches("row").count(), 2);
        // Per set: two streets of main and four local ones, of which the pattern draws those of the tee three times more.
        assert_eq!(sheet.matches("<polyline").count(), 2 * (1 + 3 + 3 * 3));
        assert_eq!(sheet.matches(DEAD).count(), 2);
        assert_eq!(sheet, draw_sheet(&[&set, &set]));
    }
}
