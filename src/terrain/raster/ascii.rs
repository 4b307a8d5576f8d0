//! Reading of ESRI ASCII grids (`.asc`), as GDAL and most surveys write them.
//!
//! A header of keys and numbers is followed by the values of the cells, from the northernmost row on. The format allows any line
//! breaks between them. But where most lines hold one row, as usual, a line that does not is an error.

use super::grid::{Band, Raster, check_place, count};
use super::holes::{self, Holes};
use crate::layer::{FileError, quoted};
use glam::DVec2;
use std::collections::BTreeMap;
use std::fmt::Display;

/// The number in cells without a value, if the header names none.
const MISSING: f64 = -9999.0;
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
        std::str::from_utf8(self.text).ok()?.parse().ok()
    }
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
struct Header {
    columns: usize,
    rows: usize,
    corner: DVec2,
    step: DVec2,
    /// The number in cells without a value.
    missing: f64,
}

impl Header {
    fn cells(&self) -> usize {
        self.columns * self.rows
    }

    /// Row and column, from 1, of the cell at the index `n` in the file.
    fn cell(&self, n: usize) -> String {
        format!("row {}, column {}", n / self.columns + 1, n % self.columns + 1)
    }

    fn is_missing(&self, value: f64) -> bool {
        value as f32 == self.missing as f32 || (value.is_nan() && self.missing.is_nan())
    }
}

impl Raster {
    /// Reads an ESRI ASCII grid: `ncols nrows`, `xllcorner` or `xllcenter`, `yllcorner` or `yllcenter`, `cellsize` or `dx dy`,
    /// and `NODATA_value` (default -9999), in any order and case, then the values. `file` is only named in errors.
    ///
    /// A grid in degrees is read as it is; [`Raster::projected`] moves it to plan metres. Memory is bounded by the length of
    /// `content`, whatever the header says.
    ///
    /// # Errors
    ///
    /// Fails on everything that is not a value of the `band`, and on cells without a value unless `holes` says how to fill them.
    /// Errors name the line and column.
    pub fn from_ascii(file: &str, content: &[u8], band: Band, holes: Holes) -> Result<Self, FileError> {
        let file = File { name: file, content };
        // Some editors put a byte order mark before a text.
        let at = if content.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        let mut words = Words { content, at, line: 0 };
        let header = header(&file, &mut words)?;
        let values = numbers(&file, &header, words, band, holes)?;
        let Header { columns, rows, corner, step, .. } = header;
        Self::new(columns, rows, corner, step, values).map_err(|e| file.error(0, e))
    }
}

