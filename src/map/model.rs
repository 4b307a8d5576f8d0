//! A real map: streets that keep their nodes, and buildings.

use crate::map::report::MapReport;
use crate::map::tags::StreetTags;
use crate::space::{Bounds, Geographic, Origin};
use glam::DVec2;

/// A real map in plan metres.
///
/// Streets meet where they share a node, and nowhere else: a street that crosses another without a node of both passes over
/// or under it. [`Map::network`] gives the streets between such nodes.
#[derive(Clone, Debug)]
pub struct Map {
    /// How longitude and latitude became plan metres, and may become degrees again; `None` for a map in metres.
    pub projection: Option<Geographic>,
    /// The box that streets are clipped to, or the box around all of them.
    pub bounds: Bounds,
    /// The box that the file itself says that it covers.
    pub stated_bounds: Option<Bounds>,
    /// The points of the streets, each once.
    pub nodes: Vec<MapNode>,
    /// Streets, by their ids.
    pub streets: Vec<MapStreet>,
    /// Buildings, by their ids.
    pub buildings: Vec<MapBuilding>,
    /// What was used of the file, and what was left out.
    pub report: MapReport,
}

/// A point of a street.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapNode {
    /// The node's id in OpenStreetMap. `None` in formats without ids, where equal places are one node, and where the border
    /// of the box cuts a street.
    pub id: Option<i64>,
    /// Plan metres.
    pub at: DVec2,
}

/// A street, or a part of one where its way lacks nodes or leaves the box.
#[derive(Clone, Debug, PartialEq)]
pub struct MapStreet {
    /// Id of the way; in GeoJSON the number of the line, from 0.
    pub id: i64,
    /// Indices into [`Map::nodes`] of its points, two or more.
    pub nodes: Vec<u32>,
    /// Class, width, direction and the like.
    pub tags: StreetTags,
}

/// A building.
#[derive(Clone, Debug, PartialEq)]
pub struct MapBuilding {
    /// Id of the way or relation; in GeoJSON the number of the polygon, from 0.
    pub id: i64,
    /// Outline in plan metres, counter-clockwise.
    pub outline: Vec<DVec2>,
    /// Courtyards in plan metres, clockwise.
    pub holes: Vec<Vec<DVec2>>,
    /// Height in metres, where it is known.
    pub height: Option<f64>,
    /// Storeys, where they or the height are known.
    pub storeys: Option<u32>,
}

impl Map {
    /// The points of a street in plan metres.
    pub fn line(&self, street: &MapStreet) -> Vec<DVec2> {
        street.nodes.iter().filter_map(|i| self.nodes.get(*i as usize)).map(|n| n.at).collect()
    }

    /// The origin that the positions of [`Map::network`] are relative to.
    pub fn origin(&self) -> Origin {
        Origin::at(self.bounds.centre())
    }
}
