//! Tiles made by `symbios-tensor`, to compare with.

use std::time::Instant;
use symbios_ground::HeightMap;
use symbios_tensor::{CityStreamer, CityStreamerConfig, LotConfig, RationalizeConfig, TensorConfig};

/// Distance between the samples of the ground, in metres.
pub const CELL: f32 = 8.0;

/// What one tile took and holds.
pub struct Tile {
    pub ms: f64,
    pub km: f64,
    pub lots: usize,
}

/// Makes the tile at `(x, y)`, `edge` metres wide, with major and minor roads about so many metres apart. The time to sample
/// the ground counts.
pub fn tile(
    seed: u64,
    edge: f64,
    (major, minor): (f32, f32),
    (x, y): (i32, i32),
    ground: impl Fn(i32, i32, &mut HeightMap),
) -> Option<Tile> {
    let config = CityStreamerConfig {
        tile_size: edge as f32,
        base_seed: seed,
        tensor: TensorConfig { major_road_dist: major, minor_road_dist: minor, snap_radius: 4.0, ..Default::default() },
        rationalize: RationalizeConfig::default(),
        lots: LotConfig { max_lot_area: 600.0, ..Default::default() },
    };
    let start = Instant::now();
    let cells = (edge / f64::from(CELL)) as usize;
    let mut streamer = CityStreamer::new(config, |x, y| {
        let mut map = HeightMap::new(cells, cells, CELL);
        ground(x, y, &mut map);
        map
    });
    match streamer.ensure_tile(x, y) {
        Ok(tile) => {
            let at = |id| tile.graph.node_pos(id);
            let live = tile.graph.edges.iter().filter(|e| e.active);
            let km = live.map(|e| f64::from(at(e.start).distance(at(e.end)))).sum::<f64>() / 1000.0;
            let lots = tile.lots.len();
            Some(Tile { ms: start.elapsed().as_secs_f64() * 1000.0, km, lots })
        }
        Err(error) => {
            println!("symbios-tensor: {error}");
            None
        }
    }
}
