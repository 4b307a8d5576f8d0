//! Runs: the stretches of a block's border along which lots are laid out.

use crate::parcel::blocks::BlockShape;
use crate::space::{left_normal, point_at};
use glam::DVec2;

/// Cosine of the turn of the border at which the next run begins, which is 30 degrees.
pub(super) const CORNER: f64 = 0.866;

/// A stretch of a block's border that follows streets and has no corner.
pub(super) struct Run {
    /// The stretch, with the block to its left.
    pub line: Vec<DVec2>,
    /// For each point of the line, its distance from the start along the line, in metres.
    pub along: Vec<f64>,
    /// For each edge of the line, the index of the street that it follows.
    streets: Vec<usize>,
    /// Unit direction of the border edge before the run; zero if the run is the whole border.
    before: DVec2,
    /// Unit direction of the border edge after the run; zero if the run is the whole border.
    after: DVec2,
}

impl Run {
    /// Length in metres.
    pub fn length(&self) -> f64 {
        self.along[self.along.len() - 1]
    }

    /// Index of the street `s` metres along the run.
    pub fn street_at(&self, s: f64) -> usize {
        let edge = self.along.partition_point(|a| *a <= s).clamp(1, self.streets.len());
        self.streets[edge - 1]
    }

    /// Unit direction, into the block, of the line between two lots `s` metres along the run. `open` says that no lot lies at
    /// this end of the run yet.
    pub fn ray(&self, s: f64, open: bool) -> DVec2 {
        let chord = point_at(&self.line, s + 5.0).0 - point_at(&self.line, s - 5.0).0;
        let normal = left_normal(chord.normalize_or_zero());
        let (first, last) = (s <= 0.01, s >= self.length() - 0.01);
        if !open || self.before == DVec2::ZERO || !(first || last) {
            return normal;
        }
        // The direction away from the corner along the neighbouring run.
        let own = point_at(&self.line, s).1;
        let (own, other) = if first { (own, -self.before) } else { (-own, self.after) };
        let normal = left_normal(point_at(&self.line, s).1);
        let convex = other.dot(normal) > 0.0;
        let between = own.dot(other);
        if convex && between > -0.57 {
            // At angles up to 125 degrees the corner belongs to the run that is cut first.
            if between > 0.0 { normal } else { other }
        } else {
            // Each run gets half of the corner.
            let half = (own + other).normalize_or_zero() * if convex { 1.0 } else { -1.0 };
            if half == DVec2::ZERO { normal } else { half }
        }
    }
}

/// The runs of a block's border.
pub(super) fn runs(block: &BlockShape) -> Vec<Run> {
    let (points, fronts) = (&block.polygon, &block.fronts);
    let n = points.len();
    let direction = |i: usize| (points[(i + 1) % n] - points[i % n]).normalize_or_zero();
    let breaks = |i: usize| {
        let before = (i + n - 1) % n;
        direction(before).dot(direction(i)) < CORNER || fronts[before].is_none() || fronts[i].is_none()
    };
    let starts: Vec<usize> = (0..n).filter(|i| breaks(*i)).collect();
    let whole = starts.is_empty();
    let starts = if whole { vec![0] } else { starts };
    let mut out = Vec::new();
    for (k, &start) in starts.iter().enumerate() {
        let next = starts[(k + 1) % starts.len()];
        let count = if next > start { next - start } else { next + n - start };
        if fronts[start].is_none() {
            continue;
        }
        let line: Vec<DVec2> = (start..=start + count).map(|i| points[i % n]).collect();
        let mut along = vec![0.0];
        line.windows(2).for_each(|w| along.push(along[along.len() - 1] + w[0].distance(w[1])));
        out.push(Run {
            line,
            along,
            streets: (start..start + count).filter_map(|i| fronts[i % n]).collect(),
            before: if whole { DVec2::ZERO } else { direction(start + n - 1) },
            after: if whole { DVec2::ZERO } else { direction(start + count) },
        });
    }
    out
}
