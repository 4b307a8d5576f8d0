//! Parametric growth of main streets (Teng 2017, section 2, Fig. 3, and the constraints of section 3.3): streets are proposed
//! from a queue of vertices, and connected, clipped or discarded.

use super::curves::{STEP, simplified};
use super::proposal::Proposal;
use super::sketch::{End, Sketch};
use crate::layer::{Cancel, LayerError};
use crate::network::VertexIx;
use crate::space::math::{angle_between, angle_of, direction, rotate, smoothstep, turn};
use crate::space::{Bounds, Stream, closest_on_line, closest_on_segment, line_length, point_at, segments};
use crate::town::DirectionField;
use glam::DVec2;
use std::f64::consts::TAU;

/// Grows the network from the centre and from the vertices `starts` outwards. Every street starts at the network that exists
/// already, so the result is one component.
pub(super) fn grow(
    sketch: &mut Sketch,
    field: &DirectionField,
    stream: &mut Stream,
    starts: &[VertexIx],
    cancel: &Cancel,
) -> Result<(), LayerError> {
    if sketch.graph.vertex_count() == 0 {
        sketch.graph.add_vertex(DVec2::ZERO);
    }
    let mut queue: Vec<(f64, VertexIx)> = vec![(0.0, 0)];
    queue.extend(starts.iter().map(|v| (sketch.graph.at(*v).length(), *v)));
    while let Some(i) = (0..queue.len()).min_by(|a, b| queue[*a].0.total_cmp(&queue[*b].0).then(a.cmp(b))) {
        cancel.check()?;
        let (_, v) = queue.swap_remove(i);
        let least = if starts.contains(&v) { sketch.graph.degree(v) + 1 } else { 0 };
        for heading in headings(sketch, field, stream, v, least) {
            let before = sketch.graph.vertex_count() as VertexIx;
            let Some(end) = propose(sketch, field, stream, v, heading) else { continue };
            // Points of inflexion are new, too, but only the end grows on.
            let new_junction = sketch.graph.degree(end) != 2;
            if end >= before && new_junction {
                queue.push((sketch.graph.at(end).length(), end));
            }
        }
    }
    Ok(())
}

/// Headings of the streets to propose at a vertex: enough for a degree drawn from the style's range, which is at least `least`
/// if the range allows it.
fn headings(sketch: &Sketch, field: &DirectionField, stream: &mut Stream, v: VertexIx, least: usize) -> Vec<DVec2> {
    let (rules, g, at) = (&sketch.rules, &sketch.graph, sketch.graph.at(v));
    let (low, high) = rules.degree;
    // As many streets as possible meet at the centre.
    let target = if v == 0 { high } else { (low + stream.index(high - low + 1)).max(least.min(high)) };
    let wanted = target.saturating_sub(g.degree(v));
    let existing: Vec<DVec2> = g.neighbours(v).map(|w| (g.at(w) - at).normalize_or_zero()).collect();
    let cross = direction(field.angle(at));
    let mut arms = [cross, cross.perp(), -cross, -cross.perp()];
    for i in (1..4).rev() {
        arms.swap(i, stream.index(i + 1));
    }
    // Straight continuations of streets come first.
    arms.sort_by_key(|a| !existing.iter().any(|d| d.dot(*a) < -0.9));
    let mut all = existing.clone();
    let mut out = Vec::new();
    let mut take = |heading: DVec2, all: &mut Vec<DVec2>| {
        if out.len() < wanted && all.iter().all(|d| angle_between(*d, heading) >= rules.min_angle) {
            all.push(heading);
            out.push(heading);
        }
    };
    for arm in arms {
        let through = existing.iter().copied().find(|d| d.dot(arm) < -0.9);
        let (from, swing) = match through {
            Some(d) => ((arm - d).normalize_or_zero(), 0.35),
            None => (arm, 1.0),
        };
        take(rotate(from, rules.angle_deviation * swing * stream.signed()), &mut all);
    }
    for _ in 4..target {
        // Streets beyond the four arms of the cross go into the widest gap.
        let mut angles: Vec<f64> = all.iter().map(|d| angle_of(*d)).collect();
        angles.sort_by(f64::total_cmp);
        let gap = |i: usize| match angles.get(i + 1) {
            Some(next) => next - angles[i],
            None => angles[0] + TAU - angles[i],
        };
        if let Some(i) = (0..angles.len()).max_by(|a, b| gap(*a).total_cmp(&gap(*b)).then(b.cmp(a))) {
            take(direction(angles[i] + gap(i) / 2.0), &mut all);
        }
    }
    out
}

