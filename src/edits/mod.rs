//! The user's wishes for settlements, roads and patches, as a RON file has them.
//!
//! All of them are local. The lattices of settlements and the proximity rule are found as without edits; then settlements
//! are taken away and set down, roads are led another way, kept or left out. Nothing beyond the reach that an edit states
//! can tell that it is there.
//!
//! A wrong file is refused as a whole, at its line and column. An edit that the file has right and the world cannot
//! fulfil, such as a settlement in a lake, is rejected alone: see [`RejectedEdit`].

mod checks;
mod painted;

pub use checks::STRENGTHS;
pub use painted::{InfluenceMap, Painted};

use crate::layer::{FileError, error_at, errors_at_elements, from_ron};
use crate::network::{JunctionId, SizeClass, Street, StreetClass, StreetId, crossings};
use checks::{number, place, points, road_classes};
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Radii that settlements may have, in metres.
pub const SETTLEMENT_RADII: (f64, f64) = (120.0, 5_000.0);
/// Bytes that a name may have.
const LONGEST_NAME: usize = 200;
/// Points that a line may have.
const MOST_POINTS: usize = 10_000;
/// Points that a road may be led through.
const MOST_VIA: usize = 32;

/// The user's wishes. Places are plan metres, x east and y north, at most 10,000,000 km from 0.
///
/// ```
/// use bevy_sprawl::edits::Edits;
///
/// let edits = Edits::from_ron("edits.ron", r#"(
///     settlements: [
///         Pin(at: (1200, -300), size: Town, name: "Aldwick"),
///         Ban(at: (8000, 8000), radius: 1500),
///     ],
///     influences: [
///         (shape: Area([(0, 0), (4000, 0), (4000, 3000)]), radius: 600, strength: 4),
///     ],
///     way_points: [
///         (at: (5200, 900), class: Major),
///     ],
///     roads: [
///         Keep(from: (1200, -300), to: (9000, 400)),
///     ],
///     patches: [
///         (patch: "small square", at: (1400, -150), heading_deg: 30),
///     ],
/// )"#)?;
/// assert_eq!(edits.settlements.len(), 2);
/// # Ok::<(), bevy_sprawl::layer::FileError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(default, deny_unknown_fields)]
pub struct Edits {
    /// Settlements pinned, moved and banned.
    pub settlements: Vec<SettlementEdit>,
    /// What draws roads near or drives them off.
    pub influences: Vec<Influence>,
    /// The same, painted.
    pub influence_maps: Vec<InfluenceMap>,
    /// Nodes of the network of roads.
    pub way_points: Vec<WayPoint>,
    /// Roads kept, led and banned.
    pub roads: Vec<RoadEdit>,
    /// Patches that stand in towns.
    pub patches: Vec<PatchEdit>,
}

/// A wish for settlements. Those of a lattice that are too near a pinned or moved one are not there; none comes in their
/// place. So an edit reaches as far as settlements must keep apart: `clearance` times both radii and `gap`, or twice what
/// the larger keeps for itself; outlines, and the towns in them, change where a neighbour did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(deny_unknown_fields)]
pub enum SettlementEdit {
    /// A settlement of its own. Its id is a hash of its place.
    Pin {
        /// Centre, rounded to whole metres; on land, and none too steep or too near water for a village.
        at: DVec2,
        /// Size class.
        size: SizeClass,
        /// Name; if not given, one drawn for the place.
        #[serde(default)]
        name: Option<String>,
        /// Name of a style; if not given, one drawn for the place as the settings weigh them.
        #[serde(default)]
        style: Option<String>,
        /// Radius in metres, 120 to 5,000; if not given, the middle of the range that the settings have for the size.
        #[serde(default)]
        radius: Option<f64>,
    },
    /// The settlement of a lattice whose circle holds `from` stands at `to` instead, with the same id, name, style and
    /// radius. Of two, that with the nearer centre.
    Move {
        /// A point of it.
        from: DVec2,
        /// The new centre, as that of a pin.
        to: DVec2,
    },
    /// No settlement of a lattice has its centre here. Pinned and moved ones may.
    Ban {
        /// Centre of a circle.
        at: DVec2,
        /// Its radius in metres, 0 to 100,000.
        radius: f64,
    },
}

/// Something that draws roads near or drives them off: a term of their cost (Galin 2011, section 4.1). Per metre of road it
/// adds `strength` (1 - (r/R)^2)^2, with R the radius and r the distance from the shape, where that is below R. Whatever
/// draws a road, it costs at least a fifth of its length.
///
/// It changes the ways between settlements whose ellipse, that of the greatest detour, meets the shape and its radius, which
/// pairs of theirs and of their neighbours the proximity rule keeps, and roads of lower classes that ran along or beside
/// these. Where a road becomes too dear for the greatest detour of its class, it is not built.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(deny_unknown_fields)]
pub struct Influence {
    /// Where.
    pub shape: Shape,
    /// Distance in metres at which it ends: 10 to 20,000.
    pub radius: f64,
    /// Extra cost per metre of road: -10 to 100. Negative draws near, positive drives off.
    pub strength: f64,
    /// Classes of roads that it works on: highway, major, minor; none for all.
    #[serde(default)]
    pub classes: Vec<StreetClass>,
}

