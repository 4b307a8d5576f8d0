//! Which pairs of settlements are worth a search for a road.
//!
//! The proximity rule needs the cost of a pair's road. Most pairs need none, because beelines already tell that the rule
//! will drop them. What is left is bounded by the number of neighbours, as in Galin 2011, section 5.2, not by the area within
//! reach.

use super::budget::Budget;
use super::inputs::Inputs;
use super::proximity::rules_out;
use super::tier::{beeline, tier_of};
use super::tier_settings::TierSettings;
use crate::layer::{LayerCache, LayerError, Reach, Weigh};
use crate::network::SizeClass;
use crate::region::settlement::{Settlement, SettlementId};
use crate::space::Bounds;
use std::sync::Arc;

/// A pair is not tried if a third settlement would rule it out by beelines even if the pair's road were this share of its
/// beeline. A detour makes a road dearer than its beeline, but that alone could never save such a pair.
const HOPELESS: f64 = 0.87;
/// Nor is it tried if more settlements than these are nearer to both ends than the ends are to each other. On open ground they
/// are two fifths of all settlements within that distance of one end. The paper tries the 20 nearest.
pub(super) const MOST_BETWEEN: usize = 20;

/// The settlements with which a settlement may share a road of a tier, sorted by id.
struct Held(Vec<Arc<Settlement>>);

impl Weigh for Held {
    fn bytes(&self) -> usize {
        size_of::<Self>() + self.0.len() * size_of::<Arc<Settlement>>()
    }
}

/// The pairs that are worth a search, by settlement.
pub(super) struct Partners {
    inputs: Arc<Inputs>,
    held: LayerCache<(u8, SettlementId), Held>,
}

/// The settlements among `others` with which `a` makes a pair that is worth a search, in their order. `others` are all
/// settlements of the tier or above that may lie nearer to both ends of a pair than these to each other.
pub(super) fn worth_a_search(
    t: &TierSettings,
    a: &Settlement,
    others: &[Arc<Settlement>],
    fits: impl Fn(&Settlement) -> bool,
) -> Vec<Arc<Settlement>> {
    let mut near: Vec<(f64, usize)> = others.iter().enumerate().map(|(i, c)| (beeline(a, c), i)).collect();
    near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    let mut found: Vec<usize> = Vec::new();
    for (rank, (ab, i)) in near.iter().enumerate() {
        let b = &others[*i];
        if b.id == a.id || !fits(b) {
            continue;
        }
        let mut between = 0;
        let hopeless = near[..rank].iter().filter(|(ac, c)| *ac < *ab && others[*c].id != a.id).any(|(ac, c)| {
            let bc = beeline(b, &others[*c]);
            between += usize::from(bc < *ab);
            between > MOST_BETWEEN || rules_out(*ac, bc, ab * HOPELESS, t.gamma)
        });
        if !hopeless {
            found.push(*i);
        }
    }
    found.sort_unstable();
    found.into_iter().map(|i| others[i].clone()).collect()
}

impl Partners {
    pub fn new(inputs: Arc<Inputs>, budget: Budget) -> Self {
        Self { inputs, held: budget.cache(1) }
    }

    /// The settlements within the reach of a tier from `a` with which it makes a pair of that tier that is worth a search or
    /// that the user wants, sorted by id.
    pub fn of(&self, tier: SizeClass, a: &Settlement) -> Result<Vec<Arc<Settlement>>, LayerError> {
        let held = self.held.get(&(tier as u8, a.id), || {
            let inputs = &*self.inputs;
            let t = inputs.tier(tier);
            let read = Reach::new("roads", Bounds::of([a.centre.plan()]), t.reach).bounds();
            let mut others = inputs.settlements.centred_in(read, tier)?;
            others.retain(|b| beeline(a, b) <= t.reach);
            let of_tier = |b: &Settlement| tier_of(a, b) == tier;
            let mut out = worth_a_search(t, a, &others, of_tier);
            others.retain(|b| b.id != a.id && of_tier(b) && inputs.wishes.wants(a, b));
            out.extend(others);
            out.sort_by_key(|b| b.id);
            out.dedup_by_key(|b| b.id);
            Ok(Held(out))
        })?;
        Ok(held.0.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::road::settings::RoadSettings;
    use crate::space::{Origin, Seed};
    use glam::DVec2;

    /// Villages at random in a square of 100 km.
    fn villages(count: usize) -> Vec<Arc<Settlement>> {
        let mut random = Seed(3).stream("test", &[]);
        let mut one = |i: usize| {
            let at = DVec2::new(random.unit(), random.unit()) * 100_000.0;
            let (id, size) = (SettlementId(i as u64 + 1), SizeClass::Village);
            let (style, name) = (String::new(), String::new());
            Arc::new(Settlement { id, centre: Origin::at(at), radius: 200.0, size, style, name })
        };
        (0..count).map(&mut one).collect()
    }

    #[test]
    fn the_number_of_pairs_follows_the_number_of_settlements() {
        for gamma in [1.01, 1.2, 2.0, 20.0] {
            let t = TierSettings { gamma, ..RoadSettings::default().minor };
            let mean = |count: usize| {
                let all = villages(count);
                let pairs: Vec<_> = all.iter().map(|a| worth_a_search(&t, a, &all, |_| true)).collect();
                for (a, of) in all.iter().zip(&pairs) {
                    let back = |b: &Arc<Settlement>| pairs[b.id.0 as usize - 1].iter().any(|c| c.id == a.id);
                    assert!(of.iter().all(back), "a pair is tried from one end only");
                }
                pairs.iter().map(Vec::len).sum::<usize>() as f64 / count as f64
            };
            let (few, many) = (mean(120), mean(480));
            assert!(many < 60.0 && many < few * 1.5, "{gamma}: {few} {many}");
        }
    }

    #[test]
    fn water_without_settlements_keeps_far_pairs() {
        // Two rows of villages at the shores of a wide strait.
        let place = |i: usize| DVec2::new(1_000.0 * (i / 2) as f64, if i.is_multiple_of(2) { 0.0 } else { 4_000.0 });
        let all: Vec<_> = (0..40)
            .map(|i| {
                let mut s = (*villages(1)[0]).clone();
                (s.id, s.centre) = (SettlementId(i as u64 + 1), Origin::at(place(i)));
                Arc::new(s)
            })
            .collect();
        let t = RoadSettings::default().minor;
        let found = worth_a_search(&t, &all[20], &all, |_| true);
        assert!(found.iter().any(|b| b.id == all[21].id) && found.len() < 12, "{}", found.len());
    }
}
