//! What the user's edits say of roads: influences on their cost, and roads kept, led and banned.

use super::field::Field;
use super::lattice::{kernel, node_at};
use super::pairs::{beeline, tier_of};
use super::places::Places;
use super::way_points::NAMED;
use super::{RoadSettings, Work, class_of};
use crate::edits::{EditList, Edits, Influence, RejectedEdit, RoadEdit, Shape};
use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::network::StreetClass;
use crate::region::{Settlement, SettlementId};
use crate::space::{Bounds, distance_to_line, point_in_polygon};
use crate::terrain::Terrain;
use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Least cost of a road over its length, whatever draws it.
pub(super) const LEAST_SHARE: f64 = 0.2;

/// An influence, ready to be asked.
#[derive(Debug)]
pub(super) struct Term {
    influence: Influence,
    /// The line of the shape; that of an area ends where it begins.
    line: Vec<DVec2>,
    /// All that it reaches.
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

    /// Least cost per metre that they allow.
    pub fn least(&self) -> f64 {
        if self.0.iter().any(|t| t.influence.strength < 0.0) { LEAST_SHARE } else { 1.0 }
    }
}

/// What the user wants of the road between two settlements.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Wish {
    Keep,
    /// Through points, in order from the settlement with the lower id.
    Via(Vec<DVec2>),
    Ban,
}

/// An edit of a road: the wish, the settlements, the lower id first, and its index.
#[derive(Debug)]
struct Wished {
    wish: Wish,
    ends: [Arc<Settlement>; 2],
    index: usize,
}

/// All edits of roads.
#[derive(Debug, Default)]
pub(super) struct Control {
    terms: Vec<Term>,
    tree: RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>,
    /// By pair, the lower id first.
    wishes: BTreeMap<(SettlementId, SettlementId), Wished>,
    /// Way points that stand, sorted by id.
    pub way_points: Vec<Arc<Settlement>>,
    /// Index of the edit of each.
    pub way_point_edits: Vec<usize>,
    /// Edits that cannot be.
    pub rejected: Vec<RejectedEdit>,
}

impl Control {
    /// The control that checked edits ask for.
    pub fn new(edits: &Edits, settings: &RoadSettings, terrain: &dyn Terrain, places: &dyn Places) -> Self {
        let terms: Vec<Term> = edits.influences.iter().map(Term::new).collect();
        let boxed = |(i, t): (usize, &Term)| {
            GeomWithData::new(Rectangle::from_corners(t.bounds.min.to_array(), t.bounds.max.to_array()), i)
        };
        let tree = RTree::bulk_load(terms.iter().enumerate().map(boxed).collect());
        let mut out = Self { terms, tree, ..Self::default() };
        for (index, edit) in edits.roads.iter().enumerate() {
            let added = match wish(edit, settings, terrain, places) {
                Ok((ends, wish)) => out.add(index, ends, wish),
                Err(reason) => Err(reason),
            };
            if let Err(reason) = added {
                out.rejected.push(RejectedEdit { list: EditList::Roads, index, reason });
            }
        }
        out
    }

    fn add(&mut self, index: usize, ends: [Arc<Settlement>; 2], wish: Wish) -> Result<(), String> {
        let key = (ends[0].id, ends[1].id);
        if let Some(Wished { index: before, .. }) = self.wishes.get(&key) {
            return Err(format!(
                "roads[{before}] is about the same two settlements; allowed is one edit for each pair"
            ));
        }
        self.wishes.insert(key, Wished { wish, ends, index });
        Ok(())
    }

    /// Influences on roads of a class in a box (plan metres).
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

    /// Adds the influences to the ground of a search.
    pub fn influence(&self, tier: SizeClass, field: &mut Field) {
        let step = field.step();
        let terms = self.terms(tier, Bounds::of(field.strip.nodes.iter().map(|n| node_at(*n, step))));
        if !terms.is_empty() {
            field.lessen(terms.least());
            field.add(|_, node| terms.at(node_at(node, step)));
        }
    }

    /// What the user wants of a pair.
    pub fn wish(&self, a: &Settlement, b: &Settlement) -> Option<&Wish> {
        if self.wishes.is_empty() {
            return None;
        }
        self.wishes.get(&(a.id.min(b.id), a.id.max(b.id))).map(|w| &w.wish)
    }

    /// Whether the user wants a road, whatever the proximity rule says.
    pub fn wants(&self, a: &Settlement, b: &Settlement) -> bool {
        self.wish(a, b).is_some_and(|w| *w != Wish::Ban)
    }

    /// Points that the road of a pair passes, from the settlement with the lower id.
    pub fn via(&self, a: &Settlement, b: &Settlement) -> &[DVec2] {
        match self.wish(a, b) {
            Some(Wish::Via(points)) => points,
            _ => &[],
        }
    }

