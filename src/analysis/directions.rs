//! Figures of the directions of streets.

use crate::space::math::{angle_between, angle_of, ln};
use glam::DVec2;
use std::f64::consts::TAU;

/// Boeing's orientation order phi of directions, each taken both ways (36 bins): 1 for one perfect grid, 0 for no order and
/// without directions.
pub(super) fn orientation_order(directions: impl Iterator<Item = DVec2>) -> f64 {
    let mut bins = [0usize; 36];
    for direction in directions.flat_map(|d| [d, -d]) {
        let turns = (angle_of(direction) / TAU * 36.0 + 36.5).floor() as usize;
        bins[turns % 36] += 1;
    }
    let total = bins.iter().sum::<usize>() as f64;
    if total == 0.0 {
        return 0.0;
    }
    let shares = bins.iter().filter(|n| **n > 0).map(|n| *n as f64 / total);
    let entropy = shares.fold(0.0, |sum, p| sum - p * ln(p));
    let (grid, most) = (ln(4.0), ln(36.0));
    let disorder = (entropy - grid) / (most - grid);
    1.0 - disorder * disorder
}

/// Whether streets that leave a junction in these directions are three or more, and two of them less than 30 degrees apart.
pub(super) fn is_sharp(leaving: &[DVec2]) -> bool {
    let mut pairs = leaving.iter().enumerate().flat_map(|(i, a)| leaving[i + 1..].iter().map(move |b| (a, b)));
    leaving.len() >= 3 && pairs.any(|(a, b)| angle_between(*a, *b) < 30f64.to_radians())
}
