//! Dividing a main cell into blocks, lots and footprints.

use crate::layer::{Cancel, LayerError};
use crate::parcel::blocks::{BlockShape, blocks};
use crate::parcel::brief::ParcelBrief;
use crate::parcel::footprints::{PARAPET, footprint, ground_floor, storeys};
use crate::parcel::land::{Block, BlockUse, CellParcels, Footprint, Lot, STOREY_HEIGHT};
use crate::parcel::lots::lots;
use crate::space::{QUANTUM, quantize, stable_hash};
use glam::DVec2;

/// Greatest length of a park's border without a street, in metres: streets of different widths leave a little at corners.
const MOST_OPEN: f64 = 12.0;

/// Divides a main cell into blocks, lots and footprints.
///
/// Blocks are the land that the surface of the streets leaves of the cell, without pieces too small or thin to use. Lots are
/// strips along the streets, cut across, in the spirit of the skeleton subdivision of Vanegas et al. 2012 ("Procedural
/// generation of parcels in urban modeling", section 4): each lot has a frontage, the lots of a block are disjoint, and land
/// too deep inside a block belongs to no lot. A block without room for a lot is a park.
///
/// # Errors
///
/// [`LayerError::Cancelled`] when `cancel` is set.
pub fn divide(brief: &ParcelBrief<'_>, cancel: &Cancel) -> Result<CellParcels, LayerError> {
    let mut out = CellParcels::default();
    let mut ground = brief.ground.drawn();
    let shapes = blocks(brief.border, brief.streets);
    cancel.check()?;
    for shape in shapes {
        let id = stable_hash(&[brief.id.0, word(shape.polygon[0]), word(shape.polygon[1])]);
        let mut rng = brief.seed.stream("parcel", &[brief.id.0, id]);
        let park = rng.chance(brief.rules.parks) && is_enclosed(&shape);
        let parcels = if park { Vec::new() } else { lots(&shape, brief.rules, &mut rng) };
        let land_use = if parcels.is_empty() { BlockUse::Park } else { BlockUse::Built };
        out.blocks.push(Block { id, polygon: shape.polygon, land_use });
        for lot in parcels {
            let polygon: Vec<DVec2> = lot.polygon.iter().map(|p| quantize(*p)).collect();
            let lot_id = stable_hash(&[id, word(polygon[0]), word(polygon[1])]);
            let mut rng = brief.seed.stream("parcel", &[brief.id.0, lot_id]);
            let built = !rng.chance(brief.rules.vacant);
            if let Some(plan) = built.then(|| footprint(&lot, brief.rules, &mut rng)).flatten() {
                let storeys = storeys(brief.rules, brief.centrality, &mut rng);
                out.footprints.push(Footprint {
                    id: stable_hash(&[lot_id, 1]),
                    lot: lot_id,
                    base: ground_floor(plan.iter().map(|p| ground.height(brief.origin.to_plan(*p)))),
                    height: f64::from(storeys) * STOREY_HEIGHT + PARAPET,
                    polygon: plan,
                    storeys,
                });
            }
            out.lots.push(Lot { id: lot_id, block: id, polygon, street: brief.streets[lot.street].id });
        }
    }
    Ok(out)
}

/// Whether there are streets on all sides of a block. Only such a block may become a park: elsewhere the town ends.
fn is_enclosed(shape: &BlockShape) -> bool {
    let n = shape.polygon.len();
    let edge = |i: usize| shape.polygon[i].distance(shape.polygon[(i + 1) % n]);
    (0..n).filter(|i| shape.fronts[*i].is_none()).map(edge).sum::<f64>() <= MOST_OPEN
}

/// A point of the quantum grid as one word.
fn word(p: DVec2) -> u64 {
    let [x, y] = (p / QUANTUM).round().to_array().map(|v| v as i64 as u64);
    x ^ y.rotate_left(32)
}
