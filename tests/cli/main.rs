//! The `sprawl` program as its users meet it: what it writes, and how it refuses.

mod flags;
mod maps;
mod readers;
mod roads;
mod support;

use serde_json::Value;
use std::path::Path;
use std::process::Command;
use support::{city, file, json, out, refused, sprawl};

#[test]
fn bad_input_is_refused_in_one_line() {
    let settings = file("bad.ron", "(\n  terrain: (\n    colour: 3,\n  ),\n)");
    let settings = settings.to_string_lossy();
    let range = file("range.ron", "(\n  chunk_size: 100,\n)");
    let patches = file("bad-patches.ron", "(patches: [\n (name: 3)\n])");
    let cases: &[(&[&str], &str)] = &[
        (&["stats", "--settings", &settings], "bad.ron:3:"),
        (&["stats", "--settings", &range.to_string_lossy()], "range.ron:2:3: chunk_size is 100"),
        (&["stats", "--settings", "missing.ron"], "missing.ron: "),
        (&["stats", "--assets", "missing"], "missing"),
        (&["patches", "check", &patches.to_string_lossy()], "bad-patches.ron:2:"),
        (&["patches", "draw", "assets", "-o", "sheet.txt"], ".svg .png"),
        (&["map", "-o", "town.txt"], ".svg .png .geojson .osm .glb"),
        (&["map", "-o", "no/such/folder/town.svg"], "no/such/folder/town.svg"),
        (&["map", "-o", "town.glb", "--size", "50000"], "at most 16000"),
        (&["map"], "--output"),
        (&["stats", "--size", "0"], "--size"),
        (&["stats", "--size", "-4"], "--size"),
        (&["stats", "--size=NaN"], "--size"),
        (&["stats", "--size", "200001"], "200000"),
        (&["stats", "--at", "7"], "--at"),
        (&["stats", "--at", "1e15,0"], "too far out"),
        (&["stats", "--threads", "0"], "--threads"),
        (&["digest", "--chunks", "0..0,0..1"], "--chunks"),
        (&["soak", "--seeds", "3..3"], "--seeds"),
        (&["fly"], "fly"),
        (&[], "--help"),
    ];
    for (arguments, expected) in cases {
        let line = refused(arguments);
        assert!(line.contains(expected), "{arguments:?}: {line}");
    }
    assert!(!Path::new("town.glb").exists());
}

#[test]
fn a_flag_without_a_use_is_refused() {
    let roads = ["roads", "--terrain", "a.asc", "--settlements", "b.csv", "-o", "c.svg"];
    let map = |name| ["map", "-o", name];
    let cases: &[(&[&str], &[&str])] = &[
        (&roads, &["--cell", "30"]),
        (&["roads", "--terrain", "a.asc", "--settlements", "b.csv", "-o", "c.geojson"], &["--pixels", "300"]),
        (&map("a.geojson"), &["--pixels", "300"]),
        (&map("a.osm"), &["--show", "region"]),
        (&map("a.glb"), &["--colour-by", "origin"]),
        (&map("a.png"), &["--detail", "full"]),
        (&map("a.svg"), &["--everything"]),
        (&map("a.png"), &["--clip"]),
        (&map("a.geojson"), &["--origin", "0,0"]),
    ];
    for (command, flag) in cases {
        let line = refused(&[*command, flag].concat());
        assert!(line.contains(flag[0]), "{command:?}: {line}");
    }
    assert!(refused(&["seams", "--most-difference", "NaN"]).contains("--most-difference"));
}

