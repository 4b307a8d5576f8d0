//! Edges that cross, split where they do.

use super::sheet::{Point, Sheet, turn};
use crate::space::QUANTUM;
use glam::{DVec2, I64Vec2, IVec2};

/// Edge of a cell in which edges are compared, in metres.
const CELL: f64 = 2.0;

/// Crossings lie on multiples of this, in steps of the quantum, so that no two are closer to each other; an edge passes through all
/// points nearer to it than three quarters of this. Otherwise slivers without an area worth the name arise.
const SNAP: i32 = 8;

/// Rounds of splitting: rounding a crossing to the quantum grid may make others.
const ROUNDS: usize = 8;

/// The edges split at every point of another edge on them and wherever two of them cross, each once. The first `fixed` edges are
/// not split. Adds the crossings to the sheet, at the heights of one of their edges. Returns the edges after the
/// fixed ones, and the crossings.
pub(super) fn arrange(sheet: &mut Sheet, fixed: &[[u32; 2]], edges: Vec<[u32; 2]>) -> (Vec<[u32; 2]>, Vec<u32>) {
    let known = sheet.points.len() as u32;
    if edges.is_empty() {
        return (edges, Vec::new());
    }
    let mut open = edges;
    for _ in 0..ROUNDS {
        let splits = splits(sheet, fixed, &open);
        if splits.is_empty() {
            break;
        }
        let mut next = Vec::with_capacity(open.len() + splits.len());
        let mut splits = splits.as_slice();
        for (i, ends) in open.iter().enumerate() {
            let own = splits.iter().take_while(|s| s.0 as usize == i).count();
            let (mine, rest) = splits.split_at(own);
            splits = rest;
            let [a, b] = ends.map(|v| sheet.points[v as usize].at);
            let mut chain: Vec<(i64, u32)> = mine
                .iter()
                .map(|(_, v)| ((sheet.points[*v as usize].at - a).as_i64vec2().dot((b - a).as_i64vec2()), *v))
                .collect();
            chain.sort_unstable();
            let mut last = ends[0];
            for v in chain.into_iter().map(|c| c.1).chain([ends[1]]) {
                if v != last {
                    next.push([last.min(v), last.max(v)]);
                }
                last = v;
            }
        }
        next.sort_unstable();
        next.dedup();
        open = next;
    }
    (open, (known..sheet.points.len() as u32).collect())
}

/// For open edges, by index, the vertices at which they are split; sorted.
fn splits(sheet: &mut Sheet, fixed: &[[u32; 2]], open: &[[u32; 2]]) -> Vec<(u32, u32)> {
    let cell = (CELL / QUANTUM) as i32;
    let columns = sheet.edge / cell + 1;
    let mut entries: Vec<(u32, u32)> = Vec::with_capacity(open.len() * 4);
    let mut touched = vec![false; ((sheet.edge + 1) / cell + 1) as usize * columns as usize];
    for (i, ends) in open.iter().chain(fixed).enumerate() {
        let [a, b] = ends.map(|v| sheet.points[v as usize].at);
        let (low, high) = ((a.min(b) - 1).max(IVec2::ZERO) / cell, (a.max(b) + 1) / cell);
        for y in low.y..=high.y {
            for at in low.x + y * columns..=high.x + y * columns {
                // Edges that are not split only matter where others are.
                if i < open.len() || touched[at as usize] {
                    touched[at as usize] = true;
                    entries.push((at as u32, i as u32));
                }
            }
        }
    }
    entries.sort_unstable();
    let ends = |i: u32| if (i as usize) < open.len() { open[i as usize] } else { fixed[i as usize - open.len()] };
    let mut out = Vec::new();
    for group in entries.chunk_by(|a, b| a.0 == b.0) {
        for (k, (_, i)) in group.iter().enumerate() {
            if *i as usize >= open.len() {
                break;
            }
            let e = ends(*i);
            let [a, b] = e.map(|v| sheet.points[v as usize].at);
            let (low, high) = (a.min(b) - 1, a.max(b) + 1);
            for (_, j) in &group[k + 1..] {
                let f = ends(*j);
                let [c, d] = f.map(|v| sheet.points[v as usize].at);
                let first = (c.min(d) - 1).max(low);
                if first.cmpgt(high.min(c.max(d) + 1)).any() {
                    continue;
                }
                // Two edges are compared in one of the cells that both come into.
                let first = first.max(IVec2::ZERO) / cell;
                if first.y * columns + first.x != group[0].0 as i32 {
                    continue;
                }
                let splits_f = (*j as usize) < open.len();
                let mut touched = false;
                for v in f {
                    if !e.contains(&v) && is_on(sheet.points[v as usize].at, a, b) {
                        out.push((*i, v));
                        touched = true;
                    }
                }
                for v in e {
                    if splits_f && !f.contains(&v) && is_on(sheet.points[v as usize].at, c, d) {
                        out.push((*j, v));
                        touched = true;
                    }
                }
                if touched || e.iter().any(|v| f.contains(v)) {
                    continue;
                }
                let sides = |a, b, c, d| turn(a, b, c).signum() * turn(a, b, d).signum();
                if sides(a, b, c, d) < 0 && sides(c, d, a, b) < 0 {
                    let (at, t) = crossing([a, b], [c, d], sheet.edge);
                    let [low, high] = f.map(|v| sheet.points[v as usize].height);
                    let v = sheet.id(Point { at, height: low + (high - low) * t });
                    out.extend((!e.contains(&v)).then_some((*i, v)));
                    out.extend((splits_f && !f.contains(&v)).then_some((*j, v)));
                }
            }
        }
    }
    out.sort_unstable();
    out.dedup();
    out
}

/// Whether a point lies between the ends of an edge, and so near to it that the edge passes through it.
fn is_on(p: IVec2, a: IVec2, b: IVec2) -> bool {
    let (ab, ap) = ((b - a).as_i64vec2(), (p - a).as_i64vec2());
    let along = ab.dot(ap);
    let length = ab.length_squared();
    let off = I64Vec2::perp_dot(ab, ap).abs();
    let near = i128::from(3 * SNAP / 4);
    along > 0 && along < length && i128::from(off) * i128::from(off) <= near * near * i128::from(length)
}

/// The point of the grid of crossings nearest to where two edges cross, inside the square of `edge` steps, and where on the second
/// edge, 0 to 1, they cross.
fn crossing([a, b]: [IVec2; 2], [c, d]: [IVec2; 2], edge: i32) -> (IVec2, f64) {
    let (oc, od) = (turn(a, b, c) as f64, turn(a, b, d) as f64);
    let t = oc / (oc - od);
    let at: DVec2 = c.as_dvec2() + (d - c).as_dvec2() * t;
    let at = (at / f64::from(SNAP)).round().as_ivec2() * SNAP;
    (at.clamp(IVec2::splat(SNAP), IVec2::splat(edge - SNAP)), t)
}
