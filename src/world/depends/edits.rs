//! What differs between two worlds of which only the edits differ.

use super::TOWN_STEPS;
use crate::edits::{Edits, PatchEdit, RoadEdit, SettlementEdit, Shape};
use crate::edits::{Influence, InfluenceMap, WayPoint};
use crate::layer::{Cancel, LayerError};
use crate::network::SizeClass;
use crate::network::StreetClass;
use crate::region::{Settlement, SettlementId};
use crate::space::{Bounds, ChunkCoord};
use crate::world::{Settings, World};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The boxes of the plan that an edit depends on and changes.
struct Place {
    /// The box that decides whether the edit can be fulfilled, if any does.
    looks: Option<Bounds>,
    /// The box that the edit may change.
    changes: Bounds,
}

/// How far edits of each kind change something, in metres.
struct Spreads<'a> {
    settings: &'a Settings,
    /// Distance from a settlement that comes, goes or moves to the ends of the outlines that it changes.
    settlement: f64,
    /// Distance from a gate to the farthest street that depends on it.
    town: f64,
    /// Largest radius of a settlement.
    radius: f64,
}

impl<'a> Spreads<'a> {
    fn new(settings: &'a Settings, edits: [&Edits; 2]) -> Self {
        let pinned = edits.into_iter().flat_map(|e| &e.settlements).filter_map(|e| match e {
            SettlementEdit::Pin { radius, .. } => *radius,
            _ => None,
        });
        let radius = pinned.fold(settings.settlements.largest_radius(), f64::max);
        let settlement = settings.settlements.change_reach(radius);
        // A changed gate changes its town, the seams of the next town, the parcels of a third, which read streets across a
        // border, and the cells of a fourth, as styles mix across a border.
        Self { settings, settlement, town: 8.0 * radius, radius }
    }

    fn settlement(&self, edit: &SettlementEdit) -> Place {
        let at = match edit {
            SettlementEdit::Pin { at, .. } => Bounds::of([*at]),
            // The settlement to move has its centre within its radius of `from`.
            SettlementEdit::Move { from, to } => Bounds::of([*from]).grown(self.radius).union(Bounds::of([*to])),
            SettlementEdit::Ban { at, radius } => Bounds::square(*at, 2.0 * radius),
        };
        let reach = self.settlement + self.settings.roads.change_reach_of_settlement() + self.town;
        Place { looks: Some(at.grown(self.settlement)), changes: at.grown(reach) }
    }

    fn influence(&self, influence: &Influence) -> Place {
        let points: &[DVec2] = match &influence.shape {
            Shape::Point(p) => std::slice::from_ref(p),
            Shape::Curve(line) => line,
            Shape::Area(border) => border,
        };
        let box_of_shape = Bounds::of(points.iter().copied()).grown(influence.radius);
        self.influenced(box_of_shape, &influence.classes)
    }

    fn influence_map(&self, map: &InfluenceMap) -> Place {
        self.influenced(map.cells.as_ref().map_or(Bounds::EMPTY, |c| c.bounds()), &map.classes)
    }

    /// What an influence on roads of some classes may change, if it reaches what lies in a box.
    fn influenced(&self, reached: Bounds, classes: &[StreetClass]) -> Place {
        let works_on = |tier: SizeClass| {
            let class = [StreetClass::Minor, StreetClass::Major, StreetClass::Highway][tier as usize];
            classes.is_empty() || classes.contains(&class)
        };
        let far = self.settings.roads.change_reach_of_influence(works_on) + self.town;
        Place { looks: None, changes: reached.grown(far) }
    }

    fn way_point(&self, point: &WayPoint) -> Place {
        let size = match point.class {
            StreetClass::Highway => SizeClass::City,
            StreetClass::Major => SizeClass::Town,
            _ => SizeClass::Village,
        };
        let at = Bounds::of([point.at]);
        let reach = self.settings.roads.change_reach_of_way_point(size) + self.town;
        Place { looks: Some(at.grown(self.settlement)), changes: at.grown(reach) }
    }

    fn road(&self, edit: &RoadEdit) -> Place {
        let ends = Bounds::of(edit.ends());
        // An edit whose ends are farther apart than roads of any class reach is rejected, so one end is enough.
        let [from, _] = edit.ends();
        let reach = self.radius + self.settings.roads.change_reach_of_road() + self.town;
        let looks = ends.grown(self.radius + self.settlement);
        Place { looks: Some(looks), changes: Bounds::of([from]).grown(reach) }
    }
}

/// A patch changes the town that it stands in.
fn patch(edit: &PatchEdit, radius: f64) -> Place {
    Place { looks: None, changes: Bounds::of([edit.at]).grown(2.0 * radius) }
}

