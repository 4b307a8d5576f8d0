//! Road masks: pictures with roads and buildings in a colour each, as Paduraru 2022 (section 3) makes them of aerial images.
//!
//! Roads are thinned to lines of one pixel (`skeletonize`). The paper's circle tells intersections, ends and turning points apart, and
//! lines of pixels between them become streets, whose widths are measured in the picture. Buildings become the polygons around
//! their pixels. The first row of the picture is the northernmost.

mod circle;
mod lines;
mod outlines;
mod picture;
#[cfg(test)]
mod tests;

use crate::map::elements::{Elements, Member, MemberLine, Outline, Way};
use crate::map::error::MapError;
use crate::map::limits::MapLimits;
use crate::map::report::LeftOut;
use crate::map::tags::{BuildingTags, ElementKind, StreetTags};
use crate::network::StreetClass;
use crate::space::Bounds;
use glam::DVec2;
use lines::{RoadLine, lines};
use outlines::outlines;
use picture::Picture;

/// Buildings smaller than this are specks, in square metres.
const LEAST_BUILDING: f64 = 4.0;

/// Streets this many times as wide as those in the middle are main streets.
const WIDE: f64 = 1.6;

/// How a road mask is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaskOptions {
    /// Edge of a pixel in metres, 0.01 to 100. A mask cannot be read without.
    pub metres_per_pixel: Option<f64>,
    /// Plan metres of the middle of the picture.
    pub middle: DVec2,
    /// Colour of roads: red, green, blue.
    pub roads: [u8; 3],
    /// Colour of buildings: red, green, blue.
    pub buildings: [u8; 3],
    /// Radius in pixels of the circle that is drawn around each pixel of a thinned road, 2 to 50. Where three roads or more
    /// leave the circle lies an intersection, where one does an end.
    pub circle: f64,
    /// Angle in degrees at which a road bends so sharply that its bend is a point of its own, 0 to 180.
    pub turn_deg: f64,
    /// Distance in pixels between intersections, up to which they are one, 0 to 200.
    pub apart: f64,
}

impl Default for MaskOptions {
    /// The plan's origin in the middle, blue roads, red buildings, and the circle of Paduraru 2022. Intersections are one up to 12 pixels; the paper discards the
    /// second up to 30, and with it the streets between.
    fn default() -> Self {
        let (roads, buildings) = ([0, 0, 255], [255, 0, 0]);
        let middle = DVec2::ZERO;
        Self { metres_per_pixel: None, middle, roads, buildings, circle: 5.0, turn_deg: 90.0, apart: 12.0 }
    }
}

impl MaskOptions {
    /// The edge of a pixel, if all values lie in their ranges.
    fn check(&self, file: &str) -> Result<f64, MapError> {
        let Some(edge) = self.metres_per_pixel else { return Err(MapError::NeedsScale { file: file.into() }) };
        let values = [
            ("metres_per_pixel", edge, 0.01, 100.0),
            ("circle", self.circle, 2.0, 50.0),
            ("turn_deg", self.turn_deg, 0.0, 180.0),
            ("apart", self.apart, 0.0, 200.0),
        ];
        match values.into_iter().find(|(_, value, low, high)| !(low..=high).contains(&value)) {
            Some((option, value, low, high)) => {
                Err(MapError::MaskOption { file: file.into(), option, value, allowed: (low, high) })
            }
            None => Ok(edge),
        }
    }
}

/// Reads the content of a PNG file, whose coordinates are plan metres.
pub(super) fn read(file: &str, content: &[u8], options: &MaskOptions, limits: MapLimits) -> Result<Elements, MapError> {
    let edge = options.check(file)?;
    let picture = Picture::read(file, content, options)?;
    let size = DVec2::new(picture.width as f64, picture.height as f64);
    // From pixels, rows downwards, to metres.
    let plan = |p: DVec2| options.middle + DVec2::new(p.x - size.x / 2.0, size.y / 2.0 - p.y) * edge;
    let mut elements = Elements::new(file, limits);
    elements.stated = Some(Bounds::of([plan(DVec2::ZERO), plan(size)]));
    let lines = lines(file, &picture, options)?;
    let usual = usual_width(&lines.roads);
    for (id, road) in lines.roads.iter().enumerate() {
        let nodes = road.line.iter().map(|p| elements.node_at(plan(*p))).collect();
        let class = if road.width > WIDE * usual { StreetClass::Main } else { StreetClass::Local };
        let kind = ElementKind::Street(StreetTags::drawn(class, road.width * edge));
        elements.put_way(id as i64, Some(Way { nodes, kind }))?;
    }
    (0..lines.specks).for_each(|_| elements.leave_out(LeftOut::Speck));
    for (id, rings) in outlines(&picture).into_iter().enumerate() {
        if rings.pixels as f64 * edge * edge < LEAST_BUILDING {
            elements.leave_out(LeftOut::Speck);
            continue;
        }
        let member = |(i, ring): (usize, Vec<DVec2>)| {
            let mut nodes: Vec<i64> = ring.iter().map(|p| elements.node_at(plan(*p))).collect();
            nodes.extend(nodes.first().copied());
            Member { is_inner: i > 0, line: MemberLine::Nodes(nodes) }
        };
        let members = rings.rings.into_iter().enumerate().map(member).collect();
        elements.put_outline(id as i64, Some(Outline { tags: BuildingTags::default(), members }))?;
    }
    Ok(elements)
}

/// The width that half of the roads, by length, do not reach, in pixels.
fn usual_width(roads: &[RoadLine]) -> f64 {
    let length = |road: &RoadLine| crate::space::line_length(&road.line);
    let mut widths: Vec<(f64, f64)> = roads.iter().map(|road| (road.width, length(road))).collect();
    widths.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = widths.iter().map(|w| w.1).sum::<f64>() / 2.0;
    let mut sum = 0.0;
    let usual = widths.iter().find(|w| {
        sum += w.1;
        sum >= half
    });
    usual.map_or(f64::INFINITY, |w| w.0)
}
