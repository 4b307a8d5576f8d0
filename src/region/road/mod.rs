//! Layer 3: roads between settlements (Galin et al. 2011). Makes pieces of road between gates and junctions, and says which
//! settlements they connect. Reads terrain, settlements and their outlines.
//!
//! # Steps
//!
//! Each step is a pure function of what it is about, remembered in a bounded cache, and reads only what lies near:
//!
//! 1. `pairs`: the cheapest way of a pair of settlements on a wide lattice (`search`), within the ellipse that the greatest
//!    detour allows; from these costs the proximity rule, and where they leave doubt from those on the fine lattice in a
//!    corridor around that way. A pair is decided by settlements within reach of both its ends.
//! 2. `site`: where roads may enter a settlement, and what they may not touch beside it. Reads six steps of the lattice
//!    around its outline.
//! 3. `course`: the course of a kept pair on the fine lattice, within the same corridor: a `geodesic` by position and
//!    heading over a `field` of costs, with bridges and tunnels as edges, around discs of the settlements that it does not
//!    serve, or where these leave no way, around their outlines. Courses of lower classes read those of higher
//!    classes in their window, never of their own, so no order among equals matters.
//! 4. `graph`: all courses as a planar graph, in tiles of 8 steps. Reads courses 2 steps around the tile.
//! 5. `merge`: stretches that run beside each other become one, forks at sharp angles move outward. Reads graphs and
//!    outlines about 2 km around the tile with the default settings. After it, in tiles of its own, lesser roads meet better
//!    ones at blunter angles and cross them at one place; this reads merged graphs and outlines about 1 km around.
//! 6. `over`: where roads cross highways at right angles or nearly, they pass over on a bridge, and a ramp joins both if the
//!    settings say so. Reads the graph before and after merging about 1 km around.
//! 7. `shape`: smoothing, in the same tiles. Reads these graphs two tiles around, and outlines 16 steps around.
//! 8. `piece`: lines between junctions, followed from tile to tile as far as they go, cut at the ends of bridges and
//!    tunnels, with heights (`profile`).
//!
//! # Padding
//!
//! Every point of a course has one of its settlements within `TierSettings::padding`: its way is at most `detour`
//! beelines long, so one end is within half of that. A tile's courses are found from settlements whose distances to the
//! tile sum to no more than such a way, at most a reach from each other, and decided by settlements nearer to both ends
//! than their road is long; a window of the ground that a search reads lies within the ellipse or corridor of its pair.
//! `Reach` enforces the first wherever settlements are read. Edits change none of this: ways that influences make cheap,
//! and those through given points, keep within the ellipse of their pair. A way point that persists is one more settlement,
//! without an outline: `way_points`, `node`. How far a change of edits reaches is in `spread`.
//!
//! # What holds
//!
//! Roads of one level meet only at junctions; bridges and tunnels that a search chose are levels of their own. Courses
//! meet only at nodes and crossings of the lattice, which are vertices of the graph, connectors of merged roads are split
//! where they meet others, and smoothing moves a line only where nothing is near. Roads touch an outline only in their
//! gate, since the lattice is closed around it. Every course ends in gates or way points, and merging leaves no dead ends, so
//! no road ends in a field where the user has set no way point. Settlements that touch have no course: their border is the
//! way between them, and no tie or course comes near it.

mod control;
mod course;
mod field;
mod geodesic;
mod graph;
mod lattice;
mod led;
mod merge;
mod network;
mod node;
mod over;
mod pairs;
mod piece;
mod places;
mod profile;
mod search;
mod settings;
mod shape;
mod site;
mod spread;
#[cfg(test)]
mod tests;
mod way_points;
mod wide;

pub use network::{NetworkError, NetworkTask, RoadNetwork};
pub(crate) use over::{CLEARANCE, rise};
pub use settings::{Crossing, RoadSettings, TierSettings};

