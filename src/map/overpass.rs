//! Answers of Overpass as JSON (`[out:json]`), `out geom` included.

use crate::layer::FileError;
use crate::map::elements::{Elements, Member, MemberLine, Outline, Way};
use crate::map::error::MapError;
use crate::map::limits::MapLimits;
use crate::map::report::LeftOut;
use crate::map::tags::{ElementKind, building};
use glam::DVec2;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::borrow::Cow;
use std::collections::BTreeMap;

#[derive(Deserialize)]
struct Answer {
    elements: Vec<Element>,
    remark: Option<String>,
}

#[derive(Deserialize)]
struct Element {
    #[serde(rename = "type")]
    kind: String,
    id: i64,
    lat: Option<f64>,
    lon: Option<f64>,
    #[serde(default)]
    nodes: Vec<i64>,
    /// Places of `nodes`; null outside of the box that was asked for.
    #[serde(default)]
    geometry: Vec<Option<LonLat>>,
    #[serde(default)]
    members: Vec<ElementMember>,
    #[serde(default)]
    tags: BTreeMap<String, String>,
}

#[derive(Clone, Copy, Deserialize)]
struct LonLat {
    lat: f64,
    lon: f64,
}

#[derive(Deserialize)]
struct ElementMember {
    #[serde(rename = "type")]
    kind: String,
    #[serde(rename = "ref")]
    id: i64,
    #[serde(default)]
    role: String,
    #[serde(default)]
    geometry: Vec<Option<LonLat>>,
}

/// Whether some JSON is an answer of Overpass rather than GeoJSON.
pub(super) fn is_answer(text: &str) -> bool {
    #[derive(Deserialize)]
    struct Outermost {
        elements: Option<IgnoredAny>,
    }
    serde_json::from_str::<Outermost>(text).is_ok_and(|o| o.elements.is_some())
}

/// Reads the text of a file; `classes` are the values of `highway` that count.
pub(super) fn read(file: &str, text: &str, classes: &[String], limits: MapLimits) -> Result<Elements, MapError> {
    let answer: Answer = serde_json::from_str(text)
        .map_err(|e| FileError::new(file, (e.line(), e.column()), format!("no readable answer of Overpass: {e}")))?;
    if let Some(remark) = answer.remark.filter(|r| r.contains("error")) {
        return Err(FileError::unreadable(file, format!("the query has failed: {remark}")).into());
    }
    let mut elements = Elements::new(file, limits);
    for element in answer.elements {
        let tag = |key: &str| element.tags.get(key).map(|v| Cow::Borrowed(v.as_str()));
        match element.kind.as_str() {
            "node" => {
                let at = element.lon.zip(element.lat).map(DVec2::from);
                if at.is_none() {
                    elements.leave_out(LeftOut::NoCoordinates);
                }
                elements.put_node(element.id, at)?;
            }
            "way" => {
                let kind = ElementKind::of(&tag, classes);
                for (node, place) in element.nodes.iter().zip(&element.geometry) {
                    if let Some(at) = place.map(LonLat::degrees) {
                        elements.put_node(*node, Some(at))?;
                    }
                }
                let nodes =
                    if element.nodes.is_empty() { line(&mut elements, &element.geometry) } else { element.nodes };
                elements.put_way(element.id, Some(Way { nodes, kind }))?;
            }
            _ => match building(&tag).filter(|_| tag("type").is_some_and(|t| t == "multipolygon")) {
                Some(tags) => {
                    let ways = element.members.into_iter().filter(|m| m.kind == "way");
                    let members = ways.map(|m| Member {
                        is_inner: m.role == "inner",
                        line: match m.geometry.is_empty() {
                            true => MemberLine::Way(m.id),
                            false => MemberLine::Nodes(line(&mut elements, &m.geometry)),
                        },
                    });
                    let members = members.collect();
                    elements.put_outline(element.id, Some(Outline { tags, members }))?;
                }
                None => elements.leave_out(LeftOut::OtherKind),
            },
        }
    }
    Ok(elements)
}

impl LonLat {
    fn degrees(self) -> DVec2 {
        DVec2::new(self.lon, self.lat)
    }
}

/// Nodes at places; a place that is missing is a node that is missing.
fn line(elements: &mut Elements, places: &[Option<LonLat>]) -> Vec<i64> {
    places.iter().map(|p| p.map_or(Elements::MISSING, |p| elements.node_at(p.degrees()))).collect()
}
