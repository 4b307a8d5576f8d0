//! Roads of a finite domain.

use crate::support::{TOWNS, country, file, json, refused, sprawl};
use serde_json::Value;
use std::path::Path;

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
