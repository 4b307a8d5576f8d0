//! Lots: strips along the streets of a block, cut across into parcels that each front a street.
//!
//! Runs of border edges along streets take turns, the longest first. A run is cut into frontages, and each frontage
//! takes the land behind it: to the middle of the block or the greatest depth, whichever is nearer, up to the block's
//! border and up to the lots that are there. What nobody takes stays a courtyard.

use crate::parcel::blocks::BlockShape;
use crate::parcel::convex::{Half, clip, overlap, segment_inside, sides};
use crate::space::{Bounds, Stream, closest_on_line, cross, left_normal, point_at, signed_area};
use crate::style::ParcelRules;
use glam::DVec2;

/// Cosine of the turn at which the border's next run begins (30 degrees).
const CORNER: f64 = 0.866;

/// Distance (metres) that a frontage may cut off from a bend of the border; at sharper bends the lots part.
const SAGITTA: f64 = 1.5;

/// A lot with two corners within this distance (metres) of a run takes the run's stretch between them.
const BESIDE: f64 = 3.0;

/// A lot: a convex polygon, its first edge the frontage.
pub(super) struct LotShape {
    pub polygon: Vec<DVec2>,
    /// Index of the street that the frontage lies on.
    pub street: usize,
    /// Index of another edge that lies on a street.
    pub corner: Option<usize>,
}

/// A run of border edges along streets without a corner.
struct Run {
    line: Vec<DVec2>,
    /// Metres along the line, for each of its points.
    along: Vec<f64>,
    /// Street of each of its edges.
    streets: Vec<usize>,
    /// Directions of the border edges before and after it; zero for the run that is the whole border.
    before: DVec2,
    after: DVec2,
}

impl Run {
    fn length(&self) -> f64 {
        self.along[self.along.len() - 1]
    }

    fn street_at(&self, s: f64) -> usize {
        let edge = self.along.partition_point(|a| *a <= s).clamp(1, self.streets.len());
        self.streets[edge - 1]
    }

    /// Direction into the block of the side that parts lots at `s` metres; `open` at an end of the run that no lot has
    /// taken yet.
    fn ray(&self, s: f64, open: bool) -> DVec2 {
        let chord = point_at(&self.line, s + 5.0).0 - point_at(&self.line, s - 5.0).0;
        let normal = left_normal(chord.normalize_or_zero());
        let (first, last) = (s <= 0.01, s >= self.length() - 0.01);
        if !open || self.before == DVec2::ZERO || !(first || last) {
            return normal;
        }
        // The other run's side of the corner, as a direction away from the corner.
        let own = point_at(&self.line, s).1;
        let (own, other) = if first { (own, -self.before) } else { (-own, self.after) };
        let normal = left_normal(point_at(&self.line, s).1);
        let convex = other.dot(normal) > 0.0;
        let between = own.dot(other);
        if convex && between > -0.57 {
            // Up to 125 degrees the corner belongs to the run that comes first.
            if between > 0.0 { normal } else { other }
        } else {
            // Both runs get their half of the corner.
            let half = (own + other).normalize_or_zero() * if convex { 1.0 } else { -1.0 };
            if half == DVec2::ZERO { normal } else { half }
        }
    }
}

/// Cuts a block into lots.
pub(super) fn lots(block: &BlockShape, rules: &ParcelRules, rng: &mut Stream) -> Vec<LotShape> {
    let mut runs = runs(block);
    runs.sort_by(|a, b| b.length().total_cmp(&a.length()).then(a.line[0].x.total_cmp(&b.line[0].x)));
    let mut cutter = Cutter { block, rules, lots: Vec::new() };
    for run in &runs {
        let depth = cutter.depth(run);
        for (from, to) in cutter.free(run) {
            let cuts = frontages(run, from, to, rules, rng);
            for cut in cuts.windows(2) {
                cutter.lot(run, cut[0], cut[1], (from, to), depth);
            }
        }
    }
    cutter.lots
}

