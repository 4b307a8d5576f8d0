//! What any filler works with, and what knows of no filler: the canvas that a cell's streets are drawn on, the check that
//! every street passes before it is built, growth, repair, and the finished streets.
//!
//! A filler makes a [`Draft`] of its brief, lays [stubs](lay_stubs) and whatever it lays, [propagates](propagate) from the
//! candidate vertices, [repairs](repair), [straightens](make_fair) and [finishes](finish). What it lays is a [`Proposal`],
//! which is built if it keeps to the [`Limits`].

mod bands;
mod canvas;
mod checker;
mod division;
mod draft;
mod exceptions;
mod fairing;
mod floating;
mod free_grid;
mod growth;
mod joint;
mod landing;
mod mend;
mod obstacle;
mod output;
mod proposal;
mod refit;
mod repair;
mod rounding;
mod rules;
mod squares;
mod stubs;

pub use canvas::Maker;
pub use draft::Draft;
pub use fairing::make_fair;
pub use floating::{connect_parts, floating};
pub use free_grid::{FreeGrid, STEP};
pub use growth::propagate;
pub use joint::joint_angle_fits;
pub use landing::landing_place;
pub use obstacle::{LooseEnd, NONE, Obstacle, nearest};
pub use output::finish;
pub use proposal::{Join, Proposal};
pub use repair::repair;
pub use rules::{Limits, WEDGE, drawing_rules};
pub use stubs::{RemovedStubs, grow_from_stubs, has_stub, lay_stubs, stub_end};
