//! Made-up grounds and settlements that the unit tests of several layers share.

mod ground;
mod settlement;

pub(crate) use ground::{Flat, Ground};
pub(crate) use settlement::{SettlementCase, any_settlement, settlement};
