//! GeoJSON in plan metres, or in degrees where the plan lies on the globe: streets, roads, junctions, blocks, lots, buildings and settlements.

use crate::export::{ExportError, Plan, hex, traffic::AreaTraffic};
use crate::network::{JunctionId, SizeClass, StreetClass, Traffic};
use crate::parcel::BlockUse;
use crate::space::{Bounds, ChunkCoord, Geographic};
use crate::world::Owned;
use glam::DVec2;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::io::Write;

use geojson::{Feature, GeometryValue, Position};

/// What else to write.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Lanes (`kind` lane) of all streets and roads, and turns (`kind` turn) through the junctions in the square.
    pub lanes: bool,
}

/// Writes a plan as a feature collection whose `bbox` is the square that was asked for.
///
/// Every feature has `kind`, `class` and `id`. Streets and roads also have `from` and `to`, and `level`, `bridge` and `tunnel`
/// where they are not 0 or false, `oneway` (true, or "against" where traffic goes from `to` to `from`) and `roundabout`. A feature that a chunk owns has that `chunk`. A junction has the class of the widest street
/// that ends there. Coordinates in plan metres are exact: reading them gives the bits that were written. With
/// [`Plan::projection`] they are longitude and latitude, to a tenth of a millimetre, as RFC 7946 wants them.
pub fn write(plan: &Plan<'_>, options: Options, out: &mut dyn Write) -> Result<(), ExportError> {
    let corners = [plan.area.bounds.min, plan.area.bounds.max].map(|p| Place(plan.projection).of(p));
    let bounds = Bounds::of(corners);
    let bbox = json!([bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y]);
    write!(out, "{{\"type\":\"FeatureCollection\",\"bbox\":{bbox},\"features\":[")?;
    let mut first = true;
    let mut put = |feature: Feature| -> Result<(), ExportError> {
        out.write_all(if first { b"\n" } else { b",\n" })?;
        first = false;
        serde_json::to_writer(&mut *out, &feature).map_err(|e| ExportError::Io(e.into()))
    };
    settlements(plan, &mut put)?;
    parcels(plan, &mut put)?;
    network(plan, &mut put)?;
    if options.lanes {
        lanes(plan, &mut put)?;
    }
    out.write_all(b"\n]}\n")?;
    Ok(())
}

type Put<'a> = dyn FnMut(Feature) -> Result<(), ExportError> + 'a;

fn settlements(plan: &Plan<'_>, put: &mut Put<'_>) -> Result<(), ExportError> {
    let place = Place(plan.projection);
    for (i, settlement) in plan.area.settlements.iter().enumerate() {
        let centre = settlement.centre.plan();
        let geometry = match plan.outlines.get(i) {
            Some(outline) => place.polygon(&outline.polygon, outline.origin.plan()),
            None => GeometryValue::Point { coordinates: place.position(centre) },
        };
        let mut fields = properties("settlement", size_name(settlement.size), settlement.id.0);
        fields.insert("name".into(), json!(settlement.name));
        fields.insert("style".into(), json!(settlement.style));
        fields.insert("sigma".into(), json!(settlement.size as u8));
        fields.insert("radius_m".into(), json!(settlement.radius));
        fields.insert("chunk".into(), json!(ChunkCoord::containing(centre, plan.chunk_size).to_string()));
        put(feature(geometry, fields))?;
    }
    Ok(())
}

fn parcels(plan: &Plan<'_>, put: &mut Put<'_>) -> Result<(), ExportError> {
    let (place, origin) = (Place(plan.projection), plan.area.origin.plan());
    for block in &plan.area.blocks {
        let class = match block.item.land_use {
            BlockUse::Built => "built",
            BlockUse::Park => "park",
        };
        put(feature(place.polygon(&block.item.polygon, origin), owned("block", class, block.item.id, block.chunk)))?;
    }
    for lot in &plan.area.lots {
        let mut fields = owned("lot", "lot", lot.item.id, lot.chunk);
        fields.insert("block".into(), json!(hex(lot.item.block)));
        fields.insert("street".into(), json!(hex(lot.item.street.0)));
        put(feature(place.polygon(&lot.item.polygon, origin), fields))?;
    }
    for building in &plan.area.footprints {
        let mut fields = owned("building", "building", building.item.id, building.chunk);
        fields.insert("lot".into(), json!(hex(building.item.lot)));
        fields.insert("storeys".into(), json!(building.item.storeys));
        fields.insert("base".into(), json!((building.item.base * 100.0).round() / 100.0));
        fields.insert("height".into(), json!((building.item.height * 100.0).round() / 100.0));
        put(feature(place.polygon(&building.item.polygon, origin), fields))?;
    }
    Ok(())
}

