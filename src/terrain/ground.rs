//! The ground before lakes: plains, hills, mountains, sea and rivers.

use super::field::{Corners, Fractal, FreshCorners, Octaves, Slots};
use super::river::Rivers;
use super::settings::TerrainSettings;
use crate::space::{Seed, math};
use glam::DVec2;

/// Number of sampled values of a field from which quantiles are found.
const QUANTILE_SAMPLES: usize = 4096;
/// Greatest amplitude of the small bays and capes along the coast.
const COAST_DETAIL: f64 = 0.1;
/// Value of the continent field, relative to the coast, from which the sea has no influence on the ground.
const INLAND: f64 = 0.17;
/// Height of flood plains above the water, in metres.
const FLOOD_PLAIN: f64 = 1.6;

/// The ground before lakes.
#[derive(Clone, Debug)]
pub(super) struct Ground {
    settings: TerrainSettings,
    continent: Continent,
    pub rivers: Rivers,
    plain: Fractal<2>,
    detail: Fractal<4>,
    hill: Fractal<4>,
    hill_mask: Mask,
    mountain: Fractal<6>,
    mountain_warp: Octaves<2>,
    mountain_mask: Mask,
    wood: Fractal<4>,
}

/// The ground at a point before lakes.
pub(super) struct Shape {
    /// Height in metres.
    pub height: f64,
    /// Water table in metres.
    pub table: f64,
    /// Distance from sea and rivers: 0 at their edge, 1 far away.
    pub dry: f64,
    /// How mountainous, 0 to 1.
    pub mountain: f64,
}

/// A field that is 0 outside a share of the plan and rises smoothly to 1 inside.
#[derive(Clone, Debug)]
struct Mask {
    field: Fractal<2>,
    low: f64,
    high: f64,
}

impl Mask {
    fn new(seed: Seed, key: u64, wavelength: f64, share: f64, width: f64, slots: &mut Slots) -> Self {
        let field = Fractal::new(seed, key, wavelength, 0.4, slots);
        let low = quantile(seed, key, wavelength, 1.0 - share, |p| field.at(p, &mut FreshCorners::new()));
        Self { field, low, high: low + width }
    }

    fn at(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        math::smoothstep(self.low, self.high, self.field.at(p, corners))
    }
}

/// The value below which a `share` of a field lies, from samples many wavelengths apart. For the shares 0 and 1, the result lies
/// beyond all values.
fn quantile(seed: Seed, key: u64, wavelength: f64, share: f64, field: impl Fn(DVec2) -> f64) -> f64 {
    let mut stream = seed.stream("terrain", &[key, 1]);
    let mut coordinate = || stream.signed() * wavelength * 500.0;
    let mut values: Vec<f64> = (0..QUANTILE_SAMPLES).map(|_| field(DVec2::new(coordinate(), coordinate()))).collect();
    values.sort_by(f64::total_cmp);
    match (share * QUANTILE_SAMPLES as f64) as usize {
        0 => values[0] - 10.0,
        QUANTILE_SAMPLES.. => values[QUANTILE_SAMPLES - 1] + 10.0,
        i => values[i],
    }
}

/// The distribution of land and sea.
#[derive(Clone, Debug)]
struct Continent {
    warp: Octaves<2>,
    warp_by: f64,
    field: Fractal<3>,
    coast: Fractal<5>,
    sea: f64,
}

impl Continent {
    fn new(seed: Seed, size: f64, sea_share: f64, slots: &mut Slots) -> Self {
        let mut continent = Self {
            warp: Octaves::new(seed, [(1, size * 0.53), (2, size * 0.53)], slots),
            warp_by: size * 0.16,
            field: Fractal::new(seed, 3, size, 0.42, slots),
            coast: Fractal::new(seed, 4, 5_300.0, 0.5, slots),
            sea: 0.0,
        };
        continent.sea = quantile(seed, 3, size, sea_share, |p| continent.large_scale(p, &mut FreshCorners::new()));
        continent
    }

    fn large_scale(&self, p: DVec2, corners: &mut impl Corners) -> f64 {
        let warp = DVec2::from(self.warp.at(p, corners));
        self.field.at(p + warp * self.warp_by, corners) - self.sea
    }

