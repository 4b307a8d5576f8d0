//! OpenStreetMap XML (`.osm`): files of openstreetmap.org, JOSM, osmium, and answers of Overpass, `out geom` included.

use crate::layer::FileError;
use crate::map::elements::{Elements, Member, MemberLine, Outline, Way};
use crate::map::error::MapError;
use crate::map::limits::MapLimits;
use crate::map::report::LeftOut;
use crate::map::tags::{ElementKind, building};
use crate::space::Bounds;
use glam::DVec2;
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use std::borrow::Cow;

/// Reads the text of a file; `classes` are the values of `highway` that count.
pub(super) fn read(file: &str, text: &str, classes: &[String], limits: MapLimits) -> Result<Elements, MapError> {
    let mut reader = quick_xml::Reader::from_str(text);
    let mut collector = XmlCollector { elements: Elements::new(file, limits), classes, open: None };
    let mut depth = 0usize;
    let mut is_osm = false;
    loop {
        let at = reader.buffer_position() as usize;
        let wrong = |at: usize, reason: &str| FileError::at(file, text.as_bytes(), at, reason);
        let event = reader
            .read_event()
            .map_err(|e| wrong(reader.error_position() as usize, &format!("no readable OSM XML: {e}")))?;
        match &event {
            Event::Start(e) | Event::Empty(e) => {
                if depth == 0 && e.name().as_ref() != "osm" {
                    return Err(wrong(at, "no readable OSM XML: the outermost element is not <osm>").into());
                }
                is_osm = true;
                collector.start(e, depth).map_err(|e| e.at(|reason| wrong(at, reason)))?;
                if matches!(event, Event::Start(_)) {
                    depth += 1;
                } else if depth == 1 {
                    collector.end()?;
                }
            }
            Event::End(_) => {
                depth = depth.saturating_sub(1);
                if depth == 1 {
                    collector.end()?;
                }
            }
            Event::Text(remark) if depth == 2 && collector.open.is_none() && remark.contains("error") => {
                // The one text in such files is the <remark> of Overpass.
                return Err(wrong(at, &format!("the query has failed: {}", remark.trim())).into());
            }
            Event::Eof if depth > 0 => {
                return Err(wrong(text.len(), "no readable OSM XML: the file ends before </osm>").into());
            }
            Event::Eof if !is_osm => return Err(wrong(0, "no readable OSM XML: there is no <osm>").into()),
            Event::Eof => return Ok(collector.elements),
            _ => {}
        }
    }
}

