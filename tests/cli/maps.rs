//! Real maps: as roads to compare with, and as towns to draw beside one of a world.

use crate::support::{TOWNS, city, country, file, json, out, refused, road_mask};
use serde_json::Value;

#[test]
fn a_real_town_is_drawn_beside_one_of_the_world() {
    let node = |id: usize, x: f64, y: f64| format!("<node id=\"{id}\" lon=\"{}\" lat=\"{}\"/>", 8.0 + x, 49.0 + y);
    let nodes: String = [(0.0, 0.0), (0.001, 0.0), (0.001, 0.001), (0.0, 0.001)]
        .iter()
        .enumerate()
        .map(|(i, (x, y))| node(i + 1, *x, *y))
        .collect();
    let way = |id: u32, refs: &[u32], tag: &str| {
        let refs: String = refs.iter().map(|r| format!("<nd ref=\"{r}\"/>")).collect();
        format!("<way id=\"{id}\">{refs}{tag}</way>")
    };
    let street = way(1, &[1, 2, 3], "<tag k=\"highway\" v=\"residential\"/>");
    let house = way(2, &[1, 2, 3, 4, 1], "<tag k=\"building\" v=\"yes\"/>");
    let real = file("real.osm", &format!("<osm version=\"0.6\">{nodes}{street}{house}</osm>"));
    let (real, drawn) = (real.to_string_lossy(), file("beside.svg", ""));
    let drawn = drawn.to_string_lossy();
    let map = ["map", "--seed", "5", "--at", city(), "--size", "400", "--beside", &real, "-o"];
    out(&[&map[..], &[&drawn, "--colour-by", "origin", "--pixels", "300"]].concat());
    let picture = std::fs::read_to_string(&*drawn).expect("a file");
    assert!(picture.contains("THIS WORLD") && picture.contains("A REAL TOWN"), "both are named");
    assert!(picture.contains("REPAIR") && picture.contains("BUILDING"), "colours are explained");
    assert!(refused(&[&map[..], &["town.osm"]].concat()).contains("--beside"));
    let empty = file("empty.osm", "<osm version=\"0.6\"></osm>");
    let house = |kind: &str| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"building\":\"yes\"}},\"geometry\":{{\"type\":\"{kind}\",\"coordinates\":\
             [[[8,49],[8.001,49],[8.001,49.001],[8,49]]]}}}}"
        )
    };
    let street = "{\"type\":\"Feature\",\"properties\":{\"highway\":\"residential\"},\"geometry\":\
        {\"type\":\"LineString\",\"coordinates\":[[8,49],[8.001,49]]}}";
    let features = [street, &house("Polygon"), &house("MultiLineString")].join(",");
    let town =
        file("town-with-house.geojson", &format!("{{\"type\":\"FeatureCollection\",\"features\":[{features}]}}"));
    let map = ["map", "--seed", "5", "--size", "400", "--beside", &town.to_string_lossy(), "-o", &drawn];
    let beside = json(&map)["beside"].clone();
    assert_eq!((&beside["streets"], &beside["buildings"]), (&Value::from(1), &Value::from(2)), "{beside}");
    // The map is read before the world is made, so that a wrong one is refused at once.
    let slow = ["--settings", "missing.ron"];
    let of_nothing = [&["map", "--beside", "missing.osm", "-o", &drawn][..], &slow].concat();
    assert!(refused(&of_nothing).contains("missing.osm"));
    let of_nothing = ["map", "--size", "400", "--beside", &empty.to_string_lossy(), "-o", &drawn];
    assert!(refused(&of_nothing).contains("no street"));
}

#[test]
fn a_road_mask_is_a_map_wherever_one_is_read() {
    let mask = road_mask("mask.png");
    let drawn = file("beside-mask.svg", "").to_string_lossy().into_owned();
    let map = ["map", "--seed", "5", "--size", "400", "-o", &drawn];
    let beside = json(&[&map[..], &["--beside", &mask, "--metres-per-pixel", "2"]].concat())["beside"].clone();
    assert_eq!((&beside["streets"], &beside["buildings"]), (&Value::from(4), &Value::from(1)), "{beside}");
    assert!(refused(&[&map[..], &["--beside", &mask]].concat()).contains("metres per pixel"));
    assert!(refused(&[&map[..], &["--metres-per-pixel", "2"]].concat()).contains("needs a map that is a picture"));
    let green = ["--beside", &mask, "--metres-per-pixel", "2", "--road-colour", "#00ff00"];
    assert!(refused(&[&map[..], &green].concat()).contains("no pixel has the colour of roads, #00ff00"));
    let somewhere = ["--beside", &mask, "--metres-per-pixel", "2", "--beside-at", "8,49"];
    assert!(refused(&[&map[..], &somewhere].concat()).contains("a picture has no degrees"));
    let [grid, table] = country("mask", TOWNS);
    let roads = ["roads", "--terrain", &grid, "--settlements", &table, "-o", &drawn, "--reference", &mask];
    let compared = json(&[&roads[..], &["--metres-per-pixel", "40"]].concat());
    assert!(compared["reference"].is_object(), "{compared}");
}

