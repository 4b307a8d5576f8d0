//! `sprawl roads`: roads between given settlements on given ground.

use crate::args::{Common, RoadsArgs};
use crate::fail::Fail;
use crate::map::{Format, Output, write};
use crate::work;
use bevy_sprawl::export::svg::MapStyle;
use bevy_sprawl::export::{self, Plan};
use bevy_sprawl::layer::{FileError, RangeError, from_ron};
use bevy_sprawl::network::StreetClass;
use bevy_sprawl::region::{
    NetworkError, NetworkTask, RoadNetwork, RoadSettings, Settlement, SettlementId, SettlementTable,
};
use bevy_sprawl::space::{Bounds, Geographic};
use bevy_sprawl::terrain::{Band, Holes, PngPlace, Raster, RasterTerrain};
use bevy_sprawl::world::Settings;
use indicatif::{ProgressBar, ProgressStyle};
use ron::Value;
use serde_json::{Value as Json, json};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// The lattice has at least so many nodes along a domain, and at most, unless the user says otherwise.
const NODES: (f64, f64) = (256.0, 1_024.0);

/// Runs the command.
pub fn run(common: &Common, args: &RoadsArgs) -> Result<(), Fail> {
    let formats = [("svg", Format::Svg), ("png", Format::Png), ("geojson", Format::GeoJson)];
    let format = Format::of(&args.output, &formats)?;
    let start = Instant::now();
    let file = match &common.settings {
        Some(path) => Some(SettingsFile::read(path)?),
        None => None,
    };
    let settings = file.as_ref().map_or_else(Settings::default, |f| f.settings.clone());
    let raster = raster(args)?;
    let geographic =
        if args.geographic { Some(raster.geographic().map_err(|e| Fail::file(&args.terrain, e))?) } else { None };
    let (terrain, cell) = terrain(args, raster, geographic.as_ref())?;
    let domain = terrain.bounds();
    let table = {
        let content = std::fs::read(&args.settlements).map_err(|e| Fail::file(&args.settlements, e))?;
        let name = args.settlements.to_string_lossy();
        SettlementTable::from_csv(&name, &content, &settings.settlements, geographic.as_ref())?
    };
    table.check_inside(domain)?;
    let settlements: Vec<Settlement> = table.settlements().cloned().collect();
    let given = file.as_ref().and_then(|f| f.step());
    let step = args.step.or(given).unwrap_or_else(|| usual_step(domain, cell, &settlements));
    let roads = roads(file.as_ref(), step, args.gamma)?;
    let mut out = Output::create(&args.output)?;
    let read = start.elapsed();

    let terrain = Arc::new(terrain);
    let network = build(common, domain, terrain.clone(), &settlements, &roads).map_err(|e| refuse(e, &table, args))?;
    let built = start.elapsed();
    let area = export::network(&network, settings.chunk_size);
    let plan = Plan { area: &area, outlines: &network.outlines, terrain: &*terrain, chunk_size: settings.chunk_size };
    let style = MapStyle { pixels: args.pixels, ..MapStyle::default() };
    work::pool(common)?.install(|| write(&plan, format, &style, false, &mut out))?;
    let bytes = out.finish()?;
    let ms = |t: std::time::Duration| (t.as_secs_f64() * 1e4).round() / 10.0;
    let mut report = report(&network);
    report["file"] = json!(args.output.to_string_lossy());
    report["bytes"] = json!(bytes);
    report["step_m"] = json!(step);
    report["timing_ms"] = json!({ "read": ms(read), "build": ms(built - read), "write": ms(start.elapsed() - built) });
    work::print(common, &report, &people(&network, &report))
}

