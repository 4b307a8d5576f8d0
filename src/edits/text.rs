//! Where the elements of a list begin in RON text that was read without an error.

/// What a piece of text is.
enum Piece {
    /// One character of its own, or a string or character literal.
    Plain,
    /// White space or a comment.
    Blank,
}

/// Byte at which element `index` of the list `name` begins, a field of the outermost struct.
pub(super) fn element(text: &str, name: &str, index: usize) -> Option<usize> {
    let bytes = text.as_bytes();
    let (mut at, mut depth, mut found, mut count) = (0, 0usize, false, 0);
    // Whether the next piece that is not blank begins an element of the list.
    let mut begins = false;
    while at < bytes.len() {
        let (piece, length) = piece(&bytes[at..]);
        let here = at;
        at += length;
        if matches!(piece, Piece::Blank) {
            continue;
        }
        let closes = matches!(bytes[here], b')' | b']' | b'}');
        if begins && !closes {
            if count == index {
                return Some(here);
            }
            (count, begins) = (count + 1, false);
        }
        match bytes[here] {
            b'(' | b'[' | b'{' => {
                depth += 1;
                begins = found && depth == 2;
            }
            _ if closes => {
                if found && depth == 2 {
                    return None;
                }
                depth = depth.saturating_sub(1);
            }
            b',' if found && depth == 2 => begins = true,
            _ if depth == 1 && bytes[here..].starts_with(name.as_bytes()) => {
                at = here + name.len();
                let mut after = at;
                while let Some(rest) = bytes.get(after..).filter(|r| !r.is_empty()) {
                    match self::piece(rest) {
                        (Piece::Blank, length) => after += length,
                        _ => break,
                    }
                }
                let before = here.checked_sub(1).map(|i| bytes[i]);
                let starts = !before.is_some_and(|b| b.is_ascii_alphanumeric() || b == b'_');
                found |= starts && bytes.get(after) == Some(&b':');
            }
            _ => {}
        }
    }
    None
}

/// The piece that text begins with, and its length, at least 1.
fn piece(text: &[u8]) -> (Piece, usize) {
    let until = |from: usize, end: &[u8]| {
        let rest = text.get(from..).unwrap_or_default();
        rest.windows(end.len()).position(|w| w == end).map_or(text.len(), |i| from + i + end.len())
    };
    match text {
        [b'/', b'/', ..] => (Piece::Blank, until(2, b"\n")),
        [b'/', b'*', ..] => (Piece::Blank, comment(text)),
        [b, ..] if b.is_ascii_whitespace() => (Piece::Blank, 1),
        [b'"', ..] => (Piece::Plain, string(text)),
        [b'\'', b'\\', ..] => (Piece::Plain, until(3, b"'")),
        [b'\'', ..] => (Piece::Plain, until(2, b"'")),
        [b'r', b'"' | b'#', ..] => {
            let marks = text[1..].iter().take_while(|b| **b == b'#').count();
            let is_string = text.get(1 + marks) == Some(&b'"');
            let end: Vec<u8> = std::iter::once(b'"').chain(std::iter::repeat_n(b'#', marks)).collect();
            (Piece::Plain, if is_string { until(2 + marks, &end) } else { 1 })
        }
        _ => (Piece::Plain, 1),
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
fn comment(text: &[u8]) -> usize {
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
