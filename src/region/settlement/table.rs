//! Settlements of a finite domain, from a CSV file.

use super::model::{Settlement, SettlementId};
use super::settings::SettlementSettings;
use crate::edits::SETTLEMENT_RADII;
use crate::layer::{FileError, RangeError, quoted};
use crate::network::SizeClass;
use crate::space::{Bounds, Geographic, Origin, stable_hash};
use csv_core::ReadFieldResult;
use glam::DVec2;
use std::collections::BTreeMap;
use std::fmt::Display;

/// Greatest absolute value of a coordinate, in metres.
const FARTHEST: f64 = 1e10;
/// Greatest length of a name in bytes.
const LONGEST_NAME: usize = 200;
/// Least and greatest number of inhabitants.
const INHABITANTS: (f64, f64) = (0.0, 1e8);

/// Size classes by number of inhabitants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Populations {
    /// Least number of inhabitants of a town.
    pub town: f64,
    /// Least number of inhabitants of a city.
    pub city: f64,
}

impl Default for Populations {
    /// Towns have at least 2,000 inhabitants, cities at least 20,000.
    fn default() -> Self {
        Self { town: 2_000.0, city: 20_000.0 }
    }
}

impl Populations {
    fn class(&self, inhabitants: f64) -> SizeClass {
        if inhabitants >= self.city {
            SizeClass::City
        } else if inhabitants >= self.town {
            SizeClass::Town
        } else {
            SizeClass::Village
        }
    }
}

/// A settlement and its position in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct SettlementRow {
    /// The settlement.
    pub settlement: Settlement,
    /// Line of the file, from 1.
    pub line: usize,
    /// Column of the settlement's first coordinate in that line, from 1.
    pub column: usize,
}

/// The settlements of a CSV file, in the order of its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct SettlementTable {
    /// Name of the file as it was given.
    pub file: String,
    /// At least one row. No two rows have the same name or position.
    pub rows: Vec<SettlementRow>,
}

impl SettlementTable {
    /// Reads a CSV file (RFC 4180, UTF-8). `file` is only named in errors. The first line names the columns, in any order:
    ///
    /// | column | meaning |
    /// |---|---|
    /// | `name` | name of the settlement, different in every row |
    /// | `x`, `y` | centre in plan metres, rounded to whole metres; with `geographic`, longitude and latitude in degrees, and the columns may also be called `lon`, `lat` |
    /// | `sigma` | size class: 0 village, 1 town, 2 city |
    /// | `population` | instead of `sigma`: number of inhabitants, 0 to 100,000,000, from which [`Populations`] give the size class |
    /// | `radius_m` | optional, and may be empty: radius in metres, 120 to 5,000 |
    ///
    /// A settlement without a radius gets the middle of the range that `settings` have for its size class. Its style is the first
    /// one that they have for the class. Ids depend on names only, so rows may be moved and added.
    ///
    /// # Errors
    ///
    /// Fails on unknown or missing columns, on values that are not numbers or out of range, and on two settlements with the same
    /// name or position. Errors name the line and column.
    pub fn from_csv(
        file: &str,
        content: &[u8],
        settings: &SettlementSettings,
        geographic: Option<&Geographic>,
    ) -> Result<Self, FileError> {
        Self::from_csv_by(file, content, settings, geographic, &Populations::default())
    }

    /// The same with other size classes for a column of inhabitants.
    ///
    /// # Errors
    ///
    /// Fails for the reasons of [`from_csv`](Self::from_csv).
    pub fn from_csv_by(
        file: &str,
        content: &[u8],
        settings: &SettlementSettings,
        geographic: Option<&Geographic>,
        populations: &Populations,
    ) -> Result<Self, FileError> {
        let records = Records { file, content };
        let mut lines = records.read()?.into_iter();
        let head =
            lines.next().ok_or_else(|| records.error(0, "the file is empty; its first line must name the columns"))?;
        let columns = Columns::new(&records, &head, geographic.is_some())?;
        let mut rows: Vec<SettlementRow> = Vec::new();
        let mut names: BTreeMap<String, usize> = BTreeMap::new();
        let mut places = BTreeMap::new();
        for fields in lines {
            let row = columns.row(&records, &fields, settings, geographic, populations)?;
            let again = |what: &str, of: usize, at: usize| {
                let first = rows.get(of).map_or(0, |r| r.line);
                records.error(at, format!("line {first} has the same {what}; each {what} may occur once"))
            };
            if let Some(of) = names.insert(row.settlement.name.clone(), rows.len()) {
                return Err(again("name", of, fields[columns.name].at));
            }
            if let Some(of) = places.insert(row.settlement.centre.0.to_array(), rows.len()) {
                return Err(again("position", of, fields[columns.x].at));
            }
            rows.push(row);
        }
        if rows.is_empty() {
            return Err(records.error(content.len(), "the file has column names but no settlement"));
        }
        Ok(Self { file: file.to_owned(), rows })
    }

