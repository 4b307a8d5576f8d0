//! The records of a table of text: fields with commas, semicolons or tabs between them (RFC 4180, apart from that).

use crate::layer::{FileError, Lines, decode_text};
use csv_core::{ReadFieldResult, ReaderBuilder};
use std::fmt::Display;

/// What may stand between fields.
const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];

/// A field of a record, without the quotes and blanks around it.
pub(super) struct Field {
    /// Byte in the text, and line from 1.
    pub at: usize,
    pub line: usize,
    pub text: String,
}

/// The text of a table and the file's name, for error messages.
pub(super) struct Records<'a> {
    file: &'a str,
    content: &'a [u8],
    lines: Lines,
    /// What stands between fields.
    separator: u8,
    /// Where the first record begins.
    start: usize,
}

impl<'a> Records<'a> {
    /// The table of a file. The separator is the one that its first line has most of, or the one that a line `sep=;` of
    /// spreadsheets names.
    pub fn new(file: &'a str, content: &'a [u8]) -> Result<Self, FileError> {
        let content = decode_text(file, content)?.as_bytes();
        let lines = Lines::new(content);
        let line_end =
            |from: usize| content[from..].iter().position(|b| *b == b'\n').map_or(content.len(), |i| from + i);
        let first = content.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(0);
        let line = content[first..line_end(first)].trim_ascii_end();
        if let Some([separator]) = line.strip_prefix(b"sep=").filter(|s| s.len() == 1) {
            return Ok(Self { file, content, lines, separator: *separator, start: line_end(first) });
        }
        let count = |separator: u8| {
            let mut is_quoted = false;
            line.iter()
                .filter(|b| {
                    is_quoted ^= **b == b'"';
                    **b == separator && !is_quoted
                })
                .count()
        };
        // Of as many, the first.
        let separator = SEPARATORS.into_iter().rev().max_by_key(|s| count(*s)).unwrap_or(b',');
        Ok(Self { file, content, lines, separator, start: 0 })
    }

    pub fn error(&self, at: usize, reason: impl Display) -> FileError {
        FileError::new(self.file, self.lines.place(self.content, at), reason)
    }

    /// The length of the text in bytes.
    pub fn end(&self) -> usize {
        self.content.len()
    }

    /// All records, without empty lines.
    pub fn read(&self) -> Result<Vec<Vec<Field>>, FileError> {
        // With a line break at the end, only an open quote can make the last field end with the file.
        let mut rest = self.content.to_vec();
        rest.push(b'\n');
        // A field is never longer than the file.
        let mut buffer = vec![0; rest.len()];
        let mut reader = ReaderBuilder::new().delimiter(self.separator).build();
        let (mut records, mut record) = (Vec::new(), Vec::new());
        let (mut at, mut last) = (self.start, self.start);
        loop {
            let (result, read, written) = reader.read_field(&rest[at..], &mut buffer);
            match result {
                ReadFieldResult::InputEmpty | ReadFieldResult::OutputFull => last = at,
                ReadFieldResult::End => return Ok(records),
                ReadFieldResult::Field { .. } if read == 0 && at == rest.len() => {
                    return Err(
                        self.error(self.start(last, record.is_empty()), "the quote that opens here is never closed")
                    );
                }
                ReadFieldResult::Field { record_end } => {
                    let start = self.start(at, record.is_empty()).min(self.content.len());
                    let line = self.lines.line(start);
                    let text = String::from_utf8_lossy(&buffer[..written]).trim().to_owned();
                    record.push(Field { at: start, line, text });
                    if record_end {
                        records.push(std::mem::take(&mut record));
                    }
                }
            }
            at += read;
        }
    }

    /// First byte of a field that is read from byte `at` on: after blanks and, if the field is the first of its record, after
    /// line breaks.
    fn start(&self, at: usize, first: bool) -> usize {
        let is_blank = |b: u8| matches!(b, b' ' | b'\t') && b != self.separator;
        let before = |b: &&u8| is_blank(**b) || (first && matches!(**b, b'\r' | b'\n'));
        at + self.content[at.min(self.content.len())..].iter().take_while(before).count()
    }

    /// Column of a byte in its line, from 1.
    pub fn column(&self, at: usize) -> usize {
        self.lines.place(self.content, at).1
    }
}
