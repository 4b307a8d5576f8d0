//! Whether the streets of a drawing keep the distances and angles among themselves that every street keeps.

use crate::network::STREET_FLOOR;
use crate::patch::Patch;
use crate::space::{math, segment_distance};
use glam::DVec2;

/// Greatest change of a patch's size when it is fitted between two vertices, as a share.
pub const STRETCH: f64 = 0.12;

/// Least length of a street between two junctions, in metres.
const LEAST_STREET: f64 = 16.0;

/// Least distance in metres between streets that meet at a junction, away from it, and between the parts of one street.
const LEAST_APART: f64 = 4.0;

/// Greatest cosine of the angle between two parts of a street, and between two streets at a junction.
const SHARPEST: [f64; 2] = [0.3, 0.75];

/// What a style asks of the drawing of a patch (Teng 2017, section 3.3), besides what is asked of every drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawingRules {
    /// Cosine of the least angle between two streets at a vertex, and between two parts of a street.
    pub cosine: f64,
    /// Greatest number of streets at a vertex.
    pub most_streets: usize,
}

impl DrawingRules {
    /// What asks for nothing.
    pub const NONE: Self = Self { cosine: 1.0, most_streets: usize::MAX };
}

/// Why a drawing cannot be built as it is. Vertices are numbered as in the drawing.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Flaw {
    /// More streets meet at a vertex than may.
    #[error("{streets} streets meet at vertex {at}; allowed are {allowed}")]
    Crowded {
        /// The vertex.
        at: usize,
        /// Number of streets that meet there.
        streets: usize,
        /// Greatest number allowed.
        allowed: usize,
    },
    /// A street between two junctions is too short.
    #[error("the street between the junctions {from} and {to} is {length:.1} m long; allowed is {allowed:.1} or more")]
    Short {
        /// The vertices at its ends.
        from: usize,
        /// The other end.
        to: usize,
        /// Length in metres.
        length: f64,
        /// Least length allowed, in metres.
        allowed: f64,
    },
    /// Two streets, or two parts of one, leave a vertex at too small an angle.
    #[error(
        "at vertex {at} the streets to {to} and {other} are {degrees:.1} degrees apart; allowed is {allowed:.1} or more"
    )]
    Sharp {
        /// The vertex.
        at: usize,
        /// The next vertex of the first street.
        to: usize,
        /// The next vertex of the second street.
        other: usize,
        /// The angle in degrees.
        degrees: f64,
        /// Least angle allowed, in degrees.
        allowed: f64,
    },
    /// Two segments that do not meet are too near each other.
    #[error("the streets {}-{} and {}-{} are {distance:.1} m apart; allowed is {allowed:.1} or more", .one.0, .one.1, .other.0, .other.1)]
    Near {
        /// The vertices of the first segment.
        one: (usize, usize),
        /// The vertices of the second segment.
        other: (usize, usize),
        /// Distance in metres.
        distance: f64,
        /// Least distance allowed, in metres.
        allowed: f64,
    },
}

impl Patch {
    /// What keeps every filler whose style has these rules from laying the patch, even when it is made smaller by [`STRETCH`].
    /// Main streets are left out.
    pub fn flaw(&self, rules: &DrawingRules) -> Option<Flaw> {
        let edges: Vec<(usize, usize)> = self.edges.iter().filter(|e| !e.main).map(|e| (e.a, e.b)).collect();
        flaw(&self.vertices, &edges, 1.0 / (1.0 - STRETCH), rules)
    }
}

/// Whether streets between `points` have no [flaw].
pub(crate) fn keeps_rules(points: &[DVec2], edges: &[(usize, usize)], larger: f64, rules: &DrawingRules) -> bool {
    flaw(points, edges, larger, rules).is_none()
}

