//! Real roads to compare with: lines of an OpenStreetMap file (`.osm`, `.osm.pbf`) or of a GeoJSON file.

use crate::fail::Fail;
use bevy_sprawl::export::RoadLine;
use bevy_sprawl::layer::FileError;
use bevy_sprawl::network::StreetClass;
use bevy_sprawl::space::Geographic;
use geojson::{Feature, GeoJson, GeometryValue, Position};
use glam::DVec2;
use osmpbf::{Element, ElementReader};
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;
use std::path::Path;

/// The value of a tag.
type Tag<'a> = &'a dyn Fn(&str) -> Option<String>;

/// Which roads of a file are wanted.
#[derive(Clone, Copy)]
struct Wanted<'a> {
    classes: &'a [String],
    /// As streets of a town: classes are those of towns.
    streets: bool,
    /// Outlines of buildings instead.
    buildings: bool,
}

impl<'a> Wanted<'a> {
    fn roads(classes: &'a [String]) -> Self {
        Self { classes, streets: false, buildings: false }
    }
}

impl Wanted<'_> {
    /// The road that a line with some tags is, if it is wanted.
    fn road(&self, tag: Tag<'_>, line: Vec<DVec2>) -> Option<RoadLine> {
        if self.buildings {
            let building = tag("building").is_some_and(|b| b != "no") && line.len() > 1;
            return building.then_some(RoadLine { class: StreetClass::Local, bridge: false, tunnel: false, line });
        }
        let highway = tag("highway")?;
        let class = highway.strip_suffix("_link").unwrap_or(&highway);
        if line.len() < 2 || !self.classes.iter().any(|c| c == class) {
            return None;
        }
        let is = |key: &str| tag(key).is_some_and(|v| v != "no");
        let class = match class {
            "primary" | "secondary" if self.streets => StreetClass::Arterial,
            "tertiary" if self.streets => StreetClass::Main,
            "motorway" | "trunk" => StreetClass::Highway,
            _ if self.streets => StreetClass::Local,
            "primary" | "secondary" => StreetClass::Major,
            _ => StreetClass::Minor,
        };
        Some(RoadLine { class, bridge: is("bridge"), tunnel: is("tunnel"), line })
    }
}

/// Reads the roads of some classes (values of the tag `highway`) from a file; `geographic` makes plan metres of degrees. A
/// GeoJSON file without it is in plan metres. Fails on a file without any such road.
pub fn read(path: &Path, classes: &[String], geographic: Option<&Geographic>) -> Result<Vec<RoadLine>, Fail> {
    let wanted = Wanted::roads(classes);
    let name = path.to_string_lossy().to_ascii_lowercase();
    let is_osm = name.ends_with(".osm") || name.ends_with(".pbf");
    if is_osm && geographic.is_none() {
        return Err(Fail::file(
            path,
            "OpenStreetMap has degrees; the ground must be in degrees too, with --geographic",
        ));
    }
    let mut roads = lines(path, &wanted)?;
    if roads.is_empty() {
        return Err(Fail::file(path, format!("no road of the classes {}", classes.join(","))));
    }
    for p in roads.iter_mut().flat_map(|r| &mut r.line) {
        if let Some(g) = geographic {
            if p.x.abs() > 360.0 || p.y.abs() > 90.0 || !p.is_finite() {
                return Err(Fail::file(path, format!("a road has a point at {},{}, which are no degrees", p.x, p.y)));
            }
            *p = g.to_plan(*p);
        } else if p.abs().max_element() > 1e10 || !p.is_finite() {
            return Err(Fail::file(path, format!("a road has a point at {},{}, too far out", p.x, p.y)));
        }
    }
    Ok(roads)
}

/// The wanted lines of a file, as it has them.
fn lines(path: &Path, wanted: &Wanted<'_>) -> Result<Vec<RoadLine>, Fail> {
    let name = path.to_string_lossy().to_ascii_lowercase();
    let content = || std::fs::read(path).map_err(|e| Fail::file(path, e));
    if name.ends_with(".pbf") {
        pbf(path, &content()?, wanted)
    } else if name.ends_with(".osm") {
        xml(path, &content()?, wanted)
    } else if name.ends_with(".geojson") || name.ends_with(".json") {
        json(path, &content()?, wanted)
    } else {
        Err(Fail::file(path, "unknown kind of file; the name must end in .osm .osm.pbf .geojson"))
    }
}

/// Ways that are streets of towns.
const STREETS: [&str; 10] = [
    "motorway",
    "trunk",
    "primary",
    "secondary",
    "tertiary",
    "unclassified",
    "residential",
    "living_street",
    "pedestrian",
    "road",
];

