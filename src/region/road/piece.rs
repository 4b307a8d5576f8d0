//! Pieces of road: lines of the graph from junction to junction, rounded off, and cut where bridges begin and end.

use super::course::Course;
use super::graph::{Graph, Key, tile_bounds};
use super::over::{CLEARANCE, HALF_LENGTH, longest, rise};
use super::profile::Profile;
use super::shape::{Shape, Shapes, corner};
use super::{Road, Work};
use crate::layer::{Cancel, LayerError, Weigh};
use crate::network::{JunctionId, Street, StreetId};
use crate::space::{
    Bounds, Measured, Origin, closest_on_line, cut_line, line_length, math::mix, quantize, segment_crossing, segments,
    stable_hash,
};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Share of a step of the lattice after which lines are looked at for water: 8 m of 128.
const WATER_STEP: f64 = 1.0 / 16.0;
/// How far a bridge reaches onto land at each end, in metres, so that its ends lie above the water.
const ABUTMENT: f64 = 8.0;
/// Land between two bridges that is shorter, in metres, is bridged too.
const SHORT_LAND: f64 = 24.0;
/// A bridge that ends this near a junction, in metres, goes on to it.
const SHORT_END: f64 = 20.0;

/// Pieces along one line of the graph, or pieces in one tile.
pub(super) struct Pieces(pub Vec<Arc<Road>>);

impl Weigh for Pieces {
    fn bytes(&self) -> usize {
        let points = |r: &Road| r.street.line.len() * (size_of::<DVec2>() + size_of::<f64>());
        self.0.iter().map(|r| 8 + size_of::<Road>() + points(r)).sum::<usize>() + 24
    }
}

impl Road {
    /// Whether the centre line comes into a box of the plan: whether the box of any of its segments overlaps it.
    pub(super) fn enters(&self, bounds: Bounds) -> bool {
        let local = bounds.moved(-self.origin.plan());
        segments(&self.street.line).any(|(a, b)| Bounds::of([a, b]).overlaps(local))
    }
}

/// Graphs and shapes by tile, held while a line is followed.
struct Walk<'a> {
    work: &'a Work,
    cancel: &'a Cancel,
    graphs: BTreeMap<[i64; 2], Arc<Graph>>,
    shapes: BTreeMap<[i64; 2], Arc<Shapes>>,
}

impl Walk<'_> {
    fn graph(&mut self, tile: I64Vec2) -> Result<Arc<Graph>, LayerError> {
        if let Some(held) = self.graphs.get(&tile.to_array()) {
            return Ok(held.clone());
        }
        let made = self.work.separated(tile, self.cancel)?;
        self.graphs.insert(tile.to_array(), made.clone());
        Ok(made)
    }

    fn shape(&mut self, key: Key) -> Result<Option<Shape>, LayerError> {
        let tile = key.tile().to_array();
        let held = match self.shapes.get(&tile) {
            Some(held) => held.clone(),
            None => {
                let made = self.work.shapes(key.tile(), self.cancel)?;
                self.shapes.insert(tile, made.clone());
                made
            }
        };
        Ok(held.0.get(&key).copied())
    }

    /// The line from `a` over `b` on to the next junction, `a` included.
    fn ahead(&mut self, a: Key, b: Key) -> Result<Vec<Key>, LayerError> {
        let mut out = vec![a, b];
        let (mut before, mut at) = (a, b);
        loop {
            let graph = self.graph(at.tile())?;
            let next = match graph.vertices.get(&at) {
                Some(v) if v.goes_on() && !at.is_gate() => v.ways.iter().map(|w| w.to).find(|to| *to != before),
                _ => None,
            };
            // A ring without a junction would come back to its start.
            match next {
                Some(next) if at != a => {
                    out.push(next);
                    (before, at) = (at, next);
                }
                _ => return Ok(out),
            }
        }
    }

    /// The whole line through the edge from `a` to `b`, in the direction that is the same from whichever edge one starts.
    fn line(&mut self, a: Key, b: Key) -> Result<Vec<Key>, LayerError> {
        let mut back = self.ahead(b, a)?;
        back.reverse();
        let ahead = self.ahead(a, b)?;
        back.extend(&ahead[2..]);
        let reversed: Vec<Key> = back.iter().rev().copied().collect();
        Ok(back.min(reversed))
    }
}

