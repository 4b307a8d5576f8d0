//! Filling a cell, step by step (Teng 2017, section 3).

use super::choice::PatchChoice;
use super::pattern;
use super::pinned::lay_pinned;
use super::placer::Placer;
use super::start::start;
use crate::layer::{Cancel, LayerError};
use crate::streets::cell::{Draft, finish, floating, lay_stubs, make_fair, propagate, repair};
use crate::streets::filler::{CellBrief, CellFiller, CellStreets, MadeBy};

/// The default filler: patches chosen by their semantics (Teng 2017).
#[derive(Clone, Copy, Debug, Default)]
pub struct SemanticPatches;

impl CellFiller for SemanticPatches {
    fn fill(&self, brief: &CellBrief<'_>, cancel: &Cancel) -> Result<CellStreets, LayerError> {
        let mut unfit = Vec::new();
        loop {
            let mut draft = Draft::new(brief);
            let mut placer = Placer::new(&draft, brief.patches, brief.weights);
            let mut choice = PatchChoice::default();
            lay_stubs(&mut draft);
            let standing = lay_pinned(&mut draft, &mut placer, brief.pinned, &mut unfit);
            start(&mut draft, &mut placer);
            cancel.check()?;
            propagate(&mut draft, cancel, |draft, v, at, direction| {
                draft.rng.chance(pattern::ONWARDS) && pattern::pattern_onwards(draft, &mut placer, v, direction)
                    || choice.attach(draft, &mut placer, v, at, direction)
            })?;
            let anchors: Vec<_> = standing.iter().map(|s| s.vertex).collect();
            repair(&mut draft, &anchors, cancel)?;
            make_fair(&mut draft);
            let cut_off = floating(&draft, &anchors);
            if cut_off.is_empty() {
                return Ok(CellStreets { unfit, ..finish(&draft, MadeBy::Patch) });
            }
            // Nothing may float: once more without the patches that could not be reached.
            unfit.extend(cut_off.into_iter().map(|i| standing[i].index));
        }
    }
}
