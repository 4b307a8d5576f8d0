//! A square made from maps, without a world: the job of Bustard and de Valmency 2015.

use super::blend::Blend;
use super::buckets::Buckets;
use super::buildings::{Site, is_near, settle, sites};
use super::mend::Mending;
use super::mosaic::{Mosaic, Plan};
use super::table::TileTable;
use super::weave::{Of, Woven, weave};
use crate::layer::{Cancel, LayerError};
use crate::network::{EdgeIx, Junction, JunctionId, Network, PlanarGraph, Street, StreetClass, StreetId, VertexIx};
use crate::patch::PatchBuilding;
use crate::space::{Bounds, Seed, centroid, quantize, quantum_key};
use glam::DVec2;
use std::collections::BTreeMap;

/// Longest street that leads on where no street of the next tile does, as a share of a tile's edge.
const LEAD_ON: f64 = 0.4;
/// Least distance in metres from the middle of a street to a building of the same tile, which may stand as near as in the map.
const BESIDE: f64 = 2.0;
/// Half of the widest carriageway of a town, in metres.
const WIDEST: f64 = 6.0;

/// A square made from tiles.
#[derive(Clone, Debug, Default)]
pub struct Synthesis {
    /// Its streets, in metres from the middle of the square.
    pub network: Network,
    /// Number of streets that end at a side between two tiles.
    pub mismatched_seams: usize,
    /// Number of places where three streets or more meet.
    pub junctions: usize,
    /// Number of streets that end inside of the square.
    pub dead_ends: usize,
    /// Number of parts whose streets hang together.
    pub components: usize,
    /// Its buildings, in metres from the middle of the square.
    pub buildings: Vec<PatchBuilding>,
    /// Number of tiles.
    pub tiles: usize,
    /// Number of tiles for which the same patch stands within 400 m.
    pub repeats: usize,
}

/// Makes a square of edge `size` metres from the tiles of a table. Where they are of several maps, one of them prevails in parts of about
/// `blend` metres.
///
/// # Errors
///
/// Only if the work is cancelled.
pub fn synthesize(
    table: &TileTable,
    size: f64,
    blend: f64,
    seed: Seed,
    cancel: &Cancel,
) -> Result<Synthesis, LayerError> {
    if table.is_empty() {
        return Ok(Synthesis::default());
    }
    let count = (size / table.size).ceil().max(1.0) as usize;
    let mut rng = seed.stream("synthesis", &[]);
    let blend = Blend { seed, town: 0, size: blend };
    let maps = |middle: DVec2| blend.costs(&table.maps, middle);
    let plan = Plan { grid: (count, count), wanted: &|_, _| true, also: &|_, _, _| 0.0, maps: &maps };
    let mosaic = Mosaic::fill(table, &plan, &mut rng, cancel)?;
    let (tiles, repeats) = (mosaic.tiles().count(), mosaic.repeated());
    let Woven { mut graph, loose, moved, warps } = weave(&mosaic);
    let sites = sites(&mosaic, &warps);
    let mut mending = Mending::new(&mut graph);
    mending.untangle(&moved);
    mending.lead_on(&loose, LEAD_ON * table.size, table.has_dead_ends(), tiles as f64 * table.length);
    cancel.check()?;
    let is_loose = |v: &&VertexIx| graph.degree(**v) == 1;
    let mismatched_seams = loose.iter().filter(is_loose).count();
    let middle = DVec2::splat(count as f64 * table.size / 2.0);
    let mut graph = clipped(&graph, middle, size);
    Mending::new(&mut graph).connect();
    let buildings = buildings(sites, &graph, middle, size);
    let border = Bounds::square(DVec2::ZERO, size).grown(-0.01);
    let ends = graph.vertices().filter(|v| graph.degree(*v) == 1);
    Ok(Synthesis {
        mismatched_seams,
        junctions: graph.vertices().filter(|v| graph.degree(*v) > 2).count(),
        dead_ends: ends.filter(|v| border.contains(graph.at(*v))).count(),
        components: graph.components().into_iter().flatten().max().map_or(0, |last| last as usize + 1),
        network: network(&graph),
        buildings,
        tiles,
        repeats,
    })
}

