//! The layers below the chunk, composed: towns, seams, streets and parcels, each made once and cached.

use super::brief::CellEdges;
use super::styles::{StyledTown, Styles};
use super::town::{Planned, SeamedTown};
use crate::edits::PatchEdit;
use crate::layer::{Cancel, LayerCache, LayerError};
use crate::network::{JunctionId, Street, StreetClass};
use crate::parcel::{self, CellParcels, ParcelBrief};
use crate::patch::PatchSet;
use crate::region::{Roads, Settlement, SettlementId, Settlements};
use crate::seam::{self, TownAndStyles};
use crate::space::{Bounds, Seed};
use crate::streets::{CellStreets, Fillers};
use crate::style::{ParcelRules, Style};
use crate::surface::FREEBOARD;
use crate::terrain::{DrawnGround, GroundTiles, Terrain};
use crate::town::{self, CellUse, Town};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Layers 1 to 8 of a world, with their caches. Each thing is made once and kept while the cache of its layer has room.
///
/// Methods with a [`Cancel`] fail with [`LayerError::Cancelled`] once it is set.
pub struct Stack {
    pub(super) seed: Seed,
    ground: GroundTiles,
    pub(super) settlements: Arc<Settlements>,
    roads: Arc<Roads>,
    pub(super) styles: Styles,
    pub(super) fillers: Fillers,
    pub(super) pins: Vec<PatchEdit>,
    plans: LayerCache<SettlementId, Planned>,
    towns: LayerCache<SettlementId, SeamedTown>,
    cells: LayerCache<(SettlementId, usize), CellStreets>,
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
    pub roads: Arc<Roads>,
    /// Every style that a settlement or another style may name, by name.
    pub styles: BTreeMap<String, Arc<Style>>,
    /// Every patch set, by name.
    pub sets: BTreeMap<String, Arc<PatchSet>>,
    /// The patches that the user pinned.
    pub pins: Vec<PatchEdit>,
    /// Most memory for the ground, towns, streets and parcels together, in bytes.
    pub bytes: usize,
}

impl Stack {
    /// The layers of a world.
    pub fn new(parts: StackParts) -> Self {
        let StackParts { seed, terrain, settlements, roads, styles, sets, pins, bytes } = parts;
        let share = bytes / 4;
        Self {
            seed,
            ground: GroundTiles::new(terrain, share / 2),
            settlements,
            roads,
            fillers: Fillers::new(&styles, &sets),
            styles: Styles(styles),
            pins,
            plans: LayerCache::new(share / 4),
            towns: LayerCache::new(share / 4 * 3),
            cells: LayerCache::new(share),
            parcels: LayerCache::new(3 * share / 2),
        }
    }

    /// The ground.
    pub fn terrain(&self) -> &Arc<dyn Terrain> {
        self.ground.terrain()
    }

    /// The vertices of the drawn ground.
    pub fn ground(&self) -> &GroundTiles {
        &self.ground
    }

