//! `sprawl soak`: checks a city of each of many worlds, with the settlements that it touches, or towns of every size and
//! style, against what the design promises.

use crate::common::{Common, Flag};
use crate::fail::Fail;
use crate::random_edits;
use crate::stats::{exceptions_json, exceptions_line};
use crate::towns;
use crate::values::seed_range;
use crate::work;
use bevy_sprawl::analysis::{Exceptions, audit, exceptions, unreached_gates};
use bevy_sprawl::edits::SettlementEdit;
use bevy_sprawl::layer::{Cancel, LayerError};
use bevy_sprawl::network::JunctionId;
use bevy_sprawl::network::SizeClass;
use bevy_sprawl::region::Settlement;
use bevy_sprawl::space::{Bounds, Seed};
use bevy_sprawl::world::{Area, World, WorldSource};
use clap::Args;
use glam::DVec2;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// A city is looked for in a square of this edge, in metres, around the origin.
const SEARCH: f64 = 100_000.0;
/// What is checked around a city beyond its radius, in metres.
pub const MARGIN: f64 = 250.0;
/// Edge of the square that is checked around a way point, in metres.
const AROUND: f64 = 3_000.0;

/// Radii of villages, towns and cities that are drawn, in metres.
const RADII: [(f64, f64); 3] = [(120.0, 340.0), (350.0, 800.0), (850.0, 1500.0)];
/// Towns in a row and rows of towns that are drawn for a world, and the edge of the square that each has to itself, in metres.
const CROWD: usize = 4;
const APART: f64 = 5_500.0;
/// Towns that are checked of these; for others there may be no ground.
const CHECKED: u64 = 12;

#[derive(Args)]
pub struct SoakArgs {
    /// Seeds of the worlds, the end excluded
    #[arg(long, value_name = "A..B", value_parser = seed_range, required_unless_present_any = ["towns", "inputs"])]
    pub seeds: Option<Range<u64>>,
    /// Check this many towns of every size and style instead, 12 in each world; seeds count up from `--seed`
    #[arg(long, value_name = "N", conflicts_with_all = ["seeds", "edits_random", "windows"])]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub towns: Option<u32>,
    /// Check this many worlds of random valid settings, styles, patch sets and edits instead, drawn from `--seed`
    #[arg(long, value_name = "N", conflicts_with_all = ["seeds", "towns", "edits_random", "windows"])]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub inputs: Option<u32>,
    /// Index of the first of these inputs [default: 0]
    #[arg(long, value_name = "K", requires = "inputs")]
    pub inputs_from: Option<u64>,
    /// Seconds that one of these worlds may take [default: 60]
    #[arg(long, value_name = "SECONDS", requires = "inputs")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub limit: Option<u32>,
    /// Check each world with random edits of every kind around its city; way points and pinned settlements are checked, too
    #[arg(long, requires = "seeds")]
    pub edits_random: bool,
    /// Check instead that the roads of a far window are the same whether or not a larger window was made before
    #[arg(long, requires = "seeds", conflicts_with = "edits_random")]
    pub windows: bool,
}

