//! What a square holds, cut at its border.

use crate::network::{Junction, JunctionId, Street, StreetId};
use crate::space::{
    Bounds, ClippedPoint, centroid, clip_line, distance_to_line, point_in_polygon, quantize, signed_area, stable_hash,
};
use crate::stack::PlacedStreet;
use crate::world::{Area, Owned};
use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use std::collections::BTreeMap;

/// A point this near to a side of the box lies on it, in metres.
const ON_SIDE: f64 = 1e-3;

/// An area cut at the border of its box, for squares that are put side by side.
///
/// A street that leaves the box ends in a junction on the border, which has the same id and place in the square on the other
/// side. Blocks, lots and buildings are cut, too; settlements stay whole. What is cut has an id of its own in each square, all
/// else keeps its id.
pub fn clipped(area: &Area) -> Area {
    // Squares side by side share their sides to the bit.
    let plan = Bounds::new(quantize(area.bounds.min), quantize(area.bounds.max));
    let border = Border { local: plan.moved(-area.origin.plan()), plan };
    let mut junctions: BTreeMap<JunctionId, Owned<Junction>> = BTreeMap::new();
    let mut streets = Vec::new();
    for street in &area.streets {
        for (index, points) in clip_line(&street.item.street.line, border.local).iter().enumerate() {
            let piece = border.piece(street, index, points);
            let it = &piece.item.street;
            for (id, at) in [(it.from, it.line.first()), (it.to, it.line.last())] {
                let junction = |at: &DVec2| Owned { chunk: street.chunk, item: Junction { id, at: *at } };
                junctions.extend(at.map(|at| (id, junction(at))));
            }
            streets.push((street.item.street.id, piece));
        }
    }
    // Those that the area has keep their chunks.
    for junction in &area.junctions {
        junctions.entry(junction.item.id).and_modify(|j| *j = junction.clone());
    }
    let (blocks, block_pieces) = border.cut_all(&area.blocks, |b| (&mut b.id, &mut b.polygon));
    let (mut lots, lot_pieces) = border.cut_all(&area.lots, |l| (&mut l.id, &mut l.polygon));
    let (mut footprints, _) = border.cut_all(&area.footprints, |f| (&mut f.id, &mut f.polygon));
    let mut by_street: BTreeMap<StreetId, Vec<&Street>> = BTreeMap::new();
    for (id, piece) in &streets {
        by_street.entry(*id).or_default().push(&piece.item.street);
    }
    for lot in &mut lots {
        lot.item.block = piece_at(&block_pieces, lot.item.block, &lot.item.polygon);
        let (whole, middle) = (lot.item.street, centroid(&lot.item.polygon));
        let pieces = by_street.get(&whole).into_iter().flatten();
        let off = |s: &&&Street| distance_to_line(middle, &s.line);
        // A lot at the border may front a street that lies outside.
        lot.item.street = pieces.min_by(|a, b| off(a).total_cmp(&off(b))).map_or(whole, |s| s.id);
    }
    for footprint in &mut footprints {
        footprint.item.lot = piece_at(&lot_pieces, footprint.item.lot, &footprint.item.polygon);
    }
    let mut streets: Vec<Owned<PlacedStreet>> = streets.into_iter().map(|(_, piece)| piece).collect();
    streets.sort_by_key(|s| s.item.street.id);
    let junctions = junctions.into_values().collect();
    Area { streets, junctions, blocks, lots, footprints, ..area.clone() }
}

/// The ids and polygons of the pieces of cut things, by the id of the whole.
type CutPieces = BTreeMap<u64, Vec<(u64, Vec<DVec2>)>>;

/// The id of the piece of a thing that holds something else; the thing's own id if it is whole.
fn piece_at(pieces: &CutPieces, whole: u64, polygon: &[DVec2]) -> u64 {
    let Some(pieces) = pieces.get(&whole) else { return whole };
    let middle = centroid(polygon);
    let holder = pieces.iter().find(|(_, piece)| point_in_polygon(middle, piece)).or_else(|| pieces.first());
    holder.map_or(whole, |(id, _)| *id)
}

/// The box that an area is cut to.
struct Border {
    /// Local to the area's origin.
    local: Bounds,
    /// In plan metres.
    plan: Bounds,
}

