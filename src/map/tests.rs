//! One little map in every format, and what readers leave out, refuse and survive.

use crate::map::fixtures::{blob, every_format, field, geojson, overpass, pbf, pbf_of, xml, xml_geom};
use crate::map::{LeftOut, Map, MapCoordinates, MapError, MapOptions, OneWay};
use crate::network::{Network, StreetClass};
use crate::space::{Bounds, Geographic};
use glam::DVec2;
use proptest::prelude::*;

fn parse(name: &str, content: impl AsRef<[u8]>) -> Result<Map, MapError> {
    Map::parse(name, content.as_ref(), &MapOptions::default())
}

fn refused(name: &str, content: impl AsRef<[u8]>) -> String {
    parse(name, content).unwrap_err().to_string()
}

/// Streets of a network as sorted lines with their class and level, and how many junctions of each degree there are.
fn shape(network: &Network) -> (Vec<String>, Vec<usize>) {
    let mut lines: Vec<String> =
        network.streets.iter().map(|s| format!("{:?} {} {} {:?}", s.class, s.level, s.bridge, s.line)).collect();
    lines.sort();
    let degree = |id| network.streets.iter().flat_map(|s| [s.from, s.to]).filter(|end| *end == id).count();
    let mut degrees: Vec<usize> = network.junctions.iter().map(|j| degree(j.id)).collect();
    degrees.sort_unstable();
    (lines, degrees)
}

#[test]
fn every_format_gives_the_same_map() {
    let expected = parse("m.osm", xml()).unwrap();
    // Node 2 joins four streets; the bridge joins the others at its ends alone.
    assert_eq!(shape(&expected.network()).1, [1, 1, 2, 2, 4]);
    assert_eq!(expected.network().streets.len(), 5);
    let street = expected.streets.iter().find(|s| s.id == 21).unwrap();
    assert_eq!((street.tags.class, street.tags.one_way), (StreetClass::Arterial, OneWay::Backward));
    assert_eq!((street.tags.name.as_deref(), street.tags.lanes), (Some("Long & Broad"), Some(2)));
    let [building] = &expected.buildings[..] else { panic!("{:?}", expected.buildings) };
    assert_eq!((building.outline.len(), building.holes.len(), building.storeys), (4, 1, Some(4)));
    let formats: [(&str, Vec<u8>); 6] = [
        ("m.osm.pbf", pbf()),
        ("m.geojson", geojson().into()),
        ("m.json", overpass(false).into()),
        ("geom.json", overpass(true).into()),
        ("geom.osm", xml_geom().into()),
        ("windows.osm", [b"\xef\xbb\xbf", xml().replace('\n', "\r\n").as_bytes()].concat()),
    ];
    for (name, content) in formats {
        let map = parse(name, content).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(shape(&map.network()), shape(&expected.network()), "{name}");
        assert_eq!((map.buildings.len(), map.report.streets), (1, 3), "{name}");
        let area = |m: &Map| crate::space::signed_area(&m.buildings[0].outline);
        assert!((area(&map) - area(&expected)).abs() < 1e-3 && map.buildings[0].holes.len() == 1, "{name}");
        assert_eq!(map.report.left_out, [(LeftOut::OtherKind, 1)].into(), "{name}");
        if !name.contains("json") || name == "m.geojson" {
            let (stated, expected) = (map.stated_bounds.unwrap(), expected.stated_bounds.unwrap());
            assert!(stated.min.distance(expected.min) + stated.max.distance(expected.max) < 1e-6, "{name}");
        }
        if name != "m.geojson" {
            assert_eq!(map.network(), expected.network(), "{name}: ids of nodes make the ids of junctions");
        }
    }
}

