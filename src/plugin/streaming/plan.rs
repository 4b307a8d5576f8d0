//! Which chunks are wanted, in which detail, and which first.

use super::slot::Slot;
use super::{StreamSettings, Streaming};
use crate::mesh::Detail;
use crate::plugin::anchor::AnchorView;
use crate::plugin::chunk::ChunkStatus;
use crate::plugin::origin::{SprawlOrigin, chunk_translation};
use crate::space::{Bounds, ChunkCoord, distance_to_segment, segment_distance};
use bevy::prelude::*;
use glam::DVec2;
use std::collections::BTreeMap;
use std::time::Instant;

/// Anchors may move so many metres before chunks are planned again.
const STEP: f64 = 4.0;

/// Added to the priority of a chunk that is there already and only needs other meshes, in metres of distance.
const REFRESH_PENALTY: f64 = 400.0;

/// What is wanted of a chunk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Want {
    pub detail: Detail,
    /// The lowest is made first.
    pub priority: f64,
}

/// The chunks that `anchors` want. `now` tells in which detail a chunk is held already: such a chunk is kept up to the
/// unload radius, and in full detail a little beyond the detail radius.
pub(super) fn wanted(
    anchors: &[AnchorView],
    size: i64,
    now: impl Fn(ChunkCoord) -> Option<Detail>,
) -> BTreeMap<ChunkCoord, Want> {
    let mut all: BTreeMap<ChunkCoord, Want> = BTreeMap::new();
    for anchor in anchors {
        let reach = Bounds::of([anchor.at, anchor.ahead]).grown(anchor.unload);
        let low = ChunkCoord::containing(reach.min, size).0;
        let high = ChunkCoord::containing(reach.max, size).0;
        for (y, x) in (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| (y, x))) {
            let coord = ChunkCoord::new(x, y);
            let square = coord.bounds(size);
            let distance = distance(square, anchor.at, anchor.ahead);
            let held = now(coord);
            if distance > if held.is_some() { anchor.unload } else { anchor.load } {
                continue;
            }
            let keep = if held == Some(Detail::Full) { size as f64 / 4.0 } else { 0.0 };
            let detail = if distance <= anchor.detail + keep { Detail::Full } else { Detail::Reduced };
            let priority = priority(square, anchor);
            let want = all.entry(coord).or_insert(Want { detail, priority });
            // The finer detail is the lesser.
            *want = Want { detail: want.detail.min(detail), priority: want.priority.min(priority) };
        }
    }
    all
}

/// The chunk under an anchor comes first, then the near ones, those ahead before those behind.
fn priority(square: Bounds, anchor: &AnchorView) -> f64 {
    if square.contains(anchor.at) {
        return -1.0;
    }
    let centre = square.centre();
    distance_to_segment(centre, anchor.at, anchor.ahead) + 0.3 * centre.distance(anchor.at.midpoint(anchor.ahead))
}

/// Distance between a square and the segment a to b.
fn distance(square: Bounds, a: DVec2, b: DVec2) -> f64 {
    if square.contains(a) || square.contains(b) {
        return 0.0;
    }
    let Bounds { min, max } = square;
    let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
    (0..4).map(|i| segment_distance(corners[i], corners[(i + 1) % 4], a, b)).fold(f64::INFINITY, f64::min)
}

