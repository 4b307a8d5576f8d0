//! Layer 2: settlements on jittered lattices, one lattice for each size class.
//!
//! A lattice cell tries a few places of its own and takes the most suitable. A place too near a settlement of a higher
//! tier is no place; of two of one tier that are too near each other, the one of higher rank, a hash, stays. Both rules
//! look at near cells only and at nothing that was decided before, so the order of queries changes nothing. What the user
//! pinned, moved and banned is applied to the lattices as they then are: `placed`.

mod name;
mod placed;
mod settings;
pub(super) mod site;
mod table;

pub use settings::{PerSize, SettlementSettings};
pub use table::{Populations, SettlementRow, SettlementTable};

use crate::edits::{RejectedEdit, SettlementEdit};
use crate::layer::{LayerCache, LayerError, Reach, Weigh};
use crate::network::SizeClass;
use crate::region::border::Found;
use crate::region::outline::{BORDER, power_line};
use crate::region::profile::Profile;
use crate::region::{Border, Outline};
use crate::space::{Bounds, Origin, Seed, Stream, stable_hash};
use crate::terrain::Terrain;
use glam::{DVec2, I64Vec2};
use placed::Placed;
use serde::{Deserialize, Serialize};
use site::LEAST_REACH;
use std::sync::Arc;

/// Places that a lattice cell tries.
const PLACES: usize = 6;
/// Share of its radius that a settlement keeps free of the line to a neighbour, and the least of that in metres.
const KEEP: (f64, f64) = (0.5, 110.0);
/// Circles nearer than this bound each other's outlines.
const NEIGHBOUR: f64 = 3.0 * BORDER;

/// Stable name of a settlement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct SettlementId(pub u64);

/// A settlement: where it is, how large, in which style.
#[derive(Clone, Debug, PartialEq)]
pub struct Settlement {
    /// Stable name, a hash of tier and lattice cell, or of the place of a pinned one; never 0.
    pub id: SettlementId,
    /// Centre, a whole-metre plan point: the origin that everything in the settlement is local to.
    pub centre: Origin,
    /// Radius in metres that its outline is shaped from; the outline never goes beyond it.
    pub radius: f64,
    /// Size class sigma.
    pub size: SizeClass,
    /// Name of its style.
    pub style: String,
    /// Its name.
    pub name: String,
}

impl Settlement {
    /// Whether its circle shares a point with a box (plan metres).
    fn touches(&self, bounds: Bounds) -> bool {
        let centre = self.centre.plan();
        centre.distance_squared(centre.clamp(bounds.min, bounds.max)) <= self.radius * self.radius
    }
}

/// What a lattice cell holds.
#[derive(Debug)]
struct Cell(Option<Arc<Settlement>>);

impl Weigh for Cell {
    fn bytes(&self) -> usize {
        size_of::<Self>() + self.0.as_ref().map_or(0, |s| size_of::<Settlement>() + s.style.len() + s.name.len())
    }
}

impl Weigh for Outline {
    fn bytes(&self) -> usize {
        // Borders live as long as an outline names them.
        let borders = self.shared.iter().map(|s| 200 + size_of::<DVec2>() * s.border.line.len());
        size_of::<Self>() + size_of::<DVec2>() * self.polygon.len() + borders.sum::<usize>()
    }
}

type CellCache = LayerCache<I64Vec2, Cell>;

/// All settlements of a world, found by place.
#[derive(Debug)]
pub struct Settlements {
    seed: Seed,
    settings: SettlementSettings,
    terrain: TerrainHandle,
    /// The best place of a cell, before it is compared with those of its tier.
    candidates: PerSize<CellCache>,
    accepted: PerSize<CellCache>,
    profiles: LayerCache<SettlementId, Profile>,
    borders: LayerCache<(SettlementId, SettlementId), Found>,
    outlines: LayerCache<SettlementId, Outline>,
    placed: Placed,
}

/// The terrain, which need not be `Debug`.
struct TerrainHandle(Arc<dyn Terrain>);

impl std::fmt::Debug for TerrainHandle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Terrain")
    }
}

