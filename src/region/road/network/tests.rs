//! Networks of finite domains against what is known of proximity graphs.

use super::*;
use crate::edits::{EditList, Edits, Influence, InfluenceMap, RoadEdit, SettlementEdit, Shape, WayPoint};
use crate::layer::LayerError;
use crate::network::{JunctionId, SizeClass, StreetClass};
use crate::region::{RoadSettings, Settlement, SettlementId};
use crate::space::{
    Bounds, DisjointSets, Origin, Seed, distance_to_line, math, point_in_polygon, segment_crossing, segments,
};
use crate::terrain::{Raster, Terrain, TerrainSample};
use crate::testing::Ground;
use glam::DVec2;
use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A plain, or hills, with a count of the samples outside a box.
struct WatchedHills {
    hills: f64,
    read: Bounds,
    outside: AtomicUsize,
}

impl Terrain for WatchedHills {
    fn sample(&self, p: DVec2) -> TerrainSample {
        if !self.read.contains(p) {
            self.outside.fetch_add(1, Ordering::Relaxed);
        }
        let wave = |x: f64, y: f64, length: f64| math::sin((p.x * x + p.y * y) * TAU / length);
        let height = wave(0.8, 0.6, 9_300.0) + wave(-0.4, 0.9, 6_100.0) + 0.5 * wave(0.9, -0.5, 3_700.0);
        // Only the highest hills have the sea in between.
        let water_level = if self.hills > 1e3 { 0.0 } else { -1e4 };
        TerrainSample { height: 500.0 + self.hills * height, water_level, vegetation: 0.0 }
    }
}

fn ground(hills: f64, domain: Bounds) -> Arc<WatchedHills> {
    Arc::new(WatchedHills { hills, read: domain, outside: AtomicUsize::new(0) })
}

fn settlement(i: usize, at: DVec2, size: SizeClass, radius: f64) -> Settlement {
    let name = format!("{size:?} {i}");
    Settlement { id: SettlementId(i as u64 + 1), centre: Origin::at(at), radius, size, style: String::new(), name }
}

/// Villages at random in a box, at least `apart` from each other.
fn villages(seed: u64, count: usize, domain: Bounds, apart: f64) -> Vec<Settlement> {
    let mut random = Seed(seed).stream("test", &[]);
    let mut out: Vec<Settlement> = Vec::new();
    while out.len() < count {
        let at = domain.min + domain.size() * DVec2::new(random.unit(), random.unit());
        if out.iter().all(|o| o.centre.plan().distance(at) >= apart + 2.0) {
            out.push(settlement(out.len(), at, SizeClass::Village, 200.0));
        }
    }
    out
}

fn settings(step: i64, gamma: f64) -> RoadSettings {
    let mut s = RoadSettings::finite(step);
    for t in [&mut s.highway, &mut s.major, &mut s.minor] {
        t.gamma = gamma;
        // The rule, and nothing else.
        (t.settlement, t.vegetation) = (0.0, 0.0);
    }
    s
}

fn pairs(network: &RoadNetwork) -> Vec<(usize, usize)> {
    let mut out: Vec<_> = network.links.iter().map(|l| (l.from.0 as usize - 1, l.to.0 as usize - 1)).collect();
    out.sort_unstable();
    out
}

/// How far the costs of two ways of one length may differ on the lattice: what ways pay for leaving their beeline by up to a
/// few steps.
const ERROR: f64 = 0.006;

/// By how much the proximity rule keeps a pair (positive) or not: the least, over third settlements, of the power mean of
/// both distances over the pair's, less 1.
fn margin(all: &[Settlement], i: usize, j: usize, gamma: f64) -> f64 {
    let d = |a: usize, b: usize| all[a].centre.offset_to(all[b].centre).length();
    let of = |c: usize| {
        let (p, q) = (d(i, c) / d(i, j), d(j, c) / d(i, j));
        if gamma.is_infinite() { p.max(q) } else { math::pow(math::pow(p, gamma) + math::pow(q, gamma), 1.0 / gamma) }
    };
    (0..all.len()).filter(|c| *c != i && *c != j).map(of).fold(f64::INFINITY, f64::min) - 1.0
}

