//! Building the network of a finite domain.

use super::check::{BuildingSite, NetworkError, check_domain};
use super::edited::edited;
use super::listed::{Listed, disc};
use super::routes::{find_routes, last_resorts};
use super::task::NetworkTask;
use crate::edits::{Edits, RejectedEdit};
use crate::network::{Junction, SizeClass};
use crate::region::outline::Outline;
use crate::region::road::budget::Budget;
use crate::region::road::crossing::HighwayCrossing;
use crate::region::road::inputs::Inputs;
use crate::region::road::lattice::node_at;
use crate::region::road::link::{Link, link};
use crate::region::road::nodes::Nodes;
use crate::region::road::sections::RoadSection;
use crate::region::road::settings::RoadSettings;
use crate::region::road::steps::{Searches, sections};
use crate::region::road::tile::tiles_in;
use crate::region::road::unfulfilled::unfulfilled;
use crate::region::settlement::{Settlement, SettlementId};
use crate::space::{Bounds, Origin};
use crate::terrain::{Scan, Terrain, TerrainSample};
use glam::{DVec2, I64Vec2};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Memory for the caches, in bytes.
const BYTES: usize = 1 << 30;

/// Roads between the settlements of a finite domain.
///
/// ```
/// use bevy_sprawl::edits::Edits;
/// use bevy_sprawl::region::{RoadNetwork, RoadSettings, SettlementSettings, SettlementTable, TableOptions};
/// use bevy_sprawl::space::{Bounds, Seed};
/// use bevy_sprawl::terrain::{Band, Holes, Raster, RasterTerrain};
/// use std::sync::Arc;
///
/// let heights = b"ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 8000\n 12 14 20\n 30 8 11\n";
/// let terrain = RasterTerrain::new(Raster::from_ascii("plain.asc", heights, Band::Height, Holes::Refuse)?)?;
/// let towns = b"name,x,y,sigma\nEast,21000,7000,1\nWest,2000,5000,2\nNorth,9000,15000,0\n";
/// let towns = SettlementTable::from_csv("towns.csv", towns, &SettlementSettings::default(), &TableOptions::default())?;
///
/// let settlements: Vec<_> = towns.settlements().cloned().collect();
/// let settings = RoadSettings::finite(250);
/// let network = RoadNetwork::build(terrain.bounds(), Arc::new(terrain), &settlements, &settings, &Edits::default())?;
/// assert_eq!(network.links.len(), 3);
/// assert!(network.unreached.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RoadNetwork {
    /// The domain, in plan metres.
    pub domain: Bounds,
    /// The settlements, sorted by id.
    pub settlements: Vec<Arc<Settlement>>,
    /// The outline of each settlement, in the same order: the outline where roads stop, or, for a settlement whose roads end at
    /// its centre, a disc of its radius.
    pub outlines: Vec<Arc<Outline>>,
    /// The connections that the proximity rule keeps, sorted by id.
    pub links: Vec<Arc<Link>>,
    /// Sections of road between gates, centres and junctions, sorted by id.
    pub roads: Vec<Arc<RoadSection>>,
    /// Crossings of roads with highways: how they are built, and what keeps them from being built as the settings say.
    pub crossings: Vec<HighwayCrossing>,
    /// Settlements that no road reaches, because of water or cost. Sorted.
    pub unreached: Vec<SettlementId>,
    /// The user's way points, as settlements of radius 0 that links name like others. Sorted by id.
    pub way_points: Vec<Arc<Settlement>>,
    /// The edits that cannot be carried out.
    pub rejected: Vec<RejectedEdit>,
}

/// A terrain that is never read outside a box. Beyond the border of the box, everything is as at the border.
struct Inside {
    terrain: Arc<dyn Terrain>,
    bounds: Bounds,
}

impl Terrain for Inside {
    fn sample(&self, p: DVec2) -> TerrainSample {
        self.terrain.sample(p.clamp(self.bounds.min, self.bounds.max))
    }

    fn scan(&self) -> Scan<'_> {
        let mut scan = self.terrain.scan();
        Box::new(move |p| scan(p.clamp(self.bounds.min, self.bounds.max)))
    }
}

impl RoadNetwork {
    /// Builds roads between `settlements`, which lie in `domain` (plan metres), over `terrain`. For `settings` see
    /// [`RoadSettings::finite`]. The user's `edits`, which must have been checked, are carried out as in an endless world; pinned
    /// settlements join the given ones, of which some may be moved or banned. Patches have no use here.
    ///
    /// # Errors
    ///
    /// Fails if a setting is out of range ([`RoadSettings::check_finite`]), if the lattice of the domain has fewer than 4 or more
    /// than 4 Mi nodes, or if there are fewer than two settlements. Also fails if a settlement lies outside the domain, under
    /// water or nearer than 1.5 steps of the lattice to another one, or has the id of another one.
    pub fn build(
        domain: Bounds,
        terrain: Arc<dyn Terrain>,
        settlements: &[Settlement],
        settings: &RoadSettings,
        edits: &Edits,
    ) -> Result<Self, NetworkError> {
        Self::build_as(domain, terrain, settlements, settings, edits, &NetworkTask::default())
    }

