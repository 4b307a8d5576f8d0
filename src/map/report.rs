//! What a reader used of a map, and what it left out, by reason.

use std::collections::BTreeMap;
use std::fmt;

/// Why a part of a map was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LeftOut {
    /// A way, a relation or a feature that is neither a street nor a building: rivers, coasts, paths, land use.
    OtherKind,
    /// A street of a class that was not asked for.
    OtherClass,
    /// Deleted in an editor (`action="delete"`), or no longer visible in a history file (`visible="false"`).
    Deleted,
    /// A node without longitude and latitude.
    NoCoordinates,
    /// A way or an outline with nodes that the file does not hold. A street keeps the parts between such nodes.
    MissingNodes,
    /// A line with fewer than two different points.
    TooFewPoints,
    /// A street that is drawn as an area, such as a square.
    StreetArea,
    /// The outline of a building that does not close or has no area.
    OpenOutline,
    /// The outline of a building that crosses or touches itself.
    CrossesItself,
    /// The same street again, such as the opposite direction of a two-way street in files of OSMnx.
    Repeated,
    /// A feature of GeoJSON without geometry, or with points alone.
    OtherGeometry,
    /// A street or a building outside of the box that was asked for.
    OutsideBox,
    /// In a picture, a spot too small for a street or a building, or a spur of a road.
    Speck,
}

impl LeftOut {
    /// Every reason.
    pub const ALL: [Self; 13] = [
        Self::OtherKind,
        Self::OtherClass,
        Self::Deleted,
        Self::NoCoordinates,
        Self::MissingNodes,
        Self::TooFewPoints,
        Self::StreetArea,
        Self::OpenOutline,
        Self::CrossesItself,
        Self::Repeated,
        Self::OtherGeometry,
        Self::OutsideBox,
        Self::Speck,
    ];

    /// The reason as a key of JSON reports.
    pub fn key(self) -> &'static str {
        match self {
            Self::OtherKind => "other_kind",
            Self::OtherClass => "other_class",
            Self::Deleted => "deleted",
            Self::NoCoordinates => "no_coordinates",
            Self::MissingNodes => "missing_nodes",
            Self::TooFewPoints => "too_few_points",
            Self::StreetArea => "street_area",
            Self::OpenOutline => "open_outline",
            Self::CrossesItself => "crosses_itself",
            Self::Repeated => "repeated",
            Self::OtherGeometry => "other_geometry",
            Self::OutsideBox => "outside_box",
            Self::Speck => "speck",
        }
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OtherKind => "neither street nor building",
            Self::OtherClass => "street of another class",
            Self::Deleted => "deleted",
            Self::NoCoordinates => "node without coordinates",
            Self::MissingNodes => "nodes missing",
            Self::TooFewPoints => "fewer than two points",
            Self::StreetArea => "street drawn as an area",
            Self::OpenOutline => "outline not closed",
            Self::CrossesItself => "outline that crosses itself",
            Self::Repeated => "repeated street",
            Self::OtherGeometry => "geometry not used",
            Self::OutsideBox => "outside of the box",
            Self::Speck => "speck of a picture",
        })
    }
}

/// What a reader used of a map, and what it left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapReport {
    /// Name of the file as it was given.
    pub file: String,
    /// Streets (ways or features) that are used, whole or in part.
    pub streets: usize,
    /// Buildings that are used.
    pub buildings: usize,
    /// Length in metres of all streets of the classes that were asked for, also outside of the box.
    pub length: f64,
    /// Length in metres of the streets that are used, within the box.
    pub length_inside: f64,
    /// How many things were left out, by reason.
    pub left_out: BTreeMap<LeftOut, usize>,
}

impl MapReport {
    /// Counts something that is left out.
    pub(super) fn leave_out(&mut self, reason: LeftOut) {
        *self.left_out.entry(reason).or_default() += 1;
    }

    /// Share of the length of the streets that lies in the box, 0 to 1.
    pub fn share_inside(&self) -> f64 {
        if self.length > 0.0 { (self.length_inside / self.length).min(1.0) } else { 0.0 }
    }

    /// What was left out in words: `7 neither street nor building, 1 deleted`. Empty where nothing was.
    pub fn left_out_in_words(&self) -> String {
        let reasons = self.left_out.iter().map(|(reason, count)| format!("{count} {reason}"));
        reasons.collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_has_a_key_and_words_of_its_own() {
        let mut names: Vec<String> = LeftOut::ALL.iter().map(|r| r.key().to_owned()).collect();
        names.extend(LeftOut::ALL.iter().map(LeftOut::to_string));
        let count = names.len();
        names.sort();
        names.dedup();
        // "deleted" is both.
        assert_eq!(names.len(), count - 1);
        let report =
            MapReport { left_out: [(LeftOut::Deleted, 2), (LeftOut::OtherKind, 1)].into(), ..MapReport::default() };
        assert_eq!(report.left_out_in_words(), "1 neither street nor building, 2 deleted");
        assert_eq!(report.share_inside(), 0.0);
    }
}
