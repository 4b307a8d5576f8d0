//! The lattices: which settlement a lattice cell of a tier holds.

use super::model::{Settlement, SettlementId};
use super::settings::SettlementSettings;
use super::spacing::{conflict, conflict_distance};
use super::{name, suitability};
use crate::layer::{LayerCache, LayerError, Reach, Weigh};
use crate::network::SizeClass;
use crate::space::{Bounds, Origin, Seed, Stream, stable_hash};
use crate::terrain::Terrain;
use glam::{DVec2, I64Vec2};
use std::sync::Arc;

/// Number of places that a lattice cell tries.
const PLACES: usize = 6;

/// The settlement of a lattice cell, if there is one.
#[derive(Debug)]
struct Cell(Option<Arc<Settlement>>);

impl Weigh for Cell {
    fn bytes(&self) -> usize {
        size_of::<Self>() + self.0.as_ref().map_or(0, |s| size_of::<Settlement>() + s.style.len() + s.name.len())
    }
}

/// How far the settlement of a cell is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Stage {
    /// The best place of the cell, before it is compared with other cells of its tier.
    Candidate,
    Accepted,
}

/// The terrain, which need not implement `Debug`.
struct TerrainHandle(Arc<dyn Terrain>);

impl std::fmt::Debug for TerrainHandle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Terrain")
    }
}

/// The settlements of all lattices, without the user's edits.
#[derive(Debug)]
pub(in crate::region) struct Lattices {
    pub seed: Seed,
    pub settings: SettlementSettings,
    terrain: TerrainHandle,
    /// One cache for all: which tier has the most cells depends on the settings.
    found: LayerCache<(Stage, SizeClass, I64Vec2), Cell>,
}

impl Lattices {
    /// The lattices of `seed` on `terrain`. `settings` must have been checked. `cache_bytes` bounds the memory of the cache.
    pub fn new(seed: Seed, settings: &SettlementSettings, terrain: Arc<dyn Terrain>, cache_bytes: usize) -> Self {
        Self { seed, settings: settings.clone(), terrain: TerrainHandle(terrain), found: LayerCache::new(cache_bytes) }
    }

    pub fn terrain(&self) -> &dyn Terrain {
        &*self.terrain.0
    }

    /// Passes the settlements of one tier whose centre lies in `bounds` to `take`.
    pub fn accepted_in(
        &self,
        bounds: Bounds,
        size: SizeClass,
        mut take: impl FnMut(Arc<Settlement>),
    ) -> Result<(), LayerError> {
        for cell in self.cells(bounds, size) {
            let found = self.found.get(&(Stage::Accepted, size, cell), || Ok(Cell(self.accept(cell, size)?)))?;
            if let Some(settlement) = &found.0
                && bounds.contains(settlement.centre.plan())
            {
                take(settlement.clone());
            }
        }
        Ok(())
    }

