//! What tags say of streets and buildings: one set of rules for every reader.
//!
//! The rules are those of the OpenStreetMap wiki for `highway`, `oneway`, `junction`, `lanes`, `width`, `bridge`, `tunnel`,
//! `layer`, `building`, `height` and `building:levels`. Values in lists (`a;b`) count in their order.

use crate::map::report::LeftOut;
use crate::network::StreetClass;
use std::borrow::Cow;

/// Values of `highway` that are streets of towns, each with its `_link`.
pub const TOWN_STREETS: [&str; 10] = [
    "motorway",
    "trunk",
    "primary",
    "secondary",
    "tertiary",
    "unclassified",
    "residential",
    "living_street",
    "pedestrian",
    "road",
];

/// Width of a lane in metres where lanes are given and the width is not.
const LANE: f64 = 3.0;
/// Widths of carriageways in metres that are believed.
const WIDTHS: std::ops::RangeInclusive<f64> = 1.0..=100.0;
/// Heights of buildings in metres that are believed.
const HEIGHTS: std::ops::RangeInclusive<f64> = 0.5..=1_000.0;
/// Height of a storey in metres.
const STOREY: f64 = 3.0;
/// Longest name that is kept, in bytes; longer ones are no names.
const LONGEST_NAME: usize = 1_024;

/// The value of a tag, where an element has it.
pub(super) type Tag<'a> = &'a dyn Fn(&str) -> Option<Cow<'a, str>>;

/// In which directions traffic may run along a street.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OneWay {
    /// In both directions.
    #[default]
    No,
    /// In the direction of the street's points.
    Forward,
    /// Against the direction of the street's points (`oneway=-1`).
    Backward,
}

/// What tags say of a street.
#[derive(Clone, Debug, PartialEq)]
pub struct StreetTags {
    /// The value of `highway` (of a list, the first that counts), with its `_link`.
    pub highway: String,
    /// Class as a street of a town; see [`StreetTags::road_class`] for roads between settlements.
    pub class: StreetClass,
    /// Width of the carriageway in metres: as tagged, or else by the lanes, or else as is usual for the class.
    pub width: f64,
    /// Lanes in both directions together, where they are tagged.
    pub lanes: Option<u8>,
    /// Whether the street is one-way: as tagged, or else as roundabouts and motorways are.
    pub one_way: OneWay,
    /// Whether it is carried over something.
    pub bridge: bool,
    /// Whether it runs under something.
    pub tunnel: bool,
    /// Height level, 0 on the ground: `layer`, or else 1 for bridges and -1 for tunnels.
    pub level: i8,
    /// Whether it is part of a roundabout.
    pub roundabout: bool,
    /// Its name.
    pub name: Option<String>,
}

impl StreetTags {
    /// A street of which no more is known than its class and the width of its carriageway in metres.
    pub(super) fn drawn(class: StreetClass, width: f64) -> Self {
        Self {
            highway: class.name().to_owned(),
            class,
            width,
            lanes: None,
            one_way: OneWay::No,
            bridge: false,
            tunnel: false,
            level: 0,
            roundabout: false,
            name: None,
        }
    }

    /// The class as a road between settlements: highway, major or minor.
    pub fn road_class(&self) -> StreetClass {
        match without_link(&self.highway) {
            "motorway" | "trunk" => StreetClass::Highway,
            "primary" | "secondary" => StreetClass::Major,
            _ if self.class.is_link() => self.class,
            _ => StreetClass::Minor,
        }
    }
}

/// What tags say of a building.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildingTags {
    /// Height in metres, where it is tagged.
    pub height: Option<f64>,
    /// Storeys: as tagged, or else by the height, where that is.
    pub storeys: Option<u32>,
}

/// What an element is by its tags.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ElementKind {
    Street(StreetTags),
    Building(BuildingTags),
    /// Neither of both, or a street that was not asked for.
    Other(LeftOut),
}

impl ElementKind {
    /// What an element with some tags is, where the values `classes` of `highway` are streets.
    pub fn of(tag: Tag<'_>, classes: &[String]) -> Self {
        match street(tag, classes) {
            Ok(street) => Self::Street(street),
            Err(reason) => building(tag).map_or(Self::Other(reason), Self::Building),
        }
    }
}

