//! Outlines of settlements: star-shaped polygons that noise, water, steep ground and neighbours give their form.

use super::settlement::site::{Course, SHORE, ray};
use crate::region::Settlement;
use crate::space::{Bounds, Origin, Seed, distance_to_segment, math, point_in_polygon, quantize, signed_area};
use crate::terrain::Terrain;
use glam::DVec2;
use std::f64::consts::TAU;

/// Distance kept to the line between two settlements, in metres.
pub(super) const BORDER: f64 = 40.0;
/// Distance between rays, and the distance aimed at between vertices, in metres.
const SPACING: f64 = 60.0;
/// Least and greatest distance between neighbouring vertices, in metres.
const VERTEX_DISTANCE: (f64, f64) = (40.0, 90.0);
/// Greatest change of the radius per radian, in radii: neither spikes nor notches.
const STEEPEST: f64 = 0.85;
/// Share of the radius that the outline of an unhindered settlement has on average, and how far noise takes it from that.
const ROUND: (f64, f64) = (0.83, 0.17);

/// The outline of a settlement: a polygon, star-shaped about the centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Origin the polygon is local to: the settlement's centre.
    pub origin: Origin,
    /// Counter-clockwise, on the quantum grid, neighbours 40 to 90 m apart, star-shaped about (0, 0).
    pub polygon: Vec<DVec2>,
}

impl Outline {
    /// Box around the outline, in plan metres.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.polygon.iter().copied()).moved(self.origin.plan())
    }

    /// Whether a plan point lies inside.
    pub fn contains(&self, plan: DVec2) -> bool {
        point_in_polygon(self.origin.to_local(plan), &self.polygon)
    }

    /// Distance from a plan point to the outline in metres: positive inside, negative outside.
    pub fn clearance(&self, plan: DVec2) -> f64 {
        let p = self.origin.to_local(plan);
        let n = self.polygon.len();
        let edges = (0..n).map(|i| distance_to_segment(p, self.polygon[i], self.polygon[(i + 1) % n]));
        let distance = edges.fold(f64::INFINITY, f64::min);
        if point_in_polygon(p, &self.polygon) { distance } else { -distance }
    }

    /// Area in square metres.
    pub fn area(&self) -> f64 {
        signed_area(&self.polygon)
    }

    /// The outline of `settlement` among its `neighbours`, which must hold every settlement whose circle comes within
    /// twice [`BORDER`] of its own.
    pub(super) fn new(
        seed: Seed,
        terrain: &dyn Terrain,
        max_slope: f64,
        settlement: &Settlement,
        neighbours: &[impl AsRef<Settlement>],
    ) -> Self {
        let radius = settlement.radius;
        let rays = ((TAU * radius / SPACING / 4.0).ceil() as usize * 4).max(24);
        let ways: Vec<DVec2> = (0..rays).map(|i| math::direction(i as f64 / rays as f64 * TAU)).collect();
        let mut reach = natural_reach(seed, terrain, max_slope, settlement, &ways);
        for other in neighbours.iter().map(AsRef::as_ref).filter(|n| n.id != settlement.id) {
            let offset = other.centre.offset_to(settlement.centre);
            let border = power_line(offset.length(), radius, other.radius) - BORDER;
            let toward = offset.normalize_or_zero();
            for (r, way) in reach.iter_mut().zip(&ways) {
                let facing = way.dot(toward);
                if facing * *r > border {
                    *r = border.max(0.0) / facing;
                }
            }
        }
        smooth(&mut reach);
        let curve: Vec<DVec2> = ways.iter().zip(&reach).map(|(way, r)| *way * *r).collect();
        Self { origin: settlement.centre, polygon: vertices(terrain, settlement.centre, &curve) }
    }
}

/// Distance from the centre of a circle to the line that parts it from another circle in their power diagram. The
/// circles' centres are `apart`, their radii `own` and `other`.
pub(super) fn power_line(apart: f64, own: f64, other: f64) -> f64 {
    (apart * apart + own * own - other * other) / (2.0 * apart)
}

