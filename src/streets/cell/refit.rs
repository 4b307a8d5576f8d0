//! Refit: whether straight streets may replace existing ones. A new street keeps to the rules of the repair; near a junction,
//! where streets are nearer to each other than that, it comes no nearer than the street that it replaces.

use super::canvas::Canvas;
use super::checker::DEAD_END_FLOOR;
use super::obstacle::{Neighbourhood, Obstacle, nearest_pairs};
use super::rules::{Limits, WEDGE};
use crate::network::{EdgeIx, STREET_FLOOR, VertexIx};
use crate::seam::{APPROACH_LENGTH, CellPort};
use crate::space::{Bounds, distance_to_segment, segment_distance};
use glam::DVec2;

/// Least cosine of the angle between the street of a port and the inward direction of the port.
const PORT: f64 = 0.93;

/// Least ratio of the new distance from the border to the old one, where the old one is short.
const ROOM_LEFT: f64 = 0.8;

/// Least ratio of the new way around a block to the old one, where the new way is short.
const WAY_LEFT: f64 = 0.8;

/// A straight street, or a part of one, that may replace existing edges.
#[derive(Clone, Copy)]
pub struct Line {
    /// The first vertex, which may not have moved to `a` yet.
    pub from: VertexIx,
    /// The last vertex.
    pub to: VertexIx,
    /// Position of the first end.
    pub a: DVec2,
    /// Position of the last end.
    pub b: DVec2,
    /// The range of edges that it replaces, in the list of edges that go.
    pub was: (usize, usize),
}

impl Line {
    fn of(s: &Obstacle) -> Self {
        Self { from: s.va, to: s.vb, a: s.a, b: s.b, was: (0, 0) }
    }

    fn ends_at(&self, v: VertexIx) -> bool {
        self.from == v || self.to == v
    }

    fn distance(&self, other: &Self) -> f64 {
        segment_distance(self.a, self.b, other.a, other.b)
    }

    fn pairs(&self, other: &Self) -> [(DVec2, DVec2); 4] {
        nearest_pairs((self.a, self.b), (other.a, other.b))
    }

    /// Its length in metres.
    pub fn length(&self) -> f64 {
        self.a.distance(self.b)
    }

    /// Direction in which it leaves the end `v`.
    pub fn way_from(&self, v: VertexIx) -> DVec2 {
        let way = (self.b - self.a).normalize_or_zero();
        if self.from == v { way } else { -way }
    }

    /// Both ends: the vertex, its position, and the position of the other end.
    fn ends(&self) -> [(VertexIx, DVec2, DVec2); 2] {
        [(self.from, self.a, self.b), (self.to, self.b, self.a)]
    }
}

/// Tells whether straight streets may replace existing ones.
pub struct Refit<'d> {
    /// The streets of the cell.
    pub canvas: &'d mut Canvas,
    /// Buffer for the obstacles near the new streets.
    pub near: &'d mut Neighbourhood,
    /// The ports of the cell.
    pub ports: &'d [CellPort],
    /// What new streets keep to.
    pub limits: Limits,
}

