//! Direction fields: at every point the cross of directions that streets prefer.

use crate::space::math::{angle_of, direction, sin, smoothstep};
use crate::space::{Bounds, Origin, Stream};
use crate::style::FieldKind;
use crate::terrain::Terrain;
use glam::DVec2;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Distance between the points at which a [`FieldKind::Contours`] field knows the slope, in metres.
const LATTICE_STEP: f64 = 80.0;
/// Slope (rise over run) at which contours count as much as the grid that replaces them on flat ground.
const FLAT: f64 = 0.035;

/// Distances from the hub of a [`FieldKind::Radial`] field, in metres: rings are round up to the first, and square with round
/// corners from the second on.
const ROUND_RINGS: (f64, f64) = (60.0, 280.0);
/// How square the outer rings are: at 0 they are round; at 1 their sides have no curvature where they cross the axes of the
/// town; with larger values they are straight for longer.
const SQUARENESS: f64 = 1.6;

/// The directions that streets prefer, as a cross at every point: one heading and its three quarter turns.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionField {
    base: f64,
    /// Centre of a radial field: avenues lead there, and rings run around it. The avenues along the two axes are straight;
    /// farther out the streets between them turn towards the nearer axis, as within the ring roads of Beijing.
    hub: Option<DVec2>,
    waves: Vec<Wave>,
    lattice: Option<Lattice>,
}

/// A plane wave of headings.
#[derive(Clone, Debug, PartialEq)]
struct Wave {
    vector: DVec2,
    phase: f64,
    amplitude: f64,
}

/// Headings at the points of a square lattice, as unit vectors at four times the angle: a quarter turn changes nothing.
#[derive(Clone, Debug, PartialEq)]
struct Lattice {
    min: DVec2,
    columns: usize,
    rows: usize,
    crosses: Vec<DVec2>,
}

impl DirectionField {
    /// The field whose cross has the same `angle` (radians) everywhere.
    pub fn uniform(angle: f64) -> Self {
        Self { base: angle, hub: None, waves: Vec::new(), lattice: None }
    }

    /// A field of a kind, with its headings drawn from `stream`. Slopes are read from `terrain` over `bounds`. The box and all
    /// later positions are local to `origin`.
    pub(crate) fn draw(
        kind: FieldKind,
        stream: &mut Stream,
        bounds: Bounds,
        origin: Origin,
        terrain: &dyn Terrain,
    ) -> Self {
        let mut field = Self::uniform(stream.range(0.0, FRAC_PI_2));
        match kind {
            FieldKind::Grid => {
                // A third of the grids turn a little, as where surveyors met a coast or an older road.
                if stream.chance(0.33) {
                    field.waves = waves(stream, 2, (1800.0, 3200.0), 0.09);
                }
            }
            FieldKind::Radial => {
                field.hub = Some(DVec2::ZERO);
                field.waves = waves(stream, 3, (700.0, 1500.0), 0.04);
            }
            FieldKind::Organic => field.waves = waves(stream, 5, (550.0, 1500.0), 0.3),
            FieldKind::Contours => {
                field.waves = waves(stream, 3, (800.0, 1800.0), 0.12);
                field.lattice = Some(Lattice::new(&field, bounds, origin, terrain));
            }
        }
        field
    }

    /// The same field with its heading turned to `angle` (radians), unless it has a hub or follows the slope.
    pub(super) fn facing(self, angle: f64) -> Self {
        if self.hub.is_some() || self.lattice.is_some() { self } else { Self { base: angle, ..self } }
    }

    /// Angle of the cross at `p` (local to the town), in radians: the angle of its arm in -pi/4..=pi/4.
    pub fn angle(&self, p: DVec2) -> f64 {
        let angle = match &self.lattice {
            Some(lattice) => angle_of(lattice.cross(p)) / 4.0,
            None => self.flat_angle(p),
        };
        angle - (angle / FRAC_PI_2).round() * FRAC_PI_2
    }

    /// The arm of the cross at `p` that is nearest to `heading`, as a unit vector.
    pub fn along(&self, p: DVec2, heading: DVec2) -> DVec2 {
        let u = direction(self.angle(p));
        let (x, y) = (u.dot(heading), u.perp_dot(heading));
        if x.abs() >= y.abs() { u * x.signum() } else { u.perp() * y.signum() }
    }

    /// The centre of a radial field.
    pub(super) fn hub(&self) -> Option<DVec2> {
        self.hub
    }

    /// The angle at a position relative to the hub.
    fn angle_around_hub(&self, from_hub: DVec2) -> f64 {
        let angle = angle_of(from_hub);
        let square = SQUARENESS * smoothstep(ROUND_RINGS.0, ROUND_RINGS.1, from_hub.length());
        angle - square / 4.0 * sin(4.0 * (angle - self.base))
    }

    /// The angle on flat ground.
    fn flat_angle(&self, p: DVec2) -> f64 {
        let base = self.hub.map_or(self.base, |hub| if p == hub { self.base } else { self.angle_around_hub(p - hub) });
        base + self.waves.iter().map(|w| w.amplitude * sin(w.vector.dot(p) + w.phase)).sum::<f64>()
    }
}

