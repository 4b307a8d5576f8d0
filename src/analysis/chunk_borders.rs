//! Whether streets know where the lines of a square lattice lie, such as the borders of chunks: figures near the lines against
//! those between them, and a spectrum of positions.

use crate::space::math::{cos, sin};
use crate::space::{Bounds, line_length, point_at, segments};
use glam::DVec2;
use serde::Serialize;
use std::f64::consts::TAU;

/// Harmonics of the lattice that the spectrum looks at.
const HARMONICS: usize = 4;
/// Frequencies beside each harmonic that it is compared with, on either side, and their distance as a share of it.
const BESIDE: (i32, f64) = (20, 0.013);
/// A street that is at most this far off an axis runs along it: tangent of 15 degrees.
const ALONG: f64 = 0.267_949_192_431_122_7;

/// Streets and junctions near the lines of a lattice and away from them. Positions are plan metres.
#[derive(Clone, Debug)]
pub struct ChunkBorderCounts {
    period: f64,
    rim: f64,
    /// Near the lines, and away from them.
    zones: [Zone; 2],
    junctions: Vec<DVec2>,
}

/// Sums over a zone.
#[derive(Clone, Copy, Debug, Default)]
struct Zone {
    area: f64,
    junctions: f64,
    streets: f64,
    street_m: f64,
    segment_m: f64,
    along_m: f64,
}

/// What [`ChunkBorderCounts`] add up to. Ratios are of what is near the lines to what is between them: 1 where nothing knows of
/// the lattice.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChunkBorderReport {
    /// Square kilometres near the lines, and away from them.
    pub area_km2: [f64; 2],
    /// Junctions near the lines, and away from them.
    pub junctions: [f64; 2],
    /// Ratio of junctions to the area.
    pub density_ratio: f64,
    /// Ratio of the mean lengths of streets by where their middle lies.
    pub length_ratio: f64,
    /// Ratio of the shares of street length that run within 15 degrees of an axis of the lattice.
    pub heading_ratio: f64,
    /// Amplitudes of the junctions' x and y at the lattice's period and its next three harmonics, over the root mean square of those at
    /// 40 frequencies around each: about 1; above 3 with a chance of one in 8,000 where nothing knows of the lattice.
    pub peaks: [[f64; HARMONICS]; 2],
}

impl ChunkBorderReport {
    /// The greatest of all peaks.
    pub fn highest_peak(&self) -> f64 {
        self.peaks.iter().flatten().copied().fold(0.0, f64::max)
    }

    /// The greatest difference of a ratio from 1.
    pub fn greatest_difference(&self) -> f64 {
        let ratios = [self.density_ratio, self.length_ratio, self.heading_ratio];
        ratios.iter().fold(0.0, |most, r| (r - 1.0).abs().max(most))
    }
}

impl ChunkBorderCounts {
    /// Nothing yet, over a lattice of lines every `period` metres from 0; what is within `rim` metres of one is near.
    pub fn new(period: f64, rim: f64) -> Self {
        Self { period, rim, zones: Default::default(), junctions: Vec::new() }
    }

    fn zone(&mut self, p: DVec2) -> &mut Zone {
        let within = p - (p / self.period).floor() * self.period;
        let to_line = within.min(DVec2::splat(self.period) - within).min_element();
        &mut self.zones[usize::from(to_line > self.rim)]
    }

    /// Takes the part of a box for which `built` holds as built up, looked at every `step` metres.
    pub fn add_area(&mut self, bounds: Bounds, step: f64, built: impl Fn(DVec2) -> bool) {
        let count = (bounds.size() / step).ceil().max(DVec2::ONE);
        let cell = bounds.size() / count;
        for y in 0..count.y as usize {
            for x in 0..count.x as usize {
                let p = bounds.min + cell * DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                if built(p) {
                    self.zone(p).area += cell.x * cell.y;
                }
            }
        }
    }

    /// Adds a junction.
    pub fn add_junction(&mut self, at: DVec2) {
        self.zone(at).junctions += 1.0;
        self.junctions.push(at);
    }

