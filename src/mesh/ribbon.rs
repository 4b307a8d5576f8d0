//! Streets between their junctions: carriageway, pavements, kerbs and markings laid on the ground.

use crate::mesh::buffers::{MeshBuffers, Rgb, blend};
use crate::mesh::drape::Drape;
use crate::network::{Street, StreetClass};
use crate::space::{left_normal, line_length, point_at};
use crate::surface::{Corner, Pieces, ROAD_LIFT, Strip, offset_line};
use glam::DVec2;
use std::ops::Range;

/// Height of a pavement above the carriageway, in metres.
pub(super) const KERB_HEIGHT: f64 = 0.12;

/// Height of pavements above the ground, in metres.
const PAVEMENT_LIFT: f64 = ROAD_LIFT + KERB_HEIGHT;

/// Height above the ground, in metres, from which the sides of a street rise: below the ground, so that no gap shows.
const SIDE_BASE: f64 = -0.1;

/// Height of streets above the ground in reduced detail, in metres: on most land the coarse ground differs by less.
const FAR_LIFT: f64 = 0.6;

/// Height of markings above the carriageway, in metres.
const MARKING_LIFT: f64 = 0.012;

const ASPHALT: Rgb = [0.062, 0.064, 0.069];
const ROAD: Rgb = [0.085, 0.085, 0.084];
pub(super) const PAVEMENT: Rgb = [0.315, 0.300, 0.275];
pub(super) const KERBSTONE: Rgb = [0.420, 0.410, 0.390];
const MARKING: Rgb = [0.720, 0.720, 0.690];
const VERGE: Rgb = [0.150, 0.140, 0.100];

/// Length of a dash of the centre line, and distance from the start of one dash to the start of the next, in metres.
const DASH: (f64, f64) = (3.0, 9.0);

/// Half the width of a dash, in metres.
const DASH_HALF: f64 = 0.08;

/// Streets shorter than this (metres) are not drawn.
const SHORTEST: f64 = 0.5;

/// Colour of the carriageway of a class.
pub(super) fn carriageway_colour(class: StreetClass) -> Rgb {
    if class.is_road() { ROAD } else { ASPHALT }
}

/// Adds a street's surface along a line, from outer edge to outer edge; nothing for fewer than two points.
pub(super) fn ribbon(drape: &mut Drape<'_>, out: &mut MeshBuffers, line: &[DVec2], class: StreetClass) {
    if let Some(strip) = Strip::new(line, class) {
        stretch(drape, out, &strip, class, 0..line.len() - 1);
    }
}

/// Adds the segments of a street's surface.
fn stretch(drape: &mut Drape<'_>, out: &mut MeshBuffers, strip: &Strip, class: StreetClass, segments: Range<usize>) {
    let Strip { carriageway: [left, right], outer } = strip;
    for i in segments.clone() {
        drape.lay_quad(out, [right[i], right[i + 1], left[i + 1], left[i]], ROAD_LIFT, carriageway_colour(class));
    }
    let points = segments.start..=segments.end;
    edging(drape, out, &left[points.clone()], &outer[0][points.clone()], true);
    edging(drape, out, &right[points.clone()], &outer[1][points], false);
}

/// Adds one side of a street: the pavement between the carriageway's edge `inner` and the `outer` edge, its kerb and its outer
/// face. Both edges have the same number of points. Without a pavement they coincide, and only the outer face is added.
fn edging(drape: &mut Drape<'_>, out: &mut MeshBuffers, inner: &[DVec2], outer: &[DVec2], left: bool) {
    for i in 0..inner.len() - 1 {
        let [a, b, c, d] = [inner[i], inner[i + 1], outer[i + 1], outer[i]];
        if a.distance_squared(d) > 1e-6 {
            drape.lay_quad(out, if left { [a, b, c, d] } else { [b, a, d, c] }, PAVEMENT_LIFT, PAVEMENT);
        }
        // Walls face to their right: kerbs towards the carriageway, outer faces away from it.
        let (inner, outer) = if left { ([a, b], [c, d]) } else { ([b, a], [d, c]) };
        if inner[0].distance_squared(outer[1]) + inner[1].distance_squared(outer[0]) > 1e-6 {
            drape.wall(out, inner, [ROAD_LIFT, PAVEMENT_LIFT], KERBSTONE);
            drape.wall(out, outer, [SIDE_BASE, PAVEMENT_LIFT], KERBSTONE);
        } else {
            drape.wall(out, outer, [SIDE_BASE, ROAD_LIFT], VERGE);
        }
    }
}

