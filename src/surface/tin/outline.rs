//! Outlines of the surface, and where shapes overlap.

use super::pairs::{Side, sides};
use super::sheet::{Sheet, turn};
use crate::space::QUANTUM;
use glam::IVec2;

/// An edge of the outline, with the surface on its left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub ends: [u32; 2],
    pub part: u32,
}

/// Edge of a cell in which edges are compared, in metres.
const CELL: f64 = 16.0;

/// The edges of the parts that are not shared which no other of their triangles has on its other side, except on the border of
/// the square. `sides` are the edges of all triangles.
fn outline(sheet: &Sheet, sides: &[Side<u32>]) -> Vec<Edge> {
    let mut out = Vec::new();
    for same in sides.chunk_by(|a, b| a.ends == b.ends) {
        let mut own = same.iter().filter(|side| !sheet.shared[side.of as usize]);
        let paired = match (own.next(), own.next(), own.next()) {
            (None, ..) => true,
            (Some(a), Some(b), None) => a.forward != b.forward,
            _ => false,
        };
        if paired || sheet.is_on_border(same[0].ends) {
            continue;
        }
        for Side { ends: [a, b], forward, of } in same.iter().filter(|side| !sheet.shared[side.of as usize]) {
            out.push(Edge { ends: if *forward { [*a, *b] } else { [*b, *a] }, part: *of });
        }
    }
    out
}

/// The edges of all triangles with their parts.
pub(super) fn all_edges(sheet: &Sheet) -> Vec<Side<u32>> {
    sides(sheet.points.len(), sheet.triangles.iter().map(|t| (t.corners, t.part)), |_| true)
}

/// Marks the parts whose outlines cross. `sides` are the edges of all triangles.
pub(super) fn find_overlaps(sheet: &mut Sheet, sides: &[Side<u32>]) {
    let crossing = crossings(sheet, &outline(sheet, sides), &[]);
    crossing.into_iter().chain(border_overlaps(sheet)).for_each(|part| sheet.shared[part as usize] = true);
}

/// Marks the parts whose shapes overlap shared parts, until nothing else overlaps. Returns the outline of the rest.
pub(super) fn separate(sheet: &mut Sheet, sides: &[Side<u32>]) -> Vec<Edge> {
    loop {
        let rest = outline(sheet, sides);
        // The edges inside of shared parts count, too: they are cut up one by one.
        let inside: Vec<Edge> = shared_edges(sheet).into_iter().map(|ends| Edge { ends, part: u32::MAX }).collect();
        if inside.is_empty() {
            return rest;
        }
        let mut found = false;
        for part in crossings(sheet, &rest, &inside) {
            found |= !std::mem::replace(&mut sheet.shared[part as usize], true);
        }
        if !found {
            return rest;
        }
    }
}

/// The parts that lie over each other on the border of the square: both squares there find the same.
fn border_overlaps(sheet: &Sheet) -> Vec<u32> {
    let mut stretches: Vec<(u8, i32, i32, u32)> = Vec::new();
    for triangle in &sheet.triangles {
        for i in 0..3 {
            let [a, b] = [triangle.corners[i], triangle.corners[(i + 1) % 3]].map(|v| sheet.points[v as usize].at);
            for axis in 0..2 {
                if a[axis] == b[axis] && (a[axis] == 0 || a[axis] == sheet.edge) {
                    let (from, to) = (a[1 - axis].min(b[1 - axis]), a[1 - axis].max(b[1 - axis]));
                    let side = axis as u8 * 2 + u8::from(a[axis] != 0);
                    stretches.push((side, from, to, triangle.part));
                }
            }
        }
    }
    stretches.sort_unstable();
    let mut out = Vec::new();
    let mut farthest: Option<(u8, i32, u32)> = None;
    for (side, from, to, part) in stretches {
        match farthest {
            Some((before, end, other)) if before == side => {
                if from < end {
                    out.extend([part, other]);
                }
                if to > end {
                    farthest = Some((side, to, part));
                }
            }
            _ => farthest = Some((side, to, part)),
        }
    }
    out
}