#[test]
fn patches_are_extracted_from_a_map_and_every_part_of_it_is_accounted_for() {
    let mask = road_mask("mask.png");
    let set = file("extracted.ron", "").to_string_lossy().into_owned();
    let sheet = file("extracted.svg", "").to_string_lossy().into_owned();
    let extract = ["patches", "extract", &mask, "--metres-per-pixel", "2", "-o", &set];
    let windows = json(&[&extract[..], &["--size", "120", "--interval", "20", "--sheet", &sheet]].concat());
    let map = &windows["maps"][0];
    assert_eq!((&map["junctions"], &map["buildings"]), (&Value::from(1), &Value::from(1)), "{windows}");
    assert!((map["km"].as_f64().expect("a number") - 0.8).abs() < 0.05 && windows["patches"].as_u64() > Some(5));
    assert!(map["left_out"]["few_streets"].as_u64() > Some(0) && map["patches"] == windows["patches"]);
    assert_eq!(json(&["patches", "check", &set])["sets"][0]["patches"], windows["patches"]);
    assert!(std::fs::read_to_string(&sheet).expect("a sheet").contains("mask"));
    let few = json(&[&extract[..], &["--size", "120", "--interval", "20", "--most", "3"]].concat());
    assert_eq!(few["patches"], 3);
    assert_eq!(json(&[&extract[..], &["--as", "pieces"]].concat())["patches"], 1);
    let long = [&extract[..], &["--least-streets", "5000"]].concat();
    assert!(
        refused(&long).contains("no patch was found; left out: ") && refused(&long).contains("with too few streets")
    );
    assert!(refused(&[&extract[..], &["--size", "9"]].concat()).contains("`size` is 9; allowed is 40 to 1000"));
    let wrong = ["patches", "extract", &mask, "--metres-per-pixel", "2", "-o", &sheet];
    assert!(refused(&wrong).contains("must end in .ron"));
}

#[test]
fn broken_maps_are_refused_with_what_was_found() {
    let way = "<way id=\"7\"><nd ref=\"1\"/><nd ref=\"8\"/><tag k=\"highway\" v=\"residential\"/></way>";
    let node = "<node id=\"1\" lat=\"49\" lon=\"8\"/>";
    let table = [
        ("cut.osm", format!("<osm version=\"0.6\">{node}{}", &way[..40]), "cut.osm:1:"),
        ("cut.osm.pbf", "\0\0\0\rOSMHeader".into(), "no readable OSM PBF"),
        ("missing.osm", format!("<osm version=\"0.6\">{node}{way}</osm>"), "left out: 1 nodes missing"),
        ("streetless.osm", format!("<osm version=\"0.6\">{node}</osm>"), "no street of the classes"),
    ];
    for (name, content, found) in table {
        let map = file(name, &content).to_string_lossy().into_owned();
        let [set, drawn] = ["broken.ron", "broken.svg"].map(|name| file(name, "").to_string_lossy().into_owned());
        for command in [&["patches", "extract", &map, "-o", &set][..], &["synth", &map, "--size", "500", "-o", &drawn]]
        {
            assert!(refused(command).contains(found), "{name}: {}", refused(command));
        }
    }
}

#[test]
fn what_is_wrong_with_a_map_is_counted_where_the_rest_is_of_use() {
    let line = |kind: &str, tag: &str, points: &str| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"{tag}\":\"residential\"}},\"geometry\":{{\"type\":\"{kind}\",\"coordinates\":{points}}}}}"
        )
    };
    let mut features: Vec<String> = (0..5)
        .flat_map(|i| [format!("[[8.00{i},49],[8.00{i},49.004]]"), format!("[[8,49.00{i}],[8.004,49.00{i}]]")])
        .map(|points| line("LineString", "highway", &points))
        .collect();
    let corners = "[[[8.0012,49.0012],[8.0016,49.0016],[8.0016,49.0012],[8.0012,49.0018],[8.0012,49.0012]]]";
    features.push(line("Polygon", "building", corners));
    let map = format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", features.join(","));
    let [map, set] = [("crossed.geojson", &*map), ("crossed.ron", "")]
        .map(|(name, content)| file(name, content).to_string_lossy().into_owned());
    let found = json(&["patches", "extract", &map, "-o", &set, "--size", "120", "--interval", "20"]);
    let found = &found["maps"][0];
    assert_eq!(
        (&found["buildings"], &found["not_read"]["crosses_itself"]),
        (&Value::from(0), &Value::from(1)),
        "{found}"
    );
    assert!(found["patches"].as_u64() > Some(5), "{found}");
}

