//! Planning.
use crate::layer::{Cancel, LayerError};
use crate::region::{Gate, Outline, Settlement};
use crate::space::Seed;
use crate::terrain::Terrain;
use crate::town::{Style, Town};
use std::sync::Arc;

/// Plans a settlement.
pub fn plan(
    _seed: Seed,
    _settlement: &Arc<Settlement>,
    _outline: &Arc<Outline>,
    _gates: Vec<Gate>,
    _style: &Style,
    _terrain: &dyn Terrain,
    _cancel: &Cancel,
) -> Result<Town, LayerError> {
    todo!()
}