#[test]
fn gamma_two_is_the_gabriel_graph_of_delaunays_edges() {
    use spade::{DelaunayTriangulation, Point2, Triangulation};
    let domain = Bounds::new(DVec2::new(-7_000.0, 3_000.0), DVec2::new(23_000.0, 33_000.0));
    let mut decided = 0;
    for seed in 0..6 {
        let all = villages(seed, 24, domain, 750.0);
        let mut mesh: DelaunayTriangulation<Point2<f64>> = DelaunayTriangulation::new();
        let mut order = Vec::new();
        for s in &all {
            let at = s.centre.plan();
            order.push(mesh.insert(Point2::new(at.x, at.y)).unwrap().index());
        }
        let named = |vertex: usize| order.iter().position(|v| *v == vertex).unwrap();
        let edges: Vec<(usize, usize)> = mesh
            .undirected_edges()
            .map(|e| e.vertices().map(|v| named(v.index())))
            .map(|[a, b]| (a.min(b), a.max(b)))
            .collect();
        let network =
            RoadNetwork::build(domain, ground(0.0, domain), &all, &settings(500, 2.0), &Edits::default()).unwrap();
        let kept = pairs(&network);
        for i in 0..all.len() {
            for j in i + 1..all.len() {
                // A Gabriel edge is one of Delaunay's whose smallest circle holds no settlement.
                let disc = |c: &Settlement| {
                    let (a, b, c) = (all[i].centre.plan(), all[j].centre.plan(), c.centre.plan());
                    (a - c).dot(b - c) < 0.0
                };
                let empty = !all.iter().enumerate().any(|(k, c)| k != i && k != j && disc(c));
                let gabriel = edges.contains(&(i, j)) && empty;
                if margin(&all, i, j, 2.0).abs() > ERROR {
                    decided += 1;
                    assert_eq!(kept.contains(&(i, j)), gabriel, "seed {seed}: {i} {j} {}", margin(&all, i, j, 2.0));
                }
            }
        }
    }
    assert!(decided > 6 * 270, "{decided}");
}

#[test]
fn gamma_without_end_is_the_relative_neighbour_graph() {
    let domain = Bounds::new(DVec2::ZERO, DVec2::new(30_000.0, 24_000.0));
    for seed in 10..16 {
        let all = villages(seed, 24, domain, 750.0);
        for gamma in [f64::INFINITY, 60.0] {
            let network =
                RoadNetwork::build(domain, ground(0.0, domain), &all, &settings(500, gamma), &Edits::default())
                    .unwrap();
            let kept = pairs(&network);
            // At 60 the rule still differs from the lune's where both distances are nearly the pair's.
            let error = ERROR + if gamma.is_infinite() { 0.0 } else { 0.012 };
            for i in 0..all.len() {
                for j in i + 1..all.len() {
                    let margin = margin(&all, i, j, f64::INFINITY);
                    if margin.abs() > error {
                        assert_eq!(kept.contains(&(i, j)), margin > 0.0, "seed {seed}: {i} {j} {margin}");
                    }
                }
            }
            assert!(network.unreached.is_empty());
        }
    }
}

#[test]
fn roads_grow_fewer_and_shorter_with_gamma() {
    let domain = Bounds::new(DVec2::ZERO, DVec2::splat(40_000.0));
    let mut all = villages(3, 28, domain, 1_500.0);
    for (i, s) in all.iter_mut().enumerate() {
        s.size = if i < 3 {
            SizeClass::City
        } else if i < 10 {
            SizeClass::Town
        } else {
            SizeClass::Village
        };
    }
    let figures = [1.2, 2.0, 8.0, f64::INFINITY].map(|gamma| {
        let network =
            RoadNetwork::build(domain, ground(90.0, domain), &all, &settings(500, gamma), &Edits::default()).unwrap();
        assert!(network.unreached.is_empty());
        (network.links.len(), network.length())
    });
    assert!(figures.windows(2).all(|w| w[0].0 >= w[1].0 && w[0].1 >= w[1].1), "{figures:?}");
    assert!(figures[0].0 > 2 * figures[3].0 && figures[0].1 > 1.5 * figures[3].1, "{figures:?}");
}