/// What an element with some tags is as a building, if it is one.
pub(super) fn building(tag: Tag<'_>) -> Option<BuildingTags> {
    let is_own = tag("kind").is_some_and(|kind| kind == "building");
    if !is_own && !is_set(tag, "building") {
        return None;
    }
    let number = |key: &str| tag(key).and_then(|v| values(&v).find_map(metres));
    let height = number("height").or_else(|| number("building:height")).filter(|h| HEIGHTS.contains(h));
    let levels = number("building:levels").or_else(|| number("levels")).or_else(|| number("storeys"));
    let levels = levels.or_else(|| Some(height? / STOREY)).filter(|l| (0.0..=500.0).contains(l));
    Some(BuildingTags { height, storeys: levels.map(|l| (l.round() as u32).max(1)) })
}

fn street(tag: Tag<'_>, classes: &[String]) -> Result<StreetTags, LeftOut> {
    let (highway, class) = highway(tag, classes)?;
    if tag("area").is_some_and(|v| v == "yes") {
        return Err(LeftOut::StreetArea);
    }
    let lanes = tag("lanes").and_then(|v| values(&v).find_map(|v| v.parse::<f64>().ok()));
    let lanes = lanes.filter(|l| (1.0..=20.0).contains(l)).map(|l| l.round() as u8);
    let width = tag("width").and_then(|v| values(&v).find_map(metres)).filter(|w| WIDTHS.contains(w));
    let (bridge, tunnel) = (is_set(tag, "bridge"), is_set(tag, "tunnel"));
    // In OpenStreetMap `level` is the storey of a building.
    let key = if tag("highway").is_some() { "layer" } else { "level" };
    let layer = tag(key).and_then(|v| v.trim().parse::<i8>().ok());
    let roundabout = tag("junction").is_some_and(|v| v == "roundabout" || v == "circular");
    let name = tag("name").map(|v| values(&v).next().unwrap_or_default().to_owned());
    Ok(StreetTags {
        one_way: one_way(tag, roundabout || without_link(&highway) == "motorway"),
        highway,
        class,
        width: width.or_else(|| Some(f64::from(lanes?) * LANE)).unwrap_or_else(|| class.carriageway()),
        lanes,
        bridge,
        tunnel,
        level: layer.unwrap_or(i8::from(bridge) - i8::from(tunnel)),
        roundabout,
        name: name.filter(|n| !n.is_empty() && n.len() <= LONGEST_NAME),
    })
}

/// The value of `highway` that counts, and its class in a town. This crate's own files have `kind` and `class` instead.
fn highway(tag: Tag<'_>, classes: &[String]) -> Result<(String, StreetClass), LeftOut> {
    if let Some(highway) = tag("highway") {
        let counts = |v: &&str| classes.iter().any(|c| c == without_link(v));
        let highway = values(&highway).find(counts).ok_or(LeftOut::OtherClass)?;
        return Ok((highway.to_owned(), town_class(highway)));
    }
    let is_own = tag("kind").is_some_and(|kind| kind == "street" || kind == "road");
    let class = tag("class").filter(|_| is_own).ok_or(LeftOut::OtherKind)?;
    let known = StreetClass::ALL.into_iter().find(|c| c.name() == class);
    known.map(|c| (class.into_owned(), c)).ok_or(LeftOut::OtherClass)
}

/// Class of a street of a town.
fn town_class(highway: &str) -> StreetClass {
    match without_link(highway) {
        "motorway" | "trunk" => StreetClass::Highway,
        "primary" | "secondary" => StreetClass::Arterial,
        "tertiary" => StreetClass::Main,
        _ => StreetClass::Local,
    }
}

fn without_link(highway: &str) -> &str {
    highway.strip_suffix("_link").unwrap_or(highway)
}

fn one_way(tag: Tag<'_>, usual: bool) -> OneWay {
    match tag("oneway").map(|v| v.to_ascii_lowercase()).as_deref() {
        Some("yes" | "true" | "1") => OneWay::Forward,
        Some("-1" | "reverse") => OneWay::Backward,
        None if usual => OneWay::Forward,
        _ => OneWay::No,
    }
}

/// Whether an element has a tag with a value other than `no`.
fn is_set(tag: Tag<'_>, key: &str) -> bool {
    tag(key).is_some_and(|v| !matches!(v.trim().to_ascii_lowercase().as_str(), "" | "no" | "false" | "0"))
}

/// The values of a list.
fn values(list: &str) -> impl Iterator<Item = &str> {
    list.split(';').map(str::trim).filter(|v| !v.is_empty())
}

