//! Pinned patches: each stands as a whole where it is pinned, whatever grows around it, or is left out.

use super::placement::Placement;
use super::placer::Placer;
use crate::network::VertexIx;
use crate::patch::PatchDatabase;
use crate::space::{math, point_in_polygon};
use crate::streets::cell::{Draft, Join, Limits, Maker, Proposal, RemovedStubs};
use crate::streets::filler::LeftOut;
use glam::DVec2;

/// Distance within which the root of a patch stands in a port, in metres.
const AT_PORT: f64 = 0.1;

/// A patch that stands in a certain place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinnedPatch {
    /// Index into [`PatchDatabase::patches`].
    pub patch: usize,
    /// Where the centre of its bounding circle lies, local to the town, in metres.
    pub at: DVec2,
    /// Angle by which it is turned against its drawing, in radians, counter-clockwise.
    pub turned: f64,
    /// Whether it is mirrored at its x axis, before it is turned.
    pub mirrored: bool,
    /// Index into the pieces that the user pinned, if the patch is one of them.
    pub piece: Option<usize>,
}

/// A connected part of a pinned patch that stands in the graph. A patch falls apart where only its main street connects it.
#[derive(Clone, Copy, Debug)]
pub struct StandingPart {
    /// Index of the patch into the list of pinned patches.
    pub index: usize,
    /// One vertex of the part.
    pub vertex: VertexIx,
}

/// The pieces that were left out, in order: those of the patches `unfit`, indices into `pinned`, and those that are `unknown` for a
/// reason of the filler's.
pub fn pieces_left_out(
    pinned: &[PinnedPatch],
    unfit: &[usize],
    unknown: &[usize],
    why_unknown: &'static str,
) -> Vec<LeftOut> {
    let reason = "does not fit among main streets, their ports and patches before it";
    let unfit = unfit.iter().filter_map(|i| pinned[*i].piece).map(|piece| LeftOut { piece, reason });
    let unknown = unknown.iter().map(|piece| LeftOut { piece: *piece, reason: why_unknown });
    let mut out: Vec<LeftOut> = unfit.chain(unknown).collect();
    out.sort_by_key(|l| l.piece);
    out
}

/// The placement of a pinned patch, in the size of its drawing.
fn placement(pinned: &PinnedPatch) -> Placement {
    let to = math::direction(pinned.turned);
    Placement::new((pinned.patch, usize::MAX, DVec2::ZERO), DVec2::X, pinned.mirrored, pinned.at, to)
}

/// Lays the pinned patches in order and returns the parts of those that stand. `left_out` has the indices of patches that are not tried; the
/// patches that do not fit are added to it.
pub fn lay_pinned(
    draft: &mut Draft<'_>,
    placer: &mut Placer<'_>,
    pinned: &[PinnedPatch],
    left_out: &mut Vec<usize>,
) -> Vec<StandingPart> {
    let limits = draft.rules.closest;
    let mut standing = Vec::new();
    for (index, pinned) in pinned.iter().enumerate() {
        if left_out.contains(&index) {
            continue;
        }
        match lay(draft, placer, pinned, &limits) {
            Some(parts) => standing.extend(parts.into_iter().map(|vertex| StandingPart { index, vertex })),
            None => left_out.push(index),
        }
    }
    left_out.sort_unstable();
    standing
}

