//! What real streets measure, for each kind of town.

use bevy_sprawl::analysis::Survey;
use bevy_sprawl::style::{FieldKind, Style};
use clap::ValueEnum;

/// A kind of real town.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Centres of planned cities
    Grid,
    /// Centres that are partly planned
    Hybrid,
    /// Centres that grew
    Organic,
    /// Suburbs
    Suburb,
    /// Villages and small towns
    Village,
}

impl Kind {
    /// The kind that a style stands for: by its name, or else by the directions of its main streets.
    pub fn of(style: &Style) -> Self {
        match (style.name.as_str(), style.main.field) {
            ("suburb", _) => Self::Suburb,
            ("village", _) => Self::Village,
            (_, FieldKind::Grid) => Self::Grid,
            (_, FieldKind::Radial) => Self::Hybrid,
            (_, FieldKind::Organic | FieldKind::Contours) => Self::Organic,
        }
    }

    /// Radius in metres of towns to measure.
    pub fn radius(self) -> f64 {
        if self == Self::Village { 340.0 } else { 900.0 }
    }

    /// Lower-case name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Hybrid => "hybrid",
            Self::Organic => "organic",
            Self::Suburb => "suburb",
            Self::Village => "village",
        }
    }
}

/// A figure of a town.
pub struct Figure {
    /// Key in JSON.
    pub key: &'static str,
    /// Name in tables.
    pub name: &'static str,
    /// Digits after the point.
    pub digits: usize,
    read: fn(&Survey) -> f64,
    /// For grid, hybrid and organic, the 10th, 50th and 90th percentile of about 40 real centres of each kind; for suburbs and
    /// villages, which are few, the least, the middle and the greatest value.
    real: [[f64; 3]; 5],
}

/// Streets in a square kilometre of the real villages.
const VILLAGE_STREETS: f64 = 93.0;
/// Degrees of freedom of 36 bins of bearings. A street counts in two opposite bins, which leaves 18, less one.
const FREE: f64 = 17.0;
/// Entropy of bearings without order less that of a grid, in nats: ln 36 - ln 4.
const ENTROPY_SPAN: f64 = 2.197_224_577_336_22;

/// Second term of the bias of the entropy of few bearings, in nats times the square of their number.
const NEXT_TERM: f64 = 323.0 / 12.0;

/// The orientation order that a place would have if it had as many streets as the real villages. Few streets look ordered by
/// chance: the entropy of the bearings of n streets comes out about 17 / 2n (Miller and Madow) and 323 / 12n² (Harris 1975)
/// too low, so that 20 streets without any order measure 0.40, 33 measure 0.25, and 93 measure 0.08.
fn order_of_a_square_kilometre(survey: &Survey) -> f64 {
    if survey.streets == 0 {
        return survey.orientation_order;
    }
    let too_low = |streets: f64| FREE / (2.0 * streets) + NEXT_TERM / (streets * streets);
    let chance = too_low(survey.streets as f64) - too_low(VILLAGE_STREETS);
    let disorder = (1.0 - survey.orientation_order).max(0.0).sqrt() + chance / ENTROPY_SPAN;
    1.0 - (disorder * disorder).min(1.0)
}

impl Figure {
    /// The figure of a town as it is compared with real towns of a kind. Villages are smaller than the square kilometre in which
    /// real villages were measured.
    pub fn value(&self, kind: Kind, survey: &Survey) -> f64 {
        match kind {
            Kind::Village if self.key == "orientation_order" => order_of_a_square_kilometre(survey),
            _ => (self.read)(survey),
        }
    }

    /// Low, middle and high of a kind of real town. The bands of suburbs and villages are widened by a quarter.
    pub fn band(&self, kind: Kind) -> [f64; 3] {
        let [low, middle, high] = self.real[kind as usize];
        match kind {
            Kind::Grid | Kind::Hybrid | Kind::Organic => [low, middle, high],
            // Nothing is shorter than the straight way, and no share is more than the whole.
            _ if self.key == "circuity" => [1.0 + (low - 1.0) / 1.25, middle, 1.0 + (high - 1.0) * 1.25],
            _ if high <= 1.0 => [low / 1.25, middle, (high * 1.25).min(1.0)],
            _ => [low / 1.25, middle, high * 1.25],
        }
    }
}

