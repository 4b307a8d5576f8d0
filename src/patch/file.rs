//! Reading patch set files. Each value checks itself as soon as it is read, so that errors carry its place.

use crate::patch::check::check_patch;
use crate::patch::{Patch, Pattern};
use crate::space::quantize;
use glam::DVec2;
use serde::de::{self, DeserializeSeed, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;

/// Greatest coordinate of a vertex, in metres.
const REACH: f64 = 2000.0;

/// A position in the drawing.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "(f64, f64)")]
pub(super) struct Place(pub DVec2);

impl TryFrom<(f64, f64)> for Place {
    type Error = String;

    fn try_from((x, y): (f64, f64)) -> Result<Self, String> {
        match [x, y].into_iter().find(|c| !(-REACH..=REACH).contains(c)) {
            Some(c) => Err(format!("a vertex has the coordinate {c}; allowed is -{REACH} to {REACH} metres")),
            None => Ok(Self(quantize(DVec2::new(x, y)))),
        }
    }
}

/// A street: the vertices that it runs through.
#[derive(Clone, Debug)]
pub(super) struct Line(pub Vec<usize>);

impl<'de> Deserialize<'de> for Line {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct LineVisitor;
        impl<'de> Visitor<'de> for LineVisitor {
            type Value = Line;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the vertices of a street, two or more, such as (0, 1) or [0, 4, 5, 1]")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Line, A::Error> {
                let mut line: Vec<usize> = Vec::new();
                while let Some(index) = seq.next_element::<i64>()? {
                    let Ok(index) = usize::try_from(index) else {
                        return Err(de::Error::custom(format!("{index} names no vertex; they are numbered from 0")));
                    };
                    if line.last() == Some(&index) {
                        let reason = format!("a street runs from vertex {index} to itself; its vertices must differ");
                        return Err(de::Error::custom(reason));
                    }
                    line.push(index);
                }
                match line.len() {
                    0 | 1 => Err(de::Error::invalid_length(line.len(), &self)),
                    _ => Ok(Line(line)),
                }
            }
        }
        deserializer.deserialize_any(LineVisitor)
    }
}

/// A tag that the user adds.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "String")]
pub(super) struct Tag(pub String);

impl TryFrom<String> for Tag {
    type Error = String;

    fn try_from(tag: String) -> Result<Self, String> {
        let word = |w: &str| !w.is_empty() && w.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit());
        if tag.split('-').all(word) {
            return Ok(Self(tag));
        }
        Err(format!("the tag {tag:?} is not lower-case words joined by `-`, such as \"river-side\""))
    }
}

/// Weight in choices.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "f64")]
pub(super) struct Weight(pub f64);

impl Default for Weight {
    fn default() -> Self {
        Self(1.0)
    }
}

impl TryFrom<f64> for Weight {
    type Error = String;

    fn try_from(weight: f64) -> Result<Self, String> {
        match (0.0..=1e6).contains(&weight) {
            true => Ok(Self(weight)),
            false => Err(format!("the weight is {weight}; allowed is 0 to 1000000")),
        }
    }
}

/// A name of a patch or pattern.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "String")]
pub(super) struct Name(pub String);

impl TryFrom<String> for Name {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        match name.trim().is_empty() {
            true => Err("the name is empty; give it one that is not used twice in the file".into()),
            false => Ok(Self(name)),
        }
    }
}

/// A patch as it is written in the file.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "Patch", deny_unknown_fields)]
pub(super) struct PatchDrawing {
    pub name: Name,
    pub vertices: Vec<Place>,
    #[serde(default)]
    pub streets: Vec<Line>,
    #[serde(default)]
    pub main: Vec<Line>,
    #[serde(default)]
    pub dead_ends: Vec<usize>,
    #[serde(default)]
    pub tags: Vec<Tag>,
    #[serde(default)]
    pub weight: Weight,
    #[serde(default)]
    pub at_most: Option<u32>,
}

/// A pattern as it is written in the file.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "Pattern", deny_unknown_fields)]
struct PatternDrawing {
    name: Name,
    element: String,
    #[serde(default = "full_size")]
    scale: (f64, f64),
    repeat: (u32, u32),
}

fn full_size() -> (f64, f64) {
    (1.0, 1.0)
}

