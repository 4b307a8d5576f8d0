//! Vertical profiles: the height of a street along its centre line.

use crate::network::Street;
use crate::space::{Measured, Origin};
use crate::surface::section::CrossSection;
use glam::DVec2;

/// Least height of streets above water, in metres.
pub const FREEBOARD: f64 = 1.0;

/// Greatest distance between two samples of a profile, in metres.
const STEP: f64 = 4.0;

/// Least number of steps of a profile: short streets have room for level ends, rounding and a grade, too.
const LEAST_STEPS: f64 = 12.0;

/// Length at each end of a street that has the height of the junction there, in metres, and its greatest share of the street.
const LEVEL: (f64, f64) = (12.0, 0.15);

/// Greatest grade of bridges, and half the length over which a change of their grade is rounded, in metres: overpasses rise
/// within the length that the road network leaves them.
const BRIDGE_GRADE: f64 = 0.09;
const BRIDGE_ROUNDING: f64 = 12.0;

/// Least distance over which a change of grade is rounded on either side, in metres.
const LEAST_ROUNDING: f64 = 2.0;

/// The height of a street's carriageway along its centre line.
///
/// A profile depends on nothing but the street and the ground under it. At both ends it has the height of the junction there,
/// which is the height of the ground at the junction's point. In between it runs halfway between the lowest line above the
/// ground and the highest line below it that keep the greatest grade of the street's class, with every change of grade rounded.
/// Where the heights of the junctions leave no way to keep the grade, the grade is as low as they allow: [`is_steep`](Self::is_steep).
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    step: f64,
    heights: Vec<f64>,
    steep: bool,
}

impl Profile {
    /// The profile of a street on the ground. `ground` gives the height at a plan point, in metres, above water where there is
    /// water. The street is local to `origin`.
    pub fn new(street: &Street, origin: Origin, ground: impl FnMut(DVec2) -> f64) -> Self {
        let Samples { length, step, points } = Samples::new(street, origin);
        let targets: Vec<f64> = points.into_iter().map(ground).collect();
        if street.tunnel {
            // A bore does not follow the ground above it.
            let ends = [targets[0], targets[targets.len() - 1]];
            let straight = |i: usize| ends[0] + (ends[1] - ends[0]) * (i as f64 * step / length.max(step)).min(1.0);
            return Self::shaped(street, step, (0..targets.len()).map(straight).collect(), ends, false);
        }
        let ends = [targets[0], targets[targets.len() - 1]];
        Self::shaped(street, step, targets, ends, false)
    }

    /// A profile that nowhere lies below `floor`, apart from the rounding of crests: for bridges. `floor` gives the least height
    /// at a distance along the centre line, in metres, for the plan point there. The ends are at the heights `ends`.
    pub(super) fn above(
        street: &Street,
        origin: Origin,
        ends: [f64; 2],
        mut floor: impl FnMut(f64, DVec2) -> f64,
    ) -> Self {
        let Samples { step, points, .. } = Samples::new(street, origin);
        let floors = points.iter().enumerate().map(|(i, p)| floor(i as f64 * step, *p)).collect();
        Self::shaped(street, step, floors, ends, true)
    }

    fn shaped(street: &Street, step: f64, targets: Vec<f64>, ends: [f64; 2], above: bool) -> Self {
        let mut section = CrossSection::of(street.class);
        if above {
            (section.grade, section.rounding) =
                (section.grade.max(BRIDGE_GRADE), section.rounding.min(BRIDGE_ROUNDING));
        }
        let count = targets.len();
        let length = (count - 1) as f64 * step;
        let level = level(length);
        // Rounding gives way before the grade does.
        let rise = (ends[1] - ends[0]).abs();
        let most = (length - 2.0 * level - rise / section.grade) / 2.0;
        let rounding = section.rounding.min(0.15 * length).min(most.max(LEAST_ROUNDING.min(0.15 * length)));
        let half = ((rounding / step).round() as usize).max(1);
        let rounding = half as f64 * step;
        // A step more, since heights are straight between samples.
        let start = level + step + rounding;
        let room = (length - 2.0 * start).max(1e-3);
        let steep = rise > section.grade * room;
        let grade = section.grade.max(rise / room);

        let raised = envelope(&targets, grade * step, f64::max);
        let line: Vec<f64> = if above {
            raised
        } else {
            let lowered = envelope(&targets, -grade * step, f64::min);
            raised.iter().zip(&lowered).map(|(a, b)| (a + b) / 2.0).collect()
        };
        let within = |i: usize| {
            let s = i as f64 * step;
            let [a, b] = [s, length - s].map(|s| grade * (s - start).max(0.0));
            let (low, high) = ((ends[0] - a).max(ends[1] - b), (ends[0] + a).min(ends[1] + b));
            line[i].min(high).max(low.min(high))
        };
        let kept: Vec<f64> = (0..count).map(within).collect();
        let heights = smoothed(&kept, half, ends);
        Self { step, heights, steep }
    }

