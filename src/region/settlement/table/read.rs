//! Reading of a table of settlements.

use super::columns::{Columns, id};
use super::model::{SettlementRow, SettlementTable, TableOptions, TableReport};
use super::records::Records;
use crate::layer::FileError;
use crate::region::settlement::settings::SettlementSettings;
use std::collections::BTreeMap;

impl SettlementTable {
    /// Reads a table in UTF-8 with commas, semicolons or tabs between its fields. `file` is only named in errors. The first line
    /// names the columns, in any order:
    ///
    /// | column | meaning |
    /// |---|---|
    /// | `name`, or `city`, `town`, `village`, `settlement`, `place`, `burg` | name of the settlement |
    /// | `x`, `y`, or `easting`, `northing` | centre in plan metres, rounded to whole metres |
    /// | `lon`, `lat`, or `lng`, `long`, `longitude`, `latitude`, or `x`, `y` | with [`TableOptions::projection`]: centre in degrees |
    /// | `sigma` | size class: 0 village, 1 town, 2 city |
    /// | `population`, or `pop`, `inhabitants` | instead of `sigma`: number of inhabitants, 0 to 100,000,000, from which [`Populations`](crate::region::Populations) give the size class; thousands may be set apart (`1,200`) |
    /// | `radius_m`, or `radius` | optional, and may be empty: radius in metres, 120 to 5,000 |
    ///
    /// The first of several headings for the same counts. Other columns, and rows without any value, are left out; see
    /// [`SettlementTable::report`].
    ///
    /// A settlement without a radius gets the middle of the range that `settings` have for its size class. Its style is the first
    /// one that they have for the class. Ids depend on names only, so rows may be moved and added; where several settlements have
    /// the same name, they depend on the place, too.
    ///
    /// # Errors
    ///
    /// Fails on missing columns, on values that are not numbers or out of range, and on two settlements at the same position.
    /// Errors name the line and column. With [`TableOptions::skip_bad`] such rows are left out; that no row is left is an error.
    pub fn from_csv(
        file: &str,
        content: &[u8],
        settings: &SettlementSettings,
        options: &TableOptions<'_>,
    ) -> Result<Self, FileError> {
        let records = Records::new(file, content)?;
        let mut lines = records.read()?.into_iter();
        let head =
            lines.next().ok_or_else(|| records.error(0, "the file is empty; its first line must name the columns"))?;
        let columns = Columns::new(&records, &head, options.projection.is_some())?;
        let mut report = TableReport {
            columns: columns.listed(true),
            columns_left_out: columns.listed(false),
            ..TableReport::default()
        };
        let mut rows: Vec<SettlementRow> = Vec::new();
        let mut names: BTreeMap<String, usize> = BTreeMap::new();
        let mut places: BTreeMap<[i64; 2], usize> = BTreeMap::new();
        for fields in lines {
            if fields.iter().all(|f| f.text.is_empty()) {
                report.empty_rows += 1;
                continue;
            }
            let row = columns.row(&records, &fields, settings, options).and_then(|row| {
                match places.insert(row.settlement.centre.0.to_array(), row.line) {
                    None => Ok(row),
                    Some(line) => {
                        let reason = format!("line {line} has the same position; each position may occur once");
                        Err(records.error(fields[columns.x].at, reason))
                    }
                }
            });
            match row {
                Ok(row) => {
                    *names.entry(row.settlement.name.clone()).or_default() += 1;
                    rows.push(row);
                }
                Err(error) if options.skip_bad => report.rows_left_out.push(error),
                Err(error) => return Err(error),
            }
        }
        if rows.is_empty() {
            let reason = match report.rows_left_out.first() {
                None => "the file has column names but no settlement".to_owned(),
                Some(first) => format!("every row is left out; line {}: {}", first.line, first.reason),
            };
            return Err(records.error(records.end(), reason));
        }
        for row in &mut rows {
            let settlement = &mut row.settlement;
            if names.get(&settlement.name).is_some_and(|count| *count > 1) {
                let place = settlement.centre.0.to_array().map(|c| c as u64);
                settlement.id = id(&settlement.name, &place);
            }
        }
        report.repeated_names = rows.len() - names.len();
        Ok(Self { file: file.to_owned(), rows, report })
    }
}
