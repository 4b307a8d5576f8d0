//! Bridges: decks with parapets, on abutments and piers.

use crate::mesh::buffers::{Coat, MeshBuffers};
use crate::mesh::footing::Footing;
use crate::mesh::streets::{KERBSTONE, PAVEMENT, carriageway_coat};
use crate::network::Street;
use crate::space::{left_normal, quantize};
use crate::surface::{Deck, KERB_HEIGHT, Pieces, offset_line};
use crate::texture::Texture;
use glam::{DVec2, DVec3};

const CONCRETE: Coat = Coat::new(Texture::Stone, [0.330, 0.325, 0.310]);

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

/// Depth of the foot of piers and abutments in the ground and half their thickness along the bridge, in metres.
const FOOT: f64 = 1.0;
const BLOCK_HALF: f64 = 0.6;

/// Distance from an abutment within which the ground falls, in metres.
const BANK_TOP: f64 = 4.0;

/// Half the width of a pier as a share of half the width of its deck.
const PIER_SHARE: f64 = 0.6;

/// Adds pieces of a bridge, `own` by their indices: its deck with parapets, on abutments and piers.
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
    let carriageway = carriageway_coat(street.class);
    let foot = if section.paved { KERB_HEIGHT } else { 0.0 };
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
            quad((inner, PARAPET), (inner, foot));
        }
        if i % PIER_EVERY == PIER_EVERY - 1 && crossings.iter().all(|p| p.distance(line[i]) > PIER_CLEARANCE) {
            let along = (line[i + 1] - line[i - 1]).normalize_or_zero();
            let (top, base) = (heights[i] - DECK, footing.height(line[i]) - FOOT);
            if top - base >= LOWEST_PIER {
                block(out, line[i], along, outer * PIER_SHARE, [base, top]);
            }
        }
    }
    let last = line.len() - 1;
    for (end, next, piece) in [(0, 1, 0), (last, last - 1, pieces.count() - 1)] {
        if !own.contains(&piece) {
            continue;
        }
        // Across the end of the deck, seen from beyond it.
        let (kerb_left, kerb_right) =
            if section.paved { (&kerb_left, &kerb_right) } else { (&inner_left, &inner_right) };
        let sides = [&right, &left, &inner_left, kerb_left, kerb_right, &inner_right].map(|side| side[end]);
        end_face(out, sides, heights[end], foot, end > 0);
        let along = (line[next] - line[end]).normalize_or_zero();
        let at = line[end] + along * BLOCK_HALF;
        let ground = footing.height(at).min(footing.height(at + along * BANK_TOP));
        let (top, base) = (heights[end].min(heights[next]) - DECK, ground - FOOT);
        if base < top {
            block(out, at, along, outer - PARAPET_WIDTH, [base, top]);
        }
    }
}

/// Adds the face across an end of a deck, from its edges there: the outer edges on the right and on the left, then the edges of
/// parapet and kerb on the left and on the right. `ahead` says that it is the end of the line, not its start.
fn end_face(out: &mut MeshBuffers, sides: [DVec2; 6], height: f64, foot: f64, ahead: bool) {
    let [right, left, inner_left, kerb_left, kerb_right, inner_right] = sides;
    let half = |side: DVec2, inner: DVec2, kerb: DVec2| {
        let (bottom, gutter) = (side.extend(-DECK), kerb.extend(0.0));
        let (step, wall) = (kerb.extend(foot), inner.extend(foot));
        let parapet = vec![bottom, wall, inner.extend(PARAPET), side.extend(PARAPET)];
        [vec![bottom, gutter, step], vec![bottom, step, wall], parapet]
    };
    let middle = vec![left.extend(-DECK), right.extend(-DECK), kerb_right.extend(0.0), kerb_left.extend(0.0)];
    let on_left = half(left, inner_left, kerb_left);
    let on_right = half(right, inner_right, kerb_right).map(|ring| ring.into_iter().rev().collect());
    for ring in std::iter::once(middle).chain(on_right).chain(on_left) {
        let mut ring: Vec<_> = ring.into_iter().map(|p| p + DVec3::Z * height).collect();
        if ahead {
            ring.reverse();
        }
        ring.dedup();
        if ring.len() > 2 {
            out.face(&ring, CONCRETE);
        }
    }
}

/// Adds a block of concrete across a bridge, `half` metres to either side of a point of its line, from one height to another.
fn block(out: &mut MeshBuffers, at: DVec2, along: DVec2, half: f64, [base, top]: [f64; 2]) {
    let (across, along) = (left_normal(along) * half, along * BLOCK_HALF);
    let ring = [across - along, -across - along, -across + along, across + along].map(|p| at + quantize(p));
    for k in 0..4 {
        let (a, b) = (ring[k], ring[(k + 1) % 4]);
        out.face(&[a.extend(base), b.extend(base), b.extend(top), a.extend(top)], CONCRETE);
    }
    out.face(&ring.map(|p| p.extend(top)), CONCRETE);
    out.face(&[3, 2, 1, 0].map(|k: usize| ring[k].extend(base)), CONCRETE);
}