/// The shape of an influence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
pub enum Shape {
    /// One point.
    Point(DVec2),
    /// A line of 2 to 10,000 points.
    Curve(Vec<DVec2>),
    /// What a border of 3 to 10,000 points encloses: the distance inside is 0. The border is closed from the last point to
    /// the first, and does not cross itself.
    Area(Vec<DVec2>),
}

/// A persistent way point (Galin 2011, section 4.3): a junction that roads of a class and of lower ones lead to and pass. To the
/// proximity rule it is one more settlement, of the size that the class belongs to and without an extent; a town's roads to it
/// are major, a village's minor.
///
/// It stands where land is even enough for a road, 4 steps of the roads' lattice (512 m) or more from outlines and from other
/// way points. It changes the roads of the class and of lower ones that the proximity rule weighs it against, as a settlement
/// of that size would: those with both ends within the `reach` of their class from it. Where one road alone finds its way there,
/// it ends there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(deny_unknown_fields)]
pub struct WayPoint {
    /// Where, rounded to whole metres.
    pub at: DVec2,
    /// Highest class of roads that pass: highway, major or minor.
    pub class: StreetClass,
}

/// A wish for the road between two settlements, each named by a point in its circle, or for that to a way point, named by a
/// point within 100 m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(deny_unknown_fields)]
pub enum RoadEdit {
    /// There is a road, whatever the proximity rule says; the settlements lie within the reach of its class.
    Keep {
        /// One end.
        from: DVec2,
        /// The other.
        to: DVec2,
    },
    /// There is a road, and it passes points (Galin 2011, section 4.3). Distances that the proximity rule compares stay what
    /// they are.
    Via {
        /// One end.
        from: DVec2,
        /// The other.
        to: DVec2,
        /// 1 to 32 points in order; the road passes the nodes of the lattice nearest to them that are free.
        points: Vec<DVec2>,
        /// Whether the road is built whatever it costs. If not, the proximity rule weighs its cost through the points as that
        /// of any pair, and may drop it.
        #[serde(default = "yes")]
        keep: bool,
    },
    /// There is none.
    Ban {
        /// One end.
        from: DVec2,
        /// The other.
        to: DVec2,
    },
}

fn yes() -> bool {
    true
}

/// A patch that stands at a place in a town, whatever its style; the other streets of the main cell there grow around it. It
/// changes that main cell only, and others of the town where the style counts patches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(deny_unknown_fields)]
pub struct PatchEdit {
    /// Name of the patch; if sets of the town's styles have it, theirs.
    pub patch: String,
    /// Where the centre of its bounding circle stands, in a settlement and not on a main street.
    pub at: DVec2,
    /// Degrees from east to the x axis of its drawing, counter-clockwise: -360 to 360.
    #[serde(default)]
    pub heading_deg: f64,
    /// Whether it is mirrored at its x axis, before it is turned.
    #[serde(default)]
    pub mirrored: bool,
}

/// One of the lists of [`Edits`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum EditList {
    /// `settlements`
    Settlements,
    /// `influences`
    Influences,
    /// `influence_maps`
    InfluenceMaps,
    /// `way_points`
    WayPoints,
    /// `roads`
    Roads,
    /// `patches`
    Patches,
}

impl EditList {
    /// Its name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Settlements => "settlements",
            Self::Influences => "influences",
            Self::InfluenceMaps => "influence_maps",
            Self::WayPoints => "way_points",
            Self::Roads => "roads",
            Self::Patches => "patches",
        }
    }
}

/// An edit that cannot be, and why. The world is the one without it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}[{index}]: {reason}", list.name())]
pub struct RejectedEdit {
    /// The list that it is in.
    pub list: EditList,
    /// Its place there, from 0.
    pub index: usize,
    /// What is wrong, and what is allowed. One line.
    pub reason: String,
}

impl RejectedEdit {
    /// The same as an error at the place where the edit is written in `text`, which was read as [`Edits`].
    pub fn in_file(&self, file: &str, text: &str) -> FileError {
        error_at(file, text, &format!("{}[{}]", self.list.name(), self.index), self)
    }

    /// Many of them as errors at their places in `text`, in the same order; the text is read once for each list.
    pub fn all_in_file(rejected: &[Self], file: &str, text: &str) -> Vec<FileError> {
        let lists = rejected.chunk_by(|a, b| a.list == b.list);
        let of = |list: &[Self]| -> Vec<FileError> {
            let Some(first) = list.first() else { return Vec::new() };
            let errors: Vec<(usize, &Self)> = list.iter().map(|e| (e.index, e)).collect();
            errors_at_elements(file, text, first.list.name(), errors).collect()
        };
        lists.flat_map(of).collect()
    }
}

