//! The surface of a junction and of the ends of its streets.

use crate::network::{Junction, JunctionId, Street, StreetClass};
use crate::space::{closest_on_segment, cut_line, math::angle_of, quantize};
use crate::surface::corner::{Corner, Edges, Meeting, meet, widest_radius};
use crate::surface::cover::cover_at;
use crate::surface::element::Element;
use crate::surface::finish::Finish;
use crate::surface::head::Head;
use crate::surface::offset::offset_line;
use crate::surface::profile::Profile;
use crate::surface::section::CrossSection;
use glam::DVec2;

/// Greatest length of a street that belongs to a junction, in metres.
pub const FARTHEST_REACH: f64 = 48.0;

/// Distance from a junction within which its corners usually lie, in metres.
const NEAR: f64 = 18.0;

/// Least length of a street between its junctions' parts, in metres.
const LEAST_BETWEEN: f64 = 0.5;

/// Length of the part of a bridge, at each of its ends, that belongs to the junction there, in metres. This part lies on the
/// ground; the deck begins beyond it.
pub fn deck_reach(street: &Street) -> f64 {
    // As wide as the widest quay.
    let most = if street.class.is_main() { 12.0 } else { 4.0 };
    (street.length() * 0.4).min(most)
}

/// The surface of a junction, up to where the streets that meet there run on by themselves. Positions are local, on the quantum
/// grid; every local frame gives the same.
pub struct JunctionShape<'a> {
    /// The junction's own point.
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
    /// Whether the street begins here.
    pub begins: bool,
    /// Where the junction ends and the street's own surface begins.
    pub cut: Cut,
    /// The corner between this arm and the next one counter-clockwise.
    pub corner: Corner,
    /// Centre line from the junction outwards to the cut and beyond, local.
    line: Vec<DVec2>,
}

/// A cut across a street.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Distance from the junction along the street, in metres.
    pub along: f64,
    /// Seen from the junction: the outer edge and the edge of the carriageway on the right, then both on the left.
    pub points: [DVec2; 4],
}

/// The end of a street at a junction.
#[derive(Clone, Debug)]
pub(super) struct StreetEnd {
    /// Where the street's own surface begins, seen from the junction.
    pub cut: Cut,
    /// Number of streets at the junction.
    pub streets: usize,
    /// The most important class among them.
    pub greatest: StreetClass,
}

