//! `sprawl digest`: hashes of the exact bits of chunks, layer by layer.

use crate::args::{Common, DigestArgs, Order};
use crate::fail::Fail;
use crate::work;
use bevy_sprawl::chunk::Chunk;
use bevy_sprawl::layer::{Cancel, LayerError};
use bevy_sprawl::mesh::{self, Detail, MeshBuffers};
use bevy_sprawl::parcel::BlockUse;
use bevy_sprawl::space::{ChunkCoord, Seed};
use bevy_sprawl::stack::PlacedStreet;
use bevy_sprawl::streets::MadeBy;
use bevy_sprawl::world::World;
use glam::DVec2;
use serde_json::{Map, json};
use std::fmt::Write;
use xxhash_rust::xxh3::Xxh3;

/// Layers that are hashed: `chunk` is all that a chunk owns, `mesh` its buffers at both levels of detail.
const LAYERS: [&str; 7] = ["terrain", "region", "town", "streets", "parcel", "chunk", "mesh"];

/// Runs the command.
pub fn run(common: &Common, args: &DigestArgs) -> Result<(), Fail> {
    let world = work::world(common)?;
    let (x, y) = (args.chunks.x.clone(), args.chunks.y.clone());
    let mut coords: Vec<ChunkCoord> = x.flat_map(|x| y.clone().map(move |y| ChunkCoord::new(x, y))).collect();
    order(&mut coords, args.order, world.seed());
    let cancel = Cancel::new();
    let hashes = work::each(common, "making chunks", &coords, |coord| hashes(&world, *coord, &cancel))?;

    // In the order of the coordinates, whatever the order of the work was.
    let mut by_coord: Vec<(ChunkCoord, [u64; LAYERS.len()])> = coords.into_iter().zip(hashes).collect();
    by_coord.sort_by_key(|(coord, _)| *coord);
    let hex = |hash: u64| format!("{hash:016x}");
    let mut layers = Map::new();
    for (i, layer) in LAYERS.iter().enumerate() {
        let mut hash = Hash::default();
        by_coord.iter().for_each(|(_, of)| hash.word(of[i]));
        layers.insert((*layer).into(), json!(hex(hash.finish())));
    }
    let mut chunks = Map::new();
    let mut total = Hash::default();
    for (coord, of) in &by_coord {
        let mut hash = Hash::default();
        of.iter().for_each(|h| hash.word(*h));
        let hash = hash.finish();
        chunks.insert(coord.to_string(), json!(hex(hash)));
        total.word(hash);
    }
    let total = hex(total.finish());
    let mut people = String::new();
    for layer in LAYERS {
        // Writing to a string cannot fail.
        let _ = writeln!(people, "{layer:8} {}", layers[layer].as_str().unwrap_or_default());
    }
    let _ = writeln!(people, "{:8} {total}  ({} chunks)", "total", chunks.len());
    work::print(common, &json!({ "layers": layers, "chunks": chunks, "total": total }), &people)
}

fn order(coords: &mut [ChunkCoord], order: Order, seed: Seed) {
    match order {
        Order::Forward => {}
        Order::Reverse => coords.reverse(),
        Order::Shuffled => {
            let mut random = seed.stream("digest order", &[]);
            for i in (1..coords.len()).rev() {
                coords.swap(i, random.index(i + 1));
            }
        }
    }
}

/// Hashes of a chunk, as [`LAYERS`].
fn hashes(world: &World, coord: ChunkCoord, cancel: &Cancel) -> Result<[u64; LAYERS.len()], LayerError> {
    let chunk = world.chunk(coord, cancel)?;
    let mut meshes = Hash::default();
    for detail in [Detail::Full, Detail::Reduced] {
        let mesh = mesh::build(&chunk, &**world.terrain(), detail, cancel)?;
        [&mesh.ground, &mesh.water, &mesh.roads, &mesh.buildings, &mesh.windows]
            .into_iter()
            .for_each(|b| meshes.buffers(b));
    }
    Ok(content(&chunk, meshes.finish()))
}

