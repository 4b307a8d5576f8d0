//! Rules of local streets.

use super::mix::Blend;
use crate::layer::{RangeError, Ranged, Walk};
use serde::{Deserialize, Serialize};

/// Least length that a style may allow, in metres: junctions at both ends need the room.
const SHORTEST: f64 = 16.0;

/// Least angle that a style may allow, in degrees: kerbs of two streets need the room.
const SHARPEST: f64 = 40.0;

/// Greatest number of streets at a junction, whatever the least angle.
const MOST_STREETS: u32 = 8;

/// Number of streets that fit at a junction if two are at least so many degrees apart.
fn most_streets(min_angle_deg: f64) -> u32 {
    (360.0 / min_angle_deg + 1e-9) as u32
}

/// Local streets: growth where no patch fits (Teng 2017, Fig. 3), and the constraints of section 3.3, which hold for all that is
/// built in a main cell: growth, patches, patterns, repair and fairing. Lengths in metres, angles in degrees.
///
/// Ports and pinned patches stand where they stand, and a patch keeps the short streets and narrow gaps that are drawn in it.
/// What breaks a rule for that reason is counted ([`CellStreets::exceptions`](crate::streets::CellStreets::exceptions)).
///
/// A street that is long for its cell meets nothing there. So a cell takes what it has room for, as a share of its width (four
/// times its area, divided by its perimeter: the side of a square): `length` up to 0.33, with `deviation` and `snap_radius` in
/// proportion, `block_width` up to 0.3, and a `min_length` of more than 30 and a `clearance` of more than 20 up to 0.12. Where
/// streets are shorter or nearer than the style says for that reason, this is counted, too.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LocalRules {
    /// Length of a street segment: 20 to 500.
    pub length: f64,
    /// Greatest deviation from that length, 0 to half of it. Where that leaves no room, a street is shorter.
    pub deviation: f64,
    /// Least length of a street, from junction to junction or dead end: 16 to `length`.
    pub min_length: f64,
    /// Least and greatest number of streets that growth aims at in a junction, 2 to 8; no junction has more than the greatest, which
    /// must fit in a full turn at the least angle. Up to four streets go straight on and leave square, more are spread evenly. Repair
    /// divides blocks that are much larger than those that junctions of so many streets make. With at most 2 there are no
    /// junctions: streets only lead from port to port, or nowhere.
    pub degree: (u32, u32),
    /// Least angle between two streets at a junction, and between two parts of a street at a bend: 40 to 90. (Kerbs need
    /// the room.)
    pub min_angle_deg: f64,
    /// Greatest deviation from the direction in which a street would leave: 0 to 45.
    pub angle_deviation_deg: f64,
    /// Distance within which an end snaps to a junction or street: 5 to 200.
    pub snap_radius: f64,
    /// Least distance between streets that do not meet, main streets included: 15 to 200. Where both lead to one place, they
    /// come nearer: to a third of the way from one to the other, if not more.
    pub clearance: f64,
    /// Distance that growth and patches keep from streets that they do not meet, 0 to 200, if it is greater than `clearance`: the
    /// width of blocks. Repair keeps `clearance` alone.
    pub block_width: f64,
    /// Share (0 to 1) of the dead ends that stay as they grew. Repair leads the others on to another street, and removes the short
    /// ones that find none.
    pub dead_ends: f64,
    /// Greatest distance from a sharp bend at which the curve begins that takes its place; bends stay sharp at 0.
    pub rounding: f64,
}

impl Default for LocalRules {
    fn default() -> Self {
        Self {
            length: 75.0,
            deviation: 15.0,
            min_length: 30.0,
            degree: (3, 4),
            min_angle_deg: 55.0,
            angle_deviation_deg: 6.0,
            snap_radius: 25.0,
            clearance: 20.0,
            block_width: 45.0,
            dead_ends: 0.0,
            rounding: 0.0,
        }
    }
}

impl Ranged for LocalRules {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self {
            length,
            deviation,
            min_length,
            degree,
            min_angle_deg,
            angle_deviation_deg,
            snap_radius,
            clearance,
            block_width,
            dead_ends,
            rounding,
        } = self;
        walk.number("length", length, 20.0, 500.0)?;
        walk.number("deviation", deviation, 0.0, *length / 2.0)?;
        walk.number("min_length", min_length, SHORTEST, *length)?;
        walk.number("min_angle_deg", min_angle_deg, SHARPEST, 90.0)?;
        let most = most_streets(*min_angle_deg).min(MOST_STREETS);
        walk.pair("degree", degree, 2.0, most.into()).map_err(|e| RangeError {
            allowed: format!(
                "{}: a full turn has room for at most {most} streets at `min_angle_deg` {min_angle_deg}",
                e.allowed
            ),
            ..e
        })?;
        walk.number("angle_deviation_deg", angle_deviation_deg, 0.0, 45.0)?;
        walk.number("snap_radius", snap_radius, 5.0, 200.0)?;
        walk.number("clearance", clearance, 15.0, 200.0)?;
        walk.number("block_width", block_width, 0.0, 200.0)?;
        walk.number("dead_ends", dead_ends, 0.0, 1.0)?;
        walk.number("rounding", rounding, 0.0, 100.0)
    }
}

impl LocalRules {
    /// The rules between `a` and `b`. Where the least angle between leaves no room for the number of streets between, junctions
    /// have as many as fit.
    pub(super) fn mix(a: &Self, b: &Self, blend: &mut Blend) -> Self {
        let min_angle_deg = blend.number(a.min_angle_deg, b.min_angle_deg);
        let (least, most) = blend.counts(a.degree, b.degree);
        let fit = most_streets(min_angle_deg);
        Self {
            length: blend.number(a.length, b.length),
            deviation: blend.number(a.deviation, b.deviation),
            min_length: blend.number(a.min_length, b.min_length),
            degree: (least.min(fit), most.min(fit)),
            min_angle_deg,
            angle_deviation_deg: blend.number(a.angle_deviation_deg, b.angle_deviation_deg),
            snap_radius: blend.number(a.snap_radius, b.snap_radius),
            clearance: blend.number(a.clearance, b.clearance),
            block_width: blend.number(a.block_width, b.block_width),
            dead_ends: blend.number(a.dead_ends, b.dead_ends),
            rounding: blend.number(a.rounding, b.rounding),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::style::Style;

    fn error(local: &str) -> String {
        Style::from_ron("s.ron", &format!("(\n  local: (\n    {local},\n  ),\n)")).expect_err(local).to_string()
    }

    #[test]
    fn rules_that_cannot_hold_are_refused_where_they_stand() {
        let crowded = error("min_angle_deg: 70, degree: (3, 6)");
        assert!(
            crowded.contains(":3:") && crowded.contains("at most 5 streets") && crowded.contains("70"),
            "{crowded}"
        );
        assert!(error("min_angle_deg: 25").contains("40 to 90"));
        assert!(error("min_length: 12").contains("16 to"));
        assert!(error("clearance: 9").contains("15 to 200"));
        for good in ["min_angle_deg: 90, degree: (4, 4)", "min_angle_deg: 45, degree: (2, 8)", "degree: (2, 2)"] {
            assert!(Style::from_ron("s.ron", &format!("(local: ({good}))")).is_ok(), "{good}");
        }
    }
}
