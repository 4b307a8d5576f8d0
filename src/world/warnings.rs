//! What of a world's assets can never be used: patches and patterns that no style lays, tags that no patch has.

use super::assets::WorldAssets;
use crate::layer::{Cancel, FileError, LayerError, error_at};
use crate::network::{JunctionId, SizeClass, StreetClass};
use crate::patch::{PatchDatabase, PatchSet, tag};
use crate::region::{Gate, Outline, Settlement, SettlementId};
use crate::space::{Origin, Seed, math, quantize};
use crate::streets::{Extent, NeverLaid, StyleCells, patch_never_laid, pattern_never_laid};
use crate::style::{Filler, Style};
use crate::terrain::{Terrain, TerrainSample};
use crate::town::{CellUse, plan};
use glam::I64Vec2;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::fmt::Display;
use std::sync::Arc;

/// Number of towns of each style whose main cells patches are held against.
const TOWNS: u64 = 4;
/// Radius of these towns, in metres.
const RADIUS: f64 = 900.0;
/// Number of points of their outlines; every quarter has a gate.
const POINTS: usize = 96;

/// Dry and level ground.
struct Level;

impl Terrain for Level {
    fn sample(&self, _: glam::DVec2) -> TerrainSample {
        TerrainSample { height: 0.0, water_level: -100.0, vegetation: 0.0 }
    }
}

/// A file that warnings are about.
#[derive(Clone, Copy)]
struct WarnedFile<'a> {
    name: &'a str,
    text: &'a str,
}

impl<'a> WarnedFile<'a> {
    fn new((name, text): (&'a str, &'a str)) -> Self {
        Self { name, text }
    }

    fn at(&self, path: &str, reason: impl Display) -> FileError {
        error_at(self.name, self.text, path, reason)
    }
}

/// Why something is never laid: the path to the place in the file, and the reason.
type Why = (String, String);

/// Warnings of patches and patterns of a set that no style can lay, each at its place in the file `file` with the content `text`:
/// patches with nothing to connect, drawings whose streets come too near to each other, weights of 0. Windows of maps are for
/// another filler, and have none.
pub fn set_warnings(set: &PatchSet, file: &str, text: &str) -> Vec<FileError> {
    let database = PatchDatabase::new(&[set], &[], &[]);
    let patch = |i: usize| patch_never_laid(&database, i, None).map(in_any_style);
    let pattern = |i: usize| pattern_never_laid(&database, i, None).map(in_any_style);
    never_laid(set, WarnedFile { name: file, text }, patch, pattern)
}

/// Warnings of the patches and patterns that are never laid for these reasons.
fn never_laid(
    set: &PatchSet,
    file: WarnedFile<'_>,
    patch: impl Fn(usize) -> Option<Why>,
    pattern: impl Fn(usize) -> Option<Why>,
) -> Vec<FileError> {
    let warning = |list: &str, what: &str, name: &str, i: usize, (path, why): Why| {
        file.at(&format!("{list}[{i}].{path}"), format!("{what} `{name}` is never laid: {why}"))
    };
    let patches = set.patches.iter().enumerate().filter(|(_, p)| p.window.is_none());
    let patches = patches.filter_map(|(i, p)| Some(warning("patches", "patch", &p.name, i, patch(i)?)));
    let patterns = set.patterns.iter().enumerate();
    let patterns = patterns.filter_map(|(i, p)| Some(warning("patterns", "pattern", &p.name, i, pattern(i)?)));
    patches.chain(patterns).collect()
}

/// Why something is never laid, whatever the style asks.
fn in_any_style(why: NeverLaid) -> Why {
    (why.path(), why.to_string())
}

