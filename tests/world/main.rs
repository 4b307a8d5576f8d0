//! The one promise: what is made depends on seed, settings, assets and edits alone, wherever, whenever and on whichever thread.

mod inputs;
mod lanes;
mod random;
mod rivers;
mod solids;
mod surface;
mod towns;

use bevy_sprawl::analysis::ChunkBorderCounts;
use bevy_sprawl::analysis::{Fault, audit, unreached_gates};
use bevy_sprawl::chunk::Chunk;
use bevy_sprawl::edits::Edits;
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::{SizeClass, StreetId};
use bevy_sprawl::parcel::STOREY_HEIGHT;
use bevy_sprawl::space::{Bounds, ChunkCoord, Seed, point_at, stable_hash};
use bevy_sprawl::surface::Pieces;
use bevy_sprawl::terrain::{Raster, RasterTerrain, Terrain, TerrainSample};
use bevy_sprawl::town::MainStreet;
use bevy_sprawl::world::{Settings, TerrainSource, World, WorldSource};
use glam::DVec2;
use proptest::prelude::*;
use std::collections::BTreeMap;

fn world(seed: u64, settings: &Settings) -> World {
    World::new(WorldSource { settings: settings.clone(), ..WorldSource::new(Seed(seed)) }).expect("settings are valid")
}

/// Everything in a chunk, to the last bit.
fn print(chunk: &Chunk) -> u64 {
    stable_hash(&format!("{chunk:?}").bytes().map(u64::from).collect::<Vec<_>>())
}

/// A chunk near the settlement nearest to a plan point.
fn built_up(world: &World, near: DVec2) -> ChunkCoord {
    let found = world.settlements().centred_in(Bounds::square(near, 24_000.0)).expect("not cancelled");
    let centre = found.iter().map(|s| s.centre.plan()).min_by(|a, b| a.distance(near).total_cmp(&b.distance(near)));
    ChunkCoord::containing(centre.unwrap_or(near), world.settings().chunk_size)
}

/// Towns and villages that grow together.
fn conurbation() -> Settings {
    let file = "assets/settings/conurbation.ron";
    let mut settings =
        Settings::from_ron(file, include_str!("../../assets/settings/conurbation.ron")).expect("it is checked");
    let s = &mut settings.settlements;
    (s.share.city, s.spacing.town, s.radius.town) = (0.0, 900.0, (560.0, 680.0));
    settings
}

fn block(middle: ChunkCoord) -> Vec<ChunkCoord> {
    let steps = || -1..=1;
    steps().flat_map(|y| steps().map(move |x| ChunkCoord::new(middle.0.x + x, middle.0.y + y))).collect()
}

#[test]
fn edits_change_what_they_name_and_nothing_far_away() {
    let plain = world(5, &Settings::default());
    let text = r#"(
        settlements: [Pin(at: (-5900, 2500), size: Town, style: "grid"), Ban(at: (8711, 3226), radius: 500)],
        influences: [(shape: Point((1000, 1000)), radius: 900, strength: -0.5)],
    )"#;
    let edits = Edits::from_ron("edits.ron", text).expect("it is right");
    let edited =
        || World::new(WorldSource { edits: edits.clone(), ..WorldSource::new(Seed(5)) }).expect("settings are valid");
    let (first, again) = (edited(), edited());
    assert_eq!(first.rejected_edits(&Cancel::new()), Ok(vec![]));
    let pinned = ChunkCoord::containing(DVec2::new(-5900.0, 2500.0), 512);
    let chunk = |world: &World, at: ChunkCoord| print(&world.chunk(at, &Cancel::new()).expect("not cancelled"));
    assert_ne!(chunk(&plain, pinned), chunk(&first, pinned));
    let far = built_up(&plain, DVec2::new(300_000.0, -150_000.0));
    for at in [far, ChunkCoord::new(far.0.x + 1, far.0.y)] {
        assert_eq!(chunk(&plain, at), chunk(&first, at));
    }
    // The other way round, with what is far made first.
    assert_eq!(chunk(&again, far), chunk(&first, far));
    assert_eq!(chunk(&again, pinned), chunk(&first, pinned));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, ..ProptestConfig::default() })]

    #[test]
    fn order_threads_and_eviction_change_nothing(
        seed in any::<u64>(),
        far in prop_oneof![Just(0i64), -3_000_000..3_000_000i64, Just(512_000_000i64), Just(-512_000_000i64)],
        towns in 4_000.0..9_000.0f64,
        turn in 0usize..9,
    ) {
        let mut settings = Settings::default();
        settings.settlements.spacing.town = towns;
        let forward = world(seed, &settings);
        let coords = block(built_up(&forward, DVec2::new(far as f64, -(far as f64) / 2.0)));
        let get = |w: &World, c: &ChunkCoord| print(&w.chunk(*c, &Cancel::new()).expect("not cancelled"));
        let expected: Vec<u64> = coords.iter().map(|c| get(&forward, c)).collect();

        let backward = world(seed, &settings);
        let mut reversed: Vec<u64> = coords.iter().rev().map(|c| get(&backward, c)).collect();
        reversed.reverse();
        prop_assert_eq!(&expected, &reversed, "reverse order");

        let alone = world(seed, &settings);
        prop_assert_eq!(expected[turn], get(&alone, &coords[turn]), "alone");

        alone.forget_chunks();
        let (a, b) = coords.split_at(4);
        let threaded = std::thread::scope(|s| {
            let first = s.spawn(|| a.iter().map(|c| get(&alone, c)).collect::<Vec<_>>());
            let second = s.spawn(|| b.iter().map(|c| get(&alone, c)).collect::<Vec<_>>());
            [first, second].into_iter().flat_map(|t| t.join().expect("no panic")).collect::<Vec<_>>()
        });
        prop_assert_eq!(&expected, &threaded, "two threads, after eviction");
    }
}

