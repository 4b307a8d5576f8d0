//! The user's influences on the cost of roads: the control term h of Galin 2011, section 4.1.

use super::cost::{LEAST_COST, kernel};
use super::tier::class_of;
use crate::edits::{EditList, Edits, Influence, InfluenceMap, Painted, RejectedEdit, Shape};
use crate::network::{SizeClass, StreetClass};
use crate::space::{Bounds, distance_to_line, point_in_polygon};
use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use std::sync::Arc;

/// What an influence is.
#[derive(Debug)]
enum Kind {
    /// A shape with the line of it. The line of an area ends where it begins.
    Shape(Influence, Vec<DVec2>),
    Painted(Arc<Painted>),
}

/// An influence, prepared for queries.
#[derive(Debug)]
struct Term {
    kind: Kind,
    /// Classes that it works on; none for all.
    classes: Vec<StreetClass>,
    /// Whether it makes roads cheaper anywhere.
    draws: bool,
    /// Box around everything that the influence reaches.
    bounds: Bounds,
}

impl Term {
    fn new(influence: &Influence) -> Self {
        let line = match &influence.shape {
            Shape::Point(p) => vec![*p],
            Shape::Curve(line) => line.clone(),
            Shape::Area(border) => border.iter().chain(border.first()).copied().collect(),
        };
        let bounds = Bounds::of(line.iter().copied()).grown(influence.radius);
        let (classes, draws) = (influence.classes.clone(), influence.strength < 0.0);
        Self { kind: Kind::Shape(influence.clone(), line), classes, draws, bounds }
    }

    fn painted(map: &InfluenceMap, cells: &Arc<Painted>) -> Self {
        let (kind, classes) = (Kind::Painted(cells.clone()), map.classes.clone());
        Self { kind, classes, draws: cells.draws(), bounds: cells.bounds() }
    }

    fn works_on(&self, class: StreetClass) -> bool {
        self.classes.is_empty() || self.classes.contains(&class)
    }

    /// Extra cost per metre at a point.
    fn at(&self, p: DVec2) -> f64 {
        if !self.bounds.contains(p) {
            return 0.0;
        }
        let (influence, line) = match &self.kind {
            Kind::Shape(influence, line) => (influence, line),
            Kind::Painted(cells) => return cells.at(p),
        };
        let distance = match &influence.shape {
            Shape::Point(middle) => p.distance(*middle),
            Shape::Area(border) if point_in_polygon(p, border) => 0.0,
            Shape::Curve(_) | Shape::Area(_) => distance_to_line(p, line),
        };
        influence.strength * kernel(distance, influence.radius)
    }
}

/// The influences on one class of roads in a box.
#[derive(Debug, Default)]
pub(super) struct Terms<'a>(Vec<&'a Term>);

impl Terms<'_> {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Extra cost per metre at a point.
    pub fn at(&self, p: DVec2) -> f64 {
        self.0.iter().map(|t| t.at(p)).sum()
    }

    /// Least cost per metre of a road under these influences.
    pub fn least_cost(&self) -> f64 {
        if self.0.iter().any(|t| t.draws) { LEAST_COST } else { 1.0 }
    }
}

/// All influences, found by place.
#[derive(Debug, Default)]
pub(super) struct Influences {
    terms: Vec<Term>,
    tree: RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>,
}

impl Influences {
    /// The influences of checked edits. Also returns the edits that cannot be carried out, because their map was not read or
    /// because they do not reach `domain` (plan metres).
    pub fn new(edits: &Edits, domain: Option<Bounds>) -> (Self, Vec<RejectedEdit>) {
        let (mut terms, mut rejected) = (Vec::new(), Vec::new());
        let mut put = |list: EditList, index: usize, term: Result<Term, String>| {
            let inside = |t: Term| match domain {
                Some(d) if !d.overlaps(t.bounds) => Err("it lies outside of the domain".to_owned()),
                _ => Ok(t),
            };
            match term.and_then(inside) {
                Ok(term) => terms.push(term),
                Err(reason) => rejected.push(RejectedEdit { list, index, reason }),
            }
        };
        for (i, influence) in edits.influences.iter().enumerate() {
            put(EditList::Influences, i, Ok(Term::new(influence)));
        }
        for (i, map) in edits.influence_maps.iter().enumerate() {
            let unread = || format!("the map {} was not read; whoever reads the edits must set its cells", map.file);
            put(EditList::InfluenceMaps, i, map.cells.as_ref().map(|c| Term::painted(map, c)).ok_or_else(unread));
        }
        let boxed = |(i, t): (usize, &Term)| {
            GeomWithData::new(Rectangle::from_corners(t.bounds.min.to_array(), t.bounds.max.to_array()), i)
        };
        let tree = RTree::bulk_load(terms.iter().enumerate().map(boxed).collect());
        (Self { terms, tree }, rejected)
    }

    /// The influences on roads of a tier in a box (plan metres).
    pub fn terms(&self, tier: SizeClass, bounds: Bounds) -> Terms<'_> {
        if self.terms.is_empty() {
            return Terms::default();
        }
        let near = AABB::from_corners(bounds.min.to_array(), bounds.max.to_array());
        let mut found: Vec<usize> = self.tree.locate_in_envelope_intersecting(near).map(|t| t.data).collect();
        // Sums of floats depend on their order.
        found.sort_unstable();
        let class = class_of(tier);
        Terms(found.into_iter().map(|i| &self.terms[i]).filter(|t| t.works_on(class)).collect())
    }
}
