//! Layer 12: the face of layers 1 to 11. A [`World`] is made from a [`WorldSource`], the five inputs, and gives chunks, meshes
//! and answers. This layer also finds what changes when an input changes.

mod area;
mod assets;
mod depends;
mod error;
mod generator;
mod route;
mod settings;
mod source;
mod warnings;

pub use area::{Area, Owned};
pub use assets::WorldAssets;
pub use depends::{Difference, changed_by_edits, difference, unchanged_chunks};
pub use error::WorldError;
pub use generator::{NearestStreet, World};
pub use route::Route;
pub use settings::{CacheSettings, Settings};
pub use source::{TerrainSource, WorldSource};
pub use warnings::set_warnings;
