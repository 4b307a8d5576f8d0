//! Measures of networks and worlds: what a network is like, how it compares with real streets, whether it keeps its promises,
//! whether chunk borders can be told from it, and whether two worlds are the same. Random inputs of worlds to check, too. No
//! layer of the generator reads it.

mod audit;
mod chunk_borders;
pub mod digest;
mod directions;
pub mod inputs;
mod measures;
mod survey;

pub use audit::{Exceptions, Fault, Finding, audit, exceptions, unreached_gates};
pub use chunk_borders::{ChunkBorderCounts, ChunkBorderReport};
pub use measures::{Measures, measure};
pub use survey::{Survey, survey};