#[test]
fn seeds_differ() {
    let settings = Settings::default();
    let chunk = |seed| {
        let w = world(seed, &settings);
        print(&w.chunk(built_up(&w, DVec2::ZERO), &Cancel::new()).unwrap())
    };
    assert_ne!(chunk(1), chunk(2));
}

/// A plain.
struct Flat;

impl Terrain for Flat {
    fn sample(&self, _: DVec2) -> TerrainSample {
        TerrainSample { height: 20.0, water_level: 0.0, vegetation: 0.25 }
    }
}

#[test]
fn a_world_stands_on_the_ground_that_a_game_brings() {
    let w = World::new(WorldSource { terrain: TerrainSource::own(Flat), ..WorldSource::new(Seed(5)) }).unwrap();
    let chunk = w.chunk(built_up(&w, DVec2::ZERO), &Cancel::new()).unwrap();
    assert!(!chunk.streets.is_empty() && !chunk.footprints.is_empty());
    assert!(chunk.ground.samples.iter().all(|s| s.height == 20.0 && s.depth() == 0.0 && s.vegetation == 0.25));
    assert_eq!(w.natural_height(DVec2::new(1e7, -3.0)), 20.0);
    let links = w.roads().links(Bounds::square(DVec2::ZERO, 12_000.0), &Cancel::new()).unwrap();
    assert!(!links.is_empty() && links.iter().all(|l| l.bridges + l.tunnels == 0), "no water, no hills: {links:?}");
}

#[test]
fn a_world_stands_on_rasters_with_water_and_woods() {
    // 30 km of ground, a lake of cells of another size in its west, woods in its south.
    let raster = |cells: usize, of: &dyn Fn(f64, f64) -> f64| {
        let (step, corner) = (30_000.0 / cells as f64, DVec2::splat(-15_000.0));
        let at = |i: usize| corner + DVec2::new((i % cells) as f64 + 0.5, (i / cells) as f64 + 0.5) * step;
        let values = (0..cells * cells).map(|i| of(at(i).x, at(i).y) as f32).collect();
        Raster::new(cells, cells, corner, DVec2::splat(step), values).unwrap()
    };
    let heights = raster(150, &|x, y| 60.0 + x * 2e-3 + y * 1e-3);
    let lake = |x: f64, y: f64| if x < -6_000.0 && y.abs() < 12_000.0 { 8.0 } else { 0.0 };
    let terrain = RasterTerrain::new(heights).and_then(|t| t.with_water_depth(raster(60, &lake)));
    let terrain = terrain.and_then(|t| t.with_vegetation(raster(20, &|_, y| if y < 0.0 { 0.9 } else { 0.0 }))).unwrap();
    let w = World::new(WorldSource { terrain: TerrainSource::own(terrain), ..WorldSource::new(Seed(8)) }).unwrap();
    let land = |x: f64, y: f64| w.terrain().sample(DVec2::new(x, y));
    assert!(land(-9_000.0, 0.0).depth() > 7.9 && land(9_000.0, 0.0).depth() == 0.0);
    assert!(land(5_000.0, -9_000.0).vegetation > 0.8 && land(5_000.0, 9_000.0).vegetation == 0.0);
    let found = w.settlements().centred_in(Bounds::square(DVec2::ZERO, 24_000.0)).unwrap();
    assert!(found.iter().any(|s| s.centre.plan().x > 0.0));
    assert!(found.iter().all(|s| lake(s.centre.plan().x, s.centre.plan().y) == 0.0));
    let chunk = w.chunk(built_up(&w, DVec2::new(5_000.0, 0.0)), &Cancel::new()).unwrap();
    assert!(!chunk.streets.is_empty());
}

