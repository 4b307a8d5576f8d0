//! Towns with their seams, and the memory that the things in a stack's caches take.

use super::styles::CellStyle;
use crate::layer::Weigh;
use crate::network::{Junction, JunctionId, Network, Street, StreetId};
use crate::parcel::CellParcels;
use crate::seam::{self, Seam};
use crate::space::Origin;
use crate::streets::{CellFiller, CellStreets, Exception, ShortCount};
use crate::town::Town;
use glam::DVec2;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A town with its seams.
#[derive(Clone, Debug)]
pub struct SeamedTown {
    /// Main streets and main cells.
    pub town: Arc<Town>,
    /// The style of each main cell.
    pub styles: Vec<CellStyle>,
    /// What fills each main cell; `None` for cells without local streets.
    pub fillers: Vec<Option<PreparedCell>>,
    /// The counts of its styles that the town does not keep.
    pub short_counts: Vec<ShortCount>,
    /// Seams, one for each main street.
    pub seams: Vec<Seam>,
    /// The main streets divided at the ports.
    pub mains: Network,
    /// Streets of `mains` along a border, which the town across it has too, each with the border's origin.
    pub shared: BTreeMap<StreetId, Origin>,
}

/// What fills a main cell.
#[derive(Clone, Debug)]
pub struct PreparedCell {
    /// The filler, prepared for the cell.
    pub filler: Arc<dyn CellFiller>,
    /// The edits that pin a patch in the cell, as indices into the list of pinned patches.
    pub edits: Vec<usize>,
}

/// A town's plan with the styles of its main cells.
pub(super) struct Planned {
    pub town: Arc<Town>,
    /// The style of each main cell.
    pub cells: Vec<CellStyle>,
}

impl Weigh for Town {
    fn bytes(&self) -> usize {
        let point = size_of::<DVec2>();
        let cells: usize = self.cells.iter().map(|c| 200 + c.border.len() * point).sum();
        let mains: usize = self.mains.iter().map(|m| 200 + m.street.line.len() * point).sum();
        cells + mains + self.outline.polygon.len() * point
    }
}

impl Weigh for Planned {
    fn bytes(&self) -> usize {
        let cells = self.cells.iter().map(|cell| 200 + weigh_style(cell));
        self.town.bytes() + cells.sum::<usize>()
    }
}

impl Weigh for SeamedTown {
    fn bytes(&self) -> usize {
        let ports: usize = self.seams.iter().map(|s| 24 + s.ports.len() * size_of::<seam::Port>()).sum();
        let shared = self.shared.len() * 48;
        let styles: usize = self.styles.iter().map(weigh_style).sum();
        let fillers = self.fillers.iter().flatten().map(|cell| cell.filler.bytes() + 8 * cell.edits.len());
        let short: usize = self.short_counts.iter().map(|s| 64 + s.style.len() + s.piece.len()).sum();
        styles + short + fillers.sum::<usize>() + ports + shared + weigh_network(&self.mains)
    }
}

impl Weigh for CellStreets {
    fn bytes(&self) -> usize {
        let streets: usize = self.streets.iter().map(|s| s.street.bytes()).sum();
        let unmet = self.unmet.len() * size_of::<JunctionId>();
        // The names are shared.
        let pieces = 16 * self.missing.len() + 24 * self.laid.len();
        let exceptions = self.exceptions.len() * size_of::<Exception>();
        let outlines: usize = self.buildings.iter().map(|b| 48 + b.outline.len() * size_of::<DVec2>()).sum();
        outlines + streets + self.junctions.len() * size_of::<Junction>() + unmet + pieces + exceptions
    }
}

impl Weigh for CellParcels {
    fn bytes(&self) -> usize {
        let points = self.blocks.iter().map(|b| &b.polygon).chain(self.lots.iter().map(|l| &l.polygon));
        points.chain(self.footprints.iter().map(|f| &f.polygon)).map(|p| 64 + p.len() * size_of::<DVec2>()).sum()
    }
}

fn weigh_style(cell: &CellStyle) -> usize {
    // Cells do not share mixed styles.
    700 + 16 * cell.parts.len()
}

fn weigh_network(network: &Network) -> usize {
    let streets: usize = network.streets.iter().map(Street::bytes).sum();
    streets + network.junctions.len() * size_of::<Junction>()
}
