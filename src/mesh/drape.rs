//! Laying flat shapes on the drawn ground. Shapes are cut along the triangles of the ground, so that they follow the ground
//! exactly and it never shows through.

use crate::chunk::Chunk;
use crate::mesh::buffers::{MeshBuffers, Rgb};
use crate::network::StreetId;
use crate::space::{Bounds, cross};
use crate::surface::Deck;
use crate::terrain::{GROUND_STEP, Terrain};
use glam::{DVec2, DVec3, IVec2};
use std::collections::BTreeMap;

/// Height (metres) and gradient at a vertex of the ground grid.
type Corner = (f64, DVec2);

/// The drawn ground in a chunk's frame, inside and outside the chunk's square, at every `stride`-th vertex.
pub(super) struct Drape<'a> {
    chunk: &'a Chunk,
    terrain: &'a dyn Terrain,
    stride: i32,
    /// Distance between vertices, in metres.
    step: f64,
    /// Steps along an edge of the square.
    cells: i32,
    inside: Vec<Corner>,
    outside: BTreeMap<(i32, i32), Corner>,
    heights: BTreeMap<(i32, i32), f64>,
    scratch: [Vec<DVec2>; 4],
}

impl<'a> Drape<'a> {
    /// The ground at every `stride`-th vertex. `stride` divides the number of steps along the chunk's square.
    pub fn new(chunk: &'a Chunk, terrain: &'a dyn Terrain, stride: i32) -> Self {
        let cells = chunk.ground.cells as i32 / stride;
        let mut drape = Self {
            chunk,
            terrain,
            stride,
            step: GROUND_STEP * f64::from(stride),
            cells,
            inside: Vec::with_capacity(((cells + 1) * (cells + 1)) as usize),
            outside: BTreeMap::new(),
            heights: BTreeMap::new(),
            scratch: Default::default(),
        };
        for row in 0..=cells {
            for column in 0..=cells {
                let corner = drape.measure(IVec2::new(column, row));
                drape.inside.push(corner);
            }
        }
        drape
    }