impl<'a> JunctionShape<'a> {
    /// The surface of a junction. `ends` are the streets there, each with whether it begins at the junction; `head` is the head of
    /// a dead end. Tunnels and streets shorter than half a metre have no surface. `None` if no street has a surface.
    pub(super) fn new(junction: &Junction, ends: &[(&'a Street, bool)], head: Option<&Head>) -> Option<Self> {
        let mut spokes: Vec<Spoke<'a>> =
            ends.iter().filter_map(|(s, begins)| Spoke::new(s, *begins, junction.at)).collect();
        spokes.sort_by(|a, b| a.angle.total_cmp(&b.angle).then(a.street.id.cmp(&b.street.id)));
        let n = spokes.len();
        if n == 0 {
            return None;
        }
        let mut meetings: Vec<[Meeting; 2]> = Vec::with_capacity(n);
        for i in 0..n {
            let (a, b) = (&spokes[i], &spokes[(i + 1) % n]);
            let directions = [a.direction(), b.direction()];
            let [r, q] = [a, b].map(|spoke| spoke.section.corner_radius);
            let [v, w] = [a, b].map(|spoke| spoke.section.outer - spoke.section.carriageway);
            let paved = a.section.paved || b.section.paved;
            let radius =
                if paved { r.min(q).min(widest_radius(v.min(w), directions[0], directions[1])) } else { r.min(q) };
            let outer_radius = if paved { 0.0 } else { (radius - v.max(w)).max(0.0) };
            let at = DVec2::ZERO;
            let [kerb, side] = match head {
                Some(head) => [&a.carriageway, &a.outer].map(|edges| Meeting::around(head, edges)),
                None => [
                    meet(at, [&a.carriageway, &b.carriageway], directions, n == 1, radius),
                    meet(at, [&a.outer, &b.outer], directions, n == 1, outer_radius),
                ],
            };
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
            let kerb = a.edge_to(b, kerb, |s| &s.carriageway, [cuts[i].points[2], cuts[j].points[1]]);
            let side = a.edge_to(b, side, |s| &s.outer, [cuts[i].points[3], cuts[j].points[0]]);
            carriageway.push(cuts[i].points[1]);
            carriageway.extend(&kerb[..kerb.len() - 1]);
            corners.push(Corner { kerb, side, paved: a.section.paved || b.section.paved });
        }
        carriageway.dedup();
        // Back from the junction's own frame.
        let back = |points: &mut [DVec2]| points.iter_mut().for_each(|p| *p += junction.at);
        back(&mut carriageway);
        let arms = spokes.into_iter().zip(cuts).zip(corners).map(|((spoke, mut cut), mut corner)| {
            back(&mut cut.points);
            back(&mut corner.kerb);
            back(&mut corner.side);
            let mut line = spoke.line;
            back(&mut line);
            Arm { street: spoke.street, begins: spoke.begins, cut, corner, line }
        });
        Some(Self { at: junction.at, arms: arms.collect(), carriageway })
    }

    /// The triangulated surface. `profile` gives the profile of each arm's street. A junction whose outlines cross each other
    /// becomes overlapping shapes.
    pub(super) fn element<'p>(&self, profile: impl Fn(&Street) -> &'p Profile) -> Element {
        let arms: Vec<(&Arm<'_>, &Profile)> = self.arms.iter().map(|arm| (arm, profile(arm.street))).collect();
        let level = arms.iter().all(|(arm, profile)| arm.cut.along <= profile.level());
        let level = arms
            .first()
            .filter(|_| level)
            .map(|(arm, profile)| profile.height(if arm.begins { 0.0 } else { arm.street.length() }));
        let heights = Heights { arms, level };
        let mut out = Element::default();
        let finish = self.finish();
        let mut ring: Vec<u32> = Vec::with_capacity(self.carriageway.len());
        for p in &self.carriageway {
            ring.push(out.point(*p, heights.at(*p)));
        }
        let first = |p: DVec2| self.carriageway.iter().position(|q| *q == p).map(|i| ring[i]);
        for arm in &self.arms {
            let Corner { kerb, side, paved } = &arm.corner;
            let kerb: Vec<u32> =
                kerb.iter().map(|p| first(*p).unwrap_or_else(|| out.point(*p, heights.at(*p)))).collect();
            let side: Vec<u32> = side.iter().map(|p| out.point(*p, heights.at(*p))).collect();
            let edging = if *paved { Finish::Pavement } else { Finish::Verge };
            let before = out.triangles.len();
            // The junction lies to the right of its corners, seen from the first arm to the second.
            out.zip(&side, &kerb, edging);
            if !out.is_sound() {
                out.triangles.truncate(before);
                let around: Vec<u32> = side.iter().chain(kerb.iter().rev()).copied().collect();
                out.polygon(&around, edging);
            }
        }
        let star = (0..self.carriageway.len()).all(|i| {
            let [p, q] = [i, (i + 1) % self.carriageway.len()].map(|i| self.carriageway[i] - self.at);
            p.perp_dot(q) > 0.05
        });
        if star {
            let middle = out.point(self.at, heights.at(self.at));
            for i in 0..ring.len() {
                out.triangle([middle, ring[i], ring[(i + 1) % ring.len()]], finish);
            }
        } else {
            out.polygon(&ring, finish);
        }
        if out.is_sound() { out } else { self.overlapping(&heights) }
    }

    /// The most important class among the streets.
    pub(super) fn greatest(&self) -> StreetClass {
        self.arms.iter().map(|arm| arm.street.class).min().unwrap_or(StreetClass::Local)
    }

    /// Outline of pavements or verges, counter-clockwise.
    pub(super) fn outer(&self) -> Vec<DVec2> {
        let arm = |arm: &Arm<'_>| {
            let side = &arm.corner.side;
            std::iter::once(arm.cut.points[0]).chain(side[..side.len() - 1].iter().copied()).collect::<Vec<_>>()
        };
        self.arms.iter().flat_map(arm).collect()
    }

    fn finish(&self) -> Finish {
        let paved = self.arms.iter().any(|arm| CrossSection::of(arm.street.class).paved);
        if paved { Finish::Asphalt } else { Finish::Road }
    }

    /// Shapes that overlap each other and together cover the junction.
    fn overlapping(&self, heights: &Heights<'_>) -> Element {
        let mut out = Element::default();
        let id = JunctionId(0);
        let short = self.arms.iter().zip(1..).map(|(arm, end)| {
            let line = cut_line(&arm.line, 0.0, arm.cut.along);
            Street { line, from: id, to: JunctionId(end), ..arm.street.clone() }
        });
        let short: Vec<Street> = short.collect();
        let streets: Vec<&Street> = short.iter().collect();
        let mut lay = |half: fn(CrossSection) -> f64, finish: Finish| {
            for polygon in cover_at(id, &streets, |class| half(CrossSection::of(class))) {
                let at = polygon.iter().map(|p| self.at + quantize(*p - self.at));
                let ring: Vec<u32> = at.map(|p| out.point(p, heights.at(p))).collect();
                out.polygon(&ring, finish);
            }
        };
        let paved = self.finish() == Finish::Asphalt;
        lay(|section| section.outer, if paved { Finish::Pavement } else { Finish::Verge });
        lay(|section| section.carriageway, self.finish());
        out
    }
}

/// Heights around a junction.
struct Heights<'s> {
    arms: Vec<(&'s Arm<'s>, &'s Profile)>,
    /// The height of all of the junction, if it is level up to where its streets begin.
    level: Option<f64>,
}

impl Heights<'_> {
    /// Height at a local point: that of the streets beside it. On the cut across a street it is the street's own.
    fn at(&self, p: DVec2) -> f64 {
        if let Some(level) = self.level {
            return level;
        }
        let (mut sum, mut weights) = (0.0, 0.0);
        for (arm, profile) in &self.arms {
            let height = |along: f64| {
                let along = if arm.begins { along } else { arm.street.length() - along };
                profile.height(along)
            };
            if arm.cut.points.contains(&p) {
                return height(arm.cut.along);
            }
            let (mut best, mut along, mut station) = (f64::INFINITY, 0.0, 0.0);
            for w in arm.line.windows(2) {
                let (t, q) = closest_on_segment(p, w[0], w[1]);
                let length = w[0].distance(w[1]);
                let squared = q.distance_squared(p);
                if squared < best {
                    (best, station) = (squared, along + t * length);
                }
                along += length;
            }
            let weight = 1.0 / (best + 0.25);
            sum += height(station) * weight;
            weights += weight;
        }
        sum / weights
    }
}

