//! Planning a settlement: growth of main streets, gates, repair, arterials, roundabouts and squares, borders, main cells.
//!
//! [`compose`] calls the steps in order. They work on one [`Sketch`](sketch::Sketch) and test every street that they add as
//! a [`Proposal`](proposal::Proposal).

mod arterial;
mod border;
mod cell_graph;
mod cells;
mod compose;
mod connect;
mod curves;
mod grow;
mod open_spaces;
mod proposal;
mod quays;
mod repair;
mod river;
mod rules;
mod simple;
mod site;
mod sketch;
#[cfg(test)]
mod tests;

pub use compose::plan;