    /// Checks that all settlements lie in `domain` (plan metres).
    ///
    /// # Errors
    ///
    /// Names the first settlement whose centre lies outside, with its line and column.
    pub fn check_inside(&self, domain: Bounds) -> Result<(), FileError> {
        let Some(row) = self.rows.iter().find(|r| !domain.contains(r.settlement.centre.plan())) else { return Ok(()) };
        let (at, low, high) = (row.settlement.centre.plan(), domain.min, domain.max);
        let name = quoted(row.settlement.name.as_bytes());
        let reason = format!(
            "{name} at {},{} m lies outside of the domain; allowed is x {:.0} to {:.0}, y {:.0} to {:.0}",
            at.x, at.y, low.x, high.x, low.y, high.y
        );
        Err(FileError { file: self.file.clone(), line: row.line, column: row.column, reason })
    }

    /// The settlements, without their positions in the file.
    pub fn settlements(&self) -> impl Iterator<Item = &Settlement> {
        self.rows.iter().map(|r| &r.settlement)
    }
}

/// A field of a record, without the quotes and blanks around it.
struct Field {
    /// Byte in the file, and line from 1.
    at: usize,
    line: usize,
    text: String,
}

/// A CSV file and its name, for error messages.
struct Records<'a> {
    file: &'a str,
    content: &'a [u8],
}

impl Records<'_> {
    fn error(&self, at: usize, reason: impl Display) -> FileError {
        FileError::at(self.file, self.content, at, reason)
    }

    /// All records, without empty lines.
    fn read(&self) -> Result<Vec<Vec<Field>>, FileError> {
        // With a line break at the end, only an open quote can make the last field end with the file.
        let mut rest = self.content.to_vec();
        rest.push(b'\n');
        // A field is never longer than the file.
        let mut buffer = vec![0; rest.len()];
        let mut reader = csv_core::Reader::new();
        let (mut records, mut record) = (Vec::new(), Vec::new());
        let (mut at, mut last) = (0, 0);
        // Lines are counted on the way. Counting from the start for each row would take hours for a long file.
        let (mut line, mut counted) = (1, 0);
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
                    line += self.content[counted..start.max(counted)].iter().filter(|b| **b == b'\n').count();
                    counted = start.max(counted);
                    record.push(Field { at: start, line, text: self.text(start, &buffer[..written])? });
                    if record_end {
                        records.push(std::mem::take(&mut record));
                    }
                }
            }
            at += read;
        }
    }

    /// First byte of a field that is read from byte `at` on: after blanks and, if the field is the first of its record, after a byte
    /// order mark and line breaks.
    fn start(&self, at: usize, first: bool) -> usize {
        let mark: &[u8] = b"\xef\xbb\xbf";
        let at = if at == 0 && self.content.starts_with(mark) { mark.len() } else { at };
        let before = |b: &&u8| matches!(b, b' ' | b'\t') || (first && matches!(b, b'\r' | b'\n'));
        at + self.content[at.min(self.content.len())..].iter().take_while(before).count()
    }

    fn text(&self, at: usize, content: &[u8]) -> Result<String, FileError> {
        let text =
            std::str::from_utf8(content).map_err(|_| self.error(at, "this is not UTF-8; save the file as UTF-8"))?;
        Ok(text.trim().to_owned())
    }

    /// Column of a byte in its line, from 1.
    fn column(&self, at: usize) -> usize {
        let line_start = self.content[..at].iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
        FileError::at("", &self.content[line_start..], at - line_start, "").column
    }
}

/// The meaning of the fields of a record, by index.
struct Columns {
    names: Vec<String>,
    name: usize,
    x: usize,
    y: usize,
    size: Size,
    radius: Option<usize>,
}

/// The column that gives the size of a settlement.
#[derive(Clone, Copy)]
enum Size {
    Sigma(usize),
    Population(usize),
}

