//! The geometry of a patch taken apart as a filler needs it: what may be cut back and what may not.

use crate::patch::{Connectable, DrawingRules, Patch, tag};
use crate::space::{line_length, math, point_at, segments};
use glam::{DVec2, Vec2, Vec4};
use std::f64::consts::TAU;

/// Least length that is left of an arm when it is cut back, in metres.
pub const LEAST_ARM: f64 = 22.0;

/// Greatest distance between two samples along an edge.
const SAMPLE: f64 = 12.0;

/// Greatest distance between two samples along the part of an arm that may be cut back.
const ARM_SAMPLE: f64 = 6.0;

/// The geometry of a patch, taken apart. Main streets are left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchShape {
    /// Points on the part that cannot be cut back, the outermost first.
    pub samples: Vec<DVec2>,
    /// Edges that are on no arm.
    pub core: Vec<(usize, usize)>,
    /// For each end its street, from the other end to that one. Ends are the connectable vertices, and those on a main
    /// street that one local street leaves from.
    pub arms: Vec<Vec<usize>>,
    /// For each vertex whether it is such an end.
    pub is_end: Vec<bool>,
    /// Whether the streets keep [`STREET_FLOOR`](crate::network::STREET_FLOOR) among themselves, meet at angles of about 40 degrees or more, and are
    /// not too short, even when the patch is made smaller by [`STRETCH`](crate::patch::STRETCH).
    pub sound: bool,
    /// For each vertex whether it lies on a curve that is drawn on purpose, which keeps its shape: on the ring of a roundabout, or
    /// on a street that makes the patch a curved one ([`tag::CURVED`](crate::patch::tag::CURVED)) and is no end of that street from which the network goes on.
    pub shaped: Vec<bool>,
    /// Whether it has a roundabout, so that only placements which leave it round keep its shape.
    pub round: bool,
    /// Whether its local streets hang together. Those of a patch with a main street may be connected by that street alone.
    pub whole: bool,
    /// Greatest cosine of the angle between two edges at a vertex.
    sharpest: f64,
    /// Greatest number of edges at a vertex.
    most_streets: usize,
}

impl PatchShape {
    /// Takes a patch apart.
    pub(super) fn of(patch: &Patch) -> Self {
        let n = patch.vertices.len();
        let mut around: Vec<Vec<usize>> = vec![Vec::new(); n];
        for (i, e) in patch.edges.iter().enumerate().filter(|(_, e)| !e.main) {
            around[e.a].push(i);
            around[e.b].push(i);
        }
        let on_main = |v: usize| patch.edges.iter().any(|e| e.main && (e.a == v || e.b == v));
        let mut shape = Self { is_end: vec![false; n], ..Self::default() };
        let mut on_arm = vec![false; patch.edges.len()];
        let at = |v: usize| patch.vertices[v];
        let roots = (0..n).filter(|v| on_main(*v) && around[*v].len() == 1);
        let ends: Vec<usize> = patch.connectables.iter().map(|c| c.vertex).chain(roots).collect();
        for &end in &ends {
            shape.is_end[end] = true;
            let (mut v, mut arm, mut edge) = (end, vec![end], around[end][0]);
            loop {
                on_arm[edge] = true;
                v = patch.edges[edge].other(v);
                arm.push(v);
                let [e, f] = around[v][..] else { break };
                if on_main(v) || arm.len() > n {
                    break;
                }
                edge = if e == edge { f } else { e };
            }
            arm.reverse();
            let mut along = 0.0;
            // A street between two ends may be cut back from either.
            let fixed = if ends.contains(&arm[0]) { &[][..] } else { &arm[..] };
            for w in fixed.windows(2) {
                let length = at(w[0]).distance(at(w[1]));
                shape.samples.push(at(w[0]).lerp(at(w[1]), ((LEAST_ARM - along) / length).clamp(0.0, 1.0)));
                along += length;
                if along > LEAST_ARM {
                    break;
                }
            }
            shape.arms.push(arm);
        }
        for (i, e) in patch.edges.iter().enumerate().filter(|(_, e)| !e.main) {
            if !on_arm[i] {
                shape.core.push((e.a, e.b));
                let parts = (at(e.a).distance(at(e.b)) / SAMPLE).ceil().max(1.0) as usize;
                shape.samples.extend((0..=parts).map(|k| at(e.a).lerp(at(e.b), k as f64 / parts as f64)));
            }
        }
        shape.samples.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
        shape.samples.dedup();
        shape.sound = patch.flaw(&DrawingRules::NONE).is_none();
        shape.shaped = patch.shaped_vertices();
        shape.round = patch.tags.contains(tag::ROUNDABOUT);
        shape.whole = patch.locals_hang_together();
        shape.most_streets = around.iter().map(Vec::len).max().unwrap_or(0);
        shape.sharpest = -1.0;
        for (v, here) in around.iter().enumerate() {
            let way = |e: usize| (at(patch.edges[e].other(v)) - at(v)).normalize_or_zero();
            for (i, e) in here.iter().enumerate() {
                let sharpest = here[..i].iter().map(|f| way(*e).dot(way(*f))).fold(-1.0, f64::max);
                shape.sharpest = shape.sharpest.max(sharpest);
            }
        }
        shape
    }

