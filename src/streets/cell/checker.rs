//! The check that every street passes before it is built, whether a piece, growth or repair proposes it (the connect and clip
//! checks of Teng 2017, section 3.3). Therefore the rules hold for the finished cell.

use super::canvas::Canvas;
use super::joint::{Joint, Reached, find_shared, joint_angle_fits, keeps_off_walls, on_one_street, parts_stay_apart};
use super::obstacle::{NONE, Neighbourhood, Obstacle, nearest, nearest_pairs};
use super::proposal::{Join, Proposal};
use super::rules::{Limits, NEAR_ALONG, WEDGE};
use crate::network::{STREET_FLOOR, VertexIx};
use crate::seam::APPROACH_LENGTH;
use crate::space::segment_crossing;
use glam::DVec2;

/// Least distance of a dead end from any street that it does not join, in metres.
pub const DEAD_END_FLOOR: f64 = 13.0;

/// Distance between the points of a street that are tested besides those at which it is nearest to another, in metres.
pub const BETWEEN: f64 = 6.0;

/// Tolerance in metres, larger than the rounding errors of distances.
const ROUNDING: f64 = 1e-6;

/// A point of a proposal's edge that may be too near to a point of an obstacle. Distances along the network decide.
struct Doubt {
    index: usize,
    obstacle: usize,
    q: DVec2,
    r: DVec2,
    kind: PointKind,
    distance: f64,
}

/// What the nearest point of an obstacle is near to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PointKind {
    /// A point of a street.
    Plain,
    /// A dead end.
    LooseEnd,
    /// A point between those at which streets are nearest to each other.
    Between,
}

/// Checks proposals, and keeps its buffers from one proposal to the next.
#[derive(Default)]
pub struct Checker {
    joints: Vec<Joint>,
    spare: Vec<Joint>,
    roots: Vec<u32>,
    degrees: Vec<u8>,
    frontier: Vec<(VertexIx, f64)>,
    doubts: Vec<Doubt>,
    /// For each edge and each vertex, the last search that saw it and its place in the results of that search.
    edges_seen: Vec<(u32, u32)>,
    vertices_seen: Vec<(u32, u32)>,
    search: u32,
}

impl Checker {
    /// Whether `p` may be built: it keeps to `limits` towards every obstacle in `near`, which must hold all obstacles within
    /// the gaps around it. Whether a proposal keeps the rules towards itself is not checked.
    pub fn check(&mut self, canvas: &Canvas, p: &Proposal, near: &Neighbourhood, limits: &Limits) -> bool {
        self.doubts.clear();
        // Ways along the network cost the most, and most proposals fail without.
        self.find_joints(canvas, p, limits)
            && (0..p.edges.len()).all(|i| self.edge_fits(canvas, p, i, near, limits))
            && self.joints_keep_ways(canvas, p, near, limits)
            && self
                .doubts
                .iter()
                .all(|d| d.distance >= self.needed(d.index, &near.obstacles[d.obstacle], d.q, d.r, d.kind, limits))
    }

    /// Finds the joints. False if one of them breaks a rule.
    fn find_joints(&mut self, canvas: &Canvas, p: &Proposal, limits: &Limits) -> bool {
        self.spare.append(&mut self.joints);
        self.roots.clear();
        self.roots.resize(p.edges.len(), 0);
        self.degrees.clear();
        self.degrees.resize(p.points.len(), 0);
        for (a, b) in &p.edges {
            self.degrees[*a] = self.degrees[*a].saturating_add(1);
            self.degrees[*b] = self.degrees[*b].saturating_add(1);
        }
        for point in 0..p.points.len() {
            if !p.joined(point) {
                continue;
            }
            if self.joints.len() >= 32 || self.degrees[point] != 1 {
                return false;
            }
            let mut joint = self.spare.pop().unwrap_or_default();
            (joint.point, joint.at, joint.is_port) = (point, p.points[point], false);
            (joint.vertex, joint.edge) = match p.joins[point] {
                Join::At(v) => (v, NONE),
                Join::On(e) => (NONE, e),
                Join::Free(_) => (NONE, NONE),
            };
            let same = |k: &Joint| {
                let apart = joint.at.distance(k.at);
                (joint.vertex != NONE && joint.vertex == k.vertex)
                    || apart < STREET_FLOOR
                    || apart < limits.min_piece && on_one_street(canvas, &joint, k)
            };
            let fits = !self.joints.iter().any(same) && self.joint_fits(canvas, p, &mut joint, limits);
            self.joints.push(joint);
            if !fits {
                return false;
            }
        }
        true
    }

