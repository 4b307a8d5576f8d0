//! Everything that overlaps a box, whoever owns it.

use super::layers::Stack;
use super::placed::{AtOrigin, PlacedStreet};
use super::town::SeamedTown;
use crate::layer::{Cancel, LayerError, Reach};
use crate::network::{Junction, Street, StreetId};
use crate::region::Settlement;
use crate::space::{Bounds, Origin};
use std::collections::BTreeSet;
use std::sync::Arc;

/// What overlaps a box.
#[derive(Default)]
pub struct Overlap {
    /// Streets, whole, each once, sorted by id.
    pub streets: Vec<AtOrigin<PlacedStreet>>,
    /// Junctions at the ends of `streets`, each once, sorted by id.
    pub junctions: Vec<AtOrigin<Junction>>,
    /// Main cells, as a town and the cell's index.
    pub cells: Vec<(Arc<SeamedTown>, usize)>,
    /// Settlements whose outline overlaps the box.
    pub settlements: Vec<Arc<Settlement>>,
}

impl Stack {
    /// Everything that overlaps `bounds` (plan metres), except parcels. `reach` says how far the caller may read; reading
    /// beyond it is an error.
    pub fn overlapping(&self, bounds: Bounds, reach: &Reach, cancel: &Cancel) -> Result<Overlap, LayerError> {
        let bounds = reach.check(bounds)?;
        let mut out = Overlap::default();
        let (mut seen, mut borders) = (BTreeSet::new(), BTreeSet::new());
        let mut put_street = |out: &mut Overlap, origin: Origin, placed: PlacedStreet| {
            if placed.street.bounds().moved(origin.plan()).overlaps(bounds) {
                for (id, at) in
                    [(placed.street.from, placed.street.line.first()), (placed.street.to, placed.street.line.last())]
                {
                    if let Some(&at) = at
                        && seen.insert(id)
                    {
                        out.junctions.push(AtOrigin { origin, item: Junction { id, at } });
                    }
                }
                out.streets.push(AtOrigin { origin, item: placed });
            }
        };
        for road in self.roads().overlapping(bounds, cancel)? {
            put_street(&mut out, road.origin, PlacedStreet { street: road.street.clone(), made_by: None });
        }
        for settlement in self.settlements.overlapping(bounds)? {
            cancel.check()?;
            if !self.settlements.outline(&settlement)?.bounds().overlaps(bounds) {
                continue;
            }
            let town = self.town(&settlement, cancel)?;
            let origin = town.town.origin;
            for AtOrigin { origin, item: street } in main_streets(&town, &mut borders) {
                put_street(&mut out, origin, PlacedStreet { street, made_by: None });
            }
            for (i, cell) in town.town.cells.iter().enumerate() {
                if !Bounds::of(cell.border.iter().copied()).moved(origin.plan()).overlaps(bounds) {
                    continue;
                }
                cancel.check()?;
                for local in &self.streets(&town, i, cancel)?.streets {
                    let placed = PlacedStreet { street: local.street.clone(), made_by: Some(local.made_by.clone()) };
                    put_street(&mut out, origin, placed);
                }
                out.cells.push((town.clone(), i));
            }
            out.settlements.push(settlement);
        }
        out.streets.sort_by_key(|s| s.item.street.id);
        out.junctions.sort_by_key(|j| j.item.id);
        Ok(out)
    }

    /// Bridges whose centre lines come near `bounds` (plan metres), each once, sorted by id. Only roads and main streets have
    /// bridges. `reach` says how far the caller may read; reading beyond it is an error.
    pub fn bridges(&self, bounds: Bounds, reach: &Reach, cancel: &Cancel) -> Result<Vec<AtOrigin<Street>>, LayerError> {
        let bounds = reach.check(bounds)?;
        let mut out: Vec<AtOrigin<Street>> = Vec::new();
        for road in self.roads().overlapping(bounds, cancel)?.iter().filter(|r| r.street.bridge) {
            out.push(AtOrigin { origin: road.origin, item: road.street.clone() });
        }
        let mut borders = BTreeSet::new();
        for settlement in self.settlements.overlapping(bounds)? {
            if self.settlements.outline(&settlement)?.bounds().overlaps(bounds) {
                let town = self.town(&settlement, cancel)?;
                out.extend(main_streets(&town, &mut borders).filter(|s| s.item.bridge));
            }
        }
        out.retain(|s| s.item.bounds().moved(s.origin.plan()).overlaps(bounds));
        out.sort_by_key(|s| s.item.id);
        Ok(out)
    }
}

/// The main streets of a town, except streets of borders that are in `borders` already; adds the town's own to them.
fn main_streets<'a>(
    town: &'a SeamedTown,
    borders: &'a mut BTreeSet<StreetId>,
) -> impl Iterator<Item = AtOrigin<Street>> + 'a {
    let origin = town.town.origin;
    town.mains.streets.iter().filter_map(move |street| {
        // Both towns at a border give the same bits, so it does not matter which of the two comes first.
        let shared = town.shared.get(&street.id);
        let new = shared.is_none() || borders.insert(street.id);
        let at = shared.copied().unwrap_or(origin);
        new.then(|| AtOrigin { origin: at, item: street.moved(origin.offset_to(at)) })
    })
}