/// Why something is never laid in any of some styles; `None` if it may be laid in one.
fn in_every_style(styles: &[&Arc<Style>], why: impl Fn(&Style) -> Option<NeverLaid>) -> Option<Why> {
    let whys = styles.iter().map(|style| Some((&style.name, why(style)?))).collect::<Option<Vec<_>>>()?;
    let (_, first) = whys.first()?;
    let path = if whys.iter().all(|(_, why)| why.path() == first.path()) { first.path() } else { "name".into() };
    let parts: Vec<String> = whys.iter().map(|(style, why)| format!("in style `{style}` {why}")).collect();
    Some((path, parts.join("; ")))
}

impl WorldAssets {
    /// Warnings of what no cell that is wholly of one style can use, each at its place in its file, in the order of the files: patches
    /// and patterns that no style which names their set ever lays, tags in `allow` and `exclude` that no patch of the style's sets
    /// has, counts without effect, sets that no style names. How large main cells are is measured in towns of each style on
    /// level ground. What was not read from a file has no warnings.
    ///
    /// # Errors
    ///
    /// A defect of the generator.
    pub fn warnings(&self) -> Result<Vec<FileError>, LayerError> {
        let mut cells: BTreeMap<&str, Vec<Extent>> = BTreeMap::new();
        for (name, style) in &self.styles {
            let made = main_cells(style)?;
            // Its fringe grows between its own main streets.
            if let Some(fringe) = &style.fringe {
                cells.entry(&fringe.style).or_default().extend(&made);
            }
            cells.entry(name).or_default().extend(&made);
        }
        let cells = |style: &str| cells.get(style).map_or(&[][..], Vec::as_slice);
        let mut out = Vec::new();
        for (name, style) in &self.styles {
            if let Some(file) = self.style_file(name).map(WarnedFile::new) {
                out.extend(self.style_warnings(style, cells(name), file));
            }
        }
        for (name, set) in &self.patch_sets {
            let Some(file) = self.set_file(name).map(WarnedFile::new) else { continue };
            let database = PatchDatabase::new(&[set], &[], &[]);
            let uses = |style: &&Arc<Style>| style.filler == Filler::SemanticPatches && style.patch_sets.contains(name);
            let users: Vec<&Arc<Style>> = self.styles.values().filter(uses).collect();
            let lays_windows =
                |style: &Arc<Style>| matches!(style.filler, Filler::PatchCity(_)) && style.patch_sets.contains(name);
            if self.styles.values().any(lays_windows) {
                continue;
            }
            if users.is_empty() {
                out.push(
                    file.at("", format!("no style lays patches of the set `{name}`: none that lays patches names it")),
                );
                continue;
            }
            fn of<'a>(style: &'a Style, cells: &'a [Extent]) -> Option<StyleCells<'a>> {
                Some(StyleCells { style, cells })
            }
            let patch = |i| {
                let anywhere = patch_never_laid(&database, i, None).map(in_any_style);
                let each = |style: &Style| patch_never_laid(&database, i, of(style, cells(&style.name)));
                anywhere.or_else(|| in_every_style(&users, each))
            };
            let pattern = |i| {
                let anywhere = pattern_never_laid(&database, i, None).map(in_any_style);
                let each = |style: &Style| pattern_never_laid(&database, i, of(style, cells(&style.name)));
                anywhere.or_else(|| in_every_style(&users, each))
            };
            out.extend(never_laid(set, file, patch, pattern));
        }
        Ok(out)
    }

