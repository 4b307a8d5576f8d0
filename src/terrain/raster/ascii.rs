//! Reading of ESRI ASCII grids (`.asc`), as GDAL and most surveys write them.
//!
//! A header of keys and numbers is followed by the values of the cells, from the northernmost row on. The format allows any line
//! breaks between them. But where most lines hold one row, as usual, a line that does not is an error.

use super::band::Band;
use super::grid::{Raster, cell_name, check_place, count};
use super::holes::{Holes, HolesError};
use crate::layer::{FileError, decode_text, quoted};
use glam::DVec2;
use std::collections::BTreeMap;
use std::fmt::Display;

/// The number in cells without a value, if the header names none.
const MISSING: f64 = -9999.0;
/// Words for a cell without a value, besides NaN.
const MISSING_WORDS: [&str; 5] = ["null", "nodata", "none", "na", "n/a"];
/// Keys of the header.
const KEYS: [&str; 10] =
    ["ncols", "nrows", "xllcorner", "xllcenter", "yllcorner", "yllcenter", "cellsize", "dx", "dy", "nodata_value"];

/// A part of the file between blanks.
#[derive(Clone, Copy, Debug)]
struct Word<'a> {
    text: &'a [u8],
    /// Byte in the file.
    at: usize,
    /// Number of line breaks before the word.
    line: usize,
}

impl Word<'_> {
    fn number(&self) -> Option<f64> {
        let text = std::str::from_utf8(self.text).ok()?;
        // As C libraries on Windows write it: -nan(ind), 1.#QNAN, -1.#IND.
        let is_nan = |text: &str| ["nan(", "#qnan", "#ind", "#snan"].iter().any(|n| text.contains(n));
        match text.parse() {
            Ok(number) => Some(number),
            Err(_) if is_nan(&text.to_ascii_lowercase()) => Some(f64::NAN),
            Err(_) => None,
        }
    }

    /// Whether this is a number but for a comma in place of the decimal point.
    fn has_decimal_comma(&self) -> bool {
        let text = String::from_utf8_lossy(self.text);
        text.matches(',').count() == 1 && text.replace(',', ".").parse::<f64>().is_ok()
    }

    fn is_missing_word(&self) -> bool {
        MISSING_WORDS.iter().any(|w| self.text.eq_ignore_ascii_case(w.as_bytes()))
    }

    /// What to add to the reason why this is no number.
    fn hint(&self) -> &'static str {
        if self.has_decimal_comma() { "; write a decimal point in place of the comma" } else { "" }
    }
}

/// The key of the header that a word is, in any case; that of cells without a value in a few spellings.
fn key_of(word: &Word<'_>) -> Option<&'static str> {
    let text = String::from_utf8_lossy(word.text).to_ascii_lowercase();
    let plain = text.replace(['_', '-'], "");
    if ["nodatavalue", "nodata"].contains(&plain.as_str()) {
        return Some("nodata_value");
    }
    KEYS.into_iter().find(|k| *k == text)
}

/// All words of a file.
#[derive(Clone, Debug)]
struct Words<'a> {
    content: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Iterator for Words<'a> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        let rest = &self.content[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        self.line += rest[..start].iter().filter(|b| **b == b'\n').count();
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        let at = self.at + start;
        self.at = at + length;
        Some(Word { text: &self.content[at..self.at], at, line: self.line })
    }
}

/// A file and its name, for error messages.
#[derive(Clone, Copy)]
struct File<'a> {
    name: &'a str,
    content: &'a [u8],
}

impl File<'_> {
    fn error(&self, at: usize, reason: impl Display) -> FileError {
        FileError::at(self.name, self.content, at, reason)
    }
}

/// The header of a file.
struct Header<'a> {
    columns: usize,
    rows: usize,
    corner: DVec2,
    step: DVec2,
    /// What stands in cells without a value, and the same as a number if it is one.
    missing: (Option<&'a [u8]>, Option<f64>),
}

impl Header<'_> {
    fn cells(&self) -> usize {
        self.columns * self.rows
    }

    /// Whether a word stands in a cell without a value.
    fn is_missing(&self, word: &Word<'_>, number: Option<f64>, band: Band) -> bool {
        match number {
            Some(value) => {
                value.is_nan() || self.missing.1.is_some_and(|m| value as f32 == m as f32) || band.is_void(value)
            }
            None => word.is_missing_word() || self.missing.0.is_some_and(|m| word.text.eq_ignore_ascii_case(m)),
        }
    }
}

