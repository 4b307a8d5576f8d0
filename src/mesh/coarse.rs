//! The ground in reduced detail: large squares where no street is near.

use crate::surface::{Finish, Tin};
use crate::terrain::GROUND_STEP;
use glam::USizeVec2;

/// Edge of a large square, in squares of the ground.
const LARGE: usize = 4;

/// Triangles of the ground, as indices of the network's points. Its border is that of the whole network.
pub(super) fn triangles(tin: &Tin) -> Vec<[u32; 3]> {
    let cells = (tin.size as f64 / GROUND_STEP) as usize;
    let blocks = cells / LARGE;
    let is_large = |block: USizeVec2| {
        let squares = |n: usize| n * LARGE..(n + 1) * LARGE;
        squares(block.y).all(|row| squares(block.x).all(|column| !tin.near[row * cells + column]))
    };
    let large: Vec<bool> = (0..blocks * blocks).map(|i| is_large(USizeVec2::new(i % blocks, i / blocks))).collect();
    let in_large = |square: USizeVec2| {
        let block = square / LARGE;
        block.max_element() < blocks && large[block.y * blocks + block.x]
    };
    let mut vertices = vec![u32::MAX; (cells + 1) * (cells + 1)];
    for (i, p) in tin.points.iter().enumerate() {
        let at = p.truncate() / GROUND_STEP;
        if at == at.floor() {
            let at = at.as_usizevec2();
            vertices[at.y * (cells + 1) + at.x] = i as u32;
        }
    }
    let mut out: Vec<[u32; 3]> = Vec::new();
    for (corners, _) in tin.triangles.iter().filter(|t| t.1 == Finish::Ground) {
        let middle = corners.map(|v| tin.points[v as usize].truncate()).iter().sum::<glam::DVec2>() / 3.0;
        let square = (middle / GROUND_STEP).as_usizevec2();
        if !in_large(square) {
            out.push(*corners);
        }
    }
    for block in (0..blocks * blocks).filter(|i| large[*i]).map(|i| USizeVec2::new(i % blocks, i / blocks)) {
        let corner = block * LARGE;
        let at = |column: usize, row: usize| vertices[(corner.y + row) * (cells + 1) + corner.x + column];
        // Beside squares that are not large, and on the border, all vertices of the side stay.
        let whole = |x: isize, y: isize| {
            let (x, y) = (block.x as isize + x, block.y as isize + y);
            let inside = x >= 0 && y >= 0 && x < blocks as isize && y < blocks as isize;
            !inside || !large[y as usize * blocks + x as usize]
        };
        let side = |fine: bool, vertex: &dyn Fn(usize) -> u32| -> Vec<u32> {
            (0..LARGE).step_by(if fine { 1 } else { LARGE }).map(vertex).collect()
        };
        let ring = [
            side(whole(0, -1), &|k| at(k, 0)),
            side(whole(1, 0), &|k| at(LARGE, k)),
            side(whole(0, 1), &|k| at(LARGE - k, LARGE)),
            side(whole(-1, 0), &|k| at(0, LARGE - k)),
        ]
        .concat();
        let middle = at(LARGE / 2, LARGE / 2);
        out.extend((0..ring.len()).map(|i| [middle, ring[i], ring[(i + 1) % ring.len()]]));
    }
    out
}
