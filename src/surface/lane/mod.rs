//! Lanes: where traffic drives. Makes the lanes of a street ([`lanes_of`]) and the turns that connect lanes through a junction
//! ([`turns_at`]). Reads the street, or the junction and its streets; padding: none.
//!
//! A lane belongs to its street and a turn to its junction. Both are pure functions of them, so the chunks that see a street give
//! its lanes the same ids and the same points, and lanes of neighbouring chunks join by id.
//!
//! Lanes leave out the ends of their streets, 18 m or less; turns run there, from the end of one lane to the start of another.

mod control;
mod curve;
mod layout;
#[cfg(test)]
mod tests;
mod turn;

pub use control::Control;
pub use layout::{Lane, LaneId, LaneRules, lanes_of};
pub use turn::{JunctionTurns, Turn, TurnKind, ends_by_junction, turns_at};