/// Why an element cannot be read.
enum ElementError {
    Element(&'static str),
    Map(MapError),
}

impl ElementError {
    fn at(self, place: impl Fn(&str) -> FileError) -> MapError {
        match self {
            Self::Element(reason) => place(reason).into(),
            Self::Map(error) => error,
        }
    }
}

impl From<MapError> for ElementError {
    fn from(error: MapError) -> Self {
        Self::Map(error)
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Way,
    Relation,
}

/// A way or relation whose end has not been read yet.
struct OpenElement {
    kind: Kind,
    id: i64,
    is_deleted: bool,
    tags: Vec<(String, String)>,
    nodes: Vec<i64>,
    members: Vec<Member>,
}

struct XmlCollector<'a> {
    elements: Elements,
    classes: &'a [String],
    open: Option<OpenElement>,
}

impl XmlCollector<'_> {
    fn start(&mut self, element: &BytesStart<'_>, depth: usize) -> Result<(), ElementError> {
        match (depth, element.name().as_ref()) {
            (1, "node") => self.node(element),
            (1, "way") => self.open(element, Kind::Way),
            (1, "relation") => self.open(element, Kind::Relation),
            (1, "bounds") => {
                let corner = |lon: &str, lat: &str| place(element, [lon, lat]);
                if let (Ok(Some(min)), Ok(Some(max))) = (corner("minlon", "minlat"), corner("maxlon", "maxlat")) {
                    self.elements.stated = Some(Bounds::new(min, max));
                }
                Ok(())
            }
            (2, "nd") => self.point(element),
            (2, "member") => self.member(element),
            (3, "nd") => self.member_point(element),
            (2, "tag") => {
                if let (Some(open), Some(key), Some(value)) =
                    (&mut self.open, attribute(element, "k"), attribute(element, "v"))
                {
                    open.tags.push((key, value));
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn node(&mut self, element: &BytesStart<'_>) -> Result<(), ElementError> {
        const NEEDED: &str = "a node needs the numbers id, lon and lat";
        let id = id(element, "id").ok_or(ElementError::Element(NEEDED))?;
        let at = place(element, ["lon", "lat"]).map_err(|()| ElementError::Element(NEEDED))?;
        if is_deleted(element) {
            self.elements.leave_out(LeftOut::Deleted);
            return Ok(self.elements.put_node(id, None)?);
        }
        if at.is_none() {
            self.elements.leave_out(LeftOut::NoCoordinates);
        }
        Ok(self.elements.put_node(id, at)?)
    }

    fn open(&mut self, element: &BytesStart<'_>, kind: Kind) -> Result<(), ElementError> {
        let id = id(element, "id").ok_or(ElementError::Element("a way or relation needs the number id"))?;
        let is_deleted = is_deleted(element);
        let (tags, nodes, members) = Default::default();
        self.open = Some(OpenElement { kind, id, is_deleted, tags, nodes, members });
        Ok(())
    }

    /// A point of a way; `out geom` of Overpass writes its place there.
    fn point(&mut self, element: &BytesStart<'_>) -> Result<(), ElementError> {
        let Some(open) = &mut self.open else { return Ok(()) };
        let node = inner_node(&mut self.elements, element)?;
        open.nodes.push(node.ok_or(ElementError::Element("a way's node needs the number ref"))?);
        Ok(())
    }

    fn member(&mut self, element: &BytesStart<'_>) -> Result<(), ElementError> {
        let Some(open) = &mut self.open else { return Ok(()) };
        if attribute(element, "type").is_some_and(|t| t == "way") {
            let way = id(element, "ref").ok_or(ElementError::Element("a relation's member needs the number ref"))?;
            let is_inner = attribute(element, "role").is_some_and(|r| r == "inner");
            open.members.push(Member { is_inner, line: MemberLine::Way(way) });
        }
        Ok(())
    }

    /// A point of a relation's member, written there by `out geom` of Overpass.
    fn member_point(&mut self, element: &BytesStart<'_>) -> Result<(), ElementError> {
        let Some(member) = self.open.as_mut().and_then(|o| o.members.last_mut()) else { return Ok(()) };
        let Some(node) = inner_node(&mut self.elements, element)? else { return Ok(()) };
        match &mut member.line {
            MemberLine::Nodes(nodes) => nodes.push(node),
            line => *line = MemberLine::Nodes(vec![node]),
        }
        Ok(())
    }

    /// What the way or relation that ends here is.
    fn end(&mut self) -> Result<(), MapError> {
        let Some(OpenElement { kind, id, is_deleted, tags, nodes, members }) = self.open.take() else { return Ok(()) };
        let value = |key: &str| tags.iter().find(|(k, _)| k == key).map(|(_, v)| Cow::Borrowed(v.as_str()));
        if is_deleted {
            self.elements.leave_out(LeftOut::Deleted);
        }
        if kind == Kind::Way {
            let way = (!is_deleted).then(|| Way { nodes, kind: ElementKind::of(&value, self.classes) });
            return self.elements.put_way(id, way);
        }
        let outline = building(&value).filter(|_| value("type").is_some_and(|t| t == "multipolygon"));
        if outline.is_none() && !is_deleted {
            self.elements.leave_out(LeftOut::OtherKind);
        }
        self.elements.put_outline(id, outline.filter(|_| !is_deleted).map(|tags| Outline { tags, members }))
    }
}

/// The node of an `nd`: that of its `ref`, or else that at its place.
fn inner_node(elements: &mut Elements, element: &BytesStart<'_>) -> Result<Option<i64>, ElementError> {
    let at = place(element, ["lon", "lat"])
        .map_err(|()| ElementError::Element("lon and lat of a point need to be numbers"))?;
    match (id(element, "ref"), at) {
        (Some(id), Some(at)) => {
            elements.put_node(id, Some(at))?;
            Ok(Some(id))
        }
        (None, Some(at)) => Ok(Some(elements.node_at(at))),
        (id, None) => Ok(id),
    }
}

/// The place in two attributes: `None` where one is missing, an error where one is no number.
fn place(element: &BytesStart<'_>, keys: [&str; 2]) -> Result<Option<DVec2>, ()> {
    let number = |key: &str| match attribute(element, key) {
        Some(value) => value.trim().parse::<f64>().ok().filter(|n| n.is_finite()).map(Some).ok_or(()),
        None => Ok(None),
    };
    let [x, y] = keys.map(number);
    Ok(x?.zip(y?).map(DVec2::from))
}

fn id(element: &BytesStart<'_>, key: &str) -> Option<i64> {
    attribute(element, key)?.trim().parse().ok()
}

/// Whether JOSM has deleted an element, or a history file says that it is not there any more.
fn is_deleted(element: &BytesStart<'_>) -> bool {
    let is = |key: &str, value: &str| attribute(element, key).is_some_and(|v| v == value);
    is("action", "delete") || is("visible", "false")
}

fn attribute(element: &BytesStart<'_>, key: &str) -> Option<String> {
    let attribute = element.attributes().flatten().find(|a| a.key.as_ref() == key)?;
    Some(attribute.normalized_value(XmlVersion::Implicit1_0).ok()?.into_owned())
}
