//! Buildings that come with the streets: those of the maps that a filler's pieces are cut out of. Each has a lot of its own.

use crate::parcel::blocks::BlockShape;
use crate::parcel::lots::LotShape;
use crate::patch::PatchBuilding;
use crate::space::{
    Bounds, centroid, common_parts, distance_to_segment, is_simple, point_in_polygon, polygon_distance, quantize,
    signed_area,
};
use glam::DVec2;

/// Least area of such a building, in square metres.
const MIN_AREA: f64 = 20.0;
/// Least share of a building that must lie in a block: what lies on a pavement is cut off.
const LEAST_SHARE: f64 = 0.6;
/// Least area for each metre of the outline: thinner pieces are no buildings.
const LEAST_WIDTH: f64 = 1.1;
/// Land that a lot may share with such a building, in square metres: rounding.
const SHARED: f64 = 0.05;
/// Share of a block that such buildings cover from which on it is built up as the map is, and no other building stands in it.
const BUILT_UP: f64 = 0.1;

/// A building that comes with the streets, on its lot.
pub(super) struct Given<'a> {
    /// Its outline, which is that of its lot. The first edge is the frontage.
    pub outline: Vec<DVec2>,
    /// Index of the street that it fronts.
    pub street: usize,
    /// What is known of it.
    pub building: &'a PatchBuilding,
    bounds: Bounds,
}

/// The buildings that stand in a block.
pub(super) fn given<'a>(block: &BlockShape, buildings: &'a [PatchBuilding]) -> Vec<Given<'a>> {
    let bounds = Bounds::of(block.polygon.iter().copied());
    let near = buildings.iter().filter(|b| bounds.overlaps(Bounds::of(b.outline.iter().copied())));
    near.filter_map(|building| stand(block, building)).collect()
}

/// A building in a block, if enough of it lies there.
fn stand<'a>(block: &BlockShape, building: &'a PatchBuilding) -> Option<Given<'a>> {
    let n = building.outline.len();
    let edge = |i: usize| (building.outline[i], building.outline[(i + 1) % n]);
    let is_inside = point_in_polygon(building.outline[0], &block.polygon)
        && (0..n).all(|i| polygon_distance(edge(i).0, edge(i).1, &block.polygon) > 0.0);
    let outline = if is_inside {
        building.outline.clone()
    } else {
        let parts = common_parts(&building.outline, &block.polygon).into_iter();
        parts.max_by(|a, b| signed_area(a).total_cmp(&signed_area(b)))?
    };
    let mut outline: Vec<DVec2> = outline.into_iter().map(quantize).collect();
    outline.dedup();
    let (area, whole) = (signed_area(&outline), signed_area(&building.outline));
    let border: f64 = (0..outline.len()).map(|i| outline[i].distance(outline[(i + 1) % outline.len()])).sum();
    if area < MIN_AREA.max(LEAST_SHARE * whole) || area < LEAST_WIDTH * border || !is_simple(&outline) {
        return None;
    }
    // It fronts the street that is nearest.
    let middle = centroid(&outline);
    let m = block.polygon.len();
    let side = |i: usize| (block.polygon[i], block.polygon[(i + 1) % m]);
    let off = |i: usize| distance_to_segment(middle, side(i).0, side(i).1);
    let fronts = (0..m).filter_map(|i| Some((i, block.fronts[i]?)));
    let (front, street) = fronts.min_by(|a, b| off(a.0).total_cmp(&off(b.0)))?;
    let to_front = |i: usize| {
        let middle = outline[i].midpoint(outline[(i + 1) % outline.len()]);
        distance_to_segment(middle, side(front).0, side(front).1)
    };
    let first = (0..outline.len()).min_by(|a, b| to_front(*a).total_cmp(&to_front(*b)))?;
    outline.rotate_left(first);
    let bounds = Bounds::of(outline.iter().copied());
    Some(Given { outline, street, building, bounds })
}

/// The lots that are left beside such buildings.
pub(super) fn beside(block: &BlockShape, given: &[Given<'_>], lots: Vec<LotShape>) -> Vec<LotShape> {
    let built: f64 = given.iter().map(|g| signed_area(&g.outline)).sum();
    if built > BUILT_UP * signed_area(&block.polygon) {
        return Vec::new();
    }
    let shares = |lot: &LotShape, given: &Given<'_>| {
        given.bounds.overlaps(Bounds::of(lot.polygon.iter().copied()))
            && common_parts(&given.outline, &lot.polygon).iter().map(|p| signed_area(p)).sum::<f64>() > SHARED
    };
    lots.into_iter().filter(|lot| !given.iter().any(|given| shares(lot, given))).collect()
}