#[test]
fn streets_are_clipped_to_the_box_and_buildings_kept_whole() {
    let around = Geographic::around(DVec2::new(9.001, 47.0)).unwrap();
    let read = |size: f64, at: DVec2| {
        let bounds = Some(Bounds::square(at, size));
        let coordinates = MapCoordinates::DegreesAround(around);
        Map::parse("m.osm", xml().as_bytes(), &MapOptions { coordinates, bounds, ..MapOptions::default() })
    };
    let map = read(60.0, DVec2::ZERO).unwrap();
    assert!(map.nodes.iter().all(|n| n.at.abs().max_element() <= 30.0));
    assert_eq!(map.nodes.iter().filter(|n| n.id.is_none()).count(), 4);
    assert_eq!(shape(&map.network()).1, [1, 1, 1, 1, 4]);
    assert!((map.report.length_inside - 120.0).abs() < 1e-6 && map.report.share_inside() < 0.3, "{:?}", map.report);
    assert_eq!(map.report.left_out[&LeftOut::OutsideBox], 2, "the bridge and the building");
    assert_eq!(read(100.0, DVec2::ZERO).unwrap().buildings[0].outline.len(), 4);
    let error = read(100.0, DVec2::new(5_000.0, 0.0)).unwrap_err().to_string();
    assert_eq!(error, "m.osm: none of its 3 streets lies in the box that was asked for");
    assert_eq!(map.projection, Some(around));
    let node = map.nodes.iter().find(|n| n.id == Some(2)).unwrap();
    assert!(around.to_degrees(node.at).distance(DVec2::new(9.001, 47.0)) < 1e-9);
}

/// The little map in XML with one thing replaced.
fn with(from: &str, to: &str) -> String {
    assert!(xml().contains(from), "{from}");
    xml().replacen(from, to, 1)
}

