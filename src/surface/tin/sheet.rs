//! The triangles of the street surface in one square, cut at its border.

use crate::space::QUANTUM;
use crate::surface::element::Element;
use crate::surface::finish::Finish;
use glam::{DVec2, DVec3, I64Vec2, IVec2};

/// Heights are rounded to multiples of this, in metres, so that squares whose local frames round differently agree.
const HEIGHT_STEP: f64 = 1.0 / 8192.0;

/// A vertex of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// Plan position in steps of [`QUANTUM`] from the square's south-west corner.
    pub at: IVec2,
    /// Height of the carriageway in metres.
    pub height: f64,
}

/// A triangle of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub corners: [u32; 3],
    pub finish: Finish,
    /// The part of an element that the triangle belongs to.
    pub part: u32,
}

/// The surface in a square.
pub(super) struct Sheet {
    pub points: Vec<Point>,
    pub triangles: Vec<Triangle>,
    /// Vertices of dropped kerbs.
    pub dropped: Vec<u32>,
    /// For each part, whether it is cut up against others because its shape is not its own alone.
    pub shared: Vec<bool>,
    index: PointIndex,
    /// Edge of the square in steps.
    pub edge: i32,
}

/// A corner of a polygon that is being cut, with the whole edge that leads from it to the next corner; `None` along the border.
type Cut = (Point, Option<[Point; 2]>);

impl Sheet {
    /// The triangles of `elements` in the square of `size` metres at the local origin.
    pub fn new(elements: &[Element], size: i64) -> Self {
        let edge = (size as f64 / QUANTUM) as i32;
        let count = elements.iter().map(|e| e.points.len()).sum();
        let mut out = Self {
            points: Vec::new(),
            triangles: Vec::new(),
            dropped: Vec::new(),
            shared: Vec::new(),
            index: PointIndex::new(count),
            edge,
        };
        for element in elements {
            out.add(element);
        }
        out
    }

    fn add(&mut self, element: &Element) {
        let point = |p: &DVec3| Point { at: (p.truncate() / QUANTUM).as_ivec2(), height: p.z };
        let points: Vec<Point> = element.points.iter().map(point).collect();
        let inside = |p: &Point| p.at.min_element() >= 0 && p.at.max_element() <= self.edge;
        let within: Vec<bool> = points.iter().map(inside).collect();
        let mut known = vec![u32::MAX; points.len()];
        let mut starts = element.parts.iter().peekable();
        let mut began = false;
        for (i, (corners, finish)) in element.triangles.iter().enumerate() {
            while starts.next_if(|start| **start <= i).is_some() {
                began = false;
            }
            let at = corners.map(|c| points[c as usize]);
            let (low, high) = (at[0].at.min(at[1].at).min(at[2].at), at[0].at.max(at[1].at).max(at[2].at));
            if high.min_element() <= 0 || low.max_element() >= self.edge {
                continue;
            }
            if !began {
                self.shared.push(false);
                began = true;
            }
            let part = self.shared.len() as u32 - 1;
            if turn(at[0].at, at[1].at, at[2].at) <= 0 {
                // A stretch that folds back on itself.
                self.shared[part as usize] = true;
                continue;
            }
            if corners.iter().all(|c| within[*c as usize]) {
                let corners = corners.map(|c| {
                    let slot = &mut known[c as usize];
                    if *slot == u32::MAX {
                        *slot = self.index.id(&mut self.points, points[c as usize]);
                    }
                    *slot
                });
                self.triangles.push(Triangle { corners, finish: *finish, part });
            } else {
                self.cut(at, *finish, part);
            }
        }
        let dropped = element.dropped.iter().map(|v| points[*v as usize].at);
        self.dropped.extend(dropped.filter_map(|at| self.index.find(&self.points, at)));
    }

    /// Adds the part of a triangle in the square.
    fn cut(&mut self, corners: [Point; 3], finish: Finish, part: u32) {
        let mut ring: Vec<Cut> = (0..3).map(|i| (corners[i], Some([corners[i], corners[(i + 1) % 3]]))).collect();
        for (axis, limit, sign) in [(0, 0, 1), (0, self.edge, -1), (1, 0, 1), (1, self.edge, -1)] {
            let depth = |p: &Point| (p.at[axis] - limit) * sign;
            let mut out: Vec<Cut> = Vec::with_capacity(ring.len() + 1);
            for i in 0..ring.len() {
                let ((a, edge), (b, _)) = (ring[i], ring[(i + 1) % ring.len()]);
                let (da, db) = (depth(&a), depth(&b));
                if da >= 0 {
                    out.push((a, edge));
                }
                if (da > 0 && db < 0) || (da < 0 && db > 0) {
                    let at = match edge {
                        Some([p, q]) => crossing(p, q, axis, limit),
                        None => corner(&corners, a, axis, limit),
                    };
                    out.push((at, if da > 0 { None } else { edge }));
                } else if da == 0 && db < 0 {
                    // The ring goes on along the border.
                    if let Some(last) = out.last_mut() {
                        last.1 = None;
                    }
                }
            }
            ring = out;
        }
        let mut ids: Vec<u32> = ring.iter().map(|(p, _)| self.index.id(&mut self.points, *p)).collect();
        ids.dedup();
        if ids.len() > 1 && ids[0] == ids[ids.len() - 1] {
            ids.pop();
        }
        for i in 1..ids.len().max(2) - 1 {
            let corners = [ids[0], ids[i], ids[i + 1]];
            let [a, b, c] = corners.map(|v| self.points[v as usize].at);
            if turn(a, b, c) > 0 {
                self.triangles.push(Triangle { corners, finish, part });
            } else if turn(a, b, c) < 0 {
                self.shared[part as usize] = true;
            }
        }
    }

