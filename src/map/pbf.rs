//! OpenStreetMap PBF (`.osm.pbf`), as the OpenStreetMap wiki describes the format ("PBF Format").
//!
//! The file is walked three times, for outlines, for the ways that are used, and for the nodes of these, so that memory
//! follows what is used, not what a block unpacks to.

use crate::layer::FileError;
use crate::map::elements::{Elements, Member, MemberLine, Outline, Way};
use crate::map::error::MapError;
use crate::map::limits::MapLimits;
use crate::map::report::LeftOut;
use crate::map::tags::{ElementKind, building};
use crate::map::wire::{Fields, Malformed, Packed, Value, signed};
use crate::space::Bounds;
use flate2::read::ZlibDecoder;
use glam::DVec2;
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::Read;

/// Largest header of a block, in bytes, as the format has it.
const LARGEST_HEADER: usize = 64 << 10;
/// Largest block once it is unpacked, in bytes, as the format has it.
const LARGEST_BLOCK: u64 = 32 << 20;
/// What a file may require of its readers.
const FEATURES: [&str; 3] = ["OsmSchema-V0.6", "DenseNodes", "HistoricalInformation"];

/// Reads the content of a file; `classes` are the values of `highway` that count.
pub(super) fn read(file: &str, content: &[u8], classes: &[String], limits: MapLimits) -> Result<Elements, MapError> {
    let mut collector = PbfCollector { elements: Elements::new(file, limits), classes };
    let walk = |each: &mut dyn FnMut(&Block<'_>) -> Result<(), WalkError>| walk(file, content, limits, each);
    let stated = walk(&mut |block| block.groups().try_for_each(|g| collector.outlines(block, g?)))?;
    let members = collector.elements.member_ways(|_| true);
    walk(&mut |block| block.groups().try_for_each(|g| collector.ways(block, g?, &members)))?;
    let mut used: Vec<i64> = collector.elements.ways.values().flat_map(|w| &w.nodes).copied().collect();
    used.sort_unstable();
    used.dedup();
    walk(&mut |block| block.groups().try_for_each(|g| collector.nodes(block, g?, &used)))?;
    collector.elements.stated = stated;
    Ok(collector.elements)
}

/// Why a walk stops.
enum WalkError {
    Malformed,
    Map(MapError),
}

impl From<Malformed> for WalkError {
    fn from(_: Malformed) -> Self {
        Self::Malformed
    }
}

impl From<MapError> for WalkError {
    fn from(error: MapError) -> Self {
        Self::Map(error)
    }
}

/// Calls `each` with every block of data and returns the box that the file's header states.
fn walk(
    file: &str,
    content: &[u8],
    limits: MapLimits,
    each: &mut dyn FnMut(&Block<'_>) -> Result<(), WalkError>,
) -> Result<Option<Bounds>, MapError> {
    let (mut at, mut unpacked, mut stated) = (0, 0u64, None);
    let mut is_osm = false;
    while at < content.len() {
        let wrong = |reason: &str| {
            MapError::File(FileError::unreadable(file, format!("no readable OSM PBF: byte {at}: {reason}")))
        };
        let (kind, blob, length) = blob(&content[at..]).map_err(&wrong)?;
        let block = unpack(blob).map_err(&wrong)?;
        unpacked += block.len() as u64;
        if unpacked > limits.unpacked_bytes {
            let limit = limits.unpacked_bytes;
            return Err(MapError::TooLarge { file: file.to_owned(), what: "unpacked bytes", limit });
        }
        match kind {
            b"OSMHeader" => {
                is_osm = true;
                stated = header(&block).map_err(&wrong)?;
            }
            b"OSMData" => {
                let block = Block::new(&block).map_err(|Malformed| wrong("a broken block"))?;
                each(&block).map_err(|error| match error {
                    WalkError::Malformed => wrong("a broken block"),
                    WalkError::Map(error) => error,
                })?;
            }
            _ => {}
        }
        at += length;
    }
    if is_osm { Ok(stated) } else { Err(FileError::unreadable(file, "no readable OSM PBF: it has no header").into()) }
}

/// Kind and content of the blob at the start of `bytes`, and how many bytes it takes with its header.
fn blob(bytes: &[u8]) -> Result<(&[u8], Fields<'_>, usize), &'static str> {
    const CUT: &str = "the file ends within a block; was the download broken off?";
    let (length, rest) = bytes.split_first_chunk::<4>().ok_or(CUT)?;
    let length = u32::from_be_bytes(*length) as usize;
    if length > LARGEST_HEADER {
        return Err("no block starts here");
    }
    let (header, rest) = rest.split_at_checked(length).ok_or(CUT)?;
    let header = Fields(header);
    let size = header.number(3).and_then(|n| usize::try_from(n).ok()).ok_or("a block without size")?;
    if size as u64 > LARGEST_BLOCK {
        return Err("a block of more than 32 MiB");
    }
    let (blob, _) = rest.split_at_checked(size).ok_or(CUT)?;
    Ok((header.bytes(1), Fields(blob), 4 + length + size))
}

/// The content of a blob.
fn unpack(blob: Fields<'_>) -> Result<Cow<'_, [u8]>, &'static str> {
    for field in blob {
        let (number, value) = field.map_err(|Malformed| "a broken block")?;
        match (number, value) {
            (1, Value::Bytes(raw)) => return Ok(Cow::Borrowed(raw)),
            (3, Value::Bytes(packed)) => {
                let mut out = Vec::new();
                let mut decoder = ZlibDecoder::new(packed).take(LARGEST_BLOCK + 1);
                decoder.read_to_end(&mut out).map_err(|_| "a block cannot be unpacked")?;
                let fits = out.len() as u64 <= LARGEST_BLOCK;
                return if fits { Ok(Cow::Owned(out)) } else { Err("a block unpacks to more than 32 MiB") };
            }
            (4..=7, Value::Bytes(_)) => return Err("a block is compressed by another method than zlib"),
            _ => {}
        }
    }
    Err("a block without content")
}

/// The box that a header states, if the file needs nothing that is not read.
fn header(block: &[u8]) -> Result<Option<Bounds>, &'static str> {
    let fields = Fields(block);
    for field in fields.clone() {
        let (number, value) = field.map_err(|Malformed| "a broken header")?;
        let feature = value.bytes().filter(|_| number == 4);
        if feature.is_some_and(|f| !FEATURES.iter().any(|known| known.as_bytes() == f)) {
            return Err("the file needs a feature of readers that is not known here");
        }
    }
    let corners = Fields(fields.bytes(1));
    let degrees = |number: u64| corners.number(number).map(|n| signed(n) as f64 / 1e9);
    let [left, right, top, bottom] = [1, 2, 3, 4].map(degrees);
    let corner = |x: Option<f64>, y: Option<f64>| Some(DVec2::new(x?, y?));
    Ok(corner(left, bottom).zip(corner(right, top)).map(|(min, max)| Bounds::new(min, max)))
}

/// A block of data.
struct Block<'a> {
    content: &'a [u8],
    words: Vec<&'a [u8]>,
    /// Nanodegrees of a step of coordinates.
    granularity: i64,
    /// Nanodegrees of longitude and latitude 0 of coordinates.
    offset: [i64; 2],
}

impl<'a> Block<'a> {
    fn new(content: &'a [u8]) -> Result<Self, Malformed> {
        let fields = Fields(content);
        let words: Result<Vec<&[u8]>, Malformed> =
            Fields(fields.bytes(1)).map(|f| f.map(|(_, word)| word.bytes().unwrap_or_default())).collect();
        let number = |n: u64, usual: i64| fields.number(n).map_or(usual, |n| n as i64);
        Ok(Self { content, words: words?, granularity: number(17, 100), offset: [number(20, 0), number(19, 0)] })
    }

    /// The groups of elements.
    fn groups(&self) -> impl Iterator<Item = Result<&'a [u8], Malformed>> + use<'a> {
        Fields(self.content).filter_map(|field| match field {
            Ok((2, Value::Bytes(group))) => Some(Ok(group)),
            Ok(_) => None,
            Err(malformed) => Some(Err(malformed)),
        })
    }

    fn word(&self, index: u64) -> Option<&'a str> {
        std::str::from_utf8(self.words.get(usize::try_from(index).ok()?)?).ok()
    }

    /// The value of a tag of an element.
    fn tag(&self, element: &Fields<'a>, key: &str) -> Option<Cow<'a, str>> {
        let mut pairs = Packed(element.bytes(2)).zip(Packed(element.bytes(3)));
        pairs.find(|(k, _)| self.word(*k) == Some(key)).and_then(|(_, v)| self.word(v)).map(Cow::Borrowed)
    }

    fn place(&self, [lon, lat]: [i64; 2]) -> DVec2 {
        let degrees = |n: i64, offset: i64| offset.wrapping_add(n.wrapping_mul(self.granularity)) as f64 / 1e9;
        DVec2::new(degrees(lon, self.offset[0]), degrees(lat, self.offset[1]))
    }
}

/// Whether an element of a history file is no longer there. Not for dense nodes.
fn is_deleted(element: &Fields<'_>) -> bool {
    Fields(element.bytes(4)).number(6) == Some(0)
}

/// The elements of a kind in a group.
fn each<'a>(group: &'a [u8], kind: u64) -> impl Iterator<Item = Result<Fields<'a>, Malformed>> {
    Fields(group).filter_map(move |field| match field {
        Ok((number, Value::Bytes(element))) => (number == kind).then_some(Ok(Fields(element))),
        Ok(_) => None,
        Err(malformed) => Some(Err(malformed)),
    })
}

