//! Laying a mosaic in a main cell: its streets, from junction to junction, each if it keeps the rules of the cell.

use super::blend::Blend;
use super::buildings::{Site, settle, sites};
use super::consolidate::{End, Strip, strips};
use super::mend::Mending;
use super::mosaic::{Mosaic, Plan};
use super::table::TileTable;
use super::weave::{Woven, weave};
use crate::layer::{Cancel, LayerError};
use crate::network::VertexIx;
use crate::patch::PatchBuilding;
use crate::space::math::{direction, rotate};
use crate::space::{Bounds, centroid, distance_to_segment, is_simple, point_in_polygon, quantize};
use crate::streets::cell::{Draft, Join, Maker, stub_end};
use crate::style::PatchCityRules;
use glam::DVec2;
use std::collections::BTreeMap;

/// Points of a tile along each axis at which it is tested whether the tile lies in the cell.
const TESTED: usize = 6;
/// Width of a street at a port in the cost of tiles, in metres, and the distance beyond which ports count alike.
const PORT: (f64, f64) = (6.0, 60.0);

/// Where a cell lies on its grid of tiles.
struct Frame {
    /// The south-west corner of the grid.
    corner: DVec2,
    /// Angle of the grid's x axis.
    angle: f64,
    columns: usize,
    rows: usize,
}

impl Frame {
    /// The grid of tiles of edge `size` that covers a cell, turned to its field.
    fn of(draft: &Draft<'_>, size: f64) -> Self {
        let border = draft.brief.border;
        let angle = draft.brief.field.angle(centroid(border));
        let box_of = Bounds::of(border.iter().map(|p| rotate(*p, -angle)));
        let count = (box_of.size() / size).ceil().max(DVec2::ONE);
        let corner = rotate(box_of.centre() - count * size / 2.0, angle);
        Self { corner, angle, columns: count.x as usize, rows: count.y as usize }
    }

    fn to_grid(&self, p: DVec2) -> DVec2 {
        rotate(p - self.corner, -self.angle)
    }

    fn to_cell(&self, p: DVec2) -> DVec2 {
        let east = direction(self.angle);
        quantize(self.corner + east * p.x + east.perp() * p.y)
    }
}

/// What was laid in a cell.
#[derive(Default)]
pub struct Laid {
    /// How often each patch stands, by the number of its piece.
    pub stands: BTreeMap<u32, u32>,
    /// The buildings of the tiles, local to the town.
    pub buildings: Vec<PatchBuilding>,
}

/// Lays tiles in a cell whose stubs and pinned patches are laid. The patches of the table are pieces from number `first` on.
///
/// # Errors
///
/// Only if the work is cancelled.
pub fn lay(
    draft: &mut Draft<'_>,
    table: &TileTable,
    rules: &PatchCityRules,
    blend: Blend,
    first: u32,
    cancel: &Cancel,
) -> Result<Laid, LayerError> {
    let frame = Frame::of(draft, table.size);
    let border: Vec<DVec2> = draft.brief.border.iter().map(|p| frame.to_grid(*p)).collect();
    let stubs: Vec<DVec2> = (0..draft.brief.ports.len()).map(|port| frame.to_grid(stub(draft, port))).collect();
    let square = |column: usize, row: usize| {
        let corner = DVec2::new(column as f64, row as f64) * table.size;
        Bounds::new(corner, corner + table.size)
    };
    let wanted = |column: usize, row: usize| {
        let square = square(column, row);
        let step = table.size / TESTED as f64;
        let point = |i: usize| square.min + (DVec2::new((i % TESTED) as f64, (i / TESTED) as f64) + 0.5) * step;
        border.iter().any(|p| square.contains(*p)) || (0..TESTED * TESTED).any(|i| point_in_polygon(point(i), &border))
    };
    let also = |tile: u32, column: usize, row: usize| {
        let square = square(column, row);
        let here = stubs.iter().filter(|stub| square.contains(**stub));
        let turns = table.tile(tile).turns;
        let off = here.map(|stub| table.window(tile).distance(turns, *stub - square.centre()).min(PORT.1) * PORT.0);
        off.map(|off| (off * off) as f32).sum()
    };
    let maps = |middle: DVec2| blend.costs(&table.maps, frame.to_cell(middle));
    let grid = (frame.columns, frame.rows);
    let mosaic =
        Mosaic::fill(table, &Plan { grid, wanted: &wanted, also: &also, maps: &maps }, &mut draft.rng, cancel)?;
    let mut stands = BTreeMap::new();
    mosaic.tiles().for_each(|(choice, _)| *stands.entry(first + table.tile(choice.tile).patch).or_default() += 1);
    let Woven { mut graph, loose, moved, warps } = weave(&mosaic);
    let is_inside = |_: &Site, outline: &[DVec2]| outline.iter().all(|p| point_in_polygon(*p, &border));
    let mut buildings = settle(sites(&mosaic, &warps), is_inside);
    buildings.iter_mut().flat_map(|b| &mut b.outline).for_each(|p| *p = frame.to_cell(*p));
    buildings.retain(|b| is_simple(&b.outline));
    let mut mending = Mending::new(&mut graph);
    mending.untangle(&moved);
    let wanted = mosaic.tiles().count() as f64 * table.length;
    mending.lead_on(&loose, 0.4 * table.size, table.has_dead_ends(), wanted);
    cancel.check()?;
    let pinned = pinned(draft);
    let has_room = |p: DVec2| has_room(draft, &pinned, p);
    let mut strips = strips(&graph, draft.rules.local.min_length, |p| frame.to_cell(p), has_room);
    lead_to_ports(draft, &mut strips, rules.port_reach);
    lay_strips(draft, strips, first, cancel)?;
    Ok(Laid { stands, buildings })
}

