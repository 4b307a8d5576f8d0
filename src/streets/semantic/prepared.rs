//! Filling a cell, step by step (Teng 2017, section 3).

use super::choice::PatchChoice;
use super::pattern::pattern_onwards;
use super::pinned::{PinnedPatch, lay_pinned, pieces_left_out};
use super::placer::Placer;
use super::start::start;
use crate::layer::{Cancel, LayerError, Weigh};
use crate::patch::PatchDatabase;
use crate::streets::cell::{Draft, finish, floating, lay_stubs, make_fair, propagate, repair};
use crate::streets::filler::{CellBrief, CellFiller, CellStreets, LeftOut};
use crate::style::StartRules;
use std::sync::Arc;

/// The name by which styles call this filler.
pub const NAME: &str = "SemanticPatches";

/// Patches chosen by their semantics (Teng 2017), prepared for one cell.
#[derive(Clone, Debug)]
pub struct PatchFiller {
    /// The patches that the cell's streets are made of.
    pub patches: Arc<PatchDatabase>,
    /// The weight of each in this cell, 0 for one that may not be chosen.
    pub weights: Vec<f64>,
    /// For each patch whether it is used once in the cell at most.
    pub once: Vec<bool>,
    /// How the cell is begun.
    pub start: StartRules,
    /// Patches that stand in the cell whatever grows around them. They keep to the border and to each other as streets do.
    pub pinned: Vec<PinnedPatch>,
    /// Pinned pieces that are none of `patches`, as indices into the list of pinned pieces.
    pub unknown: Vec<usize>,
}

impl PatchFiller {
    /// The filler of a cell in which no patch is pinned or counted over the town, and which begins as cells usually do; `weights` has
    /// the weight of each patch.
    pub fn new(patches: Arc<PatchDatabase>, weights: Vec<f64>) -> Self {
        let once = vec![false; weights.len()];
        Self { patches, weights, once, start: StartRules::default(), pinned: Vec::new(), unknown: Vec::new() }
    }

    /// The pieces that were left out, where `unfit` are indices into `pinned`.
    fn left_out(&self, unfit: &[usize]) -> Vec<LeftOut> {
        pieces_left_out(&self.pinned, unfit, &self.unknown, "is not among the patches of the styles there")
    }

    /// The names of the patches that stand because a style counts them, where `unfit` are indices into `pinned`.
    fn missing(&self, unfit: &[usize]) -> Vec<Arc<str>> {
        let counted = unfit.iter().map(|i| &self.pinned[*i]).filter(|pinned| pinned.piece.is_none());
        counted.filter_map(|pinned| self.patches.names().get(pinned.patch).cloned()).collect()
    }
}

impl CellFiller for PatchFiller {
    fn fill(&self, brief: &CellBrief<'_>, cancel: &Cancel) -> Result<CellStreets, LayerError> {
        let mut unfit = Vec::new();
        loop {
            let mut draft = Draft::new(brief);
            let mut placer = Placer::new(&draft, &self.patches, &self.weights, &self.once);
            let mut choice = PatchChoice::default();
            lay_stubs(&mut draft);
            let standing = lay_pinned(&mut draft, &mut placer, &self.pinned, &mut unfit);
            start(&mut draft, &mut placer, &self.start);
            cancel.check()?;
            propagate(&mut draft, cancel, |draft, v, at, direction| {
                draft.rng.chance(self.start.patterns_onwards) && pattern_onwards(draft, &mut placer, v, direction)
                    || choice.attach(draft, &mut placer, v, at, direction)
            })?;
            let anchors: Vec<_> = standing.iter().map(|s| s.vertex).collect();
            repair(&mut draft, &anchors, cancel)?;
            make_fair(&mut draft);
            let cut_off = floating(&draft, &anchors);
            if cut_off.is_empty() {
                let (left_out, missing) = (self.left_out(&unfit), self.missing(&unfit));
                let laid = placer.laid();
                return Ok(CellStreets { left_out, missing, laid, ..finish(&draft, NAME, self.patches.names()) });
            }
            // Nothing may float: once more without the patches that could not be reached.
            unfit.extend(cut_off.into_iter().map(|i| standing[i].index));
        }
    }
}

impl Weigh for PatchFiller {
    fn bytes(&self) -> usize {
        // The patches are shared by many cells.
        size_of::<Self>() + 9 * self.weights.len() + size_of::<PinnedPatch>() * self.pinned.len()
    }
}