/// Cities, towns and villages of all sizes at random, some of them as near to each other as is allowed.
fn mixed(seed: u64, count: usize, domain: Bounds, step: f64) -> Vec<Settlement> {
    let mut random = Seed(seed).stream("test", &[]);
    let mut out: Vec<Settlement> = Vec::new();
    while out.len() < count {
        let mut at = domain.min + domain.size() * DVec2::new(random.unit(), random.unit());
        if let Some(near) = out.last().filter(|_| random.chance(0.5)) {
            at = near.centre.plan() + math::direction(random.range(0.0, TAU)) * step * random.range(1.51, 3.0);
        }
        let free = out.iter().all(|o| o.centre.plan().distance(at) >= 1.5 * step + 2.0);
        if free && domain.grown(-1.0).contains(at) {
            let size = [SizeClass::City, SizeClass::Town, SizeClass::Village, SizeClass::Village][random.index(4)];
            out.push(settlement(out.len(), at, size, random.range(120.0, 1_700.0)));
        }
    }
    out
}

#[test]
fn every_settlement_is_reached_on_any_lattice_and_nothing_lies_outside() {
    let domain = Bounds::new(DVec2::new(-9_000.0, -4_000.0), DVec2::new(9_000.0, 11_000.0));
    let mut exact = 0;
    for (seed, step) in [(1, 150), (2, 200), (3, 333), (4, 400), (5, 781), (6, 1_000), (7, 781), (8, 250)] {
        let all = mixed(seed, 18, domain, step as f64);
        let ground = ground(if seed % 2 == 0 { 60.0 } else { 900.0 }, domain);
        let network =
            RoadNetwork::build(domain, ground.clone(), &all, &RoadSettings::finite(step), &Edits::default()).unwrap();
        assert_eq!(network.unreached, [], "seed {seed}");
        assert_eq!(ground.outside.load(Ordering::Relaxed), 0);
        exact += check(&network, domain, step);
    }
    assert!(exact > 60, "{exact}");
}

