//! Towns that rivers run through, in worlds of many seeds.

use bevy_sprawl::analysis::audit;
use bevy_sprawl::chunk::Chunk;
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::{JunctionId, SizeClass, Street};
use bevy_sprawl::region::{Outline, Settlement, Waterway};
use bevy_sprawl::space::math::{angle_between, cos, sin};
use bevy_sprawl::space::{Bounds, DisjointSets, Seed, point_at, point_in_polygon, segments, signed_area};
use bevy_sprawl::terrain::{Terrain, TerrainSample};
use bevy_sprawl::town::{CellUse, Town};
use bevy_sprawl::world::{TerrainSource, World, WorldSource};
use glam::DVec2;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

type Found = Vec<(Arc<Settlement>, Arc<Outline>)>;

/// Ground full of rivers that wind, of widths up to `widest`, 1,700 m apart.
struct Valleys {
    widest: f64,
    bend: f64,
    phase: f64,
}

impl Valleys {
    /// A draw of such ground: bends from none to narrow ones.
    fn draw(seed: u64) -> Self {
        let mut s = Seed(seed).stream("valleys", &[]);
        Self { widest: s.range(20.0, 118.0), bend: s.range(0.0, 0.6), phase: s.range(0.0, 6.0) }
    }
}

impl Terrain for Valleys {
    fn sample(&self, p: DVec2) -> TerrainSample {
        let (wave, length) = (p.x / 220.0 + self.phase, 220.0);
        let slope = self.bend * cos(wave);
        let off = p.y - self.bend * length * sin(wave);
        let k = (off / 1700.0).round();
        let width = self.widest * (0.75 + 0.25 * sin(p.x / 700.0 + k));
        let beside = (off - k * 1700.0).abs() / (1.0 + slope * slope).sqrt() - width / 2.0;
        let land = 12.0 + 3.0 * sin(p.x / 900.0) * sin(p.y / 700.0);
        TerrainSample { height: (beside * 0.2).clamp(-3.0, land), water_level: 0.0, vegetation: 0.2 }
    }
}

/// Towns and cities of a world around its origin that rivers run through, with how many there are in all.
fn river_towns(world: &World, size: f64) -> (usize, Found) {
    let near = Bounds::square(DVec2::ZERO, size);
    let mut all = world.settlements().centred_in_of(near, SizeClass::Town).expect("nothing is cancelled");
    all.extend(world.settlements().centred_in_of(near, SizeClass::City).expect("nothing is cancelled"));
    let count = all.len();
    let with = all.into_iter().map(|s| {
        let outline = world.settlements().outline(&s).expect("nothing is cancelled");
        (s, outline)
    });
    (count, with.filter(|(_, o)| o.river.is_some()).collect())
}

fn wet(world: &World, p: DVec2) -> bool {
    world.stack().terrain().sample(p).depth() > 0.0
}

/// Bridges of a plan, checked against the river; all else keeps off it.
fn check_plan(world: &World, town: &Town, way: &Waterway, what: &str) -> usize {
    let mut bridges = 0;
    for main in &town.mains {
        let line = &main.street.line;
        let crosses = segments(line).any(|(a, b)| way.crosses(a, b));
        assert_eq!(main.street.bridge, crosses, "{what}: a bridge at {}", line[0]);
        if crosses {
            bridges += 1;
            let (a, b) = (line[0], line[line.len() - 1]);
            let across = way.banks.iter().map(|bank| nearest_heading(bank, a, b));
            for heading in across {
                let off = (angle_between(heading, b - a) - FRAC_PI_2).abs();
                assert!(off < 0.45, "{what}: a bridge at {off:.2} off the square");
            }
            assert!(a.distance(b) < 230.0, "{what}: {} m", a.distance(b));
            assert!(!wet(world, town.origin.to_plan(a)) && !wet(world, town.origin.to_plan(b)), "{what}: {a}");
        } else {
            let length = main.street.length();
            for i in 0..=(length / 5.0) as usize {
                let p = town.origin.to_plan(point_at(line, i as f64 * 5.0).0);
                assert!(!wet(world, p), "{what}: a street in water at {p}");
            }
        }
    }
    let water: Vec<_> = town.cells.iter().filter(|c| c.cell_use == CellUse::Water).collect();
    let area: f64 = water.iter().map(|c| signed_area(&c.border)).sum();
    assert!((area - signed_area(&way.bed())).abs() < 1.0, "{what}: the bed is not the river's cells");
    assert_eq!(water.len(), bridges + 1, "{what}");
    bridges
}

/// Heading of a bank line where the way from `a` to `b` meets it.
fn nearest_heading(bank: &[DVec2], a: DVec2, b: DVec2) -> DVec2 {
    let middle = a.lerp(b, 0.5);
    let piece = segments(bank).min_by(|x, y| {
        bevy_sprawl::space::distance_to_segment(middle, x.0, x.1)
            .total_cmp(&bevy_sprawl::space::distance_to_segment(middle, y.0, y.1))
    });
    piece.map_or(DVec2::X, |(p, q)| q - p)
}

