//! Random inputs of worlds: settings, styles and patch sets drawn from all that is allowed, as a list of differences from given
//! ones. `sprawl soak --inputs` and tests make worlds of them; a list from which differences are taken out shows which of them
//! a fault needs.

mod drawings;

use crate::edits::Edits;
use crate::layer::{FileError, RangeError, Ranged, Walk};
use crate::patch::tag;
use crate::space::{Seed, Stream};
use crate::style::{Filler, FringeRules, PatchCount, Style};
use crate::world::{Settings, TerrainSource, WorldAssets, WorldSource};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// Name of the drawn style.
pub const DRAWN: &str = "drawn";
/// Name of the style that takes over from it at the fringe.
pub const FRINGE: &str = "drawn-fringe";

/// Inputs of a world, with two styles that may be drawn: [`DRAWN`] and [`FRINGE`].
#[derive(Clone, Debug)]
pub struct Inputs {
    /// Settings.
    pub settings: Settings,
    /// Styles and patch sets beside the drawn styles.
    pub assets: WorldAssets,
    /// The user's wishes.
    pub edits: Edits,
    drawn: Style,
    fringe: Style,
}

/// A way in which inputs differ from given ones.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The drawn style begins as a copy of this one.
    Base(String),
    /// A number of the settings or of a drawn style has this value.
    Number(String, f64),
    /// The drawn style uses this patch set, too: its name and the text of its file.
    PatchSet(String, String),
    /// The drawn style allows this tag.
    Allow(String),
    /// The drawn style excludes this tag.
    Exclude(String),
    /// The drawn style counts a patch.
    Count(PatchCount),
    /// The drawn style has a fringe.
    Fringe(FringeRules),
    /// Every settlement has the drawn style.
    Everywhere,
    /// Wishes, one in most cases.
    Edit(Edits),
}

/// Why a list of differences makes no inputs.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InputError {
    /// A number is out of its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// A patch set has a defect.
    #[error(transparent)]
    File(#[from] FileError),
    /// There is no style of this name to begin with.
    #[error("no style is named `{0}`")]
    NoStyle(String),
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Base(style) => write!(f, "{DRAWN} is a copy of {style}"),
            Self::Number(path, value) => write!(f, "{path} = {value}"),
            Self::PatchSet(name, text) => write!(f, "patch set {name} = {text}"),
            Self::Allow(tag) => write!(f, "{DRAWN} allows {tag}"),
            Self::Exclude(tag) => write!(f, "{DRAWN} excludes {tag}"),
            Self::Count(PatchCount { patch, at_least, at_most, weight }) => {
                let most = at_most.map_or("any number".to_owned(), |n| n.to_string());
                write!(f, "{DRAWN} counts {patch}: {at_least} to {most}, weight {weight}")
            }
            Self::Fringe(FringeRules { style, begins, complete }) => {
                write!(f, "{DRAWN} has the fringe {style} from {begins} to {complete}")
            }
            Self::Everywhere => write!(f, "every settlement is {DRAWN}"),
            Self::Edit(edits) => write!(f, "{edits:?}"),
        }
    }
}

impl Ranged for Inputs {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self { settings, assets: _, edits: _, drawn, fringe } = self;
        walk.within("settings", settings)?;
        walk.within(DRAWN, drawn)?;
        walk.within(FRINGE, fringe)
    }
}

impl Inputs {
    /// Settings and assets with the default style in place of the drawn ones.
    pub fn new(settings: Settings, assets: WorldAssets) -> Self {
        let style = |name: &str| Style { name: name.into(), filler: Filler::Parametric, ..Style::default() };
        Self { settings, assets, edits: Edits::default(), drawn: style(DRAWN), fringe: style(FRINGE) }
    }

