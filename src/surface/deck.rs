//! Decks of bridges: the surface to stand on where there is no ground underfoot.

use crate::network::{Street, StreetId};
use crate::region::{OVERPASS_CLEARANCE, overpass_profile};
use crate::space::{
    Bounds, Origin, closest_on_line, closest_on_segment, cut_line, left_normal, point_at, quantize, resample,
    segment_crossing, segments,
};
use crate::surface::junction::deck_reach;
use crate::surface::profile::Profile;
use crate::surface::section::{CrossSection, KERB_HEIGHT};
use glam::DVec2;

/// Distance between the points of a deck's line, in metres.
const DECK_STEP: f64 = 8.0;

/// Height of the middle of a town's bridge above the straight line between its ends, as a share of the bridge's length.
const HUMP_SHARE: f64 = 0.03;

/// Greatest height of that hump, in metres.
const MOST_HUMP: f64 = 2.0;

/// Least height of a deck above the ground under it, in metres, apart from its ends.
const ABOVE_GROUND: f64 = 0.3;

/// The deck of a bridge, with its height profile.
///
/// A deck runs from the height of one end to the height of the other, in towns with a slight hump. It is higher only where the
/// ground in between is higher and where the bridge passes over another street, as far as the greatest grade of bridges allows.
#[derive(Clone, Debug, PartialEq)]
pub struct Deck {
    /// The bridge.
    pub street: StreetId,
    /// Centre line, local to the chunk, in metres.
    pub line: Vec<DVec2>,
    /// Height of the carriageway at each point of the line, in metres.
    pub heights: Vec<f64>,
    /// Widths of the deck.
    pub section: CrossSection,
    /// Points where the bridge passes over other streets: no pier stands near them.
    pub crossings: Vec<DVec2>,
    /// Profile of the whole street, the parts at its ends that lie on the ground included.
    pub profile: Profile,
}

impl Deck {
    /// The deck of a bridge between the parts that belong to the junctions at its ends. `ground` gives the height at a plan
    /// point that the deck stays above, and that its ends have. `below` are the streets that the bridge may pass over, with
    /// their profiles. Streets are local to `origin`.
    pub fn new(
        street: &Street,
        origin: Origin,
        below: &[(Street, Profile)],
        mut ground: impl FnMut(DVec2) -> f64,
    ) -> Self {
        let section = CrossSection::of(street.class);
        let length = street.length().max(1e-3);
        let start = street.line[0];
        let whole: Vec<DVec2> = street.line.iter().map(|p| *p - start).collect();
        let ends = [start, street.line[street.line.len() - 1]].map(|p| ground(origin.to_plan(p)));
        let straight = |share: f64| ends[0] + (ends[1] - ends[0]) * share;
        // Quays are low: a bridge between them rises to let boats pass.
        let hump = if street.class.is_main() { MOST_HUMP.min(HUMP_SHARE * length) } else { 0.0 };
        let passed: Vec<(DVec2, f64, f64)> = crossings(&whole, start, below);
        let reach = deck_reach(street);
        let profile = Profile::above(street, origin, ends, |along, p| {
            let t = (along / length).min(1.0);
            let mut least = straight(t) + 4.0 * hump * t * (1.0 - t);
            if along > reach && along < length - reach {
                let d = point_at(&whole, along).1;
                let across = left_normal(d) * section.outer;
                let highest =
                    [across, DVec2::ZERO, -across].map(|q| ground(p + q)).into_iter().fold(f64::MIN, f64::max);
                least = least.max(highest + ABOVE_GROUND);
            }
            for (_, at, height) in &passed {
                let lift = (height + OVERPASS_CLEARANCE - straight(at / length)).max(0.0);
                let side = if along < *at { *at } else { length - at };
                least = least.max(straight(t) + lift * overpass_profile((along - at) / side.max(1e-3)));
            }
            least
        });
        let line = resample(&cut_line(&whole, reach, length - reach), DECK_STEP);
        let (mut along, mut heights) = (reach, Vec::with_capacity(line.len()));
        for (i, p) in line.iter().enumerate() {
            along += if i > 0 { line[i - 1].distance(*p) } else { 0.0 };
            heights.push(profile.height(along));
        }
        let line = line.into_iter().map(|p| start + quantize(p)).collect();
        let crossings = passed.into_iter().map(|(point, ..)| point + start).collect();
        Self { street: street.id, line, heights, section, crossings, profile }
    }

