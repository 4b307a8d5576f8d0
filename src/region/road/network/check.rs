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

/// Where the settlements of a network may stand.
pub(super) struct BuildingSite<'a> {
    pub domain: Bounds,
    pub terrain: &'a dyn Terrain,
    /// Spacing of the lattice in metres.
    pub step: i64,
}

impl BuildingSite<'_> {
    /// Fails if one of the settlements cannot stand where it is.
    pub fn check(&self, settlements: &[Settlement]) -> Result<(), NetworkError> {
        for (index, s) in settlements.iter().enumerate() {
            let wrong = self.unfit(s, &settlements[..index]);
            wrong.map_or(Ok(()), |reason| Err(NetworkError::Settlement { index, reason }))?;
        }
        Ok(())
    }

    /// Why a settlement cannot stand where it is, beside others; `None` if it can.
    pub fn unfit(&self, s: &Settlement, others: &[Settlement]) -> Option<String> {
        let at = s.centre.plan();
        if !self.domain.contains(at) {
            let (low, high) = (self.domain.min, self.domain.max);
            return Some(format!(
                "{} at {},{} m lies outside of the domain; allowed is x {:.0} to {:.0}, y {:.0} to {:.0}",
                s.name, at.x, at.y, low.x, high.x, low.y, high.y
            ));
        }
        let depth = self.terrain.sample(at).depth();
        if depth > 0.0 {
            return Some(format!(
                "{} at {},{} m lies under {depth:.1} m of water; a settlement needs dry ground",
                s.name, at.x, at.y
            ));
        }
        let least = LEAST_APART * self.step as f64;
        others.iter().find_map(|other| {
            let apart = s.centre.offset_to(other.centre).length();
            if other.id == s.id {
                return Some(format!("{} and {} have the same id; every id may occur once", s.name, other.name));
            }
            (apart < least).then(|| {
                format!(
                    "{} lies {apart:.0} m from {}; keep at least {LEAST_APART} steps of the lattice ({least:.0} m) between them",
                    s.name, other.name
                )
            })
        })
    }
}
