//! The placer lays patches: it knows their weights and uses, and settles the loose ends of placements.

use super::bend::Bending;
use super::placement::Placement;
use crate::network::VertexIx;
use crate::patch::{PatchDatabase, STRETCH, keeps_rules};
use crate::streets::cell::{Draft, Join, Maker, NONE, Proposal, joint_angle_fits};
use std::sync::Arc;

/// Lays patches in one cell.
pub struct Placer<'a> {
    /// The patches.
    pub patches: &'a PatchDatabase,
    /// The weight of each patch before it is used.
    weights: &'a [f64],
    /// Whether each patch is used once at most.
    once: &'a [bool],
    /// Whether each patch, as it is drawn, keeps to what the style asks.
    may_stand: Vec<bool>,
    /// How often each patch was used.
    used: Vec<u32>,
    /// The weight of each patch after these uses.
    weights_left: Vec<f64>,
    /// Greatest radius of a patch, in metres.
    pub largest: f64,
    /// Greatest distance that a patch can bridge, in metres.
    pub farthest: f64,
    /// How far patches are bent.
    pub bending: Bending,
    /// Buffer: the point of the proposal that each vertex of a patch became.
    slots: Vec<u32>,
}

impl<'a> Placer<'a> {
    /// A placer that has not used any patch yet; `weights` has the weight of each patch in the cell, and `once` says which are
    /// used once at most.
    pub fn new(draft: &Draft<'_>, patches: &'a PatchDatabase, weights: &'a [f64], once: &'a [bool]) -> Self {
        let longest = patches.patches.iter().filter_map(|p| p.pairs.last()).map(|p| p.distance);
        let mut placer = Self {
            patches,
            weights,
            once,
            may_stand: (0..patches.patches.len())
                .map(|p| patches.facts(p).shape.keeps(&draft.rules.drawings))
                .collect(),
            used: vec![0; patches.patches.len()],
            weights_left: Vec::new(),
            largest: patches.patches.iter().map(|p| p.radius).fold(0.0, f64::max),
            farthest: longest.fold(0.0, f64::max) * (1.0 + STRETCH),
            bending: Bending::new(draft.brief.field_kind, draft.rules.most_turn),
            slots: Vec::new(),
        };
        placer.weights_left = (0..patches.patches.len()).map(|p| placer.weight_after(p, 0)).collect();
        placer
    }

    /// Weight of a patch in choices.
    pub fn weight(&self, patch: usize) -> f64 {
        self.weights_left[patch]
    }

    /// Weight of a patch in choices after `count` uses. Every use lowers it. It is 0 once the patch was used as often as it may
    /// be, and for a patch whose drawing breaks the rules.
    fn weight_after(&self, patch: usize, count: u32) -> f64 {
        let most =
            self.patches.patches[patch].at_most.unwrap_or(u32::MAX).min(if self.once[patch] { 1 } else { u32::MAX });
        if count >= most || !self.may_stand[patch] { 0.0 } else { self.weights[patch] / (1.0 + 0.5 * f64::from(count)) }
    }

    /// The names of the patches that were used, each with the number of its uses.
    pub fn laid(&self) -> Vec<(Arc<str>, u32)> {
        let used = self.patches.names().iter().zip(&self.used).filter(|(_, uses)| **uses > 0);
        used.map(|(name, uses)| (name.clone(), *uses)).collect()
    }

    /// Counts one more use of a patch, which was just built.
    pub fn count_use(&mut self, draft: &mut Draft<'_>, patch: usize) {
        draft.has_rings |= self.patches.facts(patch).shape.round;
        self.used[patch] += 1;
        self.weights_left[patch] = self.weight_after(patch, self.used[patch]);
    }

    /// Counts the patch that was just built and makes its connectable ends candidates.
    pub fn after_patch(&mut self, draft: &mut Draft<'_>, patch: usize) {
        self.count_use(draft, patch);
        for (i, v) in draft.trial.built.iter().enumerate() {
            if draft.trial.proposal.joins[i] == Join::Free(true) {
                draft.canvas.nodes[*v as usize].wanted_degree = 2;
                draft.candidates.push_back(*v);
            }
        }
        draft.cross_over();
    }

    /// Builds the placement if it fits; returns whether it does.
    pub fn build_patch(&mut self, draft: &mut Draft<'_>, placement: &Placement, anchors: &[(usize, VertexIx)]) -> bool {
        self.propose_patch(draft, placement, anchors) && build_narrowed(draft, placement.patch)
    }

