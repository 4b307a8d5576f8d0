//! The modules of a crate: what each defines, what it imports and which paths it names.

use crate::tokens::{Token, tokens};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A path as it is written, with its line.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    pub path: Vec<String>,
    pub line: usize,
    /// Whether it is the path of a `pub use`.
    pub exported: bool,
}

/// What a name stands for inside a module.
#[derive(Clone, Debug)]
pub enum Entry {
    /// A child module, by index.
    Module(usize),
    /// Something that the module defines.
    Item,
    /// Something that a `use` brings in.
    Alias(Vec<String>),
}

#[derive(Debug, Default)]
pub struct Module {
    pub file: PathBuf,
    pub parent: Option<usize>,
    pub names: BTreeMap<String, Entry>,
    /// Paths of `use ...::*`.
    pub globs: Vec<Vec<String>>,
    pub named: Vec<Named>,
}

/// The modules of a crate; the first is its root.
pub struct Modules {
    pub all: Vec<Module>,
}

impl Modules {
    /// Reads a crate from its root file. Modules and items under `#[cfg(test)]` are left out.
    pub fn read(root: &Path) -> Self {
        let mut out = Self { all: Vec::new() };
        out.file(root, None, root.parent().unwrap_or(root).to_owned());
        out
    }

    /// Reads a file as a module; files of its children lie in `folder`.
    fn file(&mut self, file: &Path, parent: Option<usize>, folder: PathBuf) -> usize {
        let source = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let source = tokens(&source);
        self.module(file, parent, &folder, &source)
    }

    fn module(&mut self, file: &Path, parent: Option<usize>, folder: &Path, tokens: &[Token]) -> usize {
        let module = self.all.len();
        self.all.push(Module { file: file.to_owned(), parent, ..Module::default() });
        let (mut at, mut depth) = (0, 0usize);
        // Whether a `pub` stands before what follows, and where its visibility ends.
        let mut exported = false;
        while at < tokens.len() {
            let text = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
            match text(at) {
                "#" => {
                    let end = closing(tokens, at + 1 + usize::from(text(at + 1) == "!"));
                    let words: Vec<&str> = tokens[at..=end].iter().map(|t| t.text.as_str()).collect();
                    let test = words.windows(4).any(|w| w == ["cfg", "(", "test", ")"]);
                    at = if test { item_end(tokens, end + 1) } else { end + 1 };
                    continue;
                }
                "pub" => {
                    exported = true;
                    at = if text(at + 1) == "(" { closing(tokens, at + 1) + 1 } else { at + 1 };
                    continue;
                }
                "mod" if depth == 0 && text(at + 2) == ";" => {
                    let name = text(at + 1).to_owned();
                    let flat = folder.join(format!("{name}.rs"));
                    let child_file = if flat.exists() { flat } else { folder.join(&name).join("mod.rs") };
                    let child = self.file(&child_file, Some(module), folder.join(&name));
                    self.all[module].names.insert(name, Entry::Module(child));
                    at += 2;
                }
                "mod" if depth == 0 && text(at + 2) == "{" => {
                    let (name, end) = (text(at + 1).to_owned(), closing(tokens, at + 2));
                    let child = self.module(file, Some(module), &folder.join(&name), &tokens[at + 3..end]);
                    self.all[module].names.insert(name, Entry::Module(child));
                    at = end;
                }
                "use" => {
                    let end = (at..tokens.len()).find(|i| text(*i) == ";").unwrap_or(tokens.len());
                    self.import(module, &tokens[at + 1..end], Vec::new(), exported);
                    at = end;
                }
                "fn" | "struct" | "enum" | "union" | "trait" | "type" | "const" | "static" if depth == 0 => {
                    let skipped = ["mut", "fn", "unsafe", "extern", "async", "\""];
                    let name = (at + 1..tokens.len()).find(|i| !skipped.contains(&text(*i))).unwrap_or(at);
                    if tokens.get(name).is_some_and(Token::is_word) {
                        self.all[module].names.insert(text(name).to_owned(), Entry::Item);
                    }
                    at = name;
                }
                "{" | "(" | "[" => depth += 1,
                "}" | ")" | "]" => depth = depth.saturating_sub(1),
                word if tokens[at].is_word() && text(at + 1) == "::" && (at == 0 || text(at - 1) != "::") => {
                    let mut path = vec![word.to_owned()];
                    let line = tokens[at].line;
                    while text(at + 1) == "::" && tokens.get(at + 2).is_some_and(Token::is_word) {
                        path.push(text(at + 2).to_owned());
                        at += 2;
                    }
                    self.all[module].named.push(Named { path, line, exported: false });
                }
                _ => {}
            }
            exported = false;
            at += 1;
        }
        module
    }

