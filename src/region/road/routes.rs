//! Routes of the roads that are kept, on the fine lattice: from gate to gate, along roads of higher classes where that is
//! cheaper.

use super::budget::Budget;
use super::cost::kernel;
use super::distance::Distances;
use super::field::{Corridor, Field, roughness};
use super::geodesic::{Stop, geodesic};
use super::inputs::{Inputs, Way};
use super::last_resort::LastResorts;
use super::lattice::node_at;
use super::padding::{SITE_STEPS, TIE_REACH};
use super::partners::Partners;
use super::proximity::Proximity;
use super::route::{Route, RouteEnd};
use super::site::{Site, Sites, Tie};
use super::tier::{beeline, class_of, tier_of};
use super::via::geodesic_via;
use crate::layer::{Cancel, LayerCache, LayerError, Reach, Weigh};
use crate::network::{SizeClass, StreetId};

use crate::region::settlement::{Settlement, SettlementId};
use crate::space::{Bounds, segments};
use glam::{DVec2, I64Vec2};
use std::sync::Arc;

/// Distance in metres from an existing road within which new roads cost more.
const BESIDE: f64 = 420.0;
/// Length in metres of the stretches along which a route looks up its surroundings.
const STRETCH: f64 = 3_000.0;
/// Extra cost per metre, for each kilometre off the corridor's line: of paths that cost the same, the one that follows the line
/// is taken.
const OFF_LINE: f64 = 0.12;
/// Edge length in metres of the tiles by which routes are listed.
const LIST_TILE: f64 = 1_024.0;

/// How a route avoids the settlements that it does not serve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Avoid {
    /// By discs around everything that the settlements and their ties might fill.
    Discs,
    /// By their exact outlines and ties, which takes much more work.
    Outlines,
}

/// A route, if the land lets one through.
struct MaybeRoute(Option<Arc<Route>>);

impl Weigh for MaybeRoute {
    fn bytes(&self) -> usize {
        self.0.as_ref().map_or(0, |c| c.bytes()) + 16
    }
}

/// Two settlements whose road, if there is one, may pass through a tile.
struct Candidate {
    ends: [Arc<Settlement>; 2],
    /// The line that the corridor follows, in plan metres.
    line: Vec<DVec2>,
}

impl Candidate {
    /// Whether the road may come into `bounds` (plan metres).
    fn nears(&self, bounds: Bounds, inputs: &Inputs) -> bool {
        let t = inputs.tier(tier_of(&self.ends[0], &self.ends[1]));
        let room = bounds.grown(t.corridor + 2.0 * inputs.step() as f64);
        segments(&self.line).any(|(p, q)| Bounds::of([p, q]).overlaps(room))
    }
}

/// The candidates of a tile.
struct Listed(Vec<Candidate>);

impl Weigh for Listed {
    fn bytes(&self) -> usize {
        self.0.iter().map(|c| size_of::<Candidate>() + c.line.len() * size_of::<DVec2>()).sum::<usize>() + 24
    }
}

/// The routes of all roads. In a finite domain they are found tier by tier and [set](Self::set_found).
pub(super) struct Routes {
    inputs: Arc<Inputs>,
    distances: Arc<Distances>,
    proximity: Arc<Proximity>,
    partners: Arc<Partners>,
    last_resorts: LastResorts,
    sites: Arc<Sites>,
    /// In a finite domain: the routes found so far, by tier, each tier sorted by id.
    found: Option<[Vec<Arc<Route>>; 3]>,
    routes: LayerCache<(SettlementId, SettlementId), MaybeRoute>,
    listed: LayerCache<(u8, i64, i64), Listed>,
}

impl Routes {
    pub fn new(
        inputs: Arc<Inputs>,
        distances: Arc<Distances>,
        proximity: Arc<Proximity>,
        (partners, last_resorts): (Arc<Partners>, LastResorts),
        sites: Arc<Sites>,
        budget: Budget,
    ) -> Self {
        let found = inputs.domain.map(|_| Default::default());
        let (routes, listed) = (budget.cache(3), budget.cache(3));
        Self { inputs, distances, proximity, partners, last_resorts, sites, found, routes, listed }
    }

    /// Sets the routes of a tier in a finite domain, sorted by id.
    pub fn set_found(&mut self, tier: SizeClass, routes: Vec<Arc<Route>>) {
        if let Some(found) = &mut self.found {
            found[tier as usize] = routes;
        }
    }

