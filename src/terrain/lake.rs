//! Lakes: basins on a jittered lattice, each with a level of its own and a rim above it.

use super::field::{Corners, Octaves, Slots, floor, lattice_random};
use super::ground::Shape;
use super::settings::TerrainSettings;
use crate::layer::{LayerCache, LayerError, Weigh};
use crate::space::{Seed, math};
use glam::DVec2;

/// Distance from the centre up to which a lake changes the ground, in radii along its shorter axis.
const INFLUENCE: f64 = 2.2;
/// Distance from the centre, in radii, up to which the water level of a lake applies: beyond the shore, up its rim.
const SHORE: f64 = 1.4;
/// Greatest distance, in radii, by which noise moves the shore.
const WARP: f64 = 0.55;
/// Greatest ratio of a lake's length to its width.
const STRETCH: f64 = 1.5;
/// Distance from the centre, in radii, beyond which a lake changes nothing.
const REACH: f64 = (INFLUENCE + WARP) * STRETCH;
/// Memory for the levels of lakes, in bytes.
const CACHE_BYTES: usize = 1 << 20;

/// A place where a lake may lie, drawn for a cell without reading the ground.
#[derive(Clone, Copy, Debug)]
struct Basin {
    centre: DVec2,
    radius: f64,
    /// Direction of the longer axis, in radians.
    heading: f64,
    stretch: f64,
}

impl Basin {
    /// Unit vector along the longer axis.
    fn axis(&self) -> DVec2 {
        math::direction(self.heading)
    }

    /// The plan point at `local`, given in radii along both axes before noise moves the shore.
    fn plan(&self, local: DVec2) -> DVec2 {
        self.centre + self.axis().rotate(local * DVec2::new(self.stretch, 1.0) * self.radius)
    }
}

/// Water level of the lake of a cell; `None` if the ground allows no lake.
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
    /// A cache, which never changes a result.
    levels: LayerCache<[i64; 2], Level>,
}

impl Lakes {
    pub fn new(seed: Seed, s: &TerrainSettings, slots: &mut Slots) -> Self {
        let mut stream = seed.stream("terrain", &[40]);
        let wavelength = (s.lake_radius.0 + s.lake_radius.1) * 0.75;
        Self {
            seeds: [stream.bits(), stream.bits(), stream.bits()],
            spacing: s.lake_spacing,
            share: s.lake_share,
            radius: s.lake_radius,
            bend: Octaves::new(seed, [(41, wavelength), (42, wavelength)], slots),
            levels: LayerCache::new(CACHE_BYTES),
        }
    }

    /// The basin of a cell. A lake changes nothing outside its cell.
    fn basin(&self, cell: [i64; 2]) -> Option<Basin> {
        let [size, place, shape] = self.seeds.map(|s| (lattice_random(s, cell) + 1.0) / 2.0);
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

    /// Water level of a lake: just below the lowest ground around it. `None` if other water is near or the ground is too steep.
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

    /// Height and water level at `p` after lakes were added to the ground. `shape` is the ground at `p`, `ground` returns it at any
    /// point.
    pub fn apply(
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

        // Distance from the centre in radii: 1 on the shore.
        let axis = basin.axis();
        let unbent = DVec2::new(offset.dot(axis) / basin.stretch, offset.dot(axis.perp())) / radius;
        let bend = DVec2::from(self.bend.at(p, corners)) * 0.6;
        let q = (unbent + bend.clamp_length_max(WARP)).length();
        if q >= INFLUENCE {
            return dry;
        }
        if q < 1.0 {
            return (level - (2.0 + 0.018 * radius) * (1.0 - q * q), level);
        }
        let bank = level + (0.05 * radius * (q - 1.0)).min(3.0);
        // The rim stands above the water level all around, even where the ground between the sampled points is lower.
        let rim = level + (0.03 * radius * (q - 1.0)).min(1.0) - 0.15 * radius * (q - 1.5).max(0.0);
        let height = math::mix(bank, shape.height, math::smoothstep(1.0, INFLUENCE, q)).max(rim);
        (height, if q < SHORE { level } else { shape.table })
    }
}