    /// Adds a street.
    pub fn add_street(&mut self, line: &[DVec2]) {
        let length = line_length(line);
        let zone = self.zone(point_at(line, length / 2.0).0);
        zone.streets += 1.0;
        zone.street_m += length;
        for (a, b) in segments(line) {
            let (metres, across) = (a.distance(b), (b - a).abs());
            let zone = self.zone(a.midpoint(b));
            zone.segment_m += metres;
            if across.min_element() <= ALONG * across.max_element() {
                zone.along_m += metres;
            }
        }
    }

    /// Adds what others counted over the same lattice.
    pub fn add(&mut self, other: &Self) {
        for (own, new) in self.zones.iter_mut().zip(&other.zones) {
            own.area += new.area;
            own.junctions += new.junctions;
            own.streets += new.streets;
            own.street_m += new.street_m;
            own.segment_m += new.segment_m;
            own.along_m += new.along_m;
        }
        self.junctions.extend(&other.junctions);
    }

    /// What it adds up to.
    pub fn report(&self) -> ChunkBorderReport {
        let ratio = |of: &dyn Fn(&Zone) -> [f64; 2]| {
            let [near, away] = [of(&self.zones[0]), of(&self.zones[1])].map(|[sum, by]| sum / by.max(1e-9));
            near / away.max(1e-12)
        };
        ChunkBorderReport {
            area_km2: self.zones.map(|z| z.area / 1e6),
            junctions: self.zones.map(|z| z.junctions),
            density_ratio: ratio(&|z| [z.junctions, z.area]),
            length_ratio: ratio(&|z| [z.street_m, z.streets]),
            heading_ratio: ratio(&|z| [z.along_m, z.segment_m]),
            peaks: [0, 1].map(|axis| self.peaks(axis)),
        }
    }

    fn peaks(&self, axis: usize) -> [f64; HARMONICS] {
        let power = |frequency: f64| {
            let (mut re, mut im) = (0.0, 0.0);
            for p in &self.junctions {
                // Whole turns are left out first: far from 0 the rest would be lost.
                let turns = p[axis] / self.period * frequency;
                let angle = (turns - turns.floor()) * TAU;
                re += cos(angle);
                im += sin(angle);
            }
            re * re + im * im
        };
        let mut out = [0.0; HARMONICS];
        for (h, peak) in out.iter_mut().enumerate() {
            let harmonic = (h + 1) as f64;
            let beside = (1..=BESIDE.0).flat_map(|k| [-k, k]).map(|k| harmonic * (1.0 + f64::from(k) * BESIDE.1));
            let mean = beside.map(power).fold(0.0, |sum, p| sum + p) / f64::from(2 * BESIDE.0);
            *peak = (power(harmonic) / mean.max(1e-9)).sqrt();
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;

    /// Junctions and short streets, spread evenly over 40 km2, and drawn towards the lines by a share.
    fn spread(seed: u64, drawn: f64) -> ChunkBorderReport {
        let mut stream = Seed(seed).stream("lattice test", &[]);
        let mut counts = ChunkBorderCounts::new(512.0, 40.0);
        let bounds = Bounds::square(DVec2::new(-3000.0, 700_000.0), 6324.0);
        counts.add_area(bounds, 16.0, |_| true);
        for _ in 0..6000 {
            let mut p = bounds.min + DVec2::new(stream.unit(), stream.unit()) * bounds.size();
            if stream.chance(drawn) {
                p.x = (p.x / 512.0).round() * 512.0;
            }
            counts.add_junction(p);
            let to = p + crate::space::math::direction(stream.range(0.0, TAU)) * stream.range(30.0, 90.0);
            counts.add_street(&[p, to]);
        }
        counts.report()
    }

    #[test]
    fn a_lattice_is_seen_where_there_is_one_and_nowhere_else() {
        for seed in 0..4 {
            let blind = spread(seed, 0.0);
            assert!(blind.highest_peak() < 3.5 && blind.greatest_difference() < 0.12, "{blind:?}");
            let seen = spread(seed, 0.15);
            assert!(seen.highest_peak() > 3.5 && seen.density_ratio > 1.08, "{seen:?}");
        }
    }
}
