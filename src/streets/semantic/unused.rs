//! What is never laid of the patches and patterns of a set, and why: in cells of one style, or whatever the style asks.

use super::filler::{left_out_by, weight_of};
use super::pattern::OF_SCALE;
use super::start::STRETCHED;
use crate::patch::{DrawingRules, Flaw, Patch, PatchDatabase, STRETCH};
use crate::streets::cell::drawing_rules;
use crate::style::Style;
use glam::DVec2;
use std::fmt;

/// How many times as large as those that were measured other cells may be.
const LARGER: f64 = 1.25;

/// The size of a shape: what decides whether one shape has room in another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// Greatest distance between two of its points, in metres.
    pub across: f64,
    /// Distance in metres between the nearest two parallel lines that have the shape between them.
    pub width: f64,
}

impl Extent {
    /// The extent of some points.
    pub fn of(points: &[DVec2]) -> Self {
        let pairs = || points.iter().enumerate().flat_map(|(i, a)| points[..i].iter().map(move |b| *a - *b));
        let across = pairs().map(DVec2::length).fold(0.0, f64::max);
        // The nearest two lines lie along a side of the hull.
        let between = |along: DVec2| {
            let off = points.iter().map(|p| along.perp_dot(*p));
            let (low, high) = off.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            (high - low) / along.length()
        };
        let width = pairs().filter(|p| *p != DVec2::ZERO).map(between).fold(f64::INFINITY, f64::min);
        Self { across, width: if width.is_finite() { width } else { 0.0 } }
    }

    /// The extent of a shape `scale` times as large.
    pub fn scaled(self, scale: f64) -> Self {
        Self { across: self.across * scale, width: self.width * scale }
    }

    /// Whether a shape of this extent may have room in a cell like one of the other extent.
    fn may_lie_in(self, cell: &Self) -> bool {
        self.across <= LARGER * cell.across && self.width <= LARGER * cell.width
    }
}

impl fmt::Display for Extent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.0} m by {:.0} m", self.across, self.width)
    }
}

/// The cells of a style that patches are held against.
#[derive(Clone, Copy, Debug)]
pub struct StyleCells<'a> {
    /// The style.
    pub style: &'a Style,
    /// The extents of its main cells; none if they are not known.
    pub cells: &'a [Extent],
}

/// Why a patch or pattern is never laid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NeverLaid {
    /// The weight is 0, in the set or in the style.
    #[error("its weight is 0; allowed is more")]
    Weight,
    /// It may be used 0 times at most.
    #[error("`at_most` is 0; allowed is 1 or more")]
    AtMost,
    /// The tags of the style leave it out.
    #[error("{0}")]
    Tags(String),
    /// The drawing breaks a rule.
    #[error("{0}")]
    Flaw(Flaw),
    /// The patch has no end and stands in no pattern along a main street.
    #[error("it has no end at which the network goes on, and no pattern repeats it along a main street")]
    NothingToConnect,
    /// No main cell has room.
    #[error("it measures {least} at least, without what can be cut back, and the largest main cell {largest}")]
    TooLarge {
        /// Its least extent, without arms, which may be cut back.
        least: Extent,
        /// The extent of the cell that is largest across.
        largest: Extent,
    },
    /// The style lays no pattern of this kind.
    #[error("{0}")]
    NoPatterns(&'static str),
    /// The element of the pattern is never laid.
    #[error("patch `{0}`, its element, is never laid: {1}")]
    Element(String, Box<NeverLaid>),
}

impl NeverLaid {
    /// Path in the file from the patch or pattern to what is at fault.
    pub fn path(&self) -> String {
        match self {
            Self::Weight => "weight".into(),
            Self::AtMost => "at_most".into(),
            Self::Tags(_) => "tags".into(),
            Self::Flaw(Flaw::Crowded { at, .. } | Flaw::Sharp { at, .. }) => format!("vertices[{at}]"),
            Self::Flaw(Flaw::Short { from, .. }) => format!("vertices[{from}]"),
            Self::Flaw(Flaw::Near { one, .. }) => format!("vertices[{}]", one.0),
            Self::NothingToConnect | Self::NoPatterns(_) => "name".into(),
            // A pattern has a scale, and a patch has vertices; what is not written leads to the whole.
            Self::TooLarge { .. } => "scale".into(),
            Self::Element(..) => "element".into(),
        }
    }
}

