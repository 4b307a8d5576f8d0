//! Patches of maps that are drawn for the test, and of real maps where there are some.

use super::{ExtractOptions, MapPatches, NoPatch, PatchKind, extract, select};
use crate::map::{Map, MapBuilding, MapOptions};
use crate::network::StreetClass;
use crate::patch::{DrawingRules, PatchSet, tag, to_ron};
use crate::space::math::{angle_of, rotate};
use crate::space::signed_area;
use glam::DVec2;
use std::path::Path;

/// A map in OpenStreetMap XML of lines in metres, each with a value of `highway`.
fn map_of(lines: &[(&str, Vec<DVec2>)]) -> Map {
    // Metres to degrees near the equator, where both are the same length.
    let degrees = |p: &DVec2| (9.0 + p.x / 111_319.5, p.y / 110_574.3);
    let (mut nodes, mut ways) = (String::new(), String::new());
    let mut ids: Vec<DVec2> = Vec::new();
    for (way, (class, line)) in lines.iter().enumerate() {
        let mut refs = String::new();
        for p in line {
            let known = ids.iter().position(|q| q.distance(*p) < 0.01);
            let id = known.unwrap_or_else(|| {
                let (x, y) = degrees(p);
                nodes += &format!("<node id=\"{}\" lon=\"{x}\" lat=\"{y}\"/>", ids.len() + 1);
                ids.push(*p);
                ids.len() - 1
            });
            refs += &format!("<nd ref=\"{}\"/>", id + 1);
        }
        ways += &format!("<way id=\"{}\">{refs}<tag k=\"highway\" v=\"{class}\"/></way>", way + 1);
    }
    let text = format!("<osm version=\"0.6\">{nodes}{ways}</osm>");
    Map::parse("drawn.osm", text.as_bytes(), &MapOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Blocks of 90 by 70 m, turned by 20 degrees; every fourth street is a main street.
fn grid() -> Map {
    let at = |x: i32, y: i32| rotate(DVec2::new(90.0 * f64::from(x), 70.0 * f64::from(y)), 20f64.to_radians());
    let class = |i: i32| if i % 4 == 0 { "secondary" } else { "residential" };
    let rows = (0..=12).map(|y| (class(y), (0..=12).map(|x| at(x, y)).collect()));
    let columns = (0..=12).map(|x| (class(x), (0..=12).map(|y| at(x, y)).collect()));
    map_of(&rows.chain(columns).collect::<Vec<_>>())
}

fn extracted(map: &Map, options: &ExtractOptions) -> MapPatches {
    let mut maps = [extract(map, "drawn", options).expect("the options are sound")];
    select(&mut maps, options);
    let [patches] = maps;
    patches
}

fn total(patches: &MapPatches) -> usize {
    patches.patches.len() + patches.left_out.values().sum::<usize>()
}

#[test]
fn windows_are_turned_as_the_streets_of_the_map() {
    let found = extracted(&grid(), &ExtractOptions::default());
    assert!(found.patches.len() > 20 && found.length > 20_000.0 && found.junctions == 13 * 13 - 4, "{found:?}");
    for patch in found.patches.iter().map(|p| &p.patch) {
        let window = patch.window.as_ref().expect("every patch is a window");
        assert!((window.turned.to_degrees() - 20.0).abs() < 0.2 && window.map == "drawn");
        let along = |e: &crate::patch::PatchEdge| patch.vertices[e.b] - patch.vertices[e.a];
        let quarter = std::f64::consts::FRAC_PI_2;
        let off = |way: DVec2| (angle_of(way) / quarter - (angle_of(way) / quarter).round()).abs() * quarter;
        assert!(patch.edges.iter().all(|e| off(along(e)) < 0.02), "{}", patch.name);
        // A window of 200 m and its margin in blocks of 90 by 70 m.
        assert!(patch.vertices.iter().all(|v| (*v - window.middle).abs().max_element() < 120.02));
    }
    let has_crossing = |p: &crate::patch::Patch| (0..p.vertices.len()).any(|v| p.degree(v) == 4);
    let crossings = found.patches.iter().filter(|p| has_crossing(&p.patch)).count();
    assert!(crossings * 4 > found.patches.len() * 3, "{crossings} of {}", found.patches.len());
    assert!(found.patches.iter().any(|p| p.patch.edges.iter().any(|e| e.class == StreetClass::Arterial)));
}

/// The grid, with a house of 12 by 10 m in the corner of each block.
fn built_grid() -> Map {
    let corner = |x: i32, y: i32| DVec2::new(90.0 * f64::from(x) + 15.0, 70.0 * f64::from(y) + 15.0);
    let map = grid();
    // The map has an origin of its own.
    let turned = |p: DVec2| rotate(p, 20f64.to_radians());
    let moved = map.bounds.centre() - turned(DVec2::new(540.0, 420.0));
    let house = |x: i32, y: i32| {
        let size = [(0.0, 0.0), (12.0, 0.0), (12.0, 10.0), (0.0, 10.0)];
        let outline = size.map(|(w, h)| moved + turned(corner(x, y) + DVec2::new(w, h)));
        MapBuilding { id: 0, outline: outline.to_vec(), holes: Vec::new(), height: Some(9.0), storeys: Some(3) }
    };
    let buildings = (0..144).map(|i| house(i % 12, i / 12)).collect();
    Map { buildings, ..map }
}

#[test]
fn windows_hold_the_buildings_whose_middles_lie_in_them() {
    let options = ExtractOptions { keep_duplicates: true, ..ExtractOptions::default() };
    let found = extracted(&built_grid(), &options);
    assert_eq!(found.buildings, 144);
    let mut counts = Vec::new();
    for patch in found.patches.iter().map(|p| &p.patch) {
        let window = patch.window.as_ref().expect("a window");
        counts.push(window.buildings.len());
        for building in &window.buildings {
            let middle = crate::space::centroid(&building.outline);
            assert!(middle.abs().max_element() <= window.size / 2.0 + window.margin + 0.1);
            assert!((signed_area(&building.outline) - 120.0).abs() < 1.0 && building.height == Some(9.0));
            // Its sides lie along those of the window, as the streets do.
            let side = building.outline[1] - building.outline[0];
            assert!(side.x.abs().min(side.y.abs()) < 0.1, "{side}");
        }
    }
    // 240 m of blocks of 90 by 70 m.
    let mean = counts.iter().sum::<usize>() as f64 / counts.len() as f64;
    assert!((mean - 240.0 * 240.0 / (90.0 * 70.0)).abs() < 1.5, "{mean}");
    let drawings: Vec<_> = found.patches.iter().map(|p| p.drawing.clone()).collect();
    let set = PatchSet::from_ron("built.ron", &to_ron(&drawings)).unwrap_or_else(|e| panic!("{e}"));
    for (read, made) in set.patches.iter().zip(&found.patches) {
        let buildings = |p: &crate::patch::Patch| p.window.as_ref().map(|w| w.buildings.clone());
        assert_eq!(buildings(read), buildings(&made.patch));
    }
}

#[test]
fn a_map_ends_where_its_junctions_do() {
    // Streets that go on far beyond the others, as those do that an extract cuts off by whole ways.
    let p = DVec2::new;
    let mut lines: Vec<(&str, Vec<DVec2>)> = Vec::new();
    for i in 0..=10 {
        let at = f64::from(i) * 80.0;
        let far = if i % 3 == 0 { 2_400.0 } else { 800.0 };
        lines.push(("residential", (0..=10).map(|k| p(f64::from(k) * 80.0, at)).chain([p(far + 1.0, at)]).collect()));
        lines.push(("residential", (0..=10).map(|k| p(at, f64::from(k) * 80.0)).chain([p(at, far + 1.0)]).collect()));
    }
    let options = ExtractOptions { turn_deg: Some(0.0), keep_duplicates: true, ..ExtractOptions::default() };
    let found = extracted(&map_of(&lines), &options);
    let windows = found.patches.iter().filter_map(|p| p.patch.window.as_ref());
    let ends = windows.map(|w| w.at).fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), at| (a.min(at), b.max(at)));
    let room = (ends.1 - ends.0) + 200.0;
    assert!(room.x > 700.0 && room.y > 700.0 && room.max_element() < 950.0, "{room}");
}

