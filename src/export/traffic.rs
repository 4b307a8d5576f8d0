//! Lanes and turns of an area, and the tags by which OpenStreetMap speaks of them.

use crate::network::{JunctionId, Side, Street, Traffic};
use crate::surface::{JunctionTurns, Lane, LaneId, LaneRules, Turn, TurnKind, ends_by_junction, lanes_of, turns_at};
use crate::world::Area;
use std::collections::BTreeMap;

/// Where traffic drives in an area.
pub(super) struct AreaTraffic {
    driving: Side,
    /// Turns through the junctions in the area's box, of which all streets are known.
    pub junctions: BTreeMap<JunctionId, JunctionTurns>,
    /// The same turns, by the lane that they come from.
    by_lane: BTreeMap<LaneId, Vec<TurnKind>>,
}

impl AreaTraffic {
    pub fn new(area: &Area, driving: Side) -> Self {
        let ends = ends_by_junction(area.streets.iter().map(|s| &s.item.street));
        let inside = area.junctions.iter().filter(|j| area.bounds.contains(area.origin.to_plan(j.item.at)));
        let turns = |id: JunctionId| turns_at(id, ends.get(&id).map_or(&[], Vec::as_slice), driving);
        let junctions: BTreeMap<JunctionId, JunctionTurns> = inside.map(|j| (j.item.id, turns(j.item.id))).collect();
        let mut by_lane: BTreeMap<LaneId, Vec<TurnKind>> = BTreeMap::new();
        for Turn { from, kind, .. } in junctions.values().flat_map(|j| &j.turns) {
            by_lane.entry(*from).or_default().push(*kind);
        }
        Self { driving, junctions, by_lane }
    }

    /// The lanes of a street.
    pub fn lanes(&self, street: &Street) -> Vec<Lane> {
        lanes_of(street, self.driving)
    }

    /// Whether a way of OpenStreetMap runs against the street's line, as a one-way street does whose traffic goes that way.
    pub fn is_reversed(&self, street: &Street) -> bool {
        street.traffic(self.driving) == Traffic::Against
    }

    /// Tags of a street: number of lanes, greatest speed, direction of traffic, roundabouts, and where lanes lead.
    pub fn tags(&self, street: &Street) -> Vec<(&'static str, String)> {
        let rules = LaneRules::of(street.class);
        let both = street.traffic(self.driving) == Traffic::Both;
        let lanes = rules.each_way * if both { 2 } else { 1 };
        let kmh = (rules.speed * 3.6).round();
        let mut tags = vec![("lanes", lanes.to_string()), ("maxspeed", kmh.to_string())];
        if !both {
            tags.push(("oneway", "yes".into()));
        }
        if street.island.is_some() {
            tags.push(("junction", "roundabout".into()));
        }
        if rules.each_way > 1 {
            let all = self.lanes(street);
            for (along, key) in [(true, "turn:lanes:forward"), (false, "turn:lanes:backward")] {
                let key = if both { key } else { "turn:lanes" };
                let mut leads: Vec<String> =
                    all.iter().filter(|l| l.along == along).filter_map(|l| self.leads(l.id)).collect();
                if leads.len() < rules.each_way || leads.iter().all(|l| l == "through") {
                    continue;
                }
                // From the driver's left to the right.
                if self.driving == Side::Left {
                    leads.reverse();
                }
                tags.push((key, leads.join("|")));
            }
        }
        tags
    }

    /// Where a lane leads, in the words of `turn:lanes`.
    fn leads(&self, lane: LaneId) -> Option<String> {
        let kinds = self.by_lane.get(&lane)?;
        let all = [
            (TurnKind::Back, "reverse"),
            (TurnKind::Left, "left"),
            (TurnKind::Straight, "through"),
            (TurnKind::Right, "right"),
        ];
        let words: Vec<&str> = all.into_iter().filter(|(kind, _)| kinds.contains(kind)).map(|(_, word)| word).collect();
        Some(words.join(";"))
    }
}
