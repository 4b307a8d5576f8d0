//! The settlements of a finite domain with the user's edits.

use super::check::BuildingSite;
use crate::edits::{EditList, RejectedEdit, SettlementEdit};
use crate::region::settlement::pinned::pin;
use crate::region::settlement::{Settlement, SettlementId, SettlementSettings};
use crate::space::{Origin, Seed};
use std::collections::BTreeSet;

/// The given settlements after the edits, which must have been checked, and the edits that cannot be carried out. Bans and moves
/// are those of given settlements.
pub(super) fn edited(
    site: &BuildingSite<'_>,
    given: &[Settlement],
    edits: &[SettlementEdit],
) -> (Vec<Settlement>, Vec<RejectedEdit>) {
    let banned = |s: &Settlement| {
        let holds = |e: &SettlementEdit| matches!(e, SettlementEdit::Ban { at, radius } if s.centre.plan().distance(*at) <= *radius);
        edits.iter().any(holds)
    };
    let mut out: Vec<Settlement> = given.iter().filter(|s| !banned(s)).cloned().collect();
    let mut movable: BTreeSet<SettlementId> = out.iter().map(|s| s.id).collect();
    let mut rejected = Vec::new();
    for (index, edit) in edits.iter().enumerate() {
        if let Err(reason) = carry_out(site, &mut out, &mut movable, edit) {
            rejected.push(RejectedEdit { list: EditList::Settlements, index, reason });
        }
    }
    (out, rejected)
}

/// Carries an edit out. `movable` are the given settlements that have not been moved.
fn carry_out(
    site: &BuildingSite<'_>,
    all: &mut Vec<Settlement>,
    movable: &mut BTreeSet<SettlementId>,
    edit: &SettlementEdit,
) -> Result<(), String> {
    let put = |s: Settlement, all: &mut Vec<Settlement>| match site.unfit(&s, all) {
        Some(reason) => Err(reason),
        None => {
            all.push(s);
            Ok(())
        }
    };
    match edit {
        SettlementEdit::Ban { .. } => Ok(()),
        SettlementEdit::Pin { at, size, name, style, radius } => {
            // A finite domain has no seed of its own.
            put(pin(Seed(0), &SettlementSettings::default(), *at, *size, [name, style], *radius), all)
        }
        SettlementEdit::Move { from, to } => {
            let apart = |s: &Settlement| s.centre.plan().distance(*from);
            let holding = all.iter().enumerate().filter(|(_, s)| apart(s) <= s.radius && movable.contains(&s.id));
            let found = holding.min_by(|a, b| apart(a.1).total_cmp(&apart(b.1)).then(a.1.id.cmp(&b.1.id))).map(|f| f.0);
            let index = found.ok_or_else(|| format!("there is no settlement to move at {},{}", from.x, from.y))?;
            let before = all.remove(index);
            let moved = Settlement { centre: Origin::at(*to + 0.5), ..before.clone() };
            let id = before.id;
            let done = put(moved, all);
            match done {
                Ok(()) => drop(movable.remove(&id)),
                Err(_) => all.insert(index, before),
            }
            done
        }
    }
}
