//! The tags that are found from the geometry when a set is loaded (Teng 2017, Table 1).
//!
//! The paper's table is short; where it leaves a choice, the choice is stated here.

/// Of a vertex: the network may go on there. An end of a local street that the file does not list as a dead end.
pub const CONNECTABLE: &str = "connectable";
/// Of a vertex: three or more edges meet there.
pub const INTERSECTION: &str = "intersection";

/// Of an edge: a local one that ends without a connectable vertex. (By the letter of the table, any edge between two
/// intersections would be one too; an edge that ends is meant.)
pub const DEAD_END: &str = "dead-end";
/// Of an edge: a local one at an intersection; others may be snapped to it, it may be made longer or shorter.
pub const SNAPPABLE: &str = "snappable";
/// Of an edge: stands for a main street.
pub const MAIN: &str = "main";
/// Of an edge: stands for a local street.
pub const LOCAL: &str = "local";

/// Of a patch: a ring of streets with nothing inside, at least six vertices within an eighth of the radius of one circle
/// of at most 40 m radius, at most 65 degrees apart as seen from its centre, with intersections at two of them or more.
pub const ROUNDABOUT: &str = "roundabout";
/// Of a patch: streets, main streets included, enclose an area.
pub const LOOP: &str = "loop";
/// Of a patch: has a dead-end edge.
pub const CUL_DE_SAC: &str = "cul-de-sac";
/// Of a patch: a roundabout, or some stretch of a street turns by 15 degrees or more in all, and no point of inflexion on
/// it by more than 60 degrees or by more than three quarters of that (so that a single kink makes no curve).
pub const CURVED: &str = "curved";
/// Of a patch: not curved. Corners and kinks join straight segments.
pub const STRAIGHT: &str = "straight";
/// Of a patch: exactly one connectable vertex, so that nothing goes on from it.
pub const TERMINAL: &str = "terminal";
/// Of a patch: one straight main street, and local streets that hang together, touch it, lie on one side of it, and have
/// a connectable vertex.
pub const INITIAL: &str = "initial";
/// Of a patch that shows the window of a map: its streets do not hang together.
pub const IN_PIECES: &str = "in-pieces";

/// All that a patch as a whole can have.
pub const OF_PATCHES: [&str; 8] = [ROUNDABOUT, LOOP, CUL_DE_SAC, CURVED, STRAIGHT, TERMINAL, INITIAL, IN_PIECES];
