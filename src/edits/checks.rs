//! Checks that edits share.

use crate::layer::RangeError;
use crate::network::StreetClass;
use glam::DVec2;

/// Extra cost per metre that influences may have.
pub const STRENGTHS: (f64, f64) = (-10.0, 100.0);
/// Coordinates may be this far from 0, in metres.
const FARTHEST: f64 = 1e10;

pub(super) fn number(field: &str, value: f64, (low, high): (f64, f64)) -> Result<(), String> {
    RangeError::check(field, value, low, high).map_err(|e| e.to_string())
}

pub(super) fn place(field: &str, p: DVec2) -> Result<(), String> {
    [("x", p.x), ("y", p.y)]
        .into_iter()
        .try_for_each(|(axis, v)| number(&format!("{field}.{axis}"), v, (-FARTHEST, FARTHEST)))
}

/// Points of a line, of which no two neighbours are the same.
pub(super) fn points(field: &str, line: &[DVec2], (least, most): (usize, usize)) -> Result<(), String> {
    let count = line.len();
    if !(least..=most).contains(&count) {
        return Err(format!("{field} has {count} points; allowed is {least} to {most}"));
    }
    line.iter().enumerate().try_for_each(|(i, p)| place(&format!("{field}[{i}]"), *p))?;
    match line.windows(2).position(|w| w[0] == w[1]) {
        Some(i) => Err(format!("{field}[{}] is the point before again", i + 1)),
        None => Ok(()),
    }
}

/// Fails if a class is not one of roads.
pub(super) fn road_classes(classes: &[StreetClass]) -> Result<(), String> {
    match classes.iter().find(|c| !c.is_link()) {
        Some(class) => Err(format!("classes holds {class:?}; allowed are Highway, Major, Minor")),
        None => Ok(()),
    }
}
