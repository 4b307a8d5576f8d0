//! How each texture is made, point by point.

use super::kind::Texture;
use super::noise::{cell, layered, random, smooth};
use crate::space::math;
use glam::{IVec2, Vec2};

/// The surface at a point.
pub(super) struct Grain {
    /// How light it is; 1 is the colour of the vertex.
    pub shade: f32,
    /// Height in metres.
    pub height: f32,
    /// Roughness beyond that of the material.
    pub rough: f32,
}

fn step(low: f32, high: f32, x: f32) -> f32 {
    math::smoothstep(f64::from(low), f64::from(high), f64::from(x)) as f32
}

fn sine(x: f32) -> f32 {
    math::sin(f64::from(x)) as f32
}

/// The place in a bond of `columns` x `rows` pieces, where odd rows lie half a piece further: the piece, the place in it (0 to 1
/// each way, y down), and the distance from its edge in metres.
fn bond(p: Vec2, columns: i32, rows: i32, size: f32) -> (IVec2, Vec2, f32) {
    let y = p.y * rows as f32;
    let row = y.floor();
    let x = p.x * columns as f32 + 0.5 * (row as i32 % 2) as f32;
    let piece = IVec2::new((x.floor() as i32).rem_euclid(columns), row as i32);
    let within = Vec2::new(x - x.floor(), y - row);
    let piece_size = Vec2::new(size / columns as f32, size / rows as f32);
    let edge = within.min(1.0 - within) * piece_size;
    (piece, within, edge.min_element())
}

impl Texture {
    /// The surface at a point of the square, 0 to 1 to the right and down.
    pub(super) fn grain(self, p: Vec2) -> Grain {
        match self {
            Self::Sand => {
                let ripple = sine(std::f32::consts::TAU * (9.0 * p.y + 0.9 * layered(p, 3, 3, 10)));
                let fine = smooth(p, 200, 1);
                Grain {
                    shade: 1.0 + 0.05 * ripple + 0.10 * fine + 0.06 * layered(p, 4, 3, 4),
                    height: 0.008 * ripple + 0.002 * fine,
                    rough: 0.0,
                }
            }
            Self::Meadow => {
                let tufts = layered(p, 14, 5, 1);
                let herb = step(0.55, 0.75, smooth(p, 90, 9)) * step(0.0, 0.4, layered(p, 5, 2, 12));
                Grain {
                    shade: 0.97 + 0.26 * tufts + 0.16 * smooth(p, 180, 7) + 0.35 * herb,
                    height: 0.05 * tufts,
                    rough: 0.0,
                }
            }
            Self::Grass => {
                let (tufts, blades) = (layered(p, 12, 3, 1), smooth(p, 150, 6) + 0.6 * smooth(p, 240, 8));
                Grain { shade: 0.98 + 0.10 * tufts + 0.15 * blades, height: 0.01 * tufts + 0.008 * blades, rough: 0.0 }
            }
            Self::Litter => {
                let (leaf, moss) = (cell(p, 56, 1), layered(p, 6, 3, 20));
                Grain {
                    shade: 0.72 + 0.62 * leaf.own - 0.25 * step(0.12, 0.0, leaf.inside) + 0.14 * moss,
                    height: 0.02 * leaf.own + 0.02 * moss,
                    rough: 0.0,
                }
            }
            Self::Rock => {
                let (folds, rough) = (layered(p, 4, 6, 1).abs(), layered(p, 24, 4, 30));
                let crack = step(0.10, 0.0, layered(p, 5, 4, 50).abs());
                Grain {
                    shade: 0.97 + 0.25 * (folds - 0.3) + 0.14 * rough - 0.28 * crack,
                    height: 0.35 * folds + 0.05 * rough - 0.08 * crack,
                    rough: 0.0,
                }
            }
            Self::Chippings => {
                let stone = cell(p, 150, 1);
                Grain {
                    shade: 0.80 + 0.42 * stone.own + 0.06 * layered(p, 3, 3, 5),
                    height: 0.004 * stone.inside,
                    rough: 0.0,
                }
            }
            Self::Asphalt => {
                let (grain, blotch) = (smooth(p, 230, 1) + 0.5 * smooth(p, 120, 2), layered(p, 3, 4, 5));
                let crack = step(0.018, 0.004, layered(p, 3, 5, 40).abs()) * step(0.15, 0.5, layered(p, 2, 2, 60));
                Grain {
                    shade: 1.0 + 0.13 * grain + 0.07 * blotch - 0.35 * crack,
                    height: 0.0012 * grain - 0.004 * crack,
                    rough: -0.06 * blotch,
                }
            }
            Self::Flags => {
                let stone = cell(p, 9, 1);
                let joint = step(0.035, 0.012, stone.inside);
                let grain = smooth(p, 200, 5);
                Grain {
                    shade: 0.94 + 0.15 * stone.own + 0.05 * grain + 0.05 * layered(p, 3, 3, 8) - 0.30 * joint,
                    height: -0.006 * joint + 0.0006 * grain,
                    rough: 0.1 * joint,
                }
            }
            Self::Stone => {
                let grain = smooth(p, 180, 1);
                Grain { shade: 1.0 + 0.07 * grain + 0.07 * layered(p, 4, 4, 3), height: 0.0008 * grain, rough: 0.0 }
            }
            Self::Paint => {
                let worn = step(0.25, 0.75, 0.7 * layered(p, 8, 4, 1) + 0.5 * smooth(p, 160, 9));
                Grain { shade: 1.06 + 0.03 * smooth(p, 120, 3) - 0.42 * worn, height: 0.0, rough: -0.15 * (1.0 - worn) }
            }
            Self::Plaster => {
                let (fine, stain) = (smooth(p, 160, 1), layered(p, 2, 4, 9));
                Grain { shade: 1.0 + 0.03 * fine + 0.05 * stain, height: 0.0009 * fine, rough: 0.0 }
            }
            Self::Brick => {
                let (piece, _, edge) = bond(p, 8, 26, self.size());
                let joint = step(0.009, 0.005, edge);
                let grain = smooth(p, 150, 4);
                let own = random(piece, 3);
                Grain {
                    shade: (0.80 + 0.40 * own + 0.07 * grain) * (1.0 - joint) + 1.35 * joint,
                    height: -0.006 * joint + 0.0008 * grain,
                    rough: 0.05 * joint,
                }
            }
            Self::Tiles => {
                let (piece, within, _) = bond(p, 8, 8, self.size());
                let arch = sine(std::f32::consts::PI * within.x);
                let own = random(piece, 5);
                let lap = step(0.90, 0.98, within.y);
                let side = step(0.07, 0.0, within.x.min(1.0 - within.x));
                Grain {
                    shade: 0.92 + 0.24 * own + 0.10 * (arch - 0.6) - 0.45 * lap - 0.22 * side,
                    height: 0.022 * arch + 0.018 * within.y,
                    rough: 0.0,
                }
            }
            Self::Felt => {
                let gravel = cell(p, 130, 2);
                Grain {
                    shade: 0.86 + 0.28 * gravel.own + 0.08 * layered(p, 3, 4, 11),
                    height: 0.004 * gravel.own,
                    rough: 0.0,
                }
            }
        }
    }
}
