//! What is wrong with a file that a user wrote, and where.

/// What is wrong with a file, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}{}: {reason}", self.place())]
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
    /// `:line:column`, or nothing where the error has no place in the file.
    fn place(&self) -> String {
        if self.line == 0 { String::new() } else { format!(":{}:{}", self.line, self.column) }
    }

    /// An error without a place: the file could not be read at all, or it is no text.
    pub fn unreadable(file: impl Into<String>, reason: impl std::fmt::Display) -> Self {
        Self::new(file, (0, 0), reason)
    }

    /// An error at a line and a column, both from 1. Control characters in `reason` are escaped, long words are cut.
    pub fn new(file: impl Into<String>, (line, column): (usize, usize), reason: impl std::fmt::Display) -> Self {
        Self { file: file.into(), line, column, reason: on_one_line(&reason.to_string()) }
    }

    /// An error at a byte of the file's content; a byte beyond the end counts as the end.
    pub fn at(file: impl Into<String>, content: &[u8], byte: usize, reason: impl std::fmt::Display) -> Self {
        Self::new(file, Lines::new(content).place(content, byte), reason)
    }
}

/// The column, from 1, behind the beginning of a line.
fn column(before: &[u8]) -> usize {
    String::from_utf8_lossy(before).chars().count() + 1
}

/// Where the lines of a file begin, for many errors in it.
#[derive(Clone, Debug)]
pub(crate) struct Lines(Vec<usize>);

impl Lines {
    pub fn new(content: &[u8]) -> Self {
        let ends = content.iter().enumerate().filter(|(_, b)| **b == b'\n');
        Self(std::iter::once(0).chain(ends.map(|(i, _)| i + 1)).collect())
    }

    /// The line, from 1, that holds a byte of the content.
    pub fn line(&self, byte: usize) -> usize {
        self.0.partition_point(|start| *start <= byte)
    }

    /// Line and column, from 1, of a byte of the content; a byte beyond the end counts as the end.
    pub fn place(&self, content: &[u8], byte: usize) -> (usize, usize) {
        let byte = byte.min(content.len());
        let line = self.line(byte);
        (line, column(&content[self.0[line - 1]..byte]))
    }
}

/// Most characters of a word in a reason: a name that somebody wrote may have a million.
const LONGEST_WORD: usize = 120;
/// Most characters of a reason.
const LONGEST_REASON: usize = 1200;

/// A reason on one line and of bounded length, without characters that a terminal would obey.
fn on_one_line(reason: &str) -> String {
    let (mut out, mut word) = (String::new(), 0);
    for c in reason.chars() {
        word = if c.is_whitespace() { 0 } else { word + 1 };
        match c {
            _ if word > LONGEST_WORD => {}
            _ if word == LONGEST_WORD => out.push_str("..."),
            '\n' => out.push(' '),
            c if c.is_control() => out.extend(c.escape_default()),
            c => out.push(c),
        }
        if out.len() >= LONGEST_REASON {
            out.push_str("...");
            break;
        }
    }
    out
}

/// A piece of a file for an error's reason: on one line, in quotes, cut where it is long.
pub(crate) fn quoted(piece: &[u8]) -> String {
    const MOST: usize = 32;
    let text = String::from_utf8_lossy(&piece[..piece.len().min(4 * MOST)]);
    let cut: String = text.chars().take(MOST).collect();
    let more = if cut.len() < text.len() || piece.len() > 4 * MOST { "..." } else { "" };
    // In double quotes a single one needs no escape.
    let escaped = |c: char| if c == '\'' { c.to_string() } else { c.escape_debug().to_string() };
    format!("\"{}{more}\"", cut.chars().map(escaped).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_at_a_byte_count_lines_and_characters() {
        let text = "a\nL'\u{ce}le, x\n".as_bytes();
        let place = |byte| FileError::at("f", text, byte, "").to_string();
        assert_eq!([place(0), place(2), place(9), place(99)], ["f:1:1: ", "f:2:1: ", "f:2:7: ", "f:3:1: "]);
        assert_eq!(quoted(b"a\n\xff\"d'O"), "\"a\\n\u{fffd}\\\"d'O\"");
        assert_eq!(quoted(&[b'x'; 999]).len(), 37);
    }

    #[test]
    fn reasons_are_short_and_on_one_line() {
        let reason = FileError::unreadable("f", format!("a \u{1b}[31mred\nname {}", "x".repeat(999))).reason;
        assert!(reason.starts_with("a \\u{1b}[31mred name xxx") && reason.ends_with("x..."), "{reason}");
        assert!(reason.len() < 200, "{reason}");
        assert!(FileError::unreadable("f", "many words ".repeat(9999)).reason.len() <= LONGEST_REASON + 3);
    }
}
