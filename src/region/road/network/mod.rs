//! The roads of a finite domain: given settlements, a piece of ground, and the same steps as in the endless world (Galin et al.
//! 2011, sections 4 to 6).
//!
//! Nothing outside of the domain is read or built on. Every pair of settlements within the settings' reach is a candidate.
//! A settlement too small for the lattice is a node: roads end at its centre, or pass through it (`Nodes`). A larger one has a
//! disc with gates, shrunk where a neighbour is near (`places`).

mod parallel;
mod places;
mod settings;
#[cfg(test)]
mod tests;

use super::course::{Course, find};
use super::lattice::{node_at, node_near};
use super::node::{Nodes, around, nearer};
use super::pairs::{beeline, hopeless, kept, tier_of};
use super::search::Window;
use super::{Link, Road, RoadSettings, Work, graph};
use crate::layer::{Cancel, LayerError, RangeError};
use crate::network::Junction;
use crate::network::SizeClass;
use crate::region::{Outline, Settlement, SettlementId};
use crate::space::{Bounds, Origin};
use crate::terrain::{Scan, Terrain, TerrainSample};
use glam::{DVec2, I64Vec2};
use parallel::each;
use places::Listed;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Nodes that the lattice of a domain may have.
const MOST_NODES: f64 = 4_194_304.0;
/// Memory for what the steps remember, in bytes.
const BYTES: usize = 1 << 30;
/// How much wider the corridor is, of a pair whose road found no way in it, in the second and third try.
const WIDER: [f64; 2] = [3.0, 12.0];
/// Least distance of two settlements, in steps of the lattice: no node is the nearest to both.
const LEAST_APART: f64 = 1.5;

/// Why a network cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NetworkError {
    /// A setting, or the domain, is out of range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// There is nothing to connect.
    #[error("{0} settlements; allowed are two or more")]
    TooFew(usize),
    /// A settlement cannot be where it is.
    #[error("{reason}")]
    Settlement {
        /// Index in the list given.
        index: usize,
        /// What is wrong, and what is allowed. One line.
        reason: String,
    },
    /// The work was cancelled.
    #[error(transparent)]
    Layer(#[from] LayerError),
}

/// How a network is built. It changes nothing in the result.
pub struct NetworkTask<'a> {
    /// Threads to work on, at least 1.
    pub threads: usize,
    /// Stops the work.
    pub cancel: Cancel,
    /// Told of what is done (a step's name, how many parts of how many), from any thread.
    pub progress: &'a (dyn Fn(&str, usize, usize) + Sync),
}

impl Default for NetworkTask<'_> {
    /// One thread, and nobody is told.
    fn default() -> Self {
        Self { threads: 1, cancel: Cancel::new(), progress: &|_, _, _| () }
    }
}

/// Roads between the settlements of a finite domain.
///
/// ```
/// use bevy_sprawl::region::{RoadNetwork, RoadSettings, SettlementSettings, SettlementTable};
/// use bevy_sprawl::space::{Bounds, Seed};
/// use bevy_sprawl::terrain::{Band, Holes, Raster, RasterTerrain};
/// use std::sync::Arc;
///
/// let heights = b"ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 8000\n 12 14 20\n 30 8 11\n";
/// let terrain = RasterTerrain::new(Raster::from_ascii("plain.asc", heights, Band::Height, Holes::Refuse)?)?;
/// let towns = b"name,x,y,sigma\nEast,21000,7000,1\nWest,2000,5000,2\nNorth,9000,15000,0\n";
/// let towns = SettlementTable::from_csv("towns.csv", towns, &SettlementSettings::default(), None)?;
///
/// let settlements: Vec<_> = towns.settlements().cloned().collect();
/// let settings = RoadSettings::finite(250);
/// let network = RoadNetwork::build(terrain.bounds(), Arc::new(terrain), &settlements, &settings)?;
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
    /// Outline of each of these, in the same order: where roads stop at it, or a disc of its radius around the centre where they
    /// end there.
    pub outlines: Vec<Arc<Outline>>,
    /// The connections that the proximity rule keeps, sorted by id.
    pub links: Vec<Arc<Link>>,
    /// Pieces of road between gates, centres and junctions, sorted by id.
    pub roads: Vec<Arc<Road>>,
    /// Settlements that no road leads to, for water or cost is in the way; sorted.
    pub unreached: Vec<SettlementId>,
}