use crate::edits::{Edits, RejectedEdit};
use crate::layer::{Cancel, LayerCache, LayerError};
use crate::network::SizeClass;
use crate::network::{JunctionId, Street, StreetClass, StreetId};
use crate::region::{Settlement, SettlementId, Settlements};
use crate::space::{Bounds, Origin};
use crate::terrain::Terrain;
use glam::{DVec2, I64Vec2};
use places::Places;
use std::sync::Arc;

/// A piece of road between two junctions (gates, forks, crossings, ends of bridges).
#[derive(Clone, Debug, PartialEq)]
pub struct Road {
    /// Origin that `street.line` is local to.
    pub origin: Origin,
    /// The piece, in the classes highway, major and minor.
    pub street: Street,
    /// Height of the road in metres at each point of `street.line`: the ground, evened out so that no stretch is steeper
    /// than its class allows. Straight from end to end on bridges and in tunnels; that of the ground at junctions.
    pub heights: Vec<f64>,
}

/// Where roads enter a settlement.
#[derive(Clone, Debug, PartialEq)]
pub struct Gate {
    /// The junction where the roads end and the main street begins.
    pub junction: JunctionId,
    /// Index of the gate's vertex in the settlement's outline.
    pub vertex: usize,
    /// Position, local to the settlement: that vertex.
    pub at: DVec2,
    /// Unit direction in which the widest road arrives, into the settlement.
    pub inward: DVec2,
    /// Class of the widest road that ends here.
    pub class: StreetClass,
}

/// A connection of two settlements or way points that the proximity rule keeps, and that a road serves; not of two that touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Stable name.
    pub id: StreetId,
    /// The settlement or way point with the lower id.
    pub from: SettlementId,
    /// The settlement or way point with the higher id.
    pub to: SettlementId,
    /// Class tau = min(sigma, sigma).
    pub class: StreetClass,
    /// Length of the geodesic in metres.
    pub length_m: f64,
    /// Its cost, in metres of flat open ground.
    pub cost: f64,
    /// Number of bridges.
    pub bridges: usize,
    /// Number of tunnels.
    pub tunnels: usize,
}

/// All roads of a world, found by place.
pub struct Roads {
    work: Work,
}

/// What the steps share: what they read, and what each has made.
struct Work {
    settings: RoadSettings,
    terrain: Arc<dyn Terrain>,
    places: Arc<dyn Places>,
    /// What is different in a finite domain; `None` in the endless world.
    finite: Option<network::Finite>,
    /// Settlements that are nodes of the lattice.
    nodes: node::Nodes,
    /// What the user wants of roads.
    control: control::Control,
    samples: LayerCache<lattice::TileKey, lattice::SampleTile>,
    pairs: LayerCache<(u8, SettlementId, SettlementId), pairs::Pair>,
    tried: LayerCache<(SettlementId, SettlementId), pairs::Tried>,
    distances: LayerCache<(u8, SettlementId, SettlementId), pairs::Distance>,
    candidates: LayerCache<SettlementId, site::Candidates>,
    sites: LayerCache<SettlementId, site::Site>,
    courses: LayerCache<(SettlementId, SettlementId), course::Found>,
    listed: LayerCache<(u8, i64, i64), course::Listed>,
    graphs: LayerCache<[i64; 2], graph::Graph>,
    merged: LayerCache<[i64; 2], graph::Graph>,
    feet: LayerCache<[i64; 2], graph::Graph>,
    separated: LayerCache<[i64; 2], graph::Graph>,
    shapes: LayerCache<[i64; 2], shape::Shapes>,
    along: LayerCache<[graph::Key; 2], piece::Pieces>,
    tiles: LayerCache<[i64; 2], piece::Pieces>,
}

/// Class of the roads whose smaller end is of a size.
fn class_of(tier: SizeClass) -> StreetClass {
    match tier {
        SizeClass::City => StreetClass::Highway,
        SizeClass::Town => StreetClass::Major,
        SizeClass::Village => StreetClass::Minor,
    }
}

/// Size of the settlements whose roads to larger ones are of a class; `None` for streets.
fn tier_of_class(class: StreetClass) -> Option<SizeClass> {
    SizeClass::ALL.into_iter().find(|tier| class_of(*tier) == class)
}

