//! Endless streamed worlds of towns.

pub mod chunk;
#[cfg(feature = "cli")]
pub mod export;
pub mod layer;
pub mod mesh;
pub mod network;
pub mod parcel;
pub mod patch;
pub mod region;
pub mod seam;
pub mod space;
pub mod streets;
pub mod terrain;
pub mod town;
pub mod world;
