//! Persistent way points (Galin 2011, section 4.3): nodes of the proximity graph that the user places.
//!
//! For roads, a way point is a settlement of radius 0 without an outline: roads end in the junction there, or pass through it.

use super::lattice::{node_at, node_near};
use super::source::SettlementSource;
use super::tier::tier_of_class;
use crate::edits::{EditList, RejectedEdit, WayPoint};
use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::region::outline::Outline;
use crate::region::settlement::{Settlement, SettlementId};
use crate::space::{Bounds, Origin, point_in_polygon, polygon_distance, stable_hash};
use crate::terrain::Terrain;
use glam::DVec2;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};
use std::sync::Arc;

/// Distinguishes the ids of way points from other hashes.
const WORD: u64 = 0x0077_6179;
/// Least distance of a way point from outlines and other way points, in steps of the lattice. Gates and ties reach two steps
/// out.
const ROOM: f64 = 4.0;
/// An edit names a way point by a point at most this many metres from it.
pub(super) const NAMED: f64 = 100.0;

/// Indices of positions, found by place.
type Index = RTree<GeomWithData<[f64; 2], usize>>;

/// A way point as a settlement of radius 0.
#[derive(Clone, Debug)]
pub(super) struct PlacedWayPoint {
    pub settlement: Arc<Settlement>,
    /// Index of its edit.
    pub edit: usize,
}

/// The way points that can be placed, sorted by id, and the edits of those that cannot.
pub(super) fn place(
    edits: &[WayPoint],
    terrain: &dyn Terrain,
    settlements: &dyn SettlementSource,
    step: i64,
    domain: Option<Bounds>,
) -> (Vec<PlacedWayPoint>, Vec<RejectedEdit>) {
    let mut placed = Index::new();
    let (mut out, mut rejected) = (Vec::new(), Vec::new());
    let room = ROOM * step as f64;
    for (index, edit) in edits.iter().enumerate() {
        let centre = Origin::at(edit.at + 0.5);
        let at = centre.plan();
        let near = placed.nearest_neighbor(at.to_array()).filter(|b| DVec2::from(*b.geom()).distance(at) < room);
        let beyond = domain.filter(|d| !d.contains(at));
        let reason = match (near, beyond) {
            (_, Some(domain)) => Some(outside(at, domain)),
            (Some(other), None) => Some(format!(
                "{},{} is less than {room} m from way_points[{}]; keep at least {room} m between them",
                at.x, at.y, other.data
            )),
            (None, None) => unsuitable(centre, terrain, settlements, step).unwrap_or_else(|e| Some(e.to_string())),
        };
        // The edits were checked: the class is a class of roads.
        let size = tier_of_class(edit.class).unwrap_or(SizeClass::Village);
        match reason {
            Some(reason) => rejected.push(RejectedEdit { list: EditList::WayPoints, index, reason }),
            None => {
                placed.insert(GeomWithData::new(at.to_array(), index));
                let id = SettlementId(stable_hash(&[WORD, centre.0.x as u64, centre.0.y as u64]).max(1));
                let name = format!("the way point at {},{}", at.x, at.y);
                let point = Settlement { id, centre, radius: 0.0, size, style: String::new(), name };
                out.push(PlacedWayPoint { settlement: Arc::new(point), edit: index });
            }
        }
    }
    out.sort_by_key(|p| p.settlement.id);
    (out, rejected)
}

/// Why nothing can be at a point that a domain does not hold.
pub(super) fn outside(p: DVec2, domain: Bounds) -> String {
    let (low, high) = (domain.min, domain.max);
    format!(
        "{},{} lies outside of the domain; allowed is x {:.0} to {:.0}, y {:.0} to {:.0}",
        p.x, p.y, low.x, high.x, low.y, high.y
    )
}

/// Why there can be no way point at a place; `None` if there can be one.
fn unsuitable(
    centre: Origin,
    terrain: &dyn Terrain,
    settlements: &dyn SettlementSource,
    step: i64,
) -> Result<Option<String>, LayerError> {
    let at = centre.plan();
    let node = node_at(node_near(at, step), step);
    if [at, node].iter().any(|p| terrain.sample(*p).depth() > 0.0) {
        return Ok(Some(format!("{},{} lies in water or at its bank; a way point needs land", at.x, at.y)));
    }
    let room = ROOM * step as f64;
    for s in settlements.overlapping(Bounds::square(at, 2.0 * room))? {
        let outline = settlements.outline(&s)?;
        let p = centre.offset_to(outline.origin);
        // In a finite domain, roads lead to the centres of small settlements.
        let near_centre = outline.polygon.is_empty() && p.length() < room;
        if near_centre || point_in_polygon(p, &outline.polygon) || polygon_distance(p, p, &outline.polygon) < room {
            let name = &s.name;
            return Ok(Some(format!(
                "{},{} is less than {room} m from the outline of {name}; keep at least {room} m between them",
                at.x, at.y
            )));
        }
    }
    Ok(None)
}

/// A source of settlements that also has way points.
struct WithWayPoints {
    settlements: Arc<dyn SettlementSource>,
    points: Vec<Arc<Settlement>>,
    /// Positions of the points.
    index: Index,
}

/// The same source with way points, which are sorted by id.
pub(super) fn with_way_points(
    settlements: Arc<dyn SettlementSource>,
    points: &[Arc<Settlement>],
) -> Arc<dyn SettlementSource> {
    if points.is_empty() {
        return settlements;
    }
    let placed = points.iter().enumerate().map(|(i, s)| GeomWithData::new(s.centre.plan().to_array(), i));
    let index = RTree::bulk_load(placed.collect());
    Arc::new(WithWayPoints { settlements, points: points.to_vec(), index })
}

impl WithWayPoints {
    fn inside(&self, bounds: Bounds) -> impl Iterator<Item = &Arc<Settlement>> {
        let near = AABB::from_corners(bounds.min.to_array(), bounds.max.to_array());
        self.index.locate_in_envelope(near).map(|c| &self.points[c.data])
    }

    fn is_point(&self, s: &Settlement) -> bool {
        self.points.binary_search_by_key(&s.id, |p| p.id).is_ok()
    }
}

impl SettlementSource for WithWayPoints {
    fn centred_in_of(&self, bounds: Bounds, size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut out = self.settlements.centred_in_of(bounds, size)?;
        out.extend(self.inside(bounds).filter(|s| s.size == size).cloned());
        out.sort_by_key(|s| s.id);
        Ok(out)
    }

    fn overlapping(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut out = self.settlements.overlapping(bounds)?;
        out.extend(self.inside(bounds.grown(NAMED)).cloned());
        out.sort_by_key(|s| s.id);
        Ok(out)
    }

    fn named_near(&self, p: DVec2) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut out = self.settlements.named_near(p)?;
        out.extend(self.inside(Bounds::square(p, 2.0 * NAMED)).cloned());
        out.sort_by_key(|s| s.id);
        Ok(out)
    }

    fn outline(&self, s: &Settlement) -> Result<Arc<Outline>, LayerError> {
        if self.is_point(s) {
            return Ok(Arc::new(Outline { origin: s.centre, polygon: Vec::new(), shared: Vec::new(), river: None }));
        }
        self.settlements.outline(s)
    }

    fn touch(&self, a: &Settlement, b: &Settlement) -> Result<bool, LayerError> {
        if self.is_point(a) || self.is_point(b) { Ok(false) } else { self.settlements.touch(a, b) }
    }
}
