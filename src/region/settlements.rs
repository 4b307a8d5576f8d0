//! All settlements of a world with their outlines, found by place.

use crate::edits::{RejectedEdit, SettlementEdit};
use crate::layer::{LayerCache, LayerError, Reach, Weigh};
use crate::network::SizeClass;
use crate::region::outline::{Border, Outline, Profile};
use crate::region::settlement::lattice::Lattices;
use crate::region::settlement::pinned::Pinned;
use crate::region::settlement::spacing::NEIGHBOUR_GAP;
use crate::region::settlement::{Settlement, SettlementId, SettlementSettings};
use crate::space::{Bounds, Seed};
use crate::terrain::Terrain;
use glam::DVec2;
use std::sync::Arc;

/// Added to a padding in metres: boxes are rounded far from the origin.
const ROUNDING: f64 = 1.0;

/// The border of two settlements, if they touch.
#[derive(Debug)]
struct MaybeBorder(Option<Arc<Border>>);

impl Weigh for MaybeBorder {
    fn bytes(&self) -> usize {
        16 + self.0.as_ref().map_or(0, |b| b.bytes())
    }
}

/// All settlements of a world, found by place.
#[derive(Debug)]
pub struct Settlements {
    lattices: Lattices,
    pinned: Pinned,
    profiles: LayerCache<SettlementId, Profile>,
    borders: LayerCache<(SettlementId, SettlementId), MaybeBorder>,
    outlines: LayerCache<SettlementId, Outline>,
}

impl Settlements {
    /// Settlements of `seed` on `terrain`. `settings` must have been checked. `cache_bytes` bounds the memory of the caches.
    pub fn new(seed: Seed, settings: &SettlementSettings, terrain: Arc<dyn Terrain>, cache_bytes: usize) -> Self {
        Self {
            lattices: Lattices::new(seed, settings, terrain, cache_bytes / 2),
            pinned: Pinned::default(),
            profiles: LayerCache::new(cache_bytes / 8),
            borders: LayerCache::new(cache_bytes / 8),
            outlines: LayerCache::new(cache_bytes / 4),
        }
    }

    /// The same with the user's pins, moves and bans. `edits` must have been checked; `has_style` tells whether a style of
    /// that name exists.
    pub fn with_edits(
        seed: Seed,
        settings: &SettlementSettings,
        terrain: Arc<dyn Terrain>,
        edits: &[SettlementEdit],
        has_style: impl Fn(&str) -> bool,
        cache_bytes: usize,
    ) -> Self {
        let out = Self::new(seed, settings, terrain, cache_bytes);
        Self { pinned: Pinned::new(&out.lattices, edits, has_style), ..out }
    }

    /// The edits that cannot be carried out: they pin a settlement in water or on steep ground, too near an earlier one or
    /// with an unknown style, or move a settlement that is not there.
    pub fn rejected_edits(&self) -> &[RejectedEdit] {
        &self.pinned.rejected
    }

    /// Settlements whose centre lies in `bounds` (plan metres), sorted by id.
    pub fn centred_in(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        self.collect(bounds, 0.0, SizeClass::Village, Ok, |s| bounds.contains(s.centre.plan()))
    }

    /// Settlements of one size class whose centre lies in `bounds` (plan metres), sorted by id.
    pub fn centred_in_of(&self, bounds: Bounds, size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut found = vec![];
        self.standing_in(bounds, size, |s| found.push(s))?;
        found.extend(self.pinned.centred_in(bounds).filter(|s| s.size == size).cloned());
        found.sort_by_key(|s| s.id);
        Ok(found)
    }

    /// Settlements whose outline may overlap `bounds` (plan metres), because their circle does. Sorted by id.
    pub fn overlapping(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        self.overlapping_of(bounds, SizeClass::Village)
    }

