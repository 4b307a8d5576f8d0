//! Every reader of text goes through the same tolerances, and refuses the same things by name.

use crate::support::{country, file, json, out, refused, sprawl};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A file that a command reads.
struct Reader {
    name: &'static str,
    content: String,
    /// The command, with the file's path in place of `FILE`, and that of its grandparent folder in place of `ASSETS`.
    command: Vec<String>,
    /// Whether the file is still one when half of it is missing.
    may_be_cut: bool,
}

/// What a command says of its file, apart from times and names of files.
fn meaning(command: &[&str]) -> Value {
    let mut report = json(command);
    for key in ["timing_ms", "seconds", "bytes", "file"] {
        report.as_object_mut().expect("an object").remove(key);
    }
    report
}

/// A copy of the bundled assets that this test may change.
fn assets() -> PathBuf {
    let to = Path::new(env!("CARGO_TARGET_TMPDIR")).join("assets");
    for folder in ["styles", "patches"] {
        std::fs::create_dir_all(to.join(folder)).expect("a folder");
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(folder);
        for entry in std::fs::read_dir(from).expect("the bundled assets") {
            let path = entry.expect("a file").path();
            std::fs::copy(&path, to.join(folder).join(path.file_name().expect("a name"))).expect("a copy");
        }
    }
    to
}

fn readers() -> Vec<Reader> {
    let height = |x: i32, y: i32| (100 + (x * 7 + y * 3) % 19).to_string();
    let rows: Vec<String> = (0..20).map(|y| (0..20).map(|x| height(x, y)).collect::<Vec<_>>().join(" ")).collect();
    let grid = format!("ncols 20\nnrows 20\nxllcorner 9.0\nyllcorner 47.0\ncellsize 0.002\n{}\n", rows.join("\n"));
    let table = "name,lon,lat,sigma\nA,9.006,47.006,0\nQ,9.034,47.03,0\n".to_owned();
    let path = |name: &str, content: &str| file(name, content).to_string_lossy().into_owned();
    let (ground, towns) = (path("reader-ground.asc", &grid), path("reader-towns.csv", &table));
    let drawn = path("reader.geojson", "");
    let roads = |more: &[&str]| {
        let base = ["roads", "--geographic", "-o", &drawn];
        base.iter().chain(more).map(|w| (*w).to_owned()).collect::<Vec<_>>()
    };
    let both = ["--terrain", ground.as_str(), "--settlements", towns.as_str()];
    let real = || roads(&[&both[..], &["--reference", "FILE"]].concat());
    let words = |all: &[&str]| all.iter().map(|w| (*w).to_owned()).collect::<Vec<_>>();
    let osm = "<osm version='0.6'>\n<node id='1' lat='47.004' lon='9.004'/>\n<node id='2' lat='47.006' lon='9.010'/>\n\
        <way id='1'>\n<nd ref='1'/>\n<nd ref='2'/>\n<tag k='highway' v='primary'/>\n<tag k='name' v='Q'/>\n</way>\n</osm>\n";
    let geojson = "{\"type\":\"Feature\",\n\"properties\":{\"highway\":\"primary\",\n\"name\":\"Q\"},\n\
        \"geometry\":{\"type\":\"LineString\",\n\"coordinates\":[[9.004,47.004],\n[9.01,47.006]]}}\n";
    let overpass = "{\"elements\":[\n{\"type\":\"way\",\"id\":1,\n\"geometry\":[{\"lat\":47.004,\"lon\":9.004},\n\
        {\"lat\":47.006,\"lon\":9.01}],\n\"tags\":{\"highway\":\"primary\",\"name\":\"Q\"}}\n]}\n";
    let village = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/styles/village.ron"));
    let set = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/patches/village.ron"));
    let world = ["settlements", "--size", "300"];
    [
        ("reader.asc", grid, roads(&["--terrain", "FILE", "--settlements", &towns]), false),
        ("reader.csv", table, roads(&["--terrain", &ground, "--settlements", "FILE"]), true),
        ("reader.osm", osm.into(), real(), false),
        ("reader-in.geojson", geojson.into(), real(), false),
        ("reader.json", overpass.into(), real(), false),
        (
            "settings.ron",
            "// Q\n(\n  roads: (\n    minor: (gamma: 3),\n  ),\n)\n".into(),
            roads(&[&both[..], &["--settings", "FILE"]].concat()),
            false,
        ),
        (
            "edits.ron",
            "// Q\n(\n  settlements: [\n    Ban(at: (0, 0), radius: 9),\n  ],\n)\n".into(),
            words(&[&world[..], &["--edits", "FILE"]].concat()),
            false,
        ),
        (
            "assets/styles/village.ron",
            format!("// Q\n{}", village.expect("the style")),
            words(&[&world[..], &["--assets", "ASSETS"]].concat()),
            false,
        ),
        (
            "assets/patches/village.ron",
            format!("// Q\n{}", set.expect("the set")),
            words(&["patches", "check", "FILE"]),
            false,
        ),
    ]
    .into_iter()
    .map(|(name, content, command, may_be_cut)| Reader { name, content, command, may_be_cut })
    .collect()
}

