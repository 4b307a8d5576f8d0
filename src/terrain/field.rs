//! Smooth random fields over the endless plan: gradient noise that never repeats, and sums of its octaves.
//!
//! Written here and not taken from the `noise` crate, whose tables repeat every 256 cells, which gives no derivatives,
//! and whose 2-D gradient noise takes several times as long.

use crate::space::{Seed, math};
use glam::DVec2;

/// Makes the root mean square of an octave 0.3.
const SCALE: f64 = 1.73;

/// Multipliers of a lattice coordinate's bits. All 64 of them count, so no lattice ever repeats.
const MIX: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xC2B2_AE3D_27D4_EB4F];

/// The gradient at a corner of a lattice from its mixed coordinates, each component uniform in -1..1.
#[inline(always)]
fn corner(x: u64, y: u64) -> DVec2 {
    let h = x ^ y;
    let h = (h ^ (h >> 32)).wrapping_mul(0xD6E8_FEB8_6659_FD93);
    let h = (h ^ (h >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let component = |bits: u64| f64::from(bits as i32) * (1.0 / 2_147_483_648.0);
    DVec2::new(component(h >> 32), component(h >> 8))
}

/// `x` rounded down. `f64::floor` is a call into the math library on processors without an instruction for it.
#[inline]
fn floor(x: f64) -> i64 {
    let toward_zero = x as i64;
    toward_zero - i64::from(x < toward_zero as f64)
}

/// Where octaves take the gradients at the corners of their cells from.
pub(super) trait Corners {
    /// Gradients at the south-west, south-east, north-west and north-east corner of cell (x, y) of an octave.
    fn of(&mut self, seed: u64, x: i64, y: i64) -> [DVec2; 4];
}

/// Computes them.
pub(super) struct Fresh;

impl Corners for Fresh {
    #[inline(always)]
    fn of(&mut self, seed: u64, x: i64, y: i64) -> [DVec2; 4] {
        let (x, y) = ((x as u64).wrapping_mul(MIX[0]), (y as u64).wrapping_mul(MIX[1]));
        let (x1, y1) = (x.wrapping_add(MIX[0]), y.wrapping_add(MIX[1]) ^ seed);
        let y = y ^ seed;
        [corner(x, y), corner(x1, y), corner(x, y1), corner(x1, y1)]
    }
}

/// Remembers those of the cell that each octave was asked in last: points near each other mostly lie in the same cells.
pub(super) struct Remembered(Vec<Held>);

#[derive(Clone, Copy)]
struct Held {
    seed: u64,
    cell: [i64; 2],
    corners: [DVec2; 4],
}

/// Places in which octaves are remembered, by their seeds; some thirty times as many as there are octaves.
const PLACES: usize = 1024;

impl Remembered {
    pub fn new() -> Self {
        // No cell of an octave is ever so far out.
        Self(vec![Held { seed: 0, cell: [i64::MIN; 2], corners: [DVec2::ZERO; 4] }; PLACES])
    }
}

impl Corners for Remembered {
    #[inline(always)]
    fn of(&mut self, seed: u64, x: i64, y: i64) -> [DVec2; 4] {
        let held = &mut self.0[seed as usize % PLACES];
        if held.seed != seed || held.cell != [x, y] {
            *held = Held { seed, cell: [x, y], corners: Fresh.of(seed, x, y) };
        }
        held.corners
    }
}

/// One octave of gradient noise, mostly within -0.7..0.7 and never beyond -2.5..2.5, 0 on average, on a lattice of its own heading and place.
#[derive(Clone, Debug)]
pub(super) struct Octave {
    seed: u64,
    east: DVec2,
    north: DVec2,
    offset: DVec2,
}

impl Octave {
    /// The octave number `key` of a world, with lattice cells of `wavelength` metres.
    pub fn new(seed: Seed, key: u64, wavelength: f64) -> Self {
        let mut stream = seed.stream("terrain", &[key]);
        let heading = math::direction(stream.range(0.0, std::f64::consts::TAU)) / wavelength;
        Self {
            seed: stream.bits(),
            east: heading,
            north: heading.perp(),
            offset: DVec2::new(stream.range(0.0, 64.0), stream.range(0.0, 64.0)),
        }
    }

    /// Value at a plan point.
    pub fn at(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        self.evaluate(p, corners).0
    }

    /// Value and its gradient per metre at a plan point.
    pub fn with_gradient(&self, p: DVec2, corners: &mut impl Corners) -> (f64, DVec2) {
        self.evaluate(p, corners)
    }

    // Inlined into both callers: the one that wants no gradient then does not compute it.
    #[inline(always)]
    fn evaluate(&self, p: DVec2, corners: &mut impl Corners) -> (f64, DVec2) {
        let q = self.east * p.x + self.north * p.y + self.offset;
        let (x, y) = (floor(q.x), floor(q.y));
        let f = DVec2::new(q.x - x as f64, q.y - y as f64);
        let [ga, gb, gc, gd] = corners.of(self.seed, x, y);
        let (a, b) = (ga.dot(f), gb.dot(f - DVec2::X));
        let (c, d) = (gc.dot(f - DVec2::Y), gd.dot(f - DVec2::ONE));
        // Quintic weights and their derivatives.
        let u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
        let du = f * f * (f * (f - 2.0) + 1.0) * 30.0;
        let k = a - b - c + d;
        let value = a + u.x * (b - a) + u.y * (c - a) + u.x * u.y * k;
        let slope = ga
            + (gb - ga) * u.x
            + (gc - ga) * u.y
            + (ga - gb - gc + gd) * (u.x * u.y)
            + du * DVec2::new(b - a + u.y * k, c - a + u.x * k);
        let slope = DVec2::new(slope.dot(self.east), slope.dot(self.north));
        (value * SCALE, slope * SCALE)
    }
}

/// Two numbers, each uniform in -1..1, for a lattice point.
pub(super) fn draw(seed: u64, point: [i64; 2]) -> DVec2 {
    corner((point[0] as u64).wrapping_mul(MIX[0]), (point[1] as u64).wrapping_mul(MIX[1]) ^ seed)
}

/// Octaves with weights.
#[derive(Clone, Debug)]
pub(super) struct Fractal {
    octaves: Vec<(Octave, f64)>,
    sum: f64,
}

impl Fractal {
    /// `count` octaves from `wavelength` metres down, each `gain` times as strong as the one before; root mean square
    /// 0.3. Wavelengths shrink by an irrational factor, so that no two lattices of a fractal ever fall together again.
    pub fn new(seed: Seed, key: u64, wavelength: f64, count: usize, gain: f64) -> Self {
        let mut octaves = Vec::with_capacity(count);
        let (mut length, mut weight, mut squares) = (wavelength, 1.0, 0.0);
        for i in 0..count {
            octaves.push((Octave::new(seed, key * 64 + i as u64, length), weight));
            squares += weight * weight;
            length /= 2.0 + 1.0 / (7.0 + std::f64::consts::PI);
            weight *= gain;
        }
        octaves.iter_mut().for_each(|o| o.1 /= f64::sqrt(squares));
        let sum = octaves.iter().map(|o| o.1).sum();
        Self { octaves, sum }
    }

    /// Value at a plan point.
    pub fn at(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        self.octaves.iter().map(|(o, w)| o.at(p, corners) * w).sum()
    }

    /// Ridged sum, 0 to 1: crests where octaves cross zero, each octave stronger on the crests of the one before, so
    /// that valley floors are smooth.
    pub fn ridged_at(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        let (mut sum, mut carry) = (0.0, 1.0);
        for (octave, weight) in &self.octaves {
            let n = octave.at(p, corners) * 1.7;
            // Rounded, so that a crest is a few metres wide and not a knife's edge.
            let crest = 1.0 - (n * n + 0.002).sqrt().min(1.0);
            let crest = crest * crest * carry;
            carry = crest.min(1.0);
            sum += crest * weight;
        }
        sum / self.sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_smooth_everywhere_and_do_not_repeat() {
        let octave = Octave::new(Seed(3), 1, 100.0);
        for origin in [0.0, -7e5, 5e8, 1e12] {
            let mut last = octave.at(DVec2::new(origin, -origin), &mut Fresh);
            let mut sum = 0.0;
            for i in 1..4000 {
                let v = octave.at(DVec2::new(origin + i as f64, -origin), &mut Fresh);
                assert!((v - last).abs() < 0.05, "{origin} {i}: {last} {v}");
                sum += v * v;
                last = v;
            }
            assert!(sum > 4000.0 * 0.02, "{origin}: flat");
        }
        // A table of 256 entries would repeat after 256 cells along its own axis.
        let period = octave.east * (256.0 * 100.0 * 100.0);
        let same = (0..100).filter(|i| {
            let p = DVec2::new(f64::from(*i) * 37.0, 5.0);
            (octave.at(p, &mut Fresh) - octave.at(p + period, &mut Fresh)).abs() < 1e-6
        });
        assert!(same.count() < 5);
    }

    #[test]
    fn gradients_are_those_of_the_values() {
        let octave = Octave::new(Seed(8), 2, 50.0);
        for i in 0..500 {
            let p = DVec2::new(f64::from(i) * 13.7, f64::from(i) * -7.3);
            let (_, g) = octave.with_gradient(p, &mut Fresh);
            let along = |d: DVec2| (octave.at(p + d * 1e-3, &mut Fresh) - octave.at(p - d * 1e-3, &mut Fresh)) / 2e-3;
            assert!(g.distance(DVec2::new(along(DVec2::X), along(DVec2::Y))) < 1e-6);
        }
    }
}
