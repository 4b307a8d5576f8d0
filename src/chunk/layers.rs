//! The layers below the chunk put together: towns, seams, streets and parcels with their caches, found by place.

use crate::chunk::PlacedStreet;
use crate::layer::{Cancel, LayerCache, LayerError, Reach, Weigh};
use crate::network::{Junction, JunctionId, Network, Street, StreetClass};
use crate::parcel::{self, CellParcels, ParcelBrief};
use crate::patch::PatchDatabase;
use crate::region::{Roads, Settlement, SettlementId, Settlements};
use crate::seam::{self, Seam};
use crate::space::{Bounds, Origin, Seed};
use crate::streets::{CellBrief, CellFiller, CellStreets, SemanticPatches};
use crate::terrain::Terrain;
use crate::town::{self, Filler, MainCell, Style, Town};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A style with the patches that it may use.
#[derive(Clone, Debug)]
pub struct StyleKit {
    /// The style.
    pub style: Arc<Style>,
    /// Its patches.
    pub patches: PatchDatabase,
}

/// A town with its seams.
#[derive(Clone, Debug)]
pub struct SeamedTown {
    /// Main streets and main cells.
    pub town: Town,
    /// Seams, one for each main street.
    pub seams: Vec<Seam>,
    /// The main streets divided at the ports.
    pub mains: Network,
}

/// Layers 1 to 7 of a world. Each thing is made once and kept while the cache of its layer has room.
pub struct Layers {
    seed: Seed,
    terrain: Arc<dyn Terrain>,
    settlements: Arc<Settlements>,
    roads: Roads,
    kits: BTreeMap<String, StyleKit>,
    towns: LayerCache<SettlementId, SeamedTown>,
    streets: LayerCache<(SettlementId, usize), CellStreets>,
    parcels: LayerCache<(SettlementId, usize), CellParcels>,
}

/// A street and the origin that it is local to.
#[derive(Clone, Debug)]
pub(crate) struct Found<T> {
    pub origin: Origin,
    pub it: T,
}

/// What overlaps a box.
#[derive(Default)]
pub(crate) struct Overlap {
    /// Streets, whole; each once.
    pub streets: Vec<Found<PlacedStreet>>,
    /// Junctions at their ends; each once.
    pub junctions: Vec<Found<Junction>>,
    /// Main cells, as town and index.
    pub cells: Vec<(Arc<SeamedTown>, usize)>,
    /// Settlements whose outline overlaps the box.
    pub settlements: Vec<Arc<Settlement>>,
}

impl Layers {
    /// The layers of a world. `kits` holds every style that a settlement may name; `town_bytes` bounds the memory of
    /// towns, streets and parcels together.
    pub fn new(
        seed: Seed,
        terrain: Arc<dyn Terrain>,
        settlements: Arc<Settlements>,
        roads: Roads,
        kits: BTreeMap<String, StyleKit>,
        town_bytes: usize,
    ) -> Self {
        let share = town_bytes / 4;
        Self {
            seed,
            terrain,
            settlements,
            roads,
            kits,
            towns: LayerCache::new(share),
            streets: LayerCache::new(share),
            parcels: LayerCache::new(2 * share),
        }
    }

    /// The ground.
    pub fn terrain(&self) -> &Arc<dyn Terrain> {
        &self.terrain
    }

    /// Settlements.
    pub fn settlements(&self) -> &Settlements {
        &self.settlements
    }

    /// Roads.
    pub fn roads(&self) -> &Roads {
        &self.roads
    }

    /// Bytes held by the caches of towns, streets and parcels.
    pub fn bytes(&self) -> u64 {
        self.towns.bytes() + self.streets.bytes() + self.parcels.bytes()
    }

    /// Forgets the streets and parcels of every main cell.
    pub fn forget_cells(&self) {
        self.streets.clear();
        self.parcels.clear();
    }

    fn kit(&self, settlement: &Settlement) -> Result<&StyleKit, LayerError> {
        self.kits.get(&settlement.style).ok_or_else(|| LayerError::UnknownStyle(settlement.style.clone()))
    }

    /// Main streets, main cells and seams of a settlement.
    pub fn town(&self, settlement: &Arc<Settlement>, cancel: &Cancel) -> Result<Arc<SeamedTown>, LayerError> {
        self.towns.get(&settlement.id, || {
            let kit = self.kit(settlement)?;
            let outline = self.settlements.outline(settlement)?;
            let gates = self.roads.gates(settlement, cancel)?;
            let town = town::plan(self.seed, settlement, &outline, gates, &kit.style, &*self.terrain, cancel)?;
            let seams = seam::seams(self.seed, &town, &kit.style);
            let mains = seam::main_network(&town, &seams);
            Ok(SeamedTown { town, seams, mains })
        })
    }

    /// Local streets of a main cell.
    pub fn streets(&self, town: &SeamedTown, cell: usize, cancel: &Cancel) -> Result<Arc<CellStreets>, LayerError> {
        let plan = &town.town;
        self.streets.get(&(plan.settlement.id, cell), || {
            let kit = self.kit(&plan.settlement)?;
            let of = &plan.cells[cell];
            let brief = CellBrief {
                seed: self.seed,
                id: of.id,
                border: &of.border,
                street_half_width: &border_widths(plan, of),
                ports: &seam::cell_ports(plan, &town.seams, cell),
                field: &plan.field,
                style: &kit.style,
                patches: &kit.patches,
            };
            match kit.style.filler {
                Filler::SemanticPatches => SemanticPatches.fill(&brief, cancel),
            }
        })
    }

