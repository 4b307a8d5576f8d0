//! Diamond interchanges, and roads that highways keep off.

use super::*;
use crate::edits::RoadEdit;
use crate::space::{DisjointSets, cross, math};
use crate::terrain::{Terrain, TerrainSample};

/// Ground that rises evenly to the north-east, with a pond of a radius at a place.
#[derive(Clone, Copy)]
struct Slope {
    grade: f64,
    pond: Option<(DVec2, f64)>,
}

const EVEN: Slope = Slope { grade: 0.0, pond: None };

impl Terrain for Slope {
    fn sample(&self, p: DVec2) -> TerrainSample {
        let height = 100.0 + self.grade * (p.x + p.y);
        let wet = self.pond.is_some_and(|(at, radius)| p.distance(at) < radius);
        TerrainSample { height, water_level: if wet { height + 2.0 } else { height - 50.0 }, vegetation: 0.0 }
    }
}

const EDGE: f64 = 16_000.0;
const STEP: i64 = 128;

/// Two cities in the west and the east with a highway between them, and two towns in the south and the north with a road
/// that crosses it.
fn crossed(ground: Slope, change: impl Fn(&mut RoadSettings)) -> RoadNetwork {
    crossed_by([SizeClass::Town; 2], ground, change)
}

/// The same with other sizes of the settlements in the south and the north.
fn crossed_by(others: [SizeClass; 2], ground: Slope, change: impl Fn(&mut RoadSettings)) -> RoadNetwork {
    let place = |i: usize, at: DVec2, size, radius| {
        let (id, style, name) = (SettlementId(i as u64 + 1), String::new(), format!("{i}"));
        Settlement { id, centre: Origin::at(at), radius, size, style, name }
    };
    let at = [(1_000.0, 8_000.0), (15_000.0, 8_000.0), (8_000.0, 1_000.0), (8_000.0, 15_000.0)].map(DVec2::from);
    let all: Vec<Settlement> = (0..4)
        .map(|i| {
            let size = if i < 2 { SizeClass::City } else { others[i - 2] };
            place(i, at[i], size, if i < 2 { 600.0 } else { 300.0 })
        })
        .collect();
    let mut roads: Vec<RoadEdit> = (0..4).map(|i| RoadEdit::Ban { from: at[i / 2], to: at[2 + i % 2] }).collect();
    roads.push(RoadEdit::Keep { from: at[2], to: at[3] });
    let mut settings = RoadSettings::finite(STEP);
    change(&mut settings);
    let domain = Bounds::new(DVec2::ZERO, DVec2::splat(EDGE));
    let edits = Edits { roads, ..Edits::default() };
    RoadNetwork::build(domain, Arc::new(ground), &all, &settings, &edits).unwrap()
}

fn of_class(network: &RoadNetwork, class: StreetClass) -> Vec<&Arc<RoadSection>> {
    network.roads.iter().filter(|r| r.street.class == class).collect()
}

/// The line of a section in plan metres.
fn plan(section: &RoadSection) -> Vec<DVec2> {
    section.street.line.iter().map(|p| section.origin.to_plan(*p)).collect()
}

/// The junctions that one can drive to from one, by the rules of one-way roads.
fn reached(network: &RoadNetwork, from: JunctionId) -> Vec<JunctionId> {
    let mut out = vec![from];
    let mut i = 0;
    while let Some(at) = out.get(i).copied() {
        for s in network.roads.iter().map(|r| &r.street) {
            let next =
                if s.from == at { Some(s.to) } else { Some(s.from).filter(|_| s.to == at && !s.class.is_one_way()) };
            out.extend(next.filter(|n| !out.contains(n)));
        }
        i += 1;
    }
    out
}

/// Panics unless the ramps of a network meet roads at blunt angles, bend gently, and leave and join highways on the right.
fn assert_ramps_are_sound(network: &RoadNetwork) {
    let highways: Vec<Vec<DVec2>> = of_class(network, StreetClass::Highway).into_iter().map(|r| plan(r)).collect();
    for ramp in of_class(network, StreetClass::Ramp) {
        let line = plan(ramp);
        for w in line.windows(3) {
            let bend = math::angle_between(w[1] - w[0], w[2] - w[1]);
            let radius = w[0].distance(w[1]).min(w[1].distance(w[2])) / bend.max(1e-9);
            assert!(bend < 0.4 && radius > 30.0, "{bend} {radius} in {line:?}");
        }
        let mut ends = 0;
        for (at, out, begins) in [
            (line[0], line[1] - line[0], true),
            (line[line.len() - 1], line[line.len() - 1] - line[line.len() - 2], false),
        ] {
            for road in &network.roads {
                let other = plan(road);
                let far = if other[0] == at {
                    other[1]
                } else if other[other.len() - 1] == at {
                    other[other.len() - 2]
                } else {
                    continue;
                };
                if road.street.id == ramp.street.id {
                    continue;
                }
                ends += 1;
                let away = if begins { out } else { -out };
                assert!(math::angle_between(away, far - at) > 0.48, "{} at {at}", math::angle_between(away, far - at));
            }
            let touched = highways.iter().flat_map(|h| segments(h)).find(|(a, b)| *a == at || *b == at);
            if let Some((a, b)) = touched {
                let along = if (b - a).dot(out) > 0.0 { b - a } else { a - b };
                // To the right where it leaves, from the right where it joins. It meets the road that passes over squarely.
                if math::angle_between(along, out) < 0.8 {
                    assert_eq!(cross(along, out) < 0.0, begins, "at {at}");
                }
            }
        }
        assert!(ends >= 5, "{ends}");
    }
}