/// Why the patch at an index of a set is never laid but where it is pinned; `None` if it may be. Without a style, what no style can
/// change. `set` has the patches and patterns of one set, all of them.
pub fn patch_never_laid(set: &PatchDatabase, patch: usize, style: Option<StyleCells<'_>>) -> Option<NeverLaid> {
    let drawn = &set.patches[patch];
    let count = style.and_then(|s| s.style.count_of(&drawn.name));
    // What stands in any case is not chosen, and keeps to no more than every drawing does.
    if let Some(StyleCells { style, .. }) = style
        && count.is_some_and(|c| c.at_least > 0)
    {
        let tags = left_out_by(style, drawn).map(NeverLaid::Tags);
        return tags.or_else(|| drawn.flaw(&DrawingRules::NONE).map(NeverLaid::Flaw));
    }
    let element = unfit_as_element(set, patch, style);
    if element.is_some() {
        return element;
    }
    let facts = set.facts(patch);
    if drawn.connectables.is_empty() {
        let stands = |i: usize| {
            let entry = &set.patterns()[i];
            entry.element == patch && facts.main.is_some() && pattern_never_laid(set, i, style).is_none()
        };
        return (!(0..set.patterns().len()).any(stands)).then_some(NeverLaid::NothingToConnect);
    }
    let least = if facts.main.is_some() { *STRETCHED.start() } else { 1.0 - STRETCH };
    too_large(core(set, patch).scaled(least), style)
}

/// Why the pattern at an index of a set is never laid, as [`patch_never_laid`].
pub fn pattern_never_laid(set: &PatchDatabase, pattern: usize, style: Option<StyleCells<'_>>) -> Option<NeverLaid> {
    let entry = &set.patterns()[pattern];
    if let Some(why) = unfit_as_element(set, entry.element, style) {
        return Some(NeverLaid::Element(entry.pattern.element.clone(), Box::new(why)));
    }
    let is_along = set.facts(entry.element).main.is_some();
    if let Some(StyleCells { style: Style { start, .. }, .. }) = style {
        if is_along && start.patterns_along == 0.0 {
            return Some(NeverLaid::NoPatterns("`start.patterns_along` is 0; allowed is more"));
        }
        if !is_along && start.patterns_between == 0.0 && start.patterns_onwards == 0.0 {
            let none = "`start.patterns_between` and `start.patterns_onwards` are 0; allowed is more of one";
            return Some(NeverLaid::NoPatterns(none));
        }
    }
    let least = entry.pattern.scale.0 * if is_along { OF_SCALE.0 } else { 1.0 };
    too_large(core(set, entry.element).scaled(least), style)
}

/// Why a patch is neither chosen nor repeated by a pattern, whatever it can be connected to and however large it is.
fn unfit_as_element(set: &PatchDatabase, patch: usize, style: Option<StyleCells<'_>>) -> Option<NeverLaid> {
    let drawn = &set.patches[patch];
    if let Some(StyleCells { style, .. }) = style
        && let Some(tags) = left_out_by(style, drawn)
    {
        return Some(NeverLaid::Tags(tags));
    }
    if drawn.weight == 0.0 || style.is_some_and(|s| weight_of(s.style, drawn) == 0.0) {
        return Some(NeverLaid::Weight);
    }
    let limited = |s: StyleCells<'_>| s.style.count_of(&drawn.name).is_some_and(|c| c.at_most == Some(0));
    if drawn.at_most == Some(0) || style.is_some_and(limited) {
        return Some(NeverLaid::AtMost);
    }
    let rules = style.map_or(DrawingRules::NONE, |s| drawing_rules(&s.style.local));
    drawn.flaw(&rules).map(NeverLaid::Flaw)
}

/// The extent of the part of a patch that is not cut back.
fn core(set: &PatchDatabase, patch: usize) -> Extent {
    let (drawn, shape): (&Patch, _) = (&set.patches[patch], &set.facts(patch).shape);
    let inner = shape.arms.iter().map(|arm| arm[0]).filter(|v| !shape.is_end[*v]);
    let mut vertices: Vec<usize> = shape.core.iter().flat_map(|e| [e.0, e.1]).chain(inner).collect();
    vertices.sort_unstable();
    vertices.dedup();
    Extent::of(&vertices.into_iter().map(|v| drawn.vertices[v]).collect::<Vec<_>>())
}

/// The defect of what has this least extent, if no cell of the style has room for it.
fn too_large(least: Extent, style: Option<StyleCells<'_>>) -> Option<NeverLaid> {
    let cells = style?.cells;
    let largest = cells.iter().copied().reduce(|a, b| if b.across > a.across { b } else { a })?;
    (!cells.iter().any(|cell| least.may_lie_in(cell))).then_some(NeverLaid::TooLarge { least, largest })
}

#[cfg(test)]
mod tests {
    use super::super::tests::Kit;
    use super::*;
    use crate::patch::PatchSet;
    use crate::style::Filler;
    use crate::testing::{PortCell, all_styles, patch_sets};
    use std::collections::BTreeMap;
    use std::sync::Arc;