impl Settlements {
    /// Settlements of `seed` on `terrain`; `settings` are taken as checked. `cache_bytes` bounds the memory of what is
    /// remembered.
    pub fn new(seed: Seed, settings: &SettlementSettings, terrain: Arc<dyn Terrain>, cache_bytes: usize) -> Self {
        Self {
            seed,
            settings: settings.clone(),
            terrain: TerrainHandle(terrain),
            candidates: PerSize::from_fn(|_| CellCache::new(cache_bytes / 12)),
            accepted: PerSize::from_fn(|_| CellCache::new(cache_bytes / 12)),
            profiles: LayerCache::new(cache_bytes / 8),
            borders: LayerCache::new(cache_bytes / 8),
            outlines: LayerCache::new(cache_bytes / 4),
            placed: Placed::default(),
        }
    }

    /// The same with those that the user pinned, moved and banned; `edits` are taken as checked. `has_style` knows the names
    /// of styles.
    pub fn with_edits(
        seed: Seed,
        settings: &SettlementSettings,
        terrain: Arc<dyn Terrain>,
        edits: &[SettlementEdit],
        has_style: impl Fn(&str) -> bool,
        cache_bytes: usize,
    ) -> Self {
        let mut out = Self::new(seed, settings, terrain, cache_bytes);
        out.place(edits, has_style);
        out
    }

    /// The edits that cannot be: in water or on steep ground, too near an earlier one, of an unknown style, or moving what
    /// is not there.
    pub fn rejected_edits(&self) -> &[RejectedEdit] {
        &self.placed.rejected
    }

    /// Settlements whose centre lies in `bounds` (plan metres), sorted by id.
    pub fn centred_in(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        self.collect(bounds, 0.0, SizeClass::Village, |s| bounds.contains(s.centre.plan()))
    }

    /// The same of one size class.
    pub fn centred_in_of(&self, bounds: Bounds, size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut found = vec![];
        self.standing_in(bounds, size, |s| found.push(s))?;
        found.extend(self.placed.centred_in(bounds).filter(|s| s.size == size).cloned());
        found.sort_by_key(|s| s.id);
        Ok(found)
    }

    /// Outline of a settlement. It reads the settlements near it, and for the borders with those that it touches the ones
    /// near these.
    pub fn outline(&self, settlement: &Settlement) -> Result<Arc<Outline>, LayerError> {
        self.outlines.get(&settlement.id, || {
            let mut neighbours = Vec::new();
            for other in self.near(settlement)? {
                let border = self.border(settlement, &other)?;
                neighbours.push((other, border));
            }
            let profile = self.profile(settlement)?;
            Ok(Outline::new(&*self.terrain.0, settlement, &profile, &neighbours))
        })
    }

    /// The border of two settlements, `None` where they do not touch. The same whichever is named first.
    pub fn border(&self, a: &Settlement, b: &Settlement) -> Result<Option<Arc<Border>>, LayerError> {
        if a.id == b.id || a.centre.offset_to(b.centre).length() >= a.radius + b.radius {
            return Ok(None);
        }
        let (a, b) = if a.id < b.id { (a, b) } else { (b, a) };
        let found = self.borders.get(&(a.id, b.id), || {
            let mut others = self.near(a)?;
            others.extend(self.near(b)?);
            others.sort_by_key(|s| s.id);
            others.dedup_by_key(|s| s.id);
            others.retain(|s| s.id != a.id && s.id != b.id);
            let (of_a, of_b) = (self.profile(a)?, self.profile(b)?);
            let border = Border::between(self.seed, &*self.terrain.0, [(a, &of_a), (b, &of_b)], &others);
            Ok(Found(border.map(Arc::new)))
        })?;
        Ok(found.0.clone())
    }

