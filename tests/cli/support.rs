//! Running the program, and files for it.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

pub fn sprawl(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sprawl")).args(arguments).output().expect("the program starts")
}

/// stdout of a run that must succeed.
pub fn out(arguments: &[&str]) -> String {
    let output = sprawl(arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    assert!(errors.is_empty(), "{arguments:?} is not quiet: {errors}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

pub fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&out(&[arguments, &["--json"]].concat())).expect("one JSON object")
}

/// The only line on stderr of a run that must be refused.
pub fn refused(arguments: &[&str]) -> String {
    let output = sprawl(arguments);
    let line = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {line}");
    assert_eq!(line.lines().count(), 1, "{arguments:?}: {line}");
    line
}

/// A file in a folder of this test run.
pub fn file(name: &str, content: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    if !content.is_empty() {
        std::fs::write(&path, content).expect("the folder can be written");
    }
    path
}

/// `x,y` of the city of seed 5 that is nearest to the origin.
pub fn city() -> &'static str {
    static PLACE: OnceLock<String> = OnceLock::new();
    PLACE.get_or_init(|| {
        let found = json(&["settlements", "--seed", "5", "--size", "32000"]);
        let cities = found["settlements"].as_array().expect("a list").iter().filter(|s| s["sigma"] == 2);
        let at = |s: &Value| (s["x"].as_f64().expect("a number"), s["y"].as_f64().expect("a number"));
        let square = |(x, y): (f64, f64)| x * x + y * y;
        let nearest = cities.map(at).min_by(|a, b| square(*a).total_cmp(&square(*b)));
        let (x, y) = nearest.expect("a city within 16 km");
        format!("{x},{y}")
    })
}

/// Hills with a bay in the east, 60 by 40 cells of 250 m, and a CSV file of settlements; their paths.
pub fn country(name: &str, settlements: &str) -> [String; 2] {
    let height = |x: i32, y: i32| {
        30 + (x * 7 + y * 3) % 19 + 2 * ((x - 30) * (y - 20) / 40) - if x > 50 && y < 25 { 200 } else { 0 }
    };
    let rows: Vec<String> =
        (0..40).rev().map(|y| (0..60).map(|x| height(x, y).to_string()).collect::<Vec<_>>().join(" ")).collect();
    let head = "ncols 60\nnrows 40\nxllcorner 1000\nyllcorner -2000\ncellsize 250\n";
    let grid = file(&format!("{name}.asc"), &format!("{head}{}\n", rows.join("\n")));
    let table = file(&format!("{name}.csv"), settlements);
    [grid, table].map(|p| p.to_string_lossy().into_owned())
}

pub const TOWNS: &str = "name,x,y,sigma\nEastcliff,13000,0,1\nWestham,2500,1000,2\nNorth Combe,6000,7000,0\nMid Lee,7000,2200,2\n\
    Sandy,12500,6500,0\nFar Lee,4000,4600,0\n";

/// A road mask of 200 by 200 pixels: a crossing, and a building beside it.
pub fn road_mask(name: &str) -> String {
    let path = file(name, "");
    let mut encoder = png::Encoder::new(std::fs::File::create(&path).expect("a file"), 200, 200);
    encoder.set_color(png::ColorType::Rgb);
    let colour = |(x, y): (i32, i32)| match () {
        () if (x - 100).abs() < 5 || (y - 100).abs() < 5 => [0, 0, 255],
        () if (120..160).contains(&x) && (120..150).contains(&y) => [255, 0, 0],
        () => [255, 255, 255],
    };
    let pixels: Vec<u8> = (0..200).flat_map(|y| (0..200).map(move |x| (x, y))).flat_map(colour).collect();
    encoder.write_header().and_then(|mut w| w.write_image_data(&pixels)).expect("a picture");
    path.to_string_lossy().into_owned()
}
