//! The ground around the surface: a regular grid where it is far from streets, a constrained triangulation where it is near.

use super::arrange::arrange;
use super::outline::{Edge, shared_edges};
use super::overlaps::Overlaps;
use super::sheet::{Point, Sheet, turn};
use super::triangulation::Triangulation;
use crate::space::{QUANTUM, distance_to_segment};
use crate::surface::finish::Finish;
use crate::terrain::GROUND_STEP;
use glam::{DVec2, IVec2};

/// Vertices of the ground's grid nearer than this to the surface are left out, in metres: they would make thin triangles.
const CLEARANCE: f64 = 1.5;

/// Triangles with what they are made of, as indices of the sheet's points.
type Triangles = Vec<([u32; 3], Finish)>;

/// The ground and the shared parts of the surface.
pub(super) struct Around {
    pub triangles: Triangles,
    /// Whether each square of the ground's grid is triangulated around the surface.
    pub near: Vec<bool>,
}

/// Why a triangulation failed: the parts whose shapes cannot stand beside the others.
pub(super) struct Contradiction(pub Vec<u32>);

/// The grid of the ground in the square.
struct Grid {
    /// Squares along an edge.
    cells: usize,
    /// Edge of a square in steps of the quantum.
    step: i32,
    /// Whether a vertex takes no part.
    without: Vec<bool>,
    /// Whether a square is triangulated around the surface.
    near: Vec<bool>,
}

impl Grid {
    fn vertex(&self, column: usize, row: usize) -> usize {
        row * (self.cells + 1) + column
    }

    fn square(&self, column: usize, row: usize) -> usize {
        row * self.cells + column
    }

    fn at(&self, column: usize, row: usize) -> IVec2 {
        IVec2::new(column as i32, row as i32) * self.step
    }

    fn of(sheet: &Sheet, outline: &[Edge], shared: &[[u32; 2]], overlaps: Option<&Overlaps<'_>>) -> Self {
        let step = (GROUND_STEP / QUANTUM) as i32;
        let cells = (sheet.edge / step) as usize;
        let mut grid =
            Self { cells, step, without: vec![false; (cells + 1) * (cells + 1)], near: vec![false; cells * cells] };
        for triangle in &sheet.triangles {
            let at = triangle.corners.map(|v| sheet.points[v as usize].at);
            grid.mark_near(at);
        }
        let edges = outline.iter().map(|e| e.ends).chain(shared.iter().copied());
        for ends in edges {
            let [a, b] = ends.map(|v| sheet.plan(v));
            let low = ((a.min(b) - CLEARANCE) / GROUND_STEP).ceil().max(DVec2::ONE).as_usizevec2();
            let high = ((a.max(b) + CLEARANCE) / GROUND_STEP).floor().as_usizevec2();
            // Vertices on the border stay, since the neighbour does not know this edge.
            for row in low.y..=high.y.min(cells - 1) {
                for column in low.x..=high.x.min(cells - 1) {
                    let p = DVec2::new(column as f64, row as f64) * GROUND_STEP;
                    let vertex = grid.vertex(column, row);
                    grid.without[vertex] |= distance_to_segment(p, a, b) < CLEARANCE;
                }
            }
        }
        if let Some(overlaps) = overlaps {
            for row in 1..cells {
                for column in 1..cells {
                    let p = DVec2::new(column as f64, row as f64) * GROUND_STEP;
                    let vertex = grid.vertex(column, row);
                    grid.without[vertex] |= overlaps.at(p).is_some();
                }
            }
        }
        grid.leave_out_covered_border(sheet);
        for row in 0..=cells {
            for column in 0..=cells {
                if grid.without[grid.vertex(column, row)] {
                    for r in row.max(1) - 1..=row.min(cells - 1) {
                        for c in column.max(1) - 1..=column.min(cells - 1) {
                            let square = grid.square(c, r);
                            grid.near[square] = true;
                        }
                    }
                }
            }
        }
        grid
    }