/// Hashes of what a chunk owns, with that of its meshes in its place.
fn content(chunk: &Chunk, meshes: u64) -> [u64; LAYERS.len()] {
    let [mut terrain, mut region, mut town, mut streets, mut parcel, mut all] = [(); 6].map(|()| Hash::default());
    terrain.word(chunk.ground.cells as u64);
    for sample in &chunk.ground.samples {
        [sample.height, sample.water_level, sample.vegetation].into_iter().for_each(|x| terrain.float(x));
    }
    for s in &chunk.settlements {
        [s.id.0, s.centre.0.x as u64, s.centre.0.y as u64, s.radius.to_bits(), s.size as u64]
            .into_iter()
            .for_each(|w| region.word(w));
        region.text(&s.style);
        region.text(&s.name);
    }
    for street in &chunk.streets {
        let class = street.street.class;
        let of = if class.is_road() {
            &mut region
        } else if class.is_main() {
            &mut town
        } else {
            &mut streets
        };
        of.street(street);
    }
    for block in &chunk.blocks {
        parcel.word(block.id);
        parcel.word(u64::from(block.used_as == BlockUse::Park));
        parcel.line(&block.polygon);
    }
    for lot in &chunk.lots {
        [lot.id, lot.block, lot.street.0].into_iter().for_each(|w| parcel.word(w));
        parcel.line(&lot.polygon);
    }
    for building in &chunk.footprints {
        [building.id, building.lot, building.storeys.into()].into_iter().for_each(|w| parcel.word(w));
        parcel.line(&building.polygon);
    }
    let layers = [terrain, region, town, streets, parcel].map(Hash::finish);
    layers.into_iter().for_each(|w| all.word(w));
    [chunk.origin.0.x as u64, chunk.origin.0.y as u64, chunk.size as u64, chunk.unmet_ports as u64]
        .into_iter()
        .for_each(|w| all.word(w));
    for junction in &chunk.junctions {
        all.word(junction.id.0);
        all.point(junction.at);
    }
    let [terrain, region, town, streets, parcel] = layers;
    [terrain, region, town, streets, parcel, all.finish(), meshes]
}

/// A hash that is fed exact bits.
#[derive(Default)]
struct Hash(Xxh3);

impl Hash {
    fn word(&mut self, word: u64) {
        self.0.update(&word.to_le_bytes());
    }

    fn float(&mut self, x: f64) {
        self.word(x.to_bits());
    }

    fn point(&mut self, p: DVec2) {
        self.float(p.x);
        self.float(p.y);
    }

    fn line(&mut self, line: &[DVec2]) {
        self.word(line.len() as u64);
        line.iter().for_each(|p| self.point(*p));
    }

    fn text(&mut self, text: &str) {
        self.word(text.len() as u64);
        self.0.update(text.as_bytes());
    }

    fn street(&mut self, placed: &PlacedStreet) {
        let s = &placed.street;
        let made_by = match placed.made_by {
            None => 0,
            Some(MadeBy::Growth) => 1,
            Some(MadeBy::Repair) => 2,
            Some(MadeBy::Patch(index)) => 3 + u64::from(index),
        };
        let flags = u64::from(s.bridge) | u64::from(s.tunnel) << 1;
        [s.id.0, s.from.0, s.to.0, s.level as u64, flags, made_by].into_iter().for_each(|w| self.word(w));
        self.text(s.class.name());
        self.line(&s.line);
    }

    fn buffers(&mut self, buffers: &MeshBuffers) {
        self.word(buffers.positions.len() as u64);
        self.word(buffers.indices.len() as u64);
        let threes = buffers.positions.iter().chain(&buffers.normals).flatten();
        for x in threes.chain(buffers.colours.iter().flatten()) {
            self.0.update(&x.to_bits().to_le_bytes());
        }
        for i in &buffers.indices {
            self.0.update(&i.to_le_bytes());
        }
    }

    fn finish(self) -> u64 {
        self.0.digest()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_visits_every_chunk_once() {
        let all: Vec<_> = (0..20).map(|i| ChunkCoord::new(i / 5 - 2, i % 5)).collect();
        for by in [Order::Forward, Order::Reverse, Order::Shuffled] {
            let mut coords = all.clone();
            order(&mut coords, by, Seed(3));
            assert_eq!(coords == all, by == Order::Forward);
            coords.sort();
            assert_eq!(coords, all);
        }
    }

    #[test]
    fn one_bit_changes_the_hash() {
        let hash = |line: &[DVec2]| {
            let mut hash = Hash::default();
            hash.line(line);
            hash.finish()
        };
        let line = [DVec2::ZERO, DVec2::new(1.0, 2.0)];
        assert_ne!(hash(&line), hash(&[DVec2::ZERO, DVec2::new(1.0, 2.0 + f64::EPSILON * 2.0)]));
        assert_ne!(hash(&line), hash(&[-DVec2::ZERO, line[1]]), "signs of zeros are bits too");
    }
}