#[test]
fn what_is_missing_is_named_in_the_file_that_names_it() {
    let settings = file("roman.ron", "(\n  settlements: (\n    steep: (\"roman\", 0.1),\n  ),\n)");
    let line = refused(&["stats", "--settings", &settings.to_string_lossy()]);
    assert!(line.contains("roman.ron:3:5: settings name the style `roman`"), "{line}");
    let folder = file("few-assets", "");
    for (name, text) in [("styles/a.ron", "(\n  patch_sets: [\"b\", \"c\"],\n)"), ("patches/b.ron", "")] {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        let set = "(patches: [(name: \"x\", vertices: [(0, 0), (60, 0), (120, 0)], streets: [[0, 1, 2]])])";
        std::fs::write(path, if text.is_empty() { set } else { text }).expect("the folder can be written");
    }
    let settings =
        "(settlements: (styles: (city: [(\"a\", 1)], town: [(\"a\", 1)], village: [(\"a\", 1)]), steep: (\"\", 0)))";
    let settings = file("few.ron", settings);
    let base = ["stats", "--assets", &folder.to_string_lossy()];
    let line = refused(&[&base[..], &["--settings", &settings.to_string_lossy()]].concat());
    assert!(line.contains("few-assets/styles/a.ron:2:21: style `a` names the patch set `c`"), "{line}");
    // The default settings name styles that the folder lacks.
    let line = refused(&base);
    assert!(line.contains("few-assets: settings name the style"), "{line}");
}

#[cfg(unix)]
#[test]
fn a_link_stays_a_link() {
    let folder = file("links", "");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let (real, link) = (folder.join("real.svg"), folder.join("link.svg"));
    for is_there in [false, true] {
        if !is_there {
            std::os::unix::fs::symlink("real.svg", &link).expect("a link");
        }
        out(&["patches", "draw", "assets/patches/grid.ron", "-o", &link.to_string_lossy()]);
        assert!(link.is_symlink() && real.is_file() && !real.is_symlink());
    }
    assert_eq!(std::fs::read_dir(&folder).expect("a folder").count(), 2, "no part stays");
}

#[test]
fn a_file_that_is_read_is_not_written() {
    let text = "(chunk_size: 512)";
    let settings = file("settings.svg", text).to_string_lossy().into_owned();
    let line = refused(&["map", "--size", "300", "--settings", &settings, "-o", &settings]);
    assert!(line.contains("settings.svg: is a file that is read"), "{line}");
    assert_eq!(std::fs::read_to_string(&settings).ok().as_deref(), Some(text));
}

#[test]
fn places_never_lie_in_comments_and_names_are_escaped() {
    let text = "(\n  /* terrain: see docs, sea_share: 0.3 */\n  terrain: (\n    sea_share: 5,\n  ),\n)";
    let settings = file("comment.ron", text);
    let line = refused(&["stats", "--settings", &settings.to_string_lossy()]);
    assert!(line.contains("comment.ron:4:5: terrain.sea_share is 5"), "{line}");
    let settings = file("escape.ron", "(settlements: (steep: (\"\u{1b}[31mred\", 0.1)))");
    let line = refused(&["stats", "--settings", &settings.to_string_lossy()]);
    assert!(line.contains("escape.ron") && !line.contains('\u{1b}'), "{line}");
}

#[test]
fn a_wrong_file_of_edits_is_refused_at_its_line() {
    let cases = [
        ("colour", "(\n  settlements: [\n    Ban(at: (0, 0), colour: 3),\n  ],\n)", "colour.ron:3:"),
        (
            "range",
            "(\n  settlements: [\n    Ban(at: (0, 0), radius: -1),\n  ],\n)",
            "range.ron:3:5: settlements[0]: radius is -1",
        ),
        (
            "cross",
            "(\n  influences: [\n    (shape: Area([(0, 0), (9, 9), (9, 0), (0, 9)]), radius: 99, strength: 1),\n  ],\n)",
            "cross.ron:3:5: influences[0]: the border of the area crosses itself at 4.5,4.5",
        ),
        ("few", "(roads: [Via(from: (0, 0), to: (1, 1), points: [])])", "few.ron:1:10: roads[0]: points has 0 points"),
        (
            "nan",
            "(\n  way_points: [\n    (at: (0, NaN), class: Minor),\n  ],\n)",
            "nan.ron:3:5: way_points[0]: at.y is NaN",
        ),
        ("far", "(way_points: [(at: (1e11, 0), class: Minor)])", "far.ron:1:15: way_points[0]: at.x is 100000000000"),
    ];
    for (name, text, expected) in cases {
        let path = file(&format!("edits-{name}.ron"), text);
        let line = refused(&["settlements", "--edits", &path.to_string_lossy()]);
        assert!(line.contains(expected), "{line}");
    }
    assert!(refused(&["stats", "--edits", "missing.ron"]).contains("missing.ron: "));
}

