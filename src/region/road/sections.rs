//! Sections of road: lines of the graph from junction to junction, with rounded corners, cut where bridges and tunnels begin and
//! end.

use super::budget::Budget;
use super::crossing::HighwayCrossing;
use super::graph::Graphs;
use super::inputs::Inputs;
use super::overpass::{BuiltGraphs, HALF_LENGTH, longest_way};
use super::shape::{Shape, Shapes, TileShapes, corner};
use super::tile::{tile_bounds, tiles_around};
use super::vertex::{Graph, Key};
use super::water_bridges::{SHORT_END, SHORT_LAND, land_and_water};
use crate::layer::{Cancel, LayerCache, LayerError, Weigh};
use crate::network::{JunctionId, Street, StreetId};
use crate::space::{
    Bounds, Origin, closest_on_line, cut_line, line_length, quantize, segment_crossing, segments, stable_hash,
};
use glam::{DVec2, I64Vec2};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A section of road between two junctions (gates, forks, crossings, ends of bridges and tunnels).
#[derive(Clone, Debug, PartialEq)]
pub struct RoadSection {
    /// Origin that `street.line` is local to.
    pub origin: Origin,
    /// The section as a street of the class highway, major or minor.
    pub street: Street,
}

impl RoadSection {
    /// Whether the box of any segment of the centre line overlaps a box of the plan.
    pub(super) fn enters(&self, bounds: Bounds) -> bool {
        let local = bounds.moved(-self.origin.plan());
        segments(&self.street.line).any(|(a, b)| Bounds::of([a, b]).overlaps(local))
    }
}

/// The sections along one line of the graph, or in one tile.
pub(super) struct SectionList(pub Vec<Arc<RoadSection>>);

impl Weigh for SectionList {
    fn bytes(&self) -> usize {
        let points = |r: &RoadSection| r.street.line.len() * size_of::<DVec2>();
        self.0.iter().map(|r| 8 + size_of::<RoadSection>() + points(r)).sum::<usize>() + 24
    }
}

/// The sections of all roads, remembered.
pub(super) struct Sections {
    inputs: Arc<Inputs>,
    graphs: Arc<Graphs>,
    built: Arc<BuiltGraphs>,
    shapes: Arc<Shapes>,
    /// Sections along a line, by the first two vertices of the line.
    lines: LayerCache<[Key; 2], SectionList>,
    tiles: LayerCache<[i64; 2], SectionList>,
}

/// The graphs and shapes of tiles that were visited while lines were followed.
struct Walk<'a> {
    built: &'a BuiltGraphs,
    shapes: &'a Shapes,
    cancel: &'a Cancel,
    seen_graphs: BTreeMap<[i64; 2], Arc<Graph>>,
    seen_shapes: BTreeMap<[i64; 2], Arc<TileShapes>>,
}

impl Walk<'_> {
    fn graph(&mut self, tile: I64Vec2) -> Result<Arc<Graph>, LayerError> {
        if let Some(held) = self.seen_graphs.get(&tile.to_array()) {
            return Ok(held.clone());
        }
        let made = self.built.graph(tile, self.cancel)?;
        self.seen_graphs.insert(tile.to_array(), made.clone());
        Ok(made)
    }

    fn shape(&mut self, key: Key) -> Result<Option<Shape>, LayerError> {
        let tile = key.tile().to_array();
        let held = match self.seen_shapes.get(&tile) {
            Some(held) => held.clone(),
            None => {
                let made = self.shapes.of_tile(key.tile(), self.cancel)?;
                self.seen_shapes.insert(tile, made.clone());
                made
            }
        };
        Ok(held.0.get(&key).copied())
    }

    /// The vertices from `a` over `b` to the next junction, `a` included.
    fn ahead(&mut self, a: Key, b: Key) -> Result<Vec<Key>, LayerError> {
        let mut out = vec![a, b];
        let (mut before, mut at) = (a, b);
        loop {
            let graph = self.graph(at.tile())?;
            let next = match graph.vertices.get(&at) {
                Some(v) if v.continues() && !at.is_gate() => v.ways.iter().map(|w| w.to).find(|to| *to != before),
                _ => None,
            };
            // A ring without a junction returns to its start.
            match next {
                Some(next) if at != a => {
                    out.push(next);
                    (before, at) = (at, next);
                }
                _ => return Ok(out),
            }
        }
    }

    /// The vertices of the whole line through the edge from `a` to `b`. Their order does not depend on the edge.
    fn line(&mut self, a: Key, b: Key) -> Result<Vec<Key>, LayerError> {
        let mut back = self.ahead(b, a)?;
        back.reverse();
        let ahead = self.ahead(a, b)?;
        back.extend(&ahead[2..]);
        let reversed: Vec<Key> = back.iter().rev().copied().collect();
        Ok(back.min(reversed))
    }
}

