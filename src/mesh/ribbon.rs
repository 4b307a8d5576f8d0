//! Streets between their junctions: carriageway, pavements, kerbs and markings along a centre line; bridges.

use crate::chunk::{Deck, ROAD_LIFT as LIFT, junction_reach};
use crate::mesh::buffers::{MeshBuffers, Rgb, blend};
use crate::mesh::drape::Surface;
use crate::network::{Street, StreetClass};
use crate::space::{cut_line, left_normal, line_length, point_at};
use glam::{DVec2, DVec3};

/// Height of the pavement above the carriageway.
pub(super) const KERB: f64 = 0.12;

/// How far the sides of a street reach into the ground.
const FOOT: f64 = -0.1;

/// Lift of streets in the distance: more than the coarse ground differs from the ground on most land.
const FAR_LIFT: f64 = 0.6;

const ASPHALT: Rgb = [0.062, 0.064, 0.069];
const ROAD: Rgb = [0.085, 0.085, 0.084];
const PAVEMENT: Rgb = [0.315, 0.300, 0.275];
const KERBSTONE: Rgb = [0.420, 0.410, 0.390];
const MARKING: Rgb = [0.720, 0.720, 0.690];
const CONCRETE: Rgb = [0.330, 0.325, 0.310];
const VERGE: Rgb = [0.150, 0.140, 0.100];

/// Length of a dash of the centre line, and distance from one to the next.
const DASH: (f64, f64) = (3.0, 9.0);

/// Half the width of the centre line's dashes.
const DASH_HALF: f64 = 0.08;

pub(super) fn carriageway_colour(class: StreetClass) -> Rgb {
    if class.is_road() { ROAD } else { ASPHALT }
}

/// The points of `line` moved sideways by `by` metres (positive to the left), each between its two segments.
pub(super) fn beside(line: &[DVec2], by: f64) -> Vec<DVec2> {
    let direction = |i: usize| (line[i + 1] - line[i]).normalize_or_zero();
    let last = line.len() - 1;
    (0..=last)
        .map(|i| {
            let (before, after) = (direction(i.max(1) - 1), direction(i.min(last - 1)));
            // Where a line doubles back, the mitre would run away.
            let mitre = (before + after).perp() / (1.0 + before.dot(after)).max(0.3);
            line[i] + mitre * by
        })
        .collect()
}

/// A street's surface along a piece of its centre line, from outer edge to outer edge.
pub(super) fn ribbon(surface: &mut Surface<'_>, out: &mut MeshBuffers, line: &[DVec2], class: StreetClass) {
    if line.len() < 2 {
        return;
    }
    let (half, outer) = (class.carriageway() / 2.0, class.half_width());
    let (left, right) = (beside(line, half), beside(line, -half));
    for i in 0..line.len() - 1 {
        surface.lay_quad(out, [right[i], right[i + 1], left[i + 1], left[i]], LIFT, carriageway_colour(class));
    }
    let (outer_left, outer_right) = (beside(line, outer), beside(line, -outer));
    edging(surface, out, &left, &outer_left, true);
    edging(surface, out, &right, &outer_right, false);
}

/// Pavement between the carriageway's edge and the outer edge of a street, with as many points, its kerb and outer side;
/// without pavement the two are one, and only the side is made. `left` says which side of the street it is.
fn edging(surface: &mut Surface<'_>, out: &mut MeshBuffers, inner: &[DVec2], outer: &[DVec2], left: bool) {
    for i in 0..inner.len() - 1 {
        let [a, b, c, d] = [inner[i], inner[i + 1], outer[i + 1], outer[i]];
        if a.distance_squared(d) > 1e-6 {
            surface.lay_quad(out, if left { [a, b, c, d] } else { [b, a, d, c] }, LIFT + KERB, PAVEMENT);
        }
        // Walls face to their right: kerbs towards the carriageway, sides away from it.
        side(surface, out, if left { [a, b] } else { [b, a] }, if left { [d, c] } else { [c, d] });
    }
}

/// The kerb along `inner`, facing right, and the outer side along `outer`, facing left.
fn side(surface: &mut Surface<'_>, out: &mut MeshBuffers, inner: [DVec2; 2], outer: [DVec2; 2]) {
    if inner[0].distance_squared(outer[0]) + inner[1].distance_squared(outer[1]) > 1e-6 {
        surface.wall(out, inner[0], inner[1], [LIFT, LIFT + KERB], KERBSTONE);
        surface.wall(out, outer[1], outer[0], [FOOT, LIFT + KERB], KERBSTONE);
    } else {
        surface.wall(out, outer[1], outer[0], [FOOT, LIFT], VERGE);
    }
}

/// Pavement between two lines of any number of points that run counter-clockwise around a junction, the inner one along
/// the carriageway.
pub(super) fn corner(surface: &mut Surface<'_>, out: &mut MeshBuffers, inner: &[DVec2], outer: &[DVec2], paved: bool) {
    if !paved {
        for w in inner.windows(2) {
            surface.wall(out, w[0], w[1], [FOOT, LIFT], VERGE);
        }
        return;
    }
    // Always on to the nearer of the two next points.
    let (mut i, mut j) = (0, 0);
    while i + 1 < inner.len() || j + 1 < outer.len() {
        let step_inner = match (inner.get(i + 1), outer.get(j + 1)) {
            (Some(a), Some(b)) => a.distance_squared(outer[j]) < b.distance_squared(inner[i]),
            (next, _) => next.is_some(),
        };
        let third = if step_inner { inner[i + 1] } else { outer[j + 1] };
        surface.lay_triangle(out, [inner[i], outer[j], third], LIFT + KERB, PAVEMENT);
        if step_inner { i += 1 } else { j += 1 }
    }
    // The junction lies to the left: kerbs face it, the outer sides face away.
    for w in inner.windows(2) {
        surface.wall(out, w[1], w[0], [LIFT, LIFT + KERB], KERBSTONE);
    }
    for w in outer.windows(2) {
        surface.wall(out, w[0], w[1], [FOOT, LIFT + KERB], KERBSTONE);
    }
}