    /// Adds a route of a tier in a finite domain.
    pub fn add_found(&mut self, tier: SizeClass, route: Arc<Route>) {
        if let Some(found) = &mut self.found {
            found[tier as usize].push(route);
            found[tier as usize].sort_by_key(|r| r.id);
        }
    }

    /// The routes of all tiers that are set in a finite domain.
    pub fn found(&self) -> impl Iterator<Item = &Arc<Route>> {
        self.found.iter().flatten().flatten()
    }

    /// Routes of one tier that pass through `bounds` (plan metres), sorted by id.
    pub fn passing(&self, tier: SizeClass, bounds: Bounds, cancel: &Cancel) -> Result<Vec<Arc<Route>>, LayerError> {
        let step = self.inputs.step();
        if let Some(found) = &self.found {
            return Ok(found[tier as usize].iter().filter(|c| c.passes(bounds, step)).cloned().collect());
        }
        let (min, max) = ((bounds.min / LIST_TILE).floor().as_i64vec2(), (bounds.max / LIST_TILE).floor().as_i64vec2());
        let mut tiles = Vec::new();
        for y in min.y..=max.y {
            for x in min.x..=max.x {
                tiles.push(self.listed.get(&(tier as u8, x, y), || {
                    let corner = DVec2::new(x as f64, y as f64) * LIST_TILE;
                    self.list(tier, Bounds::new(corner, corner + LIST_TILE), cancel).map(Listed)
                })?);
            }
        }
        let mut candidates: Vec<&Candidate> = tiles.iter().flat_map(|t| &t.0).collect();
        candidates.sort_by_key(|c| [c.ends[0].id, c.ends[1].id]);
        candidates.dedup_by_key(|c| [c.ends[0].id, c.ends[1].id]);
        let mut out: Vec<Arc<Route>> = Vec::new();
        // Only the routes that may come in are searched.
        for c in candidates.into_iter().filter(|c| c.nears(bounds, &self.inputs)) {
            let route = self.between(&c.ends[0], &c.ends[1], cancel)?;
            out.extend(route.filter(|c| c.passes(bounds, step)));
        }
        out.sort_by_key(|c| c.id);
        Ok(out)
    }

    /// The pairs of a tier whose road may pass through a tile.
    fn list(&self, tier: SizeClass, tile: Bounds, cancel: &Cancel) -> Result<Vec<Candidate>, LayerError> {
        let t = self.inputs.tier(tier);
        let step = self.inputs.step();
        let padding = t.listing_padding(step) + tile.size().length() / 2.0;
        let read = Reach::new("roads", tile, padding).bounds();
        let all = self.inputs.settlements.centred_in(read, tier)?;
        let off = |s: &Settlement| distance_to_box(s.centre.plan(), tile);
        let mut out = Vec::new();
        for a in &all {
            for b in self.partners.of(tier, a)?.iter().filter(|b| a.id < b.id) {
                if off(a) + off(b) > t.longest(step, beeline(a, b)) {
                    continue;
                }
                let line = match self.distances.corridor_line(tier, a, b, cancel)? {
                    Some(line) => line,
                    None if self.last_resorts.joins(a, b, cancel)? => {
                        self.distances.coarse_path((tier, Way::Costlier), a, b, cancel)?.line.clone()
                    }
                    None => continue,
                };
                let candidate = Candidate { ends: [a.clone(), b.clone()], line };
                if candidate.nears(tile, &self.inputs) {
                    out.push(candidate);
                }
            }
        }
        Ok(out)
    }

    /// Routes of one tier that begin or end at a settlement, sorted by id.
    pub fn of(&self, tier: SizeClass, s: &Settlement, cancel: &Cancel) -> Result<Vec<Arc<Route>>, LayerError> {
        if let Some(found) = &self.found {
            let ends_here = |c: &&Arc<Route>| c.ends.iter().any(|e| e.settlement == s.id);
            return Ok(found[tier as usize].iter().filter(ends_here).cloned().collect());
        }
        let mut out = Vec::new();
        for other in self.partners.of(tier, s)? {
            out.extend(self.between(s, &other, cancel)?);
        }
        out.sort_by_key(|c: &Arc<Route>| c.id);
        Ok(out)
    }

