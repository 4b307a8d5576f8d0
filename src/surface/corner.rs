//! Corners of a junction: where the land between two neighbouring arms ends.

use crate::space::{cross, segment_crossing};
use crate::surface::head::Head;
use crate::surface::offset::{end_normals, mitre, sector_corners};
use glam::DVec2;

/// Least width of a pavement around a rounded corner, as a share of its width along the streets.
const CORNER_PAVEMENT: f64 = 0.7;

/// Greatest distance from the corner of two kerbs at which their rounding begins, in metres.
const LONGEST_TANGENT: f64 = 14.0;

/// The edge of the land between two neighbouring arms of a junction: two lines that run counter-clockwise around the
/// junction, from the end of the first arm's own surface to the end of the second arm's. Local metres.
pub struct Corner {
    /// The edge of the carriageway, rounded.
    pub kerb: Vec<DVec2>,
    /// The outer edge of the pavement or verge.
    pub side: Vec<DVec2>,
    /// Whether one of the two streets has a pavement.
    pub paved: bool,
}

/// The edges of one width of an arm.
pub(super) struct Edges {
    /// Left and right edge going outwards, with one point for each point of the arm's line.
    pub sides: [Vec<DVec2>; 2],
    /// Distance of the edges from the arm's line, in metres.
    pub half: f64,
    /// Number of points of an edge among which its end is looked for first.
    pub near: usize,
    /// The arm's line outwards.
    pub line: Vec<DVec2>,
    /// For each point of the line, its distance from the junction along the line, in metres.
    pub along: Vec<f64>,
}

/// Where the edges of two neighbouring arms end at the junction: the first arm's left edge and the second arm's right edge.
pub(super) struct Meeting {
    /// The points between the two edges.
    pub path: Vec<DVec2>,
    /// For each arm, the index of the first point of its edge beyond the path.
    pub first: [usize; 2],
    /// For each arm, the distance from the junction at which its edge begins to run undisturbed, in metres.
    pub reach: [f64; 2],
}

impl Meeting {
    /// Around the head of a dead end, relative to the junction.
    pub fn around(head: &Head, edges: &Edges) -> Self {
        let reach = head.reach(edges.half);
        let first = edges.along.partition_point(|along| *along <= reach);
        Self { path: head.around(edges.half).collect(), first: [first; 2], reach: [reach; 2] }
    }
}

/// Where the left edge of an arm in unit direction `da` and the right edge of the next arm counter-clockwise, in direction
/// `db`, end around `at`. `alone` says that both are the same arm. The corner is rounded with a radius of `radius` metres.
pub(super) fn meet(at: DVec2, edges: [&Edges; 2], directions: [DVec2; 2], alone: bool, radius: f64) -> Meeting {
    let whole = edges[0].sides[0].len().max(edges[1].sides[1].len());
    let near = edges[0].near.max(edges[1].near);
    meet_within(at, edges, directions, alone, radius, near)
        .or_else(|| meet_within(at, edges, directions, alone, radius, whole))
        .unwrap_or_else(|| {
            // The angle is so sharp that the streets do not part.
            let [a, b] = edges;
            let first = [a.sides[0].len(), b.sides[1].len()];
            let [p, q] = [a.sides[0][first[0] - 1], b.sides[1][first[1] - 1]];
            Meeting { path: vec![(p + q) / 2.0], first, reach: [f64::INFINITY; 2] }
        })
}

