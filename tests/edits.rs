//! Edits in the world: they reach no further than stated, and what cannot be says why.

use bevy_sprawl::edits::Edits;
use bevy_sprawl::edits::{Influence, RoadEdit, SettlementEdit, Shape, WayPoint};
use bevy_sprawl::layer::{Cancel, FileError};
use bevy_sprawl::network::SizeClass;
use bevy_sprawl::network::StreetClass;
use bevy_sprawl::region::Settlement;
use bevy_sprawl::space::{Bounds, ChunkCoord, Seed, Stream};
use bevy_sprawl::world::{World, WorldAssets, WorldSource, changed_by_edits};
use glam::DVec2;
use std::collections::BTreeSet;
use std::sync::{Arc, LazyLock};

static ASSETS: LazyLock<WorldAssets> = LazyLock::new(WorldAssets::bundled);

fn world(seed: u64, edits: Edits) -> World {
    World::new(WorldSource { edits, assets: ASSETS.clone(), ..WorldSource::new(Seed(seed)) })
        .expect("bundled assets suit")
}

fn draw(seed: u64) -> Stream {
    Seed(seed).stream("edits", &[])
}

fn near(stream: &mut Stream, middle: DVec2, far: f64) -> DVec2 {
    (middle + DVec2::new(stream.signed(), stream.signed()) * far).round()
}

fn settlements(world: &World, bounds: Bounds) -> Vec<Arc<Settlement>> {
    world.settlements().centred_in(bounds).expect("settlements are found")
}

/// Everything that two worlds show in a box is the same.
fn assert_same(a: &World, b: &World, bounds: Bounds) {
    let cancel = Cancel::new();
    assert_eq!(a.roads().overlapping(bounds, &cancel), b.roads().overlapping(bounds, &cancel), "roads in {bounds:?}");
    assert_eq!(a.settlements().overlapping(bounds), b.settlements().overlapping(bounds));
    for s in a.settlements().overlapping(bounds).expect("settlements are found") {
        assert_eq!(a.settlements().outline(&s), b.settlements().outline(&s));
        assert_eq!(a.roads().gates(&s, &cancel), b.roads().gates(&s, &cancel));
    }
}

/// One edit of each kind around a place, in turn.
fn drawn(world: &World, stream: &mut Stream, middle: DVec2, kind: usize) -> Edits {
    let class = [StreetClass::Highway, StreetClass::Major, StreetClass::Minor][stream.index(3)];
    let at = near(stream, middle, 1_500.0);
    let mut edits = Edits::default();
    match kind {
        0 => {
            let corners = [(-1.0, -1.0), (1.0, -0.5), (0.6, 1.0)];
            let shape = match stream.index(3) {
                0 => Shape::Point(at),
                1 => Shape::Curve(vec![at, near(stream, at, 2_000.0)]),
                _ => Shape::Area(corners.map(|(x, y)| at + DVec2::new(x, y) * 900.0).to_vec()),
            };
            let strength = if stream.chance(0.5) { -3.0 } else { 15.0 };
            let classes = if stream.chance(0.5) { vec![] } else { vec![class] };
            edits.influences.push(Influence { shape, radius: stream.range(200.0, 2_000.0), strength, classes });
        }
        1 => edits.way_points.push(WayPoint { at, class }),
        2 => {
            let size = SizeClass::ALL[stream.index(3)];
            edits.settlements.push(SettlementEdit::Pin { at, size, name: None, style: None, radius: None });
        }
        3 => edits.settlements.push(SettlementEdit::Ban { at, radius: 2_500.0 }),
        _ => {
            let links = world.roads().links(Bounds::square(middle, 8_000.0), &Cancel::new()).expect("links are found");
            let all = settlements(world, Bounds::square(middle, 60_000.0));
            let of = |id| all.iter().find(|s| s.id == id).map(|s| s.centre.plan());
            let ends = links.iter().find_map(|l| Some((of(l.from)?, of(l.to)?)));
            edits.roads.extend(ends.map(|(from, to)| RoadEdit::Ban { from, to }));
        }
    }
    assert_eq!(edits.check(), Ok(()));
    edits
}

#[test]
fn nothing_changes_beyond_the_stated_reach() {
    for seed in 0..5 {
        let mut stream = draw(seed);
        let middle = near(&mut stream, DVec2::ZERO, 3e6);
        let plain = world(seed, Edits::default());
        let edits = drawn(&plain, &mut stream, middle, seed as usize);
        let reach = changed_by_edits(plain.settings(), &Edits::default(), &edits);
        let [reach] = reach.as_slice() else { panic!("one edit has one reach: {reach:?}") };
        assert!(reach.contains(middle) && reach.size().max_element() < 500_000.0, "{reach:?}");
        let edited = world(seed, edits);
        let beyond = [DVec2::new(reach.max.x + 751.0, middle.y), DVec2::new(middle.x, reach.min.y - 751.0)];
        assert_same(&plain, &edited, Bounds::square(beyond[seed as usize % 2], 1_500.0));
    }
}

