//! The surface of a street between its junctions.

use crate::network::{Side, Street};
use crate::space::{Bounds, left_normal, quantize};
use crate::surface::element::Element;
use crate::surface::finish::Finish;
use crate::surface::junction::{Cut, StreetEnd};
use crate::surface::paint::{Mark, marks};
use crate::surface::profile::Profile;
use crate::surface::section::CrossSection;
use glam::DVec2;

/// Greatest distance between the profile and the drawn surface, in metres.
const TOLERANCE: f64 = 0.015;

/// Greatest distance between cross-sections, except beside a corner of the line, in metres.
pub(super) const LONGEST_STRETCH: f64 = 24.0;

/// Least distance between cross-sections that are there for the profile alone, in metres.
const APART: f64 = 1.5;

/// Two places along a street count as one below this distance, in metres.
const SAME: f64 = 0.05;

/// A place along a street at which its surface has a cross-section.
struct Section {
    along: f64,
    /// The centre, relative to the street's first point.
    at: DVec2,
    /// What one metre to the left is: longer than a metre in bends.
    left: DVec2,
}

/// Adds the surface of a street between its junctions, as far as it comes near `window` (local metres). `ends` are its ends; a
/// street goes on to its end where nothing is known of the junction. Each stretch between two cross-sections is a part.
pub(super) fn strip(
    out: &mut Element,
    street: &Street,
    profile: &Profile,
    ends: &[Option<StreetEnd>; 2],
    window: Bounds,
    driving: Side,
) {
    let section = CrossSection::of(street.class);
    let origin = street.line[0];
    let mut line: Vec<DVec2> = street.line.iter().map(|p| *p - origin).collect();
    line.dedup();
    let length = street.length();
    let from = ends[0].as_ref().map_or(0.0, |e| e.cut.along);
    let to = length - ends[1].as_ref().map_or(0.0, |e| e.cut.along);
    if line.len() < 2 || to - from < SAME {
        return;
    }
    let marks = marks(street, length, ends, driving);
    let places = places(&line, profile, &marks, [from, to], section.outer);
    let near = window.grown(section.outer * 2.0).moved(-origin);
    let seen = |a: &Section, b: &Section| Bounds::of([a.at, b.at]).overlaps(near);
    // The marks of a stretch.
    let columns = |row: usize| -> Vec<(f64, f64, Finish)> {
        // Nothing is painted right beside a junction.
        if row == 0 || row + 2 == places.len() {
            return Vec::new();
        }
        let middle = (places[row].along + places[row + 1].along) / 2.0;
        let painted = marks.iter().filter(|m| m.along[0] < middle && middle < m.along[1]);
        painted.map(|m| (m.across[0], m.across[1], m.finish)).collect()
    };
    let plain = if section.paved { Finish::Asphalt } else { Finish::Road };
    let edging = if section.paved { Finish::Pavement } else { Finish::Verge };
    let mut chain: Option<(usize, Chain)> = None;
    let mut painted_before = Vec::new();
    for row in 0..places.len() - 1 {
        if !seen(&places[row], &places[row + 1]) {
            chain = None;
            continue;
        }
        let painted = columns(row);
        if row == 0 || chain.is_none() {
            painted_before = if row > 0 { columns(row - 1) } else { Vec::new() };
        }
        let ahead = if row + 2 < places.len() { columns(row + 1) } else { Vec::new() };
        let mut make = |k: usize, lists: [&[(f64, f64, Finish)]; 2]| {
            let end = if k == 0 { 0 } else { 1 };
            let cut = ends[end].as_ref().filter(|_| k == 0 || k == places.len() - 1).map(|e| &e.cut);
            Chain::new(out, &places[k], origin, &section, lists, profile, cut.map(|c| (c, end == 0)))
        };
        let bottom = match chain.take() {
            Some((k, chain)) if k == row => chain,
            _ => make(row, [&painted_before, &painted]),
        };
        let top = make(row + 1, [&painted, &ahead]);
        out.begin();
        let n = [bottom.vertices.len(), top.vertices.len()];
        out.zip(&top.vertices[..2], &bottom.vertices[..2], edging);
        let mut borders: Vec<f64> = painted.iter().flat_map(|(a, b, _)| [*a, *b]).collect();
        borders.extend([-section.carriageway, section.carriageway]);
        borders.sort_by(f64::total_cmp);
        borders.dedup();
        for w in borders.windows(2) {
            let middle = (w[0] + w[1]) / 2.0;
            let over = painted.iter().filter(|(a, b, _)| *a < middle && middle < *b).map(|(.., finish)| *finish);
            let finish = over.max().unwrap_or(plain);
            out.zip(top.between(w[0], w[1]), bottom.between(w[0], w[1]), finish);
        }
        out.zip(&top.vertices[n[1] - 2..], &bottom.vertices[n[0] - 2..], edging);
        chain = Some((row + 1, top));
        painted_before = painted;
    }
}

/// The vertices of a cross-section, from right to left.
struct Chain {
    offsets: Vec<f64>,
    vertices: Vec<u32>,
}

