//! The roads of a finite domain (Galin et al. 2011, sections 4 to 6): given settlements on a given piece of ground, with the same
//! steps as in an endless world.
//!
//! Makes a [`RoadNetwork`]. Nothing outside the domain is read or built on. Every pair of settlements within the reach of the
//! settings is a candidate. A settlement too small for the lattice is a node: roads end at its centre or pass through it. A
//! larger one has a disc with gates, which shrinks where a neighbour is near (`listed`).

mod build;
mod check;
mod edited;
mod listed;
mod routes;
mod settings;
mod task;
#[cfg(test)]
mod tests;

pub use build::RoadNetwork;
pub use check::NetworkError;
pub use task::NetworkTask;
