//! Rivers as level lines of smooth fields, so that every point finds the rivers nearby on its own.
//!
//! Main rivers are the lines where a warped coordinate `across` is a multiple of the spacing: these lines are open, not closed
//! loops. Half-way between two of them lies a watershed. Tributaries are such lines of a second coordinate. Tributaries on one bank
//! alternate with the tributaries on the other, and each gets narrower towards the watershed, where it rises.

#[cfg(test)]
use super::field::FreshCorners;
use super::field::{Corners, Octaves, Slots, round, weighted};
use crate::space::{Seed, math};
use glam::DVec2;

/// Slope of the banks.
const BANK_SLOPE: f64 = 0.2;
/// Height in metres above the water to which banks rise. Flood plains lie lower.
const BANK: f64 = 7.0;

/// A coordinate in metres that grows along a heading, warped by noise.
#[derive(Clone, Debug)]
struct WarpedCoordinate<const N: usize> {
    heading: DVec2,
    bends: Octaves<N>,
    weights: [f64; N],
}

impl<const N: usize> WarpedCoordinate<N> {
    fn new(seed: Seed, key: u64, heading: DVec2, spacing: f64, bends: [(f64, f64); N], slots: &mut Slots) -> Self {
        let octaves = std::array::from_fn(|i| (key + i as u64, bends[i].0 * spacing));
        Self { heading, bends: Octaves::new(seed, octaves, slots), weights: bends.map(|b| b.1 * spacing) }
    }

    fn at(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        p.dot(self.heading) + weighted(&self.bends.at(p, corners), &self.weights)
    }

    fn gradient(&self, p: DVec2, corners: &mut impl Corners) -> DVec2 {
        let slopes = self.bends.with_gradients(p, corners).1;
        self.heading + DVec2::from(slopes.map(|s| weighted(&s, &self.weights)))
    }

    /// Metres per unit of the coordinate at `p`, which turns a difference of values into a distance.
    fn metres(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        1.0 / self.gradient(p, corners).length().clamp(STEEPNESS.0, STEEPNESS.1)
    }
}

/// Bounds of the gradient of a coordinate, so that distant rivers are recognized by the value alone.
const STEEPNESS: (f64, f64) = (0.3, 3.0);

/// The influence of rivers on a point.
pub(super) struct RiverShape {
    /// Height of bed and banks above the water surface in metres; infinite if it is above [`BANK`].
    pub profile: f64,
    /// 0 on the flood plain of a river, 1 outside its valley.
    pub valley: f64,
    /// 0 at a main river, 1 on the watershed.
    pub watershed: f64,
    /// 0 near the water, 1 from a distance of about 1 km on.
    pub dry: f64,
}

/// All rivers of a world.
#[derive(Clone, Debug)]
pub(super) struct Rivers {
    across: WarpedCoordinate<5>,
    along: WarpedCoordinate<4>,
    breadth: Octaves<1>,
    spacing: f64,
    tributaries: f64,
    width: (f64, f64),
}

/// The difference of `x` and the nearest multiple of `spacing`.
fn offset(x: f64, spacing: f64) -> f64 {
    x - spacing * round(x / spacing)
}

/// Height of bed or bank above the water, in metres, `distance` metres from the middle of a river.
fn channel(distance: f64, width: f64, depth: f64) -> f64 {
    let half = width / 2.0;
    if distance < half {
        let x = distance / half;
        return depth * (x * x - 1.0);
    }
    (distance - half) * BANK_SLOPE
}

