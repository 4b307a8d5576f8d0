//! Blocks: a cell less the ground that its streets cover.

use crate::network::Street;
use crate::space::{Bounds, QUANTUM, closest_on_segment, cross, left_normal, segments, signed_area};
use crate::surface::cover;
use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;

/// Least area of a block, in square metres.
const MIN_AREA: f64 = 150.0;

/// Least width of a block, in metres.
const MIN_WIDTH: f64 = 6.0;

/// Distance between a block and the pavements around it, in metres, so that neither rounding to the quantum grid nor dropping
/// points on stretches that are straight within [`STRAIGHT`] brings a block onto a pavement.
const MARGIN: f64 = 0.012;

/// A point of a border is dropped if it is nearer than this to the line through its neighbours, in metres.
const STRAIGHT: f64 = 0.004;

/// A block.
pub(super) struct BlockShape {
    /// The border, counter-clockwise.
    pub polygon: Vec<DVec2>,
    /// For each edge of the border, the index of the street that it follows, if any.
    pub fronts: Vec<Option<usize>>,
}

/// The blocks of a cell, ordered by position.
pub(super) fn blocks(border: &[DVec2], streets: &[&Street]) -> Vec<BlockShape> {
    let bounds = Bounds::of(border.iter().copied());
    if border.len() < 3 || !bounds.size().is_finite() {
        return Vec::new();
    }
    let grid = Grid { origin: bounds.centre().floor() };
    let covered: Vec<Ring> = cover(streets, MARGIN).iter().map(|polygon| grid.ring(polygon)).collect();
    let mut shapes = grid.overlay(&[grid.ring(border)], &covered, OverlayRule::Difference);
    let mut out = Vec::new();
    while let Some(mut shape) = shapes.pop() {
        if shape.len() > 1 {
            // Streets that reach no border leave a hole. The shape is cut in two through the middle of its first hole.
            let hole = Bounds::of(shape[1].iter().map(|p| grid.point(p))).centre().x;
            for (low, high) in [(bounds.min.x, hole), (hole, bounds.max.x)] {
                let corners = [(low, bounds.min.y), (high, bounds.min.y), (high, bounds.max.y), (low, bounds.max.y)];
                let half = grid.ring(&corners.map(|(x, y)| DVec2::new(x, y)));
                shapes.extend(grid.overlay(&shape, &[half], OverlayRule::Intersect));
            }
            continue;
        }
        let Some(ring) = shape.pop() else { continue };
        let polygon = tidy(ring.iter().map(|p| grid.point(p)).collect());
        if polygon.len() >= 3 && signed_area(&polygon) >= MIN_AREA && width(&polygon) >= MIN_WIDTH {
            out.push(polygon);
        }
    }
    out.sort_by(|p, q| p[0].x.total_cmp(&q[0].x).then(p[0].y.total_cmp(&q[0].y)));
    let near: Vec<Bounds> = streets.iter().map(|s| s.bounds().grown(s.class.half_width() * 1.5 + 0.2)).collect();
    out.into_iter()
        .map(|polygon| {
            let fronts = (0..polygon.len())
                .map(|i| street_along(polygon[i], polygon[(i + 1) % polygon.len()], streets, &near))
                .collect();
            BlockShape { polygon, fronts }
        })
        .collect()
}

/// The quantum grid as integers around a whole-metre point.
struct Grid {
    origin: DVec2,
}

/// A closed line on the grid.
type Ring = Vec<IntPoint<i32>>;

impl Grid {
    fn ring(&self, points: &[DVec2]) -> Ring {
        let at = |p: DVec2| ((p - self.origin) / QUANTUM).round();
        points.iter().map(|p| IntPoint::new(at(*p).x as i32, at(*p).y as i32)).collect()
    }

    fn point(&self, p: &IntPoint<i32>) -> DVec2 {
        DVec2::new(f64::from(p.x), f64::from(p.y)) * QUANTUM + self.origin
    }

    /// The shapes of `subject` and `clip` under a rule. Each is an outer ring, counter-clockwise, followed by its holes.
    fn overlay(&self, subject: &[Ring], clip: &[Ring], rule: OverlayRule) -> Vec<Vec<Ring>> {
        let count = subject.iter().chain(clip).map(Vec::len).sum();
        let options = IntOverlayOptions { ogc: true, ..Default::default() };
        let mut overlay = Overlay::<i32>::new_custom(count, options, Default::default());
        subject.iter().for_each(|ring| overlay.add_contour(ring, ShapeType::Subject));
        clip.iter().for_each(|ring| overlay.add_contour(ring, ShapeType::Clip));
        overlay.overlay(rule, FillRule::NonZero)
    }
}

