//! Rays over the ground: how far a settlement can extend in one direction.

use crate::terrain::Scan;
use glam::DVec2;

/// Dry ground in metres between a settlement and water.
pub(in crate::region) const SHORE: f64 = 25.0;
/// Least extent of a settlement in every direction, in metres.
pub(in crate::region) const LEAST_REACH: f64 = 105.0;
/// Beyond this distance from the centre a ray that is [`Detail::Near`] takes steps this many times as long.
pub(super) const NEAR: (f64, f64) = (130.0, 3.0);
/// Step in metres over low ground, where a narrow river may lie, and the least and greatest step over high ground.
const STEPS: (f64, f64, f64) = (18.0, 36.0, 90.0);
/// Step over high ground, in heights above the water.
const STEP_BY_HEIGHT: f64 = 3.0;
/// Ground this many metres above the water counts as high.
const HIGH: f64 = 9.0;
/// Ground less than the first number of metres above its water may be a bank: there a ray searches in steps of the second.
const BANK: (f64, f64) = (1.4, 5.0);
/// Length in metres over which the slope along a ray is measured.
const SLOPE_LENGTH: f64 = 40.0;
/// A ray ends where the ground is this many times as steep as the greatest mean slope of a settlement.
const STEEP: f64 = 3.0;

/// How carefully a ray looks for water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::region) enum Detail {
    /// No narrow river is stepped over.
    Full,
    /// As [`Detail::Full`] near the centre, in longer steps farther out: enough to judge a place.
    Near,
}

/// A ray from a centre.
#[derive(Clone, Copy, Debug)]
pub(in crate::region) struct Ray {
    /// The centre, a plan point on land.
    pub centre: DVec2,
    /// Unit direction.
    pub direction: DVec2,
    /// Distance from the centre at which the ray begins. The ground before it is not looked at.
    pub from: f64,
    /// Greatest distance from the centre.
    pub limit: f64,
    pub detail: Detail,
}

/// What a ray finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::region) struct Extent {
    /// Metres from the centre to the end of the ray: its limit, the shore, or the foot of steep ground.
    pub reach: f64,
    /// Sum of rise and fall along the ray, in metres.
    pub climb: f64,
}

impl Ray {
    /// Follows the ray until its limit, water, or a slope above three times `max_slope`.
    pub fn cast(self, ground: &mut Scan<'_>, max_slope: f64) -> Extent {
        let mut at = |along: f64| ground(self.centre + self.direction * along);
        let near = match self.detail {
            Detail::Full => f64::INFINITY,
            Detail::Near => NEAR.0,
        };
        let start = at(self.from);
        let (mut along, mut last, mut climb) = (self.from, start, 0.0);
        let mut mark = (self.from, start.height);
        let mut end = self.limit;
        // A shore just beyond the end still keeps its distance.
        while along < end + SHORE {
            let above = last.height - last.water_level;
            let (fine, longer) = if along < near { (true, 1.0) } else { (false, NEAR.1) };
            let step = if above > HIGH { (above * STEP_BY_HEIGHT).clamp(STEPS.1, STEPS.2) } else { STEPS.0 };
            let next = along + step * longer;
            let here = at(next);
            let mut wet = (here.depth() > 0.0).then_some(next);
            if fine && wet.is_none() && above.min(here.height - here.water_level) < BANK.0 {
                let finer = (1..(STEPS.1 / BANK.1) as usize).map(|i| along + i as f64 * BANK.1);
                wet = finer.take_while(|d| *d < next).find(|d| at(*d).depth() > 0.0);
            }
            if let Some(mut wet) = wet {
                // Bisects for the water's edge between the last dry step and this one.
                let mut dry = along;
                while wet - dry > 1.0 {
                    let middle = (dry + wet) / 2.0;
                    if at(middle).depth() > 0.0 { wet = middle } else { dry = middle }
                }
                return Extent { reach: end.min((dry - SHORE).max(0.0)), climb };
            }
            if next - mark.0 >= SLOPE_LENGTH && next < end {
                if (here.height - mark.1).abs() > STEEP * max_slope * (next - mark.0) {
                    end = mark.0;
                }
                mark = (next, here.height);
            }
            climb += (here.height - last.height).abs();
            (along, last) = (next, here);
        }
        Extent { reach: end, climb }
    }
}