/// What is different in a finite domain.
pub(super) struct Finite {
    bounds: Bounds,
    places: Arc<Listed>,
    /// Courses of villages, towns and cities, as far as they are found, each sorted by id.
    courses: [Vec<Arc<Course>>; 3],
}

impl Finite {
    /// Courses of one class.
    pub fn courses(&self, tier: SizeClass) -> &[Arc<Course>] {
        &self.courses[tier as usize]
    }

    /// Whether roads end at a settlement's centre.
    pub fn is_node(&self, s: &Settlement) -> bool {
        self.places.is_node(s.id)
    }

    /// The node for a settlement's centre on a lattice of some step: the nearest dry one in the domain, if one is near.
    pub fn centre_node(&self, terrain: &dyn Terrain, s: &Settlement, step: i64) -> I64Vec2 {
        let (low, high) = self.range(step);
        let near = node_near(s.centre.plan(), step).clamp(low, high);
        let is_dry = |n: &I64Vec2| terrain.sample(node_at(*n, step)).depth() == 0.0;
        let inside = around(near).filter(|n| n.cmpge(low).all() && n.cmple(high).all() && is_dry(n));
        inside.min_by(|a, b| nearer(*a, *b, s.centre, step)).unwrap_or(near)
    }

    /// First and last node in the domain.
    pub fn range(&self, step: i64) -> (I64Vec2, I64Vec2) {
        let s = step as f64;
        ((self.bounds.min / s).ceil().as_i64vec2(), (self.bounds.max / s).floor().as_i64vec2())
    }

    /// The part of a window that lies in the domain.
    pub fn clip(&self, window: Window, step: i64) -> Window {
        let (low, high) = self.range(step);
        let (min, max) = (window.min.max(low), (window.min + window.size - 1).min(high));
        Window { min, size: (max - min + 1).max(I64Vec2::ZERO) }
    }
}

/// A terrain that is never read outside of a box; beyond its border all is as there.
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
    /// Roads between `settlements`, which lie in `domain` (plan metres), over `terrain`; for `settings` see
    /// [`RoadSettings::finite`].
    ///
    /// Fails on settings out of range ([`RoadSettings::check_finite`]), on a domain with fewer than 4 or more than 4 Mi nodes
    /// of the lattice, on fewer than two settlements, and on a settlement outside of the domain, under water, with an id
    /// that another has, or nearer than 1.5 steps of the lattice to another.
    pub fn build(
        domain: Bounds,
        terrain: Arc<dyn Terrain>,
        settlements: &[Settlement],
        settings: &RoadSettings,
    ) -> Result<Self, NetworkError> {
        Self::build_as(domain, terrain, settlements, settings, &NetworkTask::default())
    }

    /// The same, on threads, cancellable, with somebody told of the progress.
    pub fn build_as(
        domain: Bounds,
        terrain: Arc<dyn Terrain>,
        settlements: &[Settlement],
        settings: &RoadSettings,
        task: &NetworkTask<'_>,
    ) -> Result<Self, NetworkError> {
        settings.check_finite()?;
        check_domain(domain, settings.step)?;
        check_settlements(domain, &*terrain, settlements, settings.step)?;
        let all: Vec<Arc<Settlement>> = settlements.iter().cloned().map(Arc::new).collect();
        let terrain = Arc::new(Inside { terrain, bounds: domain });
        let mut work = new_work(domain, terrain.clone(), all.clone(), settings, &[]);
        // Where ground and domain leave a disc no gate, its settlement is a node.
        let mut nodes = Vec::new();
        for s in all.iter().filter(|s| work.finite.as_ref().is_some_and(|f| !f.is_node(s))) {
            if !work.site(s)?.ties.iter().any(|t| domain.contains(node_at(t.node, settings.step))) {
                nodes.push(s.id);
            }
        }
        if !nodes.is_empty() {
            nodes.sort_unstable();
            work = new_work(domain, terrain, all, settings, &nodes);
        }
        for tier in SizeClass::ALL {
            let found = courses(&mut work, tier, task)?;
            if let Some(finite) = &mut work.finite {
                finite.courses[tier as usize] = found;
            }
        }
        Self::finish(domain, &work, task)
    }

    fn finish(domain: Bounds, work: &Work, task: &NetworkTask<'_>) -> Result<Self, NetworkError> {
        let Some(finite) = &work.finite else { return Err(LayerError::Cancelled.into()) };
        let all = &finite.places.all;
        let courses: Vec<&Arc<Course>> = finite.courses.iter().flatten().collect();
        let mut links = each(task, "measuring roads", &courses, |c| Ok(Arc::new(work.link(c, &task.cancel)?)))?;
        links.sort_by_key(|l| l.id);
        let size = (graph::TILE_STEPS * work.settings.step) as f64;
        let (min, max) = ((domain.min / size).floor().as_i64vec2(), (domain.max / size).floor().as_i64vec2());
        let tiles: Vec<I64Vec2> =
            (min.y..=max.y).flat_map(|y| (min.x..=max.x).map(move |x| I64Vec2::new(x, y))).collect();
        let pieces = each(task, "shaping roads", &tiles, |tile| work.tile(*tile, &task.cancel))?;
        let mut roads: Vec<&Arc<Road>> = pieces.iter().flat_map(|p| &p.0).collect();
        roads.sort_by_key(|r| r.street.id);
        roads.dedup_by_key(|r| r.street.id);
        let roads = roads.into_iter().cloned().collect();
        let outline = |s: &Arc<Settlement>| {
            let stop = finite.places.stop(s.id).cloned();
            stop.unwrap_or_else(|| Arc::new(places::disc(s, s.radius, 1)))
        };
        let reached = |id: SettlementId| links.iter().any(|l| l.from == id || l.to == id);
        Ok(Self {
            domain,
            outlines: all.iter().map(outline).collect(),
            unreached: all.iter().map(|s| s.id).filter(|id| !reached(*id)).collect(),
            settlements: all.clone(),
            links,
            roads,
        })
    }

    /// Where pieces of road end, sorted by id, local to an origin.
    pub fn junctions(&self, origin: Origin) -> Vec<Junction> {
        let mut out = BTreeMap::new();
        for road in &self.roads {
            let (street, shift) = (&road.street, road.origin.offset_to(origin));
            let ends = [(street.from, street.line.first()), (street.to, street.line.last())];
            out.extend(ends.into_iter().filter_map(|(id, at)| Some((id, *at? + shift))));
        }
        out.into_iter().map(|(id, at)| Junction { id, at }).collect()
    }

    /// Length of all pieces of road, in metres.
    pub fn length(&self) -> f64 {
        self.roads.iter().fold(0.0, |sum, r| sum + r.street.length())
    }
}

