//! Patterns: a patch repeated along a main street, between two main streets, or onwards from a candidate vertex (Teng
//! 2017, sections 3.2 and 5).

use super::at_ports::{PortOrder, across_ports, lay_at_ports};
use super::coarse::roughly_fits;
use super::placement::Placement;
use super::placer::{Placer, build};
use crate::network::VertexIx;
use crate::patch::Pattern;
use crate::space::math::turn;
use crate::streets::cell::{Draft, Obstacle, RemovedStubs, has_stub, nearest};
use crate::style::StartRules;
use glam::DVec2;

/// Shares of the least and greatest scale of a pattern between which an element may be drawn out along a main street.
pub const OF_SCALE: (f64, f64) = (0.95, 1.05);

/// Least cosine of the angle at which a row meets the ports at its ends.
const FACING: f64 = 0.95;

/// Longest row between two main streets, in metres.
const LONGEST_ROW: f64 = 420.0;

/// A row of elements along a main street.
pub struct Row {
    /// The ports that they stand at.
    pub ports: Vec<usize>,
    /// Whether the network cannot go on from any of them.
    pub is_closed: bool,
}

/// Begins a cell with patterns where the style and the ports allow; returns the row that stands along a main street.
pub fn start_with_patterns(
    draft: &mut Draft<'_>,
    placer: &mut Placer<'_>,
    rules: &StartRules,
    order: &PortOrder,
) -> Option<Row> {
    let rooted = |main: bool| -> Vec<usize> {
        let patches = placer.patches;
        let of = |i: &usize| patches.facts(patches.patterns()[*i].element).main.is_some() == main;
        (0..patches.patterns().len()).filter(of).collect()
    };
    let (along, between) = (rooted(true), rooted(false));
    let mut row = None;
    if !along.is_empty() && draft.rng.chance(rules.patterns_along) {
        row = pattern_along(draft, placer, &along, order);
    }
    if !between.is_empty() && draft.rng.chance(rules.patterns_between) {
        pattern_between(draft, placer, &between);
    }
    row
}

/// Chooses one of the patterns `of`, by the weights of their elements.
fn pick_pattern(draft: &mut Draft<'_>, placer: &mut Placer<'_>, of: &[usize]) -> Option<usize> {
    let entries = placer.patches.patterns();
    let weights: Vec<f64> = of.iter().map(|i| placer.weight(entries[*i].element)).collect();
    draft.rng.weighted(&weights).map(|i| of[i])
}

/// Lays a pattern along a main street. Its elements stand at ports next to each other. They have one scale across the street,
/// and each is stretched along the street to meet its ports. Returns where the row stands, if there is one.
fn pattern_along(draft: &mut Draft<'_>, placer: &mut Placer<'_>, of: &[usize], order: &PortOrder) -> Option<Row> {
    let pick = pick_pattern(draft, placer, of)?;
    let patches = placer.patches;
    let entry = &patches.patterns()[pick];
    let (element, pattern) = (entry.element, &entry.pattern);
    let patch = &patches.patches[element];
    let main = patches.facts(element).main.as_ref()?;
    let (from, to) = (patch.vertices[main.from], patch.vertices[main.to]);
    let roots = main.attachments.as_slice();
    let (one, last) = (*roots.first()?, *roots.last()?);
    let width = patch.vertices[one].distance(patch.vertices[last]);
    // Elements whose side streets stand at the ends of their main street have these in common.
    let shared = roots.len() > 1 && (width - from.distance(to)).abs() < 1.0;
    let per_element = roots.len();
    let runs: Vec<Vec<usize>> = order.runs(draft).into_iter().filter(|r| r.len() >= per_element).collect();
    let advance = if shared { per_element - 1 } else { per_element };
    // Where a row can stand rather than one element.
    let room =
        |r: &Vec<usize>| if r.len() >= per_element + advance { (r.len() - per_element + 1) as f64 } else { 0.01 };
    let lengths: Vec<f64> = runs.iter().map(room).collect();
    let run = draft.rng.weighted(&lengths).map(|i| &runs[i])?;
    let at = |i: usize| draft.brief.ports[run[i]].at;
    let step = at(0).distance(at(run.len() - 1)) / (run.len() - 1).max(1) as f64;
    let step = if run.len() > 1 { step } else { from.distance(to) };
    let natural = if per_element > 1 { step * (per_element - 1) as f64 / width } else { step / from.distance(to) };
    let scale = natural.clamp(pattern.scale.0, pattern.scale.1);
    let times = times(draft, pattern);
    let (mut i, mut laid, mut ports) = (0, 0, Vec::new());
    let before = draft.candidates.len();
    while i + per_element <= run.len() && laid < times {
        let here = &run[i..i + per_element];
        let fits = match *here {
            [a] => lay_at_port(draft, placer, element, (one, a), scale),
            _ => lay_across_ports(draft, placer, element, roots, here, scale, pattern),
        };
        if fits {
            laid += 1;
            ports.extend_from_slice(here);
        }
        // A pattern begins where it fits first, and ends where it no longer does.
        if laid > 0 && !fits {
            break;
        }
        i += if fits { advance } else { 1 };
    }
    (laid > 0).then_some(Row { ports, is_closed: draft.candidates.len() == before })
}

