//! Pinned patches: they stand where the user wants them, whatever grows around them, or are left out whole.

use super::Work;
use super::place::Placement;
use super::proposal::{Join, Limits, Proposal};
use crate::network::VertexIx;
use crate::patch::STREET_FLOOR;
use crate::space::{math, point_in_polygon};
use crate::streets::{CellBrief, MadeBy, PinnedPatch};
use glam::DVec2;

/// A root of a patch this near to a port stands in it, in metres.
const AT_PORT: f64 = 0.1;

/// A pinned patch that is in the graph.
#[derive(Clone, Copy, Debug)]
pub(super) struct Laid {
    /// Index into [`CellBrief::pinned`].
    pub index: usize,
    /// One of its vertices; its streets hang together.
    vertex: VertexIx,
}

/// The placement of a pinned patch, as large as it is drawn.
fn placement(pinned: &PinnedPatch) -> Placement {
    let to = math::direction(pinned.turned);
    Placement::new((pinned.patch, usize::MAX, DVec2::ZERO), DVec2::X, pinned.mirrored, pinned.at, to)
}

impl Work<'_> {
    /// Lays the pinned patches in their order, those of `left_out` (indices) excepted; what does not fit joins `left_out`.
    pub(super) fn lay_pinned(&mut self, left_out: &mut Vec<usize>) {
        let limits = self.as_near_as_can_be();
        for (index, pinned) in self.brief.pinned.iter().enumerate() {
            if !left_out.contains(&index) && !self.lay(index, pinned, &limits) {
                left_out.push(index);
            }
        }
        left_out.sort_unstable();
    }

    /// As near as streets may be at all: the user's wish outweighs the style.
    fn as_near_as_can_be(&self) -> Limits {
        let (junction_cosine, bend_cosine) = (math::cos(0.7), math::cos(1.3));
        Limits { gap: STREET_FLOOR, wall_gap: 0.0, junction_cosine, bend_cosine, ..self.relaxed }
    }

    /// Lays one; false, and nothing changes, where it breaks a rule.
    pub(super) fn lay(&mut self, index: usize, pinned: &PinnedPatch, limits: &Limits) -> bool {
        if !self.propose_pinned(pinned) {
            return false;
        }
        let mut stubs = Vec::new();
        for join in &self.proposal.joins {
            if let Join::At(port) = *join {
                let stub = self.canvas.graph.edges_at(port).first().copied();
                stubs.extend(stub.and_then(|s| self.canvas.graph.remove_edge(s)));
            }
        }
        let radius = self.brief.patches.patches[pinned.patch].radius;
        self.gather(pinned.at, radius + limits.gap.max(limits.wall_gap).max(30.0));
        if !self.build_if_fits(limits, MadeBy::Patch(pinned.patch as u32)) {
            for stub in stubs {
                self.canvas.add_stub(stub.a, stub.b);
            }
            return false;
        }
        self.count_use(pinned.patch);
        for (i, &v) in self.built.iter().enumerate() {
            self.canvas.nodes[v as usize].pinned = true;
            if self.proposal.joins[i] == Join::Free(true) {
                self.canvas.nodes[v as usize].target = 2;
                self.queue.push_back(v);
            }
        }
        if let Some(&vertex) = self.built.first() {
            self.laid.push(Laid { index, vertex });
        }
        true
    }

    /// Makes a pinned patch the proposal: whole, its roots in the ports that they fall on. False for one that is not
    /// inside the cell or breaks the rules in itself.
    fn propose_pinned(&mut self, pinned: &PinnedPatch) -> bool {
        let known = self.brief.patches.patches.get(pinned.patch);
        let Some(patch) = known.filter(|_| pinned.at.is_finite() && pinned.turned.is_finite()) else { return false };
        let facts = self.brief.patches.facts(pinned.patch);
        let placement = placement(pinned);
        let mut slots = vec![usize::MAX; patch.vertices.len()];
        let mut p = Proposal::default();
        let roots = facts.main.as_ref().map_or(&[][..], |m| m.attachments.as_slice());
        let mut fits = facts.shape.sound;
        for e in patch.edges.iter().filter(|e| !e.main) {
            for v in [e.a, e.b] {
                if slots[v] != usize::MAX {
                    continue;
                }
                slots[v] = p.points.len();
                let at = placement.map(patch.vertices[v]);
                let is_root = roots.contains(&v);
                let port = self.brief.ports.iter().position(|x| is_root && x.at.distance(at) < AT_PORT);
                if let Some(port) = port {
                    let next = placement.map(patch.vertices[e.other(v)]);
                    let inward = self.brief.ports[port].inward;
                    fits &= (next - at).normalize_or_zero().dot(inward) > 0.8;
                    p.push(self.brief.ports[port].at, Join::At(port as VertexIx));
                } else {
                    fits &= point_in_polygon(at, self.brief.border);
                    p.push(at, Join::Free(is_root || patch.is_connectable(v)));
                }
            }
            p.edges.push((slots[e.a], slots[e.b]));
        }
        self.proposal = p;
        fits
    }

    /// Pinned patches that no way leads to from a port.
    pub(super) fn cut_off(&self) -> Vec<usize> {
        if self.laid.is_empty() {
            return Vec::new();
        }
        let components = self.canvas.graph.components();
        let reached: Vec<Option<u32>> = (0..self.brief.ports.len()).map(|port| components[port]).collect();
        let cut = |l: &&Laid| !reached.contains(&components[l.vertex as usize]);
        self.laid.iter().filter(cut).map(|l| l.index).collect()
    }

    /// Connects what hangs together with a pinned patch but with no port.
    pub(super) fn connect_cut_off(&mut self) {
        for _ in 0..self.laid.len() {
            let components = self.canvas.graph.components();
            let reached: Vec<Option<u32>> = (0..self.brief.ports.len()).map(|port| components[port]).collect();
            let cut = self.laid.iter().map(|l| components[l.vertex as usize]).find(|c| !reached.contains(c));
            let Some(cut) = cut else { return };
            let near = [self.relaxed, self.as_near_as_can_be()];
            if !near.into_iter().any(|limits| self.connect_part(&components, cut, limits)) {
                return;
            }
        }
    }
}

