//! What the coarse grid tells of a placement before anything exact is computed: whether its middle has room, and whether
//! its arms can end somewhere.

use super::Work;
use super::checker::WEDGE;
use super::free::{FreeGrid, STEP};
use super::joint::joint_angle_fits;
use super::near::Seg;
use super::place::Placement;
use super::proposal::Limits;
use crate::patch::{ArmSample, LEAST_ARM, PatchView, SECTORS, SectorReach, in_sectors};
use crate::space::math;
use glam::{DVec2, Vec2};
use std::f64::consts::TAU;

/// How a patch that is seen from one of its ends lies on the coarse grid: the origin and the axes of the view there.
#[derive(Clone, Copy)]
pub(super) struct Overlay {
    origin: Vec2,
    x: Vec2,
    y: Vec2,
}

impl Overlay {
    fn map(self, p: Vec2) -> Vec2 {
        self.origin + self.turn(p)
    }

    fn turn(self, p: Vec2) -> Vec2 {
        self.x * p.x + self.y * p.y
    }
}

/// What is met first around a vertex, by sectors as those of a [`PatchView`].
pub(super) struct Surroundings {
    /// Direction of the first ray, in which the street leads on; the others follow counter-clockwise.
    direction: DVec2,
    /// Distance at which something is met, by rays.
    far: [f32; RAYS * SECTORS],
    /// Distance up to which there may be room for a patch.
    room: SectorReach,
    /// The same for patches that are mirrored.
    mirrored: SectorReach,
}

/// Greatest distance from a sample of an arm to where the arm meets what is near there, in metres.
const AHEAD: f64 = 10.0;

/// Rays in each sector.
const RAYS: usize = 2;

/// Rays that are followed at once.
const TOGETHER: usize = 4;
const _: () = assert!((RAYS * SECTORS).is_multiple_of(TOGETHER));

impl Surroundings {
    /// The greatest distance at which something may be met straight on.
    pub fn ahead(&self) -> f64 {
        f64::from(self.far[0]) + STEP
    }

    /// Whether a patch that reaches so far may have room: not where that is farther than what is met.
    pub fn may_hold(&self, reach: &SectorReach, mirrored: bool) -> bool {
        let room = if mirrored { &self.mirrored } else { &self.room };
        reach.iter().zip(room).all(|(reach, room)| reach.cmple(*room).all())
    }

    /// Whether what lies at `to` from here and `distance` away may be in sight.
    pub fn may_see(&self, to: DVec2, distance: f64) -> bool {
        let rays = self.far.len() as i32;
        let turned = DVec2::new(self.direction.dot(to), self.direction.perp_dot(to));
        // It is off by less than half a ray.
        let ray = (math::quarters(turned) * f64::from(rays) / 4.0).round() as i32;
        let far = |ray: i32| self.far[ray.rem_euclid(rays) as usize];
        far(ray - 1).max(far(ray)).max(far(ray + 1)) + 3.0 * STEP as f32 > distance as f32
    }
}

