//! Layer 2, second half: outlines of settlements.
//!
//! Makes, for each settlement, its profile (how far ground and noise let it extend in each direction), its borders with
//! settlements that it touches, a river that it spreads over, and from these its outline. Reads the terrain within the
//! settlement's radius and the settlements nearby. The settlements are handed in; `Settlements` looks them up and declares
//! the padding.
//!
//! Settlements that stand close together touch: they share a border, and both outlines take their vertices there from it.

mod border;
mod polygon;
mod profile;
mod river;
mod waterway;

pub use border::Border;
pub use polygon::{Outline, SharedBorder};
pub(super) use profile::Profile;
pub use waterway::Waterway;
