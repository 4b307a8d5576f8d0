//! Masks that are drawn for the test.

use crate::map::{LeftOut, Map, MapError, MapOptions, MaskOptions};
use crate::network::StreetClass;
use crate::space::{Seed, line_length, signed_area};
use glam::DVec2;
use std::collections::BTreeMap;

/// A picture that is drawn on.
struct Canvas {
    size: (usize, usize),
    colours: Vec<[u8; 3]>,
}

const BLUE: [u8; 3] = [0, 0, 255];
const RED: [u8; 3] = [255, 0, 0];

impl Canvas {
    fn new(width: usize, height: usize) -> Self {
        Self { size: (width, height), colours: vec![[255; 3]; width * height] }
    }

    fn paint(&mut self, colour: [u8; 3], is_in: impl Fn(DVec2) -> bool) {
        for (i, c) in self.colours.iter_mut().enumerate() {
            let p = DVec2::new((i % self.size.0) as f64 + 0.5, (i / self.size.0) as f64 + 0.5);
            if is_in(p) {
                *c = colour;
            }
        }
    }

    fn road(&mut self, line: &[(f64, f64)], width: f64) {
        let line: Vec<DVec2> = line.iter().map(|p| DVec2::from(*p)).collect();
        self.paint(BLUE, |p| crate::space::distance_to_line(p, &line) <= width / 2.0);
    }

    fn rectangle(&mut self, colour: [u8; 3], from: (f64, f64), to: (f64, f64)) {
        self.paint(colour, |p| p.cmpge(from.into()).all() && p.cmple(to.into()).all());
    }

