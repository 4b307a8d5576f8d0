//! Persistent way points (Galin 2011, section 4.3): nodes of the proximity graph that the user sets down.
//!
//! To roads a way point is a settlement without an outline: they end in the junction there, or pass through it.

use super::lattice::{node_at, node_near};
use super::places::Places;
use super::tier_of_class;
use crate::edits::{EditList, RejectedEdit, WayPoint};
use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::region::{Outline, Settlement, SettlementId};
use crate::space::{Bounds, Origin, point_in_polygon, polygon_distance, stable_hash};
use crate::terrain::Terrain;
use glam::DVec2;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};
use std::sync::Arc;

/// Marks the ids of way points.
const WORD: u64 = 0x0077_6179;
/// Least distance from outlines and other way points, in steps of the lattice: gates and ties reach two steps out.
const ROOM: f64 = 4.0;
/// A point at most so many metres from a way point names it.
pub(super) const NAMED: f64 = 100.0;

/// The way points that can stand, sorted by id, each with the index of its edit; and the others.
pub(super) fn standing(
    edits: &[WayPoint],
    terrain: &dyn Terrain,
    places: &dyn Places,
    step: i64,
) -> (Vec<(Arc<Settlement>, usize)>, Vec<RejectedEdit>) {
    let mut tree: RTree<GeomWithData<[f64; 2], usize>> = RTree::new();
    let (mut out, mut rejected) = (Vec::new(), Vec::new());
    let room = ROOM * step as f64;
    for (index, edit) in edits.iter().enumerate() {
        let centre = Origin::at(edit.at + 0.5);
        let at = centre.plan();
        let beside = tree.nearest_neighbor(at.to_array()).filter(|b| DVec2::from(*b.geom()).distance(at) < room);
        let reason = match beside {
            Some(other) => Some(format!(
                "{},{} is less than {room} m from way_points[{}]; allowed is {room} m or more",
                at.x, at.y, other.data
            )),
            None => unfit(centre, terrain, places, step).unwrap_or_else(|e| Some(e.to_string())),
        };
        // Edits are checked: the class is one of roads.
        let size = tier_of_class(edit.class).unwrap_or(SizeClass::Village);
        match reason {
            Some(reason) => rejected.push(RejectedEdit { list: EditList::WayPoints, index, reason }),
            None => {
                tree.insert(GeomWithData::new(at.to_array(), index));
                let id = SettlementId(stable_hash(&[WORD, centre.0.x as u64, centre.0.y as u64]).max(1));
                let name = format!("the way point at {},{}", at.x, at.y);
                let point = Settlement { id, centre, radius: 0.0, size, style: String::new(), name };
                out.push((Arc::new(point), index));
            }
        }
    }
    out.sort_by_key(|(s, _)| s.id);
    (out, rejected)
}

/// Why there can be no way point at a place, if there can be none.
fn unfit(centre: Origin, terrain: &dyn Terrain, places: &dyn Places, step: i64) -> Result<Option<String>, LayerError> {
    let at = centre.plan();
    let node = node_at(node_near(at, step), step);
    if [at, node].iter().any(|p| terrain.sample(*p).depth() > 0.0) {
        return Ok(Some(format!("{},{} lies in water or at its bank; allowed is land", at.x, at.y)));
    }
    let room = ROOM * step as f64;
    for s in places.overlapping(Bounds::square(at, 2.0 * room))? {
        let outline = places.outline(&s)?;
        let p = centre.offset_to(outline.origin);
        if point_in_polygon(p, &outline.polygon) || polygon_distance(p, p, &outline.polygon) < room {
            let name = &s.name;
            return Ok(Some(format!(
                "{},{} is less than {room} m from the outline of {name}; allowed is {room} m or more",
                at.x, at.y
            )));
        }
    }
    Ok(None)
}

/// Places with way points among them.
struct Among {
    places: Arc<dyn Places>,
    points: Vec<Arc<Settlement>>,
    /// Centres, with their index.
    tree: RTree<GeomWithData<[f64; 2], usize>>,
}

/// The same places with way points, which are sorted by id, among them.
pub(super) fn among(places: Arc<dyn Places>, points: &[Arc<Settlement>]) -> Arc<dyn Places> {
    if points.is_empty() {
        return places;
    }
    let placed = points.iter().enumerate().map(|(i, s)| GeomWithData::new(s.centre.plan().to_array(), i));
    let tree = RTree::bulk_load(placed.collect());
    Arc::new(Among { places, points: points.to_vec(), tree })
}

impl Among {
    fn inside(&self, bounds: Bounds) -> impl Iterator<Item = &Arc<Settlement>> {
        let near = AABB::from_corners(bounds.min.to_array(), bounds.max.to_array());
        self.tree.locate_in_envelope(near).map(|c| &self.points[c.data])
    }

    fn is_point(&self, s: &Settlement) -> bool {
        self.points.binary_search_by_key(&s.id, |p| p.id).is_ok()
    }
}

impl Places for Among {
    fn centred_in_of(&self, bounds: Bounds, size: SizeClass) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut out = self.places.centred_in_of(bounds, size)?;
        out.extend(self.inside(bounds).filter(|s| s.size == size).cloned());
        out.sort_by_key(|s| s.id);
        Ok(out)
    }

    fn overlapping(&self, bounds: Bounds) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let mut out = self.places.overlapping(bounds)?;
        out.extend(self.inside(bounds.grown(NAMED)).cloned());
        out.sort_by_key(|s| s.id);
        Ok(out)
    }

    fn outline(&self, s: &Settlement) -> Result<Arc<Outline>, LayerError> {
        if self.is_point(s) {
            return Ok(Arc::new(Outline { origin: s.centre, polygon: Vec::new(), shared: Vec::new(), river: None }));
        }
        self.places.outline(s)
    }

    fn touch(&self, a: &Settlement, b: &Settlement) -> Result<bool, LayerError> {
        if self.is_point(a) || self.is_point(b) { Ok(false) } else { self.places.touch(a, b) }
    }
}
