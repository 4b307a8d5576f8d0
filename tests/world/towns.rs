//! What styles, counts and pinned patches make of towns.

use bevy_sprawl::edits::{EditList, Edits, PatchEdit};
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::{JunctionId, SizeClass, Street};
use bevy_sprawl::region::Settlement;
use bevy_sprawl::space::math::rotate;
use bevy_sprawl::space::{Bounds, ChunkCoord, DisjointSets, Seed, distance_to_line, signed_area, stable_hash};
use bevy_sprawl::stack::PreparedCell;
use bevy_sprawl::streets::{MadeBy, StreetOrigin};
use bevy_sprawl::style::{Filler, FringeRules, LocalRules, PatchCount, Style};
use bevy_sprawl::town::CellUse;
use bevy_sprawl::world::{World, WorldAssets, WorldSource};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

fn world(assets: WorldAssets, edits: Edits) -> World {
    World::new(WorldSource { assets, edits, ..WorldSource::new(Seed(5)) }).expect("they are right")
}

/// Towns of a style near the origin.
fn towns(world: &World, style: &str) -> Vec<Arc<Settlement>> {
    let near = Bounds::square(DVec2::ZERO, 60_000.0);
    let mut all = world.settlements().centred_in_of(near, SizeClass::Town).expect("nothing is cancelled");
    all.extend(world.settlements().centred_in_of(near, SizeClass::City).expect("nothing is cancelled"));
    all.retain(|s| s.style == style);
    all
}

fn never() -> Cancel {
    Cancel::new()
}

#[test]
fn the_fringe_takes_over_from_the_centre() {
    let w = world(WorldAssets::bundled(), Edits::default());
    let (mut centre, mut middle, mut outside) = (0, 0, 0);
    for settlement in towns(&w, "european").iter().take(4) {
        let town = w.town(settlement, &never()).unwrap();
        let (own, fringe) = (&w.assets().styles["european"], &w.assets().styles["suburb"]);
        let outline = w.settlements().outline(settlement).unwrap();
        let radius = (outline.area() / std::f64::consts::PI).sqrt();
        for (cell, with) in town.town.cells.iter().zip(&town.styles) {
            let share = own.fringe_share(cell.anchor.length() / radius);
            let expected = own.local.length + (fringe.local.length - own.local.length) * share;
            assert!((with.style.local.length - expected).abs() < 0.05 * own.local.length, "{share}");
            let sum: f64 = with.parts.iter().map(|(_, share)| share).sum();
            assert!((sum - 1.0).abs() < 1e-9);
            centre += usize::from(with.style.local == own.local);
            middle += usize::from(share > 0.1 && share < 0.9);
            outside += usize::from(share > 0.9);
        }
    }
    assert!(centre > 5 && middle > 5 && outside > 3, "{centre} {middle} {outside}");
}

#[test]
fn counted_patches_stand_as_often_as_the_style_says() {
    let mut assets = WorldAssets::bundled();
    let mut style = Style::clone(&assets.styles["suburb"]);
    let count = |patch: &str, at_least, at_most, weight| PatchCount { patch: patch.into(), at_least, at_most, weight };
    style.patches = vec![
        count("cross", 0, Some(0), 1.0),
        count("tee", 0, Some(3), 50.0),
        count("roundabout of four", 2, Some(2), 1.0),
    ];
    assets.styles.insert("suburb".into(), Arc::new(style));
    let w = world(assets, Edits::default());
    let (mut tees, mut rounds) = (0, 0);
    for settlement in towns(&w, "suburb").iter().take(5) {
        let town = w.town(settlement, &never()).unwrap();
        let cells_with = |name: &str| {
            let uses = |i: usize| {
                let streets = w.stack().streets(&town, i, &never()).unwrap();
                let names = |m: &MadeBy| match &m.origin {
                    StreetOrigin::Piece(piece) => piece.ends_with(&format!("/{name}")),
                    _ => false,
                };
                streets.streets.iter().any(|s| names(&s.made_by))
            };
            (0..town.town.cells.len()).filter(|i| uses(*i)).count()
        };
        assert_eq!(cells_with("cross"), 0, "{}", settlement.name);
        assert!(cells_with("tee") <= 3 && cells_with("roundabout of four") <= 2, "{}", settlement.name);
        tees += cells_with("tee");
        rounds += cells_with("roundabout of four");
    }
    assert!(tees >= 5 && rounds >= 8, "{tees} tees, {rounds} roundabouts");
}