/// Roads lie in the domain, meet at junctions only, connect all settlements and lead through no disc. Gives the number of
/// settlements at whose very centre roads end.
fn check(network: &RoadNetwork, domain: Bounds, step: i64) -> usize {
    let mut exact = 0;
    let origin = Origin::at(domain.centre());
    let junctions = network.junctions(origin);
    let at = |id| junctions[junctions.binary_search_by_key(&id, |j| j.id).unwrap()].at;
    let mut lines = Vec::new();
    for (i, road) in network.roads.iter().enumerate() {
        let shift = road.origin.offset_to(origin);
        for (a, b) in segments(&road.street.line) {
            assert!(domain.contains(origin.to_plan(a + shift)) && domain.contains(origin.to_plan(b + shift)));
            lines.push((i, a + shift, b + shift));
        }
        let (line, street) = (&road.street.line, &road.street);
        assert_eq!([line[0] + shift, line[line.len() - 1] + shift], [at(street.from), at(street.to)]);
    }
    for (n, (i, a, b)) in lines.iter().enumerate() {
        for (j, c, d) in &lines[n + 1..] {
            let (r, s) = (&network.roads[*i].street, &network.roads[*j].street);
            // Over a bridge's deck or a tunnel's ground others may pass.
            if i != j
                && r.level == s.level
                && let Some(x) = segment_crossing(*a, *b, *c, *d)
            {
                let shared = [r.from, r.to].iter().any(|id| (*id == s.from || *id == s.to) && at(*id) == x.at);
                assert!(shared, "{:?} and {:?} meet at {}", r.id, s.id, origin.to_plan(x.at));
            }
        }
    }
    // From every settlement all others can be reached.
    let mut joined = DisjointSets::new();
    for road in &network.roads {
        joined.union(road.street.from, road.street.to);
    }
    for (s, outline) in network.settlements.iter().zip(&network.outlines) {
        let shift = origin.offset_to(s.centre);
        let polygon = &outline.polygon;
        let own: Vec<_> = junctions.iter().filter(|j| polygon.contains(&(j.at + shift))).collect();
        if own.is_empty() {
            // A node: roads end at its centre, or near where the lattice allows no more.
            let end = JunctionId::of(&[2, s.id.0, 0, 0]);
            assert!(at(end).distance(shift * -1.0) < 1.1 * step as f64, "{}", s.name);
            exact += usize::from(at(end) == shift * -1.0);
            continue;
        }
        // Gates lead into a town, whose streets connect them.
        for gate in &own {
            joined.union(gate.id, own[0].id);
        }
        let inside = |p: DVec2| point_in_polygon(p + shift, polygon) && !polygon.contains(&(p + shift));
        assert!(!lines.iter().any(|(_, a, b)| inside(*a) || inside(*b)), "a road leads through {}", s.name);
    }
    assert!(junctions.iter().all(|j| joined.same(j.id, junctions[0].id)));
    exact
}

/// A ridge from north to south, at x = 0.
fn ridge(p: DVec2) -> TerrainSample {
    let height = 240.0 * math::exp(-(p.x / 260.0) * (p.x / 260.0));
    TerrainSample { height, water_level: -100.0, vegetation: 0.0 }
}

#[test]
fn under_a_steep_ridge_leads_a_tunnel_where_one_is_allowed() {
    let domain = Bounds::square(DVec2::ZERO, 9_000.0);
    let town = |i, x: f64| settlement(i, DVec2::new(x, 300.0), SizeClass::Town, 200.0);
    let all = [town(0, -2_500.0), town(1, 2_600.0)];
    let mut settings = RoadSettings::finite(150);
    let tunnels = |settings: &RoadSettings| {
        let network = RoadNetwork::build(domain, Arc::new(Ground(ridge)), &all, settings, &Edits::default()).unwrap();
        assert_eq!(network.links.len(), 1);
        assert_eq!(network.links[0].tunnels, network.roads.iter().filter(|r| r.street.tunnel).count());
        network.links[0].tunnels
    };
    settings.major.tunnel_limit = 0.0;
    assert_eq!(tunnels(&settings), 0);
    settings.major.tunnel_limit = 2_000.0;
    assert_eq!(tunnels(&settings), 1);
}

#[test]
fn threads_change_nothing_and_a_cancelled_build_stops() {
    let domain = Bounds::square(DVec2::new(3e6, -2e6), 20_000.0);
    let all = mixed(11, 20, domain, 400.0);
    let build = |task: &NetworkTask<'_>| {
        RoadNetwork::build_as(domain, ground(60.0, domain), &all, &RoadSettings::finite(400), &Edits::default(), task)
    };
    let one = build(&NetworkTask::default()).unwrap();
    assert_eq!(one, build(&NetworkTask { threads: 3, ..NetworkTask::default() }).unwrap());
    let mut reversed = all.clone();
    reversed.reverse();
    assert_eq!(
        one,
        RoadNetwork::build(domain, ground(60.0, domain), &reversed, &RoadSettings::finite(400), &Edits::default())
            .unwrap()
    );
    let task = NetworkTask::default();
    task.cancel.cancel();
    assert_eq!(build(&task), Err(NetworkError::Layer(LayerError::Cancelled)));
}

