//! Made-up grounds, settlements and areas for unit tests.

#[cfg(feature = "cli")]
mod area;
mod ground;
mod settlement;

#[cfg(feature = "cli")]
pub(crate) use area::area;
pub(crate) use ground::{Countryside, Flat, Ground};
pub(crate) use settlement::{SettlementCase, any_settlement, settlement};
