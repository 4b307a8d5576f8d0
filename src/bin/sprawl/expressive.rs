//! `sprawl expressive-range`: what the parametric generator can make (Teng 2017, section 4.2): connectivity against density
//! over the least angle and the degrees of junctions.

mod plot;

use crate::common::{Common, Flag};
use crate::fail::Fail;
use crate::output::Output;
use crate::stats::length_inside;
use crate::work;
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::{JunctionId, StreetClass};
use bevy_sprawl::seam::CellPort;
use bevy_sprawl::space::{Bounds, Seed, left_normal, quantize, segments, stable_hash};
use bevy_sprawl::streets::{CellBrief, CellFiller, Parametric};
use bevy_sprawl::style::{FieldKind, LocalRules};
use bevy_sprawl::town::{CellId, DirectionField};
use clap::Args;
use glam::DVec2;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_4;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

/// Ranges of degrees, in the order of the paper's rows.
const DEGREES: [(u32, u32); 8] = [(2, 3), (2, 4), (2, 5), (3, 3), (3, 4), (3, 5), (4, 4), (4, 5)];
/// Least angles in degrees.
const ANGLES: [u32; 5] = [50, 60, 70, 80, 90];
/// Edge of the square that is measured, in metres.
const EDGE: f64 = 1000.0;
/// The main cell that is filled reaches this far beyond it, in metres, so that its main streets and ports are not counted.
const RIM: f64 = 150.0;
/// Distance between the ports of the main cell, in metres.
const PORTS: f64 = 100.0;
/// What the paper's networks lie between: density in km/km2, and connectivity.
const PAPER: [(f64, f64); 2] = [(15.0, 55.0), (0.6, 1.0)];

/// Figures of one network.
#[derive(Clone, Copy)]
struct Network {
    panel: usize,
    index: u64,
    density: f64,
    cnr: f64,
    junctions: usize,
    dead_ends: usize,
}

/// The range of degrees and the least angle of a panel. A range that asks for more streets than have room in a full turn ends
/// at what has.
fn parameters(panel: usize) -> ((u32, u32), u32) {
    let ((low, high), angle) = (DEGREES[panel / ANGLES.len()], ANGLES[panel % ANGLES.len()]);
    let most = 360 / angle;
    ((low.min(most), high.min(most)), angle)
}

/// The rules of a panel: what the paper keeps fixed, the least room that a style may ask for, and no dead end that is led on
/// by repair.
fn rules(panel: usize) -> LocalRules {
    let (degree, angle) = parameters(panel);
    LocalRules {
        length: 50.0,
        deviation: 10.0,
        min_length: 20.0,
        degree,
        min_angle_deg: f64::from(angle),
        angle_deviation_deg: 10.0,
        snap_radius: 20.0,
        clearance: 15.0,
        block_width: 0.0,
        dead_ends: 1.0,
        rounding: 0.0,
    }
}

