//! `sprawl soak --windows`: checks that roads of far windows are the same alone and after larger windows around them.

use crate::common::{Common, Flag};
use crate::fail::Fail;
use crate::soak::SoakArgs;
use crate::work;
use bevy_sprawl::layer::{Cancel, LayerError};
use bevy_sprawl::region::{RoadSection, Settlement};
use bevy_sprawl::space::{Bounds, Seed, line_length};
use bevy_sprawl::world::{World, WorldSource};
use glam::DVec2;
use serde_json::json;
use std::fmt::Write;
use std::sync::Arc;

/// Edge of a window, in metres.
const WINDOW: f64 = 3_000.0;
/// Edge of the larger window that is made first, in metres.
const LARGER: f64 = 9_000.0;
/// Greatest distance of a window from the origin along each axis, in metres.
const FAR: f64 = 1e9;

/// The settlements and roads in a window.
#[derive(PartialEq)]
struct Region {
    settlements: Vec<Arc<Settlement>>,
    roads: Vec<Arc<RoadSection>>,
}

impl Region {
    fn of(world: &World, bounds: Bounds) -> Result<Self, LayerError> {
        let cancel = Cancel::new();
        let settlements = world.settlements().overlapping(bounds)?;
        for s in &settlements {
            world.settlements().outline(s)?;
        }
        Ok(Self { settlements, roads: world.roads().overlapping(bounds, &cancel)? })
    }
}

/// A window that was compared.
struct Compared {
    at: DVec2,
    roads: usize,
    km: f64,
    same: bool,
}

/// Runs the command: one window for each seed. Windows that differ make it fail with exit code 1.
pub fn run(common: &Common, args: &SoakArgs) -> Result<(), Fail> {
    common.refuse("`sprawl soak --windows`", &[Flag::Seed, Flag::Edits])?;
    let world = work::world(common)?;
    let (settings, assets) = (world.settings().clone(), world.assets().clone());
    let seeds: Vec<u64> = args.seeds.clone().into_iter().flatten().collect();
    let windows = work::each(common, "comparing windows", &seeds, |seed| {
        let (settings, assets) = (settings.clone(), assets.clone());
        let source = WorldSource { settings, assets, ..WorldSource::new(Seed(*seed)) };
        Ok(compare(*seed, &World::new(source.clone())?, &World::new(source)?)?)
    })?;
    let compared: Vec<(u64, &Compared)> = seeds.iter().copied().zip(&windows).collect();
    let different: Vec<_> = compared.iter().filter(|(_, w)| !w.same).collect();
    let (roads, km) = (compared.iter().map(|w| w.1.roads).sum::<usize>(), compared.iter().map(|w| w.1.km).sum::<f64>());
    let report = json!({
        "windows": compared.len(), "with_roads": compared.iter().filter(|w| w.1.roads > 0).count(), "roads": roads,
        "road_km": km, "different": different.iter().map(|(seed, w)| json!({ "seed": seed, "x": w.at.x, "y": w.at.y }))
            .collect::<Vec<_>>(),
    });
    let mut people = String::new();
    for (seed, w) in &different {
        // Writing to a string cannot fail.
        let _ = writeln!(people, "seed {seed}: settlements or roads differ around {},{}", w.at.x, w.at.y);
    }
    let _ = writeln!(people, "{} windows, {roads} roads, {km:.0} km: {} differ", compared.len(), different.len());
    work::print(common, &report, &people)?;
    match different.len() {
        0 => Ok(()),
        n => Err(Fail::World(format!("{n} of {} windows differ", compared.len()))),
    }
}

/// Compares a window drawn from the seed in two equal worlds: `alone` has made nothing else, `after` has made a larger window
/// around it, off its middle.
fn compare(seed: u64, alone: &World, after: &World) -> Result<Compared, LayerError> {
    let mut stream = Seed(seed).stream("windows", &[]);
    let mut point = |far: f64| DVec2::new(stream.signed(), stream.signed()) * far;
    let at = point(FAR).round();
    let window = Bounds::square(at, WINDOW);
    let first = Region::of(alone, window)?;
    Region::of(after, Bounds::square(at + point((LARGER - WINDOW) / 2.0), LARGER))?;
    let same = Region::of(after, window)? == first;
    let km = first.roads.iter().map(|r| line_length(&r.street.line)).sum::<f64>() / 1000.0;
    Ok(Compared { at, roads: first.roads.len(), km, same })
}
