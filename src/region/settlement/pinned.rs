//! The user's edits of settlements: pinned and moved ones, and areas without any.

use super::lattice::Lattices;
use super::model::{Settlement, SettlementId};
use super::name;
use super::ray::{Detail, LEAST_REACH, Ray};
use super::settings::SettlementSettings;
use super::spacing::{conflict, conflict_distance};
use crate::edits::{EditList, RejectedEdit, SettlementEdit};
use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::space::{Bounds, Origin, Seed, math, stable_hash};
use crate::terrain::Terrain;
use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Distinguishes the ids of pinned settlements from other hashes.
const WORD: u64 = 0x0070_696e;
/// Number of rays along which the ground of a pinned settlement is checked.
const RAYS: usize = 32;

/// A circle in the index: the square around it, with its centre and radius.
type Circle = GeomWithData<Rectangle<[f64; 2]>, (DVec2, f64)>;

/// The changes that edits make to the settlements of the lattices.
#[derive(Debug, Default)]
pub(in crate::region) struct Pinned {
    settlements: Vec<Arc<Settlement>>,
    /// Index of the edit that made each settlement.
    edits: Vec<usize>,
    /// Centres of the settlements, with their indices.
    centres: RTree<GeomWithData<[f64; 2], usize>>,
    /// Circles that hold no settlement of a lattice.
    bans: RTree<Circle>,
    /// Ids of the lattices' settlements that were moved away, sorted.
    moved: Vec<SettlementId>,
    /// Largest radius of a pinned or moved settlement, in metres.
    pub largest: f64,
    /// Edits that cannot be carried out.
    pub rejected: Vec<RejectedEdit>,
}

/// Why a settlement cannot stand at a place; `None` if it can.
fn unsuitable(terrain: &dyn Terrain, centre: DVec2, max_slope: f64) -> Option<String> {
    if terrain.sample(centre).depth() > 0.0 {
        return Some(format!("{},{} lies in water; a settlement needs land", centre.x, centre.y));
    }
    let mut ground = terrain.scan_ground();
    let blocked = (0..RAYS).any(|i| {
        let direction = math::direction(i as f64 / RAYS as f64 * TAU);
        let ray = Ray { centre, direction, from: 0.0, limit: 1.5 * LEAST_REACH, detail: Detail::Full };
        ray.cast(&mut ground, max_slope).reach < LEAST_REACH
    });
    blocked.then(|| {
        format!(
            "{},{} has water or steep ground within {LEAST_REACH} m; a settlement needs even land around it",
            centre.x, centre.y
        )
    })
}

impl Pinned {
    /// Carries out `edits` in their order. The edits must have been checked; `has_style` tells whether a style of that name
    /// exists.
    pub fn new(lattices: &Lattices, edits: &[SettlementEdit], has_style: impl Fn(&str) -> bool) -> Self {
        let mut out = Self::default();
        for edit in edits {
            if let SettlementEdit::Ban { at, radius } = edit {
                let square = Rectangle::from_corners((*at - *radius).to_array(), (*at + *radius).to_array());
                out.bans.insert(GeomWithData::new(square, (*at, *radius)));
            }
        }
        for (index, edit) in edits.iter().enumerate() {
            let made = match edit {
                SettlementEdit::Pin { at, size, name, style, radius } => {
                    match style.as_ref().filter(|s| !has_style(s)) {
                        Some(style) => Err(format!("style `{style}` is not among the styles")),
                        None => Ok(pin(lattices.seed, &lattices.settings, *at, *size, [name, style], *radius)),
                    }
                }
                SettlementEdit::Move { from, to } => {
                    out.movable(lattices, *from).map_err(|e| e.to_string()).and_then(|found| {
                        let found =
                            found.ok_or_else(|| format!("there is no settlement to move at {},{}", from.x, from.y))?;
                        Ok(Settlement { centre: Origin::at(*to + 0.5), ..Settlement::clone(&found) })
                    })
                }
                SettlementEdit::Ban { .. } => continue,
            };
            match made.and_then(|s| out.fits(lattices, &s).map(|()| s)) {
                Ok(s) => {
                    if matches!(edit, SettlementEdit::Move { .. }) {
                        let at = out.moved.partition_point(|id| *id < s.id);
                        out.moved.insert(at, s.id);
                    }
                    out.put(index, s);
                }
                Err(reason) => out.rejected.push(RejectedEdit { list: EditList::Settlements, index, reason }),
            }
        }
        out
    }

