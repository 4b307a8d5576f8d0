//! Assembling a chunk from the layers below.

use crate::chunk::{Chunk, Ground};
use crate::layer::{Cancel, LayerError, Reach, Weigh};
use crate::network::{Junction, JunctionId, Street, StreetClass};
use crate::parcel::{Block, Footprint, Lot};
use crate::space::{ChunkCoord, Origin};
use crate::stack::{Stack, owner_of, street_owner};
use crate::surface::{Deck, Pieces};
use glam::DVec2;

/// Least height of a deck above water, in metres.
const DECK_CLEARANCE: f64 = 1.0;

/// Gathers what the chunk `coord` of edge `size` metres owns.
///
/// # Errors
///
/// [`LayerError::Cancelled`] when `cancel` is set.
pub fn assemble(stack: &Stack, coord: ChunkCoord, size: i64, cancel: &Cancel) -> Result<Chunk, LayerError> {
    let (origin, bounds) = (coord.origin(size), coord.bounds(size));
    let reach = Reach::new("chunk", bounds, widest_deck());
    let overlap = stack.overlapping(bounds, &reach, cancel)?;
    let ground = Ground::of_vertices(stack.ground().vertices(), origin, size);
    let mut chunk = Chunk { settlements: overlap.settlements, ..Chunk::empty(coord, size, ground) };
    for found in overlap.junctions {
        if owner_of(found.origin, found.item.at, size) == coord {
            chunk.junctions.push(Junction { at: found.item.at + found.origin.offset_to(origin), ..found.item });
        }
    }
    for bridge in stack.bridges(bounds.grown(widest_deck()), &reach, cancel)? {
        let mut drawn = stack.ground().drawn();
        let floor = |p| {
            let plan = origin.to_plan(p);
            let (ground, sample) = (drawn.height(plan), stack.terrain().sample(plan));
            if sample.depth() > 0.0 { ground.max(sample.water_level + DECK_CLEARANCE) } else { ground }
        };
        let street = bridge.item.moved(bridge.origin.offset_to(origin));
        let below = if street.level > 0 { passed_over(stack, &street, origin, cancel)? } else { Vec::new() };
        chunk.decks.push(Deck::new(&street, &below, floor));
    }
    for found in overlap.streets {
        let offset = found.origin.offset_to(origin);
        if street_owner(found.origin, &found.item.street, size) == coord {
            chunk.streets.push(found.item.moved(offset));
            continue;
        }
        let street = found.item.street;
        if [street.from, street.to].iter().any(|end| own_junction(&chunk, *end)) {
            chunk.arriving.push(street.moved(offset));
        } else {
            let street = street.moved(offset);
            if chunk.own_pieces(&Pieces::new(&street)).next().is_some() {
                chunk.passing.push(street);
            }
        }
    }
    for (town, cell) in overlap.cells {
        cancel.check()?;
        let from = town.town.origin;
        if owner_of(from, town.town.cells[cell].anchor, size) != coord {
            continue;
        }
        chunk.unmet_ports += stack.streets(&town, cell, cancel)?.unmet.len();
        let parcels = stack.parcels(&town, cell, cancel)?;
        let offset = from.offset_to(origin);
        chunk.blocks.extend(parcels.blocks.iter().map(|b| b.moved(offset)));
        chunk.lots.extend(parcels.lots.iter().map(|l| l.moved(offset)));
        chunk.footprints.extend(parcels.footprints.iter().map(|f| f.moved(offset)));
    }
    Ok(chunk)
}

/// Roads below a bridge, whole and local to `origin`: every chunk under the bridge finds the same roads.
fn passed_over(stack: &Stack, bridge: &Street, origin: Origin, cancel: &Cancel) -> Result<Vec<Street>, LayerError> {
    let near = stack.roads().overlapping(bridge.bounds().moved(origin.plan()), cancel)?;
    let lower = near.iter().filter(|r| r.street.level < bridge.level && !r.street.tunnel);
    Ok(lower.map(|r| r.street.moved(r.origin.offset_to(origin))).collect())
}

/// Half the width of the widest bridge, in metres.
fn widest_deck() -> f64 {
    StreetClass::ALL.map(StreetClass::half_width).into_iter().fold(0.0, f64::max)
}

fn own_junction(chunk: &Chunk, id: JunctionId) -> bool {
    chunk.junctions.binary_search_by_key(&id, |j| j.id).is_ok()
}

impl Weigh for Chunk {
    fn bytes(&self) -> usize {
        let point = size_of::<DVec2>();
        let streets: usize = self.streets_here().map(Street::bytes).sum();
        let blocks: usize = self.blocks.iter().map(|b| size_of::<Block>() + b.polygon.len() * point).sum();
        let lots: usize = self.lots.iter().map(|l| size_of::<Lot>() + l.polygon.len() * point).sum();
        let buildings: usize = self.footprints.iter().map(|f| size_of::<Footprint>() + f.polygon.len() * point).sum();
        let decks: usize = self.decks.iter().map(|d| 64 + d.line.len() * (point + size_of::<f64>())).sum();
        let ground = self.ground.samples.len() * size_of::<crate::terrain::TerrainSample>();
        streets + blocks + lots + buildings + decks + ground + self.junctions.len() * size_of::<Junction>() + 256
    }
}
