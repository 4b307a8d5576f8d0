//! Quick tests of placements on the coarse grid, before anything exact is computed: whether the middle of a patch has room,
//! and whether its arms can end somewhere.

use super::placement::Placement;
use crate::patch::{ArmSample, LEAST_ARM, PatchDatabase, PatchView};
use crate::streets::cell::{Draft, FreeGrid, Obstacle, STEP, WEDGE, joint_angle_fits, landing_place};
use glam::{DVec2, Vec2};

/// A patch, seen from one of its ends, on the coarse grid: the origin and the axes of the view there.
#[derive(Clone, Copy)]
pub struct Overlay {
    origin: Vec2,
    x: Vec2,
    y: Vec2,
}

impl Overlay {
    /// The overlay of a patch whose view from one of its ends is laid at `start` in the direction `way` (of length 1).
    pub fn new(draft: &Draft<'_>, start: DVec2, way: DVec2, mirrored: bool) -> Self {
        let x = FreeGrid::step_in_squares(way);
        Self { origin: draft.canvas.free.in_squares(start), x, y: if mirrored { -x.perp() } else { x.perp() } }
    }

    fn map(self, p: Vec2) -> Vec2 {
        self.origin + self.turn(p)
    }

    fn turn(self, p: Vec2) -> Vec2 {
        self.x * p.x + self.y * p.y
    }
}

/// Greatest distance from a sample of an arm to the point where the arm meets a nearby obstacle, in metres.
const AHEAD: f64 = 10.0;

/// False if the placement surely comes too near to an obstacle, away from its start and from its `end`.
pub fn roughly_fits(
    draft: &Draft<'_>,
    patches: &PatchDatabase,
    placement: &Placement,
    start: DVec2,
    end: Option<DVec2>,
) -> bool {
    let enough = FreeGrid::least(draft.rules.growth.coarse_gap());
    patches.facts(placement.patch).shape.samples.iter().all(|p| {
        let p = placement.map(*p);
        let room = draft.canvas.free.at(p);
        room >= enough || {
            let away = end.map_or(p.distance(start), |e| p.distance(start).min(p.distance(e)));
            room >= FreeGrid::least((WEDGE * away) as f32)
        }
    })
}

/// False if a patch, seen from one of its ends, surely comes too near to an obstacle or has an arm that cannot end anywhere.
pub fn view_roughly_fits(draft: &Draft<'_>, view: &PatchView, overlay: Overlay) -> bool {
    let enough = FreeGrid::least(draft.rules.growth.coarse_gap());
    view.samples.iter().all(|(p, away)| {
        let room = draft.canvas.free.at_square(overlay.map(*p));
        room >= enough || room >= FreeGrid::least(WEDGE as f32 * away)
    }) && view.arms.iter().all(|arm| arm_roughly_ends(draft, arm, overlay))
}

/// Whether an arm can end, either in the open or on the first obstacle that it meets.
fn arm_roughly_ends(draft: &Draft<'_>, arm: &[ArmSample], overlay: Overlay) -> bool {
    let free = &draft.canvas.free;
    let Some(end) = arm.last() else { return true };
    let needed = (WEDGE as f32 * end.at.length()).min(draft.rules.growth.coarse_gap());
    let has_room = free.at_square(overlay.map(end.at)) >= FreeGrid::least(needed);
    let beyond = (1..)
        .map(|k| (STEP * f64::from(k)) as f32)
        .take_while(|far| *far <= draft.rules.growth.gap as f32 && !has_room);
    let beyond = beyond.map(|far| ArmSample {
        at: end.at + end.heading * far,
        heading: end.heading,
        along: end.along + far,
        back: end.back + far,
    });
    for sample in arm.iter().copied().chain(beyond) {
        let square = overlay.map(sample.at);
        if free.at_square(square) > FreeGrid::MEETS {
            continue;
        }
        if let Some(met) = draft.canvas.nearest(square)
            && let Some(may_end) = arm_may_meet(draft, met, sample, overlay)
        {
            return may_end;
        }
    }
    has_room
}

/// Whether an arm may end on the obstacle `met`, which it comes near to at `sample`; `None` if the arm does not meet it.
fn arm_may_meet(draft: &Draft<'_>, met: &Obstacle, sample: ArmSample, overlay: Overlay) -> Option<bool> {
    let at = draft.canvas.free.place(overlay.map(sample.at));
    let heading = overlay.turn(sample.heading).as_dvec2() * STEP;
    let (step, to) = (met.b - met.a, met.a - at);
    let sine = heading.perp_dot(step);
    let far = to.perp_dot(step) / sine;
    let share = to.perp_dot(heading) / sine;
    if !(0.0..=1.0).contains(&share) || far.abs() > AHEAD {
        return None;
    }
    if met.is_wall() {
        // It is cut back.
        let sine = (sine.abs() / step.length()).max(0.2);
        return Some(f64::from(sample.along) + far - draft.rules.growth.wall_gap / sine > LEAST_ARM - STEP);
    }
    let hit = met.a + step * share;
    let (end, join) = landing_place(&draft.canvas, met, hit, &draft.rules.growth);
    let from = at - heading * f64::from(sample.back);
    Some(joint_angle_fits(&draft.canvas, join, end, from - end, &draft.rules.growth))
}