/// A place where the patch of index `patch` can stand: nothing of what the border, the ports and the patches that are
/// pinned already ask for keeps it from being laid there, and there is room around it for streets to reach it. The same
/// arguments give the same place; `None` where none of some hundred tries fits. A patch of a main street stands at ports,
/// any other along the field.
pub fn find_place(brief: &CellBrief<'_>, patch: usize) -> Option<PinnedPatch> {
    let drawn = brief.patches.patches.get(patch)?;
    let mut work = Work::new(brief);
    work.lay_stubs();
    work.lay_pinned(&mut Vec::new());
    let mut rng = brief.seed.stream("place of a patch", &[brief.id.0, patch as u64, brief.pinned.len() as u64]);
    let mut tries: Vec<PinnedPatch> = Vec::new();
    if let Some(main) = brief.patches.facts(patch).main.as_ref() {
        let along = drawn.vertices[main.to] - drawn.vertices[main.from];
        for port in brief.ports {
            for root in &main.attachments {
                for mirrored in [false, true] {
                    let at = drawn.vertices[*root];
                    let side = along.perp().normalize_or_zero();
                    let laid = Placement::new((patch, *root, at), side, mirrored, port.at, port.inward);
                    let turned = math::angle_of(laid.map(DVec2::X) - laid.map(DVec2::ZERO));
                    tries.push(PinnedPatch { patch, at: laid.map(DVec2::ZERO), turned, mirrored });
                }
            }
        }
        for i in (1..tries.len()).rev() {
            tries.swap(i, rng.index(i + 1));
        }
    } else {
        let bounds = crate::space::Bounds::of(brief.border.iter().copied());
        for _ in 0..TRIES {
            let at = bounds.min + bounds.size() * DVec2::new(rng.unit(), rng.unit());
            let quarter = rng.index(4) as f64 * std::f64::consts::FRAC_PI_2;
            let at = crate::space::quantize(at);
            let turned = brief.field.angle(at) + quarter;
            tries.push(PinnedPatch { patch, at, turned, mirrored: rng.chance(0.5) });
        }
    }
    // First with the style's distances, so that streets go around it as around any other patch.
    [work.limits, work.relaxed]
        .into_iter()
        .find_map(|limits| tries.iter().find(|t| work.lay(brief.pinned.len(), t, &limits)).copied())
}

/// Places that are tried for a patch that stands free.
const TRIES: usize = 400;

#[cfg(test)]
mod tests {
    use super::super::sample::{Kit, Sample};
    use super::super::tests::{defects, fill};
    use super::*;
    use crate::space::{Seed, distance_to_segment, segments};
    use crate::streets::CellStreets;