#[test]
fn a_square_is_made_of_a_map_and_hangs_together() {
    let mask = road_mask("synth-mask.png");
    let [made, again, set] =
        ["synth.osm", "synth-again.osm", "synth.ron"].map(|name| file(name, "").to_string_lossy().into_owned());
    let synth = ["synth", &mask, "--metres-per-pixel", "4", "--size", "700", "--tile", "160", "--interval", "40"];
    let report = json(&[&synth[..], &["-o", &made]].concat());
    let counts = ["components", "mismatched_seams", "buildings"].map(|key| report[key].as_u64());
    assert_eq!(counts, [Some(1), Some(0), Some(0)], "{report}");
    assert!(report["area_km2"] == 0.49 && report["street_km"].as_f64() > Some(2.0), "{report}");
    assert!(report["junctions"].as_u64() > Some(2) && report["dead_ends"].is_u64() && report["seconds"].is_f64());
    json(&[&synth[..], &["-o", &again]].concat());
    let [made, again] = [&made, &again].map(|path| std::fs::read_to_string(path).expect("a file"));
    assert!(made == again && made.contains("highway"), "the same seed gives the same square");
    let extract = ["patches", "extract", &mask, "--metres-per-pixel", "4", "--size", "160", "-o", &set];
    json(&extract);
    let drawn = file("synth.svg", "").to_string_lossy().into_owned();
    assert_eq!(json(&["synth", &set, "--size", "500", "-o", &drawn])["components"], 1);
    assert!(refused(&["synth", &set, "--size", "500", "--tile", "90", "-o", &drawn]).contains("--tile"));
    json(&[&extract[..], &["--as", "pieces", "--least-streets", "50"]].concat());
    let pieces = refused(&["synth", &set, "--size", "500", "-o", &drawn]);
    assert!(pieces.contains("no window of a map"), "{pieces}");
    let large = refused(&["synth", &mask, "--metres-per-pixel", "4", "--size", "500", "--tile", "900", "-o", &drawn]);
    assert!(large.contains("no window of a map") && large.contains("left out: synth-mask"), "{large}");
}

/// What two clipped squares side by side have on the side that they share, west of it and east of it: `(x, y)` in millimetres.
fn shared_side(name: &str, of: impl Fn(&str, &str) -> Vec<(i64, i64)>) -> [Vec<(i64, i64)>; 2] {
    let (x, y) = city().split_once(',').expect("x,y");
    let (x, y): (f64, f64) = (x.parse().expect("metres"), y.parse().expect("metres"));
    [("west", x - 200.0), ("east", x + 200.0)].map(|(side, x)| {
        let path = file(&format!("{side}-{name}"), "").to_string_lossy().into_owned();
        let origin = city();
        let mut map =
            vec!["map".to_owned(), "--seed=5".into(), format!("--at={x},{y}"), "--size=400".into(), "--clip".into()];
        if name.ends_with(".osm") {
            map.push(format!("--origin={origin}"));
        }
        map.extend(["-o".into(), path.clone()]);
        json(&map.iter().map(String::as_str).collect::<Vec<_>>());
        let mut found = of(&std::fs::read_to_string(&path).expect("a map"), origin);
        found.sort_unstable();
        found.dedup();
        found
    })
}

#[test]
fn clipped_squares_side_by_side_fit_together() {
    let millimetres = |x: f64, y: f64| ((x * 1e3).round() as i64, (y * 1e3).round() as i64);
    let middle = |origin: &str| origin.split_once(',').and_then(|(x, _)| x.parse::<f64>().ok()).expect("metres");
    let sides = shared_side("half.geojson", |text, origin| {
        let map: Value = serde_json::from_str(text).expect("GeoJSON");
        let features = map["features"].as_array().expect("features");
        let junctions = features.iter().filter(|f| f["properties"]["kind"] == "junction");
        let at = |f: &Value| {
            f["geometry"]["coordinates"].as_array().expect("a point").iter().filter_map(Value::as_f64).collect()
        };
        let places = junctions.map(at).filter(|p: &Vec<f64>| (p[0] - middle(origin)).abs() < 0.01);
        places.map(|p| millimetres(p[0], p[1])).collect()
    });
    assert!(sides[0].len() > 2, "streets cross the side");
    assert_eq!(sides[0], sides[1]);
    let sides = shared_side("half.osm", |text, _| {
        let value = |node: &str, key: &str| {
            let rest = node.split_once(key).expect("an attribute").1;
            rest[1..]
                .split(rest.chars().next().expect("a quote"))
                .next()
                .and_then(|n| n.parse::<f64>().ok())
                .expect("degrees")
        };
        let nodes = text.split("<node ").skip(1);
        let places = nodes.map(|n| (value(n, "lon=") * 111_319.5, value(n, "lat=") * 111_319.5));
        places.filter(|(x, _)| x.abs() < 0.01).map(|(_, y)| millimetres(0.0, y)).collect()
    });
    assert!(sides[0].len() > 2, "streets cross the side");
    assert_eq!(sides[0], sides[1]);
}

