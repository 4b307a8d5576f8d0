//! `sprawl seams`: checks that chunk borders do not show in the streets. Counts streets and junctions of many towns near the
//! borders and away from them.

use crate::common::Common;
use crate::fail::Fail;
use crate::values::{least_zero, size};
use crate::work;
use bevy_sprawl::analysis::ChunkBorderCounts;
use bevy_sprawl::layer::{Cancel, LayerError};
use bevy_sprawl::region::Settlement;
use bevy_sprawl::space::{Bounds, ChunkCoord, point_at};
use bevy_sprawl::world::World;
use clap::Args;
use glam::DVec2;
use serde_json::json;
use std::sync::Arc;

/// Distance from a border, in metres, within which a place counts as near it.
const RIM: f64 = 40.0;
/// Distance between the points by which a town's area is counted, in metres.
const STEP: f64 = 12.0;
/// Edge of the squares that are searched for towns, ring by ring, in metres.
const SEARCH: f64 = 32_000.0;
/// Number of rings that are searched.
const RINGS: i32 = 30;

#[derive(Args)]
pub struct SeamsArgs {
    /// Square kilometres of towns to count, around the origin
    #[arg(long, value_name = "N", default_value = "200", value_parser = size)]
    pub km2: f64,
    /// Greatest difference between streets near borders and other streets, as a share
    #[arg(long, value_name = "SHARE", default_value = "0.03", value_parser = least_zero)]
    pub most_difference: f64,
    /// Greatest peak of the spectrum at the chunk's edge and its harmonics, over the spectrum around them
    #[arg(long, value_name = "RATIO", default_value = "3", value_parser = least_zero)]
    pub most_peak: f64,
}

/// Runs the command. Differences beyond the limits make it fail with exit code 1.
pub fn run(common: &Common, args: &SeamsArgs) -> Result<(), Fail> {
    let world = work::world(common)?;
    let towns = towns(&world, args.km2 * 1e6)?;
    let parts = work::each(common, "counting streets", &towns, |town| Ok(counts(&world, town)?))?;
    let mut all = empty(&world);
    parts.iter().for_each(|part| all.add(part));
    let report = all.report();
    let fine = report.greatest_difference() <= args.most_difference && report.highest_peak() <= args.most_peak;
    let [near, away] = report.area_km2;
    let percent = |ratio: f64| format!("{:+.2} %", (ratio - 1.0) * 100.0);
    let peaks = report.peaks.map(|axis| axis.map(|p| format!("{p:.2}")).join(" "));
    let people = format!(
        "{} towns, {:.1} km2, {:.1} of it within {RIM} m of chunk borders\n\
         junctions per area there: {}\nmean length of streets: {}\nlength along the axes: {}\n\
         spectrum at the chunk's edge, 1/2, 1/3, 1/4 of it, over the spectrum around: x {}, y {}\n",
        towns.len(),
        near + away,
        near,
        percent(report.density_ratio),
        percent(report.length_ratio),
        percent(report.heading_ratio),
        peaks[0],
        peaks[1],
    );
    let json = json!({ "towns": towns.len(), "figures": report, "fine": fine });
    work::print(common, &json, &people)?;
    if fine {
        return Ok(());
    }
    Err(Fail::World(format!(
        "chunk borders show in the streets: a difference of {:.1} %, a peak of {:.2}",
        report.greatest_difference() * 100.0,
        report.highest_peak()
    )))
}

fn empty(world: &World) -> ChunkBorderCounts {
    ChunkBorderCounts::new(world.settings().chunk_size as f64, RIM)
}

/// Settlements around the origin, ring by ring, until their outlines have the `wanted` area in square metres.
fn towns(world: &World, wanted: f64) -> Result<Vec<Arc<Settlement>>, LayerError> {
    let mut found = Vec::new();
    let mut area = 0.0;
    for ring in 0..RINGS {
        let squares = (-ring..=ring).flat_map(|x| (-ring..=ring).map(move |y| ChunkCoord::new(x, y)));
        for square in squares.filter(|s| s.0.abs().max_element() == ring) {
            let middle = DVec2::new(f64::from(square.0.x), f64::from(square.0.y)) * SEARCH;
            for town in world.settlements().centred_in(Bounds::square(middle, SEARCH))? {
                if area >= wanted {
                    return Ok(found);
                }
                area += world.settlements().outline(&town)?.area();
                found.push(town);
            }
        }
    }
    Ok(found)
}

/// Counts the streets of a settlement.
fn counts(world: &World, town: &Arc<Settlement>) -> Result<ChunkBorderCounts, LayerError> {
    let mut out = empty(world);
    let outline = world.settlements().outline(town)?;
    let bounds = outline.bounds();
    out.add_area(bounds, STEP, |p| outline.contains(p));
    let area = world.area(bounds, &Cancel::new())?;
    for junction in &area.junctions {
        let at = area.origin.to_plan(junction.item.at);
        if outline.contains(at) {
            out.add_junction(at);
        }
    }
    for street in area.streets.iter().map(|s| &s.item.street).filter(|s| !s.class.is_road()) {
        let line: Vec<DVec2> = street.line.iter().map(|p| area.origin.to_plan(*p)).collect();
        if outline.contains(point_at(&line, street.length() / 2.0).0) {
            out.add_street(&line);
        }
    }
    Ok(out)
}
