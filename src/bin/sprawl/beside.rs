//! A real town, to be drawn beside one of a world.

use crate::fail::Fail;
use crate::roads::reference;
use bevy_sprawl::export::lines;
use bevy_sprawl::parcel::{Block, BlockUse, Footprint};
use bevy_sprawl::space::{Bounds, ChunkCoord, Origin, signed_area};
use bevy_sprawl::terrain::{Terrain, TerrainSample};
use bevy_sprawl::world::{Area, Owned};
use glam::DVec2;
use std::path::Path;

/// Storeys of buildings of which no height is known.
const STOREYS: u32 = 3;

/// Even ground without water: what a real town stands on here.
pub struct Plain;

impl Terrain for Plain {
    fn sample(&self, _: DVec2) -> TerrainSample {
        TerrainSample { height: 0.0, water_level: -100.0, vegetation: 0.0 }
    }
}

/// Streets and buildings of a file within a square of edge `size` metres around a place in degrees, or around its middle.
pub fn area(path: &Path, around: Option<DVec2>, size: f64, chunk_size: i64) -> Result<Area, Fail> {
    let bounds = Bounds::square(DVec2::ZERO, size);
    let [streets, buildings] = reference::town(path, around)?;
    let mut area = lines(bounds, streets, chunk_size);
    let origin = Origin::at(bounds.centre());
    let owner = ChunkCoord::new(0, 0);
    let corners =
        [bounds.min, DVec2::new(bounds.max.x, bounds.min.y), bounds.max, DVec2::new(bounds.min.x, bounds.max.y)];
    let polygon = corners.map(|p| origin.to_local(p)).to_vec();
    area.blocks.push(Owned { chunk: owner, it: Block { id: 0, polygon, used_as: BlockUse::Built } });
    let closed = buildings.into_iter().map(|b| b.line).filter(|l| l.len() > 3 && l.first() == l.last());
    for (i, line) in closed.enumerate().filter(|(_, l)| Bounds::of(l.iter().copied()).overlaps(bounds)) {
        let mut polygon: Vec<DVec2> = line[1..].iter().map(|p| origin.to_local(*p)).collect();
        if signed_area(&polygon) < 0.0 {
            polygon.reverse();
        }
        let it = Footprint { id: i as u64, lot: 0, polygon, storeys: STOREYS };
        area.footprints.push(Owned { chunk: owner, it });
    }
    Ok(area)
}
