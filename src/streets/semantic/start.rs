//! Cell initialization (Teng 2017, section 3.2): an initial patch or a plain stub at every port.

use super::Work;
use super::canvas::Node;
use super::place::Placement;
use crate::patch::{STRETCH, tag};
use crate::seam::STUB_LENGTH;
use crate::streets::MadeBy;
use glam::DVec2;

impl Work<'_> {
    /// Puts a stub at every port, so that each is met whatever comes later.
    pub(super) fn lay_stubs(&mut self) {
        for (i, port) in self.brief.ports.iter().enumerate() {
            let node = Node { open: true, target: 2, ..Node::default() };
            let end = self.canvas.add_vertex(port.at + port.inward * STUB_LENGTH, node);
            self.canvas.add_stub(i as u32, end);
        }
    }

    /// Puts initial patches in the place of stubs where they fit. The ends become the first candidate vertices.
    pub(super) fn start(&mut self) {
        self.start_with_patterns();
        let ports = self.brief.ports.len() as u32;
        let patches = self.brief.patches;
        let initial: Vec<usize> =
            patches.tagged(tag::INITIAL).iter().copied().filter(|p| patches.facts(*p).main.is_some()).collect();
        for i in 0..ports {
            // The stub is there, unless a pinned patch took its place.
            let end = ports + i;
            if !self.has_stub(i as usize) {
                continue;
            }
            // One port in three begins with an initial patch; more would leave no room between them.
            if initial.is_empty() || !self.rng.chance(0.34) || !self.start_with_patch(i as usize, &initial) {
                self.queue.push_back(end);
            }
        }
        self.canvas.stamp_stubs(self.brief.ports);
    }

    /// The vertex at which an initial patch leaves its main street, and the direction into the patch; `None` for
    /// patches that are not laid on a main street or leave it more than once.
    fn initial_root(&self, patch: usize) -> Option<(usize, DVec2)> {
        let main = self.brief.patches.facts(patch).main.as_ref()?;
        let patch = &self.brief.patches.patches[patch];
        let &[root] = main.attachments.as_slice() else { return None };
        let along = patch.vertices[main.to] - patch.vertices[main.from];
        (patch.edges_at(root).filter(|e| !patch.edges[*e].main).count() == 1)
            .then(|| (root, along.perp().normalize_or_zero()))
    }

    /// Tries initial patches at port `port` in the place of its stub.
    fn start_with_patch(&mut self, port: usize, initial: &[usize]) -> bool {
        let (at, inward) = (self.brief.ports[port].at, self.brief.ports[port].inward);
        let weights: Vec<f64> = initial.iter().map(|p| self.weight(*p)).collect();
        let Some(pick) = self.rng.weighted(&weights).map(|i| initial[i]) else { return false };
        let Some((root, side)) = self.initial_root(pick) else { return self.start_with_two(port, pick) };
        let radius = self.brief.patches.patches[pick].radius;
        let root_at = self.brief.patches.patches[pick].vertices[root];
        let Some(stub) = self.canvas.graph.edges_at(port as u32).first().copied() else { return false };
        let Some(removed) = self.canvas.graph.remove_edge(stub) else { return false };
        self.gather(at, 2.0 * radius + self.limits.gap + self.limits.min_piece);
        let first_mirrored = self.rng.chance(0.5);
        for mirrored in [first_mirrored, !first_mirrored] {
            let placement = Placement::new((pick, root, root_at), side, mirrored, at, inward);
            if self.roughly_fits(&placement, at, None)
                && self.propose_patch(&placement, &[(root, port as u32)])
                && self.build_if_fits(&self.limits.clone(), MadeBy::Patch(pick as u32))
            {
                self.after_patch(pick);
                return true;
            }
        }
        self.canvas.add_stub(removed.a, removed.b);
        false
    }

    /// Tries an initial patch that leaves its main street twice at port `port` and the next one along the street, drawn out
    /// or together a little to meet both.
    fn start_with_two(&mut self, port: usize, pick: usize) -> bool {
        let patches = self.brief.patches;
        let patch = patches.patches[pick].clone();
        let Some(&[a, b]) = patches.facts(pick).main.as_ref().map(|m| m.attachments.as_slice()) else { return false };
        let from = patch.vertices[b] - patch.vertices[a];
        let here = self.brief.ports[port];
        for (other, there) in self.brief.ports.iter().enumerate().filter(|(i, _)| *i != port) {
            let to = there.at - here.at;
            let scale = to.length() / from.length();
            let in_line = there.inward.dot(here.inward) > 0.9 && to.dot(here.inward).abs() < 0.3 * to.length();
            if !in_line || !(0.8..=1.25).contains(&scale) || !self.has_stub(other) {
                continue;
            }
            // The attachment lies to the left of the line from `a` to `b`, as drawn; else it is mirrored.
            let inward = to.perp().dot(here.inward).signum();
            let across = inward * scale.clamp(1.0 - STRETCH, 1.0 + STRETCH);
            let (one, two) = ((a, port), (b, other));
            let placement = Placement::drawn_out((pick, a, patch.vertices[a]), from, here.at, to, across);
            if self.lay_at_ports(placement, &patch, &[one, two]) {
                return true;
            }
        }
        false
    }
}