    /// Length at each end that has the height of the junction there, in metres.
    pub(super) fn level(&self) -> f64 {
        level(self.length())
    }

    /// Length of the street, in metres.
    pub(super) fn length(&self) -> f64 {
        (self.heights.len() - 1) as f64 * self.step
    }

    /// Height of the carriageway `along` metres from the street's first point.
    pub fn height(&self, along: f64) -> f64 {
        let last = self.heights.len() - 1;
        let at = (along / self.step).clamp(0.0, last as f64);
        let i = (at as usize).min(last.max(1) - 1);
        self.heights[i] + (self.heights[(i + 1).min(last)] - self.heights[i]) * (at - i as f64)
    }

    /// Rise over run around a point of the street, `along` metres from its first point.
    pub fn grade(&self, along: f64) -> f64 {
        (self.height(along + self.step / 2.0) - self.height(along - self.step / 2.0)) / self.step
    }

    /// Whether the heights of the junctions leave no way to keep the greatest grade of the class.
    pub fn is_steep(&self) -> bool {
        self.steep
    }

    /// Distances along the street between `from` and `to` (exclusive) at which a chain of straight lines through them stays
    /// within `tolerance` metres of the profile.
    pub(super) fn bends(&self, from: f64, to: f64, tolerance: f64) -> Vec<f64> {
        let mut out = Vec::new();
        let first = (from / self.step).floor() as usize + 1;
        let mut anchor = (from, self.height(from));
        let mut last: Option<f64> = None;
        let mut slopes = (f64::NEG_INFINITY, f64::INFINITY);
        let mut i = first;
        loop {
            let s = (i as f64 * self.step).min(to);
            let h = self.height(s);
            let run = (s - anchor.0).max(1e-9);
            let slope = (h - anchor.1) / run;
            if (slope < slopes.0 || slope > slopes.1)
                && let Some(before) = last.take()
            {
                out.push(before);
                anchor = (before, self.height(before));
                slopes = (f64::NEG_INFINITY, f64::INFINITY);
                continue;
            }
            slopes.0 = slopes.0.max((h - tolerance - anchor.1) / run);
            slopes.1 = slopes.1.min((h + tolerance - anchor.1) / run);
            if s >= to {
                return out;
            }
            last = Some(s);
            i += 1;
        }
    }
}

fn level(length: f64) -> f64 {
    LEVEL.0.min(LEVEL.1 * length)
}

/// Plan points of a centre line at even distances.
struct Samples {
    length: f64,
    step: f64,
    points: Vec<DVec2>,
}

impl Samples {
    fn new(street: &Street, origin: Origin) -> Self {
        // Relative to the street's first point, so that every local frame gives the same bits.
        let start = street.line[0];
        let line: Vec<DVec2> = street.line.iter().map(|p| *p - start).collect();
        let measured = Measured::new(&line);
        let length = measured.length();
        let count = (length / STEP).ceil().max(LEAST_STEPS);
        let step = length / count;
        let start = origin.to_plan(start);
        let points = (0..=count as usize).map(|i| start + measured.point_at(i as f64 * step)).collect();
        Self { length, step: step.max(1e-6), points }
    }
}