#[test]
fn every_reader_takes_what_people_have_and_names_what_it_refuses() {
    let assets = assets();
    for reader in readers() {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(reader.name);
        let words: Vec<String> = reader
            .command
            .iter()
            .map(|w| w.replace("FILE", &path.to_string_lossy()).replace("ASSETS", &assets.to_string_lossy()))
            .collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let write = |content: &[u8]| std::fs::write(&path, content).expect("the folder can be written");
        let text = &reader.content;
        write(text.as_bytes());
        let expected = meaning(&words);
        for (what, content) in [
            (
                "a byte order mark, line ends of Windows and blanks before them",
                format!("\u{feff}{}\r\n\r\n", text.replace('\n', "  \r\n")),
            ),
            ("no line end", text.trim_end().to_owned()),
            ("letters of Unicode", text.replace('Q', "\u{6771}")),
        ] {
            write(content.as_bytes());
            let found = meaning(&words);
            if !content.contains('\u{6771}') {
                assert_eq!(found, expected, "{} with {what}", reader.name);
            }
        }
        let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect();
        let letter = if text.contains('Q') { 'Q' } else { '2' };
        let latin: Vec<u8> = text.bytes().map(|b| if b == letter as u8 { 0xe9 } else { b }).collect();
        let half = text.as_bytes()[..text.len() / 2].to_vec();
        let mut cases = vec![
            (utf16, "is UTF-16 text; save it as UTF-8"),
            (latin, "seems to be Latin-1 (Windows-1252): save it as UTF-8"),
            ([b"\x1f\x8b\x08", text.as_bytes()].concat(), "is compressed by gzip; unpack it first"),
            ([text.as_bytes(), b"\0"].concat()[..].iter().rev().copied().collect(), "is a binary file"),
            (Vec::new(), ""),
        ];
        if !reader.may_be_cut {
            cases.push((half, ""));
        }
        for (content, reason) in cases {
            write(&content);
            let line = refused(&words);
            let name = path.file_name().expect("a name").to_string_lossy();
            assert!(line.contains(&*name) && line.contains(reason), "{}: {line}", reader.name);
        }
        write(text.as_bytes());
    }
    // What editors and systems leave beside the files is no asset.
    for name in [
        "styles/.#village.ron",
        "styles/~$grid.ron",
        "patches/.common.ron.swp",
        "patches/.DS_Store",
        "styles/grid.ron~",
    ] {
        std::fs::write(assets.join(name), "(").expect("the folder can be written");
    }
    let folder = assets.to_string_lossy();
    out(&["settlements", "--size", "300", "--assets", &folder]);
    let checked = json(&["patches", "check", &folder]);
    assert_eq!(checked["errors"].as_array().map(Vec::len), Some(0), "{checked}");
}