/// A street between the parts that its junctions' owners draw.
pub(super) fn street(surface: &mut Surface<'_>, out: &mut MeshBuffers, street: &Street) {
    let (length, end) = (street.length(), junction_reach(street));
    if length < 0.5 || street.tunnel {
        return;
    }
    if street.bridge {
        bridge(surface, out, street);
        return;
    }
    let line = cut_line(&street.line, end, length - end);
    ribbon(surface, out, &line, street.class);
    if street.class == StreetClass::Local {
        return;
    }
    let span = line_length(&line);
    let count = (span / DASH.1).floor();
    let first = (span - (count - 1.0) * DASH.1 - DASH.0) / 2.0;
    for k in 0..count as usize {
        let from = first + k as f64 * DASH.1;
        let (a, b) = (point_at(&line, from).0, point_at(&line, from + DASH.0).0);
        let n = left_normal((b - a).normalize_or_zero()) * DASH_HALF;
        surface.lay_quad(out, [a - n, b - n, b + n, a + n], LIFT + 0.012, MARKING);
    }
}

/// A street in the distance: one flat ribbon from end to end.
pub(super) fn far_street(surface: &mut Surface<'_>, out: &mut MeshBuffers, street: &Street) {
    if street.length() < 0.5 || street.tunnel {
        return;
    }
    let half = street.class.half_width();
    if street.bridge {
        bridge(surface, out, street);
        return;
    }
    let (left, right) = (beside(&street.line, half), beside(&street.line, -half));
    let colour = blend(carriageway_colour(street.class), PAVEMENT, (street.class.pavement() / half) as f32);
    for i in 0..street.line.len() - 1 {
        let quad = [right[i], right[i + 1], left[i + 1], left[i]];
        surface.lay_quad(out, quad, FAR_LIFT, colour);
    }
}

/// Thickness of a bridge's deck and height of its parapet, in metres.
const DECK: f64 = 0.9;
const PARAPET: f64 = 1.0;

/// Distance of piers from where a bridge passes over a street, in metres.
const OPEN: f64 = 13.0;

/// A bridge: its deck with parapets, on piers.
fn bridge(surface: &mut Surface<'_>, out: &mut MeshBuffers, street: &Street) {
    let Some(Deck { line, heights, half_width: outer, over, .. }) = surface.deck(street.id) else { return };
    let (left, right) = (beside(line, *outer), beside(line, -outer));
    let (inner_left, inner_right) = (beside(line, outer - 0.3), beside(line, 0.3 - outer));
    let kerb = street.class.carriageway() / 2.0;
    let (kerb_left, kerb_right) = (beside(line, kerb), beside(line, -kerb));
    let carriageway = carriageway_colour(street.class);
    for i in 0..line.len() - 1 {
        let at = |side: &[DVec2], k: usize, up: f64| side[i + k].extend(heights[i + k] + up);
        let quad = |out: &mut MeshBuffers, a: (&[DVec2], f64), b: (&[DVec2], f64), colour| {
            out.face(&[at(a.0, 0, a.1), at(a.0, 1, a.1), at(b.0, 1, b.1), at(b.0, 0, b.1)], colour);
        };
        if street.class.pavement() > 0.0 {
            quad(out, (&kerb_right, 0.0), (&kerb_left, 0.0), carriageway);
            quad(out, (&inner_right, KERB), (&kerb_right, KERB), PAVEMENT);
            quad(out, (&kerb_right, KERB), (&kerb_right, 0.0), KERBSTONE);
            quad(out, (&kerb_left, 0.0), (&kerb_left, KERB), KERBSTONE);
            quad(out, (&kerb_left, KERB), (&inner_left, KERB), PAVEMENT);
        } else {
            quad(out, (&inner_right, 0.0), (&inner_left, 0.0), carriageway);
        }
        quad(out, (&left, -DECK), (&right, -DECK), CONCRETE);
        for (outer, inner, flip) in [(&right, &inner_right, false), (&left, &inner_left, true)] {
            let mut quad = |a: (&[DVec2], f64), b: (&[DVec2], f64)| {
                if flip { quad(out, b, a, CONCRETE) } else { quad(out, a, b, CONCRETE) }
            };
            quad((outer, -DECK), (outer, PARAPET));
            quad((outer, PARAPET), (inner, PARAPET));
            quad((inner, PARAPET), (inner, 0.0));
        }
        if i % 3 == 2 && over.iter().all(|p| p.distance(line[i]) > OPEN) {
            pier(surface, out, line, i, heights[i] - DECK, outer * 0.6);
        }
    }
}

/// A pier under point `i` of a bridge's line, from the ground up to `top`.
fn pier(surface: &mut Surface<'_>, out: &mut MeshBuffers, line: &[DVec2], i: usize, top: f64, half: f64) {
    let base = surface.height(line[i]) - 1.0;
    if top - base < 3.0 {
        return;
    }
    let along = (line[i + 1] - line[i - 1]).normalize_or_zero();
    let across = left_normal(along) * half;
    let ring = [-across - along * 0.6, -across + along * 0.6, across + along * 0.6, across - along * 0.6];
    for k in 0..4 {
        let (a, b) = (line[i] + ring[k], line[i] + ring[(k + 1) % 4]);
        let wall: [DVec3; 4] = [a.extend(base), b.extend(base), b.extend(top), a.extend(top)];
        out.face(&wall, CONCRETE);
    }
}