#[test]
fn a_pinned_patch_stands_where_it_is_pinned_or_is_rejected_alone() {
    let plain = world(WorldAssets::bundled(), Edits::default());
    let settlement = towns(&plain, "suburb").remove(0);
    let town = plain.town(&settlement, &never()).unwrap();
    let mut cells: Vec<_> = town.town.cells.iter().filter(|c| c.cell_use == CellUse::Built).collect();
    cells.sort_by_key(|c| stable_hash(&[c.id.0]));
    let wish = |patch: &str, at: DVec2, heading_deg: f64| PatchEdit {
        patch: patch.into(),
        at: town.town.origin.to_plan(at.round()),
        heading_deg,
        mirrored: heading_deg > 100.0,
    };
    let mut patches: Vec<PatchEdit> =
        cells.iter().take(8).enumerate().map(|(i, c)| wish("tee", c.anchor, 40.0 * i as f64)).collect();
    patches.push(wish("market square", cells[8].anchor, 10.0));
    let good = patches.len();
    patches.push(wish("no such patch", cells[0].anchor, 0.0));
    patches.push(wish("link", DVec2::splat(30_000.0), 0.0));
    patches.push(wish("link", town.town.mains[0].street.line[0], 0.0));
    let edits = Edits { patches, ..Edits::default() };
    let w = world(WorldAssets::bundled(), edits.clone());
    let rejected: BTreeSet<usize> = w.rejected_edits(&never()).unwrap().iter().map(|r| r.index).collect();
    assert!((good..good + 3).all(|i| rejected.contains(&i)), "{rejected:?}");
    assert!(rejected.len() <= 3 + good / 2, "{:?}", w.rejected_edits(&never()));
    assert!(w.rejected_edits(&never()).unwrap().iter().all(|r| r.list == EditList::Patches));
    let pinned = w.town(&settlement, &never()).unwrap();
    for (index, edit) in edits.patches.iter().enumerate().filter(|(i, _)| !rejected.contains(i)) {
        let local = pinned.town.origin.to_local(edit.at);
        let pins = |c: &Option<PreparedCell>| c.as_ref().is_some_and(|c| c.edits.contains(&index));
        let cell = pinned.fillers.iter().position(pins).expect("it is not rejected");
        let mut sets = w.assets().patch_sets.values();
        let patch = sets.find_map(|set| set.patches.iter().find(|p| p.name == edit.patch)).unwrap();
        let streets = w.stack().streets(&pinned, cell, &never()).unwrap();
        for edge in &patch.edges {
            let middle = patch.vertices[edge.a].lerp(patch.vertices[edge.b], 0.5);
            let mirror = if edit.mirrored { DVec2::new(1.0, -1.0) } else { DVec2::ONE };
            let at = local + rotate(middle * mirror, edit.heading_deg.to_radians());
            let away = streets.streets.iter().map(|s| distance_to_line(at, &s.street.line));
            let off = away.fold(f64::INFINITY, f64::min);
            assert!(off < 1.0, "{}: {off} m from where it is pinned", edit.patch);
        }
    }
    // Nothing changes but what is said to.
    let size = w.settings().chunk_size;
    let middle = ChunkCoord::containing(settlement.centre.plan(), size);
    let near = || (-4..=4).flat_map(|y| (-4..=4).map(move |x| ChunkCoord::new(middle.0.x + x, middle.0.y + y)));
    let changed = w.changed_chunks(&plain, near(), &never()).unwrap();
    let print = |w: &World, c: ChunkCoord| format!("{:?}", w.chunk(c, &never()).unwrap());
    let really: BTreeSet<ChunkCoord> = near().filter(|c| print(&w, *c) != print(&plain, *c)).collect();
    assert!(!really.is_empty() && really.is_subset(&changed), "{really:?} {changed:?}");
    assert!(changed.len() < 60, "{}", changed.len());
}