    /// The same on several threads, with a cancel token and a report of the progress.
    ///
    /// # Errors
    ///
    /// Fails for the reasons of [`build`](Self::build), and if the task is cancelled.
    pub fn build_as(
        domain: Bounds,
        terrain: Arc<dyn Terrain>,
        settlements: &[Settlement],
        settings: &RoadSettings,
        edits: &Edits,
        task: &NetworkTask<'_>,
    ) -> Result<Self, NetworkError> {
        settings.check_finite()?;
        check_domain(domain, settings.step)?;
        let site = BuildingSite { domain, terrain: &*terrain, step: settings.step };
        site.check(settlements)?;
        let (all, mut rejected) = edited(&site, settlements, &edits.settlements);
        if all.len() < 2 {
            return Err(NetworkError::TooFew(all.len()));
        }
        let all: Vec<Arc<Settlement>> = all.into_iter().map(Arc::new).collect();
        let terrain: Arc<dyn Terrain> = Arc::new(Inside { terrain, bounds: domain });
        let (mut listed, mut searches) = searches(domain, &terrain, &all, settings, edits, &[]);
        // Where ground and domain leave the disc of a settlement no gate, the settlement becomes a node.
        let mut nodes = Vec::new();
        for s in all.iter().filter(|s| !listed.is_node(s.id)) {
            if !searches.sites.site(s)?.ties.iter().any(|t| domain.contains(node_at(t.node, settings.step))) {
                nodes.push(s.id);
            }
        }
        if !nodes.is_empty() {
            nodes.sort_unstable();
            (listed, searches) = self::searches(domain, &terrain, &all, settings, edits, &nodes);
        }
        let budget = Budget::new(BYTES);
        let mut routes = searches.routes(budget);
        for tier in SizeClass::ALL {
            let found = find_routes(&searches, &routes, tier, task)?;
            routes.set_found(tier, found);
        }
        for (tier, route) in last_resorts(&searches, &routes, task)? {
            routes.add_found(tier, route);
        }
        let routes = Arc::new(routes);
        let inputs = &searches.inputs;
        let found: Vec<_> = routes.found().collect();
        let measure = |route: &&Arc<_>| Ok(Arc::new(link(inputs, &searches.distances, route, &task.cancel)?));
        let mut links = task.each("measuring roads", &found, measure)?;
        rejected.extend(inputs.rejected.iter().cloned());
        rejected.extend(unfulfilled(inputs, &routes, &task.cancel)?);
        rejected.sort_by_key(|e| (e.list, e.index));
        links.sort_by_key(|l| l.id);
        let sections = sections(inputs, &routes, budget);
        let tiles: Vec<I64Vec2> = tiles_in(domain, settings.step).collect();
        let parts = task.each("shaping roads", &tiles, |tile| sections.of_tile(*tile, &task.cancel))?;
        let crossings = task.each("looking at crossings", &tiles, |tile| sections.crossings(*tile, &task.cancel))?;
        let mut roads: Vec<&Arc<RoadSection>> = parts.iter().flat_map(|p| &p.0).collect();
        roads.sort_by_key(|r| r.street.id);
        roads.dedup_by_key(|r| r.street.id);
        let outline = |s: &Arc<Settlement>| {
            let stop = listed.stop(s.id).cloned();
            stop.unwrap_or_else(|| Arc::new(disc(s, s.radius, 1)))
        };
        let reached = |id: SettlementId| links.iter().any(|l| l.from == id || l.to == id);
        Ok(Self {
            domain,
            outlines: listed.all.iter().map(outline).collect(),
            unreached: listed.all.iter().map(|s| s.id).filter(|id| !reached(*id)).collect(),
            settlements: listed.all.clone(),
            roads: roads.into_iter().cloned().collect(),
            way_points: inputs.way_points.iter().map(|p| p.settlement.clone()).collect(),
            crossings: crossings.concat(),
            links,
            rejected,
        })
    }

    /// The ends of all sections of road, sorted by id, local to an origin.
    pub fn junctions(&self, origin: Origin) -> Vec<Junction> {
        let mut out = BTreeMap::new();
        for road in &self.roads {
            let (street, shift) = (&road.street, road.origin.offset_to(origin));
            let ends = [(street.from, street.line.first()), (street.to, street.line.last())];
            out.extend(ends.into_iter().filter_map(|(id, at)| Some((id, *at? + shift))));
        }
        out.into_iter().map(|(id, at)| Junction { id, at }).collect()
    }

    /// Total length of all sections of road, in metres.
    pub fn length(&self) -> f64 {
        self.roads.iter().fold(0.0, |sum, r| sum + r.street.length())
    }
}

/// The settlements of a domain as roads see them, and the searches between them. The settlements in `nodes` (sorted ids) are
/// nodes, whatever their size.
fn searches(
    domain: Bounds,
    terrain: &Arc<dyn Terrain>,
    all: &[Arc<Settlement>],
    settings: &RoadSettings,
    edits: &Edits,
    nodes: &[SettlementId],
) -> (Arc<Listed>, Searches) {
    let budget = Budget::new(BYTES);
    let listed = Arc::new(Listed::new(all.to_vec(), settings.step, nodes));
    let mut inputs = Inputs::with_edits(settings, terrain.clone(), listed.clone(), edits, Some(domain), budget);
    let points = inputs.way_points.iter().map(|p| &p.settlement);
    let mut small: Vec<Arc<Settlement>> =
        listed.all.iter().filter(|s| listed.is_node(s.id)).chain(points).cloned().collect();
    small.sort_by_key(|s| s.id);
    inputs.nodes = Nodes::new(&small, domain, &**terrain, settings.step);
    (listed, Searches::new(inputs, budget))
}