    /// Proposes the placement with its loose ends settled. `anchors` are the vertices of the patch that fall on vertices of the
    /// graph. False if an end cannot be settled or meets a street at a wrong angle.
    pub fn propose_patch(
        &mut self,
        draft: &mut Draft<'_>,
        placement: &Placement,
        anchors: &[(usize, VertexIx)],
    ) -> bool {
        self.propose(draft, placement, anchors, true)
    }

    /// Proposes the placement; without `check`, the angles at which its arms meet streets are not tested yet.
    pub fn propose(
        &mut self,
        draft: &mut Draft<'_>,
        placement: &Placement,
        anchors: &[(usize, VertexIx)],
        check: bool,
    ) -> bool {
        let anchor = |v: usize| anchors.iter().find(|a| a.0 == v).map(|a| a.1);
        let patch = &self.patches.patches[placement.patch];
        let shape = &self.patches.facts(placement.patch).shape;
        let mut p = std::mem::take(&mut draft.trial.proposal);
        p.clear();
        let mut slots = std::mem::take(&mut self.slots);
        slots.clear();
        slots.resize(patch.vertices.len(), NONE);
        let mut slot = |p: &mut Proposal, v: usize| {
            if slots[v] == NONE {
                slots[v] = p.points.len() as u32;
                let (at, join) = match anchor(v) {
                    Some(target) => (draft.canvas.graph.at(target), Join::At(target)),
                    None => (placement.map(patch.vertices[v]), Join::Free(false)),
                };
                p.push(at, join);
                p.shaped[slots[v] as usize] = shape.shaped[v];
            }
            slots[v] as usize
        };
        let mut line = std::mem::take(&mut draft.trial.line);
        let settled = |c: usize| anchor(c).is_none();
        for e in &shape.core {
            let edge = (slot(&mut p, e.0), slot(&mut p, e.1));
            p.edges.push(edge);
        }
        let mut fits = true;
        for arm in &shape.arms {
            let tip = arm[arm.len() - 1];
            // A street between two ends is an arm of both.
            let inner = arm[0];
            if shape.is_end[inner] && (inner > tip && settled(inner) || inner < tip && !settled(tip)) {
                continue;
            }
            if !settled(tip) {
                for w in arm.windows(2) {
                    let edge = (slot(&mut p, w[0]), slot(&mut p, w[1]));
                    p.edges.push(edge);
                }
                continue;
            }
            line.clear();
            line.extend(arm.iter().map(|v| placement.map(patch.vertices[*v])));
            let leaving = anchor(inner).unwrap_or(NONE);
            let Some(join) = draft.landing().settle(&mut line, leaving, &draft.rules.growth) else {
                fits = false;
                break;
            };
            let mut before = slot(&mut p, inner);
            let mut last = [before; 2];
            for (i, at) in line.iter().enumerate().skip(1) {
                let is_last = i + 1 == line.len();
                p.push(*at, if is_last { join } else { Join::Free(false) });
                let end = p.points.len() - 1;
                p.shaped[end] = !is_last && shape.shaped[arm[i]];
                p.edges.push((before, end));
                last = [before, end];
                before = end;
            }
            let (from, end) = (p.points[last[0]], p.points[last[1]]);
            fits = !check || joint_angle_fits(&draft.canvas, join, end, from - end, &draft.rules.growth);
            if !fits {
                break;
            }
        }
        (draft.trial.proposal, self.slots, draft.trial.line) = (p, slots, line);
        let (p, rules) = (&draft.trial.proposal, &draft.rules);
        fits && p.ends_keep_apart(&rules.repair)
            // What only its main street holds together must begin on the network in every part.
            && (shape.whole || p.every_part_is_joined())
            // Of three roots the middle one may be moved to its port.
            && (placement.is_as_drawn() && anchors.len() < 3 || keeps_rules(&p.points, &p.edges, 1.0, &rules.drawings))
    }
}

/// Builds the proposal of a patch if it fits, and looks only at the obstacles around it; returns whether it fits.
pub fn build_narrowed(draft: &mut Draft<'_>, patch: usize) -> bool {
    draft.trial.build_narrowed(&mut draft.canvas, &draft.rules.growth, Maker::Piece(patch as u32))
}

/// Builds the proposal of a patch if it fits among the gathered obstacles; returns whether it does.
pub fn build(draft: &mut Draft<'_>, patch: usize) -> bool {
    draft.trial.build_if_fits(&mut draft.canvas, &draft.rules.growth, Maker::Piece(patch as u32))
}
