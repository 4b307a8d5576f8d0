//! Figures of a part of a street map, taken as OSMnx takes them, so that towns compare with published figures of real ones.

use super::directions::{is_sharp, orientation_order};
use crate::network::{JunctionId, Network, PlanarGraph};
use crate::space::{Bounds, distance_to_segment, line_length, segments};
use glam::DVec2;
use serde::Serialize;
use std::collections::BTreeMap;

/// Streets reach this far to the built-up area around them, in metres.
const BUFFER: f64 = 100.0;
/// Edge of a cell of the raster that the built-up area is counted on, in metres.
const CELL: f64 = 5.0;

/// Figures of the junctions of a part of a map and of the streets between these.
///
/// The streets are those of the simplified graph: from one vertex whose degree is not 2 to the next. A vertex has the degree that
/// it has in the whole map; a street counts if both its ends are in the part.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Survey {
    /// Square kilometres within 100 m of the streets, holes filled.
    pub area_km2: f64,
    /// Total length of the streets in kilometres.
    pub street_km: f64,
    /// Number of streets.
    pub streets: usize,
    /// Vertices of degree 3 or more.
    pub junctions: usize,
    /// Vertices of degree 1.
    pub dead_ends: usize,
    /// Junctions in a square kilometre of `area_km2`.
    pub junctions_per_km2: f64,
    /// Kilometres of street in a square kilometre of `area_km2`.
    pub street_km_per_km2: f64,
    /// Connected node ratio: junctions / (junctions + dead ends) (Teng 2017, equation 2).
    pub cnr: f64,
    /// Mean length of a street in metres.
    pub mean_street_m: f64,
    /// Share of dead ends among dead ends and junctions.
    pub share_dead_ends: f64,
    /// Share of junctions of three streets among dead ends and junctions.
    pub share_3_way: f64,
    /// Share of junctions of four streets among dead ends and junctions.
    pub share_4_way: f64,
    /// Boeing's orientation order phi, of the bearings from end to end: 1 for one perfect grid, 0 for no order (36 bins).
    pub orientation_order: f64,
    /// Total length over total distance from end to end.
    pub circuity: f64,
    /// Median area of what the streets enclose, in square metres; 0 if they enclose nothing.
    pub block_median_m2: f64,
    /// Share of junctions whose smallest angle is below 30 degrees.
    pub share_angle_below_30: f64,
}

/// A street of the simplified graph: its ends as indices of junctions, and its line.
struct Chain {
    ends: [usize; 2],
    line: Vec<DVec2>,
}

/// Surveys the junctions for which `inside` holds and the streets between them.
pub fn survey(network: &Network, inside: impl Fn(DVec2) -> bool) -> Survey {
    let chains = chains(network);
    let kept: Vec<bool> = network.junctions.iter().map(|j| inside(j.at)).collect();
    let mut leaving: Vec<Vec<DVec2>> = vec![Vec::new(); network.junctions.len()];
    for Chain { ends: [from, to], line } in &chains {
        leaving[*from].push(line[1] - line[0]);
        leaving[*to].push(line[line.len() - 2] - line[line.len() - 1]);
    }
    let (mut degrees, mut sharp) = (BTreeMap::<usize, usize>::new(), 0);
    for around in leaving.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(l, _)| l) {
        *degrees.entry(around.len()).or_default() += 1;
        sharp += usize::from(is_sharp(around));
    }
    let chains: Vec<&Chain> = chains.iter().filter(|c| kept[c.ends[0]] && kept[c.ends[1]]).collect();
    let length = chains.iter().fold(0.0, |sum, c| sum + line_length(&c.line));
    let beeline = |c: &Chain| c.line[c.line.len() - 1] - c.line[0];
    let straight = chains.iter().fold(0.0, |sum, c| sum + beeline(c).length());
    let junctions = degrees.range(3..).map(|(_, n)| n).sum::<usize>();
    let dead_ends = degrees.get(&1).copied().unwrap_or(0);
    let nodes = (junctions + dead_ends).max(1) as f64;
    let share = |degree: usize| degrees.get(&degree).copied().unwrap_or(0) as f64 / nodes;
    let area_km2 = built_up(&chains);
    let per_km2 = |x: f64| if area_km2 > 0.0 { x / area_km2 } else { 0.0 };
    Survey {
        area_km2,
        street_km: length / 1e3,
        streets: chains.len(),
        junctions,
        dead_ends,
        junctions_per_km2: per_km2(junctions as f64),
        street_km_per_km2: per_km2(length / 1e3),
        cnr: junctions as f64 / nodes,
        mean_street_m: length / chains.len().max(1) as f64,
        share_dead_ends: share(1),
        share_3_way: share(3),
        share_4_way: share(4),
        orientation_order: orientation_order(
            chains.iter().filter(|c| c.ends[0] != c.ends[1]).map(|c| beeline(c)).filter(|d| *d != DVec2::ZERO),
        ),
        circuity: if straight > 0.0 { length / straight } else { 1.0 },
        block_median_m2: median_block(&chains),
        share_angle_below_30: sharp as f64 / junctions.max(1) as f64,
    }
}

