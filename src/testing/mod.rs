//! Made-up grounds, cells, settlements and areas for unit tests.

#[cfg(feature = "cli")]
mod area;
mod block_cell;
mod ground;
mod port_cell;
mod settlement;

#[cfg(feature = "cli")]
pub(crate) use area::area;
pub(crate) use block_cell::{BlockCell, block_cell, divided, divided_with};
pub(crate) use ground::{Countryside, Flat, Ground};
pub(crate) use port_cell::{PortCell, all_styles, patch_sets, styles};
pub(crate) use settlement::{SettlementCase, any_settlement, settlement};
