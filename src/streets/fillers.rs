//! Which filler a style's `filler` stands for.

use super::filler::{CellFiller, CellToFill, FilledTown, Filler, TownToFill};
use super::parametric::Parametric;
use super::patchcity::PatchCity;
use super::semantic::SemanticPatches;
use crate::layer::LayerError;
use crate::patch::PatchSet;
use crate::style::{self, Style};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The fillers of a world, with the rules and assets that they need.
pub struct Fillers {
    semantic: SemanticPatches,
    parametric: Parametric,
    patchcity: PatchCity,
}

impl Fillers {
    /// The fillers for these styles and patch sets, both by name.
    pub fn new(styles: &BTreeMap<String, Arc<Style>>, sets: &BTreeMap<String, Arc<PatchSet>>) -> Self {
        Self {
            semantic: SemanticPatches::new(styles, sets),
            parametric: Parametric::default(),
            patchcity: PatchCity::new(styles, sets),
        }
    }

    fn of(&self, name: style::Filler) -> &dyn Filler {
        match name {
            style::Filler::SemanticPatches => &self.semantic,
            style::Filler::Parametric => &self.parametric,
            style::Filler::PatchCity(_) => &self.patchcity,
        }
    }

    /// Whether any filler has a piece of this name that can be pinned.
    pub fn has_piece(&self, name: &str) -> bool {
        style::Filler::ALL.iter().any(|filler| self.of(*filler).has_piece(name))
    }

    /// Prepares the fillers of a town's cells, each the one that the cell's style names, in the order of `cells`. `styles`
    /// are the styles of the town itself.
    pub fn prepare(&self, styles: &[&Style], cells: Vec<CellToFill<'_>>) -> Result<FilledTown, LayerError> {
        let mut short_counts = Vec::new();
        let mut out: Vec<Option<Arc<dyn CellFiller>>> = vec![None; cells.len()];
        let mut cells: Vec<(usize, CellToFill<'_>)> = cells.into_iter().enumerate().collect();
        for filler in style::Filler::ALL {
            let (here, rest) = cells.into_iter().partition(|(_, cell)| cell.style.filler.is(filler));
            cells = rest;
            let here: Vec<(usize, CellToFill<'_>)> = here;
            let (places, here): (Vec<usize>, Vec<CellToFill<'_>>) = here.into_iter().unzip();
            let prepared = self.of(filler).prepare(&TownToFill { styles: styles.to_vec(), cells: here })?;
            for (place, filler) in places.into_iter().zip(prepared.fillers) {
                out[place] = Some(filler);
            }
            short_counts.extend(prepared.short_counts);
        }
        Ok(FilledTown { fillers: out.into_iter().flatten().collect(), short_counts })
    }
}
