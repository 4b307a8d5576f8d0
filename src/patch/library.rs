//! What is asked of the patches and styles that come with the crate.

use crate::patch::{Patch, PatchDatabase, PatchSet, tag};
use crate::space::math::angle_between;
use crate::space::{distance_to_line, resample, segment_distance, segments};
use crate::style::{Filler, Style};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

fn files(folder: &str) -> Vec<(String, String)> {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(folder);
    let mut paths: Vec<_> = std::fs::read_dir(dir).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    let read = |p: &std::path::PathBuf| (p.to_string_lossy().into_owned(), std::fs::read_to_string(p).unwrap());
    paths.iter().map(read).collect()
}

fn sets() -> BTreeMap<String, PatchSet> {
    let read = |(file, text): &(String, String)| PatchSet::from_ron(file, text).unwrap_or_else(|e| panic!("{e}"));
    files("patches").iter().map(read).map(|set| (set.name.clone(), set)).collect()
}

/// Whether a set is for works, whose blocks and main cells are larger than those that people live in.
fn is_for_works(set: &PatchSet) -> bool {
    set.name == "industrial"
}

/// Whether streets may come as near as 16 m: roundabouts and small squares.
fn is_place(patch: &Patch) -> bool {
    [tag::ROUNDABOUT, "square"].iter().any(|t| patch.tags.contains(*t))
}

fn line(patch: &Patch, street: &[usize]) -> Vec<DVec2> {
    street.iter().map(|v| patch.vertices[*v]).collect()
}

#[test]
fn patches_have_room_between_and_around_their_streets() {
    let drawn = |p: &&Patch| p.window.is_none();
    for (set, patch) in sets().values().flat_map(|s| s.patches.iter().filter(drawn).map(move |p| (s, p))) {
        let name = format!("{}/{}", set.name, patch.name);
        let widest = if is_for_works(set) { 340.0 } else { 220.0 };
        assert!(2.0 * patch.radius <= widest, "{name} is {:.0} m wide", 2.0 * patch.radius);
        assert!(!patch.connectables.is_empty(), "{name} is closed");
        let streets = patch.streets();
        let clearance = if is_place(patch) { 16.0 } else { 30.0 };
        for (i, a) in streets.iter().enumerate() {
            let (from, to) = (a[0], a[a.len() - 1]);
            let la = line(patch, a);
            let length = crate::space::line_length(&la);
            // The ends of a main street stand for its course beyond.
            let main = patch.edges.iter().any(|e| e.main && [e.a, e.b].contains(&from) && [e.a, e.b].contains(&a[1]));
            assert!(is_place(patch) || main || length >= 25.0, "{name}: a street of {length:.1} m");
            for b in streets[..i].iter().filter(|b| ![b[0], b[b.len() - 1]].iter().any(|v| *v == from || *v == to)) {
                let lb = line(patch, b);
                let nearest = segments(&la)
                    .flat_map(|(p, q)| segments(&lb).map(move |(r, s)| segment_distance(p, q, r, s)))
                    .fold(f64::INFINITY, f64::min);
                assert!(nearest >= clearance, "{name}: {a:?} and {b:?} are {nearest:.1} m apart");
            }
            // The way on from each end, and dead ends themselves, keep clear of all other streets.
            for (end, next) in [(from, a[1]), (to, a[a.len() - 2])] {
                let at = patch.vertices[end];
                let out = (at - patch.vertices[next]).normalize();
                let beyond = match (patch.degree(end), patch.is_connectable(end)) {
                    (1, true) => vec![at, at + out * 40.0],
                    (1, false) if !patch.edges_at(end).any(|e| patch.edges[e].main) => vec![at],
                    _ => continue,
                };
                for b in streets.iter().filter(|b| *b != a) {
                    let lb = line(patch, b);
                    let least = if beyond.len() == 1 { 30.0 } else { 25.0 };
                    for p in resample(&beyond, 10.0) {
                        let d = distance_to_line(p, &lb);
                        assert!(d >= least, "{name}: beyond vertex {end} a street is {d:.1} m away");
                    }
                }
            }
        }
        for v in (0..patch.vertices.len()).filter(|v| patch.is_intersection(*v)) {
            let around: Vec<usize> = patch.edges_at(v).map(|e| patch.edges[e].other(v)).collect();
            let at = |w: usize| patch.vertices[w] - patch.vertices[v];
            let pairs = around.iter().enumerate().flat_map(|(i, a)| around[..i].iter().map(move |b| (*a, *b)));
            for (a, b) in pairs {
                let angle = angle_between(at(a), at(b)).to_degrees();
                assert!(angle >= 50.0, "{name}: {angle:.0} degrees at vertex {v}");
            }
        }
    }
}

