//! Reading patch set files: every defect is located in the text.

use crate::layer::{FileError, error_at, from_ron};
use crate::patch::check::{DrawingError, check_patch};
use crate::patch::file::{PatchDrawing, PatternDrawing, SetDrawing};
use crate::patch::{Patch, PatchSet, Pattern};
use std::collections::BTreeSet;
use std::path::Path;

impl Patch {
    /// The patch that a drawing describes.
    ///
    /// # Errors
    /// What is wrong with the drawing.
    pub fn of(drawing: PatchDrawing) -> Result<Self, DrawingError> {
        check_patch(drawing).map_err(|refused| DrawingError::of(&refused.defect))
    }
}

impl PatchSet {
    /// Reads a patch set from RON text (the format is described in [`crate::patch`]); `file` is named in errors, and its
    /// stem names the set. The tags of Teng 2017, Table 1 are found here ([`tag`](crate::patch::tag)).
    ///
    /// # Errors
    /// Text that is not RON, or describes a patch or pattern that cannot be: with line, column and what is allowed.
    pub fn from_ron(file: &str, text: &str) -> Result<Self, FileError> {
        if text.trim().is_empty() {
            let reason = "the file is empty; a patch set is (patches: [(name: ..., vertices: ..., streets: ...)])";
            return Err(FileError::new(file, (1, 1), reason));
        }
        let SetDrawing { patches: drawings, patterns } = from_ron(file, text)?;
        if drawings.is_empty() {
            return Err(error_at(file, text, "patches", "the list of patches is empty; it needs at least one"));
        }
        let mut names = BTreeSet::new();
        let mut patches = Vec::with_capacity(drawings.len());
        for (i, drawing) in drawings.into_iter().enumerate() {
            let name = drawing.name.clone();
            let patch = check_patch(drawing).map_err(|refused| {
                let path = format!("patches[{i}].{}", refused.path);
                error_at(file, text, &path, format!("patch `{name}`: {}", refused.defect))
            })?;
            if !names.insert(name.clone()) {
                return Err(error_at(file, text, &format!("patches[{i}].name"), used_twice("patch", &name)));
            }
            patches.push(patch);
        }
        let mut names = BTreeSet::new();
        for (i, pattern) in patterns.iter().enumerate() {
            let wrong = |(field, reason)| error_at(file, text, &format!("patterns[{i}].{field}"), reason);
            check_pattern(pattern, &patches).map_err(wrong)?;
            if !names.insert(&pattern.name) {
                return Err(wrong(("name", used_twice("pattern", &pattern.name))));
            }
        }
        let patterns = patterns.into_iter().map(|PatternDrawing { name, element, scale, repeat }| Pattern {
            name,
            element,
            scale,
            repeat,
        });
        let name = Path::new(file).file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(Self { name, patches, patterns: patterns.collect() })
    }
}

fn used_twice(what: &str, name: &str) -> String {
    format!("a second {what} is named `{name}`; a name may be used once in a file")
}

