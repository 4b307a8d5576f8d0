//! A constrained Delaunay triangulation of points of a square on the quantum grid.
//!
//! Points enter one by one, each by flips (Lawson 1977), in an order in which the triangle of each is a few steps from the last
//! point's. Edges are forced by flips (Sloan 1993). Whole numbers make all decisions exact. With the bulk load of `spade`, which
//! knows nothing of the grid, ground and streets of dense chunks took 7.5 to 10 ms where they now take 5.2 to 7.4.

use super::sheet::turn;
use glam::IVec2;

/// In place of a half-edge where there is none.
const NONE: u32 = u32::MAX;

/// Edge of the cells by which points are put in order, as a power of two in steps: 4 m.
const CELL: u32 = 12;

/// An edge crosses another that may not be flipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Crossing;

/// Triangles over a square, as half-edges: three in a row are a triangle, counter-clockwise.
pub(super) struct Triangulation<'a> {
    at: &'a [IVec2],
    /// The vertex at which each half-edge starts.
    starts: Vec<u32>,
    /// The half-edge that runs the other way, in the triangle beyond.
    twins: Vec<u32>,
    /// Whether the edge may not be flipped.
    fixed: Vec<bool>,
    /// A half-edge that leaves each vertex.
    leaving: Vec<u32>,
}

fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

