//! Roads from afar: ribbons on the coarse ground.

use super::ground::Land;
use crate::mesh::buffers::MeshBuffers;
use crate::mesh::streets::carriageway_coat;
use crate::region::RoadSection;
use crate::space::Bounds;
use crate::surface::{CrossSection, offset_line};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// Height of ribbons above the ground, in metres: their edges cross the ground's triangles elsewhere than their middle does.
const LIFT: f64 = 1.0;

/// Height of ribbons above water, in metres.
const FREEBOARD: f64 = 2.0;

/// The roads in a tile, from its south-west corner. Each stretch of a road lies in one tile of a level.
pub(super) fn roads(land: &Land, roads: &[Arc<RoadSection>]) -> MeshBuffers {
    let mut out = MeshBuffers::default();
    for road in roads.iter().filter(|road| !road.street.tunnel) {
        let by = road.origin.plan() - land.corner();
        let line: Vec<DVec2> = road.street.line.iter().map(|p| *p + by).collect();
        let half = CrossSection::of(road.street.class).carriageway;
        let edges = [-half, half].map(|half| offset_line(&line, half));
        for (i, pair) in line.windows(2).enumerate() {
            let Some((from, to)) = land.square().clip_segment(pair[0], pair[1]) else { continue };
            let mut before: Option<[u32; 2]> = None;
            for t in cuts(land, [pair[0], pair[1]], [from, to]) {
                let now = edges.each_ref().map(|edge| {
                    let at = edge[i].lerp(edge[i + 1], t);
                    let sample = land.surface(at);
                    let height = (sample.height + LIFT).max(sample.water_level + FREEBOARD);
                    out.vertex(at.extend(height), DVec3::Z, carriageway_coat(road.street.class))
                });
                if let Some([right, left]) = before.replace(now) {
                    out.triangle([right, now[0], now[1]]);
                    out.triangle([right, now[1], left]);
                }
            }
        }
    }
    out
}

/// Where the part of a segment between two parameters begins, crosses an edge of the ground's triangles, and ends, as parameters.
fn cuts(land: &Land, [a, b]: [DVec2; 2], [from, to]: [f64; 2]) -> Vec<f64> {
    let mut out = vec![from, to];
    // Columns, rows, and the diagonals from south-west to north-east.
    for number in [|p: DVec2| p.x, |p: DVec2| p.y, |p: DVec2| p.x - p.y] {
        let [start, end] = [a, b].map(|p| number(p) / land.step());
        let [low, high] = [from, to].map(|t| start + (end - start) * t);
        let (low, high) = (low.min(high), low.max(high));
        let crossed = (low.ceil() as i64..=high.floor() as i64).map(|line| (line as f64 - start) / (end - start));
        out.extend(crossed.filter(|t| *t > from && *t < to));
    }
    out.sort_by(f64::total_cmp);
    out.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    out
}

impl Land {
    /// The square, from its south-west corner.
    fn square(&self) -> Bounds {
        Bounds::new(DVec2::ZERO, DVec2::splat(self.size()))
    }
}
