//! The settings file of `sprawl roads`: one of a world, of which a finite domain has no use for some fields.

use crate::fail::Fail;
use crate::text;
use bevy_sprawl::layer::{FileError, error_at, from_ron};
use bevy_sprawl::region::{RoadOverrides, RoadSettings};
use bevy_sprawl::world::Settings;
use ron::Value;
use serde::Deserialize;
use std::path::Path;

/// The fields that have a use; the others say how an endless world is made.
const USED: [&str; 4] = ["chunk_size", "roads", "settlements.radius", "settlements.styles"];

/// A settings file and what it says.
pub struct SettingsFile {
    pub name: String,
    pub text: String,
    pub settings: Settings,
    pub roads: RoadOverrides,
    /// One for each field without a use.
    pub warnings: Vec<FileError>,
}

/// The part of a file that is laid over other settings than the defaults.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Laid {
    roads: RoadOverrides,
}

impl SettingsFile {
    /// Reads a file of world settings; ranges of roads are checked later, for those of a finite domain are wider.
    pub fn read(path: &Path) -> Result<Self, Fail> {
        let (name, text) = (path.to_string_lossy().into_owned(), text::read(path)?);
        let settings: Settings = from_ron(&name, &text)?;
        Settings { roads: RoadSettings::default(), ..settings.clone() }.check().map_err(|e| e.in_file(&name, &text))?;
        let Laid { roads } = from_ron(&name, &text)?;
        let of = |field: String| {
            let reason = format!("{field} has no use here; `sprawl roads` uses {}", USED.join(", "));
            error_at(&name, &text, &field, reason)
        };
        let warnings = unused(&from_ron(&name, &text)?).into_iter().map(of).collect();
        Ok(Self { name, text, settings, roads, warnings })
    }
}

/// The paths of fields that have no use, in the order of their names.
fn unused(file: &Value) -> Vec<String> {
    fields(file, "")
        .flat_map(|(path, value)| if USED.contains(&path.as_str()) { Vec::new() } else { inner(path, value) })
        .collect()
}

/// The fields of a value that have no use, or its own path if it has none.
fn inner(path: String, value: &Value) -> Vec<String> {
    let inside: Vec<String> = fields(value, &format!("{path}.")).map(|(path, _)| path).collect();
    if inside.is_empty() {
        return vec![path];
    }
    inside.into_iter().filter(|path| !USED.contains(&path.as_str())).collect()
}

/// The fields of a value and their paths.
fn fields<'a>(value: &'a Value, before: &'a str) -> impl Iterator<Item = (String, &'a Value)> {
    let map = if let Value::Map(map) = value { Some(map) } else { None };
    map.into_iter().flat_map(|m| m.iter()).filter_map(move |(key, value)| match key {
        Value::String(key) => Some((format!("{before}{key}"), value)),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_without_a_use_are_found() {
        let text = "(chunk_size: 512, terrain: (sea_share: 0.2, vegetation: 1), cache: (), roads: (minor: (reach: 900)), \
                    settlements: (radius: (city: (1, 2)), gap: 3, spacing: (city: 4)))";
        let found = unused(&from_ron("a.ron", text).expect("it is RON"));
        assert_eq!(
            found,
            ["cache", "settlements.gap", "settlements.spacing", "terrain.sea_share", "terrain.vegetation"]
        );
    }
}