    /// Marks the squares that a triangle touches.
    fn mark_near(&mut self, at: [IVec2; 3]) {
        let low = (at[0].min(at[1]).min(at[2]) - 1).div_euclid(IVec2::splat(self.step)).max(IVec2::ZERO);
        let high = (at[0].max(at[1]).max(at[2]) + 1)
            .div_euclid(IVec2::splat(self.step))
            .min(IVec2::splat(self.cells as i32 - 1));
        let large = (high - low).max_element() > 1;
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let square = [IVec2::new(x, y), IVec2::new(x + 1, y), IVec2::new(x, y + 1), IVec2::new(x + 1, y + 1)];
                // A square on the outer side of one of the edges is clear of the triangle.
                let clear =
                    large && (0..3).any(|i| square.iter().all(|c| turn(at[i], at[(i + 1) % 3], *c * self.step) < 0));
                if !clear {
                    let square = self.square(x as usize, y as usize);
                    self.near[square] = true;
                }
            }
        }
    }

    /// Leaves out vertices on the border of the square over which the surface runs.
    fn leave_out_covered_border(&mut self, sheet: &Sheet) {
        for triangle in &sheet.triangles {
            for i in 0..3 {
                let ends = [triangle.corners[i], triangle.corners[(i + 1) % 3]];
                if !sheet.is_on_border(ends) {
                    continue;
                }
                let [a, b] = ends.map(|v| sheet.points[v as usize].at);
                let (low, high) = (a.min(b), a.max(b));
                let first = (low + self.step - 1).div_euclid(IVec2::splat(self.step));
                let last = high.div_euclid(IVec2::splat(self.step));
                for y in first.y..=last.y {
                    for x in first.x..=last.x {
                        let at = IVec2::new(x, y) * self.step;
                        // The ends of the edge are vertices of the surface.
                        if at != a && at != b {
                            let vertex = self.vertex(x as usize, y as usize);
                            self.without[vertex] = true;
                        }
                    }
                }
            }
        }
    }
}

/// Triangles of the ground and of the shared parts of the surface, around the `outline` of the rest. Adds vertices of the ground
/// to the sheet: `height` gives theirs, for a column and a row of the grid.
pub(super) fn around(
    sheet: &mut Sheet,
    outline: &[Edge],
    mut height: impl FnMut(usize, usize) -> f64,
) -> Result<Around, Contradiction> {
    let fixed: Vec<[u32; 2]> = outline.iter().map(|e| e.ends).collect();
    let (shared, crossings) = arrange(sheet, &fixed, shared_edges(sheet));
    if let Some(overlaps) = Overlaps::new(sheet) {
        let heights: Vec<Option<f64>> = crossings.iter().map(|v| overlaps.crossing_height(sheet.plan(*v))).collect();
        for (v, height) in crossings.into_iter().zip(heights) {
            let point = &mut sheet.points[v as usize];
            point.height = height.unwrap_or(point.height);
        }
    }
    let mut out = Triangles::new();
    let grid = {
        let overlaps = Overlaps::new(sheet);
        Grid::of(sheet, outline, &shared, overlaps.as_ref())
    };
    // Vertices of the grid that take part, as points of the sheet.
    let mut vertices = vec![u32::MAX; grid.without.len()];
    for row in 0..=grid.cells {
        for column in 0..=grid.cells {
            let vertex = grid.vertex(column, row);
            if !grid.without[vertex] {
                let at = grid.at(column, row);
                vertices[vertex] = match sheet.find(at) {
                    Some(known) => known,
                    None => sheet.id(Point { at, height: height(column, row) }),
                };
            }
        }
    }
    let mut net = Vertices { slots: vec![u32::MAX; sheet.points.len() + 4], ..Vertices::default() };
    let mut rim = Vec::new();
    // The triangulation grows from the corners of the square.
    for (column, row) in [(0, 0), (grid.cells, 0), (grid.cells, grid.cells), (0, grid.cells)] {
        let at = grid.at(column, row);
        let corner = sheet.id(Point { at, height: height(column, row) });
        net.vertex(sheet, corner);
    }
    for row in 0..grid.cells {
        for column in 0..grid.cells {
            let corner = |c: usize, r: usize| vertices[grid.vertex(column + c, row + r)];
            if !grid.near[grid.square(column, row)] {
                let [sw, se, nw, ne] = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
                out.push(([sw, se, ne], Finish::Ground));
                out.push(([sw, ne, nw], Finish::Ground));
                continue;
            }
            for (c, r) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                if corner(c, r) != u32::MAX {
                    net.vertex(sheet, corner(c, r));
                }
            }
            // Between regular squares and others runs an edge.
            let far = |c: isize, r: isize| {
                let (c, r) = (column as isize + c, row as isize + r);
                let inside = c >= 0 && r >= 0 && c < grid.cells as isize && r < grid.cells as isize;
                inside && !grid.near[grid.square(c as usize, r as usize)]
            };
            let sides = [
                ((-1, 0), (0, 0), (0, 1)),
                ((1, 0), (1, 0), (1, 1)),
                ((0, -1), (0, 0), (1, 0)),
                ((0, 1), (0, 1), (1, 1)),
            ];
            for ((dc, dr), a, b) in sides {
                if far(dc, dr) {
                    rim.push([corner(a.0, a.1), corner(b.0, b.1)].map(|v| net.vertex(sheet, v)));
                }
            }
        }
    }
    if !grid.near.contains(&true) {
        return Ok(Around { triangles: out, near: grid.near });
    }
    // Corners of the surface on the border are not ends of its outline everywhere.
    for triangle in &sheet.triangles {
        for v in triangle.corners {
            let at = sheet.points[v as usize].at;
            if at.min_element() == 0 || at.max_element() == sheet.edge {
                net.vertex(sheet, v);
            }
        }
    }
    let outline: Vec<([u32; 2], u32)> =
        outline.iter().map(|e| (e.ends.map(|v| net.vertex(sheet, v)), e.part)).collect();
    let shared: Vec<[u32; 2]> = shared.iter().map(|ends| ends.map(|v| net.vertex(sheet, v))).collect();
    let mut mesh = Triangulation::new(&net.at);
    for [a, b] in rim {
        // Nothing crosses the rim, since no surface comes near it.
        let _ = mesh.fix(a, b);
    }
    let covered = cover(&mut mesh, &outline)?;
    for [a, b] in shared {
        // One of two edges that cross by rounding gives way.
        let _ = mesh.fix(a, b);
    }
    let middle = |h: u32| mesh.corners(h).map(|v| net.at[v as usize]).iter().sum::<IVec2>() / 3;
    let is_ground = |t: usize| {
        let square = (middle(3 * t as u32) / grid.step).min(IVec2::splat(grid.cells as i32 - 1)).as_usizevec2();
        !covered[t] && grid.near[grid.square(square.x, square.y)]
    };
    let free: Vec<bool> = (0..covered.len()).map(is_ground).collect();
    mesh.improve(&free);
    let overlaps = Overlaps::new(sheet);
    for t in (0..free.len()).filter(|t| free[*t]) {
        let corners = mesh.corners(3 * t as u32).map(|v| net.points[v as usize]);
        let middle = corners.map(|v| sheet.plan(v)).iter().sum::<DVec2>() / 3.0;
        let finish = overlaps.as_ref().and_then(|o| o.at(middle)).map_or(Finish::Ground, |(finish, _)| finish);
        out.push((corners, finish));
    }
    Ok(Around { triangles: out, near: grid.near })
}