#[test]
fn neighbouring_chunks_join_and_own_everything_once() {
    let w = world(11, &Settings::default());
    let size = w.settings().chunk_size as f64;
    let middle = built_up(&w, DVec2::ZERO);
    let bounds = middle.bounds(w.settings().chunk_size).grown(size);
    let area = w.area(bounds, &Cancel::new()).unwrap();
    let (mut streets, mut footprints) = (0, 0);
    for coord in block(middle) {
        let chunk = w.chunk(coord, &Cancel::new()).unwrap();
        for placed in &chunk.streets {
            let owned =
                area.streets.iter().find(|s| s.item.street.id == placed.street.id).expect("areas hold all streets");
            assert_eq!(owned.chunk, coord);
        }
        streets += chunk.streets.len();
        footprints += chunk.footprints.len();
    }
    let ours = |c: ChunkCoord| (c.0 - middle.0).abs().max_element() <= 1;
    assert_eq!(streets, area.streets.iter().filter(|s| ours(s.chunk)).count());
    assert_eq!(footprints, area.footprints.iter().filter(|f| ours(f.chunk)).count());
}

#[test]
fn every_piece_of_a_street_is_drawn_by_the_chunk_in_which_it_lies() {
    let (w, never) = (world(7, &Settings::default()), Cancel::new());
    let size = w.settings().chunk_size;
    // A village, and a country road that is longer than three chunks.
    let (low, count) = (ChunkCoord::new(-2, -10), 8);
    let mut drawn: BTreeMap<(StreetId, usize), usize> = BTreeMap::new();
    for (x, y) in (0..count).flat_map(|y| (0..count).map(move |x| (x, y))) {
        let chunk = w.chunk(ChunkCoord::new(low.0.x + x, low.0.y + y), &never).unwrap();
        for street in chunk.streets_here() {
            for piece in chunk.own_pieces(&Pieces::new(street)) {
                *drawn.entry((street.id, piece)).or_default() += 1;
            }
        }
    }
    let square = Bounds::new(low.bounds(size).min, low.bounds(size).min + (size * i64::from(count)) as f64);
    let area = w.area(square, &never).unwrap();
    let (mut pieces, mut longest) = (0, 0);
    for street in area.streets.iter().map(|s| &s.item.street) {
        let cut = Pieces::new(street);
        longest = longest.max(cut.count());
        for (piece, middle) in cut.middles().enumerate() {
            if square.contains(area.origin.to_plan(middle)) {
                assert_eq!(drawn.remove(&(street.id, piece)), Some(1), "piece {piece} of {:?}", street.id);
                pieces += 1;
            }
        }
    }
    assert!(drawn.is_empty() && pieces > 100 && longest > 12, "{pieces} pieces, {longest} in one street, {drawn:?}");
}

#[test]
fn cities_of_new_seeds_keep_every_promise() {
    for seed in [901, 902, 903] {
        let w = world(seed, &Settings::default());
        let cities = w.settlements().centred_in_of(Bounds::square(DVec2::ZERO, 80_000.0), SizeClass::City).unwrap();
        let city = cities.first().expect("a city within 40 km");
        let area = w.area(Bounds::square(city.centre.plan(), 4000.0), &Cancel::new()).unwrap();
        let found = audit(&area);
        assert!(found.is_empty(), "seed {seed}: {} findings, first {}", found.len(), found[0]);
        let outline = w.settlements().outline(city).unwrap();
        assert_eq!(unreached_gates(&area, outline.origin, &outline.polygon), [], "seed {seed}");
        assert!(area.streets.len() > 300 && area.footprints.len() > 500, "seed {seed} has no city");
    }
}

