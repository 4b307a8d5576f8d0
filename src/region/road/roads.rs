//! The roads of an endless world.

use super::budget::Budget;
use super::crossing::HighwayCrossing;
use super::inputs::Inputs;
use super::lattice::node_at;
use super::link::{Link, link};
use super::routes::Routes;
use super::sections::{RoadSection, Sections};
use super::settings::RoadSettings;
use super::source::SettlementSource;
use super::steps::{Searches, sections};
use super::tile::tiles_in;
use super::unfulfilled::unfulfilled;
use crate::edits::{Edits, RejectedEdit};
use crate::layer::{Cancel, LayerError};
use crate::network::{JunctionId, SizeClass};
use crate::region::gate::Gate;
use crate::region::settlement::{Settlement, SettlementId};
use crate::region::settlements::Settlements;
use crate::space::Bounds;
use crate::terrain::Terrain;
use std::sync::Arc;

/// All roads of an endless world, found by place.
pub struct Roads {
    pub(super) searches: Searches,
    pub(super) routes: Arc<Routes>,
    sections: Sections,
    /// The user's way points, sorted by id.
    way_points: Vec<Arc<Settlement>>,
}

/// Id of the junction at a gate.
fn gate_junction(settlement: SettlementId, vertex: usize) -> JunctionId {
    JunctionId::of(&[2, settlement.0, vertex as u64, 0])
}

impl Roads {
    /// Roads between `settlements` over `terrain`. `settings` must have been checked. `cache_bytes` bounds the memory of the
    /// caches.
    pub fn new(
        settings: &RoadSettings,
        terrain: Arc<dyn Terrain>,
        settlements: Arc<Settlements>,
        cache_bytes: usize,
    ) -> Self {
        Self::from_source(settings, terrain, settlements, &Edits::default(), cache_bytes)
    }

    /// The same with the user's edits of roads: influences on their cost, way points, and roads that are kept, routed through
    /// points or banned. `edits` must have been checked. Edits of settlements are ignored: `settlements` were made with them.
    pub fn with_edits(
        settings: &RoadSettings,
        terrain: Arc<dyn Terrain>,
        settlements: Arc<Settlements>,
        edits: &Edits,
        cache_bytes: usize,
    ) -> Self {
        Self::from_source(settings, terrain, settlements, edits, cache_bytes)
    }

    /// Roads between the settlements of any source.
    pub(super) fn from_source(
        settings: &RoadSettings,
        terrain: Arc<dyn Terrain>,
        settlements: Arc<dyn SettlementSource>,
        edits: &Edits,
        cache_bytes: usize,
    ) -> Self {
        let budget = Budget::new(cache_bytes);
        let inputs = Inputs::with_edits(settings, terrain, settlements, edits, None, budget);
        let way_points = inputs.way_points.iter().map(|p| p.settlement.clone()).collect();
        let searches = Searches::new(inputs, budget);
        let routes = Arc::new(searches.routes(budget));
        let sections = sections(&searches.inputs, &routes, budget);
        Self { searches, routes, sections, way_points }
    }

    /// Way points that roads pass, as settlements of radius 0, sorted by id. [`Link`]s name them like settlements. The junction
    /// at a way point is the junction of its gate at vertex 0.
    pub fn way_points(&self) -> &[Arc<Settlement>] {
        &self.way_points
    }

    /// The junction at a way point.
    pub fn way_point_junction(&self, id: SettlementId) -> JunctionId {
        gate_junction(id, 0)
    }

    /// The edits that cannot be carried out: edits without a settlement at both ends, beyond the reach of the class, in water,
    /// too near another way point or a settlement, or where the ground allows no road. To find the last of these, the roads
    /// that the edits ask for are searched.
    pub fn rejected_edits(&self, cancel: &Cancel) -> Result<Vec<RejectedEdit>, LayerError> {
        let mut out = self.searches.inputs.rejected.clone();
        out.extend(unfulfilled(&self.searches.inputs, &self.routes, cancel)?);
        out.sort_by_key(|e| (e.list, e.index));
        Ok(out)
    }

