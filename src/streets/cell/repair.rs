//! Repair: connects floating streets and dead ends, removes stumps, and divides large blocks.

use super::canvas::Maker;
use super::division::divide_blocks;
use super::draft::Draft;
use super::floating::connect_floating;
use super::mend::{Mend, build_best, landing, off_field};
use super::obstacle::{NONE, nearest};
use super::proposal::Join;
use super::rules::Limits;
use crate::layer::{Cancel, LayerError};
use crate::network::VertexIx;
use crate::space::math::{angle_of, rotate};
use glam::DVec2;
use std::collections::BTreeSet;

/// Number of connections that are checked exactly for one dead end.
const TRIES: usize = 10;

/// Distance, in lengths of streets, within which a dead end is led to another one where nothing is nearer.
const FAR_ENDS: f64 = 3.0;

/// Greatest angle by which a dead end turns to meet another street, in radians.
const MOST_TURN: f64 = 1.57;

/// Streets at ports that are shorter than this and lead nowhere are made longer, in metres.
const STUB: f64 = 30.0;

/// Distance that these keep from other streets if the style lets them, in metres.
const CUL_DE_SAC_GAP: f64 = 22.0;

/// Number of angles to either side that are tried where a dead end goes on, and the angle between two of them in radians.
const FAN: (i32, f64) = (8, 0.17);

/// Angles in radians by which a street that goes on with a bend turns at the bend.
const BENDS: [f64; 4] = [1.57, -1.57, 1.1, -1.1];

/// A dead end.
struct End {
    v: VertexIx,
    at: DVec2,
    /// Unit direction in which its street would go on.
    onward: DVec2,
}

impl End {
    /// Distance within which it is connected to other streets, in metres.
    fn reach(&self, draft: &Draft<'_>) -> f64 {
        1.5 * draft.rules.local.length
    }
}

/// Repairs the network. Repair beats deletion: only stumps are removed. The streets around `anchors`, vertices of the graph,
/// are connected to a port.
pub fn repair(draft: &mut Draft<'_>, anchors: &[VertexIx], cancel: &Cancel) -> Result<(), LayerError> {
    connect_floating(draft, anchors);
    let mut undivided = BTreeSet::new();
    for round in 0..2 {
        connect_dead_ends(draft);
        remove_stumps(draft);
        cancel.check()?;
        if divide_blocks(draft, &mut undivided) == 0 && round == 0 {
            break;
        }
    }
    connect_floating(draft, anchors);
    connect_dead_ends(draft);
    remove_stumps(draft);
    lengthen_stubs(draft);
    Ok(())
}

/// The dead ends that the network may go on from, each with the length of its street in metres and whether that begins at a
/// port; the shortest first.
fn dead_ends(draft: &Draft<'_>) -> Vec<(f64, VertexIx, bool)> {
    let mut out: Vec<_> = draft.canvas.graph.vertices().filter_map(|v| dead_end(draft, v)).collect();
    out.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    out
}

/// What [`dead_ends`] says of the vertex `v`; `None` if the network does not end there, or may not go on.
fn dead_end(draft: &Draft<'_>, v: VertexIx) -> Option<(f64, VertexIx, bool)> {
    let canvas = &draft.canvas;
    (canvas.is_dead_end(v) && canvas.nodes[v as usize].open).then(|| {
        let (end, length) = canvas.follow(v, canvas.graph.edges_at(v)[0], |_| {});
        (length, v, canvas.nodes[end as usize].port.is_some())
    })
}

/// Connects dead ends, except a share of them that the style lets stay.
fn connect_dead_ends(draft: &mut Draft<'_>) {
    let stay = draft.rules.local.dead_ends;
    for (_, v, _) in dead_ends(draft) {
        if stay > 0.0 && draft.rng.chance(stay) {
            // It is not asked again.
            draft.canvas.nodes[v as usize].open = false;
        } else if draft.canvas.is_dead_end(v) {
            connect(draft, v);
        }
    }
}

/// Connects the dead end `v` by a straight street or by one with a bend, if one keeps the rules of the repair.
fn connect(draft: &mut Draft<'_>, v: VertexIx) -> bool {
    let Some(onward) = draft.canvas.onward(v) else { return false };
    let end = End { v, at: draft.canvas.graph.at(v), onward };
    let limits = draft.rules.repair;
    let reach = end.reach(draft);
    draft.gather(end.at, reach + limits.gap + 30.0);
    let fan = |_: &Draft<'_>, from: DVec2| {
        let straight = || (-FAN.0..=FAN.0).map(|step| f64::from(step) * FAN.1).collect();
        if from == end.at { straight() } else { BENDS.to_vec() }
    };
    // A style may allow no angle but a right one.
    let square = |draft: &Draft<'_>, from: DVec2| square_ways(draft, end.v, from, end.onward, reach);
    let mends = ways_on(draft, &end, fan);
    if build_best(draft, mends, &limits, TRIES, Maker::Repair) {
        return true;
    }
    let mends = ways_on(draft, &end, square);
    build_best(draft, mends, &limits, TRIES, Maker::Repair) || meet_far_end(draft, &end)
}