/// Draws the number of elements of a pattern.
fn times(draft: &mut Draft<'_>, pattern: &Pattern) -> u32 {
    let (low, high) = pattern.repeat;
    low + draft.rng.index((high - low + 1) as usize) as u32
}

/// Lays an element with one root at a port; returns whether it fits.
fn lay_at_port(
    draft: &mut Draft<'_>,
    placer: &mut Placer<'_>,
    element: usize,
    root: (usize, usize),
    scale: f64,
) -> bool {
    let port = draft.brief.ports[root.1];
    let patch = &placer.patches.patches[element];
    let Some(main) = &placer.patches.facts(element).main else { return false };
    let along = patch.vertices[main.to] - patch.vertices[main.from];
    let start = (element, root.0, patch.vertices[root.0]);
    let to = -port.inward.perp() * (along.length() * scale);
    let placement = Placement::drawn_out(start, along, port.at, to, scale);
    lay_at_ports(draft, placer, placement, &[root])
}

/// Lays an element with several roots at ports next to each other; returns whether it fits.
fn lay_across_ports(
    draft: &mut Draft<'_>,
    placer: &mut Placer<'_>,
    element: usize,
    roots: &[usize],
    ports: &[usize],
    scale: f64,
    pattern: &Pattern,
) -> bool {
    let Some(placed) = across_ports(draft, placer.patches, element, (roots, ports), Some(scale)) else { return false };
    let drawn_out = placed.along;
    (OF_SCALE.0 * pattern.scale.0..=OF_SCALE.1 * pattern.scale.1).contains(&drawn_out)
        && lay_at_ports(draft, placer, placed.placement, &placed.roots)
}

