//! The patches of whole maps.

use super::found::MapPatches;
use super::ground::Ground;
use super::options::{ExtractError, ExtractOptions, NoPatch, PatchKind};
use super::shape::{Shape, most_varied};
use super::{pieces, windows};
use crate::map::model::Map;
use std::collections::BTreeSet;

/// Extracts the patches of one map; `name` begins their names.
///
/// # Errors
///
/// An option that is out of its range.
pub fn extract(map: &Map, name: &str, options: &ExtractOptions) -> Result<MapPatches, ExtractError> {
    let values = [
        ("size", options.size, 40.0, 1000.0),
        ("interval", options.interval, 2.0, 100_000.0),
        ("margin", options.margin, 0.0, options.size),
        ("turn_deg", options.turn_deg.unwrap_or(0.0), -360.0, 360.0),
        ("least_streets", options.least_streets, 0.0, 1e6),
    ];
    if let Some((option, value, low, high)) = values.into_iter().find(|(_, v, low, high)| !(low..=high).contains(&v)) {
        return Err(ExtractError { option, value, low, high });
    }
    let ground = Ground::of(map, options.turn_deg);
    let mut out = MapPatches {
        map: name.to_owned(),
        length: ground.length(),
        junctions: ground.junctions(),
        buildings: map.buildings.len(),
        not_read: map.report.left_out.clone(),
        ..MapPatches::default()
    };
    match options.kind {
        PatchKind::Windows => windows::extract(&ground, options, &mut out),
        PatchKind::Pieces => pieces::extract(&ground, options, &mut out),
    }
    Ok(out)
}

/// Leaves out patches of the same shape and the less varied ones, of all maps together, and gives equal names an ending each.
pub fn select(maps: &mut [MapPatches], options: &ExtractOptions) {
    let mut shapes = BTreeSet::new();
    let mut names = BTreeSet::new();
    for map in maps.iter_mut() {
        let before = map.patches.len();
        if !options.keep_duplicates {
            map.patches.retain(|p| shapes.insert(p.shape.key.clone()));
        }
        map.leave_out(NoPatch::Duplicate, before - map.patches.len());
        for patch in &mut map.patches {
            let name = patch.patch.name.clone();
            let mut ending = 2;
            while !names.insert(patch.patch.name.clone()) {
                patch.patch.name = format!("{name} {ending}");
                ending += 1;
            }
            patch.drawing.name.clone_from(&patch.patch.name);
        }
    }
    let all: Vec<&Shape> = maps.iter().flat_map(|m| &m.patches).map(|p| &p.shape).collect();
    let Some(most) = options.most.filter(|most| *most < all.len()) else { return };
    let kept = most_varied(&all, most);
    let mut number = 0;
    for map in maps {
        let before = map.patches.len();
        map.patches.retain(|_| {
            number += 1;
            kept[number - 1]
        });
        map.leave_out(NoPatch::LessVaried, before - map.patches.len());
    }
}
