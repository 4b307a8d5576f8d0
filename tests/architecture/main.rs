//! The order of the layers: nothing imports a layer above it, and no two files import each other, not even by way of others.
//!
//! What counts are `use` declarations and paths in code. A name that a module re-exports leads to the file that defines
//! it; `pub use` of a module's own children is a table of contents and no arrow. Tests are left out.

mod modules;
mod picture;
mod tokens;

use modules::{Definer, Modules};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The layers from the ground up. Folders in one row may not import each other in a circle either.
///
/// Analysis and exports read worlds, and nothing in a world reads them; exports may draw what an analysis finds.
const LAYERS: [&[&str]; 20] = [
    &["space"],
    &["layer", "network", "texture"],
    &["style", "patch", "edits", "map"],
    &["terrain"],
    &["region"],
    &["town"],
    &["seam"],
    &["streets"],
    &["surface"],
    &["parcel"],
    &["stack"],
    &["chunk"],
    &["mesh"],
    &["world"],
    &["analysis"],
    &["export"],
    &["plugin"],
    &["editor"],
    &["bin"],
    &["lib"],
];

/// An import of one file by another, with the line and the name.
type Arrows = BTreeMap<(PathBuf, PathBuf), Vec<(usize, String)>>;

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// All imports of files under `src`, named from there.
fn arrows() -> Arrows {
    let source = source();
    let library = Modules::read(&source.join("lib.rs"));
    let program = Modules::read(&source.join("bin/sprawl/main.rs"));
    let mut out = collect(&library, None, &source);
    out.extend(collect(&program, Some(&library), &source));
    out
}

/// The imports of a crate; paths that begin with the library's name lead there.
fn collect(modules: &Modules, library: Option<&Modules>, source: &Path) -> Arrows {
    let mut out = Arrows::new();
    let name = |file: &Path| file.strip_prefix(source).unwrap_or(file).to_owned();
    for (index, module) in modules.all.iter().enumerate() {
        for named in &module.named {
            let target = match (&named.path[..], library) {
                ([first, rest @ ..], Some(library)) if first == env!("CARGO_PKG_NAME") => {
                    let path: Vec<String> = std::iter::once("crate".to_owned()).chain(rest.iter().cloned()).collect();
                    library.definer(0, &path).map(|d| (library, d))
                }
                (path, _) => modules.definer(index, path).map(|d| (modules, d)),
            };
            // A module that is named by itself is an arrow only once something of it is named.
            let Some((of, Definer::Item(definer))) = target else { continue };
            let is_child = std::ptr::eq(of, modules) && is_below(modules, definer, index);
            let to = &of.all[definer].file;
            if *to == module.file || (named.exported && is_child) {
                continue;
            }
            out.entry((name(&module.file), name(to))).or_default().push((named.line, named.path.join("::")));
        }
    }
    out
}

fn is_below(modules: &Modules, module: usize, above: usize) -> bool {
    std::iter::successors(Some(module), |m| modules.all[*m].parent).skip(1).any(|m| m == above)
}

/// The layer of a file, by its folder.
fn layer(file: &Path) -> String {
    let first = file.iter().next().map(|f| f.to_string_lossy().into_owned()).unwrap_or_default();
    first.trim_end_matches(".rs").to_owned()
}

fn rank(file: &Path) -> usize {
    let layer = layer(file);
    LAYERS.iter().position(|row| row.contains(&layer.as_str())).unwrap_or_else(|| panic!("unknown layer `{layer}`"))
}

/// Sets of more than one node that reach each other.
fn circles<N: Ord + Clone>(edges: &BTreeSet<(N, N)>) -> Vec<BTreeSet<N>> {
    let mut next: BTreeMap<&N, BTreeSet<&N>> = BTreeMap::new();
    for (a, b) in edges {
        next.entry(a).or_default().insert(b);
    }
    let reached = |from: &N| {
        let (mut seen, mut stack) = (BTreeSet::new(), vec![from]);
        while let Some(node) = stack.pop() {
            for to in next.get(node).into_iter().flatten() {
                if seen.insert((*to).clone()) {
                    stack.push(to);
                }
            }
        }
        seen
    };
    let all: BTreeMap<&N, BTreeSet<N>> = next.keys().map(|n| (*n, reached(n))).collect();
    let mut out: Vec<BTreeSet<N>> = Vec::new();
    for (node, ahead) in &all {
        if out.iter().any(|c| c.contains(*node)) || !ahead.contains(*node) {
            continue;
        }
        let circle = ahead.iter().filter(|n| all.get(n).is_some_and(|back| back.contains(*node)));
        out.push(circle.cloned().collect());
    }
    out.retain(|c| c.len() > 1);
    out
}

/// One line for each pair of files: where the first names what of the second.
fn lines<'a>(arrows: impl Iterator<Item = (&'a (PathBuf, PathBuf), &'a Vec<(usize, String)>)>) -> Vec<String> {
    let line = |((from, to), names): (&(PathBuf, PathBuf), &Vec<(usize, String)>)| {
        let first = names.iter().map(|(line, _)| *line).min().unwrap_or(0);
        let mut paths: Vec<&str> = names.iter().map(|(_, path)| path.as_str()).collect();
        paths.sort_unstable();
        paths.dedup();
        format!("  src/{}:{first} -> src/{}: {}", from.display(), to.display(), paths.join(", "))
    };
    arrows.map(line).collect()
}

#[test]
fn no_import_runs_up() {
    let arrows = arrows();
    let up = lines(arrows.iter().filter(|((from, to), _)| rank(to) > rank(from)));
    assert!(up.is_empty(), "imports of a layer above:\n{}", up.join("\n"));
}

#[test]
fn layers_do_not_import_each_other() {
    let arrows = arrows();
    let edges: BTreeSet<(String, String)> =
        arrows.keys().map(|(a, b)| (layer(a), layer(b))).filter(|(a, b)| a != b).collect();
    let mut found = Vec::new();
    for circle in circles(&edges) {
        let inside = |(a, b): &(PathBuf, PathBuf)| {
            layer(a) != layer(b) && circle.contains(&layer(a)) && circle.contains(&layer(b))
        };
        found.push(format!("{}:", circle.iter().cloned().collect::<Vec<_>>().join(", ")));
        found.extend(lines(arrows.iter().filter(|(ends, _)| inside(ends))));
    }
    assert!(found.is_empty(), "layers that import each other:\n{}", found.join("\n"));
}

#[test]
fn files_do_not_import_each_other() {
    let arrows = arrows();
    let edges: BTreeSet<(PathBuf, PathBuf)> = arrows.keys().cloned().collect();
    let mut found = Vec::new();
    for circle in circles(&edges) {
        found.push(format!("a circle of {} files:", circle.len()));
        found.extend(lines(arrows.iter().filter(|((a, b), _)| circle.contains(a) && circle.contains(b))));
    }
    assert!(found.is_empty(), "files that import each other:\n{}", found.join("\n"));
}

#[test]
fn circles_are_found() {
    let edges = [(1, 2), (2, 3), (3, 1), (3, 4), (4, 4)].into_iter().collect();
    assert_eq!(circles(&edges), [BTreeSet::from([1, 2, 3])]);
}
