//! `sprawl towns`: measures towns of every style on ground drawn from seeds, and compares them with real towns.

mod bands;

use crate::common::{Common, Flag};
use crate::fail::Fail;
use crate::output::Output;
use crate::values::{radius, seed_range};
use crate::work;
pub use bands::Kind;
use bands::{FIGURES, Figure};
use bevy_sprawl::analysis::{Survey, survey};
use bevy_sprawl::edits::SettlementEdit;
use bevy_sprawl::layer::{Cancel, LayerError};
use bevy_sprawl::network::SizeClass;
use bevy_sprawl::network::{Network, StreetClass};
use bevy_sprawl::region::Settlement;
use bevy_sprawl::space::{Bounds, Seed, point_at, point_in_polygon, polygon_distance};
use bevy_sprawl::streets::StreetOrigin;
use bevy_sprawl::terrain::Terrain;
use bevy_sprawl::world::{Area, World, WorldSource};
use clap::Args;
use glam::DVec2;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::io::Write as _;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Edge of the square in the middle of a town that is measured, in metres.
const CENTRE: f64 = 1000.0;
/// Greatest distance of a town from the origin along each axis, in metres.
const FAR: f64 = 100_000.0;
/// Greatest mean slope of the ground under a town (rise over run).
const EVEN: f64 = 0.06;
/// Number of places that are tried for a town.
const TRIES: u64 = 400;

/// A town that was measured.
struct Measured {
    style: usize,
    seed: u64,
    at: DVec2,
    /// Streets of the square in the middle of the town.
    centre: Survey,
    /// Streets of the whole town.
    whole: Survey,
    /// Metres of street in the square by origin, as [`made`] gives them.
    made: [f64; 4],
    unmet_ports: usize,
}

