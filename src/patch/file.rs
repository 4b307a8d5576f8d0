//! A patch set as its file has it, before any check.

use crate::network::StreetClass;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;

/// A whole file.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "PatchSet", deny_unknown_fields)]
pub(super) struct SetDrawing {
    pub patches: Vec<PatchDrawing>,
    #[serde(default)]
    pub patterns: Vec<PatternDrawing>,
}

/// A patch as a file has it ([`crate::patch`] describes the format). Lengths are metres.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename = "Patch", deny_unknown_fields)]
pub struct PatchDrawing {
    /// Name, once per file.
    pub name: String,
    /// Positions, anywhere. The middle of a window is (0, 0).
    pub vertices: Vec<(f64, f64)>,
    /// Local streets, or all streets of a window.
    #[serde(default)]
    pub streets: Vec<Line>,
    /// Main streets, which stand for some that are there already.
    #[serde(default)]
    pub main: Vec<Line>,
    /// Class of each of `streets`, in their order; all are local if the list is empty.
    #[serde(default)]
    pub classes: Vec<StreetClass>,
    /// Vertices at which streets end for good.
    #[serde(default)]
    pub dead_ends: Vec<usize>,
    /// Tags besides those that are found.
    #[serde(default)]
    pub tags: Vec<String>,
    /// How often it is chosen against others.
    #[serde(default = "usual_weight")]
    pub weight: f64,
    /// Greatest number of times in a main cell.
    #[serde(default)]
    pub at_most: Option<u32>,
    /// The window of a map that it shows, if it was cut out of one.
    #[serde(default)]
    pub window: Option<WindowDrawing>,
}

/// The window of a map that a patch shows, as a file has it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename = "Window", deny_unknown_fields)]
pub struct WindowDrawing {
    /// Edge of the window.
    pub size: f64,
    /// How far beyond the window the streets are drawn.
    #[serde(default)]
    pub margin: f64,
    /// Name of the map.
    #[serde(default)]
    pub map: String,
    /// Middle of the window in the map's own metres.
    #[serde(default)]
    pub at: (f64, f64),
    /// Angle of the window's x axis in the map, in degrees, counter-clockwise from east.
    #[serde(default)]
    pub turned_deg: f64,
    /// The buildings whose middles lie in the window or its margin.
    #[serde(default)]
    pub buildings: Vec<BuildingDrawing>,
}

/// A building of a window, as a file has it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename = "Building", deny_unknown_fields)]
pub struct BuildingDrawing {
    /// Corners of its outline, three or more.
    pub outline: Vec<(f64, f64)>,
    /// Height of its walls in metres, where it is known.
    #[serde(default)]
    pub height: Option<f64>,
    /// Its storeys, where they are known.
    #[serde(default)]
    pub storeys: Option<u32>,
}

fn usual_weight() -> f64 {
    1.0
}

/// A pattern.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "Pattern", deny_unknown_fields)]
pub(super) struct PatternDrawing {
    pub name: String,
    pub element: String,
    #[serde(default = "full_size")]
    pub scale: (f64, f64),
    pub repeat: (u32, u32),
}

fn full_size() -> (f64, f64) {
    (1.0, 1.0)
}

/// The vertices that a street runs through, written as a list or as a tuple of any length.
#[derive(Clone, Debug, PartialEq)]
pub struct Line(pub Vec<i64>);

impl<'de> Deserialize<'de> for Line {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct LineVisitor;
        impl<'de> Visitor<'de> for LineVisitor {
            type Value = Line;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the vertices of a street, two or more, such as (0, 1) or [0, 4, 5, 1]")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Line, A::Error> {
                let mut line = Vec::new();
                while let Some(index) = seq.next_element()? {
                    line.push(index);
                }
                Ok(Line(line))
            }
        }
        deserializer.deserialize_any(LineVisitor)
    }
}