#[test]
fn streets_do_not_tell_where_chunk_borders_are() {
    let w = world(31, &Settings::default());
    let mut counts = ChunkBorderCounts::new(w.settings().chunk_size as f64, 40.0);
    let cities = w.settlements().centred_in_of(Bounds::square(DVec2::ZERO, 90_000.0), SizeClass::City).unwrap();
    for city in cities.iter().take(4) {
        let outline = w.settlements().outline(city).unwrap();
        counts.add_area(outline.bounds(), 20.0, |p| outline.contains(p));
        let area = w.area(outline.bounds(), &Cancel::new()).unwrap();
        let inside = |p: DVec2| outline.contains(area.origin.to_plan(p));
        for junction in area.junctions.iter().filter(|j| inside(j.item.at)) {
            counts.add_junction(area.origin.to_plan(junction.item.at));
        }
        for street in area.streets.iter().map(|s| &s.item.street).filter(|s| inside(s.line[0])) {
            counts.add_street(&street.line.iter().map(|p| area.origin.to_plan(*p)).collect::<Vec<_>>());
        }
    }
    let report = counts.report();
    assert!(report.area_km2[0] > 3.0, "{report:?}");
    // The spread of some thousand junctions; `sprawl seams` looks at 200 km2 and asks for 3 %.
    assert!(report.greatest_difference() < 0.1 && report.highest_peak() < 3.0, "{report:?}");
}

#[test]
fn towns_that_touch_hold_the_same_border() {
    let (mut borders, mut streets, mut crossings) = (0, 0, 0);
    for seed in [31, 33] {
        let w = world(seed, &conurbation());
        let at = DVec2::new(seed as f64 * 1e5, 0.0);
        for a in w.settlements().centred_in(Bounds::square(at, 2_400.0)).unwrap() {
            for b in w.settlements().touching(&a).unwrap() {
                let border = w.settlements().border(&a, &b).unwrap().expect("they touch");
                let sides = [&a, &b].map(|s| {
                    let town = w.town(s, &Cancel::new()).unwrap();
                    let shift = town.town.origin.offset_to(border.origin);
                    for gate in (0..border.gates.len()).map(|i| border.junction(i)) {
                        let inner = || town.town.mains.iter().filter(|m| m.border.is_none());
                        assert!(inner().any(|m| [m.street.from, m.street.to].contains(&gate)), "{}: a gate", s.name);
                    }
                    let mut mains = Vec::new();
                    for (main, seam) in town.town.mains.iter().zip(&town.seams) {
                        if main.border.as_ref() == Some(&border) {
                            assert_eq!(main.left == MainStreet::OUTSIDE, !border.is_left(s.id));
                            assert_eq!(main.right == MainStreet::OUTSIDE, border.is_left(s.id));
                            let mut seam = seam.clone();
                            seam.ports.iter_mut().for_each(|p| p.at += shift);
                            mains.push((main.street.moved(shift), seam));
                        }
                    }
                    mains.sort_by_key(|(s, _)| s.id);
                    let shared = town.mains.streets.iter().filter(|s| town.shared.get(&s.id) == Some(&border.origin));
                    let mut pieces: Vec<_> = shared.map(|s| s.moved(shift)).collect();
                    pieces.sort_by_key(|s| s.id);
                    (mains, pieces)
                });
                assert_eq!(sides[0], sides[1], "seed {seed}: {} and {}", a.name, b.name);
                assert_eq!(sides[0].0.len(), border.gates.len() - 1);
                borders += 1;
                streets += sides[0].0.len();
                let ports = sides[0].0.iter().flat_map(|(_, seam)| &seam.ports);
                crossings += ports.filter(|p| p.left.is_some() && p.right.is_some()).count();
            }
        }
        let area = w.area(Bounds::square(at, 2_400.0), &Cancel::new()).unwrap();
        let found = audit(&area);
        assert!(found.is_empty(), "seed {seed}: {} findings, first {}", found.len(), found[0]);
        for outline in area.outlines.iter().filter(|o| area.bounds.encloses(o.bounds())) {
            assert_eq!(unreached_gates(&area, outline.origin, &outline.polygon), [], "seed {seed}");
        }
    }
    assert!(
        borders > 8 && streets > 12 && crossings > 8,
        "{borders} borders, {streets} streets, {crossings} crossings"
    );
}

