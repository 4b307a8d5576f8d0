//! Heights along a road: the ground evened out so that no stretch is steeper than its class allows.
//!
//! The ground along the line is enveloped from above and below by lines of the greatest grade; their mean is nowhere
//! steeper, and leaves the ground no further than needed by about half. At junctions the road lies on the ground, so that
//! all that meet there agree; a line too short for the difference of its ends is as steep as they make it.

use crate::space::{Measured, Origin, line_length, math::mix};
use crate::terrain::Terrain;
use glam::DVec2;

/// Spacing of the samples along a line, in metres.
const SPACING: f64 = 32.0;
/// Height of a small bridge over the water, in metres.
const OVER_WATER: f64 = 1.5;

/// Heights along a line of the graph.
pub(super) struct Profile {
    length: f64,
    heights: Vec<f64>,
}

impl Profile {
    /// Heights along a line whose parts up to the points of `runs` are on levels: 0 for the ground, others straight.
    pub fn along(
        terrain: &dyn Terrain,
        origin: Origin,
        line: &[DVec2],
        runs: &[(usize, i8)],
        slope_limit: f64,
    ) -> Self {
        let measured = Measured::new(line);
        let length = measured.length();
        let count = (length / SPACING).ceil().max(1.0) as usize;
        let step = length / count as f64;
        let ground = |at: f64| {
            let p = match line {
                [first, ..] if at <= 0.0 => *first,
                [.., last] if at >= length => *last,
                _ => measured.point_at(at),
            };
            let s = terrain.sample(origin.to_plan(p));
            if s.depth() > 0.0 { (s.water_level + OVER_WATER, true) } else { (s.height, false) }
        };
        let place = |i: usize| if i == count { length } else { i as f64 * step };
        let sampled: Vec<(f64, bool)> = (0..=count).map(|i| ground(place(i))).collect();
        let mut heights: Vec<f64> = sampled.iter().map(|s| s.0).collect();
        // From bank to bank.
        let mut bank = 0;
        for i in 1..=count {
            if !sampled[i].1 || i == count {
                for k in bank + 1..i {
                    let deck = mix(heights[bank], heights[i], (k - bank) as f64 / (i - bank) as f64);
                    heights[k] = heights[k].max(deck);
                }
                bank = i;
            }
        }
        let mut first = (0, 0.0);
        for (last, level) in runs {
            let end = first.1 + line_length(&line[first.0..=*last]);
            if *level != 0 {
                let (from, to) = (ground(first.1).0, ground(end).0);
                for (i, height) in heights.iter_mut().enumerate() {
                    let at = (i as f64 * step - first.1) / (end - first.1);
                    if (0.0..=1.0).contains(&at) {
                        *height = mix(from, to, at);
                    }
                }
            }
            first = (*last, end);
        }
        let ends = [heights[0], heights[count]];
        let most = slope_limit.max((ends[0] - ends[1]).abs() / length.max(1e-9)) * step;
        let (mut over, mut under) = (heights.clone(), heights);
        for i in (1..=count).chain((0..count).rev()) {
            // Forwards from the point before, then backwards from the one after.
            for from in [i.wrapping_sub(1), i + 1] {
                if let (Some(o), Some(u)) = (over.get(from).copied(), under.get(from).copied()) {
                    over[i] = over[i].max(o - most);
                    under[i] = under[i].min(u + most);
                }
            }
        }
        let between = |i: usize| {
            let (a, b) = (i as f64 * most, (count - i) as f64 * most);
            let mean = (over[i] + under[i]) / 2.0;
            mean.min(ends[0] + a).min(ends[1] + b).max(ends[0] - a).max(ends[1] - b)
        };
        let mut heights: Vec<f64> = (0..=count).map(between).collect();
        (heights[0], heights[count]) = (ends[0], ends[1]);
        Self { length, heights }
    }

    /// Height at the end.
    pub fn end(&self) -> f64 {
        self.heights[self.heights.len() - 1]
    }

    /// Heights at the points of a part of the line that begins at a length along it, and the length where it ends.
    pub fn heights(&self, part: &[DVec2], from: f64) -> (Vec<f64>, f64) {
        let mut at = from;
        let mut before: Option<DVec2> = None;
        let heights = part.iter().map(|p| {
            at += before.map_or(0.0, |b| b.distance(*p));
            before = Some(*p);
            self.at(at)
        });
        (heights.collect(), at)
    }

    fn at(&self, at: f64) -> f64 {
        let count = self.heights.len() - 1;
        let place = (at / self.length.max(1e-9)).clamp(0.0, 1.0) * count as f64;
        let i = (place as usize).min(count.saturating_sub(1));
        mix(self.heights[i], self.heights[(i + 1).min(count)], place - i as f64)
    }
}
