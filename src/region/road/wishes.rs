//! The user's edits of single roads: kept, routed through points, or banned.

use super::settings::RoadSettings;
use super::source::SettlementSource;
use super::tier::{beeline, tier_of};
use super::way_points::{NAMED, outside};
use crate::edits::{EditList, RejectedEdit, RoadEdit};
use crate::layer::LayerError;
use crate::region::settlement::{Settlement, SettlementId};
use crate::space::Bounds;
use crate::terrain::Terrain;
use glam::DVec2;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What the user wants of the road between two settlements.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Wish {
    Keep,
    /// Route the road through these points, in order from the settlement with the lower id.
    Via {
        points: Vec<DVec2>,
        /// Whether it is built whatever it costs.
        keep: bool,
    },
    Ban,
}

/// An edit of a road.
#[derive(Debug)]
struct Wished {
    wish: Wish,
    /// The settlements, the lower id first.
    ends: [Arc<Settlement>; 2],
    /// Index of the edit.
    index: usize,
}

/// All edits of roads, found by pair.
#[derive(Debug, Default)]
pub(super) struct Wishes(BTreeMap<(SettlementId, SettlementId), Wished>);

impl Wishes {
    /// Resolves checked edits. Also returns the edits that cannot be carried out.
    pub fn new(
        edits: &[RoadEdit],
        settings: &RoadSettings,
        terrain: &dyn Terrain,
        settlements: &dyn SettlementSource,
        domain: Option<Bounds>,
    ) -> (Self, Vec<RejectedEdit>) {
        let (mut out, mut rejected) = (Self::default(), Vec::new());
        for (index, edit) in edits.iter().enumerate() {
            let added = match resolve(edit, settings, terrain, settlements, domain) {
                Ok((ends, wish)) => out.add(index, ends, wish),
                Err(reason) => Err(reason),
            };
            if let Err(reason) = added {
                rejected.push(RejectedEdit { list: EditList::Roads, index, reason });
            }
        }
        (out, rejected)
    }

    fn add(&mut self, index: usize, ends: [Arc<Settlement>; 2], wish: Wish) -> Result<(), String> {
        let key = (ends[0].id, ends[1].id);
        if let Some(Wished { index: before, .. }) = self.0.get(&key) {
            return Err(format!("roads[{before}] already names these two settlements; a pair may have one edit"));
        }
        self.0.insert(key, Wished { wish, ends, index });
        Ok(())
    }

    /// The wish for the road of a pair.
    pub fn of(&self, a: &Settlement, b: &Settlement) -> Option<&Wish> {
        self.0.get(&(a.id.min(b.id), a.id.max(b.id))).map(|w| &w.wish)
    }

    /// Whether the user wants a road, so that it is searched whatever beelines say.
    pub fn wants(&self, a: &Settlement, b: &Settlement) -> bool {
        self.of(a, b).is_some_and(|w| *w != Wish::Ban)
    }

    /// Points that the road of a pair passes, in order from the settlement with the lower id.
    pub fn via(&self, a: &Settlement, b: &Settlement) -> &[DVec2] {
        match self.of(a, b) {
            Some(Wish::Via { points, .. }) => points,
            _ => &[],
        }
    }

    /// The roads that the user wants: the index of the edit, the settlements with the lower id first, and the wish.
    pub fn wanted(&self) -> impl Iterator<Item = (usize, &[Arc<Settlement>; 2], &Wish)> {
        self.0.values().filter(|w| w.wish != Wish::Ban).map(|w| (w.index, &w.ends, &w.wish))
    }
}

/// The settlement whose circle holds a point, or the way point there. Of several, the one with the nearest centre.
fn settlement_at(settlements: &dyn SettlementSource, p: DVec2) -> Result<Option<Arc<Settlement>>, LayerError> {
    let near = settlements.named_near(p)?;
    let apart = |s: &Settlement| s.centre.plan().distance(p);
    let holding = near.into_iter().filter(|s| apart(s) <= if s.radius > 0.0 { s.radius } else { NAMED });
    Ok(holding.min_by(|a, b| apart(a).total_cmp(&apart(b)).then(a.id.cmp(&b.id))))
}

/// The settlements of an edit, the lower id first, and the wish for their road; or the reason why it cannot be carried out.
fn resolve(
    edit: &RoadEdit,
    settings: &RoadSettings,
    terrain: &dyn Terrain,
    settlements: &dyn SettlementSource,
    domain: Option<Bounds>,
) -> Result<([Arc<Settlement>; 2], Wish), String> {
    let find = |p: DVec2| {
        let found = settlement_at(settlements, p).map_err(|e| e.to_string())?;
        found.ok_or_else(|| {
            format!("no settlement is at {},{}; name a point inside the circle of one, or a way point", p.x, p.y)
        })
    };
    let [from, to] = edit.ends();
    let (from, to) = (find(from)?, find(to)?);
    if from.id == to.id {
        return Err(format!("both ends lie in {}; a road joins two settlements", from.name));
    }
    let turned = to.id < from.id;
    let tier = settings.tier(tier_of(&from, &to));
    let apart = beeline(&from, &to);
    if !matches!(edit, RoadEdit::Ban { .. }) {
        if apart > tier.reach {
            let (from, to, reach) = (&from.name, &to.name, tier.reach);
            return Err(format!(
                "{from} and {to} are {apart:.0} m apart; roads of their class reach at most {reach} m"
            ));
        }
        if settlements.touch(&from, &to).map_err(|e| e.to_string())? {
            return Err(format!("{} and {} touch; a road needs land between its settlements", from.name, to.name));
        }
    }
    let wish = match edit {
        RoadEdit::Keep { .. } => Wish::Keep,
        RoadEdit::Ban { .. } => Wish::Ban,
        RoadEdit::Via { points, keep, .. } => {
            for p in points {
                if let Some(d) = domain.filter(|d| !d.contains(*p)) {
                    return Err(outside(*p, d));
                }
                if terrain.sample(*p).depth() > 0.0 {
                    return Err(format!("{},{} lies in water; roads pass points on land", p.x, p.y));
                }
                if let Some(s) = settlement_at(settlements, *p).map_err(|e| e.to_string())? {
                    return Err(format!("{},{} lies in {}; roads pass points between settlements", p.x, p.y, s.name));
                }
                let around = p.distance(from.centre.plan()) + p.distance(to.centre.plan());
                let most = tier.detour * apart;
                if around > most {
                    return Err(format!(
                        "the detour by {},{} is at least {around:.0} m long; at most {most:.0} m are allowed",
                        p.x, p.y
                    ));
                }
            }
            let mut points = points.clone();
            if turned {
                points.reverse();
            }
            Wish::Via { points, keep: *keep }
        }
    };
    Ok((if turned { [to, from] } else { [from, to] }, wish))
}