impl Rivers {
    pub fn new(seed: Seed, spacing: f64, width: (f64, f64), slots: &mut Slots) -> Self {
        let heading = math::direction(seed.stream("terrain", &[900]).range(0.0, std::f64::consts::TAU));
        let tributaries = spacing * 0.41;
        let bends = [(0.071, 0.010), (0.24, 0.045), (0.83, 0.17), (3.7, 0.75), (11.3, 2.2)];
        let side = [(0.13, 0.020), (0.41, 0.09), (1.9, 0.5), (7.9, 2.1)];
        let turned = math::rotate(heading, std::f64::consts::FRAC_PI_2 - 0.35);
        Self {
            across: WarpedCoordinate::new(seed, 910, heading, spacing, bends, slots),
            along: WarpedCoordinate::new(seed, 920, turned, tributaries, side, slots),
            breadth: Octaves::new(seed, [(901, spacing * 0.7)], slots),
            spacing,
            tributaries,
            width,
        }
    }

    /// A point on a main river near `p`, if the descent along the coordinate finds one.
    #[cfg(test)]
    pub fn course_near(&self, mut p: DVec2) -> Option<DVec2> {
        for _ in 0..60 {
            let g = self.across.gradient(p, &mut FreshCorners::new());
            let step =
                g * (-offset(self.across.at(p, &mut FreshCorners::new()), self.spacing) / g.length_squared().max(0.05));
            p += step.clamp_length_max(200.0);
        }
        (offset(self.across.at(p, &mut FreshCorners::new()), self.spacing).abs() < 0.1).then_some(p)
    }

    /// Direction of the main river at `p`.
    #[cfg(test)]
    pub fn direction(&self, p: DVec2) -> DVec2 {
        self.across.gradient(p, &mut FreshCorners::new()).perp().normalize()
    }

    /// Width of rivers near a point, 0 to 1: from the least to the greatest width allowed.
    fn breadth_at(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        0.5 + 0.7 * self.breadth.at(p, corners)[0].clamp(-0.7, 0.7)
    }

    /// The influence of rivers on the plan point `p`.
    pub fn at(&self, p: DVec2, corners: &mut impl Corners) -> RiverShape {
        let near = (self.width.1 / 2.0 + BANK / BANK_SLOPE) * STEEPNESS.1;
        let u = self.across.at(p, corners);
        let main = offset(u, self.spacing);
        let watershed = main.abs() * 2.0 / self.spacing;
        let middle = (self.width.0 * self.width.1).sqrt();
        let (mut profile, mut distance) = (f64::INFINITY, f64::INFINITY);
        if main.abs() < near {
            distance = main.abs() * self.across.metres(p, corners);
            let width = math::mix(middle, self.width.1, self.breadth_at(p, corners));
            profile = channel(distance, width, 1.5 + width * 0.06);
        }

        // Tributaries of both banks. Near the main river both are evaluated, and the tributary from the other bank ends in the
        // main river. Towards the watershed the water dries up first, then the floor of the valley rises.
        let v = self.along.at(p, corners);
        let dry = math::smoothstep(0.42, 0.56, watershed);
        let mut gully = 1.0;
        for (bank, phase) in [(1.0, 0.0), (-1.0, 0.5)] {
            let beyond = -main * bank;
            if beyond > 0.0 && main.abs() >= near {
                continue;
            }
            let side = offset(v + phase * self.tributaries, self.tributaries).abs();
            if beyond <= 0.0 {
                gully = math::smoothstep(near, 0.25 * self.tributaries, side);
            }
            if side < near && dry < 1.0 {
                let width = math::mix(self.width.0, middle, self.breadth_at(p, corners) * (1.0 - watershed));
                let depth = 1.0 + width * 0.05;
                let past = if beyond > 0.0 { distance * BANK_SLOPE } else { 0.0 };
                let lift = past + dry * (depth + BANK);
                profile = profile.min(channel(side * self.along.metres(p, corners), width, depth) + lift);
            }
        }
        let gully = math::mix(gully, 1.0, math::smoothstep(0.56, 0.85, watershed));
        let valley = math::smoothstep(near, 0.2 * self.spacing, main.abs()) * gully;
        let dry = math::smoothstep(0.0, 1500.0, main.abs() - near) * gully.sqrt();
        let profile = if profile < BANK { profile } else { f64::INFINITY };
        RiverShape { profile, valley, watershed, dry }
    }
}
