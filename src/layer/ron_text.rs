//! Reading RON text, and finding the place of a value in it.

use super::file::{FileError, Lines};
use serde::de::DeserializeOwned;
use std::fmt::Display;

/// Parses `text` as RON. `file` is only named in errors.
///
/// # Errors
/// Text that is not RON or does not fit the type. The place is where the wrong value ends.
pub fn from_ron<T: DeserializeOwned>(file: &str, text: &str) -> Result<T, FileError> {
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    options.from_str(text).map_err(|e| FileError::new(file, (e.span.end.line, e.span.end.col), e.code))
}

/// An error of the value at `path` in RON text that was read without an error: the one way from what a check finds to
/// file, line and column.
///
/// A path has the names of fields and the indices of elements, such as `towns.streets[3].width`. The place is that of the
/// last field or element of the path that is written in the text.
pub fn error_at(file: &str, text: &str, path: &str, reason: impl Display) -> FileError {
    FileError::at(file, text.as_bytes(), find(text, path).0, reason)
}

/// Errors of elements of the list at `path`, by their indices: as [`error_at`] for each, but the text is read once.
pub fn errors_at_elements<'a, R: Display>(
    file: &'a str,
    text: &'a str,
    path: &str,
    errors: impl IntoIterator<Item = (usize, R)> + 'a,
) -> impl Iterator<Item = FileError> + 'a {
    let lines = Lines::new(text.as_bytes());
    let (list, is_written) = find(text, path);
    let elements = if is_written { elements(text, path) } else { Vec::new() };
    errors.into_iter().map(move |(index, reason)| {
        let byte = elements.get(index).copied().unwrap_or(list);
        FileError::new(file, lines.place(text.as_bytes(), byte), reason)
    })
}

/// The bytes at which the elements of the list at a path begin.
fn elements(text: &str, path: &str) -> Vec<usize> {
    let mut scanner = Scanner { text: text.as_bytes(), at: 0 };
    scanner.skip_attributes();
    for step in steps(path) {
        if scanner.enter(&step).is_none() {
            return Vec::new();
        }
    }
    let mut out = Vec::new();
    scanner.skip_blank();
    if scanner.peek() == Some(b'[') {
        scanner.at += 1;
        loop {
            scanner.skip_blank();
            if matches!(scanner.peek(), None | Some(b')' | b']' | b'}')) {
                break;
            }
            out.push(scanner.at);
            scanner.skip_value();
            scanner.skip_blank();
            if scanner.peek() != Some(b',') {
                break;
            }
            scanner.at += 1;
        }
    }
    out
}

/// Whether the value at a path is written in RON text, and not left to its default.
pub fn is_written(text: &str, path: &str) -> bool {
    find(text, path).1
}

/// Byte at which the last step of a path begins that is written in the text, for a field that of its name; and whether all steps
/// are.
fn find(text: &str, path: &str) -> (usize, bool) {
    let mut scanner = Scanner { text: text.as_bytes(), at: 0 };
    scanner.skip_attributes();
    let mut found = scanner.at;
    for step in steps(path) {
        match scanner.enter(&step) {
            Some(at) => found = at,
            None => return (found, false),
        }
    }
    (found, true)
}

/// One step of a path.
enum Step<'a> {
    Field(&'a str),
    Element(usize),
}

fn steps(path: &str) -> impl Iterator<Item = Step<'_>> {
    path.split(['.', '[']).filter(|part| !part.is_empty()).map(|part| match part.strip_suffix(']') {
        Some(index) => index.parse().map_or(Step::Field(part), Step::Element),
        None => Step::Field(part),
    })
}

/// Walks over RON text that is known to be well-formed; other text gives a wrong place at worst.
struct Scanner<'a> {
    text: &'a [u8],
    /// Where the scanner stands: at the beginning of a value, between steps.
    at: usize,
}

