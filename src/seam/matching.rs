//! Matching.
use crate::network::Network;
use crate::seam::{CellPort, Seam};
use crate::space::Seed;
use crate::town::{Style, Town};

/// The seams of a town, one for each of [`Town::mains`].
pub fn seams(_seed: Seed, _town: &Town, _style: &Style) -> Vec<Seam> {
    todo!()
}

/// The ports of cell `cell` (index into [`Town::cells`]), in order around its border.
pub fn cell_ports(_town: &Town, _seams: &[Seam], _cell: usize) -> Vec<CellPort> {
    todo!()
}

/// The main streets divided at the ports, with all their junctions.
pub fn main_network(_town: &Town, _seams: &[Seam]) -> Network {
    todo!()
}
