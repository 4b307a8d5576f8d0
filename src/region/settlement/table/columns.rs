//! What the columns of a table of settlements mean, and the settlement of a row.

use super::model::{SettlementRow, TableOptions};
use super::numbers::{inhabitants, number};
use super::records::{Field, Records};
use crate::edits::SETTLEMENT_RADII;
use crate::layer::{FileError, RangeError, quoted};
use crate::network::SizeClass;
use crate::region::settlement::model::{Settlement, SettlementId};
use crate::region::settlement::settings::SettlementSettings;
use crate::space::{Origin, stable_hash};
use glam::DVec2;
use std::fmt::Display;

/// Greatest absolute value of a coordinate, in metres.
const FARTHEST: f64 = 1e10;
/// Greatest length of a name in bytes.
const LONGEST_NAME: usize = 200;
/// Least and greatest number of inhabitants.
const INHABITANTS: (f64, f64) = (0.0, 1e8);

/// What a column may hold.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Name,
    X,
    Y,
    Sigma,
    Population,
    Radius,
}

/// The headings of the columns of degrees; the coordinates of a plan come after them.
const LONGITUDES: [&str; 4] = ["lon", "lng", "long", "longitude"];
const LATITUDES: [&str; 2] = ["lat", "latitude"];

/// The headings that mean a role, the best first.
fn headings(role: Role, degrees: bool) -> Vec<&'static str> {
    match (role, degrees) {
        (Role::Name, _) => vec!["name", "city", "town", "village", "settlement", "place", "burg"],
        (Role::X, false) => vec!["x", "easting", "east"],
        (Role::Y, false) => vec!["y", "northing", "north"],
        (Role::X, true) => LONGITUDES.into_iter().chain(["x"]).collect(),
        (Role::Y, true) => LATITUDES.into_iter().chain(["y"]).collect(),
        (Role::Sigma, _) => vec!["sigma"],
        (Role::Population, _) => vec!["population", "pop", "inhabitants"],
        (Role::Radius, _) => vec!["radius_m", "radius"],
    }
}

/// The meaning of the fields of a record, by index.
pub(super) struct Columns {
    headings: Vec<String>,
    pub name: usize,
    pub x: usize,
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
    pub fn new(records: &Records<'_>, head: &[Field], degrees: bool) -> Result<Self, FileError> {
        let start = head.first().map_or(0, |f| f.at);
        let has = |heading: &str| head.iter().any(|f| f.text.eq_ignore_ascii_case(heading));
        let find = |role: Role| {
            let Some(heading) = headings(role, degrees).into_iter().find(|h| has(h)) else { return Ok(None) };
            let mut of = (0..head.len()).filter(|i| head[*i].text.eq_ignore_ascii_case(heading));
            let first = of.next();
            match of.next() {
                None => Ok(first),
                Some(again) => {
                    Err(records.error(head[again].at, format!("there are two columns {heading}; keep one of them")))
                }
            }
        };
        let need = |role: Role| {
            find(role)?.ok_or_else(|| {
                let names = headings(role, degrees).join(", ");
                let has_degrees = LONGITUDES.iter().chain(&LATITUDES).any(|h| has(h));
                let hint = match role {
                    Role::X | Role::Y if !degrees && has_degrees => {
                        "; there are degrees: for these the ground has to be in degrees, too (`--geographic`)".into()
                    }
                    _ => format!("; the columns are {}", listed(head)),
                };
                records.error(start, format!("no column is called {names}{hint}"))
            })
        };
        let size = match (find(Role::Sigma)?, find(Role::Population)?) {
            (Some(_), Some(population)) => {
                let reason = "population is given in addition to sigma; give only one of them";
                return Err(records.error(head[population].at, reason));
            }
            (Some(sigma), None) => Size::Sigma(sigma),
            (None, Some(population)) => Size::Population(population),
            (None, None) => {
                let reason = format!("no column is called sigma or population; the columns are {}", listed(head));
                return Err(records.error(start, reason));
            }
        };
        let (name, x, y) = (need(Role::Name)?, need(Role::X)?, need(Role::Y)?);
        if degrees && head[x].text.eq_ignore_ascii_case("x") != head[y].text.eq_ignore_ascii_case("y") {
            let reason = format!("{} and {} are no pair of coordinates", head[x].text, head[y].text);
            return Err(records.error(head[x.max(y)].at, reason));
        }
        let headings = head.iter().map(|f| f.text.clone()).collect();
        Ok(Self { headings, name, x, y, size, radius: find(Role::Radius)? })
    }

