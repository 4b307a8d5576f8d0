//! Layer 7: the surface of streets, and the ground cut and filled to it. Reads streets and junctions, and the ground under them.
//!
//! | what | made by | depends on |
//! |---|---|---|
//! | widths and grades | [`CrossSection`] | the class of a street |
//! | lanes and turns | [`lanes_of`], [`turns_at`] | a street; the streets that meet at a junction |
//! | heights along a street | [`Profile`], [`Deck`] | the street and the ground under it |
//! | shape of a junction | [`JunctionShape`] | the streets that meet there |
//! | outlines of junctions | [`junction_outlines`] | the streets that meet there |
//! | shapes of streets and junctions, with paint | [`shapes`] | the same, and the junctions at both ends |
//! | height of the ground | [`Earthworks`] | streets within [`BANK_REACH`] |
//! | ground and streets of a square | [`Tin`] | shapes and heights there |
//! | ground that streets cover | [`cover`] | streets and their junctions |
//!
//! Padding of a square: [`SURFACE_REACH`], beyond which no street changes anything in it.
//!
//! The outlines follow from four rules:
//! - Along its centre line a street is as wide as its class says; corners of a bend are mitred.
//! - Where two neighbouring arms of a junction are less than half a turn apart, the land between them ends where their edges
//!   meet, with the kerb rounded. The end of a wide street that goes on as narrower ones counts as half an octagon around the
//!   junction.
//! - Where two neighbouring arms are more than half a turn apart, the surface goes around the outside of the junction in mitred
//!   corners. A dead end is the case of a single arm and ends square; a local street ends in a circle to turn in where nothing
//!   else is near.
//! - Where shapes of different streets or junctions overlap, they become one.
//!
//! Shapes never lie outside [`cover`], except for the rounded corners of country roads. They fall short of the cover only at
//! junctions where the end of a wide street stands out between two narrower streets, and by slivers outside a bend between
//! streets of different widths.

mod corner;
mod cover;
mod deck;
mod earthworks;
mod element;
mod finish;
mod head;
mod junction;
mod lane;
mod offset;
mod paint;
mod piece;
mod profile;
mod section;
mod shapes;
mod strip;
#[cfg(test)]
mod tests;
mod tin;

pub use corner::Corner;
pub use cover::cover;
pub use deck::Deck;
pub use earthworks::{BANK_REACH, Earthworks};
pub use element::Element;
pub use finish::{Finish, SurfaceKind};
pub use junction::{Arm, Cut, FARTHEST_REACH, JunctionShape, deck_reach, has_surface};
pub use lane::{Control, JunctionTurns, Lane, LaneId, LaneRules, Turn, TurnKind, ends_by_junction, lanes_of, turns_at};
pub use offset::offset_line;
pub use piece::{LONGEST_PIECE, Pieces};
pub use profile::{FREEBOARD, Profile};
pub use section::{CrossSection, KERB_HEIGHT};
pub use shapes::{Graded, JunctionOutline, SURFACE_REACH, junction_outlines, shapes};
pub use tin::{Step, SurfacePoint, Tin};