/// The first flaw of streets between `points`: they keep [`STREET_FLOOR`] among themselves, meet at angles of about 40 degrees or
/// more, are not too short, and keep to `rules`; distances are `larger` times what they must be.
fn flaw(points: &[DVec2], edges: &[(usize, usize)], larger: f64, rules: &DrawingRules) -> Option<Flaw> {
    let least = STREET_FLOOR * larger;
    let at = |v: usize| points[v];
    let mut degrees = vec![0u32; points.len()];
    for (a, b) in edges {
        degrees[*a] += 1;
        degrees[*b] += 1;
    }
    if let Some(at) = degrees.iter().position(|d| *d as usize > rules.most_streets) {
        return Some(Flaw::Crowded { at, streets: degrees[at] as usize, allowed: rules.most_streets });
    }
    let degree = |v: usize| degrees[v];
    // Streets: runs of edges between vertices of other degree than 2.
    let mut street = vec![usize::MAX; edges.len()];
    let mut ends: Vec<[usize; 2]> = Vec::new();
    for i in 0..edges.len() {
        if street[i] != usize::MAX {
            continue;
        }
        let id = ends.len();
        street[i] = id;
        let mut length = at(edges[i].0).distance(at(edges[i].1));
        let mut reached = [edges[i].0, edges[i].1];
        for end in &mut reached {
            while degree(*end) == 2 {
                let Some(next) =
                    (0..edges.len()).find(|k| street[*k] == usize::MAX && (edges[*k].0 == *end || edges[*k].1 == *end))
                else {
                    break;
                };
                street[next] = id;
                length += at(edges[next].0).distance(at(edges[next].1));
                *end = if edges[next].0 == *end { edges[next].1 } else { edges[next].0 };
            }
        }
        ends.push(reached);
        let allowed = LEAST_STREET * larger;
        if length < allowed && reached.iter().all(|v| degree(*v) > 2) {
            return Some(Flaw::Short { from: reached[0], to: reached[1], length, allowed });
        }
    }
    for (i, e) in edges.iter().enumerate() {
        for (k, f) in edges[..i].iter().enumerate() {
            let (e0, e1, f0, f1) = (at(e.0), at(e.1), at(f.0), at(f.1));
            let (low, high) = (e0.min(e1) - least, e0.max(e1) + least);
            if low.cmpgt(f0.max(f1)).any() || f0.min(f1).cmpgt(high).any() {
                continue;
            }
            if let Some(v) = [e.0, e.1].into_iter().find(|v| *v == f.0 || *v == f.1) {
                let next = |x: &(usize, usize)| if x.0 == v { x.1 } else { x.0 };
                let arm = |x: &(usize, usize)| (at(next(x)) - at(v)).normalize_or_zero();
                let cosine = arm(e).dot(arm(f));
                let sharpest = if degree(v) == 2 { SHARPEST[0] } else { SHARPEST[1] };
                if cosine >= sharpest || cosine > rules.cosine {
                    let degrees = |cosine: f64| math::acos(cosine.clamp(-1.0, 1.0)).to_degrees();
                    let (degrees, allowed) = (degrees(cosine), degrees(sharpest.min(rules.cosine)));
                    return Some(Flaw::Sharp { at: v, to: next(f), other: next(e), degrees, allowed });
                }
                continue;
            }
            let joined = || ends[street[i]].iter().any(|v| degree(*v) > 2 && ends[street[k]].contains(v));
            let allowed = if street[i] == street[k] || joined() { LEAST_APART } else { least };
            let distance = segment_distance(e0, e1, f0, f1);
            if distance < allowed {
                return Some(Flaw::Near { one: *f, other: *e, distance, allowed });
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::PatchSet;

    fn flaw_of(drawing: &str, rules: &DrawingRules) -> String {
        let set = PatchSet::from_ron("s.ron", &format!("(patches: [(name: \"a\", {drawing})])")).expect(drawing);
        set.patches[0].flaw(rules).map_or(String::new(), |flaw| flaw.to_string())
    }

    #[test]
    fn flaws_name_vertices_and_what_is_allowed() {
        let cross =
            "vertices: [(0, 0), (60, 0), (0, 60), (-60, 0), (40, -60)], streets: [(0, 1), (0, 2), (0, 3), (0, 4)]";
        let rules = |degrees: f64, most_streets| DrawingRules { cosine: math::cos(degrees.to_radians()), most_streets };
        assert_eq!(flaw_of(cross, &DrawingRules::NONE), "");
        assert_eq!(flaw_of(cross, &rules(50.0, 4)), "");
        assert!(flaw_of(cross, &rules(50.0, 3)).contains("4 streets meet at vertex 0; allowed are 3"));
        let sharp = flaw_of(cross, &rules(60.0, 4));
        assert!(
            sharp.contains("at vertex 0") && sharp.contains("56.3 degrees") && sharp.contains("60.0 or more"),
            "{sharp}"
        );
        // Far enough apart as drawn, and too near when the patch is made smaller.
        let near =
            "vertices: [(0, 0), (90, 0), (150, 0), (150, 60), (90, 60), (60, 15), (0, 15), (90, -60), (210, 60)],
            streets: [[0, 1, 2, 3, 4, 5, 6], (1, 7), (3, 8)]";
        let near = flaw_of(near, &DrawingRules::NONE);
        assert!(near.contains("15.0 m apart") && near.contains("16.5 or more"), "{near}");
        let short = "vertices: [(-60, 0), (0, 0), (15, 0), (75, 0), (0, 60), (15, -60)], streets: [[0, 1, 2, 3], (1, 4), (2, 5)]";
        let short = flaw_of(short, &DrawingRules::NONE);
        assert!(short.contains("junctions 1 and 2 is 15.0 m long") && short.contains("18.2 or more"), "{short}");
        let bent = flaw_of("vertices: [(0, 0), (60, 0), (10, 30)], streets: [[0, 1, 2]]", &DrawingRules::NONE);
        assert!(
            bent.contains("at vertex 1") && bent.contains("31.0 degrees") && bent.contains("72.5 or more"),
            "{bent}"
        );
    }
}