    /// The deck of a bridge, if it passes over the chunk.
    pub fn deck(&self, bridge: StreetId) -> Option<&'a Deck> {
        self.chunk.decks.iter().find(|d| d.street == bridge)
    }

    fn is_inside(&self, at: IVec2) -> bool {
        at.min_element() >= 0 && at.max_element() <= self.cells
    }

    /// Height at a vertex, in metres.
    fn height_of(&mut self, at: IVec2) -> f64 {
        if self.is_inside(at) {
            let at = at * self.stride;
            return self.chunk.ground.vertex(at.x as usize, at.y as usize).height;
        }
        let (terrain, plan) = (self.terrain, self.chunk.origin.to_plan(at.as_dvec2() * self.step));
        *self.heights.entry((at.x, at.y)).or_insert_with(|| terrain.height(plan))
    }

    fn measure(&mut self, at: IVec2) -> Corner {
        let along = |s: &mut Self, d: IVec2| (s.height_of(at + d) - s.height_of(at - d)) / (2.0 * s.step);
        let gradient = DVec2::new(along(self, IVec2::X), along(self, IVec2::Y));
        (self.height_of(at), gradient)
    }

    /// Height and gradient at a vertex.
    pub fn corner(&mut self, at: IVec2) -> Corner {
        if self.is_inside(at) && !self.inside.is_empty() {
            return self.inside[(at.y * (self.cells + 1) + at.x) as usize];
        }
        if let Some(corner) = self.outside.get(&(at.x, at.y)) {
            return *corner;
        }
        let corner = self.measure(at);
        self.outside.insert((at.x, at.y), corner);
        corner
    }

    /// The plane of the lower (south-east) or upper ground triangle of the grid square at `cell`: height and gradient at the
    /// square's south-west corner, and their changes over the square to the east and to the north.
    fn plane(&mut self, cell: IVec2, lower: bool) -> [Corner; 3] {
        let sw = self.corner(cell);
        let ne = self.corner(cell + IVec2::ONE);
        let minus = |a: Corner, b: Corner| (a.0 - b.0, a.1 - b.1);
        if lower {
            let se = self.corner(cell + IVec2::X);
            [sw, minus(se, sw), minus(ne, se)]
        } else {
            let nw = self.corner(cell + IVec2::Y);
            [sw, minus(ne, nw), minus(nw, sw)]
        }
    }

    /// Height of the drawn ground at a local point, in metres.
    pub fn height(&mut self, p: DVec2) -> f64 {
        let cell = (p / self.step).floor();
        let f = p / self.step - cell;
        let [o, x, y] = self.plane(cell.as_ivec2(), f.x >= f.y);
        o.0 + x.0 * f.x + y.0 * f.y
    }

    /// Adds a convex polygon (counter-clockwise), `lift` metres above the ground.
    pub fn lay(&mut self, out: &mut MeshBuffers, polygon: &[DVec2], lift: f64, colour: Rgb) {
        let [mut strip, mut square, mut half, mut spare] = std::mem::take(&mut self.scratch);
        let bounds = Bounds::of(polygon.iter().copied());
        let (low, high) = ((bounds.min / self.step).floor(), (bounds.max / self.step).floor());
        for row in low.y as i32..=high.y as i32 {
            let y = f64::from(row) * self.step;
            cut(polygon, &mut spare, |p| p.y - y);
            cut(&spare, &mut strip, |p| y + self.step - p.y);
            let (west, east) =
                strip.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p.x), h.max(p.x)));
            if strip.len() < 3 {
                continue;
            }
            for column in (west / self.step).floor() as i32..=(east / self.step).floor() as i32 {
                let corner = DVec2::new(f64::from(column) * self.step, y);
                cut(&strip, &mut spare, |p| p.x - corner.x);
                cut(&spare, &mut square, |p| corner.x + self.step - p.x);
                for lower in [true, false] {
                    let side = |p: DVec2| (p.x - corner.x) - (p.y - corner.y);
                    cut(&square, &mut half, |p| if lower { side(p) } else { -side(p) });
                    if half.len() < 3 {
                        continue;
                    }
                    let [o, x, y] = self.plane(IVec2::new(column, row), lower);
                    let first = out.positions.len() as u32;
                    for &p in &half {
                        let f = (p - corner) / self.step;
                        let gradient = o.1 + x.1 * f.x + y.1 * f.y;
                        let at = p.extend(o.0 + x.0 * f.x + y.0 * f.y + lift);
                        out.vertex(at, DVec3::new(-gradient.x, -gradient.y, 1.0).normalize(), colour, 1.0);
                    }
                    for i in 1..half.len() as u32 - 1 {
                        out.triangle([first, first + i, first + i + 1]);
                    }
                }
            }
        }
        self.scratch = [strip, square, half, spare];
    }

    /// Adds a quadrangle. If it is not convex, only its triangles that run counter-clockwise are added.
    pub fn lay_quad(&mut self, out: &mut MeshBuffers, quad: [DVec2; 4], lift: f64, colour: Rgb) {
        let turn = |i: usize| {
            let [a, b, c] = [0, 1, 2].map(|k| quad[(i + k) % 4]);
            cross(b - a, c - b)
        };
        if (0..4).all(|i| turn(i) >= 0.0) {
            self.lay(out, &quad, lift, colour);
        } else {
            self.lay_triangle(out, [quad[0], quad[1], quad[2]], lift, colour);
            self.lay_triangle(out, [quad[0], quad[2], quad[3]], lift, colour);
        }
    }

    /// Adds a triangle if it runs counter-clockwise.
    pub fn lay_triangle(&mut self, out: &mut MeshBuffers, [a, b, c]: [DVec2; 3], lift: f64, colour: Rgb) {
        if cross(b - a, c - a) > 0.0 {
            self.lay(out, &[a, b, c], lift, colour);
        }
    }

    /// Adds a wall along `a`-`b` that faces to the right, from `low` to `high` metres above the ground.
    pub fn wall(&mut self, out: &mut MeshBuffers, [a, b]: [DVec2; 2], [low, high]: [f64; 2], colour: Rgb) {
        let d = b - a;
        if d.length_squared() < 1e-4 {
            return;
        }
        let normal = (-d.perp()).normalize().extend(0.0);
        // The wall is cut where it passes from one ground triangle to the next.
        let mut cuts = vec![0.0, 1.0];
        for (from, along) in [(a.x, d.x), (a.y, d.y), (a.x - a.y, d.x - d.y)] {
            if along.abs() < 1e-9 {
                continue;
            }
            let (s, e) = (from / self.step, (from + along) / self.step);
            let (s, e) = (s.min(e).ceil() as i64, s.max(e).floor() as i64);
            cuts.extend((s..=e).map(|k| (k as f64 * self.step - from) / along).filter(|t| *t > 0.0 && *t < 1.0));
        }
        cuts.sort_by(f64::total_cmp);
        let mut before: Option<(DVec2, [u32; 2])> = None;
        for t in cuts {
            let p = if t == 1.0 { b } else { a + d * t };
            if before.is_some_and(|(q, _)| q.distance_squared(p) < 1e-4) && t < 1.0 {
                continue;
            }
            let ground = self.height(p);
            let pair = [low, high].map(|lift| out.vertex(p.extend(ground + lift), normal, colour, 1.0));
            if let Some((_, [low, high])) = before {
                out.triangle([low, pair[0], pair[1]]);
                out.triangle([low, pair[1], high]);
            }
            before = Some((p, pair));
        }
    }
}

/// Cuts a convex polygon to its part where `depth`, a linear function, is not negative.
fn cut(polygon: &[DVec2], out: &mut Vec<DVec2>, depth: impl Fn(DVec2) -> f64) {
    out.clear();
    let Some(&last) = polygon.last() else { return };
    let (mut a, mut da) = (last, depth(last));
    for &b in polygon {
        let db = depth(b);
        if (da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0) {
            out.push(a + (b - a) * (da / (da - db)));
        }
        if db >= 0.0 {
            out.push(b);
        }
        (a, da) = (b, db);
    }
}
