//! From the pixels of a mask to what a file of streets and buildings holds.

use super::lines::{RoadLine, lines};
use super::options::MaskOptions;
use super::outlines::outlines;
use super::picture::Picture;
use crate::map::elements::{Elements, Member, MemberLine, Outline, Way};
use crate::map::error::MapError;
use crate::map::limits::MapLimits;
use crate::map::report::LeftOut;
use crate::map::tags::{BuildingTags, ElementKind, StreetTags};
use crate::network::StreetClass;
use crate::space::Bounds;
use glam::DVec2;

/// Buildings smaller than this are specks, in square metres.
const LEAST_BUILDING: f64 = 4.0;

/// Streets this many times as wide as those in the middle are main streets.
const WIDE: f64 = 1.6;

/// Reads the content of a PNG file, whose coordinates are plan metres.
pub(in crate::map) fn read(
    file: &str,
    content: &[u8],
    options: &MaskOptions,
    limits: MapLimits,
) -> Result<Elements, MapError> {
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