    /// Pinned and moved settlements whose centre lies in `bounds`.
    pub fn centred_in(&self, bounds: Bounds) -> impl Iterator<Item = &Arc<Settlement>> {
        self.centres
            .locate_in_envelope(AABB::from_corners(bounds.min.to_array(), bounds.max.to_array()))
            .map(|c| &self.settlements[c.data])
    }

    /// Whether the edits leave a settlement of a lattice in place: it is neither moved nor banned, and conflicts with no
    /// pinned one.
    pub fn leaves(&self, settings: &SettlementSettings, s: &Settlement) -> bool {
        let empty = self.settlements.is_empty() && self.bans.size() == 0;
        empty || !(self.removes(s) || self.rival(settings, s.centre, s.radius).is_some())
    }

    /// Whether a settlement of a lattice is moved away or banned.
    fn removes(&self, s: &Settlement) -> bool {
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

    /// Index of the first pinned settlement that conflicts with a settlement of `radius` at `centre`.
    fn rival(&self, settings: &SettlementSettings, centre: Origin, radius: f64) -> Option<usize> {
        let near = Bounds::square(centre.plan(), 2.0 * conflict_distance(settings, radius, self.largest));
        let near = AABB::from_corners(near.min.to_array(), near.max.to_array());
        let found = self.centres.locate_in_envelope(near).map(|c| c.data);
        found.filter(|i| conflict(settings, &self.settlements[*i], centre, radius)).min()
    }

    /// The settlement of a lattice whose circle holds a point; of several, the one with the nearest centre. Settlements that
    /// earlier edits removed do not count.
    fn movable(&self, lattices: &Lattices, from: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
        let mut best: Option<(f64, Arc<Settlement>)> = None;
        for size in SizeClass::ALL {
            let near = Bounds::square(from, 2.0 * lattices.settings.radius.of(size).1);
            lattices.accepted_in(near, size, |s| {
                let apart = s.centre.plan().distance(from);
                let nearer = best.as_ref().is_none_or(|(b, of)| (apart, s.id) < (*b, of.id));
                if apart <= s.radius && nearer && !self.removes(&s) {
                    best = Some((apart, s));
                }
            })?;
        }
        Ok(best.map(|b| b.1))
    }

    fn fits(&self, lattices: &Lattices, s: &Settlement) -> Result<(), String> {
        if let Some(i) = self.rival(&lattices.settings, s.centre, s.radius) {
            let (list, other) = (EditList::Settlements.name(), self.edits[i]);
            return Err(format!("too near the settlement of {list}[{other}]; move one of them farther away"));
        }
        unsuitable(lattices.terrain(), s.centre.plan(), lattices.settings.max_slope).map_or(Ok(()), Err)
    }
}

/// The settlement of a pin. What the pin leaves open is drawn from the seed and the position.
pub(in crate::region) fn pin(
    seed: Seed,
    settings: &SettlementSettings,
    at: DVec2,
    size: SizeClass,
    [name, style]: [&Option<String>; 2],
    radius: Option<f64>,
) -> Settlement {
    let centre = Origin::at(at + 0.5);
    let place = [centre.0.x as u64, centre.0.y as u64];
    let mut stream = seed.stream("pinned settlement", &place);
    let drawn = settings.draw_style(&mut stream, size);
    let range = *settings.radius.of(size);
    Settlement {
        id: SettlementId(stable_hash(&[WORD, place[0], place[1]]).max(1)),
        centre,
        radius: radius.unwrap_or((range.0 + range.1) / 2.0),
        size,
        style: style.clone().unwrap_or(drawn),
        name: name.clone().unwrap_or_else(|| name::settlement_name(&mut stream, size)),
    }
}
