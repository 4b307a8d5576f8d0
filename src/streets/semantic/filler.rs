//! The filler with the patches of all styles of a world. Prepared for the cells of a town, it has for each cell the patches of
//! the styles that are mixed there, their weights, and the patches that are pinned.

use super::counts::{CountedCell, share_out};
use super::find_place::find_place;
use super::pinned::PinnedPatch;
use super::prepared::PatchFiller;
use crate::layer::{LayerCache, LayerError, Weigh};
use crate::patch::{Patch, PatchDatabase, PatchSet};
use crate::space::quantize;
use crate::streets::filler::{CellFiller, CellToFill, FilledTown, Filler, TownToFill};
use crate::style::{self, Style};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Memory for the patches of mixed styles, in bytes.
const POOL_BYTES: usize = 32 << 20;

/// A style with the patches that it may use.
struct StyleKit {
    style: Arc<Style>,
    /// Its patch sets, in the order in which it names them.
    sets: Vec<Arc<PatchSet>>,
    /// The patches of these that its tags leave.
    patches: Arc<PatchDatabase>,
    /// The weight of each.
    weights: Vec<f64>,
}

impl StyleKit {
    fn new(style: &Arc<Style>, sets: &BTreeMap<String, Arc<PatchSet>>) -> Self {
        let sets: Vec<Arc<PatchSet>> = style.patch_sets.iter().filter_map(|name| sets.get(name).cloned()).collect();
        let used: Vec<&PatchSet> = sets.iter().map(|s| &**s).collect();
        let patches = PatchDatabase::new(&used, &style.allow, &style.exclude);
        let weights = patches.patches.iter().map(|p| weight_of(style, p)).collect();
        Self { style: style.clone(), sets, patches: Arc::new(patches), weights }
    }
}

/// How the tags of a patch keep a style from using it; `None` if they do not.
pub fn left_out_by(style: &Style, patch: &Patch) -> Option<String> {
    if let Some(tag) = style.exclude.iter().find(|tag| patch.tags.contains(*tag)) {
        return Some(format!("its tag `{tag}` is excluded"));
    }
    if patch.is_in_pieces() {
        return Some("its streets do not hang together".into());
    }
    let allowed = patch.is_allowed(&style.allow, &style.exclude);
    (!allowed).then(|| format!("it has none of the allowed tags `{}`", style.allow.join("`, `")))
}

/// Weight of a patch of one of the sets that a style uses: 0 if its tags rule it out.
pub fn weight_of(style: &Style, patch: &Patch) -> f64 {
    let factor = style.count_of(&patch.name).map_or(1.0, |c| c.weight);
    let is_usable = patch.is_allowed(&style.allow, &style.exclude) && !patch.is_in_pieces();
    if is_usable { patch.weight * factor } else { 0.0 }
}

/// The patches that several styles use, with the set that each is from.
struct Pool {
    patches: Arc<PatchDatabase>,
    sets: Vec<String>,
}

impl Weigh for Pool {
    fn bytes(&self) -> usize {
        self.patches.patches.iter().map(|p| 1000 + 200 * p.vertices.len()).sum()
    }
}

/// The default filler: patches chosen by their semantics (Teng 2017).
pub struct SemanticPatches {
    /// The styles that name this filler.
    kits: BTreeMap<String, StyleKit>,
    sets: BTreeMap<String, Arc<PatchSet>>,
    /// By names of styles, and of patch sets besides theirs.
    pools: LayerCache<(Vec<String>, Vec<String>), Pool>,
}

impl SemanticPatches {
    /// The filler for those of these styles that name it; styles and patch sets are given by name.
    pub fn new(styles: &BTreeMap<String, Arc<Style>>, sets: &BTreeMap<String, Arc<PatchSet>>) -> Self {
        let own = styles.iter().filter(|(_, style)| style.filler == style::Filler::SemanticPatches);
        let kits = own.map(|(name, style)| (name.clone(), StyleKit::new(style, sets))).collect();
        Self { kits, sets: sets.clone(), pools: LayerCache::new(POOL_BYTES) }
    }

    /// The patch set that has a patch: one of those of the cell's styles if there is one, else the first by name.
    fn set_with(&self, shares: &[(&StyleKit, f64)], patch: &str) -> Option<&PatchSet> {
        let has = |set: &&PatchSet| set.patches.iter().any(|p| p.name == patch);
        let own = shares.iter().flat_map(|(kit, _)| &kit.sets).map(|set| &set.name);
        own.chain(self.sets.keys()).filter_map(|name| self.sets.get(name)).map(|set| &**set).find(has)
    }