#[test]
fn bridges_lead_over_the_rivers_that_run_through_towns() {
    let (mut towns, mut with, mut bridges) = (0, 0, 0);
    for seed in 1..=3 {
        let world = World::new(WorldSource::new(Seed(seed))).unwrap();
        let (count, found) = river_towns(&world, 40_000.0);
        towns += count;
        with += found.len();
        for (settlement, outline) in found {
            let what = format!("seed {seed}, {} at {}", settlement.name, settlement.centre.plan());
            let town = world.town(&settlement, &Cancel::new()).unwrap();
            let way = outline.river.as_ref().unwrap();
            let count = check_plan(&world, &town.town, way, &what);
            println!("{what}: radius {:.0}, {} bridges, {}", settlement.radius, count, settlement.style);
            assert!(count > 0, "{what}: no bridge");
            check_network(&town.town, &what);
            bridges += count;
        }
    }
    println!("{with} of {towns} towns have a river, {bridges} bridges");
    assert!(with > 5, "{with} of {towns}");
}

#[test]
fn nothing_is_built_in_rivers() {
    for seed in 1..=3 {
        let world = World::new(WorldSource::new(Seed(seed))).unwrap();
        for (settlement, outline) in river_towns(&world, 40_000.0).1.into_iter().take(2) {
            let bounds = Bounds::square(settlement.centre.plan(), 2.0 * (settlement.radius + 200.0));
            let area = world.area(bounds, &Cancel::new()).unwrap();
            let found = audit(&area);
            assert!(found.is_empty(), "{}", found[0]);
            let bed = outline.river.as_ref().unwrap().bed();
            for footprint in &area.footprints {
                for p in &footprint.item.polygon {
                    let plan = area.origin.to_plan(*p);
                    assert!(!wet(&world, plan), "a building in water at {plan}");
                    assert!(!point_in_polygon(outline.origin.to_local(plan), &bed), "a building in a bed at {plan}");
                }
            }
            for bridge in area.streets.iter().filter(|s| s.item.street.bridge && s.item.street.class.is_main()) {
                check_deck(&world, &world.chunk(bridge.chunk, &Cancel::new()).unwrap(), &bridge.item.street);
            }
            let dry = |s: &Street| segments(&s.line).all(|(a, b)| !wet(&world, area.origin.to_plan(a.lerp(b, 0.5))));
            let local = area.streets.iter().map(|s| &s.item.street).filter(|s| !s.class.is_road() && !s.bridge);
            for street in local {
                assert!(dry(street), "a street in water at {}", area.origin.to_plan(street.line[0]));
            }
        }
    }
}

#[test]
fn towns_lie_on_both_banks_of_every_river_that_can_be_bridged() {
    let (mut towns, mut with, mut bridges) = (0, 0, 0);
    for seed in 400..408 {
        let ground = Arc::new(Valleys::draw(seed));
        let world =
            World::new(WorldSource { terrain: TerrainSource::Own(ground), ..WorldSource::new(Seed(seed)) }).unwrap();
        let (count, found) = river_towns(&world, 16_000.0);
        towns += count;
        with += found.len();
        for (settlement, outline) in found {
            let what = format!("seed {seed}, {} at {}", settlement.name, settlement.centre.plan());
            let town = world.town(&settlement, &Cancel::new()).unwrap();
            bridges += check_plan(&world, &town.town, outline.river.as_ref().unwrap(), &what);
            check_network(&town.town, &what);
        }
    }
    println!("{with} of {towns} towns have a river, {bridges} bridges");
    assert!(with > 4, "{with} of {towns}");
}

/// The main streets of a town are one piece without dead ends but gates.
fn check_network(town: &Town, what: &str) {
    let mut degree: BTreeMap<JunctionId, usize> = BTreeMap::new();
    let mut pieces = DisjointSets::new();
    for s in town.mains.iter().map(|m| &m.street) {
        *degree.entry(s.from).or_default() += 1;
        *degree.entry(s.to).or_default() += 1;
        pieces.union(s.from, s.to);
    }
    for junction in &town.junctions {
        assert!(pieces.same(junction.id, town.junctions[0].id), "{what}: several pieces");
        let gate = town.gates.iter().any(|g| g.junction == junction.id);
        assert!(gate || degree[&junction.id] > 1, "{what}: a dead end at {}", junction.at);
    }
    for gate in &town.gates {
        assert!(degree.contains_key(&gate.junction), "{what}: a gate without a street");
    }
    let area: f64 = town.cells.iter().map(|c| signed_area(&c.border)).sum();
    assert!((area - town.outline.area()).abs() < 1e-3, "{what}: cells cover {area} of {}", town.outline.area());
}

/// The deck of a town's bridge leaves room above the water and is no ramp.
fn check_deck(world: &World, chunk: &Chunk, bridge: &Street) {
    let deck = chunk.decks.iter().find(|d| d.street == bridge.id).expect("a bridge has a deck");
    let mut wet_points = 0;
    for (p, height) in deck.line.iter().zip(&deck.heights) {
        let sample = world.terrain().sample(chunk.origin.to_plan(*p));
        wet_points += usize::from(sample.depth() > 0.0);
        assert!(sample.depth() == 0.0 || *height >= sample.water_level + 1.0, "{height} at {p}");
    }
    assert!(wet_points > 0);
    for (line, heights) in deck.line.windows(2).zip(deck.heights.windows(2)) {
        let grade = (heights[1] - heights[0]).abs() / line[0].distance(line[1]);
        assert!(grade < 0.35, "a grade of {grade:.2} at {}", chunk.origin.to_plan(line[0]));
    }
}
