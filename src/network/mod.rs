//! The planar street network: junctions and streets with stable ids, the planar graph they are grown in (connect,
//! clip, faces), and measures of the result.
//!
//! Part of the ground floor: knows no layer.

mod crossings;
mod faces;
mod growth;
mod lattice;
mod measures;
mod planar;
mod street;
mod survey;

pub use crossings::crossings;
pub use faces::{Face, HalfEdge};
pub use growth::{GrowthRules, grow};
pub use lattice::{LatticeCounts, LatticeReport};
pub use measures::{Measures, measure};
pub use planar::{Edge, EdgeIx, Hit, PlanarGraph, VertexIx};
pub use street::{Junction, JunctionId, Network, Street, StreetClass, StreetId};
pub use survey::{Survey, survey};
