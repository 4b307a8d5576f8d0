//! What commands say of crossings of highways.

use bevy_sprawl::layer::Choice;
use bevy_sprawl::region::{Crossing, HighwayCrossing, Hindrance};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Crossings one by one.
pub fn json(crossings: &[HighwayCrossing]) -> Value {
    let one = |c: &HighwayCrossing| {
        json!({
            "x": c.at.x, "y": c.at.y, "class": c.class.name(), "built": c.built.name(),
            "hindrance": c.hindrance.map(Hindrance::name),
        })
    };
    crossings.iter().map(one).collect()
}

/// A line for people that counts crossings by how they are built, and what keeps others from being built as wanted; empty if
/// there are none.
pub fn people(crossings: &[HighwayCrossing]) -> String {
    let mut kept: BTreeMap<Hindrance, usize> = BTreeMap::new();
    crossings.iter().filter_map(|c| c.hindrance).for_each(|h| *kept.entry(h).or_default() += 1);
    let kinds =
        Crossing::CHOICES.iter().rev().map(|kind| (kind, crossings.iter().filter(|c| c.built == *kind).count()));
    let kinds: Vec<String> = kinds.filter(|k| k.1 > 0).map(|(kind, n)| format!("{n} {}", kind.name())).collect();
    let kept: Vec<String> = kept.into_iter().map(|(hindrance, n)| format!("{n} {}", hindrance.name())).collect();
    match (kinds.is_empty(), kept.is_empty()) {
        (true, _) => String::new(),
        (_, true) => format!("crossings of highways: {}\n", kinds.join(", ")),
        _ => format!("crossings of highways: {}; built plainer for: {}\n", kinds.join(", "), kept.join(", ")),
    }
}