/// A length in metres: `7`, `7.5 m`, `24 ft`, `24'`, `24'6"`.
fn metres(value: &str) -> Option<f64> {
    const FOOT: f64 = 0.3048;
    let number = |v: &str| v.trim().parse::<f64>().ok().filter(|n| n.is_finite());
    if let Some((feet, inches)) = value.split_once('\'') {
        let inches = inches.trim().trim_end_matches(['"', '\'']);
        let inches = if inches.is_empty() { 0.0 } else { number(inches)? };
        return Some((number(feet)? + inches / 12.0) * FOOT);
    }
    match value.strip_suffix("ft").or_else(|| value.strip_suffix("feet")) {
        Some(feet) => number(feet).map(|n| n * FOOT),
        None => number(value.strip_suffix('m').unwrap_or(value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What an element with tags `key=value key=value` is.
    fn kind(tags: &str) -> ElementKind {
        let tags: Vec<(&str, &str)> = tags.split(' ').filter_map(|t| t.split_once('=')).collect();
        let tag = |key: &str| tags.iter().find(|(k, _)| *k == key).map(|(_, v)| Cow::Borrowed(*v));
        ElementKind::of(&tag, &TOWN_STREETS.map(String::from))
    }

    fn street(tags: &str) -> StreetTags {
        match kind(tags) {
            ElementKind::Street(street) => street,
            other => panic!("{tags}: {other:?}"),
        }
    }

    #[test]
    fn classes_of_towns_and_of_roads_between_them() {
        use StreetClass::{Arterial, Highway, Local, Main, Major, Minor};
        for (highway, class, road) in [
            ("trunk_link", Highway, Highway),
            ("secondary", Arterial, Major),
            ("tertiary_link", Main, Minor),
            ("residential", Local, Minor),
            ("track;living_street", Local, Minor),
        ] {
            let street = street(&format!("highway={highway}"));
            assert_eq!((street.class, street.road_class()), (class, road), "{highway}");
            assert_eq!(street.width, class.carriageway());
        }
        assert_eq!(kind("highway=footway"), ElementKind::Other(LeftOut::OtherClass));
        assert_eq!(kind("waterway=river"), ElementKind::Other(LeftOut::OtherKind));
        assert_eq!(kind("highway=pedestrian area=yes"), ElementKind::Other(LeftOut::StreetArea));
        assert_eq!(kind("building=no"), ElementKind::Other(LeftOut::OtherKind));
    }

    #[test]
    fn files_of_this_crate_have_kinds_and_classes() {
        let own = street("kind=road class=major bridge=true level=2");
        assert_eq!((own.class, own.road_class(), own.level), (StreetClass::Major, StreetClass::Major, 2));
        assert_eq!(street("kind=street class=main").class, StreetClass::Main);
        assert_eq!(kind("kind=junction class=main"), ElementKind::Other(LeftOut::OtherKind));
        let ElementKind::Building(own) = kind("kind=building storeys=4") else { panic!() };
        assert_eq!(own.storeys, Some(4));
    }

    #[test]
    fn widths_lanes_and_levels() {
        for (tags, width) in [
            ("width=7.5m", 7.5),
            ("width=20'6\"", 20.5 * 0.3048),
            ("width=20ft lanes=9", 20.0 * 0.3048),
            ("lanes=2;3", 6.0),
            ("width=narrow lanes=x", 6.0),
            ("width=9e9", 6.0),
        ] {
            assert_eq!(street(&format!("highway=residential {tags}")).width, width, "{tags}");
        }
        for (tags, level) in
            [("bridge=viaduct", 1), ("tunnel=yes", -1), ("bridge=yes layer=3", 3), ("layer=low", 0), ("bridge=no", 0)]
        {
            assert_eq!(street(&format!("highway=residential {tags}")).level, level, "{tags}");
        }
    }

    #[test]
    fn one_ways_as_tagged_and_as_usual() {
        for (tags, one_way) in [
            ("highway=primary oneway=yes", OneWay::Forward),
            ("highway=primary oneway=-1", OneWay::Backward),
            ("highway=primary oneway=True", OneWay::Forward),
            ("highway=motorway_link", OneWay::Forward),
            ("highway=motorway oneway=no", OneWay::No),
            ("highway=residential junction=roundabout", OneWay::Forward),
            ("highway=residential oneway=reversible", OneWay::No),
        ] {
            let street = street(tags);
            assert_eq!((street.one_way, street.roundabout), (one_way, tags.contains("roundabout")), "{tags}");
        }
    }

    #[test]
    fn heights_and_storeys_of_buildings() {
        for (tags, height, storeys) in [
            ("building=yes", None, None),
            ("building=house building:levels=2.5 height=9", Some(9.0), Some(3)),
            ("building=yes height=12.4m", Some(12.4), Some(4)),
            ("building=yes building:levels=0", None, Some(1)),
            ("building=yes height=-3 building:levels=many", None, None),
        ] {
            assert_eq!(kind(tags), ElementKind::Building(BuildingTags { height, storeys }), "{tags}");
        }
    }
}