fn network(plan: &Plan<'_>, put: &mut Put<'_>) -> Result<(), ExportError> {
    let (place, origin) = (Place(plan.projection), plan.area.origin.plan());
    let mut widest: BTreeMap<JunctionId, StreetClass> = BTreeMap::new();
    for Owned { chunk, item } in &plan.area.streets {
        let street = &item.street;
        for end in [street.from, street.to] {
            widest.entry(end).and_modify(|c| *c = street.class.min(*c)).or_insert(street.class);
        }
        let kind = if street.class.is_road() { "road" } else { "street" };
        let mut fields = owned(kind, street.class.name(), street.id.0, *chunk);
        fields.insert("from".into(), json!(hex(street.from.0)));
        fields.insert("to".into(), json!(hex(street.to.0)));
        if street.level != 0 {
            fields.insert("level".into(), json!(street.level));
        }
        // A one-way street is reversed where traffic drives on the other side.
        match street.traffic(plan.driving) {
            Traffic::Both => {}
            Traffic::Along => drop(fields.insert("oneway".into(), json!(true))),
            Traffic::Against => drop(fields.insert("oneway".into(), json!("against"))),
        }
        let roundabout = street.island.is_some();
        for (name, set) in [("bridge", street.bridge), ("tunnel", street.tunnel), ("roundabout", roundabout)] {
            if set {
                fields.insert(name.into(), json!(true));
            }
        }
        let coordinates = street.line.iter().map(|p| place.position(*p + origin)).collect();
        put(feature(GeometryValue::LineString { coordinates }, fields))?;
    }
    for junction in &plan.area.junctions {
        let class = widest.get(&junction.item.id).copied().unwrap_or(StreetClass::Local);
        let fields = owned("junction", class.name(), junction.item.id.0, junction.chunk);
        put(feature(GeometryValue::Point { coordinates: place.position(junction.item.at + origin) }, fields))?;
    }
    Ok(())
}

fn lanes(plan: &Plan<'_>, put: &mut Put<'_>) -> Result<(), ExportError> {
    let (place, origin) = (Place(plan.projection), plan.area.origin.plan());
    let line = |line: &[DVec2]| GeometryValue::LineString {
        coordinates: line.iter().map(|p| place.position(*p + origin)).collect(),
    };
    let traffic = AreaTraffic::new(plan.area, plan.driving);
    for Owned { chunk, item } in &plan.area.streets {
        for lane in traffic.lanes(&item.street) {
            let mut fields = owned("lane", lane.class.name(), lane.id.0, *chunk);
            fields.insert("street".into(), json!(hex(lane.street.0)));
            fields.insert("direction".into(), json!(if lane.along { "along" } else { "against" }));
            fields.insert("index".into(), json!(lane.index));
            fields.insert("width".into(), json!(lane.width));
            fields.insert("speed_kmh".into(), json!((lane.speed * 3.6).round()));
            put(feature(line(&lane.line), fields))?;
        }
    }
    for junction in &plan.area.junctions {
        for turn in traffic.junctions.get(&junction.item.id).iter().flat_map(|j| &j.turns) {
            let (kind, control) = (turn.kind.name(), turn.control.name());
            let mut fields = owned("turn", kind, turn.id(), junction.chunk);
            fields.insert("junction".into(), json!(hex(junction.item.id.0)));
            fields.insert("from".into(), json!(hex(turn.from.0)));
            fields.insert("to".into(), json!(hex(turn.to.0)));
            fields.insert("control".into(), json!(control));
            put(feature(line(&turn.line), fields))?;
        }
    }
    Ok(())
}

/// Name of a size class in files.
pub(crate) fn size_name(size: SizeClass) -> &'static str {
    match size {
        SizeClass::City => "city",
        SizeClass::Town => "town",
        SizeClass::Village => "village",
    }
}

