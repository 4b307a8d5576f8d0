//! The table of settlements that `sprawl roads` reads.

use super::args::RoadsArgs;
use crate::fail::Fail;
use bevy_sprawl::layer::read_file;
use bevy_sprawl::region::{SettlementSettings, SettlementTable, TableOptions, TableReport};
use bevy_sprawl::space::Geographic;
use bevy_sprawl::terrain::RasterTerrain;
use serde_json::{Value, json};

/// Tables are read up to this size, in bytes.
const LARGEST: u64 = 256 << 20;
/// Most rows that lines for people name.
const MOST_NAMED: usize = 10;

/// Reads the table, and finds every settlement a place on land.
pub fn read(
    args: &RoadsArgs,
    settings: &SettlementSettings,
    projection: Option<&Geographic>,
    terrain: &RasterTerrain,
) -> Result<SettlementTable, Fail> {
    let content = read_file(&args.settlements, LARGEST)?;
    let options = TableOptions { projection, populations: args.populations, skip_bad: args.skip_bad };
    let name = args.settlements.to_string_lossy();
    let mut table = SettlementTable::from_csv(&name, &content, settings, &options)?;
    let domain = terrain.bounds();
    if let Some(metres) = args.snap {
        table.move_to_land(domain, terrain, metres);
    }
    if args.skip_bad {
        table.leave_out_misplaced(domain, terrain);
    }
    table.check_places(domain, terrain)?;
    Ok(table)
}

/// What was used of the table, as the JSON report has it.
pub fn json(report: &TableReport) -> Value {
    json!({
        "columns": report.columns,
        "columns_left_out": report.columns_left_out,
        "empty_rows": report.empty_rows,
        "rows_left_out": report.rows_left_out.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "repeated_names": report.repeated_names,
        "moved_to_land": report.moved.iter().map(|m| json!({ "name": m.name, "distance_m": m.distance.round() })).collect::<Vec<_>>(),
    })
}

/// Lines for people on what is not as in the table.
pub fn people(table: &SettlementTable) -> String {
    let (file, report) = (&table.file, &table.report);
    let mut out = String::new();
    let mut notes = Vec::new();
    if !report.columns_left_out.is_empty() {
        notes.push(format!("columns left out: {}", report.columns_left_out.join(", ")));
    }
    if report.empty_rows > 0 {
        notes.push(format!("{} empty rows", report.empty_rows));
    }
    if report.repeated_names > 0 {
        notes.push(format!("{} names that occur again", report.repeated_names));
    }
    if !report.moved.is_empty() {
        let named = report.moved.iter().take(MOST_NAMED).map(|m| format!("{} ({:.0} m)", m.name, m.distance));
        notes.push(format!("{} moved to land: {}", report.moved.len(), named.collect::<Vec<_>>().join(", ")));
    }
    if !report.rows_left_out.is_empty() {
        notes.push(format!("{} rows left out", report.rows_left_out.len()));
    }
    if !notes.is_empty() {
        out += &format!("\n{file}: {}", notes.join("; "));
    }
    for error in report.rows_left_out.iter().take(MOST_NAMED) {
        out += &format!("\nleft out: {error}");
    }
    out
}