/// The buildings that may stand beside the streets of a graph, in metres from the middle of the square.
fn buildings(sites: Vec<Site>, graph: &PlanarGraph<Of>, middle: DVec2, size: f64) -> Vec<PatchBuilding> {
    let square = Bounds::square(middle, size);
    let buckets = Buckets::of(graph);
    let is_free = |site: &Site, outline: &[DVec2]| {
        let outline: Vec<DVec2> = outline.iter().map(|p| *p - middle).collect();
        let near = buckets.near(graph, Bounds::of(outline.iter().copied()).grown(WIDEST));
        near.into_iter().all(|e| {
            let (a, b) = graph.segment(e);
            let Of { class, patch } = graph.edge(e).data;
            let gap = if patch == Some(site.patch) { BESIDE } else { class.carriageway() / 2.0 };
            !is_near(a, b, &outline, gap)
        })
    };
    let sites = sites.into_iter().filter(|site| square.contains(centroid(&site.building.outline)));
    let mut out = settle(sites.collect(), is_free);
    out.iter_mut().flat_map(|building| &mut building.outline).for_each(|p| *p = quantize(*p - middle));
    out
}

/// The part of a graph within a square, in metres from its middle.
fn clipped(graph: &PlanarGraph<Of>, middle: DVec2, size: f64) -> PlanarGraph<Of> {
    let bounds = Bounds::square(middle, size);
    let mut out = PlanarGraph::without_index();
    let mut numbers: Vec<Option<VertexIx>> = vec![None; graph.vertex_count()];
    for (e, edge) in graph.edges() {
        let (a, b) = graph.segment(e);
        let Some((from, to)) = bounds.clip_segment(a, b) else { continue };
        let mut end = |v: VertexIx, is_whole: bool, at: DVec2| {
            let at = quantize(at - middle);
            if is_whole { *numbers[v as usize].get_or_insert_with(|| out.add_vertex(at)) } else { out.add_vertex(at) }
        };
        let ends = [end(edge.a, from == 0.0, a.lerp(b, from)), end(edge.b, to == 1.0, a.lerp(b, to))];
        if out.at(ends[0]) != out.at(ends[1]) {
            out.add_edge(ends[0], ends[1], edge.data);
        }
    }
    out
}

/// The class of the greatest part of a street: where streets of two tiles meet, theirs may differ.
fn class(graph: &PlanarGraph<Of>, chain: &[(EdgeIx, bool)]) -> StreetClass {
    let mut lengths: BTreeMap<StreetClass, f64> = BTreeMap::new();
    for (e, _) in chain {
        *lengths.entry(graph.edge(*e).data.class).or_default() += graph.edge_length(*e);
    }
    lengths.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(StreetClass::Local, |(class, _)| class)
}

/// A graph as streets from junction to junction.
fn network(graph: &PlanarGraph<Of>) -> Network {
    let mut out = Network::default();
    let mut is_junction = vec![false; graph.vertex_count()];
    let id = |v: VertexIx| JunctionId::of(&quantum_key(graph.at(v)));
    let mut add = |chain: &[(EdgeIx, bool)], vertices: &[VertexIx], number: u64| {
        let line: Vec<DVec2> = vertices.iter().map(|v| graph.at(*v)).collect();
        let (Some(from), Some(to)) = (vertices.first(), vertices.last()) else { return };
        [from, to].into_iter().for_each(|v| is_junction[*v as usize] = true);
        let class = class(graph, chain);
        out.streets.push(Street::new(StreetId::of(&[number]), class, id(*from), id(*to), line));
    };
    for (number, chain) in graph.chains(|v| graph.degree(v) != 2).into_iter().enumerate() {
        let vertices = graph.chain_vertices(&chain);
        let number = 2 * number as u64;
        if vertices.first() == vertices.last() {
            // A street that comes back to where it began is divided, so that its ends differ.
            let half = chain.len() / 2;
            add(&chain[..half], &vertices[..=half], number);
            add(&chain[half..], &vertices[half..], number + 1);
        } else {
            add(&chain, &vertices, number);
        }
    }
    let ends = graph.vertices().filter(|v| is_junction[*v as usize]);
    out.junctions = ends.map(|v| Junction { id: id(v), at: graph.at(v) }).collect();
    out
}