/// Proposes a street from `v`, connects or clips it, and adds it if it keeps to the rules; returns its end.
fn propose(
    sketch: &mut Sketch,
    field: &DirectionField,
    stream: &mut Stream,
    v: VertexIx,
    heading: DVec2,
) -> Option<VertexIx> {
    let (rules, limits) = (sketch.rules, sketch.rules.limits());
    let mut length = rules.length + rules.deviation * stream.signed();
    let (start, at) = (End::Vertex(v), sketch.graph.at(v));
    if let Some(hub) = field.hub() {
        // Streets away from the hub end on common rings, so that the rings close.
        let out = (at - hub).normalize_or(heading);
        if out.dot(heading) > 0.9 {
            let radius = at.distance(hub);
            let ring = (radius / rules.length + 0.4).floor() + 1.0;
            length = ring * rules.length - radius;
        }
    }
    let traced = trace(field, at, heading, length + rules.snap_radius);
    for (end, at) in attachments(sketch, v, &traced, length) {
        let path = bend_to(&traced, at);
        if Proposal::new(&path, start, end).fits(sketch, &limits) {
            return Some(sketch.add(&path, start, end).1);
        }
    }
    // With nothing to attach to, the street ends free, and earlier where it would come too near the outline.
    let shortest = rules.min_length.max(0.6 * length);
    for share in [1.0, 0.8, 0.6] {
        let length = (length * share).max(shortest);
        let path = bend_to(&traced, point_at(&traced, length).0);
        if Proposal::new(&path, start, End::Free).fits(sketch, &limits) {
            return Some(sketch.add(&path, start, End::Free).1);
        }
    }
    None
}

/// A line of `length` metres that leaves `from` with `heading` and then follows the field.
fn trace(field: &DirectionField, from: DVec2, heading: DVec2, length: f64) -> Vec<DVec2> {
    let deviation = turn(field.along(from + heading, heading), heading);
    let steps = (length / STEP).ceil().max(1.0);
    let step = length / steps;
    let (mut p, mut d) = (from, heading);
    let mut out = vec![from];
    for i in 0..steps as usize {
        if i > 0 {
            // A small deviation fades, so that the streets of one field stay parallel.
            let fade = if deviation.abs() > 0.35 { 1.0 } else { 1.0 - i as f64 / steps };
            let middle = p + d * (step / 2.0);
            d = rotate(field.along(middle, rotate(d, -deviation * fade)), deviation * fade);
        }
        p += d * step;
        out.push(p);
    }
    out
}

/// Ends to which the traced line may be connected, the best first: its crossing with a street, and the junctions and streets
/// within the snap radius of its end.
fn attachments(sketch: &Sketch, v: VertexIx, traced: &[DVec2], length: f64) -> Vec<(End, DVec2)> {
    let (g, snap) = (&sketch.graph, sketch.rules.snap_radius);
    let hit = segments(traced).enumerate().find_map(|(i, (a, b))| {
        let hit = g.first_hit(a, b, |e| i == 0 && g.edges_at(v).contains(&e))?;
        Some((hit, line_length(&traced[..=i]) + a.distance(hit.at)))
    });
    let tip = hit.as_ref().map_or_else(|| point_at(traced, length).0, |(h, _)| h.at);
    let mut vertices = Vec::new();
    let mut edges = Vec::new();
    for e in g.edges_near(Bounds::of([tip]).grown(snap)) {
        let (a, b) = g.segment(e);
        let (_, foot) = closest_on_segment(tip, a, b);
        if foot.distance(tip) <= snap {
            edges.push((End::Edge(e, foot), foot));
        }
        let edge = g.edge(e);
        for w in [edge.a, edge.b] {
            if w != v && g.at(w).distance(tip) <= snap {
                vertices.push((End::Vertex(w), g.at(w)));
            }
        }
    }
    // Junctions and ends come before points of inflexion, and near ones before far ones.
    let rank = |x: &(End, DVec2)| match x.0 {
        End::Vertex(w) => (g.degree(w) == 2, x.1.distance(tip)),
        _ => (false, x.1.distance(tip)),
    };
    let by_rank = |x: &(End, DVec2), y: &(End, DVec2)| {
        let (a, b) = (rank(x), rank(y));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    };
    vertices.sort_by(by_rank);
    vertices.dedup();
    edges.sort_by(by_rank);
    let (junctions, inflexions): (Vec<_>, Vec<_>) = vertices.into_iter().partition(|x| !rank(x).0);
    let clip = hit.map(|(h, _)| (End::Edge(h.edge, h.at), h.at));
    junctions.into_iter().chain(clip).chain(edges).chain(inflexions).collect()
}

