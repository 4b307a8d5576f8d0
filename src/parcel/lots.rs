//! Lots: strips along the streets of a block, cut across into parcels that each front a street.
//!
//! The runs of the block's border take turns, the longest first. A run is cut into frontages, and each frontage takes the land
//! behind it: as far as the middle of the block or the greatest depth, whichever is nearer, up to the block's border and up to
//! earlier lots. Land that no frontage takes stays a courtyard.

use crate::parcel::blocks::BlockShape;
use crate::parcel::convex::{HalfPlane, clip, overlap, segment_inside, sides};
use crate::parcel::runs::{CORNER, Run, runs};
use crate::space::{
    Bounds, Stream, closest_on_line, cross, distance_to_segment, left_normal, point_at, point_in_polygon, signed_area,
};
use crate::style::ParcelRules;
use glam::DVec2;

/// Greatest distance between a frontage and the bend of the border that it cuts off, in metres. Sharper bends divide lots.
const SAGITTA: f64 = 1.5;

/// Corners of a lot within this distance of a run, in metres, take up the stretch of the run between them.
const ON_RUN: f64 = 3.0;

/// A lot: a convex polygon whose first edge is the frontage.
pub(super) struct LotShape {
    pub polygon: Vec<DVec2>,
    /// Index of the street that the frontage lies on.
    pub street: usize,
    /// Index of another edge that lies on a street.
    pub corner: Option<usize>,
    /// Box around the polygon.
    bounds: Bounds,
}

/// Cuts a block into lots.
pub(super) fn lots(block: &BlockShape, rules: &ParcelRules, rng: &mut Stream) -> Vec<LotShape> {
    let mut runs = runs(block);
    runs.sort_by(|a, b| b.length().total_cmp(&a.length()).then(a.line[0].x.total_cmp(&b.line[0].x)));
    let mut cutter = Cutter { block, sides: sides(&block.polygon).collect(), rules, lots: Vec::new() };
    for run in &runs {
        let depth = cutter.depth(run);
        for (from, to) in cutter.free(run) {
            let cuts = follow(run, frontages(run, from, to, rules, rng));
            for cut in cuts.windows(2) {
                cutter.lot(run, cut[0], cut[1], (from, to), depth);
            }
        }
    }
    cutter.lots
}

/// Where the stretch from `from` to `to` metres of a run is cut: at sharp bends, and at random widths between them.
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
        // With the last lot, the lots may be too narrow.
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

/// Cuts more, so that no frontage leaves its run by more than [`ON_RUN`]: wide lots on a curve become narrower.
fn follow(run: &Run, cuts: Vec<f64>) -> Vec<f64> {
    let mut out = vec![cuts[0]];
    let mut rest: Vec<f64> = cuts[1..].iter().rev().copied().collect();
    while let Some(&to) = rest.last() {
        let from = out[out.len() - 1];
        let (a, b) = (point_at(&run.line, from).0, point_at(&run.line, to).0);
        let between = run.along.iter().zip(&run.line).filter(|(s, _)| **s > from + 0.01 && **s < to - 0.01);
        let off = between.map(|(s, p)| (distance_to_segment(*p, a, b), *s));
        match off.max_by(|x, y| x.0.total_cmp(&y.0)) {
            Some((off, at)) if off > ON_RUN => rest.push(at),
            _ => out.extend(rest.pop()),
        }
    }
    out
}

/// Cuts a block into lots, and collects them.
struct Cutter<'a> {
    block: &'a BlockShape,
    /// The half-planes inside the edges of the block.
    sides: Vec<HalfPlane>,
    rules: &'a ParcelRules,
    lots: Vec<LotShape>,
}

