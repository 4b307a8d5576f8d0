//! `sprawl roads`: roads between given settlements on given ground, and how they compare with real ones.

mod args;
mod compare;
mod ground;
mod reference;
mod report;
mod settings;
mod table;
mod tiles;

use crate::common::{Common, Flag};
use crate::crossings;
use crate::edits::EditsFile;
use crate::fail::Fail;
use crate::output::{FileOptions, Format, Output, spelled_in_latin, write, write_pair};
use crate::work;
pub use args::RoadsArgs;
use bevy_sprawl::edits::{Edits, SettlementEdit};
use bevy_sprawl::export::svg::MapStyle;
use bevy_sprawl::export::{self, ExportError, Plan};
use bevy_sprawl::layer::{FileError, error_at};
use bevy_sprawl::region::{
    NetworkError, NetworkTask, RoadNetwork, RoadSettings, Settlement, SettlementSettings, SettlementTable,
};
use bevy_sprawl::space::Bounds;
use bevy_sprawl::terrain::RasterTerrain;
use bevy_sprawl::world::Settings;
use compare::Comparison;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use settings::SettingsFile;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// The lattice has at least so many nodes along a domain, and at most, unless the user says otherwise.
const NODES: (f64, f64) = (256.0, 1_024.0);

/// Runs the command.
pub fn run(common: &Common, args: &RoadsArgs) -> Result<(), Fail> {
    let formats = [("svg", Format::Svg), ("png", Format::Png), ("geojson", Format::GeoJson), ("osm", Format::Osm)];
    let format = Format::of(&args.output, &formats)?;
    common.refuse("`sprawl roads`", &[Flag::Seed, Flag::Assets])?;
    let picture = matches!(format, Format::Svg | Format::Png);
    if !picture && (args.pixels.is_some() || args.compare) {
        return Err(Fail::input("--pixels and --compare need a picture: a name that ends in .svg or .png"));
    }
    let start = Instant::now();
    let file = match &common.settings {
        Some(path) => Some(SettingsFile::read(path)?),
        None => None,
    };
    let settings = file.as_ref().map_or_else(Settings::default, |f| f.settings.clone());
    let ground::Land { terrain, cell, geographic, report: ground_report } = ground::read(args)?;
    let domain = terrain.bounds();
    let edits = EditsFile::read(common, geographic.as_ref())?;
    let table = table::read(args, &settings.settlements, geographic.as_ref(), &terrain)?;
    let settlements: Vec<Settlement> = table.settlements().cloned().collect();
    let given = file.as_ref().and_then(|f| f.roads.step());
    let step = args.step.or(given).unwrap_or_else(|| usual_step(domain, cell, &settlements));
    let roads = roads(file.as_ref(), step, args.gamma)?;
    let mask = args.mask.options(args.reference.as_deref())?;
    let real = match &args.reference {
        Some(path) => Some(reference::read(path, &args.reference_classes, geographic.as_ref(), domain, mask)?),
        None => None,
    };
    let mut out = Output::create(&args.output, &inputs(common, args))?;
    let mut warnings: Vec<String> = file.iter().flat_map(|f| &f.warnings).map(ToString::to_string).collect();
    warnings.extend(edits.iter().filter(|e| !e.edits.patches.is_empty()).map(|e| {
        error_at(&e.name, &e.text, "patches", "patches have no use here; `sprawl roads` makes no towns").to_string()
    }));
    warnings.iter().for_each(|line| eprintln!("sprawl: warning: {line}"));
    let read = start.elapsed();

    let terrain = Arc::new(terrain);
    let wishes = edits.as_ref().map_or_else(Edits::default, |e| with_radii(&e.edits, &settings.settlements));
    let network =
        build(common, domain, terrain.clone(), &settlements, &roads, &wishes).map_err(|e| refuse(e, &table, args))?;
    if let Some(file) = &edits {
        file.warn(common, &network.rejected);
    }
    let names: Vec<String> = network.unreached.iter().map(|id| report::name(&network, *id)).collect();
    work::warn_of_unreached(&names);
    let built = start.elapsed();
    let compared = real.as_ref().map(|real| Comparison::new(&network, real));
    let area = export::network(&network, settings.chunk_size);
    let real = real.map(|map| export::lines(domain, reference::roads(&map), settings.chunk_size));
    let plan = Plan {
        area: &area,
        outlines: &network.outlines,
        terrain: &*terrain,
        chunk_size: settings.chunk_size,
        driving: settings.driving,
        real: real.as_ref(),
        projection: geographic,
    };
    let usual = MapStyle::default();
    let style = MapStyle { pixels: args.pixels.unwrap_or(usual.pixels), legend: true, ..usual };
    work::pool(common)?.install(|| draw(&plan, format, &style, args.compare, &mut out))?;
    let bytes = out.finish()?;
    let ms = |t: std::time::Duration| (t.as_secs_f64() * 1e4).round() / 10.0;
    let mut report = report::json(&network);
    report["file"] = json!(args.output.to_string_lossy());
    report["bytes"] = json!(bytes);
    report["step_m"] = json!(step);
    report["warnings"] = json!(warnings);
    report["timing_ms"] = json!({ "read": ms(read), "build": ms(built - read), "write": ms(start.elapsed() - built) });
    report["ground"] = ground_report.json();
    report["table"] = table::json(&table.report);
    let (spelled_json, spelled) = spelled_in_latin(&plan, format);
    report["spelled_in_latin"] = spelled_json;
    let mut people = report::people(&network, &report)
        + &crossings::people(&network.crossings)
        + &spelled
        + &ground_report.people()
        + &table::people(&table);
    if let Some(projection) = geographic {
        report["projection"] = report::projection(&projection);
    }
    if let Some(compared) = compared {
        report["reference"] = compared.json();
        people += &compared.people();
    }
    work::print(common, &report, &people)
}

