//! GeoJSON (RFC 7946): features with `highway` or `building`, as osmtogeojson, GDAL, OSMnx and this crate write them.

use crate::layer::FileError;
use crate::map::elements::{Elements, Member, MemberLine, Outline, Way};
use crate::map::error::MapError;
use crate::map::limits::MapLimits;
use crate::map::report::LeftOut;
use crate::map::tags::{ElementKind, building};
use crate::space::Bounds;
use geojson::{Feature, FeatureCollection, GeoJson, Geometry, GeometryValue, Position};
use glam::DVec2;
use serde_json::Value;
use std::borrow::Cow;

/// Reads the text of a file; `classes` are the values of `highway` that count. `in_degrees` refuses a file that names a
/// reference system of metres.
pub(super) fn read(
    file: &str,
    text: &str,
    classes: &[String],
    in_degrees: bool,
    limits: MapLimits,
) -> Result<Elements, MapError> {
    let json: GeoJson = serde_json::from_str(text)
        .map_err(|e| FileError::new(file, (e.line(), e.column()), format!("no readable GeoJSON: {e}")))?;
    let collection = match json {
        GeoJson::FeatureCollection(all) => all,
        GeoJson::Feature(one) => FeatureCollection { features: vec![one], ..FeatureCollection::default() },
        GeoJson::Geometry(one) => {
            let feature = Feature { geometry: Some(one), ..Feature::default() };
            FeatureCollection { features: vec![feature], ..FeatureCollection::default() }
        }
    };
    let system = collection.foreign_members.as_ref().and_then(|m| m.get("crs")).and_then(reference_system);
    if let Some(system) = system.filter(|s| in_degrees && !is_longitude_and_latitude(s)) {
        let reason = format!("its coordinates are in {system}; allowed are longitude and latitude (EPSG:4326)");
        return Err(FileError::unreadable(file, reason).into());
    }
    let mut collector = FeatureCollector { file, elements: Elements::new(file, limits), classes };
    collector.elements.stated = match collection.bbox.as_deref() {
        Some([west, south, east, north]) => Some(Bounds::new(DVec2::new(*west, *south), DVec2::new(*east, *north))),
        _ => None,
    };
    for (index, feature) in collection.features.iter().enumerate() {
        collector.feature(index, feature)?;
    }
    Ok(collector.elements)
}

/// The name of a reference system, as GeoJSON of 2008 has it.
fn reference_system(crs: &Value) -> Option<String> {
    Some(crs.get("properties")?.get("name")?.as_str()?.to_owned())
}

fn is_longitude_and_latitude(system: &str) -> bool {
    ["CRS84", "4326", "4258", "4269"].iter().any(|known| system.ends_with(known))
}

struct FeatureCollector<'a> {
    file: &'a str,
    elements: Elements,
    classes: &'a [String],
}

impl FeatureCollector<'_> {
    fn feature(&mut self, index: usize, feature: &Feature) -> Result<(), MapError> {
        let tag = |key: &str| feature.property(key).and_then(value);
        let kind = ElementKind::of(&tag, self.classes);
        let Some(geometry) = &feature.geometry else {
            self.elements.leave_out(LeftOut::OtherGeometry);
            return Ok(());
        };
        let mut parts = Parts::default();
        parts.gather(geometry);
        let reason = match kind {
            ElementKind::Other(reason) => Some(reason),
            _ if parts.lines.is_empty() && parts.polygons.is_empty() => Some(LeftOut::OtherGeometry),
            ElementKind::Street(_) if parts.lines.is_empty() => Some(LeftOut::StreetArea),
            _ => None,
        };
        if let Some(reason) = reason {
            self.elements.leave_out(reason);
            return Ok(());
        }
        for line in parts.lines {
            let nodes = self.line(index, line)?;
            let id = self.elements.ways.len() as i64;
            self.elements.put_way(id, Some(Way { nodes, kind: kind.clone() }))?;
        }
        let Some(tags) = building(&tag) else { return Ok(()) };
        for polygon in parts.polygons {
            let mut members = Vec::with_capacity(polygon.len());
            for (i, ring) in polygon.iter().enumerate() {
                members.push(Member { is_inner: i > 0, line: MemberLine::Nodes(self.line(index, ring)?) });
            }
            let id = self.elements.outlines.len() as i64;
            self.elements.put_outline(id, Some(Outline { tags, members }))?;
        }
        Ok(())
    }

    /// The nodes of a line.
    fn line(&mut self, feature: usize, points: &[Position]) -> Result<Vec<i64>, MapError> {
        let place = |p: &Position| Some(DVec2::new(*p.as_slice().first()?, *p.as_slice().get(1)?));
        let places: Option<Vec<DVec2>> = points.iter().map(place).collect();
        let places = places.ok_or_else(|| {
            let reason = format!("feature {}: a point has fewer than two coordinates", feature + 1);
            FileError::unreadable(self.file, format!("no readable GeoJSON: {reason}"))
        })?;
        Ok(places.into_iter().map(|p| self.elements.node_at(p)).collect())
    }
}

/// The lines and polygons of a geometry.
#[derive(Default)]
struct Parts<'a> {
    lines: Vec<&'a [Position]>,
    polygons: Vec<&'a [Vec<Position>]>,
}

impl<'a> Parts<'a> {
    fn gather(&mut self, geometry: &'a Geometry) {
        match &geometry.value {
            GeometryValue::LineString { coordinates } => self.lines.push(coordinates),
            GeometryValue::MultiLineString { coordinates } => {
                self.lines.extend(coordinates.iter().map(Vec::as_slice));
            }
            GeometryValue::Polygon { coordinates } => self.polygons.push(coordinates),
            GeometryValue::MultiPolygon { coordinates } => {
                self.polygons.extend(coordinates.iter().map(Vec::as_slice));
            }
            GeometryValue::GeometryCollection { geometries } => geometries.iter().for_each(|g| self.gather(g)),
            GeometryValue::Point { .. } | GeometryValue::MultiPoint { .. } => {}
        }
    }
}

/// A property as the value of a tag: lists, also those written as text (`['a', 'b']`), become `a;b`.
fn value(json: &Value) -> Option<Cow<'_, str>> {
    match json {
        Value::Null => None,
        Value::String(text) => match text.strip_prefix('[').and_then(|t| t.strip_suffix(']')) {
            Some(list) => {
                let values = list.split(',').map(|v| v.trim().trim_matches(['\'', '"']));
                Some(values.collect::<Vec<_>>().join(";").into())
            }
            None => Some(text.as_str().into()),
        },
        Value::Bool(set) => Some(if *set { "yes" } else { "no" }.into()),
        Value::Number(number) => Some(number.to_string().into()),
        Value::Array(list) => Some(list.iter().filter_map(value).collect::<Vec<_>>().join(";").into()),
        Value::Object(_) => None,
    }
}