impl Cutter<'_> {
    /// Depth of a run's lots in metres: the greatest depth that the rules allow, or less where this leaves room for a lot behind.
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

    /// The stretches of a run without lots, each from and to in metres along the run.
    fn free(&self, run: &Run) -> Vec<(f64, f64)> {
        let near = Bounds::of(run.line.iter().copied()).grown(ON_RUN);
        let mut taken: Vec<(f64, f64)> = Vec::new();
        for lot in self.lots.iter().filter(|lot| lot.bounds.overlaps(near)) {
            let touching = lot.polygon.iter().filter_map(|p| {
                let (along, at) = closest_on_line(*p, &run.line);
                (at.distance_squared(*p) < ON_RUN * ON_RUN).then_some(along)
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

    /// Adds the lot between `from` and `to` metres along a run, if enough of it is left. `free` is the free stretch of the run
    /// around it, and `depth` the depth of the run's lots in metres.
    fn lot(&mut self, run: &Run, from: f64, to: f64, free: (f64, f64), depth: f64) {
        let (a, b) = (point_at(&run.line, from).0, point_at(&run.line, to).0);
        let u = (b - a).normalize_or_zero();
        let front = HalfPlane { at: a, normal: left_normal(u) };
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
        let first = HalfPlane { at: a, normal: -run.ray(from, from == free.0 && from <= 0.01).perp() };
        let last = HalfPlane { at: b, normal: run.ray(to, to == free.1 && to >= run.length() - 0.01).perp() };
        lot = clip(&clip(&lot, first), last);
        if lot.is_empty() {
            return;
        }
        self.share(&mut lot, front, depth);
        let mut bounds = Bounds::of(lot.iter().copied());
        let points = &self.block.polygon;
        for (i, &p) in points.iter().enumerate() {
            let q = points[(i + 1) % points.len()];
            if !bounds.overlaps(Bounds::of([p, q])) {
                continue;
            }
            if let Some((p, q)) = segment_inside(&lot, p, q) {
                let near = if front.depth(p) < front.depth(q) { p } else { q };
                lot = best(&lot, front, [HalfPlane::left_of(p, q), HalfPlane { at: near, normal: -front.normal }]);
                bounds = Bounds::of(lot.iter().copied());
            }
        }
        for other in &self.lots {
            if bounds.overlaps(other.bounds) && overlap(&lot, &other.polygon) {
                lot = best(&lot, front, sides(&other.polygon).map(HalfPlane::flipped));
                bounds = Bounds::of(lot.iter().copied());
            }
        }
        self.accept(lot, front, run.street_at((from + to) / 2.0));
    }

    /// Cuts a lot off halfway to the streets on the other side of the block, where the block is deep enough for two lots.
    fn share(&self, lot: &mut Vec<DVec2>, front: HalfPlane, depth: f64) {
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
            let side = self.sides[i];
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
            // The half-plane of points that are nearer to the front than to the edge.
            let normal = side.normal - front.normal;
            let length = normal.length();
            let offset = side.at.dot(side.normal) - front.at.dot(front.normal);
            let half = HalfPlane { at: normal * (offset / (length * length)), normal: normal / length };
            let cut = clip(lot, half);
            if !cut.is_empty() && frontage(&cut, front).is_some() {
                *lot = cut;
            }
        }
    }

    /// Keeps a lot if it is large enough.
    fn accept(&mut self, mut lot: Vec<DVec2>, front: HalfPlane, street: usize) {
        let Some((edge, width)) = frontage(&lot, front) else { return };
        let area = signed_area(&lot);
        if width < self.rules.lot_width.0 * 0.55 || area < self.rules.min_area || area < width * 5.0 {
            return;
        }
        // No edge of the border runs through the lot, so any point of it tells on which side of the border it lies: a frontage
        // that keeps clear of a bend may lie beyond a shallow block.
        if !point_in_polygon(lot.iter().sum::<DVec2>() / lot.len() as f64, &self.block.polygon) {
            return;
        }
        lot.rotate_left(edge);
        let block = self.block;
        let on_border = |i: &usize| {
            let (a, b) = (lot[*i], lot[(i + 1) % lot.len()]);
            let middle = (a + b) / 2.0;
            a.distance_squared(b) > 16.0
                && self.sides.iter().enumerate().any(|(j, side)| {
                    let (p, q) = (block.polygon[j], block.polygon[(j + 1) % block.polygon.len()]);
                    let along = || (middle - p).dot(q - p) / p.distance_squared(q);
                    block.fronts[j].is_some()
                        && side.depth(middle).abs() < ON_RUN / 2.0
                        && (0.0..=1.0).contains(&along())
                        && side.normal.dot(front.normal) < CORNER
                })
        };
        let corner = (1..lot.len()).find(on_border);
        let bounds = Bounds::of(lot.iter().copied());
        self.lots.push(LotShape { polygon: lot, street, corner, bounds });
    }
}

/// Index and length of the edge of a lot that lies on its front.
fn frontage(lot: &[DVec2], front: HalfPlane) -> Option<(usize, f64)> {
    let on = |p: DVec2| front.depth(p).abs() < 0.01;
    (0..lot.len())
        .map(|i| (i, lot[i], lot[(i + 1) % lot.len()]))
        .filter(|(_, a, b)| on(*a) && on(*b))
        .map(|(i, a, b)| (i, a.distance(b)))
        .max_by(|x, y| x.1.total_cmp(&y.1).then(y.0.cmp(&x.0)))
}

/// The largest part of a lot inside one of `halves` that still has a frontage; empty if there is none.
fn best(lot: &[DVec2], front: HalfPlane, halves: impl IntoIterator<Item = HalfPlane>) -> Vec<DVec2> {
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