    /// The route between two settlements, if the proximity rule keeps their pair. Settlements that touch need none.
    pub fn between(&self, a: &Settlement, b: &Settlement, cancel: &Cancel) -> Result<Option<Arc<Route>>, LayerError> {
        let (a, b) = if a.id < b.id { (a, b) } else { (b, a) };
        if let Some(found) = &self.found {
            let joins = |c: &&Arc<Route>| c.ends[0].settlement == a.id && c.ends[1].settlement == b.id;
            return Ok(found[tier_of(a, b) as usize].iter().find(joins).cloned());
        }
        let found = self.routes.get(&(a.id, b.id), || {
            let corridor = self.inputs.tier(tier_of(a, b)).corridor;
            if self.inputs.settlements.touch(a, b)? {
                return Ok(MaybeRoute(None));
            }
            let kept = self.proximity.keeps(a, b, cancel)?;
            if !kept && !self.last_resorts.joins(a, b, cancel)? {
                return Ok(MaybeRoute(None));
            }
            let mut route = if kept { self.search(a, b, corridor, Way::Usual, cancel)? } else { None };
            if route.is_none() {
                route = self.search(a, b, corridor, Way::Costlier, cancel)?;
            }
            Ok(MaybeRoute(route.map(Arc::new)))
        })?;
        Ok(found.0.clone())
    }

    /// Searches the route between two settlements in a corridor of a width in metres. `None` if the land lets none through. A
    /// costlier way follows the usual corridor if there is one. The settlement with the lower id comes first.
    pub fn search(
        &self,
        a: &Settlement,
        b: &Settlement,
        corridor: f64,
        way: Way,
        cancel: &Cancel,
    ) -> Result<Option<Route>, LayerError> {
        cancel.check()?;
        let tier = tier_of(a, b);
        let step = self.inputs.step();
        let mut path = self.distances.corridor_path(tier, a, b, cancel)?;
        if way == Way::Costlier && !path.cost.is_finite() {
            path = self.distances.coarse_path((tier, Way::Costlier), a, b, cancel)?;
        }
        if !path.cost.is_finite() {
            return Ok(None);
        }

        let (site_a, site_b) = (self.sites.site(a)?, self.sites.site(b)?);
        let stops = |site: &Site, s: &Settlement| -> Vec<Stop> {
            let stop = |t: &Tie| {
                let out = s.centre.to_local(node_at(t.node, step));
                Stop { node: t.node, cost: t.way, beyond: t.gate - out }
            };
            site.ties.iter().map(stop).collect()
        };
        let (from, to) = (stops(&site_a, a), stops(&site_b, b));
        let field = |avoid: Avoid| -> Result<Field, LayerError> {
            let mut field = self.field((tier, way), [a, b], avoid, (&path.line, corridor), cancel)?;
            field.close_edges(site_a.window, &site_a.closed);
            field.close_edges(site_b.window, &site_b.closed);
            Ok(field)
        };
        let via = self.inputs.wishes.via(a, b);
        let mut found = None;
        if !via.is_empty() {
            found = geodesic_via(&mut field(Avoid::Outlines)?, &from, via, &to, cancel)?;
        }
        // Where the discs of settlements fill a valley or an isthmus, roads may pass close to the outlines.
        let attempts =
            if self.found.is_none() { [Avoid::Discs, Avoid::Outlines].as_slice() } else { &[Avoid::Outlines] };
        for avoid in attempts {
            if found.is_none() {
                found = geodesic(&mut field(*avoid)?, &from, &to, cancel)?;
            }
        }
        let Some(found) = found else { return Ok(None) };
        let (tie_a, tie_b) = (&site_a.ties[found.from], &site_b.ties[found.to]);
        let end = |s: &Settlement, tie: &Tie| RouteEnd {
            settlement: s.id,
            centre: s.centre,
            vertex: tie.vertex,
            gate: tie.gate,
        };
        let gates = [a.centre.to_plan(tie_a.gate), b.centre.to_plan(tie_b.gate)];
        Ok(Some(Route {
            id: StreetId::of(&[0x636f_7572_7365, a.id.0, b.id.0]),
            class: class_of(tier),
            ends: [end(a, tie_a), end(b, tie_b)],
            bounds: Bounds::of(found.nodes.iter().map(|n| node_at(*n, step)).chain(gates)),
            nodes: found.nodes,
            spans: found.spans,
        }))
    }