/// The streets by which a dead end may go on to what was gathered: straight ones, and such with a bend after some metres straight
/// on. `angles` has the angles from straight on, in radians, in which they may leave a place.
fn ways_on(draft: &Draft<'_>, end: &End, angles: impl Fn(&Draft<'_>, DVec2) -> Vec<f64>) -> Vec<Mend> {
    let &End { v, at, onward } = end;
    let reach = end.reach(draft);
    let mut mends: Vec<Mend> = Vec::new();
    let mut line = Vec::new();
    for angle in angles(draft, at) {
        if let Some((end, last, distance)) = landing(draft, at, rotate(onward, angle), reach, v, &mut line) {
            let welcome = if matches!(last, Join::At(w) if draft.canvas.is_dead_end(w)) { 0.6 } else { 1.0 };
            let cost = distance * welcome * (1.0 + 0.5 * angle.abs());
            mends.push(Mend::straight(cost, at, end, Join::At(v), last));
        }
    }
    let ahead = draft.landing().ray(at, at + onward * reach, v).map_or(reach, |h| h.1 * reach);
    for share in [34.0, 52.0, 75.0].into_iter().take_while(|share| *share <= ahead - 18.0) {
        let bend = at + onward * share;
        for angle in angles(draft, bend) {
            if let Some((end, last, distance)) = landing(draft, bend, rotate(onward, angle), reach, NONE, &mut line)
                && -onward.dot((end - bend).normalize_or_zero()) <= draft.rules.repair.bend_cosine
            {
                let cost = 1.5 * (share + distance);
                mends.push(Mend::bent(cost, [at, bend, end], Join::At(v), last));
            }
        }
    }
    mends
}

/// Leads a dead end to another one that is farther away, by a straight street or by one with a bend.
fn meet_far_end(draft: &mut Draft<'_>, &End { v, at, onward }: &End) -> bool {
    let reach = FAR_ENDS * draft.rules.local.length;
    // Better near a main street than a dead end.
    let limits = Limits { wall_gap: draft.rules.repair.clearance, ..draft.rules.repair };
    draft.gather(at, reach + limits.gap);
    let ends = draft.trial.near.loose_ends.iter().filter(|t| t.open && t.v != v && t.at.distance(at) < reach);
    let mut mends: Vec<Mend> = Vec::new();
    for tip in ends {
        let distance = tip.at.distance(at);
        mends.push(Mend::straight(distance * off_field(draft, at, tip.at), at, tip.at, Join::At(v), Join::At(tip.v)));
        // The bend lies straight on from one of both ends.
        for share in [0.3, 0.6] {
            for bend in [at + onward * (share * distance), tip.at + tip.onward * (share * distance)] {
                let cost = 1.5 * (at.distance(bend) + bend.distance(tip.at));
                mends.push(Mend::bent(cost, [at, bend, tip.at], Join::At(v), Join::At(tip.v)));
            }
        }
    }
    build_best(draft, mends, &limits, TRIES, Maker::Repair)
}

/// Angles in radians from `onward` at which streets from `from` meet others within `reach` metres square. What ends at `v` is
/// left out.
fn square_ways(draft: &Draft<'_>, v: VertexIx, from: DVec2, onward: DVec2, reach: f64) -> Vec<f64> {
    let near = draft.trial.near.obstacles.iter().filter(|s| !s.is_wall() && !s.ends_at(v));
    let feet = near.map(|s| nearest(from, s.a, s.b) - from).filter(|way| way.length() < reach);
    feet.map(|way| angle_of(DVec2::new(onward.dot(way), onward.perp_dot(way))))
        .filter(|angle| angle.abs() < MOST_TURN)
        .collect()
}

/// Removes dead-end streets that are too short, except at ports and in pinned pieces.
fn remove_stumps(draft: &mut Draft<'_>) {
    let is_stump = |(length, _, at_port): &(f64, VertexIx, bool), most: f64| *length < most && !at_port;
    loop {
        let mut removed = false;
        for end in dead_ends(draft) {
            // Without the shorter ones this may be a longer street, or go on.
            let stump =
                dead_end(draft, end.1).filter(|end| is_stump(end, draft.rules.stump) && !is_pinned(draft, end.1));
            removed |= stump.is_some_and(|(_, v, _)| draft.canvas.remove_dead_end(v).is_some());
        }
        if !removed {
            break;
        }
    }
}

/// Whether the street that ends at the dead end `v` is part of a pinned piece.
fn is_pinned(draft: &Draft<'_>, v: VertexIx) -> bool {
    let g = &draft.canvas.graph;
    let mut pinned = false;
    draft.canvas.follow(v, g.edges_at(v)[0], |e| {
        let edge = g.edge(e);
        pinned |= draft.canvas.nodes[edge.a as usize].pinned && draft.canvas.nodes[edge.b as usize].pinned;
    });
    pinned
}

/// Lengthens the stubs that still lead nowhere into cul-de-sacs.
fn lengthen_stubs(draft: &mut Draft<'_>) {
    let local = draft.rules.local;
    for (length, v, at_port) in dead_ends(draft) {
        if !at_port || length > STUB.max(draft.rules.repair.min_piece) {
            continue;
        }
        let (at, Some(onward)) = (draft.canvas.graph.at(v), draft.canvas.onward(v)) else { continue };
        draft.gather(at, local.length + 2.0 * draft.rules.growth.gap);
        for (share, angle) in
            [(0.8, 0.0), (0.55, 0.0), (0.35, 0.0), (0.55, 0.4), (0.55, -0.4), (0.35, 0.7), (0.35, -0.7)]
        {
            let end = at + rotate(onward, angle) * (share * local.length);
            draft.trial.proposal.line(&[at, end], Join::At(v), Join::Free(false));
            let gap = CUL_DE_SAC_GAP.clamp(draft.rules.repair.gap, draft.rules.growth.gap);
            let limits = Limits { gap, ..draft.rules.repair };
            if draft.build_if_fits(&limits, Maker::Repair) {
                break;
            }
        }
    }
}