fn raster(args: &RoadsArgs) -> Result<Raster, Fail> {
    let name = args.terrain.to_string_lossy();
    let content = std::fs::read(&args.terrain).map_err(|e| Fail::file(&args.terrain, e))?;
    match args.terrain.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).as_deref() {
        Some("asc") => {
            let holes = args.fill.map_or(Holes::Refuse, Holes::Value);
            Ok(Raster::from_ascii(&name, &content, Band::Height, holes)?)
        }
        Some("png") => {
            let (Some(cell), Some(white)) = (args.cell, args.white) else {
                return Err(Fail::file(
                    &args.terrain,
                    "a picture needs --cell and --white: the edge of a pixel, and the height of white",
                ));
            };
            let place = PngPlace { corner: args.corner, step: glam::DVec2::splat(cell), black: args.black, white };
            Ok(Raster::from_png(&name, &content, Band::Height, place)?)
        }
        _ => Err(Fail::file(&args.terrain, "unknown kind of file; the name must end in .asc .png")),
    }
}

/// The ground, and the edge of its cells in metres where that is fit for a lattice.
fn terrain(args: &RoadsArgs, raster: Raster, geographic: Option<&Geographic>) -> Result<(RasterTerrain, f64), Fail> {
    let wrong = |e: RangeError| Fail::file(&args.terrain, e);
    let raster = geographic.map_or_else(|| raster.clone(), |g| raster.clone().projected(g));
    let cell = if args.cell.is_some() { 0.0 } else { raster.step().max_element() };
    let terrain = RasterTerrain::new(raster).map_err(wrong)?;
    let terrain = match args.sea_level {
        Some(level) => terrain.with_sea_level(level).map_err(|e| Fail::input(format!("--sea-level: {e}")))?,
        None => terrain,
    };
    Ok((terrain, cell))
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

/// A settings file as it is written, and what it says.
struct SettingsFile {
    name: String,
    text: String,
    settings: Settings,
    roads: Option<Value>,
}

impl SettingsFile {
    /// Reads a file of world settings; ranges of roads are checked later, for those of a finite domain are wider.
    fn read(path: &Path) -> Result<Self, Fail> {
        let (name, text) = (path.to_string_lossy().into_owned(), work::read(path)?);
        let settings: Settings = from_ron(&name, &text)?;
        Settings { roads: RoadSettings::default(), ..settings.clone() }.check().map_err(|e| e.in_file(&name, &text))?;
        let Value::Map(all) = from_ron::<Value>(&name, &text)? else {
            return Ok(Self { name, text, settings, roads: None });
        };
        let roads = all.iter().find(|(k, _)| **k == Value::String("roads".into())).map(|(_, v)| v.clone());
        Ok(Self { name, text, settings, roads })
    }

    /// The step that the file gives.
    fn step(&self) -> Option<i64> {
        let Some(Value::Map(roads)) = &self.roads else { return None };
        roads.keys().any(|k| *k == Value::String("step".into())).then_some(self.settings.roads.step)
    }
}

/// What `over` has in place of what `under` has, maps within maps.
fn lay_over(under: Value, over: Value) -> Value {
    match (under, over) {
        (Value::Map(mut under), Value::Map(over)) => {
            for (key, value) in over {
                let held = under.remove(&key);
                under.insert(
                    key,
                    match held {
                        Some(held) => lay_over(held, value),
                        None => value,
                    },
                );
            }
            Value::Map(under)
        }
        (_, over) => over,
    }
}

/// Settings of roads: those for a finite domain, with what a file says in their place.
fn roads(file: Option<&SettingsFile>, step: i64, gamma: Option<f64>) -> Result<RoadSettings, Fail> {
    let mut out = RoadSettings::finite(step);
    if let Some((file, given)) = file.and_then(|f| Some((f, f.roads.clone()?))) {
        let failed = |e: &dyn std::fmt::Display| Fail::Input(format!("{}: {e}", file.name));
        let usual = ron::to_string(&out).map_err(|e| failed(&e))?;
        let usual: Value = ron::from_str(&usual).map_err(|e| failed(&e))?;
        out = lay_over(usual, given).into_rust().map_err(|e| failed(&e))?;
        out.step = step;
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
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let task = NetworkTask {
        threads: common.threads.map_or_else(cores, usize::from),
        progress: &progress,
        ..NetworkTask::default()
    };
    let network = RoadNetwork::build_as(domain, terrain, settlements, settings, &task);
    bar.finish_and_clear();
    network
}

/// The line for an error, at its place in a file where it has one.
fn refuse(error: NetworkError, table: &SettlementTable, args: &RoadsArgs) -> Fail {
    match error {
        NetworkError::Settlement { index, reason } => match table.rows.get(index) {
            Some(row) => FileError { file: table.file.clone(), line: row.line, column: row.column, reason }.into(),
            None => Fail::input(reason),
        },
        NetworkError::TooFew(_) => Fail::file(&args.settlements, error),
        NetworkError::Range(e) if e.field == "step" => Fail::input(format!("--step: {e}")),
        NetworkError::Range(e) => Fail::file(&args.terrain, e),
        NetworkError::Layer(e) => e.into(),
    }
}

fn hex(id: u64) -> String {
    format!("{id:016x}")
}

fn report(network: &RoadNetwork) -> Json {
    let of = |class: StreetClass| {
        let links: Vec<_> = network.links.iter().filter(|l| l.class == class).collect();
        let pieces = network.roads.iter().filter(|r| r.street.class == class);
        json!({
            "roads": links.len(),
            "length_m": pieces.fold(0.0, |sum, r| sum + r.street.length()),
            "cost": links.iter().fold(0.0, |sum, l| sum + l.cost),
        })
    };
    let classes = [StreetClass::Highway, StreetClass::Major, StreetClass::Minor];
    json!({
        "settlements": network.settlements.iter().map(|s| {
            let at = s.centre.plan();
            json!({
                "id": hex(s.id.0), "x": at.x, "y": at.y, "radius_m": s.radius, "sigma": s.size as u8, "name": s.name,
            })
        }).collect::<Vec<_>>(),
        "roads": network.links.iter().map(|l| json!({
            "id": hex(l.id.0), "from": hex(l.from.0), "to": hex(l.to.0), "class": l.class.name(),
            "length_m": l.length_m, "cost": l.cost, "bridges": l.bridges, "tunnels": l.tunnels,
        })).collect::<Vec<_>>(),
        "totals": {
            "settlements": network.settlements.len(),
            "roads": network.links.len(),
            "pieces": network.roads.len(),
            "junctions": network.junctions(bevy_sprawl::space::Origin::at(network.domain.centre())).len(),
            "length_m": network.length(),
            "bridges": network.links.iter().map(|l| l.bridges).sum::<usize>(),
            "tunnels": network.links.iter().map(|l| l.tunnels).sum::<usize>(),
            "classes": classes.into_iter().map(|c| (c.name().to_owned(), of(c))).collect::<serde_json::Map<_, _>>(),
        },
        "unreached": network.unreached.iter().map(|id| name(network, *id)).collect::<Vec<_>>(),
    })
}

fn name(network: &RoadNetwork, id: SettlementId) -> String {
    let found = network.settlements.iter().find(|s| s.id == id);
    found.map_or_else(|| hex(id.0), |s| s.name.clone())
}

fn people(network: &RoadNetwork, report: &Json) -> String {
    let totals = &report["totals"];
    let km = |v: &Json| v.as_f64().unwrap_or(0.0) / 1000.0;
    let classes = ["highway", "major", "minor"].map(|c| {
        let of = &totals["classes"][c];
        format!("{} {c} ({:.0} km)", of["roads"], km(&of["length_m"]))
    });
    let ms = |key: &str| report["timing_ms"][key].as_f64().unwrap_or(0.0) / 1000.0;
    let mut out = format!(
        "{}: {} settlements, {} roads of {:.0} km: {} ({:.2} s; reading {:.2} s, drawing {:.2} s)",
        report["file"].as_str().unwrap_or_default(),
        network.settlements.len(),
        network.links.len(),
        km(&totals["length_m"]),
        classes.join(", "),
        ms("build"),
        ms("read"),
        ms("write"),
    );
    if !network.unreached.is_empty() {
        let names: Vec<String> = network.unreached.iter().map(|id| name(network, *id)).collect();
        out += &format!("\nno road leads to {}", names.join(", "));
    }
    out
}