#[derive(Args)]
pub struct TownsArgs {
    /// Seeds of the worlds, one town of each style in each, the end excluded
    #[arg(long, value_name = "A..B", default_value = "0..20", value_parser = seed_range)]
    pub seeds: Range<u64>,
    /// Names of styles [default: every style]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub style: Vec<String>,
    /// Radius of a town in metres [default: 340 for villages, 900 for others]
    #[arg(long, value_name = "M", value_parser = radius)]
    pub radius: Option<f64>,
    /// Kind of real towns to compare with [default: what the style stands for]
    #[arg(long, value_name = "KIND")]
    pub kind: Option<Kind>,
    /// File to write the tables to, as markdown
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Runs the command.
pub fn run(common: &Common, args: &TownsArgs) -> Result<(), Fail> {
    common.refuse("`sprawl towns`", &[Flag::Seed])?;
    let world = work::world(common)?;
    let known: Vec<&String> = world.assets().styles.keys().collect();
    let styles: Vec<String> = match args.style.is_empty() {
        true => known.into_iter().cloned().collect(),
        false => args.style.clone(),
    };
    if let Some(unknown) = styles.iter().find(|s| !world.assets().styles.contains_key(*s)) {
        return Err(Fail::input(format!("--style {unknown}: there is no such style")));
    }
    let mut file = args.output.as_deref().map(|path| Output::create(path, &common.inputs())).transpose()?;
    let kind = |style: &String| args.kind.unwrap_or_else(|| Kind::of(&world.assets().styles[style]));
    let radius = |style: &String| args.radius.unwrap_or_else(|| kind(style).radius());
    let jobs: Vec<(u64, usize)> =
        args.seeds.clone().flat_map(|seed| (0..styles.len()).map(move |s| (seed, s))).collect();
    let towns = work::each(common, "measuring towns", &jobs, |(seed, style)| {
        let Some((world, town)) = stand(&world, *seed, &styles[*style], radius(&styles[*style]))? else {
            return Ok(None);
        };
        Ok(Some(Measured { style: *style, seed: *seed, ..measured(&world, &town)? }))
    })?;
    let towns: Vec<Measured> = towns.into_iter().flatten().collect();
    let mut presets = Map::new();
    let mut people = String::new();
    for (i, style) in styles.iter().enumerate() {
        let of_style: Vec<&Measured> = towns.iter().filter(|t| t.style == i).collect();
        let mut report = preset(&of_style, kind(style));
        report["radius_m"] = json!(radius(style));
        report["seeds_without_ground"] = json!(args.seeds.clone().count() - of_style.len());
        people += &table(style, &report);
        presets.insert(style.clone(), report);
    }
    let list: Vec<Value> = towns.iter().map(|t| town_json(t, &styles[t.style])).collect();
    let report = json!({
        "seeds": [args.seeds.start, args.seeds.end], "presets": presets, "towns": list,
    });
    if let Some(mut file) = file.take() {
        file.write_all(markdown(args, &report).as_bytes())?;
        file.finish()?;
    }
    work::print(common, &report, &people)
}

/// The size class that a radius in metres belongs to.
pub fn size_of(radius: f64) -> SizeClass {
    match radius {
        r if r >= 850.0 => SizeClass::City,
        r if r >= 350.0 => SizeClass::Town,
        _ => SizeClass::Village,
    }
}

/// A world with a town of a style pinned on even ground, at a place drawn from a seed. `None` if no place is fit.
fn stand(plain: &World, seed: u64, style: &str, radius: f64) -> Result<Option<(World, Arc<Settlement>)>, Fail> {
    let size = size_of(radius);
    let with = |edits| {
        let (settings, assets) = (plain.settings().clone(), plain.assets().clone());
        World::new(WorldSource { settings, assets, edits, ..WorldSource::new(Seed(seed)) })
    };
    let ground = with(plain.edits().clone())?;
    for k in 0..TRIES {
        let mut stream = Seed(seed).stream("towns to measure", &[k]);
        let at = DVec2::new(stream.signed() * FAR, stream.signed() * FAR).round();
        if !is_even(&**ground.terrain(), at, radius) {
            continue;
        }
        let mut edits = plain.edits().clone();
        let style = Some(style.to_owned());
        edits.settlements.push(SettlementEdit::Pin { at, size, name: None, style, radius: Some(radius) });
        let world = with(edits)?;
        if let Some(town) = world.settlements().at(at)?.filter(|t| t.centre.plan() == at) {
            return Ok(Some((world, town)));
        }
    }
    Ok(None)
}

/// Whether the ground within `radius` metres of a point is dry and not steep.
fn is_even(terrain: &dyn Terrain, at: DVec2, radius: f64) -> bool {
    let offsets =
        || (-4..=4).flat_map(|x| (-4..=4).map(move |y| DVec2::new(f64::from(x), f64::from(y)) / 4.0 * radius));
    let points = || offsets().filter(|o| o.length() <= radius).map(|o| at + o);
    if points().any(|p| terrain.sample(p).depth() > 0.0) {
        return false;
    }
    let slopes = points().fold(0.0, |sum, p| sum + terrain.gradient(p, 20.0).length());
    slopes / points().count() as f64 <= EVEN
}

/// Measures a town of a world.
fn measured(world: &World, town: &Arc<Settlement>) -> Result<Measured, LayerError> {
    let cancel = Cancel::new();
    let at = town.centre.plan();
    let area = world.area(Bounds::square(at, 2.0 * town.radius.max(CENTRE * 0.7) + 200.0), &cancel)?;
    let square = Bounds::square(area.origin.to_local(at), CENTRE);
    let outline = world.settlements().outline(town)?;
    let shift = area.origin.offset_to(outline.origin);
    let in_town = |p: DVec2| {
        let p = p + shift;
        point_in_polygon(p, &outline.polygon) || polygon_distance(p, p, &outline.polygon) < 0.01
    };
    let network: Network = area.network();
    Ok(Measured {
        style: 0,
        seed: 0,
        at,
        centre: survey(&network, |p| square.contains(p)),
        whole: survey(&network, in_town),
        made: made(&area, square),
        unmet_ports: area.unmet_ports,
    })
}

/// Metres of street by origin: main streets and roads, then local streets by patches, growth and repair. Only streets whose
/// middle lies in the square count.
pub fn made(area: &Area, square: Bounds) -> [f64; 4] {
    let mut out = [0.0; 4];
    for placed in area.streets.iter().map(|s| &s.item) {
        let length = placed.street.length();
        if square.contains(point_at(&placed.street.line, length / 2.0).0) {
            let origin = match (placed.street.class, placed.made_by.as_ref().map(|made_by| &made_by.origin)) {
                (StreetClass::Local, Some(StreetOrigin::Piece(_))) => 1,
                (StreetClass::Local, Some(StreetOrigin::Growth)) => 2,
                (StreetClass::Local, Some(StreetOrigin::Repair)) => 3,
                _ => 0,
            };
            out[origin] += length;
        }
    }
    out
}

/// Shares of local streets by patches, growth and repair.
fn local_shares(made: &[f64; 4]) -> [f64; 3] {
    let local = (made[1] + made[2] + made[3]).max(1e-9);
    [made[1], made[2], made[3]].map(|m| m / local)
}

/// The 10th, 50th and 90th percentile of values, interpolated between neighbouring values.
fn percentiles(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    [0.1, 0.5, 0.9].map(|share| {
        let at = share * sorted.len().saturating_sub(1) as f64;
        let value = |i: usize| sorted.get(i).or(sorted.last()).copied().unwrap_or(0.0);
        value(at as usize) + (value(at as usize + 1) - value(at as usize)) * at.fract()
    })
}

/// How percentiles lie against a band: `LOW` or `HIGH` if the median is out of it, otherwise which end is out, if any.
fn verdict(p: [f64; 3], [low, _, high]: [f64; 3], digits: usize) -> &'static str {
    // Values count as rounded in the table, where 0.98 against 0.98 must not read as out.
    let unit = (0..digits).fold(1.0, |u, _| u / 10.0);
    let (low, high) = (low - unit / 2.0, high + unit / 2.0);
    match p {
        [_, middle, _] if middle < low => "LOW",
        [_, middle, _] if middle > high => "HIGH",
        [least, _, _] if least < low => "p10 low",
        [_, _, most] if most > high => "p90 high",
        _ => "",
    }
}