#[test]
fn what_is_left_out_is_counted_by_reason() {
    let count = |name: &str, text: &str, reason: LeftOut| {
        let map = parse(name, text).unwrap_or_else(|e| panic!("{e}"));
        (map.report.left_out.get(&reason).copied().unwrap_or(0), map.report.streets, map.report.buildings)
    };
    for (from, to, reason, expected) in [
        ("way id=\"22\"", "way id=\"22\" action=\"delete\"", LeftOut::Deleted, (1, 2, 1)),
        ("way id=\"22\"", "way id=\"22\" visible=\"false\"", LeftOut::Deleted, (1, 2, 1)),
        ("relation id=\"31\"", "relation id=\"31\" action=\"delete\"", LeftOut::Deleted, (1, 3, 0)),
        ("node id=\"4\"", "node id=\"4\" action=\"delete\"", LeftOut::Deleted, (1, 2, 1)),
        ("node id=\"4\" lon=\"9.003\" lat=\"47\"", "node id=\"4\"", LeftOut::NoCoordinates, (1, 2, 1)),
        ("<nd ref=\"6\"/>", "<nd ref=\"99\"/>", LeftOut::MissingNodes, (1, 3, 1)),
        ("<nd ref=\"10\"/>", "<nd ref=\"99\"/>", LeftOut::MissingNodes, (1, 3, 0)),
        ("<nd ref=\"5\"/><nd ref=\"4\"/>", "<nd ref=\"5\"/><nd ref=\"5\"/>", LeftOut::TooFewPoints, (1, 2, 1)),
        ("<nd ref=\"10\"/>", "<nd ref=\"10\"/><nd ref=\"1\"/>", LeftOut::OpenOutline, (0, 3, 1)),
        ("<nd ref=\"9\"/><nd ref=\"10\"/>", "<nd ref=\"10\"/>", LeftOut::OpenOutline, (1, 3, 0)),
        ("v=\"residential\"", "v=\"footway\"", LeftOut::OtherClass, (1, 2, 1)),
        ("v=\"residential\"/>", "v=\"residential\"/><tag k=\"area\" v=\"yes\"/>", LeftOut::StreetArea, (1, 2, 1)),
        (
            "<nd ref=\"5\"/><nd ref=\"4\"/>",
            "<nd ref=\"6\"/><nd ref=\"2\"/><nd ref=\"5\"/>",
            LeftOut::Repeated,
            (1, 2, 1),
        ),
    ] {
        assert_eq!(count("m.osm", &with(from, to), reason), expected, "{to}");
    }
    let line = |properties: &str, coordinates: &str| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{properties},\"geometry\":{{\"type\":\"LineString\",\"coordinates\":{coordinates}}}}}"
        )
    };
    let street = line("{\"highway\":[\"residential\",\"road\"]}", "[[9,47],[9.001,47]]");
    for (feature, reason, expected) in [
        (line("{\"highway\":null,\"waterway\":\"river\"}", "[[9,47],[9,48]]"), LeftOut::OtherKind, (1, 1, 0)),
        (line("{}", "[[9,47],[9,48]]"), LeftOut::OtherKind, (1, 1, 0)),
        (line("null", "[[9,47],[9,48]]"), LeftOut::OtherKind, (1, 1, 0)),
        (line("{\"highway\":\"['path', 'track']\"}", "[[9,47],[9,48]]"), LeftOut::OtherClass, (1, 1, 0)),
        (line("{\"highway\":\"['path', 'road']\"}", "[[9,47],[9,48]]"), LeftOut::OtherClass, (0, 2, 0)),
        (line("{\"highway\":\"road\"}", "[[9.001,47],[9,47]]"), LeftOut::Repeated, (1, 1, 0)),
        (line("{\"highway\":\"road\"}", "[[9,47],[9,47]]"), LeftOut::TooFewPoints, (1, 1, 0)),
        (line("{\"building\":true}", "[[9,47],[9.1,47],[9,47.1],[9,47]]"), LeftOut::OtherKind, (0, 1, 1)),
        (line("{\"building\":true}", "[[9,47],[9.1,47],[9,47.1]]"), LeftOut::OpenOutline, (1, 1, 0)),
        (
            line("{\"building\":true}", "[[9,47],[9.2,47.2],[9.2,47],[9,47.1],[9,47]]"),
            LeftOut::CrossesItself,
            (1, 1, 0),
        ),
        (
            "{\"type\":\"Feature\",\"properties\":{\"highway\":\"road\"},\"geometry\":{\"type\":\"GeometryCollection\",\
             \"geometries\":[{\"type\":\"Point\",\"coordinates\":[1,2]},{\"type\":\"MultiLineString\",\"coordinates\":\
             [[[9,47],[9,48]],[[9,49],[9,50]]]}]}}"
                .into(),
            LeftOut::OtherGeometry,
            (0, 3, 0),
        ),
        (
            "{\"type\":\"Feature\",\"properties\":{\"highway\":\"crossing\"},\"geometry\":null}".into(),
            LeftOut::OtherGeometry,
            (1, 1, 0),
        ),
        (
            "{\"type\":\"Feature\",\"properties\":{\"highway\":\"road\"},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":\
             [[[9,47],[9.1,47],[9,47.1],[9,47]]]}}"
                .into(),
            LeftOut::StreetArea,
            (1, 1, 0),
        ),
    ] {
        let text = format!("{{\"type\":\"FeatureCollection\",\"features\":[{street},{feature}]}}");
        assert_eq!(count("m.geojson", &text, reason), expected, "{feature}");
    }
}

