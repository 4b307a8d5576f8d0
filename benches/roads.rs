//! The experiments of Galin et al. 2011 (table 1 of section 5, tables 2 and 3 of section 8), on generated ground of the same
//! sizes, on one thread.

mod clock;

use bevy_sprawl::edits::Edits;
use bevy_sprawl::network::SizeClass;
use bevy_sprawl::network::StreetClass;
use bevy_sprawl::region::{RoadNetwork, RoadSettings, Settlement, SettlementId};
use bevy_sprawl::space::{Origin, Seed, math};
use bevy_sprawl::terrain::{NoiseTerrain, Raster, RasterTerrain, Terrain, TerrainSettings};
use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec2;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

/// Edge of the domain of tables 2 and 3 in metres.
const EDGE: f64 = 200_000.0;
/// Edge of the domain of table 1 in metres, and cells along it.
const DENSITY: (f64, usize) = (128_000.0, 256);
/// Table 1 of the paper: gamma, then number and kilometres of highways, major and minor roads. The last is not in it: the
/// relative neighbour graph.
const DENSITIES: [(f64, [(usize, f64); 3]); 4] = [
    (1.2, [(3, 194.0), (19, 700.0), (70, 269.0)]),
    (2.0, [(2, 96.0), (11, 383.0), (39, 371.0)]),
    (8.0, [(2, 96.0), (9, 290.0), (29, 368.0)]),
    (f64::INFINITY, [(0, 0.0); 3]),
];

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
fn ground(cells: usize, edge: f64) -> RasterTerrain {
    let settings =
        TerrainSettings { continent_size: 150_000.0, mountain_height: 1_500.0, ..TerrainSettings::default() };
    let noise = NoiseTerrain::new(Seed(4), &settings);
    let step = edge / cells as f64;
    let at = |i: usize| DVec2::new((i % cells) as f64 + 0.5, (i / cells) as f64 + 0.5) * step;
    // The bed of the sea, and the surface of rivers and lakes: as wide as a cell they would be walls.
    let heights = (0..cells * cells).map(|i| noise.sample(at(i)).height as f32).collect();
    let raster = Raster::new(cells, cells, DVec2::ZERO, DVec2::splat(step), heights).expect("the raster is valid");
    RasterTerrain::new(raster).and_then(|t| t.with_sea_level(0.0)).expect("heights are in range")
}