#[test]
fn roads_are_compared_with_real_ones() {
    let [grid, towns] = country("real", TOWNS);
    // A road from town to town, one of a class that is not wanted, and one beyond the domain.
    let line = |highway: &str, points: &str| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"highway\":\"{highway}\"}},\"geometry\":\
             {{\"type\":\"LineString\",\"coordinates\":[{points}]}}}}"
        )
    };
    let all = [
        line("primary_link", "[2500,1000],[7000,2200]"),
        line("track", "[13000,0],[13000,9]"),
        line("trunk", "[7000,2200],[99000,2200]"),
    ];
    let text = format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", all.join(","));
    let real = file("real.geojson", &text).to_string_lossy().into_owned();
    let out = file("real.png", "").to_string_lossy().into_owned();
    let base = ["roads", "--terrain", &grid, "--settlements", &towns, "--reference", &real, "-o", &out];
    let of = |more: &[&str]| json(&[&base[..], more].concat())["reference"].clone();
    let report = of(&["--pixels", "200"]);
    let metres = |v: &Value| v.as_f64().expect("metres");
    // 4,657 m to Mid Lee, and on to the border at 16,000 m.
    assert!((metres(&report["real_to_ours"]["length_m"]) - 13_657.0).abs() < 60.0, "{report}");
    assert!(metres(&report["ours"]["mean_m"]) > 300.0 && metres(&report["straight"]["share_within_500_m"]) < 1.0);
    assert_eq!(
        (&report["streets"], &report["left_out"]["other_class"]),
        (&Value::from(2), &Value::from(1)),
        "{report}"
    );
    let share = metres(&report["share_inside"]);
    assert!((share - 13_657.0 / 96_657.0).abs() < 0.002, "{report}");
    let other = of(&["--reference-classes", "primary", "--compare", "--pixels", "200"]);
    assert!((metres(&other["real_to_straight"]["length_m"]) - 4_657.0).abs() < 60.0, "{other}");
    let picture = std::fs::read(&out).expect("a picture");
    let size: Vec<u32> = picture[16..24].chunks(4).map(|b| b.iter().fold(0, |n, b| n << 8 | u32::from(*b))).collect();
    assert_eq!(size, [400, 133]);
    let base = ["roads", "--terrain", &grid, "--settlements", &towns, "-o", &out, "--reference"];
    for (name, content, expected) in [
        ("real.osm", "<osm/>", "OpenStreetMap has degrees"),
        ("real.txt", "", "must end in .osm .osm.pbf .geojson"),
        (
            "empty.geojson",
            "{\"type\":\"FeatureCollection\",\"features\":[]}",
            "no street of the classes motorway,trunk,",
        ),
        ("broken.geojson", "{", "broken.geojson:1:1: no readable GeoJSON"),
        ("elsewhere.geojson", &line("trunk", "[90000,0],[99000,0]"), "none of its 1 roads lies in the domain"),
        ("far.geojson", &line("trunk", "[0,0],[1e300,0]"), "far.geojson: a place at 1"),
    ] {
        let path = file(name, content).to_string_lossy().into_owned();
        let line = refused(&[&base[..], &[&path]].concat());
        assert!(line.contains(expected), "{line}");
    }
}