#[test]
fn files_that_are_no_maps_are_refused_with_line_and_reason() {
    let xml = xml();
    let cut = &xml[..xml.len() - "</osm>\n".len()];
    let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain(xml.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let feature = |points: &str| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{\"highway\":\"road\"}},\"geometry\":{{\"type\":\"LineString\",\
             \"coordinates\":{points}}}}}"
        )
    };
    for (name, content, expected) in [
        ("m.txt", vec![], "m.txt: unknown kind of map"),
        ("m.osm", cut.into(), "m.osm:24:1: no readable OSM XML: the file ends before </osm>"),
        ("m.osm", xml.replace("</way>", "").into(), "no readable OSM XML: "),
        ("m.osm", with("lon=\"9.002\"", "lon=\"x\"").into(), "m.osm:6:1: a node needs the numbers id, lon and lat"),
        ("m.osm", with("lon=\"9.002\"", "lon=\"NaN\"").into(), "m.osm:6:1: a node needs"),
        ("m.osm", with("<nd ref=\"6\"", "<nd ref=\"\"").into(), ": a way's node needs the number ref"),
        (
            "m.osm",
            with("lon=\"9.001\" lat=\"46.999\"", "lon=\"9.001\" lat=\"146.999\"").into(),
            "m.osm: 9.001,146.999 is no longitude and latitude",
        ),
        ("m.osm", "<html><body/></html>".into(), "m.osm:1:1: no readable OSM XML: the outermost element is not <osm>"),
        ("m.osm", vec![], "m.osm:1:1: no readable OSM XML: there is no <osm>"),
        ("m.osm", "<osm/>".into(), "m.osm: no street of the classes motorway,"),
        (
            "m.osm",
            with("</osm>", "<remark> runtime error: Query timed out </remark>\n</osm>").into(),
            "the query has failed: runtime error: Query timed out",
        ),
        ("m.osm", utf16, "m.osm: is UTF-16 text; save it as UTF-8"),
        ("m.osm", b"\x1f\x8b\x08".to_vec(), "m.osm: is compressed by gzip"),
        ("m.osm", xml.replace("Broad", "Stra\u{df}e").chars().map(|c| c as u8).collect(), "seems to be Latin-1"),
        ("m.geojson", "{\n\"a\":".into(), "m.geojson:2:"),
        ("m.geojson", "{\"type\":\"Topology\"}".into(), "no readable GeoJSON"),
        (
            "m.geojson",
            "{\"type\":\"LineString\",\"coordinates\":[[0,1],[2,3]]}".into(),
            "left out: 1 neither street nor building",
        ),
        ("m.geojson", feature("[[1],[2]]").into(), "no readable GeoJSON"),
        ("m.geojson", feature("[[47,109],[47,109.1]]").into(), "latitude is at most 90, and comes second"),
        ("m.geojson", feature("[[500000,5200000],[500100,5200000]]").into(), "a map in metres?"),
        (
            "m.geojson",
            geojson()
                .replacen(
                    "{",
                    "{\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"urn:ogc:def:crs:EPSG::25832\"}},",
                    1,
                )
                .into(),
            "its coordinates are in urn:ogc:def:crs:EPSG::25832",
        ),
        ("m.json", "{\"elements\":[{\"type\":\"way\"}]}".into(), "no readable answer of Overpass: missing field `id`"),
        ("m.json", "{\"elements\":[],\"remark\":\"runtime error: out of memory\"}".into(), "the query has failed"),
        ("m.pbf", vec![], "m.pbf: no readable OSM PBF: it has no header"),
        ("m.pbf", vec![7; 300], "no readable OSM PBF: byte 0: no block starts here"),
        ("m.pbf", pbf()[..pbf().len() - 1].to_vec(), "the file ends within a block; was the download broken off?"),
        ("m.pbf", blob("OSMHeader", &field(4, b"Sort.Backwards"), false), "a feature of readers that is not known"),
    ] {
        let line = refused(name, &content);
        assert!(line.contains(expected) && line.starts_with(name), "{line}\nexpected: {expected}");
    }
    let metres = MapOptions { coordinates: MapCoordinates::Metres, ..MapOptions::default() };
    for (name, content) in [("m.osm", xml.clone()), ("m.json", overpass(true))] {
        let error = Map::parse(name, content.as_bytes(), &metres).unwrap_err();
        assert_eq!(error, MapError::NeedsDegrees { file: name.into() });
    }
}

