//! Layer 7: the surface of streets. Makes the outlines of carriageway and pavement along a street ([`Strip`]) and around a
//! junction ([`JunctionShape`]), the polygons that streets cover ([`cover`]), and the heights of bridges ([`Deck`]). Reads
//! the streets and junctions that it is given, and the ground under a bridge; padding: none.
//!
//! The outlines are drawn by `mesh`, and `parcel` takes blocks as what they leave, so a pavement ends where a block begins.
//! Both follow from three rules:
//! - Along its centre line a street is as wide as its class says; corners of a bend are mitred.
//! - Where two neighbouring arms of a junction are less than half a turn apart, the land between them ends where their edges
//!   meet. The end of each arm counts as half an octagon around the junction, so a wide street that goes on as a narrow one
//!   ends in a corner of its own instead of a taper of any length.
//! - Where they are more than half a turn apart, the surface goes around the outside of the junction in mitred corners. A dead
//!   end is the case of one arm and is cut off square.

mod corner;
mod cover;
mod deck;
mod junction;
mod offset;
mod strip;
#[cfg(test)]
mod tests;

pub use corner::Corner;
pub use cover::cover;
pub use deck::{Deck, ROAD_LIFT};
pub use junction::{Arm, JunctionShape, junction_reach};
pub use offset::offset_line;
pub use strip::Strip;