/// Pieces whose centre line enters a tile, sorted by id.
pub(super) fn pieces(work: &Work, tile: I64Vec2, cancel: &Cancel) -> Result<Pieces, LayerError> {
    cancel.check()?;
    let own = tile_bounds(tile, work.settings.step);
    // Edges reach less than three steps over a tile's border; rounding off moves lines by less than one, and so does bending
    // them to settlements that are nodes.
    let margin = 2.0 * work.settings.step as f64;
    // Vertices lie on ways that were there before merging, or on one between two vertices of that time.
    let longest = longest(&work.settings);
    let before = work.near(tile, margin + 1.5 * longest, cancel)?;
    let near = own.grown(margin);
    let mut walk = Walk { work, cancel, graphs: BTreeMap::new(), shapes: BTreeMap::new() };
    let mut lines: BTreeMap<[Key; 2], Vec<Key>> = BTreeMap::new();
    let mut done: Vec<[Key; 2]> = Vec::new();
    for y in -1..=1 {
        for x in -1..=1 {
            let tile = tile + I64Vec2::new(x, y);
            let reached = tile_bounds(tile, work.settings.step).grown(longest / 2.0);
            if !before.iter().any(|v| reached.contains(v.place.origin.to_plan(v.place.offset))) {
                continue;
            }
            let graph = walk.graph(tile)?;
            for (key, v) in &graph.vertices {
                for way in &v.ways {
                    let origin = Origin::at(own.min);
                    let at = [v.place.local_to(origin), way.place.local_to(origin)];
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
    }
    let mut out = Vec::new();
    for (name, line) in lines {
        let along = work.along.get(&name, || build(&mut walk, &line).map(Pieces))?;
        out.extend(along.0.iter().filter(|r| r.enters(own)).cloned());
    }
    out.sort_by_key(|r| r.street.id);
    Ok(Pieces(out))
}

/// The pieces along a line of the graph.
fn build(walk: &mut Walk, keys: &[Key]) -> Result<Vec<Arc<Road>>, LayerError> {
    walk.cancel.check()?;
    let mut places: Vec<Shape> = Vec::new();
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
        places.push(shape.unwrap_or(Shape { place: v.place, round: false }));
    }
    let Some(class) = class else { return Ok(Vec::new()) };
    let origin = places[0].place.origin;
    let mut line: Vec<DVec2> = vec![places[0].place.local_to(origin)];
    // Parts of the line on one level: index of its last point, level.
    let mut runs: Vec<(usize, i8)> = Vec::new();
    for i in 1..places.len() {
        let points = match places.get(i + 1) {
            Some(after) => corner(&places[i - 1], &places[i], after),
            None => vec![places[i].place],
        };
        for p in points.iter().map(|p| p.local_to(origin)) {
            if line.last() != Some(&p) {
                line.push(p);
            }
        }
        if i + 1 == places.len() || levels.get(i) != levels.get(i - 1) {
            runs.push((line.len() - 1, levels.get(i - 1).copied().unwrap_or(0)));
        }
    }

    let mut ends: Vec<&mut usize> = runs.iter_mut().map(|r| &mut r.0).collect();
    let line = walk.work.nodes.bend(origin, line, &mut ends);
    let (from, to) = (keys[0].junction(), keys[keys.len() - 1].junction());
    let mut words = keys[0].words().to_vec();
    words.extend(keys[1].words());
    words.extend(keys[keys.len() / 2].words());
    words.extend([from.0, to.0]);
    let name = stable_hash(&words);
    let mut overpasses = Vec::new();
    for i in 1..places.len().saturating_sub(1) {
        if let Some(under) = keys[i].under() {
            overpasses.push(overpass(walk, under, [&places[i - 1], &places[i], &places[i + 1]], origin, &line)?);
        }
    }
    let work = walk.work;
    let mut parts = all_parts(work, origin, &line, &runs);
    for over in &overpasses {
        parts = raise(parts, &line, over);
    }
    let profile = Profile::along(&*work.terrain, origin, &line, &runs, work.settings.class(class).slope_limit);
    let mut out = Vec::new();
    let mut at = 0.0;
    for (i, part) in parts.iter().enumerate() {
        let end = |at: usize| match at {
            0 => from,
            n if n == parts.len() => to,
            n => JunctionId::of(&[3, name, n as u64]),
        };
        let id = StreetId::of(&[name, end(i).0, end(i + 1).0, i as u64]);
        let (mut heights, ends) = profile.heights(&part.line, at);
        for over in overpasses.iter().filter(|o| at < o.along && o.along < ends) {
            over.lift(&part.line, at, &mut heights);
        }
        at = ends;
        if let (true, Some(last)) = (i + 1 == parts.len(), heights.last_mut()) {
            *last = profile.end();
        }
        let mut street = Street::new(id, class, end(i), end(i + 1), part.line.clone());
        (street.level, street.bridge, street.tunnel) = (part.level, part.bridge, part.level < 0);
        out.push(Arc::new(Road { origin, street, heights }));
    }
    Ok(out)
}

/// A part of a line between two junctions.
struct Part {
    line: Vec<DVec2>,
    level: i8,
    bridge: bool,
}

/// A line cut where bridges and tunnels begin and end: those that the course chose, and bridges over what water is left.
fn all_parts(work: &Work, origin: Origin, line: &[DVec2], runs: &[(usize, i8)]) -> Vec<Part> {
    let mut out = Vec::new();
    let mut first = 0;
    for (last, level) in runs {
        let run = &line[first..=*last];
        first = *last;
        if *level != 0 {
            out.push(Part { line: run.to_vec(), level: *level, bridge: *level > 0 });
            continue;
        }
        let parts = parts(work, origin, run);
        let whole = parts.len() == 1;
        out.extend(parts.into_iter().map(|(range, bridge)| {
            let line = if whole { run.to_vec() } else { cut(run, range) };
            Part { line, level: 0, bridge }
        }));
    }
    out
}

/// Where a line passes over a highway.
struct Overpass {
    /// Metres along the line.
    along: f64,
    /// Height that the line has at least there.
    height: f64,
}

/// The crossing of a line with the highway that has the vertex `under`. `around` are the line's own vertex there and those
/// before and after it.
fn overpass(
    walk: &mut Walk,
    under: Key,
    around: [&Shape; 3],
    origin: Origin,
    line: &[DVec2],
) -> Result<Overpass, LayerError> {
    let mut below: Vec<Shape> = Vec::new();
    if let Some(v) = walk.graph(under.tile())?.vertices.get(&under) {
        for (key, place) in v.ways.iter().map(|w| (w.to, w.place)).chain([(under, v.place)]) {
            below.push(walk.shape(key)?.unwrap_or(Shape { place, round: false }));
        }
    }
    // Between the middles of the edges before and after.
    let curve = |before: &Shape, at: &Shape, after: &Shape| {
        let middle = |s: &Shape| at.place.moved(s.place.from(&at.place) / 2.0);
        let places = std::iter::once(middle(before)).chain(corner(before, at, after)).chain([middle(after)]);
        places.map(|p| p.local_to(origin)).collect::<Vec<_>>()
    };
    let own = curve(around[0], around[1], around[2]);
    let met = if let [before, after, at] = below.as_slice() {
        let other = curve(before, at, after);
        segments(&own)
            .flat_map(|(a, b)| segments(&other).map(move |(c, d)| segment_crossing(a, b, c, d)).collect::<Vec<_>>())
            .flatten()
            .next()
            .map(|c| c.at)
    } else {
        None
    };
    let at = met.unwrap_or_else(|| around[1].place.local_to(origin));
    let height = walk.work.terrain.height(origin.to_plan(at)) + CLEARANCE;
    Ok(Overpass { along: closest_on_line(at, line).0, height })
}

impl Overpass {
    /// Lifts the heights along its bridge, a part of the line that begins at a length along it.
    fn lift(&self, part: &[DVec2], from: f64, heights: &mut [f64]) {
        let length = line_length(part);
        let (Some(first), Some(last)) = (heights.first().copied(), heights.last().copied()) else { return };
        let straight = |at: f64| mix(first, last, at / length.max(1e-9));
        let own = self.along - from;
        let lift = (self.height - straight(own)).max(0.0);
        let mut at = 0.0;
        for (i, height) in heights.iter_mut().enumerate() {
            at += if i > 0 { part[i].distance(part[i - 1]) } else { 0.0 };
            *height = straight(at) + lift * rise((at - own) / if at < own { own } else { length - own });
        }
    }
}

/// The parts of a line with a bridge over a highway. Bridges that it would meet become one with it.
fn raise(parts: Vec<Part>, line: &[DVec2], over: &Overpass) -> Vec<Part> {
    let (mut from, mut to) = (over.along - HALF_LENGTH, over.along + HALF_LENGTH);
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
    let mut bridge = Some(Part { line: even(&cut(line, (from, to))), level: 1, bridge: true });
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
    // Its ends were found along another line.
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

/// The line with points at most 16 m apart, so that it can rise between them.
fn even(line: &[DVec2]) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = line[..1].to_vec();
    for (a, b) in segments(line) {
        let count = (a.distance(b) / 16.0).ceil().max(1.0) as usize;
        out.extend((1..=count).map(|i| if i == count { b } else { quantize(a.lerp(b, i as f64 / count as f64)) }));
    }
    out.dedup();
    out
}

/// A part of a line, its new ends on the quantum grid.
fn cut(line: &[DVec2], (from, to): (f64, f64)) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = cut_line(line, from, to).into_iter().map(quantize).collect();
    out.dedup();
    out
}

/// Lengths of a line in turn over land and over water: from, to, and whether it is a bridge.
fn parts(work: &Work, origin: Origin, line: &[DVec2]) -> Vec<((f64, f64), bool)> {
    let line = Measured::new(line);
    let length = line.length();
    let count = (length / (WATER_STEP * work.settings.step as f64)).ceil().max(1.0) as usize;
    let step = length / count as f64;
    let mut wet: Vec<(f64, f64)> = Vec::new();
    for i in 0..=count {
        let p = line.point_at(i as f64 * step);
        if work.terrain.sample(origin.to_plan(p)).depth() <= 0.0 {
            continue;
        }
        let (from, to) = ((i as f64 - 1.0) * step - ABUTMENT, (i as f64 + 1.0) * step + ABUTMENT);
        match wet.last_mut() {
            Some(last) if from - last.1 < SHORT_LAND => last.1 = to,
            _ => wet.push((from, to)),
        }
    }
    let mut out = Vec::new();
    let mut at = 0.0;
    for (from, to) in wet {
        let from = if from < SHORT_END { 0.0 } else { from };
        let to = if to > length - SHORT_END { length } else { to };
        if from > at {
            out.push(((at, from), false));
        }
        out.push(((from, to), true));
        at = to;
    }
    if at < length {
        out.push(((at, length), false));
    }
    out
}

/// Number of bridges along a course but for those that its search chose.
pub(super) fn bridges(work: &Work, course: &Course) -> usize {
    let line = course.line(work.settings.step);
    // Relative to its own origin, so that the same way is the same anywhere.
    let origin = Origin::at(line.first().copied().unwrap_or_default());
    let local: Vec<DVec2> = line.iter().map(|p| origin.to_local(*p)).collect();
    // Points of the line are a gate, the nodes, and a gate.
    let mut first = 0;
    let mut count = 0;
    let ends = course.spans.iter().map(|s| (s.first + 1, s.last + 1)).chain([(local.len() - 1, 0)]);
    for (last, next) in ends {
        if last > first {
            count += parts(work, origin, &local[first..=last]).iter().filter(|p| p.1).count();
        }
        first = next;
    }
    count
}
