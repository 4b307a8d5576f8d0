//! `sprawl stats`: figures of the streets, blocks and buildings of a square.

use crate::common::{At, Common};
use crate::fail::Fail;
use crate::values::size;
use crate::work;
use bevy_sprawl::analysis::{Exceptions, exceptions, measure};
use bevy_sprawl::chunk::Ground;
use bevy_sprawl::layer::{Cancel, LayerError};
use bevy_sprawl::mesh::{self, Detail};
use bevy_sprawl::network::{JunctionId, Network, Street, crossings};
use bevy_sprawl::parcel::BlockUse;
use bevy_sprawl::space::{Bounds, DisjointSets, centroid, line_length, point_at, segments, signed_area};
use bevy_sprawl::world::{Area, World};
use clap::Args;
use glam::DVec2;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::time::Instant;

#[derive(Args)]
pub struct StatsArgs {
    #[command(flatten)]
    pub at: At,
    /// Edge of the square in metres
    #[arg(long, value_name = "M", default_value = "2000", allow_hyphen_values = true, value_parser = size)]
    pub size: f64,
}

/// Runs the command.
pub fn run(common: &Common, args: &StatsArgs) -> Result<(), Fail> {
    let world = work::world(common)?;
    let bounds = work::square(&world, &args.at, args.size)?;
    // Timing comes first, while nothing of the world is made yet.
    let timing = timing(&world, bounds)?;
    let area = work::area(common, &world, bounds)?;
    let mut report = figures(&area);
    report.insert("timing_ms".into(), timing);
    let report = Value::Object(report);
    work::print(common, &report, &lines(&report))
}