impl Sections {
    pub fn new(
        inputs: Arc<Inputs>,
        graphs: Arc<Graphs>,
        built: Arc<BuiltGraphs>,
        shapes: Arc<Shapes>,
        budget: Budget,
    ) -> Self {
        Self { inputs, graphs, built, shapes, lines: budget.cache(2), tiles: budget.cache(3) }
    }

    /// The crossings of highways in a tile.
    pub fn crossings(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Vec<HighwayCrossing>, LayerError> {
        self.built.crossings(tile, cancel)
    }

    /// The sections whose centre line enters a tile, sorted by id.
    pub fn of_tile(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<SectionList>, LayerError> {
        self.tiles.get(&tile.to_array(), || self.make(tile, cancel))
    }

    fn make(&self, tile: I64Vec2, cancel: &Cancel) -> Result<SectionList, LayerError> {
        cancel.check()?;
        let step = self.inputs.step();
        let own = tile_bounds(tile, step);
        // Edges reach less than three steps across a tile's border. Smoothing moves lines by less than one step, and so does the
        // warping around settlements that are nodes.
        let margin = 2.0 * step as f64;
        // Vertices lie on ways that existed before merging, or on a way between two such vertices.
        let longest = longest_way(&self.inputs.settings);
        let before = self.graphs.vertices_near(tile, margin + 1.5 * longest, cancel)?;
        let near = own.grown(margin);
        let (seen_graphs, seen_shapes) = (BTreeMap::new(), BTreeMap::new());
        let mut walk = Walk { built: &self.built, shapes: &self.shapes, cancel, seen_graphs, seen_shapes };
        let mut lines: BTreeMap<[Key; 2], Vec<Key>> = BTreeMap::new();
        let mut done: Vec<[Key; 2]> = Vec::new();
        for tile in tiles_around(tile, 1) {
            let reached = tile_bounds(tile, step).grown(longest / 2.0);
            if !before.iter().any(|v| reached.contains(v.position.plan())) {
                continue;
            }
            let graph = walk.graph(tile)?;
            for (key, v) in &graph.vertices {
                for way in &v.ways {
                    let origin = Origin::at(own.min);
                    let at = [v.position.local_to(origin), way.position.local_to(origin)];
                    let passes = Bounds::of(at).overlaps(near.moved(-origin.plan()));
                    if !passes || done.contains(&[*key, way.to]) {
                        continue;
                    }
                    let line = walk.line(*key, way.to)?;
                    for pair in line.windows(2) {
                        done.extend([[pair[0], pair[1]], [pair[1], pair[0]]]);
                    }
                    lines.insert([line[0], line[1]], line);
                }
            }
        }
        let mut out = Vec::new();
        for (name, line) in lines {
            let along = self.lines.get(&name, || build(&self.inputs, &mut walk, &line).map(SectionList))?;
            out.extend(along.0.iter().filter(|r| r.enters(own)).cloned());
        }
        out.sort_by_key(|r| r.street.id);
        Ok(SectionList(out))
    }
}

/// The vertices of a line in the direction of its traffic, if it is one-way. Ramps have no vertices between their ends.
fn in_direction<'a>(walk: &mut Walk, keys: &'a [Key]) -> Result<Cow<'a, [Key]>, LayerError> {
    let [from, to, ..] = *keys else { return Ok(keys.into()) };
    let graph = walk.graph(from.tile())?;
    let way = graph.vertices.get(&from).and_then(|v| v.ways.iter().find(|w| w.to == to));
    let against = way.and_then(|w| w.ramp).is_some_and(|r| !r.ahead);
    Ok(if against { keys.iter().rev().copied().collect::<Vec<_>>().into() } else { keys.into() })
}