    /// Inputs that differ from these.
    ///
    /// # Errors
    ///
    /// If a number is out of its range or a patch set has a defect, as may be once others are left out of a list.
    pub fn with(&self, differences: &[Difference]) -> Result<Self, InputError> {
        let mut out = self.clone();
        for difference in differences {
            if let Difference::Base(name) = difference {
                let base = out.assets.styles.get(name).ok_or_else(|| InputError::NoStyle(name.clone()))?;
                // What a style says of others is a difference of its own.
                out.drawn = Style { name: DRAWN.into(), fringe: None, patches: Vec::new(), ..Style::clone(base) };
            }
        }
        let number = |d: &Difference| match d {
            Difference::Number(path, value) => Some((path.clone(), *value)),
            _ => None,
        };
        out.set(&differences.iter().filter_map(number).collect::<BTreeMap<_, _>>())?;
        for difference in differences {
            match difference.clone() {
                Difference::Base(_) | Difference::Number(..) => {}
                Difference::PatchSet(name, text) => {
                    out.assets.add(&format!("patches/{name}.ron"), &text)?;
                    out.drawn.patch_sets.push(name);
                }
                Difference::Allow(tag) => out.drawn.allow.push(tag),
                Difference::Exclude(tag) => out.drawn.exclude.push(tag),
                Difference::Count(count) => out.drawn.patches.push(count),
                Difference::Fringe(fringe) => out.drawn.fringe = Some(fringe),
                Difference::Everywhere => {
                    let styles = &mut out.settings.settlements.styles;
                    for of_size in [&mut styles.city, &mut styles.town, &mut styles.village] {
                        *of_size = vec![(DRAWN.into(), 1.0)];
                    }
                    out.settings.settlements.steep.0.clear();
                }
                Difference::Edit(edits) => {
                    out.edits.settlements.extend(edits.settlements);
                    out.edits.influences.extend(edits.influences);
                    out.edits.influence_maps.extend(edits.influence_maps);
                    out.edits.way_points.extend(edits.way_points);
                    out.edits.roads.extend(edits.roads);
                    out.edits.patches.extend(edits.patches);
                }
            }
        }
        Ok(out)
    }

    /// The source of a world of these inputs, on the ground that the seed gives.
    pub fn source(&self, seed: Seed) -> WorldSource {
        let mut assets = self.assets.clone();
        for style in [&self.drawn, &self.fringe] {
            assets.styles.insert(style.name.clone(), Arc::new(style.clone()));
        }
        let (settings, edits) = (self.settings.clone(), self.edits.clone());
        WorldSource { seed, settings, assets, edits, terrain: TerrainSource::Noise }
    }