    /// The same for settlements of at least the size `least`.
    pub fn overlapping_of(&self, bounds: Bounds, least: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        self.collect(bounds, 1.0, least, Ok, |s| s.touches(bounds))
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

    /// Outline of a settlement. It depends on the settlements nearby and, through its borders, on the settlements near
    /// these.
    pub fn outline(&self, settlement: &Settlement) -> Result<Arc<Outline>, LayerError> {
        self.outlines.get(&settlement.id, || {
            let mut neighbours = Vec::new();
            for other in self.neighbours(settlement)? {
                let border = self.border(settlement, &other)?;
                neighbours.push((other, border));
            }
            let profile = self.profile(settlement)?;
            Ok(Outline::new(self.lattices.terrain(), settlement, &profile, &neighbours))
        })
    }

    /// The border of two settlements, `None` if they do not touch. The order of the arguments does not matter.
    pub fn border(&self, a: &Settlement, b: &Settlement) -> Result<Option<Arc<Border>>, LayerError> {
        if a.id == b.id || a.centre.offset_to(b.centre).length() >= a.radius + b.radius {
            return Ok(None);
        }
        let (a, b) = if a.id < b.id { (a, b) } else { (b, a) };
        let found = self.borders.get(&(a.id, b.id), || {
            let mut others = self.neighbours(a)?;
            others.extend(self.neighbours(b)?);
            others.sort_by_key(|s| s.id);
            others.dedup_by_key(|s| s.id);
            others.retain(|s| s.id != a.id && s.id != b.id);
            let (of_a, of_b) = (self.profile(a)?, self.profile(b)?);
            let terrain = self.lattices.terrain();
            let border = Border::between(self.lattices.seed, terrain, [(a, &of_a), (b, &of_b)], &others);
            Ok(MaybeBorder(border.map(Arc::new)))
        })?;
        Ok(found.0.clone())
    }

    /// The settlements that share a border with `settlement`, sorted by id.
    pub fn touching(&self, settlement: &Settlement) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let outline = self.outline(settlement)?;
        if outline.shared.is_empty() {
            return Ok(Vec::new());
        }
        let mut near = self.neighbours(settlement)?;
        near.retain(|n| outline.shared.iter().any(|s| s.border.sides.contains(&n.id)));
        Ok(near)
    }

    /// Largest radius of any settlement, in metres.
    pub fn largest_radius(&self) -> f64 {
        self.lattices.settings.largest_radius().max(self.pinned.largest)
    }

    fn profile(&self, settlement: &Settlement) -> Result<Arc<Profile>, LayerError> {
        let l = &self.lattices;
        self.profiles.get(&settlement.id, || Ok(Profile::new(l.seed, l.terrain(), &l.settings, settlement)))
    }

    /// The other settlements whose circle is near that of `settlement`, sorted by id. Outlines and borders read no others:
    /// their padding around a centre is both radii and the gap between the circles.
    fn neighbours(&self, settlement: &Settlement) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let own = Bounds::square(settlement.centre.plan(), 0.0);
        let padding = settlement.radius + self.largest_radius() + NEIGHBOUR_GAP + ROUNDING;
        let reach = Reach::new("outline", own, padding);
        let near = own.grown(settlement.radius + NEIGHBOUR_GAP);
        self.collect(
            near,
            1.0,
            SizeClass::Village,
            |read| reach.check(read),
            |n| {
                let apart = settlement.centre.offset_to(n.centre).length();
                n.id != settlement.id && apart < settlement.radius + n.radius + NEIGHBOUR_GAP
            },
        )
    }

    /// The `wanted` settlements of at least the size `least` in `bounds`, grown for each tier by `radii` times its greatest
    /// radius. `allow` checks each box that is read.
    fn collect(
        &self,
        bounds: Bounds,
        radii: f64,
        least: SizeClass,
        allow: impl Fn(Bounds) -> Result<Bounds, LayerError>,
        wanted: impl Fn(&Settlement) -> bool,
    ) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut found = vec![];
        for size in SizeClass::ALL.into_iter().filter(|size| *size >= least) {
            let near = allow(bounds.grown(radii * self.lattices.settings.radius.of(size).1))?;
            self.standing_in(near, size, |s| {
                if wanted(&s) {
                    found.push(s);
                }
            })?;
        }
        let near = allow(bounds.grown(radii * self.pinned.largest))?;
        found.extend(self.pinned.centred_in(near).filter(|s| s.size >= least && wanted(s)).cloned());
        found.sort_by_key(|s| s.id);
        Ok(found)
    }

    /// Passes the settlements of one tier's lattice that edits leave in place, and whose centre lies in `bounds`, to `take`.
    fn standing_in(
        &self,
        bounds: Bounds,
        size: SizeClass,
        mut take: impl FnMut(Arc<Settlement>),
    ) -> Result<(), LayerError> {
        self.lattices.accepted_in(bounds, size, |s| {
            if self.pinned.leaves(&self.lattices.settings, &s) {
                take(s);
            }
        })
    }
}

#[cfg(test)]
mod pinned_tests;
#[cfg(test)]
mod tests;