/// The tiles up to `ring` columns and rows from one.
fn around(tile: I64Vec2, ring: i64) -> impl Iterator<Item = I64Vec2> {
    (-ring..=ring).flat_map(move |y| (-ring..=ring).map(move |x| tile + I64Vec2::new(x, y)))
}

impl Work {
    fn new(settings: &RoadSettings, terrain: Arc<dyn Terrain>, places: Arc<dyn Places>, bytes: usize) -> Self {
        let share = |parts: usize| bytes / 37 * parts;
        Self {
            settings: settings.clone(),
            terrain,
            places,
            finite: None,
            nodes: node::Nodes::default(),
            control: control::Control::default(),
            samples: LayerCache::new(share(6)),
            pairs: LayerCache::new(share(3)),
            tried: LayerCache::new(share(1)),
            distances: LayerCache::new(share(1)),
            candidates: LayerCache::new(share(1)),
            sites: LayerCache::new(share(4)),
            courses: LayerCache::new(share(3)),
            listed: LayerCache::new(share(3)),
            graphs: LayerCache::new(share(3)),
            merged: LayerCache::new(share(2)),
            feet: LayerCache::new(share(2)),
            separated: LayerCache::new(share(1)),
            shapes: LayerCache::new(share(2)),
            along: LayerCache::new(share(2)),
            tiles: LayerCache::new(share(3)),
        }
    }

    /// The same with what edits want, which are taken as checked.
    fn with_edits(
        settings: &RoadSettings,
        terrain: Arc<dyn Terrain>,
        places: Arc<dyn Places>,
        edits: &Edits,
        bytes: usize,
    ) -> Self {
        let step = settings.step;
        let (found, refused) = way_points::standing(&edits.way_points, &*terrain, &*places, step);
        let (points, indices): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let everywhere = Bounds::new(DVec2::NEG_INFINITY, DVec2::INFINITY);
        let nodes = node::Nodes::new(&points, everywhere, &*terrain, step);
        let places = way_points::among(places, &points);
        let mut control = control::Control::new(edits, settings, &*terrain, &*places);
        control.rejected.extend(refused);
        (control.way_points, control.way_point_edits) = (points, indices);
        Self { control, nodes, ..Self::new(settings, terrain, places, bytes) }
    }

    /// Open ground in a strip, as a class of roads sees it.
    fn field<'a>(&'a self, t: &'a TierSettings, strip: field::Strip) -> field::Field<'a> {
        let step = self.settings.step;
        let samples = |w: &search::Window| lattice::Samples::new(&self.samples, &*self.terrain, step, w);
        field::Field::new(strip, t, step, &*self.terrain, samples)
    }

    fn candidates(&self, s: &Settlement) -> Result<Arc<site::Candidates>, LayerError> {
        self.candidates.get(&s.id, || site::candidates(self, s))
    }

    fn site(&self, s: &Settlement) -> Result<Arc<site::Site>, LayerError> {
        self.sites.get(&s.id, || self.nodes.site(s).map_or_else(|| site::site(self, s), Ok))
    }

    /// The nodes of a box that a search may use: in a finite domain, none outside of it.
    fn window(&self, bounds: Bounds, step: i64) -> search::Window {
        let window = search::Window::around(bounds, step);
        self.finite.as_ref().map_or(window, |f| f.clip(window, step))
    }

    /// The node that stands for a settlement's centre.
    fn centre_node(&self, s: &Settlement, step: i64) -> I64Vec2 {
        if let Some(node) = self.nodes.node(s, step) {
            return node;
        }
        let near = || lattice::node_near(s.centre.plan(), step);
        self.finite.as_ref().map_or_else(near, |f| f.centre_node(&*self.terrain, s, step))
    }

    /// Nodes within `width` of a line that a search may use.
    fn strip(&self, line: &[DVec2], width: f64) -> field::Strip {
        let step = self.settings.step;
        field::Strip::around(line, width, step, self.finite.as_ref().map(|f| f.range(step)))
    }

