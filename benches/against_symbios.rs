//! The same area made by `symbios-tensor` and by us, in one run, on one thread: nine 512 m tiles against nine 512 m chunks
//! in the middle of a city, streets, blocks, lots and footprints, each thing made once. Prints the mean times of a tile and
//! their ratio.
//!
//! symbios-tensor's spacing is chosen so that it makes about as many kilometres of street as we do; both lengths are
//! printed, since the ratio means little without them.

mod symbios;

use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::SizeClass;
use bevy_sprawl::space::{Bounds, ChunkCoord, Seed};
use bevy_sprawl::world::{World, WorldSource};
use glam::DVec2;
use std::time::Instant;
use symbios_ground::HeightMap;

const TILE: f64 = 512.0;
const ROUNDS: usize = 3;
/// Spacing of symbios-tensor's major and minor roads, in metres.
const SPACING: (f32, f32) = (180.0, 90.0);

fn main() {
    let never = Cancel::new();
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    let (mut our_km, mut their_km, mut our_lots, mut their_lots) = (0.0, 0.0, 0, 0);
    for round in 0..ROUNDS {
        let world = World::new(WorldSource::new(Seed(round as u64))).expect("valid settings");
        let region = Bounds::square(DVec2::ZERO, 100_000.0);
        let cities = world.settlements().centred_in_of(region, SizeClass::City).expect("never cancelled");
        let Some(city) = cities.first() else { continue };
        let middle = ChunkCoord::containing(city.centre.plan(), TILE as i64).0;
        // Where cities lie and which roads join them is work that symbios-tensor does not do.
        let block = ChunkCoord(middle).bounds(TILE as i64).grown(TILE);
        world.town(city, &never).expect("never cancelled");
        world.roads().overlapping(block, &never).expect("never cancelled");
        for (x, y) in (-1..=1).flat_map(|y| (-1..=1).map(move |x| (x, y))) {
            let start = Instant::now();
            let chunk = world.chunk(ChunkCoord::new(middle.x + x, middle.y + y), &never).expect("never cancelled");
            ours.push(start.elapsed().as_secs_f64() * 1000.0);
            our_km += chunk.streets.iter().map(|s| s.street.length()).sum::<f64>() / 1000.0;
            our_lots += chunk.footprints.len();

            let cells = (TILE / f64::from(symbios::CELL)) as usize;
            let ground = |tx: i32, ty: i32, map: &mut HeightMap| {
                for (px, py) in (0..cells).flat_map(|py| (0..cells).map(move |px| (px, py))) {
                    let local = DVec2::new(px as f64, py as f64) * f64::from(symbios::CELL);
                    let p = DVec2::new(f64::from(middle.x + tx), f64::from(middle.y + ty)) * TILE + local;
                    map.set(px, py, world.terrain().height(p) as f32);
                }
            };
            if let Some(tile) = symbios::tile(round as u64, TILE, SPACING, (x, y), ground) {
                theirs.push(tile.ms);
                their_km += tile.km;
                their_lots += tile.lots;
            }
        }
    }
    let (our_mean, their_mean) = (mean(&ours), mean(&theirs));
    let tiles = ours.len();
    println!("{tiles} tiles of {TILE} m in {ROUNDS} cities, one thread");
    println!("bevy_sprawl     {our_mean:8.2} ms a tile, {our_km:.1} km, {our_lots} buildings");
    println!("symbios-tensor  {their_mean:8.2} ms a tile, {their_km:.1} km, {their_lots} lots");
    println!("ratio           {:8.2}", their_mean / our_mean);
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
