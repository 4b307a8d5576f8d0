//! Parametric growth alone (Teng 2017, Fig. 3): from the stub of every port streets grow along the direction field, meet,
//! and are mended. It lays no pieces and needs no assets.

use super::cell::{Draft, finish, grow_from_stubs, lay_stubs, make_fair, propagate, repair};
use super::filler::{CellBrief, CellFiller, CellStreets, FilledTown, Filler, LeftOut, TownToFill};
use crate::layer::{Cancel, LayerError, Weigh};
use std::sync::Arc;

/// The name by which styles call this filler.
pub const NAME: &str = "Parametric";

/// Parametric growth alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parametric {
    /// Number of pieces that the user pinned in the cell; none of them can stand.
    pinned: usize,
}

impl Filler for Parametric {
    fn prepare(&self, town: &TownToFill<'_>) -> Result<FilledTown, LayerError> {
        let cells = town.cells.iter().map(|cell| Arc::new(Self { pinned: cell.pinned.len() }) as Arc<dyn CellFiller>);
        Ok(FilledTown { fillers: cells.collect(), short_counts: Vec::new() })
    }

    fn has_piece(&self, _: &str) -> bool {
        false
    }
}

impl CellFiller for Parametric {
    fn fill(&self, brief: &CellBrief<'_>, cancel: &Cancel) -> Result<CellStreets, LayerError> {
        let mut draft = Draft::new(brief);
        lay_stubs(&mut draft);
        grow_from_stubs(&mut draft);
        cancel.check()?;
        propagate(&mut draft, cancel, |_, _, _, _| false)?;
        repair(&mut draft, &[], cancel)?;
        make_fair(&mut draft);
        let left_out = (0..self.pinned).map(|piece| LeftOut { piece, reason: "cannot stand where streets only grow" });
        Ok(CellStreets { left_out: left_out.collect(), ..finish(&draft, NAME, &[]) })
    }
}

impl Weigh for Parametric {
    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layer::Ranged;
    use crate::network::JunctionId;
    use crate::space::{Seed, signed_area};
    use crate::style::{LocalRules, Style};
    use crate::testing::{PortCell, styles};
    use std::collections::BTreeMap;

    /// What was counted and measured in some cells.
    #[derive(Default)]
    struct Figures {
        junctions: usize,
        dead_ends: usize,
        metres: f64,
        area: f64,
    }

    impl Figures {
        fn add(&mut self, cell: &PortCell<'_>) {
            let out = Parametric::default().fill(&cell.brief(), &Cancel::new()).expect("nobody cancelled");
            let mut degree: BTreeMap<JunctionId, usize> = BTreeMap::new();
            for street in out.streets.iter().map(|s| &s.street) {
                [street.from, street.to].iter().for_each(|j| *degree.entry(*j).or_default() += 1);
                self.metres += street.length();
            }
            let inner = || out.junctions.iter().filter_map(|j| degree.get(&j.id));
            self.junctions += inner().filter(|d| **d >= 3).count();
            self.dead_ends += inner().filter(|d| **d == 1).count();
            self.area += signed_area(&cell.border);
        }

        /// Kilometres of street in a square kilometre.
        fn density(&self) -> f64 {
            self.metres * 1e3 / self.area
        }

        /// Connected node ratio.
        fn cnr(&self) -> f64 {
            self.junctions as f64 / (self.junctions + self.dead_ends).max(1) as f64
        }
    }

    /// Cells of some styles, all with these local rules.
    fn figures(local: LocalRules, seeds: std::ops::Range<u64>) -> Figures {
        let styles: Vec<Style> = styles().into_iter().map(|style| Style { local, ..style }).collect();
        let mut figures = Figures::default();
        seeds.for_each(|seed| figures.add(&PortCell::new(seed, &styles)));
        figures
    }

