//! OpenStreetMap XML, with the plan laid at latitude 0, longitude 0.

use crate::export::{ExportError, Plan, geojson::size_name};
use crate::network::StreetClass;
use crate::parcel::BlockUse;
use glam::DVec2;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};
use std::collections::BTreeMap;
use std::io::Write;

/// Metres per degree, along the equator and along the meridian, on the sphere that web maps use (radius 6378137 m).
pub const METRES_PER_DEGREE: f64 = 111_319.490_793_273_57;

/// What else to write besides streets and roads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Buildings, parks and names of settlements. Readers that take every way for a street (OSMnx does) want them left out.
    pub everything: bool,
}

/// Writes a plan with the middle of its square at latitude 0, longitude 0.
///
/// Each street is a way with `highway`; its points are nodes, and a junction is one node that all its streets share.
pub fn write(plan: &Plan<'_>, options: Options, out: &mut dyn Write) -> Result<(), ExportError> {
    let area = plan.area;
    // The middle of the square may lie between whole metres, unlike the origin that positions are local to.
    let shift = area.origin.plan() - area.bounds.centre();
    let mut file = File { writer: Writer::new_with_indent(out, b' ', 1), shift, nodes: 0 };
    file.writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let mut root = BytesStart::new("osm");
    root.push_attribute(("version", "0.6"));
    root.push_attribute(("generator", "bevy_sprawl"));
    file.writer.write_event(Event::Start(root))?;
    let half = (area.bounds.size() / 2.0 / METRES_PER_DEGREE).to_array().map(degrees);
    let sides = [("minlat", format!("-{}", half[1])), ("minlon", format!("-{}", half[0]))];
    let sides = sides.into_iter().chain([("maxlat", half[1].clone()), ("maxlon", half[0].clone())]);
    file.empty("bounds", &sides.collect::<Vec<_>>())?;

    // The format requires all nodes before the first way.
    let mut junctions = BTreeMap::new();
    for junction in &area.junctions {
        junctions.insert(junction.item.id, file.node(junction.item.at, &[])?);
    }
    let mut ways: Vec<(Vec<u64>, Tags)> = Vec::new();
    for street in area.streets.iter().map(|s| &s.item.street) {
        let (Some(&from), Some(&to)) = (junctions.get(&street.from), junctions.get(&street.to)) else {
            return Err(ExportError::Format(format!("street {:016x} ends at no junction", street.id.0)));
        };
        let mut nodes = vec![from];
        for point in &street.line[1..street.line.len() - 1] {
            nodes.push(file.node(*point, &[])?);
        }
        nodes.push(to);
        let mut tags: Tags = vec![("highway", highway(street.class).into())];
        if street.bridge {
            tags.push(("bridge", "yes".into()));
        }
        if street.tunnel {
            tags.push(("tunnel", "yes".into()));
        }
        if street.level != 0 {
            tags.push(("layer", street.level.to_string()));
        }
        ways.push((nodes, tags));
    }
    if options.everything {
        for settlement in &area.settlements {
            let tags = [("place", size_name(settlement.size).to_owned()), ("name", settlement.name.clone())];
            file.node(area.origin.to_local(settlement.centre.plan()), &tags)?;
        }
        for block in area.blocks.iter().filter(|b| b.item.land_use == BlockUse::Park) {
            ways.push((file.ring(&block.item.polygon)?, vec![("leisure", "park".into())]));
        }
        for building in &area.footprints {
            let levels = ("building:levels", building.item.storeys.to_string());
            let height = ("height", format!("{:.1}", building.item.height));
            ways.push((file.ring(&building.item.polygon)?, vec![("building", "yes".into()), levels, height]));
        }
    }
    for (i, (nodes, tags)) in ways.iter().enumerate() {
        file.way(i as u64 + 1, nodes, tags)?;
    }
    file.writer.write_event(Event::End(BytesEnd::new("osm")))?;
    file.writer.get_mut().write_all(b"\n")?;
    Ok(())
}