#[test]
fn edits_that_cannot_be_are_named_and_the_world_goes_on() {
    let (x, y) = city().split_once(',').expect("two numbers");
    let text = format!(
        "(\n  settlements: [\n    Ban(at: ({x}, {y}), radius: 1),\n    Pin(at: (0, 0), size: Town, style: \"roman\"),\n  ],\n  \
         way_points: [\n    (at: ({x}, {y}), class: Major),\n    (at: ({x}, {y}), class: Minor),\n  ],\n  \
         roads: [ // none of these\n    Keep(from: ({x}, {y}), to: (1e9, 0)),\n  ],\n)"
    );
    let path = file("rejected.ron", &text);
    let path = path.to_string_lossy();
    let at = city();
    let arguments = ["settlements", "--seed", "5", "--at", at, "--size", "9000", "--edits", &path, "--json"];
    let output = sprawl(&arguments);
    assert!(output.status.success());
    let report: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let lines = String::from_utf8(output.stderr).expect("UTF-8");
    let rejected: Vec<&str> =
        report["rejected_edits"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    let warned: Vec<&str> = lines.lines().filter_map(|l| l.strip_prefix("sprawl: warning: ")).collect();
    assert_eq!(rejected, warned);
    let expected = [
        "rejected.ron:4:5: settlements[1]: style `roman`",
        "rejected.ron:8:5: way_points[1]: ",
        "rejected.ron:11:5: roads[0]: no settlement is at",
    ];
    assert_eq!(rejected.len(), expected.len(), "{rejected:?}");
    assert!(rejected.iter().zip(expected).all(|(r, e)| r.contains(e)), "{rejected:?}");
    let settlements = report["settlements"].as_array().expect("a list");
    assert!(!settlements.is_empty() && settlements.iter().all(|s| s["sigma"] != 2), "the city is banned");
    let plain = json(&["settlements", "--seed", "5", "--at", at, "--size", "9000"]);
    assert!(plain.get("rejected_edits").is_none());
}

#[test]
fn patch_sets_are_checked_and_drawn() {
    let report = json(&["patches", "check", "assets"]);
    assert_eq!(report["errors"].as_array().map(Vec::len), Some(0));
    assert!(report["sets"].as_array().expect("a list").len() >= 5);
    let whole = json(&["patches", "check", "--assets", "assets"]);
    assert_eq!((&whole["warnings"], &whole["errors"]), (&serde_json::json!([]), &serde_json::json!([])), "{whole}");
    assert_eq!(whole["sets"], report["sets"]);
    // What can never be used is named, and the set is good all the same.
    let ring =
        "(patches: [\n(name: \"ring\", vertices: [(0, 0), (80, 0), (80, 80), (0, 80)], streets: [[0, 1, 2, 3, 0]])])";
    let ring = file("ring.ron", ring).to_string_lossy().into_owned();
    let warnings = &json(&["patches", "check", &ring])["warnings"];
    assert_eq!((&warnings[0]["line"], &warnings[0]["column"]), (&Value::from(2), &Value::from(2)), "{warnings}");
    assert!(out(&["patches", "check", &ring]).contains("warning: "));
    assert!(refused(&["patches", "check", &ring, "--assets", "assets"]).contains("not both"));
    assert!(refused(&["patches", "check"]).contains("needs patch sets"));
    let folder = file("in-vain", "");
    for (name, text) in [
        ("styles/a.ron", "(patch_sets: [\"b\"],\nexclude: [\"wod\"])"),
        (
            "patches/b.ron",
            "(patches: [(name: \"c\", vertices: [(0, 0), (60, 0)], streets: [(0, 1)], tags: [\"wood\"])])",
        ),
    ] {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("folders can be made");
        std::fs::write(path, text).expect("the folder can be written");
    }
    let folder = folder.to_string_lossy();
    let warnings = &json(&["patches", "check", "--assets", &folder])["warnings"];
    assert_eq!((warnings.as_array().map(Vec::len), &warnings[0]["line"]), (Some(1), &Value::from(2)), "{warnings}");
    std::fs::write(format!("{folder}/styles/a.ron"), "(patch_sets: [\n\"no\"])").expect("the folder can be written");
    assert!(
        refused(&["patches", "check", "--assets", &folder]).contains("a.ron:2:1: style `a` names the patch set `no`")
    );
    for (name, magic) in [("sheet.svg", &b"<svg"[..]), ("sheet.png", b"\x89PNG")] {
        let path = file(name, "");
        out(&["patches", "draw", "assets/patches/grid.ron", "-o", &path.to_string_lossy()]);
        assert!(std::fs::read(path).expect("a file").starts_with(magic), "{name}");
    }
}

#[test]
fn digests_do_not_depend_on_order_threads_or_memory() {
    let (x, y) = city().split_once(',').expect("two numbers");
    let chunk = |x: &str| (x.parse::<f64>().expect("a number") / 512.0).floor() as i64;
    let chunks = format!("{}..{},{}..{}", chunk(x) - 1, chunk(x) + 2, chunk(y), chunk(y) + 2);
    let base = ["digest", "--seed", "5", "--chunks", &chunks];
    let first = json(&[&base[..], &["--threads", "1"]].concat());
    assert_eq!(first["chunks"].as_object().map(serde_json::Map::len), Some(6));
    let layers = ["terrain", "region", "town", "streets", "parcel", "chunk", "mesh"];
    assert!(layers.iter().all(|l| first["layers"][l].as_str().is_some_and(|h| h.len() == 16)), "{first}");
    let small = file("small.ron", "(cache: (region_mib: 16, town_mib: 8, chunk_mib: 8))");
    let small = small.to_string_lossy();
    for flags in [
        &["--order", "reverse", "--threads", "3"][..],
        &["--order", "shuffled", "--threads", "2", "--settings", &small],
    ] {
        assert_eq!(first, json(&[&base[..], flags].concat()), "{flags:?}");
    }
    assert_ne!(first["total"], json(&["digest", "--seed", "6", "--chunks", &chunks])["total"]);
}

#[test]
fn stats_of_a_city_have_every_figure_and_no_fault() {
    let report = json(&["stats", "--seed", "5", "--at", city(), "--size", "1500"]);
    let keys = "area_km2 street_km junctions dead_ends degree cnr street_km_per_km2 junctions_per_km2 mean_street_m \
        orientation_order circuity block_area_median_m2 share_angle_below_30 components unmet_ports \
        crossings_without_junction buildings building_cover timing_ms";
    for key in keys.split_whitespace() {
        assert!(report.get(key).is_some(), "{key}");
    }
    let figure = |key: &str| report[key].as_f64().expect("a number");
    assert_eq!((figure("area_km2"), figure("components")), (2.25, 1.0));
    assert_eq!((figure("unmet_ports"), figure("crossings_without_junction")), (0.0, 0.0));
    assert!(figure("street_km") > 8.0 && figure("buildings") > 100.0, "{report}");
}

#[test]
fn towns_are_held_against_real_ones() {
    let path = file("towns.md", "");
    let path = path.to_string_lossy();
    let report = json(&["towns", "--seeds", "3..5", "--style", "grid", "--radius", "500", "-o", &path]);
    let grid = &report["presets"]["grid"];
    assert_eq!((grid["kind"].as_str(), grid["towns"].as_u64()), (Some("grid"), Some(2)), "{report}");
    assert_eq!(report["towns"].as_array().map(Vec::len), Some(2));
    for figure in "junctions_per_km2 street_km_per_km2 cnr mean_street_m circuity block_median_m2".split_whitespace() {
        let figure = &grid["figures"][figure];
        let [low, middle, high] = ["p10", "p50", "p90"].map(|p| figure[p].as_f64().expect("a number"));
        assert!(0.0 < low && low <= middle && middle <= high, "{report}");
    }
    assert_eq!(grid["unmet_ports"], 0);
    let page = std::fs::read_to_string(&*path).expect("a file");
    assert!(page.contains("## grid") && page.contains("| junctions/km2 |"), "{page}");
    assert!(refused(&["towns", "--style", "gothic"]).contains("gothic"));
}

#[test]
fn the_expressive_range_is_that_of_the_paper() {
    let folder = file("expressive", "");
    let folder = folder.to_string_lossy();
    let arguments = ["expressive-range", "--networks", "3", "-o", &folder];
    let report = json(&arguments);
    assert_eq!(report["panels"].as_array().map(Vec::len), Some(40));
    assert!(report["share_in_the_papers_range"].as_f64() > Some(0.9), "{report}");
    let trend = |i: usize| (report["trends"][i]["holds"].as_u64(), report["trends"][i]["of"].as_u64());
    // Of three networks each, some means are off.
    assert!(trend(0).1 == Some(32) && trend(0).0 >= Some(24) && trend(1).0 >= Some(26), "{report}");
    let spread = |what: &str| report[what][1].as_f64().unwrap_or(0.0) - report[what][0].as_f64().unwrap_or(0.0);
    assert!(spread("density") > 30.0 && spread("cnr") > 0.2, "{report}");
    let lines = std::fs::read_to_string(format!("{folder}/expressive-range.csv")).expect("a file").lines().count();
    assert_eq!(lines, 121);
    for name in ["expressive-range.svg", "expressive-range-all.svg"] {
        let figure = std::fs::read_to_string(format!("{folder}/{name}")).expect("a file");
        assert!(figure.starts_with("<svg") && figure.contains("<polygon"), "{name}");
    }
    assert_eq!(report, json(&[&arguments[..], &["--threads", "1"]].concat()));
}

#[test]
fn towns_of_every_kind_keep_every_promise_and_hide_the_chunks() {
    let report = json(&["soak", "--towns", "5", "--seed", "77"]);
    assert_eq!(report["towns"], 5, "{report}");
    assert_eq!(report["findings"].as_array().map(Vec::len), Some(0), "{report}");
    // Few towns tell little: the limits are wide.
    let wide = ["--most-difference", "0.5", "--most-peak", "5"];
    let report = json(&[&["seams", "--km2", "6", "--seed", "8"][..], &wide].concat());
    let area = &report["figures"]["area_km2"];
    assert!(area[0].as_f64() > Some(1.0) && area[1].as_f64() > Some(3.0), "{report}");
    assert_eq!(report["fine"], true);
    let refused = sprawl(&["seams", "--km2", "2", "--most-difference", "0"]);
    assert_eq!(refused.status.code(), Some(1));
}

#[test]
fn every_format_is_written_and_the_map_passes_a_strangers_check() {
    let at = city();
    let starts: [(&str, &[u8]); 5] = [
        ("town.geojson", b"{\"type\":\"FeatureCollection\""),
        ("town.osm", b"<?xml"),
        ("town.svg", b"<svg"),
        ("town.png", b"\x89PNG"),
        ("town.glb", b"glTF\x02\0\0\0"),
    ];
    for (name, magic) in starts {
        let path = file(name, "");
        let path = path.to_string_lossy();
        let size = if name == "town.glb" { "600" } else { "1500" };
        let pixels: &[&str] = if name.ends_with("svg") || name.ends_with("png") { &["--pixels", "500"] } else { &[] };
        let report = json(&[&["map", "--seed", "5", "--at", at, "--size", size, "-o", &path], pixels].concat());
        let bytes = std::fs::read(&*path).expect("a file");
        assert!(bytes.starts_with(magic), "{name}");
        assert_eq!(report["bytes"].as_u64(), Some(bytes.len() as u64));
        if name.ends_with("json") || name.ends_with("osm") {
            let check = Command::new("python3").args(["tests/check_map.py", &path]).output();
            // Machines without Python leave this to others.
            let Ok(check) = check else { continue };
            assert!(check.status.success(), "{name}: {}", String::from_utf8_lossy(&check.stdout));
        }
    }
}

#[test]
fn negative_places_work_in_both_forms() {
    let spaced = json(&["settlements", "--at", "-7000,-500", "--size", "9000"]);
    assert_eq!(spaced, json(&["settlements", "--at=-7000,-500", "--size=9000"]));
}
