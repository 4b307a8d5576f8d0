//! Corners of a junction: where the land between two neighbouring arms ends.

use crate::space::{cross, segment_crossing};
use crate::surface::offset::{end_normals, mitre, sector_corners};
use glam::DVec2;

/// Distance from the corner of two kerbs at which their rounding begins, in metres.
const ROUNDING: f64 = 3.0;

/// The edge of the land between two neighbouring arms of a junction: two lines that run counter-clockwise around the
/// junction, from where the first arm's own surface ends to where that of the second does.
pub struct Corner {
    /// The edge of the carriageway, rounded.
    pub kerb: Vec<DVec2>,
    /// The outer edge of the pavement; that of the carriageway where there is no pavement.
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

/// Where the edges of two neighbouring arms end at the junction: the first arm's left edge and the second one's right edge.
pub(super) struct Meeting {
    /// The points between the two edges.
    pub path: Vec<DVec2>,
    /// For each arm the first point of its edge beyond the path, as an index.
    pub first: [usize; 2],
    /// For each arm the distance from the junction at which its edge begins to run undisturbed, in metres.
    pub reach: [f64; 2],
}

/// Where the left edge of an arm in unit direction `da` and the right edge of the next arm counter-clockwise, in direction
/// `db`, end around `at`. `alone` says that the two are one and the same arm; a `kerb` is rounded.
pub(super) fn meet(at: DVec2, [a, b]: [&Edges; 2], [da, db]: [DVec2; 2], alone: bool, kerb: bool) -> Meeting {
    if alone || cross(da, db) < 0.0 {
        let (from, to, radius) = (da.perp(), -db.perp(), a.half.max(b.half));
        let mut path: Vec<DVec2> = Vec::with_capacity(4);
        path.extend((a.half < radius).then(|| at + from * radius));
        path.extend(sector_corners(from, to, radius).map(|corner| at + corner));
        path.extend((b.half < radius).then(|| at + to * radius));
        return Meeting { path, first: [0; 2], reach: [0.0; 2] };
    }
    let [left, right] = [Outline::new(at, a, da, 0), Outline::new(at, b, db, 1)];
    let Some(hit) = outermost_crossing(&left.points, &right.points) else {
        if da.dot(db) < -0.5 {
            return Meeting { path: Vec::new(), first: [0; 2], reach: [0.0; 2] };
        }
        // So sharp that the streets part only further out.
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
    let first = [(hit.segments[0] + 1).saturating_sub(END), (hit.segments[1] + 1).saturating_sub(END)];
    Meeting { path, first, reach: [reach_a, reach_b] }
}

/// Points of half an arm's end before its edge begins.
const END: usize = 3;

/// The outline of one side of an arm, outwards: from behind the junction around its end and along its edge.
struct Outline {
    points: Vec<DVec2>,
    /// Length of the part around the end, in metres.
    end: f64,
}

impl Outline {
    /// The outline of the left (0) or right (1) side of an arm that leaves the junction at `at` in unit direction `d`.
    fn new(at: DVec2, edges: &Edges, d: DVec2, side: usize) -> Self {
        let normals = end_normals(d);
        let [edge, slant, behind] = if side == 0 { [0, 1, 2] } else { [4, 3, 2] }.map(|i| normals[i]);
        let mut points = Vec::with_capacity(END + edges.sides[side].len());
        points.push(at + behind * edges.half);
        points.push(at + mitre(behind, slant, edges.half));
        points.push(at + mitre(slant, edge, edges.half));
        points.extend(&edges.sides[side]);
        let end = points[..=END].windows(2).map(|w| w[0].distance(w[1])).sum();
        Self { points, end }
    }

    /// The distance from the junction along the edge, and the point, `by` metres outwards from the point at `t` (0..=1) of a
    /// segment, or nearly at the end of the segment. The distance is negative on the end of the arm.
    fn beyond(&self, segment: usize, t: f64, by: f64) -> (f64, DVec2) {
        let (a, b) = (self.points[segment], self.points[segment + 1]);
        let along = (t + by / a.distance(b).max(1e-6)).min(t.max(0.95));
        let before: f64 = self.points[..=segment].windows(2).map(|w| w[0].distance(w[1])).sum();
        (before + a.distance(b) * along - self.end, a.lerp(b, along))
    }

    /// The points of the end of the arm that lie outwards of a segment.
    fn end_beyond(&self, segment: usize) -> &[DVec2] {
        &self.points[(segment + 1).min(END)..END]
    }
}

/// Where two outlines cross.
struct Crossing {
    at: DVec2,
    segments: [usize; 2],
    /// Parameters along the segments, 0..=1.
    t: [f64; 2],
}

/// The outermost crossing of two outlines.
fn outermost_crossing(left: &[DVec2], right: &[DVec2]) -> Option<Crossing> {
    for i in (0..left.len() - 1).rev() {
        for j in (0..right.len() - 1).rev() {
            if let Some(c) = segment_crossing(left[i], left[i + 1], right[j], right[j + 1]) {
                return Some(Crossing { at: c.at, segments: [i, j], t: [c.t, c.u] });
            }
        }
    }
    None
}
