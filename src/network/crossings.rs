//! Streets of one level that meet without a junction, found exactly among all pairs of segments whose boxes overlap.

use crate::network::{JunctionId, Street};
use crate::space::{orient, segment_crossing};
use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use std::collections::BTreeSet;

/// A segment of a street.
#[derive(Clone, Copy)]
struct Segment {
    /// Index of the street.
    street: usize,
    /// Index of the segment in the street's line.
    index: usize,
    ends: [DVec2; 2],
    /// The junction at each end, if the street ends there.
    junctions: [Option<JunctionId>; 2],
}

/// Local points, in metres, where two streets of the same level, or two parts of one street, cross, touch or overlap without
/// sharing a junction there. Exact predicates decide. Where streets overlap, there is one point for each pair of segments.
pub fn crossings(streets: &[&Street]) -> Vec<DVec2> {
    let mut all = Vec::new();
    for (s, street) in streets.iter().enumerate() {
        let last = street.line.len().saturating_sub(2);
        for (index, ends) in street.line.windows(2).enumerate() {
            let from = (index == 0).then_some(street.from);
            let to = (index == last).then_some(street.to);
            all.push(Segment { street: s, index, ends: [ends[0], ends[1]], junctions: [from, to] });
        }
    }
    let boxed = |(i, s): (usize, &Segment)| {
        let [a, b] = s.ends;
        GeomWithData::new(Rectangle::from_corners(a.to_array(), b.to_array()), i)
    };
    let tree = RTree::bulk_load(all.iter().enumerate().map(boxed).collect());
    let mut found = BTreeSet::new();
    for (i, a) in all.iter().enumerate() {
        let corners = AABB::from_corners(a.ends[0].to_array(), a.ends[1].to_array());
        for other in tree.locate_in_envelope_intersecting(corners).filter(|o| o.data > i) {
            let b = &all[other.data];
            if streets[a.street].level == streets[b.street].level
                && let Some(at) = forbidden(a, b)
            {
                let pair = (a.street.min(b.street), a.street.max(b.street));
                found.insert((pair, at.to_array().map(f64::to_bits)));
            }
        }
    }
    found.into_iter().map(|(_, at)| DVec2::from_array(at.map(f64::from_bits))).collect()
}

/// Where two segments meet other than at an end that they may share.
fn forbidden(a: &Segment, b: &Segment) -> Option<DVec2> {
    let meeting = segment_crossing(a.ends[0], a.ends[1], b.ends[0], b.ends[1])?;
    // Segments may share one end: a junction of both streets, or the next point of the same street.
    let mut shared = None;
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let junction = a.junctions[i].is_some() && a.junctions[i] == b.junctions[j];
        let chained = a.street == b.street
            && (i == 1 && j == 0 && a.index + 1 == b.index || i == 0 && j == 1 && b.index + 1 == a.index);
        if (junction || chained) && a.ends[i] == b.ends[j] {
            shared = Some((i, j));
            break;
        }
    }
    let Some((i, j)) = shared else { return Some(meeting.at) };
    let (at, far_a, far_b) = (a.ends[i], a.ends[1 - i], b.ends[1 - j]);
    // Two segments from one point meet nowhere else, unless they run in the same direction.
    (orient(at, far_a, far_b) == 0.0 && (far_a - at).dot(far_b - at) > 0.0).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{StreetClass, StreetId};

    fn street(id: u64, from: u64, to: u64, line: &[(f64, f64)]) -> Street {
        let line = line.iter().map(|p| DVec2::new(p.0, p.1)).collect();
        Street::new(StreetId(id), StreetClass::Local, JunctionId(from), JunctionId(to), line)
    }

    fn count(streets: &[Street]) -> usize {
        crossings(&streets.iter().collect::<Vec<_>>()).len()
    }

    #[test]
    fn shared_junctions_are_fine() {
        let fine = [
            street(1, 1, 2, &[(0., 0.), (10., 5.), (20., 0.)]),
            street(2, 2, 3, &[(20., 0.), (40., 0.)]),
            street(3, 2, 4, &[(20., 0.), (20., 30.)]),
            // A loop from a junction to itself.
            street(4, 4, 4, &[(20., 30.), (10., 40.), (20., 50.), (30., 40.), (20., 30.)]),
        ];
        assert_eq!(count(&fine), 0);
    }

    #[test]
    fn crossings_touches_and_overlaps_are_found() {
        let main = street(1, 1, 2, &[(0., 0.), (20., 0.)]);
        let across = |from, to, line: &[(f64, f64)]| count(&[main.clone(), street(2, from, to, line)]);
        assert_eq!(across(3, 4, &[(10., -5.), (10., 5.)]), 1, "a cross");
        assert_eq!(across(3, 4, &[(10., 0.), (10., 5.)]), 1, "a T without a junction");
        assert_eq!(across(2, 3, &[(20., 0.), (5., 0.)]), 1, "an overlap from a shared junction");
        assert_eq!(across(1, 2, &[(0., 0.), (20., 0.)]), 1, "the same street twice");
        assert_eq!(across(3, 4, &[(20., 0.), (30., 0.)]), 1, "the same place, another junction");
        assert_eq!(across(3, 4, &[(10., -5.), (10., 0.), (15., 5.)]), 1, "an inflexion on the street counts once");
        assert_eq!(count(&[street(1, 1, 2, &[(0., 0.), (9., 0.), (9., 9.), (5., -5.)])]), 1, "a street across itself");
        assert_eq!(count(&[street(1, 1, 2, &[(0., 0.), (9., 0.), (4., 0.)])]), 1, "a street back along itself");
    }

    #[test]
    fn levels_cross_freely() {
        let mut bridge = street(2, 3, 4, &[(10., -5.), (10., 5.)]);
        bridge.level = 1;
        assert_eq!(count(&[street(1, 1, 2, &[(0., 0.), (20., 0.)]), bridge]), 0);
    }
}
