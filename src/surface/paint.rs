//! Markings on carriageways: centre, lane and edge lines, stop lines and crossings, as rectangles along and across a street.

use crate::network::{Side, Street, StreetClass, Traffic};
use crate::surface::finish::Finish;
use crate::surface::junction::StreetEnd;
use crate::surface::lane::LaneRules;
use crate::surface::section::CrossSection;

/// A painted rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    /// Where it begins and ends along the street, in metres.
    pub along: [f64; 2],
    /// Its right and left edge, in metres to the left of the centre line.
    pub across: [f64; 2],
    /// What the carriageway is made of there.
    pub finish: Finish,
}

/// Half the width of a line, in metres.
const LINE: f64 = 0.075;

/// Distance of an edge line from the edge of the carriageway and of a double line's halves from the middle, in metres.
const INSET: f64 = 0.2;

/// Length of a dash, and distance from the start of one dash to the start of the next, in metres.
const DASH: [f64; 2] = [3.0, 9.0];
const COUNTRY_DASH: [f64; 2] = [4.0, 12.0];

/// Where a crossing begins and ends beyond the junction, in metres, and the width of its stripes and gaps.
const CROSSING: [f64; 2] = [0.6, 3.6];
const STRIPE: f64 = 0.5;

/// Where a stop line begins beyond a junction with and without a crossing, and its width, in metres.
const STOP: [f64; 2] = [4.6, 0.5];
const STOP_WIDTH: f64 = 0.4;

/// Least length of a street between its junctions that has crossings and stop lines, in metres.
const LEAST_ROOM: f64 = 24.0;

/// The marks of a street, `length` metres long, where traffic drives on the side `driving`.
pub(super) fn marks(street: &Street, length: f64, ends: &[Option<StreetEnd>; 2], driving: Side) -> Vec<Mark> {
    let (class, section) = (street.class, CrossSection::of(street.class));
    let cuts = [0, 1].map(|end| ends[end].as_ref().map_or(0.0, |e| e.cut.along));
    let roomy = length - cuts[0] - cuts[1] >= LEAST_ROOM;
    let both_ways = street.traffic(driving) == Traffic::Both;
    let mut out = Vec::new();
    // Where lines begin and end.
    let mut free = [cuts[0] + 1.0, length - cuts[1] - 1.0];
    for end in [0, 1] {
        let Some(at) = ends[end].as_ref().filter(|e| roomy && e.streets > 2) else { continue };
        let place = |from: f64, to: f64| match end {
            0 => [cuts[0] + from, cuts[0] + to],
            _ => [length - cuts[1] - to, length - cuts[1] - from],
        };
        let crossed = class.is_main() && section.paved;
        if crossed {
            let stripes = ((2.0 * section.carriageway - STRIPE) / (2.0 * STRIPE)).floor();
            let first = -(stripes - 0.5) * STRIPE;
            let zone = place(CROSSING[0], CROSSING[1]);
            out.push(Mark {
                along: zone,
                across: [-section.carriageway, section.carriageway],
                finish: Finish::Crossing,
            });
            for k in 0..stripes as usize {
                let right = first + k as f64 * 2.0 * STRIPE;
                out.push(Mark { along: zone, across: [right, right + STRIPE], finish: Finish::Stripe });
            }
        }
        // Who comes from a lesser street stops.
        let stops = both_ways && (crossed || at.greatest < class);
        let stop = STOP[usize::from(!crossed)];
        if stops {
            let edge = section.carriageway - 0.1;
            // Who arrives keeps to their own side.
            let across = if (end == 0) == (driving == Side::Right) { [0.1, edge] } else { [-edge, -0.1] };
            out.push(Mark { along: place(stop, stop + STOP_WIDTH), across, finish: Finish::Marking });
        }
        if crossed || stops {
            let begin = place(stop + STOP_WIDTH, stop + STOP_WIDTH);
            free[end] = begin[0];
        }
    }
    let mut line = |middle: f64, dash: Option<[f64; 2]>| {
        let across = [middle - LINE, middle + LINE];
        let Some([dash, period]) = dash else {
            if free[0] < free[1] {
                out.push(Mark { along: free, across, finish: Finish::Marking });
            }
            return;
        };
        for k in 0..(length / period) as usize {
            let from = (k as f64 + 0.5) * period;
            if from > free[0] && from + dash < free[1] {
                out.push(Mark { along: [from, from + dash], across, finish: Finish::Marking });
            }
        }
    };
    let (edge, lanes) = (section.carriageway - INSET, LaneRules::of(class));
    let dash = if section.paved { DASH } else { COUNTRY_DASH };
    match lanes.each_way {
        _ if class == StreetClass::Local || !both_ways => {}
        1 => line(0.0, Some(dash)),
        each_way => {
            [-INSET, INSET].into_iter().for_each(|middle| line(middle, None));
            for lane in 1..each_way {
                let off = lanes.median / 2.0 + lane as f64 * lanes.width;
                [-off, off].into_iter().for_each(|middle| line(middle, Some(dash)));
            }
        }
    }
    if matches!(class, StreetClass::Highway | StreetClass::Major | StreetClass::Ramp) {
        [-edge, edge].into_iter().for_each(|middle| line(middle, None));
    }
    out
}
