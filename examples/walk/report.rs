//! Measures of the walk, and the report.

use crate::headless::Phase;
use crate::tour::Tour;
use bevy::prelude::Resource;
use bevy_sprawl::prelude::SprawlStats;
use std::fmt::Write;
use std::path::Path;
use std::time::{Duration, Instant};

/// Memory is compared from this frame on. The first screenshot, which starts the renderer, is taken earlier.
const MEMORY_FROM: usize = 120;

/// Measures of the walk.
#[derive(Resource)]
pub struct Measures {
    /// Time to make the world, before the first frame.
    making: Duration,
    first_frame: Option<Instant>,
    frame: Instant,
    frame_ms: Vec<f32>,
    plugin_ms: Vec<f32>,
    holes: u64,
    first_chunk: Option<Duration>,
    /// Time in which tasks were in flight.
    busy: Duration,
    made_before: u64,
    rss_start: f64,
    /// Memory at the end of each lap, in MB.
    rss_laps: Vec<f64>,
}

impl Measures {
    pub fn new(making: Duration) -> Self {
        Self {
            making,
            first_frame: None,
            frame: Instant::now(),
            frame_ms: Vec::new(),
            plugin_ms: Vec::new(),
            holes: 0,
            first_chunk: None,
            busy: Duration::ZERO,
            made_before: 0,
            rss_start: 0.0,
            rss_laps: Vec::new(),
        }
    }

    pub fn begin_frame(&mut self) {
        let now = Instant::now();
        self.first_frame.get_or_insert(now);
        self.frame = now;
    }

    /// Notes that the first chunk under the walker is loaded.
    pub fn first_chunk(&mut self) {
        let since = self.first_frame.map_or(Duration::ZERO, |f| f.elapsed());
        self.first_chunk.get_or_insert(self.making + since);
    }

    pub fn start_walk(&mut self, stats: &SprawlStats) {
        self.made_before = stats.chunks_made;
    }

    /// Measures a frame of the walk from its first to its last system. Pauses between frames and the frames around
    /// screenshots are left out.
    pub fn end_frame(&mut self, phase: Phase, stats: &SprawlStats, tour: &Tour, ground: impl FnOnce() -> bool) {
        if tour.laps_done() > self.rss_laps.len() {
            self.rss_laps.push(rss_mb());
        }
        if phase != Phase::Walk {
            return;
        }
        if self.frame_ms.len() <= MEMORY_FROM {
            self.rss_start = rss_mb();
        }
        self.frame_ms.push(self.frame.elapsed().as_secs_f32() * 1000.0);
        self.plugin_ms.push(stats.main_thread_ms);
        self.holes += u64::from(!ground());
        if stats.tasks_in_flight > 0 {
            self.busy += Duration::from_secs_f64(1.0 / crate::headless::RATE).max(self.frame.elapsed());
        }
    }

    pub fn report(&self, stats: &SprawlStats, tour: &Tour) -> Report {
        let made = stats.chunks_made - self.made_before;
        Report {
            frames: self.frame_ms.len(),
            frame_ms_p50: percentile(&self.frame_ms, 0.5),
            frame_ms_p99: percentile(&self.frame_ms, 0.99),
            plugin_ms_p99: percentile(&self.plugin_ms, 0.99),
            plugin_ms_max: percentile(&self.plugin_ms, 1.0),
            chunks_made: stats.chunks_made,
            chunks_failed: stats.chunks_failed,
            chunks_per_s: made as f64 / self.busy.as_secs_f64().max(1e-3),
            chunk_ms: f64::from(stats.chunk_ms),
            tiles: stats.tiles_loaded,
            tiles_made: stats.tiles_made,
            tile_ms: f64::from(stats.tile_ms),
            holes: self.holes,
            first_chunk_ms: self.first_chunk.map_or(-1.0, |d| d.as_secs_f64() * 1000.0),
            rss_start_mb: self.rss_start,
            rss_end_mb: rss_mb(),
            rss_lap_mb: self.rss_laps.clone(),
            distance_m: tour.walked,
        }
    }
}