    /// The ground of the corridor around a line: other settlements closed, roads of higher tiers and influences added.
    fn field(
        &self,
        (tier, way): (SizeClass, Way),
        ends: [&Settlement; 2],
        avoid: Avoid,
        (line, width): (&[DVec2], f64),
        cancel: &Cancel,
    ) -> Result<Field<'_>, LayerError> {
        let inputs = &*self.inputs;
        let t = inputs.tier_for(tier, way);
        let step = inputs.step();
        let reach = inputs.pair_reach(tier, ends, width);
        let (mut settlements, mut roads) = (Vec::new(), Vec::new());
        for stretch in stretches(line) {
            let room = stretch.grown(width);
            let margin = if avoid == Avoid::Discs { TIE_REACH } else { SITE_STEPS };
            settlements.extend(inputs.settlements.overlapping(reach.check(room.grown(margin * step as f64))?)?);
            for above in [SizeClass::City, SizeClass::Town] {
                if above > tier {
                    roads.extend(self.passing(above, reach.check(room)?, cancel)?);
                }
            }
        }
        settlements.sort_by_key(|s| s.id);
        settlements.dedup_by_key(|s| s.id);
        roads.sort_by_key(|c| c.id);
        roads.dedup_by_key(|c| c.id);
        let corridor = Corridor::around(line, width, step, inputs.range());
        let mut field = Field::new(corridor, t, step, &*inputs.terrain, |w| inputs.samples(w, step));
        for s in settlements.iter().filter(|s| ends.iter().all(|e| e.id != s.id)) {
            match avoid {
                Avoid::Discs if s.radius == 0.0 => {}
                Avoid::Discs => field.close_disc(s.centre.plan(), s.radius + TIE_REACH * step as f64),
                Avoid::Outlines => {
                    let site = self.sites.site(s)?;
                    field.close_edges(site.window, &site.closed);
                }
            }
        }
        let mut beside = vec![0f64; field.corridor().nodes.len()];
        for road in &roads {
            // A toll road may be crossed, but no other road takes a stretch of it.
            let toll = inputs.settings.class(road.class).toll;
            for (i, pair) in road.nodes.windows(2).enumerate() {
                if toll && road.level(i) == 0 {
                    field.close_edge(pair[0], pair[1]);
                } else {
                    field.add_existing(pair[0], pair[1], road.level(i));
                }
            }
            for span in road.spans.iter().filter(|_| !toll) {
                field.add_existing_span(&road.nodes[span.first..=span.last], span.tunnel);
            }
            raise_closeness(&road.nodes, field.corridor(), step, &mut beside);
        }
        let off: Vec<f64> = field.corridor().off.iter().map(|off| OFF_LINE * f64::from(*off) / 1000.0).collect();
        field.add(|slot, node| {
            t.building + t.beside_roads * beside[slot] + off[slot] + t.roughness * roughness(node, step)
        });
        field.add_influences(&inputs.influences, tier);
        Ok(field)
    }
}

/// Distance from a point to a box, 0 inside.
fn distance_to_box(p: DVec2, b: Bounds) -> f64 {
    (b.min - p).max(p - b.max).max(DVec2::ZERO).length()
}

/// Boxes around the stretches of a line.
fn stretches(line: &[DVec2]) -> Vec<Bounds> {
    let mut out = Vec::new();
    let mut held = Bounds::EMPTY;
    for (a, b) in segments(line) {
        held = held.union(Bounds::of([a, b]));
        if held.size().max_element() > STRETCH {
            out.push(held);
            held = Bounds::EMPTY;
        }
    }
    out.push(held.union(Bounds::of(line.last().copied())));
    out
}

/// Raises the closeness of the slots around an existing road: 1 on the road, decreasing to 0.
fn raise_closeness(nodes: &[I64Vec2], corridor: &Corridor, step: i64, closeness: &mut [f64]) {
    let r = (BESIDE / step as f64).ceil() as i64;
    for at in nodes {
        for y in -r..=r {
            for x in -r..=r {
                let by = I64Vec2::new(x, y);
                if let Some(slot) = corridor.slot(*at + by) {
                    closeness[slot] = closeness[slot].max(kernel(node_at(by, step).length(), BESIDE));
                }
            }
        }
    }
}
