//! Footprints: where a building stands on its lot, and how high it is.

use crate::parcel::convex::{HalfPlane, chord, clip, sides, without_quadrant};
use crate::parcel::lots::LotShape;
use crate::space::{Bounds, Stream, quantize, signed_area};
use crate::style::ParcelRules;
use glam::DVec2;

/// Least area of a building, in square metres.
const MIN_AREA: f64 = 35.0;

/// Least distance (metres) from a building to the border of its lot: more than rounding can take away.
const CLEARANCE: f64 = 0.02;

/// Least width and depth of a wing behind a row house, in metres.
const WING: f64 = 5.0;
/// Depth that a wing leaves free at the back of the lot, in metres.
const YARD: f64 = 3.5;

/// Buildings closer than this (metres) to the sides of their lots count as a closed row.
const ROW: f64 = 0.6;

/// Height of the walls above the last storey, in metres.
pub(super) const PARAPET: f64 = 0.5;

/// Height of the uphill ground above the downhill ground, in metres, up to which the ground floor lies at the uphill ground.
const MOST_STEP: f64 = 2.0;

/// The ground plan of a building on a lot, counter-clockwise; `None` where too little room is left.
pub(super) fn footprint(lot: &LotShape, rules: &ParcelRules, rng: &mut Stream) -> Option<Vec<DVec2>> {
    let mut edges = sides(&lot.polygon);
    let front = edges.next()?.moved(rules.setback_front.max(CLEARANCE));
    let room = edges
        .map(|side| side.moved(rules.setback_side.max(CLEARANCE)))
        .fold(clip(&lot.polygon, front), |room, side| clip(&room, side));
    if room.is_empty() {
        return None;
    }
    let depth = (rules.building_depth * rng.range(0.82, 1.0)).max(4.0);
    let plan = if rules.setback_side < ROW {
        row_house(&room, front, lot, depth, rules.wings, rng)
    } else {
        let u = -front.normal.perp();
        let to_front = |p: &DVec2| DVec2::new((*p - front.at).dot(u), front.depth(*p));
        let local = house(&room.iter().map(to_front).collect::<Vec<_>>(), depth, rng)?;
        local.iter().map(|p| front.at + u * p.x + front.normal * p.y).collect()
    };
    let plan: Vec<DVec2> = plan.into_iter().map(quantize).collect();
    let size =
        Bounds::of(plan.iter().map(|p| DVec2::new((*p - front.at).dot(front.normal.perp()), front.depth(*p)))).size();
    (signed_area(&plan) >= MIN_AREA && size.min_element() >= 4.0).then_some(plan)
}

/// A building from side to side of the lot, along both streets at a corner. Away from corners a share `wings` has a wing behind.
fn row_house(room: &[DVec2], front: HalfPlane, lot: &LotShape, depth: f64, wings: f64, rng: &mut Stream) -> Vec<DVec2> {
    let back = front.moved(depth);
    if let Some(i) = lot.corner {
        let yard = HalfPlane::left_of(lot.polygon[i], lot.polygon[(i + 1) % lot.polygon.len()]).moved(depth);
        if let Some(plan) = without_quadrant(room, back, yard) {
            return plan;
        }
        // The lot is too small for a yard inside the corner.
        let deep = room.iter().map(|p| front.depth(*p)).fold(0.0, f64::max);
        if deep < 1.6 * depth {
            return room.to_vec();
        }
    }
    let winged = if lot.corner.is_none() && rng.chance(wings) { with_wing(room, front, depth, rng) } else { None };
    winged.unwrap_or_else(|| clip(room, back.flipped()))
}

