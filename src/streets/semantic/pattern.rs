//! Patterns: a patch repeated along a main street, between two main streets, or onwards from a candidate vertex (Teng
//! 2017, sections 3.2 and 5).

use super::coarse::roughly_fits;
use super::placement::Placement;
use super::placer::{Placer, build};
use crate::network::VertexIx;
use crate::patch::{Patch, Pattern, keeps_rules};
use crate::space::math::turn;
use crate::streets::cell::{Draft, Join, NONE, Obstacle, RemovedStubs, has_stub, nearest};
use glam::DVec2;

/// Share of cells that begin with a pattern along a main street, if the style has such patterns.
const ALONG: f64 = 0.4;

/// Share of cells that begin with a pattern between two main streets, if the style has such patterns.
const BETWEEN: f64 = 0.3;

/// Share of candidate vertices from which a pattern is tried.
pub const ONWARDS: f64 = 0.06;

/// Least cosine of the angle at which a row meets the ports at its ends.
const FACING: f64 = 0.95;

/// Longest row between two main streets, in metres.
const LONGEST_ROW: f64 = 420.0;

/// Begins a cell with patterns where chance and the ports allow.
pub fn start_with_patterns(draft: &mut Draft<'_>, placer: &mut Placer<'_>) {
    let rooted = |main: bool| -> Vec<usize> {
        let patches = placer.patches;
        let of = |i: &usize| patches.facts(patches.patterns()[*i].element).main.is_some() == main;
        (0..patches.patterns().len()).filter(of).collect()
    };
    let (along, between) = (rooted(true), rooted(false));
    if !along.is_empty() && draft.rng.chance(ALONG) {
        pattern_along(draft, placer, &along);
    }
    if !between.is_empty() && draft.rng.chance(BETWEEN) {
        pattern_between(draft, placer, &between);
    }
}

/// Chooses one of the patterns `of`, by the weights of their elements.
fn pick_pattern(draft: &mut Draft<'_>, placer: &mut Placer<'_>, of: &[usize]) -> Option<usize> {
    let entries = placer.patches.patterns();
    let weights: Vec<f64> = of.iter().map(|i| placer.weight(entries[*i].element)).collect();
    draft.rng.weighted(&weights).map(|i| of[i])
}

/// Runs of ports along the sides of the cell, in order; only ports whose stubs are not built on.
fn runs(draft: &Draft<'_>) -> Vec<Vec<usize>> {
    let ports = draft.brief.ports;
    let n = draft.brief.border.len();
    let place = |i: usize| {
        let on = |k: &usize| {
            let (a, b) = (draft.brief.border[*k], draft.brief.border[(k + 1) % n]);
            crate::space::distance_to_segment(ports[i].at, a, b)
        };
        let edge = (0..n).min_by(|a, b| on(a).total_cmp(&on(b))).unwrap_or(0);
        (edge, draft.brief.border.get(edge).map_or(0.0, |a| a.distance(ports[i].at)))
    };
    let mut order: Vec<(usize, f64, usize)> =
        (0..ports.len()).map(|i| (place(i), i)).map(|(p, i)| (p.0, p.1, i)).collect();
    order.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut runs: Vec<Vec<usize>> = Vec::new();
    for (_, _, i) in order {
        if !has_stub(&draft.canvas, draft.brief.ports.len(), i) {
            continue;
        }
        let goes_on = runs.last().and_then(|r| r.last()).is_some_and(|&before: &usize| {
            let (p, q) = (&ports[before], &ports[i]);
            let step = q.at - p.at;
            p.inward.dot(q.inward) > 0.9 && step.dot(p.inward).abs() < 0.3 * step.length()
        });
        match runs.last_mut() {
            Some(run) if goes_on => run.push(i),
            _ => runs.push(vec![i]),
        }
    }
    runs
}

