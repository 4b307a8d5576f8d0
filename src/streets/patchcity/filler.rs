//! The filler: tiles of real or drawn maps in main cells.

use super::blend::Blend;
use super::lay::{Laid, lay};
use super::pins::Pins;
use super::table::TileTable;
use crate::layer::{Cancel, LayerError, Weigh};
use crate::patch::{Patch, PatchSet};
use crate::streets::cell::{
    Draft, connect_parts, finish, floating, grow_from_stubs, lay_stubs, make_fair, propagate, repair,
};
use crate::streets::filler::{CellBrief, CellFiller, CellStreets, CellToFill, FilledTown, Filler, TownToFill};
use crate::style::{self, PatchCityRules, Style};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The name by which styles call this filler.
pub const NAME: &str = "PatchCity";

/// What a style that names this filler needs.
struct Kit {
    rules: PatchCityRules,
    table: Arc<TileTable>,
}

/// Tiles side by side (Bustard and de Valmency 2015).
pub struct PatchCity {
    kits: BTreeMap<String, Kit>,
    sets: BTreeMap<String, Arc<PatchSet>>,
}

impl PatchCity {
    /// The filler for those of these styles that name it; styles and patch sets are given by name.
    pub fn new(styles: &BTreeMap<String, Arc<Style>>, sets: &BTreeMap<String, Arc<PatchSet>>) -> Self {
        let kit = |(name, style): (&String, &Arc<Style>)| {
            let style::Filler::PatchCity(rules) = style.filler else { return None };
            let table = Arc::new(table(style, &rules, sets));
            Some((name.clone(), Kit { rules, table }))
        };
        Self { kits: styles.iter().filter_map(kit).collect(), sets: sets.clone() }
    }

    /// The kit of the style that has the greatest share of a cell.
    fn kit(&self, cell: &CellToFill<'_>) -> Option<&Kit> {
        let shares = cell.styles.iter().filter_map(|(style, share)| Some((self.kits.get(&style.name)?, *share)));
        shares.reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(kit, _)| kit)
    }
}

/// The tiles of a style: the windows in its patch sets that its tags allow.
fn table(style: &Style, rules: &PatchCityRules, sets: &BTreeMap<String, Arc<PatchSet>>) -> TileTable {
    let mut patches: Vec<(Arc<Patch>, Arc<str>)> = Vec::new();
    for set in style.patch_sets.iter().filter_map(|name| sets.get(name)) {
        let usable = |p: &&Patch| p.window.is_some() && p.weight > 0.0 && p.is_allowed(&style.allow, &style.exclude);
        let named = |p: &Patch| (Arc::new(p.clone()), Arc::from(format!("{}/{}", set.name, p.name)));
        patches.extend(set.patches.iter().filter(usable).map(named));
    }
    TileTable::new(patches.iter().map(|(patch, name)| (patch, name.clone())), rules.quarter_turns)
}

impl Filler for PatchCity {
    fn prepare(&self, town: &TownToFill<'_>) -> Result<FilledTown, LayerError> {
        let number = town.cells.iter().map(|cell| cell.brief.id.0).min().unwrap_or(0);
        let filler = |cell: &CellToFill<'_>| {
            let kit = self.kit(cell);
            Arc::new(TileFiller {
                table: kit.map(|kit| kit.table.clone()),
                rules: kit.map_or_else(PatchCityRules::default, |kit| kit.rules),
                town: number,
                pins: Pins::new(&cell.pinned, &self.sets),
            }) as Arc<dyn CellFiller>
        };
        Ok(FilledTown { fillers: town.cells.iter().map(filler).collect(), short_counts: Vec::new() })
    }

    fn has_piece(&self, _: &str) -> bool {
        false
    }
}

/// The filler of one cell.
#[derive(Debug)]
struct TileFiller {
    /// The tiles; without any, streets only grow.
    table: Option<Arc<TileTable>>,
    rules: PatchCityRules,
    /// A number that all cells of the town share.
    town: u64,
    /// The patches that the user pinned in the cell.
    pins: Pins,
}

impl CellFiller for TileFiller {
    fn fill(&self, brief: &CellBrief<'_>, cancel: &Cancel) -> Result<CellStreets, LayerError> {
        let blend = Blend { seed: brief.seed, town: self.town, size: self.rules.blend };
        let mut unfit = Vec::new();
        let pinned = self.pins.names();
        loop {
            let mut draft = Draft::new(brief);
            lay_stubs(&mut draft);
            let standing = self.pins.lay(&mut draft, &mut unfit);
            cancel.check()?;
            let mut laid = Laid::default();
            let mut names = pinned.to_vec();
            match self.table.as_deref().filter(|table| !table.is_empty() && !brief.ports.is_empty()) {
                Some(table) => {
                    draft.canvas.stamp_stubs(brief.ports);
                    laid = lay(&mut draft, table, &self.rules, blend, pinned.len() as u32, cancel)?;
                    names.extend(table.names.iter().cloned());
                }
                None => {
                    grow_from_stubs(&mut draft);
                    propagate(&mut draft, cancel, |_, _, _, _| false)?;
                }
            }
            connect_parts(&mut draft);
            cancel.check()?;
            repair(&mut draft, &standing.anchors, cancel)?;
            make_fair(&mut draft);
            let cut_off = floating(&draft, &standing.anchors);
            if cut_off.is_empty() {
                let tiles = laid.stands.into_iter().map(|(piece, count)| (names[piece as usize].clone(), count));
                return Ok(CellStreets {
                    left_out: self.pins.left_out(&unfit),
                    laid: standing.laid.into_iter().chain(tiles).collect(),
                    buildings: laid.buildings,
                    ..finish(&draft, NAME, &names)
                });
            }
            // Nothing may float: once more without the patches that could not be reached.
            unfit.extend(Pins::of(&standing, cut_off));
            unfit.sort_unstable();
            unfit.dedup();
        }
    }
}

impl Weigh for TileFiller {
    fn bytes(&self) -> usize {
        // The tiles are shared by many cells.
        size_of::<Self>()
    }
}