/// How far noise and ground let a settlement go each way.
fn natural_reach(seed: Seed, terrain: &dyn Terrain, max_slope: f64, of: &Settlement, ways: &[DVec2]) -> Vec<f64> {
    let mut stream = seed.stream("outline", &[of.id.0]);
    // Harmonics of the circle; their amplitudes sum to at most 1.
    let waves = [(2.0, 0.4), (3.0, 0.3), (4.0, 0.2), (7.0, 0.1)]
        .map(|(k, most)| (k, most * stream.range(0.3, 1.0), stream.range(0.0, TAU)));
    let (centre, mut ground) = (of.centre.plan(), terrain.scan());
    let limits: Vec<f64> = (0..ways.len())
        .map(|i| {
            let angle = i as f64 / ways.len() as f64 * TAU;
            let noise: f64 = waves.iter().map(|(k, amplitude, phase)| amplitude * math::cos(k * angle + phase)).sum();
            of.radius * (ROUND.0 + ROUND.1 * noise).min(0.995)
        })
        .collect();
    // Near the centre rays are close together: there every fourth, then every second, is followed for all.
    let mut reach = limits.clone();
    for (first, every, from) in [(0, 4, 0.0), (2, 4, 0.25), (1, 2, 0.5)] {
        for i in (first..ways.len()).step_by(every) {
            let (way, limit) = (ways[i], limits[i]);
            let beside = [i + every / 2, i + ways.len() - every / 2].map(|k| reach[k % ways.len()]);
            let (least, mut from) = (beside[0].min(beside[1]), from * limit);
            if from > 0.0 && least < from {
                reach[i] = least;
                continue;
            }
            if from > 0.0 && ground(centre + way * from).depth() > 0.0 {
                from = 0.0;
            }
            let course = Course { centre, way, from, limit, fine: f64::INFINITY };
            reach[i] = ray(&mut ground, course, max_slope).reach;
        }
    }
    reach
}

/// Takes spikes off: no radius is much greater than its neighbours', none greater than it was.
pub(super) fn smooth(reach: &mut [f64]) {
    let n = reach.len();
    let growth = 1.0 + STEEPEST * TAU / n as f64;
    let limit = |reach: &mut [f64]| {
        // Twice around each way, so that a limit carries over the start.
        for i in 0..2 * n {
            reach[(i + 1) % n] = reach[(i + 1) % n].min(reach[i % n] * growth);
        }
        for i in (0..2 * n).rev() {
            reach[i % n] = reach[i % n].min(reach[(i + 1) % n] * growth);
        }
    };
    limit(reach);
    for _ in 0..3 {
        let before = reach.to_vec();
        for i in 0..n {
            let mean = (before[(i + n - 1) % n] + 2.0 * before[i] + before[(i + 1) % n]) / 4.0;
            reach[i] = reach[i].min(mean);
        }
    }
    limit(reach);
}

/// Vertices along the closed `curve`, evenly spaced, drawn in to dry ground where a chord cuts a bay.
fn vertices(terrain: &dyn Terrain, origin: Origin, curve: &[DVec2]) -> Vec<DVec2> {
    let mut along = vec![0.0];
    for i in 0..curve.len() {
        along.push(along[i] + curve[i].distance(curve[(i + 1) % curve.len()]));
    }
    let length = along[curve.len()];
    let wanted = (length / SPACING).round().max(3.0);
    let mut best: Option<(f64, Vec<DVec2>)> = None;
    // Numbers of vertices, the wanted one first, then outwards.
    for k in 0..24 {
        let n = wanted + f64::from(k / 2 + k % 2) * if k % 2 == 1 { 1.0 } else { -1.0 };
        if n < 3.0 {
            continue;
        }
        let polygon: Vec<DVec2> = (0..n as usize)
            .map(|i| dry_point(terrain, origin, on_curve(curve, &along, i as f64 / n * length)))
            .collect();
        let edges = (0..polygon.len()).map(|i| polygon[i].distance(polygon[(i + 1) % polygon.len()]));
        let (least, greatest) = edges.fold((f64::INFINITY, 0.0f64), |(l, g), d| (l.min(d), g.max(d)));
        let off = (VERTEX_DISTANCE.0 - least).max(greatest - VERTEX_DISTANCE.1);
        if best.as_ref().is_none_or(|b| off < b.0) {
            best = Some((off, polygon));
        }
        if off <= 0.0 {
            break;
        }
    }
    best.map(|b| b.1).unwrap_or_default()
}

/// The point `at` metres along the closed curve whose points lie at `along`.
fn on_curve(curve: &[DVec2], along: &[f64], at: f64) -> DVec2 {
    let i = (along.partition_point(|a| *a <= at).max(1) - 1).min(curve.len() - 1);
    let length = along[i + 1] - along[i];
    let t = if length > 0.0 { (at - along[i]) / length } else { 0.0 };
    curve[i].lerp(curve[(i + 1) % curve.len()], t)
}

/// `local` drawn towards the centre until it is dry.
fn dry_point(terrain: &dyn Terrain, origin: Origin, local: DVec2) -> DVec2 {
    let way = local.normalize_or_zero();
    let mut p = quantize(local);
    for _ in 0..40 {
        if terrain.sample(origin.to_plan(p)).depth() == 0.0 {
            break;
        }
        p = quantize(p - way * (SHORE / 5.0).min(p.length() / 2.0));
    }
    p
}