/// The edits, in which settlements without a radius get that of the settings.
fn with_radii(edits: &Edits, settings: &SettlementSettings) -> Edits {
    let mut out = edits.clone();
    for edit in &mut out.settlements {
        if let SettlementEdit::Pin { size, radius, .. } = edit {
            let (least, greatest) = *settings.radius.of(*size);
            radius.get_or_insert((least + greatest) / 2.0);
        }
    }
    out
}

/// The files that are read.
fn inputs(common: &Common, args: &RoadsArgs) -> Vec<PathBuf> {
    let given = [&args.terrain, &args.water, &args.vegetation].into_iter().flatten();
    let given = given.chain(&args.reference).chain([&args.settlements]);
    common.inputs().into_iter().chain(given.cloned()).collect()
}

/// Writes the file: real roads under these, or on a map of their own beside that of these.
fn draw(plan: &Plan<'_>, format: Format, style: &MapStyle, beside: bool, out: &mut Output) -> Result<(), ExportError> {
    let (true, Some(real)) = (beside, plan.real) else {
        return write(plan, format, style, FileOptions::default(), out);
    };
    let mut theirs = real.clone();
    theirs.settlements.clone_from(&plan.area.settlements);
    let left = Plan { area: &theirs, outlines: &[], real: None, ..*plan };
    let right = Plan { real: None, ..*plan };
    let [first, second] = ["real roads", "these roads"].map(|title| MapStyle { title, ..*style });
    write_pair([(&left, &first), (&right, &second)], format, out)
}

/// The step that fits a raster, a domain and its settlements.
fn usual_step(domain: Bounds, cell: f64, settlements: &[Settlement]) -> i64 {
    let longest = domain.size().max_element();
    let usual = if cell > 0.0 { cell } else { longest / NODES.0 };
    let apart = settlements
        .iter()
        .enumerate()
        .flat_map(|(i, a)| settlements[..i].iter().map(|b| a.centre.offset_to(b.centre).length()));
    let nearest = apart.fold(f64::INFINITY, f64::min);
    // Two settlements must not be nearer than 1.5 steps; rounded down, or they would be.
    usual.min(nearest / 1.5).max(longest / NODES.1).clamp(10.0, 20_000.0) as i64
}

/// Settings of roads: those for a finite domain, with what a file says in their place.
fn roads(file: Option<&SettingsFile>, step: i64, gamma: Option<f64>) -> Result<RoadSettings, Fail> {
    let mut out = RoadSettings::finite(step);
    if let Some(file) = file {
        out = RoadSettings { step, ..file.roads.over(out) };
    }
    for tier in [&mut out.highway, &mut out.major, &mut out.minor] {
        tier.gamma = gamma.unwrap_or(tier.gamma);
    }
    out.check_finite().map_err(|e| match file {
        Some(f) => Fail::from(e.within("roads").in_file(&f.name, &f.text)),
        None => Fail::input(e),
    })?;
    Ok(out)
}

fn build(
    common: &Common,
    domain: Bounds,
    terrain: Arc<RasterTerrain>,
    settlements: &[Settlement],
    settings: &RoadSettings,
    edits: &Edits,
) -> Result<RoadNetwork, NetworkError> {
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{msg} {bar:30} {pos}/{len}") {
        bar.set_style(style);
    }
    let progress = |what: &str, done: usize, of: usize| {
        if bar.length() != Some(of as u64) || done == 1 {
            bar.set_length(of as u64);
            bar.set_message(what.to_owned());
        }
        bar.set_position(done as u64);
    };
    let task = NetworkTask { threads: work::threads(common), progress: &progress, ..NetworkTask::default() };
    let network = RoadNetwork::build_as(domain, terrain, settlements, settings, edits, &task);
    bar.finish_and_clear();
    network
}

/// The line for an error, at its place in a file where it has one.
fn refuse(error: NetworkError, table: &SettlementTable, args: &RoadsArgs) -> Fail {
    match error {
        NetworkError::Settlement { index, reason } => match table.rows.get(index) {
            Some(row) => FileError::new(&*table.file, (row.line, row.column), reason).into(),
            None => Fail::input(reason),
        },
        NetworkError::TooFew(_) => Fail::file(&args.settlements, error),
        NetworkError::Range(e) if e.field == "step" => Fail::input(format!("--step: {e}")),
        NetworkError::Range(e) => Fail::file(&args.terrain[0], e),
        NetworkError::Layer(e) => e.into(),
    }
}