/// The figures of a walk.
pub struct Report {
    pub frames: usize,
    pub frame_ms_p50: f64,
    pub frame_ms_p99: f64,
    pub plugin_ms_p99: f64,
    pub plugin_ms_max: f64,
    pub chunks_made: u64,
    pub chunks_failed: u64,
    /// Chunks made per second with tasks in flight.
    pub chunks_per_s: f64,
    /// Mean time of a task in milliseconds.
    pub chunk_ms: f64,
    /// Tiles of the horizon at the end.
    pub tiles: usize,
    pub tiles_made: u64,
    /// Mean time of a task that makes a tile, in milliseconds.
    pub tile_ms: f64,
    /// Frames in which the ground under the walker was missing.
    pub holes: u64,
    /// Milliseconds from making the world to the first ground under the walker; -1 if there never was any.
    pub first_chunk_ms: f64,
    pub rss_start_mb: f64,
    pub rss_end_mb: f64,
    /// Memory at the end of each lap, in MB.
    pub rss_lap_mb: Vec<f64>,
    pub distance_m: f64,
}

impl Report {
    fn json(&self) -> String {
        let fields = [
            ("frames", self.frames as f64),
            ("frame_ms_p50", self.frame_ms_p50),
            ("frame_ms_p99", self.frame_ms_p99),
            ("plugin_ms_p99", self.plugin_ms_p99),
            ("plugin_ms_max", self.plugin_ms_max),
            ("chunks_made", self.chunks_made as f64),
            ("chunks_failed", self.chunks_failed as f64),
            ("chunks_per_s", self.chunks_per_s),
            ("chunk_ms", self.chunk_ms),
            ("tiles", self.tiles as f64),
            ("tiles_made", self.tiles_made as f64),
            ("tile_ms", self.tile_ms),
            ("holes", self.holes as f64),
            ("first_chunk_ms", self.first_chunk_ms),
            ("rss_start_mb", self.rss_start_mb),
            ("rss_end_mb", self.rss_end_mb),
            ("distance_m", self.distance_m),
        ];
        let mut out = String::from("{\n");
        for (name, value) in fields {
            let rounded = (value * 1000.0).round() / 1000.0;
            writeln!(out, "  \"{name}\": {rounded},").expect("a string takes everything");
        }
        let laps: Vec<String> = self.rss_lap_mb.iter().map(|mb| format!("{mb:.1}")).collect();
        out + &format!("  \"rss_lap_mb\": [{}]\n}}\n", laps.join(", "))
    }

    /// The report in a few lines of text.
    pub fn summary(&self, tour: &Tour) -> String {
        let place = tour.town.as_ref().map_or("open country".into(), |t| t.name.clone());
        let way = if tour.on_streets { "along its streets" } else { "in a straight line" };
        format!(
            "Walked {:.0} m through {place}, {way}, at {:.0} m/s: {} frames, {} of them without ground underfoot.\n  \
             frame        {:.2} ms median, {:.2} ms p99 (the plugin {:.2} ms p99)\n  \
             chunks       {} made, {:.1} ms each, {:.0} per second; the first after {:.0} ms\n  \
             horizon      {} tiles, {} made, {:.1} ms each\n  \
             memory       {:.0} MB at the start, {:.0} MB at the end",
            self.distance_m,
            tour.pace,
            self.frames,
            self.holes,
            self.frame_ms_p50,
            self.frame_ms_p99,
            self.plugin_ms_p99,
            self.chunks_made,
            self.chunk_ms,
            self.chunks_per_s,
            self.first_chunk_ms,
            self.tiles,
            self.tiles_made,
            self.tile_ms,
            self.rss_start_mb,
            self.rss_end_mb,
        )
    }
}

pub fn write_report(file: &Path, report: &Report) -> std::io::Result<()> {
    std::fs::write(file, report.json())
}

fn percentile(values: &[f32], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f32::total_cmp);
    let at = (share * sorted.len().saturating_sub(1) as f64).round() as usize;
    sorted.get(at).copied().map_or(0.0, f64::from)
}

/// Memory of the process in megabytes; 0 where it is not known.
fn rss_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmRSS:"));
    line.and_then(|l| l.trim().trim_end_matches("kB").trim().parse::<f64>().ok()).map_or(0.0, |kib| kib / 1024.0)
}
