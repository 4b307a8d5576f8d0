//! Connectors from merged roads to the roads that stayed, and the graph after merging.

use super::padding::{ON_LINE, longest_connector};
use super::rules::{Rules, SHARP};
use crate::layer::LayerError;
use crate::region::road::vertex::{Graph, Key, Position, Rank};
use crate::space::math::angle_between;
use crate::space::{Bounds, orient};
use glam::{DVec2, I64Vec2};

/// Least desirable angle in radians between a connector and the road that it meets.
const BLUNT: f64 = 0.8;
/// Penalty for meeting a road at a sharp angle; a bend of one radian has the penalty 1.
const SHARP_PENALTY: f64 = 0.7;
/// Penalty for each metre of a connector.
const PENALTY_PER_METRE: f64 = 0.0003;
/// Penalty for crossing a road that will probably be dropped.
const CROSSING_PENALTY: f64 = 0.3;

/// A road from a vertex that lost edges to one that did not.
struct Connector {
    ends: [usize; 2],
    rank: Rank,
}

/// The graph of the tile after merging.
pub(super) fn rebuild(rules: &mut Rules, tile: I64Vec2) -> Result<Graph, LayerError> {
    let step = rules.inputs.step();
    let own = rules.net.own;
    let mut connectors: Vec<Connector> = Vec::new();
    for v in rules.net.nodes_in(own.grown(2.0 * longest_connector(&rules.inputs.settings)))? {
        if rules.needs_connector(v)? {
            connectors.extend(connector(rules, v)?);
        }
    }
    let mut lines: Vec<([usize; 2], Rank, i8, Vec<I64Vec2>)> = Vec::new();
    for c in &connectors {
        lines.push((c.ends, c.rank, 0, splits_of_connector(rules, c, &connectors)?));
    }
    for e in rules.net.edges_in(own)? {
        if rules.is_dropped(e)? {
            continue;
        }
        let edge = &rules.net.edges[e];
        let crossed =
            connectors.iter().filter(|_| edge.level == 0).filter_map(|c| meet(rules, c.ends, edge.ends)).collect();
        lines.push((edge.ends, edge.rank, edge.level, crossed));
    }
    let mut out = Graph::default();
    for (ends, rank, level, mut splits) in lines {
        let [a, b] = ends.map(|n| &rules.net.nodes[n]);
        if let (Some(p), Some(q)) = (a.key.ground_parts(), b.key.ground_parts()) {
            splits.sort_by_key(|s| ((*s - p).dot(q - p), s.to_array()));
        }
        let mut chain: Vec<(Key, Position)> = vec![(a.key, a.position)];
        let split = splits.into_iter().map(|s| Key::Ground { x: s.x, y: s.y });
        chain.extend(split.map(|k| (k, k.position(step))));
        chain.push((b.key, b.position));
        chain.dedup_by_key(|c| c.0);
        for pair in chain.windows(2) {
            out.join(tile, pair[0], pair[1], rank, level);
        }
    }
    Ok(out)
}

/// The connector of a vertex. Of the vertices that better edges join with its rung, it leads to the one that the road continues
/// to most smoothly.
fn connector(rules: &mut Rules, v: usize) -> Result<Option<Connector>, LayerError> {
    let (Some(rank), Some(rung)) = (rules.net.nodes[v].best, rules.rung(v)?) else { return Ok(None) };
    let mut kept: Vec<usize> = Vec::new();
    for e in rules.net.nodes[v].ways.clone() {
        if !rules.is_dropped(e)? {
            kept.push(e);
        }
    }
    kept.sort_by_key(|e| (rules.net.edges[*e].rank, rules.net.nodes[rules.net.far(*e, v)].key));
    let Some(first) = kept.first() else { return Ok(None) };
    let out_rank = rules.net.edges[*first].rank;
    let outward: Vec<DVec2> = kept.iter().map(|e| rules.net.step(v, rules.net.far(*e, v))).collect();

    let longest = longest_connector(&rules.inputs.settings);
    let mut joined = vec![rung];
    let mut at = 0;
    while let Some(n) = joined.get(at).copied() {
        for e in &rules.net.nodes[n].ways {
            let next = rules.net.far(*e, n);
            if rules.net.is_better(*e, rank) && !joined.contains(&next) && rules.net.apart(v, next) <= longest {
                joined.push(next);
            }
        }
        at += 1;
    }
    let mut scored: Vec<(f64, Key, usize)> = Vec::new();
    for w in joined {
        if rules.runs_beside(w)? {
            continue;
        }
        if let Some(crossings) = crossings(rules, v, w)? {
            let score = score(rules, v, w, &outward, rank) + CROSSING_PENALTY * crossings as f64;
            scored.push((score, rules.net.nodes[w].key, w));
        }
    }
    scored.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (_, _, w) in scored {
        if rules.is_free(v, w)? {
            return Ok(Some(Connector { ends: [v, w], rank: out_rank }));
        }
    }
    Ok(Some(Connector { ends: [v, rung], rank: out_rank }))
}

