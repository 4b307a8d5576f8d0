//! What readers find in a file: nodes, ways and outlines by their ids, not yet placed on the plan.

use crate::map::error::MapError;
use crate::map::limits::MapLimits;
use crate::map::report::LeftOut;
use crate::map::tags::{BuildingTags, ElementKind};
use crate::space::Bounds;
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// Ids from here down are those of nodes that have none in the file.
const MADE_UP_BELOW: i64 = i64::MIN / 2;
/// Positions this close are one node where nodes have no ids: a ten-millionth of a degree, as OpenStreetMap keeps, or of a metre.
const PLACE_STEP: f64 = 1e-7;

/// A way, or a line of a feature.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Way {
    pub nodes: Vec<i64>,
    pub kind: ElementKind,
}

/// A building made of several rings.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outline {
    pub tags: BuildingTags,
    pub members: Vec<Member>,
}

/// One line of an outline; several may make up a ring.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Member {
    /// Whether it bounds a courtyard.
    pub is_inner: bool,
    pub line: MemberLine,
}

/// The points of a member.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum MemberLine {
    /// Those of a way.
    Way(i64),
    /// Those of these nodes.
    Nodes(Vec<i64>),
}

/// What a file holds, in its own coordinates.
#[derive(Debug, Default)]
pub(super) struct Elements {
    positions: BTreeMap<i64, DVec2>,
    /// Nodes without ids, by their rounded positions.
    made_up: BTreeMap<[i64; 2], i64>,
    pub ways: BTreeMap<i64, Way>,
    pub outlines: BTreeMap<i64, Outline>,
    pub left_out: BTreeMap<LeftOut, usize>,
    /// The box that the file says it covers.
    pub stated: Option<Bounds>,
    points: u64,
    file: String,
    limits: MapLimits,
}

impl Elements {
    /// A node that the file does not have.
    pub const MISSING: i64 = i64::MAX;

    pub fn new(file: &str, limits: MapLimits) -> Self {
        Self { file: file.to_owned(), limits, ..Self::default() }
    }

    /// Counts something that is left out.
    pub fn leave_out(&mut self, reason: LeftOut) {
        *self.left_out.entry(reason).or_default() += 1;
    }

    /// The position of a node, where the file has one.
    pub fn position(&self, id: i64) -> Option<DVec2> {
        self.positions.get(&id).copied()
    }

    /// The id of a node as its file has it.
    pub fn id_in_file(id: i64) -> Option<i64> {
        (id >= MADE_UP_BELOW).then_some(id)
    }

    /// Sets the position of a node, or takes away one that was deleted (`None`).
    pub fn put_node(&mut self, id: i64, at: Option<DVec2>) -> Result<(), MapError> {
        match at {
            Some(at) => drop(self.positions.insert(id, at)),
            None => drop(self.positions.remove(&id)),
        }
        // Many nodes of a file may belong to nothing that is used.
        self.check(self.positions.len() as u64, 4 * self.limits.points, "nodes")
    }

    /// The node at a position, for files whose nodes have no ids: equal positions are one node.
    pub fn node_at(&mut self, at: DVec2) -> i64 {
        let key = (at / PLACE_STEP).round().as_i64vec2().to_array();
        let next = i64::MIN + self.made_up.len() as i64;
        let id = *self.made_up.entry(key).or_insert(next);
        self.positions.entry(id).or_insert(at);
        id
    }

    /// Puts a way there, in place of an earlier version of it, or takes away one that was deleted (`None`).
    pub fn put_way(&mut self, id: i64, way: Option<Way>) -> Result<(), MapError> {
        let Some(way) = way else {
            self.ways.remove(&id);
            return Ok(());
        };
        self.count_points(way.nodes.len())?;
        self.ways.insert(id, way);
        self.check(self.ways.len() as u64, self.limits.elements, "streets and buildings")
    }

    /// Puts an outline there, as [`put_way`](Self::put_way) does with a way.
    pub fn put_outline(&mut self, id: i64, outline: Option<Outline>) -> Result<(), MapError> {
        let Some(outline) = outline else {
            self.outlines.remove(&id);
            return Ok(());
        };
        let points = |m: &Member| match &m.line {
            MemberLine::Way(_) => 1,
            MemberLine::Nodes(nodes) => nodes.len(),
        };
        self.count_points(outline.members.iter().map(points).sum())?;
        self.outlines.insert(id, outline);
        self.check(self.outlines.len() as u64, self.limits.elements, "buildings")
    }

    /// The ways that are members of outlines, of the members for which `wanted` holds.
    pub fn member_ways(&self, wanted: impl Fn(&Member) -> bool) -> BTreeSet<i64> {
        let members = self.outlines.values().flat_map(|o| &o.members).filter(|m| wanted(m));
        members.filter_map(|m| if let MemberLine::Way(id) = m.line { Some(id) } else { None }).collect()
    }

    /// The nodes of a member.
    pub fn member_nodes(&self, member: &Member) -> Vec<i64> {
        match &member.line {
            MemberLine::Way(id) => self.ways.get(id).map_or_else(|| vec![Self::MISSING], |w| w.nodes.clone()),
            MemberLine::Nodes(nodes) => nodes.clone(),
        }
    }

    fn count_points(&mut self, count: usize) -> Result<(), MapError> {
        self.points += count as u64;
        self.check(self.points, self.limits.points, "points")
    }

    fn check(&self, count: u64, limit: u64, what: &'static str) -> Result<(), MapError> {
        if count <= limit { Ok(()) } else { Err(MapError::TooLarge { file: self.file.clone(), what, limit }) }
    }
}
