//! Dividing a main cell into blocks, lots and footprints.

use crate::layer::{Cancel, LayerError};
use crate::network::Street;
use crate::parcel::blocks::{BlockShape, blocks};
use crate::parcel::brief::ParcelBrief;
use crate::parcel::footprints::{PARAPET, footprint, ground_floor, storeys};
use crate::parcel::given::{Given, beside, given};
use crate::parcel::land::{Block, BlockUse, CellParcels, Footprint, Lot, STOREY_HEIGHT};
use crate::parcel::lots::lots;
use crate::space::{Bounds, quantize, quantum_key, stable_hash};
use crate::surface::{Earthworks, FREEBOARD, Profile};
use glam::DVec2;

/// Greatest length of a park's border without a street, in metres: streets of different widths leave a little at corners.
const MOST_OPEN: f64 = 12.0;

/// Divides a main cell into blocks, lots and footprints.
///
/// Blocks are the land that the surface of the streets leaves of the cell, without pieces too small or thin to use. Lots are
/// strips along the streets, cut across, in the spirit of the skeleton subdivision of Vanegas et al. 2012 ("Procedural
/// generation of parcels in urban modeling", section 4): each lot has a frontage, the lots of a block are disjoint, and land
/// too deep inside a block belongs to no lot. A block without room for a lot is a park. Buildings that come with the streets have lots
/// of their own; in a block that they fill well no others stand.
///
/// # Errors
///
/// [`LayerError::Cancelled`] when `cancel` is set.
pub fn divide(brief: &ParcelBrief<'_>, cancel: &Cancel) -> Result<CellParcels, LayerError> {
    let mut out = CellParcels::default();
    let mut ground = brief.ground.drawn();
    let works = earthworks(brief);
    let shapes = blocks(brief.border, brief.streets);
    cancel.check()?;
    for shape in shapes {
        let id = piece_id(brief.id.0, &shape.polygon);
        let mut rng = brief.seed.stream("parcel", &[brief.id.0, id]);
        let given = given(&shape, brief.buildings);
        let park = rng.chance(brief.rules.parks) && is_enclosed(&shape) && given.is_empty();
        let parcels = if park { Vec::new() } else { lots(&shape, brief.rules, &mut rng) };
        let parcels = if given.is_empty() { parcels } else { beside(&shape, &given, parcels) };
        let land_use = if parcels.is_empty() && given.is_empty() { BlockUse::Park } else { BlockUse::Built };
        let mut floor = |plan: &[DVec2]| {
            ground_floor(plan.iter().map(|p| works.height(*p, ground.height(brief.origin.to_plan(*p)))))
        };
        for Given { outline, street, building, .. } in given {
            let lot = piece_id(id, &outline);
            let mut rng = brief.seed.stream("parcel", &[brief.id.0, lot]);
            let known =
                building.storeys.or_else(|| building.height.map(|h| (h / STOREY_HEIGHT).round().max(1.0) as u32));
            let storeys = known.unwrap_or_else(|| storeys(brief.rules, brief.centrality, &mut rng));
            out.footprints.push(Footprint {
                id: stable_hash(&[lot, 1]),
                lot,
                base: floor(&outline),
                height: building.height.unwrap_or(f64::from(storeys) * STOREY_HEIGHT + PARAPET),
                polygon: outline.clone(),
                storeys,
            });
            out.lots.push(Lot { id: lot, block: id, polygon: outline, street: brief.streets[street].id });
        }
        out.blocks.push(Block { id, polygon: shape.polygon, land_use });
        for lot in parcels {
            let polygon: Vec<DVec2> = lot.polygon.iter().map(|p| quantize(*p)).collect();
            let lot_id = piece_id(id, &polygon);
            let mut rng = brief.seed.stream("parcel", &[brief.id.0, lot_id]);
            let built = !rng.chance(brief.rules.vacant);
            if let Some(plan) = built.then(|| footprint(&lot, brief.rules, &mut rng)).flatten() {
                let storeys = storeys(brief.rules, brief.centrality, &mut rng);
                out.footprints.push(Footprint {
                    id: stable_hash(&[lot_id, 1]),
                    lot: lot_id,
                    base: floor(&plan),
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

/// How the cell's streets shape the ground in it.
fn earthworks(brief: &ParcelBrief<'_>) -> Earthworks {
    let mut bed = brief.ground.dry(FREEBOARD);
    let streets: Vec<(&Street, Profile)> =
        brief.streets.iter().map(|s| (*s, Profile::new(s, brief.origin, |p| bed.height(p)))).collect();
    Earthworks::new(streets.iter().map(|(s, p)| (*s, p)), Bounds::of(brief.border.iter().copied()))
}

/// Whether there are streets on all sides of a block. Only such a block may become a park: elsewhere the town ends.
fn is_enclosed(shape: &BlockShape) -> bool {
    let n = shape.polygon.len();
    let edge = |i: usize| shape.polygon[i].distance(shape.polygon[(i + 1) % n]);
    (0..n).filter(|i| shape.fronts[*i].is_none()).map(edge).sum::<f64>() <= MOST_OPEN
}

/// The id of a piece of the land that `whole` names. Pieces of one whole are disjoint, so that no two have the same first edge.
fn piece_id(whole: u64, polygon: &[DVec2]) -> u64 {
    let ([x, y], [u, v]) = (quantum_key(polygon[0]), quantum_key(polygon[1]));
    stable_hash(&[whole, x, y, u, v])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::QUANTUM;
    use std::collections::BTreeSet;

    #[test]
    fn pieces_on_opposite_sides_of_the_origin_have_their_own_ids() {
        let at = |x: i32, y: i32| DVec2::new(f64::from(x), f64::from(y)) * QUANTUM;
        let piece = |x: i32, y: i32| [at(x, y), at(x + 9, y)];
        let ids: BTreeSet<u64> = (-9..9).flat_map(|x| (-9..9).map(move |y| piece_id(7, &piece(x, y)))).collect();
        assert_eq!(ids.len(), 18 * 18);
        // A point and its bitwise complement.
        assert_ne!(piece_id(7, &[at(5, 7), at(9, 7)]), piece_id(7, &[at(-6, -8), at(-10, -8)]));
    }
}
