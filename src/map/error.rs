//! Why a map cannot be read.

use crate::layer::FileError;
use glam::DVec2;

/// Why a map cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MapError {
    /// The file cannot be read, or is not what its name says. The error names the line where the format has lines.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file's name ends in nothing that a reader knows.
    #[error("{file}: unknown kind of map; the name must end in .osm .osm.pbf .geojson .png (or .xml .json)")]
    UnknownFormat {
        /// Name of the file.
        file: String,
    },
    /// The map holds more than [`MapLimits`](crate::map::MapLimits) allow.
    #[error("{file}: holds more than {limit} {what}, the most that is read; cut a part out of it first")]
    TooLarge {
        /// Name of the file.
        file: String,
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        limit: u64,
    },
    /// A place is not longitude and latitude in degrees.
    #[error("{file}: {at_x},{at_y} is no longitude and latitude in degrees: {reason}", at_x = at.x, at_y = at.y)]
    NotDegrees {
        /// Name of the file.
        file: String,
        /// Longitude and latitude as the file has them.
        at: DVec2,
        /// What may have gone wrong.
        reason: &'static str,
    },
    /// A place in metres lies too far out.
    #[error("{file}: a place at {at_x},{at_y} lies too far out; allowed are at most {limit} m", at_x = at.x, at_y = at.y)]
    TooFar {
        /// Name of the file.
        file: String,
        /// The place as the file has it.
        at: DVec2,
        /// Greatest distance from the plan's origin along an axis, in metres.
        limit: f64,
    },
    /// Coordinates in metres were asked for, but the format has degrees.
    #[error("{file}: OpenStreetMap has degrees, but coordinates in metres were asked for")]
    NeedsDegrees {
        /// Name of the file.
        file: String,
    },
    /// Nothing of the file is a street of the classes that were asked for.
    #[error("{file}: no street of the classes {classes}{left_out}", classes = classes.join(","))]
    NoStreets {
        /// Name of the file.
        file: String,
        /// The classes that were asked for.
        classes: Vec<String>,
        /// What the file holds instead: `; left out: ...`, or empty.
        left_out: String,
    },
    /// No street lies in the box that was asked for.
    #[error("{file}: none of its {streets} streets lies in the box that was asked for{hint}")]
    Outside {
        /// Name of the file.
        file: String,
        /// How many streets the file has.
        streets: usize,
        /// What may have gone wrong: `; ...`, or empty.
        hint: &'static str,
    },
    /// A road mask is read without the size of its pixels.
    #[error("{file}: a picture needs the size of its pixels (metres per pixel)")]
    NeedsScale {
        /// Name of the file.
        file: String,
    },
    /// A road mask has no degrees, but a place in degrees was asked for.
    #[error("{file}: a picture has no degrees, but a place in degrees was asked for")]
    NoDegrees {
        /// Name of the file.
        file: String,
    },
    /// An option of [`MaskOptions`](crate::map::MaskOptions) is out of its range.
    #[error("{file}: `{option}` is {value}; allowed is {} to {}", allowed.0, allowed.1)]
    MaskOption {
        /// Name of the file.
        file: String,
        /// The option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// Least and greatest value.
        allowed: (f64, f64),
    },
    /// A picture is no road mask.
    #[error("{file}: not a road mask: {reason} (its colours: {colours})")]
    NoMask {
        /// Name of the file.
        file: String,
        /// What is wrong.
        reason: String,
        /// The most common colours with their shares.
        colours: String,
    },
}
