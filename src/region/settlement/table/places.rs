//! Where the settlements of a table stand: in the domain, on dry ground.

use super::model::{Moved, SettlementTable};
use crate::layer::{FileError, quoted};
use crate::space::{Bounds, Origin, math};
use crate::terrain::Terrain;
use glam::DVec2;
use std::f64::consts::TAU;

/// Distance of the first ring that is searched for land, in metres, and of each further one as a multiple of the ring before.
const RINGS: (f64, f64) = (4.0, 1.06);
/// Places on a ring.
const ON_RING: usize = 96;
/// Most settlements that an error names.
const MOST_NAMED: usize = 20;

/// Why a settlement cannot stand at a place; `None` where it can.
fn fault(at: DVec2, domain: Bounds, terrain: &dyn Terrain) -> Option<String> {
    if !domain.contains(at) {
        let (low, high) = (domain.min, domain.max);
        return Some(format!(
            "lies outside of the domain; allowed is x {:.0} to {:.0}, y {:.0} to {:.0}",
            low.x, high.x, low.y, high.y
        ));
    }
    let depth = terrain.sample(at).depth();
    (depth > 0.0).then(|| format!("lies under {depth:.1} m of water; a settlement needs dry ground"))
}

impl SettlementTable {
    /// Checks that all settlements lie in `domain` (plan metres), on dry ground.
    ///
    /// # Errors
    ///
    /// Names the first settlement that does not, with its line and column and the reason, and all others by name and line.
    pub fn check_places(&self, domain: Bounds, terrain: &dyn Terrain) -> Result<(), FileError> {
        let faults: Vec<(usize, String)> = self.faults(domain, terrain);
        let Some((first, fault)) = faults.first() else { return Ok(()) };
        let row = &self.rows[*first];
        let named = |i: usize| quoted(self.rows[i].settlement.name.as_bytes());
        let others: Vec<String> = faults[1..]
            .iter()
            .take(MOST_NAMED)
            .map(|(i, _)| format!("{} (line {})", named(*i), self.rows[*i].line))
            .collect();
        let more = faults.len().saturating_sub(MOST_NAMED + 1);
        let others = match (others.is_empty(), more) {
            (true, _) => String::new(),
            (false, 0) => format!("; nor can {}", others.join(", ")),
            (false, more) => format!("; nor can {} and {more} more", others.join(", ")),
        };
        let at = row.settlement.centre.plan();
        let reason = format!("{} at {},{} m {fault}{others}", named(*first), at.x, at.y);
        Err(FileError::new(&*self.file, (row.line, row.column), reason))
    }

    /// Leaves out the settlements that lie outside of `domain` or in water. Each is in
    /// [`rows_left_out`](super::model::TableReport::rows_left_out) then.
    pub fn leave_out_misplaced(&mut self, domain: Bounds, terrain: &dyn Terrain) {
        let mut faults = self.faults(domain, terrain).into_iter().peekable();
        for (i, row) in std::mem::take(&mut self.rows).into_iter().enumerate() {
            match faults.next_if(|(misplaced, _)| *misplaced == i) {
                None => self.rows.push(row),
                Some((_, fault)) => {
                    let reason = format!("{} {fault}", quoted(row.settlement.name.as_bytes()));
                    self.report.rows_left_out.push(FileError::new(&*self.file, (row.line, row.column), reason));
                }
            }
        }
        self.report.rows_left_out.sort_by_key(|e| e.line);
    }

    /// Moves settlements that lie in water to the nearest dry ground in `domain`, if there is some within `metres`. Those that were
    /// moved are in [`moved`](super::model::TableReport::moved) then; the others stay where they are.
    pub fn move_to_land(&mut self, domain: Bounds, terrain: &dyn Terrain, metres: f64) {
        for row in &mut self.rows {
            let at = row.settlement.centre.plan();
            if !domain.contains(at) || fault(at, domain, terrain).is_none() {
                continue;
            }
            if let Some(land) = nearest_land(at, domain, terrain, metres) {
                row.settlement.centre = land;
                let distance = land.plan().distance(at);
                self.report.moved.push(Moved { name: row.settlement.name.clone(), distance });
            }
        }
    }

    /// The indices of rows that cannot stand where they are, and why.
    fn faults(&self, domain: Bounds, terrain: &dyn Terrain) -> Vec<(usize, String)> {
        let places = self.rows.iter().map(|r| r.settlement.centre.plan()).enumerate();
        places.filter_map(|(i, at)| Some((i, fault(at, domain, terrain)?))).collect()
    }
}

/// The nearest dry place around a point, in rings that lie farther apart the larger they are: its distance is right to 6 %.
fn nearest_land(around: DVec2, domain: Bounds, terrain: &dyn Terrain, metres: f64) -> Option<Origin> {
    let mut scan = terrain.scan();
    let mut radius = RINGS.0;
    while radius <= metres {
        for i in 0..ON_RING {
            let heading = math::direction(TAU * i as f64 / ON_RING as f64);
            let place = Origin::at(around + heading * radius + 0.5);
            if domain.contains(place.plan()) && scan(place.plan()).depth() <= 0.0 {
                return Some(place);
            }
        }
        radius = (radius * RINGS.1).max(radius + RINGS.0 / 2.0);
    }
    None
}