    /// Measures distances along the network from the joints. False if a street that a joint divides breaks a rule, or if the
    /// way around a block is too short.
    fn joints_keep_ways(&mut self, canvas: &Canvas, p: &Proposal, near: &Neighbourhood, limits: &Limits) -> bool {
        // Of a way to what is too near as the crow flies no more than makes it far enough.
        let enough = |d: &Doubt| match d.kind {
            PointKind::Between => limits.clearance * NEAR_ALONG,
            _ if near.obstacles[d.obstacle].is_wall() => limits.wall_gap.max(30.0) / WEDGE,
            _ => limits.gap / WEDGE,
        };
        let gaps = self.doubts.iter().map(enough).fold(0.0, f64::max);
        // Of a way around a block the part along the network may be no longer than what the proposal leaves of it.
        let pairs = self.joints.iter().enumerate().flat_map(|(i, j)| self.joints[..i].iter().map(move |k| (j, k)));
        let through = pairs.map(|(j, k)| j.at.distance(k.at)).fold(f64::INFINITY, f64::min);
        let reach = gaps.max(limits.min_round - through + ROUNDING);
        let fits = self.joints.iter_mut().all(|joint| {
            let divides = joint.vertex == NONE || canvas.graph.degree(joint.vertex) == 2;
            (!divides || keeps_off_walls(joint, near)) && {
                find_shared(canvas, joint);
                !divides || parts_stay_apart(joint, near)
            }
        });
        // Ways are at least as long as straight lines, and so are only asked of joints that are near each other.
        if !fits || self.doubts.is_empty() && 2.0 * through >= limits.min_round + ROUNDING {
            return fits;
        }
        let mut joints = std::mem::take(&mut self.joints);
        joints.iter_mut().for_each(|joint| self.measure_around(canvas, joint, reach));
        self.joints = joints;
        self.joints.iter().enumerate().all(|(i, j)| {
            self.joints[..i].iter().all(|k| {
                let way = j.way_to(k, canvas);
                j.at.distance(k.at) + way >= limits.min_round || p.way(j.point, k.point) + way >= limits.min_round
            })
        })
    }

    /// Checks angles, degree and the lengths of the pieces at a joint, and marks the edges that lead to it.
    fn joint_fits(&mut self, canvas: &Canvas, p: &Proposal, joint: &mut Joint, limits: &Limits) -> bool {
        let g = &canvas.graph;
        let Some(first) = p.edges.iter().position(|(a, b)| *a == joint.point || *b == joint.point) else {
            return false;
        };
        let towards = |i: usize, from: usize| if p.edges[i].0 == from { p.edges[i].1 } else { p.edges[i].0 };
        let direction = p.points[towards(first, joint.point)] - joint.at;
        let bit = 1u32 << self.joints.len();
        let (mut at, mut edge, mut length) = (joint.point, first, 0.0);
        loop {
            self.roots[edge] |= bit;
            let next = towards(edge, at);
            length += p.points[at].distance(p.points[next]);
            at = next;
            if self.degrees[at] != 2 {
                break;
            }
            let mut on = p.edges.iter().enumerate().filter(|(_, (a, b))| *a == at || *b == at).map(|(i, _)| i);
            let (Some(one), Some(two)) = (on.next(), on.next()) else { break };
            edge = if one == edge { two } else { one };
            if self.roots[edge] & bit != 0 {
                break;
            }
        }
        // A street that goes on from the end of another is as long as both.
        let behind = |point: usize| match p.joins[point] {
            Join::At(v) if canvas.is_dead_end(v) => canvas.follow(v, g.edges_at(v)[0], |_| {}).1,
            _ => 0.0,
        };
        let may_go_on = self.degrees[at] == 1 && !matches!(p.joins[at], Join::Free(false));
        length += behind(at);
        let piece = |length: f64| length >= limits.min_piece;
        if !joint_angle_fits(canvas, p.joins[joint.point], joint.at, direction, limits) {
            return false;
        }
        if joint.vertex != NONE {
            let v = joint.vertex;
            let degree = g.degree(v);
            if canvas.nodes[v as usize].port.is_some() {
                joint.is_port = true;
                return piece(length);
            }
            if degree == 1 {
                return may_go_on || piece(length + behind(joint.point));
            }
            piece(length) && (degree > 2 || g.edges_at(v).iter().all(|e| piece(canvas.follow(v, *e, |_| {}).1)))
        } else {
            let e = g.edge(joint.edge);
            piece(length)
                && [e.a, e.b].into_iter().all(|end| {
                    let rest = if canvas.is_end(end) {
                        0.0
                    } else {
                        let next = g.edges_at(end).iter().copied().find(|x| *x != joint.edge);
                        next.map_or(0.0, |x| canvas.follow(end, x, |_| {}).1)
                    };
                    piece(g.at(end).distance(joint.at) + rest)
                })
        }
    }

