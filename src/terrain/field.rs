//! Smooth random fields over the endless plan: gradient noise that never repeats, and sums of its octaves.
//!
//! The `noise` crate is no replacement: its tables repeat every 256 cells, it gives no derivatives, and its 2-D gradient noise
//! takes several times as long.

use crate::space::{Seed, math};
use glam::DVec2;

/// Scales an octave so that its root mean square is 0.3.
const SCALE: f64 = 1.73;

/// Multipliers for the bits of a lattice coordinate. All 64 bits count, so no lattice ever repeats.
const MIX: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xC2B2_AE3D_27D4_EB4F];

/// The gradient at a lattice corner with these mixed coordinates. Each component is uniform in -1..1.
#[inline(always)]
fn corner(x: u64, y: u64) -> DVec2 {
    let h = x ^ y;
    let h = (h ^ (h >> 32)).wrapping_mul(0xD6E8_FEB8_6659_FD93);
    let h = (h ^ (h >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let component = |bits: u64| f64::from(bits as i32) * (1.0 / 2_147_483_648.0);
    DVec2::new(component(h >> 32), component(h >> 8))
}

/// Adding this to a number below 2^51 and subtracting it again rounds to a whole number.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// `x` rounded to the nearest whole number. On processors without an instruction for it, `f64::round` calls the math library, and
/// so does `f64::floor`.
#[inline(always)]
pub(super) fn round(x: f64) -> f64 {
    (x + WHOLE) - WHOLE
}

/// `x` rounded down.
#[inline(always)]
pub(super) fn floor(x: f64) -> f64 {
    let near = round(x);
    near - if near > x { 1.0 } else { 0.0 }
}

/// A whole number below 2^51 as an integer.
#[inline(always)]
fn integer(x: f64) -> u64 {
    (x + WHOLE).to_bits().wrapping_sub(WHOLE.to_bits())
}

/// Gradients at the corners of one cell per octave: the east and north component at the south-west, south-east, north-west and
/// north-east corner.
type Gradients<const N: usize> = [[f64; N]; 8];

/// A source of the gradients at the corners of cells.
pub(super) trait Corners {
    /// Gradients at the corners of one cell (x, y) per octave.
    fn of<const N: usize>(&mut self, octaves: &Octaves<N>, cells: &[[f64; N]; 2]) -> &Gradients<N>;
}

/// Writes the gradients at the corners of the cell (x, y) of octave `i` to its column.
#[inline(always)]
fn put_gradients<const N: usize>(of: &mut Gradients<N>, octaves: &Octaves<N>, [x, y]: [f64; 2], i: usize) {
    let (x, y) = (integer(x).wrapping_mul(MIX[0]), integer(y).wrapping_mul(MIX[1]));
    let (x1, y1) = (x.wrapping_add(MIX[0]), y.wrapping_add(MIX[1]) ^ octaves.seeds[i]);
    let y = y ^ octaves.seeds[i];
    for (k, g) in [corner(x, y), corner(x1, y), corner(x, y1), corner(x1, y1)].into_iter().enumerate() {
        (of[2 * k][i], of[2 * k + 1][i]) = (g.x, g.y);
    }
}

/// Greatest number of octaves that are evaluated together.
const MOST_TOGETHER: usize = 6;

/// Computes gradients anew for every point.
pub(super) struct FreshCorners([f64; 8 * MOST_TOGETHER]);

impl FreshCorners {
    pub fn new() -> Self {
        Self([0.0; 8 * MOST_TOGETHER])
    }
}

/// Caches the gradients of the last cell of each octave: points near each other mostly lie in the same cells.
pub(super) struct CachedCorners {
    cells: Vec<f64>,
    gradients: Vec<f64>,
}

impl CachedCorners {
    /// A cache for so many octaves: see [`Slots::taken`].
    pub fn new(octaves: usize) -> Self {
        // NaN is equal to no cell.
        Self { cells: vec![f64::NAN; 2 * octaves], gradients: vec![0.0; 8 * octaves] }
    }
}

/// The first `M` rows of `N` numbers.
#[inline(always)]
fn rows<const M: usize, const N: usize>(numbers: &mut [f64]) -> &mut [[f64; N]; M] {
    let rows = numbers.as_chunks_mut::<N>().0.first_chunk_mut::<M>();
    rows.expect("there is room for all octaves")
}

impl Corners for FreshCorners {
    #[inline(always)]
    fn of<const N: usize>(&mut self, octaves: &Octaves<N>, [x, y]: &[[f64; N]; 2]) -> &Gradients<N> {
        let out = rows::<8, N>(&mut self.0);
        for i in 0..N {
            put_gradients(out, octaves, [x[i], y[i]], i);
        }
        out
    }
}

impl Corners for CachedCorners {
    #[inline(always)]
    fn of<const N: usize>(&mut self, octaves: &Octaves<N>, [x, y]: &[[f64; N]; 2]) -> &Gradients<N> {
        let [held_x, held_y] = rows::<2, N>(&mut self.cells[2 * octaves.slot..]);
        let held = rows::<8, N>(&mut self.gradients[8 * octaves.slot..]);
        // Usually every octave is in the same cell as before: all are compared at once, without branches.
        let mut moved = false;
        for i in 0..N {
            moved |= (x[i] != held_x[i]) | (y[i] != held_y[i]);
        }
        if moved {
            for i in 0..N {
                if x[i] != held_x[i] || y[i] != held_y[i] {
                    (held_x[i], held_y[i]) = (x[i], y[i]);
                    put_gradients(held, octaves, [x[i], y[i]], i);
                }
            }
        }
        held
    }
}

/// Slots for octaves in [`CachedCorners`], given out in order.
#[derive(Default)]
pub(super) struct Slots(usize);

impl Slots {
    fn take(&mut self, count: usize) -> usize {
        self.0 += count;
        self.0 - count
    }

    /// Number of slots that were given out.
    pub fn taken(&self) -> usize {
        self.0
    }
}

/// Octaves of gradient noise, evaluated side by side so that the compiler uses vector instructions. The values of each octave are
/// mostly within -0.7..0.7, always within -2.5..2.5, and 0 on average. Each octave has a lattice of its own heading and offset.
#[derive(Clone, Debug)]
pub(super) struct Octaves<const N: usize> {
    slot: usize,
    seeds: [u64; N],
    /// Lattice coordinates of a plan point: `east.x * p.x - east.y * p.y + offset.x` and `east.y * p.x + east.x * p.y + offset.y`.
    east: [[f64; N]; 2],
    offset: [[f64; N]; 2],
}

impl<const N: usize> Octaves<N> {
    /// Octaves of a world, each with its key and its wavelength: the edge length of its lattice cells in metres.
    pub fn new(seed: Seed, octaves: [(u64, f64); N], slots: &mut Slots) -> Self {
        const { assert!(N <= MOST_TOGETHER) };
        let slot = slots.take(N);
        let mut out = Self { slot, seeds: [0; N], east: [[0.0; N]; 2], offset: [[0.0; N]; 2] };
        for (i, (key, wavelength)) in octaves.into_iter().enumerate() {
            let mut stream = seed.stream("terrain", &[key]);
            let heading = math::direction(stream.range(0.0, std::f64::consts::TAU)) / wavelength;
            (out.east[0][i], out.east[1][i]) = (heading.x, heading.y);
            out.seeds[i] = stream.bits();
            (out.offset[0][i], out.offset[1][i]) = (stream.range(0.0, 64.0), stream.range(0.0, 64.0));
        }
        out
    }

    /// Values at a plan point.
    #[inline]
    pub fn at(&self, p: DVec2, corners: &mut impl Corners) -> [f64; N] {
        self.evaluate(p, corners).0
    }

    /// Values at a plan point, and the east and north components of their gradients per metre.
    #[inline]
    pub fn with_gradients(&self, p: DVec2, corners: &mut impl Corners) -> ([f64; N], [[f64; N]; 2]) {
        self.evaluate(p, corners)
    }

    // Inlined into both callers, so that the caller that needs no gradients does not compute them.
    #[inline(always)]
    fn evaluate(&self, p: DVec2, corners: &mut impl Corners) -> ([f64; N], [[f64; N]; 2]) {
        let [east_x, east_y] = &self.east;
        let (mut cells, mut parts) = ([[0.0; N]; 2], [[0.0; N]; 2]);
        for i in 0..N {
            let x = east_x[i] * p.x - east_y[i] * p.y + self.offset[0][i];
            let y = east_y[i] * p.x + east_x[i] * p.y + self.offset[1][i];
            (cells[0][i], cells[1][i]) = (floor(x), floor(y));
            (parts[0][i], parts[1][i]) = (x - cells[0][i], y - cells[1][i]);
        }
        let [ax, ay, bx, by, cx, cy, dx, dy] = corners.of(self, &cells);
        let (mut values, mut slopes) = ([0.0; N], [[0.0; N]; 2]);
        for i in 0..N {
            let (x, y) = (parts[0][i], parts[1][i]);
            let (a, b) = (ax[i] * x + ay[i] * y, bx[i] * (x - 1.0) + by[i] * y);
            let (c, d) = (cx[i] * x + cy[i] * (y - 1.0), dx[i] * (x - 1.0) + dy[i] * (y - 1.0));
            // Quintic weights and their derivatives.
            let weight = |f: f64| f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
            let change = |f: f64| f * f * (f * (f - 2.0) + 1.0) * 30.0;
            let (u, v) = (weight(x), weight(y));
            let k = a - b - c + d;
            values[i] = (a + u * (b - a) + v * (c - a) + u * v * k) * SCALE;
            let mixed = |a: f64, b: f64, c: f64, d: f64| a + (b - a) * u + (c - a) * v + (a - b - c + d) * (u * v);
            let along = mixed(ax[i], bx[i], cx[i], dx[i]) + change(x) * (b - a + v * k);
            let across = mixed(ay[i], by[i], cy[i], dy[i]) + change(y) * (c - a + u * k);
            slopes[0][i] = (along * east_x[i] + across * east_y[i]) * SCALE;
            slopes[1][i] = (across * east_x[i] - along * east_y[i]) * SCALE;
        }
        (values, slopes)
    }
}

/// Two random numbers for a lattice point, each uniform in -1..1.
pub(super) fn lattice_random(seed: u64, point: [i64; 2]) -> DVec2 {
    corner((point[0] as u64).wrapping_mul(MIX[0]), (point[1] as u64).wrapping_mul(MIX[1]) ^ seed)
}

/// A weighted sum of octaves.
#[derive(Clone, Debug)]
pub(super) struct Fractal<const N: usize> {
    octaves: Octaves<N>,
    weights: [f64; N],
    sum: f64,
}

impl<const N: usize> Fractal<N> {
    /// Octaves with wavelengths from `wavelength` metres down, each `gain` times as strong as the one before. The root mean square
    /// of the sum is 0.3. Wavelengths shrink by an irrational factor, so that no two lattices of a fractal ever coincide again.
    pub fn new(seed: Seed, key: u64, wavelength: f64, gain: f64, slots: &mut Slots) -> Self {
        let (mut length, mut weight, mut squares) = (wavelength, 1.0, 0.0);
        let (mut octaves, mut weights) = ([(0, 0.0); N], [0.0; N]);
        for i in 0..N {
            octaves[i] = (key * 64 + i as u64, length);
            weights[i] = weight;
            squares += weight * weight;
            length /= 2.0 + 1.0 / (7.0 + std::f64::consts::PI);
            weight *= gain;
        }
        weights.iter_mut().for_each(|w| *w /= f64::sqrt(squares));
        Self { octaves: Octaves::new(seed, octaves, slots), weights, sum: weights.iter().sum() }
    }

    /// Value at a plan point.
    pub fn at(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        weighted(&self.octaves.at(p, corners), &self.weights)
    }

    /// Ridged sum, 0 to 1. Crests lie where octaves cross zero. Each octave is stronger on the crests of the one before, so valley
    /// floors are smooth.
    pub fn ridged_at(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        let (mut sum, mut carry) = (0.0, 1.0);
        for (value, weight) in self.octaves.at(p, corners).iter().zip(&self.weights) {
            let n = value * 1.7;
            // Rounded, so that a crest is a few metres wide and not infinitely sharp.
            let crest = 1.0 - (n * n + 0.002).sqrt().min(1.0);
            let crest = crest * crest * carry;
            carry = crest.min(1.0);
            sum += crest * weight;
        }
        sum / self.sum
    }
}

/// Weighted sum of values.
#[inline(always)]
pub(super) fn weighted<const N: usize>(values: &[f64; N], weights: &[f64; N]) -> f64 {
    (0..N).map(|i| values[i] * weights[i]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_smooth_everywhere_and_do_not_repeat() {
        let octave = Octaves::new(Seed(3), [(1, 100.0)], &mut Slots::default());
        let east = DVec2::new(octave.east[0][0], octave.east[1][0]);
        let at = |p: DVec2| octave.at(p, &mut FreshCorners::new())[0];
        for origin in [0.0, -7e5, 5e8, 1e12] {
            let mut last = at(DVec2::new(origin, -origin));
            let mut sum = 0.0;
            for i in 1..4000 {
                let v = at(DVec2::new(origin + i as f64, -origin));
                assert!((v - last).abs() < 0.05, "{origin} {i}: {last} {v}");
                sum += v * v;
                last = v;
            }
            assert!(sum > 4000.0 * 0.02, "{origin}: flat");
        }
        // A table of 256 entries would repeat after 256 cells along its own axis.
        let period = east * (256.0 * 100.0 * 100.0);
        let same = (0..100).filter(|i| {
            let p = DVec2::new(f64::from(*i) * 37.0, 5.0);
            (at(p) - at(p + period)).abs() < 1e-6
        });
        assert!(same.count() < 5);
    }

    #[test]
    fn gradients_are_those_of_the_values() {
        let octave = Octaves::new(Seed(8), [(2, 50.0)], &mut Slots::default());
        let at = |p: DVec2| octave.at(p, &mut FreshCorners::new())[0];
        for i in 0..500 {
            let p = DVec2::new(f64::from(i) * 13.7, f64::from(i) * -7.3);
            let (_, [x, y]) = octave.with_gradients(p, &mut FreshCorners::new());
            let along = |d: DVec2| (at(p + d * 1e-3) - at(p - d * 1e-3)) / 2e-3;
            assert!(DVec2::new(x[0], y[0]).distance(DVec2::new(along(DVec2::X), along(DVec2::Y))) < 1e-6);
        }
    }
}