/// Runs the command. Findings make it fail with exit code 1.
pub fn run(common: &Common, args: &SoakArgs) -> Result<(), Fail> {
    if args.seeds.is_some() {
        common.refuse("`sprawl soak --seeds`", &[Flag::Seed])?;
    }
    if args.edits_random {
        common.refuse("`sprawl soak --edits-random`", &[Flag::Edits])?;
    }
    let world = work::world(common)?;
    if let Some(towns) = args.towns {
        return check_towns(common, &world, towns);
    }
    let (settings, assets) = (world.settings().clone(), world.assets().clone());
    let seeds: Vec<u64> = args.seeds.clone().into_iter().flatten().collect();
    let cities = work::each(common, "checking cities", &seeds, |seed| {
        let plain = WorldSource { settings: settings.clone(), assets: assets.clone(), ..WorldSource::new(Seed(*seed)) };
        let with = |edits| World::new(WorldSource { edits, ..plain.clone() });
        let world = with(world.edits().clone())?;
        let Some(city) = nearest(&world)? else { return Ok(City::default()) };
        if !args.edits_random {
            return Ok(check(&world, &city)?);
        }
        Ok(check_edited(&with(random_edits::edits(&world, &city, &Cancel::new())?)?)?)
    })?;
    let (mut findings, mut people) = (Vec::new(), String::new());
    for (seed, city) in seeds.iter().zip(&cities) {
        for (what, at) in &city.findings {
            findings.push(json!({ "seed": seed, "what": what, "x": at.x, "y": at.y }));
            // Writing to a string cannot fail.
            let _ = writeln!(people, "seed {seed}: {what} at {},{}", at.x, at.y);
        }
    }
    let sum = |of: fn(&City) -> usize| cities.iter().map(of).sum::<usize>();
    let found = cities.iter().filter(|c| c.streets > 0).count();
    let mut report: Value = json!({
        "seeds": seeds.len(), "cities": found, "seeds_without_city": seeds.len() - found, "streets": sum(|c| c.streets), "buildings": sum(|c| c.buildings),
        "findings": findings,
    });
    if args.edits_random {
        let of = |roads: usize| cities.iter().flat_map(|c| &c.way_points).filter(|n| **n == roads).count();
        let roads: serde_json::Map<String, Value> =
            (0..=12).map(|n| (n.to_string(), of(n).into())).filter(|(_, n)| *n != 0).collect();
        let (edits, rejected) = (sum(|c| c.edits), sum(|c| c.rejected));
        let _ =
            writeln!(people, "{edits} edits, {rejected} rejected; way points by roads: {}", Value::from(roads.clone()));
        report["edits"] = edits.into();
        report["rejected"] = rejected.into();
        report["way_points_by_roads"] = roads.into();
    }
    let (streets, buildings) = (&report["streets"], &report["buildings"]);
    let without = seeds.len() - found;
    let _ = writeln!(
        people,
        "{found} cities, {without} seeds without one, {streets} streets, {buildings} buildings: {} findings",
        findings.len()
    );
    work::print(common, &report, &people)?;
    match findings.len() {
        0 => Ok(()),
        n => Err(Fail::World(format!("{n} findings in {found} cities"))),
    }
}

/// A town that is drawn to be checked.
struct Wish {
    style: usize,
    radius: f64,
}

/// A world with drawn towns pinned side by side around a place that its seed draws, and the towns that could stand there, each with
/// its wish. What cannot stand in one place is tried in others.
fn crowd(plain: &World, seed: u64, styles: &[&String]) -> Result<Crowd, Fail> {
    let mut stream = Seed(seed).stream("towns to check", &[]);
    let with = |edits| World::new(WorldSource { seed: Seed(seed), edits, ..plain.source().clone() });
    let ground = with(plain.edits().clone())?;
    let cell = |i: usize| DVec2::new((i % CROWD) as f64, (i / CROWD) as f64) * APART;
    let dry =
        |base: DVec2| (0..CROWD * CROWD).filter(|i| ground.terrain().sample(base + cell(*i)).depth() == 0.0).count();
    let mut draw = || DVec2::new(stream.signed(), stream.signed()) * 200_000.0;
    let mut base = draw();
    for _ in 0..20 {
        if dry(base) + 2 < CROWD * CROWD {
            base = draw();
        }
    }
    let sizes = (0..CROWD * CROWD).map(|_| stream.weighted(&[0.5, 0.35, 0.15]).unwrap_or(0)).collect::<Vec<_>>();
    let wishes: Vec<Wish> = sizes
        .iter()
        .map(|s| Wish { style: stream.index(styles.len()), radius: stream.range(RADII[*s].0, RADII[*s].1).round() })
        .collect();
    let mut places: Vec<Option<DVec2>> = vec![None; wishes.len()];
    let mut tries = 1..8;
    loop {
        let mut edits = plain.edits().clone();
        for (i, wish) in wishes.iter().enumerate() {
            let jitter = DVec2::new(stream.signed(), stream.signed()) * ((APART - 3600.0) / 2.0);
            let at = *places[i].get_or_insert((base + cell(i) + jitter).round());
            let (size, style) = (towns::size_of(wish.radius), Some(styles[wish.style].clone()));
            edits.settlements.push(SettlementEdit::Pin { at, size, name: None, style, radius: Some(wish.radius) });
        }
        let world = with(edits)?;
        let mut standing = Vec::new();
        for (i, place) in places.iter_mut().enumerate() {
            let Some(at) = *place else { continue };
            match world.settlements().at(at)?.filter(|t| t.centre.plan() == at) {
                Some(town) => standing.push((i, town)),
                None => *place = None,
            }
        }
        if standing.len() == wishes.len() || tries.next().is_none() {
            return Ok(Crowd { world, wishes, towns: standing });
        }
    }
}

