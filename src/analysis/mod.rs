//! Measures of networks and worlds: what a network is like, how it compares with real streets, whether it keeps its promises,
//! whether chunk borders can be told from it, and whether two worlds are the same. No layer of the generator reads it.

mod audit;
mod chunk_borders;
pub mod digest;
mod directions;
mod measures;
mod survey;

pub use audit::{Exceptions, Fault, Finding, audit, exceptions, unreached_gates};
pub use chunk_borders::{ChunkBorderCounts, ChunkBorderReport};
pub use measures::{Measures, measure};
pub use survey::{Survey, survey};