    /// Adds what one tree of a `use` brings in, after the path `before`.
    fn import(&mut self, module: usize, tree: &[Token], before: Vec<String>, exported: bool) {
        let (mut path, mut at) = (before, 0);
        let line = tree.first().map_or(0, |t| t.line);
        while let Some(token) = tree.get(at) {
            match token.text.as_str() {
                "::" => {}
                "{" => {
                    for part in parts(&tree[at + 1..closing(tree, at)]) {
                        self.import(module, part, path.clone(), exported);
                    }
                    return;
                }
                "*" => {
                    self.all[module].named.push(Named { path: path.clone(), line, exported });
                    self.all[module].globs.push(path);
                    return;
                }
                "as" => break,
                word => path.push(word.to_owned()),
            }
            at += 1;
        }
        if path.last().is_some_and(|l| l == "self") {
            path.pop();
        }
        let renamed = tree.get(at + 1).map(|t| t.text.clone());
        let Some(name) = renamed.or_else(|| path.last().cloned()) else { return };
        self.all[module].named.push(Named { path: path.clone(), line, exported });
        self.all[module].names.entry(name).or_insert(Entry::Alias(path));
    }

    /// The module that defines what a path names, seen from `from`; `None` for what other crates define. The last path
    /// segments may be items inside an item (variants, associated functions).
    pub fn definer(&self, from: usize, path: &[String]) -> Option<Definer> {
        self.resolve(from, path, 0)
    }

    fn resolve(&self, from: usize, path: &[String], depth: usize) -> Option<Definer> {
        // Aliases that name each other end here.
        if depth > 32 {
            return None;
        }
        let (first, mut rest) = path.split_first()?;
        let mut module = match first.as_str() {
            "crate" => 0,
            "self" => from,
            "super" => self.all[from].parent?,
            _ => {
                rest = path;
                from
            }
        };
        let mut relative = rest.len() < path.len();
        for (i, name) in rest.iter().enumerate() {
            if name == "super" {
                module = self.all[module].parent?;
                continue;
            }
            match self.all[module].names.get(name) {
                Some(Entry::Module(child)) => module = *child,
                Some(Entry::Item) => return Some(Definer::Item(module)),
                Some(Entry::Alias(alias)) => {
                    // A path that begins with the name of another crate looks like an alias of itself.
                    if alias.first() == Some(name) && i == 0 && !relative {
                        return None;
                    }
                    let full: Vec<String> = alias.iter().chain(&rest[i + 1..]).cloned().collect();
                    return self.resolve(module, &full, depth + 1);
                }
                None => {
                    let globs = self.all[module].globs.iter();
                    let full = |glob: &Vec<String>| glob.iter().chain(&rest[i..]).cloned().collect::<Vec<_>>();
                    let found = globs.map(full).find_map(|full| self.resolve(module, &full, depth + 1));
                    // What a glob of an unread kind brings in, or a macro makes, counts as the module's own.
                    return found.or(relative.then_some(Definer::Item(module)));
                }
            }
            relative = true;
        }
        Some(Definer::Module(module))
    }
}

/// What a path leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Definer {
    /// An item that this module defines.
    Item(usize),
    /// This module itself.
    Module(usize),
}

/// Index of the bracket that closes the one at `open`.
fn closing(tokens: &[Token], open: usize) -> usize {
    let mut depth = 0usize;
    for (i, token) in tokens.iter().enumerate().skip(open) {
        match token.text.as_str() {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return i;
        }
    }
    tokens.len().saturating_sub(1)
}

/// Index after the item that begins at `from`, attributes included: after its first `;` or `{...}`.
fn item_end(tokens: &[Token], from: usize) -> usize {
    let mut at = from;
    while let Some(token) = tokens.get(at) {
        match token.text.as_str() {
            ";" | "," => return at + 1,
            "{" => return closing(tokens, at) + 1,
            "}" => return at,
            "(" | "[" => at = closing(tokens, at),
            // A list of imports ends with `;`, not with its bracket.
            "use" => return (at..tokens.len()).find(|i| tokens[*i].text == ";").map_or(tokens.len(), |i| i + 1),
            _ => {}
        }
        at += 1;
    }
    tokens.len()
}

/// The parts of a list, without the commas between them.
fn parts(tokens: &[Token]) -> Vec<&[Token]> {
    let (mut out, mut depth, mut start) = (Vec::new(), 0usize, 0);
    for (i, token) in tokens.iter().enumerate() {
        match token.text.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            "," if depth == 0 => {
                out.push(&tokens[start..i]);
                start = i + 1;
            }
            _ => {}
        }
    }
    out.push(&tokens[start..]);
    out.retain(|part| !part.is_empty());
    out
}