    fn png(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let mut encoder = png::Encoder::new(&mut out, self.size.0 as u32, self.size.1 as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().expect("a header");
        writer.write_image_data(self.colours.as_flattened()).expect("pixels");
        drop(writer);
        out
    }
}

fn options() -> MapOptions {
    MapOptions { mask: MaskOptions { metres_per_pixel: Some(0.5), ..MaskOptions::default() }, ..MapOptions::default() }
}

fn read(canvas: &Canvas) -> Result<Map, MapError> {
    Map::parse("mask.png", &canvas.png(), &options())
}

/// Places where so many streets meet, sorted.
fn junctions(map: &Map, degree: u32) -> Vec<DVec2> {
    let degrees = map.degrees();
    let mut out: Vec<DVec2> = map.nodes.iter().zip(degrees).filter(|(_, d)| *d == degree).map(|(n, _)| n.at).collect();
    out.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    out
}

fn near(found: &[DVec2], expected: &[(f64, f64)], off: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for p in expected {
        assert!(found.iter().any(|q| q.distance(DVec2::from(*p)) < off), "{p:?} is not among {found:?}");
    }
}

#[test]
fn a_crossing_a_tee_and_an_end_are_found_in_their_places() {
    let mut canvas = Canvas::new(400, 300);
    canvas.road(&[(0.0, 100.0), (400.0, 100.0)], 9.0);
    canvas.road(&[(100.0, 0.0), (100.0, 300.0)], 9.0);
    canvas.road(&[(250.0, 100.0), (250.0, 220.0)], 9.0);
    let map = read(&canvas).unwrap();
    // Half a metre per pixel around the middle, north up.
    near(&junctions(&map, 4), &[(-50.0, 25.0)], 1.0);
    near(&junctions(&map, 3), &[(25.0, 25.0)], 1.0);
    near(&junctions(&map, 1), &[(-100.0, 25.0), (100.0, 25.0), (-50.0, 75.0), (-50.0, -75.0), (25.0, -35.0)], 2.5);
    assert!((map.report.length_inside - (200.0 + 150.0 + 60.0)).abs() < 8.0, "{:?}", map.report);
    assert!(map.streets.iter().all(|s| (s.tags.width - 4.5).abs() < 0.8 && s.tags.class == StreetClass::Local));
    assert_eq!((map.projection, map.stated_bounds.map(|b| b.size())), (None, Some(DVec2::new(200.0, 150.0))));
    assert_eq!(map.network().streets.len(), 6);
}

#[test]
fn a_wide_road_is_a_main_street_and_a_bend_is_a_point() {
    let mut canvas = Canvas::new(300, 300);
    canvas.road(&[(20.0, 250.0), (280.0, 250.0)], 8.0);
    canvas.road(&[(150.0, 250.0), (150.0, 60.0), (40.0, 60.0)], 8.0);
    canvas.road(&[(20.0, 150.0), (280.0, 150.0)], 22.0);
    let map = read(&canvas).unwrap();
    let wide: Vec<_> = map.streets.iter().filter(|s| s.tags.class == StreetClass::Main).collect();
    assert_eq!((wide.len(), wide.iter().all(|s| (s.tags.width - 11.0).abs() < 1.5)), (2, true));
    // 40 m of it go west, the others south.
    let bend = DVec2::new(0.0, 45.0);
    assert!(map.nodes.iter().any(|n| n.at.distance(bend) < 1.5), "{:?}", map.nodes);
}

#[test]
fn buildings_keep_their_corners_and_courtyards() {
    let mut canvas = Canvas::new(200, 200);
    canvas.road(&[(0.0, 180.0), (200.0, 180.0)], 7.0);
    canvas.rectangle(RED, (20.0, 20.0), (120.0, 100.0));
    canvas.rectangle([255; 3], (50.0, 40.0), (90.0, 70.0));
    canvas.rectangle(RED, (150.0, 20.0), (152.0, 22.0));
    let map = read(&canvas).unwrap();
    let [house] = &map.buildings[..] else { panic!("{:?}", map.buildings) };
    assert_eq!((house.outline.len(), house.holes.len(), house.holes[0].len()), (4, 1, 4));
    assert!((signed_area(&house.outline) - 50.0 * 40.0).abs() < 1.0 && signed_area(&house.holes[0]) < 0.0);
    assert_eq!(map.report.left_out[&LeftOut::Speck], 1);
}

#[test]
fn a_drawn_grid_keeps_its_junctions_through_jpeg_like_noise() {
    let mut s = Seed(3).stream("test", &[]);
    let mut canvas = Canvas::new(420, 420);
    for k in 0..4 {
        let at = 60.0 + 100.0 * f64::from(k);
        canvas.road(&[(0.0, at), (420.0, at + 10.0)], 8.0);
        canvas.road(&[(at, 0.0), (at - 10.0, 420.0)], 8.0);
    }
    for colour in &mut canvas.colours {
        *colour = colour.map(|c| (f64::from(c) + 40.0 * s.signed()).clamp(0.0, 255.0) as u8);
    }
    let map = read(&canvas).unwrap();
    assert_eq!(junctions(&map, 4).len(), 16);
    let length: f64 = map.streets.iter().map(|s| line_length(&map.line(s))).sum();
    assert!((length - 8.0 * 210.0).abs() < 40.0, "{length}");
}

#[test]
fn other_colours_can_be_set_and_a_ring_is_a_street() {
    let mut canvas = Canvas::new(200, 200);
    canvas.colours.fill([0; 3]);
    canvas.paint([250, 250, 90], |p| (p.distance(DVec2::splat(100.0)) - 60.0).abs() < 4.0);
    let mask = MaskOptions { metres_per_pixel: Some(1.0), roads: [255, 255, 80], ..MaskOptions::default() };
    let options = MapOptions { mask, ..MapOptions::default() };
    let map = Map::parse("ring.png", &canvas.png(), &options).unwrap();
    let around = std::f64::consts::TAU * 60.0;
    assert!((map.report.length_inside - around).abs() < 12.0, "{:?}", map.report);
    assert!(read(&canvas).unwrap_err().to_string().contains("#0000ff"));
}

#[test]
fn what_is_no_mask_is_refused_with_what_was_found() {
    let mut s = Seed(9).stream("test", &[]);
    let mut photo = Canvas::new(120, 90);
    photo.colours.iter_mut().for_each(|c| *c = [0; 3].map(|_: u8| s.index(256) as u8));
    let said = |r: Result<Map, MapError>| r.unwrap_err().to_string();
    let photo = said(read(&photo));
    assert!(photo.starts_with("mask.png: not a road mask: only ") && photo.contains("a photo?"), "{photo}");
    assert!(photo.contains("#0000ff") && photo.contains("its colours: #"), "{photo}");
    let white = said(read(&Canvas::new(50, 50)));
    assert!(white.contains("no pixel has the colour of roads, #0000ff (its colours: #ffffff 100 %)"), "{white}");
    let mut blue = Canvas::new(50, 50);
    blue.colours.fill(BLUE);
    assert!(said(read(&blue)).contains("100 % of its pixels are road"));
    let mut road = Canvas::new(90, 90);
    road.road(&[(0.0, 40.0), (90.0, 40.0)], 8.0);
    let without = Map::parse("mask.png", &road.png(), &MapOptions::default());
    assert!(said(without).contains("needs the size of its pixels"));
    let mask = MaskOptions { circle: 1.0, ..options().mask };
    let wrong = Map::parse("mask.png", &road.png(), &MapOptions { mask, ..options() });
    assert!(said(wrong).contains("`circle` is 1; allowed is 2 to 50"));
    let cut = road.png();
    let broken = Map::parse("mask.png", &cut[..cut.len() / 2], &options());
    assert!(said(broken).contains("not a readable PNG"));
    assert!(said(Map::parse("mask.png", b"<osm>", &options())).contains("not a readable PNG"));
}

#[test]
fn random_masks_are_read_or_refused() {
    for seed in 0..60 {
        let mut s = Seed(seed).stream("test", &[]);
        let mut canvas = Canvas::new(20 + s.index(120), 20 + s.index(120));
        let size = DVec2::new(canvas.size.0 as f64, canvas.size.1 as f64);
        for _ in 0..s.index(7) {
            let line: Vec<(f64, f64)> =
                (0..2 + s.index(3)).map(|_| (s.range(-9.0, size.x), s.range(-9.0, size.y))).collect();
            canvas.road(&line, s.range(1.0, 14.0));
        }
        for _ in 0..s.index(4) {
            let from = (s.range(0.0, size.x), s.range(0.0, size.y));
            canvas.rectangle(RED, from, (from.0 + s.range(1.0, 30.0), from.1 + s.range(1.0, 30.0)));
        }
        let Ok(map) = read(&canvas) else { continue };
        let mut degrees: BTreeMap<u32, usize> = BTreeMap::new();
        map.degrees().iter().for_each(|d| *degrees.entry(*d).or_default() += 1);
        let box_of = map.stated_bounds.expect("that of the picture").grown(4.0);
        assert!(map.nodes.iter().all(|n| box_of.contains(n.at)), "seed {seed}");
        assert!(map.streets.iter().all(|s| s.tags.width >= 0.5), "seed {seed}: {degrees:?}");
    }
}