/// All edges of shared parts, each once, except on the border of the square.
pub(super) fn shared_edges(sheet: &Sheet) -> Vec<[u32; 2]> {
    let mut out = Vec::new();
    for triangle in sheet.triangles.iter().filter(|t| sheet.shared[t.part as usize]) {
        for i in 0..3 {
            let (a, b) = (triangle.corners[i], triangle.corners[(i + 1) % 3]);
            out.push([a.min(b), a.max(b)]);
        }
    }
    out.sort_unstable();
    out.dedup();
    out.retain(|ends| !sheet.is_on_border(*ends));
    out
}

/// The parts of `edges` that cross or touch each other anywhere but at a shared vertex. If there are edges `inside` of shared
/// parts, only what comes near these is looked at.
fn crossings(sheet: &Sheet, edges: &[Edge], inside: &[Edge]) -> Vec<u32> {
    let cell = (CELL / QUANTUM) as i32;
    let columns = sheet.edge / cell + 1;
    let at = |v: u32| sheet.points[v as usize].at;
    let mut entries: Vec<(u32, u32)> = Vec::with_capacity(edges.len() * 2);
    let mut touched = vec![inside.is_empty(); (columns * columns) as usize];
    let all = inside.len() + edges.len();
    let edge = |i: usize| inside.get(i).unwrap_or_else(|| &edges[i - inside.len()]);
    for i in 0..all {
        let [a, b] = edge(i).ends.map(at);
        let (low, high) = (a.min(b) / cell, a.max(b) / cell);
        for y in low.y..=high.y {
            for here in y * columns + low.x..=y * columns + high.x {
                touched[here as usize] |= i < inside.len();
                if touched[here as usize] {
                    entries.push((here as u32, i as u32));
                }
            }
        }
    }
    entries.sort_unstable();
    let mut out = Vec::new();
    for group in entries.chunk_by(|a, b| a.0 == b.0) {
        for (k, (_, i)) in group.iter().enumerate() {
            let e = edge(*i as usize);
            let [a, b] = e.ends.map(at);
            let (low, high) = (a.min(b), a.max(b));
            for (_, j) in &group[k + 1..] {
                let f = edge(*j as usize);
                if e.part == u32::MAX && f.part == u32::MAX {
                    continue;
                }
                let [c, d] = f.ends.map(at);
                let first = c.min(d).max(low);
                if first.cmpgt(high.min(c.max(d))).any() {
                    continue;
                }
                // Two edges are compared in one of the cells that both come into.
                if first.y / cell * columns + first.x / cell != group[0].0 as i32 {
                    continue;
                }
                let [g, h] = [e, f].map(|edge| edge.part == u32::MAX);
                // Parts beside shared parts have edges in common with them.
                let common = (g || h) && (e.ends == f.ends || e.ends == [f.ends[1], f.ends[0]]);
                if !common && meet(e.ends, f.ends, [a, b, c, d]) {
                    out.extend([e.part, f.part].into_iter().filter(|part| *part != u32::MAX));
                }
            }
        }
    }
    out
}

/// Whether two edges share more than a common end.
fn meet(e: [u32; 2], f: [u32; 2], [a, b, c, d]: [IVec2; 4]) -> bool {
    let shared = [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter().find(|(i, j)| e[*i] == f[*j]);
    if let Some((i, j)) = shared {
        if e[1 - i] == f[1 - j] {
            return true;
        }
        let (at, p, q) = (if i == 0 { a } else { b }, if i == 0 { b } else { a }, if j == 0 { d } else { c });
        let along = (p - at).as_i64vec2().dot((q - at).as_i64vec2());
        return turn(at, p, q) == 0 && along > 0;
    }
    let sides = |a, b, c, d| (turn(a, b, c).signum(), turn(a, b, d).signum());
    let ((s, t), (u, v)) = (sides(a, b, c, d), sides(c, d, a, b));
    s * t <= 0 && u * v <= 0
}