    /// Blocks, lots and footprints of a main cell.
    pub fn parcels(&self, town: &SeamedTown, cell: usize, cancel: &Cancel) -> Result<Arc<CellParcels>, LayerError> {
        let plan = &town.town;
        self.parcels.get(&(plan.settlement.id, cell), || {
            let local = self.streets(town, cell, cancel)?;
            let of = &plan.cells[cell];
            let near = Bounds::of(of.border.iter().copied()).grown(StreetClass::Highway.half_width());
            let mains = town.mains.streets.iter().filter(|s| s.bounds().overlaps(near));
            let streets: Vec<&Street> = mains.chain(local.streets.iter().map(|s| &s.street)).collect();
            let brief = ParcelBrief {
                seed: self.seed,
                id: of.id,
                border: &of.border,
                streets: &streets,
                rules: &self.kit(&plan.settlement)?.style.parcels,
                centrality: (1.0 - of.anchor.length() / plan.settlement.radius).clamp(0.0, 1.0),
            };
            parcel::divide(&brief, cancel)
        })
    }

    /// Everything that overlaps `bounds` (plan metres), parcels excepted; `reach` says how far the caller may read.
    pub(crate) fn overlapping(&self, bounds: Bounds, reach: &Reach, cancel: &Cancel) -> Result<Overlap, LayerError> {
        let bounds = reach.check(bounds)?;
        let mut out = Overlap::default();
        let mut seen = BTreeSet::new();
        let mut put_street = |out: &mut Overlap, origin: Origin, it: PlacedStreet| {
            if it.street.bounds().moved(origin.plan()).overlaps(bounds) {
                for (id, at) in [(it.street.from, it.street.line.first()), (it.street.to, it.street.line.last())] {
                    if let Some(&at) = at
                        && seen.insert(id)
                    {
                        out.junctions.push(Found { origin, it: Junction { id, at } });
                    }
                }
                out.streets.push(Found { origin, it });
            }
        };
        for road in self.roads.overlapping(bounds, cancel)? {
            put_street(&mut out, road.origin, PlacedStreet { street: road.street.clone(), made_by: None });
        }
        for settlement in self.settlements.overlapping(bounds)? {
            cancel.check()?;
            if !self.settlements.outline(&settlement)?.bounds().overlaps(bounds) {
                continue;
            }
            let town = self.town(&settlement, cancel)?;
            let origin = town.town.origin;
            for street in &town.mains.streets {
                put_street(&mut out, origin, PlacedStreet { street: street.clone(), made_by: None });
            }
            for (i, cell) in town.town.cells.iter().enumerate() {
                if !Bounds::of(cell.border.iter().copied()).moved(origin.plan()).overlaps(bounds) {
                    continue;
                }
                cancel.check()?;
                for local in &self.streets(&town, i, cancel)?.streets {
                    let placed = PlacedStreet { street: local.street.clone(), made_by: Some(local.made_by) };
                    put_street(&mut out, origin, placed);
                }
                out.cells.push((town.clone(), i));
            }
            out.settlements.push(settlement);
        }
        out.streets.sort_by_key(|s| s.it.street.id);
        out.junctions.sort_by_key(|j| j.it.id);
        Ok(out)
    }
}

/// Half the width of the street along each border edge of a cell.
fn border_widths(town: &Town, cell: &MainCell) -> Vec<Option<f64>> {
    let mut widths = vec![None; cell.border.len()];
    for side in &cell.sides {
        let width = side.main.map(|m| town.mains[m].street.class.half_width());
        for edge in side.first..side.first + side.count {
            widths[edge % cell.border.len()] = width;
        }
    }
    widths
}

impl Weigh for SeamedTown {
    fn bytes(&self) -> usize {
        let point = size_of::<DVec2>();
        let cells: usize = self.town.cells.iter().map(|c| 200 + c.border.len() * point).sum();
        let mains: usize = self.town.mains.iter().map(|m| 200 + m.street.line.len() * point).sum();
        let ports: usize = self.seams.iter().map(|s| 24 + s.ports.len() * size_of::<seam::Port>()).sum();
        cells + mains + ports + weigh_network(&self.mains) + self.town.outline.polygon.len() * point
    }
}

impl Weigh for CellStreets {
    fn bytes(&self) -> usize {
        let streets: usize = self.streets.iter().map(|s| 120 + s.street.line.len() * size_of::<DVec2>()).sum();
        streets + self.junctions.len() * size_of::<Junction>() + self.unmet.len() * size_of::<JunctionId>()
    }
}

impl Weigh for CellParcels {
    fn bytes(&self) -> usize {
        let points = self.blocks.iter().map(|b| &b.polygon).chain(self.lots.iter().map(|l| &l.polygon));
        points.chain(self.footprints.iter().map(|f| &f.polygon)).map(|p| 64 + p.len() * size_of::<DVec2>()).sum()
    }
}

fn weigh_network(network: &Network) -> usize {
    let streets: usize = network.streets.iter().map(|s| 112 + s.line.len() * size_of::<DVec2>()).sum();
    streets + network.junctions.len() * size_of::<Junction>()
}