type Tags = Vec<(&'static str, String)>;

/// Value of `highway` for a class.
fn highway(class: StreetClass) -> &'static str {
    match class {
        // A highway is one two-way carriageway here, which `motorway` and `trunk` would not be.
        StreetClass::Highway => "primary",
        StreetClass::Major | StreetClass::Arterial => "secondary",
        StreetClass::Minor | StreetClass::Main => "tertiary",
        StreetClass::Local => "residential",
    }
}

/// Degrees to a tenth of a millimetre.
fn degrees(x: f64) -> String {
    format!("{x:.9}")
}

struct File<'a> {
    writer: Writer<&'a mut dyn Write>,
    shift: DVec2,
    nodes: u64,
}

impl File<'_> {
    fn empty(&mut self, name: &str, attributes: &[(&str, String)]) -> std::io::Result<()> {
        let attributes = attributes.iter().map(|(k, v)| (*k, v.as_str()));
        self.writer.write_event(Event::Empty(BytesStart::new(name).with_attributes(attributes)))
    }

    fn element(
        &mut self,
        name: &str,
        attributes: &[(&str, String)],
        refs: &[u64],
        tags: &[(&str, String)],
    ) -> std::io::Result<()> {
        if refs.is_empty() && tags.is_empty() {
            return self.empty(name, attributes);
        }
        let start = BytesStart::new(name).with_attributes(attributes.iter().map(|(k, v)| (*k, v.as_str())));
        self.writer.write_event(Event::Start(start))?;
        for node in refs {
            self.empty("nd", &[("ref", node.to_string())])?;
        }
        for (key, value) in tags {
            self.empty("tag", &[("k", (*key).to_owned()), ("v", value.clone())])?;
        }
        self.writer.write_event(Event::End(BytesEnd::new(name)))
    }

    fn node(&mut self, local: DVec2, tags: &[(&str, String)]) -> std::io::Result<u64> {
        self.nodes += 1;
        let at = (local + self.shift) / METRES_PER_DEGREE;
        // Editors refuse elements without a version.
        let id = [("id", self.nodes.to_string()), ("version", "1".into())];
        let place = [("lat", degrees(at.y)), ("lon", degrees(at.x))];
        self.element("node", &[id, place].concat(), &[], tags)?;
        Ok(self.nodes)
    }

    fn ring(&mut self, polygon: &[DVec2]) -> std::io::Result<Vec<u64>> {
        let mut nodes = polygon.iter().map(|p| self.node(*p, &[])).collect::<Result<Vec<_>, _>>()?;
        nodes.extend(nodes.first().copied());
        Ok(nodes)
    }

    fn way(&mut self, id: u64, nodes: &[u64], tags: &[(&str, String)]) -> std::io::Result<()> {
        self.element("way", &[("id", id.to_string()), ("version", "1".into())], nodes, tags)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    fn text(options: Options) -> String {
        let mut file = Vec::new();
        write(&testing::area(DVec2::new(700.25, -300.0)).plan(), options, &mut file).unwrap();
        String::from_utf8(file).unwrap()
    }

    #[test]
    fn a_junction_is_one_node_and_only_streets_are_ways() {
        let town = testing::area(DVec2::ZERO);
        let file = text(Options::default());
        let streets = town.area.streets.len();
        let inner: usize = town.area.streets.iter().map(|s| s.item.street.line.len() - 2).sum();
        assert_eq!(file.matches("<way ").count(), streets);
        assert_eq!(file.matches("k=\"highway\"").count(), streets);
        assert_eq!(file.matches("<node ").count(), town.area.junctions.len() + inner);
        assert!(file.contains("k=\"bridge\" v=\"yes\"") && file.contains("k=\"layer\" v=\"1\""));
        assert!(!file.contains("building"));
    }

    #[test]
    fn everything_has_buildings_and_escaped_names() {
        let file = text(Options { everything: true });
        assert!(file.contains("building:levels") && file.contains("Sample &amp; Sons"), "{file}");
    }
}
