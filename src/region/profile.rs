//! How far the ground and noise let a settlement spread each way, before its neighbours are looked at.

use super::outline::smooth;
use super::river::{self, River};
use super::settlement::site::{Course, ray};
use crate::layer::Weigh;
use crate::region::{Settlement, SettlementSettings};
use crate::space::{Seed, math};
use crate::terrain::Terrain;
use glam::DVec2;
use std::f64::consts::TAU;

/// Distance between rays at the settlement's radius, in metres.
const SPACING: f64 = 60.0;
/// How far noise takes an outline from its average, as a share of the radius.
const NOISE: f64 = 0.17;

/// Reach of a settlement along rays that leave its centre evenly spread, in metres.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    /// Unit direction of each ray, counter-clockwise from east.
    pub ways: Vec<DVec2>,
    /// Reach of each, as ground and noise have it.
    pub reach: Vec<f64>,
    /// The same without spikes and notches: what an outline can really follow.
    even: Vec<f64>,
    /// A river that the settlement spreads over, and the reach of the rays with the other bank.
    pub over: Option<(River, Vec<f64>)>,
}

impl Weigh for Profile {
    fn bytes(&self) -> usize {
        let over = self
            .over
            .as_ref()
            .map_or(0, |(river, reach)| 3 * river.middle.len() * size_of::<DVec2>() + reach.len() * size_of::<f64>());
        size_of::<Self>() + self.ways.len() * (size_of::<DVec2>() + 2 * size_of::<f64>()) + over
    }
}

impl Profile {
    /// The profile of `of`: a function of the settlement, the ground within its radius, and the seed.
    pub fn new(seed: Seed, terrain: &dyn Terrain, settings: &SettlementSettings, of: &Settlement) -> Self {
        let rays = ((TAU * of.radius / SPACING / 4.0).ceil() as usize * 4).max(24);
        let ways: Vec<DVec2> = (0..rays).map(|i| math::direction(i as f64 / rays as f64 * TAU)).collect();
        let mut stream = seed.stream("outline", &[of.id.0]);
        // Harmonics of the circle; their amplitudes sum to at most 1.
        let waves = [(2.0, 0.4), (3.0, 0.3), (4.0, 0.2), (7.0, 0.1)]
            .map(|(k, most)| (k, most * stream.range(0.3, 1.0), stream.range(0.0, TAU)));
        let swing = NOISE.min(1.0 - settings.fullness);
        let limits: Vec<f64> = (0..rays)
            .map(|i| {
                let angle = i as f64 / rays as f64 * TAU;
                let noise: f64 = waves.iter().map(|(k, size, phase)| size * math::cos(k * angle + phase)).sum();
                of.radius * (settings.fullness + swing * noise).min(0.995)
            })
            .collect();
        let (centre, mut ground) = (of.centre.plan(), terrain.scan_ground());
        // Near the centre rays are close together: there every fourth, then every second, is followed for all.
        let mut reach = limits.clone();
        for (first, every, from) in [(0, 4, 0.0), (2, 4, 0.25), (1, 2, 0.5)] {
            for i in (first..rays).step_by(every) {
                let (way, limit) = (ways[i], limits[i]);
                let beside = [i + every / 2, i + rays - every / 2].map(|k| reach[k % rays]);
                let (least, mut from) = (beside[0].min(beside[1]), from * limit);
                let open = |k: usize| reach[k % rays] >= limits[k % rays];
                if every == 2 && open(i + 1) && open(i + rays - 1) {
                    // Nothing hinders its neighbours, 120 m apart at most.
                    continue;
                }
                if least < from {
                    reach[i] = least;
                    continue;
                }
                if from > 0.0 && ground(centre + way * from).depth() > 0.0 {
                    from = 0.0;
                }
                let course = Course { centre, way, from, limit, fine: f64::INFINITY };
                reach[i] = ray(&mut ground, course, settings.max_slope).reach;
            }
        }
        let mut even = reach.clone();
        smooth(&mut even);
        let spreads = of.radius >= river::LEAST_RADIUS && settings.widest_river > 0.0;
        let over = spreads
            .then(|| {
                river::spread(&mut ground, centre, (&ways, &reach, &limits), settings.max_slope, settings.widest_river)
            })
            .flatten();
        Self { ways, reach, even, over }
    }

    /// Whether a point, local to the settlement, is within reach without crossing a river.
    pub fn reaches(&self, local: DVec2) -> bool {
        let n = self.even.len();
        let at = math::angle_of(local).rem_euclid(TAU) / TAU * n as f64;
        let i = at.floor() as usize;
        local.length() <= self.even[i % n].min(self.even[(i + 1) % n])
    }
}