impl Scanner<'_> {
    fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    /// Moves to the next byte that is no white space and in no comment.
    fn skip_blank(&mut self) {
        while let Some(rest) = self.text.get(self.at..).filter(|r| !r.is_empty()) {
            self.at += match rest {
                [b'/', b'/', ..] => rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len()),
                [b'/', b'*', ..] => block_comment(rest),
                // The byte order mark at the beginning of some files.
                [0xef, 0xbb, 0xbf, ..] => 3,
                [b, ..] if b.is_ascii_whitespace() => 1,
                _ => return,
            };
        }
    }

    /// Moves over `#![enable(...)]` at the beginning of a file.
    fn skip_attributes(&mut self) {
        self.skip_blank();
        while self.peek() == Some(b'#') {
            self.at += 2;
            self.skip_value();
            self.skip_blank();
        }
    }

    /// Moves over an identifier, if there is one.
    fn skip_word(&mut self) {
        while self.peek().is_some_and(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'#' || b >= 0x80) {
            self.at += 1;
        }
    }

    /// Moves to the end of a value or a key: to the next `,`, `:` or closing bracket that does not lie inside.
    fn skip_value(&mut self) {
        let mut depth = 0usize;
        loop {
            self.skip_blank();
            let Some(byte) = self.peek() else { return };
            match byte {
                b'(' | b'[' | b'{' => depth += 1,
                b')' | b']' | b'}' if depth == 0 => return,
                b')' | b']' | b'}' => depth -= 1,
                b',' | b':' if depth == 0 => return,
                _ => {}
            }
            self.at += token(&self.text[self.at..]);
            if depth == 0 && matches!(byte, b')' | b']' | b'}') {
                return;
            }
        }
    }

    /// Goes into the field or element of the value here, and gives the byte at which it begins.
    fn enter(&mut self, step: &Step<'_>) -> Option<usize> {
        self.skip_blank();
        let name = self.at;
        self.skip_word();
        let is_named = self.at > name;
        self.skip_blank();
        if !matches!(self.peek(), Some(b'(' | b'[' | b'{')) {
            return None;
        }
        self.at += 1;
        self.skip_blank();
        let inside = self.at;
        for index in 0.. {
            self.skip_blank();
            if matches!(self.peek(), None | Some(b')' | b']' | b'}')) {
                break;
            }
            let start = self.at;
            self.skip_value();
            let end = self.at;
            self.skip_blank();
            let is_key = self.peek() == Some(b':');
            match step {
                Step::Element(wanted) if *wanted == index && !is_key && !(is_named && index == 0) => {
                    self.at = start;
                    return Some(start);
                }
                Step::Field(field) if is_key && is_name(&self.text[start..end], field) => {
                    self.at += 1;
                    self.skip_blank();
                    return Some(start);
                }
                _ => {}
            }
            if is_key {
                self.at += 1;
                self.skip_value();
                self.skip_blank();
            }
            match self.peek() {
                Some(b',') => self.at += 1,
                _ => break,
            }
        }
        // `Some(value)` and variants that hold one value are no step of a path.
        self.at = inside;
        if is_named { self.enter(step) } else { None }
    }
}

/// Whether the text of a key, an identifier or a string, is a name.
fn is_name(key: &[u8], name: &str) -> bool {
    let key = key.trim_ascii();
    let key = key.strip_prefix(b"r#").unwrap_or(key);
    let quoted = key.strip_prefix(b"\"").and_then(|k| k.strip_suffix(b"\""));
    quoted.unwrap_or(key) == name.as_bytes()
}

/// Length of the string, character or single byte that text begins with, at least 1.
fn token(text: &[u8]) -> usize {
    let until = |from: usize, end: &[u8]| {
        let rest = text.get(from..).unwrap_or_default();
        rest.windows(end.len()).position(|w| w == end).map_or(text.len(), |i| from + i + end.len())
    };
    match text {
        [b'"', ..] => string(text),
        [b'\'', b'\\', ..] => until(3, b"'"),
        [b'\'', ..] => until(2, b"'"),
        [b'r', b'"' | b'#', ..] => {
            let marks = text[1..].iter().take_while(|b| **b == b'#').count();
            let end: Vec<u8> = std::iter::once(b'"').chain(std::iter::repeat_n(b'#', marks)).collect();
            if text.get(1 + marks) == Some(&b'"') { until(2 + marks, &end) } else { 1 }
        }
        _ => 1,
    }
}

