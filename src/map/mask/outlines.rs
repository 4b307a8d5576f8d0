//! The outlines of the buildings in a mask: the edges between their pixels and others.

use super::picture::{Picture, Pixel};
use crate::space::{signed_area, simplify_line};
use glam::{DVec2, IVec2};
use std::collections::BTreeSet;

/// Distance in pixels from a straight wall up to which the corners of pixels lie on it.
const STRAIGHT: f64 = 1.0;

/// A building.
pub(super) struct Rings {
    /// The outline, and then the courtyards, in pixels from the north-west corner of the picture.
    pub rings: Vec<Vec<DVec2>>,
    /// Number of its pixels.
    pub pixels: usize,
}

/// The buildings in a picture: pixels that share an edge are of one.
pub(super) fn outlines(picture: &Picture) -> Vec<Rings> {
    let mut owner = vec![usize::MAX; picture.pixels.len()];
    let index = |p: IVec2| p.y as usize * picture.width + p.x as usize;
    let mut out = Vec::new();
    for start in 0..picture.pixels.len() {
        if picture.pixels[start] != Pixel::Building || owner[start] != usize::MAX {
            continue;
        }
        let number = out.len();
        let mut pixels = vec![IVec2::new((start % picture.width) as i32, (start / picture.width) as i32)];
        owner[start] = number;
        let mut next = 0;
        while let Some(&p) = pixels.get(next) {
            next += 1;
            for step in [IVec2::X, IVec2::Y, IVec2::NEG_X, IVec2::NEG_Y] {
                let q = p + step;
                if picture.at(q.x.into(), q.y.into()) == Pixel::Building && owner[index(q)] == usize::MAX {
                    owner[index(q)] = number;
                    pixels.push(q);
                }
            }
        }
        out.push(Rings { rings: rings(picture, &pixels), pixels: pixels.len() });
    }
    out
}

/// The rings around some pixels that hang together, the outer one first.
fn rings(picture: &Picture, pixels: &[IVec2]) -> Vec<Vec<DVec2>> {
    let is_inside = |p: IVec2| picture.at(p.x.into(), p.y.into()) == Pixel::Building;
    // Edges of pixels, with the building on their right as rows run down.
    let mut edges: BTreeSet<(i32, i32, i32, i32)> = BTreeSet::new();
    for &p in pixels {
        let corners = [p, p + IVec2::X, p + IVec2::ONE, p + IVec2::Y];
        for (k, beside) in [IVec2::NEG_Y, IVec2::X, IVec2::Y, IVec2::NEG_X].into_iter().enumerate() {
            if !is_inside(p + beside) {
                let (a, b) = (corners[k], corners[(k + 1) % 4]);
                edges.insert((a.x, a.y, b.x, b.y));
            }
        }
    }
    let mut out: Vec<Vec<DVec2>> = Vec::new();
    while let Some(first) = edges.pop_first() {
        let start = IVec2::new(first.0, first.1);
        let mut at = IVec2::new(first.2, first.3);
        let mut along = at - start;
        let mut ring = vec![start];
        while at != start {
            ring.push(at);
            // Where two pixels touch at a corner, the ring turns towards its own.
            let turns = [along.perp(), along, -along.perp()];
            let next = turns.into_iter().map(|step| at + step).find(|to| edges.remove(&(at.x, at.y, to.x, to.y)));
            let Some(to) = next else { break };
            along = to - at;
            at = to;
        }
        out.push(simple(&ring));
    }
    let area = |ring: &Vec<DVec2>| signed_area(ring).abs();
    out.sort_by(|a, b| area(b).total_cmp(&area(a)));
    out.retain(|ring| ring.len() > 2);
    out
}

/// A ring of corners of pixels as the walls of a building.
fn simple(ring: &[IVec2]) -> Vec<DVec2> {
    let line: Vec<DVec2> = ring.iter().map(|p| p.as_dvec2()).collect();
    // Both halves begin at corners: the farthest points of each other.
    let farthest = |from: DVec2| {
        let off = |i: &usize| line[*i].distance_squared(from);
        (0..line.len()).max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
    };
    let a = farthest(line[0]);
    let b = farthest(line[a]);
    let turned: Vec<DVec2> = (0..=line.len()).map(|i| line[(a + i) % line.len()]).collect();
    let middle = (b + line.len() - a) % line.len();
    let mut out = simplify_line(&turned[..=middle], STRAIGHT);
    out.extend(simplify_line(&turned[middle..], STRAIGHT).into_iter().skip(1));
    out.pop();
    out
}