#[test]
fn what_is_left_out_is_counted_and_the_most_varied_are_kept() {
    let all = ExtractOptions { keep_duplicates: true, interval: 30.0, ..ExtractOptions::default() };
    let (kept, map) = (extracted(&grid(), &all), grid());
    let fewer = extracted(&map, &ExtractOptions { keep_duplicates: false, ..all.clone() });
    assert!(fewer.left_out[&NoPatch::Duplicate] > 50, "{:?}", fewer.left_out);
    assert_eq!(total(&kept), total(&fewer));
    let few = extracted(&map, &ExtractOptions { most: Some(9), ..all.clone() });
    assert_eq!((few.patches.len(), total(&few)), (9, total(&kept)));
    let long = extracted(&map, &ExtractOptions { least_streets: 1_300.0, ..all.clone() });
    assert!(long.left_out[&NoPatch::FewStreets] > 10 && total(&long) == total(&kept));
    let wrong = extract(&map, "drawn", &ExtractOptions { size: 5.0, ..all });
    assert_eq!(wrong.unwrap_err().to_string(), "`size` is 5; allowed is 40 to 1000");
}

#[test]
fn pieces_hang_on_main_streets_and_any_cell_may_lay_them() {
    let options = ExtractOptions { kind: PatchKind::Pieces, ..ExtractOptions::default() };
    let found = extracted(&grid(), &options);
    assert!(found.patches.len() > 3, "{:?}", found.left_out);
    assert!(found.patches.iter().any(|p| p.patch.tags.contains(tag::INITIAL)));
    assert!(found.patches.iter().any(|p| !p.patch.tags.contains(tag::INITIAL)));
    for patch in found.patches.iter().map(|p| &p.patch) {
        assert_eq!(patch.flaw(&DrawingRules::NONE), None, "{}", patch.name);
        assert!(!patch.is_in_pieces() && !patch.connectables.is_empty());
    }
}

