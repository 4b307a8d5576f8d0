//! Tiles side by side: texture synthesis of streets (Bustard and de Valmency 2015).
//!
//! Windows that were cut out of maps are tiles on a grid. `table` finds tiles by how many streets cross their sides, `cost` and
//! `choose` say which goes on those beside it best, `mosaic` lays them out, `weave` joins their streets, `mend` gives what is left
//! loose a way on, and `buildings` says which buildings stand. `synthesis` makes a square of them without a world; `lay` and `consolidate` fit them into a main cell, whose
//! rules every street keeps.

mod blend;
mod buckets;
mod buildings;
mod choose;
mod consolidate;
mod cost;
mod figures;
mod filler;
mod lay;
mod mend;
mod mosaic;
mod pins;
mod side;
mod synthesis;
mod table;
mod weave;
mod window;

pub use filler::PatchCity;
pub use synthesis::{Synthesis, synthesize};
pub use table::TileTable;
