//! Grade-separated crossings: lesser roads pass over a highway on a bridge instead of meeting it. Makes the graph that is built,
//! tile by tile. Reads the merged graph and the terrain within [`padding`]; where roads are only bridged, also the graph before
//! merging and the routes.
//!
//! A crossing has two edges of the highway and two of another road, each road going nearly straight on. The other road gets a
//! vertex of its own there ([`Key::Overpass`](super::vertex::Key)), so that its line runs on, and `sections` makes a bridge of the
//! stretch around it. What joins both roads is a setting of the class of the other road:
//!
//! - [`Crossing::Diamond`](super::crossing::Crossing): four one-way ramps, one in each quarter (`diamond`). Where they have no
//!   room, the crossing is built as the next kind.
//! - [`Crossing::Interchange`](super::crossing::Crossing): a two-way ramp in one of the four quarters, as in a quadrant interchange
//!   (`quadrant`). Where it has no room either, the junction stays.
//! - [`Crossing::Bridge`](super::crossing::Crossing): nothing. This is done only where no route turns from one road to the other
//!   and nothing was merged nearby, because what merging dropped may be connected by way of the crossing. Roads of another class
//!   neither turn off a toll road nor merge with it, so a toll road is bridged wherever a bridge fits.
//!
//! So everything that was connected stays connected. Ramps and bridges lie nearer to their own crossing than to any other one,
//! and the land between ramps and roads contains nothing else. The decision is a function of the graph nearby, so there is no
//! order of decisions.

mod built;
mod diamond;
mod dimensions;
mod quadrant;
mod separations;
mod surroundings;

pub(super) use built::BuiltGraphs;
pub(super) use dimensions::{HALF_LENGTH, longest_way, padding};
pub(crate) use dimensions::{OVERPASS_CLEARANCE, overpass_profile};
