//! A real town, drawn beside one of a world.

use crate::fail::Fail;
use bevy_sprawl::export::{RoadLine, lines};
use bevy_sprawl::map::{Map, MapCoordinates, MapOptions, MaskOptions};
use bevy_sprawl::parcel::{Block, BlockUse, Footprint, STOREY_HEIGHT};
use bevy_sprawl::space::{Bounds, ChunkCoord, Geographic, Origin};
use bevy_sprawl::terrain::{Terrain, TerrainSample};
use bevy_sprawl::world::{Area, Owned};
use glam::DVec2;
use std::path::Path;

/// Storeys of a building whose height is not known.
const STOREYS: u32 = 3;

/// Flat ground without water, on which a real town is drawn.
pub struct Plain;

impl Terrain for Plain {
    fn sample(&self, _: DVec2) -> TerrainSample {
        TerrainSample { height: 0.0, water_level: -100.0, vegetation: 0.0 }
    }
}

/// Reads the map of a real town in degrees or of pixels, within a square of edge `size` metres around a place in degrees, or
/// around the map's middle.
pub fn read(path: &Path, around: Option<DVec2>, size: f64, mask: MaskOptions) -> Result<Map, Fail> {
    let coordinates = match around {
        None => MapCoordinates::Degrees,
        Some(at) => {
            let projection = Geographic::around(at).ok_or_else(|| {
                Fail::input(format!("--beside-at {},{} is no longitude and latitude, or near a pole", at.x, at.y))
            })?;
            MapCoordinates::DegreesAround(projection)
        }
    };
    let bounds = Some(Bounds::square(DVec2::ZERO, size));
    Ok(Map::read(path, &MapOptions { coordinates, bounds, mask, ..MapOptions::default() })?)
}

/// The streets and buildings of a map as the exporters want them.
pub fn area(map: &Map, chunk_size: i64) -> Area {
    let streets = map.streets.iter().map(|street| RoadLine {
        class: street.tags.class,
        bridge: street.tags.bridge,
        tunnel: street.tags.tunnel,
        line: map.line(street),
    });
    let bounds = map.bounds;
    let mut area = lines(bounds, streets, chunk_size);
    build(
        &mut area,
        map.buildings.iter().map(|b| Building { outline: &b.outline, height: b.height, storeys: b.storeys }),
    );
    area
}

/// A building of a map.
pub struct Building<'a> {
    /// Outline in the plan's metres.
    pub outline: &'a [DVec2],
    /// Height in metres, where it is known.
    pub height: Option<f64>,
    /// Storeys, where they are known.
    pub storeys: Option<u32>,
}

/// Puts buildings into an area, on land that may be built on.
pub fn build<'a>(area: &mut Area, buildings: impl Iterator<Item = Building<'a>>) {
    let bounds = area.bounds;
    let origin = Origin::at(bounds.centre());
    let owner = ChunkCoord::new(0, 0);
    let corners =
        [bounds.min, DVec2::new(bounds.max.x, bounds.min.y), bounds.max, DVec2::new(bounds.min.x, bounds.max.y)];
    let polygon = corners.map(|p| origin.to_local(p)).to_vec();
    area.blocks.push(Owned { chunk: owner, item: Block { id: 0, polygon, land_use: BlockUse::Built } });
    for (i, building) in buildings.enumerate() {
        let polygon = building.outline.iter().map(|p| origin.to_local(*p)).collect();
        let storeys = building.storeys.unwrap_or(STOREYS);
        let height = building.height.unwrap_or(f64::from(storeys) * STOREY_HEIGHT);
        let item = Footprint { id: i as u64, lot: 0, polygon, storeys, base: 0.0, height };
        area.footprints.push(Owned { chunk: owner, item });
    }
}