    #[test]
    fn what_a_style_asks_of_growth_shows_in_its_cells() {
        // The values of Teng 2017, section 4.2, in cells as wide as those of towns.
        let base = LocalRules {
            length: 50.0,
            deviation: 10.0,
            min_length: 20.0,
            degree: (3, 4),
            min_angle_deg: 50.0,
            angle_deviation_deg: 10.0,
            snap_radius: 20.0,
            clearance: 15.0,
            block_width: 0.0,
            dead_ends: 0.0,
            rounding: 0.0,
        };
        let of = |local| figures(local, 0..40);
        let usual = of(base);
        let (few, many) = (of(LocalRules { degree: (2, 3), ..base }), of(LocalRules { degree: (4, 5), ..base }));
        assert!(many.density() > 1.6 * few.density(), "degree: {} {}", few.density(), many.density());
        let square = of(LocalRules { min_angle_deg: 90.0, ..base });
        assert!(usual.density() > 1.3 * square.density(), "angle: {} {}", usual.density(), square.density());
        assert!(usual.cnr() > 0.1 + square.cnr(), "angle: {} {}", usual.cnr(), square.cnr());
        let loose = of(LocalRules { dead_ends: 1.0, ..base });
        assert!(usual.cnr() > 0.12 + loose.cnr(), "dead ends: {} {}", usual.cnr(), loose.cnr());
        let [short, long] = [40.0, 150.0].map(|length| of(LocalRules { length, ..base }));
        assert!(short.density() > 1.4 * long.density(), "length: {} {}", short.density(), long.density());
        assert!(long.cnr() > 0.75, "length: {}", long.cnr());
    }

    #[test]
    fn dead_ends_are_few_at_every_end_of_every_range() {
        let usual = LocalRules::default();
        let with = |change: fn(&mut LocalRules)| {
            let mut rules = usual;
            change(&mut rules);
            rules
        };
        let ends = [
            with(|r| (r.length, r.deviation, r.min_length) = (20.0, 0.0, 16.0)),
            with(|r| r.length = 500.0),
            with(|r| (r.length, r.min_length) = (500.0, 500.0)),
            with(|r| r.deviation = 0.0),
            with(|r| r.deviation = r.length / 2.0),
            with(|r| r.min_length = 16.0),
            with(|r| r.min_length = r.length),
            with(|r| r.degree = (2, 3)),
            with(|r| (r.degree, r.min_angle_deg) = ((8, 8), 45.0)),
            with(|r| r.min_angle_deg = 40.0),
            with(|r| r.min_angle_deg = 90.0),
            with(|r| r.angle_deviation_deg = 0.0),
            with(|r| r.angle_deviation_deg = 45.0),
            with(|r| r.snap_radius = 5.0),
            with(|r| r.snap_radius = 200.0),
            with(|r| r.clearance = 15.0),
            with(|r| r.clearance = 200.0),
            with(|r| r.block_width = 0.0),
            with(|r| r.block_width = 200.0),
        ];
        for rules in ends {
            let found = figures(rules, 0..30);
            // Few streets of a cell lie so that others can meet them at right angles alone.
            let least = if rules.min_angle_deg > 80.0 { 0.55 } else { 0.72 };
            assert!(found.cnr() > least, "{} with {rules:?}", found.cnr());
        }
    }

    #[test]
    fn dead_ends_are_few_whatever_the_rules() {
        let mut found = Figures::default();
        let all = styles();
        for seed in 0..200 {
            let mut s = Seed(seed).stream("random rules", &[]);
            let mut drawn = LocalRules::default();
            drawn.draw(0.9, &mut s).expect("no range is empty");
            // Without junctions only dead ends are left.
            let local = LocalRules { dead_ends: 0.0, degree: (drawn.degree.0, drawn.degree.1.max(3)), ..drawn };
            let styles: Vec<Style> = all.iter().map(|style| Style { local, ..style.clone() }).collect();
            (0..3).for_each(|k| found.add(&PortCell::new(10 * seed + k, &styles)));
        }
        assert!(found.cnr() > 0.72, "{}", found.cnr());
    }
}
