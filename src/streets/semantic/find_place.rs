//! Finds a place in a cell for a patch that is to stand there.

use super::pinned::{PinnedPatch, lay, lay_pinned};
use super::placement::Placement;
use super::placer::Placer;
use super::prepared::PatchFiller;
use crate::space::{Bounds, math, quantize};
use crate::streets::cell::{Draft, lay_stubs};
use crate::streets::filler::CellBrief;
use glam::DVec2;
use std::f64::consts::FRAC_PI_2;

/// Number of places that are tried for a patch without a main street.
const TRIES: usize = 400;

/// A place where the patch of index `patch` can stand: it keeps its distance from the border, the ports and the patches that
/// are pinned already, and streets have room to reach it. A patch with a main street stands at ports, any other along the
/// field. The same arguments give the same place; `None` if none of some hundred places fits.
pub fn find_place(brief: &CellBrief<'_>, filler: &PatchFiller, patch: usize) -> Option<PinnedPatch> {
    let drawn = filler.patches.patches.get(patch)?;
    let mut draft = Draft::new(brief);
    let mut placer = Placer::new(&draft, &filler.patches, &filler.weights, &filler.once);
    lay_stubs(&mut draft);
    lay_pinned(&mut draft, &mut placer, &filler.pinned, &mut Vec::new());
    let mut rng = brief.seed.stream("place of a patch", &[brief.id.0, patch as u64, filler.pinned.len() as u64]);
    let mut tries: Vec<PinnedPatch> = Vec::new();
    if let Some(main) = filler.patches.facts(patch).main.as_ref() {
        let along = drawn.vertices[main.to] - drawn.vertices[main.from];
        for port in brief.ports {
            for root in &main.attachments {
                for mirrored in [false, true] {
                    let at = drawn.vertices[*root];
                    let side = along.perp().normalize_or_zero();
                    let laid = Placement::new((patch, *root, at), side, mirrored, port.at, port.inward);
                    let turned = math::angle_of(laid.map(DVec2::X) - laid.map(DVec2::ZERO));
                    tries.push(PinnedPatch { patch, at: laid.map(DVec2::ZERO), turned, mirrored, piece: None });
                }
            }
        }
        for i in (1..tries.len()).rev() {
            tries.swap(i, rng.index(i + 1));
        }
    } else {
        let bounds = Bounds::of(brief.border.iter().copied());
        for _ in 0..TRIES {
            let at = bounds.min + bounds.size() * DVec2::new(rng.unit(), rng.unit());
            let quarter = rng.index(4) as f64 * FRAC_PI_2;
            let at = quantize(at);
            let turned = brief.field.angle(at) + quarter;
            tries.push(PinnedPatch { patch, at, turned, mirrored: rng.chance(0.5), piece: None });
        }
    }
    // First with the style's distances, so that streets go around it as around any other patch.
    [draft.rules.growth, draft.rules.repair]
        .into_iter()
        .find_map(|limits| tries.iter().find(|t| lay(&mut draft, &mut placer, t, &limits).is_some()).copied())
}