/// Figures of the square of an area:
///
/// - `street_km` is the length of centre lines within the square, roads included.
/// - `junctions`, `dead_ends`, `degree`, `cnr` and `share_angle_below_30` concern the junctions in the square, with all
///   streets that end there.
/// - `mean_street_m`, `orientation_order` and `circuity` concern the whole streets whose middle is in the square.
/// - `components` takes streets that leave the square as joined outside it; `components_in_square` does not.
/// - Blocks and buildings count if their centroid is in the square. `building_cover` is the area of buildings over the area
///   of blocks, parks included; `building_cover_of_square` is the area of buildings over the area of the square.
/// - `exceptions` counts where local streets break a rule of their style, by rule and then by cause: a port, a pinned patch, the
///   drawing of a patch, a cell that is too narrow for the rule, or none (a defect).
/// - `short_counts` lists what falls short of the `at_least` of a style in the towns whose cells overlap the square.
/// - `crossings_without_junction` concerns all streets that overlap the square.
fn figures(area: &Area) -> Map<String, Value> {
    let square = area.bounds.moved(-area.origin.plan());
    let km2 = square.size().x * square.size().y / 1e6;
    let all = area.network();
    let inside = measure(&Network {
        junctions: all.junctions.iter().filter(|j| square.contains(j.at)).copied().collect(),
        streets: all.streets.clone(),
    });
    let middle = |s: &Street| point_at(&s.line, line_length(&s.line) / 2.0).0;
    let whole = measure(&Network {
        junctions: all.junctions.clone(),
        streets: all.streets.iter().filter(|s| square.contains(middle(s))).cloned().collect(),
    });
    let street_km = all
        .streets
        .iter()
        .flat_map(|s| segments(&s.line))
        .map(|(a, b)| length_inside(square, a, b))
        .fold(0.0, |sum, m| sum + m)
        / 1e3;
    let polygon_area = |p: &[DVec2]| signed_area(p).abs();
    let blocks = || area.blocks.iter().map(|b| &b.item).filter(|b| square.contains(centroid(&b.polygon)));
    let mut areas: Vec<f64> = blocks().map(|b| polygon_area(&b.polygon)).collect();
    areas.sort_by(f64::total_cmp);
    let buildings: Vec<f64> = area
        .footprints
        .iter()
        .filter(|f| square.contains(centroid(&f.item.polygon)))
        .map(|f| polygon_area(&f.item.polygon))
        .collect();
    let built: f64 = buildings.iter().sum();
    let blocks_area: f64 = areas.iter().sum();
    let (components, alone) = components(&all, square);
    let degree: Map<String, Value> = inside.degree.iter().map(|(k, v)| (k.to_string(), json!(v))).collect();
    let figures = json!({
        "area_km2": km2,
        "street_km": street_km,
        "junctions": inside.junctions,
        "dead_ends": inside.dead_ends,
        "degree": degree,
        "cnr": inside.cnr,
        "street_km_per_km2": street_km / km2,
        "junctions_per_km2": inside.junctions as f64 / km2,
        "mean_street_m": whole.mean_street_m,
        "orientation_order": whole.orientation_order,
        "circuity": whole.circuity,
        "blocks": areas.len(),
        "parks": blocks().filter(|b| b.land_use == BlockUse::Park).count(),
        "block_area_median_m2": median(&areas),
        "share_angle_below_30": inside.share_angle_below_30,
        "components": components,
        "components_in_square": alone,
        "unmet_ports": area.unmet_ports,
        "exceptions": exceptions_json(&exceptions(area)),
        "short_counts": short_counts(area),
        "crossings_without_junction": crossings(&all.streets.iter().collect::<Vec<_>>()).len(),
        "buildings": buildings.len(),
        "building_cover": if blocks_area > 0.0 { built / blocks_area } else { 0.0 },
        "building_cover_of_square": built / (km2 * 1e6),
    });
    match figures {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

/// What falls short of the least counts of styles: in whole towns, and in cells where no street could reach a patch.
fn short_counts(area: &Area) -> Value {
    let towns = area
        .short_counts
        .iter()
        .map(|s| json!({ "style": s.style, "patch": s.piece, "at_least": s.at_least, "stands": s.stands }));
    let cells = area.missing.iter().map(|patch| json!({ "patch": **patch, "at_least": 1, "stands": 0 }));
    towns.chain(cells).collect()
}

/// Exceptions as an object of rules, each an object of causes and counts.
pub fn exceptions_json(counted: &Exceptions) -> Value {
    let mut out = Map::new();
    for ((rule, cause), count) in counted {
        let of_rule = out.entry(rule.name()).or_insert_with(|| json!({}));
        of_rule[cause.name()] = json!(count);
    }
    Value::Object(out)
}

/// Exceptions in words, such as `length/port: 3`.
pub fn exceptions_line(exceptions: &Value) -> String {
    let of_rule = |(rule, causes): (&String, &Value)| {
        let part = |(cause, count): (&String, &Value)| format!("{rule}/{cause}: {count}");
        causes.as_object().into_iter().flatten().map(part).collect::<Vec<_>>()
    };
    let parts: Vec<String> = exceptions.as_object().into_iter().flatten().flat_map(of_rule).collect();
    if parts.is_empty() { "none".into() } else { parts.join("  ") }
}

/// Median of sorted values; 0 without values.
fn median(sorted: &[f64]) -> f64 {
    match sorted.len() {
        0 => 0.0,
        n if n % 2 == 1 => sorted[n / 2],
        n => (sorted[n / 2 - 1] + sorted[n / 2]) / 2.0,
    }
}

/// Length of the part of a segment that lies in a box.
pub fn length_inside(bounds: Bounds, a: DVec2, b: DVec2) -> f64 {
    bounds.clip_segment(a, b).map_or(0.0, |(from, to)| (to - from) * a.distance(b))
}

/// Numbers of connected components of a network: if all streets that leave the square are joined outside it, and if none is.
fn components(network: &Network, square: Bounds) -> (usize, usize) {
    let known: BTreeSet<JunctionId> = network.junctions.iter().map(|j| j.id).collect();
    let mut sets = DisjointSets::new();
    let (mut touched, mut leaving) = (BTreeSet::new(), BTreeSet::new());
    for street in network.streets.iter().filter(|s| known.contains(&s.from) && known.contains(&s.to)) {
        touched.extend([street.from, street.to]);
        sets.union(street.from, street.to);
        if !square.encloses(street.bounds()) {
            leaving.insert(street.from);
        }
    }
    let mut count =
        |junctions: BTreeSet<JunctionId>| junctions.into_iter().map(|id| sets.find(id)).collect::<BTreeSet<_>>().len();
    let (all, outside) = (count(touched), count(leaving));
    (all - outside.saturating_sub(1), all)
}

/// Milliseconds that each layer takes for the square, on one thread, from a world in which nothing is made yet. Seams
/// are part of `town`.
fn timing(world: &World, bounds: Bounds) -> Result<Value, LayerError> {
    let cancel = Cancel::new();
    let size = world.settings().chunk_size;
    let coords = work::chunks(world, bounds);
    let mut out = Map::new();
    let mut timed = |layer: &str, start: Instant| {
        let ms = start.elapsed().as_secs_f64() * 1e3;
        out.insert(layer.into(), json!((ms * 1e3).round() / 1e3));
    };

    let start = Instant::now();
    for coord in &coords {
        std::hint::black_box(Ground::new(&**world.terrain(), coord.origin(size), size));
    }
    timed("terrain", start);

    let start = Instant::now();
    let mut settlements = world.settlements().overlapping(bounds)?;
    let mut outlines = Vec::new();
    for settlement in &settlements {
        outlines.push(world.settlements().outline(settlement)?.bounds().overlaps(bounds));
    }
    let mut outlines = outlines.into_iter();
    settlements.retain(|_| outlines.next().unwrap_or(false));
    timed("settlement", start);

    let start = Instant::now();
    world.roads().overlapping(bounds, &cancel)?;
    for settlement in &settlements {
        world.roads().gates(settlement, &cancel)?;
    }
    timed("road", start);

    let start = Instant::now();
    let towns = settlements.iter().map(|s| world.town(s, &cancel)).collect::<Result<Vec<_>, _>>()?;
    timed("town", start);

    let near = |town: usize, cell: usize| {
        let plan = &towns[town].town;
        Bounds::of(plan.cells[cell].border.iter().copied()).moved(plan.origin.plan()).overlaps(bounds)
    };
    let cells: Vec<(usize, usize)> = (0..towns.len())
        .flat_map(|t| (0..towns[t].town.cells.len()).map(move |c| (t, c)))
        .filter(|(t, c)| near(*t, *c))
        .collect();
    let start = Instant::now();
    for (town, cell) in &cells {
        world.stack().streets(&towns[*town], *cell, &cancel)?;
    }
    timed("streets", start);

    let start = Instant::now();
    for (town, cell) in &cells {
        world.stack().parcels(&towns[*town], *cell, &cancel)?;
    }
    timed("parcel", start);

    let start = Instant::now();
    let chunks = coords.iter().map(|c| world.chunk(*c, &cancel)).collect::<Result<Vec<_>, _>>()?;
    timed("chunk", start);

    let start = Instant::now();
    for chunk in &chunks {
        std::hint::black_box(mesh::build(chunk, &**world.terrain(), Detail::Full, &cancel)?);
    }
    timed("mesh", start);
    Ok(Value::Object(out))
}

/// The figures for people.
fn lines(report: &Value) -> String {
    let rows = [
        ("streets", "street_km", "km"),
        ("density", "street_km_per_km2", "km/km2"),
        ("junctions", "junctions", ""),
        ("", "junctions_per_km2", "per km2"),
        ("dead ends", "dead_ends", ""),
        ("connected node ratio", "cnr", ""),
        ("mean street", "mean_street_m", "m"),
        ("orientation order", "orientation_order", ""),
        ("circuity", "circuity", ""),
        ("sharp junctions", "share_angle_below_30", ""),
        ("median block", "block_area_median_m2", "m2"),
        ("buildings", "buildings", ""),
        ("building cover", "building_cover", "of blocks"),
        ("components", "components", ""),
        ("unmet ports", "unmet_ports", ""),
        ("crossings without junction", "crossings_without_junction", ""),
    ];
    let number = |value: &Value| match value.as_u64() {
        Some(whole) => whole.to_string(),
        None => format!("{:.3}", value.as_f64().unwrap_or_default()),
    };
    let mut out = String::new();
    for (title, key, unit) in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{title:27}{:>12} {unit}", number(&report[key]));
    }
    let _ = writeln!(out, "{:27} {}", "exceptions to rules", exceptions_line(&report["exceptions"]));
    for short in report["short_counts"].as_array().into_iter().flatten() {
        let (patch, style) = (short["patch"].as_str().unwrap_or_default(), short["style"].as_str().unwrap_or("a cell"));
        let (stands, least) = (&short["stands"], &short["at_least"]);
        let _ = writeln!(out, "{:27} {patch} in {style}: {stands} of {least}", "too few");
    }
    for (key, row) in [("degree", "junctions by degree"), ("timing_ms", "ms, one thread")] {
        let parts = report[key].as_object().into_iter().flatten().map(|(k, v)| format!("{k}: {v}"));
        let _ = writeln!(out, "{row:27} {}", parts.collect::<Vec<_>>().join("  "));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_sprawl::network::{Junction, StreetClass, StreetId};
    use bevy_sprawl::space::{ChunkCoord, Origin};
    use bevy_sprawl::stack::PlacedStreet;
    use bevy_sprawl::world::Owned;
    use std::collections::BTreeMap;

    fn area(lines: &[[(f64, f64); 2]]) -> Area {
        let id = |p: DVec2| JunctionId::of(&[p.x.to_bits(), p.y.to_bits()]);
        let chunk = ChunkCoord::new(0, 0);
        let mut junctions = BTreeMap::new();
        let streets = lines.iter().enumerate().map(|(i, line)| {
            let line = line.map(|p| DVec2::new(p.0, p.1)).to_vec();
            junctions.extend(line.iter().map(|p| (id(*p), *p)));
            let street = Street::new(StreetId(i as u64), StreetClass::Local, id(line[0]), id(line[1]), line);
            Owned { chunk, item: PlacedStreet { street, made_by: None } }
        });
        let streets = streets.collect();
        Area {
            origin: Origin::at(DVec2::ZERO),
            bounds: Bounds::square(DVec2::ZERO, 100.0),
            streets,
            junctions: junctions.into_iter().map(|(id, at)| Owned { chunk, item: Junction { id, at } }).collect(),
            blocks: Vec::new(),
            lots: Vec::new(),
            footprints: Vec::new(),
            settlements: Vec::new(),
            outlines: Vec::new(),
            unmet_ports: 0,
            exceptions: Vec::new(),
            short_counts: Vec::new(),
            missing: Vec::new(),
        }
    }

    #[test]
    fn what_leaves_the_square_counts_inside_alone() {
        // A cross whose arms end outside, but for a dead end in the south.
        let cross = [[(0., 0.), (80., 0.)], [(0., 0.), (-80., 0.)], [(0., 0.), (0., 80.)], [(0., 0.), (0., -30.)]];
        let f = figures(&area(&cross));
        assert_eq!(f["street_km"], json!(0.18));
        assert_eq!((&f["junctions"], &f["dead_ends"]), (&json!(1), &json!(1)), "ends outside are no dead ends");
        assert_eq!((&f["components"], &f["components_in_square"]), (&json!(1), &json!(1)));
    }

    #[test]
    fn streets_across_the_border_are_joined_outside() {
        let two = [[(-80., 20.), (80., 20.)], [(-80., -20.), (80., -20.)], [(0., 0.), (5., 5.)]];
        let f = figures(&area(&two));
        assert_eq!((&f["components"], &f["components_in_square"]), (&json!(2), &json!(3)), "one floats");
        assert_eq!(f["crossings_without_junction"], json!(0));
    }

    #[test]
    fn segments_are_clipped() {
        let bounds = Bounds::square(DVec2::ZERO, 10.0);
        let inside = |a: (f64, f64), b: (f64, f64)| length_inside(bounds, DVec2::new(a.0, a.1), DVec2::new(b.0, b.1));
        assert_eq!(inside((-9., 0.), (9., 0.)), 10.0);
        assert_eq!(inside((-9., 7.), (9., 7.)), 0.0);
        assert_eq!(inside((0., 0.), (3., 4.)), 5.0);
        assert!((inside((0., 0.), (10., 10.)) - 50f64.sqrt()).abs() < 1e-12);
    }
}
