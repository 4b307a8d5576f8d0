//! Patches, patterns and patch sets.

use crate::network::StreetClass;
use glam::DVec2;
use std::collections::BTreeSet;

/// A vertex of a patch at which the network may go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connectable {
    /// Index into [`Patch::vertices`]; a vertex of degree 1.
    pub vertex: usize,
    /// Unit direction in which the patch leaves this vertex, into the patch.
    pub inward: DVec2,
}

/// Two connectable vertices that local streets connect, and their distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Index into [`Patch::connectables`] of the first.
    pub a: usize,
    /// Index into [`Patch::connectables`] of the second, greater than `a`.
    pub b: usize,
    /// Straight distance in metres.
    pub distance: f64,
}

/// A straight edge of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PatchEdge {
    /// First vertex.
    pub a: usize,
    /// Second vertex.
    pub b: usize,
    /// Whether it stands for a main street (then the patch is attached to one there and the edge itself is not built).
    pub main: bool,
    /// Class of the street.
    pub class: StreetClass,
}

impl PatchEdge {
    /// The end that is not `v`.
    pub fn other(&self, v: usize) -> usize {
        if self.a == v { self.b } else { self.a }
    }
}

/// A small example street graph with tags. Lengths are metres; vertices of degree 2 are points of inflexion.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Name, unique in its set.
    pub name: String,
    /// Positions of the vertices, relative to the centre of the bounding circle.
    pub vertices: Vec<DVec2>,
    /// Edges.
    pub edges: Vec<PatchEdge>,
    /// Tags, found from the geometry (Teng 2017, Table 1) and added by the user. Lower case, words joined by `-`.
    pub tags: BTreeSet<String>,
    /// Weight in choices, 0 or more; 1 when the file does not say.
    pub weight: f64,
    /// How often the patch may be used in a main cell at most.
    pub at_most: Option<u32>,
    /// Connectable vertices.
    pub connectables: Vec<Connectable>,
    /// Pairs of connectable vertices, sorted by distance.
    pub pairs: Vec<Pair>,
    /// Radius of the bounding circle around (0, 0).
    pub radius: f64,
    /// The window of a map that the patch shows, if it was cut out of one.
    pub window: Option<PatchWindow>,
}

/// The square window of a map that a patch shows. Streets go on beyond the window for some metres, so that it can be moved a little.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchWindow {
    /// Edge, in metres.
    pub size: f64,
    /// How far beyond the window streets are drawn, in metres.
    pub margin: f64,
    /// Middle of the window, as the vertices of the patch.
    pub middle: DVec2,
    /// Name of the map.
    pub map: String,
    /// Middle of the window in the map's own metres.
    pub at: DVec2,
    /// Angle of the window's x axis in the map, in radians, counter-clockwise from east.
    pub turned: f64,
    /// The buildings whose middles lie in the window or its margin.
    pub buildings: Vec<PatchBuilding>,
}

/// A building of a window.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchBuilding {
    /// Outline in metres from the middle of the window, counter-clockwise.
    pub outline: Vec<DVec2>,
    /// Height of its walls in metres, where it is known.
    pub height: Option<f64>,
    /// Its storeys, where they are known.
    pub storeys: Option<u32>,
}

/// A patch repeated along a street.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// Name, unique in its set.
    pub name: String,
    /// Name of the patch that is repeated, in the same set.
    pub element: String,
    /// Least and greatest scale of the element.
    pub scale: (f64, f64),
    /// Least and greatest number of elements.
    pub repeat: (u32, u32),
}

/// A file of patches and patterns.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchSet {
    /// Name: the file's, without folders and extension.
    pub name: String,
    /// Patches, at least one.
    pub patches: Vec<Patch>,
    /// Patterns.
    pub patterns: Vec<Pattern>,
}
