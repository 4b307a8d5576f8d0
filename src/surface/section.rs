//! Cross-sections of streets by class: widths, corners, greatest grade and crests.

use crate::network::StreetClass;

/// Height of a kerb's face, in metres: pavements lie so much above the carriageway.
pub const KERB_HEIGHT: f64 = 0.12;

/// Width of the verge along a carriageway without pavements, in metres. It counts as part of the street's width.
const VERGE: f64 = 0.6;

/// Across a street: the carriageway, then on each side a pavement behind a kerb, or a level verge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossSection {
    /// Half the width of the carriageway, in metres.
    pub carriageway: f64,
    /// Half of the full width, in metres.
    pub outer: f64,
    /// Whether the sides are pavements behind kerbs rather than verges.
    pub paved: bool,
    /// Radius of the kerb at the corner of a junction, in metres.
    pub corner_radius: f64,
    /// Greatest grade, rise over run.
    pub grade: f64,
    /// Half the length over which a change of grade is rounded, in metres.
    pub rounding: f64,
}

impl CrossSection {
    /// The cross-section of a class.
    pub fn of(class: StreetClass) -> Self {
        let paved = class.pavement() > 0.0;
        let (corner_radius, grade, rounding) = match class {
            StreetClass::Highway => (9.0, 0.05, 30.0),
            StreetClass::Major => (8.0, 0.06, 20.0),
            StreetClass::Minor => (6.0, 0.08, 12.0),
            StreetClass::Ramp => (6.0, 0.07, 12.0),
            StreetClass::Arterial => (6.0, 0.07, 12.0),
            StreetClass::Main => (5.0, 0.09, 10.0),
            StreetClass::Local => (3.5, 0.13, 6.0),
        };
        let carriageway = class.carriageway() / 2.0 - if paved { 0.0 } else { VERGE };
        Self { carriageway, outer: class.half_width(), paved, corner_radius, grade, rounding }
    }
}
