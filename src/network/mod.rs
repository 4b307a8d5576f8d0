//! The planar street network: junctions and streets with stable ids, and the planar graph in which they grow (connect, clip,
//! faces).
//!
//! Belongs to the ground floor: it knows no layer.

mod crossings;
mod faces;
mod planar;
mod roundabout;
mod size_class;
mod street;
mod traffic;

pub use crossings::crossings;
pub use faces::{Face, HalfEdge};
pub use planar::{Edge, EdgeIx, Hit, PlanarGraph, VertexIx};
pub use roundabout::{is_round, island_side};
pub use size_class::SizeClass;
pub use street::{Junction, JunctionId, Network, STREET_FLOOR, Street, StreetClass, StreetId};
pub use traffic::{Side, Traffic};