/// Settlements at random on dry, level ground, larger ones further apart.
fn settlements(counts: [usize; 3], ground: &RasterTerrain) -> Vec<Settlement> {
    let edge = ground.bounds().size().x;
    let mut random = Seed(9).stream("bench", &[]);
    let mut out: Vec<Settlement> = Vec::new();
    for (size, count, radius) in [
        (SizeClass::City, counts[0], 1_400.0),
        (SizeClass::Town, counts[1], 620.0),
        (SizeClass::Village, counts[2], 220.0),
    ] {
        let least = 0.45 * edge / (out.len() as f64 + count as f64).sqrt();
        let wanted = out.len() + count;
        while out.len() < wanted {
            let at = DVec2::new(random.range(0.03, 0.97), random.range(0.03, 0.97)) * edge;
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

fn build(ground: &Arc<RasterTerrain>, all: &[Settlement], cells: usize, gamma: Option<f64>) -> RoadNetwork {
    let mut settings = RoadSettings::finite((ground.bounds().size().x / cells as f64) as i64);
    for tier in [&mut settings.highway, &mut settings.major, &mut settings.minor] {
        tier.gamma = gamma.unwrap_or(tier.gamma);
    }
    RoadNetwork::build(ground.bounds(), ground.clone(), all, &settings, &Edits::default()).expect("the case is valid")
}

/// The best of three times, in seconds, and the network.
fn best(make: impl Fn() -> RoadNetwork) -> (f64, RoadNetwork) {
    let (mut best, network) = clock::timed(&make);
    for _ in 0..2 {
        best = best.min(clock::timed(&make).0);
    }
    (best.as_secs_f64(), network)
}

/// Table 1: the greater gamma, the fewer and shorter the roads.
fn densities(_: &mut Criterion) {
    let (edge, cells) = DENSITY;
    let ground = Arc::new(ground(cells, edge));
    let all = settlements([3, 6, 16], &ground);
    println!("\ntable 1: roads and kilometres by class (the paper's in brackets), and seconds");
    println!("{:>6} {:>22} {:>22} {:>22} {:>8}", "gamma", "highway", "major", "minor", "s");
    let mut before = (usize::MAX, f64::INFINITY);
    for (gamma, paper) in DENSITIES {
        let (seconds, network) = best(|| build(&ground, &all, cells, Some(gamma)));
        let classes = [StreetClass::Highway, StreetClass::Major, StreetClass::Minor];
        let columns = classes.iter().zip(paper).map(|(class, (n, km))| {
            let links = network.links.iter().filter(|l| l.class == *class);
            let (count, metres) = links.fold((0, 0.0), |(n, m), l| (n + 1, m + l.length_m));
            let theirs = if n > 0 { format!("({n:>3} {km:>4.0})") } else { " ".repeat(10) };
            format!("{count:>4} {:>5.0} {theirs}", metres / 1000.0)
        });
        println!("{gamma:>6} {} {seconds:>8.3}", columns.map(|c| format!("{c:>22}")).collect::<Vec<_>>().join(" "));
        let now = (network.links.len(), network.length());
        assert!(now.0 <= before.0 && now.1 <= before.1, "gamma {gamma} makes more roads: {now:?}, {before:?}");
        before = now;
    }
}

/// Tables 2 and 3: the time over cells and roads.
fn roads(c: &mut Criterion) {
    println!("\ntables 2 and 3: time, the paper's, and time for each cell and road");
    println!(
        "{:14} {:>7} {:>9} {:>10} {:>10} {:>8} {:>14}",
        "", "roads", "km", "paper, s", "ours, s", "ratio", "ns/cell/road"
    );
    let mut work = Vec::new();
    for case in &CASES {
        let ground = Arc::new(ground(case.cells, EDGE));
        let all = settlements(case.counts, &ground);
        let (seconds, network) = best(|| build(&ground, &all, case.cells, None));
        let (links, km) = (network.links.len(), network.length() / 1000.0);
        let size = (case.cells * case.cells * links) as f64;
        work.push((size, seconds));
        println!(
            "{:14} {links:>7} {km:>9.0} {:>10.1} {seconds:>10.3} {:>8.0} {:>14.2}",
            case.name,
            case.paper,
            case.paper / seconds,
            seconds / size * 1e9
        );
        assert!(network.unreached.is_empty(), "{:?}", network.unreached);
        c.bench_function(&format!("roads/{}", case.name), |b| {
            b.iter(|| black_box(build(&ground, &all, case.cells, None)));
        });
    }
    for (name, cases) in [("cells", &work[..3]), ("roads", &work[3..])] {
        if let [(low, first), .., (high, last)] = cases {
            println!("time grows with the {:.2}th power of {name}", math::ln(last / first) / math::ln(high / low));
        }
    }
}

/// Heights with straits too wide for any bridge, which divide the land into `count` x `count` islands.
fn islands(cells: usize, edge: f64, count: usize) -> RasterTerrain {
    let step = edge / cells as f64;
    let width = (5_000.0 / step).ceil() as usize;
    let is_strait = |i: usize| i % (cells / count) < width;
    let land = ground(cells, edge);
    let height = |n: usize| {
        let (x, y) = (n % cells, n / cells);
        let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * step;
        if is_strait(x) || is_strait(y) { -300.0 } else { land.height(at).max(2.0) as f32 }
    };
    let heights = (0..cells * cells).map(height).collect();
    let raster = Raster::new(cells, cells, DVec2::ZERO, DVec2::splat(step), heights).expect("the raster is valid");
    RasterTerrain::new(raster).and_then(|t| t.with_sea_level(0.0)).expect("heights are in range")
}

/// The problem of table 2 with few and with many roads: time must grow no faster than the number of roads allows.
fn dense(_: &mut Criterion) {
    let (cells, counts) = (256, [4, 16, 70]);
    let ground = Arc::new(ground(cells, EDGE));
    let all = settlements(counts, &ground);
    println!("\ndense networks: {counts:?} settlements on {cells} x {cells} cells");
    let times = [2.0, 1.2].map(|gamma| {
        let (seconds, network) = best(|| build(&ground, &all, cells, Some(gamma)));
        println!("gamma {gamma:<8} {:>7} roads {seconds:>10.3} s", network.links.len());
        seconds
    });
    println!("gamma 1.2 takes {:.1} times as long as gamma 2", times[1] / times[0]);
}

/// The same number of settlements on one landmass and on nine islands: pairs that no land joins must not take longer.
fn landmasses(_: &mut Criterion) {
    let (cells, counts) = (256, [5, 45, 97]);
    println!("\nlandmasses: time for {counts:?} settlements on {cells} x {cells} cells");
    let time = |name: &str, ground: RasterTerrain| {
        let ground = Arc::new(ground);
        let all = settlements(counts, &ground);
        let (seconds, network) = best(|| build(&ground, &all, cells, None));
        println!("{name:14} {:>7} roads {seconds:>10.3} s", network.links.len());
        seconds
    };
    let (one, nine) = (time("one", ground(cells, EDGE)), time("nine islands", islands(cells, EDGE, 3)));
    assert!(nine < 3.0 * one, "islands take {nine} s, one landmass {one} s");
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).measurement_time(Duration::from_secs(5));
    targets = densities, dense, roads, landmasses
}
criterion_main!(benches);
