//! Roofs over footprints: flat, gabled, hipped and mansard. Each roof closes the walls below it edge to edge.

use crate::mesh::buffers::{Coat, MeshBuffers};
use crate::space::{cross, ears, left_normal, stable_hash};
use crate::texture::Texture;
use glam::{DVec2, DVec3};

/// Buildings with this many storeys or more have no pitched roof.
const FLAT_FROM: u32 = 4;

/// Shape of a roof. `start` is the index of the corner of the footprint at which the pattern begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Roof {
    /// Level.
    Flat,
    /// Over four corners: a ridge between the middles of edges `start + 1` and `start + 3`, shortened at both ends by a hip.
    Ridge { start: usize, hip: bool },
    /// Over an L with its inner corner at `start`: a ridge from the middle of each end wall to the knee.
    Knee { start: usize },
    /// Steep sides up to a level top.
    Mansard,
}

/// The roof that suits a footprint. `frontage` is the edge of the lot along the street, as two points.
pub(super) fn roof(plan: &[DVec2], storeys: u32, frontage: Option<&[DVec2]>, id: u64) -> Roof {
    let pick = |salt: u64, n: u64| stable_hash(&[id, salt]) % n;
    if storeys >= FLAT_FROM {
        let mansard = storeys <= 7 && pick(11, 3) == 0 && inset(plan, MANSARD_INSET).is_some();
        return if mansard { Roof::Mansard } else { Roof::Flat };
    }
    let n = plan.len();
    let edge = |i: usize| plan[(i + 1) % n] - plan[i % n];
    let turn = |i: usize| cross(edge(i + n - 1).normalize_or_zero(), edge(i).normalize_or_zero());
    match n {
        4 if (0..4).all(|i| turn(i) > 0.7) => {
            let (even, odd) = (edge(0).length() + edge(2).length(), edge(1).length() + edge(3).length());
            if even.min(odd) > 28.0 {
                return Roof::Flat;
            }
            // The ridge runs along the longer edges, or along the street in a row of houses.
            let row = frontage.and_then(|f| {
                let (street, length) = ((f[1] - f[0]).normalize_or_zero(), f[0].distance(f[1]));
                let across = (0..4).map(|i| plan[i].dot(street));
                let (low, high) = across.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
                let along = |i: usize| edge(i).normalize_or_zero().dot(street).abs();
                (high - low > 0.93 * length).then(|| usize::from(along(0) < along(1)))
            });
            let start = row.unwrap_or(usize::from(even < odd));
            Roof::Ridge { start, hip: row.is_none() && pick(12, 3) == 0 }
        }
        6 => {
            let mut inner = (0..6).filter(|i| turn(*i) < -0.7);
            match (inner.next(), inner.next()) {
                (Some(start), None) if (0..6).filter(|i| turn(*i) > 0.7).count() == 5 => Roof::Knee { start },
                _ => Roof::Flat,
            }
        }
        _ => Roof::Flat,
    }
}

/// Distance by which the top of a mansard is drawn in from its eaves, in metres.
const MANSARD_INSET: f64 = 1.3;

/// Height of the top of a mansard above its eaves, in metres.
const MANSARD_HEIGHT: f64 = 2.6;

