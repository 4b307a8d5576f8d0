//! The streets of a mosaic: where those of two tiles go on as one, each of both ends moves half of the distance between them (Bustard
//! and de Valmency 2015, section 3), and what lies beside moves with it, less and less towards the middle of the tile, so that no
//! street has a kink at a side.

use super::choose::ALONE;
use super::cost::pairs;
use super::mosaic::Mosaic;
use super::side::Side;
use crate::network::{PlanarGraph, StreetClass, VertexIx};
use glam::DVec2;
use std::collections::BTreeMap;

/// Share of a tile's edge within which streets move with their ends.
const DEPTH: f64 = 0.45;
/// Streets that move farther than this may come to cross others, in metres.
const FAR: f64 = 2.0;

/// What an edge of a mosaic is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Of {
    /// Class of the street.
    pub class: StreetClass,
    /// The patch that the street is from, as index into [`TileTable::patches`](super::table::TileTable::patches); `None` for a street that joins others.
    pub patch: Option<u32>,
}

/// How the points of a tile move, so that its streets meet those beside it.
#[derive(Clone, Debug, Default)]
pub struct Warp {
    half: f64,
    /// For each side places along it, in order, and how far the tile moves along the side there.
    sides: [Vec<(f64, f64)>; 4],
}

impl Warp {
    /// Where a point of the tile moves, in metres from its middle.
    pub fn of(&self, p: DVec2) -> DVec2 {
        let mut out = p;
        for side in Side::ALL {
            let (axis, moves) = (side.axis(), &self.sides[side as usize]);
            let off = match side {
                Side::West | Side::South => p[axis] + self.half,
                Side::East | Side::North => self.half - p[axis],
            };
            let share = (1.0 - off / (2.0 * DEPTH * self.half)).clamp(0.0, 1.0);
            if share > 0.0 && !moves.is_empty() {
                out[1 - axis] += share * between(moves, p[1 - axis]);
            }
        }
        out
    }
}

/// The value at a place, between those at the places before and after it.
fn between(values: &[(f64, f64)], at: f64) -> f64 {
    let after = values.partition_point(|value| value.0 <= at);
    match (after.checked_sub(1).map(|before| values[before]), values.get(after)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (at - a.0) / (b.0 - a.0).max(1e-9),
        (Some(a), None) => a.1,
        (None, Some(b)) => b.1,
        (None, None) => 0.0,
    }
}

/// The streets of a mosaic, in metres from the south-west corner of its grid.
pub struct Woven {
    /// The streets.
    pub graph: PlanarGraph<Of>,
    /// Vertices at which a street ends at the side of a tile, because none goes on there.
    pub loose: Vec<VertexIx>,
    /// Vertices that moved so far that their streets may cross others.
    pub moved: Vec<VertexIx>,
    /// How each tile moves, by its column and row.
    pub warps: BTreeMap<(usize, usize), Warp>,
}