/// For each element of two lists, whether it differs. Past the common beginning and end of the lists, an element differs if the
/// other list does not have it; all elements differ if the common ones stand in another order.
fn differing<'a, T: PartialEq>(before: &'a [T], after: &'a [T]) -> [Vec<bool>; 2] {
    let first = before.iter().zip(after).take_while(|(a, b)| a == b).count();
    let (rest, other) = (&before[first..], &after[first..]);
    let last = rest.iter().rev().zip(other.iter().rev()).take_while(|(a, b)| a == b).count();
    let (rest, other) = (&rest[..rest.len() - last], &other[..other.len() - last]);
    let mut free = vec![true; other.len()];
    let mut twin = |e: &T| {
        let found = (0..other.len()).find(|i| free[*i] && other[*i] == *e)?;
        free[found] = false;
        Some(found)
    };
    let twins: Vec<Option<usize>> = rest.iter().map(&mut twin).collect();
    let ordered = twins.iter().flatten().is_sorted();
    let same = |count: usize| std::iter::repeat_n(false, count);
    let before = twins.iter().map(|t| t.is_none() || !ordered);
    let after = free.iter().map(|f| *f || !ordered);
    [same(first).chain(before).chain(same(last)).collect(), same(first).chain(after).chain(same(last)).collect()]
}

/// Boxes of the plan (metres) outside of which two worlds of the same seed, settings, assets and terrain are equal: one with the
/// edits `before`, the other with the edits `after`. Both lists must have been checked.
///
/// The boxes hold everything that could change: mostly roads of all classes that take another way, and their gates in towns.
/// [`World::changed_chunks`] finds the far smaller part that does change.
pub fn changed_by_edits(settings: &Settings, before: &Edits, after: &Edits) -> Vec<Bounds> {
    let spreads = Spreads::new(settings, [before, after]);
    let mut places: Vec<(bool, Place)> = Vec::new();
    let mut list = |flags: [Vec<bool>; 2], made: [Vec<Place>; 2]| {
        for (flags, made) in flags.into_iter().zip(made) {
            places.extend(flags.into_iter().zip(made));
        }
    };
    let both = [before, after];
    let flags = differing(&before.settlements, &after.settlements);
    list(flags, both.map(|e| e.settlements.iter().map(|s| spreads.settlement(s)).collect()));
    let flags = differing(&before.influences, &after.influences);
    list(flags, both.map(|e| e.influences.iter().map(|i| spreads.influence(i)).collect()));
    let flags = differing(&before.influence_maps, &after.influence_maps);
    list(flags, both.map(|e| e.influence_maps.iter().map(|m| spreads.influence_map(m)).collect()));
    let flags = differing(&before.way_points, &after.way_points);
    list(flags, both.map(|e| e.way_points.iter().map(|w| spreads.way_point(w)).collect()));
    let flags = differing(&before.roads, &after.roads);
    list(flags, both.map(|e| e.roads.iter().map(|r| spreads.road(r)).collect()));
    let flags = differing(&before.patches, &after.patches);
    list(flags, both.map(|e| e.patches.iter().map(|p| patch(p, spreads.radius)).collect()));
    // An edit that looks at what another changes may become possible or impossible.
    let (mut changed, mut rest): (Vec<_>, Vec<_>) = places.into_iter().partition(|(differs, _)| *differs);
    let mut next = 0;
    while next < changed.len() {
        let reached = changed[next].1.changes;
        let looks = |p: &(bool, Place)| p.1.looks.is_some_and(|l| l.overlaps(reached));
        let (more, others) = rest.into_iter().partition(looks);
        rest = others;
        changed.extend::<Vec<_>>(more);
        next += 1;
    }
    let mut out: Vec<Bounds> = changed.into_iter().map(|(_, place)| place.changes).collect();
    out.dedup();
    out
}

/// Two worlds, and what is known about their towns.
struct Comparison<'a> {
    worlds: [&'a World; 2],
    cancel: &'a Cancel,
    /// Whether a town has the same outline and gates in both.
    same: BTreeMap<SettlementId, bool>,
}