/// Lays a pinned patch and returns a vertex of each of its connected parts. If the patch breaks a rule, nothing changes and the
/// result is `None`.
pub fn lay(
    draft: &mut Draft<'_>,
    placer: &mut Placer<'_>,
    pinned: &PinnedPatch,
    limits: &Limits,
) -> Option<Vec<VertexIx>> {
    if !propose_pinned(draft, placer.patches, pinned) {
        return None;
    }
    let (mut stubs, ports) = (RemovedStubs::default(), draft.brief.ports.len());
    for join in &draft.trial.proposal.joins {
        if let Join::At(port) = *join
            && !stubs.remove(&mut draft.canvas, ports, port as usize)
        {
            // Another piece stands there.
            stubs.restore(&mut draft.canvas);
            return None;
        }
    }
    let radius = placer.patches.patches[pinned.patch].radius;
    draft.gather(pinned.at, radius + limits.gap.max(limits.wall_gap).max(30.0));
    if !draft.build_if_fits(limits, Maker::Piece(pinned.patch as u32)) {
        stubs.restore(&mut draft.canvas);
        return None;
    }
    placer.count_use(draft, pinned.patch);
    for (i, &v) in draft.trial.built.iter().enumerate() {
        draft.canvas.nodes[v as usize].pinned = true;
        if draft.trial.proposal.joins[i] == Join::Free(true) {
            draft.canvas.nodes[v as usize].wanted_degree = 2;
            draft.candidates.push_back(v);
        }
    }
    let parts = draft.trial.proposal.parts();
    let of_part = |part: usize| {
        let mut vertices = draft.trial.built.iter().zip(&parts).filter(|(_, p)| **p == part).map(|(v, _)| *v);
        let first = vertices.next()?;
        // A port is connected whatever stands there.
        let is_port = |v: VertexIx| draft.canvas.nodes[v as usize].port.is_some();
        Some(if is_port(first) { vertices.find(|v| !is_port(*v)).unwrap_or(first) } else { first })
    };
    Some((0..parts.len()).filter_map(of_part).collect())
}

/// Proposes a pinned patch as a whole, with its roots in the ports that they fall on. False if the patch does not lie inside
/// the cell or breaks the rules in itself.
fn propose_pinned(draft: &mut Draft<'_>, patches: &PatchDatabase, pinned: &PinnedPatch) -> bool {
    let known = patches.patches.get(pinned.patch);
    let Some(patch) = known.filter(|_| pinned.at.is_finite() && pinned.turned.is_finite()) else { return false };
    let facts = patches.facts(pinned.patch);
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
            let port = draft.brief.ports.iter().position(|x| is_root && x.at.distance(at) < AT_PORT);
            if let Some(port) = port {
                let next = placement.map(patch.vertices[e.other(v)]);
                let inward = draft.brief.ports[port].inward;
                fits &= (next - at).normalize_or_zero().dot(inward) > 0.8;
                p.push(draft.brief.ports[port].at, Join::At(port as VertexIx));
            } else {
                fits &= point_in_polygon(at, draft.brief.border);
                p.push(at, Join::Free(is_root || patch.is_connectable(v)));
            }
        }
        p.edges.push((slots[e.a], slots[e.b]));
    }
    draft.trial.proposal = p;
    fits
}

#[cfg(test)]
mod tests {
    use super::super::find_place::find_place;
    use super::super::prepared::PatchFiller;
    use super::super::tests::Kit;
    use super::*;
    use crate::layer::Cancel;
    use crate::space::{Bounds, Seed, centroid, distance_to_segment, segments};
    use crate::streets::contract::defects;
    use crate::streets::filler::{CellFiller, CellStreets};
    use crate::testing::{PortCell, styles};

    /// The filler of a cell's style.
    fn filler(kits: &[Kit], cell: &PortCell<'_>) -> PatchFiller {
        let kit = kits.iter().find(|kit| kit.style.name == cell.style.name);
        kit.expect("a kit for every style").filler.clone()
    }

    fn fill(filler: &PatchFiller, cell: &PortCell<'_>) -> CellStreets {
        filler.fill(&cell.brief(), &Cancel::new()).expect("nobody cancelled")
    }

    /// The pieces that were left out.
    fn left_out(out: &CellStreets) -> Vec<usize> {
        out.left_out.iter().map(|l| l.piece).collect()
    }

