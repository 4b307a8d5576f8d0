//! Bridges: decks with parapets on piers.

use crate::mesh::buffers::{MeshBuffers, Rgb};
use crate::mesh::footing::Footing;
use crate::mesh::streets::{KERBSTONE, PAVEMENT, carriageway_colour};
use crate::network::Street;
use crate::space::{left_normal, quantize};
use crate::surface::{Deck, KERB_HEIGHT, Pieces, offset_line};
use glam::DVec2;

const CONCRETE: Rgb = [0.330, 0.325, 0.310];

/// Thickness of a deck, in metres.
const DECK: f64 = 0.9;

/// Height and width of a parapet, in metres.
const PARAPET: f64 = 1.0;
const PARAPET_WIDTH: f64 = 0.3;

/// Least distance between a pier and a street that the bridge passes over, in metres.
const PIER_CLEARANCE: f64 = 13.0;

/// Number of points of a deck's line from one pier to the next.
const PIER_EVERY: usize = 3;

/// Piers lower than this are left out, in metres, their foot in the ground included.
const LOWEST_PIER: f64 = 3.0;

/// Depth of a pier's foot in the ground and half its thickness along the bridge, in metres.
const PIER_FOOT: f64 = 1.0;
const PIER_HALF: f64 = 0.6;

/// Half the width of a pier as a share of half the width of its deck.
const PIER_SHARE: f64 = 0.6;

/// Adds pieces of a bridge, `own` by their indices: its deck with parapets, on piers.
pub(super) fn bridge(
    footing: &mut Footing<'_>,
    out: &mut MeshBuffers,
    deck: &Deck,
    street: &Street,
    pieces: &Pieces<'_>,
    own: &[usize],
) {
    let Deck { line, heights, section, crossings, .. } = deck;
    let outer = section.outer;
    let offset_line = |line: &[DVec2], by: f64| -> Vec<DVec2> {
        let start = line[0];
        let own: Vec<DVec2> = line.iter().map(|p| *p - start).collect();
        offset_line(&own, by).into_iter().map(|p| start + quantize(p)).collect()
    };
    let (left, right) = (offset_line(line, outer), offset_line(line, -outer));
    let (inner_left, inner_right) =
        (offset_line(line, outer - PARAPET_WIDTH), offset_line(line, PARAPET_WIDTH - outer));
    let kerb = section.carriageway;
    let (kerb_left, kerb_right) = (offset_line(line, kerb), offset_line(line, -kerb));
    let carriageway = carriageway_colour(street.class);
    // Pieces of a deck meet at the points of its line.
    let point = |piece: usize| piece * (line.len() - 1) / pieces.count();
    for i in own.iter().flat_map(|piece| point(*piece)..point(piece + 1)) {
        let at = |side: &[DVec2], k: usize, up: f64| side[i + k].extend(heights[i + k] + up);
        let quad = |out: &mut MeshBuffers, a: (&[DVec2], f64), b: (&[DVec2], f64), colour| {
            out.face(&[at(a.0, 0, a.1), at(a.0, 1, a.1), at(b.0, 1, b.1), at(b.0, 0, b.1)], colour);
        };
        if section.paved {
            quad(out, (&kerb_right, 0.0), (&kerb_left, 0.0), carriageway);
            quad(out, (&inner_right, KERB_HEIGHT), (&kerb_right, KERB_HEIGHT), PAVEMENT);
            quad(out, (&kerb_right, KERB_HEIGHT), (&kerb_right, 0.0), KERBSTONE);
            quad(out, (&kerb_left, 0.0), (&kerb_left, KERB_HEIGHT), KERBSTONE);
            quad(out, (&kerb_left, KERB_HEIGHT), (&inner_left, KERB_HEIGHT), PAVEMENT);
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
        if i % PIER_EVERY == PIER_EVERY - 1 && crossings.iter().all(|p| p.distance(line[i]) > PIER_CLEARANCE) {
            pier(footing, out, line, i, heights[i] - DECK, outer * PIER_SHARE);
        }
    }
}

/// Adds a pier under point `i` of a bridge's line, from the ground up to the height `top`.
fn pier(footing: &mut Footing<'_>, out: &mut MeshBuffers, line: &[DVec2], i: usize, top: f64, half: f64) {
    let base = footing.height(line[i]) - PIER_FOOT;
    if top - base < LOWEST_PIER {
        return;
    }
    let along = (line[i + 1] - line[i - 1]).normalize_or_zero();
    let (across, along) = (left_normal(along) * half, along * PIER_HALF);
    let ring = [-across - along, -across + along, across + along, across - along];
    for k in 0..4 {
        let (a, b) = (line[i] + ring[k], line[i] + ring[(k + 1) % 4]);
        out.face(&[a.extend(base), b.extend(base), b.extend(top), a.extend(top)], CONCRETE);
    }
}
