//! One little map, written in every format.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// Longitude and latitude in degrees of the nodes 1 to 12: a street of four nodes that crosses another at node 2, a bridge
/// from 3 across the first without a shared node, a house, and a courtyard house of two ways with its court.
const NODES: [[f64; 2]; 12] = [
    [9.000, 47.000],
    [9.001, 47.000],
    [9.002, 47.000],
    [9.003, 47.000],
    [9.001, 47.001],
    [9.001, 46.999],
    [9.0011, 47.0004],
    [9.0014, 47.0004],
    [9.0014, 47.0007],
    [9.0011, 47.0007],
    [9.0012, 47.0005],
    [9.0013, 47.0006],
];

/// Ways by their ids: nodes, and tags `key=value,key=value`.
const WAYS: [(i64, &[i64], &str); 7] = [
    (21, &[1, 2, 3, 4], "highway=primary,name=Long & Broad,lanes=2,oneway=-1"),
    (22, &[5, 2, 6], "highway=residential"),
    (23, &[5, 4], "highway=tertiary_link,bridge=yes"),
    (24, &[1, 5], "waterway=river"),
    (25, &[7, 8, 9], ""),
    (26, &[9, 10, 7], ""),
    (27, &[8, 11, 12, 8], ""),
];

const OUTLINE: (&[(i64, &str)], &str) =
    (&[(25, "outer"), (26, "outer"), (27, "inner")], "type=multipolygon,building=yes,building:levels=4");

fn tags(list: &str) -> Vec<(&str, &str)> {
    list.split(',').filter_map(|t| t.split_once('=')).collect()
}

pub(super) fn xml() -> String {
    let escape = |v: &str| v.replace('&', "&amp;");
    let tags = |list: &str| -> String {
        tags(list).iter().map(|(k, v)| format!("<tag k=\"{k}\" v=\"{}\"/>", escape(v))).collect()
    };
    let node = |(i, [x, y]): (usize, &[f64; 2])| format!("<node id=\"{}\" lon=\"{x}\" lat=\"{y}\"/>\n", i + 1);
    let nodes: String = NODES.iter().enumerate().map(node).collect();
    let way = |(id, nodes, list): &(i64, &[i64], &str)| {
        let nodes: String = nodes.iter().map(|n| format!("<nd ref=\"{n}\"/>")).collect();
        format!("<way id=\"{id}\">{nodes}{}</way>\n", tags(list))
    };
    let ways: String = WAYS.iter().map(way).collect();
    let member = |(id, role): &(i64, &str)| format!("<member type=\"way\" ref=\"{id}\" role=\"{role}\"/>");
    let members: String = OUTLINE.0.iter().map(member).collect();
    let bounds = "<bounds minlat=\"46.999\" minlon=\"9\" maxlat=\"47.001\" maxlon=\"9.003\"/>\n";
    let relation = format!("<relation id=\"31\">{members}{}</relation>\n", tags(OUTLINE.1));
    format!("<?xml version='1.0'?>\n<osm version=\"0.6\">\n{bounds}{nodes}{ways}{relation}</osm>\n")
}

/// A field of bytes of a protocol buffer.
pub(super) fn field(number: u64, bytes: &[u8]) -> Vec<u8> {
    [varint(number << 3 | 2), varint(bytes.len() as u64), bytes.to_vec()].concat()
}