/// Whether two points count as one corner.
fn is_same(a: DVec2, b: DVec2) -> bool {
    a.distance_squared(b) < 1e-4
}

/// The junction's part of a street, relative to the junction.
struct Spoke<'a> {
    street: &'a Street,
    begins: bool,
    section: CrossSection,
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

impl<'a> Spoke<'a> {
    fn new(street: &'a Street, begins: bool, at: DVec2) -> Option<Self> {
        let length = street.length();
        if !has_surface(street) {
            return None;
        }
        let reach = if street.bridge {
            deck_reach(street)
        } else {
            FARTHEST_REACH.min((length - LEAST_BETWEEN) / 2.0).max(length * 0.2)
        };
        let mut line: Vec<DVec2> = street.line.iter().map(|p| *p - at).collect();
        if !begins {
            line.reverse();
        }
        let mut line = cut_line(&line, 0.0, reach);
        line.dedup();
        if line.len() < 2 {
            return None;
        }
        let mut along = vec![0.0];
        along.extend(line.windows(2).scan(0.0, |sum, w| {
            *sum += w[0].distance(w[1]);
            Some(*sum)
        }));
        let near = along.iter().filter(|s| **s <= NEAR).count() + 1;
        let section = CrossSection::of(street.class);
        let edges = |half: f64| Edges {
            sides: [offset_line(&line, half), offset_line(&line, -half)],
            half,
            near,
            line: line.clone(),
            along: along.clone(),
        };
        let (carriageway, outer) = (edges(section.carriageway), edges(section.outer));
        let angle = angle_of(line[1] - line[0]);
        let clear = if street.bridge { along[along.len() - 1] } else { 0.0 };
        Some(Self { street, begins, section, along, angle, carriageway, outer, clear, line })
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
        let [carriageway, outer] = [&self.carriageway, &self.outer].map(|edges| match line.len() {
            0 | 1 => [0, 1].map(|side| edges.sides[side][self.line.len() - 1]),
            _ => [edges.half, -edges.half].map(|by| offset_line(&line[..2], by)[0]),
        });
        let points = [outer[1], carriageway[1], carriageway[0], outer[0]].map(quantize);
        Cut { along: self.clear, points }
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
            let beyond = |k: &usize| spoke.along[*k] < spoke.clear - 0.05;
            (first..edge.len()).take_while(beyond).map(|k| quantize(edge[k])).collect::<Vec<_>>()
        };
        let before = disturbed(self, 0);
        let path = before.into_iter().rev().chain(meeting.path.iter().map(|p| quantize(*p))).chain(disturbed(next, 1));
        let mut out = vec![from];
        for p in path {
            if !is_same(out[out.len() - 1], p) && !is_same(p, to) {
                out.push(p);
            }
        }
        out.push(to);
        out
    }
}

/// Whether a street has a surface: on the ground or on a deck.
pub fn has_surface(street: &Street) -> bool {
    !street.tunnel && street.length() >= 0.5
}
