//! All settings of a world.

use crate::layer::{Choice, FileError, RangeError, Ranged, Walk, from_ron};
use crate::network::Side;
use crate::region::{RoadSettings, SettlementSettings};
use crate::space::CHUNK_SIZE;
use crate::terrain::TerrainSettings;
use serde::{Deserialize, Serialize};

/// All settings of a world. Every field has a default; a RON file names only the fields that differ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Edge of a chunk in metres: a multiple of 64, from 64 to 4096.
    pub chunk_size: i64,
    /// The ground.
    pub terrain: TerrainSettings,
    /// Settlements.
    pub settlements: SettlementSettings,
    /// Roads.
    pub roads: RoadSettings,
    /// The side of the road on which traffic drives.
    pub driving: Side,
    /// Memory for caches.
    pub cache: CacheSettings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            chunk_size: CHUNK_SIZE,
            terrain: TerrainSettings::default(),
            settlements: SettlementSettings::default(),
            roads: RoadSettings::default(),
            driving: Side::default(),
            cache: CacheSettings::default(),
        }
    }
}

/// Most memory for the things that are kept, in MiB, each up to 65,536. The bounds change speed, never the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "bevy", derive(bevy::reflect::Reflect))]
#[serde(default, deny_unknown_fields)]
pub struct CacheSettings {
    /// Settlements and roads. At least 16: the roads of one place need the settlements of some thousand cells at once.
    pub region_mib: f64,
    /// Towns and their filled main cells, and the ground that they stand on. At least 8.
    pub town_mib: f64,
    /// Chunks. At least 8.
    pub chunk_mib: f64,
}

impl Default for CacheSettings {
    fn default() -> Self {
        Self { region_mib: 64.0, town_mib: 128.0, chunk_mib: 64.0 }
    }
}

impl Settings {
    /// Reads and checks settings from RON text; `file` is named in errors.
    ///
    /// # Errors
    ///
    /// If the text is not RON, or names an unknown field or a value outside its range: with line and column.
    pub fn from_ron(file: &str, text: &str) -> Result<Self, FileError> {
        let settings: Self = from_ron(file, text)?;
        settings.check().map_err(|e| e.in_file(file, text))?;
        Ok(settings)
    }

    /// Checks that every value lies in its allowed range.
    pub fn check(&self) -> Result<(), RangeError> {
        self.check_ranges()
    }
}

impl Choice for Side {
    const CHOICES: &'static [Self] = &[Self::Left, Self::Right];
}

impl Ranged for Settings {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self { chunk_size, terrain, settlements, roads, driving, cache } = self;
        walk.steps("chunk_size", chunk_size, 64.0, (64.0, 4096.0))?;
        walk.within("terrain", terrain)?;
        walk.within("settlements", settlements)?;
        walk.within("roads", roads)?;
        walk.choice("driving", driving)?;
        walk.within("cache", cache)?;
        roads.check_effort(settlements).map_err(|e| e.within("roads"))
    }
}

impl Ranged for CacheSettings {
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
        let Self { region_mib, town_mib, chunk_mib } = self;
        walk.number("region_mib", region_mib, 16.0, 65_536.0)?;
        walk.number("town_mib", town_mib, 8.0, 65_536.0)?;
        walk.number("chunk_mib", chunk_mib, 8.0, 65_536.0)
    }
}
