//! Towns of random valid styles, and worlds of random valid settings.

use bevy_sprawl::analysis::inputs::{DRAWN, Difference, Inputs};
use bevy_sprawl::analysis::{audit, exceptions};
use bevy_sprawl::edits::{Edits, SettlementEdit};
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::{JunctionId, SizeClass, StreetClass};
use bevy_sprawl::space::math::angle_between;
use bevy_sprawl::space::{Bounds, Seed, polygon_distance, segments};
use bevy_sprawl::streets::{Cause, Rule, StreetOrigin};
use bevy_sprawl::style::PatchCount;
use bevy_sprawl::world::{Area, Settings, World, WorldAssets, WorldError};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// Angle in radians by which streets may miss the least angle, since positions are rounded.
const SLACK: f64 = 0.006;

fn usual() -> Inputs {
    Inputs::new(Settings::default(), WorldAssets::bundled())
}

/// A world with a town of a drawn style on dry ground, and the town's place and radius.
fn town_of(usual: &Inputs, seed: u64) -> Option<(World, Vec<Difference>, DVec2, f64)> {
    let mut stream = Seed(seed).stream("random styles", &[]);
    let mut differences = usual.draw_differences(&mut stream).ok()?;
    // The usual ground and settlements, and one style for the whole town.
    differences.retain(|d| match d {
        Difference::Number(path, _) => !path.starts_with("settings."),
        d => !matches!(d, Difference::Fringe(_) | Difference::Everywhere),
    });
    let radius = stream.range(200.0, 400.0).round();
    for _ in 0..20 {
        let at = (DVec2::new(stream.signed(), stream.signed()) * 100_000.0).round();
        let (style, size) = (Some(DRAWN.to_owned()), SizeClass::Village);
        let pin = SettlementEdit::Pin { at, size, name: None, style, radius: Some(radius) };
        let edit = Difference::Edit(Edits { settlements: vec![pin], ..Edits::default() });
        let inputs = usual.with(&[&differences[..], &[edit]].concat()).expect("what is drawn is valid");
        let world = match World::new(inputs.source(Seed(seed))) {
            Ok(world) => world,
            Err(WorldError::NoPatches { .. }) => return None,
            Err(e) => panic!("seed {seed}: {e}"),
        };
        let town = world.settlements().at(at).expect("not cancelled").filter(|t| t.centre.plan() == at);
        if town.is_some_and(|t| world.settlements().touching(&t).expect("not cancelled").is_empty()) {
            return Some((world, differences, at, radius));
        }
    }
    None
}

/// The junctions of local streets where a rule is broken that the area does not count.
fn uncounted(area: &Area, world: &World) -> Vec<String> {
    let rules = &world.assets().styles[DRAWN].local;
    let mut ways: BTreeMap<JunctionId, Vec<DVec2>> = BTreeMap::new();
    let mut others: BTreeSet<JunctionId> = BTreeSet::new();
    let made_by_style = |made_by: &StreetOrigin| !matches!(made_by, StreetOrigin::Repair);
    let mut bad = Vec::new();
    let known = |rule: Rule, at: DVec2| area.exceptions.iter().any(|e| e.rule == rule && e.at.distance(at) < 1.0);
    for placed in area.streets.iter().map(|s| &s.item) {
        let (street, n) = (&placed.street, placed.street.line.len());
        let ends = [(street.from, street.line[0]), (street.to, street.line[n - 1])];
        if street.class != StreetClass::Local {
            others.extend([street.from, street.to]);
            continue;
        }
        let is_short = street.length() < rules.min_length - 0.2;
        let origin = placed.made_by.as_ref().map(|m| &m.origin);
        if is_short && origin.is_some_and(made_by_style) && !ends.iter().any(|(_, at)| known(Rule::Length, *at)) {
            bad.push(format!("a street of {} m at {}", street.length(), street.line[0]));
        }
        ways.entry(street.from).or_default().push(street.line[1] - street.line[0]);
        ways.entry(street.to).or_default().push(street.line[n - 2] - street.line[n - 1]);
    }
    let at: BTreeMap<JunctionId, DVec2> = area.junctions.iter().map(|j| (j.item.id, j.item.at)).collect();
    for (id, ways) in ways.into_iter().filter(|(id, _)| !others.contains(id)) {
        let sharp = |a: &DVec2, b: &DVec2| angle_between(*a, *b) < rules.min_angle_deg.to_radians() - SLACK;
        if (0..ways.len()).any(|i| ways[..i].iter().any(|b| sharp(&ways[i], b))) && !known(Rule::Angle, at[&id]) {
            bad.push(format!("a sharp angle at {}", at[&id]));
        }
        if ways.len() > (rules.degree.1 as usize).max(2) && !known(Rule::Degree, at[&id]) {
            bad.push(format!("{} streets at {}", ways.len(), at[&id]));
        }
    }
    bad
}

