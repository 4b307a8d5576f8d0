//! The filler: tiles of real or drawn maps in main cells.

use super::lay::lay;
use super::table::TileTable;
use crate::layer::{Cancel, LayerError, Weigh};
use crate::patch::{Patch, PatchSet};
use crate::streets::cell::{Draft, connect_parts, finish, grow_from_stubs, lay_stubs, make_fair, propagate, repair};
use crate::streets::filler::{CellBrief, CellFiller, CellStreets, CellToFill, FilledTown, Filler, LeftOut, TownToFill};
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
}

impl PatchCity {
    /// The filler for those of these styles that name it; styles and patch sets are given by name.
    pub fn new(styles: &BTreeMap<String, Arc<Style>>, sets: &BTreeMap<String, Arc<PatchSet>>) -> Self {
        let kit = |(name, style): (&String, &Arc<Style>)| {
            let style::Filler::PatchCity(rules) = style.filler else { return None };
            let table = Arc::new(table(style, &rules, sets));
            Some((name.clone(), Kit { rules, table }))
        };
        Self { kits: styles.iter().filter_map(kit).collect() }
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
        let filler = |cell: &CellToFill<'_>| {
            let kit = self.kit(cell);
            Arc::new(TileFiller {
                table: kit.map(|kit| kit.table.clone()),
                rules: kit.map_or_else(PatchCityRules::default, |kit| kit.rules),
                pinned: cell.pinned.len(),
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
    /// Number of pieces that the user pinned in the cell; none of them can stand.
    pinned: usize,
}

impl CellFiller for TileFiller {
    fn fill(&self, brief: &CellBrief<'_>, cancel: &Cancel) -> Result<CellStreets, LayerError> {
        let mut draft = Draft::new(brief);
        lay_stubs(&mut draft);
        cancel.check()?;
        let mut stands = BTreeMap::new();
        let mut names: &[Arc<str>] = &[];
        match self.table.as_deref().filter(|table| !table.is_empty() && !brief.ports.is_empty()) {
            Some(table) => {
                draft.canvas.stamp_stubs(brief.ports);
                stands = lay(&mut draft, table, &self.rules, cancel)?;
                names = &table.names;
            }
            None => {
                grow_from_stubs(&mut draft);
                propagate(&mut draft, cancel, |_, _, _, _| false)?;
            }
        }
        connect_parts(&mut draft);
        cancel.check()?;
        repair(&mut draft, &[], cancel)?;
        make_fair(&mut draft);
        let left_out = (0..self.pinned).map(|piece| LeftOut { piece, reason: "cannot stand among tiles" });
        let laid = stands.into_iter().map(|(patch, count)| (names[patch as usize].clone(), count));
        Ok(CellStreets { left_out: left_out.collect(), laid: laid.collect(), ..finish(&draft, NAME, names) })
    }
}

impl Weigh for TileFiller {
    fn bytes(&self) -> usize {
        // The tiles are shared by many cells.
        size_of::<Self>()
    }
}