    /// Warnings of what a style says of patches in vain.
    fn style_warnings(&self, style: &Style, cells: &[Extent], file: WarnedFile<'_>) -> Vec<FileError> {
        let name = &style.name;
        if style.filler != Filler::SemanticPatches {
            let lays_windows = matches!(style.filler, Filler::PatchCity(_));
            let given = [
                ("patch_sets", lays_windows || style.patch_sets.is_empty()),
                ("allow", lays_windows || style.allow.is_empty()),
                ("exclude", lays_windows || style.exclude.is_empty()),
                ("patches", style.patches.is_empty()),
            ];
            let given = given.into_iter().filter(|(_, is_right)| !is_right);
            let lays = if lays_windows { "counts" } else { "lays" };
            let reason = |field| format!("`{field}` has no effect: the filler of style `{name}` {lays} no patches");
            let mut out: Vec<FileError> = given.map(|(field, _)| file.at(field, reason(field))).collect();
            let of_style = || style.patch_sets.iter().filter_map(|set| self.patch_sets.get(set));
            if lays_windows && !of_style().any(|set| set.patches.iter().any(|p| p.window.is_some())) {
                let reason = format!("no patch set of style `{name}` has windows of maps, so its streets only grow");
                out.push(file.at("filler", reason));
            }
            return out;
        }
        let sets: Vec<&Arc<PatchSet>> = style.patch_sets.iter().filter_map(|set| self.patch_sets.get(set)).collect();
        let patches = || sets.iter().flat_map(|set| &set.patches);
        let tags: BTreeSet<&str> = patches().flat_map(|p| &p.tags).map(String::as_str).collect();
        let known = || tags.iter().copied().collect::<Vec<_>>().join("`, `");
        let mut out = Vec::new();
        // To exclude what is found from drawings makes sense before any has it.
        let is_found = |tag: &str| tag::OF_PATCHES.contains(&tag);
        for (field, list) in [("allow", &style.allow), ("exclude", &style.exclude)] {
            let unknown = list.iter().enumerate().filter(|(_, tag)| !tags.contains(tag.as_str()));
            for (i, tag) in unknown.filter(|(_, tag)| field == "allow" || !is_found(tag)) {
                let reason =
                    format!("no patch of the sets of style `{name}` has the tag `{tag}`; they have `{}`", known());
                out.push(file.at(&format!("{field}[{i}]"), reason));
            }
        }
        let style_cells = Some(StyleCells { style, cells });
        for (i, count) in style.patches.iter().enumerate() {
            let mut whys = Vec::new();
            for set in &sets {
                let database = PatchDatabase::new(&[set], &[], &[]);
                let named = (0..set.patches.len()).filter(|k| set.patches[*k].name == count.patch);
                whys.extend(named.map(|k| patch_never_laid(&database, k, style_cells)));
            }
            // That the count itself rules a patch out is what it is for.
            let in_vain = |why: &NeverLaid| !matches!(why, NeverLaid::Weight | NeverLaid::AtMost);
            if let Some(Some(why)) = whys.first()
                && whys.iter().all(|why| why.as_ref().is_some_and(in_vain))
            {
                let reason = format!("style `{name}` counts the patch `{}`, which is never laid: {why}", count.patch);
                out.push(file.at(&format!("patches[{i}].patch"), reason));
            }
        }
        out
    }
}

