//! Random junctions: the drawn surface is the covered ground, once.

use crate::network::{JunctionId, Side, Street, StreetClass, StreetId};
use crate::space::math::direction;
use crate::space::{Bounds, Origin, Seed, Stream, quantize, signed_area};
use crate::surface::{Graded, Profile, cover, shapes};
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

/// Streets on flat ground.
fn level(streets: &[Street]) -> Vec<Graded> {
    streets.iter().map(|s| Graded { street: s.clone(), profile: Profile::new(s, Origin::default(), |_| 7.0) }).collect()
}

/// The triangles that are drawn for streets and their junctions.
fn drawn(streets: &[Street]) -> Rings {
    let elements = shapes(&level(streets), Bounds::square(DVec2::ZERO, 400.0), Side::Right);
    let triangles = elements.iter().flat_map(|e| e.triangles.iter().map(move |t| t.0.map(|v| e.plan(v))));
    triangles.map(|t| ring(&t)).collect()
}

fn area(r: &[[f64; 2]]) -> f64 {
    signed_area(&r.iter().map(|p| DVec2::new(p[0], p[1])).collect::<Vec<_>>())
}

fn area_of(a: &Rings, b: &Rings, rule: OverlayRule) -> f64 {
    a.overlay(b, rule, FillRule::NonZero).iter().flatten().map(|r| area(r)).sum()
}

/// Area drawn outside the cover, and area covered but not drawn, in square metres.
fn mismatch(streets: &[Street]) -> (f64, f64) {
    let drawn = drawn(streets);
    let covered: Rings = cover(&streets.iter().collect::<Vec<_>>(), 0.0).iter().map(|p| ring(p)).collect();
    let area = |a, b| area_of(a, b, OverlayRule::Difference);
    (area(&drawn, &covered), area(&covered, &drawn))
}

/// Area that is drawn more than once, in square metres.
fn doubled(rings: &Rings) -> f64 {
    let all: f64 = rings.iter().map(|r| area(r)).sum();
    all - area_of(rings, &Vec::new(), OverlayRule::Subject)
}

const PAVED: [StreetClass; 3] = [StreetClass::Arterial, StreetClass::Main, StreetClass::Local];

#[test]
fn junctions_of_streets_of_one_width_are_drawn_once_and_as_they_cover() {
    let mut rng = Seed(7).stream("surface test", &[]);
    for case in 0..300 {
        let class = PAVED[rng.index(PAVED.len())];
        let streets = star(&mut rng, 1 + case % 5, |_| class);
        let (beyond, missing) = mismatch(&streets);
        assert!(beyond < 0.2 && missing < 0.2, "case {case}: {beyond} m2 beyond, {missing} m2 missing, {streets:?}");
        let doubled = doubled(&drawn(&streets));
        assert!(doubled < 0.01, "case {case}: {doubled} m2 twice, {streets:?}");
    }
}

#[test]
fn two_streets_of_any_width_are_drawn_as_they_cover() {
    let mut rng = Seed(8).stream("surface test", &[]);
    for case in 0..300 {
        let streets = star(&mut rng, 2, |rng| PAVED[rng.index(PAVED.len())]);
        let (beyond, missing) = mismatch(&streets);
        // The corners of the octagon around the end of the wider street may stand out of the mitred corners by this much.
        assert!(beyond < 0.1 && missing < 1.5, "case {case}: {beyond} m2 beyond, {missing} m2 missing, {streets:?}");
    }
}

#[test]
fn nothing_is_drawn_beyond_what_streets_cover_except_rounded_corners_of_country_roads() {
    let mut rng = Seed(9).stream("surface test", &[]);
    for case in 0..300 {
        let streets = star(&mut rng, 1 + case % 5, |rng| StreetClass::ALL[rng.index(StreetClass::ALL.len())]);
        let (beyond, _) = mismatch(&streets);
        let country = streets.iter().filter(|s| s.class.is_road()).count() > 1;
        assert!(beyond < if country { 120.0 } else { 0.1 }, "case {case}: {beyond} m2 beyond, {streets:?}");
    }
}

#[test]
fn every_frame_gives_the_same_shapes() {
    let mut rng = Seed(10).stream("surface test", &[]);
    for case in 0..100 {
        let streets = star(&mut rng, 1 + case % 6, |rng| StreetClass::ALL[rng.index(StreetClass::ALL.len())]);
        let shift = DVec2::new(512.0, -1024.0);
        let moved: Vec<Street> = streets.iter().map(|s| s.moved(shift)).collect();
        let window = Bounds::square(DVec2::ZERO, 400.0);
        let (here, there) =
            (shapes(&level(&streets), window, Side::Right), shapes(&level(&moved), window.moved(shift), Side::Right));
        assert_eq!(here.len(), there.len());
        for (a, b) in here.iter().zip(&there) {
            assert_eq!(a.triangles, b.triangles, "case {case}");
            assert!(a.points.iter().zip(&b.points).all(|(p, q)| p.truncate() == q.truncate() - shift), "case {case}");
        }
    }
}