/// Lays a pattern along a main street. Its elements stand at ports next to each other. They have one scale across the street,
/// and each is stretched along the street to meet its ports.
fn pattern_along(draft: &mut Draft<'_>, placer: &mut Placer<'_>, of: &[usize]) {
    let Some(pick) = pick_pattern(draft, placer, of) else { return };
    let entry = &placer.patches.patterns()[pick];
    let (element, pattern) = (entry.element, entry.pattern.clone());
    let patch = placer.patches.patches[element].clone();
    let Some(main) = placer.patches.facts(element).main.clone() else { return };
    let (from, to) = (patch.vertices[main.from], patch.vertices[main.to]);
    let (&[one] | &[one, ..]) = main.attachments.as_slice() else { return };
    let last = main.attachments[main.attachments.len() - 1];
    let width = patch.vertices[one].distance(patch.vertices[last]);
    // Elements whose side streets stand at the ends of their main street have these in common.
    let shared = main.attachments.len() == 2 && (width - from.distance(to)).abs() < 1.0;
    let per_element = main.attachments.len().min(2);
    let runs: Vec<Vec<usize>> = runs(draft).into_iter().filter(|r| r.len() >= per_element).collect();
    // Where a row can stand rather than one element.
    let needed = if shared { 3 } else { 2 * per_element };
    let room = |r: &Vec<usize>| if r.len() >= needed { (r.len() - per_element + 1) as f64 } else { 0.01 };
    let lengths: Vec<f64> = runs.iter().map(room).collect();
    let Some(run) = draft.rng.weighted(&lengths).map(|i| &runs[i]) else { return };
    if main.attachments.len() > 2 {
        return;
    }
    let at = |i: usize| draft.brief.ports[run[i]].at;
    let step = at(0).distance(at(run.len() - 1)) / (run.len() - 1).max(1) as f64;
    let step = if run.len() > 1 { step } else { from.distance(to) };
    let natural = if per_element == 2 { step / width } else { step / from.distance(to) };
    let scale = natural.clamp(pattern.scale.0, pattern.scale.1);
    let times = times(draft, &pattern);
    let advance = if per_element == 2 && !shared { 2 } else { 1 };
    let (mut i, mut laid) = (0, 0);
    while i + per_element <= run.len() && laid < times {
        let ports = &run[i..i + per_element];
        let fits = match *ports {
            [a] => lay_at_port(draft, placer, &patch, element, (one, a), scale, &pattern),
            [a, b] => lay_between_ports(draft, placer, &patch, element, [(one, a), (last, b)], scale, &pattern),
            _ => false,
        };
        laid += u32::from(fits);
        // A pattern begins where it fits first, and ends where it no longer does.
        if laid > 0 && !fits {
            break;
        }
        i += if fits { advance } else { 1 };
    }
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
    patch: &Patch,
    element: usize,
    root: (usize, usize),
    scale: f64,
    pattern: &Pattern,
) -> bool {
    let port = draft.brief.ports[root.1];
    let Some(main) = &placer.patches.facts(element).main else { return false };
    let along = patch.vertices[main.to] - patch.vertices[main.from];
    let scale = scale.clamp(pattern.scale.0, pattern.scale.1);
    let placement = Placement::drawn_out(
        (element, root.0, patch.vertices[root.0]),
        along,
        port.at,
        -port.inward.perp() * (along.length() * scale),
        scale,
    );
    lay_at_ports(draft, placer, placement, patch, &[root])
}

/// Lays an element with two roots between two ports; returns whether it fits.
fn lay_between_ports(
    draft: &mut Draft<'_>,
    placer: &mut Placer<'_>,
    patch: &Patch,
    element: usize,
    roots: [(usize, usize); 2],
    scale: f64,
    pattern: &Pattern,
) -> bool {
    let [(a, p), (b, q)] = roots;
    let from = patch.vertices[b] - patch.vertices[a];
    let (at, to) = (draft.brief.ports[p].at, draft.brief.ports[q].at - draft.brief.ports[p].at);
    let drawn_out = to.length() / from.length();
    if !(0.95 * pattern.scale.0..=1.05 * pattern.scale.1).contains(&drawn_out) {
        return false;
    }
    let placement = Placement::drawn_out((element, a, patch.vertices[a]), from, at, to, scale);
    lay_at_ports(draft, placer, placement, patch, &roots)
}

/// Builds a patch whose roots fall on ports, in place of their stubs, and returns whether it fits. A side street that it shares
/// with the element before is not built again.
pub fn lay_at_ports(
    draft: &mut Draft<'_>,
    placer: &mut Placer<'_>,
    placement: Placement,
    patch: &Patch,
    roots: &[(usize, usize)],
) -> bool {
    let centre = placement.map(DVec2::ZERO);
    let mut stubs = RemovedStubs::default();
    for (_, port) in roots {
        if has_stub(&draft.canvas, draft.brief.ports.len(), *port) {
            stubs.remove(&mut draft.canvas, *port as VertexIx);
        }
    }
    let anchors: Vec<(usize, VertexIx)> = roots.iter().map(|(v, port)| (*v, *port as VertexIx)).collect();
    draft.gather(centre, 1.5 * patch.radius + draft.rules.growth.gap + draft.rules.growth.min_piece);
    let start = draft.brief.ports[roots[0].1].at;
    let end = roots.get(1).map(|r| draft.brief.ports[r.1].at);
    // What is shared is there already: only the exact check can tell it from what is in the way.
    let shares = roots.iter().any(|r| draft.canvas.graph.degree(r.1 as VertexIx) > 0);
    let fits = (shares || roughly_fits(draft, placer.patches, &placement, start, end))
        && placer.propose(draft, &placement, &anchors, false)
        && share_streets(draft, roots)
        && build(draft, placement.patch);
    if fits {
        placer.after_patch(draft, placement.patch);
    } else {
        stubs.restore(&mut draft.canvas);
    }
    fits
}

