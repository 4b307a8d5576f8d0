//! Parametric growth, where no patch fits (Teng 2017, Fig. 3).

use super::Work;
use super::proposal::Join;
use crate::network::VertexIx;
use crate::space::{Bounds, math::rotate};
use crate::streets::MadeBy;
use glam::DVec2;

impl Work<'_> {
    /// Grows a street from `v`, and makes its end a candidate. The vertex itself stays one while it has fewer streets
    /// than it should.
    pub(super) fn grow(&mut self, v: VertexIx, at: DVec2, direction: DVec2) {
        let local = &self.brief.style.local;
        let (degree, snap) = (local.degree, local.snap_radius);
        let length = local.length + self.rng.signed() * local.deviation;
        let off = self.rng.signed() * local.angle_deviation_deg.to_radians();
        // A shorter street or one that turns aside, where the first choice does not fit.
        let bend = self.most_turn;
        let far = length.max(local.min_length) + snap.max(self.limits.gap);
        let beside = far * (bend + off.abs()).min(1.0) + self.limits.reach();
        self.canvas.gather(Bounds::of([at, at + direction * far]), beside, &mut self.near);
        let tries = [(1.0, off), (0.65, off), (1.0, 0.5 * bend), (1.0, -0.5 * bend), (0.65, bend), (0.65, -bend)];
        for (share, angle) in tries {
            let to = at + rotate(direction, angle) * (length * share).max(local.min_length);
            let mut line = std::mem::take(&mut self.line);
            line.clear();
            line.extend([at, to]);
            let join = self.settle(&mut line, v, &self.limits);
            if let Some(join) = join {
                self.proposal.line(&line, Join::At(v), join);
            }
            self.line = line;
            let Some(join) = join.filter(|_| self.build_if_fits(&self.limits.clone(), MadeBy::Growth)) else {
                continue;
            };
            if join == Join::Free(true) {
                let target = degree.0 as usize + self.rng.index((degree.1.saturating_sub(degree.0) + 1) as usize);
                self.canvas.nodes[self.built[1] as usize].target = target;
                self.queue.push_back(self.built[1]);
            }
            self.cross_over();
            if self.canvas.graph.degree(v) < self.canvas.nodes[v as usize].target {
                self.queue.push_back(v);
            }
            return;
        }
    }
}
