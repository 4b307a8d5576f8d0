//! Settlements too small for the lattice: a settlement whose disc would be smaller than 1.5 steps is a node. Roads end
//! at its centre.
//!
//! The centre is joined to the nodes around it by ties, all with the centre as their gate. Lattice edges that would come near
//! a tie other than at its end are closed, and so are those that pass by the centre: who goes through, goes through the
//! settlement.

use super::Finite;
use crate::layer::LayerError;
use crate::region::Settlement;
use crate::region::road::Work;
use crate::region::road::lattice::{STENCIL, node_at, node_near};
use crate::region::road::search::Window;
use crate::region::road::site::{Site, Tie};
use crate::space::{distance_to_segment, math::angle_between, segment_distance};
use glam::{DVec2, I64Vec2};

/// Least and greatest length of a tie, in steps: wherever the centre is, four nodes or more lie between the two. Nothing
/// passes a centre nearer than the first.
const TIE: (f64, f64) = (0.35, 1.3);
/// Distance in steps that ties keep from each other and from edges that they do not meet.
const CLEAR: f64 = 0.1;
/// Least angle between a tie and an edge at its end.
const LEAST_ANGLE: f64 = 0.4;
/// How far around the centre edges may be closed, in steps: an edge is two long, and so a tie's length more may be.
const AROUND: i64 = 4;

impl Finite {
    /// Ties of a settlement that is a node, and the edges that it closes.
    pub fn site(&self, work: &Work, s: &Settlement) -> Result<Site, LayerError> {
        let step = work.settings.step;
        let centre = s.centre.plan();
        let ends: Vec<DVec2> = self.tie_ends(work, s).iter().map(|n| node_at(*n, step) - centre).collect();
        let free = |end: &DVec2| {
            self.nodes_near(s, AROUND as f64 * step as f64).all(|other| {
                let shift = s.centre.offset_to(other.centre);
                // Of two ties in each other's way, that of the settlement with the higher id goes.
                let theirs = if other.id < s.id { self.tie_ends(work, other) } else { Vec::new() };
                theirs.iter().map(|n| node_at(*n, step) - other.centre.plan()).all(|their| {
                    their == *end + shift
                        || segment_distance(DVec2::ZERO, their, shift, *end + shift) > CLEAR * step as f64
                })
            })
        };
        let free: Vec<DVec2> = ends.into_iter().filter(free).collect();
        let ties = free.iter().map(|end| Tie {
            vertex: 0,
            gate: DVec2::ZERO,
            node: node_near(centre + *end, step),
            way: end.length(),
        });
        let near = node_near(centre, step);
        let window = Window { min: near - AROUND, size: I64Vec2::splat(2 * AROUND + 1) };
        let closed = (0..window.len()).map(|index| {
            let node = window.node(index);
            let closes = |s: &I64Vec2| is_closed(node_at(node, step) - centre, node_at(node + *s, step) - centre, &free, step);
            STENCIL.iter().enumerate().fold(0, |bits, (heading, s)| bits | u16::from(closes(s)) << heading)
        });
        Ok(Site { ties: ties.collect(), window, closed: closed.collect() })
    }

    /// Nodes that ties may lead to: at the right distance, in the domain, off other centres, and dry if any are.
    fn tie_ends(&self, work: &Work, s: &Settlement) -> Vec<I64Vec2> {
        let (step, centre) = (work.settings.step, s.centre.plan());
        let steps = step as f64;
        let near = node_near(centre, step);
        let around = (0..25).map(|i| near + I64Vec2::new(i % 5 - 2, i / 5 - 2));
        let fits = |node: &I64Vec2| {
            let end = node_at(*node, step) - centre;
            (TIE.0 * steps..=TIE.1 * steps).contains(&end.length())
                && self.bounds.contains(node_at(*node, step))
                && self.nodes_near(s, 3.0 * steps).all(|other| {
                    distance_to_segment(other.centre.offset_to(s.centre), DVec2::ZERO, end) >= TIE.0 * steps
                })
        };
        let all: Vec<I64Vec2> = around.filter(fits).collect();
        let is_dry = |node: &&I64Vec2| work.terrain.sample(node_at(**node, step)).depth() == 0.0;
        let dry: Vec<I64Vec2> = all.iter().filter(is_dry).copied().collect();
        if dry.is_empty() { all } else { dry }
    }

    /// Other settlements that are nodes, with centres within `distance` metres.
    fn nodes_near<'a>(&'a self, s: &'a Settlement, distance: f64) -> impl Iterator<Item = &'a Settlement> {
        let near = move |o: &&Settlement| o.id != s.id && o.centre.offset_to(s.centre).length() <= distance;
        self.places.all.iter().map(|o| &**o).filter(|o| self.is_node(o)).filter(near)
    }
}

/// Whether the edge from `p` to `q` is closed by a centre at (0, 0) or by one of its ties to `ends`.
fn is_closed(p: DVec2, q: DVec2, ends: &[DVec2], step: i64) -> bool {
    let steps = step as f64;
    let comes_near = |end: &DVec2| match [(p, q), (q, p)].into_iter().find(|(a, _)| a == end) {
        Some((_, far)) => angle_between(-*end, far - *end) < LEAST_ANGLE,
        None => segment_distance(p, q, DVec2::ZERO, *end) < CLEAR * steps,
    };
    distance_to_segment(DVec2::ZERO, p, q) < TIE.0 * steps || ends.iter().any(comes_near)
}