fn previous(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl<'a> Triangulation<'a> {
    /// The Delaunay triangulation of points. No two are the same; the first four are the corners of the square, counter-clockwise.
    pub fn new(at: &'a [IVec2]) -> Self {
        let room = 6 * at.len();
        let mut out = Self {
            at,
            starts: Vec::with_capacity(room),
            twins: Vec::with_capacity(room),
            fixed: Vec::with_capacity(room),
            leaving: vec![NONE; at.len()],
        };
        out.triangle([0, 1, 2]);
        out.triangle([0, 2, 3]);
        out.link(2, 3);
        let mut order: Vec<(u32, u32)> = (4..at.len() as u32).map(|v| (place(at[v as usize]), v)).collect();
        order.sort_unstable();
        let (mut near, mut stack) = (0, Vec::new());
        for (_, v) in order {
            near = out.insert(v, near, &mut stack);
        }
        out
    }

    /// Number of half-edges, three to a triangle.
    pub fn half_edges(&self) -> u32 {
        self.starts.len() as u32
    }

    /// The corners of the triangle that begins at half-edge `h`.
    pub fn corners(&self, h: u32) -> [u32; 3] {
        [0, 1, 2].map(|i| self.starts[(h + i) as usize])
    }

    /// The half-edge that runs the other way, if there is a triangle beyond.
    pub fn twin(&self, h: u32) -> Option<u32> {
        Some(self.twins[h as usize]).filter(|twin| *twin != NONE)
    }

    /// The half-edge from one vertex to another, if they are neighbours and a triangle lies to its left.
    pub fn find(&self, a: u32, b: u32) -> Option<u32> {
        self.around(a).find(|h| self.end(*h) == b)
    }

    /// Makes the straight line between two vertices an edge that is never flipped, or several edges if other vertices lie on it.
    /// After an error, the line may be fixed as far as a vertex that lies on it.
    pub fn fix(&mut self, mut a: u32, b: u32) -> Result<(), Crossing> {
        while a != b {
            a = match self.toward(a, b).ok_or(Crossing)? {
                Toward::Along(h, end) => {
                    self.set_fixed(h);
                    end
                }
                Toward::Across(h) => self.force(a, b, h)?,
            };
        }
        Ok(())
    }

    /// Flips edges between triangles that are `free` until no corner beyond such an edge lies within the circle around a triangle.
    pub fn improve(&mut self, free: &[bool]) {
        let mut stack: Vec<u32> = (0..self.half_edges()).filter(|h| *h < self.twins[*h as usize]).collect();
        stack.reverse();
        while let Some(h) = stack.pop() {
            let twin = self.twins[h as usize];
            let stays = |h: u32| h == NONE || self.fixed[h as usize] || !free[h as usize / 3];
            if stays(h) || stays(twin) || !self.is_flat(h) {
                continue;
            }
            self.flip(h);
            stack.extend([next(h), previous(h), next(twin), previous(twin)]);
        }
    }

    fn end(&self, h: u32) -> u32 {
        self.starts[next(h) as usize]
    }

    /// The corner opposite of a half-edge.
    fn apex(&self, h: u32) -> u32 {
        self.starts[previous(h) as usize]
    }

    fn side(&self, a: u32, b: u32, p: u32) -> i64 {
        turn(self.at[a as usize], self.at[b as usize], self.at[p as usize])
    }

    fn triangle(&mut self, corners: [u32; 3]) -> u32 {
        let h = self.half_edges();
        for (i, v) in corners.into_iter().enumerate() {
            self.starts.push(v);
            self.twins.push(NONE);
            self.fixed.push(false);
            self.leaving[v as usize] = h + i as u32;
        }
        h
    }

    fn link(&mut self, h: u32, twin: u32) {
        self.twins[h as usize] = twin;
        if twin != NONE {
            self.twins[twin as usize] = h;
        }
    }

    fn set_fixed(&mut self, h: u32) {
        self.fixed[h as usize] = true;
        if let Some(twin) = self.twin(h) {
            self.fixed[twin as usize] = true;
        }
    }

    /// Inserts a point. `near` is a half-edge near it; returns one that leaves it.
    fn insert(&mut self, p: u32, near: u32, stack: &mut Vec<u32>) -> u32 {
        let (mut h, mut sides) = (near - near % 3, [0; 3]);
        'walk: loop {
            for i in 0..3 {
                sides[i as usize] = self.side(self.starts[(h + i) as usize], self.end(h + i), p);
                if sides[i as usize] < 0 {
                    let beyond = self.twins[(h + i) as usize];
                    h = beyond - beyond % 3;
                    continue 'walk;
                }
            }
            break;
        }
        match (0..3).find(|i| sides[*i as usize] == 0) {
            Some(i) => self.split_edge(h + i, p, stack),
            None => self.split_triangle(h, p, stack),
        }
        while let Some(h) = stack.pop() {
            if self.twins[h as usize] != NONE && self.is_flat(h) {
                let twin = self.twins[h as usize];
                self.flip(h);
                stack.extend([previous(h), next(twin)]);
            }
        }
        self.leaving[p as usize]
    }

    fn split_triangle(&mut self, h: u32, p: u32, stack: &mut Vec<u32>) {
        let [a, b, c] = self.corners(h);
        let [beyond_b, beyond_c] = [1, 2].map(|i| self.twins[(h + i) as usize]);
        self.starts[h as usize + 2] = p;
        let (f, g) = (self.triangle([b, c, p]), self.triangle([c, a, p]));
        self.link(f, beyond_b);
        self.link(g, beyond_c);
        self.link(h + 1, f + 2);
        self.link(f + 1, g + 2);
        self.link(g + 1, h + 2);
        self.leaving[a as usize] = h;
        self.leaving[b as usize] = h + 1;
        stack.extend([h, f, g]);
    }

    fn split_edge(&mut self, h: u32, p: u32, stack: &mut Vec<u32>) {
        let twin = self.twins[h as usize];
        let (a, b, c) = (self.starts[h as usize], self.end(h), self.apex(h));
        let half = |out: &mut Self, h: u32, b: u32, c: u32| {
            let beyond = out.twins[next(h) as usize];
            out.starts[next(h) as usize] = p;
            let f = out.triangle([p, b, c]);
            out.link(f + 1, beyond);
            out.link(next(h), f + 2);
            f
        };
        let f = half(self, h, b, c);
        stack.extend([previous(h), f + 1]);
        self.link(f, NONE);
        if twin != NONE {
            let d = self.apex(twin);
            let g = half(self, twin, a, d);
            self.link(h, g);
            self.link(f, twin);
            stack.extend([previous(twin), g + 1]);
        }
        self.leaving[a as usize] = h;
        self.leaving[p as usize] = next(h);
    }

    /// Whether the corner beyond an edge lies within the circle around its triangle.
    fn is_flat(&self, h: u32) -> bool {
        let at = |v: u32| self.at[v as usize];
        let d = at(self.apex(self.twins[h as usize]));
        let [a, b, c] = [self.starts[h as usize], self.end(h), self.apex(h)].map(|v| (at(v) - d).as_i64vec2());
        let lifted = |p: glam::I64Vec2, q: glam::I64Vec2, r: glam::I64Vec2| {
            i128::from(p.length_squared()) * i128::from(q.perp_dot(r))
        };
        lifted(a, b, c) + lifted(b, c, a) + lifted(c, a, b) > 0
    }

    /// Turns an edge around within its two triangles. The edge keeps its half-edges; those around it move on by one.
    fn flip(&mut self, h: u32) {
        let g = self.twins[h as usize];
        let [hn, hp, gn, gp] = [next(h), previous(h), next(g), previous(g)];
        let [a, b, c, d] = [h, g, hp, gp].map(|h| self.starts[h as usize]);
        let beyond = [hp, gn, gp, hn].map(|h| (self.twins[h as usize], self.fixed[h as usize]));
        for ((slot, start), (twin, fixed)) in [(hn, c), (hp, a), (gn, d), (gp, b)].into_iter().zip(beyond) {
            self.starts[slot as usize] = start;
            self.link(slot, twin);
            self.fixed[slot as usize] = fixed;
            self.leaving[start as usize] = slot;
        }
        self.starts[h as usize] = d;
        self.starts[g as usize] = c;
    }

    /// The half-edges that leave a vertex and have a triangle to their left.
    fn around(&self, a: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.leaving[a as usize];
        let (mut at, mut back) = (Some(first), false);
        std::iter::from_fn(move || {
            let here = at?;
            if back {
                at = self.twin(here).map(next);
            } else if let Some(beyond) = self.twin(previous(here)) {
                at = Some(beyond).filter(|h| *h != first);
            } else {
                // A vertex on the border: the others lie on the other side of the first.
                back = true;
                at = self.twin(first).map(next);
            }
            Some(here)
        })
    }

    /// The way from a vertex to another.
    fn toward(&self, a: u32, b: u32) -> Option<Toward> {
        let ahead = |v: u32| {
            let at = |v: u32| self.at[v as usize].as_i64vec2();
            (at(v) - at(a)).dot(at(b) - at(a)) > 0
        };
        for h in self.around(a) {
            let (u, v) = (self.end(h), self.apex(h));
            let (right, left) = (self.side(a, u, b), self.side(a, v, b));
            if right == 0 && ahead(u) {
                return Some(Toward::Along(h, u));
            }
            if left == 0 && ahead(v) {
                return Some(Toward::Along(previous(h), v));
            }
            if right > 0 && left < 0 {
                return Some(Toward::Across(next(h)));
            }
        }
        None
    }

    /// Flips the edges between `a` and `b` away, from `h` on, the first that crosses the line. Stops at a vertex on the line, and
    /// returns it.
    fn force(&mut self, a: u32, b: u32, mut h: u32) -> Result<u32, Crossing> {
        let mut crossed: std::collections::VecDeque<[u32; 2]> = std::collections::VecDeque::new();
        let end = loop {
            let twin = self.twins[h as usize];
            if self.fixed[h as usize] {
                return Err(Crossing);
            }
            crossed.push_back([self.starts[h as usize], self.end(h)]);
            let beyond = self.apex(twin);
            match self.side(a, b, beyond) {
                0 => break beyond,
                side if side > 0 => h = next(twin),
                _ => h = previous(twin),
            }
        };
        // Some edges wait until others are flipped. No case is known in which that takes longer than this.
        let mut left = 8 * crossed.len() * crossed.len() + 8;
        while let Some([u, v]) = crossed.pop_front() {
            left -= 1;
            let h = self.find(u, v).filter(|_| left > 0).ok_or(Crossing)?;
            let (c, d) = (self.apex(h), self.apex(self.twins[h as usize]));
            if self.side(d, c, u) <= 0 || self.side(d, c, v) >= 0 {
                crossed.push_back([u, v]);
                continue;
            }
            self.flip(h);
            let sides = (self.side(a, end, c), self.side(a, end, d));
            if sides.0.signum() * sides.1.signum() < 0 {
                crossed.push_back([d, c]);
            }
        }
        let h = self.find(a, end).ok_or(Crossing)?;
        self.set_fixed(h);
        Ok(end)
    }
}