/// The sections along a line of the graph.
fn build(inputs: &Inputs, walk: &mut Walk, keys: &[Key]) -> Result<Vec<Arc<RoadSection>>, LayerError> {
    walk.cancel.check()?;
    let keys = &*in_direction(walk, keys)?;
    let mut corners: Vec<Shape> = Vec::new();
    let mut levels: Vec<i8> = Vec::new();
    let mut class = None;
    for (i, key) in keys.iter().enumerate() {
        let graph = walk.graph(key.tile())?;
        let Some(v) = graph.vertices.get(key) else { return Ok(Vec::new()) };
        let way = keys.get(i + 1).and_then(|next| v.ways.iter().find(|w| w.to == *next));
        class = class.or(way.map(|w| w.rank.class));
        levels.extend(way.map(|w| w.level));
        let inner = i > 0 && i + 1 < keys.len();
        let shape = if inner { walk.shape(*key)? } else { None };
        corners.push(shape.unwrap_or(Shape { position: v.position, round: false }));
        if let Some((way, ramp)) = way.and_then(|w| Some((w, w.ramp?))) {
            corners.push(Shape { position: ramp.bend, round: true });
            levels.push(way.level);
        }
    }
    let Some(class) = class else { return Ok(Vec::new()) };
    let origin = corners[0].position.origin;
    let mut line: Vec<DVec2> = vec![corners[0].position.local_to(origin)];
    // Runs of the line on one level: the index of the last point, and the level.
    let mut runs: Vec<(usize, i8)> = Vec::new();
    for i in 1..corners.len() {
        let points = match corners.get(i + 1) {
            Some(after) => corner(&corners[i - 1], &corners[i], after),
            None => vec![corners[i].position],
        };
        for p in points.iter().map(|p| p.local_to(origin)) {
            if line.last() != Some(&p) {
                line.push(p);
            }
        }
        if i + 1 == corners.len() || levels.get(i) != levels.get(i - 1) {
            runs.push((line.len() - 1, levels.get(i - 1).copied().unwrap_or(0)));
        }
    }

    let mut ends: Vec<&mut usize> = runs.iter_mut().map(|r| &mut r.0).collect();
    let line = inputs.nodes.warp(origin, line, &mut ends);
    let (from, to) = (keys[0].junction(), keys[keys.len() - 1].junction());
    let mut words = keys[0].words().to_vec();
    words.extend(keys[1].words());
    words.extend(keys[keys.len() / 2].words());
    words.extend([from.0, to.0]);
    let name = stable_hash(&words);
    let mut overpasses = Vec::new();
    for i in 1..keys.len().saturating_sub(1) {
        if let Some(below) = keys[i].below() {
            let around = [&corners[i - 1], &corners[i], &corners[i + 1]];
            overpasses.push(overpass(walk, below, around, origin, &line)?);
        }
    }
    let mut parts = parts(inputs, origin, &line, &runs);
    for overpass in overpasses {
        parts = with_overpass(parts, &line, overpass);
    }
    let mut out = Vec::new();
    for (i, part) in parts.iter().enumerate() {
        let end = |at: usize| match at {
            0 => from,
            n if n == parts.len() => to,
            n => JunctionId::of(&[3, name, n as u64]),
        };
        let id = StreetId::of(&[name, end(i).0, end(i + 1).0, i as u64]);
        let mut street = Street::new(id, class, end(i), end(i + 1), part.line.clone());
        (street.level, street.bridge, street.tunnel) = (part.level, part.bridge, part.level < 0);
        out.push(Arc::new(RoadSection { origin, street }));
    }
    Ok(out)
}

/// A part of a line between two junctions.
struct Part {
    line: Vec<DVec2>,
    level: i8,
    bridge: bool,
}

/// The parts of a line, cut where bridges and tunnels begin and end: those that the route chose, and small bridges over other
/// water.
fn parts(inputs: &Inputs, origin: Origin, line: &[DVec2], runs: &[(usize, i8)]) -> Vec<Part> {
    let mut out = Vec::new();
    let mut first = 0;
    for (last, level) in runs {
        let run = &line[first..=*last];
        first = *last;
        if *level != 0 {
            out.push(Part { line: run.to_vec(), level: *level, bridge: *level > 0 });
            continue;
        }
        let parts = land_and_water(inputs, origin, run);
        let whole = parts.len() == 1;
        out.extend(parts.into_iter().map(|(range, bridge)| {
            let line = if whole { run.to_vec() } else { cut(run, range) };
            Part { line, level: 0, bridge }
        }));
    }
    out
}