/// The values moved up (`pick` is `max`, `fall` positive) or down until neighbours differ by `fall` at most.
fn envelope(values: &[f64], fall: f64, pick: fn(f64, f64) -> f64) -> Vec<f64> {
    let mut out = values.to_vec();
    for i in 1..out.len() {
        out[i] = pick(out[i], out[i - 1] - fall);
    }
    for i in (1..out.len()).rev() {
        out[i - 1] = pick(out[i - 1], out[i] - fall);
    }
    out
}

/// Means over `half` steps on either side. Beyond the ends the values are `ends`.
fn smoothed(values: &[f64], half: usize, ends: [f64; 2]) -> Vec<f64> {
    let n = values.len() as isize;
    let value = |i: isize| match i {
        i if i < 0 => ends[0],
        i if i >= n => ends[1],
        i => values[i as usize],
    };
    let h = half as isize;
    let mean = |i: isize| {
        let inner: f64 = (i - h + 1..i + h).map(value).sum();
        (inner + (value(i - h) + value(i + h)) / 2.0) / (2 * h) as f64
    };
    let mut out: Vec<f64> = (0..n).map(mean).collect();
    // The ends lie on stretches of one height, where the mean differs from it by rounding alone.
    out[0] = ends[0];
    out[n as usize - 1] = ends[1];
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{JunctionId, StreetClass, StreetId};
    use crate::space::{Seed, quantize};

    fn street(class: StreetClass, length: f64) -> Street {
        let line = vec![DVec2::ZERO, quantize(DVec2::new(length * 0.6, 0.0)), quantize(DVec2::new(length, 0.0))];
        Street::new(StreetId(1), class, JunctionId(1), JunctionId(2), line)
    }

    #[test]
    fn profiles_keep_grade_and_crests_and_begin_and_end_level() {
        let mut rng = Seed(5).stream("profile", &[]);
        let mut steep = 0;
        for case in 0..400 {
            let class = StreetClass::ALL[case % StreetClass::ALL.len()];
            let street = street(class, rng.range(20.0, 900.0));
            let (wave, high, tilt) = (rng.range(20.0, 300.0), rng.range(0.0, 12.0), rng.range(-0.16, 0.16));
            let ground = |p: DVec2| crate::space::math::sin(p.x / wave) * high + p.x * tilt;
            let profile = Profile::new(&street, Origin::default(), ground);
            let (length, section) = (street.length(), CrossSection::of(class));
            let ends = [0.0, length].map(|s| (profile.height(s), ground(DVec2::X * s)));
            assert!(ends.iter().all(|(a, b)| (a - b).abs() < 1e-9), "{case}: {ends:?}");
            assert!((profile.height(profile.level()) - profile.height(0.0)).abs() < 1e-9, "{case}");
            steep += usize::from(profile.is_steep());
            let n = (length / profile.step).round() as usize;
            for i in 0..n {
                let s = i as f64 * profile.step;
                let grade = (profile.height(s + profile.step) - profile.height(s)).abs() / profile.step;
                assert!(profile.is_steep() || grade < section.grade + 1e-9, "{case}: {grade} at {s} of {length}");
            }
            let kept = profile.bends(3.0, length - 3.0, 0.01);
            let mut chain = vec![3.0];
            chain.extend(&kept);
            chain.push(length - 3.0);
            for w in chain.windows(2) {
                let n = ((w[1] - w[0]) / 0.5).ceil() as usize;
                for k in 0..=n {
                    let t = k as f64 / n as f64;
                    let straight = profile.height(w[0]) * (1.0 - t) + profile.height(w[1]) * t;
                    assert!((profile.height(w[0] + (w[1] - w[0]) * t) - straight).abs() < 0.021, "{case}");
                }
            }
        }
        assert!((20..300).contains(&steep), "{steep}");
    }

    #[test]
    fn every_frame_gives_the_same_profile() {
        let ground = |p: DVec2| (p.x / 13.0).fract() * 3.0 + p.y * 0.01;
        let street = street(StreetClass::Local, 123.0);
        let here = Profile::new(&street, Origin::default(), ground);
        let shift = DVec2::new(512.0, -1024.0);
        assert_eq!(here, Profile::new(&street.moved(shift), Origin::at(-shift), ground));
    }
}