impl PatternDrawing {
    fn check(self, patches: &[Patch]) -> Result<Pattern, String> {
        let Self { name: Name(name), element, scale, repeat } = self;
        if !patches.iter().any(|p| p.name == element) {
            let known: Vec<&str> = patches.iter().map(|p| p.name.as_str()).collect();
            let known = known.join("`, `");
            return Err(format!("pattern `{name}`: no patch is named `{element}`; this file has `{known}`"));
        }
        let (low, high) = scale;
        if !(low >= 0.25 && low <= high && high <= 4.0) {
            let allowed = "least, then greatest, each 0.25 to 4";
            return Err(format!("pattern `{name}`: scale is ({low}, {high}); allowed is {allowed}"));
        }
        let (low, high) = repeat;
        if !(low >= 1 && low <= high && high <= 100) {
            let allowed = "least, then greatest, each 1 to 100";
            return Err(format!("pattern `{name}`: repeat is ({low}, {high}); allowed is {allowed}"));
        }
        Ok(Pattern { name, element, scale, repeat })
    }
}

/// A whole file.
pub(super) struct SetFile {
    pub patches: Vec<Patch>,
    pub patterns: Vec<Pattern>,
}

#[derive(Deserialize)]
#[serde(field_identifier, rename_all = "snake_case")]
enum Field {
    Patches,
    Patterns,
}

impl<'de> Deserialize<'de> for SetFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct FileVisitor;
        impl<'de> Visitor<'de> for FileVisitor {
            type Value = SetFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a patch set, (patches: [...], patterns: [...])")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<SetFile, A::Error> {
                let (mut patches, mut patterns) = (None, None);
                while let Some(field) = map.next_key()? {
                    match field {
                        Field::Patches if patches.is_some() => return Err(de::Error::duplicate_field("patches")),
                        Field::Patches => patches = Some(map.next_value_seed(Patches)?),
                        Field::Patterns if patterns.is_some() => return Err(de::Error::duplicate_field("patterns")),
                        Field::Patterns => {
                            // Only so can an unknown element be reported where it stands.
                            let Some(patches) = &patches else {
                                return Err(de::Error::custom("`patterns` stands before `patches`; put it after them"));
                            };
                            patterns = Some(map.next_value_seed(Patterns(patches))?);
                        }
                    }
                }
                let patches = patches.ok_or_else(|| de::Error::missing_field("patches"))?;
                Ok(SetFile { patches, patterns: patterns.unwrap_or_default() })
            }
        }
        deserializer.deserialize_struct("PatchSet", &["patches", "patterns"], FileVisitor)
    }
}

/// Reads the list of patches.
struct Patches;

impl<'de> DeserializeSeed<'de> for Patches {
    type Value = Vec<Patch>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Vec<Patch>, D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Patches {
    type Value = Vec<Patch>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of patches, at least one")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<Patch>, A::Error> {
        let mut patches: Vec<Patch> = Vec::new();
        while let Some(patch) = seq.next_element_seed(NextPatch(&patches))? {
            patches.push(patch);
        }
        match patches.is_empty() {
            true => Err(de::Error::invalid_length(0, &self)),
            false => Ok(patches),
        }
    }
}

/// Reads the patch that comes after these. Its errors must be raised here, before the list goes on to the next one, to be
/// reported at its own place.
struct NextPatch<'a>(&'a [Patch]);

impl<'de> DeserializeSeed<'de> for NextPatch<'_> {
    type Value = Patch;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Patch, D::Error> {
        let patch = check_patch(PatchDrawing::deserialize(deserializer)?).map_err(de::Error::custom)?;
        if self.0.iter().any(|p| p.name == patch.name) {
            return Err(de::Error::custom(used_twice("patch", &patch.name)));
        }
        Ok(patch)
    }
}

fn used_twice(what: &str, name: &str) -> String {
    format!("a second {what} is named `{name}`; a name may be used once in a file")
}

/// Reads the list of patterns of these patches.
struct Patterns<'a>(&'a [Patch]);

impl<'de> DeserializeSeed<'de> for Patterns<'_> {
    type Value = Vec<Pattern>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Vec<Pattern>, D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Patterns<'_> {
    type Value = Vec<Pattern>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of patterns")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<Pattern>, A::Error> {
        let mut patterns: Vec<Pattern> = Vec::new();
        while let Some(pattern) = seq.next_element_seed(NextPattern(self.0, &patterns))? {
            patterns.push(pattern);
        }
        Ok(patterns)
    }
}

/// Reads the pattern of these patches that comes after these patterns.
struct NextPattern<'a>(&'a [Patch], &'a [Pattern]);

