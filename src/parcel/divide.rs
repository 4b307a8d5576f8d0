//! Dividing.
use crate::layer::{Cancel, LayerError};
use crate::parcel::{CellParcels, ParcelBrief};

/// Divides a main cell into blocks, lots and footprints.
pub fn divide(_brief: &ParcelBrief<'_>, _cancel: &Cancel) -> Result<CellParcels, LayerError> {
    todo!()
}
