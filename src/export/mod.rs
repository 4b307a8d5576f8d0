//! Pictures and files of a square of the world: SVG, PNG, GeoJSON, OSM XML and GLB.
//!
//! Exporters are pure functions of a [`Plan`] (GLB: of chunk meshes). A square exports the streets it overlaps, whole,
//! with the junctions at both their ends.

mod clip;
pub mod geojson;
pub mod glb;
mod glyphs;
pub mod osm;
pub mod png;
mod relief;
pub mod svg;
mod traffic;

pub use clip::clipped;

use crate::layer::{Cancel, LayerError};
use crate::network::{Junction, JunctionId, Network, Side, Street, StreetClass, StreetId};
use crate::region::{Outline, RoadNetwork, RoadSection};
use crate::space::{Bounds, Geographic, quantize};
use crate::stack::{PlacedStreet, owner_of, street_owner};
use crate::terrain::Terrain;
use crate::world::{Area, Owned, World};
use glam::DVec2;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The writer failed.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// The content does not fit the format.
    #[error("{0}")]
    Format(String),
}

/// All that the exporters of maps read.
pub struct Plan<'a> {
    /// Everything in the square.
    pub area: &'a Area,
    /// Outline of each of `area.settlements`, in the same order.
    pub outlines: &'a [Arc<Outline>],
    /// The ground.
    pub terrain: &'a dyn Terrain,
    /// Edge of a chunk in metres.
    pub chunk_size: i64,
    /// The side of the road on which traffic drives.
    pub driving: Side,
    /// Real roads to compare with, drawn under the plan's own roads in pictures.
    pub real: Option<&'a Area>,
    /// Where the plan lies on the globe. With it GeoJSON and OSM are in the longitudes and latitudes of that place.
    pub projection: Option<Geographic>,
}

/// Outlines of the settlements of an area, as [`Plan::outlines`] wants them.
pub fn outlines(world: &World, area: &Area) -> Result<Vec<Arc<Outline>>, LayerError> {
    area.settlements.iter().map(|s| world.settlements().outline(s)).collect()
}

/// The settlements and roads that overlap `bounds` (plan metres), for a map of a whole region: without streets, blocks and
/// buildings.
pub fn region(world: &World, bounds: Bounds, cancel: &Cancel) -> Result<Area, LayerError> {
    let mut area = Area::empty(bounds);
    put_roads(&mut area, &world.roads().overlapping(bounds, cancel)?, world.settings().chunk_size);
    for settlement in world.settlements().overlapping(bounds)? {
        let outline = world.settlements().outline(&settlement)?;
        if outline.bounds().overlaps(bounds) {
            area.settlements.push(settlement);
            area.outlines.push(outline);
        }
    }
    Ok(area)
}

/// The settlements and roads of a finite domain, as the exporters want them. `chunk_size` is the edge of a chunk in metres;
/// files name the chunk that owns each thing.
pub fn network(network: &RoadNetwork, chunk_size: i64) -> Area {
    let mut area = Area::empty(network.domain);
    put_roads(&mut area, &network.roads, chunk_size);
    area.settlements.clone_from(&network.settlements);
    area
}

/// A network as the streets of an area; its positions are metres from the middle of `bounds`, rounded down to whole metres.
pub fn streets(bounds: Bounds, network: &Network, chunk_size: i64) -> Area {
    let mut area = Area::empty(bounds);
    let origin = area.origin;
    area.streets = network
        .streets
        .iter()
        .map(|street| Owned {
            chunk: street_owner(origin, street, chunk_size),
            item: PlacedStreet { street: street.clone(), made_by: None },
        })
        .collect();
    area.junctions =
        network.junctions.iter().map(|j| Owned { chunk: owner_of(origin, j.at, chunk_size), item: *j }).collect();
    area
}

/// Lines as roads of an area, for [`Plan::real`] or for drawing like a network. The roads have no junctions; their ids follow
/// from their places in the list.
pub fn lines(bounds: Bounds, roads: impl IntoIterator<Item = RoadLine>, chunk_size: i64) -> Area {
    let mut area = Area::empty(bounds);
    let origin = area.origin;
    for (i, road) in roads.into_iter().enumerate() {
        let line: Vec<DVec2> = road.line.iter().map(|p| quantize(origin.to_local(*p))).collect();
        if !Bounds::of(road.line).overlaps(bounds) {
            continue;
        }
        let id = |end: u64| JunctionId::of(&[i as u64, end]);
        let mut street = Street::new(StreetId::of(&[i as u64]), road.class, id(0), id(1), line);
        (street.bridge, street.tunnel) = (road.bridge, road.tunnel);
        street.level = i8::from(road.bridge) - i8::from(road.tunnel);
        let chunk = street_owner(origin, &street, chunk_size);
        area.streets.push(Owned { chunk, item: PlacedStreet { street, made_by: None } });
    }
    area
}

/// A road from elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct RoadLine {
    /// The class as which the road is drawn.
    pub class: StreetClass,
    /// Whether the road runs on a bridge.
    pub bridge: bool,
    /// Whether the road runs under the ground.
    pub tunnel: bool,
    /// Two points or more, in plan metres.
    pub line: Vec<DVec2>,
}

/// Puts sections of road and their ends into an area without roads.
fn put_roads(area: &mut Area, roads: &[Arc<RoadSection>], chunk_size: i64) {
    let origin = area.origin;
    let mut junctions = BTreeMap::new();
    for road in roads {
        let street = road.street.moved(road.origin.offset_to(origin));
        let ends = [(street.from, street.line.first()), (street.to, street.line.last())];
        junctions.extend(ends.into_iter().filter_map(|(id, at)| Some((id, *at?))));
        let chunk = street_owner(origin, &street, chunk_size);
        area.streets.push(Owned { chunk, item: PlacedStreet { street, made_by: None } });
    }
    area.junctions = junctions
        .into_iter()
        .map(|(id, at)| Owned { chunk: owner_of(origin, at, chunk_size), item: Junction { id, at } })
        .collect();
}

/// An id as written in files: 16 hexadecimal digits, because a number in JSON keeps only 53 bits.
pub(crate) fn hex(id: u64) -> String {
    format!("{id:016x}")
}

/// Classes from the narrowest to the widest: the order in which they are drawn.
pub(crate) fn narrowest_first() -> impl Iterator<Item = StreetClass> {
    use StreetClass::{Arterial, Highway, Local, Main, Major, Minor, Ramp};
    [Ramp, Local, Minor, Main, Major, Arterial, Highway].into_iter()
}
