//! The four one-way ramps of a diamond interchange.
//!
//! In each quarter a ramp joins the highway, some way before or after the crossing, with the other road beyond its bridge. It
//! meets the other road nearly at a right angle, in one junction with the ramp on the other side of that road. Along the highway
//! the ramps of both sides begin and end at different places, so that each meets it in a junction of its own. Traffic keeps to the
//! right: it leaves the highway before the crossing and joins it beyond.

use super::dimensions::{FARTHEST_RAMP, HALF_LENGTH, LONGEST_RAMP, OFF, OFF_VERTEX, RAMP_ANGLE, RAMPS_WITHIN, RUN_OUT};
use super::surroundings::{Cross, RunVertex, Surroundings};
use crate::layer::LayerError;
use crate::region::road::cost::corner_radius;
use crate::region::road::crossing::Hindrance;
use crate::region::road::vertex::{Key, Position, Rank, part_of_way};
use crate::space::math::angle_between;
use crate::space::{cross, left_normal, segment_crossing, segments};
use glam::{DVec2, I64Vec2};

/// Distances in metres from the crossing, along the highway, at which ramps begin or end; the first that fit are taken.
const ON_HIGHWAY: [f64; 5] = [240.0, 285.0, FARTHEST_RAMP, 200.0, 165.0];
/// The same along the other road.
const ON_UPPER: [f64; 3] = [HALF_LENGTH + RUN_OUT, HALF_LENGTH + RUN_OUT + 30.0, HALF_LENGTH + RUN_OUT + 65.0];
/// Lengths in metres of the stretch in which a ramp approaches the other road squarely.
const APPROACHES: [f64; 3] = [110.0, 75.0, 50.0];
/// Least distance in metres along the highway between the ends of ramps on both sides of it.
const STAGGER: f64 = 40.0;
/// Least angle in radians between a ramp and the other road.
const UPPER_ANGLE: f64 = 0.9;
/// Least radius in metres of the curve of a ramp.
const LEAST_RADIUS: f64 = 40.0;
/// Greatest bend in radians of a road at a vertex where a ramp ends.
const STRAIGHT: f64 = 0.2;
/// Distance in metres on both sides of the end of a ramp within which the road is dry.
const DRY: f64 = 30.0;
/// Distance in metres that a ramp keeps from its roads, and the share of a corner by which smoothing may move them.
const APART: (f64, f64) = (8.0, 0.4);

/// A place on a road where a ramp begins or ends.
#[derive(Clone, Copy)]
pub(super) struct RampEnd {
    /// The edge that it divides; `None` at a vertex.
    pub edge: Option<usize>,
    pub key: Key,
    pub position: Position,
    /// The place relative to the crossing, and the direction of the road there, away from the crossing.
    at: DVec2,
    along: DVec2,
    /// Distance in metres from the crossing along the road.
    far: f64,
}

/// A one-way ramp, in the direction of its traffic.
#[derive(Clone, Copy)]
pub(super) struct Ramp {
    pub ends: [RampEnd; 2],
    /// The corner that it rounds.
    pub bend: Position,
}

/// The ramps of a diamond interchange.
pub(super) struct Diamond {
    pub ramps: [Ramp; 4],
    /// Where the other road is of a lesser class on one side of the crossing, its edges up to the ramps on that side, each with its
    /// vertex on the side of the crossing: they get the rank of the better class.
    pub raised: Vec<(usize, usize)>,
    pub rank: Rank,
}

/// A road from the crossing on: its vertices, relative to the crossing, and its edges.
struct Arm {
    run: Vec<RunVertex>,
    line: Vec<DVec2>,
    /// Ends of ramps that were tried, by distance.
    ends: Vec<RampEnd>,
}

impl Arm {
    fn edges(&self) -> impl Iterator<Item = usize> {
        self.run.iter().map(|v| v.edge)
    }

    /// The edges up to a distance, each with its vertex on the side of the crossing.
    fn before(&self, crossing: usize, far: f64) -> impl Iterator<Item = (usize, usize)> {
        let starts = std::iter::once((0.0, crossing)).chain(self.run.iter().map(|v| (v.along, v.node)));
        starts.zip(self.edges()).filter(move |((start, _), _)| *start < far).map(|((_, n), e)| (e, n))
    }

    /// The line up to a distance, without the vertices beyond.
    fn up_to(&self, end: &RampEnd) -> Vec<DVec2> {
        let before = self.run.iter().take_while(|v| v.along < end.far).count();
        self.line[..=before].to_vec()
    }
}

