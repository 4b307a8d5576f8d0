//! Junctions: where streets meet, one surface with rounded kerbs, and the ends of these streets up to where their owners
//! go on.

use crate::chunk::{Chunk, ROAD_LIFT as LIFT, junction_reach};
use crate::mesh::buffers::MeshBuffers;
use crate::mesh::drape::Surface;
use crate::mesh::ribbon::{beside, carriageway_colour, corner, ribbon};
use crate::network::{Junction, Street};
use crate::space::{cross, cut_line, line_length, math::angle_of, segment_crossing};
use glam::DVec2;

/// Distance (metres) from the corner of two kerbs at which their rounding begins.
const ROUNDING: f64 = 3.0;

/// How far (metres) the edges of streets that meet at an obtuse angle are followed back beyond the junction to cross.
const BACK: f64 = 15.0;

/// The end of a street at a junction.
struct Spoke<'a> {
    street: &'a Street,
    /// Centre line from the junction to where the street's owner goes on.
    line: Vec<DVec2>,
    angle: f64,
    /// Edges of the carriageway and outer edges, left and right going outwards.
    kerbs: [Vec<DVec2>; 2],
    sides: [Vec<DVec2>; 2],
    /// Metres along the line from which the street runs undisturbed.
    clear: f64,
}

/// The edge of the land between two spokes: the kerb, and the outer edge of the pavement.
struct Between {
    kerb: Vec<DVec2>,
    side: Vec<DVec2>,
}

/// The streets that end at each of the chunk's junctions, as index of the junction and whether the street begins there.
pub(super) fn ends(chunk: &Chunk) -> Vec<Vec<(&Street, bool)>> {
    let mut ends: Vec<Vec<(&Street, bool)>> = vec![Vec::new(); chunk.junctions.len()];
    for street in chunk.streets.iter().map(|s| &s.street).chain(&chunk.arriving) {
        for (id, begins) in [(street.from, true), (street.to, false)] {
            if let Ok(at) = chunk.junctions.binary_search_by_key(&id, |j| j.id) {
                ends[at].push((street, begins));
            }
        }
    }
    ends
}

/// Adds a junction and the ends of its streets.
pub(super) fn junction(
    surface: &mut Surface<'_>,
    out: &mut MeshBuffers,
    junction: &Junction,
    ends: &[(&Street, bool)],
) {
    let mut spokes: Vec<Spoke> = ends.iter().filter_map(|(street, begins)| spoke(street, *begins)).collect();
    spokes.sort_by(|a, b| a.angle.total_cmp(&b.angle).then(a.street.id.cmp(&b.street.id)));
    let n = spokes.len();
    let between: Vec<Between> = (0..n).map(|i| between(&mut spokes, i, (i + 1) % n, junction.at)).collect();
    let mut core: Vec<DVec2> = Vec::new();
    for (i, spoke) in spokes.iter().enumerate() {
        let length = line_length(&spoke.line);
        let class = spoke.street.class;
        let (half, outer) = (class.carriageway() / 2.0, class.half_width());
        let rest = cut_line(&spoke.line, spoke.clear, length);
        let cut =
            |by: f64| if rest.len() > 1 { beside(&rest, by)[0] } else { beside(&spoke.line, by)[spoke.line.len() - 1] };
        ribbon(surface, out, &rest, class);
        let next = &spokes[(i + 1) % n];
        let next_rest = cut_line(&next.line, next.clear, line_length(&next.line));
        let next_cut = |by: f64| {
            if next_rest.len() > 1 { beside(&next_rest, by)[0] } else { beside(&next.line, by)[next.line.len() - 1] }
        };
        let next_class = next.street.class;
        let whole = |middle: &[DVec2], from: DVec2, to: DVec2| {
            let mut points = vec![from];
            points.extend(middle.iter().chain([&to]));
            points.dedup_by(|b, a| a.distance_squared(*b) < 1e-4);
            points
        };
        let kerb = whole(&between[i].kerb, cut(half), next_cut(-next_class.carriageway() / 2.0));
        let side = whole(&between[i].side, cut(outer), next_cut(-next_class.half_width()));
        let paved = class.pavement() > 0.0 || next_class.pavement() > 0.0;
        corner(surface, out, &kerb, &side, paved);
        core.push(cut(-half));
        core.extend(kerb);
        core.pop();
    }
    core.dedup_by(|b, a| a.distance_squared(*b) < 1e-4);
    let Some(widest) = spokes.iter().map(|s| s.street.class).min() else { return };
    for i in 0..core.len() {
        let triangle = [junction.at, core[i], core[(i + 1) % core.len()]];
        surface.lay_triangle(out, triangle, LIFT, carriageway_colour(widest));
    }
}