#[test]
fn a_conurbation_is_the_same_in_any_order() {
    for seed in [41, 42] {
        let (forward, backward) = (world(seed, &conurbation()), world(seed, &conurbation()));
        let coords = block(built_up(&forward, DVec2::new(-4e6, 9e5)));
        let get = |w: &World, c: &ChunkCoord| print(&w.chunk(*c, &Cancel::new()).expect("not cancelled"));
        let expected: Vec<u64> = coords.iter().map(|c| get(&forward, c)).collect();
        let mut reversed: Vec<u64> = coords.iter().rev().map(|c| get(&backward, c)).collect();
        reversed.reverse();
        assert_eq!(expected, reversed, "seed {seed}");
    }
}

#[test]
fn a_route_leads_along_streets_across_a_city() {
    let w = world(901, &Settings::default());
    let city =
        w.settlements().centred_in_of(Bounds::square(DVec2::ZERO, 80_000.0), SizeClass::City).unwrap()[0].clone();
    let (from, to) = (city.centre.plan() - 500.0, city.centre.plan() + 500.0);
    let route = w.route(from, to, 1000.0, &Cancel::new()).unwrap().expect("a city's streets are one component");
    assert!(route.length >= route.points[0].distance(route.points[route.points.len() - 1]));
    assert!(route.length < 4000.0 && route.streets.len() > 3, "{route:?}");
    let longest = route.points.windows(2).map(|p| p[0].distance(p[1])).fold(0.0, f64::max);
    assert!(longest < 600.0, "a jump of {longest} m");
}

#[test]
fn a_route_is_the_shortest_whichever_way_it_is_walked() {
    let w = world(902, &Settings::default());
    let town = &w.settlements().centred_in(Bounds::square(DVec2::ZERO, 30_000.0)).expect("not cancelled")[0];
    let length = |from: DVec2, to: DVec2| {
        let route = w.route(from, to, 600.0, &Cancel::new()).expect("not cancelled").expect("one component");
        let jumps = route.points.windows(2).map(|p| p[0].distance(p[1])).sum::<f64>();
        assert!((jumps - route.length).abs() < 1e-6);
        route.length
    };
    let radius = town.radius * 0.8;
    for k in 0..40u64 {
        let mut stream = Seed(k).stream("route", &[]);
        let mut place = || town.centre.plan() + DVec2::new(stream.signed(), stream.signed()) * radius;
        let (a, b, c) = (place(), place(), place());
        let (there, back) = (length(a, b), length(b, a));
        assert!((there - back).abs() < 0.1, "{there} m there, {back} m back");
        assert!(there <= length(a, c) + length(c, b) + 0.1, "a detour is shorter than {there} m");
    }
}

#[test]
fn a_cancelled_chunk_is_an_error_and_nothing_is_kept() {
    let w = world(5, &Settings::default());
    let coord = built_up(&w, DVec2::ZERO);
    let cancelled = Cancel::new();
    cancelled.cancel();
    assert!(w.chunk(coord, &cancelled).is_err());
    assert!(w.chunk(coord, &Cancel::new()).is_ok());
}

#[test]
fn the_audit_sees_what_is_wrong() {
    let w = world(901, &Settings::default());
    let city =
        w.settlements().centred_in_of(Bounds::square(DVec2::ZERO, 80_000.0), SizeClass::City).unwrap()[0].clone();
    let whole = w.area(Bounds::square(city.centre.plan(), 4000.0), &Cancel::new()).unwrap();
    let mut broken = whole.clone();
    broken.streets[7].item.street.line[0].x += 40.0;
    let faults: Vec<Fault> = audit(&broken).iter().map(|f| f.what).collect();
    assert!(faults.contains(&Fault::LooseEnd), "{faults:?}");
    let mut cut = whole.clone();
    cut.streets.retain(|s| s.item.street.class.is_road() || s.item.street.id.0 % 3 != 0);
    assert!(audit(&cut).iter().any(|f| f.what == Fault::Disconnected));
    let mut moved = whole;
    for f in &mut moved.footprints {
        f.item.polygon.iter_mut().for_each(|p| *p += DVec2::splat(15.0));
    }
    assert!(audit(&moved).iter().any(|f| f.what == Fault::BuildingOnStreet));
}