fn new_work(
    domain: Bounds,
    terrain: Arc<dyn Terrain>,
    all: Vec<Arc<Settlement>>,
    settings: &RoadSettings,
    nodes: &[SettlementId],
) -> Work {
    let places = Arc::new(Listed::new(all, settings.step, nodes));
    let small: Vec<Arc<Settlement>> = places.all.iter().filter(|s| places.is_node(s.id)).cloned().collect();
    let nodes = Nodes::new(&small, domain, &*terrain, settings.step);
    let finite = Some(Finite { bounds: domain, places: places.clone(), courses: Default::default() });
    Work { nodes, finite, ..Work::new(settings, terrain, places, BYTES) }
}

/// The courses of one class, sorted by id.
fn courses(work: &mut Work, tier: SizeClass, task: &NetworkTask<'_>) -> Result<Vec<Arc<Course>>, LayerError> {
    let everywhere = Bounds::new(DVec2::NEG_INFINITY, DVec2::INFINITY);
    let all = work.places.of_tier(everywhere, tier)?;
    let t = work.settings.tier(tier).clone();
    let rows: Vec<usize> = (0..all.len()).collect();
    let choose = |fits: &(dyn Fn(&Settlement, &Settlement) -> bool + Sync)| {
        let row = |i: &usize| {
            let a = &all[*i];
            let wanted = |b: &&Arc<Settlement>| tier_of(a, b) == tier && beeline(a, b) <= t.reach && fits(a, b);
            Ok(all[i + 1..].iter().filter(wanted).map(|b| (a, b)).collect::<Vec<_>>())
        };
        Ok(each(task, "choosing pairs", &rows, row)?.concat())
    };
    let mut wanted = choose(&|a, b| !hopeless(&t, a, b, &all))?;
    let (mut out, mut tried): (Vec<Arc<Course>>, BTreeSet<_>) = Default::default();
    // That a pair is hopeless is judged by beelines. In mountains these may lead astray: the cheapest way from one part of the
    // network to the rest, which the proximity rule never rules out, is found among all pairs.
    while !wanted.is_empty() {
        let found = built(work, tier, &wanted, task)?;
        let stuck = found.is_empty() && !tried.is_empty();
        out.extend(found);
        tried.extend(wanted.iter().map(|(a, b)| (a.id, b.id)));
        let parts = parts(&all, work.finite.iter().flat_map(|f| f.courses.iter().flatten()).chain(&out));
        let apart = |a: &Settlement, b: &Settlement| parts.get(&a.id) != parts.get(&b.id);
        wanted = if stuck { Vec::new() } else { choose(&|a, b| apart(a, b) && !tried.contains(&(a.id, b.id)))? };
    }
    out.sort_by_key(|c| c.id);
    Ok(out)
}