impl Columns {
    fn new(records: &Records<'_>, head: &[Field], degrees: bool) -> Result<Self, FileError> {
        let known: &[(&str, usize)] = match degrees {
            true => &[
                ("name", 0),
                ("x", 1),
                ("lon", 1),
                ("y", 2),
                ("lat", 2),
                ("sigma", 3),
                ("radius_m", 4),
                ("population", 5),
            ],
            false => &[("name", 0), ("x", 1), ("y", 2), ("sigma", 3), ("radius_m", 4), ("population", 5)],
        };
        let mut found = [None; 6];
        for (i, field) in head.iter().enumerate() {
            let Some((name, which)) = known.iter().find(|(name, _)| field.text.eq_ignore_ascii_case(name)) else {
                let names: Vec<&str> = known.iter().map(|k| k.0).collect();
                let text = quoted(field.text.as_bytes());
                let reason =
                    format!("{text} is not a column; the columns are {}, separated by commas", names.join(" "));
                return Err(records.error(field.at, reason));
            };
            if found[*which].replace(i).is_some() {
                return Err(records
                    .error(field.at, format!("{name} gives the same value as an earlier column; keep one of them")));
            }
        }
        let need = |which: usize| {
            found[which].ok_or_else(|| {
                let name = known.iter().find(|k| k.1 == which).map_or("", |k| k.0);
                records.error(head.first().map_or(0, |f| f.at), format!("the column {name} is missing"))
            })
        };
        let size = match (found[3], found[5]) {
            (Some(_), Some(population)) => {
                let reason = "population is given in addition to sigma; give only one of them";
                return Err(records.error(head[population].at, reason));
            }
            (Some(sigma), None) => Size::Sigma(sigma),
            (None, Some(population)) => Size::Population(population),
            (None, None) => {
                let at = head.first().map_or(0, |f| f.at);
                return Err(records.error(at, "the column sigma or population is missing"));
            }
        };
        let names = head.iter().map(|f| f.text.clone()).collect();
        Ok(Self { names, name: need(0)?, x: need(1)?, y: need(2)?, size, radius: found[4] })
    }

    fn row(
        &self,
        records: &Records<'_>,
        fields: &[Field],
        settings: &SettlementSettings,
        geographic: Option<&Geographic>,
        populations: &Populations,
    ) -> Result<SettlementRow, FileError> {
        let (has, needs) = (fields.len(), self.names.len());
        if has != needs {
            let at = fields.get(needs).or(fields.first()).map_or(0, |f| f.at);
            return Err(
                records.error(at, format!("this line has {has} fields; it needs one for each of the {needs} columns"))
            );
        }
        let wrong = |column: usize, reason: &dyn Display| records.error(fields[column].at, reason);
        let number = |column: usize, (low, high): (f64, f64)| {
            let (name, text) = (&self.names[column], &fields[column].text);
            let value: f64 = text.parse().map_err(|_| {
                wrong(
                    column,
                    &format!("{name} is {}; it must be a number from {low} to {high}", quoted(text.as_bytes())),
                )
            })?;
            RangeError::check(name, value, low, high).map_err(|e| wrong(column, &e))?;
            Ok(value)
        };

        let name = &fields[self.name].text;
        if name.is_empty() || name.len() > LONGEST_NAME || name.contains(char::is_control) {
            let quoted = quoted(name.as_bytes());
            let reason = format!("name is {quoted}; it must have 1 to {LONGEST_NAME} bytes on one line");
            return Err(wrong(self.name, &reason));
        }
        let size = match self.size {
            Size::Population(column) => populations.class(number(column, INHABITANTS)?),
            Size::Sigma(column) => match fields[column].text.as_str() {
                "0" => SizeClass::Village,
                "1" => SizeClass::Town,
                "2" => SizeClass::City,
                other => {
                    let other = quoted(other.as_bytes());
                    let reason = format!("sigma is {other}; it must be 0 (village), 1 (town) or 2 (city)");
                    return Err(wrong(column, &reason));
                }
            },
        };
        let (wide, high) = match geographic {
            Some(_) => ((-180.0, 360.0), (-90.0, 90.0)),
            None => ((-FARTHEST, FARTHEST), (-FARTHEST, FARTHEST)),
        };
        let at = DVec2::new(number(self.x, wide)?, number(self.y, high)?);
        let at = geographic.map_or(at, |g| g.to_plan(at));
        let range = *settings.radius.of(size);
        let radius = match self.radius.filter(|column| !fields[*column].text.is_empty()) {
            Some(column) => number(column, SETTLEMENT_RADII)?,
            None => (range.0 + range.1) / 2.0,
        };
        let style = settings.styles.of(size).iter().find(|s| s.1 > 0.0).map(|s| s.0.clone()).unwrap_or_default();
        let id = SettlementId(stable_hash(&name.bytes().map(u64::from).collect::<Vec<_>>()).max(1));
        let centre = Origin::at(at + 0.5);
        let settlement = Settlement { id, centre, radius, size, style, name: name.clone() };
        let Field { at, line, .. } = fields[self.x];
        Ok(SettlementRow { settlement, line, column: records.column(at) })
    }
}

#[cfg(test)]
mod tests;
