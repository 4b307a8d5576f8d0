//! Patches that a style counts over a town, shared out over its main cells.

use super::pinned::PinnedPatch;
use super::prepared::PatchFiller;
use crate::space::stable_hash;
use crate::streets::filler::ShortCount;
use crate::style::Style;
use crate::town::CellId;
use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::sync::Arc;

/// A cell among which counted patches are shared out.
pub struct CountedCell {
    /// Its name.
    pub id: CellId,
    /// The styles that are mixed in it; the counts of each hold for all its cells in the town.
    pub styles: Vec<Arc<Style>>,
    /// What fills it.
    pub filler: PatchFiller,
}

impl CountedCell {
    fn has_style(&self, name: &str) -> bool {
        self.styles.iter().any(|style| style.name == name)
    }

    /// The patches of a name; patches of several sets may have the same one.
    fn named(&self, name: &str) -> Vec<usize> {
        let patches = self.filler.patches.patches.iter().enumerate();
        patches.filter(|(_, p)| p.name == name).map(|(i, _)| i).collect()
    }

    /// The patch of a name that may stand here: one that may be chosen, or that the only style of the cell counts.
    fn candidate(&self, name: &str) -> Option<usize> {
        let is_counted = matches!(&self.styles[..], [style] if style.count_of(name).is_some());
        self.named(name).into_iter().find(|patch| is_counted || self.filler.weights[*patch] > 0.0)
    }

    /// Number of patches of a name that are pinned here, by the user or for a count.
    fn pins(&self, name: &str) -> u32 {
        let is = |p: &&PinnedPatch| self.filler.patches.patches.get(p.patch).is_some_and(|p| p.name == name);
        self.filler.pinned.iter().filter(is).count() as u32
    }
}

/// The greatest number of patches of a name in the cells of a style, and how many are used there.
struct Limit<'a> {
    style: &'a str,
    most: u32,
    used: u32,
}