/// A row house with a wing of random depth along one side of its yard; `None` where the yard is too small.
fn with_wing(room: &[DVec2], front: HalfPlane, depth: f64, rng: &mut Stream) -> Option<Vec<DVec2>> {
    let u = -front.normal.perp();
    let deep = room.iter().map(|p| front.depth(*p)).fold(0.0, f64::max) - YARD;
    let across = room.iter().map(|p| (*p - front.at).dot(u));
    let (left, right) = across.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, r), x| (l.min(x), r.max(x)));
    let width = rng.range(0.35, 0.5) * (right - left);
    let reach = depth + (deep - depth) * rng.range(0.5, 1.0);
    if width < WING || reach < depth + WING {
        return None;
    }
    let yard = if rng.chance(0.5) {
        HalfPlane { at: front.at + u * (left + width), normal: u }
    } else {
        HalfPlane { at: front.at + u * (right - width), normal: -u }
    };
    without_quadrant(&clip(room, front.moved(reach).flipped()), front.moved(depth), yard)
}

/// A free-standing house: a rectangle, sometimes an L. `room` has its x axis along the front, y into the lot.
fn house(room: &[DVec2], depth: f64, rng: &mut Stream) -> Option<Vec<DVec2>> {
    let start = room.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let mut best: Option<(f64, [f64; 4])> = None;
    for step in [0.0, 1.5, 4.0] {
        for share in [1.0, 0.85, 0.7, 0.55, 0.4] {
            let (low, high) = (start + step + 1e-3, start + step + depth * share);
            let (Some(a), Some(b)) = (chord(room, low), chord(room, high)) else { continue };
            let (left, right) = (a.0.max(b.0), a.1.min(b.1));
            let width = right - left;
            // A house much wider than twice its depth would be a bar.
            let area = width.min(depth * share * 2.2) * (high - low);
            if width > 4.0 && best.is_none_or(|(most, _)| area > most) {
                best = Some((area, [left, right, low, high]));
            }
        }
    }
    let (area, [left, right, low, high]) = best?;
    let (fit_width, fit_depth) = ((right - left).min((high - low) * 2.2), high - low);
    // Houses fill small lots, and leave a garden on large ones.
    let shrink =
        |rng: &mut Stream, size: f64| if area > 70.0 { (size * rng.range(0.68, 1.0)).max(7.0).min(size) } else { size };
    let (width, depth) = (shrink(rng, fit_width), shrink(rng, fit_depth));
    let x = left + (right - left - width) * (0.5 + 0.35 * rng.signed());
    let y = low + (fit_depth - depth) * 0.3 * rng.unit();
    let mut plan =
        vec![DVec2::new(x, y), DVec2::new(x + width, y), DVec2::new(x + width, y + depth), DVec2::new(x, y + depth)];
    if width > 10.0 && depth > 9.0 && rng.chance(0.4) {
        let (notch, cut) = (width * rng.range(0.35, 0.5), depth * rng.range(0.3, 0.45));
        if rng.chance(0.5) {
            plan[2].y -= cut;
            plan.insert(3, DVec2::new(x + width - notch, y + depth - cut));
            plan.insert(4, DVec2::new(x + width - notch, y + depth));
        } else {
            plan[3] = DVec2::new(x + notch, y + depth);
            plan.push(DVec2::new(x + notch, y + depth - cut));
            plan.push(DVec2::new(x, y + depth - cut));
        }
    }
    Some(plan)
}

/// Height of the ground floor above ground with these heights at the corners of a building, in metres.
pub(super) fn ground_floor(corners: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = corners.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
    // The ground floor is entered from the uphill side, unless that would bury it.
    high.min(low + MOST_STEP)
}

/// Number of storeys: more towards the centre, with some variance.
pub(super) fn storeys(rules: &ParcelRules, centrality: f64, rng: &mut Stream) -> u32 {
    let (least, most) = rules.storeys;
    let share = (centrality + 0.3 * rng.signed()).clamp(0.0, 1.0);
    (f64::from(least) + f64::from(most.saturating_sub(least)) * share).round().max(1.0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ground_floors_lie_uphill_unless_that_would_bury_them() {
        let floor = |corners: [f64; 3]| ground_floor(corners.into_iter());
        assert_eq!([floor([4.0, 4.0, 4.0]), floor([0.5, 1.0, 0.0]), floor([-3.0, 2.0, -1.0])], [4.0, 1.0, -1.0]);
    }
}