/// The border's runs along streets.
fn runs(block: &BlockShape) -> Vec<Run> {
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

/// Where the stretch from `from` to `to` of a run is cut: at sharp bends, and between them at random widths.
fn frontages(run: &Run, from: f64, to: f64, rules: &ParcelRules, rng: &mut Stream) -> Vec<f64> {
    let (least, most) = rules.lot_width;
    let mut ends = vec![from];
    for (i, w) in run.line.windows(3).enumerate() {
        let at = run.along[i + 1];
        let turn = cross((w[1] - w[0]).normalize_or_zero(), (w[2] - w[1]).normalize_or_zero());
        let far_enough = at > ends[ends.len() - 1] + least * 0.6 && at < to - least * 0.6;
        if turn.abs() * (least + most) / 8.0 > SAGITTA && far_enough {
            ends.push(at);
        }
    }
    ends.push(to);
    let mut cuts = vec![from];
    for piece in ends.windows(2) {
        let length = piece[1] - piece[0];
        let mut widths: Vec<f64> = Vec::new();
        let mut sum = 0.0;
        while sum < length {
            let width = rng.range(least, most);
            widths.push(width);
            sum += width;
        }
        // The last one may be one too many to leave each its least width.
        if widths.len() > 1 && length / (widths.len() as f64) < least.max(0.6 * (least + most) / 2.0) {
            sum -= widths.pop().unwrap_or_default();
        }
        let mut at = piece[0];
        for (i, width) in widths.iter().enumerate() {
            at += width * length / sum;
            cuts.push(if i + 1 == widths.len() { piece[1] } else { at });
        }
    }
    cuts
}

struct Cutter<'a> {
    block: &'a BlockShape,
    rules: &'a ParcelRules,
    lots: Vec<LotShape>,
}