#[test]
fn what_cannot_be_built_is_named() {
    let domain = Bounds::new(DVec2::ZERO, DVec2::splat(10_000.0));
    let village = |i, x: f64, y: f64| settlement(i, DVec2::new(x, y), SizeClass::Village, 200.0);
    let refuse = |all: &[Settlement], step: i64, level: f64| {
        let terrain = ground(level, domain);
        RoadNetwork::build(domain, terrain, all, &RoadSettings::finite(step), &Edits::default()).unwrap_err()
    };
    let (a, b) = (village(0, 1_000.0, 1_000.0), village(1, 5_000.0, 2_000.0));
    assert_eq!(refuse(std::slice::from_ref(&a), 400, 0.0), NetworkError::TooFew(1));
    let cases = [
        (village(2, 10_500.0, 0.0), 0.0, "Village 2 at 10500,0 m lies outside of the domain; allowed is x 0 to 10000"),
        (
            village(2, 5_300.0, 2_000.0),
            0.0,
            "Village 2 lies 300 m from Village 1; keep at least 1.5 steps of the lattice (600 m)",
        ),
        (village(1, 9_000.0, 2_000.0), 0.0, "Village 1 and Village 1 have the same id"),
        (village(2, 2_500.0, 8_000.0), 1e4, "of water; a settlement needs dry ground"),
    ];
    for (bad, hills, expected) in cases {
        let all = if hills > 0.0 { vec![bad.clone(), bad] } else { vec![a.clone(), b.clone(), bad] };
        let error = refuse(&all, 400, hills);
        let NetworkError::Settlement { reason, .. } = &error else { panic!("{error}") };
        assert!(reason.contains(expected), "{reason}");
    }
    assert!(matches!(refuse(&[a.clone(), b.clone()], 9_000, 0.0), NetworkError::Range(_)));
    assert!(matches!(refuse(&[a, b], 5, 0.0), NetworkError::Range(_)));
}

/// A row of four villages on a plain with a fifth north of it, 4 km apart.
fn row(domain: Bounds) -> Vec<Settlement> {
    let (low, step) = (domain.min, 4_000.0);
    let places = [(1.0, 1.0), (2.0, 1.0), (3.0, 1.0), (4.0, 1.0), (2.5, 2.2)];
    let at = |(x, y): (f64, f64)| low + DVec2::new(x, y) * step;
    places.iter().enumerate().map(|(i, p)| settlement(i, at(*p), SizeClass::Village, 200.0)).collect()
}

fn edited_row(domain: Bounds, edits: &Edits) -> RoadNetwork {
    assert_eq!(edits.check(), Ok(()));
    let network = RoadNetwork::build(domain, ground(0.0, domain), &row(domain), &settings(250, 2.0), edits).unwrap();
    check(&network, domain, 250);
    network
}

/// Least distance in metres from a point to any road.
fn off_roads(network: &RoadNetwork, p: DVec2) -> f64 {
    let off = |r: &Arc<crate::region::RoadSection>| distance_to_line(r.origin.to_local(p), &r.street.line);
    network.roads.iter().map(off).fold(f64::INFINITY, f64::min)
}

