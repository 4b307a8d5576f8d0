//! What a search for a road reads: the nodes of a corridor, the costs of the edges between them, and where bridges and
//! tunnels could run.
//!
//! Reads the terrain in the corridor. The cost per metre is 1 on flat open ground and grows with slope along the heading,
//! vegetation and control terms (Galin 2011, section 4.1), but never falls below a least cost. Roads cross water only on
//! bridges, straight along one heading, or on an edge with two dry ends.

mod corridor;
mod edges;
mod existing;
mod ground;
mod search_ground;
mod spans;

pub(super) use corridor::Corridor;
pub(super) use ground::roughness;
pub(super) use search_ground::Field;
pub(super) use spans::SpanEdge;
