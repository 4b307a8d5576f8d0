//! Merging of roads that run beside each other (Galin et al. 2011, section 6). Makes the graph without twins, tile by tile;
//! reads the graph and the ground within [`padding`].
//!
//! # What is done
//!
//! Every way has a rank: its class, then the length and the name of its course. A course *runs beside* better ways at a
//! vertex when over some steps it stays within the merge distance of them without heading away; so does the first vertex
//! after a fork that is too sharp. Such a vertex has a *rung*: the nearest vertex of a better way that itself runs beside
//! nothing better. A way goes when the rungs of its two ends (or the ends themselves, where they lie on better ways) are
//! joined by better ways within the merge distance: then vertex after vertex, coupled by rungs, keeps within that distance,
//! which is what the discrete Frechet distance of the two stretches measures (Eiter and Mannila 1994). Where a vertex loses
//! ways but keeps others, a connector takes the place of the rung, bent so that the road goes on smoothly: its far end is
//! the Steiner junction, a vertex that was there before, so its name is that of its place. Last, `feet` moves such junctions
//! along the better road to whole parts of a step of the lattice, where the angles are blunter or another road meets it.
//!
//! # Why nothing falls apart
//!
//! Add all rungs to the graph, each ranking just before the ways of the vertex it starts from. A way goes only as the last in
//! rank of a ring (itself, two rungs, better ways). Leaving out the last edge of any number of rings, all at once, splits no
//! graph: its least spanning forest holds none of them. Rungs end at vertices that run beside nothing, whose best ways
//! stay, so a rung whose own vertex has lost every way is a dead end and goes too; a rung whose vertex has lost none was
//! part of no ring. A connector may end elsewhere than its rung as far as better ways join the two ends. The class of what
//! stays is the greatest of what it replaces, as class comes first in rank. Every decision is a function of the
//! graph around it, so there is no order.

mod connect;
mod feet;
mod net;
mod ring;
mod rules;

use super::graph::{Graph, TILE_STEPS, tile_bounds};
use super::{RoadSettings, Work, around};
use crate::layer::{Cancel, LayerError, Reach};
pub(super) use connect::parts;
pub(super) use feet::{feet, longest_stem};
use glam::I64Vec2;
pub(super) use net::Net;
pub(super) use rules::Rules;

/// Length in steps of the stretch, each way from a vertex, over which a course is watched.
const WATCHED_STEPS: f64 = 3.0;
/// How much nearer to each other shaping mostly brings two roads than they are on the lattice, in metres.
const NEARER: f64 = 11.0;
/// Greatest length of an edge of the lattice in steps.
const EDGE_STEPS: f64 = 2.237;

/// Greatest length of a connector in metres: over the merge distance at half a right angle.
pub(super) fn longest_connector(settings: &RoadSettings) -> f64 {
    1.4 * settings.merge
}

/// Distance in metres within which a course is beside another: shaping may bring roads a little nearer.
fn beside(settings: &RoadSettings) -> f64 {
    settings.merge + NEARER
}

/// Greatest length of a rung in metres: vertices of a road that is beside lie up to half an edge further along.
fn longest_rung(settings: &RoadSettings) -> f64 {
    let half = EDGE_STEPS * settings.step as f64 / 2.0;
    (beside(settings) * beside(settings) + half * half).sqrt()
}

/// How far in metres around its tile the merged graph depends on the graph: a connector into the tile, one that crosses it,
/// what the choice of that one depends on: whether its ways go, and what runs beside what where it could end.
fn padding(settings: &RoadSettings) -> f64 {
    let step = settings.step as f64;
    let (edge, connector) = (EDGE_STEPS * step, longest_connector(settings));
    let beside = WATCHED_STEPS * step + beside(settings);
    let goes = edge + longest_rung(settings) + beside;
    2.0 * connector + goes.max(connector + beside)
}

/// How far in metres around its tile the graph after both stages depends on the graph before them.
pub(super) fn reads(settings: &RoadSettings) -> f64 {
    padding(settings) + feet::padding(settings)
}

/// The graph of a tile where no more than one course comes near: there nothing merges and no foot moves. Vertices that would
/// decide otherwise lie within a stem, the longer of an edge and a connector, and a rung.
fn plain(work: &Work, tile: I64Vec2, cancel: &Cancel) -> Result<Option<Graph>, LayerError> {
    let (settings, step) = (&work.settings, work.settings.step as f64);
    let reads = longest_stem(settings) + (EDGE_STEPS * step).max(longest_connector(settings)) + longest_rung(settings);
    let ring = (reads / (TILE_STEPS as f64 * step)).ceil() as i64;
    let mut rank = None;
    for tile in around(tile, ring) {
        for v in work.graph(tile, cancel)?.vertices.values() {
            if v.ways.len() > 2 || v.ways.iter().any(|w| *rank.get_or_insert(w.rank) != w.rank) {
                return Ok(None);
            }
        }
    }
    Ok(Some(Graph { vertices: work.graph(tile, cancel)?.vertices.clone() }))
}

/// The graph of one tile after merging.
pub(super) fn merged(work: &Work, tile: I64Vec2, cancel: &Cancel) -> Result<Graph, LayerError> {
    cancel.check()?;
    let step = work.settings.step as f64;
    if work.settings.merge <= 0.0 {
        return Ok(Graph { vertices: work.graph(tile, cancel)?.vertices.clone() });
    }
    if let Some(plain) = plain(work, tile, cancel)? {
        return Ok(plain);
    }
    let own = tile_bounds(tile, work.settings.step);
    let reach = Reach::new("roads", own, padding(&work.settings));
    let ring = (padding(&work.settings) / (TILE_STEPS as f64 * step)).ceil() as i64;
    let graphs = around(tile, ring).map(|t| work.graph(t, cancel)).collect::<Result<Vec<_>, _>>()?;
    let net = Net::new(work, tile, reach, &graphs)?;
    connect::rebuild(&mut rules::Rules::new(work, net), tile)
}
