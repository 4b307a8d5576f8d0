//! Checks of a domain and its settlements.

use crate::layer::{LayerError, RangeError};
use crate::region::settlement::Settlement;
use crate::space::Bounds;
use crate::terrain::Terrain;

/// Greatest number of nodes that the lattice of a domain may have.
const MOST_NODES: f64 = 4_194_304.0;
/// Least distance between two settlements in steps of the lattice, so that no node is the nearest to both.
const LEAST_APART: f64 = 1.5;

/// Why a network cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NetworkError {
    /// A setting or the domain is out of range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// There is nothing to connect.
    #[error("a network needs at least two settlements; found {0}")]
    TooFew(usize),
    /// A settlement cannot stand where it is.
    #[error("{reason}")]
    Settlement {
        /// Index in the given list.
        index: usize,
        /// What is wrong, and what is allowed. One line.
        reason: String,
    },
    /// The work was cancelled.
    #[error(transparent)]
    Layer(#[from] LayerError),
}

pub(super) fn check_domain(domain: Bounds, step: i64) -> Result<(), RangeError> {
    let size = domain.size();
    for (field, at) in [("domain.min.x", domain.min.x), ("domain.min.y", domain.min.y)] {
        RangeError::check(field, at, -1e10, 1e10)?;
    }
    RangeError::check("width of the domain", size.x, 0.0, 1e9)?;
    RangeError::check("height of the domain", size.y, 0.0, 1e9)?;
    let least = (size.x * size.y / MOST_NODES).sqrt().ceil();
    RangeError::check("step", step as f64, least, size.min_element() / 2.0)
}

pub(super) fn check_settlements(
    domain: Bounds,
    terrain: &dyn Terrain,
    settlements: &[Settlement],
    step: i64,
) -> Result<(), NetworkError> {
    if settlements.len() < 2 {
        return Err(NetworkError::TooFew(settlements.len()));
    }
    for (index, s) in settlements.iter().enumerate() {
        let at = s.centre.plan();
        let wrong = |reason: String| Err(NetworkError::Settlement { index, reason });
        if !domain.contains(at) {
            let (low, high) = (domain.min, domain.max);
            return wrong(format!(
                "{} at {},{} m lies outside of the domain; allowed is x {:.0} to {:.0}, y {:.0} to {:.0}",
                s.name, at.x, at.y, low.x, high.x, low.y, high.y
            ));
        }
        let depth = terrain.sample(at).depth();
        if depth > 0.0 {
            return wrong(format!(
                "{} at {},{} m lies under {depth:.1} m of water; a settlement needs dry ground",
                s.name, at.x, at.y
            ));
        }
        for other in &settlements[..index] {
            let apart = s.centre.offset_to(other.centre).length();
            if other.id == s.id {
                return wrong(format!("{} and {} have the same id; every id may occur once", s.name, other.name));
            }
            let least = LEAST_APART * step as f64;
            if apart < least {
                return wrong(format!(
                    "{} lies {apart:.0} m from {}; keep at least {LEAST_APART} steps of the lattice ({least:.0} m) between them",
                    s.name, other.name
                ));
            }
        }
    }
    Ok(())
}
