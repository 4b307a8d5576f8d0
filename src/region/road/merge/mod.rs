//! Merging of roads that run beside each other (Galin et al. 2011, section 6). Makes the graph without parallel roads, tile by
//! tile. Reads the graph before merging, the terrain and the outlines within the padding that `padding` declares.
//!
//! # What is computed
//!
//! The paper measures the distance of two stretches by the discrete Frechet distance (Eiter and Mannila 1994). Here couplings of
//! vertices, called *rungs*, take its place; the Frechet distance itself is not computed.
//!
//! Every edge has a rank: first its class, then the length and the id of its route. A route *runs beside* better edges at a
//! vertex if, over some steps, it stays within the merge distance of them without heading away. The first vertex after a fork
//! that is too sharp also runs beside. Each such vertex has a rung to the nearest vertex of a better edge that itself runs
//! beside nothing better. An edge is dropped if better edges near it join the rungs of its two ends (or the ends themselves, where
//! they lie on better edges). So both stretches are coupled vertex after vertex by rungs, none of them longer than
//! `longest_rung`, which is a little more than the merge distance.
//!
//! Roads of another class do not merge with toll roads (section 6): for them, edges of toll roads are no better edges.
//!
//! Where a vertex loses edges but keeps others, a *connector* takes the place of the rung, chosen so that the road continues
//! smoothly. Its far end is the Steiner junction of the paper. That junction is a vertex that was there before, so its id comes
//! from its position. At last, `realign` moves such junctions along the better road, to whole parts of a step of the lattice,
//! where the angles are blunter or another road meets the same place.
//!
//! # Why the network stays connected
//!
//! Add all rungs to the graph, each ranked just before the edges of the vertex that it starts from. An edge is dropped only as
//! the last in rank of a ring that consists of itself, two rungs and better edges. Dropping the last edge of any number of rings
//! at once disconnects no graph, because the minimum spanning forest contains none of these edges. Rungs end at vertices that
//! run beside nothing and keep their best edges. A rung whose own vertex lost every edge is a dead end and is dropped, too. A
//! rung whose vertex lost no edge was part of no ring. A connector may end elsewhere than its rung, as far as better edges join
//! both ends. The class of what stays is the highest class of what it replaces, because the class comes first in the rank. Every
//! decision is a function of the graph nearby, so there is no order of decisions.

mod connect;
mod net;
mod padding;
mod realign;
mod ring;
mod rules;
mod stages;

pub(super) use net::Net;
pub(super) use padding::{longest_connector, longest_leg, padding};
pub(super) use rules::Rules;
pub(super) use stages::MergedGraphs;