#[test]
fn one_stands_on_bridges_and_under_them() {
    let world = world(31, &Settings::default());
    let mut stood = 0;
    for road in
        world.roads().overlapping(Bounds::square(DVec2::new(9_000.0, -4_000.0), 16_000.0), &Cancel::new()).unwrap()
    {
        if !road.street.bridge || road.street.length() < 60.0 {
            continue;
        }
        let middle = road.origin.to_plan(point_at(&road.street.line, road.street.length() / 2.0).0);
        let coord = ChunkCoord::containing(middle, world.settings().chunk_size);
        let chunk = world.chunk(coord, &Cancel::new()).unwrap();
        let local = chunk.origin.to_local(middle);
        let (deck, bed) = (chunk.surface(local, f64::INFINITY).unwrap(), chunk.surface_at(local).unwrap().height);
        assert!(deck > bed && deck > world.terrain().sample(middle).water_level, "{middle}: {deck} {bed}");
        assert_eq!(chunk.surface(local, bed), Some(bed));
        assert_eq!(bed, world.height_at(middle, &Cancel::new()).unwrap());
        stood += 1;
    }
    assert!(stood > 3, "{stood}");
}

#[test]
fn buildings_know_their_heights_and_chunks_only_their_own_ground() {
    let world = world(19, &Settings::default());
    let chunk = world.chunk(built_up(&world, DVec2::ZERO), &Cancel::new()).unwrap();
    let edge = chunk.size as f64;
    for outside in [DVec2::new(-0.01, 5.0), DVec2::new(5.0, edge + 0.01), DVec2::new(f64::NAN, 5.0)] {
        assert_eq!((chunk.ground.height(outside), chunk.surface(outside, 1e9)), (None, None), "{outside}");
    }
    for inside in [DVec2::ZERO, DVec2::splat(edge), DVec2::new(3.7, edge), DVec2::new(200.25, 17.5)] {
        let height = world.natural_height(chunk.origin.to_plan(inside));
        assert!((chunk.ground.height(inside).unwrap() - height).abs() < 1e-9, "{inside}");
    }
    let mut stepped = 0;
    for building in &chunk.footprints {
        let ground = |p: &DVec2| world.height_at(chunk.origin.to_plan(*p), &Cancel::new()).unwrap();
        let grounds = building.polygon.iter().map(ground);
        let (low, high) = grounds.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), g| (l.min(g), h.max(g)));
        // Triangles of the ground are as wide as 8 m, so that corners between them lie a little off.
        let near = 0.4;
        assert!(building.base > low - near && building.base < high + near && building.base <= low + 2.0 + near);
        assert!((building.base - high).abs() < near || high > low + 2.0 - near);
        let walls = f64::from(building.storeys) * STOREY_HEIGHT;
        assert!((walls..walls + 1.0).contains(&building.height));
        stepped += usize::from(high > low + 0.1);
    }
    assert!(chunk.footprints.len() > 20 && stepped > 0);
}

#[test]
fn streets_and_junctions_are_found_by_their_ids() {
    let world = world(23, &Settings::default());
    let chunk = world.chunk(built_up(&world, DVec2::ZERO), &Cancel::new()).unwrap();
    let bounds = chunk.coord.bounds(chunk.size);
    for placed in chunk.streets.iter().step_by(7) {
        let found = world.street(placed.street.id, bounds, &Cancel::new()).unwrap();
        // A street belongs to the chunk that holds its middle, so part of it overlaps the chunk.
        let found = found.expect("a street of the chunk");
        assert_eq!(found.item.moved(found.origin.offset_to(chunk.origin)), *placed);
    }
    for junction in chunk.junctions.iter().step_by(7) {
        let found = world.junction(junction.id, bounds, &Cancel::new()).unwrap().expect("a junction of the chunk");
        assert_eq!(found.item.at + found.origin.offset_to(chunk.origin), junction.at);
    }
    let far = Bounds::square(DVec2::splat(90_000.0), 100.0);
    assert!(world.street(chunk.streets[0].street.id, far, &Cancel::new()).unwrap().is_none());
}