impl<'de> DeserializeSeed<'de> for NextPattern<'_> {
    type Value = Pattern;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Pattern, D::Error> {
        let pattern = PatternDrawing::deserialize(deserializer)?.check(self.0).map_err(de::Error::custom)?;
        if self.1.iter().any(|p| p.name == pattern.name) {
            return Err(de::Error::custom(used_twice("pattern", &pattern.name)));
        }
        Ok(pattern)
    }
}

#[cfg(test)]
mod tests {
    use crate::layer::FileError;
    use crate::patch::PatchSet;

    fn error(text: &str) -> FileError {
        PatchSet::from_ron("sets/bad.ron", text).expect_err("the set has a defect")
    }

    /// The error of a set whose second patch, from line 4 on, has these fields besides its name.
    fn patch_error(fields: &str) -> FileError {
        let good = "(name: \"good\", vertices: [(0, 0), (50, 0)], streets: [(0, 1)])";
        error(&format!("(\n  patches: [\n    {good},\n    (name: \"bad\",\n{fields}),\n    {good},\n  ],\n)"))
    }

    fn assert_says(error: &FileError, line: usize, parts: &[&str]) {
        assert_eq!((error.file.as_str(), error.line), ("sets/bad.ron", line), "{error}");
        assert!(error.column > 0, "{error}");
        for part in parts {
            assert!(error.reason.contains(part), "`{part}` is missing in: {error}");
        }
    }

    const FOUR: &str = "vertices: [(0, 0), (50, 0), (50, 50), (0, 60)],\n";

    #[test]
    fn values_are_refused_where_they_stand() {
        let bad = |fields: &str, parts: &[&str]| assert_says(&patch_error(fields), 5, parts);
        bad("colour: 3", &["colour", "vertices", "weight"]);
        bad("vertices: [(0, 0), (NaN, 5)], streets: [(0, 1)]", &["NaN", "-2000 to 2000"]);
        bad("vertices: [(0, 0), (inf, 5)], streets: [(0, 1)]", &["inf", "-2000 to 2000"]);
        bad("vertices: [(0, 0), (3, 2000.5)], streets: [(0, 1)]", &["2000.5", "-2000 to 2000"]);
        bad("streets: [(0, 1), (1, 1)]", &["from vertex 1 to itself"]);
        bad("streets: [(0, -1)]", &["-1 names no vertex", "from 0"]);
        bad("streets: [[4]]", &["two or more", "(0, 1)"]);
        bad("weight: -0.5", &["-0.5", "0 to 1000000"]);
        bad("weight: NaN", &["NaN", "0 to 1000000"]);
        bad("tags: [\"Up Town\"]", &["Up Town", "lower-case"]);
        let nameless = error("(patches: [(\nname: \" \", vertices: [(0, 0), (9, 0)], streets: [(0, 1)])])");
        assert_says(&nameless, 2, &["name is empty"]);
    }

    #[test]
    fn drawings_are_refused_at_their_own_end() {
        let bad = |rest: &str, parts: &[&str]| {
            let error = patch_error(&format!("{FOUR}{rest}"));
            assert_says(&error, 6, parts);
            assert!(error.reason.contains("`bad`"), "{error}");
        };
        bad("streets: [[0, 1, 2, 7]]", &["vertex 7", "4 vertices, 0 to 3"]);
        bad("streets: [(0, 1)], main: [(1, 9)]", &["`main`", "vertex 9"]);
        bad("streets: [[0, 1, 2, 3]], dead_ends: [4]", &["`dead_ends`", "vertex 4"]);
        bad("streets: [[0, 1, 2, 3]], dead_ends: [1]", &["dead end 1", "2 streets"]);
        bad("streets: [[0, 1, 2, 3], (2, 1)]", &["2-1", "twice"]);
        bad("main: [[0, 1, 2, 3], (2, 1)]", &["2-1", "twice"]);
        bad("streets: [(0, 2), (2, 1), (1, 3)]", &["0-2 and 1-3", "cross"]);
        bad("streets: [[0, 1, 2]]", &["vertex 3", "on no street"]);
        bad("streets: [(0, 1), (2, 3)]", &["from vertex 0 to vertex 2", "connected"]);
        bad("", &["no local streets", "(0, 1)"]);
        bad("main: [[0, 1, 2, 3]]", &["no local streets"]);

        let bad = |fields: &str, parts: &[&str]| assert_says(&patch_error(fields), 5, parts);
        bad("vertices: [(0, 0), (50, 0), (0, 0)], streets: [(0, 1)]", &["vertices 0 and 2", "same place"]);
        bad("vertices: [(0, 0)], streets: [(0, 1)]", &["1 vertices", "2 to 512"]);
        bad("vertices: [(0, 0), (60, 0), (60, 20)], streets: [(0, 1), (0, 2)]", &["vertex 0", "18 degrees", "20"]);
        // A street that ends on another without a vertex of it.
        bad("vertices: [(0, 0), (60, 0), (60, 50), (30, 0)], streets: [[0, 1, 2, 3]]", &["0-1 and 2-3", "touch"]);
    }