/// Penalty for the bends of a road that comes in along the first of `outward` (the edges kept at `v`) and continues over a
/// connector to `w` and the edges there.
fn score(rules: &Rules, v: usize, w: usize, outward: &[DVec2], rank: Rank) -> f64 {
    let by = rules.net.step(v, w);
    let bend = outward.first().map_or(0.0, |u| angle_between(-*u, by));
    let beside = outward.iter().map(|u| angle_between(*u, by)).fold(f64::INFINITY, f64::min);
    let ways = rules.net.nodes[w].ways.iter().filter(|e| rules.net.edges[**e].rank < rank);
    let met = ways.map(|e| angle_between(-by, rules.net.step(w, rules.net.far(*e, w)))).fold(f64::INFINITY, f64::min);
    let sharp = |angle: f64| {
        let lacks = (BLUNT - angle).max(0.0);
        lacks * lacks + if angle < SHARP { SHARP_PENALTY } else { 0.0 }
    };
    bend * bend + 3.0 * (sharp(met) + sharp(beside)) + PENALTY_PER_METRE * by.length()
}

/// Number of edges that the straight line between two vertices crosses, if all their ends run beside better roads. `None` if the
/// line crosses any other edge or comes too near a vertex.
fn crossings(rules: &mut Rules, v: usize, w: usize) -> Result<Option<usize>, LayerError> {
    let box_of = Bounds::of([rules.net.nodes[v].at, rules.net.nodes[w].at]);
    let longest = longest_connector(&rules.inputs.settings);
    let mut count = 0;
    for e in rules.net.edges_in(box_of.grown(ON_LINE))? {
        let ends = rules.net.edges[e].ends;
        if ends == [v, w] || ends == [w, v] {
            continue;
        }
        for n in ends {
            if n != v && n != w && rules.net.distance_to_line(n, v, w) < ON_LINE {
                return Ok(None);
            }
        }
        if !ends.contains(&v) && !ends.contains(&w) && crosses(rules, [v, w], ends) {
            if rules.net.edges[e].level != 0 {
                return Ok(None);
            }
            for n in ends {
                if rules.net.apart(v, n) > longest || !rules.runs_beside(n)? {
                    return Ok(None);
                }
            }
            count += 1;
        }
    }
    Ok(Some(count))
}

/// Whether two lines cross inside both.
fn crosses(rules: &Rules, [a, b]: [usize; 2], [c, d]: [usize; 2]) -> bool {
    let [b, c, d] = [b, c, d].map(|n| rules.net.step(a, n));
    let a = DVec2::ZERO;
    orient(a, b, c) * orient(a, b, d) < 0.0 && orient(c, d, a) * orient(c, d, b) < 0.0
}

/// The point where a connector and another line cross, rounded to whole parts of a step.
fn meet(rules: &Rules, connector: [usize; 2], other: [usize; 2]) -> Option<I64Vec2> {
    if other.iter().any(|n| connector.contains(n)) || !crosses(rules, connector, other) {
        return None;
    }
    // Where an end of the other line lies on the connector, the connector bends to that end.
    if other.iter().any(|n| rules.net.distance_to_line(*n, connector[0], connector[1]) < ON_LINE) {
        return None;
    }
    // The result is the same whichever line comes first, and in every tile.
    let of = |line: [usize; 2]| {
        let [p, q] = line.map(|n| rules.net.nodes[n].key.ground_parts().map(|p| p.to_array()));
        Some((p.min(q)?, p.max(q)?))
    };
    let (e, f) = (of(connector)?, of(other)?);
    let (e, f) = (e.min(f), e.max(f));
    let [a, b, c, d] = [e.0, e.1, f.0, f.1].map(I64Vec2::from);
    let (r, s, ac) = (b - a, d - c, c - a);
    let den = r.perp_dot(s);
    let along = |x: i64| (2 * x * ac.perp_dot(s) + den).div_euclid(2 * den);
    (den != 0).then(|| a + I64Vec2::new(along(r.x), along(r.y)))
}

/// Points where a connector is split: vertices that lie on it, and crossings.
fn splits_of_connector(rules: &mut Rules, c: &Connector, all: &[Connector]) -> Result<Vec<I64Vec2>, LayerError> {
    let mut out = Vec::new();
    let bounds = Bounds::of(c.ends.map(|n| rules.net.nodes[n].at)).grown(ON_LINE);
    for e in rules.net.edges_in(bounds)? {
        let ends = rules.net.edges[e].ends;
        if rules.net.edges[e].level != 0 {
            continue;
        }
        let near = |n: &usize| !c.ends.contains(n) && rules.net.distance_to_line(*n, c.ends[0], c.ends[1]) < ON_LINE;
        let on_line: Vec<usize> = ends.into_iter().filter(near).collect();
        let meets = meet(rules, c.ends, ends);
        if (on_line.is_empty() && meets.is_none()) || rules.is_dropped(e)? {
            continue;
        }
        out.extend(meets);
        out.extend(on_line.iter().filter_map(|n| rules.net.nodes[*n].key.ground_parts()));
    }
    out.extend(all.iter().filter_map(|o| meet(rules, c.ends, o.ends)));
    Ok(out)
}