impl Cutter<'_> {
    /// Depth of a run's lots: the greatest, or less where that leaves the runs beside it room for a lot.
    fn depth(&self, run: &Run) -> f64 {
        let (depth, spare) = (self.rules.lot_depth, self.rules.lot_width.0 * 0.5 + 0.5);
        let (at, direction) = point_at(&run.line, run.length() / 2.0);
        let across = self.across(at, left_normal(direction), 2.0 * (depth + spare)) / 2.0;
        if across > depth && across < depth + spare { (across - spare).max(depth * 0.6) } else { depth }
    }

    /// Distance from `at` along unit `ray` to the border, at most `most`.
    fn across(&self, at: DVec2, ray: DVec2, most: f64) -> f64 {
        let points = &self.block.polygon;
        let mut best = most;
        for (i, &a) in points.iter().enumerate() {
            let ab = points[(i + 1) % points.len()] - a;
            let det = cross(ray, ab);
            if det <= 0.0 {
                continue;
            }
            let (t, u) = (cross(a - at, ab) / det, cross(a - at, ray) / det);
            if t > 0.1 && (0.0..=1.0).contains(&u) {
                best = best.min(t);
            }
        }
        best
    }

    /// Stretches of a run that no lot lies at.
    fn free(&self, run: &Run) -> Vec<(f64, f64)> {
        let mut taken: Vec<(f64, f64)> = Vec::new();
        for lot in &self.lots {
            let touching = lot.polygon.iter().filter_map(|p| {
                let (along, at) = closest_on_line(*p, &run.line);
                (at.distance_squared(*p) < BESIDE * BESIDE).then_some(along)
            });
            let (low, high) = touching.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)));
            if low < high {
                taken.push((low, high));
            }
        }
        taken.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        taken.push((run.length(), run.length()));
        let (mut at, mut out) = (0.0, Vec::new());
        for (low, high) in taken {
            if low - at >= self.rules.lot_width.0 * 0.6 {
                out.push((at, low));
            }
            at = high.max(at);
        }
        out
    }

    /// Adds the lot between `from` and `to` metres along a run if enough of it is left. `free` is the stretch it is on.
    fn lot(&mut self, run: &Run, from: f64, to: f64, free: (f64, f64), depth: f64) {
        let (a, b) = (point_at(&run.line, from).0, point_at(&run.line, to).0);
        let u = (b - a).normalize_or_zero();
        let front = Half { at: a, normal: left_normal(u) };
        let bend = |s: f64, p: DVec2| if s > from && s < to { front.depth(p) } else { 0.0 };
        // Where the border bends into the lot, the frontage keeps clear of it.
        let inset = run.along.iter().zip(&run.line).map(|(s, p)| bend(*s, *p)).fold(0.0, f64::max);
        let front = front.moved(inset);
        let (reach, n) = (u * (depth + b.distance(a)), front.normal);
        let mut lot = vec![
            front.at - reach,
            front.at + (b - a) + reach,
            front.at + (b - a) + reach + n * (depth - inset),
            front.at - reach + n * (depth - inset),
        ];
        let first = Half { at: a, normal: -run.ray(from, from == free.0 && from <= 0.01).perp() };
        let last = Half { at: b, normal: run.ray(to, to == free.1 && to >= run.length() - 0.01).perp() };
        lot = clip(&clip(&lot, first), last);
        if lot.is_empty() {
            return;
        }
        self.share(&mut lot, front, depth);
        let points = &self.block.polygon;
        for (i, &p) in points.iter().enumerate() {
            let q = points[(i + 1) % points.len()];
            let bounds = Bounds::of(lot.iter().copied());
            if !bounds.overlaps(Bounds::of([p, q])) {
                continue;
            }
            if let Some((p, q)) = segment_inside(&lot, p, q) {
                let near = if front.depth(p) < front.depth(q) { p } else { q };
                lot = best(&lot, front, [Half::left_of(p, q), Half { at: near, normal: -front.normal }]);
            }
        }
        for other in &self.lots {
            if overlap(&lot, &other.polygon) {
                lot = best(&lot, front, sides(&other.polygon).map(Half::flipped));
            }
        }
        self.accept(lot, front, run.street_at((from + to) / 2.0));
    }

    /// Leaves the land beyond the middle to the streets that a lot faces across the block, where it is deep enough for two.
    fn share(&self, lot: &mut Vec<DVec2>, front: Half, depth: f64) {
        let least = (self.rules.lot_depth * 0.35).clamp(8.0, 20.0);
        let u = -front.normal.perp();
        let span =
            lot.iter().filter(|p| front.depth(**p) < 0.01).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| {
                let x = (*p - front.at).dot(u);
                (l.min(x), h.max(x))
            });
        let points = &self.block.polygon;
        for (i, &a) in points.iter().enumerate() {
            let b = points[(i + 1) % points.len()];
            let side = Half::left_of(a, b);
            let facing = side.normal.dot(front.normal) < -0.6;
            if !facing || self.block.fronts[i].is_none() {
                continue;
            }
            // The stretch of the edge that lies in front of the lot.
            let (xa, xb) = ((a - front.at).dot(u), (b - front.at).dot(u));
            let t = |x: f64| ((x - xa) / (xb - xa)).clamp(0.0, 1.0);
            if xa.min(xb) >= span.1 || xa.max(xb) <= span.0 || xa == xb {
                continue;
            }
            let (p, q) = (a.lerp(b, t(span.0)), a.lerp(b, t(span.1)));
            let far = front.depth(p).max(front.depth(q));
            let near = front.depth(p).min(front.depth(q));
            if near < 0.1 || near > 2.0 * depth || far < 2.0 * least {
                continue;
            }
            // Nearer to the front than to the edge.
            let normal = side.normal - front.normal;
            let length = normal.length();
            let offset = side.at.dot(side.normal) - front.at.dot(front.normal);
            let half = Half { at: normal * (offset / (length * length)), normal: normal / length };
            let cut = clip(lot, half);
            if !cut.is_empty() && frontage(&cut, front).is_some() {
                *lot = cut;
            }
        }
    }

    /// Keeps a lot if it is large enough.
    fn accept(&mut self, mut lot: Vec<DVec2>, front: Half, street: usize) {
        let Some((edge, width)) = frontage(&lot, front) else { return };
        let area = signed_area(&lot);
        if width < self.rules.lot_width.0 * 0.55 || area < self.rules.min_area || area < width * 5.0 {
            return;
        }
        lot.rotate_left(edge);
        let block = self.block;
        let on_border = |i: &usize| {
            let (a, b) = (lot[*i], lot[(i + 1) % lot.len()]);
            let middle = (a + b) / 2.0;
            a.distance_squared(b) > 16.0
                && (0..block.polygon.len()).any(|j| {
                    let (p, q) = (block.polygon[j], block.polygon[(j + 1) % block.polygon.len()]);
                    let side = Half::left_of(p, q);
                    let along = (middle - p).dot(q - p) / p.distance_squared(q);
                    block.fronts[j].is_some()
                        && side.depth(middle).abs() < BESIDE / 2.0
                        && (0.0..=1.0).contains(&along)
                        && side.normal.dot(front.normal) < CORNER
                })
        };
        let corner = (1..lot.len()).find(on_border);
        self.lots.push(LotShape { polygon: lot, street, corner });
    }
}

/// Index and length of the edge of a lot that lies on its front.
fn frontage(lot: &[DVec2], front: Half) -> Option<(usize, f64)> {
    let on = |p: DVec2| front.depth(p).abs() < 0.01;
    (0..lot.len())
        .map(|i| (i, lot[i], lot[(i + 1) % lot.len()]))
        .filter(|(_, a, b)| on(*a) && on(*b))
        .map(|(i, a, b)| (i, a.distance(b)))
        .max_by(|x, y| x.1.total_cmp(&y.1).then(y.0.cmp(&x.0)))
}

/// The largest part of a lot that one of `halves` leaves, a part without frontage counting for nothing.
fn best(lot: &[DVec2], front: Half, halves: impl IntoIterator<Item = Half>) -> Vec<DVec2> {
    let mut best = (0.0, Vec::new());
    for half in halves {
        let part = clip(lot, half);
        let area = signed_area(&part);
        if area > best.0 && frontage(&part, front).is_some_and(|(_, width)| width > 3.0) {
            best = (area, part);
        }
    }
    best.1
}
