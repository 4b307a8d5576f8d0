//! Finding the triangle at a point.

use crate::surface::finish::Finish;
use glam::{DVec2, DVec3, USizeVec2};

/// Edge of a cell of the index, in metres.
const CELL: f64 = 8.0;

/// Triangles with what they are made of, and their points.
#[derive(Clone, Copy)]
pub(super) struct Net<'a> {
    pub points: &'a [DVec3],
    pub triangles: &'a [([u32; 3], Finish)],
}

/// Triangles by place.
#[derive(Clone, Debug)]
pub(super) struct Index {
    columns: usize,
    /// For each cell, where its triangles begin in `triangles`; and the end of the last.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Index {
    /// The index of triangles over the square of `size` metres.
    pub fn new(size: i64, net: Net<'_>) -> Self {
        let columns = (size as f64 / CELL).ceil().max(1.0) as usize;
        let cells = |corners: &[u32; 3]| {
            let at = corners.map(|v| net.points[v as usize].truncate());
            let cell = |p: DVec2| (p.max(DVec2::ZERO) / CELL).as_usizevec2().min(USizeVec2::splat(columns - 1));
            let (low, high) = (cell(at[0].min(at[1]).min(at[2])), cell(at[0].max(at[1]).max(at[2])));
            (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| y * columns + x))
        };
        let mut starts = vec![0u32; columns * columns + 1];
        for (corners, _) in net.triangles {
            cells(corners).for_each(|cell| starts[cell + 1] += 1);
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut triangles = vec![0u32; starts[columns * columns] as usize];
        for (i, (corners, _)) in net.triangles.iter().enumerate() {
            for cell in cells(corners) {
                triangles[next[cell] as usize] = i as u32;
                next[cell] += 1;
            }
        }
        Self { columns, starts, triangles }
    }

    /// The triangle at a point of the square, and the weights of its corners there. A point beside all triangles by rounding
    /// belongs to the nearest.
    pub fn find(&self, net: Net<'_>, p: DVec2) -> Option<(u32, [f64; 3])> {
        let cell = (p / CELL).as_usizevec2().min(USizeVec2::splat(self.columns - 1));
        let cell = cell.y * self.columns + cell.x;
        let mut best: Option<(f64, u32, [f64; 3])> = None;
        for i in &self.triangles[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
            let [a, b, c] = net.triangles[*i as usize].0.map(|v| net.points[v as usize].truncate());
            let area = (b - a).perp_dot(c - a);
            let weights = [(c - b).perp_dot(p - b), (a - c).perp_dot(p - c), (b - a).perp_dot(p - a)].map(|w| w / area);
            let least = weights[0].min(weights[1]).min(weights[2]);
            if least >= 0.0 {
                return Some((*i, weights));
            }
            if best.is_none_or(|(most, ..)| least > most) {
                best = Some((least, *i, weights));
            }
        }
        best.map(|(_, i, weights)| (i, weights))
    }
}