fn properties(kind: &str, class: &str, id: u64) -> Map<String, Value> {
    let common = [("kind", json!(kind)), ("class", json!(class)), ("id", json!(hex(id)))];
    common.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

fn owned(kind: &str, class: &str, id: u64, chunk: ChunkCoord) -> Map<String, Value> {
    let mut fields = properties(kind, class, id);
    fields.insert("chunk".into(), json!(chunk.to_string()));
    fields
}

fn feature(geometry: GeometryValue, properties: Map<String, Value>) -> Feature {
    Feature { geometry: Some(geometry.into()), properties: Some(properties), ..Default::default() }
}

/// Decimals of a degree: a tenth of a millimetre.
const DEGREE_STEPS: f64 = 1e9;

/// Where plan points are written: in plan metres, or projected.
#[derive(Clone, Copy)]
struct Place(Option<Geographic>);

impl Place {
    fn of(self, p: DVec2) -> DVec2 {
        self.0.map_or(p, |g| (g.to_degrees(p) * DEGREE_STEPS).round() / DEGREE_STEPS)
    }

    fn position(self, p: DVec2) -> Position {
        self.of(p).to_array().into()
    }

    fn polygon(self, points: &[DVec2], origin: DVec2) -> GeometryValue {
        let ring = points.iter().chain(points.first()).map(|p| self.position(*p + origin)).collect();
        GeometryValue::Polygon { coordinates: vec![ring] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::QUANTUM;
    use crate::testing;

    #[test]
    fn a_plan_on_the_globe_is_written_in_degrees() {
        let town = testing::area(DVec2::new(400.0, -300.0));
        let projection = Geographic::around(DVec2::new(9.0, 47.0)).unwrap();
        let mut file = Vec::new();
        write(&Plan { projection: Some(projection), ..town.plan() }, Options::default(), &mut file).unwrap();
        let read: geojson::FeatureCollection = String::from_utf8(file).unwrap().parse().unwrap();
        let on_plan = |p: &[f64]| projection.to_plan(DVec2::new(p[0], p[1]));
        let bbox = read.bbox.unwrap();
        assert!(
            on_plan(&bbox[..2]).distance(town.area.bounds.min) < 1e-3
                && on_plan(&bbox[2..]).distance(town.area.bounds.max) < 1e-3
        );
        let junctions: Vec<DVec2> = town.area.junctions.iter().map(|j| town.area.origin.to_plan(j.item.at)).collect();
        let mut found = 0;
        for feature in &read.features {
            if let Some(GeometryValue::Point { coordinates }) = feature.geometry.as_ref().map(|g| &g.value) {
                let at = on_plan(coordinates.as_slice());
                assert!(junctions.iter().any(|j| j.distance(at) < 1e-3), "{at}");
                found += 1;
            }
        }
        assert_eq!(found, junctions.len());
    }

    #[test]
    fn lanes_and_turns_join_by_id() {
        let town = testing::area(DVec2::new(400.0, -300.0));
        let mut file = Vec::new();
        write(&town.plan(), Options { lanes: true }, &mut file).unwrap();
        let read: geojson::FeatureCollection = String::from_utf8(file).unwrap().parse().unwrap();
        let text = |f: &Feature, key: &str| f.property(key).and_then(|v| v.as_str()).unwrap_or_default().to_owned();
        let of = |kind: &str| read.features.iter().filter(|f| text(f, "kind") == kind).collect::<Vec<_>>();
        let ends = |f: &Feature| match f.geometry.as_ref().map(|g| &g.value) {
            Some(GeometryValue::LineString { coordinates: line }) => {
                [0, line.len() - 1].map(|i| [line[i].as_slice()[0], line[i].as_slice()[1]])
            }
            other => panic!("{other:?}"),
        };
        let lanes: BTreeMap<String, [[f64; 2]; 2]> = of("lane").into_iter().map(|f| (text(f, "id"), ends(f))).collect();
        let turns = of("turn");
        assert!(lanes.len() >= 2 * town.area.streets.len() && turns.len() > 100);
        for turn in turns {
            let [from, to] = ends(turn);
            assert_eq!(lanes[&text(turn, "from")][1], from);
            assert_eq!(lanes[&text(turn, "to")][0], to);
        }
    }

    #[test]
    fn positions_far_out_and_ids_come_back_bit_for_bit() {
        let town = testing::area(DVec2::new(1.0e11, -3.0e10));
        let mut file = Vec::new();
        write(&town.plan(), Options::default(), &mut file).unwrap();
        let file = String::from_utf8(file).unwrap();
        let read: geojson::FeatureCollection = file.parse().unwrap();
        let street = &town.area.streets[0];
        // The text is read, since numbers of serde_json may be off by the last bit unless its `float_roundtrip` is on.
        let id = format!("\"id\":\"{}\"", hex(street.item.street.id.0));
        let text = file.lines().find(|l| l.contains(&id)).unwrap();
        let numbers = text.split("[[").nth(1).unwrap().split("]]").next().unwrap().replace("],[", ",");
        let numbers: Vec<f64> = numbers.split(',').map(|n| n.parse().unwrap()).collect();
        let back: Vec<DVec2> = numbers.chunks(2).map(|p| DVec2::new(p[0], p[1])).collect();
        let line: Vec<DVec2> = street.item.street.line.iter().map(|p| town.area.origin.to_plan(*p)).collect();
        assert_eq!(back, line);
        assert!(back.iter().all(|p| (*p / QUANTUM).round() * QUANTUM == *p));
        let kinds: std::collections::BTreeSet<_> =
            read.features.iter().filter_map(|f| f.property("kind")?.as_str()).collect();
        assert_eq!(kinds.len(), 7, "{kinds:?}");
        let levels = read.features.iter().filter(|f| f.property("level").is_some()).count();
        assert_eq!(levels, 1, "only the bridge has a level");
    }
}
