//! Settlements of a finite domain, from a table of text (CSV).

mod columns;
mod model;
mod numbers;
mod places;
mod read;
mod records;
#[cfg(test)]
mod tests;

pub use model::{Moved, Populations, SettlementRow, SettlementTable, TableOptions, TableReport};