/// The figures for which real towns have bands, in the order of the tables.
#[rustfmt::skip]
pub const FIGURES: [Figure; 9] = [
    Figure { key: "junctions_per_km2", name: "junctions/km2", digits: 0, read: |s| s.junctions_per_km2,
        real: [[53.0, 92.0, 141.0], [57.0, 97.0, 142.0], [72.0, 111.0, 164.0], [21.0, 31.0, 73.0], [51.0, 52.0, 54.0]] },
    Figure { key: "street_km_per_km2", name: "street km/km2", digits: 1, read: |s| s.street_km_per_km2,
        real: [[12.5, 16.5, 22.6], [10.9, 16.0, 20.7], [12.5, 17.2, 21.7], [7.2, 9.9, 12.4], [8.3, 9.5, 10.7]] },
    Figure { key: "cnr", name: "CNR", digits: 2, read: |s| s.cnr,
        real: [[0.91, 0.98, 1.0], [0.88, 0.96, 1.0], [0.81, 0.92, 0.96], [0.56, 0.77, 0.81], [0.61, 0.67, 0.73]] },
    Figure { key: "mean_street_m", name: "mean street m", digits: 0, read: |s| s.mean_street_m,
        real: [[72.0, 95.0, 121.0], [67.0, 85.0, 124.0], [65.0, 76.0, 95.0], [100.0, 159.0, 198.0], [90.0, 102.0, 114.0]] },
    Figure { key: "share_4_way", name: "4-way share", digits: 2, read: |s| s.share_4_way,
        real: [[0.23, 0.44, 0.74], [0.09, 0.26, 0.48], [0.08, 0.17, 0.30], [0.07, 0.10, 0.14], [0.02, 0.05, 0.07]] },
    Figure { key: "orientation_order", name: "orientation order", digits: 2, read: |s| s.orientation_order,
        real: [[0.52, 0.83, 0.97], [0.16, 0.46, 0.71], [0.09, 0.20, 0.44], [0.14, 0.22, 0.80], [0.12, 0.14, 0.15]] },
    Figure { key: "circuity", name: "circuity", digits: 3, read: |s| s.circuity,
        real: [[1.003, 1.013, 1.032], [1.005, 1.023, 1.053], [1.023, 1.045, 1.084], [1.038, 1.073, 1.131],
               [1.043, 1.060, 1.076]] },
    Figure { key: "block_median_m2", name: "median block m2", digits: 0, read: |s| s.block_median_m2,
        real: [[4500.0, 9300.0, 16300.0], [3300.0, 6800.0, 15200.0], [2800.0, 5600.0, 8700.0],
               [11839.0, 21817.0, 26835.0], [3497.0, 11776.0, 20054.0]] },
    Figure { key: "share_angle_below_30", name: "angles < 30°", digits: 3, read: |s| s.share_angle_below_30,
        real: [[0.0, 0.05, 0.1], [0.0, 0.05, 0.1], [0.0, 0.05, 0.1], [0.0, 0.05, 0.08], [0.0, 0.05, 0.08]] },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_streets_without_order_measure_as_many_do() {
        // The orientation order that random bearings measure.
        for (streets, order) in [(20, 0.400), (25, 0.325), (33, 0.248), (40, 0.201), (93, 0.081)] {
            let survey = Survey { streets, orientation_order: order, ..Survey::default() };
            let value = order_of_a_square_kilometre(&survey);
            assert!((value - 0.081).abs() < 0.02, "{streets} streets: {value}");
        }
        let grid = Survey { streets: 93, orientation_order: 0.7, ..Survey::default() };
        assert!((order_of_a_square_kilometre(&grid) - 0.7).abs() < 1e-12);
    }

    #[test]
    fn bands_rise() {
        for kind in [Kind::Grid, Kind::Hybrid, Kind::Organic, Kind::Suburb, Kind::Village] {
            for figure in &FIGURES {
                let [low, middle, high] = figure.band(kind);
                assert!(low <= middle && middle <= high, "{} of {kind:?}", figure.key);
            }
        }
    }
}
