//! Layers 2 and 3: settlements with their outlines, and the roads between them.
//!
//! Settlements read terrain and higher tiers; roads read terrain, settlements, outlines and higher tiers. Roads stop at
//! the outlines of settlements, in gates, so outlines are made here.

pub mod outline;
pub mod road;
pub mod settlement;

pub use outline::Outline;
pub use road::{Gate, Link, NetworkError, NetworkTask, Road, RoadNetwork, RoadSettings, Roads, TierSettings};
pub use settlement::{
    PerSize, Settlement, SettlementId, SettlementRow, SettlementSettings, SettlementTable, Settlements, SizeClass,
};
