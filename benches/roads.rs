//! The experiments of Galin et al. 2011, section 8 (tables 2 and 3), on generated ground of the same sizes, on one thread.

use bevy_sprawl::region::{RoadNetwork, RoadSettings, Settlement, SettlementId, SizeClass};
use bevy_sprawl::space::{Origin, Seed};
use bevy_sprawl::terrain::{NoiseTerrain, Raster, RasterTerrain, Terrain, TerrainSettings};
use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec2;
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Edge of the domain in metres.
const EDGE: f64 = 200_000.0;

struct Case {
    name: &'static str,
    /// Cells along the domain.
    cells: usize,
    /// Cities, towns and villages.
    counts: [usize; 3],
    /// What the paper reports, in seconds.
    paper: f64,
}

/// Tables 2 and 3 of the paper.
const CASES: [Case; 6] = [
    Case { name: "128 x 128", cells: 128, counts: [4, 16, 70], paper: 23.2 },
    Case { name: "256 x 256", cells: 256, counts: [4, 16, 70], paper: 112.7 },
    Case { name: "512 x 512", cells: 512, counts: [4, 16, 70], paper: 625.3 },
    Case { name: "3, 10, 37", cells: 256, counts: [3, 10, 37], paper: 89.1 },
    Case { name: "5, 45, 97", cells: 256, counts: [5, 45, 97], paper: 119.2 },
    Case { name: "10, 107, 204", cells: 256, counts: [10, 107, 204], paper: 146.8 },
];

/// Hills, mountains and a sea, as the paper's scenes have them, sampled once for each cell.
fn ground(cells: usize) -> RasterTerrain {
    let settings =
        TerrainSettings { continent_size: 150_000.0, mountain_height: 1_500.0, ..TerrainSettings::default() };
    let noise = NoiseTerrain::new(Seed(4), &settings);
    let step = EDGE / cells as f64;
    let at = |i: usize| DVec2::new((i % cells) as f64 + 0.5, (i / cells) as f64 + 0.5) * step;
    // The bed of the sea, and the surface of rivers and lakes: as wide as a cell they would be walls.
    let heights = (0..cells * cells).map(|i| noise.sample(at(i)).height as f32).collect();
    let raster = Raster::new(cells, cells, DVec2::ZERO, DVec2::splat(step), heights).expect("the raster is valid");
    RasterTerrain::new(raster).and_then(|t| t.with_sea_level(0.0)).expect("heights are in range")
}

/// Settlements at random on dry, level ground, larger ones further apart.
fn settlements(counts: [usize; 3], ground: &dyn Terrain) -> Vec<Settlement> {
    let mut random = Seed(9).stream("bench", &[]);
    let mut out: Vec<Settlement> = Vec::new();
    for (size, count, radius) in [
        (SizeClass::City, counts[0], 1_400.0),
        (SizeClass::Town, counts[1], 620.0),
        (SizeClass::Village, counts[2], 220.0),
    ] {
        let least = 0.45 * EDGE / (out.len() as f64 + count as f64).sqrt();
        let wanted = out.len() + count;
        while out.len() < wanted {
            let at = DVec2::new(random.range(0.03, 0.97), random.range(0.03, 0.97)) * EDGE;
            let apart = out.iter().all(|o| o.centre.plan().distance(at) > least);
            if apart && ground.sample(at).depth() == 0.0 && ground.gradient(at, 1_000.0).length() < 0.1 {
                let id = SettlementId(out.len() as u64 + 1);
                let name = format!("{size:?} {}", id.0);
                out.push(Settlement { id, centre: Origin::at(at), radius, size, style: String::new(), name });
            }
        }
    }
    out
}

/// Time that this thread has had a processor, where the system says; else the time of day. Other work on the machine counts
/// in the second only.
fn clock(start: Instant) -> Duration {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanos = text.split_whitespace().next().and_then(|n| n.parse().ok());
    nanos.map_or_else(|| start.elapsed(), Duration::from_nanos)
}

fn build(case: &Case, ground: &Arc<RasterTerrain>, all: &[Settlement]) -> RoadNetwork {
    let settings = RoadSettings::finite((EDGE / case.cells as f64) as i64);
    RoadNetwork::build(ground.bounds(), ground.clone(), all, &settings).expect("the case is valid")
}

fn roads(c: &mut Criterion) {
    println!("{:14} {:>7} {:>9} {:>10} {:>10} {:>8}", "", "roads", "km", "paper, s", "ours, s", "ratio");
    let start = Instant::now();
    for case in &CASES {
        let ground = Arc::new(ground(case.cells));
        let all = settlements(case.counts, &*ground);
        let mut best = Duration::MAX;
        let mut network = None;
        for _ in 0..3 {
            let before = clock(start);
            network = Some(build(case, &ground, &all));
            best = best.min(clock(start) - before);
        }
        let Some(network) = network else { continue };
        let seconds = best.as_secs_f64();
        let (links, km) = (network.links.len(), network.length() / 1000.0);
        println!(
            "{:14} {links:>7} {km:>9.0} {:>10.1} {seconds:>10.3} {:>8.0}",
            case.name,
            case.paper,
            case.paper / seconds
        );
        assert!(network.unreached.is_empty(), "{:?}", network.unreached);
        c.bench_function(&format!("roads/{}", case.name), |b| b.iter(|| black_box(build(case, &ground, &all))));
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).measurement_time(Duration::from_secs(5));
    targets = roads
}
criterion_main!(benches);
