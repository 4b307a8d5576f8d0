//! What every layer shares: its bounded cache, the padding it declares, the token that cancels work, and the errors of
//! files that users write.
//!
//! Part of the ground floor: knows no layer.

mod cache;
mod error;
mod file;

pub use cache::{LayerCache, Weigh};
pub use error::{Cancel, LayerError, Reach};
pub(crate) use file::quoted;
pub use file::{FileError, RangeError, from_ron};
