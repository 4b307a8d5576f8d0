//! The picture of the layers in `docs/layers.svg`: what each makes, in the words of its own documentation, and which it reads.

use crate::{LAYERS, arrows, layer, source};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;

const WIDTH: usize = 980;
const ROW: usize = 44;

/// What a sentence may be long, in characters; a longer one is cut at its colon.
const LONGEST: usize = 110;

/// The first sentence of a layer's documentation, without its number and what stands in brackets.
fn makes(name: &str) -> String {
    let files = [source().join(name).join("mod.rs"), source().join(format!("{name}.rs"))];
    let text = files.iter().find_map(|f| std::fs::read_to_string(f).ok()).unwrap_or_default();
    let lines = text.lines().map_while(|l| l.strip_prefix("//!")).map(str::trim).take_while(|l| !l.is_empty());
    let all = lines.collect::<Vec<_>>().join(" ");
    let sentence = all.split(". ").next().unwrap_or_default().trim_end_matches('.');
    let sentence = match sentence.split_once(": ") {
        Some((number, rest)) if number.starts_with("Layer") => rest,
        _ => sentence,
    };
    let mut plain = String::new();
    let mut depth = 0usize;
    for c in sentence.chars() {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            '`' | '[' | ']' => {}
            c if depth == 0 => plain.push(c),
            _ => {}
        }
    }
    let plain = plain.replace(" ,", ",").replace("  ", " ");
    let short = match plain.split_once(": ") {
        Some((start, _)) if plain.len() > LONGEST => start,
        _ => plain.trim(),
    };
    let mut letters = short.chars();
    let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
    (first + letters.as_str()).replace('&', "&amp;").replace('<', "&lt;")
}

/// Draws the layers, the highest at the top.
fn draw() -> String {
    let mut reads: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (from, to) in arrows().keys().filter(|(a, b)| layer(a) != layer(b)) {
        reads.entry(layer(from)).or_default().insert(layer(to));
    }
    let order: Vec<&str> = LAYERS.iter().flat_map(|row| row.iter().copied()).collect();
    let exists = |name: &str| source().join(name).exists() || source().join(format!("{name}.rs")).exists();
    let shown: Vec<&str> = order.iter().rev().copied().filter(|name| *name != "lib" && exists(name)).collect();
    let mut out = String::new();
    let height = shown.len() * ROW + 8;
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#ffffff\"/>"
    );
    for (i, name) in shown.iter().enumerate() {
        let y = i * ROW + 4;
        let fill = match *name {
            "space" | "layer" | "network" | "style" | "patch" | "edits" | "map" => "#e9e4d8",
            "analysis" | "export" | "plugin" | "editor" | "bin" => "#dfe8f2",
            _ => "#e4efdc",
        };
        let of = reads.get(*name).cloned().unwrap_or_default();
        let below: Vec<&str> = order.iter().copied().filter(|l| of.contains(*l)).collect();
        let title = if *name == "bin" { "bin/sprawl" } else { name };
        let makes = if *name == "bin" { "The command line".to_owned() } else { makes(name) };
        let _ = writeln!(
            out,
            "<rect x=\"4\" y=\"{y}\" width=\"{}\" height=\"{}\" rx=\"5\" fill=\"{fill}\"/>\n\
             <text x=\"16\" y=\"{}\" font-weight=\"bold\">{title}</text>\n\
             <text x=\"120\" y=\"{}\">{makes}</text>\n\
             <text x=\"120\" y=\"{}\" font-size=\"11\" fill=\"#666666\">{}</text>",
            WIDTH - 8,
            ROW - 5,
            y + 24,
            y + 17,
            y + 32,
            if below.is_empty() { "reads none".to_owned() } else { format!("reads {}", below.join(", ")) }
        );
    }
    out + "</svg>\n"
}

#[test]
#[ignore = "writes docs/layers.svg"]
fn draw_the_layers() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/layers.svg");
    std::fs::write(file, draw()).expect("the folder docs can be written");
}
