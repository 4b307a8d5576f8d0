//! Random patch sets, as the texts of their files.

use crate::patch::PatchSet;
use crate::space::Stream;
use glam::DVec2;
use std::collections::BTreeSet;

/// Tags that drawn patches may have.
pub const TAGS: [&str; 3] = ["drawn", "farm", "river-side"];

/// Patches that are tried for a set, at most.
const TRIES: usize = 60;

/// The text of a patch set of one patch or more, some of them repeated in patterns.
pub fn patch_set(stream: &mut Stream) -> String {
    let wanted = 1 + stream.index(6);
    let mut patches: Vec<String> = Vec::new();
    let mut patterns: Vec<String> = Vec::new();
    let file = |patches: &[String], patterns: &[String]| {
        format!("(patches: [{}], patterns: [{}])", patches.join(", "), patterns.join(", "))
    };
    let is_valid = |text: &str| PatchSet::from_ron("drawn.ron", text).is_ok();
    for _ in 0..TRIES {
        if patches.len() == wanted {
            break;
        }
        let name = format!("drawn {}", patches.len());
        let patch = patch(stream, &name);
        if is_valid(&file(std::slice::from_ref(&patch), &[])) {
            patches.push(patch);
            let pattern = pattern(stream, &name);
            if stream.chance(0.5) && is_valid(&file(&patches, std::slice::from_ref(&pattern))) {
                patterns.push(pattern);
            }
        }
    }
    if patches.is_empty() {
        patches.push("(name: \"drawn 0\", vertices: [(0, 0), (60, 0)], streets: [(0, 1)])".into());
    }
    file(&patches, &patterns)
}

/// A pattern of a patch.
fn pattern(stream: &mut Stream, element: &str) -> String {
    let scale = [0.25, 4.0, stream.range(0.5, 1.0), 1.0][stream.index(4)];
    let most = [scale, 4.0, (scale * 1.5).min(4.0)][stream.index(3)];
    let repeat = [1, 2, 100][stream.index(3)];
    let often = [repeat, 100, (repeat + 4).min(100)][stream.index(3)];
    format!(
        "(name: \"{element}, repeated\", element: \"{element}\", scale: ({scale:?}, {most:?}), repeat: ({repeat}, {often}))"
    )
}

/// A drawing of streets between points of a bent lattice, in some of them along a main street. Many a drawing breaks a rule of
/// patches.
fn patch(stream: &mut Stream, name: &str) -> String {
    let (columns, rows) = (1 + stream.index(4), 1 + stream.index(4));
    let pitch = if stream.chance(0.8) { stream.range(25.0, 90.0) } else { stream.range(2.0, 500.0) };
    let (bend, along_main) = (stream.range(0.0, 0.3), stream.chance(0.4));
    let cell = |k: usize| DVec2::new((k % columns) as f64, (k / columns) as f64);
    let mut at = Vec::new();
    for k in 0..columns * rows {
        let off = DVec2::new(stream.signed(), stream.signed()) * bend;
        at.push((cell(k) + if along_main && k < columns { DVec2::ZERO } else { off }) * pitch);
    }
    // A tree through points of the lattice, with some streets between its branches.
    let near = |a: usize, b: usize| cell(a).distance_squared(cell(b)) == 1.0;
    let (mut points, mut streets) = (vec![stream.index(columns)], BTreeSet::new());
    for _ in 0..3 * at.len() {
        let (from, to) = (points[stream.index(points.len())], stream.index(at.len()));
        let is_new = !points.contains(&to);
        if near(from, to) && (is_new || stream.chance(0.15)) {
            streets.insert((from.min(to), from.max(to)));
            points.extend(is_new.then_some(to));
        }
    }
    let index = |k: usize| points.iter().position(|p| *p == k).unwrap_or_default();
    let list = |main: bool| {
        let of = streets.iter().filter(|(_, b)| (along_main && *b < columns) == main);
        of.map(|(a, b)| format!("({}, {})", index(*a), index(*b))).collect::<Vec<_>>().join(", ")
    };
    let vertices: Vec<String> = points.iter().map(|k| format!("({:.3}, {:.3})", at[*k].x, at[*k].y)).collect();
    let ends = |k: usize| streets.iter().filter(|(a, b)| *a == k || *b == k).count() == 1;
    let mut dead_ends = Vec::new();
    let mut tags = Vec::new();
    for k in points.iter().filter(|k| ends(**k)) {
        if stream.chance(0.15) {
            dead_ends.push(index(*k).to_string());
        }
    }
    for tag in TAGS {
        if stream.chance(0.2) {
            tags.push(format!("\"{tag}\""));
        }
    }
    let weight = [0.0, 1.0, 1.0, 1e6, stream.range(0.1, 10.0)][stream.index(5)];
    let at_most = if stream.chance(0.3) { format!(", at_most: {}", stream.index(4)) } else { String::new() };
    format!(
        "(name: \"{name}\", vertices: [{}], streets: [{}], main: [{}], dead_ends: [{}], tags: [{}], weight: {weight:?}{at_most})",
        vertices.join(", "),
        list(false),
        list(true),
        dead_ends.join(", "),
        tags.join(", "),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;

    #[test]
    fn drawn_sets_are_valid_and_of_many_kinds() {
        let (mut patches, mut patterns, mut tags) = (0, 0, BTreeSet::new());
        for i in 0..150 {
            let text = patch_set(&mut Seed(i).stream("test", &[]));
            let set = PatchSet::from_ron("drawn.ron", &text).unwrap_or_else(|e| panic!("{e}: {text}"));
            patches += set.patches.len();
            patterns += set.patterns.len();
            tags.extend(set.patches.into_iter().flat_map(|p| p.tags));
        }
        assert!(patches > 300 && patterns > 40, "{patches} patches, {patterns} patterns");
        for tag in ["loop", "terminal", "initial", "cul-de-sac", "straight", "farm"] {
            assert!(tags.contains(tag), "{tag}: {tags:?}");
        }
    }
}
