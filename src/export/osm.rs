//! OpenStreetMap XML, with the plan laid at latitude 0, longitude 0, or where it lies on the globe.

use crate::export::{ExportError, Plan, geojson::size_name, traffic::AreaTraffic};
use crate::network::StreetClass;
use crate::parcel::BlockUse;
use crate::space::{Geographic, stable_hash};
use glam::DVec2;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};
use std::collections::BTreeMap;
use std::io::Write;

/// Metres per degree, along the equator and along the meridian, on the sphere that web maps use (radius 6378137 m).
pub const METRES_PER_DEGREE: f64 = 111_319.490_793_273_57;

/// What else to write besides streets and roads, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Buildings, parks and names of settlements. Readers that take every way for a street (OSMnx does) want them left out.
    pub everything: bool,
    /// The plan point (in metres) that is laid at latitude 0, longitude 0; the middle of the square if not given. Squares of one
    /// world that are written with the same origin fit together, and what they share has the same ids. Without it ids are
    /// counted from 1. Not for a plan that has a projection.
    pub origin: Option<DVec2>,
}

/// Writes a plan with a point of it at latitude 0, longitude 0, or with [`Plan::projection`] where it lies on the globe.
///
/// Each street is a way with `highway`; its points are nodes, and a junction is one node that all its streets share. Ways have
/// `lanes` and `maxspeed`, and where it matters `oneway`, `junction=roundabout` and `turn:lanes`.
pub fn write(plan: &Plan<'_>, options: Options, out: &mut dyn Write) -> Result<(), ExportError> {
    let area = plan.area;
    let place = match plan.projection {
        Some(projection) => Place::Projected(area.origin.plan(), projection),
        None => {
            // The squares' middles may be off the whole metres that positions are local to.
            let zero = options.origin.unwrap_or_else(|| area.bounds.centre());
            Place::AtZero(area.origin.plan() - zero)
        }
    };
    let writer = Writer::new_with_indent(out, b' ', 1);
    let mut file = File { writer, place, nodes: 0, ways: 0, has_ids: options.origin.is_some() };
    file.writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let mut root = BytesStart::new("osm");
    root.push_attribute(("version", "0.6"));
    root.push_attribute(("generator", "bevy_sprawl"));
    file.writer.write_event(Event::Start(root))?;
    let [low, high] = [area.bounds.min, area.bounds.max].map(|p| file.place.degrees(area.origin.to_local(p)));
    let sides = [("minlat", low.y), ("minlon", low.x), ("maxlat", high.y), ("maxlon", high.x)];
    file.empty("bounds", &sides.map(|(name, at)| (name, degrees(at))))?;

    // The format requires all nodes before the first way.
    let mut junctions = BTreeMap::new();
    for junction in &area.junctions {
        junctions.insert(junction.item.id, file.node(&[junction.item.id.0], junction.item.at, &[])?);
    }
    let traffic = AreaTraffic::new(area, plan.driving);
    let mut ways: Vec<(u64, Vec<u64>, Tags)> = Vec::new();
    for street in area.streets.iter().map(|s| &s.item.street) {
        let (Some(&from), Some(&to)) = (junctions.get(&street.from), junctions.get(&street.to)) else {
            return Err(ExportError::Format(format!("street {:016x} ends at no junction", street.id.0)));
        };
        let mut nodes = vec![from];
        for (i, point) in street.line.iter().enumerate().take(street.line.len() - 1).skip(1) {
            nodes.push(file.node(&[street.id.0, i as u64], *point, &[])?);
        }
        nodes.push(to);
        if traffic.is_reversed(street) {
            nodes.reverse();
        }
        let mut tags: Tags = vec![("highway", highway(street.class).into())];
        tags.extend(traffic.tags(street));
        if street.bridge {
            tags.push(("bridge", "yes".into()));
        }
        if street.tunnel {
            tags.push(("tunnel", "yes".into()));
        }
        if street.level != 0 {
            tags.push(("layer", street.level.to_string()));
        }
        ways.push((street.id.0, nodes, tags));
    }
    if options.everything {
        for settlement in &area.settlements {
            let tags = [("place", size_name(settlement.size).to_owned()), ("name", settlement.name.clone())];
            file.node(&[settlement.id.0], area.origin.to_local(settlement.centre.plan()), &tags)?;
        }
        for block in area.blocks.iter().filter(|b| b.item.land_use == BlockUse::Park) {
            let nodes = file.ring(block.item.id, &block.item.polygon)?;
            ways.push((block.item.id, nodes, vec![("leisure", "park".into())]));
        }
        for building in &area.footprints {
            let levels = ("building:levels", building.item.storeys.to_string());
            let height = ("height", format!("{:.1}", building.item.height));
            let nodes = file.ring(building.item.id, &building.item.polygon)?;
            ways.push((building.item.id, nodes, vec![("building", "yes".into()), levels, height]));
        }
    }
    for (id, nodes, tags) in &ways {
        file.way(*id, nodes, tags)?;
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
        // A link road counts as the better of the roads that it joins.
        StreetClass::Ramp => "primary_link",
        StreetClass::Major | StreetClass::Arterial => "secondary",
        StreetClass::Minor | StreetClass::Main => "tertiary",
        StreetClass::Local => "residential",
    }
}