/// A field with a number of a protocol buffer.
fn number(number: u64, value: u64) -> Vec<u8> {
    [varint(number << 3), varint(value)].concat()
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

/// Differences of numbers, each with its sign as the last bit.
fn differences(numbers: &[i64]) -> Vec<u8> {
    let pairs = numbers.iter().zip([0].iter().chain(numbers));
    pairs.map(|(n, before)| n - before).flat_map(|d| varint((d << 1 ^ d >> 63) as u64)).collect()
}

fn packed(numbers: impl IntoIterator<Item = u64>) -> Vec<u8> {
    numbers.into_iter().flat_map(varint).collect()
}

/// A blob of a PBF file: compressed, or as it is.
pub(super) fn blob(kind: &str, content: &[u8], compressed: bool) -> Vec<u8> {
    let blob = if compressed {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(content).unwrap();
        field(3, &encoder.finish().unwrap())
    } else {
        field(1, content)
    };
    let head = [field(1, kind.as_bytes()), number(3, blob.len() as u64)].concat();
    [&(head.len() as u32).to_be_bytes()[..], &head, &blob].concat()
}

pub(super) fn pbf_of(data: &[u8], compressed: bool) -> Vec<u8> {
    let box_of = [9_000_000_000, 9_003_000_000, 47_001_000_000, 46_999_000_000i64];
    let corners: Vec<u8> = (1..).zip(box_of).flat_map(|(n, v)| number(n, (v << 1) as u64)).collect();
    let header = [field(1, &corners), field(4, b"OsmSchema-V0.6"), field(4, b"DenseNodes")].concat();
    [blob("OSMHeader", &header, false), blob("OSMData", data, compressed)].concat()
}

pub(super) fn pbf() -> Vec<u8> {
    let mut words = vec![""];
    let mut word = |w: &'static str| {
        let found = words.iter().position(|known| *known == w).unwrap_or_else(|| {
            words.push(w);
            words.len() - 1
        });
        found as u64
    };
    let coordinates = |axis: usize| differences(&NODES.map(|n| (n[axis] * 1e7).round() as i64));
    let ids: Vec<i64> = (1..=NODES.len() as i64).collect();
    let dense = [field(1, &differences(&ids)), field(8, &coordinates(1)), field(9, &coordinates(0))].concat();
    let mut group = field(2, &dense);
    for (id, nodes, list) in WAYS {
        let (keys, values): (Vec<_>, Vec<_>) = tags(list).into_iter().map(|(k, v)| (word(k), word(v))).unzip();
        let way =
            [number(1, id as u64), field(2, &packed(keys)), field(3, &packed(values)), field(8, &differences(nodes))];
        group.extend(field(3, &way.concat()));
    }
    let (keys, values): (Vec<_>, Vec<_>) = tags(OUTLINE.1).into_iter().map(|(k, v)| (word(k), word(v))).unzip();
    let roles: Vec<u64> = OUTLINE.0.iter().map(|(_, role)| word(role)).collect();
    let members: Vec<i64> = OUTLINE.0.iter().map(|(id, _)| *id).collect();
    let relation = [
        number(1, 31),
        field(2, &packed(keys)),
        field(3, &packed(values)),
        field(8, &packed(roles)),
        field(9, &differences(&members)),
        field(10, &packed([1, 1, 1])),
    ];
    group.extend(field(4, &relation.concat()));
    let table: Vec<u8> = words.iter().flat_map(|w| field(1, w.as_bytes())).collect();
    pbf_of(&[field(1, &table), field(2, &group)].concat(), true)
}

fn place(id: i64) -> String {
    let [x, y] = NODES[id as usize - 1];
    format!("[{x},{y}]")
}

pub(super) fn geojson() -> String {
    let properties =
        |list: &str| tags(list).iter().map(|(k, v)| format!("\"{k}\":\"{v}\"")).collect::<Vec<_>>().join(",");
    let feature = |kind: &str, coordinates: String, list: &str| {
        format!(
            "{{\"type\":\"Feature\",\"properties\":{{{}}},\"geometry\":{{\"type\":\"{kind}\",\"coordinates\":{coordinates}}}}}",
            properties(list)
        )
    };
    let ring = |nodes: &[i64]| format!("[{}]", nodes.iter().map(|n| place(*n)).collect::<Vec<_>>().join(","));
    let ways = WAYS.iter().filter(|w| !w.2.is_empty());
    let mut features: Vec<String> = ways.map(|(_, nodes, list)| feature("LineString", ring(nodes), list)).collect();
    let rings = format!("[[{},{}]]", ring(&[7, 8, 9, 10, 7]), ring(&[8, 11, 12, 8]));
    features.push(feature("MultiPolygon", rings, OUTLINE.1));
    let bbox = "[9,46.999,9.003,47.001]";
    format!("{{\"type\":\"FeatureCollection\",\"bbox\":{bbox},\"features\":[\n{}\n]}}", features.join(",\n"))
}