/// The streets of the simplified graph. Rings without a junction are left out.
fn chains(network: &Network) -> Vec<Chain> {
    let index: BTreeMap<JunctionId, usize> = network.junctions.iter().enumerate().map(|(i, j)| (j.id, i)).collect();
    // Streets at each junction, and which of a street's ends is there.
    let mut around: Vec<Vec<(usize, usize)>> = vec![Vec::new(); network.junctions.len()];
    let mut ends = Vec::new();
    for (s, street) in network.streets.iter().enumerate() {
        let at = [street.from, street.to].map(|id| index.get(&id).copied());
        ends.push(at);
        if let [Some(from), Some(to)] = at {
            around[from].push((s, 0));
            around[to].push((s, 1));
        }
    }
    let mut used = vec![false; network.streets.len()];
    let mut out = Vec::new();
    for start in (0..around.len()).filter(|v| around[*v].len() != 2) {
        for &first in &around[start] {
            if used[first.0] {
                continue;
            }
            let (mut at, mut next, mut line) = (start, first, Vec::new());
            loop {
                let (s, end) = next;
                used[s] = true;
                let points = &network.streets[s].line;
                let mut add = |p: DVec2| {
                    if line.last() != Some(&p) {
                        line.push(p);
                    }
                };
                if end == 0 {
                    points.iter().for_each(|p| add(*p))
                } else {
                    points.iter().rev().for_each(|p| add(*p))
                }
                at = ends[s][1 - end].unwrap_or(at);
                let onward = around[at].iter().find(|(t, _)| !used[*t]);
                match onward {
                    Some(onward) if around[at].len() == 2 => next = *onward,
                    _ => break,
                }
            }
            if line.len() >= 2 {
                out.push(Chain { ends: [start, at], line });
            }
        }
    }
    out
}

/// Square kilometres within reach of the streets, holes filled.
fn built_up(chains: &[&Chain]) -> f64 {
    let all = Bounds::of(chains.iter().flat_map(|c| c.line.iter().copied()));
    if chains.is_empty() {
        return 0.0;
    }
    // A rim of free cells all around, from which the outside is flooded.
    let bounds = all.grown(BUFFER + 2.0 * CELL);
    let (columns, rows) = ((bounds.size().x / CELL).ceil() as usize, (bounds.size().y / CELL).ceil() as usize);
    let cells = |p: DVec2| ((p - bounds.min) / CELL).max(DVec2::ZERO).as_usizevec2();
    let mut taken = vec![false; columns * rows];
    for (a, b) in chains.iter().flat_map(|c| segments(&c.line)) {
        let near = Bounds::of([a, b]).grown(BUFFER);
        let (low, high) = (cells(near.min), cells(near.max));
        for y in low.y..=high.y.min(rows - 1) {
            for x in low.x..=high.x.min(columns - 1) {
                let cell = &mut taken[y * columns + x];
                let middle = bounds.min + DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * CELL;
                *cell = *cell || distance_to_segment(middle, a, b) <= BUFFER;
            }
        }
    }
    let mut outside = vec![false; columns * rows];
    let mut stack = vec![0];
    while let Some(cell) = stack.pop() {
        if taken[cell] || outside[cell] {
            continue;
        }
        outside[cell] = true;
        let (x, y) = (cell % columns, cell / columns);
        stack.extend([(x > 0, -1), (x + 1 < columns, 1)].iter().filter(|n| n.0).map(|n| cell.wrapping_add_signed(n.1)));
        let row = columns as isize;
        stack
            .extend([(y > 0, -row), (y + 1 < rows, row)].iter().filter(|n| n.0).map(|n| cell.wrapping_add_signed(n.1)));
    }
    outside.iter().filter(|o| !**o).count() as f64 * CELL * CELL / 1e6
}