impl Roof {
    /// Adds the roof over walls that end at the height `eaves`, in metres.
    pub fn build(self, out: &mut MeshBuffers, plan: &[DVec2], eaves: f64, tiles: Coat, wall: Coat) {
        let at = |i: usize| plan[i % plan.len()].extend(eaves);
        let middle = |i: usize| (plan[i % plan.len()] + plan[(i + 1) % plan.len()]) / 2.0;
        match self {
            Self::Flat => cap(out, plan, eaves, true, tiles),
            Self::Ridge { start: s, hip } => {
                let (a, b) = (middle(s + 1), middle(s + 3));
                let span = plan[(s + 1) % 4].distance(plan[(s + 2) % 4]).min(plan[s % 4].distance(plan[(s + 3) % 4]));
                let up = (span * 0.36).min(4.5);
                let pull = if hip { (span * 0.45).min(a.distance(b) * 0.4) } else { 0.0 };
                let along = (b - a).normalize_or_zero() * pull;
                let (a, b) = ((a + along).extend(eaves + up), (b - along).extend(eaves + up));
                let ends = if hip { tiles } else { wall };
                quadrangle(out, [at(s), at(s + 1), a, b], tiles);
                quadrangle(out, [at(s + 2), at(s + 3), b, a], tiles);
                out.face(&[at(s + 1), at(s + 2), a], ends);
                out.face(&[at(s + 3), at(s), b], ends);
            }
            Self::Knee { start: s } => {
                let (a, b) = (middle(s + 1), middle(s + 4));
                let widths = [(s + 1, s + 2), (s + 4, s + 5)].map(|(i, j)| plan[i % 6].distance(plan[j % 6]));
                let up = eaves + (widths[0].min(widths[1]) * 0.36).min(4.5);
                let knee = ((plan[s % 6] + plan[(s + 3) % 6]) / 2.0).extend(up);
                let (a, b) = (a.extend(up), b.extend(up));
                quadrangle(out, [at(s + 2), at(s + 3), knee, a], tiles);
                quadrangle(out, [at(s), at(s + 1), a, knee], tiles);
                quadrangle(out, [at(s + 3), at(s + 4), b, knee], tiles);
                quadrangle(out, [at(s + 5), at(s), knee, b], tiles);
                out.face(&[at(s + 1), at(s + 2), a], wall);
                out.face(&[at(s + 4), at(s + 5), b], wall);
            }
            Self::Mansard => {
                let Some(top) = inset(plan, MANSARD_INSET) else { return cap(out, plan, eaves, true, tiles) };
                let up = |i: usize| top[i % top.len()].extend(eaves + MANSARD_HEIGHT);
                for i in 0..plan.len() {
                    quadrangle(out, [at(i), at(i + 1), up(i + 1), up(i)], tiles);
                }
                let cover = Coat { texture: Texture::Felt, ..tiles.tinted([0.2; 3], 0.5) };
                cap(out, &top, eaves + MANSARD_HEIGHT, true, cover);
            }
        }
    }
}

/// Adds a quadrangle that need not be flat, as two triangles.
fn quadrangle(out: &mut MeshBuffers, [a, b, c, d]: [DVec3; 4], coat: Coat) {
    out.face(&[a, b, c], coat);
    out.face(&[a, c, d], coat);
}

/// Adds a level face over a simple polygon, seen from above or from below.
pub(super) fn cap(out: &mut MeshBuffers, plan: &[DVec2], height: f64, above: bool, coat: Coat) {
    let normal = if above { DVec3::Z } else { DVec3::NEG_Z };
    let first = out.positions.len() as u32;
    plan.iter().for_each(|p| {
        out.vertex(p.extend(height), normal, coat);
    });
    for [a, b, c] in ears(plan) {
        out.triangle(if above { [a, b, c] } else { [a, c, b] }.map(|i| first + i as u32));
    }
}

/// A polygon with each edge moved inwards by `by` metres; `None` if an edge would turn around or nearly vanish.
fn inset(plan: &[DVec2], by: f64) -> Option<Vec<DVec2>> {
    let n = plan.len();
    let edge = |i: usize| (plan[(i + 1) % n] - plan[i % n]).normalize_or_zero();
    let moved: Vec<DVec2> = (0..n)
        .map(|i| {
            let (before, after) = (edge(i + n - 1), edge(i));
            plan[i] + (left_normal(before) + left_normal(after)) * (by / (1.0 + before.dot(after)).max(0.2))
        })
        .collect();
    (0..n).all(|i| (moved[(i + 1) % n] - moved[i]).dot(edge(i)) > 1.0).then_some(moved)
}