impl Edits {
    /// Reads and checks edits from RON text; `file` is only named in errors.
    pub fn from_ron(file: &str, text: &str) -> Result<Self, FileError> {
        let edits: Self = from_ron(file, text)?;
        edits.check().map_err(|e| e.in_file(file, text))?;
        Ok(edits)
    }

    /// Moves every place that the edits name, as a projection does. Painted maps stay.
    pub fn move_places(&mut self, to: impl Fn(DVec2) -> DVec2) {
        let mut places: Vec<&mut DVec2> = Vec::new();
        for edit in &mut self.settlements {
            match edit {
                SettlementEdit::Pin { at, .. } | SettlementEdit::Ban { at, .. } => places.push(at),
                SettlementEdit::Move { from, to } => places.extend([from, to]),
            }
        }
        for influence in &mut self.influences {
            match &mut influence.shape {
                Shape::Point(p) => places.push(p),
                Shape::Curve(line) | Shape::Area(line) => places.extend(line),
            }
        }
        for edit in &mut self.roads {
            match edit {
                RoadEdit::Keep { from, to } | RoadEdit::Ban { from, to } => places.extend([from, to]),
                RoadEdit::Via { from, to, points, .. } => {
                    places.extend([from, to]);
                    places.extend(points);
                }
            }
        }
        places.extend(self.way_points.iter_mut().map(|w| &mut w.at));
        places.extend(self.patches.iter_mut().map(|p| &mut p.at));
        places.into_iter().for_each(|p| *p = to(*p));
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Checks all that can be known without a world: ranges, counts of points, borders that cross themselves.
    pub fn check(&self) -> Result<(), RejectedEdit> {
        fn all<T>(list: EditList, edits: &[T], check: impl Fn(&T) -> Result<(), String>) -> Result<(), RejectedEdit> {
            edits
                .iter()
                .enumerate()
                .try_for_each(|(index, e)| check(e).map_err(|reason| RejectedEdit { list, index, reason }))
        }
        all(EditList::Settlements, &self.settlements, SettlementEdit::check)?;
        all(EditList::Influences, &self.influences, Influence::check)?;
        all(EditList::InfluenceMaps, &self.influence_maps, InfluenceMap::check)?;
        all(EditList::WayPoints, &self.way_points, WayPoint::check)?;
        all(EditList::Roads, &self.roads, RoadEdit::check)?;
        all(EditList::Patches, &self.patches, PatchEdit::check)
    }
}

impl SettlementEdit {
    fn check(&self) -> Result<(), String> {
        match self {
            Self::Pin { at, name, radius, .. } => {
                place("at", *at)?;
                if name.as_ref().is_some_and(|n| n.is_empty() || n.len() > LONGEST_NAME || n.contains(char::is_control))
                {
                    return Err(format!("name is not 1 to {LONGEST_NAME} bytes on one line"));
                }
                radius.map_or(Ok(()), |r| number("radius", r, SETTLEMENT_RADII))
            }
            Self::Move { from, to } => place("from", *from).and(place("to", *to)),
            Self::Ban { at, radius } => place("at", *at).and(number("radius", *radius, (0.0, 100_000.0))),
        }
    }
}

impl Influence {
    fn check(&self) -> Result<(), String> {
        match &self.shape {
            Shape::Point(p) => place("shape", *p)?,
            Shape::Curve(line) => points("shape", line, (2, MOST_POINTS))?,
            Shape::Area(border) => {
                points("shape", border, (3, MOST_POINTS))?;
                let mut closed = border.clone();
                // A border that names its first point again at its end is closed already.
                if border.last() != border.first() {
                    closed.push(border[0]);
                }
                let (id, corner) = (StreetId(1), JunctionId(1));
                let border = Street::new(id, StreetClass::Local, corner, corner, closed);
                if let Some(at) = crossings(&[&border]).first() {
                    return Err(format!("the border of the area crosses itself at {:.1},{:.1}", at.x, at.y));
                }
            }
        }
        number("radius", self.radius, (10.0, 20_000.0))?;
        number("strength", self.strength, STRENGTHS)?;
        road_classes(&self.classes)
    }
}

impl WayPoint {
    fn check(&self) -> Result<(), String> {
        place("at", self.at)?;
        let class = self.class;
        if class.is_link() { Ok(()) } else { Err(format!("class is {class:?}; allowed are Highway, Major, Minor")) }
    }
}

impl RoadEdit {
    /// Both ends.
    pub fn ends(&self) -> [DVec2; 2] {
        match self {
            Self::Keep { from, to } | Self::Via { from, to, .. } | Self::Ban { from, to } => [*from, *to],
        }
    }

    fn check(&self) -> Result<(), String> {
        let [from, to] = self.ends();
        place("from", from)?;
        place("to", to)?;
        match self {
            Self::Via { points: via, .. } => points("points", via, (1, MOST_VIA)),
            _ => Ok(()),
        }
    }
}

impl PatchEdit {
    fn check(&self) -> Result<(), String> {
        place("at", self.at)?;
        number("heading_deg", self.heading_deg, (-360.0, 360.0))
    }
}

#[cfg(test)]
mod tests;