    #[test]
    fn names_patterns_and_whole_files() {
        assert_says(&error(" \n"), 1, &["empty", "(patches:"]);
        assert_says(&error("(\npatches: [],\n)"), 2, &["at least one"]);
        assert_says(&error("(\npatterns: [],\n)"), 2, &["`patches`", "after"]);
        assert_says(&error("(\n)"), 2, &["patches"]);
        assert_says(&error("(\n  patchs: [],\n)"), 2, &["patchs", "patches"]);
        let one = "(name: \"a\", vertices: [(0, 0), (50, 0)], streets: [(0, 1)])";
        assert_says(&error(&format!("(patches: [\n{one},\n{one},\n])")), 3, &["second patch", "`a`"]);

        let pattern = |fields: &str| error(&format!("(patches: [{one}],\npatterns: [\n({fields}),\n])"));
        assert_says(&pattern("name: \"p\", element: \"b\", repeat: (1, 2)"), 3, &["`p`", "`b`", "has `a`"]);
        for scale in ["(0, 1)", "(1, 0.5)", "(1, 5)", "(NaN, 1)", "(1, inf)"] {
            let fields = format!("name: \"p\", element: \"a\", scale: {scale}, repeat: (1, 2)");
            assert_says(&pattern(&fields), 3, &["`p`", "scale", "0.25 to 4"]);
        }
        for repeat in ["(0, 1)", "(3, 2)", "(1, 101)"] {
            let fields = format!("name: \"p\", element: \"a\", repeat: {repeat}");
            assert_says(&pattern(&fields), 3, &["`p`", "repeat", "1 to 100"]);
        }
        assert_says(&pattern("name: \"p\", element: \"a\", repeat: (1, 2), times: 3"), 3, &["times", "repeat"]);
        let good = "(name: \"p\", element: \"a\", repeat: (1, 2))";
        let twice = error(&format!("(patches: [{one}],\npatterns: [{good},\n{good}])"));
        assert_says(&twice, 3, &["second pattern", "`p`"]);
    }

    #[test]
    fn a_set_is_read() {
        let text = r#"(
            patches: [
                (name: "tee", vertices: [(0, 0), (60, 0), (120, 0), (60, -50)], streets: [[0, 1, 2], (1, 3)]),
                (
                    name: "yard",
                    vertices: [(-60, 0), (0, 0), (60, 0), (0, 50), (50, 60), (-40, 50)],
                    main: [[0, 1, 2]],
                    streets: [(0, 1), [1, 3, 4], (3, 5)],
                    dead_ends: [5],
                    tags: ["farm"],
                    weight: 0.5,
                    at_most: 2,
                ),
            ],
            patterns: [(name: "yards", element: "yard", scale: (0.8, 1.2), repeat: (2, 5))],
        )"#;
        let set = PatchSet::from_ron("some/where/farms.ron", text).unwrap();
        assert_eq!((set.name.as_str(), set.patches.len(), set.patterns.len()), ("farms", 2, 1));
        let [tee, yard] = &set.patches[..] else { unreachable!() };
        assert_eq!((tee.weight, tee.at_most, tee.connectables.len(), tee.pairs.len()), (1.0, None, 3, 3));
        assert!(tee.pairs.is_sorted_by(|x, y| x.distance <= y.distance) && tee.pairs[2].distance == 120.0);
        assert_eq!((tee.vertices[0].x, tee.radius), (-60.0, 60.0));
        assert_eq!(tee.connectables[0].inward, glam::DVec2::X);
        assert_eq!((yard.weight, yard.at_most, yard.connectables.len()), (0.5, Some(2), 1));
        assert_eq!(yard.edges.iter().filter(|e| e.main).count(), 2, "drawn as both, it is a main street");
        assert!(yard.tags.contains("farm") && yard.tags.contains("initial"));
    }
}