    /// The patches of a cell with their weights: those of its styles, and of the sets that have a pinned one.
    fn mix(&self, shares: &[(&StyleKit, f64)], cell: &CellToFill<'_>) -> Result<PatchFiller, LayerError> {
        let pinned = cell.pinned.iter().filter_map(|p| self.set_with(shares, &p.piece));
        let mut also: Vec<String> = pinned.map(|set| set.name.clone()).collect();
        also.sort();
        also.dedup();
        if let ([(kit, _)], []) = (shares, &also[..]) {
            return Ok(PatchFiller::new(kit.patches.clone(), kit.weights.clone()));
        }
        let key = (shares.iter().map(|(kit, _)| kit.style.name.clone()).collect(), also.clone());
        let pool = self.pools.get(&key, || Ok(self.pool(shares, &also)))?;
        let weight = |(patch, set): (&Arc<Patch>, &String)| {
            let of = |(kit, share): &(&StyleKit, f64)| {
                let uses = kit.style.patch_sets.contains(set);
                if uses { share * weight_of(&kit.style, patch) } else { 0.0 }
            };
            shares.iter().map(of).sum()
        };
        let weights = pool.patches.patches.iter().zip(&pool.sets).map(weight).collect();
        Ok(PatchFiller::new(pool.patches.clone(), weights))
    }

    fn pool(&self, shares: &[(&StyleKit, f64)], also: &[String]) -> Pool {
        let mut sets: BTreeMap<&str, &PatchSet> = BTreeMap::new();
        for set in shares.iter().flat_map(|(kit, _)| &kit.sets).chain(also.iter().filter_map(|s| self.sets.get(s))) {
            sets.insert(&set.name, set);
        }
        let of = |(name, set): (&&str, &&PatchSet)| std::iter::repeat_n((*name).to_owned(), set.patches.len());
        let names = sets.iter().flat_map(of).collect();
        let patches = PatchDatabase::new(&sets.values().copied().collect::<Vec<_>>(), &[], &[]);
        Pool { patches: Arc::new(patches), sets: names }
    }

    /// Prepares the filler for a cell as if it were alone; what is counted over a town is not yet shared out.
    fn prepare_cell(&self, cell: &CellToFill<'_>) -> Result<CountedCell, LayerError> {
        let own = |(style, share): &(Arc<Style>, f64)| Some((self.kits.get(&style.name)?, *share));
        let shares: Vec<(&StyleKit, f64)> = cell.styles.iter().filter_map(own).collect();
        let mut filler = PatchFiller { start: cell.style.start.clone(), ..self.mix(&shares, cell)? };
        for (index, piece) in cell.pinned.iter().enumerate() {
            match filler.patches.patches.iter().position(|p| p.name == piece.piece && !p.is_in_pieces()) {
                Some(patch) => filler.pinned.push(PinnedPatch {
                    patch,
                    at: quantize(piece.at),
                    turned: piece.turned,
                    mirrored: piece.mirrored,
                    piece: Some(index),
                }),
                None => filler.unknown.push(index),
            }
        }
        let styles = shares.iter().map(|(kit, _)| kit.style.clone()).collect();
        Ok(CountedCell { id: cell.brief.id, styles, filler })
    }
}

impl Filler for SemanticPatches {
    fn prepare(&self, town: &TownToFill<'_>) -> Result<FilledTown, LayerError> {
        let mut cells = Vec::with_capacity(town.cells.len());
        for cell in &town.cells {
            cells.push(self.prepare_cell(cell)?);
        }
        let short_counts = share_out(&town.styles, &mut cells, |cell, filler, patch| {
            find_place(&town.cells[cell].brief, filler, patch)
        });
        let fillers = cells.into_iter().map(|cell| Arc::new(cell.filler) as Arc<dyn CellFiller>).collect();
        Ok(FilledTown { fillers, short_counts })
    }

    fn has_piece(&self, name: &str) -> bool {
        self.sets.values().any(|set| set.patches.iter().any(|p| p.name == name && !p.is_in_pieces()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{PortCell, patch_sets, styles};

    #[test]
    fn a_cell_of_two_styles_has_the_patches_of_both_by_their_shares() {
        let styles = styles();
        let sets = patch_sets(&styles);
        let by_name: BTreeMap<_, _> = styles.iter().map(|s| (s.name.clone(), Arc::new(s.clone()))).collect();
        let semantic = SemanticPatches::new(&by_name, &sets);
        let cell = PortCell::new(1, &styles);
        let weights = |parts: &[(&str, f64)]| {
            let parts: Vec<_> = parts.iter().map(|(name, share)| (by_name[*name].clone(), *share)).collect();
            let to_fill = CellToFill { brief: cell.brief(), style: cell.style, styles: &parts, pinned: Vec::new() };
            let filler = semantic.prepare_cell(&to_fill).expect("nothing is cancelled").filler;
            assert_eq!(filler.weights.len(), filler.patches.patches.len());
            let names = filler.patches.names().iter().map(ToString::to_string);
            names.zip(filler.weights).filter(|(_, weight)| *weight > 0.0).collect::<BTreeMap<_, _>>()
        };
        let (grid, suburb) = (weights(&[("grid", 1.0)]), weights(&[("suburb", 1.0)]));
        let mixed = weights(&[("grid", 0.3), ("suburb", 0.7)]);
        let of = |weights: &BTreeMap<String, f64>, name: &String| weights.get(name).copied().unwrap_or_default();
        assert!(mixed.len() >= grid.len().max(suburb.len()) && mixed.values().sum::<f64>() > 5.0);
        for name in grid.keys().chain(suburb.keys()) {
            let expected = 0.3 * of(&grid, name) + 0.7 * of(&suburb, name);
            assert!((of(&mixed, name) - expected).abs() < 1e-9, "{name}");
        }
    }
}