impl Border {
    /// A part of a street between two of its points or two points on the border.
    fn piece(&self, street: &Owned<PlacedStreet>, index: usize, points: &[ClippedPoint]) -> Owned<PlacedStreet> {
        let whole = &street.item.street;
        let last = whole.line.len() - 1;
        let end = |point: Option<&ClippedPoint>| match point {
            Some(ClippedPoint::Own(0)) => whole.from,
            Some(ClippedPoint::Own(i)) if *i == last => whole.to,
            Some(ClippedPoint::Own(i)) => JunctionId::of(&[whole.id.0, *i as u64]),
            Some(ClippedPoint::Border(segment, at)) => self.junction(whole.id, *segment, *at),
            None => whole.from,
        };
        let is_whole = points.len() == whole.line.len() && points.iter().all(|p| matches!(p, ClippedPoint::Own(_)));
        let mut out = street.clone();
        let it = &mut out.item.street;
        if !is_whole {
            it.id = StreetId(self.id(whole.id.0, index));
            (it.from, it.to) = (end(points.first()), end(points.last()));
            it.line = points
                .iter()
                .map(|point| match point {
                    ClippedPoint::Own(i) => whole.line[*i],
                    ClippedPoint::Border(_, at) => self.on_side(*at).0,
                })
                .collect();
        }
        out
    }

    /// The id of a piece of a thing.
    fn id(&self, id: u64, index: usize) -> u64 {
        let corners = [self.plan.min, self.plan.max].map(|p| [p.x.to_bits(), p.y.to_bits()]).concat();
        stable_hash(&[&[id, index as u64], &corners[..]].concat())
    }

    /// A point on the border as both squares beside it have it, and the axis that the side crosses. Along the side it lies on the
    /// quantum grid, which squares share.
    fn on_side(&self, at: DVec2) -> (DVec2, usize) {
        let sides = [(0, self.local.min.x), (0, self.local.max.x), (1, self.local.min.y), (1, self.local.max.y)];
        let away = |(axis, side): &(usize, f64)| (at[*axis] - side).abs();
        let (axis, side) = sides.into_iter().min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(sides[0]);
        let mut out = quantize(at);
        out[axis] = side;
        (out, axis)
    }

    /// The junction where a segment of a street crosses the border. A segment crosses the line of a side once, so that both
    /// squares beside it name the same junction.
    fn junction(&self, street: StreetId, segment: usize, at: DVec2) -> JunctionId {
        let (at, axis) = self.on_side(at);
        let side = at[axis] + (self.plan.min - self.local.min)[axis];
        let side = (side / ON_SIDE).round() as i64 as u64;
        JunctionId::of(&[street.0, segment as u64, axis as u64, side])
    }

    /// All things that overlap the box, cut, and the pieces of the cut ones.
    fn cut_all<T: Clone>(
        &self,
        all: &[Owned<T>],
        parts: impl Fn(&mut T) -> (&mut u64, &mut Vec<DVec2>),
    ) -> (Vec<Owned<T>>, CutPieces) {
        let (mut out, mut cuts) = (Vec::with_capacity(all.len()), CutPieces::new());
        for thing in all {
            let mut whole = thing.clone();
            let (id, polygon) = parts(&mut whole.item);
            let around = Bounds::of(polygon.iter().copied());
            if self.local.encloses(around) {
                out.push(whole);
                continue;
            }
            let (id, pieces) = (*id, if self.local.overlaps(around) { self.cut(polygon) } else { Vec::new() });
            for (index, piece) in pieces.into_iter().enumerate() {
                let mut cut = thing.clone();
                let (new, polygon) = parts(&mut cut.item);
                (*new, *polygon) = (self.id(id, index), piece);
                cuts.entry(id).or_default().push((*new, polygon.clone()));
                out.push(cut);
            }
        }
        (out, cuts)
    }