    /// Draws differences of every kind but edits. Some lists differ in a few numbers, others in most.
    ///
    /// # Errors
    ///
    /// If the settings refuse numbers that are in range one by one.
    pub fn draw_differences(&self, stream: &mut Stream) -> Result<Vec<Difference>, InputError> {
        let mut out = Vec::new();
        let mut inputs = self.clone();
        if stream.chance(0.8) {
            let styles: Vec<&String> = self.assets.styles.keys().collect();
            out.extend(styles.get(stream.index(styles.len())).map(|name| Difference::Base(name.to_string())));
            inputs = inputs.with(&out)?;
        }
        let share = |stream: &mut Stream, shares: [f64; 3]| shares[stream.index(3)];
        let mut numbers = Vec::new();
        let mut put = |part: &str, changed: Vec<(String, f64)>| {
            numbers
                .extend(changed.into_iter().map(|(path, value)| Difference::Number(format!("{part}.{path}"), value)));
        };
        put(
            "settings",
            inputs.settings.draw(share(stream, [0.0, 0.05, 0.3]), stream).map_err(|e| e.within("settings"))?,
        );
        put(DRAWN, inputs.drawn.draw(share(stream, [0.05, 0.3, 0.9]), stream)?);
        put(FRINGE, inputs.fringe.draw(share(stream, [0.05, 0.3, 0.9]), stream)?);
        out.extend(numbers);
        if stream.chance(0.5) {
            let text = drawings::patch_set(stream);
            out.push(Difference::PatchSet("drawn-patches".into(), text));
            inputs = self.with(&out)?;
        }
        let mut tags: Vec<String> = tag::OF_PATCHES.iter().map(|t| t.to_string()).collect();
        tags.extend(drawings::TAGS.iter().map(|t| t.to_string()));
        if stream.chance(0.2) {
            out.push(Difference::Allow(tags.swap_remove(stream.index(tags.len()))));
        }
        if stream.chance(0.3) {
            out.push(Difference::Exclude(tags.swap_remove(stream.index(tags.len()))));
        }
        let sets = inputs.drawn.patch_sets.iter().filter_map(|set| inputs.assets.patch_sets.get(set));
        let patches: Vec<String> = sets.flat_map(|set| &set.patches).map(|patch| patch.name.clone()).collect();
        for _ in 0..stream.index(4) {
            let Some(patch) = patches.get(stream.index(patches.len())) else { break };
            let most = stream.chance(0.7).then(|| 1 + stream.index(6) as u32);
            let mut count = PatchCount { patch: patch.clone(), at_least: 0, at_most: most, weight: 1.0 };
            count.draw(0.5, stream)?;
            if !out.iter().any(|d| matches!(d, Difference::Count(c) if c.patch == count.patch)) {
                out.push(Difference::Count(count));
            }
        }
        if stream.chance(0.4) {
            let mut fringe = FringeRules { style: FRINGE.into(), begins: 0.4, complete: 0.9 };
            fringe.draw(0.7, stream)?;
            out.push(Difference::Fringe(fringe));
        }
        if stream.chance(0.5) {
            out.push(Difference::Everywhere);
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::World;
    use std::collections::BTreeSet;

    #[test]
    fn drawn_inputs_are_valid_and_of_every_kind() {
        let usual = Inputs::new(Settings::default(), WorldAssets::bundled());
        let numbers = usual.ends().len();
        assert!(numbers > 150, "{numbers}");
        let (mut made, mut refused) = (0, Vec::new());
        let (mut kinds, mut paths) = (Vec::new(), BTreeSet::new());
        for i in 0..120 {
            let mut stream = Seed(i).stream("test", &[]);
            let Ok(differences) = usual.draw_differences(&mut stream) else { continue };
            for difference in &differences {
                let text = difference.to_string();
                assert!(!text.is_empty() && !text.contains("NaN"), "{text}");
                let kind = std::mem::discriminant(difference);
                if !kinds.contains(&kind) {
                    kinds.push(kind);
                }
                if let Difference::Number(path, _) = difference {
                    paths.insert(path.clone());
                }
            }
            let inputs = usual.with(&differences).expect("what is drawn is valid");
            if i < 40 {
                match World::new(inputs.source(Seed(i))) {
                    Ok(_) => made += 1,
                    Err(e) => refused.push(e.to_string()),
                }
            }
        }
        assert!(made > 12, "{made} worlds; {refused:?}");
        assert_eq!(kinds.len(), 8, "all but edits");
        let never: Vec<_> = usual.ends().into_iter().filter(|(path, _)| !paths.contains(path)).collect();
        assert!(never.is_empty(), "{never:?} are never drawn");
    }

    #[test]
    fn a_list_without_some_differences_is_valid_or_refused() {
        let usual = Inputs::new(Settings::default(), WorldAssets::bundled());
        let mut stream = Seed(3).stream("test", &[]);
        let differences = std::iter::from_fn(|| Some(usual.draw_differences(&mut stream))).flatten().next().unwrap();
        for left_out in 0..differences.len() {
            let mut rest = differences.clone();
            rest.remove(left_out);
            if let Ok(inputs) = usual.with(&rest) {
                assert_eq!(inputs.check_ranges(), Ok(()));
            }
        }
        let few = [Difference::Number("drawn.local.length".into(), 20.0)];
        let error = usual.with(&few).unwrap_err().to_string();
        assert!(error.starts_with("drawn.local.deviation is 15"), "{error}");
    }
}
