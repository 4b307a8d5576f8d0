//! A table of settlements, and how it is read.

use crate::layer::FileError;
use crate::network::SizeClass;
use crate::region::settlement::model::Settlement;
use crate::space::Geographic;

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
    pub(super) fn class(&self, inhabitants: f64) -> SizeClass {
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

/// How a table is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TableOptions<'a> {
    /// Makes plan metres of degrees; without it, places are in plan metres.
    pub projection: Option<&'a Geographic>,
    /// Size classes for a column of inhabitants.
    pub populations: Populations,
    /// Leaves rows out that have an error, instead of refusing the table.
    pub skip_bad: bool,
}

/// A settlement that was moved out of the water.
#[derive(Clone, Debug, PartialEq)]
pub struct Moved {
    /// Its name.
    pub name: String,
    /// How far it was moved, in metres.
    pub distance: f64,
}

/// What was used of a table, and what was left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableReport {
    /// Headings of the columns that were used.
    pub columns: Vec<String>,
    /// Headings of the columns that were not.
    pub columns_left_out: Vec<String>,
    /// Rows without any value.
    pub empty_rows: usize,
    /// Rows that were left out because of an error, with the reasons.
    pub rows_left_out: Vec<FileError>,
    /// Rows that share their name with an earlier one.
    pub repeated_names: usize,
    /// Settlements that were moved out of the water.
    pub moved: Vec<Moved>,
}

/// The settlements of a table, in the order of its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct SettlementTable {
    /// Name of the file as it was given.
    pub file: String,
    /// At least one row. No two rows have the same position.
    pub rows: Vec<SettlementRow>,
    /// What was used, and what was left out.
    pub report: TableReport,
}

impl SettlementTable {
    /// The settlements, without their positions in the file.
    pub fn settlements(&self) -> impl Iterator<Item = &Settlement> {
        self.rows.iter().map(|r| &r.settlement)
    }
}