/// The streets of a real town and the outlines of its buildings, in metres around a place in degrees, or else where half of
/// the points of the file's streets lie on either side. Fails on a file without a street.
pub fn town(path: &Path, around: Option<DVec2>) -> Result<[Vec<RoadLine>; 2], Fail> {
    let classes = STREETS.map(String::from);
    let wanted = Wanted { classes: &classes, streets: true, buildings: false };
    let mut both = [lines(path, &wanted)?, lines(path, &Wanted { buildings: true, ..wanted })?];
    if both[0].is_empty() {
        return Err(Fail::file(path, "no street"));
    }
    // Some ways of an extract reach far out of it; half of their points lie on either side of the middle.
    let middle = |of: fn(&DVec2) -> f64| {
        let mut all: Vec<f64> = both[0].iter().flat_map(|r| &r.line).map(of).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let middle = DVec2::new(middle(|p| p.x), middle(|p| p.y));
    let geographic = Some(around.unwrap_or(middle)).filter(|p| p.is_finite()).and_then(Geographic::around);
    let geographic = geographic.ok_or_else(|| Fail::file(path, "its middle is no place in degrees"))?;
    both.iter_mut().flatten().flat_map(|r| &mut r.line).for_each(|p| *p = geographic.to_plan(*p));
    Ok(both)
}

/// Ways by their nodes: points that are missing, as where an extract was cut, part a way.
fn along(nodes: &BTreeMap<i64, DVec2>, refs: &[i64]) -> Vec<Vec<DVec2>> {
    let known: Vec<Option<DVec2>> = refs.iter().map(|id| nodes.get(id).copied()).collect();
    known.split(Option::is_none).map(|part| part.iter().copied().flatten().collect()).collect()
}

fn pbf(path: &Path, content: &[u8], wanted: &Wanted<'_>) -> Result<Vec<RoadLine>, Fail> {
    let (mut nodes, mut ways) = (BTreeMap::new(), Vec::new());
    let failed = |e: osmpbf::Error| Fail::file(path, format!("no readable OSM PBF: {e}"));
    ElementReader::new(content)
        .for_each(|element| match element {
            Element::Node(n) => drop(nodes.insert(n.id(), DVec2::new(n.lon(), n.lat()))),
            Element::DenseNode(n) => drop(nodes.insert(n.id(), DVec2::new(n.lon(), n.lat()))),
            Element::Way(way) => {
                let tags: BTreeMap<&str, &str> = way.tags().collect();
                let tag = |key: &str| tags.get(key).map(|v| (*v).to_owned());
                // Two points that are not yet known: what counts is the class.
                if let Some(road) = wanted.road(&tag, vec![DVec2::ZERO; 2]) {
                    ways.push((road, way.refs().collect::<Vec<i64>>()));
                }
            }
            Element::Relation(_) => {}
        })
        .map_err(failed)?;
    Ok(placed(&nodes, ways))
}

fn placed(nodes: &BTreeMap<i64, DVec2>, ways: Vec<(RoadLine, Vec<i64>)>) -> Vec<RoadLine> {
    let parts = ways
        .into_iter()
        .flat_map(|(road, refs)| along(nodes, &refs).into_iter().map(move |line| RoadLine { line, ..road.clone() }));
    parts.filter(|r| r.line.len() > 1).collect()
}

fn xml(path: &Path, content: &[u8], wanted: &Wanted<'_>) -> Result<Vec<RoadLine>, Fail> {
    let name = path.to_string_lossy();
    let text = std::str::from_utf8(content)
        .map_err(|e| FileError::at(&*name, content, e.valid_up_to(), "not UTF-8; allowed is text in UTF-8"))?;
    let mut reader = quick_xml::Reader::from_str(text);
    let (mut nodes, mut ways) = (BTreeMap::new(), Vec::new());
    let (mut tags, mut refs): (BTreeMap<String, String>, Vec<i64>) = Default::default();
    loop {
        let at = reader.buffer_position() as usize;
        let wrong = |reason: &str| FileError::at(&*name, content, at, reason);
        let event = reader.read_event().map_err(|e| wrong(&format!("no readable OSM XML: {e}")))?;
        match &event {
            Event::Eof => break,
            Event::Start(e) | Event::Empty(e) => {
                let number = |key: &str| attribute(e, key).and_then(|v| v.parse::<f64>().ok());
                let id = |key: &str| attribute(e, key).and_then(|v| v.parse::<i64>().ok());
                match e.name().as_ref() {
                    "node" => {
                        let (Some(id), Some(lon), Some(lat)) = (id("id"), number("lon"), number("lat")) else {
                            return Err(wrong("a node needs the numbers id, lon and lat").into());
                        };
                        nodes.insert(id, DVec2::new(lon, lat));
                    }
                    "way" => (tags, refs) = Default::default(),
                    "nd" => refs.push(id("ref").ok_or_else(|| wrong("a way's node needs the number ref"))?),
                    "tag" => drop(attribute(e, "k").and_then(|k| tags.insert(k, attribute(e, "v")?))),
                    _ => {}
                }
            }
            Event::End(e) if e.name().as_ref() == "way" => {
                if let Some(road) = wanted.road(&|key| tags.get(key).cloned(), vec![DVec2::ZERO; 2]) {
                    ways.push((road, std::mem::take(&mut refs)));
                }
            }
            _ => {}
        }
    }
    Ok(placed(&nodes, ways))
}

fn attribute(element: &BytesStart<'_>, key: &str) -> Option<String> {
    let attribute = element.attributes().flatten().find(|a| a.key.as_ref() == key)?;
    Some(attribute.normalized_value(XmlVersion::Implicit1_0).ok()?.into_owned())
}

/// Lines of features with the property `highway`; those without it are taken for roads of the least class.
fn json(path: &Path, content: &[u8], wanted: &Wanted<'_>) -> Result<Vec<RoadLine>, Fail> {
    let failed = |e: &dyn std::fmt::Display| Fail::file(path, format!("no readable GeoJSON: {e}"));
    let text = std::str::from_utf8(content).map_err(|e| failed(&e))?;
    let features = match text.parse::<GeoJson>().map_err(|e| failed(&e))? {
        GeoJson::FeatureCollection(all) => all.features,
        GeoJson::Feature(one) => vec![one],
        GeoJson::Geometry(one) => vec![Feature { geometry: Some(one), ..Feature::default() }],
    };
    let mut roads = Vec::new();
    for feature in &features {
        let tag = |key: &str| {
            let value = feature.property(key).filter(|v| !v.is_null() && v.as_bool() != Some(false))?;
            Some(value.as_str().map_or_else(|| value.to_string(), str::to_owned))
        };
        let lines: Vec<&Vec<Position>> = match feature.geometry.as_ref().map(|g| &g.value) {
            Some(GeometryValue::LineString { coordinates }) => vec![coordinates],
            Some(GeometryValue::MultiLineString { coordinates }) => coordinates.iter().collect(),
            _ => continue,
        };
        for line in lines {
            let points: Option<Vec<DVec2>> =
                line.iter().map(|p| Some(DVec2::new(*p.as_slice().first()?, *p.as_slice().get(1)?))).collect();
            let points = points.ok_or_else(|| failed(&"a point has less than two coordinates"))?;
            let is_tagged = tag("highway").is_some();
            let plain = |key: &str| if key == "highway" { wanted.classes.last().cloned() } else { tag(key) };
            roads.extend(wanted.road(if is_tagged { &tag } else { &plain }, points));
        }
    }
    Ok(roads)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wanted() -> Vec<String> {
        ["primary", "tertiary"].map(String::from).to_vec()
    }

    /// Nodes 1 to 4 at 1.0 to 1.3 degrees east, 42.5 north; a way of 1, 2, 9 (nowhere), 3, 4.
    const XML: &str = "<?xml version='1.0'?>\n<osm version=\"0.6\">\n <node id='1' lon='1.0' lat='42.5'/>\n \
        <node id='2' lon='1.1' lat='42.5'><tag k='highway' v='crossing'/></node>\n <node id='3' lon='1.2' lat='42.5'/>\n \
        <node id='4' lon='1.3' lat='42.5'/>\n <way id='7'>\n  <nd ref='1'/><nd ref='2'/><nd ref='9'/><nd ref='3'/><nd ref='4'/>\n  \
        <tag k='highway' v='primary_link'/><tag k='bridge' v='yes'/><tag k='tunnel' v='no'/>\n </way>\n <way id='8'>\n  \
        <nd ref='1'/><nd ref='4'/><tag k='highway' v='track'/>\n </way>\n</osm>\n";

    fn expected() -> Vec<RoadLine> {
        let road = |x: [f64; 2]| RoadLine {
            class: StreetClass::Major,
            bridge: true,
            tunnel: false,
            line: x.map(|x| DVec2::new(x, 42.5)).to_vec(),
        };
        vec![road([1.0, 1.1]), road([1.2, 1.3])]
    }

    #[test]
    fn ways_of_an_osm_file_are_read_and_parted_where_nodes_are_missing() {
        let classes = wanted();
        let read = |text: &str| xml(Path::new("r.osm"), text.as_bytes(), &Wanted::roads(&classes));
        assert_eq!(read(XML).unwrap(), expected());
        let Err(Fail::Input(line)) = read(&XML.replacen("lon='1.2'", "lon='x'", 1)) else { panic!() };
        assert_eq!(line, "r.osm:5:2: a node needs the numbers id, lon and lat");
        assert!(read("<osm><way></osm>").is_err());
    }

    /// A field of a protocol buffer: a number or bytes.
    fn field(number: u64, bytes: &[u8]) -> Vec<u8> {
        [varint(number << 3 | 2), varint(bytes.len() as u64), bytes.to_vec()].concat()
    }

    fn varint(mut value: u64) -> Vec<u8> {
        let mut out = Vec::new();
        while value > 127 {
            out.push(value as u8 | 128);
            value >>= 7;
        }
        out.push(value as u8);
        out
    }

    /// Differences of numbers, signs last.
    fn deltas(numbers: &[i64]) -> Vec<u8> {
        let differences = numbers.iter().zip([0].iter().chain(numbers)).map(|(n, before)| n - before);
        differences.flat_map(|d| varint((d << 1 ^ d >> 63) as u64)).collect()
    }

    fn blob(kind: &str, content: &[u8]) -> Vec<u8> {
        let blob = field(1, content);
        let head = [field(1, kind.as_bytes()), varint(3 << 3), varint(blob.len() as u64)].concat();
        [&(head.len() as u32).to_be_bytes()[..], &head, &blob].concat()
    }

    #[test]
    fn a_binary_file_holds_the_same() {
        let words = ["", "highway", "primary_link", "bridge", "yes", "track"];
        let table: Vec<u8> = words.iter().flat_map(|w| field(1, w.as_bytes())).collect();
        let lons = [1.0, 1.1, 1.2, 1.3].map(|x| (x * 1e7) as i64);
        let nodes = [field(1, &deltas(&[1, 2, 3, 4])), field(8, &deltas(&[425_000_000; 4])), field(9, &deltas(&lons))];
        let way = |id: u64, keys: &[u8], values: &[u8], refs: &[i64]| {
            let parts = [varint(1 << 3), varint(id), field(2, keys), field(3, values), field(8, &deltas(refs))];
            field(3, &parts.concat())
        };
        let ways = [way(7, &[1, 3], &[2, 4], &[1, 2, 9, 3, 4]), way(8, &[1], &[5], &[1, 4])].concat();
        let group = [field(2, &nodes.concat()), ways].concat();
        let data = [field(1, &table), field(2, &group)].concat();
        let file = [blob("OSMHeader", &field(4, b"OsmSchema-V0.6")), blob("OSMData", &data)].concat();
        let classes = wanted();
        let read = |content: &[u8]| pbf(Path::new("r.osm.pbf"), content, &Wanted::roads(&classes));
        let found = read(&file).unwrap();
        for (road, expected) in found.iter().zip(expected()) {
            assert_eq!((road.class, road.bridge), (expected.class, true));
            assert!(road.line.iter().zip(&expected.line).all(|(a, b)| a.distance(*b) < 1e-9), "{road:?}");
        }
        assert_eq!(found.len(), 2);
        for cut in [9, 20, file.len() - 1] {
            assert!(read(&file[..cut]).is_err(), "{cut}");
        }
        assert!(read(&[7; 300]).is_err());
    }

    #[test]
    fn lines_of_geojson_with_and_without_a_class() {
        let classes = wanted();
        let read = |text: &str| json(Path::new("r.geojson"), text.as_bytes(), &Wanted::roads(&classes));
        let lines = "{\"type\":\"MultiLineString\",\"coordinates\":[[[0,1],[2,3]],[[4,5,6],[7,8,9]],[[1,1]]]}";
        let bare = read(lines).unwrap();
        assert_eq!(
            bare.iter().map(|r| (r.class, r.line[0].y)).collect::<Vec<_>>(),
            [(StreetClass::Minor, 1.0), (StreetClass::Minor, 5.0)]
        );
        let of = |class: &str| {
            let tags = format!("{{\"highway\":\"{class}\",\"tunnel\":true,\"bridge\":null}}");
            read(&format!("{{\"type\":\"Feature\",\"properties\":{tags},\"geometry\":{lines}}}")).unwrap()
        };
        assert!(of("primary").iter().all(|r| r.class == StreetClass::Major && r.tunnel && !r.bridge));
        assert_eq!((of("primary").len(), of("path").len()), (2, 0));
        assert!(read("{").is_err() && read("{\"type\":\"LineString\",\"coordinates\":[[1]]}").is_err());
    }
}