impl Surroundings<'_> {
    /// The four ramps of a crossing, if there is room for all.
    pub fn diamond(&self, crossing: &Cross) -> Result<Result<Diamond, Hindrance>, LayerError> {
        let arms = |edges: [usize; 2], wanted: &[f64]| -> Result<[Arm; 2], Hindrance> {
            let [a, b] = edges.map(|e| self.arm(crossing.node, e, wanted));
            Ok([a?, b?])
        };
        let (highway, upper) = match (arms(crossing.highway, &ON_HIGHWAY), arms(crossing.upper, &ON_UPPER)) {
            (Ok(highway), Ok(upper)) => (highway, upper),
            (Err(hindrance), _) | (_, Err(hindrance)) => return Ok(Err(hindrance)),
        };
        let own: Vec<usize> = highway.iter().chain(&upper).flat_map(Arm::edges).collect();
        let rank = self.net().edges[crossing.upper[0]].rank;
        let (mut out, mut raised): (Vec<Ramp>, Vec<(usize, usize)>) = Default::default();
        for u in &upper {
            let mut hindrance = Hindrance::Junction;
            let mut both = None;
            for q in &u.ends {
                match self.pair((crossing, &own), &highway, (u, q), &out)? {
                    Ok(pair) => {
                        both = Some(pair);
                        if u.edges().any(|e| self.class(e) != rank.class) {
                            raised.extend(u.before(crossing.node, q.far));
                        }
                        break;
                    }
                    // What comes last in the order of tests kept the ramps from the least.
                    Err(h) => hindrance = hindrance.max(h),
                }
            }
            match both {
                Some(pair) => out.extend(pair),
                None => return Ok(Err(hindrance)),
            }
        }
        let ramps = <[Ramp; 4]>::try_from(out).map_err(|_| Hindrance::Junction);
        Ok(ramps.map(|ramps| Diamond { ramps, raised, rank }))
    }

    /// The ramps from both arms of the highway to one place on the other road, beside those that were found before. The edges of
    /// all arms come with the crossing.
    fn pair(
        &self,
        crossing: (&Cross, &[usize]),
        highway: &[Arm; 2],
        upper: (&Arm, &RampEnd),
        before: &[Ramp],
    ) -> Result<Result<[Ramp; 2], Hindrance>, LayerError> {
        let mut out: Vec<Ramp> = Vec::new();
        for arm in highway {
            let mut hindrance = Hindrance::Junction;
            let mut found = None;
            for p in &arm.ends {
                let taken = before.iter().flat_map(|r| r.ends).any(|e| e.at.distance(p.at) < STAGGER);
                if taken {
                    continue;
                }
                match self.ramp(crossing, (arm, p), upper)? {
                    Ok(ramp) => {
                        found = Some(ramp);
                        break;
                    }
                    Err(h) => hindrance = hindrance.max(h),
                }
            }
            match found {
                Some(ramp) => out.push(ramp),
                None => return Ok(Err(hindrance)),
            }
        }
        Ok(<[Ramp; 2]>::try_from(out).map_err(|_| Hindrance::Junction))
    }

    /// A ramp between a place on the highway and one on the other road.
    fn ramp(
        &self,
        (crossing, own): (&Cross, &[usize]),
        (h, p): (&Arm, &RampEnd),
        (u, q): (&Arm, &RampEnd),
    ) -> Result<Result<Ramp, Hindrance>, LayerError> {
        let node = crossing.node;
        // Square to the other road, on the side of the highway's arm.
        let square = left_normal(q.along) * if cross(q.along, p.at - q.at) > 0.0 { 1.0 } else { -1.0 };
        let mut hindrance = Hindrance::Angle;
        for approach in APPROACHES {
            let bend = self.net().nodes[node].position.moved(q.at + square * approach);
            let corner = bend.from(&self.net().nodes[node].position);
            let line = [p.at, corner, q.at];
            let meets = |at: DVec2, along: DVec2| {
                let by = corner - at;
                angle_between(by, along).min(angle_between(by, -along))
            };
            let fits = meets(p.at, p.along) >= RAMP_ANGLE
                && meets(q.at, q.along) >= UPPER_ANGLE
                && corner_radius(corner - p.at, q.at - corner) >= LEAST_RADIUS
                && p.at.distance(q.at) <= LONGEST_RAMP
                && line.iter().all(|at| at.length() <= RAMPS_WITHIN);
            if !fits || !keeps_apart(&line, h, p) || !keeps_apart(&line, u, q) {
                continue;
            }
            if !self.are_own(node, &line)? {
                hindrance = hindrance.max(Hindrance::Crossing);
                continue;
            }
            let mut corners = h.up_to(p);
            corners.reverse();
            corners.extend(&u.up_to(q)[1..]);
            corners.reverse();
            if !self.is_free(node, &line, &corners, own)? {
                hindrance = hindrance.max(Hindrance::Obstacle);
                continue;
            }
            let class = self.class(crossing.upper[0]);
            let ends = [(p, bend), (q, bend)];
            let mut lets_through = self.is_dry(p) && self.is_dry(q);
            for (end, bend) in ends {
                lets_through =
                    lets_through && self.rules.ground_lets_through(&end.position, bend.from(&end.position), class)?;
            }
            if !lets_through {
                hindrance = Hindrance::Ground;
                continue;
            }
            // Traffic that comes along the highway's arm has the other road's arm to its right, or not.
            let leaves = cross(p.along, q.along) > 0.0;
            return Ok(Ok(Ramp { ends: if leaves { [*p, *q] } else { [*q, *p] }, bend }));
        }
        Ok(Err(hindrance))
    }

    /// The road along an edge from a crossing, with the places where ramps may end.
    fn arm(&self, node: usize, edge: usize, wanted: &[f64]) -> Result<Arm, Hindrance> {
        let longest = wanted.iter().copied().fold(0.0, f64::max);
        // A shorter stretch without junctions leaves room for the nearer places.
        let run = self.run(node, edge, longest + RUN_OUT);
        let clear = run.last().map_or(0.0, |last| last.along) - RUN_OUT;
        let line = std::iter::once(DVec2::ZERO).chain(run.iter().map(|v| self.net().step(node, v.node))).collect();
        let mut arm = Arm { run, line, ends: Vec::new() };
        let wanted = wanted.iter().filter(|far| **far <= clear);
        let ends = wanted.filter_map(|far| self.ramp_end(node, &arm, *far)).filter(|end| end.far <= clear);
        arm.ends = ends.collect();
        if arm.ends.is_empty() { Err(Hindrance::Junction) } else { Ok(arm) }
    }

    /// The place at a distance along an arm.
    fn ramp_end(&self, crossing: usize, arm: &Arm, far: f64) -> Option<RampEnd> {
        let net = self.net();
        let i = arm.run.iter().position(|v| v.along >= far)?;
        let (from, to) = (arm.line[i], arm.line[i + 1]);
        let length = from.distance(to);
        let start = arm.run[i].along - length;
        let along = (to - from) / length;
        let off_start = far - start;
        let vertex = |k: usize| {
            let v = arm.run.get(k).filter(|v| v.plain)?;
            let next = arm.line.get(k + 2)?;
            let bend = angle_between(arm.line[k + 1] - arm.line[k], *next - arm.line[k + 1]);
            let n = &net.nodes[v.node];
            let along = (arm.line[k + 1] - arm.line[k]).normalize_or_zero();
            let (at, key, position) = (arm.line[k + 1], n.key, n.position);
            (bend < STRAIGHT).then_some(RampEnd { edge: None, key, position, at, along, far: v.along })
        };
        let first = if i == 0 { crossing } else { arm.run[i - 1].node };
        let [a, b] = [first, arm.run[i].node].map(|n| net.nodes[n].key.ground_parts());
        let (a, b) = (a?, b?);
        let step = self.inputs.step();
        let origin = net.nodes[crossing].position;
        let place = |p: I64Vec2| {
            let key = Key::Ground { x: p.x, y: p.y };
            let position = key.position(step);
            (key, position, position.from(&origin))
        };
        let wanted = from + along * off_start;
        let exact = place(part_of_way(a, b, off_start / length));
        // A line whose ends are coprime holds no exact place: the road bends there by a part of a step.
        let rounded = place(a + ((b - a).as_dvec2() * (off_start / length)).round().as_i64vec2());
        let (key, position, at) = if exact.2.distance(wanted) <= OFF { exact } else { rounded };
        if at.distance(from) < OFF_VERTEX {
            return vertex(i.checked_sub(1)?);
        }
        if at.distance(to) < OFF_VERTEX {
            return vertex(i);
        }
        let far = start + at.distance(from);
        (at.distance(wanted) <= OFF).then_some(RampEnd { edge: Some(arm.run[i].edge), key, position, at, along, far })
    }

    /// Whether a road is dry around the end of a ramp.
    fn is_dry(&self, end: &RampEnd) -> bool {
        [-DRY, -DRY / 2.0, 0.0, DRY / 2.0, DRY].into_iter().all(|by| {
            let position = end.position.moved(end.along * by);
            self.inputs.terrain.sample(position.plan()).depth() <= 0.0
        })
    }
}

/// Whether a ramp meets the road that it joins only in its end there, wherever smoothing moves the road's vertices.
fn keeps_apart(ramp: &[DVec2], arm: &Arm, end: &RampEnd) -> bool {
    let crosses = |(a, b): (DVec2, DVec2)| {
        segments(ramp).any(|(p, q)| segment_crossing(a, b, p, q).is_some_and(|x| x.at.distance(end.at) > 1.0))
    };
    let clears = |w: &[DVec2]| {
        let corner = ((w[0] - w[1]) + (w[2] - w[1])).length();
        let apart = crate::space::distance_to_line(w[1], ramp);
        w[1].distance(end.at) < 1.0 || apart >= APART.0 + APART.1 * corner
    };
    !segments(&arm.line).any(crosses) && arm.line.windows(3).all(clears)
}