/// Figures of all towns of a style.
fn preset(towns: &[&Measured], kind: Kind) -> Value {
    let figure = |f: &Figure| {
        let p = percentiles(towns.iter().map(|t| f.value(kind, &t.centre)));
        let whole = percentiles(towns.iter().map(|t| f.value(kind, &t.whole)));
        let band = f.band(kind);
        let inside = towns.iter().filter(|t| (band[0]..=band[2]).contains(&f.value(kind, &t.centre))).count();
        json!({
            "p10": p[0], "p50": p[1], "p90": p[2], "whole_p50": whole[1], "band": band,
            "share_in_band": inside as f64 / towns.len().max(1) as f64, "verdict": verdict(p, band, f.digits),
        })
    };
    let figures: Map<String, Value> = FIGURES.iter().map(|f| (f.key.to_owned(), figure(f))).collect();
    let plain = |value: &dyn Fn(&Measured) -> f64| {
        let p = percentiles(towns.iter().map(|t| value(t)));
        json!({ "p10": p[0], "p50": p[1], "p90": p[2] })
    };
    json!({
        "kind": kind.name(),
        "towns": towns.len(),
        "figures": figures,
        "patch_share": plain(&|t| local_shares(&t.made)[0]),
        "growth_share": plain(&|t| local_shares(&t.made)[1]),
        "repair_share": plain(&|t| local_shares(&t.made)[2]),
        "dead_end_share": plain(&|t| t.centre.share_dead_ends),
        "unmet_ports": towns.iter().map(|t| t.unmet_ports).sum::<usize>(),
    })
}

fn town_json(town: &Measured, style: &str) -> Value {
    json!({
        "style": style, "seed": town.seed, "x": town.at.x, "y": town.at.y, "centre": town.centre, "whole": town.whole,
        "patch_share": local_shares(&town.made)[0],
    })
}

/// Figures without a band, in the rows below the figures with one.
const OTHERS: [(&str, &str); 4] = [
    ("dead_end_share", "dead-end share"),
    ("patch_share", "local m by patches"),
    ("growth_share", "local m by growth"),
    ("repair_share", "local m by repair"),
];

fn number(value: &Value, digits: usize) -> String {
    format!("{:.digits$}", value.as_f64().unwrap_or(0.0))
}

fn triple(values: [&Value; 3], digits: usize) -> String {
    values.map(|v| number(v, digits)).join(" - ")
}