/// Degrees to a tenth of a millimetre.
fn degrees(x: f64) -> String {
    format!("{x:.9}")
}

/// Where positions local to the area's origin lie in degrees.
enum Place {
    /// Around latitude 0, longitude 0: what is to be added to a position.
    AtZero(DVec2),
    /// The origin, and the projection of plan points.
    Projected(DVec2, Geographic),
}

impl Place {
    fn degrees(&self, local: DVec2) -> DVec2 {
        match self {
            Self::AtZero(shift) => (local + *shift) / METRES_PER_DEGREE,
            Self::Projected(origin, projection) => projection.to_degrees(*origin + local),
        }
    }
}

struct File<'a> {
    writer: Writer<&'a mut dyn Write>,
    place: Place,
    nodes: u64,
    ways: u64,
    /// Whether ids are made from those of the world, and not counted.
    has_ids: bool,
}

/// An id of the format, 62 bits and above 0, from the words that name a thing of the world.
fn id_of(words: &[u64]) -> u64 {
    stable_hash(words) >> 2 | 1
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

    /// A node that these words name in the world; gives its id.
    fn node(&mut self, words: &[u64], local: DVec2, tags: &[(&str, String)]) -> std::io::Result<u64> {
        self.nodes += 1;
        let number = if self.has_ids { id_of(words) } else { self.nodes };
        let at = self.place.degrees(local);
        // Editors refuse elements without a version.
        let id = [("id", number.to_string()), ("version", "1".into())];
        let place = [("lat", degrees(at.y)), ("lon", degrees(at.x))];
        self.element("node", &[id, place].concat(), &[], tags)?;
        Ok(number)
    }

    fn ring(&mut self, id: u64, polygon: &[DVec2]) -> std::io::Result<Vec<u64>> {
        let points = polygon.iter().enumerate();
        let mut nodes = points.map(|(i, p)| self.node(&[id, i as u64], *p, &[])).collect::<Result<Vec<_>, _>>()?;
        nodes.extend(nodes.first().copied());
        Ok(nodes)
    }

    fn way(&mut self, id: u64, nodes: &[u64], tags: &[(&str, String)]) -> std::io::Result<()> {
        self.ways += 1;
        let number = if self.has_ids { id_of(&[id]) } else { self.ways };
        self.element("way", &[("id", number.to_string()), ("version", "1".into())], nodes, tags)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::clipped;
    use crate::network::Side;
    use crate::space::Bounds;
    use crate::testing;

    fn text(options: Options) -> String {
        of(&testing::area(DVec2::new(700.25, -300.0)).plan(), options)
    }

    fn of(plan: &Plan<'_>, options: Options) -> String {
        let mut file = Vec::new();
        write(plan, options, &mut file).unwrap();
        String::from_utf8(file).unwrap()
    }

    /// The nodes of a file: id, latitude and longitude as they are written.
    fn nodes(file: &str) -> BTreeMap<String, [String; 2]> {
        let value = |line: &str, key: &str| {
            let rest = &line[line.find(&format!(" {key}=\"")).unwrap() + key.len() + 3..];
            rest[..rest.find('"').unwrap()].to_owned()
        };
        let lines = file.lines().filter(|l| l.contains("<node "));
        lines.map(|l| (value(l, "id"), [value(l, "lat"), value(l, "lon")])).collect()
    }

    #[test]
    fn squares_with_one_origin_fit_together() {
        let town = testing::area(DVec2::ZERO);
        let origin = Some(DVec2::new(-1000.0, 250.5));
        let squares = [DVec2::new(-200.0, 0.0), DVec2::new(200.0, 0.0)].map(|middle| {
            let mut area = town.area.clone();
            area.bounds = Bounds::square(middle, 400.0);
            let area = clipped(&area);
            nodes(&of(&Plan { area: &area, ..town.plan() }, Options { origin, ..Options::default() }))
        });
        let [west, east] = &squares;
        let shared: Vec<_> = west.iter().filter(|(id, _)| east.contains_key(*id)).collect();
        // Five streets and the bridge cross the border; a street runs along it.
        assert!(shared.len() >= 6, "{}", shared.len());
        for (id, place) in &shared {
            let apart =
                place.iter().zip(&east[*id]).map(|(a, b)| a.parse::<f64>().unwrap() - b.parse::<f64>().unwrap());
            assert!(apart.map(f64::abs).fold(0.0, f64::max) < 1e-8, "{place:?} {:?}", east[*id]);
        }
        let whole = nodes(&of(&town.plan(), Options { origin, ..Options::default() }));
        for (id, place) in west.iter().filter(|(id, _)| whole.contains_key(*id)) {
            assert_eq!(place, &whole[id]);
        }
    }

    #[test]
    fn a_plan_on_the_globe_lies_there() {
        let town = testing::area(DVec2::new(400.0, -300.0));
        let projection = Geographic::around(DVec2::new(9.0, 47.0)).unwrap();
        let file = of(&Plan { projection: Some(projection), ..town.plan() }, Options::default());
        let at = |[lat, lon]: &[String; 2]| projection.to_plan(DVec2::new(lon.parse().unwrap(), lat.parse().unwrap()));
        let found: Vec<DVec2> = nodes(&file).values().map(at).collect();
        for junction in &town.area.junctions {
            let place = town.area.origin.to_plan(junction.item.at);
            assert!(found.iter().any(|p| p.distance(place) < 1e-3), "{place}");
        }
        assert!(file.contains("minlat=\"46.99") && file.contains("maxlon=\"9.01"), "{}", &file[..300]);
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
    fn a_ramp_is_a_one_way_link() {
        let mut town = testing::area(DVec2::ZERO);
        assert!(!of(&town.plan(), Options::default()).contains("oneway"));
        town.area.streets[0].item.street.class = StreetClass::Ramp;
        let file = of(&town.plan(), Options::default());
        assert_eq!(file.matches("k=\"highway\" v=\"primary_link\"").count(), 1);
        assert_eq!(file.matches("k=\"oneway\" v=\"yes\"").count(), 1);
        let left = of(&Plan { driving: Side::Left, ..town.plan() }, Options::default());
        let ends = |file: &str| {
            let way = file.split("<way ").find(|way| way.contains("primary_link")).unwrap();
            let refs: Vec<&str> = way.split("ref=\"").skip(1).map(|r| &r[..r.find('"').unwrap()]).collect();
            [refs[0].to_owned(), refs[refs.len() - 1].to_owned()]
        };
        let [from, to] = ends(&file);
        assert_eq!(ends(&left), [to, from], "traffic on the left drives the other way");
    }

    #[test]
    fn roundabouts_lanes_and_turns_are_tagged() {
        let mut town = testing::area(DVec2::ZERO);
        for street in town.area.streets.iter_mut().map(|s| &mut s.item.street).filter(|s| s.class == StreetClass::Main)
        {
            street.class = StreetClass::Arterial;
        }
        town.area.streets[0].item.street.island = Some(Side::Left);
        let file = of(&town.plan(), Options::default());
        assert_eq!(file.matches("k=\"junction\" v=\"roundabout\"").count(), 1);
        assert!(file.contains("k=\"lanes\" v=\"4\"") && file.contains("k=\"maxspeed\" v=\"50\""), "{file}");
        assert!(file.contains("k=\"turn:lanes:forward\" v=\"left;through|through;right\""), "{file}");
    }

    #[test]
    fn everything_has_buildings_and_escaped_names() {
        let file = text(Options { everything: true, ..Options::default() });
        assert!(file.contains("building:levels") && file.contains("Sample &amp; Sons"), "{file}");
    }
}