    /// Wanted roads: the index of each edit, the settlements, the lower id first, and what is wanted.
    pub fn wanted(&self) -> impl Iterator<Item = (usize, &[Arc<Settlement>; 2], &Wish)> {
        self.wishes.values().filter(|w| w.wish != Wish::Ban).map(|w| (w.index, &w.ends, &w.wish))
    }
}

/// The settlement whose circle holds a point, or the way point there; of several, that with the nearest centre.
fn settlement_at(places: &dyn Places, p: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
    let near = places.overlapping(Bounds::new(p, p))?;
    let apart = |s: &Settlement| s.centre.plan().distance(p);
    let holding = near.into_iter().filter(|s| apart(s) <= s.radius.max(NAMED));
    Ok(holding.min_by(|a, b| apart(a).total_cmp(&apart(b)).then(a.id.cmp(&b.id))))
}

/// The settlements of an edit, the lower id first, and what it wants of them; or why it cannot be.
fn wish(
    edit: &RoadEdit,
    settings: &RoadSettings,
    terrain: &dyn Terrain,
    places: &dyn Places,
) -> Result<([Arc<Settlement>; 2], Wish), String> {
    let find = |p: DVec2| {
        let found = settlement_at(places, p).map_err(|e| e.to_string())?;
        found.ok_or_else(|| {
            format!("no settlement is at {},{}; allowed is a point in the circle of one, or at a way point", p.x, p.y)
        })
    };
    let [from, to] = edit.ends();
    let (from, to) = (find(from)?, find(to)?);
    if from.id == to.id {
        return Err(format!("both ends lie in {}; allowed are two settlements", from.name));
    }
    let turned = to.id < from.id;
    let tier = settings.tier(tier_of(&from, &to));
    let apart = beeline(&from, &to);
    if !matches!(edit, RoadEdit::Ban { .. }) {
        if apart > tier.reach {
            let (from, to, reach) = (&from.name, &to.name, tier.reach);
            return Err(format!(
                "{from} and {to} are {apart:.0} m apart; allowed is at most {reach} m for their class"
            ));
        }
        if places.touch(&from, &to).map_err(|e| e.to_string())? {
            return Err(format!("{} and {} touch; allowed are settlements with land between them", from.name, to.name));
        }
    }
    let wish = match edit {
        RoadEdit::Keep { .. } => Wish::Keep,
        RoadEdit::Ban { .. } => Wish::Ban,
        RoadEdit::Via { points, .. } => {
            for p in points {
                if terrain.sample(*p).depth() > 0.0 {
                    return Err(format!("{},{} lies in water; allowed is land", p.x, p.y));
                }
                if let Some(s) = settlement_at(places, *p).map_err(|e| e.to_string())? {
                    return Err(format!("{},{} lies in {}; allowed is land between settlements", p.x, p.y, s.name));
                }
                let around = p.distance(from.centre.plan()) + p.distance(to.centre.plan());
                if around > tier.detour * apart {
                    let most = tier.detour * apart;
                    return Err(format!(
                        "{},{} makes the way at least {around:.0} m long; allowed is at most {most:.0} m",
                        p.x, p.y
                    ));
                }
            }
            let mut points = points.clone();
            if turned {
                points.reverse();
            }
            Wish::Via(points)
        }
    };
    Ok((if turned { [to, from] } else { [from, to] }, wish))
}

/// Edits that the ground leaves no way for, besides those that were rejected at once.
pub(super) fn without_way(work: &Work, cancel: &crate::layer::Cancel) -> Result<Vec<RejectedEdit>, LayerError> {
    let mut out = Vec::new();
    let step = work.settings.step;
    for (index, [a, b], wish) in work.control.wanted() {
        let course = super::course::course(work, a, b, cancel)?;
        let reason = match (course, wish) {
            (None, _) => format!("the ground lets no road through between {} and {}", a.name, b.name),
            (Some(course), Wish::Via(points)) => {
                let line = course.line(step);
                let missed = points.iter().find(|p| distance_to_line(**p, &line) > super::led::VIA_STEPS * step as f64);
                let Some(p) = missed else { continue };
                format!("the ground lets no road through to {},{}; it takes its own way", p.x, p.y)
            }
            _ => continue,
        };
        out.push(RejectedEdit { list: EditList::Roads, index, reason });
    }
    let control = &work.control;
    for (point, index) in control.way_points.iter().zip(&control.way_point_edits) {
        let mut reached = false;
        for tier in SizeClass::ALL.into_iter().filter(|t| *t <= point.size) {
            reached = reached || !super::course::courses_of(work, tier, point, cancel)?.is_empty();
        }
        if !reached {
            let reason = format!("no road finds a way to {}; allowed is a place that one can reach", point.name);
            out.push(RejectedEdit { list: EditList::WayPoints, index: *index, reason });
        }
    }
    Ok(out)
}
