//! Styles: how the streets, lots and buildings of a settlement look. A style is a RON file; each struct of rules has a file of
//! its own here, with the ranges of its values and how two of its kind mix.
//!
//! Part of the ground floor: knows no layer.

mod filler;
mod fringe;
mod local;
mod main_streets;
mod mix;
mod parcel;
mod patchcity;
mod seam;
mod start;

pub use filler::{Filler, PatchCount};
pub use fringe::FringeRules;
pub use local::LocalRules;
pub use main_streets::{FieldKind, MainRules};
pub use parcel::ParcelRules;
pub use patchcity::PatchCityRules;
pub use seam::SeamRules;
pub use start::StartRules;

use crate::layer::{FileError, RangeError, Ranged, Walk, from_ron};
use crate::space::Stream;
use mix::Blend;
use serde::{Deserialize, Serialize};

/// How the streets, lots and buildings of a settlement look.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Style {
    /// Name: the file's, without folders and extension.
    #[serde(skip)]
    pub name: String,
    /// Main streets.
    pub main: MainRules,
    /// Attachment of local streets to main streets.
    pub seam: SeamRules,
    /// Local streets.
    pub local: LocalRules,
    /// What fills the main cells.
    pub filler: Filler,
    /// Names of the patch sets that it uses.
    pub patch_sets: Vec<String>,
    /// Tags of which a patch must have one; empty allows every patch.
    pub allow: Vec<String>,
    /// Tags of which a patch must have none.
    pub exclude: Vec<String>,
    /// How often single patches are used.
    pub patches: Vec<PatchCount>,
    /// How main cells are begun with patches and patterns.
    pub start: StartRules,
    /// The style that takes over towards the outline; none if not given.
    pub fringe: Option<FringeRules>,
    /// Lots and buildings.
    pub parcels: ParcelRules,
}

impl Style {
    /// Reads and checks a style from RON text; `file` names it in errors, and its stem names the style.
    pub fn from_ron(file: &str, text: &str) -> Result<Self, FileError> {
        let mut style: Self = from_ron(file, text)?;
        style.check().map_err(|e| e.in_file(file, text))?;
        style.name =
            std::path::Path::new(file).file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(style)
    }

    /// Share of the fringe's style at a distance from the centre, in radii of the settlement: 0 to 1.
    pub fn fringe_share(&self, radii: f64) -> f64 {
        self.fringe.as_ref().map_or(0.0, |fringe| fringe.share(radii))
    }

    /// Checks that every value lies in its range; the error names the struct of rules and the field.
    pub fn check(&self) -> Result<(), RangeError> {
        self.check_ranges()
    }

    /// How the style counts the patches of a name, if it does.
    pub fn count_of(&self, patch: &str) -> Option<&PatchCount> {
        self.patches.iter().find(|count| count.patch == patch)
    }

    /// The style that is `t` (0 to 1) of the way from `a` to `b`. Numbers lie between, counts are rounded, choices without a
    /// middle are drawn from `stream` (`b` with probability `t`), and the patch sets are those of both. The name and the
    /// tags are those of the nearer style. A mixed style has no fringe and counts no patches.
    pub fn mix(a: &Self, b: &Self, t: f64, stream: &mut Stream) -> Self {
        let nearer = if t < 0.5 { a } else { b };
        let mut patch_sets: Vec<String> = a.patch_sets.iter().chain(&b.patch_sets).cloned().collect();
        patch_sets.sort();
        patch_sets.dedup();
        let mut blend = Blend::new(t, stream);
        Self {
            name: nearer.name.clone(),
            main: MainRules::mix(&a.main, &b.main, &mut blend),
            seam: SeamRules::mix(&a.seam, &b.seam, &mut blend),
            local: LocalRules::mix(&a.local, &b.local, &mut blend),
            filler: Filler::mix(&a.filler, &b.filler, &mut blend),
            patch_sets,
            allow: nearer.allow.clone(),
            exclude: nearer.exclude.clone(),
            patches: Vec::new(),
            start: StartRules::mix(&a.start, &b.start, &mut blend),
            fringe: None,
            parcels: ParcelRules::mix(&a.parcels, &b.parcels, &mut blend),
        }
    }
}

impl Ranged for Style {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self {
            name: _,
            main,
            seam,
            local,
            filler,
            patch_sets: _,
            allow: _,
            exclude: _,
            patches,
            start,
            fringe,
            parcels,
        } = self;
        walk.within("main", main)?;
        walk.within("seam", seam)?;
        walk.within("local", local)?;
        walk.within("filler", filler)?;
        walk.within("parcels", parcels)?;
        for (i, count) in patches.iter_mut().enumerate() {
            walk.within(&format!("patches[{i}]"), count)?;
        }
        walk.within("start", start)?;
        fringe.as_mut().map_or(Ok(()), |fringe| walk.within("fringe", fringe))
    }
}

#[cfg(test)]
mod tests {
    use crate::layer::Ranged;
    use crate::space::Seed;
    use crate::style::Style;

    fn bundled() -> Vec<Style> {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/styles");
        let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        files.sort();
        let read = |file: &std::path::PathBuf| {
            Style::from_ron(&file.to_string_lossy(), &std::fs::read_to_string(file).unwrap()).unwrap()
        };
        files.iter().map(read).collect()
    }

    #[test]
    fn a_mixed_style_is_sound_and_lies_between_both() {
        let styles = bundled();
        let mut stream = Seed(1).stream("test", &[]);
        for a in &styles {
            for b in &styles {
                for t in [0.0, 0.17, 0.5, 0.83, 1.0] {
                    let mixed = Style::mix(a, b, t, &mut stream);
                    assert_eq!(mixed.check(), Ok(()), "{} and {} at {t}", a.name, b.name);
                    let (x, y) = (a.local.length, b.local.length);
                    assert!((mixed.local.length - (x + (y - x) * t)).abs() < 1e-9);
                    assert!(a.patch_sets.iter().chain(&b.patch_sets).all(|s| mixed.patch_sets.contains(s)));
                    let (end, of) = if t < 0.5 { (0.0, a) } else { (1.0, b) };
                    if t == end {
                        assert_eq!((&mixed.main, &mixed.seam, &mixed.local), (&of.main, &of.seam, &of.local));
                        assert_eq!((&mixed.parcels, &mixed.name), (&of.parcels, &of.name));
                    }
                }
            }
        }
    }

    #[test]
    fn mixtures_of_random_valid_styles_are_valid() {
        let mut s = Seed(5).stream("test", &[]);
        for _ in 0..500 {
            let [mut a, mut b] = [Style::default(), Style::default()];
            for style in [&mut a, &mut b] {
                style.draw(0.7, &mut s).unwrap();
            }
            let t = s.unit();
            assert_eq!(Style::mix(&a, &b, t, &mut s).check(), Ok(()), "{a:?} {b:?} {t}");
        }
    }
}
