//! What the ground around a place allows a settlement: how far it can spread in each direction.

use crate::region::outline::smooth;
use crate::space::math;
use crate::terrain::Scan;
use glam::DVec2;
use std::f64::consts::TAU;

/// Dry ground kept between a settlement and water, in metres.
pub(in crate::region) const SHORE: f64 = 25.0;
/// Least reach of a settlement in every direction, in metres.
pub(in crate::region) const LEAST_REACH: f64 = 105.0;
/// Step along a ray over low ground, where a narrow river may lie, and least and greatest over ground well above the
/// water.
const STEPS: (f64, f64, f64) = (18.0, 36.0, 90.0);
/// Step over ground well above the water, in heights above it.
const STEP_BY_HEIGHT: f64 = 3.0;
/// Height above the water from which ground counts as well above it.
const HIGH: f64 = 9.0;
/// Ground lower than this above its water may be a bank: there a ray is searched in finer steps.
const BANK: (f64, f64) = (1.4, 5.0);
/// Length over which a slope is measured.
const SLOPE_LENGTH: f64 = 40.0;
/// Distance in metres between the rays that a place is judged by, at its radius, and how many they are.
const RAY_SPACING: f64 = 120.0;
const RAYS: (usize, usize) = (10, 12);
/// Distance from a place within which it is judged as finely as outlines are made; beyond it with steps so much longer.
const JUDGED: (f64, f64) = (130.0, 3.0);
/// Share of its circle that a settlement fills at least.
const LEAST_AREA: f64 = 0.42;
/// A settlement ends where the ground is this many times steeper than its mean slope may be.
const STEEP: f64 = 3.0;

/// How far a settlement can go in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::region) struct Ray {
    /// Metres to the end: the limit, the shore, or the foot of steep ground.
    pub reach: f64,
    /// Whether water ends it.
    pub wet: bool,
    /// Sum of rise and fall on the way, in metres.
    pub climb: f64,
}

/// Where a ray leads from.
#[derive(Clone, Copy, Debug)]
pub(in crate::region) struct Course {
    /// Plan metres, on land.
    pub centre: DVec2,
    /// Unit direction.
    pub way: DVec2,
    /// Distance from the centre at which the ray begins.
    pub from: f64,
    /// Greatest distance from the centre.
    pub limit: f64,
    /// Distance up to which no narrow river is stepped over.
    pub fine: f64,
}

/// Follows a course until its limit, water, or slopes above three times `max_slope`. Neither its beginning nor what lies
/// before it is looked at.
pub(in crate::region) fn ray(ground: &mut Scan<'_>, course: Course, max_slope: f64) -> Ray {
    let mut at = |along: f64| ground(course.centre + course.way * along);
    let start = at(course.from);
    let (mut along, mut last, mut climb) = (course.from, start, 0.0);
    let mut mark = (course.from, start.height);
    let mut end = course.limit;
    // A shore just beyond the end still keeps its distance.
    while along < end + SHORE {
        let above = last.height - last.water_level;
        let (fine, longer) = if along < course.fine { (true, 1.0) } else { (false, JUDGED.1) };
        let step = if above > HIGH { (above * STEP_BY_HEIGHT).clamp(STEPS.1, STEPS.2) } else { STEPS.0 };
        let next = along + step * longer;
        let here = at(next);
        let mut wet = (here.depth() > 0.0).then_some(next);
        if fine && wet.is_none() && above.min(here.height - here.water_level) < BANK.0 {
            let finer = (1..(STEPS.1 / BANK.1) as usize).map(|i| along + i as f64 * BANK.1);
            wet = finer.take_while(|d| *d < next).find(|d| at(*d).depth() > 0.0);
        }
        if let Some(mut wet) = wet {
            // The water's edge between the last dry step and this one.
            let mut dry = along;
            while wet - dry > 1.0 {
                let middle = (dry + wet) / 2.0;
                if at(middle).depth() > 0.0 { wet = middle } else { dry = middle }
            }
            return Ray { reach: end.min((dry - SHORE).max(0.0)), wet: true, climb };
        }
        if next - mark.0 >= SLOPE_LENGTH && next < end {
            if (here.height - mark.1).abs() > STEEP * max_slope * (next - mark.0) {
                end = mark.0;
            }
            mark = (next, here.height);
        }
        climb += (here.height - last.height).abs();
        (along, last) = (next, here);
    }
    Ray { reach: end, wet: false, climb }
}

/// How promising a place looks from a few samples: greater is better; `None` where a settlement cannot be.
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
        // Two rings of five.
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

/// The mean slope of the ground around a place, if a settlement of a radius finds enough ground there, and none of it too
/// steep.
pub(super) fn suits(ground: &mut Scan<'_>, centre: DVec2, radius: f64, max_slope: f64) -> Option<f64> {
    let rays = ((TAU * radius / RAY_SPACING) as usize).clamp(RAYS.0, RAYS.1);
    let (mut reach, mut climb, mut length) = (vec![0.0; rays], 0.0, 0.0);
    for (i, reach) in reach.iter_mut().enumerate() {
        let way = math::direction(i as f64 / rays as f64 * TAU);
        let course = Course { centre, way, from: 0.0, limit: radius, fine: JUDGED.0 };
        let ray = ray(ground, course, max_slope);
        if ray.reach < LEAST_REACH {
            return None;
        }
        *reach = ray.reach;
        climb += ray.climb;
        length += ray.reach;
    }
    smooth(&mut reach);
    let area = reach.iter().map(|r| r * r).sum::<f64>() / (radius * radius * rays as f64);
    (area >= LEAST_AREA && climb <= max_slope * length).then(|| climb / length)
}