#[test]
fn real_roads_come_as_people_have_them() {
    let height = |x: i32, y: i32| (100 + (x * 7 + y * 3) % 19).to_string();
    let rows: Vec<String> = (0..20).map(|y| (0..20).map(|x| height(x, y)).collect::<Vec<_>>().join(" ")).collect();
    let head = "ncols 20\nnrows 20\nxllcorner 9.0\nyllcorner 47.0\ncellsize 0.002\n";
    let path = |name: &str, content: &str| file(name, content).to_string_lossy().into_owned();
    let grid = path("degrees.asc", &format!("{head}{}\n", rows.join("\n")));
    let towns = path("degrees.csv", "name,lon,lat,sigma\nA,9.006,47.006,0\nB,9.034,47.03,0\n");
    let out = path("degrees.svg", "");
    let base = ["roads", "--geographic", "--terrain", &grid, "--settlements", &towns, "-o", &out, "--reference"];
    let nodes = "<node id='1' lat='47.004' lon='9.004'/><node id='2' lat='47.006' lon='9.010'/>\
        <node id='3' lat='47.03' lon='9.036'/>";
    let way = |with: &str, nodes: &str| {
        format!("<way id='1{}' {with}>{nodes}<tag k='highway' v='primary'/></way>", with.len())
    };
    let alive = way("", "<nd ref='1'/><nd ref='2'/>");
    let osm = |body: &str| format!("<osm version='0.6'>{body}</osm>");
    let deleted = way("action='delete'", "<nd ref='2'/><nd ref='3'/>");
    let invisible = way("visible='false'", "<nd ref='2'/><nd ref='3'/>");
    let geom = way("", "<nd ref='1' lat='47.004' lon='9.004'/><nd ref='2' lat='47.006' lon='9.01'/>");
    let line = "{\"type\":\"Feature\",\"properties\":{\"highway\":\"primary\"},\"geometry\":{\"type\":\"LineString\",\
        \"coordinates\":[[9.004,47.004],[9.01,47.006]]}}";
    let river =
        line.replace("\"highway\":\"primary\"", "\"highway\":null,\"waterway\":\"river\"").replace("9.01,", "9.03,");
    let json_of = |features: &str| format!("{{\"type\":\"FeatureCollection\",\"features\":[{features}]}}");
    for (name, content) in [
        ("alive.osm", osm(&format!("{nodes}{alive}"))),
        ("deleted.osm", osm(&format!("{nodes}{alive}{deleted}{invisible}"))),
        ("geom.osm", osm(&geom)),
        ("mark.geojson", format!("\u{feff}{}", json_of(line))),
        ("river.geojson", json_of(&format!("{line},{river}"))),
    ] {
        let report = json(&[&base[..], &[&path(name, &content)]].concat());
        let length = report["reference"]["real_to_ours"]["length_m"].as_f64().expect("metres");
        assert!((length - 507.0).abs() < 1.0, "{name}: {report}");
        assert_eq!(report["reference"]["share_inside"].as_f64(), Some(1.0), "{name}");
        assert!(report["projection"]["middle"][0].as_f64().is_some_and(|x| (x - 9.02).abs() < 0.01), "{report}");
    }
    // What is written lies where the data lies.
    for name in ["degrees-out.geojson", "degrees-out.osm"] {
        let written = path(name, "");
        let report = json(&["roads", "--geographic", "--terrain", &grid, "--settlements", &towns, "-o", &written]);
        let scale: Vec<f64> = report["projection"]["metres_per_degree"]
            .as_array()
            .expect("two")
            .iter()
            .filter_map(Value::as_f64)
            .collect();
        let text = std::fs::read_to_string(&written).expect("a map");
        let middle = "9.02";
        assert!(text.contains(middle) && scale.len() == 2 && !text.contains("\"-1520"), "{name}");
        let again = json(&[&base[..], &[&written, "--reference-classes", "primary,secondary,tertiary,minor"]].concat());
        let far = again["reference"]["real_to_ours"]["mean_m"].as_f64();
        assert!(far.is_some_and(|m| m < 5.0), "{name}: {again}");
    }
    let cut = osm(&format!("{nodes}{alive}")).replace("</osm>", "");
    let swapped = json_of(&line.replace("[9.004,47.004],[9.01,47.006]", "[47.004,9.004],[47.03,9.036]"));
    for (name, content, expected) in [
        ("cut.osm", cut, "the file ends before </osm>"),
        ("swapped.geojson", swapped, "lies in the domain; some would with longitude and latitude swapped"),
        ("rivers.geojson", json_of(&river), "left out: 1 neither street nor building"),
        ("far.geojson", json_of(&line.replace("9.01,", "1e10,")), "no longitude and latitude"),
    ] {
        let line = refused(&[&base[..], &[&path(name, &content)]].concat());
        assert!(line.contains(expected), "{line}");
    }
    let endless = path("endless.osm", "");
    #[cfg(unix)]
    if std::os::unix::fs::symlink("/dev/zero", &endless).is_ok() {
        let line = refused(&[&base[..], &[&endless]].concat());
        std::fs::remove_file(&endless).expect("a link");
        assert!(line.contains("larger than 1 MiB"), "{line}");
    }
}