#[test]
fn a_table_says_what_it_left_out_and_moves_towns_to_land() {
    let rows =
        "id;name;x;y;population\n1;A;2000;1000;10\n2;B;9000;3000;\n3;C;15000;1000;\"3,000\"\n;;;;\n4;A;4000;4600;5\n";
    let [grid, table] = country("table", rows);
    let drawn = file("table.geojson", "").to_string_lossy().into_owned();
    let base = ["roads", "--terrain", &grid, "--settlements", &table, "--sea-level", "-50", "-o", &drawn];
    let line = refused(&base);
    assert!(line.contains("table.csv:3:15: population of \"B\" is empty"), "{line}");
    let report = json(&[&base[..], &["--skip-bad"]].concat());
    let of = &report["table"];
    assert_eq!(of["columns_left_out"], serde_json::json!(["id"]), "{of}");
    assert_eq!((&of["empty_rows"], &of["repeated_names"]), (&Value::from(1), &Value::from(1)));
    let left_out = of["rows_left_out"].as_array().expect("a list");
    assert!(left_out.len() == 2 && left_out[1].as_str().is_some_and(|l| l.contains("table.csv:4:5: \"C\" lies under")));
    let report = json(&[&base[..], &["--skip-bad", "--snap", "9000"]].concat());
    let moved = &report["table"]["moved_to_land"][0];
    assert_eq!(moved["name"], "C", "{report}");
    assert!(moved["distance_m"].as_f64().is_some_and(|m| (100.0..3000.0).contains(&m)), "{moved}");
    let people = String::from_utf8(sprawl(&[&base[..], &["--skip-bad", "--snap", "9000"]].concat()).stdout);
    let people = people.expect("UTF-8");
    assert!(people.contains("columns left out: id") && people.contains("1 moved to land: C ("), "{people}");
}

#[test]
fn tiles_are_joined_and_masks_need_no_value_on_land() {
    let [grid, towns] = country("tiled", crate::support::TOWNS);
    let text = std::fs::read_to_string(&grid).expect("a grid");
    let rows: Vec<Vec<&str>> = text.lines().skip(5).map(|l| l.split(' ').collect()).collect();
    // Two tiles that share a column, and a mask of a river without a value on land.
    let tile = |name: &str, columns: std::ops::Range<usize>| {
        let head = format!("ncols {}\nnrows 40\nxllcorner {}\n", columns.len(), 1000 + 250 * columns.start);
        let rows = rows.iter().map(|r| r[columns.clone()].join(" ")).collect::<Vec<_>>().join("\n");
        let text = format!("{head}yllcorner -2000\ncellsize 250\n{rows}\n");
        file(name, &text).to_string_lossy().into_owned()
    };
    let (west, east) = (tile("west.asc", 0..31), tile("east.asc", 30..60));
    let drawn = file("tiled.geojson", "").to_string_lossy().into_owned();
    let roads = |terrain: &[&str], more: &[&str]| {
        let base = ["roads", "--settlements", &towns, "--sea-level", "-50", "-o", &drawn, "--terrain"];
        let report = json(&[&base[..], terrain, more].concat());
        (report, std::fs::read(&drawn).expect("a map"))
    };
    let (one, map) = roads(&[&grid], &[]);
    let (two, joined) = roads(&[&west, &east], &[]);
    assert_eq!((&one["totals"], map), (&two["totals"], joined));
    assert_eq!(two["ground"]["terrain"]["tiles"], 2);
    let mask = text.lines().take(5).map(|l| format!("{l}\n")).collect::<String>() + "NODATA_value 0\n";
    let row = (0..60).map(|x| if x == 22 { "2" } else { "0" }).collect::<Vec<_>>().join(" ");
    let mask = file("mask.asc", &format!("{mask}{}", format!("{row}\n").repeat(40))).to_string_lossy().into_owned();
    let (wet, _) = roads(&[&grid], &["--water", &mask]);
    assert_eq!(wet["ground"]["water"]["filled_cells"], 59 * 40);
    assert!(wet["totals"]["bridges"].as_u64() > Some(0), "{wet}");
    let void =
        file("void.asc", &text.replacen(&format!("\n{} ", rows[0][0]), "\n-32768 ", 1)).to_string_lossy().into_owned();
    let base = ["roads", "--settlements", &towns, "-o", &drawn, "--terrain", &void];
    assert!(
        refused(&base).contains("void.asc:6:1: row 1, column 1: this cell and 0 more of 2400 cells have no height")
    );
    assert_eq!(
        json(&[&base[..], &["--fill", "0", "--sea-level", "-50"]].concat())["ground"]["terrain"]["filled_cells"],
        1
    );
}
