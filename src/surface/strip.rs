//! The surface of a street along a stretch of its centre line.

use crate::network::StreetClass;
use crate::surface::offset::offset_line;
use glam::DVec2;

/// Edges of a street's surface along a stretch of its centre line, in local metres, with one point for each point of the line.
/// Left and right are seen along the line.
pub struct Strip {
    /// Left and right edge of the carriageway.
    pub carriageway: [Vec<DVec2>; 2],
    /// Left and right outer edge of the pavements, or of the carriageway where there are no pavements.
    pub outer: [Vec<DVec2>; 2],
}

impl Strip {
    /// The surface of a street of a class along `line`; `None` for fewer than two points.
    pub fn new(line: &[DVec2], class: StreetClass) -> Option<Self> {
        if line.len() < 2 {
            return None;
        }
        let edges = |by: f64| [offset_line(line, by), offset_line(line, -by)];
        let (carriageway, half_width) = (class.carriageway() / 2.0, class.half_width());
        Some(Self { carriageway: edges(carriageway), outer: edges(half_width) })
    }
}