    /// Cells of each style.
    const CELLS: u64 = 200;

    /// A cell of the kit's style, as large as its main streets make them.
    fn cell(kit: &Kit, seed: u64) -> PortCell<'_> {
        let times = (kit.style.main.length / 230.0).max(1.0);
        PortCell::sized(7000 + seed, std::slice::from_ref(&kit.style), times)
    }

    /// How often each patch was laid in many cells of a style, by `set/patch`, and the extents of these cells.
    fn laid(kit: &Kit) -> (BTreeMap<String, u32>, Vec<Extent>) {
        let (mut laid, mut cells) = (BTreeMap::new(), Vec::new());
        for seed in 0..CELLS {
            let cell = cell(kit, seed);
            cells.push(Extent::of(&cell.border));
            for (name, uses) in kit.fill(&cell).laid {
                *laid.entry(name.to_string()).or_insert(0) += uses;
            }
        }
        (laid, cells)
    }

    /// Whether a patch is laid in any of many cells if it has no rivals.
    fn is_laid_alone(kit: &Kit, name: &str) -> bool {
        let mut filler = kit.filler.clone();
        let names = filler.patches.names().to_vec();
        filler.weights = names.iter().map(|other| f64::from(u8::from(**other == *name))).collect();
        let kit = Kit { style: kit.style.clone(), filler };
        (0..CELLS).any(|seed| kit.fill(&cell(&kit, CELLS + seed)).laid.iter().any(|(laid, _)| **laid == *name))
    }

    /// Patches of the kit's sets as `set/patch`, each with how often it was laid and why it never is.
    fn judged(kit: &Kit, sets: &BTreeMap<String, Arc<PatchSet>>) -> Vec<(String, u32, Option<NeverLaid>)> {
        let (laid, cells) = laid(kit);
        let style = StyleCells { style: &kit.style, cells: &cells };
        let mut out = Vec::new();
        for set in kit.style.patch_sets.iter().map(|name| &sets[name]) {
            let database = PatchDatabase::new(&[set], &[], &[]);
            for (i, patch) in set.patches.iter().enumerate() {
                let name = format!("{}/{}", set.name, patch.name);
                let uses = laid.get(&name).copied().unwrap_or_default();
                out.push((name, uses, patch_never_laid(&database, i, Some(style))));
            }
        }
        out
    }

    #[test]
    fn what_is_said_of_bundled_patches_is_what_happens() {
        let mut styles = all_styles();
        styles.retain(|style| style.filler == Filler::SemanticPatches);
        let sets = patch_sets(&styles);
        let (mut wrong, mut never, mut rare) = (Vec::new(), 0, 0);
        for style in styles {
            let kit = Kit::new(style, &sets);
            for (name, uses, why) in judged(&kit, &sets) {
                let fits = match &why {
                    Some(_) => uses == 0,
                    None => uses > 0 || is_laid_alone(&kit, &name),
                };
                never += usize::from(why.is_some());
                rare += usize::from(why.is_none() && uses == 0);
                if !fits {
                    wrong.push(format!("{}: {name} was laid {uses} times: {why:?}", kit.style.name));
                }
            }
        }
        assert!(wrong.is_empty(), "{rare} rare\n{}", wrong.join("\n"));
        assert!(never > 20, "{never} patches are never laid in a style");
    }

    #[test]
    fn what_can_never_be_laid_never_is() {
        let ring = "vertices: [(0, 0), (80, 0), (80, 80), (0, 80)], streets: [[0, 1, 2, 3, 0]]";
        let fork =
            "vertices: [(0, 0), (60, 0), (-45, 60), (-45, -60), (-70, 0)], streets: [(0, 1), (0, 2), (0, 3), (0, 4)]";
        let big = "vertices: [(-900, 0), (900, 0), (0, -900), (0, 900), (-940, 0), (940, 0), (0, -940), (0, 940)],
            streets: [[0, 2, 1, 3, 0], (0, 4), (1, 5), (2, 6), (3, 7)]";
        let near = "vertices: [(0, 0), (70, 0), (70, 60), (85, 0), (85, 60), (170, 0)], streets: [[0, 1, 3, 5], (1, 2), (3, 4)]";
        let tooth =
            "vertices: [(-30, 0), (0, 0), (30, 0), (0, 60)], main: [[0, 1, 2]], streets: [(1, 3)], dead_ends: [3]";
        let text = format!(
            "(
                patches: [
                    (name: \"line\", vertices: [(0, 0), (70, 0)], streets: [(0, 1)]),
                    (name: \"ring\", {ring}),
                    (name: \"fork\", {fork}),
                    (name: \"big\", {big}),
                    (name: \"near\", {near}),
                    (name: \"none\", vertices: [(0, 0), (80, 0)], streets: [(0, 1)], weight: 0),
                    (name: \"zero\", vertices: [(0, 0), (90, 0)], streets: [(0, 1)], at_most: 0),
                    (name: \"farm\", vertices: [(0, 0), (60, 0)], streets: [(0, 1)], tags: [\"farm\"]),
                    (name: \"tooth\", {tooth}),
                    (name: \"lonely\", {tooth}),
                ],
                patterns: [
                    (name: \"comb\", element: \"tooth\", scale: (0.6, 1.6), repeat: (2, 6)),
                    (name: \"wide\", element: \"line\", scale: (0.5, 1), repeat: (1, 3)),
                    (name: \"forks\", element: \"big\", repeat: (1, 3)),
                ],
            )"
        );
        let set = Arc::new(PatchSet::from_ron("q.ron", &text).unwrap_or_else(|e| panic!("{e}")));
        let sets = BTreeMap::from([("q".to_owned(), set.clone())]);
        let mut style = all_styles().remove(0);
        (style.patch_sets, style.patches) = (vec!["q".into()], Vec::new());
        (style.exclude, style.local.min_angle_deg) = (vec!["farm".into()], 58.0);
        style.local.degree = (3, 4);
        let kit = Kit::new(style, &sets);
        let found = judged(&kit, &sets);
        for (name, parts) in [
            ("q/line", None),
            ("q/ring", Some("no end")),
            ("q/fork", Some("at vertex 0 the streets to 2 and 4 are 53.1 degrees apart; allowed is 57.9")),
            ("q/big", Some("it measures 1584 m by 1120 m at least")),
            ("q/near", Some("junctions 1 and 3 is 15.0 m long")),
            ("q/none", Some("weight is 0")),
            ("q/zero", Some("`at_most` is 0")),
            ("q/farm", Some("`farm` is excluded")),
            ("q/tooth", None),
            ("q/lonely", Some("no end")),
        ] {
            let (_, uses, why) = found.iter().find(|(patch, ..)| patch == name).expect(name);
            let said = why.as_ref().map(ToString::to_string);
            assert!(said.is_some() == parts.is_some(), "{name}: {said:?}");
            assert!(said.as_ref().zip(parts).is_none_or(|(said, part)| said.contains(part)), "{name}: {said:?}");
            assert_eq!(*uses == 0, why.is_some(), "{name} was laid {uses} times");
        }
        let database = PatchDatabase::new(&[&set], &[], &[]);
        let pattern = |i: usize, style: &Style| {
            let why = pattern_never_laid(&database, i, Some(StyleCells { style, cells: &[] }));
            why.map(|why| why.to_string()).unwrap_or_default()
        };
        assert_eq!([0, 1, 2].map(|i| pattern(i, &kit.style)), [""; 3]);
        let cells = [Extent { across: 400.0, width: 300.0 }, Extent { across: 350.0, width: 320.0 }];
        let too_large = pattern_never_laid(&database, 2, Some(StyleCells { style: &kit.style, cells: &cells }));
        let said = too_large.map(|why| why.to_string()).unwrap_or_default();
        assert!(said.contains("1800 m by 1273 m") && said.contains("largest main cell 400 m by 300 m"), "{said}");
        let mut style = kit.style.clone();
        style.start.patterns_along = 0.0;
        assert!(pattern(0, &style).contains("`start.patterns_along` is 0") && pattern(1, &style).is_empty());
        assert!(patch_never_laid(&database, 8, Some(StyleCells { style: &style, cells: &[] })).is_some());
        (style.start.patterns_between, style.start.patterns_onwards) = (0.0, 0.0);
        assert!(pattern(1, &style).contains("`start.patterns_onwards` are 0"));
        // What the style wants in any case stands, although it would not be chosen.
        style.patches =
            Style::from_ron("s.ron", "(patches: [(patch: \"ring\", at_least: 1)])").expect("a style").patches;
        assert_eq!(patch_never_laid(&database, 1, Some(StyleCells { style: &style, cells: &[] })), None);
    }

    #[test]
    fn extents_are_those_of_the_shape() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let box_of = Extent::of(&[at(0., 0.), at(30., 0.), at(30., 40.), at(0., 40.)]);
        assert_eq!((box_of.across, box_of.width), (50.0, 30.0));
        assert_eq!(Extent::of(&[]), Extent::default());
        assert_eq!(Extent::of(&[at(3., 4.), at(0., 0.)]), Extent { across: 5.0, width: 0.0 });
    }
}