/// Lays a pattern as a row between two ports that face each other.
fn pattern_between(draft: &mut Draft<'_>, placer: &mut Placer<'_>, of: &[usize]) {
    let Some(pick) = pick_pattern(draft, placer, of) else { return };
    let entry = &placer.patches.patterns()[pick];
    let (element, pattern) = (entry.element, entry.pattern.clone());
    let Some(length) = placer.patches.patches[element].pairs.last().map(|p| p.distance) else { return };
    let ports = draft.brief.ports;
    let mut pairs: Vec<(f64, usize, usize, u32)> = Vec::new();
    let free: Vec<usize> = (0..ports.len()).filter(|i| has_stub(&draft.canvas, draft.brief.ports.len(), *i)).collect();
    for (n, &i) in free.iter().enumerate() {
        for &k in &free[..n] {
            let (p, q) = (&ports[i], &ports[k]);
            let d = p.at.distance(q.at);
            let line = (q.at - p.at) / d.max(1e-9);
            let facing = p.inward.dot(line).min(-q.inward.dot(line));
            let times = (d / (length * (pattern.scale.0 + pattern.scale.1) / 2.0)).round().max(1.0);
            let scale = d / (times * length);
            let fits = (pattern.scale.0..=pattern.scale.1).contains(&scale) && times as u32 <= pattern.repeat.1;
            if facing > FACING && d < LONGEST_ROW && fits && times as u32 >= pattern.repeat.0.min(2) {
                pairs.push((facing * draft.rng.range(0.95, 1.0), i, k, times as u32));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, i, k, times) in pairs.into_iter().take(4) {
        let stubs = [i, k].map(|port| draft.canvas.graph.edges_at(port as VertexIx)[0]);
        let line = (ports[i].at, ports[k].at);
        draft.gather((line.0 + line.1) / 2.0, line.0.distance(line.1) / 2.0 + 10.0);
        let clear = |s: &Obstacle| {
            stubs.contains(&s.edge)
                || (s.is_wall() && [line.0, line.1].iter().any(|p| nearest(*p, s.a, s.b).distance(*p) < 0.01))
                || crate::space::segment_crossing(line.0, line.1, s.a, s.b).is_none()
        };
        if draft.trial.near.obstacles.iter().all(clear) && row_between(draft, placer, element, (i, k), times) {
            return;
        }
    }
}

/// Lays a row of elements from one port towards another; returns whether there is at least one. A row may end before it
/// reaches the other port; then the streets grow on from its last end.
fn row_between(
    draft: &mut Draft<'_>,
    placer: &mut Placer<'_>,
    element: usize,
    (first, last): (usize, usize),
    times: u32,
) -> bool {
    let (a, b) = (draft.brief.ports[first].at, draft.brief.ports[last].at);
    let mut at = first as VertexIx;
    for k in 0..times {
        let target = a.lerp(b, f64::from(k + 1) / f64::from(times));
        let is_last = k + 1 == times;
        let mut stubs = RemovedStubs::default();
        let ends = [(k == 0).then_some(first), is_last.then_some(last)];
        // An earlier element may have met the stub of the last port.
        if !ends.into_iter().flatten().all(|port| stubs.remove(&mut draft.canvas, draft.brief.ports.len(), port)) {
            stubs.restore(&mut draft.canvas);
            return k > 0;
        }
        let end = is_last.then_some(last as VertexIx);
        let built = lay_element(draft, placer, element, at, target, end);
        let Some(reached) = built else {
            stubs.restore(&mut draft.canvas);
            return k > 0;
        };
        let Some(next) = reached else { return true };
        at = next;
    }
    true
}

/// Lays an element between `v` and the place `target`, where the port `end` may lie. `None` if it does not fit, else the vertex
/// at its far end, unless that end met another street before.
fn lay_element(
    draft: &mut Draft<'_>,
    placer: &mut Placer<'_>,
    element: usize,
    v: VertexIx,
    target: DVec2,
    end: Option<VertexIx>,
) -> Option<Option<VertexIx>> {
    if placer.weight(element) <= 0.0 {
        return None;
    }
    let patches = placer.patches;
    let patch = &patches.patches[element];
    let pair = patch.pairs.last()?;
    let (a, b) = (patch.connectables[pair.a], patch.connectables[pair.b]);
    let at = draft.canvas.graph.at(v);
    let (pa, pb) = (patch.vertices[a.vertex], patch.vertices[b.vertex]);
    let onward = match draft.canvas.nodes[v as usize].port {
        Some(port) => draft.brief.ports[port].inward,
        None => draft.canvas.onward(v)?,
    };
    let arriving = end.map(|port| -draft.brief.ports[port as usize].inward);
    let chord = target - at;
    // As large as the element becomes; one that is larger than the cell cannot stand in it.
    let size = patch.radius * chord.length() / pa.distance(pb);
    if size > draft.canvas.size() {
        return None;
    }
    draft.gather((at + target) / 2.0, 2.0 * size + 2.0 * draft.rules.growth.gap + draft.rules.growth.min_piece);
    let wanted = [Some(turn(chord, onward)), arriving.map(|a| turn(chord, a))];
    let first = draft.rng.chance(0.5);
    for (mirrored, back) in [(first, false), (!first, false), (first, true), (!first, true)] {
        let (a, b, pa, pb) = if back { (b, a, pb, pa) } else { (a, b, pa, pb) };
        let straight = Placement::new((element, a.vertex, pa), pb - pa, mirrored, at, target - at);
        let heading = |i: DVec2| straight.map(i) - straight.map(DVec2::ZERO);
        let is = [turn(chord, heading(a.inward)), turn(chord, heading(-b.inward))];
        let Some((slopes, _)) = placer.bending.of(&patches.facts(element).shape).bend(is, wanted) else { continue };
        let placement = straight.bent(at, target, slopes);
        let anchors = [(a.vertex, v), (b.vertex, end.unwrap_or_default())];
        let anchors = if end.is_some() { &anchors[..] } else { &anchors[..1] };
        if roughly_fits(draft, placer.patches, &placement, at, end.map(|_| target))
            && placer.propose_patch(draft, &placement, anchors)
            && build(draft, element)
        {
            let tip = placement.map(pb);
            let reached = draft.trial.built.iter().copied().filter(|w| draft.canvas.is_dead_end(*w));
            let near = |w: &VertexIx| draft.canvas.graph.at(*w).distance(tip);
            let reached = reached.min_by(|x, y| near(x).total_cmp(&near(y)).then(x.cmp(y)));
            let reached = reached.filter(|w| near(w) < 1.0);
            placer.after_patch(draft, element);
            return Some(end.or(reached));
        }
    }
    None
}

/// Lays a pattern as a row onwards from `v`; returns whether there is at least one element.
pub fn pattern_onwards(draft: &mut Draft<'_>, placer: &mut Placer<'_>, v: VertexIx, direction: DVec2) -> bool {
    let patches = placer.patches;
    let free = |i: &usize| patches.facts(patches.patterns()[*i].element).main.is_none();
    let of: Vec<usize> = (0..patches.patterns().len()).filter(free).collect();
    let Some(pick) = pick_pattern(draft, placer, &of) else { return false };
    let entry = &patches.patterns()[pick];
    let (element, pattern) = (entry.element, &entry.pattern);
    let Some(length) = patches.patches[element].pairs.last().map(|p| p.distance) else { return false };
    let scale = draft.rng.range(pattern.scale.0, pattern.scale.1);
    let mut at = v;
    for laid in 0..times(draft, pattern) {
        let from = draft.canvas.graph.at(at);
        match lay_element(draft, placer, element, at, from + direction * (length * scale), None) {
            Some(Some(next)) => at = next,
            Some(None) => return true,
            None => return laid > 0,
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::tests::Kit;
    use super::*;
    use crate::streets::cell::{finish, lay_stubs};
    use crate::streets::contract::defects;

    /// How many elements `lay` built, and at how many ports, over many cells of each style that has such patterns.
    fn built(kits: &[Kit], main: bool, lay: impl Fn(&mut Draft<'_>, &mut Placer<'_>, &[usize])) -> Vec<(u32, usize)> {
        let mut out = Vec::new();
        for kit in kits {
            let patches = &kit.filler.patches;
            let of = |i: &usize| patches.facts(patches.patterns()[*i].element).main.is_some() == main;
            let patterns: Vec<usize> = (0..patches.patterns().len()).filter(of).collect();
            for seed in 300..if patterns.is_empty() { 300 } else { 340 } {
                let cell = kit.cell(seed);
                let brief = cell.brief();
                let mut draft = Draft::new(&brief);
                let mut placer = Placer::new(&draft, patches, &kit.filler.weights, &kit.filler.once);
                lay_stubs(&mut draft);
                lay(&mut draft, &mut placer, &patterns);
                let n = cell.ports.len();
                let ports = (0..n).filter(|i| !has_stub(&draft.canvas, n, *i)).count();
                out.push((placer.laid().iter().map(|(_, uses)| uses).sum(), ports));
                let streets = finish(&draft, "", patches.names());
                assert_eq!(defects(&cell, &streets), Vec::<String>::new(), "{} {seed}", kit.style.name);
            }
        }
        out
    }

    #[test]
    fn patterns_stand_along_main_streets() {
        let found = built(&Kit::all(), true, |draft, placer, of| {
            let order = PortOrder::of(draft.brief);
            pattern_along(draft, placer, of, &order);
        });
        let rows = found.iter().filter(|(elements, _)| *elements >= 2).count();
        assert!(rows * 8 > found.len(), "{rows} rows in {} cells", found.len());
        // Each element begins at a port of its own, or shares its side street with the one before.
        assert!(found.iter().all(|(elements, ports)| *ports >= *elements as usize));
    }

    #[test]
    fn patterns_bridge_main_streets() {
        let found = built(&Kit::all(), false, pattern_between);
        let bridges = found.iter().filter(|(_, ports)| *ports >= 2).count();
        assert!(bridges * 8 > found.len(), "{bridges} of {} cells have a row from street to street", found.len());
    }
}