#[test]
fn a_road_crosses_a_highway_in_a_diamond_with_four_ramps() {
    for ground in [EVEN, Slope { grade: 0.02, ..EVEN }] {
        let network = crossed(ground, |_| ());
        assert_eq!(network.links.len(), 2);
        let [crossing] = network.crossings.as_slice() else { panic!("{:?}", network.crossings) };
        assert_eq!((crossing.built, crossing.class, crossing.hindrance), (Crossing::Diamond, StreetClass::Major, None));
        let ramps = of_class(&network, StreetClass::Ramp);
        assert_eq!(ramps.len(), 4);
        assert_planar(&network.roads, Origin::at(crossing.at));
        assert_ramps_are_sound(&network);
        // Every road leads to every other, whichever way one drives.
        let all: Vec<JunctionId> = network.junctions(Origin::at(crossing.at)).iter().map(|j| j.id).collect();
        for from in &all {
            assert_eq!(reached(&network, *from).len(), all.len());
        }
        // Two ramps meet the other road in one place on each side of the highway, and the highway in four.
        let ends: Vec<JunctionId> = ramps.iter().flat_map(|r| [r.street.from, r.street.to]).collect();
        let mut places = ends.clone();
        places.sort();
        places.dedup();
        assert_eq!(places.len(), 6);
        for ramp in ramps {
            let line = plan(ramp);
            let height = |p: DVec2| ground.sample(p).height;
            let rises = segments(&line).map(|(a, b)| (height(a) - height(b)).abs() / a.distance(b));
            assert!(rises.fold(0.0, f64::max) < 0.11);
            assert!(line.iter().all(|p| (60.0..450.0).contains(&p.distance(crossing.at))), "{line:?}");
        }
    }
}

#[test]
fn a_class_that_crosses_at_junctions_gets_a_plain_one() {
    let network = crossed(EVEN, |s| s.major.highway_crossings = Crossing::Junction);
    let [crossing] = network.crossings.as_slice() else { panic!("{:?}", network.crossings) };
    assert_eq!((crossing.built, crossing.hindrance), (Crossing::Junction, None));
    assert!(of_class(&network, StreetClass::Ramp).is_empty());
    assert!(network.roads.iter().all(|r| !r.street.bridge));
    let at = network.junctions(Origin::at(DVec2::ZERO)).into_iter().find(|j| j.at.distance(crossing.at) < 1.0).unwrap();
    let ends = network.roads.iter().flat_map(|r| [r.street.from, r.street.to]);
    assert_eq!(ends.filter(|id| *id == at.id).count(), 4);
}

#[test]
fn a_diamond_without_room_is_built_plainer_and_says_why() {
    // A pond in one quarter, where a ramp would run.
    let at = crossed(EVEN, |_| ()).crossings[0].at;
    let network = crossed(Slope { pond: Some((at + DVec2::new(140.0, 140.0), 95.0)), ..EVEN }, |_| ());
    let [crossing] = network.crossings.as_slice() else { panic!("{:?}", network.crossings) };
    assert_eq!(crossing.hindrance, Some(Hindrance::Ground));
    assert!(crossing.built < Crossing::Diamond);
    assert!(of_class(&network, StreetClass::Ramp).is_empty());
}

#[test]
fn highways_cross_highways_in_diamonds() {
    let network = crossed_by([SizeClass::City; 2], Slope { grade: 0.01, ..EVEN }, |_| ());
    let [crossing] = network.crossings.as_slice() else { panic!("{:?}", network.crossings) };
    assert_eq!((crossing.built, crossing.class, crossing.hindrance), (Crossing::Diamond, StreetClass::Highway, None));
    assert_eq!(of_class(&network, StreetClass::Ramp).len(), 4);
    assert_planar(&network.roads, Origin::at(crossing.at));
    assert_ramps_are_sound(&network);
}

