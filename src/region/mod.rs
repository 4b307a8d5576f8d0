//! Layers 2 and 3: settlements with their outlines, and the roads between them.
//!
//! Makes settlements and outlines (layer 2) and roads (layer 3). Settlements read the terrain and higher tiers; roads read
//! the terrain, settlements, outlines and roads of higher tiers. Roads end at gates in the outlines of settlements, so
//! outlines are made here. Each part declares its padding: see [`settlement`], [`outline`] and [`road`].

mod gate;
pub mod outline;
pub mod road;
pub mod settlement;
mod settlements;

pub use gate::Gate;
pub use outline::{Border, Outline, SharedBorder, Waterway};
pub use road::{
    Crossing, HighwayCrossing, Hindrance, Link, NetworkError, NetworkTask, RoadNetwork, RoadOverrides, RoadSection,
    RoadSettings, Roads, TierSettings,
};
pub(crate) use road::{OVERPASS_CLEARANCE, overpass_profile};
pub use settlement::{
    Moved, PerSize, Populations, Settlement, SettlementId, SettlementRow, SettlementSettings, SettlementTable,
    TableOptions, TableReport,
};
pub use settlements::Settlements;