    /// Lattice cells of a tier whose settlement may have its centre in `bounds`.
    fn cells(&self, bounds: Bounds, size: SizeClass) -> impl Iterator<Item = I64Vec2> + use<> {
        let spacing = *self.settings.spacing.of(size);
        // Places stray this far, in cells, from the middle of their cell. They are rounded to the metre.
        let half = self.settings.jitter / 2.0;
        let low = ((bounds.min - 1.0) / spacing - 0.5 - half).ceil().as_i64vec2();
        let high = ((bounds.max + 1.0) / spacing - 0.5 + half).floor().as_i64vec2();
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| I64Vec2::new(x, y)))
    }

    fn cell_bounds(&self, cell: I64Vec2, size: SizeClass) -> Bounds {
        let spacing = *self.settings.spacing.of(size);
        Bounds::new(cell.as_dvec2() * spacing, (cell + 1).as_dvec2() * spacing)
    }

    fn stream(&self, cell: I64Vec2, size: SizeClass) -> Stream {
        self.seed.stream("settlement", &[size as u64, cell.x as u64, cell.y as u64])
    }

    /// The candidate of a cell, unless it conflicts with a candidate of its tier that has a higher rank.
    fn accept(&self, cell: I64Vec2, size: SizeClass) -> Result<Option<Arc<Settlement>>, LayerError> {
        let Some(own) = self.candidate(cell, size)?.0.clone() else { return Ok(None) };
        let padding = self.conflict_distance(size, size);
        let reach = Reach::new("settlement", self.cell_bounds(cell, size), padding);
        let near = reach.check(Bounds::square(own.centre.plan(), 2.0 * padding))?;
        for other in self.cells(near, size).filter(|c| *c != cell) {
            if rank(lattice_id(other, size)) > rank(own.id)
                && let Some(other) = &self.candidate(other, size)?.0
                && conflict(&self.settings, &own, other.centre, other.radius)
            {
                return Ok(None);
            }
        }
        Ok(Some(own))
    }

    fn candidate(&self, cell: I64Vec2, size: SizeClass) -> Result<Arc<Cell>, LayerError> {
        self.found.get(&(Stage::Candidate, size, cell), || Ok(Cell(self.choose(cell, size)?)))
    }

    /// The most promising of the places of a cell that suit a settlement.
    fn choose(&self, cell: I64Vec2, size: SizeClass) -> Result<Option<Arc<Settlement>>, LayerError> {
        let s = &self.settings;
        let mut stream = self.stream(cell, size);
        if !stream.chance(*s.share.of(size)) {
            return Ok(None);
        }
        let (least, greatest) = *s.radius.of(size);
        let radius = stream.range(least, greatest);
        let bounds = self.cell_bounds(cell, size);
        let places: Vec<Origin> = (0..PLACES)
            .map(|_| DVec2::new(stream.signed(), stream.signed()) * (s.jitter / 2.0))
            .map(|offset| Origin::at(bounds.centre() + offset * bounds.size()))
            .collect();

        // Around each place alone: a wide cell of a rare tier holds very many cells of the tiers above.
        let mut free = Vec::with_capacity(PLACES);
        for place in places {
            let mut conflicts = false;
            for &tier in size.higher() {
                let padding = self.conflict_distance(size, tier);
                let around = Bounds::square(place.plan(), 2.0 * padding);
                let near = Reach::new("settlement", bounds, padding).check(around)?;
                self.accepted_in(near, tier, |other| conflicts |= conflict(s, &other, place, radius))?;
            }
            if !conflicts {
                free.push(place);
            }
        }
        let mut ground = self.terrain().scan_ground();
        let mut places: Vec<(f64, Origin)> = free
            .into_iter()
            .filter_map(|p| Some((suitability::promise(&mut ground, p.plan(), radius, s.max_slope, s.max_height)?, p)))
            .collect();
        // A stable sort: of equal places, the one drawn first stays first.
        places.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut suiting = places
            .iter()
            .filter_map(|(_, p)| Some((*p, suitability::mean_slope(&mut ground, p.plan(), radius, s.max_slope)?)));
        let Some((centre, slope)) = suiting.next() else { return Ok(None) };
        let drawn = s.draw_style(&mut stream, size);
        let style = s.style_on_slope(size, slope).unwrap_or(drawn);
        let id = lattice_id(cell, size);
        let name = name::settlement_name(&mut stream, size);
        Ok(Some(Arc::new(Settlement { id, centre, radius, size, style, name })))
    }

    /// Distance in metres from which no two settlements of these tiers conflict.
    fn conflict_distance(&self, a: SizeClass, b: SizeClass) -> f64 {
        conflict_distance(&self.settings, self.settings.radius.of(a).1, self.settings.radius.of(b).1)
    }
}

/// Decides which of two conflicting candidates stays: the one with the greater rank. Different settlements have different
/// ranks.
fn rank(id: SettlementId) -> (u64, SettlementId) {
    (stable_hash(&[id.0, 1]), id)
}

/// Id of the settlement of a lattice cell.
fn lattice_id(cell: I64Vec2, size: SizeClass) -> SettlementId {
    SettlementId(stable_hash(&[size as u64, cell.x as u64, cell.y as u64]).max(1))
}
