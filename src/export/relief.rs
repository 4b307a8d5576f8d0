//! The ground of a map: hill shading as a raster, water and heights as contours.

use crate::export::ExportError;
use crate::space::Bounds;
use crate::space::math::{pow, smoothstep};
use crate::terrain::{Terrain, TerrainSample};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use resvg::tiny_skia::{IntSize, Pixmap};

/// Terrain at the points of a square grid over a map, and one step beyond it on every side.
pub(crate) struct Relief {
    /// Steps along the longer side of the map.
    steps: usize,
    /// Steps from west to east and from north to south; the last step may reach over the border.
    size: [usize; 2],
    /// Length of a step in metres.
    step: f64,
    /// Terrain at (column, row) in element `row * (size[0] + 3) + column`, from one step beyond the north-west corner.
    samples: Vec<TerrainSample>,
    /// How many times steeper the land is drawn than it is.
    steeper: f64,
    /// Height at which the scale of colours begins, in metres, and the factor for heights above it.
    tinted: (f64, f64),
    /// Height of the water above the ground at each point, in metres; where steps are long, the greatest height around the point.
    wet: Vec<f64>,
}

/// Steps longer than this, in metres, would miss most of a river.
const FINE: f64 = 6.0;
/// Greatest mean slope that is drawn.
const STEEPEST: f64 = 0.26;
/// Greatest range of heights that the scale of colours covers unscaled, in metres.
const TALLEST: f64 = 1_000.0;
/// Ground farther above its water than this, in metres, has no river beside it.
const DRY: f64 = 4.0;

impl Relief {
    /// Samples `bounds` (plan metres) at `steps + 1` points along the longer side.
    pub fn new(terrain: &dyn Terrain, bounds: Bounds, steps: usize) -> Self {
        let step = bounds.size().max_element() / steps as f64;
        // A side may be a whole number of steps but for rounding.
        let size = (bounds.size() / step - 1e-6).ceil().max(DVec2::ONE).to_array().map(|n| n as usize);
        let (row, rows) = (size[0] + 3, size[1] + 3);
        let corner = DVec2::new(bounds.min.x - step, bounds.max.y + step);
        let at = |i: usize| corner + DVec2::new((i % row) as f64, -((i / row) as f64)) * step;
        let samples: Vec<TerrainSample> = (0..row * rows).into_par_iter().map(|i| terrain.sample(at(i))).collect();
        let parts = (step / FINE).ceil().clamp(1.0, 4.0) as usize;
        let over = |s: TerrainSample| s.water_level - s.height;
        let wet = |(i, s): (usize, &TerrainSample)| {
            let here = over(*s);
            if parts == 1 || !(-DRY..=0.0).contains(&here) {
                return here;
            }
            let part = |k: usize| (k as f64 + 0.5) / parts as f64 - 0.5;
            let around = (0..parts * parts).map(|k| at(i) + DVec2::new(part(k % parts), part(k / parts)) * step);
            around.map(|p| over(terrain.sample(p))).fold(here, f64::max)
        };
        let mut wet: Vec<f64> = samples.par_iter().enumerate().map(wet).collect();
        if parts > 1 {
            // The limits favour water, so that a river one cell wide stays joined, also across the diagonal.
            wet.iter_mut().for_each(|w| *w = w.clamp(-1.0, 1.5));
        }
        // From far off the same hills look flatter, so the land is drawn steeper with longer steps. But where most of the land is
        // steep, shades must still differ.
        let rises =
            samples.windows(2).filter(|p| p[0].depth() == 0.0).map(|p| ((p[1].height - p[0].height) / step).abs());
        let (sum, count) = rises.fold((0.0, 1.0), |(sum, count), rise| (sum + rise, count + 1.0));
        let steeper = (2.2 * pow((step / 4.0).max(0.25), 0.15)).min(STEEPEST / (sum / count));
        let mut out = Self { steps, size, step, samples, steeper, tinted: (0.0, 1.0), wet };
        // Among mountains, valleys must differ from peaks.
        if let Some((low, high)) = out.heights().filter(|(low, high)| high - low > TALLEST) {
            out.tinted = (low, TALLEST / (high - low));
        }
        out
    }

    /// Rings around water, like [`Relief::rings`].
    pub fn shores(&self, pixels: f64) -> Vec<Vec<DVec2>> {
        self.rings_of(pixels, |i| self.wet[i])
    }

    /// Whether there is water on the map.
    pub fn has_water(&self) -> bool {
        self.wet.iter().any(|w| *w > 0.0)
    }

