//! Assembling a chunk from the layers below.

use crate::chunk::{Chunk, Ground};
use crate::layer::{Cancel, LayerError, Reach, Weigh};
use crate::network::{Junction, JunctionId, Side, Street, StreetClass};
use crate::parcel::{Block, Footprint, Lot};
use crate::space::{Bounds, ChunkCoord, Origin};
use crate::stack::{Stack, owner_of, street_owner};
use crate::surface::{Deck, Earthworks, Graded, Pieces, Profile, SURFACE_REACH, Tin, shapes};
use crate::terrain::{DrawnGround, GROUND_STEP};
use glam::DVec2;

/// Gathers what the chunk `coord` of edge `size` metres owns. Traffic drives on the side `driving`.
///
/// # Errors
///
/// [`LayerError::Cancelled`] when `cancel` is set.
pub fn assemble(
    stack: &Stack,
    coord: ChunkCoord,
    size: i64,
    driving: Side,
    cancel: &Cancel,
) -> Result<Chunk, LayerError> {
    let (origin, bounds) = (coord.origin(size), coord.bounds(size));
    let reach = Reach::new("chunk", bounds, SURFACE_REACH);
    let overlap = stack.overlapping(bounds.grown(SURFACE_REACH), &reach, cancel)?;
    let ground = Ground::of_vertices(stack.ground().vertices(), origin, size);
    let mut chunk = Chunk::empty(coord, size, ground);
    for settlement in overlap.settlements {
        if stack.settlements().outline(&settlement)?.bounds().overlaps(bounds) {
            chunk.settlements.push(settlement);
        }
    }
    for found in overlap.junctions {
        if owner_of(found.origin, found.item.at, size) == coord {
            chunk.junctions.push(Junction { at: found.item.at + found.origin.offset_to(origin), ..found.item });
        }
    }
    let mut dry = stack.road_bed();
    let mut graded: Vec<Graded> = Vec::with_capacity(overlap.streets.len());
    for found in overlap.streets {
        let offset = found.origin.offset_to(origin);
        let street = found.item.street.moved(offset);
        let profile = if street.bridge {
            let deck = deck(stack, &street, origin, &mut dry, cancel)?;
            let profile = deck.profile.clone();
            if street.bounds().overlaps(bounds.moved(-origin.plan()).grown(widest_deck())) {
                chunk.decks.push(deck);
            }
            profile
        } else {
            Profile::new(&street, origin, |p| dry.height(p))
        };
        graded.push(Graded { street: street.clone(), profile });
        if street_owner(found.origin, &found.item.street, size) == coord {
            chunk.streets.push(found.item.moved(offset));
        } else if [street.from, street.to].iter().any(|end| own_junction(&chunk, *end)) {
            chunk.arriving.push(street);
        } else if chunk.own_pieces(&Pieces::new(&street)).next().is_some() {
            chunk.passing.push(street);
        }
    }
    cancel.check()?;
    chunk.tin = tin(&chunk, &graded, driving);
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

/// Ground and streets of a chunk's square. `graded` are the streets within [`SURFACE_REACH`] of it, sorted by id.
pub fn tin(chunk: &Chunk, graded: &[Graded], driving: Side) -> Tin {
    let square = Bounds::new(DVec2::ZERO, DVec2::splat(chunk.size as f64));
    let works = Earthworks::new(graded.iter().map(|g| (&g.street, &g.profile)), square);
    Tin::new(&shapes(graded, square, driving), chunk.size, |column, row| {
        let p = DVec2::new(column as f64, row as f64) * GROUND_STEP;
        works.height(p, chunk.ground.vertex(column, row).height)
    })
}

fn deck(
    stack: &Stack,
    bridge: &Street,
    origin: Origin,
    dry: &mut DrawnGround<'_>,
    cancel: &Cancel,
) -> Result<Deck, LayerError> {
    let mut below = Vec::new();
    if bridge.level > 0 {
        for street in passed_over(stack, bridge, origin, cancel)? {
            let profile = Profile::new(&street, origin, |p| dry.height(p));
            below.push((street, profile));
        }
    }
    Ok(Deck::new(bridge, origin, &below, |p| dry.height(p)))
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
        streets
            + blocks
            + lots
            + buildings
            + decks
            + ground
            + self.tin.bytes()
            + self.junctions.len() * size_of::<Junction>()
            + 256
    }
}
