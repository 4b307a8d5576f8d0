//! How far roads change when something that they depend on changes.

use super::merge;
use super::overpass;
use super::padding::SITE_STEPS;
use super::settings::RoadSettings;
use super::shape::RING;
use super::tile::TILE_STEPS;
use crate::network::SizeClass;

impl RoadSettings {
    /// Distance in metres from a way point of class `top` that appears, disappears or changes, beyond which no road changes.
    pub(crate) fn change_reach_of_way_point(&self, top: SizeClass) -> f64 {
        // The way point is an end of a pair, rules out a pair both ends of which lie within reach of it, or is the first that
        // a settlement within reach has a way to, so that this one needs no last resort.
        self.change_reach(|tier| {
            if tier <= top { 2.0 * self.tier(tier).reach + self.tier(tier).padding(self.step) } else { 0.0 }
        })
    }

    /// Distance in metres from a settlement's outline that changes, beyond which no road changes: roads of all classes avoid
    /// outlines.
    pub(crate) fn change_reach_of_settlement(&self) -> f64 {
        self.change_reach(|tier| {
            let t = self.tier(tier);
            let passing = SITE_STEPS * self.step as f64 + t.corridor + 2.0 * t.padding(self.step);
            passing.max(2.0 * t.reach + t.padding(self.step))
        })
    }

    /// Distance in metres from the area of an influence that changes, beyond which no road changes. `works_on` tells which
    /// tiers the influence works on.
    pub(crate) fn change_reach_of_influence(&self, works_on: impl Fn(SizeClass) -> bool) -> f64 {
        // A pair whose ellipse meets the area, and the pairs that share an end with it and are compared with it.
        self.change_reach(|tier| if works_on(tier) { 4.0 * self.tier(tier).padding(self.step) } else { 0.0 })
    }

    /// Distance in metres from one end of a road that is newly kept, routed or banned, beyond which no road changes.
    pub(crate) fn change_reach_of_road(&self) -> f64 {
        self.change_reach(|tier| 2.0 * self.tier(tier).padding(self.step))
    }

    /// Distance in metres beyond which no road changes, if routes of each tier change directly up to a distance of `direct`.
    /// Routes of lower tiers follow changed routes of higher tiers. A settlement at an end of a changed route may come to need
    /// a last resort, or no longer need it, and that road is of any class.
    fn change_reach(&self, direct: impl Fn(SizeClass) -> f64) -> f64 {
        // A way lies in an ellipse around the settlements at its ends, so that no point of it is farther from either of them than
        // half the way, which the padding holds, and half the beeline.
        let to_end = |tier: SizeClass| self.tier(tier).reach / 2.0 + self.tier(tier).padding(self.step);
        let changed = SizeClass::ALL.into_iter().filter(|tier| direct(*tier) > 0.0);
        let ends = changed.map(to_end).fold(f64::NEG_INFINITY, f64::max);
        let mut routes: f64 = 0.0;
        for tier in SizeClass::ALL {
            let t = self.tier(tier);
            let along = if routes > 0.0 { routes + t.corridor + 2.0 * t.padding(self.step) } else { 0.0 };
            routes = along.max(direct(tier)).max(ends + to_end(tier));
        }
        // Merging and smoothing read farther, and a changed line changes as far as its next junction.
        let tile = (TILE_STEPS * self.step) as f64;
        let longest = SizeClass::ALL.map(|tier| self.tier(tier).padding(self.step)).into_iter().fold(0.0, f64::max);
        routes + merge::padding(self) + overpass::padding(self) + (RING + 1) as f64 * tile + 2.0 * longest
    }
}
