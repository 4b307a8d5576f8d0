//! Random edits, for checks of worlds with edits.

use bevy_sprawl::edits::{Edits, Influence, PatchEdit, RoadEdit, SettlementEdit, Shape, WayPoint};
use bevy_sprawl::layer::{Cancel, LayerError};
use bevy_sprawl::network::SizeClass;
use bevy_sprawl::network::StreetClass;
use bevy_sprawl::region::{Link, Settlement};
use bevy_sprawl::space::{Bounds, Stream};
use bevy_sprawl::world::World;
use glam::DVec2;
use std::sync::Arc;

/// Edits lie in a square of this edge, in metres, around the settlement that is checked.
const AREA: f64 = 14_000.0;
/// Classes of roads.
const CLASSES: [StreetClass; 3] = [StreetClass::Highway, StreetClass::Major, StreetClass::Minor];

/// Draws from the seed of a world.
struct Draw {
    stream: Stream,
    middle: DVec2,
}

impl Draw {
    /// A point at most a share of the area off its middle, along each axis.
    fn point(&mut self, share: f64) -> DVec2 {
        let off = DVec2::new(self.stream.signed(), self.stream.signed());
        (self.middle + off * (share * AREA / 2.0)).round()
    }

    fn of<'a, T>(&mut self, list: &'a [T]) -> Option<&'a T> {
        if list.is_empty() { None } else { list.get(self.stream.index(list.len())) }
    }

    fn influence(&mut self) -> Influence {
        let at = self.point(1.0);
        let size = self.stream.range(300.0, 2_500.0);
        let shape = match self.stream.index(3) {
            0 => Shape::Point(at),
            1 => Shape::Curve((0..4).map(|i| at + DVec2::new(f64::from(i), self.stream.signed()) * size).collect()),
            _ => {
                Shape::Area([(-1.0, -1.0), (1.0, -0.6), (0.8, 1.0)].map(|(x, y)| at + DVec2::new(x, y) * size).to_vec())
            }
        };
        let strength =
            if self.stream.chance(0.5) { self.stream.range(-4.0, -0.2) } else { self.stream.range(0.5, 20.0) };
        let classes = if self.stream.chance(0.5) { Vec::new() } else { vec![CLASSES[self.stream.index(3)]] };
        Influence { shape, radius: self.stream.range(100.0, 2_500.0), strength, classes }
    }

    fn via(&mut self, from: DVec2, to: DVec2) -> RoadEdit {
        let count = 1 + self.stream.index(3);
        let along = |i: usize| (i as f64 + 1.0) / (count as f64 + 1.0);
        let points =
            (0..count).map(|i| from.lerp(to, along(i)) + (to - from).perp() * (0.25 * self.stream.signed())).collect();
        RoadEdit::Via { from, to, points, keep: true }
    }
}

/// Random edits of every kind around a settlement. The world cannot fulfil all of them.
pub fn edits(plain: &World, around: &Settlement, cancel: &Cancel) -> Result<Edits, LayerError> {
    let middle = around.centre.plan();
    let mut draw = Draw { stream: plain.seed().stream("drawn edits", &[]), middle };
    let area = Bounds::square(middle, AREA);
    let mut there = plain.settlements().centred_in(area)?;
    there.retain(|s| s.id != around.id);
    let links = plain.roads().links(area, cancel)?;
    let mut out = Edits::default();
    for share in [0.3, 0.6, 1.0] {
        let at = draw.point(share);
        let size = SizeClass::ALL[draw.stream.index(3)];
        let radius = draw.stream.chance(0.5).then(|| draw.stream.range(130.0, 900.0));
        out.settlements.push(SettlementEdit::Pin { at, size, name: None, style: None, radius });
    }
    if let Some(s) = draw.of(&there) {
        let (from, radius) = (s.centre.plan(), s.radius);
        let to = from + DVec2::new(draw.stream.signed(), draw.stream.signed()) * radius;
        out.settlements.push(SettlementEdit::Move { from, to });
    }
    if let Some(s) = draw.of(&there) {
        let at = s.centre.plan();
        out.settlements.push(SettlementEdit::Ban { at, radius: draw.stream.range(10.0, 1_000.0) });
    }
    out.influences = (0..3).map(|_| draw.influence()).collect();
    out.way_points = [0.25, 0.4, 0.6, 0.8, 1.0]
        .map(|share| draw.point(share))
        .into_iter()
        .map(|at| WayPoint { at, class: CLASSES[draw.stream.index(3)] })
        .collect();
    // Ends of a road that are among the settlements around.
    let end = |id| there.iter().find(|s: &&Arc<Settlement>| s.id == id).map(|s| s.centre.plan());
    let ends = |link: &Arc<Link>| Some((end(link.from)?, end(link.to)?));
    for _ in 0..3 {
        if let Some((from, to)) = draw.of(&links).and_then(ends) {
            let road = if draw.stream.chance(0.7) { draw.via(from, to) } else { RoadEdit::Ban { from, to } };
            out.roads.push(road);
        }
    }
    if let (Some(a), Some(b)) = (draw.of(&there), draw.of(&there)) {
        out.roads.push(RoadEdit::Keep { from: a.centre.plan(), to: b.centre.plan() });
    }
    let names: Vec<&String> = plain.assets().patch_sets.values().flat_map(|s| &s.patches).map(|p| &p.name).collect();
    for _ in 0..4 {
        let off = DVec2::new(draw.stream.signed(), draw.stream.signed()) * around.radius;
        let (heading_deg, mirrored) = (draw.stream.range(-360.0, 360.0), draw.stream.chance(0.5));
        if let Some(patch) = draw.of(&names) {
            out.patches.push(PatchEdit { patch: patch.to_string(), at: middle + off, heading_deg, mirrored });
        }
    }
    Ok(out)
}

/// Edits one by one, in the order in which they stand in a file.
pub fn one_by_one(edits: Edits) -> Vec<Edits> {
    let Edits { settlements, influences, influence_maps, way_points, roads, patches } = edits;
    let mut out = Vec::new();
    out.extend(settlements.into_iter().map(|e| Edits { settlements: vec![e], ..Edits::default() }));
    out.extend(influences.into_iter().map(|e| Edits { influences: vec![e], ..Edits::default() }));
    out.extend(influence_maps.into_iter().map(|e| Edits { influence_maps: vec![e], ..Edits::default() }));
    out.extend(way_points.into_iter().map(|e| Edits { way_points: vec![e], ..Edits::default() }));
    out.extend(roads.into_iter().map(|e| Edits { roads: vec![e], ..Edits::default() }));
    out.extend(patches.into_iter().map(|e| Edits { patches: vec![e], ..Edits::default() }));
    out
}
