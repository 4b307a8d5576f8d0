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
/// their names. The greatest numbers are those of `limits`, the styles of all cells.
pub fn share_out(
    styles: &[&Style],
    limits: &[&Style],
    cells: &mut [CountedCell],
    mut find: impl FnMut(usize, &PatchFiller, usize) -> Option<PinnedPatch>,
) {
    // The strictest of the counts of several styles holds.
    let mut counts: BTreeMap<&str, (u32, u32)> = BTreeMap::new();
    for count in styles.iter().flat_map(|s| &s.patches) {
        let (least, _) = counts.entry(&count.patch).or_insert((0, u32::MAX));
        *least = (*least).max(count.at_least);
    }
    for count in limits.iter().flat_map(|s| &s.patches) {
        let (_, most) = counts.entry(&count.patch).or_insert((0, u32::MAX));
        *most = (*most).min(count.at_most.unwrap_or(u32::MAX));
    }
    for (name, (least, most)) in counts {
        let word = stable_hash(&name.bytes().map(u64::from).collect::<Vec<_>>());
        // Patches of several sets may have one name.
        let named = |cell: &CountedCell| -> Vec<usize> {
            let patches = cell.filler.patches.patches.iter().enumerate();
            patches.filter(|(_, p)| p.name == name).map(|(i, _)| i).collect()
        };
        let may_stand = |cell: &CountedCell, patch: &usize| {
            cell.filler.weights[*patch] > 0.0 || cell.counts.patches.iter().any(|c| c.patch == name)
        };
        // Those that the user pinned count.
        let pins = |cell: &CountedCell| {
            let is = |p: &&PinnedPatch| cell.filler.patches.patches.get(p.patch).is_some_and(|p| p.name == name);
            cell.filler.pinned.iter().filter(is).count() as u32
        };
        let mut used: u32 = cells.iter().map(pins).sum();
        let mut ranked: Vec<(usize, usize)> = (0..cells.len())
            .filter_map(|i| named(&cells[i]).into_iter().find(|p| may_stand(&cells[i], p)).map(|patch| (i, patch)))
            .collect();
        ranked.sort_by_key(|(i, _)| Reverse(stable_hash(&[cells[*i].id.0, word])));
        for &(i, patch) in &ranked {
            if used >= least.min(most) {
                break;
            }
            if pins(&cells[i]) == 0
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
            let may_have = pins(&cells[i]) == 0 && used < most;
            used += u32::from(may_have);
            cells[i].filler.once[patch] = true;
            for other in named(&cells[i]).into_iter().filter(|other| !may_have || *other != patch) {
                cells[i].filler.weights[other] = 0.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layer::Cancel;
    use crate::patch::{PatchDatabase, PatchSet};
    use crate::streets::filler::{CellFiller, StreetOrigin};
    use crate::testing::{PortCell, styles};

    /// A comb along a main street, as a patch and as a pattern that repeats it.
    const COMB: &str = "(
        patches: [(name: \"tooth\", vertices: [(-30, 0), (0, 0), (30, 0), (0, 70)], main: [[0, 1, 2]], streets: [(1, 3)])],
        patterns: [(name: \"comb\", element: \"tooth\", scale: (0.6, 2), repeat: (3, 8))],
    )";

    #[test]
    fn no_town_has_more_of_a_patch_than_its_styles_allow() {
        let set = PatchSet::from_ron("q.ron", COMB).expect("a valid set");
        // A second set has a patch of the same name.
        let patches = Arc::new(PatchDatabase::new(&[&set, &set], &[], &[]));
        let style = |at_most: &str| {
            let count = format!("(patches: [(patch: \"tooth\", at_most: {at_most})])");
            Style::from_ron("s.ron", &count).expect("a valid style")
        };
        let samples = styles();
        for (at_most, limited) in [("Some(0)", 0), ("Some(2)", 2), ("Some(5)", 5), ("None", usize::MAX)] {
            let counting = style(at_most);
            let briefs: Vec<PortCell<'_>> = (0..12).map(|seed| PortCell::new(700 + seed, &samples)).collect();
            let cell = |id: u64| {
                let mut filler = PatchFiller::new(patches.clone(), patches.weights());
                filler.start.patterns_along = 1.0;
                CountedCell { id: CellId(id), counts: Arc::default(), filler }
            };
            let mut cells: Vec<CountedCell> = (0..12).map(cell).collect();
            share_out(&[], &[&counting], &mut cells, |_, _, _| None);
            let mut used = 0;
            for (cell, sample) in cells.iter().zip(&briefs) {
                let out = cell.filler.fill(&sample.brief(), &Cancel::new()).expect("nobody cancels");
                let teeth = |s: &&crate::streets::LocalStreet| matches!(s.made_by.origin, StreetOrigin::Piece(_));
                used += out.streets.iter().filter(teeth).count();
            }
            // A tooth is one street, and is cut into more where others meet it.
            assert!(if limited == 0 { used == 0 } else { used > 0 }, "{at_most}: {used}");
            assert!(limited == usize::MAX || used <= 3 * limited, "{used} streets of at most {limited} patches");
            assert!(limited < usize::MAX || used > 20, "{used} streets");
        }
    }
}
