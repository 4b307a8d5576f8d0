//! Layer 7: the surface of streets. Makes the outlines of carriageway and pavement along a street ([`Strip`]) and around a
//! junction ([`JunctionShape`]), the polygons that streets cover ([`cover`]), the pieces in which long
//! streets are drawn ([`Pieces`]), and the heights of bridges ([`Deck`]). Reads the streets and junctions that it is given, and
//! the ground under a bridge; padding: none.
//!
//! `mesh` draws the outlines, and `parcel` makes blocks of the land that they leave, so a pavement ends where a block begins. The
//! outlines follow from three rules:
//! - Along its centre line a street is as wide as its class says; corners of a bend are mitred.
//! - Where two neighbouring arms of a junction are less than half a turn apart, the land between them ends where their edges
//!   meet. The end of a wide street that goes on as narrower ones counts as half an octagon around the junction.
//! - Where two neighbouring arms are more than half a turn apart, the surface goes around the outside of the junction in mitred
//!   corners. A dead end is the case of a single arm and ends square.
//!
//! The drawn surface never lies outside [`cover`]. It falls short of the cover only at junctions where the end of a wide street
//! stands out between two narrower streets, and by slivers outside a bend between streets of different widths.
//!
//! A street on the ground has the height of the ground; only decks have profiles of their own.

mod corner;
mod cover;
mod deck;
mod junction;
mod lane;
mod offset;
mod piece;
mod strip;
#[cfg(test)]
mod tests;

pub use corner::Corner;
pub use cover::cover;
pub use deck::{Deck, ROAD_LIFT};
pub use junction::{Arm, JunctionShape, junction_reach};
pub use lane::{Control, JunctionTurns, Lane, LaneId, LaneRules, Turn, TurnKind, ends_by_junction, lanes_of, turns_at};
pub use offset::offset_line;
pub use piece::{LONGEST_PIECE, Pieces};
pub use strip::Strip;