    /// Height of the deck at a local point in metres, if the point lies on the deck.
    pub fn height(&self, p: DVec2) -> Option<f64> {
        let mut best: Option<(f64, f64)> = None;
        for (line, heights) in self.line.windows(2).zip(self.heights.windows(2)) {
            let (t, at) = closest_on_segment(p, line[0], line[1]);
            let off = at.distance(p);
            if off <= self.section.outer && best.is_none_or(|(least, _)| off < least) {
                best = Some((off, heights[0] + (heights[1] - heights[0]) * t));
            }
        }
        let raised = |off: f64| self.section.paved && off > self.section.carriageway;
        best.map(|(off, height)| if raised(off) { height + KERB_HEIGHT } else { height })
    }
}

/// Where a line crosses streets below: the point, the distance along the line, and the height of the street there. The line and
/// the points are relative to `start`.
fn crossings(line: &[DVec2], start: DVec2, below: &[(Street, Profile)]) -> Vec<(DVec2, f64, f64)> {
    let bounds = Bounds::of(line.iter().copied()).moved(start);
    let mut out: Vec<(DVec2, f64, f64)> = Vec::new();
    for (street, profile) in below.iter().filter(|(s, _)| s.bounds().overlaps(bounds)) {
        for (c, d) in segments(&street.line) {
            let mut along = 0.0;
            for (a, b) in segments(line) {
                if let Some(x) = segment_crossing(a, b, c - start, d - start)
                    && out.iter().all(|o| o.0 != x.at)
                {
                    let height = profile.height(closest_on_line(x.at + start, &street.line).0);
                    out.push((x.at, along + a.distance(x.at), height));
                }
                along += a.distance(b);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{JunctionId, StreetClass};

    #[test]
    fn a_deck_runs_from_bank_to_bank_above_the_ground() {
        // A valley 20 m deep with an island that is higher than the banks.
        let ground = |p: DVec2| match p.x {
            x if (30.0..90.0).contains(&x) => 80.0,
            x if (90.0..110.0).contains(&x) => 102.0,
            x if (110.0..170.0).contains(&x) => 80.0,
            _ => 100.0 + p.x * 0.01,
        };
        let line = vec![DVec2::ZERO, DVec2::X * 200.0];
        let street =
            Street { bridge: true, ..Street::new(StreetId(1), StreetClass::Minor, JunctionId(1), JunctionId(2), line) };
        let deck = Deck::new(&street, Origin::default(), &[], ground);
        let reach = deck_reach(&street);
        let at = |x: f64, y: f64| deck.height(DVec2::new(x, y));
        assert!((at(reach + 0.01, 0.0).unwrap() - ground(DVec2::ZERO)).abs() < 0.01);
        assert!(at(60.0, 2.0).unwrap() > 100.4, "{:?}", at(60.0, 2.0));
        assert!(at(100.0, 0.0).unwrap() > 102.0);
        assert_eq!(at(60.0, StreetClass::Minor.half_width() + 0.1), None);
        assert_eq!(at(200.0, 0.0), None, "the junction's part lies on the ground");
    }

    #[test]
    fn a_deck_clears_the_street_that_it_passes_over() {
        let street = |id: u64, class, line| Street::new(StreetId(id), class, JunctionId(id), JunctionId(id + 1), line);
        let bridge = street(1, StreetClass::Minor, vec![DVec2::X * -130.0, DVec2::X * 130.0]);
        let highway = street(3, StreetClass::Highway, vec![DVec2::Y * -50.0, DVec2::Y * 50.0]);
        let ground = |p: DVec2| 40.0 + 0.02 * p.x;
        let profile = Profile::new(&highway, Origin::default(), ground);
        let deck =
            Deck::new(&Street { bridge: true, level: 1, ..bridge }, Origin::default(), &[(highway, profile)], ground);
        assert_eq!(deck.crossings, [DVec2::ZERO]);
        assert!(deck.height(DVec2::ZERO).unwrap() > ground(DVec2::ZERO) + OVERPASS_CLEARANCE - 0.5);
        assert!((deck.heights[0] - ground(DVec2::X * -130.0)).abs() < 0.05, "it begins on the ground");
    }
}
