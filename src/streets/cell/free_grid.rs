//! A coarse grid of the distance to the nearest obstacle. It rules out most placements in a few nanoseconds, before anything
//! exact is computed.

use crate::space::Bounds;
use glam::{DVec2, Vec2, Vec4};

/// Edge of a grid square, in metres.
pub const STEP: f64 = 6.0;

/// Number of squares that are computed at once.
const LANES: usize = 4;

/// Greatest difference between the room at a point and the room at the middle of its square, in metres.
const SLACK: f64 = STEP * 0.71;

/// The room at the middle of every grid square: the distance to the nearest obstacle, squared, up to a cap, and 0 outside the
/// cell.
///
/// It approximates the work area by which Teng 2017, section 3.3, filters patches.
pub struct FreeGrid {
    origin: DVec2,
    /// The numbers of columns and rows.
    size: Vec2,
    rows: usize,
    /// Number of squares from one row to the next, a multiple of [`LANES`]. Squares beyond the last column are outside.
    stride: usize,
    room: Vec<f32>,
    /// Number of the nearest obstacle, as a float so that it is selected together with the distance.
    nearest: Vec<f32>,
    cap: f64,
}

impl FreeGrid {
    /// The grid of a cell without obstacles; not even its border is stamped. `asked` is the greatest distance in metres that
    /// the grid will be asked about.
    pub fn new(border: &[DVec2], asked: f64) -> Self {
        // More room than that makes no difference, nor does rounding.
        let cap = (asked - SLACK).max(0.0) + 0.1;
        let bounds = Bounds::of(border.iter().copied());
        let size = ((bounds.size() / STEP).ceil() + 1.0).max(DVec2::ONE);
        let (size, columns, rows) = (size.as_vec2(), size.x as usize, size.y as usize);
        let stride = columns.next_multiple_of(LANES);
        let mut room = vec![0.0; stride * rows];
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
                room[row * stride + column(pair[0])..row * stride + column(pair[1])].fill((cap * cap) as f32);
            }
        }
        let nearest = vec![0.0; room.len()];
        Self { origin: bounds.min, size, rows, stride, room, nearest, cap }
    }

    /// Adds the obstacle `number`, which is the segment `a`-`b`.
    pub fn stamp(&mut self, number: usize, a: DVec2, b: DVec2) {
        let low = ((a.min(b) - self.cap - self.origin) / STEP).floor().max(DVec2::ZERO);
        let high = ((a.max(b) + self.cap - self.origin) / STEP).ceil().max(DVec2::ZERO);
        let (x0, x1) = (low.x as usize / LANES, (high.x as usize).div_ceil(LANES).min(self.stride / LANES));
        let (y0, y1) = (low.y as usize, (high.y as usize).min(self.rows));
        // Single precision, several squares at once; the slack hides the rounding.
        let ab = (b - a).as_vec2();
        let along = ab / ab.length_squared().max(1e-6);
        let corner = (self.origin + 0.5 * STEP - a).as_vec2();
        let number = Vec4::splat(number as f32);
        for y in y0..y1 {
            let py = corner.y + y as f32 * STEP as f32;
            let row = y * self.stride..(y + 1) * self.stride;
            let room = &mut self.room[row.clone()].as_chunks_mut::<LANES>().0[x0.min(x1)..x1];
            let nearest = &mut self.nearest[row].as_chunks_mut::<LANES>().0[x0.min(x1)..x1];
            let mut column = Vec4::new(0.0, 1.0, 2.0, 3.0) + (x0 * LANES) as f32;
            for (room, nearest) in room.iter_mut().zip(nearest) {
                let px = corner.x + column * STEP as f32;
                let t = (px * along.x + py * along.y).max(Vec4::ZERO).min(Vec4::ONE);
                let (dx, dy) = (px - t * ab.x, py - t * ab.y);
                let (d2, before) = (dx * dx + dy * dy, Vec4::from_array(*room));
                *nearest = Vec4::select(d2.cmplt(before), number, Vec4::from_array(*nearest)).to_array();
                *room = d2.min(before).to_array();
                column += LANES as f32;
            }
        }
    }

    /// The room at `p`, squared. Its root is within [`SLACK`] of the distance to the nearest obstacle, up to the cap; it is 0
    /// outside the cell.
    pub fn at(&self, p: DVec2) -> f32 {
        self.at_square(self.in_squares(p))
    }

    /// A place counted in squares.
    pub fn in_squares(&self, p: DVec2) -> Vec2 {
        ((p - self.origin) * (1.0 / STEP)).as_vec2()
    }

    /// A step counted in squares.
    pub fn step_in_squares(step: DVec2) -> Vec2 {
        (step * (1.0 / STEP)).as_vec2()
    }

    /// [`at`](Self::at) for a place [counted in squares](Self::in_squares).
    pub fn at_square(&self, square: Vec2) -> f32 {
        self.index(square).map_or(0.0, |i| self.room[i])
    }

    /// Index of the square at a place counted in squares; `None` outside the grid.
    fn index(&self, square: Vec2) -> Option<usize> {
        let inside = square.x >= 0.0 && square.y >= 0.0 && square.x < self.size.x && square.y < self.size.y;
        inside.then(|| square.y as i32 as usize * self.stride + square.x as i32 as usize)
    }

    /// Number of the stamped obstacle nearest to a place [counted in squares](Self::in_squares); 0 if none is in reach, `None`
    /// outside the grid.
    pub fn nearest_at_square(&self, square: Vec2) -> Option<usize> {
        Some(self.nearest[self.index(square)?] as usize)
    }

    /// The position of a place [counted in squares](Self::in_squares).
    pub fn place(&self, square: Vec2) -> DVec2 {
        self.origin + square.as_dvec2() * STEP
    }

    /// For each ray, given by its start at a street and its direction: the approximate distance to the next obstacle, up to
    /// `reach` metres. Several rays at once take little longer than one.
    pub fn ahead<const N: usize>(&self, rays: [(DVec2, DVec2); N], reach: f64) -> [f64; N] {
        let (slack, reach) = (SLACK as f32, reach as f32);
        let rays = rays.map(|(from, direction)| (self.in_squares(from), Self::step_in_squares(direction)));
        // Not the street that is left.
        let mut far = [2.0 * slack; N];
        let mut done = [false; N];
        while done.contains(&false) {
            for i in 0..N {
                let room = self.at_square(rays[i].0 + rays[i].1 * far[i]).sqrt();
                done[i] |= far[i] >= reach || room < slack && far[i] > 4.0 * slack;
                far[i] += if done[i] { 0.0 } else { room.max(0.5 * STEP as f32) };
            }
        }
        far.map(|far| f64::from(far.min(reach)))
    }

    /// If [`at`](Self::at) is at most this, a line through the point may meet an obstacle within half a square.
    pub const MEETS: f32 = ((SLACK + 0.5 * STEP) * (SLACK + 0.5 * STEP)) as f32;

    /// If [`at`](Self::at) is greater than this, no obstacle is nearer than `distance` metres.
    pub fn most(distance: f64) -> f32 {
        let most = (distance + SLACK) as f32;
        most * most
    }

    /// If [`at`](Self::at) is less than this, an obstacle is surely nearer than `distance` metres, or the place is outside.
    /// `distance` may not exceed the distance that the grid was made for.
    pub fn least(distance: f32) -> f32 {
        let least = (distance - SLACK as f32).max(0.0);
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
        walls.iter().enumerate().for_each(|(i, (a, b))| grid.stamp(i, *a, *b));
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
