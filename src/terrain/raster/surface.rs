//! A raster prepared for interpolation.

use super::grid::Raster;
use crate::space::math::mix;
use glam::DVec2;

/// Number of rings of samples around the raster, so that interpolation needs no test for the border.
const RING: usize = 2;
/// Negative depth of a dry cell beside water, as a share of the depth of the water. Below 1, so that wet cells that touch only at
/// a corner stay connected.
const SHORE: f32 = 0.8;
/// Negative depth of every other dry cell, in metres. Not so low that searches for a shore would take long steps.
const LAND: f32 = -5.0;

/// Samples with rings around them, in rows from the south.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// Position of the south-west sample of the outermost ring.
    first: DVec2,
    /// Samples per metre.
    per_metre: DVec2,
    /// Greatest coordinates in samples, relative to `first`: the border of the outermost cells.
    end: DVec2,
    width: usize,
    values: Vec<f32>,
}

impl Surface {
    /// The surface of a raster that continues beyond its border with the slope at the border.
    pub fn sloping(raster: Raster) -> Self {
        Self::padded(raster, |edge, inner, ring| edge + (edge - inner) * ring)
    }

    /// The surface of a raster that continues beyond its border at the same level.
    pub fn flat(raster: Raster) -> Self {
        Self::padded(raster, |edge, _, _| edge)
    }

    fn padded(raster: Raster, beyond: impl Fn(f32, f32, f32) -> f32) -> Self {
        let (columns, rows) = (raster.columns, raster.rows);
        let (width, height) = (columns + 2 * RING, rows + 2 * RING);
        let mut values = vec![0.0; width * height];
        let at = |column: usize, row: usize| row * width + column;
        for row in 0..rows {
            let start = at(RING, row + RING);
            values[start..start + columns].copy_from_slice(&raster.values[row * columns..(row + 1) * columns]);
            for ring in 1..=RING {
                let west = beyond(values[start], values[start + 1], ring as f32);
                values[start - ring] = west;
                let last = start + columns - 1;
                values[last + ring] = beyond(values[last], values[last - 1], ring as f32);
            }
        }
        for column in 0..width {
            for ring in 1..=RING {
                let (south, north) = (RING, RING + rows - 1);
                values[at(column, south - ring)] =
                    beyond(values[at(column, south)], values[at(column, south + 1)], ring as f32);
                values[at(column, north + ring)] =
                    beyond(values[at(column, north)], values[at(column, north - 1)], ring as f32);
            }
        }
        Self {
            first: raster.corner + raster.step * (0.5 - RING as f64),
            per_metre: 1.0 / raster.step,
            end: DVec2::new(columns as f64, rows as f64) + (RING as f64 - 0.5),
            width,
            values,
        }
    }

    /// Index of the sample south-west of a point, and the position of the point between this sample and the next, 0 to 1 along each
    /// axis. There is at least one more sample to the south and west, and two to the north and east.
    fn place(&self, p: DVec2) -> (usize, DVec2) {
        let u = ((p - self.first) * self.per_metre).clamp(DVec2::splat(RING as f64 - 0.5), self.end);
        // Both are positive, so truncation rounds down.
        let (column, row) = (u.x as usize, u.y as usize);
        (row * self.width + column, u - DVec2::new(column as f64, row as f64))
    }

    /// Bilinear interpolation.
    pub fn bilinear(&self, p: DVec2) -> f64 {
        let (i, f) = self.place(p);
        let row = |i: usize| mix(f64::from(self.values[i]), f64::from(self.values[i + 1]), f.x);
        mix(row(i), row(i + self.width), f.y)
    }

    /// Catmull-Rom interpolation: passes through all samples, has continuous slopes, and is exact on level ground.
    pub fn smooth(&self, p: DVec2) -> f64 {
        let (i, f) = self.place(p);
        let row = |k: usize| {
            let start = i - self.width - 1 + k * self.width;
            let v = &self.values[start..start + 4];
            spline([v[0], v[1], v[2], v[3]].map(f64::from), f.x)
        };
        spline([row(0), row(1), row(2), row(3)], f.y)
    }
}

/// The Catmull-Rom spline through four consecutive values, at `t` (0 to 1) between the two in the middle.
fn spline([a, b, c, d]: [f64; 4], t: f64) -> f64 {
    let rise = c - a;
    let bend = 2.0 * a - 5.0 * b + 4.0 * c - d;
    let twist = 3.0 * (b - c) + d - a;
    b + 0.5 * t * (rise + t * (bend + t * twist))
}

/// Depths of water with negative values on land, so that the depth is 0 about half-way between a wet and a dry sample.
pub(super) fn with_shores(depths: Raster) -> Raster {
    let (columns, rows) = (depths.columns, depths.rows);
    let shore = |column: usize, row: usize| {
        let (mut sum, mut wet) = (0.0, 0.0);
        for y in row.saturating_sub(1)..=(row + 1).min(rows - 1) {
            for x in column.saturating_sub(1)..=(column + 1).min(columns - 1) {
                let depth = depths.values[y * columns + x];
                if depth > 0.0 {
                    sum += depth;
                    wet += 1.0;
                }
            }
        }
        if wet > 0.0 { -SHORE * sum / wet } else { LAND }
    };
    let signed = |i: usize, depth: f32| if depth > 0.0 { depth } else { shore(i % columns, i / columns) };
    let values = depths.values.iter().enumerate().map(|(i, d)| signed(i, *d)).collect();
    Raster { values, ..depths }
}