    /// Measures the distances along the network from a joint, up to `reach` metres.
    fn measure_around(&mut self, canvas: &Canvas, joint: &mut Joint, reach: f64) {
        let g = &canvas.graph;
        joint.reached.clear();
        joint.ports.clear();
        self.frontier.clear();
        if joint.vertex != NONE {
            self.frontier.push((joint.vertex, 0.0));
        } else {
            let e = g.edge(joint.edge);
            self.frontier.extend([e.a, e.b].map(|end| (end, joint.at.distance(g.at(end)))));
        }
        self.search = self.search.wrapping_add(1);
        let search = self.search;
        if self.vertices_seen.len() < g.vertex_count() {
            self.vertices_seen.resize(g.vertex_count(), (0, 0));
        }
        for (i, (v, _)) in self.frontier.iter().enumerate() {
            self.vertices_seen[*v as usize] = (search, i as u32);
        }
        // Shortest paths over the few vertices in reach: each is settled when it is the nearest left.
        let mut settled = 0;
        while settled < self.frontier.len() {
            let rest = &self.frontier[settled..];
            let Some(least) = (0..rest.len()).min_by(|a, b| rest[*a].1.total_cmp(&rest[*b].1)) else { break };
            self.frontier.swap(settled, settled + least);
            for i in [settled, settled + least] {
                self.vertices_seen[self.frontier[i].0 as usize].1 = i as u32;
            }
            let (v, d) = self.frontier[settled];
            settled += 1;
            if canvas.nodes[v as usize].port.is_some() {
                joint.ports.push((g.at(v), d));
            }
            for &edge in g.edges_at(v) {
                let w = g.edge(edge).other(v);
                let far = d + g.at(v).distance(g.at(w));
                if self.edges_seen.len() <= edge as usize {
                    self.edges_seen.resize(edge as usize + 1, (0, 0));
                }
                let seen = &mut self.edges_seen[edge as usize];
                let known = if seen.0 == search { joint.reached.get_mut(seen.1 as usize) } else { None };
                match known {
                    Some(x) if x.va == v => x.from_a = x.from_a.min(d),
                    Some(x) => x.from_b = x.from_b.min(d),
                    None => {
                        *seen = (search, joint.reached.len() as u32);
                        joint.reached.push(Reached { edge, va: v, from_a: d, from_b: far });
                    }
                }
                if far > reach {
                    continue;
                }
                let seen = &mut self.vertices_seen[w as usize];
                if seen.0 == search {
                    let known = &mut self.frontier[seen.1 as usize].1;
                    *known = known.min(far);
                } else {
                    *seen = (search, self.frontier.len() as u32);
                    self.frontier.push((w, far));
                }
            }
        }
        joint.reached.sort_unstable_by_key(|x| x.edge);
    }

