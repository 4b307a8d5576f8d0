//! Random fields on a square that repeats, for pictures: coordinates run from 0 to 1.
//!
//! The `noise` crate has no fields that repeat after a given number of cells. A torus in four dimensions repeats, too, but takes
//! ten times as long.

use glam::{IVec2, Vec2};

/// A random number for a corner of a lattice, 0 to 1.
pub(super) fn random(at: IVec2, salt: u32) -> f32 {
    let mut h = (at.x as u32).wrapping_mul(0x9E37_79B1)
        ^ (at.y as u32).wrapping_mul(0x85EB_CA77)
        ^ salt.wrapping_mul(0xC2B2_AE3D);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    (h ^ (h >> 15)) as f32 / u32::MAX as f32
}

/// Smooth noise, -1 to 1, with `cells` cells along each side of the square.
pub(super) fn smooth(p: Vec2, cells: i32, salt: u32) -> f32 {
    let p = p * cells as f32;
    let (corner, t) = (p.floor(), p - p.floor());
    let t = t * t * (3.0 - 2.0 * t);
    let value = |x: i32, y: i32| {
        let at = corner.as_ivec2() + IVec2::new(x, y);
        random(IVec2::new(at.x.rem_euclid(cells), at.y.rem_euclid(cells)), salt)
    };
    let low = value(0, 0) + (value(1, 0) - value(0, 0)) * t.x;
    let high = value(0, 1) + (value(1, 1) - value(0, 1)) * t.x;
    2.0 * (low + (high - low) * t.y) - 1.0
}

/// Smooth noise of `octaves` sizes, about -1 to 1: from `cells` cells a side, each octave half as large and half as strong.
pub(super) fn layered(p: Vec2, cells: i32, octaves: u32, salt: u32) -> f32 {
    let (mut sum, mut strength, mut total) = (0.0, 1.0, 0.0);
    for octave in 0..octaves {
        sum += strength * smooth(p, cells << octave, salt + octave);
        total += strength * strength;
        strength *= 0.5;
    }
    sum / f32::sqrt(total)
}

/// A cell around a random point.
pub(super) struct Cell {
    /// A random number of the cell, 0 to 1.
    pub own: f32,
    /// Distance from the nearest edge of the cell, in edges of a cell of the lattice, about.
    pub inside: f32,
}

/// The cell at a point, of `cells` cells a side with one random point each.
pub(super) fn cell(p: Vec2, cells: i32, salt: u32) -> Cell {
    let p = p * cells as f32;
    let home = p.floor().as_ivec2();
    let (mut first, mut second, mut own) = (f32::INFINITY, f32::INFINITY, 0.0);
    for y in -1..=1 {
        for x in -1..=1 {
            let at = home + IVec2::new(x, y);
            let name = IVec2::new(at.x.rem_euclid(cells), at.y.rem_euclid(cells));
            // Points keep to the middle of their cells, so that none is tiny.
            let point = at.as_vec2() + 0.5 + (Vec2::new(random(name, salt), random(name, salt + 1)) - 0.5) * 0.8;
            let distance = point.distance(p);
            if distance < first {
                (second, first, own) = (first, distance, random(name, salt + 2));
            } else if distance < second {
                second = distance;
            }
        }
    }
    Cell { own, inside: (second - first) / 2.0 }
}