/// Plans when an anchor has moved, come, gone or changed, or when there is a new world.
pub(super) fn plan_chunks(
    mut commands: Commands,
    mut streaming: ResMut<Streaming>,
    origin: Res<SprawlOrigin>,
    settings: Res<StreamSettings>,
    entities: Query<()>,
) {
    let start = Instant::now();
    let streaming = &mut *streaming;
    streaming.counts.frame_ms = 0.0;
    let still = |a: &AnchorView, b: &AnchorView| {
        (a.load, a.unload, a.detail) == (b.load, b.unload, b.detail)
            && a.at.distance(b.at) < STEP
            && a.ahead.distance(b.ahead) < STEP
    };
    let anchors_still = streaming.anchors.len() == streaming.planned.len()
        && streaming.anchors.iter().zip(&streaming.planned).all(|(a, b)| still(a, b));
    if streaming.maker.is_none() || (anchors_still && !streaming.replan && !settings.is_changed()) {
        return;
    }
    streaming.replan = false;
    streaming.planned.clone_from(&streaming.anchors);
    // A game may despawn chunks itself: they are made anew while they are wanted.
    let gone: Vec<ChunkCoord> =
        streaming.slots.iter().filter(|(_, s)| !entities.contains(s.entity)).map(|(c, _)| *c).collect();
    for coord in gone {
        if let Some(mut slot) = streaming.slots.remove(&coord) {
            streaming.cancelled.extend(slot.cancel());
        }
    }
    let slots = &streaming.slots;
    let held = |coord: ChunkCoord| {
        let slot = slots.get(&coord)?;
        Some(slot.shown.as_ref().map_or(slot.want, |s| s.detail.min(slot.want)))
    };
    let wanted = wanted(&streaming.anchors, streaming.size, held);
    for (coord, slot) in &mut streaming.slots {
        match wanted.get(coord) {
            Some(want) => {
                slot.leaving = false;
                slot.want = want.detail;
                slot.priority = want.priority + if slot.shown.is_some() { REFRESH_PENALTY } else { 0.0 };
            }
            None if !slot.leaving => {
                slot.leaving = true;
                streaming.cancelled.extend(slot.cancel());
            }
            None => {}
        }
    }
    for (coord, want) in wanted {
        streaming.slots.entry(coord).or_insert_with(|| {
            let translation = chunk_translation(origin.origin(), coord, streaming.size);
            let entity = commands.spawn((
                Name::new(format!("chunk {coord}")),
                coord,
                ChunkStatus::Queued,
                Transform::from_translation(translation),
                Visibility::default(),
            ));
            Slot::new(entity.id(), want.detail, want.priority)
        });
    }
    streaming.counts.frame_ms += start.elapsed().as_secs_f32() * 1000.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn anchor(x: f64, y: f64) -> AnchorView {
        let at = DVec2::new(x, y);
        AnchorView { at, ahead: at, load: 1000.0, unload: 1400.0, detail: 400.0 }
    }

    #[test]
    fn chunks_are_kept_longer_than_they_are_asked_for() {
        let fresh = wanted(&[anchor(100.0, 100.0)], 512, |_| None);
        assert!(fresh.contains_key(&ChunkCoord::new(-2, 0)) && !fresh.contains_key(&ChunkCoord::new(-3, 0)));
        let moved = |held: bool| {
            wanted(&[anchor(800.0, 100.0)], 512, |c| (held && fresh.contains_key(&c)).then_some(Detail::Reduced))
        };
        assert!(!moved(false).contains_key(&ChunkCoord::new(-2, 0)));
        assert!(moved(true).contains_key(&ChunkCoord::new(-2, 0)));
        assert!(
            !wanted(&[anchor(1200.0, 100.0)], 512, |_| Some(Detail::Reduced)).contains_key(&ChunkCoord::new(-2, 0))
        );
    }

    #[test]
    fn detail_does_not_flicker_at_its_radius() {
        let far = ChunkCoord::new(1, 0);
        let detail = |x: f64, held| wanted(&[anchor(x, 256.0)], 512, |_| held)[&far].detail;
        assert_eq!(detail(100.0, None), Detail::Reduced);
        assert_eq!(detail(150.0, Some(Detail::Reduced)), Detail::Full);
        assert_eq!(detail(100.0, Some(Detail::Full)), Detail::Full);
        assert_eq!(detail(-100.0, Some(Detail::Full)), Detail::Reduced);
    }

    #[test]
    fn the_ground_underfoot_comes_first_and_what_is_ahead_before_what_is_behind() {
        let mut moving = anchor(256.0, 256.0);
        moving.ahead = DVec2::new(656.0, 256.0);
        let wants = wanted(&[moving], 512, |_| None);
        let of = |x, y| wants[&ChunkCoord::new(x, y)].priority;
        assert!(wants.values().all(|w| w.priority >= of(0, 0)));
        assert!(of(1, 0) < of(0, 1) && of(0, 1) < of(-1, 0), "{} {} {}", of(1, 0), of(0, 1), of(-1, 0));
        assert!(of(2, 0) < of(-2, 0));
    }

    #[test]
    fn several_anchors_share_chunks_and_the_finest_detail_wins() {
        let both = wanted(&[anchor(256.0, 256.0), anchor(1256.0, 256.0)], 512, |_| None);
        let alone = wanted(&[anchor(256.0, 256.0)], 512, |_| None);
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
