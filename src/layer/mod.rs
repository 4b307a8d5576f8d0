//! What every layer shares: its bounded cache, the padding it declares, the token that cancels work, the ranges of settings,
//! and the errors of files that users write.
//!
//! Part of the ground floor: knows no layer.

mod cache;
mod error;
mod file;
mod parallel;
mod range;
mod ranged;
mod ron_text;
mod text;

pub use cache::{LayerCache, Weigh};
pub use error::{Cancel, LayerError, Reach};
pub use file::FileError;
pub(crate) use file::{Lines, quoted};
pub use parallel::each;
pub use range::RangeError;
pub use ranged::{Choice, Number, Numeric, Ranged, Walk};
pub use ron_text::{error_at, errors_at_elements, from_ron, is_written};
pub use text::{decode_text, is_asset_file, read_file, read_text, ron_files};
