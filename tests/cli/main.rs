//! The `sprawl` program as its users meet it: what it writes, and how it refuses.

mod flags;
mod maps;
mod readers;
mod support;

use serde_json::Value;
use std::path::Path;
use std::process::Command;
use support::{TOWNS, city, country, file, json, out, refused, sprawl};

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
    let small = file("small.ron", "(cache: (region_mib: 8, town_mib: 8, chunk_mib: 8))");
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

#[test]
fn roads_of_a_finite_domain() {
    let [grid, towns] = country("country", TOWNS);
    let run = |gamma: &str, name: &str, more: &[&str]| {
        let path = file(name, "").to_string_lossy().into_owned();
        let base =
            ["roads", "--terrain", &grid, "--settlements", &towns, "--gamma", gamma, "--sea-level", "-50", "-o", &path];
        (json(&[&base[..], more].concat()), std::fs::read(&path).expect("a file"))
    };
    let (report, map) = run("inf", "country.geojson", &[]);
    let list = |key: &str| report[key].as_array().expect("a list").clone();
    assert_eq!((list("settlements").len(), list("unreached").len(), report["step_m"].as_i64()), (6, 0, Some(250)));
    assert!(list("roads").iter().all(|r| r["length_m"].as_f64() <= r["cost"].as_f64().map(|c| 1.2 * c)), "{report}");
    assert!(["read", "build", "write"].iter().all(|t| report["timing_ms"][t].is_number()));
    assert_eq!(report["totals"]["classes"]["highway"]["roads"], 1);
    assert!(String::from_utf8_lossy(&map).contains("\"kind\":\"road\""));
    let dense = run("1.1", "dense.geojson", &["--threads", "2"]).0;
    assert!(dense["totals"]["roads"].as_u64() > report["totals"]["roads"].as_u64(), "{dense}");
    // Threads change nothing but the time.
    assert_eq!(map, run("inf", "again.geojson", &["--threads", "3"]).1);
    for (name, magic) in [("country.svg", &b"<svg"[..]), ("country.png", b"\x89PNG")] {
        let (_, picture) = run("2", name, &["--pixels", "300"]);
        assert!(picture.starts_with(magic), "{name}");
    }
    // A settings file changes what it names, and leaves the rest as it is without one.
    let settings = file(
        "country.ron",
        "(roads: (highway: (turn: 60), major: (highway_crossings: Junction), minor: (gamma: inf)))",
    )
    .to_string_lossy()
    .into_owned();
    let by_file = run("inf", "by_file.geojson", &["--settings", &settings]).0;
    assert_eq!(by_file["totals"]["roads"], report["totals"]["roads"]);
    let mountains = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/settings/mountains.ron");
    let by_file = run("2", "mountains.geojson", &["--settings", mountains]).0;
    assert_eq!(by_file["unreached"], Value::Array(vec![]));
}

#[test]
fn roads_follow_edits() {
    let [grid, towns] = country("wishes", TOWNS);
    let out = file("wishes.geojson", "").to_string_lossy().into_owned();
    let base = ["roads", "--terrain", &grid, "--settlements", &towns, "--sea-level", "-50", "-o", &out];
    let count = |report: &Value, key: &str| report[key].as_array().map(Vec::len);
    let plain = json(&base);
    let head = "ncols 60\nnrows 40\nxllcorner 1000\nyllcorner -2000\ncellsize 250\nNODATA_value -9999\n";
    file("painted.asc", &format!("{head}{}\n", vec![vec!["-9999"; 60].join(" "); 40].join("\n")));
    let text = "(\n  settlements: [Pin(at: (10000, 4000), size: Village, name: \"New\")],\n  \
                roads: [\n    Ban(from: (2500, 1000), to: (7000, 2200)),\n    Keep(from: (0, 0), to: (7000, 2200)),\n  ],\n  \
                influence_maps: [(file: \"painted.asc\")],\n  patches: [(patch: \"cross\", at: (0, 0))],\n)";
    let edits = file("wishes.ron", text).to_string_lossy().into_owned();
    let output = sprawl(&[&base[..], &["--edits", &edits, "--json"]].concat());
    let lines = String::from_utf8(output.stderr).expect("UTF-8");
    for expected in ["wishes.ron:8:", "patches have no use here", "wishes.ron:5:5: roads[1]: no settlement is at 0,0"] {
        assert!(lines.contains(expected), "{lines}");
    }
    let report: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    assert_eq!((count(&report, "rejected_edits"), count(&report, "settlements")), (Some(1), Some(7)), "{report}");
    let highways = |report: &Value| report["totals"]["classes"]["highway"]["roads"].clone();
    assert_eq!((highways(&plain), highways(&report)), (Value::from(1), Value::from(0)));
    assert!(refused(&[&base[..], &["--edits", "missing.ron"]].concat()).contains("missing.ron: "));
    let unread = file("unread.ron", "(influence_maps: [(file: \"nowhere.asc\")])").to_string_lossy().into_owned();
    assert!(refused(&[&base[..], &["--edits", &unread]].concat()).contains("nowhere.asc: "));
}