#[test]
fn streets_that_cross_meet_and_forks_are_pulled_together() {
    let p = DVec2::new;
    let map = map_of(&[
        ("residential", vec![p(-300.0, 0.0), p(300.0, 0.0)]),
        // Over it without a node, and a street that ends beside it.
        ("residential", vec![p(0.0, -300.0), p(10.0, 300.0)]),
        ("residential", vec![p(-100.0, 0.3), p(-100.0, 200.0)]),
        // A slip road that leaves the street at 5 degrees.
        ("residential", vec![p(-300.0, 0.0), p(-200.0, 9.0), p(-150.0, 250.0)]),
        // A driveway.
        ("residential", vec![p(0.0, -300.0), p(3.0, -302.0)]),
        ("motorway", vec![p(-300.0, -100.0), p(300.0, -90.0)]),
    ]);
    let options = ExtractOptions { turn_deg: Some(0.0), keep_duplicates: true, ..ExtractOptions::default() };
    let found = extracted(&map, &options);
    assert_eq!(found.junctions, 3, "the crossing, the street beside it, and the end of the slip road");
    assert_eq!(found.left_out.keys().find(|r| [NoPatch::SharpAngle, NoPatch::Touching].contains(r)), None);
    let most = found.patches.iter().map(|p| p.patch.edges.len()).max();
    assert!(most > Some(3), "{most:?}");
}

#[test]
fn a_written_set_is_the_same_again() {
    for kind in [PatchKind::Windows, PatchKind::Pieces] {
        let found = extracted(&grid(), &ExtractOptions { kind, most: Some(12), ..ExtractOptions::default() });
        let drawings: Vec<_> = found.patches.iter().map(|p| p.drawing.clone()).collect();
        let set = PatchSet::from_ron("drawn.ron", &to_ron(&drawings)).unwrap_or_else(|e| panic!("{e}"));
        let patches: Vec<_> = found.patches.iter().map(|p| p.patch.clone()).collect();
        let bare = |p: &crate::patch::Patch| crate::patch::Patch { window: None, ..p.clone() };
        assert_eq!(set.patches.iter().map(bare).collect::<Vec<_>>(), patches.iter().map(bare).collect::<Vec<_>>());
    }
}

#[test]
fn every_real_map_gives_patches() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/maps");
    let Ok(files) = std::fs::read_dir(folder) else { return };
    let mut files: Vec<_> = files.filter_map(|f| Some(f.ok()?.path())).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "osm" || e == "pbf"));
    files.sort();
    // The smaller ones; all of them take too long in a test.
    files.retain(|f| f.metadata().is_ok_and(|m| m.len() < 110_000));
    for file in files {
        let map = Map::read(&file, &MapOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        for kind in [PatchKind::Windows, PatchKind::Pieces] {
            let options = ExtractOptions { kind, interval: 100.0, ..ExtractOptions::default() };
            let found = extracted(&map, &options);
            assert!(found.patches.len() > 9, "{}: {:?}", file.display(), found.left_out);
        }
    }
}