    /// The parts of a polygon in the box.
    fn cut(&self, polygon: &[DVec2]) -> Vec<Vec<DVec2>> {
        let Bounds { min, max } = self.local;
        let corners = vec![[min.x, min.y], [max.x, min.y], [max.x, max.y], [min.x, max.y]];
        let ring: Vec<[f64; 2]> = polygon.iter().map(DVec2::to_array).collect();
        let shapes = ring.overlay(&corners, OverlayRule::Intersect, FillRule::NonZero);
        let snap = |p: [f64; 2]| {
            let p = DVec2::from(p);
            let near = |low: f64, high: f64, x: f64| {
                if (x - low).abs() < ON_SIDE {
                    low
                } else if (x - high).abs() < ON_SIDE {
                    high
                } else {
                    x
                }
            };
            let on_grid = quantize(p);
            DVec2::new(near(min.x, max.x, on_grid.x), near(min.y, max.y, on_grid.y))
        };
        // A polygon without holes has none within a box.
        shapes
            .into_iter()
            .filter_map(|s| s.into_iter().next())
            .map(|ring| {
                let mut ring: Vec<DVec2> = ring.into_iter().map(snap).collect();
                ring.dedup();
                if ring.len() > 1 && ring.first() == ring.last() {
                    ring.pop();
                }
                ring
            })
            // Slivers along the border.
            .filter(|ring| ring.len() > 2 && signed_area(ring).abs() > ON_SIDE)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::line_length;
    use crate::testing;
    use std::collections::BTreeSet;

    #[test]
    fn four_squares_hold_what_one_does() {
        let town = testing::area(DVec2::new(100.5, -50.25));
        let middle = town.area.bounds.centre() + DVec2::new(7.0, 11.0);
        let squares: Vec<Area> = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)]
            .map(|(x, y)| {
                let mut area = town.area.clone();
                area.bounds = Bounds::square(middle + DVec2::new(x, y) * 450.0, 900.0);
                clipped(&area)
            })
            .to_vec();
        let length = |a: &Area| a.streets.iter().map(|s| line_length(&s.item.street.line)).sum::<f64>();
        let built = |a: &Area| a.footprints.iter().map(|f| signed_area(&f.item.polygon).abs()).sum::<f64>();
        let sum = |of: &dyn Fn(&Area) -> f64| squares.iter().map(of).sum::<f64>();
        assert!((sum(&length) - length(&town.area)).abs() < 0.1, "{} {}", sum(&length), length(&town.area));
        assert!((sum(&built) - built(&town.area)).abs() < 1.0, "{} {}", sum(&built), built(&town.area));
        let mut ids: Vec<u64> = squares.iter().flat_map(|a| a.streets.iter().map(|s| s.item.street.id.0)).collect();
        let count = ids.len();
        assert!(count > town.area.streets.len());
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), count, "pieces have ids of their own");
        for area in &squares {
            let local = area.bounds.moved(-area.origin.plan()).grown(1e-9);
            let junctions: BTreeMap<JunctionId, DVec2> =
                area.junctions.iter().map(|j| (j.item.id, j.item.at)).collect();
            for street in &area.streets {
                let it = &street.item.street;
                assert!(it.line.iter().all(|p| local.contains(*p)));
                assert_eq!((junctions.get(&it.from), junctions.get(&it.to)), (it.line.first(), it.line.last()));
            }
            assert!(area.footprints.iter().flat_map(|f| &f.item.polygon).all(|p| local.contains(*p)));
            let whole: BTreeSet<StreetId> = town.area.streets.iter().map(|s| s.item.street.id).collect();
            let streets: BTreeSet<StreetId> = area.streets.iter().map(|s| s.item.street.id).collect();
            let blocks: BTreeSet<u64> = area.blocks.iter().map(|b| b.item.id).collect();
            let lots: BTreeSet<u64> = area.lots.iter().map(|l| l.item.id).collect();
            assert!(area.lots.iter().all(|l| blocks.contains(&l.item.block)));
            assert!(area.lots.iter().all(|l| streets.contains(&l.item.street) || whole.contains(&l.item.street)));
            assert!(area.footprints.iter().all(|f| lots.contains(&f.item.lot)));
        }
        // A junction on the border is the same on both of its sides.
        let [west, east] = [&squares[0], &squares[1]];
        let on_border: Vec<_> = west
            .junctions
            .iter()
            .filter(|j| (west.origin.to_plan(j.item.at).x - west.bounds.max.x).abs() < 1e-9)
            .collect();
        assert!(!on_border.is_empty());
        for junction in on_border {
            let other = east.junctions.iter().find(|j| j.item.id == junction.item.id);
            assert_eq!(other.map(|j| j.item.at), Some(junction.item.at));
        }
    }
}