    /// The heights that streets follow: the natural ground, and a little above the water where there is water.
    pub fn road_bed(&self) -> DrawnGround<'_> {
        self.ground.dry(FREEBOARD)
    }

    /// The settlements.
    pub fn settlements(&self) -> &Arc<Settlements> {
        &self.settlements
    }

    /// The roads.
    pub fn roads(&self) -> &Arc<Roads> {
        &self.roads
    }

    /// Bytes held by the caches of the ground, towns, streets and parcels.
    pub fn bytes(&self) -> u64 {
        self.ground.bytes() + self.plans.bytes() + self.towns.bytes() + self.cells.bytes() + self.parcels.bytes()
    }

    /// Forgets the ground, and the streets and parcels of every main cell.
    pub fn forget_cells(&self) {
        self.ground.clear();
        self.cells.clear();
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
            let style = self.styles.of(&settlement.style)?;
            let town = town::plan(self.seed, settlement, &outline, gates, style, &**self.terrain(), cancel)?;
            let own = self.styles.town(settlement, &outline)?;
            let mut across: Vec<(StyledTown, _)> = Vec::new();
            for other in self.settlements.touching(settlement)? {
                let other_outline = self.settlements.outline(&other)?;
                for shared in outline.shared.iter().filter(|s| s.border.sides.contains(&other.id)) {
                    across.push((self.styles.town(&other, &other_outline)?, shared.border.clone()));
                }
            }
            let mut cells = Vec::with_capacity(town.cells.len());
            for cell in &town.cells {
                cells.push(self.styles.mix(self.seed, cell.id, (&own, cell.anchor), &across)?);
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
                plan.cells.iter().map(|cell| &*cell.style).collect()
            }
            let theirs: Vec<Vec<&Style>> = touched.iter().map(|plan| styles(plan)).collect();
            let across: Vec<TownAndStyles> =
                touched.iter().zip(&theirs).map(|(plan, styles)| TownAndStyles { town: &plan.town, styles }).collect();
            let seams = seam::seams(self.seed, &plan.town, &styles(&plan), &across);
            let mains = seam::main_network(&plan.town, &seams);
            let shared = seam::shared_streets(&plan.town, &seams);
            let (fillers, short_counts) = self.prepare(&plan, &seams)?;
            let (town, styles) = (plan.town.clone(), plan.cells.clone());
            Ok(SeamedTown { town, styles, fillers, short_counts, seams, mains, shared })
        })
    }

    /// Local streets of the main cell with index `cell`.
    pub fn streets(&self, town: &SeamedTown, cell: usize, cancel: &Cancel) -> Result<Arc<CellStreets>, LayerError> {
        let plan = &town.town;
        self.cells.get(&(plan.settlement.id, cell), || {
            let Some(filler) = &town.fillers[cell] else { return Ok(CellStreets::default()) };
            let edges = CellEdges::of(plan, &town.seams, cell);
            filler.filler.fill(&edges.brief(self.seed, plan, cell, &town.styles[cell].style), cancel)
        })
    }

    /// Blocks, lots and footprints of the main cell with index `cell`.
    pub fn parcels(&self, town: &SeamedTown, cell: usize, cancel: &Cancel) -> Result<Arc<CellParcels>, LayerError> {
        let plan = &town.town;
        self.parcels.get(&(plan.settlement.id, cell), || {
            let local = self.streets(town, cell, cancel)?;
            let main_cell = &plan.cells[cell];
            if main_cell.cell_use == CellUse::Water {
                return Ok(CellParcels::default());
            }
            let near = Bounds::of(main_cell.border.iter().copied()).grown(StreetClass::Highway.half_width());
            let mains = town.mains.streets.iter().filter(|s| s.bounds().overlaps(near));
            let across = self.streets_across(plan, near, cancel)?;
            let streets: Vec<&Street> = mains.chain(local.streets.iter().map(|s| &s.street)).chain(&across).collect();
            let rules = &town.styles[cell].style.parcels;
            let park = ParcelRules { parks: 1.0, ..rules.clone() };
            let brief = ParcelBrief {
                seed: self.seed,
                id: main_cell.id,
                border: &main_cell.border,
                streets: &streets,
                buildings: &local.buildings,
                rules: if main_cell.cell_use == CellUse::Open { &park } else { rules },
                ground: &self.ground,
                origin: plan.origin,
                centrality: (1.0 - main_cell.anchor.length() / plan.settlement.radius).clamp(0.0, 1.0),
            };
            parcel::divide(&brief, cancel)
        })
    }

    /// Main streets of other towns near a box that end at a gate on a border with this town, local to this town.
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
                let other_town = self.town(&other, cancel)?;
                let meets = |s: &&Street| gates.contains(&s.from) || gates.contains(&s.to);
                let own = |s: &&Street| !other_town.shared.contains_key(&s.id);
                for s in other_town.mains.streets.iter().filter(meets).filter(own) {
                    let street = s.moved(other_town.town.origin.offset_to(town.origin));
                    out.extend(street.bounds().overlaps(near).then_some(street));
                }
            }
        }
        Ok(out)
    }
}