/// Joins the streets of all tiles.
pub fn weave(mosaic: &Mosaic<'_>) -> Woven {
    let table = mosaic.table;
    let half = table.size / 2.0;
    // For each crossing of each side the one that it is joined to, and how far it moves.
    type Joined = [Vec<Option<(usize, f64)>>; 4];
    let joins: BTreeMap<(usize, usize), Joined> = mosaic
        .places()
        .map(|(place, placed)| {
            let of_side = |side: Side| {
                let own = &placed.sides[side as usize];
                let mut joined = vec![None; own.len()];
                let other = mosaic.beside(place.0, place.1, side).and_then(|(column, row)| mosaic.at(column, row));
                let fixed = other.map_or(&[][..], |other| &other.sides[side.opposite() as usize]);
                // In one order for both tiles, so that both say the same.
                let first = matches!(side, Side::West | Side::South);
                let together = if first { pairs(fixed, own, ALONE) } else { pairs(own, fixed, ALONE) };
                for (a, b) in together {
                    let (i, k) = if first { (a, b) } else { (b, a) };
                    let off = f64::from(fixed[i].at) - f64::from(own[k].at);
                    joined[k] = Some((i, off / 2.0));
                }
                joined
            };
            (place, Side::ALL.map(of_side))
        })
        .collect();
    let mut woven =
        Woven { graph: PlanarGraph::without_index(), loose: Vec::new(), moved: Vec::new(), warps: BTreeMap::new() };
    let mut ends: BTreeMap<(usize, usize), [Vec<VertexIx>; 4]> = BTreeMap::new();
    for (place, placed) in mosaic.places() {
        let tile = table.tile(placed.choice.tile);
        let cut = table.window(placed.choice.tile).cut(tile.turns, placed.choice.shift);
        let middle = mosaic.middle(place.0, place.1);
        let joined = &joins[&place];
        let warp = Warp {
            half,
            sides: Side::ALL.map(|side| {
                let own = placed.sides[side as usize].iter().zip(&joined[side as usize]);
                own.filter_map(|(crossing, joined)| Some((f64::from(crossing.at), (*joined)?.1))).collect()
            }),
        };
        let mut vertices: Vec<Option<VertexIx>> = vec![None; cut.points.len()];
        for side in Side::ALL {
            let beside = mosaic.beside(place.0, place.1, side);
            for (k, (_, point)) in cut.sides[side as usize].iter().enumerate() {
                let mut at = cut.points[*point as usize];
                let Some((i, by)) = joined[side as usize][k] else {
                    if beside.is_some_and(|(column, row)| mosaic.at(column, row).is_some()) {
                        let v = woven.graph.add_vertex(middle + warp.of(at));
                        vertices[*point as usize] = Some(v);
                        woven.loose.push(v);
                    }
                    continue;
                };
                let there = beside.and_then(|beside| ends.get(&beside)).map(|ends| ends[side.opposite() as usize][i]);
                at[1 - side.axis()] += by;
                let v = there.unwrap_or_else(|| woven.graph.add_vertex(middle + at));
                vertices[*point as usize] = Some(v);
                if by.abs() > FAR {
                    woven.moved.push(v);
                }
            }
        }
        for (vertex, point) in vertices.iter_mut().zip(&cut.points) {
            if vertex.is_none() {
                let at = warp.of(*point);
                let v = woven.graph.add_vertex(middle + at);
                *vertex = Some(v);
                if at.distance(*point) > FAR {
                    woven.moved.push(v);
                }
            }
        }
        let vertex = |point: u32| vertices[point as usize].unwrap_or_default();
        for &(a, b, class) in &cut.edges {
            let (a, b) = (vertex(a), vertex(b));
            if a != b && woven.graph.edge_between(a, b).is_none() {
                woven.graph.add_edge(a, b, Of { class, patch: Some(tile.patch) });
            }
        }
        ends.insert(place, cut.sides.map(|side| side.into_iter().map(|(_, point)| vertex(point)).collect()));
        woven.warps.insert(place, warp);
    }
    woven.loose.retain(|v| woven.graph.degree(*v) == 1);
    woven
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;

    fn warp(west: &[(f64, f64)], south: &[(f64, f64)]) -> Warp {
        Warp { half: 100.0, sides: [west.to_vec(), Vec::new(), south.to_vec(), Vec::new()] }
    }

    #[test]
    fn a_side_moves_with_its_streets_and_the_middle_stays() {
        let warp = warp(&[(-40.0, 8.0), (40.0, -4.0)], &[]);
        let at = |x: f64, y: f64| warp.of(DVec2::new(x, y)) - DVec2::new(x, y);
        assert_eq!(at(-100.0, -40.0), DVec2::Y * 8.0);
        assert_eq!(at(-100.0, 0.0), DVec2::Y * 2.0, "between the streets");
        assert_eq!(at(-100.0, 90.0), DVec2::Y * -4.0, "beyond them");
        assert_eq!(at(-55.0, -40.0), DVec2::Y * 4.0, "half as far in");
        assert_eq!([at(0.0, -40.0), at(100.0, -40.0)], [DVec2::ZERO; 2]);
    }

    #[test]
    fn what_lies_in_order_along_a_side_stays_in_order() {
        let mut rng = Seed(3).stream("warp", &[]);
        for _ in 0..200 {
            let side = |rng: &mut crate::space::Stream| -> Vec<(f64, f64)> {
                // Streets of both tiles in order, each moved half of the way to the other one.
                let (mut own, mut other) = (rng.range(-95.0, -60.0), rng.range(-95.0, -60.0));
                let mut out = Vec::new();
                while own < 90.0 && other < 90.0 {
                    out.push((own, (other - own).clamp(-30.0, 30.0) / 2.0));
                    (own, other) = (own + rng.range(10.0, 70.0), other + rng.range(10.0, 70.0));
                }
                out
            };
            let warp = warp(&side(&mut rng), &[]);
            let line: Vec<f64> = (-100..=100).map(|y| warp.of(DVec2::new(-100.0, f64::from(y))).y).collect();
            assert!(line.array_windows().all(|[a, b]| a < b), "{warp:?}");
        }
    }
}
