//! The world-aligned lattice that courses of roads run on, its stencil, and samples of the terrain at its nodes.

use crate::layer::{LayerCache, LayerError, Weigh};
use crate::region::road::settings::TierSettings;
use crate::terrain::{Terrain, TerrainSample};
use glam::{DVec2, I64Vec2};
use std::sync::Arc;

/// Number of headings of the stencil.
pub(super) const DIRECTIONS: usize = 16;

/// Steps of the stencil, counter-clockwise from east; step `i + 8` is the opposite of step `i`. No step passes over a
/// node, so two different edges share at most one point.
pub(super) const STENCIL: [I64Vec2; DIRECTIONS] = {
    const fn v(x: i64, y: i64) -> I64Vec2 {
        I64Vec2::new(x, y)
    }
    [
        v(1, 0),
        v(2, 1),
        v(1, 1),
        v(1, 2),
        v(0, 1),
        v(-1, 2),
        v(-1, 1),
        v(-2, 1),
        v(-1, 0),
        v(-2, -1),
        v(-1, -1),
        v(-1, -2),
        v(0, -1),
        v(1, -2),
        v(1, -1),
        v(2, -1),
    ]
};

/// Edge length of a tile of samples, in nodes.
const TILE: i64 = 8;

/// The heading of the stencil that leads from node `a` to node `b`, if they are joined by an edge.
pub(super) fn heading(a: I64Vec2, b: I64Vec2) -> Option<usize> {
    STENCIL.iter().position(|s| *s == b - a)
}

/// Length, in steps, of the shortest way over `d` steps along edges of the stencil.
pub(super) fn stencil_distance(d: I64Vec2) -> f64 {
    let (high, low) = (d.x.abs().max(d.y.abs()) as f64, d.x.abs().min(d.y.abs()) as f64);
    let (five, two) = (5f64.sqrt(), 2f64.sqrt());
    if 2.0 * low <= high { low * five + (high - 2.0 * low) } else { (high - low) * five + (2.0 * low - high) * two }
}

/// Node nearest to the plan point `p` on the lattice of spacing `step`.
pub(super) fn node_near(p: DVec2, step: i64) -> I64Vec2 {
    (p / step as f64).round().as_i64vec2()
}

/// Plan position of a node of the lattice of spacing `step`.
pub(super) fn node_at(node: I64Vec2, step: i64) -> DVec2 {
    (node * step).as_dvec2()
}

/// What a road sees of the ground at a node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ground {
    /// Height of ground or water, whichever is above.
    pub surface: f32,
    pub depth: f32,
    pub vegetation: f32,
}

impl Ground {
    /// What a road sees of a sample.
    pub fn of(s: &TerrainSample) -> Self {
        Self { surface: s.height.max(s.water_level) as f32, depth: s.depth() as f32, vegetation: s.vegetation as f32 }
    }
}

/// Samples of 8 by 8 nodes.
pub(super) struct SampleTile([Ground; (TILE * TILE) as usize]);

impl Weigh for SampleTile {
    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}

/// Key of a tile of samples: spacing of its nodes, and its column and row.
pub(super) type TileKey = (i64, i64, i64);

/// Samples at the nodes of a window, fetched tile by tile as they are asked for.
pub(super) struct Samples<'a> {
    cache: &'a LayerCache<TileKey, SampleTile>,
    terrain: &'a dyn Terrain,
    step: i64,
    first: I64Vec2,
    columns: usize,
    tiles: Vec<Option<Arc<SampleTile>>>,
}

impl<'a> Samples<'a> {
    pub fn new(
        cache: &'a LayerCache<TileKey, SampleTile>,
        terrain: &'a dyn Terrain,
        step: i64,
        window: &super::search::Window,
    ) -> Self {
        let tile = I64Vec2::splat(TILE);
        let first = window.min.div_euclid(tile);
        let count = (window.min + window.size - 1).div_euclid(tile) - first + 1;
        let tiles = vec![None; (count.x * count.y).max(0) as usize];
        Self { cache, terrain, step, first, columns: count.x as usize, tiles }
    }

    /// The ground at a node of the window.
    pub fn at(&mut self, node: I64Vec2) -> Result<Ground, LayerError> {
        let tile = node.div_euclid(I64Vec2::splat(TILE));
        let inside = node - tile * TILE;
        let local = tile - self.first;
        let slot = &mut self.tiles[local.y as usize * self.columns + local.x as usize];
        let held = match slot {
            Some(held) => held,
            None => {
                let (terrain, step) = (self.terrain, self.step);
                let made = self.cache.get(&(step, tile.x, tile.y), || Ok(sample_tile(terrain, step, tile)))?;
                slot.insert(made)
            }
        };
        Ok(held.0[(inside.y * TILE + inside.x) as usize])
    }
}

fn sample_tile(terrain: &dyn Terrain, step: i64, tile: I64Vec2) -> SampleTile {
    let mut out = [Ground::default(); (TILE * TILE) as usize];
    let mut scan = terrain.scan();
    for (i, ground) in out.iter_mut().enumerate() {
        let node = tile * TILE + I64Vec2::new(i as i64 % TILE, i as i64 / TILE);
        *ground = Ground::of(&scan(node_at(node, step)));
    }
    SampleTile(out)
}

