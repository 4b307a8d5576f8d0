//! Random junctions: the drawn surface is the covered ground.

use crate::network::{Junction, JunctionId, Street, StreetClass, StreetId};
use crate::space::math::direction;
use crate::space::{Seed, Stream, cut_line, quantize, signed_area};
use crate::surface::{JunctionShape, Strip, cover, junction_reach};
use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use std::f64::consts::{FRAC_PI_3, TAU};

/// `count` streets of some classes out of one junction, at least 60 degrees apart, most of them bent near it.
fn star(rng: &mut Stream, count: usize, class: impl Fn(&mut Stream) -> StreetClass) -> Vec<Street> {
    let gaps: Vec<f64> = (0..count).map(|_| rng.unit() * rng.unit()).collect();
    let spare = TAU - FRAC_PI_3 * count as f64;
    let scale = spare / gaps.iter().sum::<f64>().max(1e-3);
    let mut angle = rng.range(0.0, TAU);
    let mut out = Vec::new();
    for (i, gap) in gaps.iter().enumerate() {
        let class = class(rng);
        let mut line = vec![DVec2::ZERO];
        let bend = if rng.chance(0.7) { rng.range(-0.03, 0.03) } else { 0.0 };
        for k in 1..=6 {
            line.push(line[k - 1] + direction(angle + bend * k as f64) * 12.0);
        }
        let line = line.into_iter().map(quantize).collect();
        let to = JunctionId(1 + i as u64);
        let mut street = Street::new(StreetId(i as u64), class, JunctionId(0), to, line);
        if rng.chance(0.5) {
            street.line.reverse();
            (street.from, street.to) = (street.to, street.from);
        }
        out.push(street);
        angle += FRAC_PI_3 + gap * scale;
    }
    out
}

type Rings = Vec<Vec<[f64; 2]>>;

fn ring(points: &[DVec2]) -> Vec<[f64; 2]> {
    points.iter().map(|p| [p.x, p.y]).collect()
}

/// The polygons that are drawn for streets and their junctions.
fn drawn(streets: &[Street]) -> Rings {
    let mut out: Rings = Vec::new();
    let strip = |line: &[DVec2], class, out: &mut Rings| {
        let Some(strip) = Strip::new(line, class) else { return };
        let [left, right] = &strip.outer;
        for i in 0..line.len() - 1 {
            out.push(ring(&[right[i], right[i + 1], left[i + 1], left[i]]));
        }
    };
    for street in streets {
        let (length, end) = (street.length(), junction_reach(street));
        strip(&cut_line(&street.line, end, length - end), street.class, &mut out);
    }
    let ids = 0..=streets.len() as u64;
    for id in ids.map(JunctionId) {
        let ends: Vec<(&Street, bool)> = streets
            .iter()
            .flat_map(|s| [(s, s.from == id, true), (s, s.to == id, false)])
            .filter(|(_, meets, _)| *meets)
            .map(|(s, _, begins)| (s, begins))
            .collect();
        let (street, begins) = ends[0];
        let at = if begins { street.line[0] } else { street.line[street.line.len() - 1] };
        let shape = JunctionShape::new(&Junction { id, at }, &ends).unwrap();
        let outline: Vec<DVec2> = shape.arms.iter().flat_map(|arm| arm.corner.side.iter().copied()).collect();
        out.push(ring(&outline));
        for arm in &shape.arms {
            strip(&arm.line, arm.street.class, &mut out);
        }
    }
    out
}

fn area_of(a: &Rings, b: &Rings, rule: OverlayRule) -> f64 {
    let area = |r: &Vec<[f64; 2]>| signed_area(&r.iter().map(|p| DVec2::new(p[0], p[1])).collect::<Vec<_>>());
    a.overlay(b, rule, FillRule::NonZero).iter().flatten().map(area).sum()
}

/// Area drawn outside the cover, and area covered but not drawn, in square metres.
fn mismatch(streets: &[Street]) -> (f64, f64) {
    let drawn = drawn(streets);
    let covered: Rings = cover(&streets.iter().collect::<Vec<_>>(), 0.0).iter().map(|p| ring(p)).collect();
    let area = |a, b| area_of(a, b, OverlayRule::Difference);
    (area(&drawn, &covered), area(&covered, &drawn))
}

#[test]
fn junctions_of_streets_of_one_width_are_drawn_as_they_cover() {
    let mut rng = Seed(7).stream("surface test", &[]);
    for case in 0..300 {
        let class = StreetClass::ALL[rng.index(StreetClass::ALL.len())];
        let streets = star(&mut rng, 1 + case % 5, |_| class);
        let (beyond, missing) = mismatch(&streets);
        assert!(beyond < 0.1 && missing < 0.1, "case {case}: {beyond} m2 beyond, {missing} m2 missing, {streets:?}");
    }
}

#[test]
fn two_streets_of_any_width_are_drawn_as_they_cover() {
    let mut rng = Seed(8).stream("surface test", &[]);
    for case in 0..300 {
        let streets = star(&mut rng, 2, |rng| StreetClass::ALL[rng.index(StreetClass::ALL.len())]);
        let (beyond, missing) = mismatch(&streets);
        // The corners of the octagon around the end of the wider street may stand out of the mitred corners by this much.
        assert!(beyond < 0.1 && missing < 1.5, "case {case}: {beyond} m2 beyond, {missing} m2 missing, {streets:?}");
    }
}

#[test]
fn nothing_is_drawn_beyond_what_streets_cover() {
    let mut rng = Seed(9).stream("surface test", &[]);
    for case in 0..300 {
        let streets = star(&mut rng, 1 + case % 5, |rng| StreetClass::ALL[rng.index(StreetClass::ALL.len())]);
        let (beyond, _) = mismatch(&streets);
        assert!(beyond < 0.1, "case {case}: {beyond} m2 beyond, {streets:?}");
    }
}