impl Chain {
    fn new(
        out: &mut Element,
        place: &Section,
        origin: DVec2,
        section: &CrossSection,
        painted: [&[(f64, f64, Finish)]; 2],
        profile: &Profile,
        cut: Option<(&Cut, bool)>,
    ) -> Self {
        let mut offsets = vec![-section.outer, -section.carriageway, section.carriageway, section.outer];
        // Nothing is painted across a cut.
        if cut.is_none() {
            offsets.extend(painted.iter().flat_map(|list| list.iter().flat_map(|(a, b, _)| [*a, *b])));
        }
        offsets.sort_by(f64::total_cmp);
        offsets.dedup();
        let height = profile.height(place.along);
        let vertices: Vec<u32> = match cut {
            Some((cut, begins)) => {
                let mut points = cut.points;
                if !begins {
                    points.reverse();
                }
                points.iter().map(|p| out.point(*p, height)).collect()
            }
            None => {
                let at = |by: &f64| origin + quantize(place.at + place.left * *by);
                offsets.iter().map(|by| out.point(at(by), height)).collect()
            }
        };
        // People step down to a crossing without a kerb.
        if cut.is_none() && painted.iter().any(|list| list.iter().any(|mark| mark.2 == Finish::Crossing)) {
            let kerbs = offsets.iter().zip(&vertices).filter(|(by, _)| by.abs() == section.carriageway);
            out.dropped.extend(kerbs.map(|(_, vertex)| *vertex));
        }
        Self { offsets, vertices }
    }

    /// The vertices between two offsets, both of which the cross-section has.
    fn between(&self, right: f64, left: f64) -> &[u32] {
        let at = |offset: f64| self.offsets.partition_point(|o| *o < offset);
        let (first, last) = (at(right), at(left).min(self.offsets.len() - 1));
        &self.vertices[first.min(last)..=last]
    }
}

/// The places of the cross-sections between `from` and `to`.
fn places(line: &[DVec2], profile: &Profile, marks: &[Mark], [from, to]: [f64; 2], outer: f64) -> Vec<Section> {
    // Places that must be there, and how near to them others may lie.
    let mut fixed: Vec<(f64, f64)> = vec![(from, 0.0), (to, 0.0)];
    let mut along = vec![0.0];
    for w in line.windows(2) {
        along.push(along[along.len() - 1] + w[0].distance(w[1]));
    }
    let mut corners: Vec<(f64, DVec2, DVec2, f64)> = Vec::new();
    for i in 1..line.len() - 1 {
        let [d, e] = [line[i] - line[i - 1], line[i + 1] - line[i]].map(DVec2::normalize_or_zero);
        let left = (d + e).perp() / (1.0 + d.dot(e)).max(0.3);
        let reach = outer * d.perp_dot(e).abs() / (1.0 + d.dot(e)).max(0.3) + SAME;
        if along[i] - reach > from && along[i] + reach < to {
            corners.push((along[i], line[i], left, reach));
            fixed.push((along[i], reach));
        }
    }
    fixed.sort_by(|a, b| a.0.total_cmp(&b.0));
    let free = |s: f64, apart: f64| {
        let k = fixed.partition_point(|(at, _)| *at < s);
        let clear = |(at, reach): &(f64, f64)| (s - at).abs() > reach.max(apart);
        fixed[k.saturating_sub(1)..(k + 1).min(fixed.len())].iter().all(clear)
    };
    let mut painted: Vec<f64> =
        marks.iter().flat_map(|m| m.along).filter(|s| *s > from && *s < to && free(*s, SAME)).collect();
    painted.sort_by(f64::total_cmp);
    painted.dedup_by(|b, a| *b - *a < SAME);
    // Places that do not depend on the junctions, which a square far from them does not know.
    let mut bends = profile.bends(0.0, profile.length(), TOLERANCE);
    bends.extend((1..(profile.length() / LONGEST_STRETCH) as usize + 1).map(|k| k as f64 * LONGEST_STRETCH));
    bends.sort_by(f64::total_cmp);
    bends.dedup_by(|b, a| *b - *a < APART);
    let clear_of_paint = |s: f64| {
        let k = painted.partition_point(|at| *at < s);
        painted[k.saturating_sub(1)..(k + 1).min(painted.len())].iter().all(|at| (s - at).abs() > APART)
    };
    let bends: Vec<f64> =
        bends.into_iter().filter(|s| *s > from && *s < to && free(*s, APART) && clear_of_paint(*s)).collect();
    let mut all: Vec<f64> = fixed.iter().map(|f| f.0).chain(painted.iter().copied()).chain(bends).collect();
    all.sort_by(f64::total_cmp);
    let (mut segment, mut corner) = (0, 0);
    let place = |s: f64| {
        while corner < corners.len() && corners[corner].0 < s {
            corner += 1;
        }
        if let Some((at, p, left, _)) = corners.get(corner)
            && *at == s
        {
            return Section { along: s, at: *p, left: *left };
        }
        while segment + 2 < along.len() && along[segment + 1] < s {
            segment += 1;
        }
        let d = (line[segment + 1] - line[segment]).normalize_or_zero();
        Section { along: s, at: line[segment] + d * (s - along[segment]), left: left_normal(d) }
    };
    all.into_iter().map(place).collect()
}