#[test]
fn all_edits_are_carried_out_in_a_finite_domain() {
    let domain = Bounds::square(DVec2::new(3e5, -2e5), 20_000.0);
    let (places, low) = (row(domain).iter().map(|s| s.centre.plan()).collect::<Vec<_>>(), domain.min);
    assert_eq!(pairs(&edited_row(domain, &Edits::default())), [(0, 1), (1, 2), (1, 4), (2, 3), (2, 4)]);
    let roads = vec![
        RoadEdit::Ban { from: places[1], to: places[4] },
        // Named by a point in the circle, not by the centre.
        RoadEdit::Keep { from: places[0] + 150.0 * DVec2::Y, to: places[4] },
        RoadEdit::Via { from: places[0], to: places[1], points: vec![low + DVec2::new(6_000.0, 2_500.0)], keep: true },
    ];
    let network = edited_row(domain, &Edits { roads, ..Edits::default() });
    assert_eq!((pairs(&network), &network.rejected), (vec![(0, 1), (0, 4), (1, 2), (2, 3), (2, 4)], &vec![]));
    assert!(off_roads(&network, low + DVec2::new(6_000.0, 2_500.0)) < 3.0 * 250.0);

    let at = low + DVec2::new(10_000.0, 14_000.0);
    let way_points = vec![WayPoint { at, class: StreetClass::Minor }];
    let network = edited_row(domain, &Edits { way_points, ..Edits::default() });
    assert_eq!((network.way_points.len(), network.rejected.len()), (1, 0));
    let id = network.way_points[0].id;
    assert!(network.links.iter().any(|l| l.from == id || l.to == id) && off_roads(&network, at) == 0.0);

    let pin = low + DVec2::new(16_000.0, 12_000.0);
    let settlements = vec![
        SettlementEdit::Pin { at: pin, size: SizeClass::Town, name: Some("Pinned".into()), style: None, radius: None },
        SettlementEdit::Move { from: places[4], to: places[4] + DVec2::new(500.0, 900.0) },
        SettlementEdit::Ban { at: places[0], radius: 300.0 },
    ];
    let network = edited_row(domain, &Edits { settlements, ..Edits::default() });
    let names: Vec<&str> = network.settlements.iter().map(|s| s.name.as_str()).collect();
    assert!(names.len() == 5 && names.contains(&"Pinned") && !names.contains(&"Village 0"), "{names:?}");
    let moved = network.settlements.iter().find(|s| s.name == "Village 4").unwrap();
    assert_eq!((moved.centre.plan(), &network.unreached), (places[4] + DVec2::new(500.0, 900.0), &vec![]));

    let drives = |shape| Influence { shape, radius: 800.0, strength: 60.0, classes: vec![] };
    let wall = low + DVec2::new(10_000.0, 4_000.0);
    assert!(off_roads(&edited_row(domain, &Edits::default()), wall) < 100.0);
    let influences = vec![drives(Shape::Curve(vec![wall - DVec2::Y * 700.0, wall + DVec2::Y * 700.0]))];
    assert!(off_roads(&edited_row(domain, &Edits { influences, ..Edits::default() }), wall) > 700.0);
    // The same wall, painted.
    let values = (0..20 * 20).map(|i| if i % 20 == 9 && i / 20 < 6 { 60.0 } else { 0.0 }).collect();
    let raster = Raster::new(20, 20, low, DVec2::splat(1_000.0), values).unwrap();
    let mut map = InfluenceMap {
        file: "wall.asc".into(),
        corner: None,
        cell: None,
        black: None,
        white: None,
        classes: vec![],
        cells: None,
    };
    let painted =
        |map: &InfluenceMap| edited_row(domain, &Edits { influence_maps: vec![map.clone()], ..Edits::default() });
    assert!(painted(&map).rejected[0].reason.contains("wall.asc was not read"));
    map.paint(&raster);
    assert!(off_roads(&painted(&map), low + DVec2::new(9_500.0, 4_000.0)) > 700.0);
}

