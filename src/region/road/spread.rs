//! How far a change of what roads read spreads.

use super::RoadSettings;
use super::graph::TILE_STEPS;
use super::shape::RING;
use super::site::SITE_STEPS;
use super::{merge, over};
use crate::network::SizeClass;

impl RoadSettings {
    /// Distance in metres from a way point of class `top` that comes, goes or changes, beyond which no road is different.
    pub(crate) fn spread_of_way_point(&self, top: SizeClass) -> f64 {
        // It is one end of a pair, or rules a pair out that lies within reach of it with both ends.
        self.spread(|tier| if tier <= top { self.tier(tier).reach + self.tier(tier).padding(self.step) } else { 0.0 })
    }

    /// The same from the outline of a settlement: roads of all classes go around it.
    pub(crate) fn spread_of_settlement(&self) -> f64 {
        self.spread(|tier| {
            let t = self.tier(tier);
            let passing = SITE_STEPS * self.step as f64 + t.corridor + 2.0 * t.padding(self.step);
            passing.max(t.reach + t.padding(self.step))
        })
    }

    /// The same from what an influence on some classes reaches.
    pub(crate) fn spread_of_influence(&self, works_on: impl Fn(SizeClass) -> bool) -> f64 {
        // A pair whose ellipse meets it, and the pairs that share an end with that pair, weighed against it.
        self.spread(|tier| if works_on(tier) { 4.0 * self.tier(tier).padding(self.step) } else { 0.0 })
    }

    /// The same from one end of a road that is kept, led or banned.
    pub(crate) fn spread_of_road(&self) -> f64 {
        self.spread(|tier| 2.0 * self.tier(tier).padding(self.step))
    }

    /// The same where courses of each class differ at most `own` metres around; those of lower classes follow them.
    fn spread(&self, own: impl Fn(SizeClass) -> f64) -> f64 {
        let mut courses: f64 = 0.0;
        for tier in SizeClass::ALL {
            let t = self.tier(tier);
            let along = if courses > 0.0 { courses + t.corridor + 2.0 * t.padding(self.step) } else { 0.0 };
            courses = along.max(own(tier));
        }
        // What is merged and shaped differently, and the line that it is part of as far as the next junction.
        let tile = (TILE_STEPS * self.step) as f64;
        let longest = SizeClass::ALL.map(|tier| self.tier(tier).padding(self.step)).into_iter().fold(0.0, f64::max);
        courses + merge::reads(self) + over::padding(self) + (RING + 1) as f64 * tile + 2.0 * longest
    }
}
