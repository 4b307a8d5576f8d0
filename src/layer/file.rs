//! Reading the files that users write: where an error is, and RON.

use serde::de::DeserializeOwned;

/// What is wrong with a file, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}:{line}:{column}: {reason}")]
pub struct FileError {
    /// Name of the file as it was given.
    pub file: String,
    /// Line, from 1; 0 when the file could not be read at all.
    pub line: usize,
    /// Column, from 1; 0 when the file could not be read at all.
    pub column: usize,
    /// What is wrong, and what is allowed. One line.
    pub reason: String,
}

impl FileError {
    /// The file could not be read at all.
    pub fn unreadable(file: impl Into<String>, reason: impl std::fmt::Display) -> Self {
        Self { file: file.into(), line: 0, column: 0, reason: reason.to_string() }
    }

    /// What is wrong at a byte of the file's content; beyond its end counts as its end.
    pub fn at(file: impl Into<String>, content: &[u8], byte: usize, reason: impl std::fmt::Display) -> Self {
        let before = &content[..byte.min(content.len())];
        let line_start = before.iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
        Self {
            file: file.into(),
            line: before.iter().filter(|b| **b == b'\n').count() + 1,
            column: String::from_utf8_lossy(&before[line_start..]).chars().count() + 1,
            reason: reason.to_string(),
        }
    }
}

/// A piece of a file for an error's reason: on one line, in quotes, cut where it is long.
pub(crate) fn quoted(piece: &[u8]) -> String {
    const MOST: usize = 32;
    let text = String::from_utf8_lossy(&piece[..piece.len().min(4 * MOST)]);
    let cut: String = text.chars().take(MOST).collect();
    let more = if cut.len() < text.len() || piece.len() > 4 * MOST { "..." } else { "" };
    format!("\"{}{more}\"", cut.escape_debug())
}

/// Parses `text` as RON. Values that check themselves while they are deserialized (`#[serde(try_from = ...)]`) are
/// reported with the place in the file where they end.
pub fn from_ron<T: DeserializeOwned>(file: &str, text: &str) -> Result<T, FileError> {
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    options.from_str(text).map_err(|e| FileError {
        file: file.to_owned(),
        line: e.span.end.line,
        column: e.span.end.col,
        reason: e.code.to_string().replace('\n', " "),
    })
}

/// A value outside its allowed range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field} is {value}; allowed is {allowed}")]
pub struct RangeError {
    /// Dotted path of the field, as in the file.
    pub field: String,
    /// The value given.
    pub value: String,
    /// What is allowed.
    pub allowed: String,
}

impl RangeError {
    /// Fails unless `low <= value <= high` (so NaN fails).
    pub fn check(field: &str, value: f64, low: f64, high: f64) -> Result<(), Self> {
        if value >= low && value <= high {
            return Ok(());
        }
        Err(Self { field: field.into(), value: value.to_string(), allowed: format!("{low} to {high}") })
    }

    /// Fails unless `low <= pair.0 <= pair.1 <= high`.
    pub fn check_pair(field: &str, pair: (f64, f64), low: f64, high: f64) -> Result<(), Self> {
        Self::check(field, pair.0, low, high)?;
        Self::check(field, pair.1, pair.0, high)
    }

    /// The same error with `parent.` before the field.
    pub fn within(self, parent: &str) -> Self {
        Self { field: format!("{parent}.{}", self.field), ..self }
    }

    /// The error at the place in `text` where the field is written.
    pub fn in_file(&self, file: &str, text: &str) -> FileError {
        let mut at = 0;
        for name in self.field.split('.') {
            let found = text[at..].match_indices(name).find(|(i, _)| {
                let before = text[..at + i].chars().next_back();
                let after = text[at + i + name.len()..].trim_start().chars().next();
                !before.is_some_and(|c| c.is_alphanumeric() || c == '_') && after == Some(':')
            });
            at += found.map_or(0, |(i, _)| i);
        }
        FileError::at(file, text.as_bytes(), at, self)
    }
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

    #[test]
    fn errors_at_a_byte_count_lines_and_characters() {
        let text = "a\nL'\u{ce}le, x\n".as_bytes();
        let place = |byte| FileError::at("f", text, byte, "").to_string();
        assert_eq!([place(0), place(2), place(9), place(99)], ["f:1:1: ", "f:2:1: ", "f:2:7: ", "f:3:1: "]);
        assert_eq!(quoted(b"a\n\xff\""), "\"a\\n\u{fffd}\\\"\"");
        assert_eq!(quoted(&[b'x'; 999]).len(), 37);
    }

    #[test]
    fn range_errors_find_their_field() {
        let text = "(\n  roads: (slope: 1),\n  towns: (\n    slope: -2,\n  ),\n)";
        let error = RangeError::check("slope", -2.0, 0.0, 9.0).unwrap_err().within("towns").in_file("s.ron", text);
        assert_eq!(error.to_string(), "s.ron:4:5: towns.slope is -2; allowed is 0 to 9");
        assert!(RangeError::check("x", f64::NAN, 0.0, 1.0).is_err());
    }
}