#[test]
fn the_library_is_rich() {
    let sets = sets();
    let patches: Vec<&Patch> = sets.values().flat_map(|s| &s.patches).collect();
    assert!(patches.len() >= 40, "{} patches", patches.len());
    assert!(sets.values().map(|s| s.patterns.len()).sum::<usize>() >= 2);
    let found: BTreeSet<&str> = patches.iter().flat_map(|p| p.tags.iter().map(String::as_str)).collect();
    assert!(tag::OF_PATCHES.iter().all(|t| found.contains(t)), "{found:?}");
    let drawn = |p: &&Patch| p.window.is_none();
    let to_live_in = sets.values().filter(|s| !is_for_works(s)).flat_map(|s| s.patches.iter().filter(drawn));
    let widths: Vec<f64> = to_live_in.map(|p| 2.0 * p.radius).collect();
    let middling = widths.iter().filter(|w| (40.0..=170.0).contains(*w)).count();
    assert!(middling * 4 >= widths.len() * 3, "{middling} of {} are 40 to 170 m wide", widths.len());
    for pattern in sets.values().flat_map(|s| s.patterns.iter().map(move |p| (s, p))) {
        let element = pattern.0.patches.iter().find(|p| p.name == pattern.1.element).unwrap();
        assert!(element.repeat_line().is_some(), "{}", pattern.1.name);
    }
}

#[test]
fn styles_are_sound_and_have_patches_for_every_need() {
    let sets = sets();
    let styles = files("styles");
    assert_eq!(styles.len(), 9);
    for (file, text) in &styles {
        let style = Style::from_ron(file, text).unwrap_or_else(|e| panic!("{e}"));
        let used: Vec<&PatchSet> = style.patch_sets.iter().map(|n| &sets[n]).collect();
        if matches!(style.filler, Filler::PatchCity(_)) {
            let windows = used.iter().flat_map(|s| &s.patches).filter(|p| p.window.is_some()).count();
            assert!(windows >= 100, "{} has {windows} windows", style.name);
            continue;
        }
        let db = PatchDatabase::new(&used, &style.allow, &style.exclude);
        let name = &style.name;
        assert!(db.patches.len() >= 15, "{name} has {} patches", db.patches.len());
        assert!(db.tagged(tag::INITIAL).len() >= 3, "{name} has {} initial patches", db.tagged(tag::INITIAL).len());
        // Something to bridge any gap from a short block to a long one.
        for distance in [60.0, 80.0, 100.0, 120.0, 140.0] {
            let mut near = db.passages_near(distance, style.local.snap_radius, [0.0; 2], 9.0);
            assert!(near.next().is_some(), "{name}: nothing of {distance} m");
        }
        assert!(style.exclude.iter().all(|t| sets.values().any(|s| s.patches.iter().any(|p| p.tags.contains(t)))));
    }
}

#[test]
fn damaged_files_are_refused_or_read_but_never_panic() {
    let signs: Vec<char> = "()[]{},:\"-.019eNaNinf \n".chars().collect();
    let (mut refused, files) = (0, files("patches"));
    for i in 0..300 {
        let mut s = crate::space::Seed(i).stream("damage", &[]);
        let (file, text) = &files[s.index(files.len())];
        let mut text: Vec<char> = text.chars().take(3000).collect();
        // Closed again after the cut, so that damage inside patches is what is met.
        let end = text.iter().collect::<String>().rfind("\n        ),").map_or(0, |byte| byte + 11);
        text.truncate(end);
        text.extend("]\n)".chars());
        for _ in 0..1 + s.index(3) {
            let at = s.index(text.len());
            match s.index(3) {
                0 => drop(text.remove(at)),
                1 => text.insert(at, signs[s.index(signs.len())]),
                _ => text[at] = signs[s.index(signs.len())],
            }
        }
        let text: String = text.into_iter().collect();
        if let Err(error) = PatchSet::from_ron(file, &text) {
            refused += 1;
            let lines = text.lines().count() + 1;
            assert!((1..=lines).contains(&error.line) && !error.reason.is_empty(), "{error}");
        }
    }
    assert!((100..300).contains(&refused), "{refused} of 300 were refused");
}