/// Cost per metre of a straight piece of road `length` metres long over dry ground between two points; `None` where it is
/// too steep. At least 1, so a road never costs less than its length.
pub(super) fn cost_per_metre(a: Ground, b: Ground, length: f64, t: &TierSettings) -> Option<f64> {
    let slope = f64::from((a.surface - b.surface).abs()) / length;
    if slope > t.slope_limit {
        return None;
    }
    let steep = slope / t.slope_limit;
    let wood = f64::from(a.vegetation + b.vegetation) / 2.0;
    Some(1.0 + t.slope * steep * steep + t.vegetation * wood)
}

/// Cost per metre of a straight piece between nodes of the wide lattice, on land or over water, and the share of it that
/// is a bridge; `None` where the class of road does not go.
pub(super) fn cost_over_water(a: Ground, b: Ground, length: f64, t: &TierSettings) -> Option<(f64, f64)> {
    let depth = f64::from(a.depth.max(b.depth));
    if depth > t.depth_limit {
        return None;
    }
    let ends = f64::from(u8::from(a.depth > 0.0) + u8::from(b.depth > 0.0)) / 2.0;
    let water = if ends > 0.0 { t.water * ends * (1.0 + depth / t.depth_limit) } else { 0.0 };
    Some((cost_per_metre(a, b, length, t)? + water, ends))
}

/// For each heading, the headings that a road may take next, with the cost of the bend: quadratic in its angle, and no
/// sharper than a rounded corner of the class's least radius allows.
pub(super) fn bends(t: &TierSettings, step: i64) -> [Vec<(usize, f32)>; DIRECTIONS] {
    std::array::from_fn(|from| {
        let allowed = |to: usize| {
            let apart = (to + DIRECTIONS - from) % DIRECTIONS;
            let bend = apart.min(DIRECTIONS - apart);
            let fits =
                bend <= 1 || corner_radius(STENCIL[from].as_dvec2(), STENCIL[to].as_dvec2()) * step as f64 >= t.radius;
            (bend < DIRECTIONS / 2 && fits).then_some((to, (t.turn * (bend * bend) as f64) as f32))
        };
        (0..DIRECTIONS).filter_map(allowed).collect()
    })
}

/// Least radius of the parabola that rounds off the corner from a side `a` to a side `b`, tangent to both at the same
/// distance from it, half the shorter side.
pub(super) fn corner_radius(a: DVec2, b: DVec2) -> f64 {
    let (long, short) = (a.length(), b.length());
    let cosine = (a.dot(b) / (long * short)).clamp(-1.0, 1.0);
    // Half angles, without trigonometry.
    let (cos2, sin) = ((1.0 + cosine) / 2.0, ((1.0 - cosine) / 2.0).sqrt());
    if sin > 0.0 { long.min(short) / 2.0 * cos2 / sin } else { f64::INFINITY }
}

/// The compact kernel of control primitives: 1 at distance 0, smoothly 0 from `radius` on. Galin 2011, section 4.1, prints
/// 1 - (r^2/R^2)^2; this is the square of 1 - (r/R)^2, which also ends without a corner.
pub(super) fn kernel(distance: f64, radius: f64) -> f64 {
    let x = distance / radius;
    if x >= 1.0 { 0.0 } else { (1.0 - x * x) * (1.0 - x * x) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stencil_is_ordered_and_its_distance_bounds_the_beeline() {
        for (i, s) in STENCIL.iter().enumerate() {
            assert_eq!(STENCIL[(i + 8) % 16], -*s);
            assert!(s.perp_dot(STENCIL[(i + 1) % 16]) > 0);
            assert_eq!(stencil_distance(*s), s.as_dvec2().length());
        }
        for x in -20..20 {
            for y in -20..20 {
                let d = I64Vec2::new(x, y);
                let ratio = stencil_distance(d) / d.as_dvec2().length();
                assert!(d == I64Vec2::ZERO || (1.0 - 1e-12..1.03).contains(&ratio));
            }
        }
    }

    #[test]
    fn roads_cost_at_least_their_length_and_avoid_what_they_should() {
        let t = TierSettings::default();
        let flat = Ground { surface: 10.0, depth: 0.0, vegetation: 0.0 };
        assert_eq!(cost_per_metre(flat, flat, 128.0, &t), Some(1.0));
        let hill = Ground { surface: 15.0, ..flat };
        let higher = Ground { surface: 20.0, ..flat };
        let cost = |b| cost_per_metre(flat, b, 128.0, &t).unwrap() - 1.0;
        assert!((cost(higher) / cost(hill) - 4.0).abs() < 1e-9);
        assert_eq!(cost_per_metre(flat, Ground { surface: 200.0, ..flat }, 128.0, &t), None);
        assert_eq!(cost_over_water(flat, Ground { depth: 100.0, ..flat }, 128.0, &t), None);
        assert!(cost_over_water(flat, Ground { depth: 1.0, ..flat }, 128.0, &t).unwrap().1 > 0.0);
    }

    #[test]
    fn bends_keep_the_least_radius() {
        let settings = crate::region::road::RoadSettings::default();
        for (t, range) in [(&settings.highway, 3..=5), (&settings.major, 3..=5), (&settings.minor, 7..=9)] {
            let counts = bends(t, 128).map(|b| b.len());
            assert!(counts.iter().all(|n| range.contains(n)), "{counts:?}");
        }
        // A quarter circle of chords has about the circle's radius.
        let (a, b) = (DVec2::new(8.0, 0.0), crate::space::math::direction(0.1) * 8.0);
        assert!((corner_radius(a, b) - 80.0).abs() < 1.0);
    }
}
