//! Heads of dead ends: circles in which vehicles turn.

use crate::network::{JunctionId, Street, StreetClass, StreetId};
use crate::space::{distance_to_line, math};
use crate::surface::section::CrossSection;
use glam::DVec2;
use std::collections::BTreeMap;

/// Radius of the carriageway of a head, in metres.
const RADIUS: f64 = 6.5;

/// No head has a greater radius than this, in metres.
const WIDEST: f64 = 12.0;

/// Least distance between a head and other streets, in metres.
const CLEARANCE: f64 = 0.5;

/// Least length of a street that ends in a head, in metres.
const LEAST_LENGTH: f64 = 30.0;

/// Number of sides of a head's outline from one edge of its street around to the other.
const SIDES: u32 = 12;

/// The head of a dead end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Head {
    /// The end of the street.
    pub at: DVec2,
    /// Unit direction in which the street leaves it.
    pub direction: DVec2,
    class: StreetClass,
}

impl Head {
    /// Radius of the outline that lies `half` metres from the street's centre line beside the street, in metres.
    pub fn radius(&self, half: f64) -> f64 {
        half + RADIUS - CrossSection::of(self.class).carriageway
    }

    /// Radius of the whole head, in metres.
    fn outer(&self) -> f64 {
        self.radius(CrossSection::of(self.class).outer)
    }

    /// Distance along the street from its end to where that outline begins, in metres.
    pub fn reach(&self, half: f64) -> f64 {
        let radius = self.radius(half);
        (radius * radius - half * half).sqrt()
    }

    /// The points of that outline, relative to the end of the street, from the street's left edge, seen from there, around to its
    /// right edge.
    pub fn around(&self, half: f64) -> impl Iterator<Item = DVec2> {
        let left = self.direction * self.reach(half) + self.direction.perp() * half;
        let turn = math::angle_between(self.direction, left);
        let sweep = std::f64::consts::TAU - 2.0 * turn;
        (0..=SIDES).map(move |k| math::rotate(left, sweep * f64::from(k) / f64::from(SIDES)))
    }
}

/// The heads among `streets` by their junctions: local streets end in one where nothing else is near. All streets within 30 m of
/// a dead end must be known.
pub(super) fn heads<'a>(streets: impl Iterator<Item = &'a Street> + Clone) -> BTreeMap<JunctionId, Head> {
    let mut ends: BTreeMap<JunctionId, Vec<(&Street, DVec2, DVec2)>> = BTreeMap::new();
    for street in streets.clone() {
        let n = street.line.len();
        if n < 2 {
            continue;
        }
        for (id, at, next) in [(street.from, 0, 1), (street.to, n - 1, n - 2)] {
            ends.entry(id).or_default().push((street, street.line[at], street.line[next]));
        }
    }
    let mut found: Vec<(Head, JunctionId, StreetId)> = Vec::new();
    for (id, arms) in ends {
        let [(street, at, next)] = arms[..] else { continue };
        if street.class != StreetClass::Local || street.bridge || street.tunnel || street.length() < LEAST_LENGTH {
            continue;
        }
        let head = Head { at, direction: (next - at).normalize_or_zero(), class: street.class };
        // The street is straight within its head.
        if at.distance(next) >= head.outer() {
            found.push((head, id, street.id));
        }
    }
    found.sort_by(|a, b| a.0.at.x.total_cmp(&b.0.at.x).then(a.1.cmp(&b.1)));
    let mut crowded = vec![false; found.len()];
    for street in streets.filter(|s| !s.tunnel) {
        let beside = street.class.half_width() + CLEARANCE;
        let near = street.bounds().grown(beside + WIDEST);
        let [first, last] = [near.min.x, near.max.x].map(|x| found.partition_point(|(head, ..)| head.at.x < x));
        for ((head, _, own), crowded) in found[first..last].iter().zip(&mut crowded[first..last]) {
            *crowded |= *own != street.id
                && near.contains(head.at)
                && distance_to_line(head.at, &street.line) < head.outer() + beside;
        }
    }
    let clear = found.into_iter().zip(crowded).filter(|(_, crowded)| !crowded);
    clear.map(|((head, id, _), _)| (id, head)).collect()
}