/// The end of a port's stub.
fn stub(draft: &Draft<'_>, port: usize) -> DVec2 {
    draft.canvas.graph.at(stub_end(draft.brief.ports.len(), port))
}

/// The streets of pinned patches.
fn pinned(draft: &Draft<'_>) -> Vec<(DVec2, DVec2)> {
    let is_pinned = |v: VertexIx| draft.canvas.nodes[v as usize].pinned;
    let graph = &draft.canvas.graph;
    let edges = graph.edges().filter(|(_, edge)| is_pinned(edge.a) && is_pinned(edge.b));
    edges.map(|(e, _)| graph.segment(e)).collect()
}

/// Whether a street may pass a point: it lies in the cell, as far from its border and from pinned patches as streets must.
fn has_room(draft: &Draft<'_>, pinned: &[(DVec2, DVec2)], p: DVec2) -> bool {
    if pinned.iter().any(|(a, b)| distance_to_segment(p, *a, *b) < draft.rules.local.clearance) {
        return false;
    }
    let least = draft.rules.repair.wall_gap;
    let border = draft.brief.border;
    let sides = (0..border.len()).map(|i| (border[i], border[(i + 1) % border.len()]));
    point_in_polygon(p, border) && sides.into_iter().all(|(a, b)| distance_to_segment(p, a, b) >= least)
}

/// Leads streets that the border cuts off to the ports near there, the nearest pairs first: like streets of two tiles, but a port
/// stays where it is.
fn lead_to_ports(draft: &Draft<'_>, strips: &mut [Strip], reach: f64) {
    let ports = draft.brief.ports;
    let mut pairs: Vec<(f64, usize, usize, bool)> = Vec::new();
    for (i, strip) in strips.iter().enumerate() {
        for (is_last, end) in [(false, strip.first), (true, strip.last)] {
            let at = if is_last { strip.line[strip.line.len() - 1] } else { strip.line[0] };
            let off = |port: usize| stub(draft, port).distance(at);
            if end == End::Cut {
                let near = (0..ports.len()).filter(|port| off(*port) <= reach);
                pairs.extend(near.map(|port| (off(port), port, i, is_last)));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2, a.3).cmp(&(b.1, b.2, b.3))));
    let mut is_met = vec![false; ports.len()];
    for (_, port, i, is_last) in pairs {
        let strip = &mut strips[i];
        let end = if is_last { &mut strip.last } else { &mut strip.first };
        if is_met[port] || *end != End::Cut {
            continue;
        }
        is_met[port] = true;
        *end = End::Port(port);
        let place = if is_last { strip.line.len() - 1 } else { 0 };
        strip.line[place] = stub(draft, port);
    }
}

/// Lays streets, those first that go on from streets that are there.
fn lay_strips(draft: &mut Draft<'_>, strips: Vec<Strip>, first: u32, cancel: &Cancel) -> Result<(), LayerError> {
    let mut vertices: BTreeMap<VertexIx, VertexIx> = BTreeMap::new();
    let mut left: Vec<Strip> = strips;
    left.sort_by(|a, b| b.length().total_cmp(&a.length()));
    while !left.is_empty() {
        cancel.check()?;
        let goes_on = |strip: &Strip| {
            [strip.first, strip.last].into_iter().any(|end| match end {
                End::Port(_) => true,
                End::Vertex(v) => vertices.contains_key(&v),
                End::Cut | End::Dead => false,
            })
        };
        let next = left.iter().position(goes_on).unwrap_or(0);
        let mut strip = left.remove(next);
        strip.straighten(draft.rules.repair.bend_cosine);
        lay_strip(draft, &strip, first, &mut vertices);
    }
    Ok(())
}

/// Lays a street if it keeps the rules of repair.
fn lay_strip(draft: &mut Draft<'_>, strip: &Strip, first: u32, vertices: &mut BTreeMap<VertexIx, VertexIx>) {
    let ports = draft.brief.ports.len();
    let join = |end: End| match end {
        End::Port(port) => Join::At(stub_end(ports, port)),
        End::Vertex(v) => vertices.get(&v).map_or(Join::Free(true), |v| Join::At(*v)),
        End::Cut => Join::Free(true),
        End::Dead => Join::Free(false),
    };
    let limits = draft.rules.repair;
    let maker = strip.patch.map_or(Maker::Repair, |patch| Maker::Piece(first + patch));
    draft.canvas.gather(Bounds::of(strip.line.iter().copied()), limits.reach() + 1.0, &mut draft.trial.near);
    draft.trial.proposal.line(&strip.line, join(strip.first), join(strip.last));
    if draft.build_if_fits(&limits, maker) {
        let built = &draft.trial.built;
        for (end, place) in [(strip.first, 0), (strip.last, built.len() - 1)] {
            if let End::Vertex(v) = end {
                vertices.insert(v, built[place]);
            }
        }
    }
}
