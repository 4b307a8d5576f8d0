//! How far ground and noise let a settlement extend in each direction, before its neighbours are considered.

use super::river::{self, River};
use crate::layer::Weigh;
use crate::region::settlement::radii::even_out;
use crate::region::settlement::ray::{Detail, Ray};
use crate::region::settlement::{Settlement, SettlementSettings};
use crate::space::{Seed, math};
use crate::terrain::Terrain;
use glam::DVec2;
use std::f64::consts::TAU;

/// Distance in metres between rays, measured at the settlement's radius.
const SPACING: f64 = 60.0;
/// Greatest deviation of an outline from its average, as a share of the radius.
const NOISE: f64 = 0.17;

/// How far a settlement extends along rays that leave its centre, spread evenly, in metres.
#[derive(Clone, Debug)]
pub(in crate::region) struct Profile {
    /// Unit direction of each ray, counter-clockwise from east.
    pub directions: Vec<DVec2>,
    /// Reach of each ray, limited by ground and noise.
    pub reach: Vec<f64>,
    /// The same without spikes and notches: what an outline can really follow.
    even: Vec<f64>,
    /// A river that the settlement spreads across_river, with the reach of the rays when they cross it.
    pub across_river: Option<(River, Vec<f64>)>,
}

impl Weigh for Profile {
    fn bytes(&self) -> usize {
        let across_river = self
            .across_river
            .as_ref()
            .map_or(0, |(river, reach)| 3 * river.middle.len() * size_of::<DVec2>() + reach.len() * size_of::<f64>());
        size_of::<Self>() + self.directions.len() * (size_of::<DVec2>() + 2 * size_of::<f64>()) + across_river
    }
}

impl Profile {
    /// The profile of `of`. It depends on the settlement, the ground within its radius and the seed.
    pub fn new(seed: Seed, terrain: &dyn Terrain, settings: &SettlementSettings, of: &Settlement) -> Self {
        let rays = ((TAU * of.radius / SPACING / 4.0).ceil() as usize * 4).max(24);
        let directions: Vec<DVec2> = (0..rays).map(|i| math::direction(i as f64 / rays as f64 * TAU)).collect();
        let mut stream = seed.stream("outline", &[of.id.0]);
        // Harmonics of the circle. Their amplitudes sum to at most 1.
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
        // Near the centre the rays lie close together: there every fourth, then every second, stands for all.
        let mut reach = limits.clone();
        for (first, every, from) in [(0, 4, 0.0), (2, 4, 0.25), (1, 2, 0.5)] {
            for i in (first..rays).step_by(every) {
                let (way, limit) = (directions[i], limits[i]);
                let beside = [i + every / 2, i + rays - every / 2].map(|k| reach[k % rays]);
                let (least, mut from) = (beside[0].min(beside[1]), from * limit);
                let open = |k: usize| reach[k % rays] >= limits[k % rays];
                if every == 2 && open(i + 1) && open(i + rays - 1) {
                    // Nothing stops its neighbours, which are at most 120 m apart.
                    continue;
                }
                if least < from {
                    reach[i] = least;
                    continue;
                }
                if from > 0.0 && ground(centre + way * from).depth() > 0.0 {
                    from = 0.0;
                }
                let ray = Ray { centre, direction: way, from, limit, detail: Detail::Full };
                reach[i] = ray.cast(&mut ground, settings.max_slope).reach;
            }
        }
        let mut even = reach.clone();
        even_out(&mut even);
        let spreads = of.radius >= river::LEAST_RADIUS && settings.widest_river > 0.0;
        let across_river = spreads
            .then(|| {
                river::find(
                    &mut ground,
                    centre,
                    (&directions, &reach, &limits),
                    settings.max_slope,
                    settings.widest_river,
                )
            })
            .flatten();
        Self { directions, reach, even, across_river }
    }

    /// Whether a point, local to the settlement, lies within reach without crossing a river.
    pub fn reaches(&self, local: DVec2) -> bool {
        let n = self.even.len();
        let at = math::angle_of(local).rem_euclid(TAU) / TAU * n as f64;
        let i = at.floor() as usize;
        local.length() <= self.even[i % n].min(self.even[(i + 1) % n])
    }
}
