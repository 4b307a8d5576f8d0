//! The default filler: patches chosen by their semantics (Teng 2017, section 3), with parametric growth as fall-back and
//! a repair pass.

mod bands;
mod bend;
mod canvas;
mod checker;
mod coarse;
mod fairing;
mod free;
mod growth;
mod joint;
mod near;
mod output;
mod patches;
mod pattern;
mod pinned;
mod place;
mod proposal;
mod refit;
mod repair;
mod round;
#[cfg(test)]
mod sample;
mod squares;
mod start;
#[cfg(test)]
mod tests;

pub use pinned::find_place;

use crate::layer::{Cancel, LayerError};
use crate::network::VertexIx;
use crate::patch::STRETCH;
use crate::space::{Bounds, Stream, math};
use crate::streets::{CellBrief, CellFiller, CellStreets, MadeBy};
use crate::style::FieldKind;
use canvas::Canvas;
use checker::Checker;
use glam::DVec2;
use near::{Near, Seg};
use patches::{Bridge, Ranked};
use pinned::Laid;
use proposal::{Join, Limits, Proposal};
use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The default filler: patches chosen by their semantics (Teng 2017).
#[derive(Clone, Copy, Debug, Default)]
pub struct SemanticPatches;

impl CellFiller for SemanticPatches {
    fn fill(&self, brief: &CellBrief<'_>, cancel: &Cancel) -> Result<CellStreets, LayerError> {
        let mut unfit = Vec::new();
        loop {
            let mut work = Work::new(brief);
            work.lay_stubs();
            work.lay_pinned(&mut unfit);
            work.start();
            cancel.check()?;
            work.propagate(cancel)?;
            work.repair(cancel)?;
            work.make_fair();
            let cut_off = work.cut_off();
            if cut_off.is_empty() {
                return Ok(CellStreets { unfit, ..work.finish() });
            }
            // Nothing may float: once more without the patches that could not be reached.
            unfit.extend(cut_off);
        }
    }
}

/// A cell while it is being filled.
struct Work<'a> {
    brief: &'a CellBrief<'a>,
    canvas: Canvas,
    checker: Checker,
    rng: Stream,
    /// Candidate vertices of the propagation.
    queue: VecDeque<VertexIx>,
    /// Least angle at a junction in the propagation, in radians.
    min_angle: f64,
    /// Rules of the propagation.
    limits: Limits,
    /// Rules of the repair: as near as streets may ever come.
    relaxed: Limits,
    /// Least cosine of the bend where a street goes on as another.
    straightness: f64,
    /// Greatest angle by which a street may turn where another goes on from it, in radians.
    most_turn: f64,
    /// Greatest angle by which a patch is bent at an end, in radians.
    bending: f64,
    /// Share of T junctions that growth goes on from, across the street that was met.
    crossings: f64,
    /// How much the field draws streets: 0 not at all, 1 wholly.
    field_pull: f64,
    /// Dead-end streets shorter than this that do not start at a port are removed.
    stump: f64,
    /// Greatest distance of a street that is straightened from straight, in metres; 0 where streets may wind.
    dogleg: f64,
    /// How often each patch was used.
    used: Vec<u32>,
    /// Weight of each patch in choices after these uses.
    weights: Vec<f64>,
    /// Greatest radius of a patch.
    largest: f64,
    /// Greatest distance that a patch can bridge.
    farthest: f64,
    /// Pinned patches that stand.
    laid: Vec<Laid>,
    near: Near,
    /// Obstacles around one placement.
    around: Near,
    proposal: Proposal,
    /// Proposals to choose from.
    ranked: Vec<Ranked>,
    /// Patches to propose, by a key that grows with the wish for them.
    order: Vec<u64>,
    /// Placements between two vertices to choose from.
    bridges: Vec<Bridge>,
    /// Loose ends that may be reached, with their distances.
    targets: Vec<(f64, VertexIx)>,
    built: Vec<VertexIx>,
    /// Point of the proposal that a vertex of a patch became.
    slots: Vec<u32>,
    /// An arm of a patch that is being settled.
    line: Vec<DVec2>,
}