/// What [`crowd`] makes: towns by the index of their wish.
struct Crowd {
    world: World,
    wishes: Vec<Wish>,
    towns: Vec<(usize, Arc<Settlement>)>,
}

/// Checks towns of all sizes and styles, some side by side in each of many worlds.
fn check_towns(common: &Common, plain: &World, towns: u32) -> Result<(), Fail> {
    let styles: Vec<&String> = plain.assets().styles.keys().collect();
    let batches: Vec<u64> = (0..u64::from(towns).div_ceil(CHECKED)).collect();
    let checked = work::each(common, "checking towns", &batches, |i| {
        let seed = common.seed().wrapping_add(*i);
        let wanted = CHECKED.min(u64::from(towns) - i * CHECKED) as usize;
        let crowd = crowd(plain, seed, &styles)?;
        let mut out = Vec::new();
        for (wish, town) in crowd.towns.iter().take(wanted) {
            let Wish { style, radius } = crowd.wishes[*wish];
            // A panic is a finding like others.
            let panicked = |_| Ok(City { findings: vec![("Panic".to_owned(), town.centre.plan())], ..City::default() });
            let city = catch_unwind(AssertUnwindSafe(|| check(&crowd.world, town))).unwrap_or_else(panicked)?;
            out.push((seed, style, town.size, radius, city));
        }
        Ok(out)
    })?;
    let (mut findings, mut people) = (Vec::new(), String::new());
    let mut of: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    let mut excepted: BTreeMap<&str, (usize, Exceptions)> = BTreeMap::new();
    let (mut streets, mut buildings) = (0, 0);
    for (seed, style, size, radius, city) in checked.iter().flatten() {
        *of.entry((styles[*style], size.name())).or_default() += 1;
        streets += city.streets;
        buildings += city.buildings;
        let (of_style, counted) = excepted.entry(styles[*style]).or_default();
        *of_style += city.streets;
        for (kind, count) in &city.exceptions {
            *counted.entry(*kind).or_default() += count;
        }
        for (what, at) in &city.findings {
            let style = styles[*style];
            findings
                .push(json!({ "seed": seed, "style": style, "radius_m": radius, "what": what, "x": at.x, "y": at.y }));
            let _ = writeln!(people, "seed {seed}, {style}, radius {radius}: {what} at {},{}", at.x, at.y);
        }
    }
    let found: usize = of.values().sum();
    let kinds: Vec<Value> =
        of.iter().map(|((style, size), n)| json!({ "style": style, "size": size, "towns": n })).collect();
    for ((style, size), n) in &of {
        let _ = writeln!(people, "{style:12} {size:8} {n:6}");
    }
    let exceptions: serde_json::Map<String, Value> = excepted
        .iter()
        .map(|(style, (streets, counted))| {
            let counted = exceptions_json(counted);
            let _ = writeln!(people, "{style:12} exceptions in {streets} streets: {}", exceptions_line(&counted));
            (style.to_string(), json!({ "streets": streets, "exceptions": counted }))
        })
        .collect();
    let missing = towns as usize - found;
    let _ = writeln!(
        people,
        "{found} towns, {missing} without ground to stand on, {streets} streets, {buildings} buildings: {} findings",
        findings.len()
    );
    let count = findings.len();
    let report = json!({
        "towns": found, "towns_without_ground": missing, "kinds": kinds, "streets": streets, "buildings": buildings, "exceptions": exceptions,
        "findings": findings,
    });
    work::print(common, &report, &people)?;
    match count {
        0 => Ok(()),
        n => Err(Fail::World(format!("{n} findings in {found} towns"))),
    }
}

