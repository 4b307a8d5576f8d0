//! Corners of a junction: where the land between two neighbouring arms ends.

use crate::space::{cross, segment_crossing};
use crate::surface::offset::{end_normals, mitre, sector_corners};
use glam::DVec2;

/// Distance from the corner of two kerbs at which their rounding begins, in metres.
const ROUNDING: f64 = 3.0;

/// The edge of the land between two neighbouring arms of a junction: two lines that run counter-clockwise around the
/// junction, from the end of the first arm's own surface to the end of the second arm's. Local metres.
pub struct Corner {
    /// The edge of the carriageway, rounded.
    pub kerb: Vec<DVec2>,
    /// The outer edge of the pavement, or the edge of the carriageway where there is no pavement.
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

/// Where the left edge of an arm in unit direction `da` and the right edge of the next arm counter-clockwise, in direction
/// `db`, end around `at`. `alone` says that both are the same arm; a `kerb` is rounded.
pub(super) fn meet(at: DVec2, [a, b]: [&Edges; 2], [da, db]: [DVec2; 2], alone: bool, kerb: bool) -> Meeting {
    let (from, to) = (da.perp(), -db.perp());
    let open = alone || cross(da, db) < 0.0;
    let direct = |path: Vec<DVec2>| Meeting { path, first: [0; 2], reach: [0.0; 2] };
    let widest = a.half.max(b.half);
    let around = || direct(sector_corners(from, to, widest).map(|corner| at + corner).collect());
    if open && a.half == b.half {
        return around();
    }
    let [mut left, mut right] = [Outline::new(at, a, da, 0), Outline::new(at, b, db, 1)];
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
            return around();
        }
        if da.dot(db) < -0.5 {
            return direct(Vec::new());
        }
        // The angle is so sharp that the streets part only farther out.
        let [p, q] = [&left, &right].map(|o| o.points[o.points.len() - 1]);
        let first = [a.sides[0].len(), b.sides[1].len()];
        return Meeting { path: vec![(p + q) / 2.0], first, reach: [f64::INFINITY; 2] };
    };
    let by = if kerb { ROUNDING } else { 0.0 };
    let [(reach_a, pa), (reach_b, pb)] =
        [left.beyond(hit.segments[0], hit.t[0], by), right.beyond(hit.segments[1], hit.t[1], by)];
    let curve = |t: f64| pa.lerp(hit.at, t).lerp(hit.at.lerp(pb, t), t);
    let mut path = left.end_beyond(hit.segments[0]).to_vec();
    path.reverse();
    if kerb {
        path.extend([pa, curve(0.25), curve(0.5), curve(0.75), pb]);
    } else {
        path.push(hit.at);
    }
    path.extend(right.end_beyond(hit.segments[1]));
    let first = [left.first_beyond(hit.segments[0]), right.first_beyond(hit.segments[1])];
    Meeting { path, first, reach: [reach_a, reach_b] }
}

/// The outline of one side of an arm, outwards: around the end of the arm behind the junction, then along its edge.
struct Outline {
    points: Vec<DVec2>,
    /// Number of points around the end, before the first point of the edge.
    end: usize,
}

impl Outline {
    /// The outline of the left (0) or right (1) side of an arm that leaves the junction at `at` in unit direction `d`.
    fn new(at: DVec2, edges: &Edges, d: DVec2, side: usize) -> Self {
        let normals = end_normals(d);
        let [edge, slant, behind] = if side == 0 { [0, 1, 2] } else { [4, 3, 2] }.map(|i| normals[i]);
        let mut points = Vec::with_capacity(8 + edges.sides[side].len());
        points.push(at + behind * edges.half);
        points.push(at + mitre(behind, slant, edges.half));
        points.push(at + mitre(slant, edge, edges.half));
        points.extend(&edges.sides[side]);
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

    /// The point `by` metres outwards from `t` (0..=1) on a segment, or else near the segment's end, and its distance from the
    /// junction along the edge, in metres. The distance is negative on the end of the arm.
    fn beyond(&self, segment: usize, t: f64, by: f64) -> (f64, DVec2) {
        let (a, b) = (self.points[segment], self.points[segment + 1]);
        let along = (t + by / a.distance(b).max(1e-6)).min(t.max(0.95));
        let length = |points: &[DVec2]| points.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
        let before = if segment < self.end {
            -length(&self.points[segment..=self.end])
        } else {
            length(&self.points[self.end..=segment])
        };
        (before + a.distance(b) * along, a.lerp(b, along))
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
