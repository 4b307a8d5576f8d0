//! Obstacles: the street segments and border edges around a place, and which of them a ray meets first.

use crate::network::{EdgeIx, VertexIx};
use crate::space::{closest_on_segment, segment_crossing};
use glam::{DVec2, Vec4};

/// Least cross product, in square metres, that tells a point surely beside a line; rounding errors are far smaller.
const BESIDE: f64 = 1e-6;

/// Stands for "no edge" and "no vertex" in a [`Obstacle`].
pub const NONE: u32 = u32::MAX;

/// The bounding box of a segment, slightly enlarged, in single precision and from the canvas's origin. It holds the
/// south-west corner and the negated north-east corner, so that one comparison of vectors tests for overlap.
#[derive(Clone, Copy, Debug)]
pub struct Hull(Vec4);

impl Hull {
    /// The hull of the segment `a`-`b`.
    pub fn new(a: DVec2, b: DVec2, origin: DVec2) -> Self {
        let (low, high) = (a.min(b) - origin - HULL_MARGIN, a.max(b) - origin + HULL_MARGIN);
        Self(Vec4::new(low.x as f32, low.y as f32, -high.x as f32, -high.y as f32))
    }

    /// False only if the segment surely lies outside the window.
    pub fn overlaps(self, reach: Window) -> bool {
        self.0.cmple(reach.0).all()
    }
}

/// A box to test [`Hull`]s against: the north-east corner and the negated south-west corner.
#[derive(Clone, Copy, Debug, Default)]
pub struct Window(Vec4);

impl Window {
    /// The box from `low` to `high`, for hulls from the same origin.
    pub fn new(low: DVec2, high: DVec2, origin: DVec2) -> Self {
        let (low, high) = ((low - origin).as_vec2(), (high - origin).as_vec2());
        Self(Vec4::new(high.x, high.y, -low.x, -low.y))
    }
}

/// Margin of a hull around its segment, in metres; far more than single precision loses within a cell.
const HULL_MARGIN: f64 = 0.02;

/// An obstacle: a segment of a street, or a wall, which is an edge of the cell's border.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle {
    /// First end.
    pub a: DVec2,
    /// Second end.
    pub b: DVec2,
    /// Its bounding box.
    pub hull: Hull,
    /// Edge of the graph, [`NONE`] for a wall.
    pub edge: EdgeIx,
    /// Vertex at `a`, [`NONE`] for a wall.
    pub va: VertexIx,
    /// Vertex at `b`, [`NONE`] for a wall.
    pub vb: VertexIx,
    /// Least distance in metres that every street keeps from a wall; 0 for streets.
    pub floor: f64,
}

impl Obstacle {
    /// Whether this is a border edge.
    pub fn is_wall(&self) -> bool {
        self.edge == NONE
    }

    /// Whether the obstacle lies to one side of the line through `from` along `step`, farther than any rounding error.
    pub fn lies_beside(&self, from: DVec2, step: DVec2) -> bool {
        let (a, b) = (step.perp_dot(self.a - from), step.perp_dot(self.b - from));
        a.min(b) > BESIDE || a.max(b) < -BESIDE
    }

    /// Whether `v` is one of its ends.
    pub fn ends_at(&self, v: VertexIx) -> bool {
        self.va == v || self.vb == v
    }
}

/// The obstacles around a place, copied so that many proposals can be tested against them.
#[derive(Default)]
pub struct Neighbourhood {
    /// The obstacles.
    pub obstacles: Vec<Obstacle>,
    /// The dead ends among the ends of the obstacles.
    pub loose_ends: Vec<LooseEnd>,
    /// The window in which the obstacles were gathered.
    pub within: Window,
    /// Origin of the hulls.
    pub origin: DVec2,
}

/// A dead end.
#[derive(Clone, Copy, Debug)]
pub struct LooseEnd {
    /// The vertex.
    pub v: VertexIx,
    /// The position of the vertex.
    pub at: DVec2,
    /// Unit direction in which the street would go on.
    pub onward: DVec2,
    /// Whether the network may go on here.
    pub open: bool,
}

impl Neighbourhood {
    /// The window from `low` to `high`, to test the hulls of the obstacles against.
    pub fn reach(&self, low: DVec2, high: DVec2) -> Window {
        Window::new(low, high, self.origin)
    }

    /// The first of these obstacles that the segment `from`-`to` meets; see [`Ray`].
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

/// A segment, and the first obstacle that it meets among the obstacles tried so far.
pub struct Ray {
    from: DVec2,
    to: DVec2,
    leaving: VertexIx,
    origin: DVec2,
    /// Window of the segment up to the first obstacle; obstacles outside cannot be met first.
    pub reach: Window,
    best: Option<(u32, Obstacle, f64, DVec2)>,
}

impl Ray {
    /// The segment from `from` to `to`. What ends at the vertex `leaving` is not met; [`NONE`] leaves no vertex.
    pub fn new(from: DVec2, to: DVec2, leaving: VertexIx, origin: DVec2) -> Self {
        let reach = Window::new(from.min(to), from.max(to), origin);
        Self { from, to, leaving, origin, reach, best: None }
    }

    /// Tries an obstacle. Returns the point where the segment meets the obstacle if it is the first so far; of two obstacles
    /// met at the same point, the one with the lower number is first.
    pub fn try_on(&mut self, number: u32, s: &Obstacle) -> Option<DVec2> {
        let (from, to) = (self.from, self.to);
        if s.lies_beside(from, to - from) {
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

    /// The first obstacle met, with the parameter and the position of the meeting point on the segment.
    pub fn met(self) -> Option<(Obstacle, f64, DVec2)> {
        self.best.map(|(_, s, t, at)| (s, t, at))
    }
}

/// Nearest point of segment `a`-`b` to `p`.
pub fn nearest(p: DVec2, a: DVec2, b: DVec2) -> DVec2 {
    closest_on_segment(p, a, b).1
}

/// The pairs of points at which two segments that do not cross may be nearest to each other: each end with the nearest point
/// of the other segment, always the point of the first segment first.
pub fn nearest_pairs((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> [(DVec2, DVec2); 4] {
    [(a, nearest(a, c, d)), (b, nearest(b, c, d)), (nearest(c, a, b), c), (nearest(d, a, b), d)]
}