/// An answer of Overpass: with nodes apart, or with their places in ways and members (`out geom`).
pub(super) fn overpass(geom: bool) -> String {
    let places = |nodes: &[i64]| {
        let place = |n: &i64| {
            let [x, y] = NODES[*n as usize - 1];
            format!("{{\"lat\":{y},\"lon\":{x}}}")
        };
        format!("[{}]", nodes.iter().map(place).collect::<Vec<_>>().join(","))
    };
    let tags = |list: &str| tags(list).iter().map(|(k, v)| format!("\"{k}\":\"{v}\"")).collect::<Vec<_>>().join(",");
    let mut all = Vec::new();
    if !geom {
        let node =
            |(i, [x, y]): (usize, &[f64; 2])| format!("{{\"type\":\"node\",\"id\":{},\"lat\":{y},\"lon\":{x}}}", i + 1);
        all.extend(NODES.iter().enumerate().map(node));
    }
    for (id, nodes, list) in WAYS.iter().filter(|w| !geom || !w.2.is_empty()) {
        let geometry = if geom { format!(",\"geometry\":{}", places(nodes)) } else { String::new() };
        all.push(format!("{{\"type\":\"way\",\"id\":{id},\"nodes\":{nodes:?}{geometry},\"tags\":{{{}}}}}", tags(list)));
    }
    let member = |(id, role): &(i64, &str)| {
        let nodes = WAYS.iter().find(|w| w.0 == *id).map_or(&[][..], |w| w.1);
        let geometry = if geom { format!(",\"geometry\":{}", places(nodes)) } else { String::new() };
        format!("{{\"type\":\"way\",\"ref\":{id},\"role\":\"{role}\"{geometry}}}")
    };
    let members = OUTLINE.0.iter().map(member).collect::<Vec<_>>().join(",");
    all.push(format!("{{\"type\":\"relation\",\"id\":31,\"members\":[{members}],\"tags\":{{{}}}}}", tags(OUTLINE.1)));
    format!("{{\"version\":0.6,\"elements\":[\n{}\n]}}", all.join(",\n"))
}

/// The same map as `out geom` of Overpass writes it in XML.
pub(super) fn xml_geom() -> String {
    let nd = |n: &i64, id: bool| {
        let [x, y] = NODES[*n as usize - 1];
        let id = if id { format!(" ref=\"{n}\"") } else { String::new() };
        format!("<nd{id} lat=\"{y}\" lon=\"{x}\"/>")
    };
    let mut text = xml().lines().filter(|l| !l.contains("<node") && !l.contains("<way")).collect::<Vec<_>>().join("\n");
    let all = xml();
    let mut ways = String::new();
    for (id, nodes, _) in WAYS.iter().filter(|w| !w.2.is_empty()) {
        let line = all.lines().find(|l| l.starts_with(&format!("<way id=\"{id}\""))).unwrap();
        let points: String = nodes.iter().map(|n| nd(n, true)).collect();
        let rest = &line[line.find("<tag").unwrap()..];
        ways +=
            &format!("<way id=\"{id}\"><bounds minlat=\"1\" minlon=\"1\" maxlat=\"2\" maxlon=\"2\"/>{points}{rest}\n");
    }
    for (id, nodes, _) in WAYS.iter().filter(|w| w.2.is_empty()) {
        let points: String = nodes.iter().map(|n| nd(n, false)).collect();
        let from = format!("<member type=\"way\" ref=\"{id}\" ");
        let start = text.find(&from).unwrap();
        let end = start + text[start..].find("/>").unwrap();
        text.replace_range(end..end + 2, &format!(">{points}</member>"));
    }
    text.replacen("<relation", &format!("{ways}<relation"), 1)
}

/// Every format of the little map.
pub(super) fn every_format() -> [(&'static str, Vec<u8>); 6] {
    [
        ("m.osm", xml().into()),
        ("geom.osm", xml_geom().into()),
        ("m.osm.pbf", pbf()),
        ("m.geojson", geojson().into()),
        ("m.json", overpass(true).into()),
        ("plain.osm.pbf", {
            let nodes =
                [field(1, &differences(&[1, 2])), field(8, &differences(&[1, 2])), field(9, &differences(&[3, 4]))];
            pbf_of(&field(2, &field(2, &nodes.concat())), false)
        }),
    ]
}
