//! Pinned patches among tiles: they are laid first, and tiles fill the hole around them.

use crate::network::VertexIx;
use crate::patch::{PatchDatabase, PatchSet};
use crate::space::quantize;
use crate::streets::cell::Draft;
use crate::streets::filler::{LeftOut, PinnedPiece};
use crate::streets::semantic::{PinnedPatch, Placer, lay_pinned, pieces_left_out};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The patches that are pinned in a cell.
#[derive(Debug)]
pub struct Pins {
    patches: PatchDatabase,
    weights: Vec<f64>,
    once: Vec<bool>,
    pinned: Vec<PinnedPatch>,
    /// Pieces that are no patch which may be pinned, as indices into the list of pinned pieces.
    unknown: Vec<usize>,
}

/// Pinned patches that stand.
#[derive(Default)]
pub struct Standing {
    /// A vertex of each of their connected parts.
    pub anchors: Vec<VertexIx>,
    /// The patch of each part, as index into the list of pinned patches.
    of: Vec<usize>,
    /// How often each patch was laid, by name.
    pub laid: Vec<(Arc<str>, u32)>,
}

impl Pins {
    /// The patches for some pinned pieces, each from the first set by name that has it.
    pub fn new(pieces: &[PinnedPiece], sets: &BTreeMap<String, Arc<PatchSet>>) -> Self {
        let find = |piece: &PinnedPiece| {
            sets.values().find_map(|set| {
                let patch = set.patches.iter().find(|p| p.name == piece.piece && !p.is_in_pieces())?;
                Some((set, patch))
            })
        };
        let mut used: BTreeMap<&str, PatchSet> = BTreeMap::new();
        for (set, patch) in pieces.iter().filter_map(find) {
            let used = used.entry(&set.name).or_insert_with(|| PatchSet {
                name: set.name.clone(),
                patches: Vec::new(),
                patterns: Vec::new(),
            });
            if used.patches.iter().all(|p| p.name != patch.name) {
                used.patches.push(patch.clone());
            }
        }
        let patches = PatchDatabase::new(&used.values().collect::<Vec<_>>(), &[], &[]);
        let count = patches.patches.len();
        let (pinned, unknown) = (Vec::new(), Vec::new());
        let mut out = Self { weights: vec![0.0; count], once: vec![false; count], patches, pinned, unknown };
        for (index, piece) in pieces.iter().enumerate() {
            match out.patches.patches.iter().position(|p| p.name == piece.piece) {
                Some(patch) => out.pinned.push(PinnedPatch {
                    patch,
                    at: quantize(piece.at),
                    turned: piece.turned,
                    mirrored: piece.mirrored,
                    piece: Some(index),
                }),
                None => out.unknown.push(index),
            }
        }
        out
    }

    /// Names of the patches, in the order of the numbers that their streets are made by.
    pub fn names(&self) -> &[Arc<str>] {
        self.patches.names()
    }

    /// Lays the patches but those in `unfit`, to which the ones that do not fit are added.
    pub fn lay(&self, draft: &mut Draft<'_>, unfit: &mut Vec<usize>) -> Standing {
        let mut placer = Placer::new(draft, &self.patches, &self.weights, &self.once);
        let parts = lay_pinned(draft, &mut placer, &self.pinned, unfit);
        // Tiles lead streets to them; nothing grows from them before.
        draft.candidates.clear();
        let (anchors, of) = parts.into_iter().map(|part| (part.vertex, part.index)).unzip();
        Standing { anchors, of, laid: placer.laid() }
    }

    /// The patches of parts that no street could reach, as indices into the list of pinned patches.
    pub fn of(standing: &Standing, parts: Vec<usize>) -> impl Iterator<Item = usize> + '_ {
        parts.into_iter().map(|part| standing.of[part])
    }

    /// The pieces that were left out.
    pub fn left_out(&self, unfit: &[usize]) -> Vec<LeftOut> {
        pieces_left_out(&self.pinned, unfit, &self.unknown, "is no patch whose streets hang together")
    }
}