#[test]
fn a_town_of_two_fillers_is_one_network_without_unmet_ports() {
    let mut assets = WorldAssets::bundled();
    let grown = Style { name: "grown".into(), filler: Filler::Parametric, ..Style::clone(&assets.styles["suburb"]) };
    let mut centre = Style::clone(&assets.styles["european"]);
    centre.fringe = Some(FringeRules { style: grown.name.clone(), begins: 0.3, complete: 0.9 });
    assets.styles.insert(grown.name.clone(), Arc::new(grown));
    assets.styles.insert(centre.name.clone(), Arc::new(centre));
    let w = world(assets, Edits::default());
    for settlement in towns(&w, "european").iter().take(3) {
        let town = w.town(settlement, &never()).unwrap();
        let mut cells_by_filler: BTreeMap<&str, usize> = BTreeMap::new();
        let mut joined: DisjointSets<JunctionId> = DisjointSets::new();
        let mut junctions: BTreeSet<JunctionId> = BTreeSet::new();
        let mut join = |street: &Street| {
            joined.union(street.from, street.to);
            junctions.extend([street.from, street.to]);
        };
        town.mains.streets.iter().for_each(&mut join);
        for cell in 0..town.town.cells.len() {
            let streets = w.stack().streets(&town, cell, &never()).unwrap();
            assert_eq!(streets.unmet, [], "{}: cell {cell}", settlement.name);
            if let Some(street) = streets.streets.first() {
                *cells_by_filler.entry(street.made_by.filler).or_default() += 1;
            }
            streets.streets.iter().for_each(|s| join(&s.street));
        }
        let semantic = cells_by_filler.get("SemanticPatches").copied().unwrap_or_default();
        let parametric = cells_by_filler.get("Parametric").copied().unwrap_or_default();
        assert!(semantic > 3 && parametric > 3, "{}: {cells_by_filler:?}", settlement.name);
        let parts: BTreeSet<JunctionId> = junctions.iter().map(|j| joined.find(*j)).collect();
        assert_eq!(parts.len(), 1, "{} falls into {} parts", settlement.name, parts.len());
    }
}

#[test]
fn growth_makes_of_a_town_what_its_style_asks() {
    // Street km in a km2 of the cells of a town that only grows, and the connected node ratio.
    let figures = |degree: (u32, u32), dead_ends: f64, length: f64| {
        let mut assets = WorldAssets::bundled();
        let mut style = Style::clone(&assets.styles["organic"]);
        (style.filler, style.fringe) = (Filler::Parametric, None);
        // Wide cells with few ports: the streets of ports must be there whatever a style asks.
        (style.main.length, style.main.min_length, style.seam.spacing) = (420.0, 200.0, 170.0);
        style.local = LocalRules {
            length,
            deviation: 0.2 * length,
            min_length: 20.0,
            degree,
            min_angle_deg: 50.0,
            angle_deviation_deg: 10.0,
            snap_radius: 20.0,
            clearance: 15.0,
            block_width: 0.0,
            dead_ends,
            rounding: 0.0,
        };
        assets.styles.insert("organic".into(), Arc::new(style));
        let w = world(assets, Edits::default());
        let town = w.town(&towns(&w, "organic")[0], &never()).unwrap();
        let (mut length, mut area, mut degrees) = (0.0, 0.0, BTreeMap::<JunctionId, usize>::new());
        let built = town.town.cells.iter().enumerate().filter(|(_, cell)| cell.cell_use == CellUse::Built);
        for (i, cell) in built.filter(|(i, _)| town.styles[*i].style.filler == Filler::Parametric) {
            let streets = w.stack().streets(&town, i, &never()).unwrap();
            assert!(streets.unmet.is_empty());
            area += signed_area(&cell.border);
            for street in streets.streets.iter().map(|s| &s.street) {
                length += street.length();
                let inner =
                    [street.from, street.to].into_iter().filter(|j| streets.junctions.iter().any(|k| k.id == *j));
                inner.for_each(|j| *degrees.entry(j).or_default() += 1);
            }
        }
        let count = |of: fn(usize) -> bool| degrees.values().filter(|d| of(**d)).count() as f64;
        let (junctions, dead_ends) = (count(|d| d >= 3), count(|d| d == 1));
        assert!(junctions > 30.0, "{junctions} junctions");
        (length * 1e3 / area, junctions / (junctions + dead_ends))
    };
    let (sparse, dense) = (figures((2, 3), 0.0, 50.0), figures((4, 5), 0.0, 50.0));
    assert!(dense.0 > 1.5 * sparse.0 && dense.1 > 0.85, "{sparse:?} {dense:?}");
    let loose = figures((4, 5), 1.0, 50.0);
    assert!(loose.1 < dense.1 - 0.1, "{loose:?} {dense:?}");
    let long = figures((4, 5), 0.0, 200.0);
    assert!(long.0 < 0.7 * dense.0 && long.1 > 0.75, "{long:?} {dense:?}");
}