/// Waves with lengths in a range of metres, which together make a heading wander by about `swing` radians.
fn waves(stream: &mut Stream, count: usize, lengths: (f64, f64), swing: f64) -> Vec<Wave> {
    (0..count)
        .map(|_| {
            let vector = direction(stream.range(0.0, PI)) * (TAU / stream.range(lengths.0, lengths.1));
            let amplitude = swing * stream.range(0.6, 1.4) / (count as f64).sqrt();
            Wave { vector, phase: stream.range(0.0, TAU), amplitude }
        })
        .collect()
}

impl Lattice {
    fn new(flat: &DirectionField, bounds: Bounds, origin: Origin, terrain: &dyn Terrain) -> Self {
        let min = bounds.min - 2.0 * LATTICE_STEP;
        let size = ((bounds.size() / LATTICE_STEP).ceil() + 5.0).as_usizevec2();
        let (columns, rows) = (size.x, size.y);
        let at = |i: usize| min + DVec2::new((i % columns) as f64, (i / columns) as f64) * LATTICE_STEP;
        let heights: Vec<f64> = (0..columns * rows).map(|i| terrain.height(origin.to_plan(at(i)))).collect();
        let difference = |i: usize, low: bool, high: bool, step: usize| {
            let (a, b) = (if low { i } else { i - step }, if high { i } else { i + step });
            (heights[b] - heights[a]) / (LATTICE_STEP * ((b - a) / step) as f64)
        };
        let mut crosses: Vec<DVec2> = (0..columns * rows)
            .map(|i| {
                let (x, y) = (i % columns, i / columns);
                let slope = DVec2::new(
                    difference(i, x == 0, x + 1 == columns, 1),
                    difference(i, y == 0, y + 1 == rows, columns),
                );
                let angle = 4.0 * flat.flat_angle(at(i));
                let steepness = slope.length() / FLAT;
                let uphill = if steepness > 0.0 { 4.0 * angle_of(slope) } else { 0.0 };
                direction(angle) + direction(uphill) * steepness * steepness.min(3.0)
            })
            .collect();
        // Streets follow the lie of the land rather than its bumps.
        for _ in 0..2 {
            let before = crosses.clone();
            for y in 1..rows - 1 {
                for x in 1..columns - 1 {
                    let i = y * columns + x;
                    let around = before[i - 1] + before[i + 1] + before[i - columns] + before[i + columns];
                    crosses[i] = (before[i] * 2.0 + around) / 6.0;
                }
            }
        }
        Self { min, columns, rows, crosses }
    }

    /// The cross at `p`, interpolated between lattice points and constant outside the lattice.
    fn cross(&self, p: DVec2) -> DVec2 {
        let last = DVec2::new((self.columns - 1) as f64, (self.rows - 1) as f64);
        let at = ((p - self.min) / LATTICE_STEP).clamp(DVec2::ZERO, last);
        let cell = at.floor().min(last - 1.0);
        let (t, i) = (at - cell, cell.y as usize * self.columns + cell.x as usize);
        let low = self.crosses[i].lerp(self.crosses[i + 1], t.x);
        low.lerp(self.crosses[i + self.columns].lerp(self.crosses[i + self.columns + 1], t.x), t.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;
    use crate::terrain::TerrainSample;
    use crate::testing::Ground;

    fn draw(kind: FieldKind, seed: u64, slope: DVec2) -> DirectionField {
        let bounds = Bounds::square(DVec2::ZERO, 1000.0);
        let height = move |p: DVec2| TerrainSample { height: 500.0 + slope.dot(p), water_level: 0.0, vegetation: 0.0 };
        DirectionField::draw(kind, &mut Seed(seed).stream("test", &[]), bounds, Origin::default(), &Ground(height))
    }

    #[test]
    fn angles_are_crosses_and_change_gently() {
        for kind in [FieldKind::Grid, FieldKind::Radial, FieldKind::Organic, FieldKind::Contours] {
            for seed in 0..20 {
                let field = draw(kind, seed, DVec2::new(0.02, 0.05));
                let mut s = Seed(seed).stream("points", &[]);
                for _ in 0..50 {
                    let p = direction(s.range(0.0, TAU)) * s.range(150.0, 900.0);
                    let angle = field.angle(p);
                    assert!(angle.abs() <= FRAC_PI_2 / 2.0 + 1e-12);
                    let heading = direction(s.range(0.0, TAU));
                    let along = field.along(p, heading);
                    assert!(along.dot(heading) > 0.7 && (along.length() - 1.0).abs() < 1e-12);
                    let next = field.along(p + heading * 10.0, along);
                    assert!(next.dot(along) > 0.97, "{kind:?} turns sharply at {p}");
                }
            }
        }
    }

    #[test]
    fn contours_follow_the_slope_where_there_is_one() {
        for seed in 0..10 {
            let uphill = direction(seed as f64 * 0.37);
            let field = draw(FieldKind::Contours, seed, uphill * 0.15);
            assert!(field.along(DVec2::new(120.0, -340.0), uphill).dot(uphill) > 0.98);
            let flat = draw(FieldKind::Contours, seed, DVec2::ZERO);
            assert_eq!(flat.angle(DVec2::ONE), draw(FieldKind::Contours, seed, DVec2::ZERO).angle(DVec2::ONE));
        }
    }
}
