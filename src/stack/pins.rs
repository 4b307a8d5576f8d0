//! What fills the main cells of a town, and the pieces that the user pinned in them.

use super::brief::CellEdges;
use super::layers::Stack;
use super::styles::CellStyle;
use super::town::{Planned, PreparedCell};
use crate::edits::{EditList, RejectedEdit};
use crate::layer::{Cancel, LayerError};
use crate::seam::Seam;
use crate::space::point_in_polygon;
use crate::streets::{CellToFill, PinnedPiece, ShortCount};
use crate::town::{CellUse, MainCell, Town};
use glam::DVec2;
use std::collections::BTreeMap;

impl Stack {
    /// Prepares what fills the main cells of a town, with the pieces that the user pinned in them.
    /// Besides, returns the counts that the town does not keep.
    pub(super) fn prepare(
        &self,
        plan: &Planned,
        seams: &[Seam],
    ) -> Result<(Vec<Option<PreparedCell>>, Vec<ShortCount>), LayerError> {
        let town = &*plan.town;
        let mut wishes: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, edit) in self.pins.iter().enumerate() {
            if let Some(cell) = cell_at(town, edit.at) {
                wishes.entry(cell).or_default().push(index);
            }
        }
        let built: Vec<usize> = (0..town.cells.len()).filter(|i| town.cells[*i].cell_use == CellUse::Built).collect();
        let edges: Vec<CellEdges> = built.iter().map(|cell| CellEdges::of(town, seams, *cell)).collect();
        let pinned = |index: &usize| {
            let edit = &self.pins[*index];
            PinnedPiece {
                piece: edit.patch.clone(),
                at: town.origin.to_local(edit.at),
                turned: edit.heading_deg.to_radians(),
                mirrored: edit.mirrored,
            }
        };
        let mut cells = Vec::with_capacity(built.len());
        for (&cell, edges) in built.iter().zip(&edges) {
            let CellStyle { style, parts } = &plan.cells[cell];
            cells.push(CellToFill {
                brief: edges.brief(self.seed, town, cell, style),
                style,
                styles: parts,
                pinned: wishes.get(&cell).into_iter().flatten().map(pinned).collect(),
            });
        }
        let own = &**self.styles.of(&town.settlement.style)?;
        let mut styles = vec![own];
        if let Some(fringe) = &own.fringe {
            styles.push(self.styles.of(&fringe.style)?);
        }
        let mut out = vec![None; town.cells.len()];
        let filled = self.fillers.prepare(&styles, cells)?;
        for (cell, filler) in built.iter().zip(filled.fillers) {
            out[*cell] = Some(PreparedCell { filler, edits: wishes.remove(cell).unwrap_or_default() });
        }
        Ok((out, filled.short_counts))
    }

    /// The edits that pin a patch which cannot stand, with the reason; in the order of the list.
    pub(crate) fn rejected_pins(&self, cancel: &Cancel) -> Result<Vec<RejectedEdit>, LayerError> {
        let mut out = Vec::new();
        for (index, edit) in self.pins.iter().enumerate() {
            let at = format!("{},{}", edit.at.x, edit.at.y);
            let reason = if !self.fillers.has_piece(&edit.patch) {
                Some(format!("patch `{}` is in none of the patch sets", edit.patch))
            } else if let Some(settlement) = self.settlements.at(edit.at)? {
                let town = self.town(&settlement, cancel)?;
                match cell_at(&town.town, edit.at) {
                    Some(cell) => {
                        let left_out = &self.streets(&town, cell, cancel)?.left_out;
                        let edits = town.fillers[cell].as_ref().map_or(&[][..], |prepared| &prepared.edits);
                        let left_out = left_out.iter().find(|l| edits.get(l.piece) == Some(&index));
                        left_out.map(|l| format!("at {at} it {}", l.reason))
                    }
                    None => Some(format!("{at} lies where there are no local streets; allowed is a place among them")),
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
    let holds = |c: &MainCell| c.cell_use == CellUse::Built && point_in_polygon(at, &c.border);
    (at.length() <= reach).then(|| town.cells.iter().position(holds)).flatten()
}
