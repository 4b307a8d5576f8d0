//! The routes of a finite domain, tier by tier.

use super::task::NetworkTask;
use crate::layer::LayerError;
use crate::network::SizeClass;
use crate::region::road::inputs::Way;
use crate::region::road::last_resort::MOST_TRIES;
use crate::region::road::partners::worth_a_search;
use crate::region::road::route::Route;
use crate::region::road::routes::Routes;
use crate::region::road::steps::Searches;
use crate::region::road::tier::{beeline, class_of, tier_of};
use crate::region::road::wishes::Wish;
use crate::region::settlement::{Settlement, SettlementId};
use crate::space::{Bounds, DisjointSets};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// If the road of a pair finds no path, its corridor becomes this much wider in the second and third attempt.
const WIDER: [f64; 2] = [3.0, 12.0];

/// A pair of settlements.
type Pair = (Arc<Settlement>, Arc<Settlement>);

/// The routes of a tier, sorted by id. The routes of higher tiers are set in `routes`.
pub(super) fn find_routes(
    searches: &Searches,
    routes: &Routes,
    tier: SizeClass,
    task: &NetworkTask<'_>,
) -> Result<Vec<Arc<Route>>, LayerError> {
    let everywhere = Bounds::new(DVec2::NEG_INFINITY, DVec2::INFINITY);
    let all = searches.inputs.settlements.centred_in(everywhere, tier)?;
    let t = searches.inputs.tier(tier);
    let rows: Vec<usize> = (0..all.len()).collect();
    let fits = |a: &Settlement, b: &Settlement| tier_of(a, b) == tier && beeline(a, b) <= t.reach;
    let likely = |i: &usize| {
        let a = &all[*i];
        let found = worth_a_search(t, a, &all, |b| a.id < b.id && fits(a, b));
        Ok(found.into_iter().map(|b| (a.clone(), b)).collect::<Vec<_>>())
    };
    let mut wanted: Vec<Pair> = task.each("choosing pairs", &rows, likely)?.concat();
    let wishes = searches.inputs.wishes.wanted().map(|(_, [a, b], _)| (a, b));
    wanted.extend(wishes.filter(|(a, b)| fits(a, b)).map(|(a, b)| (a.clone(), b.clone())));
    wanted.sort_by_key(|(a, b)| (a.id, b.id));
    wanted.dedup_by_key(|(a, b)| (a.id, b.id));
    let (mut out, mut tried): (Vec<Arc<Route>>, BTreeSet<_>) = Default::default();
    // Whether a pair is hopeless is judged by beelines, which may mislead in mountains. The cheapest path from one part of the
    // network to the rest is never ruled out by the proximity rule; it is found among all pairs of different parts.
    while !wanted.is_empty() {
        let found = kept_routes(searches, routes, tier, &wanted, task)?;
        let stuck = found.is_empty() && !tried.is_empty();
        out.extend(found);
        tried.extend(wanted.iter().map(|(a, b)| (a.id, b.id)));
        let parts = parts(&all, routes.found().chain(&out));
        let apart = |a: &Settlement, b: &Settlement| parts.get(&a.id) != parts.get(&b.id);
        let missing = |i: &usize| {
            let a = &all[*i];
            let wanted = |b: &&Arc<Settlement>| fits(a, b) && apart(a, b) && !tried.contains(&(a.id, b.id));
            Ok(all[i + 1..].iter().filter(wanted).map(|b| (a.clone(), b.clone())).collect::<Vec<_>>())
        };
        wanted = if stuck { Vec::new() } else { task.each("choosing pairs", &rows, missing)?.concat() };
    }
    out.sort_by_key(|c| c.id);
    Ok(out)
}

/// Routes at any cost for the settlements that the routes found so far do not reach, each to the nearest settlement that such a
/// way leads to.
pub(super) fn last_resorts(
    searches: &Searches,
    routes: &Routes,
    task: &NetworkTask<'_>,
) -> Result<Vec<(SizeClass, Arc<Route>)>, LayerError> {
    let everywhere = Bounds::new(DVec2::NEG_INFINITY, DVec2::INFINITY);
    let all = searches.inputs.settlements.centred_in(everywhere, SizeClass::Village)?;
    let ends = routes.found().flat_map(|r| r.ends.iter().map(|e| e.settlement));
    let mut reached: BTreeSet<SettlementId> = ends.collect();
    let mut out = Vec::new();
    for s in &all {
        task.cancel.check()?;
        if reached.contains(&s.id) {
            continue;
        }
        let inputs = &searches.inputs;
        let within_reach = |o: &Settlement| beeline(s, o) <= inputs.tier(tier_of(s, o)).reach;
        let may_join =
            |o: &&Arc<Settlement>| o.id != s.id && within_reach(o) && inputs.wishes.of(s, o) != Some(&Wish::Ban);
        let mut others: Vec<&Arc<Settlement>> = all.iter().filter(may_join).collect();
        others.sort_by(|a, b| beeline(s, a).total_cmp(&beeline(s, b)).then(a.id.cmp(&b.id)));
        for other in others.into_iter().take(MOST_TRIES) {
            let (a, b) = if s.id < other.id { (s, other) } else { (other, s) };
            let tier = tier_of(a, b);
            let corridor = searches.inputs.tier(tier).corridor * WIDER[0];
            if let Some(route) = routes.search(a, b, corridor, Way::Costlier, &task.cancel)? {
                reached.extend([a.id, b.id]);
                out.push((tier, Arc::new(route)));
                break;
            }
        }
    }
    Ok(out)
}

/// The part of the network that each settlement belongs to, as the id of one of its settlements.
fn parts<'a>(
    all: &[Arc<Settlement>],
    routes: impl Iterator<Item = &'a Arc<Route>>,
) -> BTreeMap<SettlementId, SettlementId> {
    let mut sets = DisjointSets::new();
    for route in routes {
        sets.union(route.ends[0].settlement, route.ends[1].settlement);
    }
    all.iter().map(|s| (s.id, sets.find(s.id))).collect()
}

/// Routes of the pairs among `tried` that the proximity rule keeps.
fn kept_routes(
    searches: &Searches,
    routes: &Routes,
    tier: SizeClass,
    tried: &[Pair],
    task: &NetworkTask<'_>,
) -> Result<Vec<Arc<Route>>, LayerError> {
    let what = format!("finding {} roads", class_of(tier).name());
    let keeps = task.each(&what, tried, |(a, b)| searches.proximity.keeps(a, b, &task.cancel))?;
    let mut pairs: Vec<Pair> = tried.iter().zip(keeps).filter(|(_, k)| *k).map(|(p, _)| p.clone()).collect();
    let mut out: Vec<Arc<Route>> = Vec::new();
    let corridor = searches.inputs.tier(tier).corridor;
    for wider in [1.0].into_iter().chain(WIDER) {
        let found =
            task.each(&what, &pairs, |(a, b)| routes.search(a, b, corridor * wider, Way::Usual, &task.cancel))?;
        let blocked: Vec<_> = pairs.iter().zip(&found).filter(|(_, f)| f.is_none()).map(|(p, _)| p.clone()).collect();
        out.extend(found.into_iter().flatten().map(Arc::new));
        pairs = blocked;
    }
    Ok(out)
}