    /// The continent field without and with the detail of the coast: positive on land, negative in the sea.
    fn at(&self, p: DVec2, corners: &mut impl Corners) -> (f64, f64) {
        let large_scale = self.large_scale(p, corners);
        let x = large_scale / INLAND;
        if x.abs() >= 1.0 {
            return (large_scale, large_scale);
        }
        let fade = (1.0 - x * x) * (1.0 - x * x);
        (large_scale, large_scale + COAST_DETAIL * fade * self.coast.at(p, corners).clamp(-1.0, 1.0))
    }
}

/// `x` where it is clearly positive, decreasing smoothly to 0 below: this gives valley floors without a crease.
fn positive(x: f64) -> f64 {
    (x + (x * x + 0.03).sqrt()) / 2.0
}

/// The smaller of two heights, rounded over `k` metres.
fn smooth_min(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * k / 4.0
}

impl Ground {
    pub fn new(seed: Seed, s: &TerrainSettings, slots: &mut Slots) -> Self {
        Self {
            settings: s.clone(),
            continent: Continent::new(seed, s.continent_size, s.sea_share, slots),
            rivers: Rivers::new(seed, s.river_spacing, s.river_width, slots),
            plain: Fractal::new(seed, 20, 2_300.0, 0.4, slots),
            detail: Fractal::new(seed, 21, 330.0, 0.3, slots),
            hill: Fractal::new(seed, 22, 2_900.0, 0.42, slots),
            hill_mask: Mask::new(seed, 23, 15_700.0, s.hill_share, 0.25, slots),
            mountain: Fractal::new(seed, 24, 7_900.0, 0.44, slots),
            mountain_warp: Octaves::new(seed, [(25, 3_100.0), (26, 3_100.0)], slots),
            mountain_mask: Mask::new(seed, 27, 39_000.0, s.mountain_share, 0.35, slots),
            wood: Fractal::new(seed, 28, 2_900.0, 0.65, slots),
        }
    }

    /// The ground at a plan point.
    pub fn at(&self, p: DVec2, corners: &mut impl Corners) -> Shape {
        let s = &self.settings;
        let (large_scale, coast) = self.continent.at(p, corners);
        let table = s.inland_height * math::smoothstep(INLAND, 0.95, large_scale);
        let river = self.rivers.at(p, corners);

        // Relief grows away from rivers, and mountains stand on watersheds.
        let mut relief = 9.0 * positive(0.55 + self.plain.at(p, corners)) * river.valley;
        let hilly = if coast > 0.0 { self.hill_mask.at(p, corners) * coast / (coast + 0.05) } else { 0.0 };
        if hilly > 0.0 {
            relief += s.hill_height * hilly * river.valley * positive(0.45 + 0.9 * self.hill.at(p, corners));
        }
        let mut mountain = 0.0;
        // Mountains keep away from the beach, too.
        let inland = math::smoothstep(0.0, INLAND, coast);
        let room = inland * math::smoothstep(0.12, 0.6, river.watershed) * river.valley;
        if room > 0.0 {
            mountain = self.mountain_mask.at(p, corners) * room;
            if mountain > 0.0 {
                let warp = DVec2::from(self.mountain_warp.at(p, corners)) * 500.0;
                relief += s.mountain_height * mountain * (0.15 + self.mountain.ridged_at(p + warp, corners));
            }
        }
        let rough = 0.5 * positive(0.8 + self.detail.at(p, corners)) * (1.0 + (3.0 * mountain + hilly) * river.valley);
        let land = if coast > 0.0 {
            let shore = coast / (coast + 0.035) * (1.0 + 0.035);
            shore * (FLOOD_PLAIN + rough + relief) + 40.0 * coast.min(0.05)
        } else {
            420.0 * coast / (1.0 - 3.0 * coast)
        };
        let height = table + smooth_min(land, river.profile, 0.5);
        let dry = river.dry * inland;
        Shape { height, table, dry, mountain }
    }

    /// Density of the vegetation at a point whose final height is `height`.
    pub fn vegetation(&self, p: DVec2, shape: &Shape, height: f64, corners: &mut impl Corners) -> f64 {
        let above = height - shape.table;
        let shore = math::smoothstep(0.5, 4.0, above);
        let tree_line = 1.0 - math::smoothstep(420.0, 620.0, above);
        let density = 0.5 + self.wood.at(p, corners) + 1.4 * (self.settings.vegetation - 0.5) + 0.25 * shape.mountain;
        math::smoothstep(0.0, 1.0, density) * shore * tree_line
    }
}