    fn is_used(&self, column: usize) -> bool {
        let (Size::Sigma(size) | Size::Population(size)) = self.size;
        [self.name, self.x, self.y, size].contains(&column) || self.radius == Some(column)
    }

    /// The headings of the columns that are used, or of those that are not.
    pub fn listed(&self, used: bool) -> Vec<String> {
        let of = self.headings.iter().enumerate().filter(|(i, h)| self.is_used(*i) == used && !h.is_empty());
        of.map(|(_, heading)| heading.clone()).collect()
    }

    /// The settlement of a record.
    pub fn row(
        &self,
        records: &Records<'_>,
        fields: &[Field],
        settings: &SettlementSettings,
        options: &TableOptions<'_>,
    ) -> Result<SettlementRow, FileError> {
        let (has, needs) = (fields.len(), self.headings.len());
        let is_more = |fields: &[Field]| fields.iter().any(|f| !f.text.is_empty());
        if has < needs || is_more(&fields[needs..]) {
            let at = fields.get(needs).or(fields.first()).map_or(0, |f| f.at);
            return Err(
                records.error(at, format!("this line has {has} fields; it needs one for each of the {needs} columns"))
            );
        }
        let wrong = |column: usize, reason: &dyn Display| records.error(fields[column].at, reason);
        let name = &fields[self.name].text;
        let number = |column: usize, parse: fn(&str) -> Result<f64, &'static str>, (low, high): (f64, f64)| {
            let (heading, text) = (&self.headings[column], &fields[column].text);
            let value = parse(text).map_err(|hint| {
                let of = quoted(name.as_bytes());
                let reason = match text.is_empty() {
                    true => format!("{heading} of {of} is empty; fill it in, or leave such rows out (`--skip-bad`)"),
                    false => {
                        let text = quoted(text.as_bytes());
                        format!("{heading} is {text}; it must be a number from {low} to {high}{hint}")
                    }
                };
                wrong(column, &reason)
            })?;
            RangeError::check(heading, value, low, high).map_err(|e| wrong(column, &e))?;
            Ok(value)
        };
        if name.is_empty() || name.len() > LONGEST_NAME || name.contains(char::is_control) {
            let quoted = quoted(name.as_bytes());
            let heading = &self.headings[self.name];
            let reason = format!("{heading} is {quoted}; it must have 1 to {LONGEST_NAME} bytes on one line");
            return Err(wrong(self.name, &reason));
        }
        let size = match self.size {
            Size::Population(column) => options.populations.class(number(column, inhabitants, INHABITANTS)?),
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
        let (wide, high) = match options.projection {
            Some(_) => ((-180.0, 360.0), (-90.0, 90.0)),
            None => ((-FARTHEST, FARTHEST), (-FARTHEST, FARTHEST)),
        };
        let at = DVec2::new(number(self.x, self::number, wide)?, number(self.y, self::number, high)?);
        let at = options.projection.map_or(at, |g| g.to_plan(at));
        let range = *settings.radius.of(size);
        let radius = match self.radius.filter(|column| !fields[*column].text.is_empty()) {
            Some(column) => number(column, self::number, SETTLEMENT_RADII)?,
            None => (range.0 + range.1) / 2.0,
        };
        let style = settings.styles.of(size).iter().find(|s| s.1 > 0.0).map(|s| s.0.clone()).unwrap_or_default();
        let centre = Origin::at(at + 0.5);
        let settlement = Settlement { id: id(name, &[]), centre, radius, size, style, name: name.clone() };
        let Field { at, line, .. } = fields[self.x];
        Ok(SettlementRow { settlement, line, column: records.column(at) })
    }
}

/// The id of a name; settlements that share a name are told apart by `more`.
pub(super) fn id(name: &str, more: &[u64]) -> SettlementId {
    let words: Vec<u64> = name.bytes().map(u64::from).chain(more.iter().copied()).collect();
    SettlementId(stable_hash(&words).max(1))
}

fn listed(head: &[Field]) -> String {
    head.iter().map(|f| quoted(f.text.as_bytes())).collect::<Vec<_>>().join(" ")
}