impl Raster {
    /// Reads an ESRI ASCII grid: `ncols nrows`, `xllcorner` or `xllcenter`, `yllcorner` or `yllcenter`, `cellsize` or `dx dy`,
    /// and `NODATA_value` (default -9999; a number or a word), in any order and case, then the values. `file` is only named in
    /// errors.
    ///
    /// Cells have no value where they hold what `NODATA_value` says, `nan`, `null`, `nodata`, `none` or `na`, and among heights
    /// -32768 and -32767, the marks of voids in surveys.
    ///
    /// A grid in degrees is read as it is; [`Raster::projected`] moves it to plan metres. Memory is bounded by the length of
    /// `content`, whatever the header says.
    ///
    /// # Errors
    ///
    /// Fails on everything that is not a value of the `band`, and on cells without a value unless `holes` says how to fill them.
    /// Errors name the line and column.
    pub fn from_ascii(file: &str, content: &[u8], band: Band, holes: Holes) -> Result<Self, FileError> {
        let content = decode_text(file, content)?.as_bytes();
        let file = File { name: file, content };
        let mut words = Words { content, at: 0, line: 0 };
        let header = header(&file, &mut words)?;
        let (values, hole) = numbers(&file, &header, words, band)?;
        let Header { columns, rows, corner, step, .. } = header;
        let raster = Self::new(columns, rows, corner, step, values).map_err(|e| file.error(0, e))?;
        raster.turned_north(band, holes).map_err(|e| match (e, hole) {
            (HolesError::Refused { count, cells, .. }, Some((word, n))) => {
                let cell = cell_name(n, columns);
                let (name, held) = (band.name(), String::from_utf8_lossy(word.text));
                let reason = format!(
                    "{cell}: this cell and {} more of {cells} cells have no {name} (this one holds {held}); fill them, or \
                     say how to fill them (`--fill`)",
                    count - 1,
                );
                file.error(word.at, reason)
            }
            (error, hole) => file.error(hole.map_or(0, |(word, _)| word.at), error),
        })
    }
}

/// Reads the header and leaves `words` at the first number.
fn header<'a>(file: &File<'a>, words: &mut Words<'a>) -> Result<Header<'a>, FileError> {
    let mut found: BTreeMap<&str, (Word<'a>, f64)> = BTreeMap::new();
    let mut missing = None;
    loop {
        let before = words.clone();
        let Some(word) = words.next() else { break };
        let is_missing = |m: &Word<'_>| word.text.eq_ignore_ascii_case(m.text);
        let key = key_of(&word);
        let is_cell = word.number().is_some() || word.has_decimal_comma();
        if is_cell
            || (!found.is_empty()
                && key.is_none()
                && (word.is_missing_word() || missing.as_ref().is_some_and(is_missing)))
        {
            *words = before;
            break;
        }
        let Some(key) = key else {
            let reason =
                format!("{} is neither a number nor a key; the keys are {}", quoted(word.text), KEYS.join(" "));
            return Err(file.error(word.at, reason));
        };
        let after = words.next();
        let value = after.and_then(|w| w.number());
        // A word may stand for cells without a value, too.
        let is_word = key == "nodata_value" && after.is_some_and(|w| key_of(&w).is_none() && !w.has_decimal_comma());
        let (Some(value), Some(_)) = (value.or(is_word.then_some(f64::NAN)), after) else {
            let (words, hint) = after.map_or(("the end".into(), ""), |w| (quoted(w.text), w.hint()));
            let reason = format!("{key} needs a number, not {words}{hint}");
            return Err(file.error(after.map_or(file.content.len(), |w| w.at), reason));
        };
        if key == "nodata_value" {
            missing = after;
        }
        if found.insert(key, (word, value)).is_some() {
            return Err(file.error(word.at, format!("{key} is given twice")));
        }
    }
    let end = words.clone().next().map_or(file.content.len(), |w| w.at);
    let lacks = |keys: &str| file.error(end, format!("the header ends without {keys}"));
    let twice = |a: &str, b: &str| match (found.get(a), found.get(b)) {
        (Some(_), Some((word, _))) => {
            Err(file.error(word.at, format!("{b} is given in addition to {a}; give only one of them")))
        }
        (first, second) => Ok(first.or(second).copied()),
    };
    let whole = |key: &str| {
        let &(word, value) = found.get(key).ok_or_else(|| lacks(key))?;
        if value.fract() != 0.0 || !(2.0..1e9).contains(&value) {
            return Err(file.error(word.at, format!("{key} is {value}; it must be a whole number of at least 2")));
        }
        Ok((word, value as usize))
    };
    let ((_, columns), (last, rows)) = (whole("ncols")?, whole("nrows")?);
    count(columns, rows).map_err(|e| file.error(last.at, e))?;

    let (dx, dy) = match twice("cellsize", "dx")? {
        None => return Err(lacks("cellsize, or dx and dy")),
        Some(size) if found.contains_key("cellsize") => (size, twice("cellsize", "dy")?.unwrap_or(size)),
        Some(dx) => (dx, *found.get("dy").ok_or_else(|| lacks("dy"))?),
    };
    for (word, value) in [dx, dy] {
        check_place(DVec2::ZERO, DVec2::splat(value)).map_err(|e| {
            let key = String::from_utf8_lossy(word.text);
            file.error(word.at, format!("{key} is {value}; allowed is {}", e.allowed))
        })?;
    }
    let step = DVec2::new(dx.1, dy.1);
    // If the centre of a cell is given, its corner lies half a cell to the south-west.
    let low = |corner: &str, centre: &str, step: f64| {
        let (word, value) = twice(corner, centre)?.ok_or_else(|| lacks(&format!("{corner} or {centre}")))?;
        check_place(DVec2::splat(value), DVec2::ONE).map_err(|e| {
            let key = String::from_utf8_lossy(word.text);
            file.error(word.at, format!("{key} is {value}; allowed is {}", e.allowed))
        })?;
        Ok(if found.contains_key(centre) { value - step / 2.0 } else { value })
    };
    let corner = DVec2::new(low("xllcorner", "xllcenter", step.x)?, low("yllcorner", "yllcenter", step.y)?);
    let missing = match missing {
        Some(word) => (Some(word.text), word.number()),
        None => (None, Some(MISSING)),
    };
    Ok(Header { columns, rows, corner, step, missing })
}

/// How the numbers are spread over lines.
#[derive(Default)]
struct Lines {
    /// Number of lines that hold as many numbers as a row, and of other lines that are not empty.
    whole: usize,
    other: usize,
    /// First byte, and count of numbers, of the current line.
    open: Option<(usize, usize)>,
    /// First byte, index among all lines, and count of numbers of the first line that does not hold a row.
    first_other: Option<(usize, usize, usize)>,
}

impl Lines {
    fn close(&mut self, columns: usize) {
        let Some((at, count)) = self.open.take() else { return };
        if count == columns {
            self.whole += 1;
        } else {
            self.other += 1;
            self.first_other = self.first_other.or(Some((at, self.whole + self.other, count)));
        }
    }
}

/// A cell without a value: its word, and its index in the file.
type Hole<'a> = (Word<'a>, usize);