#[test]
fn a_map_in_metres_stays_where_it_is() {
    let text = "{\"type\":\"FeatureCollection\",\"features\":[\
        {\"type\":\"Feature\",\"properties\":{\"kind\":\"street\",\"class\":\"main\"},\"geometry\":\
        {\"type\":\"LineString\",\"coordinates\":[[70000,-300],[70100,-300.5]]}}]}";
    let options = MapOptions { coordinates: MapCoordinates::Metres, ..MapOptions::default() };
    let map = Map::parse("m.geojson", text.as_bytes(), &options).unwrap();
    assert_eq!(map.line(&map.streets[0]), [DVec2::new(70_000.0, -300.0), DVec2::new(70_100.0, -300.5)]);
    let network = map.network();
    assert_eq!(map.origin().to_plan(network.streets[0].line[1]), DVec2::new(70_100.0, -300.5));
    assert_eq!((network.streets[0].class, map.projection), (StreetClass::Main, None));
}

#[test]
fn roundabouts_and_loops_keep_their_junctions() {
    let node = |id: i64, x: f64, y: f64| format!("<node id=\"{id}\" lon=\"{}\" lat=\"{}\"/>", 9.0 + x, 47.0 + y);
    let ring = [(0.0, 0.0), (1e-4, 0.0), (1e-4, 1e-4), (0.0, 1e-4), (5e-4, 5e-4)];
    let nodes: String = ring.iter().zip(1..).map(|((x, y), id)| node(id, *x, *y)).collect();
    let text = format!(
        "<osm>{nodes}<way id=\"1\"><nd ref=\"1\"/><nd ref=\"2\"/><nd ref=\"3\"/><nd ref=\"4\"/><nd ref=\"1\"/>\
         <tag k=\"highway\" v=\"residential\"/><tag k=\"junction\" v=\"roundabout\"/></way>\
         <way id=\"2\"><nd ref=\"3\"/><nd ref=\"5\"/><tag k=\"highway\" v=\"residential\"/></way></osm>"
    );
    let map = parse("m.osm", text).unwrap();
    assert_eq!(map.streets[0].tags.one_way, OneWay::Forward);
    assert!(map.streets[0].tags.roundabout && !map.streets[1].tags.roundabout);
    // The ring is parted at its own end and where the street joins it.
    assert_eq!(shape(&map.network()).1, [1, 2, 3]);
}

#[test]
fn small_files_cannot_ask_for_much() {
    // Eight million empty ways in a few kilobytes.
    let ways: Vec<u8> = std::iter::repeat_n([0x1a, 0], 8 << 20).flatten().collect();
    let small = pbf_of(&field(2, &ways[..1 << 20]), true);
    assert!(small.len() < 4_096);
    assert!(refused("m.pbf", &small).contains("no street"));
    let large = pbf_of(&field(2, &[&ways[..], &ways, &ways].concat()), true);
    assert!(refused("m.pbf", &large).contains("a block unpacks to more than 32 MiB"));
    let mut options = MapOptions::default();
    options.limits.points = 8;
    let error = Map::parse("m.osm", xml().as_bytes(), &options).unwrap_err().to_string();
    assert_eq!(error, "m.osm: holds more than 8 points, the most that is read; cut a part out of it first");
    options = MapOptions::default();
    options.limits.unpacked_bytes = 99;
    assert!(Map::parse("m.pbf", &pbf(), &options).unwrap_err().to_string().contains("99 unpacked bytes"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn no_broken_file_makes_a_reader_panic(
        format in 0..6usize,
        cut in 0.0..1.0f64,
        flips in prop::collection::vec((0.0..1.0f64, any::<u8>()), 0..6),
        is_cut: bool,
    ) {
        let (name, mut content) = every_format()[format].clone();
        for (at, byte) in flips {
            let at = (at * content.len() as f64) as usize;
            content[at] = byte;
        }
        if is_cut {
            content.truncate((cut * content.len() as f64) as usize);
        }
        let bounds = Some(Bounds::square(DVec2::ZERO, 100.0));
        for options in [MapOptions::default(), MapOptions { bounds, ..MapOptions::default() }] {
            if let Ok(map) = Map::parse(name, &content, &options) {
                let network = map.network();
                prop_assert!(network.streets.iter().all(|s| s.line.len() > 1 && s.line.iter().all(|p| p.is_finite())));
                prop_assert!(map.buildings.iter().all(|b| b.outline.len() > 2));
            }
        }
    }
}