/// What a check found.
#[derive(Default)]
pub struct City {
    pub streets: usize,
    pub buildings: usize,
    /// Edits, and how many of them cannot be.
    pub edits: usize,
    pub rejected: usize,
    /// Roads at each way point.
    pub way_points: Vec<usize>,
    pub findings: Vec<(String, DVec2)>,
    /// Where streets break a rule of their style.
    pub exceptions: Exceptions,
}

/// The city nearest to the origin.
fn nearest(world: &World) -> Result<Option<Arc<Settlement>>, LayerError> {
    let cities = world.settlements().centred_in_of(Bounds::square(DVec2::ZERO, SEARCH), SizeClass::City)?;
    let distance = |s: &Arc<Settlement>| s.centre.plan().length();
    Ok(cities.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))))
}

/// Checks a world with drawn edits: the city nearest to the origin, what was pinned, and what lies around way points.
fn check_edited(world: &World) -> Result<City, LayerError> {
    let cancel = Cancel::new();
    let mut out = match nearest(world)? {
        Some(city) => check(world, &city)?,
        None => City::default(),
    };
    let edits = world.edits();
    let rejected = world.rejected_edits(&cancel)?;
    out.edits = edits.settlements.len() + edits.influences.len() + edits.way_points.len() + edits.roads.len();
    out.rejected = rejected.len();
    for edit in &edits.settlements {
        if let SettlementEdit::Pin { at, .. } = edit
            && let Some(pinned) = world.settlements().at(*at)?
        {
            let City { streets, buildings, findings, .. } = check(world, &pinned)?;
            out.streets += streets;
            out.buildings += buildings;
            out.findings.extend(findings);
        }
    }
    for point in world.roads().way_points() {
        let at = point.centre.plan();
        let area = world.area(Bounds::square(at, AROUND), &cancel)?;
        out.findings.extend(findings(&area));
        let junction = world.roads().way_point_junction(point.id);
        let place = area.junctions.iter().find(|j| j.item.id == junction).map(|j| area.origin.to_plan(j.item.at));
        let roads = roads_at(&area, junction);
        let refused = rejected.iter().any(|e| e.reason.contains(&point.name));
        if place != Some(at) && !refused {
            out.findings.push(("MissedWayPoint".to_owned(), at));
        }
        out.way_points.push(roads);
    }
    out.findings.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.x.total_cmp(&b.1.x)).then(a.1.y.total_cmp(&b.1.y)));
    out.findings.dedup();
    Ok(out)
}

/// Ends of roads at a junction.
fn roads_at(area: &Area, junction: JunctionId) -> usize {
    let ends = area.streets.iter().flat_map(|s| [s.item.street.from, s.item.street.to]);
    ends.filter(|id| *id == junction).count()
}

/// The broken promises of an area.
pub fn findings(area: &Area) -> Vec<(String, DVec2)> {
    audit(area).into_iter().map(|f| (format!("{:?}", f.what), f.at)).collect()
}

/// The gates of a settlement in an area that no main street reaches.
pub fn unreached(world: &World, area: &Area, settlement: &Settlement) -> Result<Vec<(String, DVec2)>, LayerError> {
    let outline = world.settlements().outline(settlement)?;
    let gates = unreached_gates(area, outline.origin, &outline.polygon);
    Ok(gates.into_iter().map(|at| ("UnreachedGate".to_owned(), area.origin.to_plan(at))).collect())
}

/// Checks a city with the settlements that it touches.
fn check(world: &World, city: &Arc<Settlement>) -> Result<City, LayerError> {
    let cancel = Cancel::new();
    let around = |s: &Settlement| Bounds::square(s.centre.plan(), 2.0 * (s.radius + MARGIN));
    let mut checked = vec![city.clone()];
    checked.extend(world.settlements().touching(city)?);
    let bounds = checked.iter().fold(Bounds::EMPTY, |all, s| all.union(around(s)));
    let area = world.area(bounds, &cancel)?;
    let mut findings = findings(&area);
    for settlement in &checked {
        findings.extend(unreached(world, &area, settlement)?);
    }
    let (streets, buildings) = (area.streets.len(), area.footprints.len());
    Ok(City { streets, buildings, findings, exceptions: exceptions(&area), ..City::default() })
}
