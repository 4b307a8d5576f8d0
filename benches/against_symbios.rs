//! The same area made by `symbios-tensor` and by us, in one run, on one thread: 512 m tiles against 512 m chunks in the
//! middle of a city, streets, blocks, lots and footprints. Prints the medians and their ratio.
//!
//! symbios-tensor's roads are spaced as our grid style measures (main streets about 260 m, local streets about 95 m apart).

use bevy_sprawl::layer::Cancel;
use bevy_sprawl::region::SizeClass;
use bevy_sprawl::space::{Bounds, ChunkCoord, Seed};
use bevy_sprawl::world::{Settings, World, WorldAssets};
use glam::DVec2;
use std::time::Instant;
use symbios_ground::HeightMap;
use symbios_tensor::{CityStreamer, CityStreamerConfig, LotConfig, RationalizeConfig, TensorConfig};

const TILE: f64 = 512.0;
const ROUNDS: usize = 3;

fn main() {
    let never = Cancel::new();
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    let (mut our_streets, mut their_edges, mut our_lots, mut their_lots) = (0, 0, 0, 0);
    for round in 0..ROUNDS {
        let world =
            World::new(Seed(round as u64), Settings::default(), WorldAssets::bundled()).expect("valid settings");
        let region = Bounds::square(DVec2::ZERO, 100_000.0);
        let cities = world.settlements().centred_in_of(region, SizeClass::City).expect("never cancelled");
        let Some(city) = cities.first() else { continue };
        world.town(city, &never).expect("never cancelled");
        let middle = ChunkCoord::containing(city.centre.plan(), TILE as i64).0;
        for (x, y) in (-1..=1).flat_map(|y| (-1..=1).map(move |x| (x, y))) {
            let start = Instant::now();
            world.forget_chunks();
            let chunk = world.chunk(ChunkCoord::new(middle.x + x, middle.y + y), &never).expect("never cancelled");
            ours.push(start.elapsed().as_secs_f64() * 1000.0);
            our_streets += chunk.streets.len();
            our_lots += chunk.footprints.len();

            let config = CityStreamerConfig {
                tile_size: TILE as f32,
                base_seed: round as u64,
                tensor: TensorConfig {
                    major_road_dist: 260.0,
                    minor_road_dist: 95.0,
                    snap_radius: 12.0,
                    ..Default::default()
                },
                rationalize: RationalizeConfig::default(),
                lots: LotConfig { max_lot_area: 600.0, ..Default::default() },
            };
            let start = Instant::now();
            let ground = (TILE / 8.0) as usize;
            let mut streamer = CityStreamer::new(config, |tx, ty| {
                let mut map = HeightMap::new(ground, ground, 8.0);
                for (px, py) in (0..ground).flat_map(|py| (0..ground).map(move |px| (px, py))) {
                    let local = DVec2::new(px as f64, py as f64) * 8.0;
                    let p = DVec2::new(f64::from(middle.x + tx), f64::from(middle.y + ty)) * TILE + local;
                    map.set(px, py, world.terrain().height(p) as f32);
                }
                map
            });
            match streamer.ensure_tile(x, y) {
                Ok(tile) => {
                    their_edges += tile.graph.edges.len();
                    their_lots += tile.lots.len();
                }
                Err(error) => println!("symbios-tensor: {error}"),
            }
            theirs.push(start.elapsed().as_secs_f64() * 1000.0);
        }
    }
    let (our_median, their_median) = (median(&mut ours), median(&mut theirs));
    let tiles = ours.len();
    println!("{tiles} tiles of {TILE} m, one thread, nothing of the tile kept between rounds");
    println!("bevy_sprawl     {our_median:8.2} ms median, {our_streets} streets, {our_lots} buildings");
    println!("symbios-tensor  {their_median:8.2} ms median, {their_edges} edges, {their_lots} lots");
    println!("ratio           {:8.2}", their_median / our_median);
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