    /// The vertex at a place, if there is one.
    pub fn find(&self, at: IVec2) -> Option<u32> {
        self.index.find(&self.points, at)
    }

    /// The vertex at a place, a new one if there is none.
    pub fn id(&mut self, point: Point) -> u32 {
        self.index.id(&mut self.points, point)
    }

    /// Plan position of a vertex in metres.
    pub fn plan(&self, vertex: u32) -> DVec2 {
        self.points[vertex as usize].at.as_dvec2() * QUANTUM
    }

    /// Whether both ends of an edge lie on the same side of the square.
    pub fn is_on_border(&self, [a, b]: [u32; 2]) -> bool {
        let [a, b] = [a, b].map(|v| self.points[v as usize].at);
        (0..2).any(|axis| a[axis] == b[axis] && (a[axis] == 0 || a[axis] == self.edge))
    }
}

/// Twice the signed area of a triangle: positive if it runs counter-clockwise.
pub(super) fn turn(a: IVec2, b: IVec2, c: IVec2) -> i64 {
    let (ab, ac) = ((b - a).as_i64vec2(), (c - a).as_i64vec2());
    I64Vec2::perp_dot(ab, ac)
}

/// Where the edge between two points crosses a line of the grid. The order of the points does not matter.
fn crossing(p: Point, q: Point, axis: usize, limit: i32) -> Point {
    let (p, q) = if (p.at.x, p.at.y) < (q.at.x, q.at.y) { (p, q) } else { (q, p) };
    let by = (q.at - p.at).as_dvec2();
    let t = f64::from(limit - p.at[axis]) / by[axis];
    let other = 1 - axis;
    let mut at = p.at;
    at[axis] = limit;
    at[other] += (by[other] * t).round() as i32;
    Point { at, height: p.height + (q.height - p.height) * t }
}

/// The corner of the square that an edge along its border passes, with the height of the triangle's plane there.
fn corner(plane: &[Point; 3], on: Point, axis: usize, limit: i32) -> Point {
    let mut at = on.at;
    at[axis] = limit;
    Point { at, height: height_on(plane, at.as_dvec2()) }
}

/// Height of the plane through three points at a place, given in steps.
pub(super) fn height_on(plane: &[Point; 3], at: DVec2) -> f64 {
    let [a, b, c] = plane;
    let (ab, ac) = ((b.at - a.at).as_dvec2(), (c.at - a.at).as_dvec2());
    let d = at - a.at.as_dvec2();
    let area = ab.perp_dot(ac);
    a.height + ((b.height - a.height) * d.perp_dot(ac) + (c.height - a.height) * ab.perp_dot(d)) / area
}

/// Vertices by their places: an open table.
struct PointIndex {
    slots: Vec<u32>,
    count: usize,
}

impl PointIndex {
    fn new(expected: usize) -> Self {
        Self { slots: vec![u32::MAX; (expected * 2).next_power_of_two().max(64)], count: 0 }
    }

    fn slot(&self, points: &[Point], at: IVec2) -> usize {
        let key = (u64::from(at.x as u32) << 32) | u64::from(at.y as u32);
        let mask = self.slots.len() - 1;
        let mut slot = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.slots[slot] != u32::MAX && points[self.slots[slot] as usize].at != at {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn find(&self, points: &[Point], at: IVec2) -> Option<u32> {
        let id = self.slots[self.slot(points, at)];
        (id != u32::MAX).then_some(id)
    }

    fn id(&mut self, points: &mut Vec<Point>, point: Point) -> u32 {
        let slot = self.slot(points, point.at);
        if self.slots[slot] != u32::MAX {
            return self.slots[slot];
        }
        let id = points.len() as u32;
        points.push(Point { height: (point.height / HEIGHT_STEP).round() * HEIGHT_STEP, ..point });
        self.slots[slot] = id;
        self.count += 1;
        if self.count * 2 > self.slots.len() {
            let wider = Self { slots: vec![u32::MAX; self.slots.len() * 2], count: self.count };
            let old = std::mem::replace(self, wider);
            for id in old.slots.into_iter().filter(|id| *id != u32::MAX) {
                let slot = self.slot(points, points[id as usize].at);
                self.slots[slot] = id;
            }
        }
        id
    }
}