#[test]
fn influences_change_nothing_beyond_what_their_classes_reach() {
    let cancel = Cancel::new();
    let mut changed = 0;
    for seed in 20..22 {
        let mut stream = draw(seed);
        let middle = near(&mut stream, DVec2::ZERO, 1e6);
        let plain = world(seed, Edits::default());
        let mut edits = drawn(&plain, &mut stream, middle, 0);
        edits.influences[0].classes = vec![StreetClass::Minor];
        let radius = edits.influences[0].radius;
        let edited = world(seed, edits);
        // Pairs whose ellipse meets it, the pairs weighed against these, and what is merged and shaped there.
        let t = &plain.settings().roads.minor;
        let pair = 1.03 * t.detour * t.reach + 2_000.0;
        let far = 1_500.0 + 2_000.0 + radius + 2.0 * pair + 5_000.0;
        let way = if seed % 2 == 0 { DVec2::X } else { DVec2::NEG_Y };
        assert_same(&plain, &edited, Bounds::square(middle + way * (far + 750.0), 1_500.0));
        let here = Bounds::square(middle, 4_000.0);
        changed += usize::from(plain.roads().overlapping(here, &cancel) != edited.roads().overlapping(here, &cancel));
    }
    assert!(changed >= 1, "{changed}");
}

/// Chunks around a place, column by column.
fn chunks(middle: DVec2, ring: i32) -> Vec<ChunkCoord> {
    let at = ChunkCoord::containing(middle, 512).0;
    (-ring..=ring).flat_map(|x| (-ring..=ring).map(move |y| ChunkCoord::new(at.x + x, at.y + y))).collect()
}

#[test]
fn chunks_that_are_not_named_as_changed_are_equal() {
    let cancel = Cancel::new();
    let (mut named, mut differ) = (0, 0);
    for seed in 40..43 {
        let mut stream = draw(seed);
        let plain = world(seed, Edits::default());
        let all = settlements(&plain, Bounds::square(near(&mut stream, DVec2::ZERO, 1e5), 20_000.0));
        let Some(s) = all.iter().find(|s| s.size < SizeClass::City) else { continue };
        let middle = s.centre.plan() + s.radius * 0.5;
        let before = world(seed, drawn(&plain, &mut stream, middle, (seed % 5) as usize));
        let mut edits = before.edits().clone();
        let more = drawn(&plain, &mut stream, middle, ((seed + 2) % 5) as usize);
        edits.settlements.extend(more.settlements);
        edits.influences.extend(more.influences);
        edits.way_points.extend(more.way_points);
        edits.roads.extend(more.roads);
        let after = world(seed, edits);
        let coords = chunks(middle, 2);
        let changed = after.changed_chunks(&before, coords.iter().copied(), &cancel).expect("they are compared");
        let differing: BTreeSet<ChunkCoord> = coords
            .into_iter()
            .filter(|c| {
                let [a, b] = [&before, &after].map(|w| w.chunk(*c, &cancel).expect("it can be made"));
                format!("{a:?}") != format!("{b:?}")
            })
            .collect();
        assert!(differing.is_subset(&changed), "seed {seed}: {differing:?} {changed:?}");
        named += changed.len();
        differ += differing.len();
        // The other way round it is the same.
        assert_eq!(before.changed_chunks(&after, chunks(middle, 2), &cancel), Ok(changed));
    }
    assert!(differ > 0 && named < 2 * differ + 40, "{named} {differ}");
}

/// What is said of the edits in a text, each with its line.
fn said(seed: u64, text: &str) -> Vec<FileError> {
    let edits = Edits::from_ron("e.ron", text).expect("it is right by itself");
    let rejected = world(seed, edits).rejected_edits(&Cancel::new()).expect("roads are made");
    rejected.iter().map(|e| e.in_file("e.ron", text)).collect()
}