/// The field of a pattern that is wrong, and why.
fn check_pattern(pattern: &PatternDrawing, patches: &[Patch]) -> Result<(), (&'static str, String)> {
    let PatternDrawing { name, element, scale, repeat } = pattern;
    if name.trim().is_empty() {
        return Err(("name", "the name of a pattern is empty".into()));
    }
    let Some(patch) = patches.iter().find(|p| p.name == *element) else {
        let known: Vec<&str> = patches.iter().map(|p| p.name.as_str()).collect();
        let known = known.join("`, `");
        let reason = format!("pattern `{name}`: no patch is named `{element}`; this file has `{known}`");
        return Err(("element", reason));
    };
    patch.may_repeat().map_err(|why| ("element", format!("pattern `{name}`: patch `{element}` {why}")))?;
    let (low, high) = *scale;
    if !(low >= 0.25 && low <= high && high <= 4.0) {
        let allowed = "least, then greatest, each 0.25 to 4";
        return Err(("scale", format!("pattern `{name}`: scale is ({low}, {high}); allowed is {allowed}")));
    }
    let (low, high) = *repeat;
    if !(low >= 1 && low <= high && high <= 100) {
        let allowed = "least, then greatest, each 1 to 100";
        return Err(("repeat", format!("pattern `{name}`: repeat is ({low}, {high}); allowed is {allowed}")));
    }
    Ok(())
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
        let two = |fields: &str, parts: &[&str]| bad(&format!("vertices: [(0, 0), (50, 0)], {fields}"), parts);
        two("streets: [(0, 1), (1, 1)]", &["from vertex 1 to itself"]);
        two("streets: [(0, -1)]", &["-1 names no vertex", "from 0"]);
        two("streets: [[4]]", &["two or more", "(0, 1)"]);
        two("weight: -0.5", &["-0.5", "0 to 1000000"]);
        two("weight: NaN", &["NaN", "0 to 1000000"]);
        two("tags: [\"Up Town\"]", &["Up Town", "lower-case"]);
        let nameless = error("(patches: [(\nname: \" \", vertices: [(0, 0), (9, 0)], streets: [(0, 1)])])");
        assert_says(&nameless, 2, &["name is empty"]);
    }

    #[test]
    fn drawings_are_refused_where_the_defect_is_drawn() {
        let bad_at = |line: usize, rest: &str, parts: &[&str]| {
            let error = patch_error(&format!("{FOUR}{rest}"));
            assert_says(&error, line, parts);
            assert!(error.reason.contains("`bad`"), "{error}");
        };
        let bad = |rest: &str, parts: &[&str]| bad_at(6, rest, parts);
        bad("streets: [[0, 1, 2, 7]]", &["vertex 7", "4 vertices, 0 to 3"]);
        bad("streets: [(0, 1)], main: [(1, 9)]", &["`main`", "vertex 9"]);
        bad("streets: [[0, 1, 2, 3]], dead_ends: [4]", &["`dead_ends`", "vertex 4"]);
        bad("streets: [[0, 1, 2, 3]], dead_ends: [1]", &["dead end 1", "2 streets"]);
        bad("streets: [[0, 1, 2, 3], (2, 1)]", &["2-1", "twice"]);
        bad("main: [[0, 1, 2, 3], (2, 1)]", &["2-1", "twice"]);
        bad("streets: [(0, 2), (2, 1), (1, 3)]", &["0-2 and 1-3", "cross"]);
        bad_at(5, "streets: [[0, 1, 2]]", &["vertex 3", "on no street"]);
        bad_at(5, "streets: [(0, 1), (2, 3)]", &["from vertex 0 to vertex 2", "connected"]);
        bad_at(4, "", &["no local streets", "(0, 1)"]);
        bad_at(4, "main: [[0, 1, 2, 3]]", &["no local streets"]);

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
        assert_says(&error("(\npatterns: [],\n)"), 3, &["patches"]);
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
        let of = |fields: &str| {
            error(&format!(
                "(patches: [(name: \"a\", {fields})],\npatterns: [\n(name: \"p\", element: \"a\", repeat: (1, 2))])"
            ))
        };
        assert_says(
            &of("vertices: [(0, 0), (50, 0)], streets: [(0, 1)], dead_ends: [1]"),
            3,
            &["`p`", "`a`", "two ends"],
        );
        let forked =
            "vertices: [(-40, 0), (0, 0), (40, 0), (30, 50), (-30, 50)], main: [[0, 1, 2]], streets: [(1, 3), (1, 4)]";
        assert_says(&of(forked), 3, &["vertex 1", "2 streets"]);
        let good = "(name: \"p\", element: \"a\", repeat: (1, 2))";
        let twice = error(&format!("(patches: [{one}],\npatterns: [{good},\n{good}])"));
        assert_says(&twice, 3, &["second pattern", "`p`"]);
    }

    #[test]
    fn places_are_exact() {
        let text = "(patches: [(name: \"a\", vertices: [(0, 0), // (1, 9)\n  (50, 0)], streets: [(0, 1), (1, 9)])])";
        let error = error(text);
        assert_eq!((error.line, error.column), (2, 31), "{error}");
    }

    #[test]
    fn patterns_may_stand_first() {
        let text = "(patterns: [(name: \"p\", element: \"a\", repeat: (1, 2))],
            patches: [(name: \"a\", vertices: [(0, 0), (50, 0)], streets: [(0, 1)])])";
        assert_eq!(PatchSet::from_ron("p.ron", text).map(|s| s.patterns.len()), Ok(1));
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