    /// Whether every street of a pinned patch is there.
    fn stands(filler: &PatchFiller, pinned: &PinnedPatch, out: &CellStreets) -> bool {
        let patch = &filler.patches.patches[pinned.patch];
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
        let (kits, styles) = (Kit::all(), styles());
        let (mut stood, mut fell) = (0, 0);
        for seed in 0..120 {
            let cell = PortCell::new(seed, &styles);
            let mut filler = filler(&kits, &cell);
            let mut s = Seed(seed).stream("pins", &[]);
            let bounds = Bounds::of(cell.border.iter().copied());
            let off = 0.6 * bounds.size();
            for i in 0..1 + s.index(3) {
                filler.pinned.push(PinnedPatch {
                    patch: s.index(filler.patches.patches.len()),
                    at: bounds.centre() + off * DVec2::new(s.unit() - 0.5, s.unit() - 0.5),
                    turned: s.range(-4.0, 4.0),
                    mirrored: s.chance(0.5),
                    piece: Some(i),
                });
            }
            let out = fill(&filler, &cell);
            assert_eq!(defects(&cell, &out), Vec::<String>::new(), "cell {seed}");
            assert!(left_out(&out).is_sorted_by(|a, b| a < b));
            for (i, pinned) in filler.pinned.iter().enumerate() {
                let out_of = left_out(&out).contains(&i);
                assert!(out_of || stands(&filler, pinned, &out), "cell {seed}: a part of {pinned:?} is missing");
                (stood, fell) = (stood + i32::from(!out_of), fell + i32::from(out_of));
            }
            if out.left_out.len() == filler.pinned.len() {
                // What does not fit leaves no trace.
                filler.pinned.clear();
                assert_eq!(fill(&filler, &cell).streets, out.streets, "cell {seed}");
            }
        }
        assert!(stood > 20 && fell > 20, "{stood} stood, {fell} were left out");
    }

    #[test]
    fn a_place_that_was_found_is_one() {
        let (kits, styles) = (Kit::all(), styles());
        let (mut found, mut stood) = (0, 0);
        for seed in 200..260 {
            let cell = PortCell::new(seed, &styles);
            let mut filler = filler(&kits, &cell);
            for k in 0..2 {
                let patch = (seed as usize * 7 + k * 5) % filler.patches.patches.len();
                let place = find_place(&cell.brief(), &filler, patch);
                assert_eq!(place, find_place(&cell.brief(), &filler, patch));
                filler.pinned.extend(place.map(|place| PinnedPatch { piece: Some(filler.pinned.len()), ..place }));
            }
            let out = fill(&filler, &cell);
            assert_eq!(defects(&cell, &out), Vec::<String>::new(), "cell {seed}");
            found += filler.pinned.len();
            stood += filler.pinned.len() - out.left_out.len();
            let mut pinned = filler.pinned.iter().enumerate();
            assert!(pinned.all(|(i, p)| left_out(&out).contains(&i) || stands(&filler, p, &out)));
        }
        assert!(found > 40 && stood * 50 >= found * 49, "{stood} of {found} places");
    }

    #[test]
    fn what_cannot_be_is_left_out() {
        let (kits, styles) = (Kit::all(), styles());
        let mut cell = PortCell::new(11, &styles);
        let mut filler = filler(&kits, &cell);
        let at = centroid(&cell.border);
        let pin = |piece, patch, at, turned| PinnedPatch { patch, at, turned, mirrored: false, piece: Some(piece) };
        filler.pinned = vec![
            pin(0, 10_000, at, 0.0),
            pin(1, 0, at * f64::NAN, 0.0),
            pin(2, 0, at, f64::INFINITY),
            pin(3, 0, at + 5000.0, 0.0),
            pin(4, 0, cell.border[0], 0.0),
        ];
        assert_eq!(left_out(&fill(&filler, &cell)), [0, 1, 2, 3, 4]);
        cell.ports.clear();
        filler.pinned = vec![pin(0, 0, at, 0.0)];
        let out = fill(&filler, &cell);
        assert_eq!(left_out(&out), [0]);
        assert_eq!(CellStreets { left_out: Vec::new(), ..out }, CellStreets::default());
    }
}
