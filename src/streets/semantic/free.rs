//! A coarse grid of the free room around every point of a cell: what lets most placements be turned down in a few
//! nanoseconds, before anything exact is computed.

use crate::space::Bounds;
use glam::DVec2;

/// Edge of a grid square, in metres.
const STEP: f64 = 6.0;

/// Greatest difference between the room at a point and at the middle of its square.
const SLACK: f64 = STEP * 0.71;

/// Square of the distance to the nearest obstacle at the middle of every grid square, up to a cap; 0 outside the cell.
///
/// This is the approximation of the work area that Teng 2017, section 3.3, filters patches with.
pub(super) struct FreeGrid {
    origin: DVec2,
    columns: usize,
    rows: usize,
    /// The numbers of columns and rows once more.
    size: DVec2,
    room: Vec<f32>,
    cap: f64,
}

impl FreeGrid {
    /// The grid of an empty cell; the border itself is not stamped yet. `asked` is the greatest distance that will be asked
    /// for.
    pub fn new(border: &[DVec2], asked: f64) -> Self {
        // More room than that makes no difference, nor does rounding.
        let cap = (asked - SLACK).max(0.0) + 0.1;
        let bounds = Bounds::of(border.iter().copied());
        let size = ((bounds.size() / STEP).ceil() + 1.0).max(DVec2::ONE);
        let (columns, rows) = (size.x as usize, size.y as usize);
        let mut room = vec![0.0; columns * rows];
        let mut crossings: Vec<f64> = Vec::new();
        for row in 0..rows {
            let y = bounds.min.y + (row as f64 + 0.5) * STEP;
            crossings.clear();
            for (i, &a) in border.iter().enumerate() {
                let b = border[(i + 1) % border.len()];
                if (a.y > y) != (b.y > y) {
                    crossings.push(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
                }
            }
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let column = |x: f64| (((x - bounds.min.x) / STEP + 0.5).floor().max(0.0) as usize).min(columns);
                room[row * columns + column(pair[0])..row * columns + column(pair[1])].fill((cap * cap) as f32);
            }
        }
        Self { origin: bounds.min, columns, rows, size: DVec2::new(columns as f64, rows as f64), room, cap }
    }

    /// Takes the segment `a`-`b` into account.
    pub fn stamp(&mut self, a: DVec2, b: DVec2) {
        let low = ((a.min(b) - self.cap - self.origin) / STEP).floor().max(DVec2::ZERO);
        let high = ((a.max(b) + self.cap - self.origin) / STEP).ceil().max(DVec2::ZERO);
        let (x0, x1) = (low.x as usize, (high.x as usize).min(self.columns));
        let (y0, y1) = (low.y as usize, (high.y as usize).min(self.rows));
        // Single precision, without branches, so that several squares are done at once; the slack hides the rounding.
        let ab = (b - a).as_vec2();
        let per_length = 1.0 / ab.length_squared().max(1e-6);
        let corner = (self.origin + 0.5 * STEP - a).as_vec2();
        for y in y0..y1 {
            let py = corner.y + y as f32 * STEP as f32;
            let row = y * self.columns;
            // Numbers of 32 bits become floats several at once.
            for (x, cell) in (x0 as i32..x1 as i32).zip(&mut self.room[row + x0.min(x1)..row + x1]) {
                let px = corner.x + x as f32 * STEP as f32;
                let t = (px * ab.x + py * ab.y) * per_length;
                let t = if t < 0.0 { 0.0 } else { t };
                let t = if t > 1.0 { 1.0 } else { t };
                let (dx, dy) = (px - ab.x * t, py - ab.y * t);
                let d2 = dx * dx + dy * dy;
                *cell = if d2 < *cell { d2 } else { *cell };
            }
        }
    }

    /// Square of the room at the square of `p`, whose root is within [`SLACK`] of the distance to the nearest obstacle, or
    /// the cap; 0 outside.
    pub fn at(&self, p: DVec2) -> f64 {
        self.at_square(self.in_squares(p))
    }

    /// A place counted in squares.
    pub fn in_squares(&self, p: DVec2) -> DVec2 {
        (p - self.origin) * (1.0 / STEP)
    }

    /// A step counted in squares.
    pub fn step_in_squares(step: DVec2) -> DVec2 {
        step * (1.0 / STEP)
    }

    /// [`at`](Self::at) for a place [counted in squares](Self::in_squares).
    pub fn at_square(&self, square: DVec2) -> f64 {
        let inside = square.x >= 0.0 && square.y >= 0.0 && square.x < self.size.x && square.y < self.size.y;
        if !inside {
            return 0.0;
        }
        let square = square.y as i32 as usize * self.columns + square.x as i32 as usize;
        self.room.get(square).copied().map_or(0.0, f64::from)
    }

    /// About how far it is from a street at `from` in this direction to what is met next, up to `reach`.
    pub fn ahead(&self, from: DVec2, direction: DVec2, reach: f64) -> f64 {
        // Not the street that is left.
        let mut far = 2.0 * SLACK;
        while far < reach {
            let room = self.at(from + direction * far).sqrt();
            if room < SLACK && far > 4.0 * SLACK {
                break;
            }
            far += room.max(0.5 * STEP);
        }
        far.min(reach)
    }

    /// Where [`at`](Self::at) is more than this, no obstacle is nearer than `distance`.
    pub fn most(distance: f64) -> f64 {
        (distance + SLACK) * (distance + SLACK)
    }

    /// Where [`at`](Self::at) is less than this, an obstacle is surely nearer than `distance`, no more than what was to be asked, or
    /// the place is outside.
    pub fn least(distance: f64) -> f64 {
        let least = (distance - SLACK).max(0.0);
        least * least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Seed, distance_to_segment};

    #[test]
    fn never_turns_down_a_point_with_room() {
        let mut s = Seed(3).stream("test", &[]);
        let border = [DVec2::ZERO, DVec2::new(190.0, -20.0), DVec2::new(230.0, 160.0), DVec2::new(20.0, 210.0)];
        let mut grid = FreeGrid::new(&border, 30.0);
        let mut walls: Vec<_> = (0..4).map(|i| (border[i], border[(i + 1) % 4])).collect();
        walls.push((DVec2::new(60.0, 60.0), DVec2::new(130.0, 90.0)));
        walls.iter().for_each(|(a, b)| grid.stamp(*a, *b));
        for _ in 0..2000 {
            let p = DVec2::new(s.range(0.0, 230.0), s.range(-20.0, 210.0));
            let room = walls.iter().map(|(a, b)| distance_to_segment(p, *a, *b)).fold(f64::MAX, f64::min);
            let inside = crate::space::point_in_polygon(p, &border);
            if inside && room > 25.0 {
                assert!(grid.at(p) >= FreeGrid::least(25.0), "{p} has {room}");
            }
            if !inside && room > 9.0 {
                assert_eq!(grid.at(p), 0.0);
            }
        }
    }
}
