//! Main streets between the two cells beside them, of one town or of two.

use super::propose::{PortProposal, propose};
use super::side::StreetSide;
use crate::network::StreetId;
use crate::space::{Seed, line_length};
use crate::style::Style;
use crate::town::{CellUse, MainCell, Town};
use glam::DVec2;

/// A town and the styles of its main cells.
#[derive(Clone, Copy, Debug)]
pub struct TownAndStyles<'a> {
    /// Its plan.
    pub town: &'a Town,
    /// The style of each of its main cells.
    pub styles: &'a [&'a Style],
}

/// A town with the ports that each of its cells proposes.
pub(super) struct TownProposals<'a> {
    pub source: TownAndStyles<'a>,
    by_cell: Vec<Vec<PortProposal>>,
}

impl<'a> TownProposals<'a> {
    /// The proposals of the town whose seams are asked for.
    pub fn of_own(seed: Seed, town: TownAndStyles<'a>) -> Self {
        Self::of_cells(seed, town, |_| true)
    }

    /// The proposals of a town across a border: only cells at borders propose.
    pub fn of_neighbour(seed: Seed, town: TownAndStyles<'a>) -> Self {
        let has_border = |main: usize| town.town.mains[main].border.is_some();
        Self::of_cells(seed, town, |cell| cell.sides.iter().any(|s| s.main.is_some_and(has_border)))
    }

    fn of_cells(seed: Seed, source: TownAndStyles<'a>, proposes: impl Fn(&MainCell) -> bool) -> Self {
        let by_cell = source.town.cells.iter().zip(source.styles).map(|(cell, style)| {
            let asked = cell.cell_use == CellUse::Built && proposes(cell);
            if asked { propose(seed, source.town, cell, style) } else { Vec::new() }
        });
        Self { source, by_cell: by_cell.collect() }
    }

    /// One side of a main street of the town. `shift` makes a position on the seam local to the town when added to it.
    fn side(&self, main: usize, side: StreetSide, shift: DVec2) -> Option<SeamSide<'_>> {
        let cell = side.cell(&self.source.town.mains[main]);
        let (style, proposals) = (self.source.styles.get(cell)?, self.by_cell.get(cell)?);
        Some(SeamSide { town: self.source.town, style, proposals, main, side, shift })
    }
}

/// One side of a main street: the town that its cell belongs to, the cell's style, and the ports that the cell proposes.
#[derive(Clone, Copy)]
pub(super) struct SeamSide<'a> {
    pub town: &'a Town,
    pub style: &'a Style,
    /// The proposals of the cell for all its streets.
    pub proposals: &'a [PortProposal],
    /// Index of the street among the town's.
    pub main: usize,
    pub side: StreetSide,
    /// Makes a position on the seam local to the town when added to it.
    pub shift: DVec2,
}

/// A main street between its two sides. Along a border everything is local to the border, so that both towns find the same
/// bits.
pub(super) struct SeamEdge<'a> {
    pub street: StreetId,
    pub line: Vec<DVec2>,
    pub length: f64,
    pub left: Option<SeamSide<'a>>,
    pub right: Option<SeamSide<'a>>,
    /// Makes a position on the seam local to the town whose seams are asked for when added to it.
    pub shift: DVec2,
    /// Whether the street runs along a border.
    pub on_border: bool,
}

impl<'a> SeamEdge<'a> {
    /// A main street of the first of `towns`; the others share borders with it.
    pub fn new(towns: &'a [TownProposals], main: usize) -> Self {
        let own = &towns[0];
        let street = &own.source.town.mains[main];
        let id = street.street.id;
        let Some(border) = &street.border else {
            return Self {
                street: id,
                line: street.street.line.clone(),
                length: street.street.length(),
                left: own.side(main, StreetSide::Left, DVec2::ZERO),
                right: own.side(main, StreetSide::Right, DVec2::ZERO),
                shift: DVec2::ZERO,
                on_border: false,
            };
        };
        let on = |side: StreetSide| {
            let settlement = border.sides[usize::from(side == StreetSide::Right)];
            let proposals = towns.iter().find(|t| t.source.town.settlement.id == settlement)?;
            let town = proposals.source.town;
            let main = town.mains.iter().position(|m| m.street.id == id)?;
            proposals.side(main, side, border.origin.offset_to(town.origin))
        };
        let origin = own.source.town.origin;
        let line = street.street.moved(origin.offset_to(border.origin)).line;
        Self {
            street: id,
            length: line_length(&line),
            line,
            left: on(StreetSide::Left),
            right: on(StreetSide::Right),
            shift: border.origin.offset_to(origin),
            on_border: true,
        }
    }

    /// One of the two sides.
    pub fn side(&self, side: StreetSide) -> Option<&SeamSide<'a>> {
        match side {
            StreetSide::Left => self.left.as_ref(),
            StreetSide::Right => self.right.as_ref(),
        }
    }

    /// The sides that have a cell, left before right.
    pub fn sides(&self) -> impl Iterator<Item = &SeamSide<'a>> {
        self.left.iter().chain(&self.right)
    }
}