/// Whether the highway of a network and its other roads are joined anywhere.
fn are_joined(network: &RoadNetwork) -> bool {
    let mut sets = DisjointSets::new();
    for r in &network.roads {
        sets.union(r.street.from.0, r.street.to.0);
    }
    let [highway, other] =
        [StreetClass::Highway, StreetClass::Minor].map(|c| sets.find(of_class(network, c)[0].street.from.0));
    highway == other
}

#[test]
fn a_toll_road_is_joined_in_settlements_and_at_interchanges_only() {
    // A road to villages would follow the highway for most of the way, because its use costs less.
    let build = |toll: bool, crossing: Crossing| {
        crossed_by([SizeClass::Village; 2], EVEN, |s| {
            s.highway.toll = toll;
            s.minor.highway_crossings = crossing;
        })
    };
    assert!(are_joined(&build(false, Crossing::Junction)));
    assert!(!are_joined(&build(true, Crossing::Bridge)));
    let paid = build(true, Crossing::Diamond);
    assert!(are_joined(&paid) && paid.crossings.iter().all(|c| c.built == Crossing::Diamond), "{:?}", paid.crossings);
}

/// The number of junctions in a random world where one other road joins a highway that goes on.
fn forks_of_highways(i: u64, toll: bool) -> usize {
    let (seed, centre) = random_place(i);
    let base = super::world(seed, MERGE);
    let inputs = &base.searches.inputs;
    let mut settings = inputs.settings.clone();
    settings.highway.toll = toll;
    let (terrain, settlements) = (inputs.terrain.clone(), inputs.settlements.clone());
    let roads = Roads::from_source(&settings, terrain, settlements, &Edits::default(), 256 << 20);
    let sections = all(&roads, Bounds::square(centre, 14_000.0));
    assert_planar(&sections, Origin::at(centre));
    let mut at: BTreeMap<JunctionId, Vec<StreetClass>> = BTreeMap::new();
    for r in &sections {
        [r.street.from, r.street.to].into_iter().for_each(|id| at.entry(id).or_default().push(r.street.class));
    }
    let forks = |classes: &&Vec<StreetClass>| {
        let of = |class| classes.iter().filter(|c| **c == class).count();
        of(StreetClass::Highway) == 2 && of(StreetClass::Major) + of(StreetClass::Minor) == 1
    };
    at.values().filter(forks).count()
}

#[test]
fn no_road_branches_off_a_toll_road_on_the_way() {
    let count = |toll| (300..302).map(|i| forks_of_highways(i, toll)).sum::<usize>();
    let (free, paid) = (count(false), count(true));
    // What is left are ties of settlements and two-way ramps.
    assert!(free > 5 && paid * 4 < free, "{free} {paid}");
}

/// In a random world, the crossings of highways around a place.
fn crossings(i: u64, change: impl Fn(&mut RoadSettings)) -> Vec<HighwayCrossing> {
    let (seed, centre) = random_place(i);
    let base = super::world(seed, MERGE);
    let inputs = &base.searches.inputs;
    let mut settings = inputs.settings.clone();
    change(&mut settings);
    let (terrain, settlements) = (inputs.terrain.clone(), inputs.settlements.clone());
    let roads = Roads::from_source(&settings, terrain, settlements, &Edits::default(), 256 << 20);
    roads.crossings(Bounds::square(centre, 14_000.0), &Cancel::new()).unwrap()
}

#[test]
fn few_crossings_of_highways_with_better_roads_are_plain() {
    let (mut all, mut diamonds, mut plain) = (0, 0, 0);
    for i in 300..306 {
        let mut found = crossings(i, |_| ());
        found.retain(|c| c.class != StreetClass::Minor);
        all += found.len();
        for c in &found {
            assert_eq!(c.built == Crossing::Diamond, c.hindrance.is_none(), "{c:?}");
            diamonds += usize::from(c.built == Crossing::Diamond);
            // Where no road goes straight over the highway, two roads end at it in one place.
            plain += usize::from(c.built == Crossing::Junction && c.hindrance != Some(Hindrance::Angle));
        }
    }
    assert!(all > 8 && diamonds > 2 && 10 * plain <= all, "{all} {diamonds} {plain}");
}

#[test]
fn the_same_at_diamonds_whatever_was_asked_before() {
    let mut places = 0;
    for i in 300..306 {
        let found = crossings(i, |_| ()).into_iter().find(|c| c.built == Crossing::Diamond);
        let Some(crossing) = found else { continue };
        let (seed, _) = random_place(i);
        assert_same_whatever_was_asked(|| super::world(seed, MERGE), crossing.at, 1_000.0);
        places += 1;
    }
    assert!(places > 1, "{places}");
}