#[test]
fn edits_that_cannot_be_say_where_they_are_written_and_why() {
    let plain = world(5, Edits::default());
    let water = |p: &DVec2| plain.terrain().sample(*p).depth() > 3.0;
    let sea = (0..).map(|i| DVec2::new(f64::from(i) * 400.0, 77.0)).find(water).expect("there is water");
    let all = settlements(&plain, Bounds::square(DVec2::ZERO, 20_000.0));
    let town = all[0].centre.plan();
    let land = (1..).map(|i| town + DVec2::new(f64::from(i) * 500.0, 0.0)).find(|p| {
        let fits = |e: WayPoint| {
            let edits = Edits { way_points: vec![e], ..Edits::default() };
            world(5, edits).rejected_edits(&Cancel::new()) == Ok(vec![])
        };
        fits(WayPoint { at: *p, class: StreetClass::Minor })
    });
    let land = land.expect("there is open land");
    let at = |p: DVec2| format!("({:?}, {:?})", p.x, p.y);
    let text = format!(
        "(\n way_points: [\n  (at: {}, class: Minor),\n  (at: {}, class: Major),\n  (at: {}, class: Minor),\n  (at: {}, class: \
         Highway),\n ],\n settlements: [\n  Pin(at: {}, size: Town),\n ],\n roads: [\n  Via(from: {}, to: (9e9, 0), points: \
         [(1, 1)]),\n  Ban(from: {}, to: {}),\n ],\n)",
        at(sea),
        at(town),
        at(land),
        at(land + 300.0),
        at(sea),
        at(town),
        at(town),
        at(town + 1.0)
    );
    let found = said(5, &text);
    let expected = [
        (9, 3, "settlements[0]: "),
        (3, 3, "way_points[0]: "),
        (4, 3, "way_points[1]: "),
        (6, 3, "way_points[3]: "),
        (12, 3, "roads[0]: no settlement is at 9000000000,0"),
        (13, 3, "roads[1]: both ends lie in "),
    ];
    let places: Vec<(usize, usize)> = found.iter().map(|e| (e.line, e.column)).collect();
    assert_eq!(places, expected.map(|e| (e.0, e.1)), "{found:?}");
    assert!(found.iter().zip(expected).all(|(f, e)| f.reason.starts_with(e.2)), "{found:?}");
    let reasons = ["lies in water", "lies in water", "m from the outline of", "m from way_points[2]"];
    assert!(found.iter().zip(reasons).all(|(f, r)| f.reason.contains(r)), "{found:?}");
}

#[test]
fn files_that_are_wrong_by_themselves_are_refused_at_their_line() {
    let cases = [
        ("(way_points: [\n (at: (NaN, 0), class: Minor)])", "e.ron:2:2: way_points[0]: at.x is NaN"),
        (
            "(way_points: [\n (at: (0, 2e10), class: Minor)])",
            "e.ron:2:2: way_points[0]: at.y is 20000000000; allowed is -1",
        ),
        (
            "(way_points: [\n (at: (0, 0), class: Local)])",
            "e.ron:2:2: way_points[0]: class is Local; allowed are Highway",
        ),
        ("(way_points: [\n (at: (0, 0))])", "e.ron:2:"),
        (
            "(influences: [\n (shape: Point((0, -inf)), radius: 99, strength: 1)])",
            "e.ron:2:2: influences[0]: shape.y is -inf",
        ),
        ("(influences: [(shape: Point((0, 0)), radius: 99, strength: NaN)])", "influences[0]: strength is NaN"),
        (
            "(influences: [(shape: Area([(0, 0), (9, 9), (9, 0), (0, 9)]), radius: 99, strength: 1)])",
            "crosses itself at 4.5,4.5",
        ),
        ("(roads: [Keep(from: (0, 0), to: (1, inf))])", "roads[0]: to.y is inf"),
        ("(settlements: [Move(from: (0, 0), to: (-1e11, 0))])", "settlements[0]: to.x is -100000000000"),
    ];
    for (text, expected) in cases {
        let error = Edits::from_ron("e.ron", text).expect_err(text).to_string();
        assert!(error.contains(expected), "{text}: {error}");
    }
}

#[test]
fn a_world_far_out_has_way_points_too() {
    let middle = DVec2::new(4e9, -7e9);
    let edits = Edits {
        way_points: (0..4).map(|i| WayPoint { at: middle + f64::from(i) * 700.0, class: StreetClass::Minor }).collect(),
        ..Edits::default()
    };
    let far = world(3, edits);
    let cancel = Cancel::new();
    for point in far.roads().way_points() {
        let area = far.area(Bounds::square(point.centre.plan(), 100.0), &cancel).expect("it can be made");
        let junction = far.roads().way_point_junction(point.id);
        let at = area.junctions.iter().find(|j| j.item.id == junction).map(|j| area.origin.to_plan(j.item.at));
        assert!(at.is_none_or(|at| at == point.centre.plan()));
    }
}
