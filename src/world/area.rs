//! Everything in a box, whoever owns it.

use crate::layer::{Cancel, LayerError, Reach};
use crate::network::{Junction, Network};
use crate::parcel::{Block, Footprint, Lot};
use crate::region::{Outline, Settlement};
use crate::space::{Bounds, ChunkCoord, Origin};
use crate::stack::{PlacedStreet, Stack, owner_of, street_owner};
use crate::streets::{Exception, ShortCount};
use std::collections::BTreeSet;
use std::sync::Arc;

/// A thing and the chunk that owns it.
#[derive(Clone, Debug, PartialEq)]
pub struct Owned<T> {
    /// The chunk that owns the thing.
    pub chunk: ChunkCoord,
    /// The thing.
    pub item: T,
}

/// Everything that overlaps a box. Positions are local to `origin`.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// The whole-metre point below the middle of the box.
    pub origin: Origin,
    /// The box that was asked for, in plan metres.
    pub bounds: Bounds,
    /// Streets and roads that overlap the box, whole; sorted by id.
    pub streets: Vec<Owned<PlacedStreet>>,
    /// Junctions at the ends of `streets`, wherever they lie; sorted by id.
    pub junctions: Vec<Owned<Junction>>,
    /// Blocks of the main cells that overlap the box.
    pub blocks: Vec<Owned<Block>>,
    /// Lots of `blocks`.
    pub lots: Vec<Owned<Lot>>,
    /// Buildings on `lots`.
    pub footprints: Vec<Owned<Footprint>>,
    /// Settlements whose outline overlaps the box, sorted by id.
    pub settlements: Vec<Arc<Settlement>>,
    /// Outlines of `settlements` in the same order, each local to its settlement.
    pub outlines: Vec<Arc<Outline>>,
    /// Number of unmet ports in the main cells that overlap the box.
    pub unmet_ports: usize,
    /// Where the streets of these cells break a rule of their style.
    pub exceptions: Vec<Exception>,
    /// The counts of styles that the towns of these cells do not keep.
    pub short_counts: Vec<ShortCount>,
    /// Names of pieces that should stand in these cells because a style counts them, and that no street could reach.
    pub missing: Vec<Arc<str>>,
}

impl Area {
    /// An area of `bounds` (plan metres) that holds nothing. Positions are local to the middle of the box.
    pub(crate) fn empty(bounds: Bounds) -> Self {
        Self {
            origin: Origin::at(bounds.centre()),
            bounds,
            streets: Vec::new(),
            junctions: Vec::new(),
            blocks: Vec::new(),
            lots: Vec::new(),
            footprints: Vec::new(),
            settlements: Vec::new(),
            outlines: Vec::new(),
            unmet_ports: 0,
            exceptions: Vec::new(),
            short_counts: Vec::new(),
            missing: Vec::new(),
        }
    }

    pub(super) fn gather(stack: &Stack, bounds: Bounds, size: i64, cancel: &Cancel) -> Result<Self, LayerError> {
        let overlap = stack.overlapping(bounds, &Reach::new("area", bounds, 0.0), cancel)?;
        let outlines = overlap.settlements.iter().map(|s| stack.settlements().outline(s)).collect::<Result<_, _>>()?;
        let mut area = Self { settlements: overlap.settlements, outlines, ..Self::empty(bounds) };
        let origin = area.origin;
        for found in overlap.streets {
            let chunk = street_owner(found.origin, &found.item.street, size);
            area.streets.push(Owned { chunk, item: found.item.moved(found.origin.offset_to(origin)) });
        }
        for found in overlap.junctions {
            let at = found.item.at + found.origin.offset_to(origin);
            area.junctions.push(Owned { chunk: owner_of(origin, at, size), item: Junction { at, ..found.item } });
        }
        let mut towns = BTreeSet::new();
        for (town, cell) in overlap.cells {
            cancel.check()?;
            let (from, offset) = (town.town.origin, town.town.origin.offset_to(origin));
            let chunk = owner_of(from, town.town.cells[cell].anchor, size);
            let streets = stack.streets(&town, cell, cancel)?;
            area.unmet_ports += streets.unmet.len();
            area.missing.extend(streets.missing.iter().cloned());
            if towns.insert(town.town.settlement.id) {
                area.short_counts.extend(town.short_counts.iter().cloned());
            }
            area.exceptions.extend(streets.exceptions.iter().map(|e| Exception { at: e.at + offset, ..*e }));
            let parcels = stack.parcels(&town, cell, cancel)?;
            area.blocks.extend(parcels.blocks.iter().map(|b| Owned { chunk, item: b.moved(offset) }));
            area.lots.extend(parcels.lots.iter().map(|l| Owned { chunk, item: l.moved(offset) }));
            area.footprints.extend(parcels.footprints.iter().map(|f| Owned { chunk, item: f.moved(offset) }));
        }
        Ok(area)
    }

    /// The streets and junctions of the area.
    pub fn network(&self) -> Network {
        Network {
            junctions: self.junctions.iter().map(|j| j.item).collect(),
            streets: self.streets.iter().map(|s| s.item.street.clone()).collect(),
        }
    }
}
