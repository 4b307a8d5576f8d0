//! Proposals: streets that could be added, and the limits that they are held against.

use crate::network::{EdgeIx, VertexIx};
use crate::space::quantize;
use glam::DVec2;

/// How a point of a proposal meets what is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Join {
    /// It does not: a new vertex, and whether the network may go on from it.
    Free(bool),
    /// It is this vertex.
    At(VertexIx),
    /// It divides this edge.
    On(EdgeIx),
}

/// Streets that could be added.
#[derive(Clone, Debug, Default)]
pub(super) struct Proposal {
    /// Points.
    pub points: Vec<DVec2>,
    /// How each point meets what is there.
    pub joins: Vec<Join>,
    /// Straight edges between points.
    pub edges: Vec<(usize, usize)>,
}

impl Proposal {
    /// Empties it.
    pub fn clear(&mut self) {
        self.points.clear();
        self.joins.clear();
        self.edges.clear();
    }

    /// Adds a point.
    pub fn push(&mut self, at: DVec2, join: Join) {
        self.points.push(quantize(at));
        self.joins.push(join);
    }

    /// Makes it the street along `line`, of which the ends meet what is there as given.
    pub fn line(&mut self, line: &[DVec2], first: Join, last: Join) {
        self.clear();
        for (i, p) in line.iter().enumerate() {
            let join = if i == 0 {
                first
            } else if i + 1 == line.len() {
                last
            } else {
                Join::Free(false)
            };
            self.push(*p, join);
            if i > 0 {
                self.edges.push((i - 1, i));
            }
        }
    }

    /// Length of the shortest way from one point to another along its edges.
    pub fn way(&self, from: usize, to: usize) -> f64 {
        let mut far = vec![f64::INFINITY; self.points.len()];
        far[from] = 0.0;
        // A street has few edges, so that every round of this settles many points.
        for _ in 0..self.points.len() {
            let mut changed = false;
            for &(a, b) in &self.edges {
                let length = self.points[a].distance(self.points[b]);
                for (a, b) in [(a, b), (b, a)] {
                    if far[a] + length < far[b] {
                        (far[b], changed) = (far[a] + length, true);
                    }
                }
            }
            if !changed {
                break;
            }
        }
        far[to]
    }

    /// Whether a point meets what is there.
    pub fn joined(&self, point: usize) -> bool {
        !matches!(self.joins[point], Join::Free(_))
    }
}

/// What a proposal must keep to. Lengths in metres, angles in radians.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Distance from streets that it does not meet.
    pub gap: f64,
    /// Distance from the border.
    pub wall_gap: f64,
    /// Cosine of the least angle at a junction.
    pub junction_cosine: f64,
    /// Cosine of the least angle at a point of inflexion; -1 is straight on.
    pub bend_cosine: f64,
    /// Least length of a street between junctions.
    pub min_piece: f64,
    /// Greatest number of streets at a junction.
    pub max_degree: usize,
    /// Least way around a block.
    pub min_round: f64,
}

impl Limits {
    /// No street must keep farther away from anything than this.
    pub fn reach(&self) -> f64 {
        self.gap.max(self.wall_gap).max(20.0)
    }
}
