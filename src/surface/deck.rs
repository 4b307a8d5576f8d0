//! Decks of bridges: the surface to stand on where there is no ground underfoot.

use crate::network::{Street, StreetId};
use crate::region::{OVERPASS_CLEARANCE, overpass_profile};
use crate::space::{Bounds, closest_on_segment, cut_line, left_normal, resample, segment_crossing, segments};
use crate::surface::junction::junction_reach;
use glam::DVec2;

/// Height of a carriageway above the drawn ground, in metres; for a bridge, at its ends.
pub const ROAD_LIFT: f64 = 0.1;

/// Distance between the points of a deck's line, in metres.
const DECK_STEP: f64 = 8.0;

/// Height of the middle of a town's bridge above the straight line between its ends, as a share of the bridge's length.
const HUMP_SHARE: f64 = 0.03;

/// Greatest height of that hump, in metres.
const MOST_HUMP: f64 = 2.0;

/// The deck of a bridge, with its height profile.
///
/// A deck runs straight from the height of one end to the height of the other, in towns with a slight hump. It is higher only
/// where the ground in between is higher and where the bridge passes over another street.
#[derive(Clone, Debug, PartialEq)]
pub struct Deck {
    /// The bridge.
    pub street: StreetId,
    /// Centre line, local to the chunk, in metres.
    pub line: Vec<DVec2>,
    /// Height of the carriageway at each point of the line, in metres.
    pub heights: Vec<f64>,
    /// Half of the deck's width in metres.
    pub half_width: f64,
    /// Points where the bridge passes over other streets: no pier stands near them.
    pub crossings: Vec<DVec2>,
}

impl Deck {
    /// The deck of a bridge between the parts that belong to the junctions at its ends. `floor` gives the height at a local
    /// point that the deck stays above, such as the drawn ground. `below` are the streets that the bridge may pass over.
    pub fn new(street: &Street, below: &[Street], mut floor: impl FnMut(DVec2) -> f64) -> Self {
        let (length, end) = (street.length(), junction_reach(street));
        let line = resample(&cut_line(&street.line, end, length - end), DECK_STEP);
        let (last, half_width) = (line.len() - 1, street.class.half_width());
        let mut along = vec![0.0];
        for (a, b) in segments(&line) {
            along.push(along[along.len() - 1] + a.distance(b));
        }
        let length = along[last].max(1e-3);
        let ends = [line[0], line[last]].map(|p| floor(p) + ROAD_LIFT);
        let straight = |share: f64| ends[0] + (ends[1] - ends[0]) * share;
        let mut heights = Vec::with_capacity(line.len());
        for (i, &p) in line.iter().enumerate() {
            let way = (line[(i + 1).min(last)] - line[i.max(1) - 1]).normalize_or_zero();
            let across = left_normal(way) * half_width;
            let highest = [across, DVec2::ZERO, -across].map(|q| floor(p + q)).into_iter().fold(f64::MIN, f64::max);
            heights.push(straight(along[i] / length).max(highest + ROAD_LIFT));
        }
        if street.class.is_main() {
            // Quays are low: a bridge between them rises to let boats pass.
            let lift = MOST_HUMP.min(HUMP_SHARE * length);
            for (height, at) in heights.iter_mut().zip(&along) {
                let t = (at / length).min(1.0);
                *height = height.max(straight(t) + 4.0 * lift * t * (1.0 - t));
            }
        }
        let crossings = crossings(&line, below);
        for (point, crossing) in &crossings {
            let lift = (floor(*point) + ROAD_LIFT + OVERPASS_CLEARANCE - straight(crossing / length)).max(0.0);
            for (height, at) in heights.iter_mut().zip(&along) {
                let reach = if at < crossing { *crossing } else { length - crossing };
                *height =
                    height.max(straight(at / length) + lift * overpass_profile((at - crossing) / reach.max(1e-3)));
            }
        }
        let crossings = crossings.into_iter().map(|(point, _)| point).collect();
        Self { street: street.id, line, heights, half_width, crossings }
    }

    /// Height of the deck at a local point in metres, if the point lies on the deck.
    pub fn height(&self, p: DVec2) -> Option<f64> {
        let mut best: Option<(f64, f64)> = None;
        for (line, heights) in self.line.windows(2).zip(self.heights.windows(2)) {
            let (t, at) = closest_on_segment(p, line[0], line[1]);
            let off = at.distance(p);
            if off <= self.half_width && best.is_none_or(|(least, _)| off < least) {
                best = Some((off, heights[0] + (heights[1] - heights[0]) * t));
            }
        }
        best.map(|(_, height)| height)
    }
}

/// Where a line crosses streets, and how far along the line.
fn crossings(line: &[DVec2], below: &[Street]) -> Vec<(DVec2, f64)> {
    let bounds = Bounds::of(line.iter().copied());
    let near = below.iter().filter(|s| s.bounds().overlaps(bounds)).flat_map(|s| segments(&s.line));
    let mut out: Vec<(DVec2, f64)> = Vec::new();
    for (c, d) in near {
        let mut along = 0.0;
        for (a, b) in segments(line) {
            if let Some(x) = segment_crossing(a, b, c, d)
                && out.iter().all(|o| o.0 != x.at)
            {
                out.push((x.at, along + a.distance(x.at)));
            }
            along += a.distance(b);
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
            x if (90.0..110.0).contains(&x) => 104.0,
            x if (110.0..170.0).contains(&x) => 80.0,
            _ => 100.0 + p.x * 0.01,
        };
        let line = vec![DVec2::ZERO, DVec2::X * 200.0];
        let street =
            Street { bridge: true, ..Street::new(StreetId(1), StreetClass::Minor, JunctionId(1), JunctionId(2), line) };
        let deck = Deck::new(&street, &[], ground);
        let reach = junction_reach(&street);
        let at = |x: f64, y: f64| deck.height(DVec2::new(x, y));
        assert!((at(reach + 0.01, 0.0).unwrap() - ground(DVec2::X * reach) - ROAD_LIFT).abs() < 0.01);
        assert!((at(60.0, 2.0).unwrap() - 100.7).abs() < 0.2, "{:?}", at(60.0, 2.0));
        assert_eq!(at(100.0, 0.0), Some(104.0 + ROAD_LIFT));
        assert_eq!(at(60.0, StreetClass::Minor.half_width() + 0.1), None);
        assert_eq!(at(200.0, 0.0), None, "the junction's part lies on the ground");
    }

    #[test]
    fn a_deck_clears_the_street_that_it_passes_over() {
        let street = |id: u64, class, line| Street::new(StreetId(id), class, JunctionId(id), JunctionId(id + 1), line);
        let bridge = street(1, StreetClass::Minor, vec![DVec2::X * -130.0, DVec2::X * 130.0]);
        let highway = street(3, StreetClass::Highway, vec![DVec2::Y * -50.0, DVec2::Y * 50.0]);
        let ground = |p: DVec2| 40.0 + 0.02 * p.x;
        let deck = Deck::new(&Street { bridge: true, level: 1, ..bridge }, &[highway], ground);
        assert_eq!(deck.crossings, [DVec2::ZERO]);
        assert!(deck.height(DVec2::ZERO).unwrap() > ground(DVec2::ZERO) + OVERPASS_CLEARANCE - 0.3);
        assert!(deck.heights[0] < ground(deck.line[0]) + ROAD_LIFT + 0.01, "it begins on the ground");
    }
}