    /// Sections of road whose centre line enters `bounds` (plan metres; the box of one of its segments overlaps it), sorted
    /// by id.
    pub fn overlapping(&self, bounds: Bounds, cancel: &Cancel) -> Result<Vec<Arc<RoadSection>>, LayerError> {
        let mut out = Vec::new();
        for tile in tiles_in(bounds, self.searches.inputs.step()) {
            cancel.check()?;
            let sections = self.sections.of_tile(tile, cancel)?;
            out.extend(sections.0.iter().filter(|r| r.enters(bounds)).cloned());
        }
        out.sort_by_key(|r: &Arc<RoadSection>| r.street.id);
        out.dedup_by_key(|r| r.street.id);
        Ok(out)
    }

    /// Crossings of roads with highways in `bounds` (plan metres), on the ground and on bridges: how they are built, and what keeps
    /// them from being built as the settings say. Sorted by place.
    pub fn crossings(&self, bounds: Bounds, cancel: &Cancel) -> Result<Vec<HighwayCrossing>, LayerError> {
        let mut out = Vec::new();
        for tile in tiles_in(bounds, self.searches.inputs.step()) {
            cancel.check()?;
            out.extend(self.sections.crossings(tile, cancel)?.into_iter().filter(|c| bounds.contains(c.at)));
        }
        out.sort_by(|a, b| a.at.y.total_cmp(&b.at.y).then(a.at.x.total_cmp(&b.at.x)));
        Ok(out)
    }

    /// Gates of a settlement where roads arrive, sorted by vertex.
    pub fn gates(&self, settlement: &Settlement, cancel: &Cancel) -> Result<Vec<Gate>, LayerError> {
        let mut out: Vec<Gate> = Vec::new();
        for tier in SizeClass::ALL.into_iter().filter(|tier| *tier <= settlement.size) {
            for route in self.routes.of(tier, settlement, cancel)? {
                let last = usize::from(route.ends[1].settlement == settlement.id);
                let end = &route.ends[last];
                let node = if last == 1 { route.nodes.last() } else { route.nodes.first() };
                let Some(node) = node else { continue };
                if out.iter().any(|g| g.vertex == end.vertex) {
                    // Higher classes come first.
                    continue;
                }
                let from = settlement.centre.to_local(node_at(*node, self.searches.inputs.step()));
                out.push(Gate {
                    junction: gate_junction(settlement.id, end.vertex),
                    vertex: end.vertex,
                    at: end.gate,
                    inward: (end.gate - from).normalize_or_zero(),
                    class: route.class,
                });
            }
        }
        out.sort_by_key(|g| g.vertex);
        Ok(out)
    }

    /// Settlements centred in `bounds` (plan metres) that no road reaches and that touch no other, because water or steep ground
    /// lies all around them. Sorted by id.
    pub fn unreached(&self, bounds: Bounds, cancel: &Cancel) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let inputs = &self.searches.inputs;
        let mut out = Vec::new();
        for s in inputs.settlements.centred_in(bounds, SizeClass::Village)? {
            let mut reached = s.radius == 0.0;
            for tier in SizeClass::ALL.into_iter().filter(|tier| *tier <= s.size) {
                reached = reached || !self.routes.of(tier, &s, cancel)?.is_empty();
            }
            if !reached {
                for other in inputs.settlements.overlapping(Bounds::square(s.centre.plan(), 2.0 * s.radius))? {
                    reached = reached || (other.id != s.id && inputs.settlements.touch(&s, &other)?);
                }
            }
            if !reached {
                out.push(s);
            }
        }
        Ok(out)
    }

    /// Links with at least one end in `bounds` (plan metres), sorted by id.
    pub fn links(&self, bounds: Bounds, cancel: &Cancel) -> Result<Vec<Arc<Link>>, LayerError> {
        let (inputs, distances) = (&self.searches.inputs, &self.searches.distances);
        let mut out: Vec<Arc<Link>> = Vec::new();
        for s in inputs.settlements.centred_in(bounds, SizeClass::Village)? {
            for tier in SizeClass::ALL {
                cancel.check()?;
                if tier > s.size {
                    continue;
                }
                for route in self.routes.of(tier, &s, cancel)? {
                    if !out.iter().any(|l| l.id == route.id) {
                        out.push(Arc::new(link(inputs, distances, &route, cancel)?));
                    }
                }
            }
        }
        out.sort_by_key(|l| l.id);
        Ok(out)
    }
}