/// Adds the pavement, kerb and outer face of a junction's corner.
pub(super) fn corner(drape: &mut Drape<'_>, out: &mut MeshBuffers, Corner { kerb, side, paved }: &Corner) {
    if !paved {
        for w in kerb.windows(2) {
            drape.wall(out, [w[0], w[1]], [SIDE_BASE, ROAD_LIFT], VERGE);
        }
        return;
    }
    // Each step goes on to the nearer of the two next points.
    let (mut i, mut j) = (0, 0);
    while i + 1 < kerb.len() || j + 1 < side.len() {
        let along_kerb = match (kerb.get(i + 1), side.get(j + 1)) {
            (Some(a), Some(b)) => a.distance_squared(side[j]) < b.distance_squared(kerb[i]),
            (next, _) => next.is_some(),
        };
        let third = if along_kerb { kerb[i + 1] } else { side[j + 1] };
        drape.lay_triangle(out, [kerb[i], side[j], third], PAVEMENT_LIFT, PAVEMENT);
        if along_kerb { i += 1 } else { j += 1 }
    }
    // The junction lies to the left: kerbs face it, outer faces turn away from it.
    for w in kerb.windows(2) {
        drape.wall(out, [w[1], w[0]], [ROAD_LIFT, PAVEMENT_LIFT], KERBSTONE);
    }
    for w in side.windows(2) {
        drape.wall(out, [w[0], w[1]], [SIDE_BASE, PAVEMENT_LIFT], KERBSTONE);
    }
}

/// Whether a street has a surface: on the ground or on a deck.
pub(super) fn is_drawn(street: &Street) -> bool {
    street.length() >= SHORTEST && !street.tunnel
}

/// Adds pieces of a street on the ground, `own` by their indices.
pub(super) fn street(
    drape: &mut Drape<'_>,
    out: &mut MeshBuffers,
    street: &Street,
    pieces: &Pieces<'_>,
    own: &[usize],
) {
    let (line, at) = pieces.line(false);
    let Some(strip) = Strip::new(&line, street.class) else { return };
    for &piece in own {
        stretch(drape, out, &strip, street.class, at[piece]..at[piece + 1]);
    }
    if street.class == StreetClass::Local || street.class.is_one_way() {
        return;
    }
    let span = line_length(&line);
    let count = (span / DASH.1).floor();
    let first = (span - (count - 1.0) * DASH.1 - DASH.0) / 2.0;
    let start = pieces.range(0)[0];
    for k in 0..count as usize {
        let from = first + k as f64 * DASH.1;
        // A dash belongs to the piece in which it begins.
        let begins = |piece: &usize| (pieces.range(*piece)[0]..pieces.range(*piece)[1]).contains(&(start + from));
        if !own.iter().any(begins) {
            continue;
        }
        let (a, b) = (point_at(&line, from).0, point_at(&line, from + DASH.0).0);
        let n = left_normal((b - a).normalize_or_zero()) * DASH_HALF;
        drape.lay_quad(out, [a - n, b - n, b + n, a + n], ROAD_LIFT + MARKING_LIFT, MARKING);
    }
}

/// Adds pieces of a street in reduced detail, `own` by their indices: flat ribbons. The first and the last piece reach to the
/// ends of the street.
pub(super) fn far_street(
    drape: &mut Drape<'_>,
    out: &mut MeshBuffers,
    street: &Street,
    pieces: &Pieces<'_>,
    own: &[usize],
) {
    let half = street.class.half_width();
    let (line, at) = pieces.line(true);
    let (left, right) = (offset_line(&line, half), offset_line(&line, -half));
    let colour = blend(carriageway_colour(street.class), PAVEMENT, (street.class.pavement() / half) as f32);
    for i in own.iter().flat_map(|piece| at[*piece]..at[piece + 1]) {
        drape.lay_quad(out, [right[i], right[i + 1], left[i + 1], left[i]], FAR_LIFT, colour);
    }
}
