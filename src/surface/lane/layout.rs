//! The lanes of a street.

use crate::network::{Side, Street, StreetClass, StreetId, Traffic};
use crate::space::{cut_line, quantize, stable_hash};
use crate::surface::offset::offset_line;
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Stable name of a lane: the same in every run and in every chunk that sees its street.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LaneId(pub u64);

impl LaneId {
    /// The id of a lane of a street.
    fn of(street: StreetId, along: bool, index: usize) -> Self {
        Self(stable_hash(&[street.0, 0x6c61_6e65, u64::from(along), index as u64]))
    }
}

/// A lane of a street, in one direction of traffic.
#[derive(Clone, Debug, PartialEq)]
pub struct Lane {
    /// Stable name.
    pub id: LaneId,
    /// The street.
    pub street: StreetId,
    /// Class of the street.
    pub class: StreetClass,
    /// Whether traffic goes from the street's junction `from` to its junction `to`.
    pub along: bool,
    /// Place among the lanes of its direction: 0 for the lane at the middle of the street.
    pub index: usize,
    /// Width in metres.
    pub width: f64,
    /// Greatest speed in metres per second.
    pub speed: f64,
    /// Centre line in the direction of traffic, local to the street's frame: two points or more, on the quantum grid. It leaves
    /// out both ends of the street, through which turns lead.
    pub line: Vec<DVec2>,
}

/// How a class of streets is divided into lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneRules {
    /// Lanes in each direction of traffic.
    pub each_way: usize,
    /// Width of a lane in metres.
    pub width: f64,
    /// Width between the directions of traffic, in metres.
    pub median: f64,
    /// Greatest speed in metres per second.
    pub speed: f64,
}

impl LaneRules {
    /// The lanes of a class. What lanes and median leave of the carriageway are its margins.
    pub fn of(class: StreetClass) -> Self {
        let (each_way, width, median, kmh) = match class {
            StreetClass::Highway => (2, 3.25, 0.6, 100.0),
            StreetClass::Major => (1, 3.5, 0.0, 80.0),
            StreetClass::Minor => (1, 2.65, 0.0, 70.0),
            StreetClass::Ramp => (1, 3.75, 0.0, 50.0),
            StreetClass::Arterial => (2, 2.9, 0.0, 50.0),
            StreetClass::Main => (1, 3.25, 0.0, 50.0),
            StreetClass::Local => (1, 2.75, 0.0, 30.0),
        };
        Self { each_way, width, median, speed: kmh / 3.6 }
    }

    /// Width of all lanes of a street with traffic in so many directions, and of the median between these, in metres.
    pub fn full_width(&self, directions: usize) -> f64 {
        (directions * self.each_way) as f64 * self.width + if directions == 2 { self.median } else { 0.0 }
    }
}

/// Length at each end of a street in which turns lead from and to its lanes, in metres, and its greatest share of the street.
const TURNS: (f64, f64) = (18.0, 0.4);

/// The lanes of a street where traffic drives on the side `driving`: those along the street, then those against it, in each
/// direction from the middle of the street outwards. None for a street shorter than half a metre.
pub fn lanes_of(street: &Street, driving: Side) -> Vec<Lane> {
    let length = street.length();
    if length < 0.5 {
        return Vec::new();
    }
    let rules = LaneRules::of(street.class);
    let reach = TURNS.0.min(TURNS.1 * length);
    // Relative to the street's first point, so that every frame gives the same points.
    let start = street.line[0];
    let line: Vec<DVec2> = street.line.iter().map(|p| *p - start).collect();
    let middle = cut_line(&line, reach, length - reach);
    let directions: &[bool] = match street.traffic(driving) {
        Traffic::Both => &[true, false],
        Traffic::Along => &[true],
        Traffic::Against => &[false],
    };
    let mut lanes = Vec::with_capacity(directions.len() * rules.each_way);
    for &along in directions {
        for index in 0..rules.each_way {
            let off = match directions {
                [_] => (index as f64 + 0.5) * rules.width - rules.full_width(1) / 2.0,
                _ => (index as f64 + 0.5) * rules.width + rules.median / 2.0,
            };
            // To the left of the street's line.
            let left = if along == (driving == Side::Left) { off } else { -off };
            let mut line: Vec<DVec2> = offset_line(&middle, left).into_iter().map(|p| start + quantize(p)).collect();
            line.dedup();
            if !along {
                line.reverse();
            }
            let id = LaneId::of(street.id, along, index);
            let (width, speed) = (rules.width, rules.speed);
            lanes.push(Lane { id, street: street.id, class: street.class, along, index, width, speed, line });
        }
    }
    lanes
}