impl<'a> Work<'a> {
    fn new(brief: &'a CellBrief<'a>) -> Self {
        let local = &brief.style.local;
        let min_angle = local.min_angle_deg.to_radians().max(0.7);
        // Blocks much narrower than the style's streets are long look pinched.
        let share = match brief.style.main.field {
            FieldKind::Grid => 0.6,
            FieldKind::Radial => 0.68,
            FieldKind::Organic | FieldKind::Contours => 0.55,
        };
        let gap = local.clearance.max(share * local.length);
        let limits = Limits {
            gap,
            wall_gap: gap,
            junction_cosine: math::cos(min_angle),
            bend_cosine: math::cos(1.75),
            min_piece: local.min_length.clamp(18.0, 40.0),
            max_degree: (local.degree.1 as usize).clamp(3, 5),
            min_round: 3.0 * local.length,
        };
        let relaxed = Limits {
            gap: 20.0_f64.min(limits.gap),
            wall_gap: 30.0_f64.min(limits.wall_gap),
            junction_cosine: math::cos(min_angle.min(0.75)),
            bend_cosine: math::cos(1.45),
            min_piece: 16.0,
            max_degree: limits.max_degree.max(4),
            min_round: 2.6 * local.length,
        };
        let asked = coarse::coarse_gap(&limits);
        let (straightness, bending, crossings, field_pull, stump, dogleg) = match brief.style.main.field {
            FieldKind::Grid => (0.98, 0.05, 0.75, 1.0, 1.1, 16.0),
            FieldKind::Radial => (0.88, 0.2, 0.4, 0.9, 0.9, 16.0),
            FieldKind::Contours => (0.82, 0.2, 0.25, 0.75, 0.5, 0.0),
            FieldKind::Organic => (0.75, 0.2, 0.2, 0.5, 0.8, 0.0),
        };
        let patches = &brief.patches.patches;
        let longest = patches.iter().filter_map(|p| p.pairs.last()).map(|p| p.distance);
        Self {
            brief,
            canvas: Canvas::new(brief, f64::from(asked)),
            checker: Checker::default(),
            rng: brief.seed.stream("streets", &[brief.id.0]),
            queue: VecDeque::new(),
            min_angle,
            limits,
            relaxed,
            straightness,
            most_turn: math::acos(straightness),
            bending,
            crossings,
            field_pull,
            stump: stump * local.length,
            dogleg,
            used: vec![0; patches.len()],
            weights: (0..patches.len()).map(|p| patches::weight(brief, p, 0)).collect(),
            largest: patches.iter().map(|p| p.radius).fold(0.0, f64::max),
            farthest: longest.fold(0.0, f64::max) * (1.0 + STRETCH),
            laid: Vec::new(),
            near: Near::default(),
            around: Near::default(),
            proposal: Proposal::default(),
            ranked: Vec::new(),
            order: Vec::new(),
            bridges: Vec::new(),
            targets: Vec::new(),
            built: Vec::new(),
            slots: Vec::new(),
            line: Vec::new(),
        }
    }

    /// Network propagation (Teng 2017, algorithm 1).
    fn propagate(&mut self, cancel: &Cancel) -> Result<(), LayerError> {
        let mut steps = 0usize;
        while let Some(v) = self.queue.pop_front() {
            steps += 1;
            if steps.is_multiple_of(16) {
                cancel.check()?;
            }
            let degree = self.canvas.graph.degree(v);
            if degree == 0 || degree >= self.limits.max_degree || !self.canvas.nodes[v as usize].open {
                continue;
            }
            let Some(direction) = self.direction(v) else { continue };
            let at = self.canvas.graph.at(v);
            let made = degree == 1
                && (self.rng.chance(pattern::ONWARDS) && self.pattern_onwards(v, direction)
                    || self.attach_patch(v, at, direction));
            if !made {
                self.grow(v, at, direction);
            }
        }
        Ok(())
    }

    /// Propagation direction of a vertex: the bisector of the largest angle between its streets (Teng 2017, Fig. 6),
    /// drawn towards the nearest direction of the field. `None` where no street fits between the others.
    fn direction(&mut self, v: VertexIx) -> Option<DVec2> {
        let g = &self.canvas.graph;
        let at = g.at(v);
        let mut angles: Vec<f64> = g.neighbours(v).map(|w| math::angle_of(g.at(w) - at)).collect();
        angles.sort_by(f64::total_cmp);
        let n = angles.len();
        let gap = |i: usize| if i + 1 < n { angles[i + 1] - angles[i] } else { angles[0] + TAU - angles[i] };
        let widest = (0..n).max_by(|a, b| gap(*a).total_cmp(&gap(*b)))?;
        if gap(widest) < 2.0 * self.min_angle {
            return None;
        }
        let bisector = angles[widest] + gap(widest) / 2.0;
        let off = self.brief.field.angle(at) - bisector;
        let off = off - (off / FRAC_PI_2).round() * FRAC_PI_2;
        // A street never bends more at once than this to follow the field.
        let most = if n == 1 { 0.16 } else { gap(widest) / 2.0 - self.min_angle };
        Some(math::direction(bisector + (off * self.field_pull).clamp(-most.min(PI / 4.0), most.min(PI / 4.0))))
    }

    /// Collects the obstacles around a point.
    fn gather(&mut self, at: DVec2, reach: f64) {
        self.canvas.gather(Bounds::of([at]), reach, &mut self.near);
    }

    /// First obstacle within what was gathered that the segment `from`-`to` meets, as [`Canvas::ray`].
    fn ray(&self, from: DVec2, to: DVec2, leaving: VertexIx) -> Option<(Seg, f64, DVec2)> {
        if self.near.segs.is_empty() {
            // Only dead ends were.
            self.canvas.ray(from, to, leaving, self.near.within)
        } else {
            self.near.ray(from, to, leaving)
        }
    }

    /// Builds the proposal if it keeps to `limits` towards what is in `near`.
    fn build_if_fits(&mut self, limits: &Limits, made_by: MadeBy) -> bool {
        let fits = self.checker.check(&self.canvas, &self.proposal, &self.near, limits);
        if fits {
            self.canvas.build(&self.proposal, made_by, &mut self.built);
        }
        fits
    }

    /// Makes some of the T junctions that were just built candidates, so that streets go on across the one they met.
    fn cross_over(&mut self) {
        for i in 0..self.built.len() {
            if matches!(self.proposal.joins[i], Join::On(_)) && self.rng.chance(self.crossings) {
                self.canvas.nodes[self.built[i] as usize].target = 4;
                self.queue.push_back(self.built[i]);
            }
        }
    }
}
