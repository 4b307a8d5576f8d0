//! The surface of a junction and of the ends of its streets.

use crate::network::{Junction, Street};
use crate::space::{cut_line, math::angle_of};
use crate::surface::corner::{Corner, Edges, Meeting, meet};
use crate::surface::offset::offset_line;
use glam::DVec2;

/// Length of the part of a street, at each of its ends, that belongs to the junction there, in metres. This part lies on the
/// ground; a bridge's deck begins beyond it.
pub fn junction_reach(street: &Street) -> f64 {
    let most = match street.bridge {
        // As wide as the widest quay.
        true if street.class.is_main() => 12.0,
        true => 4.0,
        false => 18.0,
    };
    (street.length() * 0.4).min(most)
}

/// The surface of a junction, up to where the streets that meet there run on by themselves.
pub struct JunctionShape<'a> {
    /// The junction's own point, from which all of `carriageway` is seen.
    pub at: DVec2,
    /// The streets that meet, counter-clockwise from west.
    pub arms: Vec<Arm<'a>>,
    /// Outline of the carriageway between the arms, counter-clockwise.
    pub carriageway: Vec<DVec2>,
}

/// The end of a street at a junction.
pub struct Arm<'a> {
    /// The street.
    pub street: &'a Street,
    /// Centre line from where the arm is clear of the junction's corners, outwards to the end of the junction's part of the
    /// street. A single point, or none, if the corners reach that far.
    pub line: Vec<DVec2>,
    /// The corner between this arm and the next one counter-clockwise.
    pub corner: Corner,
}

impl<'a> JunctionShape<'a> {
    /// The surface of a junction. `ends` are the streets there, each with whether it begins at the junction. Tunnels and streets
    /// shorter than half a metre have no surface. `None` if no street has a surface.
    pub fn new(junction: &Junction, ends: &[(&'a Street, bool)]) -> Option<Self> {
        let mut spokes: Vec<Spoke<'a>> = ends.iter().filter_map(|(s, begins)| Spoke::new(s, *begins)).collect();
        spokes.sort_by(|a, b| a.angle.total_cmp(&b.angle).then(a.street.id.cmp(&b.street.id)));
        let n = spokes.len();
        if n == 0 {
            return None;
        }
        let mut meetings: Vec<[Meeting; 2]> = Vec::with_capacity(n);
        for i in 0..n {
            let (a, b) = (&spokes[i], &spokes[(i + 1) % n]);
            let directions = [a.direction(), b.direction()];
            let kerb = meet(junction.at, [&a.carriageway, &b.carriageway], directions, n == 1, true);
            let side = meet(junction.at, [&a.outer, &b.outer], directions, n == 1, false);
            let reach = [0, 1].map(|k| kerb.reach[k].max(side.reach[k]));
            spokes[i].keep_clear(reach[0]);
            spokes[(i + 1) % n].keep_clear(reach[1]);
            meetings.push([kerb, side]);
        }
        let cuts: Vec<Cut> = spokes.iter().map(Spoke::cut).collect();
        let mut carriageway: Vec<DVec2> = Vec::new();
        let mut corners = Vec::with_capacity(n);
        for (i, [kerb, side]) in meetings.iter().enumerate() {
            let j = (i + 1) % n;
            let (a, b) = (&spokes[i], &spokes[j]);
            let kerb = a.edge_to(b, kerb, |s| &s.carriageway, [cuts[i].carriageway[0], cuts[j].carriageway[1]]);
            let side = a.edge_to(b, side, |s| &s.outer, [cuts[i].outer[0], cuts[j].outer[1]]);
            carriageway.push(cuts[i].carriageway[1]);
            carriageway.extend(&kerb[..kerb.len() - 1]);
            let paved = a.street.class.pavement() > 0.0 || b.street.class.pavement() > 0.0;
            corners.push(Corner { kerb, side, paved });
        }
        carriageway.dedup_by(|b, a| is_same(*a, *b));
        let arms = spokes.into_iter().zip(cuts).zip(corners);
        let arms = arms.map(|((spoke, cut), corner)| Arm { street: spoke.street, line: cut.line, corner }).collect();
        Some(Self { at: junction.at, arms, carriageway })
    }
}

/// Whether two points count as one corner.
fn is_same(a: DVec2, b: DVec2) -> bool {
    a.distance_squared(b) < 1e-4
}

/// The junction's part of a street.
struct Spoke<'a> {
    street: &'a Street,
    /// Centre line outwards.
    line: Vec<DVec2>,
    /// For each point of `line`, its distance from the junction along the line, in metres.
    along: Vec<f64>,
    angle: f64,
    carriageway: Edges,
    outer: Edges,
    /// Metres along the line from which the street runs undisturbed.
    clear: f64,
}

/// Where a street's own surface begins: its centre line from there, and the left and right ends of its edges.
struct Cut {
    line: Vec<DVec2>,
    carriageway: [DVec2; 2],
    outer: [DVec2; 2],
}

impl<'a> Spoke<'a> {
    fn new(street: &'a Street, begins: bool) -> Option<Self> {
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
        let mut along = vec![0.0];
        along.extend(line.windows(2).scan(0.0, |sum, w| {
            *sum += w[0].distance(w[1]);
            Some(*sum)
        }));
        let edges = |half: f64| Edges { sides: [offset_line(&line, half), offset_line(&line, -half)], half };
        let (carriageway, outer) = (edges(street.class.carriageway() / 2.0), edges(street.class.half_width()));
        let angle = angle_of(line[1] - line[0]);
        Some(Self { street, along, angle, carriageway, outer, clear: 0.0, line })
    }

    fn direction(&self) -> DVec2 {
        (self.line[1] - self.line[0]).normalize_or_zero()
    }

    fn length(&self) -> f64 {
        self.along[self.along.len() - 1]
    }

    /// Lets the street run undisturbed only from `reach` metres on.
    fn keep_clear(&mut self, reach: f64) {
        self.clear = self.clear.max(reach).min(self.length());
    }

    fn cut(&self) -> Cut {
        let line = cut_line(&self.line, self.clear, self.length());
        let ends = |edges: &Edges| match line.len() {
            0 | 1 => [0, 1].map(|side| edges.sides[side][self.line.len() - 1]),
            _ => [edges.half, -edges.half].map(|by| offset_line(&line, by)[0]),
        };
        Cut { carriageway: ends(&self.carriageway), outer: ends(&self.outer), line }
    }

    /// The edge of the land from this arm to the next: from the end of this arm's left edge, over the points where both edges
    /// meet, to the end of the next arm's right edge.
    fn edge_to(
        &self,
        next: &Self,
        meeting: &Meeting,
        edges: fn(&Self) -> &Edges,
        [from, to]: [DVec2; 2],
    ) -> Vec<DVec2> {
        let disturbed = |spoke: &Self, side: usize| {
            let (edge, first) = (&edges(spoke).sides[side], meeting.first[side]);
            let beyond = |k: &usize| spoke.along[*k] < spoke.clear - 0.01;
            (first..edge.len()).take_while(beyond).map(|k| edge[k]).collect::<Vec<_>>()
        };
        let mut out = vec![from];
        out.extend(disturbed(self, 0).iter().rev());
        out.extend(&meeting.path);
        out.extend(disturbed(next, 1));
        out.push(to);
        out.dedup_by(|b, a| is_same(*a, *b));
        out
    }
}
