//! Settings of settlements.

use super::model::PerSize;
use crate::edits::SETTLEMENT_RADII;
use crate::layer::{RangeError, Ranged, Walk};
use crate::network::SizeClass;
use crate::space::Stream;
use serde::{Deserialize, Serialize};

/// Settings of settlements. Lengths are in metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(default, deny_unknown_fields)]
pub struct SettlementSettings {
    /// Edge length of a lattice cell, which holds at most one settlement: from 1.2 times the greatest radius to 1,000,000. If it is
    /// below twice the radius, settlements of one tier may touch, as far as `clearance` and `gap` allow it.
    pub spacing: PerSize<f64>,
    /// Least and greatest radius: 120 to 5,000.
    pub radius: PerSize<(f64, f64)>,
    /// Share of the lattice cells that may hold a settlement: 0 to 1.
    pub share: PerSize<f64>,
    /// Names of styles, each with a weight that tells how often it is chosen: at least one, not all weights 0.
    pub styles: PerSize<Vec<(String, f64)>>,
    /// Name of the style of cities and towns on steep ground, and the mean slope (0 to 1) from which ground counts as steep. If the
    /// name is empty, steep ground makes no difference.
    pub steep: (String, f64),
    /// How far a settlement may lie from the middle of its cell: from 0 (a regular grid) to 0.9 (almost anywhere in the cell).
    pub jitter: f64,
    /// Greatest mean slope of a settlement's ground: 0.01 to 0.5.
    pub max_slope: f64,
    /// Greatest height of a centre above sea level: 0 to 10,000.
    pub max_height: f64,
    /// Average distance of an outline from the centre where nothing limits it, as a share of the radius: from 0.7 (ragged, with
    /// room between neighbours) to 0.98 (round, touching its neighbours where it can).
    pub fullness: f64,
    /// Least distance between two centres, as a multiple of the sum of their radii: 0.5 to 4. Below 1, settlements may touch: the
    /// border that they share becomes a main street of both, and they grow into one city.
    pub clearance: f64,
    /// Distance that is added to the least distance: 0 to 10,000.
    pub gap: f64,
    /// Greatest width of a river that towns and cities spread across, with bridges: from 0 (they end at every river) to 200. They
    /// always end at lakes and the sea.
    pub widest_river: f64,
}

impl Default for SettlementSettings {
    fn default() -> Self {
        let styles = |list: &[(&str, f64)]| list.iter().map(|(name, weight)| ((*name).into(), *weight)).collect();
        Self {
            spacing: PerSize { city: 16_000.0, town: 6_000.0, village: 2_500.0 },
            radius: PerSize { city: (1100.0, 1700.0), town: (450.0, 800.0), village: (140.0, 300.0) },
            share: PerSize { city: 1.0, town: 0.95, village: 0.9 },
            styles: PerSize {
                city: styles(&[("grid", 1.0), ("european", 1.0), ("radial", 0.8)]),
                town: styles(&[("european", 0.7), ("organic", 0.7), ("suburb", 1.0), ("industrial", 0.3)]),
                village: styles(&[("village", 1.0)]),
            },
            steep: ("hillside".into(), 0.045),
            jitter: 0.7,
            max_slope: 0.08,
            max_height: 450.0,
            fullness: 0.83,
            clearance: 1.25,
            gap: 200.0,
            widest_river: 120.0,
        }
    }
}

impl Ranged for SettlementSettings {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self {
            spacing,
            radius,
            share,
            styles,
            steep,
            jitter,
            max_slope,
            max_height,
            fullness,
            clearance,
            gap,
            widest_river,
        } = self;
        for size in SizeClass::ALL {
            let within = |field: &str| format!("{field}.{}", size.name());
            let radius = radius.of_mut(size);
            walk.pair(&within("radius"), radius, SETTLEMENT_RADII.0, SETTLEMENT_RADII.1)?;
            walk.number(&within("spacing"), spacing.of_mut(size), radius.1 * 1.2, 1_000_000.0)?;
            walk.number(&within("share"), share.of_mut(size), 0.0, 1.0)?;
            let styles = styles.of_mut(size);
            for (i, (_, weight)) in styles.iter_mut().enumerate() {
                walk.number(&format!("{}[{i}]", within("styles")), weight, 0.0, 1e6)?;
            }
            if !styles.iter().any(|s| s.1 > 0.0) {
                let allowed = "at least one style with a weight above 0".into();
                return Err(RangeError { field: within("styles"), value: "empty".into(), allowed });
            }
        }
        walk.number("steep[1]", &mut steep.1, 0.0, 1.0)?;
        walk.number("jitter", jitter, 0.0, 0.9)?;
        walk.number("max_slope", max_slope, 0.01, 0.5)?;
        walk.number("max_height", max_height, 0.0, 10_000.0)?;
        walk.number("fullness", fullness, 0.7, 0.98)?;
        walk.number("clearance", clearance, 0.5, 4.0)?;
        walk.number("gap", gap, 0.0, 10_000.0)?;
        walk.number("widest_river", widest_river, 0.0, 200.0)
    }
}

impl SettlementSettings {
    /// Checks that every value lies in its range.
    ///
    /// # Errors
    ///
    /// Names the first field whose value is out of range or NaN.
    pub fn check(&self) -> Result<(), RangeError> {
        self.check_ranges()
    }

    /// Names of all styles that settlements may get.
    pub fn style_names(&self) -> impl Iterator<Item = &str> {
        self.styles_by_path().map(|(_, name)| name)
    }

    /// The same with the path of each in a file of these settings, such as `styles.city[0]`.
    pub fn styles_by_path(&self) -> impl Iterator<Item = (String, &str)> {
        let steep = Some(("steep".to_owned(), self.steep.0.as_str())).filter(|(_, name)| !name.is_empty());
        let of = |size: SizeClass| {
            let styles = self.styles.of(size).iter().enumerate();
            styles.map(move |(i, (name, _))| (format!("styles.{}[{i}]", size.name()), name.as_str()))
        };
        SizeClass::ALL.into_iter().flat_map(of).chain(steep)
    }

    /// The style that a settlement gets because of the mean slope of its ground, if that is steep.
    pub(super) fn style_on_slope(&self, size: SizeClass, slope: f64) -> Option<String> {
        let (name, least) = &self.steep;
        (size != SizeClass::Village && !name.is_empty() && slope >= *least).then(|| name.clone())
    }

    /// Draws a style for a settlement of a size by the weights.
    pub(super) fn draw_style(&self, stream: &mut Stream, size: SizeClass) -> String {
        let styles = self.styles.of(size);
        let weights: Vec<f64> = styles.iter().map(|style| style.1).collect();
        stream.weighted(&weights).map(|i| styles[i].0.clone()).unwrap_or_default()
    }

    /// Largest radius of any settlement, in metres.
    pub fn largest_radius(&self) -> f64 {
        self.radius.city.1.max(self.radius.town.1).max(self.radius.village.1)
    }
}