impl Comparison<'_> {
    /// Whether a town is the same, and so is every town that at most `rings` steps from town to touching town reach.
    fn same_town(&mut self, s: &Arc<Settlement>, rings: usize) -> Result<bool, LayerError> {
        let [a, b] = self.worlds;
        let same = match self.same.get(&s.id) {
            Some(known) => *known,
            None => {
                let outlines = a.settlements().outline(s)? == b.settlements().outline(s)?;
                let same = outlines && a.roads().gates(s, self.cancel)? == b.roads().gates(s, self.cancel)?;
                self.same.insert(s.id, same);
                same
            }
        };
        if !same || rings == 0 {
            return Ok(same);
        }
        let touching = a.settlements().touching(s)?;
        if touching != b.settlements().touching(s)? {
            return Ok(false);
        }
        for other in touching {
            if !self.same_town(&other, rings - 1)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether the same patches are pinned in a town.
    fn same_pins(&self, s: &Settlement) -> Result<bool, LayerError> {
        let [a, b] = self.worlds.map(|w| &w.edits().patches);
        if a == b {
            return Ok(true);
        }
        let outline = self.worlds[0].settlements().outline(s)?;
        Ok(a.iter().filter(|p| outline.contains(p.at)).eq(b.iter().filter(|p| outline.contains(p.at))))
    }

    fn same_chunk(&mut self, bounds: Bounds) -> Result<bool, LayerError> {
        self.cancel.check()?;
        let [a, b] = self.worlds;
        let settlements = a.settlements().overlapping(bounds)?;
        if settlements != b.settlements().overlapping(bounds)?
            || a.roads().overlapping(bounds, self.cancel)? != b.roads().overlapping(bounds, self.cancel)?
        {
            return Ok(false);
        }
        for s in settlements {
            if !self.same_town(&s, TOWN_STEPS)? || !self.same_pins(&s)? {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

impl World {
    /// The chunks among `chunks` that may differ from the same chunks of `before`, a world of the same seed, settings, assets
    /// and terrain with other edits. All other chunks are equal. In the boxes of [`changed_by_edits`], roads, settlements and
    /// gates of both worlds are compared, which makes the roads of this world there.
    pub fn changed_chunks(
        &self,
        before: &World,
        chunks: impl IntoIterator<Item = ChunkCoord>,
        cancel: &Cancel,
    ) -> Result<BTreeSet<ChunkCoord>, LayerError> {
        let size = self.settings().chunk_size;
        let reached = changed_by_edits(self.settings(), before.edits(), self.edits());
        let mut comparison = Comparison { worlds: [before, self], cancel, same: BTreeMap::new() };
        let mut out = BTreeSet::new();
        for coord in chunks {
            let bounds = coord.bounds(size);
            if reached.iter().any(|r| r.overlaps(bounds)) && !comparison.same_chunk(bounds)? {
                out.insert(coord);
            }
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_differ_where_elements_come_go_or_change_places() {
        let flags = |a: &[u8], b: &[u8]| differing(a, b).map(|f| f.iter().map(|f| u8::from(*f)).collect::<Vec<_>>());
        assert_eq!(flags(&[1, 2, 3], &[1, 2, 3]), [vec![0; 3], vec![0; 3]]);
        assert_eq!(flags(&[1, 2, 3, 4], &[1, 3, 9, 4]), [vec![0, 1, 0, 0], vec![0, 0, 1, 0]]);
        assert_eq!(flags(&[1, 1], &[1]), [vec![0, 1], vec![0]]);
        assert_eq!(flags(&[5, 1, 2, 6], &[5, 2, 1, 6]), [vec![0, 1, 1, 0], vec![0, 1, 1, 0]]);
        assert_eq!(flags(&[], &[7]), [vec![], vec![1]]);
    }

    #[test]
    fn an_edit_that_looks_at_a_changed_place_is_changed_too() {
        let settings = Settings::default();
        let pin = |x: f64| SettlementEdit::Pin {
            at: DVec2::new(x, 0.0),
            size: SizeClass::Town,
            name: None,
            style: None,
            radius: None,
        };
        let edits =
            |places: &[f64]| Edits { settlements: places.iter().map(|x| pin(*x)).collect(), ..Edits::default() };
        let changed = |a: &[f64], b: &[f64]| changed_by_edits(&settings, &edits(a), &edits(b));
        assert!(changed(&[0.0, 1e6], &[0.0, 1e6]).is_empty());
        let alone = changed(&[1e6], &[0.0, 1e6]);
        assert_eq!(alone.len(), 1);
        let reach = alone[0].max.x;
        assert!(alone[0].contains(DVec2::ZERO) && reach < 2e5);
        assert_eq!(changed(&[2.0 * reach], &[0.0, 2.0 * reach]).len(), 1);
        assert_eq!(changed(&[reach], &[0.0, reach]).len(), 2);
        assert_eq!(changed(&[reach, 1.5 * reach, 4.0 * reach], &[0.0, reach, 1.5 * reach, 4.0 * reach]).len(), 3);
    }
}
