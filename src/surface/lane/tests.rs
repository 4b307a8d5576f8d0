use super::*;
use crate::network::{JunctionId, Side, Street, StreetClass, StreetId};
use crate::space::{Seed, Stream, distance_to_line, line_length, math::direction, quantize, segments};
use glam::DVec2;
use std::collections::BTreeSet;

const HERE: JunctionId = JunctionId(1);

/// A street between the junction at the origin and a place in some direction.
fn spoke(id: u64, class: StreetClass, angle: f64, begins: bool) -> Street {
    let line = vec![DVec2::ZERO, quantize(direction(angle) * 35.0), quantize(direction(angle + 0.2) * 80.0)];
    let other = JunctionId(100 + id);
    if begins {
        return Street::new(StreetId(id), class, HERE, other, line);
    }
    Street::new(StreetId(id), class, other, HERE, line.into_iter().rev().collect())
}

fn ends(streets: &[Street]) -> Vec<(&Street, bool)> {
    streets.iter().map(|s| (s, s.from == HERE)).collect()
}

/// Streets of random classes around the origin.
fn star(rng: &mut Stream) -> Vec<Street> {
    let (count, first) = (1 + rng.index(6) as u64, rng.range(0.0, 6.0));
    let step = std::f64::consts::TAU / count as f64;
    let angle = |k: u64| first + step * (k as f64 + 0.3 * (k as f64 * 1.7).fract());
    (0..count)
        .map(|k| spoke(k, StreetClass::ALL[rng.index(StreetClass::ALL.len())], angle(k), rng.chance(0.5)))
        .collect()
}

#[test]
fn every_lane_goes_on_and_is_reached() {
    let mut rng = Seed(8).stream("lanes", &[]);
    for case in 0..600 {
        let (streets, driving) = (star(&mut rng), if rng.chance(0.5) { Side::Left } else { Side::Right });
        let lanes: Vec<Lane> = streets.iter().flat_map(|s| lanes_of(s, driving)).collect();
        let leaves = |lane: &Lane| {
            let street = &streets[lane.street.0 as usize];
            lane.along == (street.from == HERE)
        };
        let turns = turns_at(HERE, &ends(&streets), driving).turns;
        let from: BTreeSet<LaneId> = turns.iter().map(|t| t.from).collect();
        let to: BTreeSet<LaneId> = turns.iter().map(|t| t.to).collect();
        let (leaving, arriving): (Vec<&Lane>, Vec<&Lane>) = lanes.iter().partition(|lane| leaves(lane));
        if leaving.is_empty() || arriving.is_empty() {
            assert!(turns.is_empty(), "{case}");
            continue;
        }
        assert_eq!(from, arriving.iter().map(|l| l.id).collect(), "{case}: lanes that arrive");
        assert_eq!(to, leaving.iter().map(|l| l.id).collect(), "{case}: lanes that leave");
        let lane = |id: LaneId| lanes.iter().find(|l| l.id == id).expect("a lane of the streets");
        for (i, turn) in turns.iter().enumerate() {
            let (a, b) = (lane(turn.from), lane(turn.to));
            assert_eq!((a.line.last(), b.line.first()), (turn.line.first(), turn.line.last()), "{case}");
            assert!(segments(&turn.line).all(|(p, q)| p.distance(q) < 3.5), "{case}: no jump");
            assert!(a.street != b.street || turn.kind == TurnKind::Back, "{case}");
            assert!(turn.conflicts.iter().all(|k| turns[*k].conflicts.contains(&i) && turns[*k].from != turn.from));
        }
    }
}

#[test]
fn traffic_on_the_left_is_the_mirror_of_traffic_on_the_right() {
    let mut rng = Seed(9).stream("lanes", &[]);
    let mirror = |p: &DVec2| DVec2::new(p.x, -p.y);
    for case in 0..200 {
        let streets = star(&mut rng);
        let mirrored: Vec<Street> = streets
            .iter()
            .map(|s| {
                // Ramps are drawn for traffic on the right.
                let ramp = s.class == StreetClass::Ramp;
                let line: Vec<DVec2> = s.line.iter().map(mirror).collect();
                match ramp {
                    true => Street { from: s.to, to: s.from, line: line.into_iter().rev().collect(), ..s.clone() },
                    false => Street { line, ..s.clone() },
                }
            })
            .collect();
        let right = turns_at(HERE, &ends(&streets), Side::Right).turns;
        let left = turns_at(HERE, &ends(&mirrored), Side::Left).turns;
        let kinds = |turns: &[Turn], kind: TurnKind| turns.iter().filter(|t| t.kind == kind).count();
        assert_eq!(right.len(), left.len(), "{case}");
        for (a, b) in [
            (TurnKind::Left, TurnKind::Right),
            (TurnKind::Straight, TurnKind::Straight),
            (TurnKind::Back, TurnKind::Back),
        ] {
            assert_eq!(kinds(&right, a), kinds(&left, b), "{case}");
        }
    }
}

