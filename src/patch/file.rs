//! A patch set as its file has it, before any check.

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

/// A patch.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "Patch", deny_unknown_fields)]
pub(super) struct PatchDrawing {
    pub name: String,
    pub vertices: Vec<(f64, f64)>,
    #[serde(default)]
    pub streets: Vec<Line>,
    #[serde(default)]
    pub main: Vec<Line>,
    #[serde(default)]
    pub dead_ends: Vec<usize>,
    #[serde(default)]
    pub tags: Vec<String>,
    #[serde(default = "usual_weight")]
    pub weight: f64,
    #[serde(default)]
    pub at_most: Option<u32>,
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
#[derive(Clone, Debug)]
pub(super) struct Line(pub Vec<i64>);

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
