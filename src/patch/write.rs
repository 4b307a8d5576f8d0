//! Writing patch sets.

use crate::network::StreetClass;
use crate::patch::file::{BuildingDrawing, Line, PatchDrawing, WindowDrawing};
use std::fmt::Write;

/// The text of a patch set with these patches, each on lines of its own; [`PatchSet::from_ron`](crate::patch::PatchSet::from_ron)
/// reads it. Lengths are rounded to centimetres.
pub fn to_ron(patches: &[PatchDrawing]) -> String {
    let mut out = String::from("(\n    patches: [\n");
    for patch in patches {
        // Writing to a string cannot fail.
        let _ = write_patch(&mut out, patch);
    }
    out.push_str("    ],\n)\n");
    out
}

fn write_patch(out: &mut String, patch: &PatchDrawing) -> std::fmt::Result {
    let PatchDrawing { name, vertices, streets, main, classes, dead_ends, tags, weight, at_most, window } = patch;
    writeln!(out, "        (\n            name: {},", quoted(name))?;
    writeln!(out, "            vertices: {},", points(vertices))?;
    for (field, lines) in [("streets", streets), ("main", main)] {
        if !lines.is_empty() {
            let lines: Vec<String> = lines.iter().map(|Line(line)| format!("{line:?}")).collect();
            writeln!(out, "            {field}: [{}],", lines.join(", "))?;
        }
    }
    if classes.iter().any(|class| *class != StreetClass::Local) {
        writeln!(out, "            classes: {classes:?},")?;
    }
    if !dead_ends.is_empty() {
        writeln!(out, "            dead_ends: {dead_ends:?},")?;
    }
    if !tags.is_empty() {
        let tags: Vec<String> = tags.iter().map(|tag| quoted(tag)).collect();
        writeln!(out, "            tags: [{}],", tags.join(", "))?;
    }
    if *weight != 1.0 {
        writeln!(out, "            weight: {weight},")?;
    }
    if let Some(most) = at_most {
        writeln!(out, "            at_most: {most},")?;
    }
    if let Some(WindowDrawing { size, margin, map, at, turned_deg, buildings }) = window {
        let at = format!("({}, {})", metres(at.0), metres(at.1));
        let (size, margin, map) = (metres(*size), metres(*margin), quoted(map));
        write!(
            out,
            "            window: (size: {size}, margin: {margin}, map: {map}, at: {at}, turned_deg: {turned_deg}"
        )?;
        if !buildings.is_empty() {
            writeln!(out, ", buildings: [")?;
            for building in buildings {
                write_building(out, building)?;
            }
            write!(out, "            ]")?;
        }
        writeln!(out, "),")?;
    }
    writeln!(out, "        ),")
}

fn write_building(out: &mut String, building: &BuildingDrawing) -> std::fmt::Result {
    let BuildingDrawing { outline, height, storeys } = building;
    write!(out, "                (outline: {}", points(outline))?;
    if let Some(height) = height {
        write!(out, ", height: {}", metres(*height))?;
    }
    if let Some(storeys) = storeys {
        write!(out, ", storeys: {storeys}")?;
    }
    writeln!(out, "),")
}

/// A list of points.
fn points(points: &[(f64, f64)]) -> String {
    let points: Vec<String> = points.iter().map(|(x, y)| format!("({}, {})", metres(*x), metres(*y))).collect();
    format!("[{}]", points.join(", "))
}

/// A number with as many places as it needs, at most two.
fn metres(x: f64) -> f64 {
    // Not a negative zero.
    (x * 100.0).round() / 100.0 + 0.0
}

/// Text as RON has it.
fn quoted(text: &str) -> String {
    let escaped = |c: char| match c {
        '"' => "\\\"".into(),
        '\\' => "\\\\".into(),
        c if c.is_control() => format!("\\u{{{:x}}}", c as u32),
        c => c.to_string(),
    };
    format!("\"{}\"", text.chars().map(escaped).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::{Patch, PatchSet};

    #[test]
    fn what_is_written_is_read_again() {
        let drawing = PatchDrawing {
            name: "a \"b\" \\ c\u{7}".into(),
            vertices: vec![(-60.0, -0.0), (0.25, 3.33), (60.0, 1.0), (0.0, -60.0), (30.0, -60.0), (30.0, -20.0)],
            streets: vec![Line(vec![0, 1, 2]), Line(vec![1, 3]), Line(vec![4, 5])],
            main: Vec::new(),
            classes: vec![StreetClass::Main, StreetClass::Local, StreetClass::Arterial],
            dead_ends: vec![5],
            tags: vec!["old-town".into()],
            weight: 0.5,
            at_most: Some(3),
            window: Some(WindowDrawing {
                size: 100.0,
                margin: 10.0,
                map: "m".into(),
                at: (5.0, -7.5),
                turned_deg: 12.5,
                buildings: vec![
                    BuildingDrawing {
                        outline: vec![(5.0, 8.0), (15.0, 8.0), (15.0, 14.5)],
                        height: Some(7.25),
                        storeys: None,
                    },
                    BuildingDrawing {
                        outline: vec![(-5.0, 8.0), (-5.0, 18.0), (-15.0, 14.5)],
                        height: None,
                        storeys: Some(2),
                    },
                ],
            }),
        };
        let text = to_ron(std::slice::from_ref(&drawing));
        let set = PatchSet::from_ron("s.ron", &text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(set.patches, [Patch::of(drawing).expect("it is sound")]);
        assert!(set.patches[0].is_in_pieces() && set.patches[0].edges[3].class == StreetClass::Arterial);
        let window = set.patches[0].window.as_ref().expect("one");
        assert!((set.patches[0].vertices[0] - window.middle).distance(glam::DVec2::new(-60.0, 0.0)) < 1e-3);
    }
}