struct PbfCollector<'a> {
    elements: Elements,
    classes: &'a [String],
}

impl PbfCollector<'_> {
    fn outlines(&mut self, block: &Block<'_>, group: &[u8]) -> Result<(), WalkError> {
        for relation in each(group, 4) {
            let relation = relation?;
            let tag = |key: &str| block.tag(&relation, key);
            let id = relation.number(1).unwrap_or_default() as i64;
            if is_deleted(&relation) {
                self.elements.leave_out(LeftOut::Deleted);
                self.elements.put_outline(id, None)?;
                continue;
            }
            let is_outline = tag("type").is_some_and(|t| t == "multipolygon");
            let Some(tags) = building(&tag).filter(|_| is_outline) else {
                self.elements.leave_out(LeftOut::OtherKind);
                continue;
            };
            let ways = Packed(relation.bytes(9)).sums().zip(Packed(relation.bytes(10))).zip(Packed(relation.bytes(8)));
            let ways = ways.filter(|((_, kind), _)| *kind == 1);
            let member = |((id, _), role): ((i64, u64), u64)| Member {
                is_inner: block.word(role) == Some("inner"),
                line: MemberLine::Way(id),
            };
            self.elements.put_outline(id, Some(Outline { tags, members: ways.map(member).collect() }))?;
        }
        Ok(())
    }

    fn ways(&mut self, block: &Block<'_>, group: &[u8], members: &BTreeSet<i64>) -> Result<(), WalkError> {
        for way in each(group, 3) {
            let way = way?;
            let id = way.number(1).unwrap_or_default() as i64;
            if is_deleted(&way) {
                self.elements.leave_out(LeftOut::Deleted);
                self.elements.put_way(id, None)?;
                continue;
            }
            match ElementKind::of(&|key: &str| block.tag(&way, key), self.classes) {
                ElementKind::Other(reason) if !members.contains(&id) => self.elements.leave_out(reason),
                kind => {
                    let nodes: Vec<i64> = Packed(way.bytes(8)).sums().collect();
                    // Some files give the places of nodes with their ways ("LocationsOnWays").
                    let places = Packed(way.bytes(10)).sums().zip(Packed(way.bytes(9)).sums());
                    for (node, (lon, lat)) in nodes.iter().zip(places) {
                        self.elements.put_node(*node, Some(block.place([lon, lat])))?;
                    }
                    self.elements.put_way(id, Some(Way { nodes, kind }))?;
                }
            }
        }
        Ok(())
    }

    fn nodes(&mut self, block: &Block<'_>, group: &[u8], used: &[i64]) -> Result<(), WalkError> {
        for node in each(group, 1) {
            let node = node?;
            let signed = |number: u64| node.number(number).map(signed);
            let Some(id) = signed(1) else { continue };
            let at = signed(9).zip(signed(8)).map(|(lon, lat)| block.place([lon, lat]));
            if at.is_none() {
                self.elements.leave_out(LeftOut::NoCoordinates);
            }
            self.node(id, at, is_deleted(&node), used)?;
        }
        for dense in each(group, 2) {
            let dense = dense?;
            let sums = |number: u64| Packed(dense.bytes(number)).sums();
            let visible = Packed(Fields(dense.bytes(5)).bytes(6)).map(Some).chain(std::iter::repeat(None));
            for (((id, lat), lon), visible) in sums(1).zip(sums(8)).zip(sums(9)).zip(visible) {
                self.node(id, Some(block.place([lon, lat])), visible == Some(0), used)?;
            }
        }
        Ok(())
    }

    fn node(&mut self, id: i64, at: Option<DVec2>, is_deleted: bool, used: &[i64]) -> Result<(), MapError> {
        if is_deleted {
            self.elements.leave_out(LeftOut::Deleted);
        }
        if used.binary_search(&id).is_ok() { self.elements.put_node(id, at.filter(|_| !is_deleted)) } else { Ok(()) }
    }
}
