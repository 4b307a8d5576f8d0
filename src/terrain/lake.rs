//! Lakes: basins on a jittered lattice, each with a level of its own and a rim above it.

use super::TerrainSettings;
use super::field::{Corners, Octaves, Places, draw, floor};
use super::noise::Shape;
use crate::layer::{LayerCache, LayerError, Weigh};
use crate::space::{Seed, math};
use glam::DVec2;

/// How far a lake changes the ground, in radii along its shorter axis.
const INFLUENCE: f64 = 2.2;
/// How far, in radii, the level of a lake holds: from its shore to well up its rim.
const SHORE: f64 = 1.4;
/// Greatest distance, in radii, by which noise moves the shore.
const BENT: f64 = 0.55;
/// Greatest length of a lake over its width.
const STRETCH: f64 = 1.5;
/// Distance from the centre, in radii, beyond which a lake changes nothing.
const REACH: f64 = (INFLUENCE + BENT) * STRETCH;
/// Memory of the lakes that were looked at, in bytes.
const CACHE_BYTES: usize = 1 << 20;

/// Where a lake may lie: drawn for each cell without a look at the ground.
#[derive(Clone, Copy, Debug)]
struct Basin {
    centre: DVec2,
    radius: f64,
    /// Heading of its greater length, in radians.
    heading: f64,
    stretch: f64,
}

impl Basin {
    /// Unit vector along its greater length.
    fn axis(&self) -> DVec2 {
        math::direction(self.heading)
    }

    /// The plan point at `local`, in radii along the greater length and across it, unbent.
    fn plan(&self, local: DVec2) -> DVec2 {
        self.centre + self.axis().rotate(local * DVec2::new(self.stretch, 1.0) * self.radius)
    }
}

/// Level of the lake of a cell; `None` where the ground allows none.
#[derive(Debug)]
struct Level(Option<f64>);

impl Weigh for Level {
    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}

/// The lakes of a world.
#[derive(Debug)]
pub(super) struct Lakes {
    seeds: [u64; 3],
    spacing: f64,
    share: f64,
    radius: (f64, f64),
    bend: Octaves<2>,
    /// Memory only: what is in it never changes a result.
    levels: LayerCache<[i64; 2], Level>,
}

impl Lakes {
    pub fn new(seed: Seed, s: &TerrainSettings, places: &mut Places) -> Self {
        let mut stream = seed.stream("terrain", &[40]);
        let wavelength = (s.lake_radius.0 + s.lake_radius.1) * 0.75;
        Self {
            seeds: [stream.bits(), stream.bits(), stream.bits()],
            spacing: s.lake_spacing,
            share: s.lake_share,
            radius: s.lake_radius,
            bend: Octaves::new(seed, [(41, wavelength), (42, wavelength)], places),
            levels: LayerCache::new(CACHE_BYTES),
        }
    }

    /// The basin of a cell. All that a lake changes lies within its cell.
    fn basin(&self, cell: [i64; 2]) -> Option<Basin> {
        let [size, place, shape] = self.seeds.map(|s| (draw(s, cell) + 1.0) / 2.0);
        if size.x >= self.share {
            return None;
        }
        // Small lakes are more common than large ones.
        let radius = math::mix(self.radius.0, self.radius.1, size.y * size.y);
        let room = self.spacing / 2.0 - REACH * radius;
        let corner = DVec2::new(cell[0] as f64, cell[1] as f64);
        Some(Basin {
            centre: (corner + 0.5) * self.spacing + (place * 2.0 - 1.0) * room,
            radius,
            heading: shape.x * std::f64::consts::TAU,
            stretch: math::mix(1.0, STRETCH, shape.y),
        })
    }

    /// Level of a lake: just below the lowest ground around it, if no other water is near and the ground gentle enough.
    fn level(&self, basin: &Basin, ground: impl Fn(DVec2) -> Shape) -> Option<f64> {
        let directions = ((basin.radius * 0.05).ceil() as usize).clamp(12, 48);
        let (mut low, mut high, mut table) = (f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY);
        for ring in [0.0, 0.5, 1.1, 1.7, INFLUENCE + 0.1] {
            for i in 0..if ring == 0.0 { 1 } else { directions } {
                let local = math::direction(i as f64 / directions as f64 * std::f64::consts::TAU) * ring;
                let shape = ground(basin.plan(local));
                if shape.dry < 0.4 {
                    return None;
                }
                table = table.max(shape.table);
                high = high.max(shape.height);
                if ring > 0.9 {
                    low = low.min(shape.height);
                }
            }
        }
        let level = low - 1.0;
        (level > table + 0.5 && high - level < 6.0 + 0.12 * basin.radius).then_some(level)
    }

    /// Centre, axes and level of the lake of a cell.
    #[cfg(test)]
    pub fn lake(&self, cell: [i64; 2], ground: impl Fn(DVec2) -> Shape) -> Option<(DVec2, f64, f64)> {
        let basin = self.basin(cell)?;
        Some((basin.centre, basin.radius, self.level(&basin, ground)?))
    }

    /// Height and water level at `p` once lakes are laid into the ground `shape`; `ground` gives it elsewhere.
    pub fn lay(
        &self,
        p: DVec2,
        shape: &Shape,
        corners: &mut impl Corners,
        ground: impl Fn(DVec2) -> Shape,
    ) -> (f64, f64) {
        let dry = (shape.height, shape.table);
        let cell = (p / self.spacing).to_array().map(|x| floor(x) as i64);
        let Some(basin) = self.basin(cell) else { return dry };
        let (offset, radius) = (p - basin.centre, basin.radius);
        if offset.length_squared() >= (REACH * radius) * (REACH * radius) {
            return dry;
        }
        let level = self.levels.get(&cell, || Ok::<_, LayerError>(Level(self.level(&basin, ground))));
        let Ok(Some(level)) = level.map(|l| l.0) else { return dry };

        // Distance from the centre in radii, 1 on the shore.
        let axis = basin.axis();
        let unbent = DVec2::new(offset.dot(axis) / basin.stretch, offset.dot(axis.perp())) / radius;
        let bend = DVec2::from(self.bend.at(p, corners)) * 0.6;
        let q = (unbent + bend.clamp_length_max(BENT)).length();
        if q >= INFLUENCE {
            return dry;
        }
        if q < 1.0 {
            return (level - (2.0 + 0.018 * radius) * (1.0 - q * q), level);
        }
        let bank = level + (0.05 * radius * (q - 1.0)).min(3.0);
        // The rim stands above the level all around, also where the ground between the places looked at is lower.
        let rim = level + (0.03 * radius * (q - 1.0)).min(1.0) - 0.15 * radius * (q - 1.5).max(0.0);
        let height = math::mix(bank, shape.height, math::smoothstep(1.0, INFLUENCE, q)).max(rim);
        (height, if q < SHORE { level } else { shape.table })
    }
}
