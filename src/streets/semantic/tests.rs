//! What streets of patches look like.

use super::prepared::PatchFiller;
use crate::layer::Cancel;
use crate::patch::{PatchDatabase, PatchSet};
use crate::space::{distance_to_line, line_length, math::angle_between};
use crate::streets::filler::{CellFiller, CellStreets, StreetOrigin};
use crate::style::{FieldKind, Style};
use crate::testing::{PortCell, patch_sets, styles};
use std::f64::consts::PI;
use std::sync::Arc;

/// A style with its patches.
pub struct Kit {
    pub style: Style,
    pub filler: PatchFiller,
}

impl Kit {
    /// The bundled styles.
    pub fn all() -> Vec<Self> {
        let styles = styles();
        let sets = patch_sets(&styles);
        let kit = |style: Style| {
            let sets: Vec<&PatchSet> = style.patch_sets.iter().map(|name| &*sets[name]).collect();
            let patches = PatchDatabase::new(&sets, &style.allow, &style.exclude);
            let weights = patches.weights();
            Self { style, filler: PatchFiller::new(Arc::new(patches), weights) }
        };
        styles.into_iter().map(kit).collect()
    }

    /// A cell of this style.
    pub fn cell(&self, seed: u64) -> PortCell<'_> {
        PortCell::new(seed, std::slice::from_ref(&self.style))
    }

    /// Fills a cell.
    pub fn fill(&self, cell: &PortCell<'_>) -> CellStreets {
        self.filler.fill(&cell.brief(), &Cancel::new()).expect("nobody cancelled")
    }
}

/// Turns of streets between their ends, in radians, with how far each street is from straight, in metres.
fn turns(kit: &Kit) -> (Vec<f64>, Vec<f64>) {
    let (mut turns, mut off) = (Vec::new(), Vec::new());
    for seed in 2000..2040 {
        for s in &kit.fill(&kit.cell(seed)).streets {
            let line = &s.street.line;
            let chord = [line[0], line[line.len() - 1]];
            off.push(line.iter().map(|p| distance_to_line(*p, &chord)).fold(0.0, f64::max));
            turns.extend(line.windows(3).map(|w| PI - angle_between(w[0] - w[1], w[2] - w[1])));
        }
    }
    (turns, off)
}

#[test]
fn streets_of_grids_have_no_doglegs_and_those_of_old_towns_no_kinks() {
    for kit in &Kit::all() {
        let (turns, off) = turns(kit);
        if kit.style.main.field == FieldKind::Grid {
            let bent = off.iter().filter(|d| (0.5..16.0).contains(*d)).count();
            assert!(bent * 12 < off.len(), "{bent} of {} streets are nearly straight", off.len());
        } else if kit.style.local.rounding > 0.0 {
            let kinks = turns.iter().filter(|t| **t > 0.7).count();
            assert!(kinks * 12 < off.len(), "{}: {kinks} kinks in {} streets", kit.style.name, off.len());
        }
    }
}

#[test]
fn patches_make_half_of_the_streets() {
    let kits = Kit::all();
    for kit in &kits {
        let (mut patched, mut all, mut from_patches, mut streets) = (0.0, 0.0, 0, 0);
        for seed in 1000..1040 {
            for s in &kit.fill(&kit.cell(seed)).streets {
                let is = matches!(s.made_by.origin, StreetOrigin::Piece(_));
                let length = line_length(&s.street.line);
                all += length;
                patched += if is { length } else { 0.0 };
                from_patches += u32::from(is);
                streets += 1;
            }
        }
        let share = (patched / all, f64::from(from_patches) / f64::from(streets));
        assert!(share.0 > 0.5, "{}: {:.2} of the length is from patches", kit.style.name, share.0);
    }
}