/// Reads the header and leaves `words` at the first number.
fn header(file: &File<'_>, words: &mut Words<'_>) -> Result<Header, FileError> {
    let mut found: BTreeMap<&str, (Word<'_>, f64)> = BTreeMap::new();
    loop {
        let before = words.clone();
        let Some(word) = words.next() else { break };
        if word.number().is_some() {
            *words = before;
            break;
        }
        let Some(key) = KEYS.into_iter().find(|k| word.text.eq_ignore_ascii_case(k.as_bytes())) else {
            let reason =
                format!("{} is neither a number nor a key; the keys are {}", quoted(word.text), KEYS.join(" "));
            return Err(file.error(word.at, reason));
        };
        let after = words.next();
        let Some(value) = after.and_then(|w| w.number()) else {
            let reason = format!("{key} needs a number, not {}", after.map_or("the end".into(), |w| quoted(w.text)));
            return Err(file.error(after.map_or(file.content.len(), |w| w.at), reason));
        };
        if found.insert(key, (word, value)).is_some() {
            return Err(file.error(word.at, format!("{key} is given twice")));
        }
    }
    let end = words.clone().next().map_or(file.content.len(), |w| w.at);
    let missing = |keys: &str| file.error(end, format!("the header ends without {keys}"));
    let twice = |a: &str, b: &str| match (found.get(a), found.get(b)) {
        (Some(_), Some((word, _))) => {
            Err(file.error(word.at, format!("{b} is given in addition to {a}; give only one of them")))
        }
        (first, second) => Ok(first.or(second).copied()),
    };
    let whole = |key: &str| {
        let &(word, value) = found.get(key).ok_or_else(|| missing(key))?;
        if value.fract() != 0.0 || !(2.0..1e9).contains(&value) {
            return Err(file.error(word.at, format!("{key} is {value}; it must be a whole number of at least 2")));
        }
        Ok((word, value as usize))
    };
    let ((_, columns), (last, rows)) = (whole("ncols")?, whole("nrows")?);
    count(columns, rows).map_err(|e| file.error(last.at, e))?;

    let (dx, dy) = match twice("cellsize", "dx")? {
        None => return Err(missing("cellsize, or dx and dy")),
        Some(size) if found.contains_key("cellsize") => (size, twice("cellsize", "dy")?.unwrap_or(size)),
        Some(dx) => (dx, *found.get("dy").ok_or_else(|| missing("dy"))?),
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
        let (word, value) = twice(corner, centre)?.ok_or_else(|| missing(&format!("{corner} or {centre}")))?;
        check_place(DVec2::splat(value), DVec2::ONE).map_err(|e| {
            let key = String::from_utf8_lossy(word.text);
            file.error(word.at, format!("{key} is {value}; allowed is {}", e.allowed))
        })?;
        Ok(if found.contains_key(centre) { value - step / 2.0 } else { value })
    };
    let corner = DVec2::new(low("xllcorner", "xllcenter", step.x)?, low("yllcorner", "yllcenter", step.y)?);
    let missing = found.get("nodata_value").map_or(MISSING, |f| f.1);
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

/// Reads the values. The result has the order of a raster: rows from south to north.
fn numbers(
    file: &File<'_>,
    header: &Header,
    words: Words<'_>,
    band: Band,
    holes: Holes,
) -> Result<Vec<f32>, FileError> {
    let cells = header.cells();
    // A number takes at least two bytes.
    let mut values: Vec<f32> = Vec::with_capacity(cells.min((file.content.len() - words.at) / 2 + 1));
    let (mut lines, mut line) = (Lines::default(), usize::MAX);
    let (mut first_hole, mut hole_count, mut surplus) = (None, 0usize, None);
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
        let wrong = |reason: &dyn Display| file.error(word.at, format!("{}: {reason}", header.cell(values.len())));
        let number = word.number().ok_or_else(|| {
            let comma = if word.text.contains(&b',') { ", and a decimal point instead of a comma" } else { "" };
            wrong(&format!("{} is not a number; the file needs numbers separated by blanks{comma}", quoted(word.text)))
        })?;
        if header.is_missing(number) {
            first_hole = first_hole.or(Some((word.at, values.len())));
            hole_count += 1;
            values.push(f32::NAN);
        } else {
            band.check(number).map_err(|e| wrong(&e))?;
            values.push(number as f32);
        }
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
    if let Some((at, n)) = first_hole {
        match holes {
            Holes::Refuse => {
                let reason = format!(
                    "{}: this cell and {} more of {cells} cells have no {} (they hold {}); fill them, or say how to fill them",
                    header.cell(n),
                    hole_count - 1,
                    band.name(),
                    header.missing,
                );
                return Err(file.error(at, reason));
            }
            Holes::FromNeighbours if hole_count == cells => {
                return Err(file.error(at, format!("no cell of this file has a {}", band.name())));
            }
            Holes::FromNeighbours => holes::from_neighbours(&mut values, columns),
            Holes::Value(value) => {
                band.check(value).map_err(|e| file.error(at, format!("the value for cells without a value: {e}")))?;
                values.iter_mut().filter(|v| v.is_nan()).for_each(|v| *v = value as f32);
            }
        }
    }
    let (mut south, mut north) = (0, rows - 1);
    while south < north {
        let (low, high) = values.split_at_mut(north * columns);
        low[south * columns..(south + 1) * columns].swap_with_slice(&mut high[..columns]);
        (south, north) = (south + 1, north - 1);
    }
    Ok(values)
}
