//! The layers below the chunk put together: towns, seams, streets and parcels, each made once and cached.

use super::kits::{CellStyle, Kits, Spread, StyleKit};
use super::town::{Planned, SeamedTown};
use crate::edits::PatchEdit;
use crate::layer::{Cancel, LayerCache, LayerError};
use crate::network::{JunctionId, Street, StreetClass};
use crate::parcel::{self, CellParcels, ParcelBrief};
use crate::patch::PatchSet;
use crate::region::{Roads, Settlement, SettlementId, Settlements};
use crate::seam::{self, Across};
use crate::space::{Bounds, Seed};
use crate::streets::{CellBrief, CellFiller, CellStreets, SemanticPatches};
use crate::style::{Filler, ParcelRules, Style};
use crate::terrain::Terrain;
use crate::town::{self, CellUse, MainCell, Town};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Layers 1 to 8 of a world, with their caches. Each thing is made once and kept while the cache of its layer has room.
pub struct Stack {
    pub(super) seed: Seed,
    terrain: Arc<dyn Terrain>,
    pub(super) settlements: Arc<Settlements>,
    roads: Roads,
    pub(super) kits: Kits,
    pub(super) pins: Vec<PatchEdit>,
    plans: LayerCache<SettlementId, Planned>,
    towns: LayerCache<SettlementId, SeamedTown>,
    streets: LayerCache<(SettlementId, usize), CellStreets>,
    parcels: LayerCache<(SettlementId, usize), CellParcels>,
}

/// What a [`Stack`] is made of.
pub struct StackParts {
    /// The seed.
    pub seed: Seed,
    /// The ground.
    pub terrain: Arc<dyn Terrain>,
    /// The settlements on it.
    pub settlements: Arc<Settlements>,
    /// The roads between them.
    pub roads: Roads,
    /// Every style that a settlement or another style may name, with its patches.
    pub kits: BTreeMap<String, StyleKit>,
    /// Every patch set.
    pub sets: BTreeMap<String, Arc<PatchSet>>,
    /// The patches that the user pinned.
    pub pins: Vec<PatchEdit>,
    /// Bound of the memory of towns, streets and parcels together, in bytes.
    pub bytes: usize,
}

