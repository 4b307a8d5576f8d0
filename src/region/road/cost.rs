//! What a road costs: slopes, vegetation, water and bends (Galin 2011, section 4.1), in metres of flat open ground.

use super::lattice::{DIRECTIONS, STENCIL};
use super::samples::Ground;
use super::tier_settings::TierSettings;
use glam::DVec2;

/// Least cost of a road per metre, however much an influence attracts it.
pub(super) const LEAST_COST: f64 = 0.2;

/// Cost per metre of a straight stretch of road, `length` metres long, over dry ground between two points. `None` where the
/// stretch is too steep. The cost is at least 1, so that a road never costs less than its length.
pub(super) fn cost_per_metre(a: Ground, b: Ground, length: f64, t: &TierSettings) -> Option<f64> {
    let slope = f64::from((a.surface - b.surface).abs()) / length;
    if slope > t.slope_limit {
        return None;
    }
    let steep = slope / t.slope_limit;
    let wood = f64::from(a.vegetation + b.vegetation) / 2.0;
    Some(1.0 + t.slope * steep * steep + t.vegetation * wood)
}

/// Cost per metre of a straight stretch between nodes of the coarse lattice, on land or over water, and the share of the
/// stretch that is a bridge. `None` where roads of the class may not run.
pub(super) fn cost_over_water(a: Ground, b: Ground, length: f64, t: &TierSettings) -> Option<(f64, f64)> {
    let depth = f64::from(a.depth.max(b.depth));
    if depth > t.depth_limit {
        return None;
    }
    let ends = f64::from(u8::from(a.depth > 0.0) + u8::from(b.depth > 0.0)) / 2.0;
    let water = if ends > 0.0 { t.water * ends * (1.0 + depth / t.depth_limit) } else { 0.0 };
    Some((cost_per_metre(a, b, length, t)? + water, ends))
}

/// For each heading, the headings that a road may take next, with the cost of the bend. The cost is quadratic in the angle.
/// A bend is allowed if its rounded corner keeps the least radius of the class.
pub(super) fn bends(t: &TierSettings, step: i64) -> [Vec<(usize, f32)>; DIRECTIONS] {
    std::array::from_fn(|from| {
        let allowed = |to: usize| {
            let apart = (to + DIRECTIONS - from) % DIRECTIONS;
            let bend = apart.min(DIRECTIONS - apart);
            let fits =
                bend <= 1 || corner_radius(STENCIL[from].as_dvec2(), STENCIL[to].as_dvec2()) * step as f64 >= t.radius;
            (bend < DIRECTIONS / 2 && fits).then_some((to, (t.turn * (bend * bend) as f64) as f32))
        };
        (0..DIRECTIONS).filter_map(allowed).collect()
    })
}

/// Least radius of the parabola that rounds the corner from a side `a` to a side `b`. The parabola is tangent to both sides
/// at the same distance from the corner: half the length of the shorter side.
pub(super) fn corner_radius(a: DVec2, b: DVec2) -> f64 {
    let (long, short) = (a.length(), b.length());
    let cosine = (a.dot(b) / (long * short)).clamp(-1.0, 1.0);
    // Half-angle formulas, without trigonometry.
    let (cos2, sin) = ((1.0 + cosine) / 2.0, ((1.0 - cosine) / 2.0).sqrt());
    if sin > 0.0 { long.min(short) / 2.0 * cos2 / sin } else { f64::INFINITY }
}

/// The compact kernel of control primitives: 1 at distance 0, decreasing smoothly to 0 at `radius`. Galin 2011, section 4.1,
/// prints 1 - (r^2/R^2)^2. This is (1 - r^2/R^2)^2 instead, which has no corner at R.
pub(super) fn kernel(distance: f64, radius: f64) -> f64 {
    let x = distance / radius;
    if x >= 1.0 { 0.0 } else { (1.0 - x * x) * (1.0 - x * x) }
}

#[cfg(test)]
mod tests {
    use super::super::settings::RoadSettings;
    use super::*;

    #[test]
    fn roads_cost_at_least_their_length_and_avoid_what_they_should() {
        let t = TierSettings::minor();
        let flat = Ground { surface: 10.0, depth: 0.0, vegetation: 0.0 };
        assert_eq!(cost_per_metre(flat, flat, 128.0, &t), Some(1.0));
        let hill = Ground { surface: 15.0, ..flat };
        let higher = Ground { surface: 20.0, ..flat };
        let cost = |b| cost_per_metre(flat, b, 128.0, &t).unwrap() - 1.0;
        assert!((cost(higher) / cost(hill) - 4.0).abs() < 1e-9);
        assert_eq!(cost_per_metre(flat, Ground { surface: 200.0, ..flat }, 128.0, &t), None);
        assert_eq!(cost_over_water(flat, Ground { depth: 100.0, ..flat }, 128.0, &t), None);
        assert!(cost_over_water(flat, Ground { depth: 1.0, ..flat }, 128.0, &t).unwrap().1 > 0.0);
    }

    #[test]
    fn bends_keep_the_least_radius() {
        let settings = RoadSettings::default();
        for (t, range) in [(&settings.highway, 3..=5), (&settings.major, 3..=5), (&settings.minor, 7..=9)] {
            let counts = bends(t, 128).map(|b| b.len());
            assert!(counts.iter().all(|n| range.contains(n)), "{counts:?}");
        }
        // A quarter circle of chords has about the circle's radius.
        let (a, b) = (DVec2::new(8.0, 0.0), crate::space::math::direction(0.1) * 8.0);
        assert!((corner_radius(a, b) - 80.0).abs() < 1.0);
    }
}