#[derive(Args)]
pub struct ExpressiveArgs {
    /// Networks for each pair of a range of degrees and a least angle
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub networks: u64,
    /// Folder to write `expressive-range.csv`, a figure of all pairs (`.svg`) and one of all networks (`-all.svg`) to
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// Runs the command.
pub fn run(common: &Common, args: &ExpressiveArgs) -> Result<(), Fail> {
    common.refuse("`sprawl expressive-range`", &[Flag::Settings, Flag::Assets, Flag::Edits])?;
    let folder = |name: &str| args.output.as_ref().map(|f| f.join(name));
    if let Some(folder) = &args.output {
        std::fs::create_dir_all(folder).map_err(|e| Fail::file(folder, e))?;
    }
    // A file that cannot be written is refused before the work.
    let open = |name: &str| folder(name).map(|path| Output::create(&path, &[])).transpose();
    let files = [open("expressive-range.csv")?, open("expressive-range.svg")?, open("expressive-range-all.svg")?];
    let panels = DEGREES.len() * ANGLES.len();
    let jobs: Vec<(u64, usize)> = (0..args.networks).flat_map(|i| (0..panels).map(move |p| (i, p))).collect();
    let networks = work::each(common, "growing networks", &jobs, |(i, panel)| network(common.seed(), *panel, *i))?;
    let all: Vec<Vec<Network>> =
        (0..panels).map(|p| networks.iter().filter(|n| n.panel == p).copied().collect()).collect();
    let points = |of: &[Network]| of.iter().map(|n| (n.density, n.cnr)).collect::<Vec<_>>();
    let [csv, figure, combined] = files;
    let write = |file: Option<Output>, text: &dyn Fn() -> Result<String, Fail>| {
        let Some(mut file) = file else { return Ok(()) };
        file.write_all(text()?.as_bytes())?;
        file.finish().map(|_| ())
    };
    write(csv, &|| Ok(table(&networks)))?;
    let panels: Vec<(String, Vec<(f64, f64)>)> = all.iter().enumerate().map(|(p, of)| (title(p), points(of))).collect();
    write(figure, &|| plot::panels(&panels, ANGLES.len()))?;
    write(combined, &|| plot::panels(&[("All networks".to_owned(), points(&networks))], 1))?;
    let means: Vec<[f64; 4]> = all.iter().map(|of| moments(of)).collect();
    let trends = trends(&means);
    let report = json!({
        "networks": args.networks,
        "panels": means.iter().enumerate().map(|(p, m)| panel_json(p, m)).collect::<Vec<_>>(),
        "density": range(networks.iter().map(|n| n.density)),
        "cnr": range(networks.iter().map(|n| n.cnr)),
        "share_in_the_papers_range": share(&networks),
        "trends": trends.iter().map(|(what, holds, of)| json!({ "what": what, "holds": holds, "of": of })).collect::<Vec<_>>(),
    });
    work::print(common, &report, &people(&report, &means))
}

fn title(panel: usize) -> String {
    let ((low, high), angle) = parameters(panel);
    format!("degree {low}-{high}, {angle}°")
}

/// Fills a main cell by parametric growth, and measures the square in its middle.
fn network(seed: u64, panel: usize, index: u64) -> Result<Network, Fail> {
    let id = CellId(stable_hash(&[panel as u64, index]));
    let mut stream = Seed(seed).stream("expressive range", &[id.0]);
    let square = Bounds::square(DVec2::ZERO, EDGE);
    let cell = square.grown(RIM);
    let border = [cell.min, DVec2::new(cell.max.x, cell.min.y), cell.max, DVec2::new(cell.min.x, cell.max.y)];
    let brief = CellBrief {
        seed: Seed(seed),
        id,
        border: &border,
        street_half_width: &[Some(StreetClass::Main.half_width()); 4],
        ports: &ports(&border),
        field: &DirectionField::uniform(stream.range(-FRAC_PI_4, FRAC_PI_4)),
        field_kind: FieldKind::Organic,
        rules: &rules(panel),
    };
    let streets = Parametric::default().fill(&brief, &Cancel::new())?;
    let mut degrees: BTreeMap<JunctionId, usize> = BTreeMap::new();
    let mut length = 0.0;
    for street in streets.streets.iter().map(|s| &s.street) {
        [street.from, street.to].iter().for_each(|j| *degrees.entry(*j).or_default() += 1);
        length += segments(&street.line).map(|(a, b)| length_inside(square, a, b)).sum::<f64>();
    }
    let inside = || streets.junctions.iter().filter(|j| square.contains(j.at)).map(|j| degrees.get(&j.id).copied());
    let junctions = inside().filter(|degree| *degree >= Some(3)).count();
    let dead_ends = inside().filter(|degree| *degree == Some(1)).count();
    let cnr = junctions as f64 / (junctions + dead_ends).max(1) as f64;
    Ok(Network { panel, index, density: length / 1e3 / (EDGE * EDGE / 1e6), cnr, junctions, dead_ends })
}

/// Ports along all sides of a cell, which is walked counter-clockwise.
fn ports(border: &[DVec2; 4]) -> Vec<CellPort> {
    let mut ports = Vec::new();
    for (i, a) in border.iter().enumerate() {
        let side = border[(i + 1) % border.len()] - a;
        let (room, along) = (side.length(), side.normalize_or_zero());
        let (count, inward) = ((room / PORTS).floor() as usize, left_normal(along));
        ports.extend((1..count).map(|k| {
            let at = quantize(a + along * (room * k as f64 / count as f64));
            let junction = JunctionId::of(&[at.x.to_bits(), at.y.to_bits()]);
            CellPort { junction, at, inward, class: StreetClass::Local }
        }));
    }
    ports
}

/// Mean and standard deviation of density, then of connectivity.
fn moments(of: &[Network]) -> [f64; 4] {
    let n = of.len().max(1) as f64;
    let both = |value: &dyn Fn(&Network) -> f64| {
        let mean = of.iter().fold(0.0, |sum, x| sum + value(x)) / n;
        let variance = of.iter().fold(0.0, |sum, x| sum + (value(x) - mean) * (value(x) - mean)) / n;
        [mean, variance.sqrt()]
    };
    let ([a, b], [c, d]) = (both(&|x| x.density), both(&|x| x.cnr));
    [a, b, c, d]
}

fn panel_json(panel: usize, [density, density_sd, cnr, cnr_sd]: &[f64; 4]) -> Value {
    let ((low, high), angle) = parameters(panel);
    json!({
        "degree": [low, high], "min_angle_deg": angle,
        "density": density, "density_sd": density_sd, "cnr": cnr, "cnr_sd": cnr_sd,
    })
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

/// Share of the networks that lie where the paper's do.
fn share(networks: &[Network]) -> f64 {
    let within =
        |n: &&Network| (PAPER[0].0..=PAPER[0].1).contains(&n.density) && (PAPER[1].0..=PAPER[1].1).contains(&n.cnr);
    networks.iter().filter(within).count() as f64 / networks.len().max(1) as f64
}

/// What the paper observes, and in how many of the comparisons between the means of panels it holds.
fn trends(means: &[[f64; 4]]) -> Vec<(&'static str, usize, usize)> {
    let columns = ANGLES.len();
    let at = |row: usize, column: usize| means[row * columns + column];
    // Panels may be alike, where fewer streets fit than are asked for.
    let differ =
        |a: (usize, usize), b: (usize, usize)| parameters(a.0 * columns + a.1) != parameters(b.0 * columns + b.1);
    let row_of = |degree| DEGREES.iter().position(|d| *d == degree).unwrap_or(0);
    let count = |of: Vec<bool>| (of.iter().filter(|x| **x).count(), of.len());
    let beside = || (0..DEGREES.len()).flat_map(|r| (1..columns).map(move |c| (r, c)));
    let cnr = count(beside().map(|(r, c)| at(r, c)[2] < at(r, c - 1)[2]).collect());
    let thin = count(beside().map(|(r, c)| at(r, c)[0] < at(r, c - 1)[0]).collect());
    // Rows with one least degree, and with one greatest.
    let rises = [
        ((2, 3), (2, 4)),
        ((2, 4), (2, 5)),
        ((3, 3), (3, 4)),
        ((3, 4), (3, 5)),
        ((4, 4), (4, 5)),
        ((2, 3), (3, 3)),
        ((2, 4), (3, 4)),
        ((3, 4), (4, 4)),
        ((2, 5), (3, 5)),
        ((3, 5), (4, 5)),
    ];
    let dense = |columns: std::ops::Range<usize>| {
        let pairs = rises.iter().flat_map(|(a, b)| columns.clone().map(|c| (row_of(*a), row_of(*b), c)));
        count(pairs.filter(|(a, b, c)| differ((*a, *c), (*b, *c))).map(|(a, b, c)| at(b, c)[0] > at(a, c)[0]).collect())
    };
    let drop = count((0..columns - 1).map(|c| at(row_of((3, 3)), c)[0] < at(row_of((2, 5)), c)[0]).collect());
    let spread = |c: usize| {
        let [low, high] = range((0..DEGREES.len()).map(|r| at(r, c)[0]));
        high - low
    };
    let steady = count((0..columns - 1).map(|c| spread(columns - 1) < spread(c)).collect());
    let line = |what, (holds, of): (usize, usize)| (what, holds, of);
    vec![
        line("a greater least angle lowers the connectivity", cnr),
        line("a greater least angle lowers the density", thin),
        line("higher degrees raise the density, 50 to 80 degrees", dense(0..columns - 1)),
        line("the density drops from degrees 2-5 to 3-3", drop),
        line("at 90 degrees the density varies less over degrees than at smaller angles", steady),
    ]
}

fn table(networks: &[Network]) -> String {
    let mut out =
        String::from("degree_min,degree_max,min_angle_deg,network,density_km_per_km2,cnr,junctions,dead_ends\n");
    let mut sorted: Vec<&Network> = networks.iter().collect();
    sorted.sort_by_key(|n| (n.panel, n.index));
    for n in sorted {
        let ((low, high), angle) = parameters(n.panel);
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{low},{high},{angle},{},{:.4},{:.4},{},{}",
            n.index, n.density, n.cnr, n.junctions, n.dead_ends
        );
    }
    out
}

fn people(report: &Value, means: &[[f64; 4]]) -> String {
    let mut out = String::from("mean density in km/km2 and mean connected node ratio by least angle\n  degrees");
    ANGLES.iter().for_each(|a| out += &format!(" {:>13}", format!("{a}°")));
    for (r, (low, high)) in DEGREES.iter().enumerate() {
        let _ = write!(out, "\n  {low}-{high}    ");
        for c in 0..ANGLES.len() {
            let m = means[r * ANGLES.len() + c];
            let _ = write!(out, " {:>13}", format!("{:.1} / {:.2}", m[0], m[2]));
        }
    }
    let number = |v: &Value| v.as_f64().unwrap_or(0.0);
    let (density, cnr) = (&report["density"], &report["cnr"]);
    let _ = writeln!(
        out,
        "\n{} networks a cell: density {:.1} to {:.1} km/km2 (paper {} to {}), CNR {:.2} to {:.2} (paper {} to {}); {:.1} % lie in the paper's range",
        report["networks"],
        number(&density[0]),
        number(&density[1]),
        PAPER[0].0,
        PAPER[0].1,
        number(&cnr[0]),
        number(&cnr[1]),
        PAPER[1].0,
        PAPER[1].1,
        number(&report["share_in_the_papers_range"]) * 100.0
    );
    out += "a junction has at most as many streets as fit in a full turn: 5 at 70 degrees, 4 at 80 and 90\n";
    for trend in report["trends"].as_array().into_iter().flatten() {
        let what = trend["what"].as_str().unwrap_or_default();
        let _ = writeln!(out, "{what}: {} of {}", trend["holds"], trend["of"]);
    }
    out
}
