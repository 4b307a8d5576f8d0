//! The graphs of tiles as they are built.

use super::dimensions::{changed_within, longest_way, padding};
use super::separations::{Separation, Separations, Verdict};
use super::surroundings::Surroundings;
use crate::layer::{Cancel, LayerCache, LayerError, Reach};
use crate::network::StreetClass;
use crate::region::road::budget::Budget;
use crate::region::road::crossing::{Crossing, HighwayCrossing};
use crate::region::road::graph::Graphs;
use crate::region::road::inputs::Inputs;
use crate::region::road::merge::{MergedGraphs, Net, Rules};
use crate::region::road::routes::Routes;
use crate::region::road::tile::{rings, tile_bounds, tiles_around};
use crate::region::road::vertex::{Graph, Vertex};
use crate::space::Bounds;
use glam::I64Vec2;
use std::sync::Arc;

/// The graphs of all tiles as they are built, remembered.
pub(in crate::region::road) struct BuiltGraphs {
    inputs: Arc<Inputs>,
    routes: Arc<Routes>,
    graphs: Arc<Graphs>,
    merged: Arc<MergedGraphs>,
    built: LayerCache<[i64; 2], Graph>,
}

impl BuiltGraphs {
    pub fn new(
        inputs: Arc<Inputs>,
        routes: Arc<Routes>,
        graphs: Arc<Graphs>,
        merged: Arc<MergedGraphs>,
        budget: Budget,
    ) -> Self {
        Self { inputs, routes, graphs, merged, built: budget.cache(1) }
    }

    /// The graph of a tile as it is built: with grade-separated crossings of highways.
    pub fn graph(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<Graph>, LayerError> {
        self.built.get_shared(&tile.to_array(), || self.make(tile, cancel))
    }

    fn make(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<Graph>, LayerError> {
        let own = self.merged.realigned(tile, cancel)?;
        let separates = |class| self.inputs.settings.class(class).highway_crossings != Crossing::Junction;
        let any = [StreetClass::Highway, StreetClass::Major, StreetClass::Minor].into_iter().any(separates);
        if own.vertices.is_empty() || !any {
            return Ok(own);
        }
        let near = changed_within(&self.inputs.settings);
        let rebuilt = self.with_separations(tile, near, cancel, |separations, verdicts| {
            let found: Vec<Separation> = verdicts.into_iter().filter_map(|(_, v)| v.separation).collect();
            if found.is_empty() { Ok(None) } else { separations.rebuild(tile, &found).map(Some) }
        })?;
        Ok(rebuilt.flatten().map_or(own, Arc::new))
    }

    /// The crossings of highways in a tile, on the ground and on bridges.
    pub fn crossings(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Vec<HighwayCrossing>, LayerError> {
        let found = self.with_separations(tile, 0.0, cancel, |separations, verdicts| {
            let net = separations.ground.net();
            let own = verdicts.into_iter().filter(|(node, _)| net.nodes[*node].key.tile() == tile);
            let crossing = |(node, v): (usize, Verdict)| {
                let at = net.nodes[node].position.plan();
                HighwayCrossing { at, class: v.class, built: v.built(), hindrance: v.hindrance }
            };
            Ok(own.map(crossing).collect())
        })?;
        Ok(found.unwrap_or_default())
    }

    /// Works with the verdicts on the crossings within `near` metres of a tile, each with its vertex. `None` if it is plain that
    /// there are no crossings.
    fn with_separations<T>(
        &self,
        tile: I64Vec2,
        near: f64,
        cancel: &Cancel,
        work: impl FnOnce(&Separations, Vec<(usize, Verdict)>) -> Result<T, LayerError>,
    ) -> Result<Option<T>, LayerError> {
        let (settings, step) = (&self.inputs.settings, self.inputs.step());
        // Most tiles have no highway nearby, or nothing that crosses it, and need no merged graph. The distance covers a leg whose
        // attachment moved to the crossing, and half a way to a vertex that its road had before.
        let is_highway = |v: &Vertex| v.ways.iter().any(|w| w.rank.class == StreetClass::Highway);
        let (mut highway, mut others, mut rank) = (false, false, None);
        for v in self.graphs.vertices_near(tile, near + 1.5 * longest_way(settings), cancel)? {
            highway |= is_highway(&v);
            others |= v.ways.iter().any(|w| *rank.get_or_insert(w.rank) != w.rank);
        }
        if !highway || !others {
            return Ok(None);
        }
        let crosses = |v: &Vertex| v.ways.len() >= 4 && is_highway(v);
        let mut crossed = false;
        for t in tiles_around(tile, rings(near, step)) {
            crossed = crossed || self.merged.realigned(t, cancel)?.vertices.values().any(crosses);
        }
        if !crossed {
            return Ok(None);
        }
        let around = tiles_around(tile, rings(padding(settings), step)).map(|t| self.merged.realigned(t, cancel));
        let graphs = around.collect::<Result<Vec<_>, _>>()?;
        let bounds = tile_bounds(tile, step);
        let net = Net::new(settings, tile, Reach::new("roads", bounds, padding(settings)), &graphs);
        let ground = Surroundings {
            inputs: &self.inputs,
            routes: &self.routes,
            graphs: &self.graphs,
            rules: Rules::new(&self.inputs, net, bounds, padding(settings)),
            vertices: graphs.iter().flat_map(|g| &g.vertices).map(|(k, v)| (*k, v)).collect(),
            cancel,
        };
        let near: Bounds = ground.net().own.grown(near);
        let separations = Separations { ground };
        let mut verdicts = Vec::new();
        for node in separations.ground.net().nodes_in(near)? {
            verdicts.extend(separations.at(node)?.map(|v| (node, v)));
        }
        work(&separations, verdicts).map(Some)
    }
}
