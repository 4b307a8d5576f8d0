//! The choice of a patch for the end of a street.

use super::breadth_first::BreadthFirst;
use super::depth_first::DepthFirst;
use super::panorama::Panorama;
use super::placer::Placer;
use crate::network::VertexIx;
use crate::patch::STRETCH;
use crate::space::Bounds;
use crate::streets::cell::Draft;
use glam::DVec2;

/// Chooses patches, and keeps its buffers from one vertex to the next.
#[derive(Default)]
pub struct PatchChoice {
    breadth_first: BreadthFirst,
    depth_first: DepthFirst,
}

impl PatchChoice {
    /// Attaches a patch to the vertex `v` at `at`, breadth-first if possible, else depth-first; returns whether one fits.
    pub fn attach(
        &mut self,
        draft: &mut Draft<'_>,
        placer: &mut Placer<'_>,
        v: VertexIx,
        at: DVec2,
        direction: DVec2,
    ) -> bool {
        if placer.largest == 0.0 {
            return false;
        }
        let reach = 2.0 * placer.largest * (1.0 + STRETCH) + draft.rules.growth.gap;
        let around = Panorama::of(draft, at, direction, reach);
        if around.ahead() < draft.rules.growth.min_piece {
            return false;
        }
        draft.canvas.gather_loose_ends(Bounds::of([at]), reach, &mut draft.trial.near);
        self.breadth_first.attach(draft, placer, v, at, &around)
            || self.depth_first.attach(draft, placer, (v, at, direction), &around)
    }
}