#[test]
fn towns_of_random_styles_keep_what_they_state() {
    let usual = usual();
    let (mut towns, mut streets, mut lots, mut counts) = (0, 0, 0, 0);
    for seed in 0..9 {
        let Some((world, differences, at, radius)) = town_of(&usual, seed) else { continue };
        let area = world.area(Bounds::square(at, 2.0 * radius + 300.0), &Cancel::new()).expect("not cancelled");
        let of = || differences.iter().map(|d| format!("{d}\n")).collect::<String>();
        let findings = audit(&area);
        assert!(findings.is_empty(), "seed {seed}: {findings:?}\n{}", of());
        let bad = uncounted(&area, &world);
        assert!(bad.is_empty(), "seed {seed}: {bad:?}\n{}", of());
        let pieces = &world.assets().styles[DRAWN].patches;
        for ((rule, cause), count) in exceptions(&area) {
            let is_due = match cause {
                Cause::Port | Cause::Drawing | Cause::Cell => matches!(rule, Rule::Length | Rule::Clearance),
                // What a style counts stands in any case.
                Cause::Pin => pieces.iter().any(|p| p.at_least > 0),
                Cause::Defect => false,
            };
            assert!(is_due, "seed {seed}: {count} times {rule:?} by {cause:?}\n{}", of());
        }
        for lot in area.lots.iter().map(|l| &l.item) {
            for street in area.streets.iter().map(|s| &s.item.street).filter(|s| !s.bridge && !s.tunnel) {
                if street.bounds().grown(10.0).overlaps(Bounds::of(lot.polygon.iter().copied())) {
                    let near = segments(&street.line).map(|(a, b)| polygon_distance(a, b, &lot.polygon));
                    let near = near.fold(f64::INFINITY, f64::min);
                    assert!(
                        near > street.class.half_width() - 0.1,
                        "seed {seed}: lot {} is {near} m off\n{}",
                        lot.id,
                        of()
                    );
                }
            }
        }
        let town = world.settlements().at(at).expect("not cancelled").expect("it stands");
        let town = world.town(&town, &Cancel::new()).expect("not cancelled");
        for PatchCount { patch, at_most, .. } in pieces {
            let stands = |cell: &usize| {
                let streets = world.stack().streets(&town, *cell, &Cancel::new()).expect("not cancelled");
                let is_piece = |origin: &StreetOrigin| matches!(origin, StreetOrigin::Piece(p) if p.ends_with(&format!("/{patch}")));
                streets.streets.iter().any(|s| is_piece(&s.made_by.origin))
            };
            let cells = (0..town.town.cells.len()).filter(stands).count();
            assert!(
                at_most.is_none_or(|most| cells <= most as usize),
                "seed {seed}: {patch} stands in {cells}\n{}",
                of()
            );
            counts += 1;
        }
        towns += 1;
        streets += area.streets.len();
        lots += area.lots.len();
    }
    assert!(towns > 4 && streets > 150 && lots > 50 && counts > 2, "{towns} {streets} {lots} {counts}");
}

#[test]
fn random_settings_give_a_map_or_are_refused() {
    let usual = usual();
    let (mut made, mut refused) = (0, 0);
    for seed in 0..12 {
        let mut stream = Seed(seed).stream("random settings", &[]);
        let source = usual.draw_differences(&mut stream).map(|d| usual.with(&d).expect("what is drawn is valid"));
        let Ok(world) = source
            .map_err(|e| e.to_string())
            .and_then(|inputs| World::new(inputs.source(Seed(seed))).map_err(|e| e.to_string()))
        else {
            refused += 1;
            continue;
        };
        let at = DVec2::new(stream.signed(), stream.signed()) * 50_000.0;
        // A bound in steps holds on every machine.
        let area = world.area(Bounds::square(at, 2_000.0), &Cancel::after(200_000));
        let area = area.unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        let findings = audit(&area);
        assert!(findings.is_empty(), "seed {seed}: {findings:?}");
        made += 1;
    }
    assert!(made > 3 && made + refused == 12, "{made} maps, {refused} refused");
}