    /// Whether there is so much wood that it shows.
    pub fn has_wood(&self) -> bool {
        self.samples.iter().filter(|s| s.vegetation > 0.6).count() > self.samples.len() / 500
    }

    fn at(&self, column: usize, row: usize) -> &TerrainSample {
        &self.samples[row * (self.size[0] + 3) + column]
    }

    /// Lowest and highest ground above the water, in metres; `None` when all is water.
    pub fn heights(&self) -> Option<(f64, f64)> {
        let dry = self.samples.iter().filter(|s| s.depth() == 0.0).map(|s| s.height);
        dry.fold(None, |range, h| Some(range.map_or((h, h), |(low, high): (f64, f64)| (low.min(h), high.max(h)))))
    }

    /// Colour of the land at a grid point of the map, each part 0 to 255.
    fn colour(&self, column: usize, row: usize) -> DVec3 {
        let (c, r) = (column + 1, row + 1);
        let here = self.at(c, r);
        let slope = DVec2::new(
            self.at(c + 1, r).height - self.at(c - 1, r).height,
            self.at(c, r - 1).height - self.at(c, r + 1).height,
        ) / (2.0 * self.step);
        let steeper = self.steeper;
        let light = DVec3::new(-0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2);
        let normal = DVec3::new(-slope.x * steeper, -slope.y * steeper, 1.0).normalize();
        let shade = normal.dot(light) / light.z - 1.0;

        let tints = match self.tinted.1 < 1.0 {
            true => {
                [(0.0, [217, 226, 196]), (200.0, [236, 232, 205]), (500.0, [226, 207, 174]), (950.0, [248, 245, 241])]
            }
            false => {
                [(0.0, [236, 236, 218]), (150.0, [241, 235, 217]), (400.0, [231, 220, 197]), (900.0, [246, 243, 238])]
            }
        };
        let tints = tints.map(|(height, rgb)| (height, DVec3::from_array(rgb.map(f64::from))));
        let tint = tints.windows(2).fold(tints[0].1, |tint, pair| {
            let t = smoothstep(pair[0].0, pair[1].0, (here.height - self.tinted.0) * self.tinted.1);
            if t > 0.0 { pair[0].1.lerp(pair[1].1, t) } else { tint }
        });
        let wood = DVec3::new(190.0, 211.0, 165.0);
        let land = tint.lerp(wood, 0.75 * smoothstep(0.2, 0.9, here.vegetation));
        if shade < 0.0 {
            land.lerp(DVec3::new(74.0, 82.0, 110.0), (-shade * 0.75).min(0.6))
        } else {
            land.lerp(DVec3::new(255.0, 253.0, 244.0), (shade * 0.9).min(0.6))
        }
    }

    /// The shaded land as `width` by `height` pixels, in the proportions of the map.
    pub fn raster(&self, [width, height]: [u32; 2]) -> Result<Pixmap, ExportError> {
        let across = self.size[0] + 1;
        let points: Vec<DVec3> =
            (0..across * (self.size[1] + 1)).into_par_iter().map(|i| self.colour(i % across, i / across)).collect();
        let per_pixel = self.steps as f64 / f64::from(width.max(height));
        let cell = |pixel: u32, steps: usize| {
            let x = (f64::from(pixel) + 0.5) * per_pixel;
            let whole = x.floor().min(steps as f64 - 1.0);
            (whole as usize, x - whole)
        };
        let row_of = |y: u32| -> Vec<u8> {
            let (row, v) = cell(y, self.size[1]);
            let colour = |x: u32| {
                let (column, u) = cell(x, self.size[0]);
                let point = |dx, dy| points[(row + dy) * across + column + dx];
                let c = point(0, 0).lerp(point(1, 0), u).lerp(point(0, 1).lerp(point(1, 1), u), v);
                [c.x.round() as u8, c.y.round() as u8, c.z.round() as u8, 255]
            };
            (0..width).flat_map(colour).collect()
        };
        let rows: Vec<Vec<u8>> = (0..height).into_par_iter().map(row_of).collect();
        IntSize::from_wh(width, height)
            .and_then(|size| Pixmap::from_vec(rows.concat(), size))
            .ok_or_else(|| ExportError::Format(format!("a picture of {width} by {height} pixels is not possible")))
    }