#[test]
fn a_road_through_points_may_be_dropped_where_it_costs_too_much() {
    let domain = Bounds::square(DVec2::ZERO, 20_000.0);
    let places: Vec<DVec2> = row(domain).iter().map(|s| s.centre.plan()).collect();
    let via = |aside: f64, keep: bool| {
        let points = vec![(places[0] + places[1]) / 2.0 + DVec2::Y * aside];
        let roads = vec![RoadEdit::Via { from: places[0], to: places[1], points, keep }];
        edited_row(domain, &Edits { roads, ..Edits::default() })
    };
    // The second village is the first one's only neighbour: its road stays, at whatever cost the settings allow.
    assert!(pairs(&via(2_500.0, false)).contains(&(0, 1)));
    let roads = |keep: bool| {
        // 12 km by way of the south, where the third village is nearer to both ends.
        let points = vec![DVec2::new(places[1].x, domain.min.y + 500.0)];
        let roads = vec![RoadEdit::Via { from: places[1], to: places[2], points, keep }];
        let mut all = row(domain);
        all.push(settlement(5, (places[1] + places[2]) / 2.0 + DVec2::Y * 2_300.0, SizeClass::Village, 200.0));
        RoadNetwork::build(domain, ground(0.0, domain), &all, &settings(250, 2.0), &Edits { roads, ..Edits::default() })
            .unwrap()
    };
    let (kept, dropped) = (roads(true), roads(false));
    assert!(pairs(&kept).contains(&(1, 2)) && kept.rejected.is_empty(), "{:?}", kept.rejected);
    assert!(!pairs(&dropped).contains(&(1, 2)), "{:?}", pairs(&dropped));
    assert!(dropped.rejected[0].reason.contains("keep: true"), "{:?}", dropped.rejected);
}

#[test]
fn edits_that_a_domain_cannot_fulfil_are_named() {
    let domain = Bounds::square(DVec2::ZERO, 20_000.0);
    let places: Vec<DVec2> = row(domain).iter().map(|s| s.centre.plan()).collect();
    let out = DVec2::new(30_000.0, 0.0);
    let pin = |at| SettlementEdit::Pin { at, size: SizeClass::Town, name: None, style: None, radius: None };
    let edits = Edits {
        settlements: vec![pin(out), pin(places[0] + 90.0), SettlementEdit::Move { from: out, to: places[0] }],
        influences: vec![Influence { shape: Shape::Point(out), radius: 500.0, strength: 1.0, classes: vec![] }],
        way_points: vec![WayPoint { at: out, class: StreetClass::Minor }],
        roads: vec![
            RoadEdit::Keep { from: out, to: places[1] },
            RoadEdit::Via { from: places[2], to: places[3], points: vec![out], keep: true },
        ],
        ..Edits::default()
    };
    let network = edited_row(domain, &edits);
    let named: Vec<(EditList, usize)> = network.rejected.iter().map(|e| (e.list, e.index)).collect();
    let (s, r) = (EditList::Settlements, EditList::Roads);
    let one = |list| (list, 0);
    assert_eq!(named, [(s, 0), (s, 1), (s, 2), one(EditList::Influences), one(EditList::WayPoints), (r, 0), (r, 1)]);
    assert_eq!(pairs(&network), pairs(&edited_row(domain, &Edits::default())));
}

#[test]
fn who_would_get_no_road_gets_a_costlier_one() {
    let domain = Bounds::square(DVec2::ZERO, 20_000.0);
    let all = row(domain);
    let alone = all[4].centre.plan();
    let corner = |x: f64, y: f64| alone + DVec2::new(x, y) * 900.0;
    let ring = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0)];
    let influence = Influence { shape: Shape::Curve(ring.to_vec()), radius: 600.0, strength: 100.0, classes: vec![] };
    let mut settings = settings(250, 2.0);
    settings.minor.detour = 1.5;
    let build = |edits: &Edits| RoadNetwork::build(domain, ground(0.0, domain), &all, &settings, edits).unwrap();
    let network = build(&Edits { influences: vec![influence.clone()], ..Edits::default() });
    check(&network, domain, 250);
    let links: Vec<_> = pairs(&network).into_iter().filter(|p| p.1 == 4).collect();
    assert_eq!((links.len(), &network.unreached), (1, &vec![]), "{links:?}");
    assert!(network.links.iter().all(|l| l.cost.is_finite()));
    // What the user bans stays away, and the settlement is named.
    let bans = (0..4).map(|i| RoadEdit::Ban { from: all[i].centre.plan(), to: alone });
    let network = build(&Edits { influences: vec![influence], roads: bans.collect(), ..Edits::default() });
    assert_eq!(network.unreached, [all[4].id]);
}
