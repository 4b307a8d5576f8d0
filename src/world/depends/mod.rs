//! What depends on what: which chunks stay the same when an input of the world changes.

mod edits;
mod inputs;

pub use edits::changed_by_edits;
pub use inputs::{Difference, difference, unchanged_chunks};