    /// Whether every street of a pinned patch is there.
    fn stands(cell: &Sample<'_>, pinned: &PinnedPatch, out: &CellStreets) -> bool {
        let patch = &cell.kit.patches.patches[pinned.patch];
        let placement = placement(pinned);
        patch.edges.iter().filter(|e| !e.main).all(|e| {
            let (a, b) = (placement.map(patch.vertices[e.a]), placement.map(patch.vertices[e.b]));
            (0..=8).all(|k| {
                let p = a.lerp(b, f64::from(k) / 8.0);
                let on = |line: &[DVec2]| segments(line).any(|(c, d)| distance_to_segment(p, c, d) < 0.05);
                out.streets.iter().any(|s| on(&s.street.line))
            })
        })
    }

    #[test]
    fn pinned_patches_stand_whole_or_are_reported() {
        let kits = Kit::all();
        let (mut stood, mut left_out) = (0, 0);
        for seed in 0..120 {
            let mut cell = Sample::new(seed, &kits);
            let mut s = Seed(seed).stream("pins", &[]);
            let bounds = crate::space::Bounds::of(cell.border.iter().copied());
            let off = 0.6 * bounds.size();
            for _ in 0..1 + s.index(3) {
                cell.pinned.push(PinnedPatch {
                    patch: s.index(cell.kit.patches.patches.len()),
                    at: bounds.centre() + off * DVec2::new(s.unit() - 0.5, s.unit() - 0.5),
                    turned: s.range(-4.0, 4.0),
                    mirrored: s.chance(0.5),
                });
            }
            let out = fill(&cell);
            assert_eq!(defects(&cell, &out), Vec::<String>::new(), "cell {seed}");
            assert!(out.unfit.is_sorted() && out.unfit.windows(2).all(|w| w[0] < w[1]));
            for (i, pinned) in cell.pinned.iter().enumerate() {
                let unfit = out.unfit.contains(&i);
                assert!(unfit || stands(&cell, pinned, &out), "cell {seed}: a part of {pinned:?} is missing");
                (stood, left_out) = (stood + i32::from(!unfit), left_out + i32::from(unfit));
            }
            if out.unfit.len() == cell.pinned.len() {
                // What does not fit leaves no trace.
                let mut without = Sample::new(seed, &kits);
                without.pinned.clear();
                assert_eq!(fill(&without).streets, out.streets, "cell {seed}");
            }
        }
        assert!(stood > 20 && left_out > 20, "{stood} stood, {left_out} were left out");
    }

    #[test]
    fn a_place_that_was_found_is_one() {
        let kits = Kit::all();
        let (mut found, mut stood) = (0, 0);
        for seed in 200..260 {
            let mut cell = Sample::new(seed, &kits);
            for k in 0..2 {
                let patch = (seed as usize * 7 + k * 5) % cell.kit.patches.patches.len();
                let place = find_place(&cell.brief(), patch);
                assert_eq!(place, find_place(&cell.brief(), patch));
                cell.pinned.extend(place);
            }
            let out = fill(&cell);
            assert_eq!(defects(&cell, &out), Vec::<String>::new(), "cell {seed}");
            found += cell.pinned.len();
            stood += cell.pinned.len() - out.unfit.len();
            assert!(cell.pinned.iter().enumerate().all(|(i, p)| out.unfit.contains(&i) || stands(&cell, p, &out)));
        }
        assert!(found > 40 && stood * 50 >= found * 49, "{stood} of {found} places");
    }

    #[test]
    fn what_cannot_be_is_unfit() {
        let kits = Kit::all();
        let mut cell = Sample::new(11, &kits);
        let at = crate::space::centroid(&cell.border);
        let pin = |patch, at, turned| PinnedPatch { patch, at, turned, mirrored: false };
        cell.pinned = vec![
            pin(10_000, at, 0.0),
            pin(0, at * f64::NAN, 0.0),
            pin(0, at, f64::INFINITY),
            pin(0, at + 5000.0, 0.0),
            pin(0, cell.border[0], 0.0),
        ];
        assert_eq!(fill(&cell).unfit, [0, 1, 2, 3, 4]);
        cell.ports.clear();
        cell.pinned = vec![pin(0, at, 0.0)];
        assert_eq!(fill(&cell), CellStreets { unfit: vec![0], ..CellStreets::default() });
    }
}