    fn settlement(&self, end: &course::End) -> Result<Option<Arc<Settlement>>, LayerError> {
        let all = self.places.of_tier(Bounds::square(end.centre.plan(), 2.0), SizeClass::Village)?;
        Ok(all.into_iter().find(|s| s.id == end.settlement))
    }

    fn link(&self, course: &course::Course, cancel: &Cancel) -> Result<Link, LayerError> {
        let [a, b] = [self.settlement(&course.ends[0])?, self.settlement(&course.ends[1])?];
        let cost = match (&a, &b) {
            (Some(a), Some(b)) => pairs::distance(self, pairs::tier_of(a, b), a, b, cancel)?,
            _ => f64::INFINITY,
        };
        let line = course.line(self.settings.step);
        let tunnels = course.spans.iter().filter(|s| s.tunnel).count();
        let small = piece::bridges(self, course);
        Ok(Link {
            id: course.id,
            from: course.ends[0].settlement,
            to: course.ends[1].settlement,
            class: course.class,
            length_m: crate::space::line_length(&line),
            cost,
            bridges: course.spans.len() - tunnels + small,
            tunnels,
        })
    }

    fn graph(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<graph::Graph>, LayerError> {
        self.graphs.get(&tile.to_array(), || graph::graph(self, tile, cancel))
    }

    /// Vertices of the graph before merging within `distance` metres of the tile.
    fn near(&self, tile: I64Vec2, distance: f64, cancel: &Cancel) -> Result<Vec<graph::Vertex>, LayerError> {
        let own = graph::tile_bounds(tile, self.settings.step);
        let ring = (distance / own.size().x).ceil() as i64;
        let near = Bounds::new(DVec2::ZERO, own.size()).grown(distance);
        let mut out = Vec::new();
        for t in around(tile, ring) {
            let graph = self.graph(t, cancel)?;
            let is_near = |v: &&graph::Vertex| near.contains(v.place.local_to(Origin::at(own.min)));
            out.extend(graph.vertices.values().filter(is_near).cloned());
        }
        Ok(out)
    }

    fn shapes(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<shape::Shapes>, LayerError> {
        self.shapes.get(&tile.to_array(), || {
            let around = around(tile, shape::RING).map(|t| self.separated(t, cancel));
            shape::shapes(self, tile, &around.collect::<Result<Vec<_>, _>>()?, cancel)
        })
    }

    fn merged(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<graph::Graph>, LayerError> {
        self.merged.get(&tile.to_array(), || merge::merged(self, tile, cancel))
    }

    fn feet(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<graph::Graph>, LayerError> {
        self.feet.get(&tile.to_array(), || merge::feet(self, tile, cancel))
    }

    /// The graph as it is built.
    fn separated(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<graph::Graph>, LayerError> {
        self.separated.get_shared(&tile.to_array(), || over::separated(self, tile, cancel))
    }

    fn tile(&self, tile: I64Vec2, cancel: &Cancel) -> Result<Arc<piece::Pieces>, LayerError> {
        self.tiles.get(&tile.to_array(), || piece::pieces(self, tile, cancel))
    }
}

impl Roads {
    /// Roads between `settlements` over `terrain`. `cache_bytes` bounds the memory of what is remembered.
    pub fn new(
        settings: &RoadSettings,
        terrain: Arc<dyn Terrain>,
        settlements: Arc<Settlements>,
        cache_bytes: usize,
    ) -> Self {
        Self { work: Work::new(settings, terrain, settlements, cache_bytes) }
    }

    /// The same with influences on their cost, and roads kept, led and banned. Of `edits`, which are taken as checked, those of
    /// settlements are not looked at: `settlements` were made with them.
    pub fn with_edits(
        settings: &RoadSettings,
        terrain: Arc<dyn Terrain>,
        settlements: Arc<Settlements>,
        edits: &Edits,
        cache_bytes: usize,
    ) -> Self {
        Self { work: Work::with_edits(settings, terrain, settlements, edits, cache_bytes) }
    }

    /// Way points that roads pass, as settlements of radius 0, sorted by id: [`Link`]s name them like settlements. The
    /// junction at one is that of its gate at vertex 0.
    pub fn way_points(&self) -> &[Arc<Settlement>] {
        &self.work.control.way_points
    }

    /// The junction at a way point.
    pub fn way_point_junction(&self, id: SettlementId) -> JunctionId {
        JunctionId::of(&[2, id.0, 0, 0])
    }

    /// The edits that cannot be: without a settlement at both ends, beyond the reach of the class, through water, too near
    /// another way point or a settlement, or where the ground lets no road through. Finding out the last makes the roads that
    /// the edits want.
    pub fn rejected_edits(&self, cancel: &Cancel) -> Result<Vec<RejectedEdit>, LayerError> {
        let mut out = self.work.control.rejected.clone();
        out.extend(control::without_way(&self.work, cancel)?);
        out.sort_by_key(|e| (e.list, e.index));
        Ok(out)
    }

    /// Pieces of road whose centre line comes into `bounds` (plan metres; the box of one of its segments overlaps it),
    /// sorted by id.
    pub fn overlapping(&self, bounds: Bounds, cancel: &Cancel) -> Result<Vec<Arc<Road>>, LayerError> {
        let size = (graph::TILE_STEPS * self.work.settings.step) as f64;
        let (min, max) = ((bounds.min / size).floor().as_i64vec2(), (bounds.max / size).floor().as_i64vec2());
        let mut out = Vec::new();
        for y in min.y..=max.y {
            for x in min.x..=max.x {
                cancel.check()?;
                let tile = self.work.tile(I64Vec2::new(x, y), cancel)?;
                out.extend(tile.0.iter().filter(|r| r.enters(bounds)).cloned());
            }
        }
        out.sort_by_key(|r: &Arc<Road>| r.street.id);
        out.dedup_by_key(|r| r.street.id);
        Ok(out)
    }

    /// Gates of a settlement, by vertex.
    pub fn gates(&self, settlement: &Settlement, cancel: &Cancel) -> Result<Vec<Gate>, LayerError> {
        let mut out: Vec<Gate> = Vec::new();
        for tier in [SizeClass::City, SizeClass::Town, SizeClass::Village] {
            if tier > settlement.size {
                continue;
            }
            for course in course::courses_of(&self.work, tier, settlement, cancel)? {
                let last = usize::from(course.ends[1].settlement == settlement.id);
                let (end, node) =
                    (&course.ends[last], if last == 1 { course.nodes.last() } else { course.nodes.first() });
                let Some(node) = node else { continue };
                if out.iter().any(|g| g.vertex == end.vertex) {
                    // Wider classes come first.
                    continue;
                }
                let from = settlement.centre.to_local(lattice::node_at(*node, self.work.settings.step));
                out.push(Gate {
                    junction: JunctionId::of(&[2, settlement.id.0, end.vertex as u64, 0]),
                    vertex: end.vertex,
                    at: end.gate,
                    inward: (end.gate - from).normalize_or_zero(),
                    class: course.class,
                });
            }
        }
        out.sort_by_key(|g| g.vertex);
        Ok(out)
    }

    /// Connections with at least one end in `bounds` (plan metres), sorted by id.
    pub fn links(&self, bounds: Bounds, cancel: &Cancel) -> Result<Vec<Arc<Link>>, LayerError> {
        let mut out: Vec<Arc<Link>> = Vec::new();
        for s in self.work.places.of_tier(bounds, SizeClass::Village)? {
            for tier in [SizeClass::City, SizeClass::Town, SizeClass::Village] {
                cancel.check()?;
                if tier > s.size {
                    continue;
                }
                for course in course::courses_of(&self.work, tier, &s, cancel)? {
                    if !out.iter().any(|l| l.id == course.id) {
                        out.push(Arc::new(self.work.link(&course, cancel)?));
                    }
                }
            }
        }
        out.sort_by_key(|l| l.id);
        Ok(out)
    }
}
