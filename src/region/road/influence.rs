//! The user's influences on the cost of roads: the control term h of Galin 2011, section 4.1.

use super::cost::{LEAST_COST, kernel};
use super::tier::class_of;
use crate::edits::{Influence, Shape};
use crate::network::{SizeClass, StreetClass};
use crate::space::{Bounds, distance_to_line, point_in_polygon};
use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

/// An influence, prepared for queries.
#[derive(Debug)]
struct Term {
    influence: Influence,
    /// The line of the shape. The line of an area ends where it begins.
    line: Vec<DVec2>,
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
        Self { influence: influence.clone(), line, bounds }
    }

    fn works_on(&self, class: StreetClass) -> bool {
        self.influence.classes.is_empty() || self.influence.classes.contains(&class)
    }

    /// Extra cost per metre at a point.
    fn at(&self, p: DVec2) -> f64 {
        if !self.bounds.contains(p) {
            return 0.0;
        }
        let distance = match &self.influence.shape {
            Shape::Point(middle) => p.distance(*middle),
            Shape::Area(border) if point_in_polygon(p, border) => 0.0,
            Shape::Curve(_) | Shape::Area(_) => distance_to_line(p, &self.line),
        };
        self.influence.strength * kernel(distance, self.influence.radius)
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
        if self.0.iter().any(|t| t.influence.strength < 0.0) { LEAST_COST } else { 1.0 }
    }
}

/// All influences, found by place.
#[derive(Debug, Default)]
pub(super) struct Influences {
    terms: Vec<Term>,
    tree: RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>,
}

impl Influences {
    pub fn new(influences: &[Influence]) -> Self {
        let terms: Vec<Term> = influences.iter().map(Term::new).collect();
        let boxed = |(i, t): (usize, &Term)| {
            GeomWithData::new(Rectangle::from_corners(t.bounds.min.to_array(), t.bounds.max.to_array()), i)
        };
        let tree = RTree::bulk_load(terms.iter().enumerate().map(boxed).collect());
        Self { terms, tree }
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
