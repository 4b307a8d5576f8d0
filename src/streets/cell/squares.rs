//! An index of the obstacles along a ray: the cell is cut into squares, and each square knows the obstacles whose boxes reach
//! into it.

use crate::space::Bounds;
use glam::{DVec2, IVec2};

/// Edge of a square, in metres.
const SIDE: f64 = 40.0;

/// Margin around boxes and rays, in metres; far more than rounding errors.
const MARGIN: f64 = 0.1;

/// Up to this number, all squares of a ray's box are visited.
const FEW: i32 = 4;

/// Marks the end of a list.
const END: u32 = u32::MAX;

/// Obstacles, by number, in linked lists per square.
pub struct Squares {
    corner: DVec2,
    size: IVec2,
    /// The last link of each square.
    heads: Vec<u32>,
    /// Each link is an obstacle and the link before.
    links: Vec<(u32, u32)>,
}

impl Squares {
    /// The squares of a cell. Obstacles outside the bounds belong to the nearest square.
    pub fn new(bounds: Bounds) -> Self {
        let size = (bounds.size() / SIDE).ceil().clamp(DVec2::ONE, DVec2::splat(512.0)).as_ivec2();
        let heads = vec![END; (size.x * size.y) as usize];
        Self { corner: bounds.min, size, heads, links: Vec::new() }
    }

    fn square(&self, p: DVec2) -> IVec2 {
        ((p - self.corner) * (1.0 / SIDE)).as_ivec2().clamp(IVec2::ZERO, self.size - 1)
    }

    /// The lowest and the highest square that a box reaches into.
    fn extent(&self, bounds: Bounds) -> [IVec2; 2] {
        [self.square(bounds.min - MARGIN), self.square(bounds.max + MARGIN)]
    }

    fn links_of(&self, x: i32, y: i32) -> impl Iterator<Item = u32> + '_ {
        let head = self.heads[(y * self.size.x + x) as usize];
        let links = std::iter::successors(self.links.get(head as usize), |link| self.links.get(link.1 as usize));
        links.map(|link| link.0)
    }

    /// Adds an obstacle, which is the segment `a`-`b`. An obstacle that was added before is found at its old place as well.
    pub fn put(&mut self, obstacle: u32, a: DVec2, b: DVec2) {
        let [low, high] = self.extent(Bounds::of([a, b]));
        for (x, y) in (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| (x, y))) {
            let head = &mut self.heads[(y * self.size.x + x) as usize];
            self.links.push((obstacle, *head));
            *head = (self.links.len() - 1) as u32;
        }
    }

    /// Visits the obstacles that the segment `from`-`to` may meet, roughly in the order of meeting, and some of them more than
    /// once. `visit` receives each obstacle and may shorten the segment by moving its end.
    pub fn along(&self, from: DVec2, mut to: DVec2, mut visit: impl FnMut(u32, &mut DVec2)) {
        let [low, high] = self.extent(Bounds::of([from, to]));
        let extent = high - low + 1;
        if extent.x * extent.y <= FEW {
            for (x, y) in (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| (x, y))) {
                self.links_of(x, y).for_each(|obstacle| visit(obstacle, &mut to));
            }
            return;
        }
        let step = to - from;
        let east = if step.x < 0.0 { -1 } else { 1 };
        let north = if step.y < 0.0 { -1 } else { 1 };
        let mut y = self.square(from - f64::from(north) * MARGIN).y;
        let slope = step.x / step.y;
        let side = DVec2::new(f64::from(east), f64::from(north)) * MARGIN;
        loop {
            let last = self.square(to + side);
            if (last.y - y) * north < 0 {
                break;
            }
            // The part of the segment within the row: where it enters and where it leaves.
            let (mut enters, mut leaves) = (from.x, to.x);
            if slope.is_finite() {
                let south = self.corner.y + f64::from(y) * SIDE;
                let (near, far) = if north > 0 { (south, south + SIDE) } else { (south + SIDE, south) };
                let at = |edge: f64| from.x + (edge - from.y) * slope;
                let is_first = (near - side.y - from.y) * f64::from(north) <= 0.0;
                let is_last = (far + side.y - to.y) * f64::from(north) >= 0.0;
                if !is_first && y > 0 && y + 1 < self.size.y {
                    enters = at(near - side.y);
                }
                if !is_last && y > 0 && y + 1 < self.size.y {
                    leaves = at(far + side.y);
                }
            }
            let mut x = self.square(DVec2::new(enters - side.x, from.y)).x;
            let end = self.square(DVec2::new(leaves + side.x, from.y)).x;
            while (end - x) * east >= 0 {
                for obstacle in self.links_of(x, y) {
                    visit(obstacle, &mut to);
                }
                x += east;
            }
            y += north;
            if y < 0 || y >= self.size.y {
                break;
            }
        }
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::space::{Seed, segment_crossing};

    /// A random cell and what makes random segments about it: some outside, some along the axes.
    pub fn segments_about(seed: u64) -> (Bounds, impl FnMut() -> (DVec2, DVec2)) {
        let mut s = Seed(seed).stream("test", &[]);
        let bounds = Bounds::new(DVec2::new(-50.0, 20.0), DVec2::new(s.range(30.0, 500.0), s.range(60.0, 500.0)));
        let place = move || {
            let p = DVec2::new(s.range(-120.0, 560.0), s.range(-60.0, 560.0));
            let p = if s.chance(0.3) { (p / 40.0).round() * 40.0 - DVec2::new(50.0, 20.0) } else { p };
            let d = DVec2::new(s.range(-90.0, 90.0), s.range(-90.0, 90.0));
            let d = if s.chance(0.2) { DVec2::new(d.x, 0.0) } else { d };
            (p, p + if s.chance(0.2) { DVec2::new(0.0, d.y) } else { d })
        };
        (bounds, place)
    }

    #[test]
    fn finds_what_a_full_scan_finds() {
        for seed in 0..40 {
            let (bounds, mut place) = segments_about(seed);
            let mut squares = Squares::new(bounds);
            let lines: Vec<_> = (0..150).map(|_| place()).collect();
            lines.iter().enumerate().for_each(|(i, (a, b))| squares.put(i as u32, *a, *b));
            for _ in 0..100 {
                let (a, b) = place();
                let mut seen = vec![0; lines.len()];
                squares.along(a, b, |i, _| seen[i as usize] += 1);
                for (i, (c, d)) in lines.iter().enumerate() {
                    assert!(seen[i] > 0 || segment_crossing(a, b, *c, *d).is_none(), "{seed}: {a} {b} meets {c} {d}");
                }
            }
        }
    }
}