/// The way from a vertex to another.
enum Toward {
    /// Along an edge, up to the vertex at its other end.
    Along(u32, u32),
    /// Across the edge opposite of the vertex.
    Across(u32),
}

/// The place of a point along a curve that fills the square (Morton 1966).
fn place(at: IVec2) -> u32 {
    let spread = |x: i32| {
        let mut x = (x as u32) >> CELL;
        x = (x | (x << 8)) & 0x00ff_00ff;
        x = (x | (x << 4)) & 0x0f0f_0f0f;
        x = (x | (x << 2)) & 0x3333_3333;
        (x | (x << 1)) & 0x5555_5555
    };
    spread(at.x) | (spread(at.y) << 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;
    use std::collections::BTreeSet;

    /// The corners of a square, and random points in it and on its border, many of them on common lines and circles.
    fn points(seed: u64, edge: i32) -> Vec<IVec2> {
        let mut rng = Seed(seed).stream("triangulation", &[]);
        let mut out = vec![IVec2::ZERO, IVec2::new(edge, 0), IVec2::splat(edge), IVec2::new(0, edge)];
        let step = 1 + rng.index(3) as i32 * edge / 16;
        let mut known: BTreeSet<(i32, i32)> = out.iter().map(|p| (p.x, p.y)).collect();
        for _ in 0..4 + rng.index(200) {
            let at = IVec2::from([0, 1].map(|_| rng.index((edge / step) as usize + 1) as i32 * step));
            if known.insert((at.x, at.y)) {
                out.push(at);
            }
        }
        out
    }

    /// Checks that triangles run counter-clockwise, fill the square, and know each other.
    fn check(mesh: &Triangulation<'_>, edge: i32) {
        let mut area = 0;
        for h in (0..mesh.half_edges()).step_by(3) {
            let [a, b, c] = mesh.corners(h).map(|v| mesh.at[v as usize]);
            assert!(turn(a, b, c) > 0, "{a} {b} {c}");
            area += turn(a, b, c);
        }
        assert_eq!(area, 2 * i64::from(edge) * i64::from(edge));
        for h in 0..mesh.half_edges() {
            let ends = [mesh.starts[h as usize], mesh.end(h)];
            match mesh.twin(h) {
                Some(twin) => {
                    assert_eq!(mesh.twin(twin), Some(h));
                    assert_eq!([mesh.end(twin), mesh.starts[twin as usize]], ends);
                    assert_eq!(mesh.fixed[h as usize], mesh.fixed[twin as usize]);
                }
                None => {
                    let [a, b] = ends.map(|v| mesh.at[v as usize]);
                    assert!((0..2).any(|k| a[k] == b[k] && (a[k] == 0 || a[k] == edge)), "{a} {b}");
                }
            }
            assert_eq!(mesh.find(ends[0], ends[1]), Some(h));
        }
    }

    /// Whether no edge that may be flipped has a corner beyond it within the circle around its triangle.
    fn is_delaunay(mesh: &Triangulation<'_>) -> bool {
        let inner = |h: &u32| mesh.twin(*h).is_some() && !mesh.fixed[*h as usize];
        (0..mesh.half_edges()).filter(inner).all(|h| !mesh.is_flat(h))
    }

    #[test]
    fn random_points_are_triangulated_as_delaunay_says() {
        for seed in 0..300 {
            let edge = [64, 4096, 1 << 19][seed as usize % 3];
            let at = points(seed, edge);
            let mesh = Triangulation::new(&at);
            check(&mesh, edge);
            assert!(is_delaunay(&mesh), "{seed}");
        }
    }

    #[test]
    fn edges_are_forced_unless_they_cross_forced_ones() {
        let (mut forced, mut refused) = (0, 0);
        for seed in 0..300 {
            let edge = [64, 4096, 1 << 19][seed as usize % 3];
            let at = points(1000 + seed, edge);
            let mut rng = Seed(seed).stream("edges", &[]);
            let mut mesh = Triangulation::new(&at);
            let (mut kept, mut tried): (Vec<[u32; 2]>, Vec<[u32; 2]>) = (Vec::new(), Vec::new());
            for _ in 0..30 {
                let [a, b] = [0, 1].map(|_| rng.index(at.len()) as u32);
                let [p, q] = [a, b].map(|v| at[v as usize]);
                let crosses = |others: &[[u32; 2]]| {
                    others.iter().map(|ends| ends.map(|v| at[v as usize])).any(|[c, d]| {
                        turn(p, q, c).signum() * turn(p, q, d).signum() < 0
                            && turn(c, d, p).signum() * turn(c, d, q).signum() < 0
                            // Lines that cross at a vertex share it.
                            && !at.iter().any(|v| turn(p, q, *v) == 0 && turn(c, d, *v) == 0)
                    })
                };
                match mesh.fix(a, b) {
                    Ok(()) => {
                        assert!(!crosses(&kept), "{seed}");
                        kept.push([a, b]);
                        forced += 1;
                    }
                    Err(Crossing) => {
                        assert!(crosses(&tried), "{seed}: {p} {q}");
                        refused += 1;
                    }
                }
                tried.push([a, b]);
            }
            mesh.improve(&vec![true; mesh.half_edges() as usize / 3]);
            check(&mesh, edge);
            assert!(is_delaunay(&mesh), "{seed}");
            // A forced line is there, from vertex to vertex.
            for [a, b] in kept {
                let mut here = a;
                while here != b {
                    let Some(Toward::Along(h, end)) = mesh.toward(here, b) else { panic!("{seed}: a line is broken") };
                    assert!(mesh.fixed[h as usize], "{seed}");
                    here = end;
                }
            }
        }
        assert!(forced > 1000 && refused > 500, "{forced} {refused}");
    }
}