/// The same among the first `limit` points of the edges; `None` if they do not part there.
fn meet_within(
    at: DVec2,
    [a, b]: [&Edges; 2],
    [da, db]: [DVec2; 2],
    alone: bool,
    radius: f64,
    limit: usize,
) -> Option<Meeting> {
    let (from, to) = (da.perp(), -db.perp());
    let open = alone || cross(da, db) < 0.0;
    let direct = |path: Vec<DVec2>| Meeting { path, first: [0; 2], reach: [0.0; 2] };
    let widest = a.half.max(b.half);
    let around = || direct(sector_corners(from, to, widest).map(|corner| at + corner).collect());
    if open && a.half == b.half {
        return Some(around());
    }
    let [mut left, mut right] = [Outline::new(at, a, da, 0, limit), Outline::new(at, b, db, 1, limit)];
    if open && a.half > b.half {
        left.extend(at, a, [da, to], 0, sector_corners(from, to, widest).rev());
    } else if open {
        right.extend(at, b, [db, from], 1, sector_corners(from, to, widest));
    }
    // Outside a bend the narrower arm comes out from under the wider one.
    let crossing = if open && b.half < a.half {
        outermost_crossing(&right.points, &left.points).map(Crossing::swapped)
    } else {
        outermost_crossing(&left.points, &right.points)
    };
    let Some(hit) = crossing else {
        if open {
            return Some(around());
        }
        return (da.dot(db) < -0.5).then(|| direct(Vec::new()));
    };
    let tangent = match radius {
        r if r > 0.0 && !open => {
            let (d, e) = (left.direction(hit.segments[0]), right.direction(hit.segments[1]));
            // The cotangent of half the angle between the edges.
            (r * (1.0 + d.dot(e)) / cross(d, e).abs().max(1e-3)).min(LONGEST_TANGENT)
        }
        _ => 0.0,
    };
    let by = tangent.min(left.left_beyond(hit.segments[0], hit.t[0])).min(right.left_beyond(hit.segments[1], hit.t[1]));
    let pa = left.beyond(hit.segments[0], hit.t[0], by, a);
    let pb = right.beyond(hit.segments[1], hit.t[1], by, b);
    let mut path = left.end_beyond(pa.segment).to_vec();
    path.reverse();
    if by > 0.3 {
        let curve = |t: f64| pa.at.lerp(hit.at, t).lerp(hit.at.lerp(pb.at, t), t);
        let parts = if by < 5.0 { 4 } else { 6 };
        path.extend((0..=parts).map(|k| curve(f64::from(k) / f64::from(parts))));
    } else {
        path.push(hit.at);
    }
    path.extend(right.end_beyond(pb.segment));
    let first = [left.first_beyond(pa.segment), right.first_beyond(pb.segment)];
    Some(Meeting { path, first, reach: [pa.reach, pb.reach] })
}

/// The greatest radius of the kerb around a corner that leaves enough of a pavement `width` metres wide. The streets leave the
/// corner in the unit directions `d` and `e`.
pub(super) fn widest_radius(width: f64, d: DVec2, e: DVec2) -> f64 {
    // The sine of half the angle at the corner.
    let sine = ((1.0 - d.dot(e)) / 2.0).max(1e-6).sqrt();
    width * (1.0 / sine - CORNER_PAVEMENT) / (1.0 / sine - 1.0).max(1e-3)
}

/// A place on an outline.
struct Place {
    at: DVec2,
    segment: usize,
    /// Distance from the junction along the arm's line, in metres; 0 on the end of the arm.
    reach: f64,
}

/// The outline of one side of an arm, outwards: around the end of the arm behind the junction, then along its edge.
struct Outline {
    points: Vec<DVec2>,
    /// Number of points around the end, before the first point of the edge.
    end: usize,
}

impl Outline {
    /// The outline of the left (0) or right (1) side of an arm that leaves the junction at `at` in unit direction `d`, up to point
    /// `limit` of the edge.
    fn new(at: DVec2, edges: &Edges, d: DVec2, side: usize, limit: usize) -> Self {
        let normals = end_normals(d);
        let [edge, slant, behind] = if side == 0 { [0, 1, 2] } else { [4, 3, 2] }.map(|i| normals[i]);
        let mut points = Vec::with_capacity(8 + edges.sides[side].len());
        points.push(at + behind * edges.half);
        points.push(at + mitre(behind, slant, edges.half));
        points.push(at + mitre(slant, edge, edges.half));
        points.extend(edges.sides[side].iter().take(limit.max(2)));
        Self { points, end: 3 }
    }

