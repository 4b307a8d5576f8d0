//! The steps that make roads, each with its cache, from the bottom up.

use super::budget::Budget;
use super::distance::Distances;
use super::graph::Graphs;
use super::inputs::Inputs;
use super::last_resort::LastResorts;
use super::merge::MergedGraphs;
use super::overpass::BuiltGraphs;
use super::partners::Partners;
use super::proximity::Proximity;
use super::routes::Routes;
use super::sections::Sections;
use super::shape::Shapes;
use super::site::Sites;
use std::sync::Arc;

/// The steps up to routes.
pub(super) struct Searches {
    pub inputs: Arc<Inputs>,
    pub distances: Arc<Distances>,
    pub proximity: Arc<Proximity>,
    pub partners: Arc<Partners>,
    pub sites: Arc<Sites>,
}

impl Searches {
    pub fn new(inputs: Inputs, budget: Budget) -> Self {
        let inputs = Arc::new(inputs);
        let distances = Arc::new(Distances::new(inputs.clone(), budget));
        let proximity = Arc::new(Proximity::new(inputs.clone(), distances.clone()));
        let partners = Arc::new(Partners::new(inputs.clone(), budget));
        let sites = Arc::new(Sites::new(inputs.clone(), budget));
        Self { inputs, distances, proximity, partners, sites }
    }

    /// The routes that these searches make. In a finite domain, none are found yet.
    pub fn routes(&self, budget: Budget) -> Routes {
        let (inputs, distances) = (self.inputs.clone(), self.distances.clone());
        let (proximity, partners) = (self.proximity.clone(), self.partners.clone());
        let last_resorts = LastResorts::new(inputs.clone(), distances.clone(), partners.clone(), budget);
        Routes::new(inputs, distances, proximity, (partners, last_resorts), self.sites.clone(), budget)
    }
}

/// The sections of the roads with some routes.
pub(super) fn sections(inputs: &Arc<Inputs>, routes: &Arc<Routes>, budget: Budget) -> Sections {
    let graphs = Arc::new(Graphs::new(inputs.clone(), routes.clone(), budget));
    let merged = Arc::new(MergedGraphs::new(inputs.clone(), graphs.clone(), budget));
    let built = Arc::new(BuiltGraphs::new(inputs.clone(), routes.clone(), graphs.clone(), merged, budget));
    let shapes = Arc::new(Shapes::new(inputs.clone(), built.clone(), budget));
    Sections::new(inputs.clone(), graphs, built, shapes, budget)
}