fn spoke(street: &Street, begins: bool) -> Option<Spoke<'_>> {
    let length = street.length();
    if length < 0.5 || street.tunnel {
        return None;
    }
    let end = junction_reach(street);
    let line = if begins {
        cut_line(&street.line, 0.0, end)
    } else {
        let mut line = cut_line(&street.line, length - end, length);
        line.reverse();
        line
    };
    if line.len() < 2 {
        return None;
    }
    let (half, outer) = (street.class.carriageway() / 2.0, street.class.half_width());
    Some(Spoke {
        street,
        angle: angle_of(line[1] - line[0]),
        kerbs: [beside(&line, half), beside(&line, -half)],
        sides: [beside(&line, outer), beside(&line, -outer)],
        clear: 0.0,
        line,
    })
}

/// The corner between spoke `i` and the next one counter-clockwise, `j`; both are told how far it reaches.
fn between(spokes: &mut [Spoke<'_>], i: usize, j: usize, at: DVec2) -> Between {
    let (a, b) = (&spokes[i], &spokes[j]);
    let (da, db) = ((a.line[1] - a.line[0]).normalize_or_zero(), (b.line[1] - b.line[0]).normalize_or_zero());
    // More than half a turn from `a` to `b`: the corner lies outside both.
    let open = i == j || (cross(da, db) < -0.02);
    let mut reach = [0.0f64; 2];
    let mut edge = |left: &[DVec2], right: &[DVec2], round: f64| -> Vec<DVec2> {
        if open {
            return around(left[0] - at, right[0] - at).into_iter().map(|p| at + p).collect();
        }
        let back = |edge: &[DVec2], d: DVec2| [&[edge[0] - d * BACK], edge].concat();
        let (left, right) = (back(left, da), back(right, db));
        let Some(hit) = meeting(&left, &right) else {
            if da.dot(db) < -0.5 {
                return vec![left[1], right[1]];
            }
            // So sharp that they part only further out.
            reach = [f64::INFINITY; 2];
            return vec![(left[left.len() - 1] + right[right.len() - 1]) / 2.0];
        };
        let (ta, pa) = hit.out(&left, hit.i, hit.t, round);
        let (tb, pb) = hit.out(&right, hit.j, hit.u, round);
        reach[0] = reach[0].max(ta);
        reach[1] = reach[1].max(tb);
        if round == 0.0 {
            return vec![hit.at];
        }
        let curve = |t: f64| pa.lerp(hit.at, t).lerp(hit.at.lerp(pb, t), t);
        vec![pa, curve(0.25), curve(0.5), curve(0.75), pb]
    };
    let kerb = edge(&a.kerbs[0], &b.kerbs[1], ROUNDING);
    let side = edge(&a.sides[0], &b.sides[1], 0.0);
    for (k, reach) in [(i, reach[0]), (j, reach[1])] {
        let length = line_length(&spokes[k].line);
        spokes[k].clear = spokes[k].clear.max(reach).min(length);
    }
    Between { kerb, side }
}

/// Corners of a square edge from offset `from` counter-clockwise round to offset `to`, both ends included.
fn around(from: DVec2, to: DVec2) -> Vec<DVec2> {
    let mitre = |a: DVec2, b: DVec2| (a + b) / (1.0 + a.normalize_or_zero().dot(b.normalize_or_zero())).max(0.5);
    if from.dot(to) >= 0.0 && cross(from, to) >= 0.0 {
        return vec![from, mitre(from, to), to];
    }
    let (a, b) = (from.normalize_or_zero(), to.normalize_or_zero());
    let middle = if cross(a, b) > 1e-6 { (a + b).normalize_or_zero() } else { a.perp() };
    let middle = middle * from.length().max(to.length());
    vec![from, mitre(from, middle), mitre(middle, to), to]
}

/// Where two edges meet.
struct Meeting {
    at: DVec2,
    i: usize,
    t: f64,
    j: usize,
    u: f64,
}

/// The outermost crossing of two edges that both begin near a junction.
fn meeting(left: &[DVec2], right: &[DVec2]) -> Option<Meeting> {
    for i in (0..left.len() - 1).rev() {
        for j in (0..right.len() - 1).rev() {
            if let Some(c) = segment_crossing(left[i], left[i + 1], right[j], right[j + 1]) {
                return Some(Meeting { at: c.at, i, t: c.t, j, u: c.u });
            }
        }
    }
    None
}

impl Meeting {
    /// Metres along an edge that begins [`BACK`] metres early, and the point, `by` metres outwards from the meeting on its
    /// segment, or nearly the segment's end.
    fn out(&self, edge: &[DVec2], segment: usize, t: f64, by: f64) -> (f64, DVec2) {
        let (a, b) = (edge[segment], edge[segment + 1]);
        let along = (t + by / a.distance(b).max(1e-6)).min(t.max(0.95));
        let before: f64 = edge[..=segment].windows(2).map(|w| w[0].distance(w[1])).sum();
        (before + a.distance(b) * along - BACK, a.lerp(b, along))
    }
}