    /// Whether a patch of this shape may stand where these rules hold: it is [sound](Self::sound), and neither forks too sharply
    /// nor has too many streets at a vertex.
    pub fn keeps(&self, rules: &DrawingRules) -> bool {
        self.sound && self.sharpest <= rules.cosine && self.most_streets <= rules.most_streets
    }
}

/// Number of sectors that the surroundings of a vertex are told apart by.
pub const SECTORS: usize = 16;

/// A patch as seen from one of its connectable vertices: from there, x is the direction in which the street enters the
/// patch. In single precision, since it is held against what is known coarsely.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchView {
    /// [`PatchShape::samples`], and more on what leads from there to the rest, with their distances from there, the farthest
    /// first.
    pub samples: Vec<(Vec2, f32)>,
    /// The other [`PatchShape::arms`].
    pub arms: Vec<Vec<ArmSample>>,
    /// The greatest distance of a sample in each sector, the middle of the first of which is x, counter-clockwise.
    pub reach: SectorReach,
}

/// A distance in each of [`SECTORS`], in metres, four together.
pub type SectorReach = [Vec4; SECTORS / 4];

/// The distances that are given for each sector, together.
pub(crate) fn in_sectors(distance: impl Fn(usize) -> f32) -> SectorReach {
    std::array::from_fn(|k| Vec4::from_array(std::array::from_fn(|lane| distance(4 * k + lane))))
}

/// A point on the part of an arm that may be cut back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmSample {
    /// Where it lies.
    pub at: Vec2,
    /// Unit direction of the arm there, outwards.
    pub heading: Vec2,
    /// Distance from where the arm begins.
    pub along: f32,
    /// Distance from where its straight edge begins.
    pub back: f32,
}

impl PatchView {
    pub(super) fn of(patch: &Patch, shape: &PatchShape, from: &Connectable) -> Self {
        let start = patch.vertices[from.vertex];
        let x = from.inward / from.inward.length_squared();
        let seen = |p: DVec2| DVec2::new(x.dot(p - start), x.perp_dot(p - start));
        let is_own = |arm: &&Vec<usize>| arm[arm.len() - 1] == from.vertex;
        let line = |arm: &Vec<usize>| arm.iter().map(|v| seen(patch.vertices[*v])).collect::<Vec<_>>();
        let own = shape.arms.iter().filter(is_own).filter(|arm| !shape.is_end[arm[0]]).map(line);
        let own = own.flat_map(|arm| samples_along(&arm, 0.0, SAMPLE)).map(|s| s.at.as_dvec2());
        let mut all: Vec<DVec2> = shape.samples.iter().map(|p| seen(*p)).chain(own).collect();
        all.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
        all.dedup();
        let mut view = Self::default();
        for p in &all {
            let sector = math::angle_of(*p) * SECTORS as f64 / TAU;
            let sector = (sector.round() as i32).rem_euclid(SECTORS as i32) as usize;
            let reach = &mut view.reach[sector / 4][sector % 4];
            *reach = reach.max(p.length() as f32);
        }
        view.samples = all.into_iter().map(|p| (p.as_vec2(), p.length() as f32)).collect();
        let others = shape.arms.iter().filter(|arm| !is_own(arm)).map(line);
        view.arms = others.map(|arm| samples_along(&arm, LEAST_ARM, ARM_SAMPLE)).collect();
        view
    }
}

/// The least reach in each sector of some views and of the same mirrored.
pub(super) fn least_reach(views: &[PatchView]) -> SectorReach {
    let of_sector = |view: &PatchView, sector: usize| view.reach[sector / 4][sector % 4];
    in_sectors(|sector| {
        let mirrored = (SECTORS - sector) % SECTORS;
        let both = views.iter().map(|view| of_sector(view, sector).min(of_sector(view, mirrored)));
        both.fold(f32::INFINITY, f32::min)
    })
}

/// Points along a line, no more than `step` apart, the first `from` metres after its beginning, the last at its end.
fn samples_along(line: &[DVec2], from: f64, step: f64) -> Vec<ArmSample> {
    let length = line_length(line);
    let parts = ((length - from) / step).ceil().max(0.0) as usize;
    let sample = |k: usize| {
        let along = length - (length - from) * k as f64 / parts.max(1) as f64;
        let (at, heading) = point_at(line, along);
        let begins =
            segments(line).map(|(a, b)| a.distance(b)).scan(0.0, |sum, l| Some(std::mem::replace(sum, *sum + l)));
        let back = along - begins.take_while(|begin| *begin < along).last().unwrap_or(0.0);
        ArmSample { at: at.as_vec2(), heading: heading.as_vec2(), along: along as f32, back: back as f32 }
    };
    (0..=parts).rev().map(sample).collect()
}