/// A style's figures for people.
fn table(style: &str, report: &Value) -> String {
    let mut out = String::new();
    let text = |v: &Value| v.as_str().unwrap_or_default().to_owned();
    // Writing to a string cannot fail.
    let (towns, without) = (&report["towns"], &report["seeds_without_ground"]);
    let _ = writeln!(
        out,
        "{style}: {towns} towns, {without} seeds without even ground, against real ones of kind {}",
        text(&report["kind"])
    );
    let _ =
        writeln!(out, "  {:20} {:>25} {:>25} {:>7} {:>8}", "p10 - p50 - p90", "centre 1 km2", "real", "in", "whole");
    for figure in &FIGURES {
        let row = &report["figures"][figure.key];
        let ours = triple([&row["p10"], &row["p50"], &row["p90"]], figure.digits);
        let real = triple([&row["band"][0], &row["band"][1], &row["band"][2]], figure.digits);
        let inside = format!("{:.0} %", row["share_in_band"].as_f64().unwrap_or(0.0) * 100.0);
        let (whole, verdict) = (number(&row["whole_p50"], figure.digits), text(&row["verdict"]));
        let line = format!("  {:20} {ours:>25} {real:>25} {inside:>7} {whole:>8}  {verdict}", figure.name);
        let _ = writeln!(out, "{}", line.trim_end());
    }
    for (key, name) in OTHERS {
        let row = &report[key];
        let _ = writeln!(out, "  {name:20} {:>25}", triple([&row["p10"], &row["p50"], &row["p90"]], 2));
    }
    out + "\n"
}

/// All styles as one page of markdown.
fn markdown(args: &TownsArgs, report: &Value) -> String {
    let mut out = String::from("# Bundled styles against real streets\n\n");
    let seeds = &args.seeds;
    let text = |v: &Value| v.as_str().unwrap_or_default().to_owned();
    let _ = write!(
        out,
        "Written by `sprawl towns --seeds {}..{} -o FILE`: one town of each style for each seed, a circle on even \
         ground\nthat the seed draws. The square kilometre in its middle is measured as [OSMnx](https://\
         github.com/gboeing/osmnx) does: the simplified graph,\nvertices in the square with their true degree, streets \
         between them, area within 100 m of the streets with holes filled. Values are p10 - p50 - p90.\nThe real values \
         come from about 40 city centres of each kind, measured the same way; for suburbs and villages from a few single \
         places,\nwith a band from the least to the greatest value, widened by a quarter. Few streets look ordered by \
         chance: the orientation order of villages\nis given for as many streets as a square kilometre of real villages \
         has. *In* is the share of towns within the real p10 to p90; *whole* is the median over whole towns.\n",
        seeds.start, seeds.end
    );
    for (style, preset) in report["presets"].as_object().into_iter().flatten() {
        let _ = write!(
            out,
            "\n## {style}\n\n{} towns with a radius of {} m, {} seeds without even ground; kind {}.\n\n| figure | centre | real | in | whole | |\n|---|---|---|---|---|---|\n",
            preset["towns"],
            preset["radius_m"],
            preset["seeds_without_ground"],
            text(&preset["kind"])
        );
        for figure in &FIGURES {
            let row = &preset["figures"][figure.key];
            let _ = writeln!(
                out,
                "| {} | {} | {} | {:.0} % | {} | {} |",
                figure.name,
                triple([&row["p10"], &row["p50"], &row["p90"]], figure.digits),
                triple([&row["band"][0], &row["band"][1], &row["band"][2]], figure.digits),
                row["share_in_band"].as_f64().unwrap_or(0.0) * 100.0,
                number(&row["whole_p50"], figure.digits),
                text(&row["verdict"]),
            );
        }
        for (key, name) in OTHERS {
            let row = &preset[key];
            let _ = writeln!(out, "| {name} | {} | | | | |", triple([&row["p10"], &row["p50"], &row["p90"]], 2));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_lie_between_values() {
        assert_eq!(percentiles((0..=10).map(f64::from)), [1.0, 5.0, 9.0]);
        assert_eq!(percentiles([3.0].into_iter()), [3.0; 3]);
        assert_eq!(percentiles([].into_iter()), [0.0; 3]);
    }

    #[test]
    fn verdicts_name_the_end_that_is_out() {
        let band = [1.0, 2.0, 3.0];
        let cases = [([0.9, 2.0, 3.0], "p10 low"), ([1.0, 2.0, 3.2], "p90 high"), ([0.0, 0.5, 2.0], "LOW")];
        for (p, expected) in cases {
            assert_eq!(verdict(p, band, 1), expected);
        }
        assert_eq!(verdict([0.96, 2.0, 3.04], band, 1), "");
    }
}
