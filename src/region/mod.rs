//! Layers 2 and 3: settlements with their outlines, and the roads between them.
//!
//! Settlements read terrain and higher tiers; roads read terrain, settlements, outlines and higher tiers. Roads stop at
//! the outlines of settlements, in gates, so outlines are made here. Settlements that stand close enough touch: they share a
//! border, from which both outlines take their vertices. A border reads the settlements near its two, so an outline reads
//! those near its neighbours. Both follow the user's edits.

mod border;
pub mod outline;
mod profile;
mod river;
pub mod road;
pub mod settlement;
mod waterway;

pub use border::Border;
pub use outline::{Outline, SharedBorder};
pub(crate) use road::{CLEARANCE, rise};
pub use road::{Crossing, Gate, Link, NetworkError, NetworkTask, Road, RoadNetwork, RoadSettings, Roads, TierSettings};
pub use settlement::{
    PerSize, Populations, Settlement, SettlementId, SettlementRow, SettlementSettings, SettlementTable, Settlements,
};
pub use waterway::Waterway;
