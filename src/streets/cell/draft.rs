//! A cell while it is being filled: the parts that every step of a filler works with.

use super::canvas::{Canvas, Maker};
use super::checker::Checker;
use super::landing::Landing;
use super::obstacle::{Neighbourhood, Obstacle};
use super::proposal::{Join, Proposal};
use super::rules::{CellRules, Limits};
use crate::network::VertexIx;
use crate::space::{Bounds, Stream};
use crate::streets::filler::CellBrief;
use glam::DVec2;
use std::collections::VecDeque;

/// A proposal under trial: the streets that may be built, what is around them, and the vertices that they became.
#[derive(Default)]
pub struct Trial {
    /// The streets that may be built next.
    pub proposal: Proposal,
    /// The obstacles that it is held against.
    pub near: Neighbourhood,
    /// While the view is narrowed to a proposal, the obstacles that were gathered before.
    wider: Neighbourhood,
    /// The vertices of the proposal that was built last, by its points.
    pub built: Vec<VertexIx>,
    /// A street of which it is being found where it ends.
    pub line: Vec<DVec2>,
    checker: Checker,
}

impl Trial {
    /// Builds the proposal on `canvas` if it keeps to `limits` towards what is near.
    pub fn build_if_fits(&mut self, canvas: &mut Canvas, limits: &Limits, maker: Maker) -> bool {
        let fits = self.checker.check(canvas, &self.proposal, &self.near, limits);
        if fits {
            canvas.build(&self.proposal, maker, &mut self.built);
        }
        fits
    }

    /// Builds the proposal on `canvas` if it keeps to `limits` towards what is near, of which no more is looked at than
    /// what lies around the proposal.
    pub fn build_narrowed(&mut self, canvas: &mut Canvas, limits: &Limits, maker: Maker) -> bool {
        let bounds = Bounds::of(self.proposal.points.iter().copied()).grown(limits.reach() + 1.0);
        self.swap_view();
        canvas.gather_obstacles(bounds, &mut self.near);
        self.near.loose_ends.clear();
        self.near.loose_ends.extend(self.wider.loose_ends.iter().filter(|t| bounds.contains(t.at)));
        let fits = self.build_if_fits(canvas, limits, maker);
        self.swap_view();
        fits
    }

    /// Narrows the view to the obstacles that `keep` holds for; [`swap_view`](Self::swap_view) goes back to all of them.
    pub fn narrow(&mut self, keep: impl Fn(&Obstacle) -> bool) {
        self.swap_view();
        (self.near.origin, self.near.within) = (self.wider.origin, self.wider.within);
        self.near.obstacles.clear();
        self.near.loose_ends.clone_from(&self.wider.loose_ends);
        self.near.obstacles.extend(self.wider.obstacles.iter().filter(|s| keep(s)));
    }

    /// Exchanges the narrow view and the wider one.
    pub fn swap_view(&mut self) {
        std::mem::swap(&mut self.near, &mut self.wider);
    }
}

/// A cell while it is being filled.
pub struct Draft<'a> {
    /// What is to be filled.
    pub brief: &'a CellBrief<'a>,
    /// What is asked of its streets.
    pub rules: CellRules,
    /// The streets that are built.
    pub canvas: Canvas,
    /// The streets that may be built next.
    pub trial: Trial,
    /// The cell's random choices.
    pub rng: Stream,
    /// Whether a piece with a roundabout was laid: its ring is looked for when the cell is finished.
    pub has_rings: bool,
    /// Candidate vertices of the propagation, in the order in which it comes to them.
    pub candidates: VecDeque<VertexIx>,
}

impl<'a> Draft<'a> {
    /// The empty cell: a vertex at each port, and no street.
    pub fn new(brief: &'a CellBrief<'a>) -> Self {
        let rules = CellRules::new(brief);
        Self {
            brief,
            canvas: Canvas::new(brief, f64::from(rules.growth.coarse_gap())),
            rules,
            trial: Trial::default(),
            rng: brief.seed.stream("streets", &[brief.id.0]),
            has_rings: false,
            candidates: VecDeque::new(),
        }
    }

    /// Collects the obstacles within `reach` metres of a point.
    pub fn gather(&mut self, at: DVec2, reach: f64) {
        self.canvas.gather(Bounds::of([at]), reach, &mut self.trial.near);
    }

    /// How streets end among what was gathered.
    pub fn landing(&self) -> Landing<'_> {
        Landing {
            canvas: &self.canvas,
            near: &self.trial.near,
            snap_radius: self.rules.local.snap_radius,
            straightness: self.rules.straightness,
        }
    }

    /// Builds the proposal if it keeps to `limits` towards what was gathered.
    pub fn build_if_fits(&mut self, limits: &Limits, maker: Maker) -> bool {
        self.trial.build_if_fits(&mut self.canvas, limits, maker)
    }

    /// Makes some of the T junctions that were just built candidates, so that streets go on across the one they met.
    pub fn cross_over(&mut self) {
        let (least, most) = self.rules.local.degree;
        let crossings = if least >= 4 { 1.0 } else { self.rules.crossings };
        for i in 0..self.trial.built.len() {
            if most >= 4 && matches!(self.trial.proposal.joins[i], Join::On(_)) && self.rng.chance(crossings) {
                self.canvas.nodes[self.trial.built[i] as usize].wanted_degree = 4;
                self.candidates.push_back(self.trial.built[i]);
            }
        }
    }
}
