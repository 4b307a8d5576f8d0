//! Settlements that the user pinned and moved, and where the user wants none.

use super::{LEAST_REACH, NEIGHBOUR, SettlementSettings, Settlements, apart, name, site};
use crate::edits::{EditList, RejectedEdit, SettlementEdit};
use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::region::{Settlement, SettlementId};
use crate::space::{Bounds, Origin, math, stable_hash};
use crate::terrain::Terrain;
use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Marks the ids of pinned settlements.
const WORD: u64 = 0x0070_696e;
/// Rays that the ground of a place is looked at along.
const RAYS: usize = 32;

/// A circle: the square around it, with its centre and radius.
type Circle = GeomWithData<Rectangle<[f64; 2]>, (DVec2, f64)>;

/// What edits change of the settlements of the lattices.
#[derive(Debug, Default)]
pub(super) struct Placed {
    settlements: Vec<Arc<Settlement>>,
    /// Index of the edit that placed each.
    edits: Vec<usize>,
    /// Centres of the placed settlements, with their index.
    centres: RTree<GeomWithData<[f64; 2], usize>>,
    /// Where there are no settlements of a lattice.
    bans: RTree<Circle>,
    /// Settlements of a lattice that stand elsewhere, sorted.
    moved: Vec<SettlementId>,
    /// Greatest radius of a placed settlement.
    pub largest: f64,
    /// Edits that cannot be.
    pub rejected: Vec<RejectedEdit>,
}

impl Placed {
    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.settlements.is_empty() && self.bans.size() == 0
    }

    /// Placed settlements whose centre lies in `bounds`.
    pub fn centred_in(&self, bounds: Bounds) -> impl Iterator<Item = &Arc<Settlement>> {
        self.centres
            .locate_in_envelope(AABB::from_corners(bounds.min.to_array(), bounds.max.to_array()))
            .map(|c| &self.settlements[c.data])
    }

    /// Whether a settlement of a lattice is here no more because of a ban or a move.
    fn gone(&self, s: &Settlement) -> bool {
        let at = s.centre.plan();
        self.moved.binary_search(&s.id).is_ok()
            || self.bans.locate_all_at_point(at.to_array()).any(|b| at.distance(b.data.0) <= b.data.1)
    }

    fn put(&mut self, edit: usize, s: Settlement) {
        let centre = s.centre.plan().to_array();
        self.centres.insert(GeomWithData::new(centre, self.settlements.len()));
        self.largest = self.largest.max(s.radius);
        self.edits.push(edit);
        self.settlements.push(Arc::new(s));
    }
}

impl SettlementSettings {
    /// Distance in metres from where a settlement comes, goes or moves to the ends of the outlines that differ: `largest` is the
    /// radius of the largest. Others give way to it, their neighbours have other outlines, and so do those with whom these
    /// share a border.
    pub(crate) fn spread(&self, largest: f64) -> f64 {
        let apart = apart(self, largest, largest);
        apart + 2.0 * (2.0 * largest + NEIGHBOUR) + largest
    }
}

/// Why a settlement cannot stand at a place, if it cannot.
fn unfit(terrain: &dyn Terrain, centre: DVec2, max_slope: f64) -> Option<String> {
    if terrain.sample(centre).depth() > 0.0 {
        return Some(format!("{},{} lies in water; allowed is land", centre.x, centre.y));
    }
    let mut ground = terrain.scan();
    let least = LEAST_REACH;
    let blocked = (0..RAYS).any(|i| {
        let way = math::direction(i as f64 / RAYS as f64 * TAU);
        let course = site::Course { centre, way, from: 0.0, limit: 1.5 * least, fine: f64::INFINITY };
        site::ray(&mut ground, course, max_slope).reach < least
    });
    blocked
        .then(|| format!("{},{} has water or steep ground within {least} m; allowed is even land", centre.x, centre.y))
}

impl Settlements {
    /// Whether a settlement of a lattice stays where the user placed others, moved it, or wants none.
    pub(super) fn stands(&self, s: &Settlement) -> bool {
        self.placed.is_empty() || !(self.placed.gone(s) || self.rival(s.centre, s.radius).is_some())
    }

