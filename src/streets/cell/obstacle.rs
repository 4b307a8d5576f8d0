//! The obstacles around a place, and what is met first among them.

use crate::network::{EdgeIx, VertexIx};
use crate::space::{closest_on_segment, segment_crossing};
use glam::{DVec2, Vec4};

/// Least cross product, in square metres, of what is surely beside a line; rounding errors are far smaller.
const BESIDE: f64 = 1e-6;

/// Stands for "no edge" and "no vertex" in a [`Obstacle`].
pub const NONE: u32 = u32::MAX;

/// The box of a segment, or a little more, so that one instruction or two tell whether it overlaps another: the south-west
/// corner and the north-east one with its signs changed, in single precision, from the canvas's origin.
#[derive(Clone, Copy, Debug)]
pub struct Hull(Vec4);

impl Hull {
    /// The box of the segment `a`-`b`.
    pub fn new(a: DVec2, b: DVec2, origin: DVec2) -> Self {
        let (low, high) = (a.min(b) - origin - HULL_MARGIN, a.max(b) - origin + HULL_MARGIN);
        Self(Vec4::new(low.x as f32, low.y as f32, -high.x as f32, -high.y as f32))
    }

    /// False only where the boxes are surely apart.
    pub fn overlaps(self, reach: Window) -> bool {
        self.0.cmple(reach.0).all()
    }
}

/// A box to hold against [`Hull`]s: its north-east corner, and the south-west one with its signs changed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Window(Vec4);

impl Window {
    /// The box from `low` to `high`, for hulls from the same origin.
    pub fn new(low: DVec2, high: DVec2, origin: DVec2) -> Self {
        let (low, high) = ((low - origin).as_vec2(), (high - origin).as_vec2());
        Self(Vec4::new(high.x, high.y, -low.x, -low.y))
    }
}

/// How much a hull is larger than the box, in metres; far more than single precision loses within a cell.
const HULL_MARGIN: f64 = 0.02;

/// An obstacle: a street segment or a wall.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle {
    /// First end.
    pub a: DVec2,
    /// Second end.
    pub b: DVec2,
    /// Its box.
    pub hull: Hull,
    /// Edge of the graph, [`NONE`] for a wall.
    pub edge: EdgeIx,
    /// Vertex at `a`, [`NONE`] for a wall.
    pub va: VertexIx,
    /// Vertex at `b`, [`NONE`] for a wall.
    pub vb: VertexIx,
    /// Least distance from a wall that nothing may fall below; 0 for streets.
    pub floor: f64,
}

impl Obstacle {
    /// Whether this is a border edge.
    pub fn is_wall(&self) -> bool {
        self.edge == NONE
    }

    /// Whether it surely lies to one side of the line through `from` along `step`, by so much that no rounding matters.
    pub fn is_beside(&self, from: DVec2, step: DVec2) -> bool {
        let (a, b) = (step.perp_dot(self.a - from), step.perp_dot(self.b - from));
        a.min(b) > BESIDE || a.max(b) < -BESIDE
    }

    /// Whether `v` is one of its ends.
    pub fn ends_at(&self, v: VertexIx) -> bool {
        self.va == v || self.vb == v
    }
}

/// The obstacles around a place, copied together so that many proposals can be held against them.
#[derive(Default)]
pub struct Neighbourhood {
    /// The obstacles.
    pub obstacles: Vec<Obstacle>,
    /// The dead ends among their ends.
    pub loose_ends: Vec<LooseEnd>,
    /// Where they were looked for.
    pub within: Window,
    /// Origin of the hulls.
    pub origin: DVec2,
}

/// A dead end.
#[derive(Clone, Copy, Debug)]
pub struct LooseEnd {
    /// The vertex.
    pub v: VertexIx,
    /// Where it lies.
    pub at: DVec2,
    /// Unit direction in which its street would go on.
    pub onward: DVec2,
    /// Whether the network may go on here.
    pub open: bool,
}

impl Neighbourhood {
    /// The box from `low` to `high`, to hold against the hulls of the obstacles.
    pub fn reach(&self, low: DVec2, high: DVec2) -> Window {
        Window::new(low, high, self.origin)
    }

    /// First of these obstacles that the segment `from`-`to` meets, as [`Canvas::ray`].
    pub fn ray(&self, from: DVec2, to: DVec2, leaving: VertexIx) -> Option<(Obstacle, f64, DVec2)> {
        let mut ray = Ray::new(from, to, leaving, self.origin);
        for (number, s) in self.obstacles.iter().enumerate() {
            if s.hull.overlaps(ray.reach) {
                ray.try_on(number as u32, s);
            }
        }
        ray.met()
    }
}

/// A segment and what it meets first, so far.
pub struct Ray {
    from: DVec2,
    to: DVec2,
    leaving: VertexIx,
    origin: DVec2,
    /// What lies beyond is not met first.
    pub reach: Window,
    best: Option<(u32, Obstacle, f64, DVec2)>,
}

impl Ray {
    /// From `from` to `to`, leaving the vertex `leaving`.
    pub fn new(from: DVec2, to: DVec2, leaving: VertexIx, origin: DVec2) -> Self {
        let reach = Window::new(from.min(to), from.max(to), origin);
        Self { from, to, leaving, origin, reach, best: None }
    }

    /// Takes an obstacle into account; where that is met, if it is the first so far. Of two that are met at once the lower number counts.
    pub fn try_on(&mut self, number: u32, s: &Obstacle) -> Option<DVec2> {
        let (from, to) = (self.from, self.to);
        if s.is_beside(from, to - from) {
            return None;
        }
        // At a port, the main street is left as well.
        if self.leaving != NONE
            && (s.ends_at(self.leaving) || (s.is_wall() && nearest(from, s.a, s.b).distance_squared(from) < 1e-4))
        {
            return None;
        }
        let x = segment_crossing(from, to, s.a, s.b)?;
        let first = self.best.is_none_or(|b| x.t < b.2 || (x.t == b.2 && number < b.0));
        if first {
            self.best = Some((number, *s, x.t, x.at));
            // More than rounding is left.
            self.reach = Window::new(from.min(x.at), from.max(x.at), self.origin);
        }
        first.then_some(x.at)
    }

    /// What is met first: the obstacle, and parameter and position on the segment.
    pub fn met(self) -> Option<(Obstacle, f64, DVec2)> {
        self.best.map(|(_, s, t, at)| (s, t, at))
    }
}

/// Nearest point of segment `a`-`b` to `p`.
pub fn nearest(p: DVec2, a: DVec2, b: DVec2) -> DVec2 {
    closest_on_segment(p, a, b).1
}

/// Where two segments may come nearest to each other if they do not cross: each end and the point of the other nearest to it,
/// as points of the first and of the second.
pub fn nearest_pairs((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> [(DVec2, DVec2); 4] {
    [(a, nearest(a, c, d)), (b, nearest(b, c, d)), (nearest(c, a, b), c), (nearest(d, a, b), d)]
}
