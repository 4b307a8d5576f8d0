//! PatchCity's own job (Bustard and de Valmency 2015): squares made of windows, by area and by the number of windows. Times are of
//! one thread, for choosing tiles, joining their streets and repair, without cutting windows; the best of several rounds.
//!
//! The authors' program chooses patches for about 83 km2 in a second.

mod clock;

use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::StreetClass;
use bevy_sprawl::patch::{Line, Patch, PatchDrawing, WindowDrawing};
use bevy_sprawl::space::Seed;
use bevy_sprawl::streets::{TileTable, synthesize};
use std::sync::Arc;

/// Edge of a window, and how far beyond it streets are drawn, in metres.
const WINDOW: f64 = 200.0;
const MARGIN: f64 = 20.0;
/// Edge of the map that windows are cut out of, in metres.
const MAP: f64 = 8000.0;
/// What is to be made in a second at least, in square kilometres.
const BAR: f64 = 100.0;

/// The places of the streets of a map along one axis: 40 to 110 m apart, every fifth a main street.
fn streets(axis: u64) -> Vec<(f64, StreetClass)> {
    let mut rng = Seed(7).stream("map", &[axis]);
    let mut at = 0.0;
    let mut out = Vec::new();
    while at < MAP {
        at += rng.range(40.0, 110.0);
        out.push((at, if out.len() % 5 == 0 { StreetClass::Main } else { StreetClass::Local }));
    }
    out
}

/// A window of the map at a place.
fn window(
    number: usize,
    middle: (f64, f64),
    across: &[(f64, StreetClass)],
    along: &[(f64, StreetClass)],
) -> Arc<Patch> {
    let half = WINDOW / 2.0 + MARGIN;
    let within = |streets: &[(f64, StreetClass)], middle: f64| -> Vec<(f64, StreetClass)> {
        let inside = streets.iter().map(|(at, class)| (at - middle, *class));
        inside.filter(|(at, _)| at.abs() < half - 1.0).collect()
    };
    let (columns, rows) = (within(across, middle.0), within(along, middle.1));
    let (w, h) = (columns.len() as i64, rows.len() as i64);
    // Crossings, then the ends of columns, then those of rows.
    let mut vertices: Vec<(f64, f64)> = rows.iter().flat_map(|y| columns.iter().map(move |x| (x.0, y.0))).collect();
    vertices.extend(columns.iter().flat_map(|x| [(x.0, -half), (x.0, half)]));
    vertices.extend(rows.iter().flat_map(|y| [(-half, y.0), (half, y.0)]));
    let line = |first: i64, inner: Vec<i64>| Line([vec![first], inner, vec![first + 1]].concat());
    let mut streets: Vec<Line> = (0..w).map(|x| line(w * h + 2 * x, (0..h).map(|y| y * w + x).collect())).collect();
    streets.extend((0..h).map(|y| line(w * h + 2 * w + 2 * y, (0..w).map(|x| y * w + x).collect())));
    let window = WindowDrawing {
        size: WINDOW,
        margin: MARGIN,
        map: "drawn".into(),
        at: middle,
        turned_deg: 0.0,
        buildings: Vec::new(),
    };
    let drawing = PatchDrawing {
        name: number.to_string(),
        vertices,
        streets,
        main: Vec::new(),
        classes: columns.iter().chain(&rows).map(|(_, class)| *class).collect(),
        dead_ends: Vec::new(),
        tags: Vec::new(),
        weight: 1.0,
        at_most: None,
        window: Some(window),
    };
    Arc::new(Patch::of(drawing).expect("the drawing is sound"))
}

/// A table of so many windows of the map.
fn table(count: usize) -> TileTable {
    let (across, along) = (streets(0), streets(1));
    let mut rng = Seed(8).stream("windows", &[]);
    let mut place = || rng.range(WINDOW, MAP - WINDOW).round();
    let windows: Vec<Arc<Patch>> =
        (0..count).map(|number| window(number, (place(), place()), &across, &along)).collect();
    TileTable::new(windows.iter().map(|patch| (patch, Arc::from(patch.name.as_str()))), false)
}

/// Square kilometres in a second.
fn speed(table: &TileTable, size: f64, rounds: u64) -> f64 {
    let km2 = size * size / 1e6;
    let make = |round: u64| {
        let (time, made) =
            clock::timed(|| synthesize(table, size, 500.0, Seed(round), &Cancel::new()).expect("nobody cancels"));
        assert_eq!((made.components, made.mismatched_seams), (1, 0), "{size} m");
        time.as_secs_f64()
    };
    km2 / (0..rounds).map(make).fold(f64::INFINITY, f64::min)
}

fn main() {
    let usual = table(2000);
    println!("km2     km2/s  (2000 windows; the bar is {BAR} km2/s, the authors' choice of patches alone 83)");
    for size in [2000.0, 4000.0, 8000.0, 16_000.0] {
        let speed = speed(&usual, size, 3);
        println!("{:>4} {speed:>9.0}", size * size / 1e6);
        assert!(speed > BAR, "{speed:.0} km2/s");
    }
    println!("\nwindows   km2/s  (16 km2)");
    for count in [200, 2000, 20_000] {
        let speed = speed(&table(count), 4000.0, 3);
        println!("{count:>7} {speed:>7.0}");
        assert!(speed > BAR, "{count} windows: {speed:.0} km2/s");
    }
}