/// Lets the cells of a town use counted patches so often that the cells of each style keep to its counts: at most so many cells
/// may use one, once each, and of the `own` styles of the town at least so many have it pinned where `find` finds a place in a
/// cell. Which cells is drawn from their names. Returns what falls short of the least numbers.
pub fn share_out(
    own: &[&Style],
    cells: &mut [CountedCell],
    mut find: impl FnMut(usize, &PatchFiller, usize) -> Option<PinnedPatch>,
) -> Vec<ShortCount> {
    let mut styles: Vec<Arc<Style>> = cells.iter().flat_map(|cell| cell.styles.iter().cloned()).collect();
    styles.sort_by(|a, b| a.name.cmp(&b.name));
    styles.dedup_by(|a, b| a.name == b.name);
    let counted: BTreeSet<&str> = styles.iter().flat_map(|s| &s.patches).map(|count| &*count.patch).collect();
    let mut short = Vec::new();
    for name in counted {
        let pins = |style: &str, cells: &[CountedCell]| -> u32 {
            cells.iter().filter(|cell| cell.has_style(style)).map(|cell| cell.pins(name)).sum()
        };
        let limit = |style: &'_ Arc<Style>| style.count_of(name).and_then(|count| count.at_most);
        let mut limits: Vec<Limit<'_>> = styles
            .iter()
            .filter_map(|style| Some(Limit { style: &style.name, most: limit(style)?, used: pins(&style.name, cells) }))
            .collect();
        let word = stable_hash(&name.bytes().map(u64::from).collect::<Vec<_>>());
        let mut ranked: Vec<(usize, usize)> =
            (0..cells.len()).filter_map(|i| Some((i, cells[i].candidate(name)?))).collect();
        ranked.sort_by_key(|(i, _)| Reverse(stable_hash(&[cells[*i].id.0, word])));
        for style in styles.iter().filter(|style| own.iter().any(|own| own.name == style.name)) {
            let at_least = style.count_of(name).map_or(0, |count| count.at_least);
            let mut stands = pins(&style.name, cells);
            for &(i, patch) in &ranked {
                if stands >= at_least {
                    break;
                }
                let may_stand = cells[i].has_style(&style.name) && cells[i].pins(name) == 0;
                if may_stand
                    && limits.iter().all(|limit| limit.used < limit.most || !cells[i].has_style(limit.style))
                    && let Some(place) = find(i, &cells[i].filler, patch)
                {
                    cells[i].filler.pinned.push(place);
                    stands += 1;
                    limits.iter_mut().filter(|limit| cells[i].has_style(limit.style)).for_each(|limit| limit.used += 1);
                }
            }
            if stands < at_least {
                short.push(ShortCount { style: style.name.clone(), piece: name.into(), at_least, stands });
            }
        }
        for &(i, patch) in &ranked {
            let cell = &mut cells[i];
            let mut here: Vec<&mut Limit<'_>> = limits.iter_mut().filter(|limit| cell.has_style(limit.style)).collect();
            if here.is_empty() {
                continue;
            }
            let may_have = cell.pins(name) == 0 && here.iter().all(|limit| limit.used < limit.most);
            here.iter_mut().for_each(|limit| limit.used += u32::from(may_have));
            cell.filler.once[patch] = true;
            for other in cell.named(name).into_iter().filter(|other| !may_have || *other != patch) {
                cell.filler.weights[other] = 0.0;
            }
        }
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layer::Cancel;
    use crate::patch::{PatchDatabase, PatchSet};
    use crate::streets::filler::{CellFiller, StreetOrigin};
    use crate::testing::{PortCell, styles};

    /// A comb along a main street, as a patch and as a pattern that repeats it.
    const COMB: &str = "(
        patches: [(name: \"tooth\", vertices: [(-30, 0), (0, 0), (30, 0), (0, 70)], main: [[0, 1, 2]], streets: [(1, 3)])],
        patterns: [(name: \"comb\", element: \"tooth\", scale: (0.6, 2), repeat: (3, 8))],
    )";

    #[test]
    fn no_town_has_more_of_a_patch_than_its_styles_allow() {
        let set = PatchSet::from_ron("q.ron", COMB).expect("a valid set");
        // A second set has a patch of the same name.
        let patches = Arc::new(PatchDatabase::new(&[&set, &set], &[], &[]));
        let style = |at_most: &str| {
            let count = format!("(patches: [(patch: \"tooth\", at_most: {at_most})])");
            Style::from_ron("s.ron", &count).expect("a valid style")
        };
        let samples = styles();
        for (at_most, limited) in [("Some(0)", 0), ("Some(2)", 2), ("Some(5)", 5), ("None", usize::MAX)] {
            let counting = Arc::new(style(at_most));
            let briefs: Vec<PortCell<'_>> = (0..12).map(|seed| PortCell::new(700 + seed, &samples)).collect();
            let cell = |id: u64| {
                let mut filler = PatchFiller::new(patches.clone(), patches.weights());
                filler.start.patterns_along = 1.0;
                CountedCell { id: CellId(id), styles: vec![counting.clone()], filler }
            };
            let mut cells: Vec<CountedCell> = (0..12).map(cell).collect();
            assert_eq!(share_out(&[&counting], &mut cells, |_, _, _| None), []);
            let mut used = 0;
            for (cell, sample) in cells.iter().zip(&briefs) {
                let out = cell.filler.fill(&sample.brief(), &Cancel::new()).expect("nobody cancels");
                let teeth = |s: &&crate::streets::LocalStreet| matches!(s.made_by.origin, StreetOrigin::Piece(_));
                used += out.streets.iter().filter(teeth).count();
            }
            // A tooth is one street, and is cut into more where others meet it.
            assert!(if limited == 0 { used == 0 } else { used > 0 }, "{at_most}: {used}");
            assert!(limited == usize::MAX || used <= 3 * limited, "{used} streets of at most {limited} patches");
            assert!(limited < usize::MAX || used > 20, "{used} streets");
        }
    }

    #[test]
    fn the_counts_of_each_style_hold_for_its_own_cells_and_what_cannot_hold_is_said() {
        let set = PatchSet::from_ron("q.ron", COMB).expect("a valid set");
        let patches = Arc::new(PatchDatabase::new(&[&set], &[], &[]));
        let style = |name: &str, count: &str| {
            let text = format!("(patches: [(patch: \"tooth\", {count})])");
            Arc::new(Style::from_ron(&format!("{name}.ron"), &text).expect("a valid style"))
        };
        let (own, foreign) = (style("own", "at_least: 5, at_most: 6"), style("foreign", "at_most: 1"));
        // Two cells at the border are mixed of both styles.
        let mixed = |id: u64| if id < 2 { vec![own.clone(), foreign.clone()] } else { vec![own.clone()] };
        let cells = |count: u64| -> Vec<CountedCell> {
            let filler = || PatchFiller::new(patches.clone(), patches.weights());
            (0..count).map(|id| CountedCell { id: CellId(id), styles: mixed(id), filler: filler() }).collect()
        };
        let place = PinnedPatch { patch: 0, at: glam::DVec2::ZERO, turned: 0.0, mirrored: false, piece: None };
        let of = |cells: &[CountedCell], style: &str| -> (usize, usize) {
            let here = || cells.iter().filter(|cell| cell.has_style(style));
            (here().filter(|c| c.pins("tooth") > 0).count(), here().filter(|c| c.filler.weights[0] > 0.0).count())
        };
        let mut ten = cells(10);
        assert_eq!(share_out(&[&own], &mut ten, |_, _, _| Some(place)), []);
        let (pinned, chosen) = of(&ten, "own");
        assert_eq!((pinned, pinned + chosen), (5, 6));
        let (pinned, chosen) = of(&ten, "foreign");
        assert!(pinned + chosen <= 1, "{pinned} pinned and {chosen} chosen");

        // The other style leaves room in one of the two mixed cells.
        let mut four = cells(4);
        let short = [ShortCount { style: "own".into(), piece: "tooth".into(), at_least: 5, stands: 3 }];
        assert_eq!(share_out(&[&own], &mut four, |_, _, _| Some(place)), short);
        assert_eq!((of(&four, "own"), of(&four, "foreign")), ((3, 0), (1, 0)));
        let nowhere = share_out(&[&own], &mut cells(9), |_, _, _| None);
        assert_eq!(nowhere, [ShortCount { stands: 0, ..short[0].clone() }]);
        // What another town's style asks for is not asked of this town.
        assert_eq!(share_out(&[&foreign], &mut cells(9), |_, _, _| None), []);
    }
}