    /// A placed settlement that one of `radius` at `centre` is too near.
    fn rival(&self, centre: Origin, radius: f64) -> Option<usize> {
        let near = Bounds::square(centre.plan(), 2.0 * self.apart(radius, self.placed.largest));
        let near = AABB::from_corners(near.min.to_array(), near.max.to_array());
        let found = self.placed.centres.locate_in_envelope(near).map(|c| c.data);
        found.filter(|i| self.conflict(&self.placed.settlements[*i], centre, radius)).min()
    }

    /// Places what `edits` say, in their order; `has_style` knows the names of styles.
    pub(super) fn place(&mut self, edits: &[SettlementEdit], has_style: impl Fn(&str) -> bool) {
        for edit in edits {
            if let SettlementEdit::Ban { at, radius } = edit {
                let square = Rectangle::from_corners((*at - *radius).to_array(), (*at + *radius).to_array());
                self.placed.bans.insert(GeomWithData::new(square, (*at, *radius)));
            }
        }
        for (index, edit) in edits.iter().enumerate() {
            let made = match edit {
                SettlementEdit::Pin { at, size, name, style, radius } => {
                    let unknown = style.as_ref().filter(|s| !has_style(s));
                    match unknown {
                        Some(style) => Err(format!("style `{style}` is not among the styles")),
                        None => Ok(self.pin(*at, *size, [name, style], *radius)),
                    }
                }
                SettlementEdit::Move { from, to } => self.moving(*from).map_err(|e| e.to_string()).and_then(|found| {
                    let found =
                        found.ok_or_else(|| format!("no settlement of a lattice is at {},{}", from.x, from.y))?;
                    Ok(Settlement { centre: Origin::at(*to + 0.5), ..Settlement::clone(&found) })
                }),
                SettlementEdit::Ban { .. } => continue,
            };
            match made.and_then(|s| self.fits(&s).map(|()| s)) {
                Ok(s) => {
                    if matches!(edit, SettlementEdit::Move { .. }) {
                        let at = self.placed.moved.partition_point(|id| *id < s.id);
                        self.placed.moved.insert(at, s.id);
                    }
                    self.placed.put(index, s);
                }
                Err(reason) => self.placed.rejected.push(RejectedEdit { list: EditList::Settlements, index, reason }),
            }
        }
    }

    fn pin(&self, at: DVec2, size: SizeClass, [name, style]: [&Option<String>; 2], radius: Option<f64>) -> Settlement {
        let centre = Origin::at(at + 0.5);
        let place = [centre.0.x as u64, centre.0.y as u64];
        let mut stream = self.seed.stream("pinned settlement", &place);
        let s = &self.settings;
        let drawn = s.draw_style(&mut stream, size);
        let range = *s.radius.of(size);
        Settlement {
            id: SettlementId(stable_hash(&[WORD, place[0], place[1]]).max(1)),
            centre,
            radius: radius.unwrap_or((range.0 + range.1) / 2.0),
            size,
            style: style.clone().unwrap_or(drawn),
            name: name.clone().unwrap_or_else(|| name::place_name(&mut stream, size)),
        }
    }

    /// The settlement of a lattice whose circle holds a point and whose centre is nearest to it, among those not gone.
    fn moving(&self, from: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
        let mut best: Option<(f64, Arc<Settlement>)> = None;
        for size in SizeClass::ALL {
            let near = Bounds::square(from, 2.0 * self.settings.radius.of(size).1);
            self.accepted_in(near, size, |s| {
                let apart = s.centre.plan().distance(from);
                let nearer = best.as_ref().is_none_or(|(b, of)| (apart, s.id) < (*b, of.id));
                if apart <= s.radius && nearer && !self.placed.gone(&s) {
                    best = Some((apart, s));
                }
            })?;
        }
        Ok(best.map(|b| b.1))
    }

    fn fits(&self, s: &Settlement) -> Result<(), String> {
        if let Some(i) = self.rival(s.centre, s.radius) {
            return Err(format!(
                "too near that of {}[{}]; allowed is further from it",
                EditList::Settlements.name(),
                self.placed.edits[i]
            ));
        }
        unfit(&*self.terrain.0, s.centre.plan(), self.settings.max_slope).map_or(Ok(()), Err)
    }
}

#[cfg(test)]
mod tests;