/// Reads the values, from the northernmost row on; cells without a value are NaN. Also gives the first of these.
fn numbers<'a>(
    file: &File<'a>,
    header: &Header<'_>,
    words: Words<'a>,
    band: Band,
) -> Result<(Vec<f32>, Option<Hole<'a>>), FileError> {
    let cells = header.cells();
    // A number takes at least two bytes.
    let mut values: Vec<f32> = Vec::with_capacity(cells.min((file.content.len() - words.at) / 2 + 1));
    let (mut lines, mut line) = (Lines::default(), usize::MAX);
    let (mut first_hole, mut surplus) = (None, None);
    for word in words {
        if word.line != line {
            lines.close(header.columns);
            line = word.line;
        }
        lines.open = Some(lines.open.map_or((word.at, 1), |(at, count)| (at, count + 1)));
        if values.len() == cells {
            surplus = surplus.or(Some(word.at));
            continue;
        }
        let wrong = |reason: &dyn Display| {
            file.error(word.at, format!("{}: {reason}", cell_name(values.len(), header.columns)))
        };
        let number = word.number();
        if header.is_missing(&word, number, band) {
            first_hole = first_hole.or(Some((word, values.len())));
            values.push(f32::NAN);
            continue;
        }
        let number = number.ok_or_else(|| {
            let (text, hint) = (quoted(word.text), word.hint());
            wrong(&format!("{text} is not a number; the file needs numbers separated by blanks{hint}"))
        })?;
        band.check(number).map_err(|e| wrong(&e))?;
        values.push(number as f32);
    }
    lines.close(header.columns);
    let (columns, rows, end) = (header.columns, header.rows, file.content.len());
    // If lines do not hold rows, only the total number of values counts.
    let lines_are_rows = lines.whole >= lines.other;
    if let (Some((at, row, count)), true) = (lines.first_other, lines_are_rows) {
        return Err(file.error(at, format!("row {row} has {count} numbers; ncols is {columns}")));
    }
    if values.len() < cells {
        let rows_read = values.len() / columns;
        let reason =
            format!("the file ends after {} numbers ({rows_read} of {rows} rows); it needs {cells}", values.len());
        return Err(file.error(end, reason));
    }
    if let Some(at) = surplus {
        return Err(file
            .error(at, format!("numbers continue after the {rows} rows of {columns} that nrows and ncols announce")));
    }
    Ok((values, first_hole))
}
