//! Which chunks are wanted, in which detail, and which first.

use crate::mesh::Detail;
use crate::plugin::anchor::AnchorView;
use crate::space::{Bounds, ChunkCoord, distance_to_segment, segment_distance};
use crate::surface::LONGEST_PIECE;
use glam::DVec2;
use std::collections::BTreeMap;

/// A chunk that is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Want {
    pub detail: Detail,
    /// Chunks are made in the order of this number, the lowest first.
    pub priority: f64,
}

/// The chunks of edge `size` metres that `anchors` want. `current_detail` gives the detail of a chunk that is loaded or planned
/// already. Such a chunk is kept up to the unload radius, and in full detail a little beyond the detail radius.
pub(super) fn wanted(
    anchors: &[AnchorView],
    size: i64,
    current_detail: impl Fn(ChunkCoord) -> Option<Detail>,
) -> BTreeMap<ChunkCoord, Want> {
    let mut all: BTreeMap<ChunkCoord, Want> = BTreeMap::new();
    for anchor in anchors {
        let reach = Bounds::of([anchor.at, anchor.ahead]).grown(anchor.unload + LONGEST_PIECE / 2.0);
        let low = ChunkCoord::containing(reach.min, size).0;
        let high = ChunkCoord::containing(reach.max, size).0;
        for (y, x) in (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| (y, x))) {
            let coord = ChunkCoord::new(x, y);
            let square = coord.bounds(size);
            // Streets of a chunk reach half a piece out of its square.
            let distance = distance(square, anchor.at, anchor.ahead) - LONGEST_PIECE / 2.0;
            let current = current_detail(coord);
            if distance > if current.is_some() { anchor.unload } else { anchor.load } {
                continue;
            }
            let margin = if current == Some(Detail::Full) { size as f64 / 4.0 } else { 0.0 };
            let detail = if distance <= anchor.detail + margin { Detail::Full } else { Detail::Reduced };
            let priority = priority(square, anchor);
            let want = all.entry(coord).or_insert(Want { detail, priority });
            // A finer detail is a lesser value.
            *want = Want { detail: want.detail.min(detail), priority: want.priority.min(priority) };
        }
    }
    all
}

/// The chunk under an anchor comes first, then near chunks before far ones, and chunks ahead before chunks behind.
fn priority(square: Bounds, anchor: &AnchorView) -> f64 {
    if square.contains(anchor.at) {
        return -1.0;
    }
    let centre = square.centre();
    distance_to_segment(centre, anchor.at, anchor.ahead) + 0.3 * centre.distance(anchor.at.midpoint(anchor.ahead))
}

/// Distance in metres between a square and the segment from `a` to `b`.
fn distance(square: Bounds, a: DVec2, b: DVec2) -> f64 {
    if square.contains(a) || square.contains(b) {
        return 0.0;
    }
    let Bounds { min, max } = square;
    let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
    (0..4).map(|i| segment_distance(corners[i], corners[(i + 1) % 4], a, b)).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_kept_longer_than_they_are_asked_for() {
        let fresh = wanted(&[AnchorView::standing(100.0, 100.0)], 512, |_| None);
        assert!(fresh.contains_key(&ChunkCoord::new(-2, 0)) && !fresh.contains_key(&ChunkCoord::new(-3, 0)));
        let moved = |held: bool| {
            wanted(&[AnchorView::standing(800.0, 100.0)], 512, |c| {
                (held && fresh.contains_key(&c)).then_some(Detail::Reduced)
            })
        };
        assert!(!moved(false).contains_key(&ChunkCoord::new(-2, 0)));
        assert!(moved(true).contains_key(&ChunkCoord::new(-2, 0)));
        assert!(
            !wanted(&[AnchorView::standing(1200.0, 100.0)], 512, |_| Some(Detail::Reduced))
                .contains_key(&ChunkCoord::new(-2, 0))
        );
    }

    #[test]
    fn detail_does_not_flicker_at_its_radius() {
        let far = ChunkCoord::new(1, 0);
        let detail = |x: f64, held| wanted(&[AnchorView::standing(x, 256.0)], 512, |_| held)[&far].detail;
        assert_eq!(detail(40.0, None), Detail::Reduced);
        assert_eq!(detail(150.0, Some(Detail::Reduced)), Detail::Full);
        assert_eq!(detail(40.0, Some(Detail::Full)), Detail::Full);
        assert_eq!(detail(-100.0, Some(Detail::Full)), Detail::Reduced);
    }

    #[test]
    fn the_ground_underfoot_comes_first_and_what_is_ahead_before_what_is_behind() {
        let mut moving = AnchorView::standing(256.0, 256.0);
        moving.ahead = DVec2::new(656.0, 256.0);
        let wants = wanted(&[moving], 512, |_| None);
        let priority = |x, y| wants[&ChunkCoord::new(x, y)].priority;
        assert!(wants.values().all(|w| w.priority >= priority(0, 0)));
        let [ahead, aside, behind] = [priority(1, 0), priority(0, 1), priority(-1, 0)];
        assert!(ahead < aside && aside < behind, "{ahead} {aside} {behind}");
        assert!(priority(2, 0) < priority(-2, 0));
    }

    #[test]
    fn several_anchors_share_chunks_and_the_finest_detail_wins() {
        let both = wanted(&[AnchorView::standing(256.0, 256.0), AnchorView::standing(1256.0, 256.0)], 512, |_| None);
        let alone = wanted(&[AnchorView::standing(256.0, 256.0)], 512, |_| None);
        assert!(both.len() > alone.len());
        assert_eq!(alone[&ChunkCoord::new(2, 0)].detail, Detail::Reduced);
        assert_eq!(both[&ChunkCoord::new(2, 0)].detail, Detail::Full);
    }

    #[test]
    fn a_segment_that_passes_through_a_square_touches_it() {
        let square = Bounds::square(DVec2::ZERO, 10.0);
        assert_eq!(distance(square, DVec2::new(-20.0, 1.0), DVec2::new(20.0, 2.0)), 0.0);
        assert_eq!(distance(square, DVec2::new(-20.0, 0.0), DVec2::new(-8.0, 0.0)), 3.0);
    }
}
