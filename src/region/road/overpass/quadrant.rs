//! The two-way ramp of a quadrant interchange.

use super::dimensions::{CLEAR, FARTHEST_RAMP, HALF_LENGTH, RAMP_ANGLE, RAMP_AT, RUN_OUT, longest_before};
use super::surroundings::{Cross, RunVertex, Surroundings};
use crate::layer::LayerError;
use crate::region::road::crossing::Hindrance;
use crate::space::math::angle_between;
use crate::space::{Bounds, orient, point_in_polygon, segment_distance};
use glam::DVec2;

impl Surroundings<'_> {
    /// Ends of the best ramp, on the highway and on the other road.
    pub fn two_way_ramp(&self, cross: &Cross) -> Result<Result<[usize; 2], Hindrance>, LayerError> {
        let net = self.net();
        let Cross { node, highway, upper } = *cross;
        let longest = longest_before(&self.inputs.settings);
        let mut hindrance = Hindrance::Angle;
        let mut scored: Vec<(f64, [usize; 2])> = Vec::new();
        for h in highway {
            let on_highway = self.run(node, h, RAMP_AT.1);
            for u in upper {
                let on_upper = self.run(node, u, HALF_LENGTH + RUN_OUT);
                for (i, p) in on_highway.iter().enumerate().filter(|(_, p)| p.plain && p.along >= RAMP_AT.0) {
                    for (k, q) in on_upper.iter().enumerate() {
                        let by = net.step(p.node, q.node);
                        let fits = q.plain && (HALF_LENGTH + RUN_OUT..FARTHEST_RAMP).contains(&q.along);
                        if !fits || p.along > FARTHEST_RAMP || by.length() > longest {
                            hindrance = hindrance.max(Hindrance::Junction);
                            continue;
                        }
                        let meets = |n: usize, by: DVec2| {
                            let angles = net.nodes[n].ways.iter().map(|e| angle_between(by, self.towards(n, *e)));
                            angles.fold(f64::INFINITY, f64::min)
                        };
                        let least = meets(p.node, by).min(meets(q.node, -by));
                        let own = [p, q].map(|end| net.step(node, end.node));
                        if least < RAMP_ANGLE {
                            continue;
                        }
                        if !self.are_own(node, &own)? {
                            hindrance = hindrance.max(Hindrance::Crossing);
                            continue;
                        }
                        if !self.is_empty(node, &on_highway[..=i], &on_upper[..=k])? {
                            hindrance = hindrance.max(Hindrance::Obstacle);
                            continue;
                        }
                        scored.push((by.length() - 200.0 * least.min(0.8), [p.node, q.node]));
                    }
                }
            }
        }
        let key = |n: &[usize; 2]| n.map(|n| net.nodes[n].key);
        scored.sort_by(|a, b| a.0.total_cmp(&b.0).then(key(&a.1).cmp(&key(&b.1))));
        for (_, ends) in scored {
            let rank = net.edges[upper[0]].rank.max(net.edges[upper[1]].rank);
            if self.rules.lets_through(ends[0], net.step(ends[0], ends[1]), Some(ends[1]), rank)? {
                return Ok(Ok(ends));
            }
            hindrance = Hindrance::Ground;
        }
        Ok(Err(hindrance))
    }

    /// Whether nothing lies between two roads from a vertex and the ramp that joins their ends.
    fn is_empty(&self, node: usize, p: &[RunVertex], q: &[RunVertex]) -> Result<bool, LayerError> {
        let net = self.net();
        let mut corners = vec![node];
        corners.extend(p.iter().map(|s| s.node));
        corners.extend(q.iter().rev().map(|s| s.node));
        let polygon: Vec<DVec2> = corners.iter().map(|n| net.step(node, *n)).collect();
        let [from, to] = [polygon[p.len()], polygon[p.len() + 1]];
        let bounds = Bounds::of(polygon.iter().copied()).moved(net.nodes[node].at).grown(CLEAR);
        for e in net.edges_in(bounds)? {
            let ends = net.edges[e].ends;
            let at = ends.map(|n| net.step(node, n));
            let inside = |i: usize| !corners.contains(&ends[i]) && point_in_polygon(at[i], &polygon);
            if inside(0) || inside(1) {
                return Ok(false);
            }
            let touches = ends.iter().filter(|n| corners.contains(n)).count();
            let of_ramp = ends.iter().any(|n| *n == corners[p.len()] || *n == corners[p.len() + 1]);
            if !of_ramp && touches < 2 && segment_distance(from, to, at[0], at[1]) < CLEAR {
                return Ok(false);
            }
            // A road that turns back would cross the ramp.
            let cuts = orient(from, to, at[0]) * orient(from, to, at[1]) < 0.0
                && orient(at[0], at[1], from) * orient(at[0], at[1], to) < 0.0;
            if cuts {
                return Ok(false);
            }
        }
        Ok(true)
    }
}
