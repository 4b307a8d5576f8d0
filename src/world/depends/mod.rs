//! What depends on what: which chunks stay the same when an input of the world changes.

/// Steps from town to touching town over which a town depends on others. Its parcels read the streets that the town across a
/// border brings to a gate. The seams of that town have ports from the towns that it touches, and these ports follow styles that
/// mix with the styles of towns one step farther.
const TOWN_STEPS: usize = 3;

mod edits;
mod inputs;

pub use edits::changed_by_edits;
pub use inputs::{Difference, difference, unchanged_chunks};