impl Stack {
    /// The layers of a world.
    pub fn new(parts: StackParts) -> Self {
        let StackParts { seed, terrain, settlements, roads, kits, sets, pins, bytes } = parts;
        let share = bytes / 4;
        Self {
            seed,
            terrain,
            settlements,
            roads,
            kits: Kits::new(kits, sets),
            pins,
            plans: LayerCache::new(share / 4),
            towns: LayerCache::new(share / 4 * 3),
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
        self.plans.bytes() + self.towns.bytes() + self.streets.bytes() + self.parcels.bytes()
    }

    /// Forgets the streets and parcels of every main cell.
    pub fn forget_cells(&self) {
        self.streets.clear();
        self.parcels.clear();
    }

    /// Main streets and main cells of a settlement.
    pub fn plan(&self, settlement: &Arc<Settlement>, cancel: &Cancel) -> Result<Arc<Town>, LayerError> {
        Ok(self.planned(settlement, cancel)?.town.clone())
    }

    fn planned(&self, settlement: &Arc<Settlement>, cancel: &Cancel) -> Result<Arc<Planned>, LayerError> {
        self.plans.get(&settlement.id, || {
            let outline = self.settlements.outline(settlement)?;
            let gates = self.roads.gates(settlement, cancel)?;
            let style = &self.kits.of(&settlement.style)?.style;
            let town = town::plan(self.seed, settlement, &outline, gates, style, &*self.terrain, cancel)?;
            let own = self.kits.spread(settlement, &outline)?;
            let mut across: Vec<(Spread, _)> = Vec::new();
            for other in self.settlements.touching(settlement)? {
                let there = self.settlements.outline(&other)?;
                for shared in outline.shared.iter().filter(|s| s.border.sides.contains(&other.id)) {
                    across.push((self.kits.spread(&other, &there)?, shared.border.clone()));
                }
            }
            let mut cells = Vec::with_capacity(town.cells.len());
            for cell in &town.cells {
                let blend = own.blend(cell.anchor, &across);
                let style = self.kits.mix(self.seed, cell.id, &blend, &[])?;
                cells.push((blend, style));
            }
            Ok(Planned { town: Arc::new(town), cells })
        })
    }

    /// Main streets, main cells and seams of a settlement.
    pub fn town(&self, settlement: &Arc<Settlement>, cancel: &Cancel) -> Result<Arc<SeamedTown>, LayerError> {
        self.towns.get(&settlement.id, || {
            let plan = self.planned(settlement, cancel)?;
            let mut touched = Vec::new();
            for other in self.settlements.touching(settlement)? {
                touched.push(self.planned(&other, cancel)?);
            }
            fn styles(plan: &Planned) -> Vec<&Style> {
                plan.cells.iter().map(|(_, cell)| &*cell.style).collect()
            }
            let theirs: Vec<Vec<&Style>> = touched.iter().map(|plan| styles(plan)).collect();
            let across: Vec<Across> =
                touched.iter().zip(&theirs).map(|(plan, styles)| Across { town: &plan.town, styles }).collect();
            let seams = seam::seams(self.seed, &plan.town, &styles(&plan), &across);
            let mains = seam::main_network(&plan.town, &seams);
            let shared = seam::shared_streets(&plan.town, &seams);
            let cells = plan.cells.iter().map(|(_, cell)| cell.clone()).collect();
            let mut town = SeamedTown { town: plan.town.clone(), cells, seams, mains, shared };
            self.pin(&mut town, &plan)?;
            Ok(town)
        })
    }

    /// Gives `use_it` the brief of a main cell.
    pub(super) fn brief<T>(
        &self,
        town: &SeamedTown,
        cell: usize,
        with: &CellStyle,
        use_it: impl FnOnce(&CellBrief) -> T,
    ) -> T {
        let (plan, of) = (&town.town, &town.town.cells[cell]);
        use_it(&CellBrief {
            seed: self.seed,
            id: of.id,
            border: &of.border,
            street_half_width: &border_widths(plan, of),
            ports: &seam::cell_ports(plan, &town.seams, cell),
            field: &plan.field,
            style: &with.style,
            patches: &with.patches,
            weights: &with.weights,
            pinned: &with.pinned,
        })
    }

    /// Local streets of a main cell.
    pub fn streets(&self, town: &SeamedTown, cell: usize, cancel: &Cancel) -> Result<Arc<CellStreets>, LayerError> {
        let plan = &town.town;
        self.streets.get(&(plan.settlement.id, cell), || {
            if plan.cells[cell].used_as != CellUse::Built {
                return Ok(CellStreets::default());
            }
            let with = &town.cells[cell];
            self.brief(town, cell, with, |brief| match with.style.filler {
                Filler::SemanticPatches => SemanticPatches.fill(brief, cancel),
            })
        })
    }

    /// Blocks, lots and footprints of a main cell.
    pub fn parcels(&self, town: &SeamedTown, cell: usize, cancel: &Cancel) -> Result<Arc<CellParcels>, LayerError> {
        let plan = &town.town;
        self.parcels.get(&(plan.settlement.id, cell), || {
            let local = self.streets(town, cell, cancel)?;
            let of = &plan.cells[cell];
            if of.used_as == CellUse::Water {
                return Ok(CellParcels::default());
            }
            let near = Bounds::of(of.border.iter().copied()).grown(StreetClass::Highway.half_width());
            let mains = town.mains.streets.iter().filter(|s| s.bounds().overlaps(near));
            let across = self.streets_across(plan, near, cancel)?;
            let streets: Vec<&Street> = mains.chain(local.streets.iter().map(|s| &s.street)).chain(&across).collect();
            let rules = &town.cells[cell].style.parcels;
            let park = ParcelRules { parks: 1.0, ..rules.clone() };
            let brief = ParcelBrief {
                seed: self.seed,
                id: of.id,
                border: &of.border,
                streets: &streets,
                rules: if of.used_as == CellUse::Open { &park } else { rules },
                centrality: (1.0 - of.anchor.length() / plan.settlement.radius).clamp(0.0, 1.0),
            };
            parcel::divide(&brief, cancel)
        })
    }

    /// Main streets of other towns that meet this one's in a gate on their border, near a box; all local to this town.
    fn streets_across(&self, town: &Town, near: Bounds, cancel: &Cancel) -> Result<Vec<Street>, LayerError> {
        let mut out = Vec::new();
        for shared in &town.outline.shared {
            let border = &shared.border;
            let shift = border.origin.offset_to(town.origin);
            if !Bounds::of(border.line.iter().map(|p| *p + shift)).overlaps(near) {
                continue;
            }
            let gates: Vec<JunctionId> = (0..border.gates.len()).map(|i| border.junction(i)).collect();
            for other in self.settlements.touching(&town.settlement)? {
                if !border.sides.contains(&other.id) {
                    continue;
                }
                let there = self.town(&other, cancel)?;
                let meets = |s: &&Street| gates.contains(&s.from) || gates.contains(&s.to);
                for s in there.mains.streets.iter().filter(meets).filter(|s| !there.shared.contains_key(&s.id)) {
                    let street = s.moved(there.town.origin.offset_to(town.origin));
                    out.extend(street.bounds().overlaps(near).then_some(street));
                }
            }
        }
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