impl Refit<'_> {
    /// Whether blocks stay large enough when a way along streets changes from `before` metres to `now`. The ends of the way
    /// are `apart` metres from each other.
    pub fn keeps_way(&self, now: f64, before: f64, apart: f64) -> bool {
        now + apart >= self.limits.min_round || now >= WAY_LEFT * before
    }

    /// Whether `lines` may replace the edges `gone`.
    pub fn lines_fit(&mut self, lines: &[Line], gone: &[EdgeIx]) -> bool {
        let g = &self.canvas.graph;
        let ends_fit = lines.iter().all(|line| {
            line.ends().into_iter().all(|(v, at, other)| {
                let way = (other - at).normalize_or_zero();
                let others = || g.edges_at(v).iter().filter(|e| !gone.contains(e));
                let bends = others().count() == 1;
                let most = if bends { self.limits.bend_cosine } else { self.limits.junction_cosine };
                self.leaves_port(v, way)
                    && others().all(|e| way.dot((g.at(g.edge(*e).other(v)) - g.at(v)).normalize_or_zero()) <= most)
            })
        });
        if !ends_fit {
            return false;
        }
        let (gap, wall_gap) = (self.limits.gap, self.limits.wall_gap);
        // The border is long and asks for more room than streets do.
        let keep_off = lines.iter().all(|line| {
            let bounds = Bounds::of([line.a, line.b]).grown(wall_gap.max(gap));
            let mut walls = self.canvas.overlapping_walls(bounds);
            walls.all(|wall| self.keeps_off(line, wall, gone))
        });
        if !keep_off {
            return false;
        }
        let mut near = std::mem::take(self.near);
        self.canvas.gather_obstacles(Bounds::of(lines.iter().flat_map(|l| [l.a, l.b])).grown(gap), &mut near);
        near.obstacles.retain(|s| !s.is_wall() && !gone.contains(&s.edge));
        let fits = lines.iter().all(|line| {
            let reach = near.reach(line.a.min(line.b) - gap, line.a.max(line.b) + gap);
            near.obstacles.iter().filter(|s| s.hull.overlaps(reach)).all(|s| {
                let other = Line::of(s);
                self.keep_apart(line, &other) && self.is_beside(line, lines, gone, &other)
            })
        });
        *self.near = near;
        fits
    }

    /// Whether a street from `v` in the direction `way` leaves the main street nearly square; true if `v` is no port.
    fn leaves_port(&self, v: VertexIx, way: DVec2) -> bool {
        self.canvas.nodes[v as usize].port.is_none_or(|port| way.dot(self.ports[port].inward) >= PORT)
    }

    /// Whether two lines that meet keep their dead ends away from each other.
    pub fn keep_apart(&self, x: &Line, y: &Line) -> bool {
        let loose_ends = |x: &Line, y: &Line| {
            x.ends().into_iter().all(|(v, at, _)| {
                y.ends_at(v) || !self.canvas.is_dead_end(v) || distance_to_segment(at, y.a, y.b) >= DEAD_END_FLOOR
            })
        };
        !(x.ends_at(y.from) || x.ends_at(y.to)) || (loose_ends(x, y) && loose_ends(y, x))
    }

    /// Whether one of `lines` keeps its distance from a street, or comes no nearer to it than the edges that it replaces.
    fn is_beside(&self, line: &Line, lines: &[Line], gone: &[EdgeIx], other: &Line) -> bool {
        if line.ends_at(other.from) || line.ends_at(other.to) {
            return true;
        }
        let now = line.distance(other);
        now >= self.limits.gap
            || now >= self.before(line, gone, other)
            || now > 0.0 && self.is_near_along(line, lines, gone, other)
    }

    /// Whether a line and a street may be near to each other because a street between their ends makes them near along the
    /// network.
    fn is_near_along(&self, line: &Line, lines: &[Line], gone: &[EdgeIx], other: &Line) -> bool {
        let g = &self.canvas.graph;
        let pairs = line.pairs(other);
        let may_be = |at: DVec2, w: VertexIx| {
            // A street that meets the line may come nearer to it than others.
            let floor = if self.canvas.is_end(w) { STREET_FLOOR } else { 0.0 };
            let end = g.at(w);
            pairs.iter().all(|(q, r)| {
                let way = q.distance(at) + at.distance(end) + end.distance(*r);
                q.distance(*r) >= self.limits.gap.min(WEDGE * way).max(floor)
            })
        };
        line.ends().into_iter().any(|(v, at, _)| {
            let here = lines.iter().filter(|l| l.from == v).map(|l| l.to);
            let stay = g.edges_at(v).iter().filter(|e| !gone.contains(e)).map(|e| g.edge(*e).other(v));
            here.chain(stay).any(|w| other.ends_at(w) && may_be(at, w))
        })
    }

    /// Distance in metres between the edges that a line replaces and another line.
    fn before(&self, line: &Line, gone: &[EdgeIx], other: &Line) -> f64 {
        let was = gone[line.was.0..line.was.1].iter().map(|e| self.canvas.graph.segment(*e));
        was.map(|(a, b)| segment_distance(a, b, other.a, other.b)).fold(f64::INFINITY, f64::min)
    }

    /// Whether a line keeps its distance from a wall, or comes hardly nearer than the edges that it replaces.
    fn keeps_off(&self, line: &Line, wall: &Obstacle, gone: &[EdgeIx]) -> bool {
        let wall_gap = self.limits.wall_gap;
        let wall_line = Line::of(wall);
        let port = line.ends().into_iter().find(|(v, ..)| self.canvas.nodes[*v as usize].port.is_some());
        if let Some((_, at, far)) = port {
            let from_wall = |p: DVec2| distance_to_segment(p, wall.a, wall.b);
            if from_wall(at) < 0.01 {
                return line.length() <= APPROACH_LENGTH || from_wall(far) >= wall.floor;
            }
            // The wall is near along the main street.
            let may_be = line.pairs(&wall_line).into_iter().all(|(q, r)| {
                let floor = if q.distance(at) < APPROACH_LENGTH { 0.0 } else { wall.floor };
                q.distance(r) >= wall_gap.min(WEDGE * (q.distance(at) + at.distance(r))).max(floor)
            });
            if may_be {
                return line.distance(&wall_line) > 0.0;
            }
        }
        let (now, before) = (line.distance(&wall_line), self.before(line, gone, &wall_line));
        now >= before || now >= wall_gap.min(ROOM_LEFT * before).max(wall.floor).max(self.limits.gap)
    }
}
