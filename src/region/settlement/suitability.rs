//! How well the ground at a place suits a settlement.

use super::radii::even_out;
use super::ray::{Detail, LEAST_REACH, Ray};
use crate::space::math;
use crate::terrain::Scan;
use glam::DVec2;
use std::f64::consts::TAU;

/// Distance in metres between the rays that a place is judged by, measured at its radius, and the least and greatest
/// number of rays.
const RAY_SPACING: f64 = 120.0;
const RAYS: (usize, usize) = (10, 12);
/// Least share of its circle that a settlement fills.
const LEAST_AREA: f64 = 0.42;

/// A quick rating of a place from a few samples: greater is better. `None` where no settlement can stand.
pub(super) fn promise(
    ground: &mut Scan<'_>,
    centre: DVec2,
    radius: f64,
    max_slope: f64,
    max_height: f64,
) -> Option<f64> {
    let middle = ground(centre);
    if middle.depth() > 0.0 || middle.height > max_height {
        return None;
    }
    let (mut slope, mut inner, mut outer) = (0.0, 0, 0);
    for i in 0..10 {
        // Two rings of five samples.
        let distance = radius * if i % 2 == 0 { 0.4 } else { 0.85 };
        let s = ground(centre + math::direction(f64::from(i) / 10.0 * TAU) * distance);
        slope += (s.height.max(s.water_level) - middle.height).abs() / distance / 10.0;
        *(if i % 2 == 0 { &mut inner } else { &mut outer }) += i32::from(s.depth() > 0.0);
    }
    // A waterfront is worth something, water all around is not.
    let shore = if outer <= 2 { 0.2 * f64::from(outer) } else { 0.0 };
    let high = middle.height.max(0.0) / max_height.max(1.0);
    Some(shore - slope / max_slope - 0.6 * f64::from(inner) - 0.25 * f64::from(outer.max(2) - 2) - 0.5 * high)
}

/// The mean slope of the ground around a place, if a settlement of `radius` finds enough ground there and the ground is not
/// too steep.
pub(super) fn mean_slope(ground: &mut Scan<'_>, centre: DVec2, radius: f64, max_slope: f64) -> Option<f64> {
    let rays = ((TAU * radius / RAY_SPACING) as usize).clamp(RAYS.0, RAYS.1);
    let (mut reach, mut climb, mut length) = (vec![0.0; rays], 0.0, 0.0);
    for (i, reach) in reach.iter_mut().enumerate() {
        let direction = math::direction(i as f64 / rays as f64 * TAU);
        let ray = Ray { centre, direction, from: 0.0, limit: radius, detail: Detail::Near };
        let found = ray.cast(ground, max_slope);
        if found.reach < LEAST_REACH {
            return None;
        }
        *reach = found.reach;
        climb += found.climb;
        length += found.reach;
    }
    even_out(&mut reach);
    let area = reach.iter().map(|r| r * r).sum::<f64>() / (radius * radius * rays as f64);
    (area >= LEAST_AREA && climb <= max_slope * length).then(|| climb / length)
}