/// The traced line cut off where it comes nearest to `at`, and bent to end there.
fn bend_to(traced: &[DVec2], at: DVec2) -> Vec<DVec2> {
    let (along, nearest) = closest_on_line(at, traced);
    let parts = (along / STEP).round().max(1.0);
    let shift = at - nearest;
    // A straight street turns as a whole; a curved one keeps its heading at both ends.
    let (end, _) = point_at(traced, along);
    let straight = end.distance(traced[0]) > 0.9995 * along;
    let at_part = |i: usize| {
        let t = i as f64 / parts;
        let weight = if straight { t } else { smoothstep(0.0, 1.0, t) };
        if i == parts as usize { at } else { point_at(traced, along * t).0 + shift * weight }
    };
    simplified((0..=parts as usize).map(at_part).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::StreetClass;
    use crate::region::Outline;
    use crate::space::{Origin, Seed};
    use crate::style::MainRules;
    use crate::testing::Flat;
    use crate::town::plan::rules::{Limits, Rules};
    use crate::town::plan::site::Site;
    use std::sync::LazyLock;

    fn rules() -> Rules {
        let style = MainRules {
            length: 200.0,
            deviation: 0.0,
            min_length: 100.0,
            min_angle_deg: 60.0,
            angle_deviation_deg: 0.0,
            snap_radius: 50.0,
            ..MainRules::default()
        };
        Rules::new(&style, 2000.0)
    }

    static OUTLINE: LazyLock<Outline> = LazyLock::new(|| {
        let polygon = [(-2e3, -2e3), (2e3, -2e3), (2e3, 2e3), (-2e3, 2e3)].map(DVec2::from).to_vec();
        Outline { origin: Origin::default(), polygon, shared: Vec::new(), river: None }
    });

    /// A sketch on a plain with streets along the given lines; streets whose points coincide meet there.
    fn sketch_of(lines: &[&[(f64, f64)]]) -> Sketch<'static> {
        let mut sketch = Sketch::new(Site::new(&OUTLINE, &[], &Flat), rules());
        for line in lines {
            let vertices: Vec<VertexIx> = line.iter().map(|p| vertex(&mut sketch, *p)).collect();
            for pair in vertices.windows(2) {
                sketch.graph.add_edge(pair[0], pair[1], StreetClass::Main);
            }
        }
        sketch
    }

    fn vertex(sketch: &mut Sketch, p: (f64, f64)) -> VertexIx {
        let p = DVec2::from(p);
        let found = sketch.graph.vertices().find(|v| sketch.graph.at(*v) == p);
        found.unwrap_or_else(|| sketch.graph.add_vertex(p))
    }

    /// Proposes a street of 200 m to the north from a new vertex; returns where it ends, and the degree of its end.
    fn north(sketch: &mut Sketch, x: f64, y: f64) -> Option<(DVec2, usize)> {
        let v = sketch.graph.add_vertex(DVec2::new(x, y));
        let (field, mut stream) = (DirectionField::uniform(0.0), Seed(1).stream("test", &[]));
        let end = propose(sketch, &field, &mut stream, v, DVec2::Y)?;
        Some((sketch.graph.at(end), sketch.graph.degree(end)))
    }

    #[test]
    fn a_street_ends_free_where_nothing_is_near() {
        assert_eq!(north(&mut sketch_of(&[]), 0.0, 0.0), Some((DVec2::new(0.0, 200.0), 1)));
    }

    #[test]
    fn a_street_connects_to_the_nearest_junction_within_the_snap_radius() {
        let cross: [&[(f64, f64)]; 2] =
            [&[(-400.0, 230.0), (0.0, 230.0), (400.0, 230.0)], &[(0.0, 230.0), (0.0, 500.0)]];
        assert_eq!(north(&mut sketch_of(&cross), 30.0, 0.0), Some((DVec2::new(0.0, 230.0), 4)));
        // Another junction, nearer to the end.
        let nearer: [&[(f64, f64)]; 2] = [cross[0], &[(-400.0, 230.0), (-400.0, 500.0)]];
        let (at, degree) = north(&mut sketch_of(&nearer), 30.0, 0.0).unwrap();
        assert!(at.distance(DVec2::new(30.0, 230.0)) < 0.01 && degree == 3, "{at} {degree}");
    }

    #[test]
    fn a_street_makes_an_intersection_with_an_edge_within_the_snap_radius() {
        let bar: [&[(f64, f64)]; 1] = [&[(-400.0, 240.0), (400.0, 240.0)]];
        assert_eq!(north(&mut sketch_of(&bar), 30.0, 0.0), Some((DVec2::new(30.0, 240.0), 3)));
    }

    #[test]
    fn a_street_is_clipped_where_it_meets_another() {
        let bar: [&[(f64, f64)]; 1] = [&[(-400.0, 130.0), (400.0, 130.0)]];
        assert_eq!(north(&mut sketch_of(&bar), 30.0, 0.0), Some((DVec2::new(30.0, 130.0), 3)));
    }

    /// Whether a straight street from a new vertex may attach to the sketch at an end.
    fn fits(sketch: &mut Sketch, from: (f64, f64), end: End, limits: &Limits) -> bool {
        let v = vertex(sketch, from);
        let to = match end {
            End::Vertex(w) => sketch.graph.at(w),
            End::Edge(_, p) => p,
            _ => DVec2::ZERO,
        };
        Proposal::new(&[DVec2::from(from), to], End::Vertex(v), end).fits(sketch, limits)
    }

    #[test]
    fn connecting_and_clipping_are_discarded_for_a_small_angle() {
        // A bar that rises so that a street to the north meets it at an angle of 90 degrees less `rise`.
        for (rise, fine) in [(0.0, true), (25.0, true), (29.0, true), (31.0, false), (60.0, false)] {
            let way = direction(f64::to_radians(rise)) * 600.0;
            let (a, b) = (DVec2::Y * 150.0 - way, DVec2::Y * 150.0 + way);
            let mut sketch = sketch_of(&[&[a.into(), b.into()]]);
            let limits = sketch.rules.limits();
            assert_eq!(fits(&mut sketch, (0.0, 0.0), End::Edge(0, DVec2::Y * 150.0), &limits), fine, "{rise}");
        }
        let mut sketch = sketch_of(&[&[(0.0, 150.0), (200.0, 50.0)]]);
        let limits = sketch.rules.limits();
        assert!(!fits(&mut sketch, (100.0, -60.0), End::Vertex(0), &limits), "beside the street at the junction");
    }

    #[test]
    fn connecting_and_clipping_are_discarded_for_a_short_part_of_a_split_street() {
        for (x, fine) in [(0.0, true), (95.0, true), (105.0, false), (180.0, false)] {
            // There are junctions at both ends of the street that is split.
            let mut sketch = sketch_of(&[
                &[(-300.0, 150.0), (-200.0, 150.0), (200.0, 150.0), (300.0, 150.0)],
                &[(-200.0, 150.0), (-200.0, 400.0)],
                &[(200.0, 150.0), (200.0, 400.0)],
            ]);
            let limits = sketch.rules.limits();
            let edge = sketch.graph.edges_near(Bounds::of([DVec2::new(x, 150.0)]))[0];
            assert_eq!(fits(&mut sketch, (x, 0.0), End::Edge(edge, DVec2::new(x, 150.0)), &limits), fine, "{x}");
        }
    }

    #[test]
    fn connecting_is_discarded_at_a_full_junction() {
        for (most, fine) in [(5, true), (4, false), (3, false)] {
            let mut sketch = sketch_of(&[&[(0.0, 150.0), (300.0, 250.0)], &[(0.0, 150.0), (-300.0, 250.0)]]);
            for (i, x) in [-40.0, 40.0].into_iter().enumerate() {
                let v = vertex(&mut sketch, (x, 450.0));
                sketch.graph.add_edge(0, v, StreetClass::Main);
                assert_eq!(sketch.graph.degree(0), 3 + i);
            }
            sketch.rules.degree = (3, most);
            let limits = sketch.rules.limits();
            assert_eq!(fits(&mut sketch, (0.0, 0.0), End::Vertex(0), &limits), fine, "{most}");
        }
    }

    #[test]
    fn short_streets_are_discarded() {
        for (length, fine) in [(99.0, false), (101.0, true)] {
            let mut sketch = sketch_of(&[&[(-400.0, length), (400.0, length)]]);
            let limits = sketch.rules.limits();
            assert_eq!(fits(&mut sketch, (0.0, 0.0), End::Edge(0, DVec2::Y * length), &limits), fine, "{length}");
        }
    }

    #[test]
    fn headings_keep_to_the_degree_range_and_the_angle_deviation() {
        for number in 0..200 {
            let mut stream = Seed(number).stream("test", &[]);
            let mut sketch = sketch_of(&[&[(0.0, -300.0), (0.0, 0.0)]]);
            sketch.rules.degree = (2 + stream.index(2), 4 + stream.index(2));
            sketch.rules.angle_deviation = stream.range(0.0, 0.3);
            let field = DirectionField::uniform(0.0);
            let found = headings(&sketch, &field, &mut stream, 1, 0);
            let (low, high) = sketch.rules.degree;
            assert!(
                (low..=high).contains(&(found.len() + 1)) || found.len() == 3,
                "{} in {low}..={high}",
                found.len() + 1
            );
            let mut all = vec![-DVec2::Y];
            for heading in found.iter().take(3) {
                let off = angle_between(field.along(DVec2::ZERO, *heading), *heading);
                assert!(off <= sketch.rules.angle_deviation + 1e-9, "{off}");
                assert!(all.iter().all(|d| angle_between(*d, *heading) >= sketch.rules.min_angle - 1e-9));
                all.push(*heading);
            }
        }
    }
}
