//! Styles with their patches, and what they become in a main cell: the style of the centre, that of the fringe, and those of
//! towns across a border, mixed by where the cell lies.

use crate::layer::{LayerCache, LayerError, Weigh};
use crate::patch::{Patch, PatchDatabase, PatchSet};
use crate::region::{Border, Outline, Settlement};
use crate::space::{Origin, Seed, distance_to_line};
use crate::streets::PinnedPatch;
use crate::style::Style;
use crate::town::CellId;
use glam::DVec2;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

/// Distance from a border, in metres, within which the styles on both sides mix.
pub const BORDER_BLEND: f64 = 400.0;
/// Styles with a smaller share of a cell than this are left out.
const LEAST_SHARE: f64 = 0.04;
/// Memory for the patches of mixed styles, in bytes.
const POOL_BYTES: usize = 32 << 20;

/// A style with the patches that it may use.
#[derive(Clone, Debug)]
pub struct StyleKit {
    /// The style.
    pub style: Arc<Style>,
    /// Its patch sets.
    pub sets: Vec<Arc<PatchSet>>,
    /// Its patches: those of the sets that its tags leave.
    pub patches: Arc<PatchDatabase>,
    /// The weight of each.
    pub weights: Vec<f64>,
}

impl StyleKit {
    /// A style with its patch sets, in the order in which it names them.
    pub fn new(style: Arc<Style>, sets: Vec<Arc<PatchSet>>) -> Self {
        let used: Vec<&PatchSet> = sets.iter().map(|s| &**s).collect();
        let mut patches = PatchDatabase::new(&used, &style.allow, &style.exclude);
        cap(&mut patches, &[&style]);
        let weights = patches.patches.iter().map(|p| style.weight_of(p)).collect();
        Self { style, sets, patches: Arc::new(patches), weights }
    }
}

/// Patches of which a town has at most so many are used once in a cell.
fn cap(patches: &mut PatchDatabase, styles: &[&Style]) {
    let counts = || styles.iter().flat_map(|s| &s.patches).filter(|c| c.at_most.is_some());
    for patch in &mut patches.patches {
        if patch.at_most != Some(1) && counts().any(|c| c.patch == patch.name) {
            Arc::make_mut(patch).at_most = Some(1);
        }
    }
}

/// What the main cell of a town is filled with.
#[derive(Clone, Debug)]
pub struct CellStyle {
    /// The style of this cell.
    pub style: Arc<Style>,
    /// The patches that streets of the cell are made of.
    pub patches: Arc<PatchDatabase>,
    /// Weight of each of them here.
    pub weights: Vec<f64>,
    /// Patches that stand in the cell in any case.
    pub pinned: Vec<PinnedPatch>,
    /// For the first of `pinned`, those that the user wants: its place in the list of edits.
    pub edits: Vec<usize>,
}

/// Names of styles, in order, with their shares, which sum to 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Blend(Vec<(String, f64)>);

impl Blend {
    fn of(mut shares: Vec<(String, f64)>) -> Self {
        shares.sort_by(|a, b| a.0.cmp(&b.0));
        let mut merged: Vec<(String, f64)> = Vec::new();
        for (name, share) in shares {
            match merged.last_mut() {
                Some(last) if last.0 == name => last.1 += share,
                _ => merged.push((name, share)),
            }
        }
        merged.retain(|(_, share)| *share >= LEAST_SHARE);
        let sum: f64 = merged.iter().map(|(_, share)| share).sum();
        merged.iter_mut().for_each(|(_, share)| *share /= sum);
        Self(merged)
    }
}

/// A town as its styles are spread over it.
pub(super) struct Spread<'a> {
    style: &'a Style,
    origin: Origin,
    /// Radius of the circle with the outline's area.
    radius: f64,
}