/// The extents of main cells that a style's main streets make.
fn main_cells(style: &Style) -> Result<Vec<Extent>, LayerError> {
    let ring: Vec<_> = (0..POINTS).map(|k| math::direction(k as f64 / POINTS as f64 * TAU)).collect();
    let gate = |k: usize| {
        let vertex = k * POINTS / 4;
        let at = quantize(ring[vertex] * RADIUS);
        let junction = JunctionId::of(&[k as u64]);
        Gate { junction, vertex, at, inward: -ring[vertex], class: StreetClass::Major }
    };
    let origin = Origin(I64Vec2::ZERO);
    let polygon = ring.iter().map(|p| quantize(*p * RADIUS)).collect();
    let outline = Arc::new(Outline { origin, polygon, shared: Vec::new(), river: None });
    let mut out = Vec::new();
    for number in 0..TOWNS {
        let settlement = Arc::new(Settlement {
            id: SettlementId(number),
            centre: origin,
            radius: RADIUS,
            size: SizeClass::City,
            style: style.name.clone(),
            name: String::new(),
        });
        let gates = (0..4).map(gate).collect();
        let town = plan(Seed(number), &settlement, &outline, gates, style, &Level, &Cancel::new())?;
        let built = town.cells.iter().filter(|cell| cell.cell_use == CellUse::Built);
        out.extend(built.map(|cell| Extent::of(&cell.border)));
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_that_is_bundled_can_be_used() {
        let warnings = WorldAssets::bundled().warnings().expect("towns are planned");
        let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        assert!(warnings.is_empty(), "{}", warnings.join("\n"));
    }

    #[test]
    fn what_is_in_vain_is_named_where_it_is_written() {
        let good = "vertices: [(0, 0), (70, 0)], streets: [(0, 1)]";
        let set = format!(
            "(\npatches: [\n(name: \"line\", {good}),\n(name: \"barn\", {good}, tags: [\"farm\"]),\n\
             (name: \"ring\",\n vertices: [(0, 0), (80, 0), (80, 80), (0, 80)], streets: [[0, 1, 2, 3, 0]]),\n\
             (name: \"fork\",\n vertices: [\n(0, 0), (60, 0), (-45, 60), (-45, -60), (-70, 0)],\n\
             streets: [(0, 1), (0, 2), (0, 3), (0, 4)]),\n],\n\
             patterns: [(name: \"row\", element: \"line\",\n scale: (4, 4), repeat: (1, 2)),\n\
             (name: \"barns\",\n element: \"barn\", repeat: (1, 2))],\n)"
        );
        let mut assets = WorldAssets::default();
        let mut add = |file: &str, text: &str| assets.add(file, text).unwrap_or_else(|e| panic!("{e}"));
        add("a/patches/farms.ron", &set);
        add("a/patches/idle.ron", &format!("(patches: [(name: \"a\", {good})])"));
        let one = "(\nlocal: (min_angle_deg: 60, degree: (3, 4)),\npatch_sets: [\"farms\"],\nallow: [\"straight\", \"stright\"],\n\
                   exclude: [\"curved\",\n\"farm\", \"pond\"],\npatches: [(patch: \"line\", weight: 2),\n(patch: \"barn\", at_least: 1)],\n)";
        add("a/styles/one.ron", one);
        add("a/styles/two.ron", "(local: (min_angle_deg: 70), patch_sets: [\"farms\"], exclude: [\"farm\"])");
        add("a/styles/three.ron", "(\nfiller: Parametric,\npatch_sets: [\"idle\"])");
        assert_eq!(assets.check_styles(), Ok(()));
        let found: Vec<String> =
            assets.warnings().expect("towns are planned").iter().map(ToString::to_string).collect();
        let expected = [
            "a/styles/one.ron:4:21: no patch of the sets of style `one` has the tag `stright`; they have `farm`, `loop`, `straight`",
            "a/styles/one.ron:6:9: no patch of the sets of style `one` has the tag `pond`",
            "a/styles/one.ron:8:2: style `one` counts the patch `barn`, which is never laid: its tag `farm` is excluded",
            "a/styles/three.ron:3:1: `patch_sets` has no effect: the filler of style `three` lays no patches",
            "a/patches/farms.ron:4:64: patch `barn` is never laid: in style `one` its tag `farm` is excluded; in style `two`",
            "a/patches/farms.ron:5:2: patch `ring` is never laid: it has no end at which the network goes on",
            "a/patches/farms.ron:9:1: patch `fork` is never laid: in style `one` at vertex 0 the streets to",
            "a/patches/farms.ron:15:2: pattern `barns` is never laid: in style `one` patch `barn`, its element, is never",
            "a/patches/idle.ron:1:1: no style lays patches of the set `idle`: none that lays patches names it",
        ];
        let same = found.len() == expected.len() && found.iter().zip(expected).all(|(f, e)| f.starts_with(e));
        assert!(same, "{}", found.join("\n"));
        // What no style can change is known of the set alone.
        let file = assets.set_file("farms").expect("the file of the set");
        let alone = set_warnings(&assets.patch_sets["farms"], file.0, file.1);
        assert_eq!(alone.iter().map(ToString::to_string).collect::<Vec<_>>(), [found[5].clone()]);
    }
}
