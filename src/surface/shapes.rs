//! The shapes of all streets and junctions around a square.

use crate::network::{Junction, JunctionId, Side, Street, StreetClass, StreetId};
use crate::space::Bounds;
use crate::surface::earthworks::BANK_REACH;
use crate::surface::element::Element;
use crate::surface::head::heads;
use crate::surface::junction::{FARTHEST_REACH, JunctionShape, StreetEnd, has_surface};
use crate::surface::profile::Profile;
use crate::surface::strip::{LONGEST_STRETCH, strip};
use glam::DVec2;
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
/// streets within [`SURFACE_REACH`] of it, sorted by id, and `window` is the square, in local metres. Traffic drives on
/// the side `driving`.
pub fn shapes(streets: &[Graded], window: Bounds, driving: Side) -> Vec<Element> {
    let near = window.grown(SURFACE_REACH);
    // Of junctions farther out not all streets are known.
    let junctions = meetings(streets.iter().map(|g| &g.street), |at| near.contains(at));
    let profile_of = |street: &Street| {
        let at = streets.binary_search_by_key(&street.id, |g| g.street.id).unwrap_or_default();
        &streets[at].profile
    };
    let heads = heads(streets.iter().map(|g| &g.street));
    let mut out = Vec::with_capacity(junctions.len() + 1);
    let mut ends: BTreeMap<StreetId, [Option<StreetEnd>; 2]> = BTreeMap::new();
    for Meeting { junction, arms } in junctions.values() {
        let Some(shape) = JunctionShape::new(junction, arms, heads.get(&junction.id)) else { continue };
        let greatest = shape.greatest();
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
        strip(&mut element, street, profile, ends.get(&street.id).unwrap_or(&unknown), window, driving);
        if !element.triangles.is_empty() {
            out.push(element);
        }
    }
    out
}

/// The streets on the ground or on decks that meet at the junctions whose streets are all known.
fn meetings<'a>(
    streets: impl Iterator<Item = &'a Street>,
    is_known: impl Fn(DVec2) -> bool,
) -> BTreeMap<JunctionId, Meeting<'a>> {
    let mut out: BTreeMap<JunctionId, Meeting<'a>> = BTreeMap::new();
    for street in streets.filter(|s| has_surface(s)) {
        let [first, last] = [street.line[0], street.line[street.line.len() - 1]];
        for (id, at, begins) in [(street.from, first, true), (street.to, last, false)] {
            if is_known(at) {
                let new = || Meeting { junction: Junction { id, at }, arms: Vec::new() };
                out.entry(id).or_insert_with(new).arms.push((street, begins));
            }
        }
    }
    out
}

/// The outlines of a junction with the ends of its streets, counter-clockwise, in local metres.
#[derive(Clone, Debug)]
pub struct JunctionOutline {
    /// Around the carriageway.
    pub carriageway: Vec<DVec2>,
    /// Around pavements or verges.
    pub outer: Vec<DVec2>,
    /// The most important class among the streets.
    pub class: StreetClass,
}

/// The outlines of the junctions in `bounds` between streets of which all that come into it are known.
pub fn junction_outlines<'a>(
    streets: impl Iterator<Item = &'a Street> + Clone,
    bounds: Bounds,
) -> Vec<JunctionOutline> {
    let heads = heads(streets.clone());
    let junctions = meetings(streets, |at| bounds.contains(at));
    let shapes = junctions.values().filter_map(|m| JunctionShape::new(&m.junction, &m.arms, heads.get(&m.junction.id)));
    let outline = |shape: JunctionShape<'_>| {
        let (class, outer) = (shape.greatest(), shape.outer());
        JunctionOutline { carriageway: shape.carriageway, outer, class }
    };
    shapes.map(outline).collect()
}
