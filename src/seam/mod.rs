//! Layer 5: seams. The two cells beside a main street propose attachment points from their styles. The proposals are matched
//! and become the ports that both cells start from.
//!
//! Reads the town and its styles. A seam depends on the main street, its two cells, their styles and the town's field alone, so
//! the padding is that of the town. Along a border the two cells belong to two towns, and the seam reads both plans.

mod clearance;
mod cut;
mod edge;
mod matching;
mod pairing;
mod point;
mod port;
mod propose;
mod side;
#[cfg(test)]
mod tests;

pub use cut::{cell_ports, main_network, shared_streets};
pub use edge::TownAndStyles;
pub use matching::seams;
pub use port::{APPROACH_CLEARANCE, APPROACH_LENGTH, CellPort, Port, Seam};