/// Removes from the proposal the streets that exist already. False if nothing is left or the rest breaks a rule.
fn share_streets(draft: &mut Draft<'_>, roots: &[(usize, usize)]) -> bool {
    let g = &draft.canvas.graph;
    if roots.iter().all(|r| g.degree(r.1 as VertexIx) == 0) {
        return true;
    }
    let p = &mut draft.trial.proposal;
    for i in 0..p.points.len() {
        let loose_ends = p.joins[i];
        if !matches!(loose_ends, Join::Free(_)) {
            continue;
        }
        let ends = draft.trial.near.obstacles.iter().flat_map(|s| [(s.va, s.a), (s.vb, s.b)]);
        let same = ends.filter(|(v, q)| *v != NONE && q.distance(p.points[i]) < SAME).map(|(v, _)| v);
        if let Some(v) = same.min() {
            p.joins[i] = Join::At(v);
            p.points[i] = g.at(v);
        }
    }
    let joins = p.joins.clone();
    p.edges.retain(|(a, b)| match (joins[*a], joins[*b]) {
        (Join::At(v), Join::At(w)) => g.edge_between(v, w).is_none(),
        _ => true,
    });
    // Points without an edge go.
    let used: Vec<bool> = (0..p.points.len()).map(|i| p.edges.iter().any(|e| e.0 == i || e.1 == i)).collect();
    let slot: Vec<usize> = used.iter().scan(0, |n, u| (Some(*n), *n += usize::from(*u)).0).collect();
    let keep = |i: &usize| used[*i];
    p.points = (0..used.len()).filter(keep).map(|i| p.points[i]).collect();
    p.joins = (0..used.len()).filter(keep).map(|i| joins[i]).collect();
    p.edges.iter_mut().for_each(|e| *e = (slot[e.0], slot[e.1]));
    !p.edges.is_empty() && keeps_rules(&p.points, &p.edges, 1.0)
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
        for port in [(k == 0).then_some(first), is_last.then_some(last)].into_iter().flatten() {
            stubs.remove(&mut draft.canvas, port as VertexIx);
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
    draft.gather((at + target) / 2.0, 1.2 * patch.radius + 2.0 * draft.rules.growth.gap + draft.rules.growth.min_piece);
    let chord = target - at;
    let wanted = [Some(turn(chord, onward)), arriving.map(|a| turn(chord, a))];
    let first = draft.rng.chance(0.5);
    for (mirrored, back) in [(first, false), (!first, false), (first, true), (!first, true)] {
        let (a, b, pa, pb) = if back { (b, a, pb, pa) } else { (a, b, pa, pb) };
        let straight = Placement::new((element, a.vertex, pa), pb - pa, mirrored, at, target - at);
        let heading = |i: DVec2| straight.map(i) - straight.map(DVec2::ZERO);
        let is = [turn(chord, heading(a.inward)), turn(chord, heading(-b.inward))];
        let Some((slopes, _)) = placer.bending.bend(is, wanted) else { continue };
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

/// Distance within which vertices of two elements that share a street are the same, in metres.
const SAME: f64 = 7.0;

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
                let mut placer = Placer::new(&draft, patches, &kit.filler.weights);
                lay_stubs(&mut draft);
                lay(&mut draft, &mut placer, &patterns);
                let n = cell.ports.len();
                let ports = (0..n).filter(|i| !has_stub(&draft.canvas, n, *i)).count();
                out.push((placer.uses(), ports));
                let streets = finish(&draft, "", patches.names());
                assert_eq!(defects(&cell, &streets), Vec::<String>::new(), "{} {seed}", kit.style.name);
            }
        }
        out
    }

    #[test]
    fn patterns_stand_along_main_streets() {
        let found = built(&Kit::all(), true, pattern_along);
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
