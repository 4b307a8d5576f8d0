//! Rust text as a list of tokens: identifiers, and single signs. Comments are dropped, literals become `"`.

/// A token and its line, from 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Token {
    pub text: String,
    pub line: usize,
}

impl Token {
    pub fn is_word(&self) -> bool {
        self.text.starts_with(|c: char| c.is_alphabetic() || c == '_')
    }
}

/// Splits Rust source text into tokens. `::`, `->` and `=>` are one token each.
pub fn tokens(source: &str) -> Vec<Token> {
    let text: Vec<char> = source.chars().collect();
    let (mut out, mut at, mut line) = (Vec::new(), 0, 1);
    while at < text.len() {
        let (length, kept) = token(&text[at..]);
        if let Some(text) = kept {
            out.push(Token { text, line });
        }
        line += text[at..at + length].iter().filter(|c| **c == '\n').count();
        at += length;
    }
    out
}

/// The length of the token, comment or blank that `text` begins with, at least 1, and the token if it is one.
fn token(text: &[char]) -> (usize, Option<String>) {
    let literal = |length: usize| (length.min(text.len()), Some("\"".to_owned()));
    let word = |from: usize| from + text[from..].iter().take_while(|c| c.is_alphanumeric() || **c == '_').count();
    match text {
        [c, ..] if c.is_whitespace() => (1, None),
        ['/', '/', ..] => (text.iter().position(|c| *c == '\n').unwrap_or(text.len()), None),
        ['/', '*', ..] => (block_comment(text), None),
        ['"', ..] => literal(string(text, 1)),
        ['b' | 'c', '"', ..] => literal(string(text, 2)),
        ['b', '\'', ..] => literal(character(text, 2)),
        ['r', '"', ..] | ['r', '#', '"' | '#', ..] => literal(raw_string(text, 1)),
        ['b' | 'c', 'r', '"' | '#', ..] => literal(raw_string(text, 2)),
        ['r', '#', ..] => (word(2), Some(text[2..word(2)].iter().collect())),
        // A lifetime has no closing quote after its first character.
        ['\'', '\\', ..] | ['\'', _, '\'', ..] => literal(character(text, 1)),
        ['\'', ..] => (word(1), None),
        [c, ..] if c.is_alphabetic() || *c == '_' => (word(0), Some(text[..word(0)].iter().collect())),
        [c, ..] if c.is_ascii_digit() => (word(0), Some("0".to_owned())),
        [':', ':', ..] => (2, Some("::".into())),
        ['-', '>', ..] => (2, Some("->".into())),
        ['=', '>', ..] => (2, Some("=>".into())),
        [c, ..] => (1, Some(c.to_string())),
        [] => (1, None),
    }
}

fn block_comment(text: &[char]) -> usize {
    let (mut at, mut depth) = (0, 0usize);
    while at + 1 < text.len() {
        match (text[at], text[at + 1]) {
            ('/', '*') => (at, depth) = (at + 2, depth + 1),
            ('*', '/') => (at, depth) = (at + 2, depth - 1),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

fn quoted(text: &[char], from: usize, end: char) -> usize {
    let mut at = from;
    while let Some(c) = text.get(at) {
        match c {
            '\\' => at += 2,
            c if *c == end => return at + 1,
            _ => at += 1,
        }
    }
    text.len()
}

fn string(text: &[char], from: usize) -> usize {
    quoted(text, from, '"')
}

fn character(text: &[char], from: usize) -> usize {
    quoted(text, from, '\'')
}

fn raw_string(text: &[char], from: usize) -> usize {
    let marks = text[from..].iter().take_while(|c| **c == '#').count();
    let end: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', marks)).collect();
    let body = from + marks + 1;
    let rest = text.get(body..).unwrap_or_default();
    rest.windows(end.len()).position(|w| w == end).map_or(text.len(), |i| body + i + end.len())
}

#[test]
fn comments_strings_and_lifetimes_are_no_words() {
    let source = "a /* b /* c */ d */ ::\n// e\nfn f<'g>(\"h \\\" i\", r#\"j\"#, 'k', '\\'', b'l') -> r#m 1.5e3";
    let words: Vec<String> = tokens(source).into_iter().filter(Token::is_word).map(|t| t.text).collect();
    assert_eq!(words, ["a", "fn", "f", "m"]);
    assert_eq!(tokens(source).iter().find(|t| t.text == "fn").map(|t| t.line), Some(3));
}