    /// The settlements that a settlement shares a border with, sorted by id.
    pub fn touching(&self, settlement: &Settlement) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let outline = self.outline(settlement)?;
        if outline.shared.is_empty() {
            return Ok(Vec::new());
        }
        let mut near = self.near(settlement)?;
        near.retain(|n| outline.shared.iter().any(|s| s.border.sides.contains(&n.id)));
        Ok(near)
    }

    fn profile(&self, settlement: &Settlement) -> Result<Arc<Profile>, LayerError> {
        self.profiles.get(&settlement.id, || Ok(Profile::new(self.seed, &*self.terrain.0, &self.settings, settlement)))
    }

    /// The other settlements whose circle is near that of a settlement, sorted by id.
    fn near(&self, settlement: &Settlement) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let own = Bounds::square(settlement.centre.plan(), 0.0);
        let padding = settlement.radius + self.largest_radius() + NEIGHBOUR;
        Reach::new("outline", own, padding).check(own.grown(padding))?;
        self.collect(own.grown(settlement.radius + NEIGHBOUR), 1.0, SizeClass::Village, |n| {
            let apart = settlement.centre.offset_to(n.centre).length();
            n.id != settlement.id && apart < settlement.radius + n.radius + NEIGHBOUR
        })
    }

    /// Settlements whose outline may overlap `bounds` (their circles do), sorted by id.
    pub fn overlapping(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        self.overlapping_of(bounds, SizeClass::Village)
    }

    /// The same of at least the size `least`.
    pub fn overlapping_of(&self, bounds: Bounds, least: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        self.collect(bounds, 1.0, least, |s| s.touches(bounds))
    }

    /// The settlement whose outline holds the plan point `p`.
    pub fn at(&self, p: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
        for settlement in self.overlapping(Bounds::new(p, p))? {
            if self.outline(&settlement)?.contains(p) {
                return Ok(Some(settlement));
            }
        }
        Ok(None)
    }

    /// Largest radius of any settlement, in metres.
    pub fn largest_radius(&self) -> f64 {
        self.settings.largest_radius().max(self.placed.largest)
    }

    /// Settlements of at least the size `least` in `bounds`, grown by `radii` times the greatest radius of the tier, that are
    /// `wanted`.
    fn collect(
        &self,
        bounds: Bounds,
        radii: f64,
        least: SizeClass,
        wanted: impl Fn(&Settlement) -> bool,
    ) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut found = vec![];
        for size in SizeClass::ALL.into_iter().filter(|size| *size >= least) {
            let near = bounds.grown(radii * self.settings.radius.of(size).1);
            self.standing_in(near, size, |s| {
                if wanted(&s) {
                    found.push(s);
                }
            })?;
        }
        let near = bounds.grown(radii * self.placed.largest);
        found.extend(self.placed.centred_in(near).filter(|s| s.size >= least && wanted(s)).cloned());
        found.sort_by_key(|s| s.id);
        Ok(found)
    }

    /// The settlements of one tier's lattice with their centre in `bounds` that edits leave there.
    fn standing_in(
        &self,
        bounds: Bounds,
        size: SizeClass,
        mut take: impl FnMut(Arc<Settlement>),
    ) -> Result<(), LayerError> {
        self.accepted_in(bounds, size, |s| {
            if self.stands(&s) {
                take(s);
            }
        })
    }

    /// The accepted settlements of one tier's lattice with their centre in `bounds`.
    fn accepted_in(
        &self,
        bounds: Bounds,
        size: SizeClass,
        mut take: impl FnMut(Arc<Settlement>),
    ) -> Result<(), LayerError> {
        for cell in self.cells(bounds, size) {
            let found = self.accepted.of(size).get(&cell, || Ok(Cell(self.accept(cell, size)?)))?;
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
        // Places lie that far, in cells, around the middle of their cell; they are rounded to the metre.
        let half = self.settings.jitter / 2.0;
        let low = ((bounds.min - 1.0) / spacing - 0.5 - half).ceil().as_i64vec2();
        let high = ((bounds.max + 1.0) / spacing - 0.5 + half).floor().as_i64vec2();
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| I64Vec2::new(x, y)))
    }

    /// Box of a lattice cell.
    fn cell_bounds(&self, cell: I64Vec2, size: SizeClass) -> Bounds {
        let spacing = *self.settings.spacing.of(size);
        Bounds::new(cell.as_dvec2() * spacing, (cell + 1).as_dvec2() * spacing)
    }

    fn stream(&self, cell: I64Vec2, size: SizeClass) -> Stream {
        self.seed.stream("settlement", &[size as u64, cell.x as u64, cell.y as u64])
    }

    /// The candidate of a cell, unless a candidate of its tier with a higher rank is too near.
    fn accept(&self, cell: I64Vec2, size: SizeClass) -> Result<Option<Arc<Settlement>>, LayerError> {
        let Some(own) = self.candidate(cell, size)?.0.clone() else { return Ok(None) };
        let padding = self.too_near(size, size);
        let reach = Reach::new("settlement", self.cell_bounds(cell, size), padding);
        let near = reach.check(Bounds::square(own.centre.plan(), 2.0 * padding))?;
        for other in self.cells(near, size).filter(|c| *c != cell) {
            if rank(lattice_id(other, size)) > rank(own.id)
                && let Some(other) = &self.candidate(other, size)?.0
                && self.conflict(&own, other.centre, other.radius)
            {
                return Ok(None);
            }
        }
        Ok(Some(own))
    }

    fn candidate(&self, cell: I64Vec2, size: SizeClass) -> Result<Arc<Cell>, LayerError> {
        self.candidates.of(size).get(&cell, || Ok(Cell(self.choose(cell, size)?)))
    }

    /// The most promising of the places of a cell that suit.
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

        let mut higher = vec![];
        for &tier in size.higher() {
            let padding = self.too_near(size, tier);
            let around = Bounds::of(places.iter().map(|p| p.plan())).grown(padding);
            let near = Reach::new("settlement", bounds, padding).check(around)?;
            self.accepted_in(near, tier, |other| higher.push(other))?;
        }
        let mut ground = self.terrain.0.scan_ground();
        let mut places: Vec<(f64, Origin)> = places
            .into_iter()
            .filter(|p| !higher.iter().any(|o| self.conflict(o, *p, radius)))
            .filter_map(|p| Some((site::promise(&mut ground, p.plan(), radius, s.max_slope, s.max_height)?, p)))
            .collect();
        // Stable: of equals the first drawn stays first.
        places.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut suiting =
            places.iter().filter_map(|(_, p)| Some((*p, site::suits(&mut ground, p.plan(), radius, s.max_slope)?)));
        let Some((centre, slope)) = suiting.next() else { return Ok(None) };
        let drawn = s.draw_style(&mut stream, size);
        let style = s.style_on_slope(size, slope).unwrap_or(drawn);
        let id = lattice_id(cell, size);
        let name = name::place_name(&mut stream, size);
        Ok(Some(Arc::new(Settlement { id, centre, radius, size, style, name })))
    }

    /// Whether `a` and a settlement of `radius` at `centre` are too near each other: within the distance set, or so that
    /// the line between them would leave one of them little room.
    fn conflict(&self, a: &Settlement, centre: Origin, radius: f64) -> bool {
        let apart = a.centre.offset_to(centre).length();
        let room = |own: f64, other: f64| power_line(apart, own, other) - BORDER < keep(own);
        apart < self.settings.clearance * (a.radius + radius) + self.settings.gap
            || room(a.radius, radius)
            || room(radius, a.radius)
    }

    /// A distance at which no two settlements of these tiers conflict.
    fn too_near(&self, a: SizeClass, b: SizeClass) -> f64 {
        self.apart(self.settings.radius.of(a).1, self.settings.radius.of(b).1)
    }

    /// A distance at which no settlements of these radii conflict.
    fn apart(&self, a: f64, b: f64) -> f64 {
        apart(&self.settings, a, b)
    }
}

/// A distance at which no settlements of two radii conflict.
fn apart(settings: &SettlementSettings, a: f64, b: f64) -> f64 {
    // `power_line(d, own, other) >= k` holds from d = 2 k + other on.
    let room = |own: f64, other: f64| 2.0 * (keep(own) + BORDER) + other;
    (settings.clearance * (a + b) + settings.gap).max(room(a, b)).max(room(b, a))
}

/// Metres from its centre that a settlement of a radius keeps for itself.
fn keep(radius: f64) -> f64 {
    (radius * KEEP.0).max(KEEP.1)
}

/// Who stays of two candidates that are too near each other. Distinct for distinct settlements.
fn rank(id: SettlementId) -> (u64, SettlementId) {
    (stable_hash(&[id.0, 1]), id)
}

/// Name of the settlement of a lattice cell, if there is one.
fn lattice_id(cell: I64Vec2, size: SizeClass) -> SettlementId {
    SettlementId(stable_hash(&[size as u64, cell.x as u64, cell.y as u64]).max(1))
}

#[cfg(test)]
mod tests;
