//! Patches that a style counts over a whole town, shared out over its main cells.

use super::pinned::PinnedPatch;
use super::prepared::PatchFiller;
use crate::space::stable_hash;
use crate::style::Style;
use crate::town::CellId;
use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A cell among which counted patches are shared out.
pub struct CountedCell {
    /// Its name.
    pub id: CellId,
    /// The style whose counts name patches that may stand here although they are never chosen: that of the cell, if it is
    /// not mixed of several.
    pub counts: Arc<Style>,
    /// What fills it.
    pub filler: PatchFiller,
}

/// Lets the cells of a town use counted patches so often that the town keeps to its styles' counts: at most so many cells may
/// use it, once each, and at least so many have it pinned where `find` finds a place in a cell. Which cells is drawn from
/// their names.
pub fn share_out(
    styles: &[&Style],
    cells: &mut [CountedCell],
    mut find: impl FnMut(usize, &PatchFiller, usize) -> Option<PinnedPatch>,
) {
    // The strictest of the counts of several styles holds.
    let mut counts: BTreeMap<&str, (u32, u32)> = BTreeMap::new();
    for count in styles.iter().flat_map(|s| &s.patches) {
        let (least, most) = counts.entry(&count.patch).or_insert((0, u32::MAX));
        *least = (*least).max(count.at_least);
        *most = (*most).min(count.at_most.unwrap_or(u32::MAX));
    }
    for (name, (least, most)) in counts {
        let word = stable_hash(&name.bytes().map(u64::from).collect::<Vec<_>>());
        let of = |cell: &CountedCell| cell.filler.patches.patches.iter().position(|p| p.name == name);
        let mut ranked: Vec<(usize, usize)> = (0..cells.len())
            .filter_map(|i| of(&cells[i]).map(|patch| (i, patch)))
            .filter(|(i, patch)| {
                cells[*i].filler.weights[*patch] > 0.0 || cells[*i].counts.patches.iter().any(|c| c.patch == name)
            })
            .collect();
        ranked.sort_by_key(|(i, _)| Reverse(stable_hash(&[cells[*i].id.0, word])));
        // Those that the user pinned count.
        let stands = |cell: &CountedCell, patch: usize| cell.filler.pinned.iter().any(|p| p.patch == patch);
        let mut used = ranked.iter().filter(|(i, patch)| stands(&cells[*i], *patch)).count() as u32;
        for &(i, patch) in &ranked {
            if used >= least.min(most) {
                break;
            }
            if !stands(&cells[i], patch)
                && let Some(place) = find(i, &cells[i].filler, patch)
            {
                cells[i].filler.pinned.push(place);
                used += 1;
            }
        }
        if most == u32::MAX {
            continue;
        }
        for &(i, patch) in &ranked {
            if !stands(&cells[i], patch) && used < most {
                used += 1;
            } else {
                cells[i].filler.weights[patch] = 0.0;
            }
        }
    }
}