    /// Rings around the land where `field` is above `level`, in pixels of a map whose longer side has `pixels`, y down. Rings
    /// that leave the map are closed beyond it.
    pub fn rings(&self, pixels: f64, level: f64, field: impl Fn(&TerrainSample) -> f64) -> Vec<Vec<DVec2>> {
        self.rings_of(pixels, |i| field(&self.samples[i]) - level)
    }

    fn rings_of(&self, pixels: f64, over: impl Fn(usize) -> f64) -> Vec<Vec<DVec2>> {
        let row = self.size[0] + 3;
        let last = self.size.map(|n| n + 2);
        let outside = |i: usize| i.is_multiple_of(row) || i % row == last[0] || i / row == 0 || i / row == last[1];
        // A rim below the level closes every ring.
        let over: Vec<f64> = (0..self.samples.len()).map(|i| if outside(i) { -1.0 } else { over(i) }).collect();
        let scale = pixels / self.steps as f64;
        // The rim is pushed out, so that closed rings do not run along the map's edge.
        let place = |p: DVec2| {
            let out = |x: f64, last: usize| {
                if x < 0.5 {
                    -2.0
                } else if x > last as f64 - 0.5 {
                    last as f64
                } else {
                    x - 1.0
                }
            };
            DVec2::new(out(p.x, last[0]), out(p.y, last[1])) * scale
        };
        trace(&over, row).into_iter().map(|ring| ring.into_iter().map(place).collect()).collect()
    }
}

/// Marching squares: closed rings around where `over` (a grid with `row` columns) is positive, in grid units.
fn trace(over: &[f64], row: usize) -> Vec<Vec<DVec2>> {
    const NONE: usize = usize::MAX;
    // Grid edges that a ring crosses: `2 i` runs east from point i, `2 i + 1` runs down from it.
    let mut next = vec![NONE; 2 * over.len()];
    let rows = over.len() / row;
    for (c, r) in (0..rows - 1).flat_map(|r| (0..row - 1).map(move |c| (c, r))) {
        let i = r * row + c;
        let corner = [i, i + 1, i + row + 1, i + row];
        let edge = [2 * i, 2 * (i + 1) + 1, 2 * (i + row), 2 * i + 1];
        let high = corner.map(|k| over[k] > 0.0);
        // A ring leaves the cell where going around it meets low after high, and enters where it meets high after low.
        let leaves = |k: usize| high[k] && !high[(k + 1) % 4];
        let enters = |k: usize| !high[k] && high[(k + 1) % 4];
        let joined = corner.iter().map(|k| over[*k]).sum::<f64>() > 0.0;
        for k in (0..4).filter(|k| enters(*k)) {
            // At a saddle, with two high and two low corners, the middle decides whether the high corners are joined.
            let to = if joined {
                (1..4).rev().map(|d| (k + d) % 4).find(|m| leaves(*m))
            } else {
                (1..4).map(|d| (k + d) % 4).find(|m| leaves(*m))
            };
            if let Some(to) = to {
                next[edge[k]] = edge[to];
            }
        }
    }
    let crossing = |edge: usize| {
        let (a, b) = (edge / 2, if edge.is_multiple_of(2) { edge / 2 + 1 } else { edge / 2 + row });
        let at = |k: usize| DVec2::new((k % row) as f64, (k / row) as f64);
        at(a).lerp(at(b), over[a] / (over[a] - over[b]))
    };
    let mut rings = Vec::new();
    for start in 0..next.len() {
        let (mut ring, mut edge) = (Vec::new(), start);
        while next[edge] != NONE {
            ring.push(crossing(edge));
            edge = std::mem::replace(&mut next[edge], NONE);
        }
        if !ring.is_empty() {
            rings.push(ring);
        }
    }
    rings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Seed, signed_area};

    #[test]
    fn rings_part_high_points_from_low_ones() {
        for seed in 0..50 {
            let mut random = Seed(seed).stream("test", &[]);
            let row = 12;
            let inner = |i: usize| (1..row - 1).contains(&(i % row)) && (1..row - 1).contains(&(i / row));
            let over: Vec<f64> = (0..row * row).map(|i| if inner(i) { random.signed() } else { -1.0 }).collect();
            let rings = trace(&over, row);
            let winding = |p: DVec2| rings.iter().filter(|r| crate::space::point_in_polygon(p, r)).count() % 2;
            for (i, value) in over.iter().enumerate() {
                let p = DVec2::new((i % row) as f64, (i / row) as f64);
                assert_eq!(winding(p) == 1, *value > 0.0, "seed {seed}, {p}");
            }
            assert!(rings.iter().all(|r| signed_area(r) != 0.0));
        }
    }
}