/// Which settlements courses connect: those of one part have the same number.
fn parts<'a>(all: &[Arc<Settlement>], courses: impl Iterator<Item = &'a Arc<Course>>) -> BTreeMap<SettlementId, usize> {
    let mut part: BTreeMap<SettlementId, usize> = all.iter().enumerate().map(|(i, s)| (s.id, i)).collect();
    for course in courses {
        let ends = [0, 1].map(|i| part.get(&course.ends[i].settlement).copied());
        if let [Some(a), Some(b)] = ends {
            part.values_mut().filter(|p| **p == b).for_each(|p| *p = a);
        }
    }
    part
}

/// Courses of the pairs among `tried` that the proximity rule keeps.
fn built(
    work: &mut Work,
    tier: SizeClass,
    tried: &[(&Arc<Settlement>, &Arc<Settlement>)],
    task: &NetworkTask<'_>,
) -> Result<Vec<Arc<Course>>, LayerError> {
    let what = format!("finding {} roads", super::class_of(tier).name());
    let keeps = each(task, &what, tried, |(a, b)| kept(work, a, b, &task.cancel))?;
    let mut pairs: Vec<_> = tried.iter().zip(keeps).filter(|(_, k)| *k).map(|(p, _)| *p).collect();
    let mut out: Vec<Arc<Course>> = Vec::new();
    let corridor = work.settings.tier(tier).corridor;
    for wider in [1.0].into_iter().chain(WIDER) {
        work.settings.tier_mut(tier).corridor = corridor * wider;
        let found = each(task, &what, &pairs, |(a, b)| find(work, a, b, &task.cancel))?;
        let blocked: Vec<_> = pairs.iter().zip(&found).filter(|(_, f)| f.is_none()).map(|(p, _)| *p).collect();
        out.extend(found.into_iter().flatten().map(Arc::new));
        pairs = blocked;
    }
    work.settings.tier_mut(tier).corridor = corridor;
    Ok(out)
}

fn check_domain(domain: Bounds, step: i64) -> Result<(), RangeError> {
    let size = domain.size();
    for (field, at) in [("domain.min.x", domain.min.x), ("domain.min.y", domain.min.y)] {
        RangeError::check(field, at, -1e10, 1e10)?;
    }
    RangeError::check("width of the domain", size.x, 0.0, 1e9)?;
    RangeError::check("height of the domain", size.y, 0.0, 1e9)?;
    let least = (size.x * size.y / MOST_NODES).sqrt().ceil();
    RangeError::check("step", step as f64, least, size.min_element() / 2.0)
}

fn check_settlements(
    domain: Bounds,
    terrain: &dyn Terrain,
    settlements: &[Settlement],
    step: i64,
) -> Result<(), NetworkError> {
    if settlements.len() < 2 {
        return Err(NetworkError::TooFew(settlements.len()));
    }
    for (index, s) in settlements.iter().enumerate() {
        let at = s.centre.plan();
        let wrong = |reason: String| Err(NetworkError::Settlement { index, reason });
        if !domain.contains(at) {
            let (low, high) = (domain.min, domain.max);
            return wrong(format!(
                "{} at {},{} m lies outside of the domain; allowed is x {:.0} to {:.0}, y {:.0} to {:.0}",
                s.name, at.x, at.y, low.x, high.x, low.y, high.y
            ));
        }
        let depth = terrain.sample(at).depth();
        if depth > 0.0 {
            return wrong(format!(
                "{} at {},{} m lies under {depth:.1} m of water; allowed is dry ground",
                s.name, at.x, at.y
            ));
        }
        for other in &settlements[..index] {
            let apart = s.centre.offset_to(other.centre).length();
            if other.id == s.id {
                return wrong(format!("{} has the id of {}; allowed is each once", s.name, other.name));
            }
            if apart < LEAST_APART * step as f64 {
                return wrong(format!(
                    "{} lies {apart:.0} m from {}; allowed are {LEAST_APART} steps of the lattice, {:.0} m, or more",
                    s.name,
                    other.name,
                    LEAST_APART * step as f64
                ));
            }
        }
    }
    Ok(())
}
