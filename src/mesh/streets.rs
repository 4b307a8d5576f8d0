//! Streets: the triangles of the chunk's surface that are not ground, and the faces of kerbs.

use crate::chunk::Chunk;
use crate::mesh::buffers::{Coat, MeshBuffers};
use crate::network::StreetClass;
use crate::surface::{Finish, Step, Tin};
use crate::texture::Texture;
use glam::{DVec2, DVec3};

const ASPHALT: Coat = Coat::new(Texture::Asphalt, [0.062, 0.064, 0.069]);
const ROAD: Coat = Coat::new(Texture::Chippings, [0.085, 0.085, 0.084]);
pub(super) const PAVEMENT: Coat = Coat::new(Texture::Flags, [0.315, 0.300, 0.275]);
pub(super) const KERBSTONE: Coat = Coat::new(Texture::Stone, [0.420, 0.410, 0.390]);
const MARKING: Coat = Coat::new(Texture::Paint, [0.720, 0.720, 0.690]);
const VERGE: Coat = Coat::new(Texture::Meadow, [0.150, 0.140, 0.100]);

/// What the carriageway of a class is made of.
pub(super) fn carriageway_coat(class: StreetClass) -> Coat {
    if class.is_road() { ROAD } else { ASPHALT }
}

fn coat(finish: Finish) -> Coat {
    match finish {
        Finish::Ground | Finish::Verge => VERGE,
        Finish::Pavement => PAVEMENT,
        Finish::Road => ROAD,
        Finish::Asphalt | Finish::Crossing => ASPHALT,
        Finish::Marking | Finish::Stripe => MARKING,
    }
}

/// The streets of a chunk. Unless `full`, they are without paint and the height of kerbs.
pub(super) fn streets(chunk: &Chunk, full: bool) -> MeshBuffers {
    let tin = &chunk.tin;
    let mut out = MeshBuffers::default();
    let height_of = |v: u32, finish: Finish| if full { tin.height_of(v, finish) } else { tin.points[v as usize].z };
    let seen = |finish: Finish| match finish {
        Finish::Marking | Finish::Stripe | Finish::Crossing if !full => Finish::Asphalt,
        _ => finish,
    };
    let drawn = tin.triangles.iter().filter(|t| t.1 != Finish::Ground);
    let mut triangles: Vec<([u32; 3], Finish)> = drawn.map(|(corners, finish)| (*corners, seen(*finish))).collect();
    triangles.sort_by_key(|t| t.1);
    let steps = if full { tin.steps() } else { Vec::new() };
    out.reserve(2 * tin.points.len() + 4 * steps.len(), triangles.len() + 2 * steps.len());
    let mut normals = vec![DVec3::ZERO; tin.points.len()];
    for (corners, _) in &triangles {
        let normal = normal(tin, *corners);
        if !is_steep(normal) {
            corners.iter().for_each(|v| normals[*v as usize] += normal);
        }
    }
    // Each finish has vertices of its own.
    let mut slots = vec![(u32::MAX, 0); tin.points.len()];
    for (round, same) in triangles.chunk_by(|a, b| a.1 == b.1).enumerate() {
        let finish = same[0].1;
        for (corners, _) in same {
            // Where shapes at different heights overlap, a small face leads from one to the other.
            if is_steep(normal(tin, *corners)) {
                let at = |v: u32| tin.points[v as usize].truncate().extend(height_of(v, finish));
                out.face(&corners.map(at), coat(finish));
                continue;
            }
            let corners = corners.map(|v| {
                let slot = &mut slots[v as usize];
                if slot.0 == u32::MAX || slot.1 != round {
                    let at = tin.points[v as usize].truncate().extend(height_of(v, finish));
                    let normal = normals[v as usize].normalize_or(DVec3::Z);
                    *slot = (out.vertex(at, normal, coat(finish)), round);
                }
                slot.0
            });
            out.indices.extend(corners);
        }
    }
    for step in &steps {
        kerb(&mut out, chunk, step);
    }
    if !full {
        hem(&mut out, tin);
    }
    out.shrink();
    out
}

/// Adds faces along the border of the square between the heights in reduced and in full detail, seen from both sides.
fn hem(out: &mut MeshBuffers, tin: &Tin) {
    let edge = tin.size as f64;
    for (corners, finish) in &tin.triangles {
        for i in 0..3 {
            let ends = [corners[i], corners[(i + 1) % 3]];
            let [a, b] = ends.map(|v| tin.points[v as usize]);
            if !(0..2).any(|k| a[k] == b[k] && (a[k] == 0.0 || a[k] == edge)) {
                continue;
            }
            let [p, q] = ends.map(|v| tin.points[v as usize].truncate().extend(tin.height_of(v, *finish)));
            let ring: Vec<DVec3> = match (p.z > a.z, q.z > b.z) {
                (false, false) => continue,
                (true, false) => vec![a, b, p],
                (false, true) => vec![a, b, q],
                (true, true) => vec![a, b, q, p],
            };
            out.face(&ring, coat(*finish));
            out.face(&ring.into_iter().rev().collect::<Vec<_>>(), coat(*finish));
        }
    }
}

/// The normal of a triangle, as long as twice its area.
fn normal(tin: &Tin, corners: [u32; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|v| tin.points[v as usize]);
    (b - a).cross(c - a)
}

fn is_steep(normal: DVec3) -> bool {
    normal.z < 0.0 || normal.z * normal.z < 0.49 * normal.length_squared()
}

/// Adds the face of a kerb. It looks away from the upper side.
fn kerb(out: &mut MeshBuffers, chunk: &Chunk, step: &Step) {
    let [a, b] = step.ends.map(|v| chunk.tin.points[v as usize].truncate());
    let by: DVec2 = b - a;
    let normal = (-by.perp()).normalize_or_zero().extend(0.0);
    let corners = [(a, step.low[0]), (b, step.low[1]), (b, step.high[1]), (a, step.high[0])];
    let mut ring: Vec<u32> = Vec::with_capacity(4);
    for (i, (p, height)) in corners.iter().enumerate() {
        let (q, other) = corners[(i + 3) % 4];
        if q != *p || other != *height {
            ring.push(out.vertex(p.extend(*height), normal, KERBSTONE));
        }
    }
    for i in 1..ring.len().max(2) - 1 {
        out.triangle([ring[0], ring[i], ring[i + 1]]);
    }
}
