//! The settlements of a finite domain: some have a disc where roads stop, the others are nodes.

use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::region::outline::Outline;
use crate::region::road::source::SettlementSource;
use crate::region::settlement::{Settlement, SettlementId};
use crate::space::{Bounds, math, quantize};
use glam::DVec2;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Least radius of a disc in steps of the lattice. Settlements with a smaller disc are nodes.
const LEAST_DISC: f64 = 1.5;
/// Gap between two discs, or between a disc and a centre, in steps: ties reach two steps out, and roads pass between them.
const ROOM: f64 = 4.0;
/// Distance between the vertices of a disc: in steps, and at least in metres.
const VERTICES: (f64, f64) = (0.2, 60.0);

/// The settlements of a finite domain.
pub(super) struct Listed {
    /// Sorted by id.
    pub all: Vec<Arc<Settlement>>,
    /// Where roads stop: a disc, or an outline without vertices for a node.
    stops: BTreeMap<SettlementId, Arc<Outline>>,
}

/// A disc as an outline. A radius of 0 gives no vertices.
pub(super) fn disc(s: &Settlement, radius: f64, step: i64) -> Outline {
    let spacing = VERTICES.1.max(VERTICES.0 * step as f64);
    let count = if radius > 0.0 { ((TAU * radius / spacing) as usize).max(24) } else { 0 };
    let vertex = |i: usize| quantize(math::direction(i as f64 / count as f64 * TAU) * radius);
    Outline { origin: s.centre, polygon: (0..count).map(vertex).collect(), shared: Vec::new(), river: None }
}

impl Listed {
    /// Settlements in a domain with a lattice of spacing `step`. The settlements in `nodes` (sorted ids) are nodes, whatever
    /// their size.
    pub fn new(mut all: Vec<Arc<Settlement>>, step: i64, nodes: &[SettlementId]) -> Self {
        all.sort_by_key(|s| s.id);
        let (least, room) = (LEAST_DISC * step as f64, ROOM * step as f64);
        let large = |s: &Settlement| s.radius >= least && nodes.binary_search(&s.id).is_err();
        let radius = |s: &Settlement| {
            let shrunk = all.iter().filter(|o| o.id != s.id).fold(s.radius, |held, o| {
                let free = (s.centre.offset_to(o.centre).length() - room).max(0.0);
                // Two discs share the ground between them in proportion to their radii.
                let share = if large(o) { s.radius / (s.radius + o.radius) } else { 1.0 };
                held.min(free * share)
            });
            if large(s) && shrunk >= least { shrunk } else { 0.0 }
        };
        let stops = all.iter().map(|s| (s.id, Arc::new(disc(s, radius(s), step)))).collect();
        Self { all, stops }
    }

    /// Whether a settlement is a node.
    pub fn is_node(&self, id: SettlementId) -> bool {
        self.stops.get(&id).is_none_or(|o| o.polygon.is_empty())
    }

    /// The disc where roads stop; `None` for a node.
    pub fn stop(&self, id: SettlementId) -> Option<&Arc<Outline>> {
        self.stops.get(&id).filter(|o| !o.polygon.is_empty())
    }
}

impl SettlementSource for Listed {
    fn centred_in_of(&self, bounds: Bounds, size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let inside = |s: &&Arc<Settlement>| s.size == size && bounds.contains(s.centre.plan());
        Ok(self.all.iter().filter(inside).cloned().collect())
    }

    fn overlapping(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let touches = |s: &&Arc<Settlement>| {
            let radius = if self.is_node(s.id) { 0.0 } else { s.radius };
            let centre = s.centre.plan();
            centre.distance_squared(centre.clamp(bounds.min, bounds.max)) <= radius * radius
        };
        Ok(self.all.iter().filter(touches).cloned().collect())
    }

    fn named_near(&self, p: DVec2) -> Result<Vec<Arc<Settlement>>, LayerError> {
        Ok(self.all.iter().filter(|s| s.centre.plan().distance(p) <= s.radius).cloned().collect())
    }

    fn outline(&self, s: &Settlement) -> Result<Arc<Outline>, LayerError> {
        Ok(self.stops.get(&s.id).cloned().unwrap_or_else(|| Arc::new(disc(s, 0.0, 1))))
    }
}
