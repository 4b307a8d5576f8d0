//! Ground and streets of a square as one planar triangulation: what is drawn, walked on and asked for.
//!
//! The shapes of streets and junctions are cut at the border of the square. Shapes that overlap no other are taken as they are.
//! Where shapes overlap, all their edges enter the triangulation, and each triangle becomes what the greatest shape over it is
//! made of. The ground fills the rest: between streets it is triangulated around their outlines. Vertices on the border depend on
//! nothing but the shapes and the ground there, so neighbouring squares have the same.

mod arrange;
mod ground;
mod locate;
mod outline;
mod overlaps;
mod pairs;
mod sheet;
mod triangulation;

use self::ground::{Around, around};
use self::locate::{Index, Net};
use self::outline::{all_edges, find_overlaps, separate};
use self::pairs::sides;
use self::sheet::Sheet;
use crate::surface::element::Element;
use crate::surface::finish::{Finish, SurfaceKind};
use crate::surface::section::KERB_HEIGHT;
use crate::terrain::GROUND_STEP;
use glam::{DVec2, DVec3};
use std::sync::OnceLock;

/// A triangulated irregular network: ground and streets over a square.
#[derive(Clone, Debug)]
pub struct Tin {
    /// Edge of the square in metres.
    pub size: i64,
    /// Plan position in metres from the square's south-west corner, and height of the carriageway or the ground. Positions
    /// are on the quantum grid, so they are exact as `f32`.
    pub points: Vec<DVec3>,
    /// Whether the ground at a point lies at the height of a pavement.
    pub raised: Vec<bool>,
    /// Whether pavements come down to the height of the carriageway at a point: dropped kerbs.
    pub dropped: Vec<bool>,
    /// Triangles, counter-clockwise, with what they are made of.
    pub triangles: Vec<([u32; 3], Finish)>,
    /// Whether each square of the ground's grid is triangulated around streets, by rows. The others are two triangles.
    pub near: Vec<bool>,
    /// Number of parts of streets that overlap others and were cut up against them.
    pub overlapping: usize,
    index: OnceLock<Index>,
}

/// The surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Height in metres.
    pub height: f64,
    /// What one stands on.
    pub kind: SurfaceKind,
}

impl Tin {
    /// The network over the square of `size` metres at the local origin. `elements` are all shapes of streets that come into the
    /// square, in an order that every square agrees on; `ground` gives the height at a column and a row of the ground's grid.
    pub fn new(elements: &[Element], size: i64, mut ground: impl FnMut(usize, usize) -> f64) -> Self {
        let mut sheet = Sheet::new(elements, size);
        // Heights are asked for once, however often a triangulation is tried.
        let columns = (size as f64 / GROUND_STEP) as usize + 1;
        let mut known = vec![f64::NAN; columns * columns];
        let mut ground = |column: usize, row: usize| {
            let height = &mut known[row * columns + column];
            if height.is_nan() {
                *height = ground(column, row);
            }
            *height
        };
        let edges = all_edges(&sheet);
        find_overlaps(&mut sheet, &edges);
        let Around { triangles, near } = loop {
            let outline = separate(&mut sheet, &edges);
            match around(&mut sheet, &outline, &mut ground) {
                Ok(around) => break around,
                Err(contradiction) => {
                    let mut found = false;
                    for part in contradiction.0 {
                        found |= !std::mem::replace(&mut sheet.shared[part as usize], true);
                    }
                    if !found {
                        sheet.shared.fill(true);
                    }
                }
            }
        };
        let own = sheet.triangles.iter().filter(|t| !sheet.shared[t.part as usize]);
        let mut all: Vec<([u32; 3], Finish)> = own.map(|t| (t.corners, t.finish)).collect();
        all.extend(triangles);
        let points: Vec<DVec3> =
            (0..sheet.points.len() as u32).map(|v| sheet.plan(v).extend(sheet.points[v as usize].height)).collect();
        let mut raised = vec![false; points.len()];
        for (corners, _) in all.iter().filter(|(_, finish)| finish.is_raised()) {
            corners.iter().for_each(|v| raised[*v as usize] = true);
        }
        let mut dropped = vec![false; points.len()];
        sheet.dropped.iter().for_each(|v| dropped[*v as usize] = true);
        let overlapping = sheet.shared.iter().filter(|shared| **shared).count();
        Self { size, points, raised, dropped, triangles: all, near, overlapping, index: OnceLock::new() }
    }

    /// Size in memory, in bytes, with the index that questions need.
    pub(crate) fn bytes(&self) -> usize {
        let triangle = size_of::<([u32; 3], Finish)>() + 3 * size_of::<u32>();
        self.points.len() * (size_of::<DVec3>() + 2) + self.triangles.len() * triangle
    }

    /// Height of a point as part of a triangle that is made of `finish`, in metres.
    pub fn height_of(&self, point: u32, finish: Finish) -> f64 {
        let raised = finish.is_raised() || (finish == Finish::Ground && self.raised[point as usize]);
        self.points[point as usize].z + if raised && !self.dropped[point as usize] { KERB_HEIGHT } else { 0.0 }
    }

    /// The surface at a local point: ground, street or verge. `None` outside the square.
    pub fn at(&self, p: DVec2) -> Option<SurfacePoint> {
        let edge = DVec2::splat(self.size as f64);
        if !(p.cmpge(DVec2::ZERO) & p.cmple(edge)).all() {
            return None;
        }
        let net = Net { points: &self.points, triangles: &self.triangles };
        let index = self.index.get_or_init(|| Index::new(self.size, net));
        let (triangle, weights) = index.find(net, p)?;
        let (corners, finish) = self.triangles[triangle as usize];
        let height = (0..3).map(|i| self.height_of(corners[i], finish) * weights[i]).sum();
        Some(SurfacePoint { height, kind: finish.kind() })
    }

    /// The edges where two finishes meet at different heights: the point on either end with the lower and the upper height, so
    /// that the upper side lies to the left.
    pub fn steps(&self) -> Vec<Step> {
        let mut out = Vec::new();
        let is_raised = |ends: [u32; 2]| ends.iter().any(|v| self.raised[*v as usize]);
        for same in
            sides(self.points.len(), self.triangles.iter().copied(), is_raised).chunk_by(|a, b| a.ends == b.ends)
        {
            let [one, other] = same else { continue };
            let heights = |finish: Finish| one.ends.map(|v| self.height_of(v, finish));
            let (a, b) = (heights(one.of), heights(other.of));
            if a == b || one.forward == other.forward {
                continue;
            }
            let (upper, low, high, beside) =
                if a[0] + a[1] > b[0] + b[1] { (one, b, a, other.of) } else { (other, a, b, one.of) };
            let turned = |[p, q]: [f64; 2]| if upper.forward { [p, q] } else { [q, p] };
            let [p, q] = upper.ends;
            let ends = if upper.forward { [p, q] } else { [q, p] };
            out.push(Step { ends, low: turned(low), high: turned(high), beside });
        }
        out
    }
}

/// A vertical face along an edge, such as a kerb's. The upper side lies to its left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The points of the edge.
    pub ends: [u32; 2],
    /// Height of the lower side at each end, in metres.
    pub low: [f64; 2],
    /// Height of the upper side at each end, in metres.
    pub high: [f64; 2],
    /// What the lower side is made of.
    pub beside: Finish,
}
