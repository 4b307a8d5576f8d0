//! Layer 9: layers 1 to 8 composed. Makes towns with their seams, local streets and parcels, keeps them in bounded caches,
//! mixes styles in each main cell, and answers which things overlap a box and which chunk owns a thing.
//!
//! A town's seams read the plans of the towns that it touches. A plan reads only the borders of its neighbours, and for the
//! styles of cells near a border the styles and outlines of the towns across. A town's parcels read the streets that towns
//! across a border bring to its gates.
//!
//! A chunk owns the main cells whose anchor lies in its square (with their blocks, lots and footprints), the streets whose
//! midpoint lies in it, and the junctions that lie in it. So a street is made once, by one owner, and nothing is cut.

mod brief;
mod layers;
mod overlap;
mod owner;
mod pins;
mod placed;
mod styles;
mod town;

pub use layers::{Stack, StackParts};
pub use overlap::Overlap;
pub use owner::{owner_of, street_owner};
pub use placed::{AtOrigin, PlacedStreet};
pub use styles::{BORDER_BLEND, CellStyle};
pub use town::{PreparedCell, SeamedTown};
