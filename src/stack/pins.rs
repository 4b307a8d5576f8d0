//! Patches that the user pinned in towns, and those that styles count.

use super::counts::share_out;
use super::layers::Stack;
use super::town::{Planned, SeamedTown};
use crate::edits::{EditList, RejectedEdit};
use crate::layer::{Cancel, LayerError};
use crate::space::{point_in_polygon, quantize};
use crate::streets::{self, PinnedPatch};
use crate::town::{CellUse, MainCell, Town};
use glam::DVec2;
use std::collections::BTreeMap;

impl Stack {
    /// Pins the patches that the user wants in a town, and those that its styles count.
    pub(super) fn pin(&self, town: &mut SeamedTown, plan: &Planned) -> Result<(), LayerError> {
        let mut wishes: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, edit) in self.pins.iter().enumerate() {
            if let Some(cell) = cell_at(&town.town, edit.at) {
                wishes.entry(cell).or_default().push(index);
            }
        }
        for (cell, edits) in wishes {
            let blend = &plan.cells[cell].0;
            let set = |edit: &usize| self.kits.set_with(blend, &self.pins[*edit].patch).map(|s| s.name.clone());
            let mut also: Vec<String> = edits.iter().filter_map(set).collect();
            also.sort();
            also.dedup();
            let mut mixed = self.kits.mix(self.seed, town.town.cells[cell].id, blend, &also)?;
            for edit in edits {
                let wish = &self.pins[edit];
                let known = mixed.patches.patches.iter().position(|p| p.name == wish.patch);
                mixed.pinned.extend(known.map(|patch| PinnedPatch {
                    patch,
                    at: quantize(town.town.origin.to_local(wish.at)),
                    turned: wish.heading_deg.to_radians(),
                    mirrored: wish.mirrored,
                }));
                mixed.edits.extend(known.map(|_| edit));
            }
            town.cells[cell] = mixed;
        }
        let own = &*self.kits.of(&town.town.settlement.style)?.style;
        let mut styles = vec![own];
        if let Some(fringe) = &own.fringe {
            styles.push(&self.kits.of(&fringe.style)?.style);
        }
        let mut cells = std::mem::take(&mut town.cells);
        share_out(&town.town, &styles, &mut cells, |cell, with, patch| {
            self.brief(town, cell, with, |brief| streets::find_place(brief, patch))
        });
        town.cells = cells;
        Ok(())
    }

    /// The patches pinned by edits that cannot be, as `rejected` tells it, by their place in the list.
    pub(crate) fn rejected_pins(&self, cancel: &Cancel) -> Result<Vec<RejectedEdit>, LayerError> {
        let mut out = Vec::new();
        for (index, edit) in self.pins.iter().enumerate() {
            let at = format!("{},{}", edit.at.x, edit.at.y);
            let reason = if !self.kits.has_patch(&edit.patch) {
                Some(format!("patch `{}` is in none of the patch sets", edit.patch))
            } else if let Some(settlement) = self.settlements.at(edit.at)? {
                let town = self.town(&settlement, cancel)?;
                match cell_at(&town.town, edit.at) {
                    Some(cell) => {
                        let unfit = &self.streets(&town, cell, cancel)?.unfit;
                        let own = town.cells[cell].edits.iter().position(|e| *e == index);
                        own.is_none_or(|i| unfit.contains(&i)).then(|| {
                            format!("does not fit at {at} among main streets, their ports and patches before it")
                        })
                    }
                    None => Some(format!("{at} lies in an open place; allowed is a place among local streets")),
                }
            } else {
                Some(format!("{at} lies in no settlement"))
            };
            out.extend(reason.map(|reason| RejectedEdit { list: EditList::Patches, index, reason }));
        }
        Ok(out)
    }
}

/// The main cell of a town with local streets that holds a plan point.
fn cell_at(town: &Town, plan: DVec2) -> Option<usize> {
    let at = town.origin.to_local(plan);
    let reach = town.settlement.radius * 1.1;
    let holds = |c: &MainCell| c.used_as == CellUse::Built && point_in_polygon(at, &c.border);
    (at.length() <= reach).then(|| town.cells.iter().position(holds)).flatten()
}