impl Work<'_> {
    /// What is around `at`, where a street leads on in `direction`, as far as `reach`.
    pub(super) fn surroundings(&self, at: DVec2, direction: DVec2, reach: f64) -> Surroundings {
        let turn = math::direction(TAU / (RAYS * SECTORS) as f64);
        let mut ray = DVec2::new(turn.x, -turn.y).rotate(direction);
        let mut far = [0.0; RAYS * SECTORS];
        for far in far.as_chunks_mut::<TOGETHER>().0 {
            let rays = [(); TOGETHER].map(|()| {
                ray = turn.rotate(ray);
                (at, ray)
            });
            *far = self.canvas.free.ahead(rays, reach).map(|far| far as f32);
        }
        let gap = self.limits.gap as f32;
        let room: [f32; SECTORS] = std::array::from_fn(|sector| {
            let middle = RAYS * sector + far.len();
            let rays = middle - RAYS / 2..=middle + RAYS / 2;
            let far = rays.map(|k| far[k % far.len()]).fold(0.0, f32::max);
            // Something is nearer beside it.
            (far - gap).max(far / (1.0 + WEDGE as f32))
        });
        let mirrored = in_sectors(|sector| room[(SECTORS - sector) % SECTORS]);
        Surroundings { direction, far, room: in_sectors(|sector| room[sector]), mirrored }
    }

    /// Quick and coarse: false when the placement surely comes too near something away from its start and `end`.
    pub(super) fn roughly_fits(&self, placement: &Placement, start: DVec2, end: Option<DVec2>) -> bool {
        let enough = FreeGrid::least(coarse_gap(&self.limits));
        self.brief.patches.facts(placement.patch).shape.samples.iter().all(|p| {
            let p = placement.map(*p);
            let room = self.canvas.free.at(p);
            room >= enough || {
                let away = end.map_or(p.distance(start), |e| p.distance(start).min(p.distance(e)));
                room >= FreeGrid::least((WEDGE * away) as f32)
            }
        })
    }

    /// Quick and coarse: false when a street from `from` to `to`, where it meets others, surely comes too near something on
    /// its way.
    pub(super) fn way_is_roughly_free(&self, from: DVec2, to: DVec2, limits: &Limits) -> bool {
        let length = from.distance(to);
        [0.3, 0.5, 0.7].into_iter().all(|share: f64| {
            let needed = (WEDGE * length * share.min(1.0 - share)) as f32;
            self.canvas.free.at(from.lerp(to, share)) >= FreeGrid::least(needed.min(coarse_gap(limits)))
        })
    }

    /// The overlay of a patch whose view from one of its ends is laid at `start` in the direction `way` (of length 1).
    pub(super) fn overlay(&self, start: DVec2, way: DVec2, mirrored: bool) -> Overlay {
        let x = FreeGrid::step_in_squares(way);
        Overlay { origin: self.canvas.free.in_squares(start), x, y: if mirrored { -x.perp() } else { x.perp() } }
    }

    /// The same for a patch seen from one of its ends. Its arms need not lie in the open, but end somewhere.
    pub(super) fn view_roughly_fits(&self, view: &PatchView, overlay: Overlay) -> bool {
        let enough = FreeGrid::least(coarse_gap(&self.limits));
        view.samples.iter().all(|(p, away)| {
            let room = self.canvas.free.at_square(overlay.map(*p));
            room >= enough || room >= FreeGrid::least(WEDGE as f32 * away)
        }) && view.arms.iter().all(|arm| self.arm_roughly_ends(arm, overlay))
    }

    /// Whether an arm can end: where it lies if there is room, or on what it meets.
    fn arm_roughly_ends(&self, arm: &[ArmSample], overlay: Overlay) -> bool {
        let free = &self.canvas.free;
        let Some(end) = arm.last() else { return true };
        let needed = (WEDGE as f32 * end.at.length()).min(coarse_gap(&self.limits));
        let has_room = free.at_square(overlay.map(end.at)) >= FreeGrid::least(needed);
        let beyond =
            (1..).map(|k| (STEP * f64::from(k)) as f32).take_while(|far| *far <= self.limits.gap as f32 && !has_room);
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
            if let Some(met) = self.canvas.nearest(square)
                && let Some(may_end) = self.arm_may_meet(met, sample, overlay)
            {
                return may_end;
            }
        }
        has_room
    }

    /// Whether an arm that comes near the obstacle `met` about at `sample` may end there; `None` where it does not meet it.
    fn arm_may_meet(&self, met: &Seg, sample: ArmSample, overlay: Overlay) -> Option<bool> {
        let at = self.canvas.free.place(overlay.map(sample.at));
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
            return Some(f64::from(sample.along) + far - self.limits.wall_gap / sine > LEAST_ARM - STEP);
        }
        let hit = met.a + step * share;
        let (end, join) = self.landing_place(met, hit, &self.limits);
        let from = at - heading * f64::from(sample.back);
        Some(joint_angle_fits(&self.canvas, join, end, from - end, &self.limits))
    }
}

/// The distance that the coarse grid is asked for: a little less than the gap, since near the vertices that are joined the
/// distance along the network decides.
pub(super) fn coarse_gap(limits: &Limits) -> f32 {
    (limits.gap.min(limits.wall_gap) - 1.0) as f32
}