    /// Takes the outline from the arm's other edge around the whole end and over `corners` outside the junction, which begin
    /// at the unit normal `from`. The arm leaves the junction at `at` in unit direction `d`.
    fn extend(
        &mut self,
        at: DVec2,
        edges: &Edges,
        [d, from]: [DVec2; 2],
        side: usize,
        corners: impl Iterator<Item = DVec2>,
    ) {
        let half = edges.half;
        let normals = end_normals(d);
        let [other, slant, behind] = if side == 0 { [4, 3, 2] } else { [0, 1, 2] }.map(|i| normals[i]);
        let mut before: Vec<DVec2> = edges.sides[1 - side].iter().rev().copied().collect();
        before.extend([at + mitre(other, slant, half), at + mitre(slant, behind, half)]);
        self.end += before.len();
        self.points.splice(..0, before);
        let mut outside = vec![at + from * half];
        outside.extend(corners.map(|corner| at + corner));
        outside.push(self.points[self.end]);
        // The corners begin inside the arm's end. The outline follows them from where they leave the end.
        for k in 0..outside.len() - 1 {
            for i in 0..self.end {
                let [a, b] = [self.points[i], self.points[i + 1]];
                if let Some(c) = segment_crossing(outside[k], outside[k + 1], a, b) {
                    let corners = std::iter::once(c.at).chain(outside[k + 1..outside.len() - 1].iter().copied());
                    self.points.splice(i + 1..self.end, corners);
                    self.end = i + outside.len() - k;
                    return;
                }
            }
        }
    }

    /// Unit direction of a segment, outwards.
    fn direction(&self, segment: usize) -> DVec2 {
        (self.points[segment + 1] - self.points[segment]).normalize_or_zero()
    }

    /// Length of the outline outwards of `t` (0..=1) on a segment, less a little, in metres.
    fn left_beyond(&self, segment: usize, t: f64) -> f64 {
        let rest: f64 = self.points[segment + 1..].windows(2).map(|w| w[0].distance(w[1])).sum();
        (rest + self.points[segment].distance(self.points[segment + 1]) * (1.0 - t) - 0.1).max(0.0)
    }

    /// The place `by` metres outwards from `t` (0..=1) on a segment. The outline goes on at least as far.
    fn beyond(&self, mut segment: usize, mut t: f64, mut by: f64, edges: &Edges) -> Place {
        loop {
            let (a, b) = (self.points[segment], self.points[segment + 1]);
            let length = a.distance(b).max(1e-6);
            if by <= length * (1.0 - t) || segment + 2 == self.points.len() {
                t = (t + by / length).min(1.0);
                let at = a.lerp(b, t);
                let reach = match segment.checked_sub(self.end) {
                    Some(k) => {
                        let direction = (edges.line[k + 1] - edges.line[k]).normalize_or_zero();
                        edges.along[k] + (at - edges.line[k]).dot(direction)
                    }
                    None => 0.0,
                };
                return Place { at, segment, reach };
            }
            by -= length * (1.0 - t);
            (segment, t) = (segment + 1, 0.0);
        }
    }

    /// The points around the end that lie outwards of a segment.
    fn end_beyond(&self, segment: usize) -> &[DVec2] {
        &self.points[(segment + 1).min(self.end)..self.end]
    }

    /// Index of the first point of the edge outwards of a segment.
    fn first_beyond(&self, segment: usize) -> usize {
        (segment + 1).saturating_sub(self.end)
    }
}

/// Where two outlines cross.
struct Crossing {
    at: DVec2,
    segments: [usize; 2],
    /// Parameters along the segments, 0..=1.
    t: [f64; 2],
}

impl Crossing {
    fn swapped(self) -> Self {
        let ([i, j], [t, u]) = (self.segments, self.t);
        Self { at: self.at, segments: [j, i], t: [u, t] }
    }
}

/// The crossing of two outlines that is outermost on the first.
fn outermost_crossing(first: &[DVec2], second: &[DVec2]) -> Option<Crossing> {
    for i in (0..first.len() - 1).rev() {
        for j in (0..second.len() - 1).rev() {
            if let Some(c) = segment_crossing(first[i], first[i + 1], second[j], second[j + 1]) {
                return Some(Crossing { at: c.at, segments: [i, j], t: [c.t, c.u] });
            }
        }
    }
    None
}
