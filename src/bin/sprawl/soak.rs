//! `sprawl soak`: checks a city of each of many worlds, with the settlements that it touches, against what the design
//! promises.

use crate::args::{Common, SoakArgs};
use crate::fail::Fail;
use crate::work;
use bevy_sprawl::layer::{Cancel, LayerError};
use bevy_sprawl::region::{Settlement, SizeClass};
use bevy_sprawl::space::{Bounds, Seed};
use bevy_sprawl::world::{World, audit, unreached_gates};
use glam::DVec2;
use serde_json::{Value, json};
use std::fmt::Write;

/// A city is looked for in a square of this edge, in metres, around the origin.
const SEARCH: f64 = 100_000.0;
/// What is checked around a city beyond its radius, in metres.
const MARGIN: f64 = 250.0;

/// Runs the command. Findings make it fail with exit code 1.
pub fn run(common: &Common, args: &SoakArgs) -> Result<(), Fail> {
    let world = work::world(common)?;
    let (settings, assets) = (world.settings().clone(), world.assets().clone());
    let seeds: Vec<u64> = args.seeds.clone().collect();
    let cities = work::each(common, "checking cities", &seeds, |seed| {
        let world = World::with_edits(Seed(*seed), settings.clone(), assets.clone(), world.edits().clone());
        // The settings and assets are those of a world that was made already.
        world.map_or(Ok(City::default()), |world| check(&world))
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
    let report: Value = json!({
        "seeds": seeds.len(), "cities": found, "streets": sum(|c| c.streets), "buildings": sum(|c| c.buildings),
        "findings": findings,
    });
    let (streets, buildings) = (&report["streets"], &report["buildings"]);
    let _ = writeln!(people, "{found} cities, {streets} streets, {buildings} buildings: {} findings", findings.len());
    work::print(common, &report, &people)?;
    match findings.len() {
        0 => Ok(()),
        n => Err(Fail::World(format!("{n} findings in {found} cities"))),
    }
}

#[derive(Default)]
struct City {
    streets: usize,
    buildings: usize,
    findings: Vec<(String, DVec2)>,
}

/// Checks the city nearest to the origin.
fn check(world: &World) -> Result<City, LayerError> {
    let cancel = Cancel::new();
    let cities = world.settlements().centred_in_of(Bounds::square(DVec2::ZERO, SEARCH), SizeClass::City)?;
    let distance = |p: DVec2| p.length();
    let nearest = cities.iter().min_by(|a, b| distance(a.centre.plan()).total_cmp(&distance(b.centre.plan())));
    let Some(city) = nearest else { return Ok(City::default()) };
    let around = |s: &Settlement| Bounds::square(s.centre.plan(), 2.0 * (s.radius + MARGIN));
    let mut checked = vec![city.clone()];
    checked.extend(world.settlements().touching(city)?);
    let bounds = checked.iter().fold(Bounds::EMPTY, |all, s| all.union(around(s)));
    let area = world.area(bounds, &cancel)?;
    let mut findings: Vec<_> = audit(&area).into_iter().map(|f| (format!("{:?}", f.what), f.at)).collect();
    for settlement in &checked {
        let outline = world.settlements().outline(settlement)?;
        let gates = unreached_gates(&area, outline.origin, &outline.polygon);
        findings.extend(gates.into_iter().map(|at| ("UnreachedGate".to_owned(), area.origin.to_plan(at))));
    }
    Ok(City { streets: area.streets.len(), buildings: area.footprints.len(), findings })
}
