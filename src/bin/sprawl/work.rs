//! What commands share: making the world, working on many threads with a progress bar, printing.

use crate::common::{At, Common};
use crate::edits::EditsFile;
use crate::fail::Fail;
use crate::text;
use bevy_sprawl::edits::Edits;
use bevy_sprawl::layer::{self, Cancel};
use bevy_sprawl::space::{Bounds, ChunkCoord, Seed};
use bevy_sprawl::world::{Area, Settings, World, WorldAssets, WorldSource};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::Value;
use std::io::Write;

/// The world that the common flags describe. Each edit that the world cannot fulfil is named in a line on stderr.
pub fn world(common: &Common) -> Result<World, Fail> {
    let written = match &common.settings {
        Some(path) => Some((path.to_string_lossy(), text::read(path)?)),
        None => None,
    };
    let settings = match &written {
        Some((file, text)) => Settings::from_ron(file, text)?,
        None => {
            // One command looks at one square and ends, so nothing that fits in memory should be made twice.
            let mut settings = Settings::default();
            settings.cache.region_mib = settings.cache.region_mib.max(256.0);
            settings.cache.town_mib = settings.cache.town_mib.max(1024.0);
            settings
        }
    };
    let assets = match &common.assets {
        Some(dir) => WorldAssets::from_dir(dir)?,
        None => WorldAssets::bundled(),
    };
    let file = EditsFile::read(common, None)?;
    let edits = file.as_ref().map_or_else(Edits::default, |f| f.edits.clone());
    let source = WorldSource { settings, assets, edits, ..WorldSource::new(Seed(common.seed())) };
    let world = World::new(source.clone()).map_err(|e| {
        let in_settings = || written.as_ref().and_then(|(name, text)| e.in_settings(&source.settings, name, text));
        match (source.assets.locate(&e).or_else(in_settings), &common.assets) {
            (Some(located), _) => located.into(),
            // What the settings say by default is not in the folder.
            (None, Some(folder)) => Fail::file(folder, e),
            (None, None) => e.into(),
        }
    })?;
    if let Some(file) = file {
        file.warn(common, &world.rejected_edits(&Cancel::new())?);
    }
    Ok(world)
}

/// Names on stderr the settlements that no road leads to.
pub fn warn_of_unreached(names: &[impl AsRef<str>]) {
    if !names.is_empty() {
        let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
        eprintln!("sprawl: warning: no road leads to {}", names.join(", "));
    }
}

/// The square of edge `size` around `at`, if the world's chunks reach that far.
pub fn square(world: &World, at: &At, size: f64) -> Result<Bounds, Fail> {
    let edge = world.settings().chunk_size as f64;
    // Chunk coordinates have 32 bits, and things in the square may reach beyond it.
    let most = edge * f64::from(i32::MAX) - 500_000.0;
    if at.at.abs().max_element() > most {
        return Err(Fail::input(format!("--at is too far out: at most {most:.0} m with chunks of {edge} m")));
    }
    Ok(Bounds::square(at.at, size))
}

/// The chunks that overlap a box, column by column.
pub fn chunks(world: &World, bounds: Bounds) -> Vec<ChunkCoord> {
    let size = world.settings().chunk_size;
    let (a, b) = (ChunkCoord::containing(bounds.min, size).0, ChunkCoord::containing(bounds.max, size).0);
    // A border on a chunk's west or south edge does not reach into that chunk.
    let last = |to: i32, border: f64, from: i32| {
        if f64::from(to) * size as f64 == border && to > from { to - 1 } else { to }
    };
    let (x, y) = (last(b.x, bounds.max.x, a.x), last(b.y, bounds.max.y, a.y));
    (a.x..=x).flat_map(|x| (a.y..=y).map(move |y| ChunkCoord::new(x, y))).collect()
}

/// Runs `make` on every item, on as many threads as the flags say; results come in the order of the items. A bar shows the
/// progress if stderr is a terminal.
pub fn each<T: Sync, R: Send>(
    common: &Common,
    what: &'static str,
    items: &[T],
    make: impl Fn(&T) -> Result<R, Fail> + Sync,
) -> Result<Vec<R>, Fail> {
    let bar = ProgressBar::new(items.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{msg} {bar:30} {pos}/{len} {eta}") {
        bar.set_style(style);
    }
    bar.set_message(what);
    let made = layer::each(threads(common), items, make, |_| bar.inc(1));
    bar.finish_and_clear();
    made
}

/// As many threads as the flags say.
pub fn threads(common: &Common) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    common.threads.map_or_else(cores, usize::from)
}

/// A pool of as many threads as the flags say, for what draws pictures.
pub fn pool(common: &Common) -> Result<rayon::ThreadPool, Fail> {
    rayon::ThreadPoolBuilder::new().num_threads(threads(common)).build().map_err(|e| Fail::World(e.to_string()))
}

/// Everything in a square, its chunks made on many threads first.
pub fn area(common: &Common, world: &World, bounds: Bounds) -> Result<Area, Fail> {
    let cancel = Cancel::new();
    let size = world.settings().chunk_size as f64;
    // The world keeps the towns and cells of these squares of 2 by 2 chunks, so gathering the whole square finds them made.
    let tiles = (bounds.size() / (2.0 * size)).ceil().max(glam::DVec2::ONE);
    let step = bounds.size() / tiles;
    let corner =
        |i: usize| bounds.min + step * glam::DVec2::new((i % tiles.x as usize) as f64, (i / tiles.x as usize) as f64);
    let tiles: Vec<Bounds> =
        (0..(tiles.x * tiles.y) as usize).map(|i| Bounds::new(corner(i), corner(i) + step)).collect();
    if tiles.len() > 1 {
        each(common, "making streets", &tiles, |tile| Ok(world.area(*tile, &cancel).map(|_| ())?))?;
    }
    Ok(world.area(bounds, &cancel)?)
}

/// Prints one JSON object, with the rejected edits if there is a file of edits, or the lines for people.
pub fn print(common: &Common, json: &Value, people: &str) -> Result<(), Fail> {
    let mut out = std::io::stdout().lock();
    if common.json {
        let mut json = json.clone();
        if let (Some(rejected), Some(fields)) = (common.rejected.get(), json.as_object_mut()) {
            fields.insert("rejected_edits".into(), rejected.clone().into());
        }
        writeln!(out, "{json}")?;
    } else if !people.is_empty() {
        writeln!(out, "{}", people.trim_end())?;
    }
    Ok(())
}
