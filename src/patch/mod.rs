//! Patches (small example street graphs with tags), patterns, patch sets, and the database that is searched (Teng 2017,
//! section 3).
//!
//! Part of the ground floor: knows no layer but the file errors of [`crate::layer`].
//!
//! # The file
//!
//! A patch set is a RON file: `patches`, then `patterns` (which may be left out). Lengths are metres, x east, y north; a
//! patch may be drawn anywhere, it is moved so that the centre of its bounding circle is its origin.
//!
//! ```ron
//! (
//!     patches: [
//!         (
//!             name: "tee",                                        // once per file
//!             vertices: [(0, 0), (45, 0), (90, 0), (45, -50)],    // numbered from 0
//!             streets: [[0, 1, 2], (1, 3)],                       // each through two vertices or more
//!         ),
//!         (
//!             name: "yard off a main street",
//!             vertices: [(-60, 0), (0, 0), (60, 0), (0, 50), (50, 60), (-40, 50)],
//!             main: [[0, 1, 2]],       // main streets: stand for one that is there already
//!             streets: [[1, 3, 4], (3, 5)],
//!             dead_ends: [5],          // ends that are not to be built on from
//!             tags: ["farm"],          // besides those found from the drawing; lower case, words joined by `-`
//!             weight: 0.5,             // how often it is chosen against the others; 1 when left out
//!             at_most: 2,              // times in one main cell; no limit when left out
//!         ),
//!     ],
//!     patterns: [(name: "yards", element: "yard off a main street", scale: (0.8, 1.2), repeat: (2, 5))],
//! )
//! ```
//!
//! - A street is a line through vertices, `(0, 1)` or `[0, 4, 5, 1]`; it may come back to where it began. Streets meet in
//!   the vertices that they share, and nowhere else.
//! - Curves are drawn as vertices every 8 to 20 m. A vertex on two streets' segments is a point of inflexion, one on three
//!   or more an intersection.
//! - Every end of a street is connectable, save those in `dead_ends`: there the network goes on. The ends of `main`
//!   streets are neither.
//! - A street of `main` may stand in `streets` too; it is a main street then.
//!
//! # Windows of maps
//!
//! A patch may show a square window that was cut out of a map, as the filler `PatchCity` lays them side by side: then its middle is
//! (0, 0), its streets need not hang together, and they may be of any class.
//!
//! ```ron
//! (
//!     name: "old-town 120 -40",
//!     vertices: [(-120, 10), (0, 12), (120, 20), (0, -120)],
//!     streets: [[0, 1, 2], (1, 3)],
//!     classes: [Main, Local],   // of each street; all are local when left out
//!     window: (
//!         size: 200,            // its edge, 20 to 1000
//!         margin: 20,           // how far beyond it streets are drawn, so that it can be moved; 0 when left out
//!         map: "old-town",      // where it is from: name, middle and angle
//!         at: (120, -40),
//!         turned_deg: 0,
//!         buildings: [(outline: [(20, 25), (32, 25), (32, 34), (20, 34)], height: 7.5, storeys: 2)],   // whose middles lie in it
//!     ),
//! )
//! ```
//!
//! What a file may not hold is said by the error, with line and column: of the vertex, street, tag or weight where that
//! alone is wrong, else of the end of the patch or pattern.
//!
//! # Tags
//!
//! [`tag`] lists the tags that are found from the geometry, and what exactly they mean. Those of a whole patch are in
//! [`Patch::tags`] with the user's own; those of vertices and edges are asked for with [`Patch::vertex_tags`] and
//! [`Patch::edge_tags`].

mod check;
mod database;
mod drawing;
mod file;
#[cfg(test)]
mod library;
mod read;
mod semantics;
mod set;
mod shape;
#[cfg(feature = "cli")]
mod sheet;
pub mod tag;
mod write;

pub use check::{DrawingError, DrawingErrorKind};
pub use database::{Passage, PatchDatabase, PatchFacts, PatternEntry};
pub(crate) use drawing::keeps_rules;
pub use drawing::{DrawingRules, Flaw, STRETCH};
pub use file::{BuildingDrawing, Line, PatchDrawing, WindowDrawing};
pub use semantics::MainLine;
pub use set::{Connectable, Pair, Patch, PatchBuilding, PatchEdge, PatchSet, PatchWindow, Pattern};
pub(crate) use shape::in_sectors;
pub use shape::{ArmSample, LEAST_ARM, PatchShape, PatchView, SECTORS, SectorReach};
#[cfg(feature = "cli")]
pub use sheet::draw_sheet;
pub use write::to_ron;