/// Length of a string literal.
fn string(text: &[u8]) -> usize {
    let mut at = 1;
    while let Some(b) = text.get(at) {
        match b {
            b'"' => return at + 1,
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
    text.len()
}

/// Length of a comment between slashes and stars, which may hold others.
fn block_comment(text: &[u8]) -> usize {
    let (mut at, mut depth) = (0, 0usize);
    while at + 1 < text.len() {
        match &text[at..at + 2] {
            b"/*" => (at, depth) = (at + 2, depth + 1),
            b"*/" => (at, depth) = (at + 2, depth - 1),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(serde::Deserialize, Debug)]
    #[serde(deny_unknown_fields)]
    struct Sample {
        size: u32,
    }

    #[test]
    fn errors_name_file_line_column_and_reason() {
        let error = from_ron::<Sample>("a.ron", "(\n  size: 3,\n  colour: 4,\n)").unwrap_err();
        assert_eq!((error.file.as_str(), error.line), ("a.ron", 3));
        assert!(error.to_string().contains("colour"), "{error}");
        assert_eq!(from_ron::<Sample>("a.ron", "(size: 3)").map(|s| s.size), Ok(3));
    }

    /// What is written at the place of a path.
    fn at<'a>(text: &'a str, path: &str) -> &'a str {
        let rest = &text[find(text, path).0..];
        &rest[..rest.find([',', '\n']).unwrap_or(rest.len())]
    }

    #[test]
    fn values_are_found_by_their_path() {
        let text = "#![enable(implicit_some)]\nWorld(a: (b: 1), b: Some((a: 3)), list: [(x: 5), Pin(x: 6), (7, 8)],\n)";
        let cases = [
            ("a.b", "b: 1)"),
            ("b.a", "a: 3))"),
            ("list[0].x", "x: 5)"),
            ("list[1]", "Pin(x: 6)"),
            ("list[1].x", "x: 6)"),
            ("list[2][1]", "8)]"),
            ("list[9]", "list: [(x: 5)"),
            ("missing.a", "World(a: (b: 1)"),
        ];
        for (path, expected) in cases {
            assert_eq!(at(text, path), expected, "{path}");
            assert_eq!(is_written(text, path), !["list[9]", "missing.a"].contains(&path), "{path}");
        }
    }

    #[test]
    fn places_never_lie_in_comments_or_strings() {
        let text = "( // a: 1\n/* a: /* a: */ a: */ c: \"(a: \\\"2\", d: r#\"a: \"3\"#, e: 'a', f: '\\'', a: 4,\n)";
        assert_eq!(at(text, "a"), "a: 4");
        assert_eq!(at("{\"a b\": [(1), (2)]}", "a b[1]"), "(2)]}");
        assert_eq!(at("(shape: Area([(0, 0), (5, 5)]))", "shape[1].x"), "(5");
    }

    #[test]
    fn many_errors_of_a_list_are_found_in_one_pass() {
        let text = "(\n  a: [ // [x]\n    (1, \"],\"), \u{ce}(2),\n    [3, 4],\n  ],\n  b: 1,\n)";
        for path in ["a", "b", "c"] {
            let errors = errors_at_elements("f", text, path, (0..4).map(|i| (i, i)));
            for (i, error) in errors.enumerate() {
                let path = if i < 3 && path == "a" { format!("a[{i}]") } else { path.to_owned() };
                assert_eq!(error, error_at("f", text, &path, i), "{path}");
            }
        }
        // Quadratic work on this list would take hours.
        let long = format!("(a: [{}])", "(1, 2),\n".repeat(200_000));
        let last = errors_at_elements("f", &long, "a", (0..200_000).map(|i| (i, ""))).last();
        assert_eq!(last.map(|e| (e.line, e.column)), Some((200_000, 1)));
    }

    #[test]
    fn broken_text_gives_some_place() {
        for text in ["", "(", "a: [", "\"", "/*", "(a: 'x", "((((", "r#\"", ")"] {
            assert!(find(text, "a.b[3].c").0 <= text.len(), "{text}");
        }
    }
}