    /// Whether an edge of the proposal keeps its distance from all obstacles. If only distances along the network can tell,
    /// the pair of points is added to the doubts.
    fn edge_fits(
        &mut self,
        canvas: &Canvas,
        p: &Proposal,
        index: usize,
        near: &Neighbourhood,
        limits: &Limits,
    ) -> bool {
        let mut doubts = std::mem::take(&mut self.doubts);
        let fits = self.edge_may_fit(canvas, p, index, near, limits, &mut doubts);
        self.doubts = doubts;
        fits
    }

    fn edge_may_fit(
        &self,
        canvas: &Canvas,
        p: &Proposal,
        index: usize,
        near: &Neighbourhood,
        limits: &Limits,
        doubts: &mut Vec<Doubt>,
    ) -> bool {
        let (i, j) = p.edges[index];
        let (a, b) = (p.points[i], p.points[j]);
        let widest = limits.reach();
        let reach = |widest: f64| near.reach(a.min(b) - widest, a.max(b) + widest);
        // Streets may come nearer than walls.
        let (to_walls, to_streets) = (reach(widest), reach(limits.gap.max(20.0)));
        let open = |point: usize| !p.joined(point) && self.degrees[point] == 1;
        let (open_a, open_b) = (open(i), open(j));
        let far = (widest + ROUNDING) * (widest + ROUNDING);
        let step = b - a;
        let length = step.length();
        let (off, end) = (widest * length + ROUNDING, length * length);
        'obstacles: for (obstacle, s) in near.obstacles.iter().enumerate() {
            if !s.hull.overlaps(if s.is_wall() { to_walls } else { to_streets }) {
                continue;
            }
            // Beyond the same box turned along the edge.
            let (to_a, to_b) = (s.a - a, s.b - a);
            let (beside_a, beside_b) = (step.perp_dot(to_a), step.perp_dot(to_b));
            let (along_a, along_b) = (step.dot(to_a), step.dot(to_b));
            if beside_a.min(beside_b) > off
                || beside_a.max(beside_b) < -off
                || along_a.min(along_b) > end + off
                || along_a.max(along_b) < -off
            {
                continue;
            }
            let dead = |v: VertexIx| v != NONE && canvas.is_dead_end(v) && self.joints.iter().all(|j| j.vertex != v);
            let tip = |r: DVec2| {
                let may_go_on = |v: VertexIx, at: DVec2| r == at && dead(v) && canvas.nodes[v as usize].open;
                may_go_on(s.va, s.a) || may_go_on(s.vb, s.b)
            };
            for joint in self.joints.iter().filter(|x| x.point == i || x.point == j) {
                if joint.incident(s) {
                    // They meet at the joint, at an angle that was checked; only loose ends can be too near.
                    let (far, loose) = if joint.point == i { (b, open_b) } else { (a, open_a) };
                    if loose && nearest(far, s.a, s.b).distance(far) < DEAD_END_FLOOR {
                        return false;
                    }
                    for (v, at) in [(s.va, s.a), (s.vb, s.b)] {
                        if dead(v) && nearest(at, a, b).distance(at) < DEAD_END_FLOOR {
                            return false;
                        }
                    }
                    continue 'obstacles;
                }
                if joint.is_port && s.is_wall() && nearest(joint.at, s.a, s.b).distance(joint.at) < 0.01 {
                    // The main street that the port lies on.
                    let (far, loose) = if joint.point == i { (b, open_b) } else { (a, open_a) };
                    if (loose || far.distance(joint.at) > APPROACH_LENGTH) && loose_end_near(far, s) {
                        return false;
                    }
                    continue 'obstacles;
                }
            }
            if !s.lies_beside(a, b - a) && segment_crossing(a, b, s.a, s.b).is_some() {
                return false;
            }
            let loose = [open_a, open_b, dead(s.va), dead(s.vb)];
            let mut nearest_at = f64::INFINITY;
            for ((q, r), loose) in nearest_pairs((a, b), (s.a, s.b)).into_iter().zip(loose) {
                if q.distance_squared(r) > far {
                    continue;
                }
                let distance = q.distance(r);
                nearest_at = nearest_at.min(distance);
                // A street may pass a loose end that can be led into it.
                if distance >= widest || (distance >= limits.tip_gap && tip(r)) {
                    continue;
                }
                let kind = if loose { PointKind::LooseEnd } else { PointKind::Plain };
                if distance >= surely_enough(s, kind, limits) {
                    continue;
                }
                if distance < self.surely_needed(index, s, q, r, kind, limits) - ROUNDING {
                    return false;
                }
                doubts.push(Doubt { index, obstacle, q, r, kind, distance });
            }
            // What is near at one end, near to where both lead, may be too near beyond.
            let parts = if nearest_at < limits.clearance { (length / BETWEEN).ceil() as usize } else { 0 };
            for k in 1..parts {
                let q = a + step * (k as f64 / parts as f64);
                let r = nearest(q, s.a, s.b);
                let distance = q.distance(r);
                if distance < limits.clearance {
                    doubts.push(Doubt { index, obstacle, q, r, kind: PointKind::Between, distance });
                }
            }
        }
        true
    }

    /// A lower bound of [`needed`](Self::needed): distances along the network are at least straight distances.
    fn surely_needed(&self, index: usize, s: &Obstacle, q: DVec2, r: DVec2, kind: PointKind, limits: &Limits) -> f64 {
        let mut along = f64::INFINITY;
        let mut from_port = false;
        for (k, joint) in self.joints.iter().enumerate() {
            let away = q.distance(joint.at);
            if away < 1e-3 {
                return 0.0;
            }
            along = along.min(away + joint.at.distance(r));
            from_port |= self.roots[index] & (1 << k) != 0 && joint.is_port && away < APPROACH_LENGTH;
        }
        let floor = if s.is_wall() { s.floor } else { STREET_FLOOR };
        let loosely = if s.is_wall() { from_port } else { self.roots[index] != 0 };
        let base = if s.is_wall() { limits.wall_gap.max(s.floor) } else { limits.gap };
        let needed = base.min(WEDGE * along).max(if loosely { 0.0 } else { floor });
        needed.max(least_at(s, kind))
    }

    /// Distance in metres that the point `q` of the proposal's edge `index` must keep from the point `r` of an obstacle.
    fn needed(&self, index: usize, s: &Obstacle, q: DVec2, r: DVec2, kind: PointKind, limits: &Limits) -> f64 {
        let mut along = f64::INFINITY;
        let (mut shared, mut from_port) = (false, false);
        for (k, joint) in self.joints.iter().enumerate() {
            let away = q.distance(joint.at);
            if away < 1e-3 {
                return 0.0;
            }
            along = along.min(away + joint.along(s, r));
            let root = self.roots[index] & (1 << k) != 0;
            shared |= root && joint.shared.contains(&s.edge);
            from_port |= root && joint.is_port && away < APPROACH_LENGTH;
        }
        if kind == PointKind::Between {
            return limits.clearance.min(along / NEAR_ALONG);
        }
        let base = if s.is_wall() { limits.wall_gap.max(s.floor) } else { limits.gap };
        let mut needed = base.min(WEDGE * along);
        if s.is_wall() {
            if !from_port {
                needed = needed.max(s.floor);
            }
        } else if !shared {
            needed = needed.max(STREET_FLOOR);
        }
        needed.max(least_at(s, kind))
    }
}

/// Distance in metres that is kept at a point in any case.
fn least_at(s: &Obstacle, kind: PointKind) -> f64 {
    match kind {
        PointKind::LooseEnd if s.is_wall() => s.floor,
        PointKind::LooseEnd => DEAD_END_FLOOR,
        PointKind::Plain | PointKind::Between => 0.0,
    }
}

/// An upper bound of [`Checker::needed`]: the distance that streets keep if they are far apart along the network.
fn surely_enough(s: &Obstacle, kind: PointKind, limits: &Limits) -> f64 {
    let enough = if s.is_wall() { limits.wall_gap.max(s.floor) } else { limits.gap.max(STREET_FLOOR) };
    enough.max(least_at(s, kind))
}

fn loose_end_near(end: DVec2, s: &Obstacle) -> bool {
    nearest(end, s.a, s.b).distance(end) < s.floor
}
