//! The two stages of merging, tile by tile.

use super::connect;
use super::net::Net;
use super::padding::{merged_padding, plain_padding, realigned_padding};
use super::realign::Realignment;
use super::rules::Rules;
use crate::layer::{Cancel, LayerCache, LayerError, Reach};
use crate::region::road::budget::Budget;
use crate::region::road::graph::Graphs;
use crate::region::road::inputs::Inputs;
use crate::region::road::tile::{rings, tile_bounds, tiles_around};
use crate::region::road::vertex::Graph;
use glam::I64Vec2;
use std::sync::Arc;

/// The graphs of all tiles after merging, remembered.
pub(in crate::region::road) struct MergedGraphs {
    inputs: Arc<Inputs>,
    graphs: Arc<Graphs>,
    merged: LayerCache<[i64; 2], Graph>,
    realigned: LayerCache<[i64; 2], Graph>,
}

impl MergedGraphs {
    pub fn new(inputs: Arc<Inputs>, graphs: Arc<Graphs>, budget: Budget) -> Self {
        Self { inputs, graphs, merged: budget.cache(2), realigned: budget.cache(2) }
    }

    /// The graph of a tile after roads that run beside each other were merged.
    pub fn merged(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<Graph>, LayerError> {
        self.merged.get(&tile.to_array(), || self.make_merged(tile, cancel))
    }

    /// The graph of a tile after both stages: merging, and the realignment of minor legs.
    pub fn realigned(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<Graph>, LayerError> {
        self.realigned.get(&tile.to_array(), || self.make_realigned(tile, cancel))
    }

    fn make_merged(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Graph, LayerError> {
        cancel.check()?;
        let (inputs, step) = (&*self.inputs, self.inputs.step());
        if inputs.settings.merge <= 0.0 {
            return Ok(Graph::clone(&*self.graphs.graph(tile, cancel)?));
        }
        if let Some(plain) = self.plain(tile, cancel)? {
            return Ok(plain);
        }
        let (own, padding) = (tile_bounds(tile, step), merged_padding(&inputs.settings));
        let around = tiles_around(tile, rings(padding, step)).map(|t| self.graphs.graph(t, cancel));
        let graphs = around.collect::<Result<Vec<_>, _>>()?;
        let net = Net::new(&inputs.settings, tile, Reach::new("roads", own, padding), &graphs);
        connect::rebuild(&mut Rules::new(inputs, net, own, padding), tile)
    }

    fn make_realigned(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Graph, LayerError> {
        cancel.check()?;
        let (inputs, step) = (&*self.inputs, self.inputs.step());
        if inputs.settings.merge <= 0.0 {
            return Ok(Graph::clone(&*self.merged(tile, cancel)?));
        }
        if let Some(plain) = self.plain(tile, cancel)? {
            return Ok(plain);
        }
        let (own, padding) = (tile_bounds(tile, step), realigned_padding(&inputs.settings));
        let around = tiles_around(tile, rings(padding, step)).map(|t| self.merged(t, cancel));
        let graphs = around.collect::<Result<Vec<_>, _>>()?;
        let net = Net::new(&inputs.settings, tile, Reach::new("roads", own, padding), &graphs);
        Realignment::new(Rules::new(inputs, net, own, padding)).rebuild(tile)
    }

    /// The graph of a tile that at most one route comes near: there nothing merges and nothing is realigned.
    fn plain(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Option<Graph>, LayerError> {
        let padding = plain_padding(&self.inputs.settings);
        let mut rank = None;
        for near in tiles_around(tile, rings(padding, self.inputs.step())) {
            for v in self.graphs.graph(near, cancel)?.vertices.values() {
                if v.ways.len() > 2 || v.ways.iter().any(|w| *rank.get_or_insert(w.rank) != w.rank) {
                    return Ok(None);
                }
            }
        }
        Ok(Some(Graph::clone(&*self.graphs.graph(tile, cancel)?)))
    }
}
