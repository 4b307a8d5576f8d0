//! The shapes of all streets and junctions around a square.

use crate::network::{Junction, JunctionId, Street, StreetClass, StreetId};
use crate::space::Bounds;
use crate::surface::earthworks::BANK_REACH;
use crate::surface::element::Element;
use crate::surface::junction::{FARTHEST_REACH, JunctionShape, StreetEnd, has_surface};
use crate::surface::profile::Profile;
use crate::surface::strip::{LONGEST_STRETCH, strip};
use std::collections::BTreeMap;

/// Distance from a square within which streets and junctions change something in it, in metres: the part of a street that belongs
/// to a junction, with the paint beside it, and the longest stretches that begin there.
pub const SURFACE_REACH: f64 = FARTHEST_REACH + 2.0 * LONGEST_STRETCH;

const _: () = assert!(SURFACE_REACH > BANK_REACH + 8.0);

/// A street with its profile.
#[derive(Clone, Debug)]
pub struct Graded {
    /// The street.
    pub street: Street,
    /// Its heights; for a bridge, the heights of its [`Deck`](super::Deck).
    pub profile: Profile,
}

/// A junction with the streets there, each with whether it begins there.
struct Meeting<'a> {
    junction: Junction,
    arms: Vec<(&'a Street, bool)>,
}

/// The shapes of streets and junctions that come into a square, in an order that every square agrees on. `streets` are all
/// streets within [`SURFACE_REACH`] of it, sorted by id, and `window` is the square, in local metres.
pub fn shapes(streets: &[Graded], window: Bounds) -> Vec<Element> {
    let near = window.grown(SURFACE_REACH);
    let mut junctions: BTreeMap<JunctionId, Meeting<'_>> = BTreeMap::new();
    for street in streets.iter().map(|g| &g.street).filter(|s| has_surface(s)) {
        let [first, last] = [street.line[0], street.line[street.line.len() - 1]];
        for (id, at, begins) in [(street.from, first, true), (street.to, last, false)] {
            // Of junctions farther out not all streets are known.
            if near.contains(at) {
                let new = || Meeting { junction: Junction { id, at }, arms: Vec::new() };
                junctions.entry(id).or_insert_with(new).arms.push((street, begins));
            }
        }
    }
    let profile_of = |street: &Street| {
        let at = streets.binary_search_by_key(&street.id, |g| g.street.id).unwrap_or_default();
        &streets[at].profile
    };
    let mut out = Vec::with_capacity(junctions.len() + 1);
    let mut ends: BTreeMap<StreetId, [Option<StreetEnd>; 2]> = BTreeMap::new();
    for Meeting { junction, arms } in junctions.values() {
        let Some(shape) = JunctionShape::new(junction, arms) else { continue };
        let greatest = shape.arms.iter().map(|arm| arm.street.class).min().unwrap_or(StreetClass::Local);
        for arm in &shape.arms {
            let end = StreetEnd { cut: arm.cut, streets: shape.arms.len(), greatest };
            ends.entry(arm.street.id).or_default()[usize::from(!arm.begins)] = Some(end);
        }
        if window.grown(FARTHEST_REACH + 8.0).contains(junction.at) {
            out.push(shape.element(profile_of));
        }
    }
    let unknown = [None, None];
    for Graded { street, profile } in streets.iter().filter(|g| has_surface(&g.street) && !g.street.bridge) {
        let mut element = Element::default();
        strip(&mut element, street, profile, ends.get(&street.id).unwrap_or(&unknown), window);
        if !element.triangles.is_empty() {
            out.push(element);
        }
    }
    out
}