#[test]
fn roads_name_the_settings_without_a_use() {
    let [grid, towns] = country("unused", TOWNS);
    let text = "(\n  terrain: (sea_share: 0.2),\n  roads: (minor: (gamma: inf)),\n  cache: (region_mib: 64),\n)";
    let settings = file("unused.ron", text).to_string_lossy().into_owned();
    let out = file("unused.geojson", "").to_string_lossy().into_owned();
    let all = ["roads", "--terrain", &grid, "--settlements", &towns, "-o", &out, "--settings", &settings, "--json"];
    let output = sprawl(&all);
    let lines = String::from_utf8(output.stderr).expect("UTF-8");
    for expected in
        ["unused.ron:2:13: terrain.sea_share has no use here", "unused.ron:4:11: cache.region_mib has no use"]
    {
        assert!(lines.contains(expected), "{lines}");
    }
    assert_eq!(lines.lines().count(), 2, "{lines}");
    let report: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    assert_eq!(report["warnings"].as_array().map(Vec::len), Some(2));
}

#[test]
fn roads_over_water_and_through_woods() {
    let [grid, towns] = country("wet", TOWNS);
    // A narrow lake of cells twice as wide, in the way; woods in the south.
    let band = |name: &str, of: &dyn Fn(i32, i32) -> &'static str| {
        let rows: Vec<String> =
            (0..20).rev().map(|y| (0..30).map(|x| of(x, y)).collect::<Vec<_>>().join(" ")).collect();
        let head = "ncols 30\nnrows 20\nxllcorner 1000\nyllcorner -2000\ncellsize 500\n";
        file(name, &format!("{head}{}\n", rows.join("\n"))).to_string_lossy().into_owned()
    };
    let lake = |x: i32, y: i32| if x == 4 && y > 3 { "6" } else { "0" };
    let water = band("lake.asc", &lake);
    let wood = band("wood.asc", &|_, y| if y < 10 { "0.9" } else { "0" });
    let out = file("wet.geojson", "").to_string_lossy().into_owned();
    let base = ["roads", "--terrain", &grid, "--settlements", &towns, "-o", &out];
    let of = |more: &[&str]| json(&[&base[..], more].concat())["totals"].clone();
    let (dry, wet) = (of(&[]), of(&["--water", &water]));
    assert!(dry["bridges"] == 0 && dry != wet, "{dry} {wet}");
    assert_ne!(of(&["--vegetation", &wood])["classes"], dry["classes"]);
    // Pictures cover the domain; white is the greatest depth, or dense wood.
    let picture = |name: &str, of: &dyn Fn(i32, i32) -> u8| {
        let path = file(name, "").to_string_lossy().into_owned();
        let mut encoder = png::Encoder::new(std::fs::File::create(&path).expect("a file"), 30, 20);
        encoder.set_color(png::ColorType::Grayscale);
        let pixels: Vec<u8> = (0..20).rev().flat_map(|y| (0..30).map(move |x| of(x, y))).collect();
        encoder.write_header().and_then(|mut w| w.write_image_data(&pixels)).expect("a picture");
        path
    };
    let drawn = picture("lake.png", &|x, y| if lake(x, y) == "6" { 255 } else { 0 });
    assert_eq!(of(&["--water", &drawn, "--water-white", "6"]), wet);
    let drawn = picture("wood.png", &|_, y| if y < 10 { 255 } else { 0 });
    assert_ne!(of(&["--vegetation", &drawn])["classes"], dry["classes"]);
    let bad = |name: &str, from: &str, to: &str| {
        let text = std::fs::read_to_string(&water).expect("a grid").replacen(from, to, 1);
        file(name, &text).to_string_lossy().into_owned()
    };
    // Where a mask has no value, there is no water.
    for hole in ["nan", "-9999", "null"] {
        assert_eq!(of(&["--water", &bad("hole.asc", "0 0", &format!("0 {hole}"))]), wet);
    }
    for (flag, path, expected) in [
        ("--water", bad("short.asc", "0 0", "0"), "short.asc:6:1: row 1 has 29 numbers; ncols is 30"),
        ("--water", bad("deep.asc", "0 0", "0 -1"), "deep.asc:6:3: row 1, column 2: water depth is -1"),
        ("--vegetation", water.clone(), "vegetation density is 6; allowed is 0 to 1"),
        ("--water", bad("off.asc", "xllcorner 1000", "xllcorner 99000"), "off.asc: place of the water depth"),
        ("--water", "lake.tif".into(), "lake.tif: "),
    ] {
        let line = refused(&[&base[..], &[flag, &path]].concat());
        assert!(line.contains(expected), "{line}");
    }
}