/// Vertices of a triangulation.
#[derive(Default)]
struct Vertices {
    at: Vec<IVec2>,
    /// The point of the sheet of each vertex.
    points: Vec<u32>,
    /// The vertex of each point of the sheet.
    slots: Vec<u32>,
}

impl Vertices {
    fn vertex(&mut self, sheet: &Sheet, point: u32) -> u32 {
        let slot = &mut self.slots[point as usize];
        if *slot == u32::MAX {
            *slot = self.at.len() as u32;
            self.at.push(sheet.points[point as usize].at);
            self.points.push(point);
        }
        *slot
    }
}

/// Fixes the `outline` of the surface, given as edges with their parts and the surface on the left. Returns for each triangle
/// whether it lies under the surface.
fn cover(mesh: &mut Triangulation<'_>, outline: &[([u32; 2], u32)]) -> Result<Vec<bool>, Contradiction> {
    let torn: Vec<u32> =
        outline.iter().filter(|([a, b], _)| mesh.fix(*a, *b).is_err()).map(|(_, part)| *part).collect();
    if !torn.is_empty() {
        return Err(Contradiction(torn));
    }
    // The half-edges of the outline, except where a vertex lies on it.
    let edges: Vec<(Option<u32>, u32)> = outline.iter().map(|([a, b], part)| (mesh.find(*a, *b), *part)).collect();
    let mut open: Vec<u32> = edges.iter().filter_map(|edge| edge.0).collect();
    // Nothing passes from under the surface over its outline.
    let mut barred = vec![false; mesh.half_edges() as usize];
    open.iter().for_each(|h| barred[*h as usize] = true);
    let mut covered = vec![false; barred.len() / 3];
    while let Some(h) = open.pop() {
        let first = h - h % 3;
        if !std::mem::replace(&mut covered[h as usize / 3], true) {
            open.extend((first..first + 3).filter(|h| !barred[*h as usize]).filter_map(|h| mesh.twin(h)));
        }
    }
    // An outline with the surface on both sides belongs to a part that lies on another.
    let is_whole = |h: u32| mesh.twin(h).is_none_or(|twin| !covered[twin as usize / 3]);
    let torn: Vec<u32> = edges.iter().filter(|(h, _)| !h.is_some_and(is_whole)).map(|(_, part)| *part).collect();
    if torn.is_empty() { Ok(covered) } else { Err(Contradiction(torn)) }
}
