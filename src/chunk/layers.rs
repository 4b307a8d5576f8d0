//! The layers below the chunk put together: towns, seams, streets and parcels with their caches, found by place.
//!
//! A town's seams read the plans of the towns that it touches; plans read nothing of each other but the borders, and for the
//! styles of cells near these the style and outline of the other town.

mod pins;

use super::kits::{Blend, CellStyle, Kits, Spread, StyleKit};
use crate::chunk::PlacedStreet;
use crate::layer::{Cancel, LayerCache, LayerError, Reach, Weigh};
use crate::network::{Junction, JunctionId, Network, Street, StreetClass, StreetId};
use crate::parcel::{self, CellParcels, ParcelBrief};
use crate::patch::PatchSet;
use crate::region::edits::PatchEdit;
use crate::region::{Roads, Settlement, SettlementId, Settlements};
use crate::seam::{self, Across, Seam};
use crate::space::{Bounds, Origin, Seed};
use crate::streets::{CellBrief, CellFiller, CellStreets, PinnedPatch, SemanticPatches};
use crate::terrain::Terrain;
use crate::town::{self, CellUse, Filler, MainCell, ParcelRules, Style, Town};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A town with its seams.
#[derive(Clone, Debug)]
pub struct SeamedTown {
    /// Main streets and main cells.
    pub town: Arc<Town>,
    /// What each main cell is filled with.
    pub cells: Vec<CellStyle>,
    /// Seams, one for each main street.
    pub seams: Vec<Seam>,
    /// The main streets divided at the ports.
    pub mains: Network,
    /// Streets of `mains` that run along a border, which another town has, too, with the border's origin.
    pub shared: BTreeMap<StreetId, Origin>,
}

/// A town's plan with the styles of its main cells.
struct Planned {
    town: Arc<Town>,
    /// What is mixed in each cell, and the mixture.
    cells: Vec<(Blend, CellStyle)>,
}

/// Layers 1 to 7 of a world. Each thing is made once and kept while the cache of its layer has room.
pub struct Layers {
    seed: Seed,
    terrain: Arc<dyn Terrain>,
    settlements: Arc<Settlements>,
    roads: Roads,
    kits: Kits,
    pins: Vec<PatchEdit>,
    plans: LayerCache<SettlementId, Planned>,
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
    /// The layers of a world. `kits` holds every style that a settlement or another style may name, `sets` every patch set, `pins`
    /// the patches that the user wants somewhere; `town_bytes` bounds the memory of towns, streets and parcels together.
    #[expect(clippy::too_many_arguments, reason = "the things that a world is made of")]
    pub fn new(
        seed: Seed,
        terrain: Arc<dyn Terrain>,
        settlements: Arc<Settlements>,
        roads: Roads,
        kits: BTreeMap<String, StyleKit>,
        sets: BTreeMap<String, Arc<PatchSet>>,
        pins: Vec<PatchEdit>,
        town_bytes: usize,
    ) -> Self {
        let share = town_bytes / 4;
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
    fn brief<T>(&self, town: &SeamedTown, cell: usize, with: &CellStyle, use_it: impl FnOnce(&CellBrief) -> T) -> T {
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

    /// Everything that overlaps `bounds` (plan metres), parcels excepted; `reach` says how far the caller may read.
    pub(crate) fn overlapping(&self, bounds: Bounds, reach: &Reach, cancel: &Cancel) -> Result<Overlap, LayerError> {
        let bounds = reach.check(bounds)?;
        let mut out = Overlap::default();
        let (mut seen, mut borders) = (BTreeSet::new(), BTreeSet::new());
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
                // Both towns at a border give the very same bits, whichever comes first.
                let shared = town.shared.get(&street.id);
                if shared.is_none() || borders.insert(street.id) {
                    let at = shared.copied().unwrap_or(origin);
                    let street = street.moved(origin.offset_to(at));
                    put_street(&mut out, at, PlacedStreet { street, made_by: None });
                }
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

impl Weigh for Town {
    fn bytes(&self) -> usize {
        let point = size_of::<DVec2>();
        let cells: usize = self.cells.iter().map(|c| 200 + c.border.len() * point).sum();
        let mains: usize = self.mains.iter().map(|m| 200 + m.street.line.len() * point).sum();
        cells + mains + self.outline.polygon.len() * point
    }
}

impl Weigh for Planned {
    fn bytes(&self) -> usize {
        let cells = self.cells.iter().map(|(_, cell)| 200 + weigh_style(cell));
        self.town.bytes() + cells.sum::<usize>()
    }
}

impl Weigh for SeamedTown {
    fn bytes(&self) -> usize {
        let ports: usize = self.seams.iter().map(|s| 24 + s.ports.len() * size_of::<seam::Port>()).sum();
        let shared = self.shared.len() * 48;
        let cells: usize = self.cells.iter().map(weigh_style).sum();
        cells + ports + shared + weigh_network(&self.mains)
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

fn weigh_style(cell: &CellStyle) -> usize {
    // A mixed style is the cell's own.
    700 + 8 * cell.weights.len() + size_of::<PinnedPatch>() * cell.pinned.len()
}

fn weigh_network(network: &Network) -> usize {
    let streets: usize = network.streets.iter().map(|s| 112 + s.line.len() * size_of::<DVec2>()).sum();
    streets + network.junctions.len() * size_of::<Junction>()
}