#[test]
fn lanes_lie_beside_each_other_on_the_carriageway() {
    for class in StreetClass::ALL {
        let street = spoke(7, class, 0.4, true);
        for driving in [Side::Left, Side::Right] {
            let lanes = lanes_of(&street, driving);
            for lane in &lanes {
                let off = |p: &DVec2| distance_to_line(*p, &street.line);
                let half = class.carriageway() / 2.0 - lane.width / 2.0;
                assert!(lane.line.iter().all(|p| off(p) < half + 0.1), "{class:?}: on the carriageway");
                let (a, b) = (lane.line[0], lane.line[1]);
                let middle = crate::space::closest_on_line(a, &street.line).1;
                let to_side = (b - a).perp_dot(a - middle);
                let on_side = if driving == Side::Left { to_side > 0.0 } else { to_side < 0.0 };
                assert!(on_side || class.is_one_way(), "{class:?}");
            }
            for (i, a) in lanes.iter().enumerate() {
                for b in &lanes[..i] {
                    let apart = distance_to_line(a.line[0], &b.line);
                    assert!(apart > (a.width + b.width) / 2.0 - 0.05, "{class:?}: {apart}");
                }
            }
        }
    }
}

#[test]
fn every_frame_has_the_same_lanes() {
    let mut rng = Seed(10).stream("lanes", &[]);
    for _ in 0..50 {
        let streets = star(&mut rng);
        let shift = DVec2::new(512.0 * 37.0, -512.0 * 1201.0);
        let moved: Vec<Street> = streets.iter().map(|s| s.moved(shift)).collect();
        let there = turns_at(HERE, &ends(&moved), Side::Right).turns;
        for (a, b) in turns_at(HERE, &ends(&streets), Side::Right).turns.iter().zip(&there) {
            assert_eq!(a.line.iter().map(|p| *p + shift).collect::<Vec<_>>(), b.line);
            assert_eq!((a.from, a.to, &a.conflicts), (b.from, b.to, &b.conflicts));
        }
    }
}

#[test]
fn a_crossing_has_the_turns_and_conflicts_of_a_crossing() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let streets: Vec<Street> = (0..4).map(|k| spoke(k, StreetClass::Local, quarter * k as f64, true)).collect();
    let turns = turns_at(HERE, &ends(&streets), Side::Right).turns;
    let count = |kind: TurnKind| turns.iter().filter(|t| t.kind == kind).count();
    assert_eq!([TurnKind::Straight, TurnKind::Left, TurnKind::Right, TurnKind::Back].map(count), [4, 4, 4, 0]);
    for turn in &turns {
        let conflicts = turn.conflicts.len();
        let expected = match turn.kind {
            // The turns that end in the same lane: straight on from the left, and to the left from ahead.
            TurnKind::Right => 2..=2,
            // Both streets across, and turns across or into the same lane.
            TurnKind::Straight => 6..=7,
            _ => 4..=7,
        };
        assert!(expected.contains(&conflicts), "{:?}: {conflicts}", turn.kind);
    }
    let lengths: Vec<f64> = turns.iter().map(|t| line_length(&t.line)).collect();
    assert!(lengths.iter().all(|l| (20.0..60.0).contains(l)), "{lengths:?}");
}

#[test]
fn a_roundabout_is_driven_around_its_island() {
    // The ring passes the junction from the east to the north, with the island in the north-east.
    let leg = spoke(0, StreetClass::Main, -2.356, true);
    let ring = [spoke(1, StreetClass::Main, 0.0, true), spoke(2, StreetClass::Main, 1.571, true)];
    let [mut east, mut north] = ring;
    (east.island, north.island) = (Some(Side::Left), Some(Side::Right));
    let streets = [leg, east, north];
    for (driving, enters) in [(Side::Right, 1), (Side::Left, 2)] {
        let turns = turns_at(HERE, &ends(&streets), driving).turns;
        let street = |id: LaneId| {
            let lane = streets.iter().flat_map(|s| lanes_of(s, driving)).find(|l| l.id == id);
            lane.expect("a lane of the streets").street.0
        };
        let ways: BTreeSet<(u64, u64)> = turns.iter().map(|t| (street(t.from), street(t.to))).collect();
        let leaves = 3 - enters;
        assert_eq!(ways, BTreeSet::from([(0, enters), (leaves, 0), (leaves, enters)]), "{driving:?}");
        let control = |from: u64| turns.iter().find(|t| street(t.from) == from).map(|t| t.control);
        assert_eq!((control(0), control(leaves)), (Some(Control::GiveWay), Some(Control::Priority)));
    }
}