/// Median area of the faces between streets.
fn median_block(chains: &[&Chain]) -> f64 {
    let mut graph = PlanarGraph::<()>::without_index();
    let mut known: BTreeMap<usize, u32> = BTreeMap::new();
    for chain in chains {
        let last = chain.line.len() - 1;
        let mut before = None;
        for (i, p) in chain.line.iter().enumerate() {
            let vertex = match i {
                0 => *known.entry(chain.ends[0]).or_insert_with(|| graph.add_vertex(*p)),
                i if i == last => *known.entry(chain.ends[1]).or_insert_with(|| graph.add_vertex(*p)),
                _ => graph.add_vertex(*p),
            };
            if let Some(before) = before.filter(|b| *b != vertex) {
                graph.add_edge(before, vertex, ());
            }
            before = Some(vertex);
        }
    }
    let mut areas: Vec<f64> = graph.faces().iter().map(|f| f.area()).filter(|a| *a > 0.0).collect();
    areas.sort_by(f64::total_cmp);
    match areas.len() {
        0 => 0.0,
        n if n % 2 == 1 => areas[n / 2],
        n => (areas[n / 2 - 1] + areas[n / 2]) / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Junction, Street, StreetClass, StreetId};

    /// A grid of `n` by `n` junctions, 100 m apart, each street in two pieces.
    fn grid(n: u64) -> Network {
        let at = |x: u64, y: u64| DVec2::new(x as f64 * 100.0, y as f64 * 100.0);
        let mut out = Network::default();
        for (x, y) in (0..n).flat_map(|x| (0..n).map(move |y| (x, y))) {
            let id = x * n + y;
            out.junctions.push(Junction { id: JunctionId(id), at: at(x, y) });
            for (dx, dy, key) in [(1, 0, 1000), (0, 1, 2000)] {
                let (to, middle) = ((x + dx) * n + y + dy, JunctionId(key + id));
                if x + dx < n && y + dy < n {
                    let half = at(x, y).midpoint(at(x + dx, y + dy));
                    out.junctions.push(Junction { id: middle, at: half });
                    let class = StreetClass::Local;
                    let [from, to] = [JunctionId(id), JunctionId(to)];
                    let [a, b] = [StreetId(2 * (key + id)), StreetId(2 * (key + id) + 1)];
                    out.streets.push(Street::new(a, class, from, middle, vec![at(x, y), half]));
                    out.streets.push(Street::new(b, class, to, middle, vec![at(x + dx, y + dy), half]));
                }
            }
        }
        out
    }

    #[test]
    fn a_grid_in_pieces_is_a_grid() {
        let all = survey(&grid(5), |_| true);
        // The four corners are bends.
        assert_eq!((all.junctions, all.dead_ends, all.streets), (21, 0, 36));
        assert_eq!((all.cnr, all.street_km, all.share_4_way), (1.0, 4.0, 9.0 / 21.0));
        assert_eq!((all.block_median_m2, all.share_angle_below_30), (1e4, 0.0));
        // Four streets are bent at a corner.
        assert!(all.orientation_order < 1.0 && all.circuity > 1.0);
        let middle = survey(&grid(5), |p| Bounds::new(DVec2::splat(50.0), DVec2::splat(350.0)).contains(p));
        assert_eq!((middle.junctions, middle.streets, middle.share_4_way), (9, 12, 1.0));
        assert_eq!((middle.circuity, middle.mean_street_m), (1.0, 100.0));
        assert!((middle.orientation_order - 1.0).abs() < 1e-12);
        // A square of 400 m with corners of a radius of 100 m.
        let area = 0.04 + 4.0 * 0.02 + 0.01 * std::f64::consts::PI;
        assert!((middle.area_km2 / area - 1.0).abs() < 0.01, "{} is not {area}", middle.area_km2);
    }

    #[test]
    fn nothing_has_no_figures() {
        let none = survey(&grid(3), |_| false);
        assert_eq!((none.area_km2, none.junctions_per_km2, none.mean_street_m), (0.0, 0.0, 0.0));
    }
}