/// The ring, begun at its first corner by x and y, without doubled points, spikes and points on straight stretches.
fn tidy(mut ring: Vec<DVec2>) -> Vec<DVec2> {
    // The first corner always stays, so each point is judged between the last point kept and the next one.
    let first = (0..ring.len()).min_by(|&i, &j| ring[i].x.total_cmp(&ring[j].x).then(ring[i].y.total_cmp(&ring[j].y)));
    ring.rotate_left(first.unwrap_or(0));
    let mut changed = true;
    while changed && ring.len() > 3 {
        changed = false;
        let mut out = vec![ring[0]];
        let mut dropped: Vec<DVec2> = Vec::new();
        for (i, &p) in ring.iter().enumerate().skip(1) {
            let (before, after) = (out[out.len() - 1], ring[(i + 1) % ring.len()]);
            let base = after - before;
            let off = |q: &DVec2| cross(base, *q - before).abs() / base.length().max(QUANTUM);
            let spike = (p - before).dot(after - p) < 0.0 && off(&p) < 0.02;
            let straight = off(&p) < STRAIGHT && dropped.iter().all(|q| off(q) < STRAIGHT);
            if spike || p.distance_squared(before) < 1e-6 || straight {
                dropped.push(p);
                changed = true;
                continue;
            }
            dropped.clear();
            out.push(p);
        }
        ring = out;
    }
    ring
}

/// Width of a polygon in metres: its least extent across any of its edges, but no more than its area and perimeter allow.
fn width(polygon: &[DVec2]) -> f64 {
    let edges = || (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]));
    let across = edges()
        .map(|(a, b)| {
            let n = left_normal((b - a).normalize_or_zero());
            let (low, high) = polygon
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p.dot(n)), high.max(p.dot(n))));
            high - low
        })
        .fold(f64::INFINITY, f64::min);
    // 2 area / perimeter is about w for a strip of width w, and w / 2 for a square of edge w.
    let around: f64 = edges().map(|(a, b)| a.distance(b)).sum();
    across.min(4.0 * signed_area(polygon) / around)
}

/// Index of the street whose outer edge the border edge `a`-`b` follows. `near` are boxes around the streets.
fn street_along(a: DVec2, b: DVec2, streets: &[&Street], near: &[Bounds]) -> Option<usize> {
    let middle = (a + b) / 2.0;
    let inwards = left_normal(b - a);
    let mut best: Option<(f64, usize)> = None;
    for (i, street) in streets.iter().enumerate() {
        if !near[i].contains(middle) || street.tunnel {
            continue;
        }
        let half = street.class.half_width();
        let (at, distance) = nearest_point(middle, &street.line);
        let excess = distance - half;
        // A short edge may be the tip of a mitre, which lies farther out.
        let allowed = if a.distance_squared(b) < 36.0 { half * 0.45 } else { 0.1 };
        if excess < allowed && (at - middle).dot(inwards) < 0.0 && best.is_none_or(|(e, _)| excess < e) {
            best = Some((excess, i));
        }
    }
    best.map(|(_, i)| i)
}

/// The point of a line nearest to `p`, and its distance.
fn nearest_point(p: DVec2, line: &[DVec2]) -> (DVec2, f64) {
    let (at, squared) = segments(line)
        .map(|(a, b)| closest_on_segment(p, a, b).1)
        .map(|q| (q, q.distance_squared(p)))
        .fold((DVec2::ZERO, f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best });
    (at, squared.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{JunctionId, StreetClass, StreetId};

    #[test]
    fn a_slight_bend_at_a_junction_stays_a_bend() {
        let at = [DVec2::new(-42.0, -49.25), DVec2::ZERO, DVec2::new(33.25, 40.25)];
        let street = |i: usize| {
            let (from, to) = (JunctionId(i as u64), JunctionId(i as u64 + 1));
            Street::new(StreetId(i as u64), StreetClass::Arterial, from, to, vec![at[i], at[i + 1]])
        };
        let (a, b) = (street(0), street(1));
        let border = [at[0], DVec2::new(58.0, -49.25), DVec2::new(58.0, 40.25), at[2], at[1]];
        let found = blocks(&border, &[&a, &b]);
        assert_eq!(found.len(), 1);
        let polygon = &found[0].polygon;
        let edges = (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]));
        let nearest = edges.map(|(p, q)| crate::space::distance_to_segment(DVec2::ZERO, p, q)).fold(99.0, f64::min);
        assert!(nearest >= StreetClass::Arterial.half_width(), "{nearest}");
    }
}