impl Spread<'_> {
    /// Shares of the styles of this town alone at a place local to it, times `share`.
    fn shares(&self, at: DVec2, share: f64, out: &mut Vec<(String, f64)>) {
        let outer = self.style.fringe_share(at.length() / self.radius);
        out.push((self.style.name.clone(), share * (1.0 - outer)));
        if let Some(fringe) = &self.style.fringe {
            out.push((fringe.style.clone(), share * outer));
        }
    }

    /// Shares of the styles at a place local to this town; `across` has the towns that it touches.
    pub fn blend(&self, at: DVec2, across: &[(Spread<'_>, Arc<Border>)]) -> Blend {
        let near = |border: &Border| {
            let distance = distance_to_line(at + self.origin.offset_to(border.origin), &border.line);
            0.5 * (1.0 - distance / BORDER_BLEND).max(0.0)
        };
        let theirs: Vec<f64> = across.iter().map(|(_, border)| near(border)).collect();
        // Where three towns meet no more than two thirds are those of others.
        let scale = 1.0 / (0.5 + theirs.iter().sum::<f64>()).max(1.0);
        let mut out = Vec::new();
        let mut own = 1.0;
        for ((town, _), share) in across.iter().zip(theirs).filter(|(_, share)| *share > 0.0) {
            own -= share * scale;
            town.shares(at + self.origin.offset_to(town.origin), share * scale, &mut out);
        }
        self.shares(at, own, &mut out);
        Blend::of(out)
    }
}

/// The patches that several styles use, with the set that each is from.
struct Pool {
    patches: Arc<PatchDatabase>,
    sets: Vec<String>,
}

impl Weigh for Pool {
    fn bytes(&self) -> usize {
        self.patches.patches.iter().map(|p| 1000 + 200 * p.vertices.len()).sum()
    }
}

/// All styles and patch sets of a world.
pub(super) struct Kits {
    styles: BTreeMap<String, StyleKit>,
    sets: BTreeMap<String, Arc<PatchSet>>,
    /// By names of styles, and of patch sets besides theirs.
    pools: LayerCache<(Vec<String>, Vec<String>), Pool>,
}

impl Kits {
    pub fn new(styles: BTreeMap<String, StyleKit>, sets: BTreeMap<String, Arc<PatchSet>>) -> Self {
        Self { styles, sets, pools: LayerCache::new(POOL_BYTES) }
    }

    pub fn of(&self, style: &str) -> Result<&StyleKit, LayerError> {
        self.styles.get(style).ok_or_else(|| LayerError::UnknownStyle(style.to_owned()))
    }

    /// How the styles of a settlement are spread.
    pub fn spread(&self, settlement: &Settlement, outline: &Outline) -> Result<Spread<'_>, LayerError> {
        let style = &self.of(&settlement.style)?.style;
        Ok(Spread { style, origin: outline.origin, radius: (outline.area() / PI).sqrt() })
    }

    /// The patch set that has a patch: one of those of a blend's styles if there is one, else the first by name.
    pub fn set_with(&self, blend: &Blend, patch: &str) -> Option<&Arc<PatchSet>> {
        let has = |set: &&Arc<PatchSet>| set.patches.iter().any(|p| p.name == patch);
        let own = blend.0.iter().filter_map(|(name, _)| self.styles.get(name)).flat_map(|kit| &kit.sets);
        own.chain(self.sets.values()).find(has)
    }

    /// Whether any patch set has a patch of a name.
    pub fn has_patch(&self, patch: &str) -> bool {
        self.sets.values().any(|set| set.patches.iter().any(|p| p.name == patch))
    }

    /// What a main cell with a blend of styles is filled with; the patches hold those of the sets `also`, too.
    pub fn mix(&self, seed: Seed, cell: CellId, blend: &Blend, also: &[String]) -> Result<CellStyle, LayerError> {
        let mut shares = Vec::with_capacity(blend.0.len());
        for (name, share) in &blend.0 {
            shares.push((self.of(name)?, *share));
        }
        if let ([(kit, _)], []) = (&shares[..], also) {
            let (style, patches, weights) = (kit.style.clone(), kit.patches.clone(), kit.weights.clone());
            return Ok(CellStyle { style, patches, weights, pinned: Vec::new(), edits: Vec::new() });
        }
        let key = (blend.0.iter().map(|(name, _)| name.clone()).collect(), also.to_vec());
        let pool = self.pools.get(&key, || Ok(self.pool(&shares, also)))?;
        // The choices of a cell are drawn in the order of the styles' names, whatever their shares.
        let mut stream = seed.stream("style", &[cell.0]);
        let (mut sum, mut style): (f64, Option<Arc<Style>>) = (0.0, None);
        for (kit, share) in &shares {
            sum += share;
            style = Some(match style {
                Some(before) => Arc::new(Style::mix(&before, &kit.style, share / sum, &mut stream)),
                None => kit.style.clone(),
            });
        }
        let weight = |(patch, set): (&Arc<Patch>, &String)| {
            let of = |(kit, share): &(&StyleKit, f64)| {
                let uses = kit.style.patch_sets.contains(set);
                if uses { share * kit.style.weight_of(patch) } else { 0.0 }
            };
            shares.iter().map(of).sum()
        };
        Ok(CellStyle {
            style: style.unwrap_or_default(),
            weights: pool.patches.patches.iter().zip(&pool.sets).map(weight).collect(),
            patches: pool.patches.clone(),
            pinned: Vec::new(),
            edits: Vec::new(),
        })
    }

    fn pool(&self, shares: &[(&StyleKit, f64)], also: &[String]) -> Pool {
        let mut sets: BTreeMap<&str, &PatchSet> = BTreeMap::new();
        for set in shares.iter().flat_map(|(kit, _)| &kit.sets).chain(also.iter().filter_map(|s| self.sets.get(s))) {
            sets.insert(&set.name, set);
        }
        let of = |(name, set): (&&str, &&PatchSet)| std::iter::repeat_n((*name).to_owned(), set.patches.len());
        let names = sets.iter().flat_map(of).collect();
        let mut patches = PatchDatabase::new(&sets.values().copied().collect::<Vec<_>>(), &[], &[]);
        cap(&mut patches, &shares.iter().map(|(kit, _)| &*kit.style).collect::<Vec<_>>());
        Pool { patches: Arc::new(patches), sets: names }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::StreetClass;
    use crate::region::SettlementId;
    use crate::style::FringeRules;

    #[test]
    fn styles_of_towns_that_touch_meet_in_equal_shares_on_their_border() {
        let style = |name: &str, fringe: &str| Style {
            name: name.into(),
            fringe: Some(FringeRules { style: fringe.into(), begins: 0.6, complete: 1.1 }),
            ..Style::default()
        };
        let (a, b) = (style("a", "c"), style("b", "d"));
        let origins = [Origin::at(DVec2::ZERO), Origin::at(DVec2::new(1300.0, 200.0))];
        let spread = |i: usize| Spread { style: [&a, &b][i], origin: origins[i], radius: 700.0 };
        let border = Arc::new(Border {
            origin: Origin::at(DVec2::new(650.0, 100.0)),
            sides: [SettlementId(1), SettlementId(2)],
            line: vec![DVec2::new(60.0, -400.0), DVec2::new(-10.0, 0.0), DVec2::new(-60.0, 400.0)],
            gates: vec![1],
            class: StreetClass::Arterial,
        });
        let blend =
            |i: usize, plan: DVec2| spread(i).blend(origins[i].to_local(plan), &[(spread(1 - i), border.clone())]);
        for p in &border.line {
            let plan = border.origin.to_plan(*p);
            let (here, there) = (blend(0, plan), blend(1, plan));
            assert_eq!(here.0.len(), there.0.len());
            for (x, y) in here.0.iter().zip(&there.0) {
                assert!(x.0 == y.0 && (x.1 - y.1).abs() < 1e-9, "{here:?} {there:?}");
            }
        }
        // It fades with the distance, and ends.
        let share = |x: f64, of: &str| {
            let blend = blend(0, DVec2::new(x, 0.0));
            blend.0.iter().filter(|(name, _)| name == of).map(|(_, s)| *s).sum::<f64>()
        };
        let own: Vec<f64> = (0..8).map(|i| share(600.0 - 100.0 * f64::from(i), "b")).collect();
        assert!(own.windows(2).all(|w| w[1] <= w[0] + 1e-12), "{own:?}");
        assert_eq!((share(0.0, "a"), share(0.0, "b")), (1.0, 0.0));
        let sum: f64 = blend(0, DVec2::new(500.0, 90.0)).0.iter().map(|(_, s)| s).sum();
        assert!((sum - 1.0).abs() < 1e-12);
    }
}
