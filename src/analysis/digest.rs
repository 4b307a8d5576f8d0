//! Hashes of the exact bits of chunks, layer by layer: two worlds are the same where their digests are.

use crate::chunk::Chunk;
use crate::layer::{Cancel, LayerError};
use crate::mesh::{self, Detail, MeshBuffers};
use crate::parcel::BlockUse;
use crate::space::ChunkCoord;
use crate::stack::PlacedStreet;
use crate::streets::StreetOrigin;
use crate::world::World;
use glam::DVec2;
use std::collections::BTreeMap;
use xxhash_rust::xxh3::Xxh3;

/// Layers that are hashed: `chunk` is all that a chunk owns, `mesh` its buffers at both levels of detail.
pub const LAYERS: [&str; 7] = ["terrain", "region", "town", "streets", "parcel", "chunk", "mesh"];

/// Hashes of one chunk, one for each of [`LAYERS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChunkDigest(pub [u64; LAYERS.len()]);

impl ChunkDigest {
    /// Makes a chunk and its meshes, and hashes them.
    ///
    /// # Errors
    /// What making the chunk fails with.
    pub fn new(world: &World, coord: ChunkCoord, cancel: &Cancel) -> Result<Self, LayerError> {
        let chunk = world.chunk(coord, cancel)?;
        let mut meshes = Hash::default();
        for detail in [Detail::Full, Detail::Reduced] {
            let mesh = mesh::build(&chunk, &**world.terrain(), detail, cancel)?;
            mesh.parts().for_each(|(_, buffers)| meshes.buffers(buffers));
        }
        Ok(Self(content(&chunk, meshes.finish())))
    }

    /// One hash of all layers.
    pub fn total(&self) -> u64 {
        Hash::of(self.0)
    }
}

/// Hashes of many chunks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Digest {
    /// One hash of all chunks for each of [`LAYERS`].
    pub layers: [u64; LAYERS.len()],
    /// One hash of all layers for each chunk.
    pub chunks: BTreeMap<ChunkCoord, u64>,
    /// One hash of everything.
    pub total: u64,
}

impl Digest {
    /// The digest of chunks, which does not depend on their order here.
    pub fn new(chunks: impl IntoIterator<Item = (ChunkCoord, ChunkDigest)>) -> Self {
        let by_coord: BTreeMap<ChunkCoord, ChunkDigest> = chunks.into_iter().collect();
        let layers = std::array::from_fn(|layer| Hash::of(by_coord.values().map(|c| c.0[layer])));
        let chunks: BTreeMap<ChunkCoord, u64> = by_coord.iter().map(|(coord, c)| (*coord, c.total())).collect();
        let total = Hash::of(chunks.values().copied());
        Self { layers, chunks, total }
    }
}

/// Hashes of what a chunk owns; `meshes` is the hash of its meshes.
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
        parcel.word(u64::from(block.land_use == BlockUse::Park));
        parcel.line(&block.polygon);
    }
    for lot in &chunk.lots {
        [lot.id, lot.block, lot.street.0].into_iter().for_each(|w| parcel.word(w));
        parcel.line(&lot.polygon);
    }
    for building in &chunk.footprints {
        [building.id, building.lot, building.storeys.into()].into_iter().for_each(|w| parcel.word(w));
        parcel.line(&building.polygon);
        [building.base, building.height].into_iter().for_each(|h| parcel.float(h));
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
    fn of(words: impl IntoIterator<Item = u64>) -> u64 {
        let mut hash = Self::default();
        words.into_iter().for_each(|w| hash.word(w));
        hash.finish()
    }

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
        let made_by = match placed.made_by.as_ref().map(|made_by| &made_by.origin) {
            None => 0,
            Some(StreetOrigin::Growth) => 1,
            Some(StreetOrigin::Repair) => 2,
            Some(StreetOrigin::Piece(_)) => 3,
        };
        let island = s.island.map_or(0, |side| 1 + side as u64);
        let flags = u64::from(s.bridge) | u64::from(s.tunnel) << 1 | island << 2;
        [s.id.0, s.from.0, s.to.0, s.level as u64, flags, made_by].into_iter().for_each(|w| self.word(w));
        self.text(s.class.name());
        self.line(&s.line);
    }

    fn buffers(&mut self, buffers: &MeshBuffers) {
        self.word(buffers.positions.len() as u64);
        self.word(buffers.indices.len() as u64);
        for x in buffers.positions.iter().flatten() {
            self.0.update(&x.to_bits().to_le_bytes());
        }
        for x in buffers.normals.iter().flatten() {
            self.0.update(&x.to_le_bytes());
        }
        for x in buffers.colours.iter().flatten() {
            self.0.update(&x.to_le_bytes());
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
