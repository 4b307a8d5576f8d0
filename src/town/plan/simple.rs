//! Main streets of settlements that are too small or too rugged for growth: one street that runs through, or a ring.

use super::curves::{STEP, cubic, simplified};
use super::proposal::Proposal;
use super::rules::Limits;
use super::sketch::{End, Sketch};
use crate::network::StreetClass;
use crate::space::math::{angle_between, angle_of, direction, rotate};
use crate::space::{Stream, line_length, quantize};
use glam::DVec2;
use std::f64::consts::{PI, TAU};

/// Least angle between the directions of two gates, seen from the centre, for a street between them to run through.
const OPPOSITE: f64 = 1.2;

/// Lays a street from gate to gate through the centre, between the two gates that lie most opposite each other; returns
/// whether there are such gates.
pub(super) fn lay_through_street(sketch: &mut Sketch, stream: &mut Stream) -> bool {
    let gates = sketch.site.gates;
    let mut pairs: Vec<(f64, usize, usize)> = (0..gates.len())
        .flat_map(|i| (i + 1..gates.len()).map(move |j| (i, j)))
        .map(|(i, j)| (angle_between(gates[i].at, gates[j].at), i, j))
        .filter(|(angle, ..)| *angle >= OPPOSITE)
        .collect();
    // Gates of roads come before gates on borders.
    let borders = |i: usize, j: usize| [i, j].into_iter().filter(|g| gates[*g].class.is_main()).count();
    pairs.sort_by(|a, b| {
        let by_class = borders(a.1, a.2).cmp(&borders(b.1, b.2));
        by_class.then(b.0.total_cmp(&a.0)).then((a.1, a.2).cmp(&(b.1, b.2)))
    });
    let Some(&(_, i, j)) = pairs.first() else { return false };
    let centre = sketch.graph.add_vertex(DVec2::ZERO);
    let tangent = (gates[j].at.normalize_or_zero() - gates[i].at.normalize_or_zero()).normalize_or_zero();
    // High streets wind: they swing to one side by at least half of the greatest deviation.
    let swing = stream.signed();
    let tangent = rotate(tangent, sketch.rules.angle_deviation * 0.5 * (swing + swing.signum()));
    let limits = Limits {
        gap: 20.0,
        min_angle: 0.6,
        min_length: 20.0,
        margin: 25.0,
        max_turn: 0.6,
        checks_ground: false,
        ..sketch.rules.limits()
    };
    for (gate, arriving) in [(i, tangent), (j, -tangent)] {
        let at = gates[gate].at;
        let curved = simplified(cubic(at, gates[gate].inward, DVec2::ZERO, arriving));
        let (start, end) = (End::Gate(gate), End::Vertex(centre));
        let fits = curved.len() > 1 && Proposal::new(&curved, start, end).fits(sketch, &limits);
        // The outline is star-shaped: the straight line always stays inside.
        let path = if fits { curved } else { vec![at, DVec2::ZERO] };
        sketch.add(&path, start, end);
    }
    true
}

/// Lays a ring around the centre, half way to the outline.
pub(super) fn lay_ring(sketch: &mut Sketch) {
    let outline = sketch.site.outline;
    let n = outline.len();
    // A blend of the outline's shape and a circle: both are star-shaped about the centre, so the ring is simple.
    let nearest = outline.iter().map(|p| p.length()).fold(f64::INFINITY, f64::min);
    // A ring stays on the centre's side of a river.
    let reaches: Vec<f64> = outline
        .iter()
        .map(|p| {
            let river = sketch.site.river.as_ref();
            let bank = river.and_then(|river| river.bank_crossings(DVec2::ZERO, *p).first().copied());
            bank.unwrap_or(*p).length()
        })
        .collect();
    let nearest = reaches.iter().copied().fold(nearest, f64::min);
    let reach = |i: usize| {
        let sum: f64 = (0..5).map(|k| reaches[(i + n + k - 2) % n]).sum();
        (0.5 * sum / 5.0).min(0.62 * reaches[i]).min(1.6 * nearest)
    };
    let shape: Vec<DVec2> = (0..n).map(|i| outline[i].normalize_or_zero() * reach(i)).collect();
    let around = line_length(&shape);
    let parts = (around / STEP).round().clamp(12.0, 60.0) as usize;
    let mut by_angle: Vec<(f64, f64)> = shape.iter().map(|p| (angle_of(*p), p.length())).collect();
    by_angle.sort_by(|a, b| a.0.total_cmp(&b.0));
    let radius = |angle: f64| {
        let next = by_angle.partition_point(|(a, _)| *a <= angle) % by_angle.len();
        let (a1, r1) = by_angle[next];
        let (a0, r0) = by_angle[(next + by_angle.len() - 1) % by_angle.len()];
        let span = (a1 - a0).rem_euclid(TAU).max(1e-9);
        r0 + (r1 - r0) * ((angle - a0).rem_euclid(TAU) / span).min(1.0)
    };
    let points: Vec<DVec2> = (0..parts)
        .map(|i| {
            let angle = -PI + TAU * (i as f64 + 0.5) / parts as f64;
            quantize(direction(angle) * radius(angle))
        })
        .collect();
    let vertices: Vec<_> = points.iter().map(|p| sketch.graph.add_vertex(*p)).collect();
    for i in 0..parts {
        sketch.graph.add_edge(vertices[i], vertices[(i + 1) % parts], StreetClass::Main);
    }
}