#[test]
fn inhabitants_stand_for_size_classes() {
    let [grid, towns] = country("people", "name,x,y,population\nA,2000,1000,21000\nB,9000,3000,5000\nC,5000,5000,70\n");
    let out = file("people.geojson", "").to_string_lossy().into_owned();
    let base = ["roads", "--terrain", &grid, "--settlements", &towns, "-o", &out];
    let sizes = |more: &[&str]| {
        let report = json(&[&base[..], more].concat());
        let all = report["settlements"].as_array().expect("a list").clone();
        let mut all: Vec<(String, u64)> =
            all.iter().map(|s| (s["name"].to_string(), s["sigma"].as_u64().expect("a size"))).collect();
        all.sort();
        all.into_iter().map(|s| s.1).collect::<Vec<_>>()
    };
    assert_eq!(sizes(&[]), [2, 1, 0]);
    assert_eq!(sizes(&["--populations", "50,5000"]), [2, 2, 1]);
    assert!(refused(&[&base[..], &["--populations", "9,5"]].concat()).contains("no less for a city"));
}

#[test]
fn roads_refuse_bad_input_in_one_line() {
    let [grid, towns] = country("hills", TOWNS);
    let wrong = |name: &str, row: &str| {
        country(name, &format!("name,x,y,sigma\nA,2000,1000,1\nB,9000,3000,0\n{row}"))[1].clone()
    };
    let outside = wrong("outside", "C,900,1000,0\n");
    let drowned = wrong("drowned", "C,15000,1000,0\n");
    let twice = wrong("twice", "C,9000,3000,0\n");
    let near = wrong("near", "C,9000,3100,0\n");
    let alone = country("alone", "name,x,y,sigma\nA,2000,1000,1\n")[1].clone();
    let bad = file("bad-roads.ron", "(\n  roads: (minor: (gamma: 0.5)),\n)").to_string_lossy().into_owned();
    let picture = file("nothing.png", "x").to_string_lossy().into_owned();
    let out = file("refused.svg", "").to_string_lossy().into_owned();
    let cases: &[(&str, &str, &[&str], &str)] = &[
        (&grid, &outside, &[], "outside.csv:4:3: \"C\" at 900,1000 m lies outside of the domain"),
        (&grid, &drowned, &["--sea-level", "-50"], "drowned.csv:4:3: \"C\" at 15000,1000 m lies under"),
        (&grid, &twice, &[], "twice.csv:4:3: line 3 has the same position"),
        (
            &grid,
            &near,
            &["--step", "250"],
            "near.csv:4:3: C lies 100 m from B; keep at least 1.5 steps of the lattice (375 m)",
        ),
        (&grid, &alone, &[], "alone.csv: a network needs at least two settlements; found 1"),
        (&grid, &towns, &["--gamma", "1"], "1.01 or more is allowed, or inf"),
        (&grid, &towns, &["--step", "9000"], "--step: step is 9000; allowed is "),
        (&grid, &towns, &["--settings", &bad], "bad-roads.ron:2:19: roads.minor.gamma is 0.5; allowed is 1.01 to inf"),
        (&grid, &towns, &["--geographic"], "box of the raster in degrees"),
        (&grid, "missing.csv", &[], "missing.csv: "),
        (&picture, &towns, &[], "a picture needs --cell and --white"),
        (&picture, &towns, &["--cell", "30", "--white", "900"], "nothing.png: not a readable PNG"),
        (&towns, &towns, &[], "must end in .asc .tif .tiff .png"),
    ];
    for (terrain, settlements, more, expected) in cases {
        let base = ["roads", "--terrain", terrain, "--settlements", settlements, "-o", &out];
        let line = refused(&[&base[..], more].concat());
        assert!(line.contains(expected), "{more:?}: {line}");
    }
    assert!(!Path::new(&out).exists());
}