/// Metres along a line at which it passes over the highway that has the vertex `below`. `around` holds the line's own vertex
/// there, between the vertices before and after it.
fn overpass(
    walk: &mut Walk,
    below: Key,
    around: [&Shape; 3],
    origin: Origin,
    line: &[DVec2],
) -> Result<f64, LayerError> {
    let mut highway: Vec<Shape> = Vec::new();
    if let Some(v) = walk.graph(below.tile())?.vertices.get(&below) {
        for (key, position) in v.ways.iter().map(|w| (w.to, w.position)).chain([(below, v.position)]) {
            highway.push(walk.shape(key)?.unwrap_or(Shape { position, round: false }));
        }
    }
    // The curve between the middles of the edges before and after a vertex.
    let curve = |before: &Shape, at: &Shape, after: &Shape| {
        let middle = |s: &Shape| at.position.moved(s.position.from(&at.position) / 2.0);
        let points = std::iter::once(middle(before)).chain(corner(before, at, after)).chain([middle(after)]);
        points.map(|p| p.local_to(origin)).collect::<Vec<_>>()
    };
    let own = curve(around[0], around[1], around[2]);
    let met = if let [before, after, at] = highway.as_slice() {
        let other = curve(before, at, after);
        segments(&own)
            .flat_map(|(a, b)| segments(&other).map(move |(c, d)| segment_crossing(a, b, c, d)).collect::<Vec<_>>())
            .flatten()
            .next()
            .map(|c| c.at)
    } else {
        None
    };
    let at = met.unwrap_or_else(|| around[1].position.local_to(origin));
    Ok(closest_on_line(at, line).0)
}

/// The parts of a line, with a bridge over the highway that it crosses `overpass` metres along. Bridges that the new bridge
/// would meet become part of it.
fn with_overpass(parts: Vec<Part>, line: &[DVec2], overpass: f64) -> Vec<Part> {
    let (mut from, mut to) = (overpass - HALF_LENGTH, overpass + HALF_LENGTH);
    let mut at = 0.0;
    let mut ranges: Vec<(f64, f64, Part)> = Vec::new();
    for part in parts {
        let length = line_length(&part.line);
        ranges.push((at, at + length, part));
        at += length;
    }
    for (a, b, part) in &ranges {
        if part.bridge && *a < to + SHORT_LAND && *b > from - SHORT_LAND {
            (from, to) = (from.min(*a), to.max(*b));
        }
    }
    (from, to) = (if from < SHORT_END { 0.0 } else { from }, if to > at - SHORT_END { at } else { to });
    let mut out: Vec<Part> = Vec::new();
    let mut bridge = Some(Part { line: densify(&cut(line, (from, to))), level: 1, bridge: true });
    for (a, b, part) in ranges {
        if b <= from || a >= to {
            if a >= to {
                out.extend(bridge.take());
            }
            out.push(part);
            continue;
        }
        if a < from {
            out.push(Part { line: cut(&part.line, (0.0, from - a)), ..part });
        }
        if b >= to {
            out.extend(bridge.take());
        }
        if b > to {
            out.push(Part { line: cut(&part.line, (to - a, b - a)), ..part });
        }
    }
    out.extend(bridge);
    // The ends of the bridge were found along another line: joins the parts.
    for i in 1..out.len() {
        let (head, tail) = out.split_at_mut(i);
        if let ([.., before], [after, ..]) = (head, tail)
            && let ([.., end], [begin, ..]) = (before.line.as_mut_slice(), after.line.as_mut_slice())
        {
            if before.level > 0 { *end = *begin } else { *begin = *end }
        }
    }
    out
}

/// The line with points at most 16 m apart, so that an overpass can rise between them.
fn densify(line: &[DVec2]) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = line[..1].to_vec();
    for (a, b) in segments(line) {
        let count = (a.distance(b) / 16.0).ceil().max(1.0) as usize;
        out.extend((1..=count).map(|i| if i == count { b } else { quantize(a.lerp(b, i as f64 / count as f64)) }));
    }
    out.dedup();
    out
}

/// A part of a line, with its new ends on the quantum grid.
fn cut(line: &[DVec2], (from, to): (f64, f64)) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = cut_line(line, from, to).into_iter().map(quantize).collect();
    out.dedup();
    out
}
