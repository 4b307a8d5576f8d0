//! The file of edits that commands read.

use crate::common::Common;
use crate::fail::Fail;
use crate::raster;
use bevy_sprawl::edits::{Edits, InfluenceMap, RejectedEdit};
use bevy_sprawl::layer::{FileError, error_at};
use bevy_sprawl::space::Geographic;
use bevy_sprawl::terrain::{Band, Holes, PngPlace};
use glam::DVec2;
use std::path::Path;

/// A file of edits as it is written, and what it says, with its painted maps.
pub struct EditsFile {
    pub name: String,
    pub text: String,
    pub edits: Edits,
}

impl EditsFile {
    /// The edits that the common flags name, if they do, with their maps. With a projection, all places are in degrees.
    pub fn read(common: &Common, geographic: Option<&Geographic>) -> Result<Option<Self>, Fail> {
        let Some(path) = common.edits.as_deref() else { return Ok(None) };
        let (name, text) = (path.to_string_lossy().into_owned(), crate::text::read(path)?);
        let mut edits = Edits::from_ron(&name, &text)?;
        let mut maps = Vec::new();
        for (index, map) in edits.influence_maps.iter_mut().enumerate() {
            let file = path.parent().unwrap_or(Path::new("")).join(&map.file);
            let field =
                |reason: &str| -> FileError { error_at(&name, &text, &format!("influence_maps[{index}]"), reason) };
            paint(map, &file, geographic, field)?;
            maps.push(file);
        }
        if let Some(geographic) = geographic {
            edits.move_places(|p| geographic.to_plan(p));
        }
        // Each command reads one file.
        let _ = common.maps.set(maps);
        Ok(Some(Self { name, text, edits }))
    }

    /// Names each of some edits that cannot be carried out in a line on stderr, and keeps the lines for the report.
    pub fn warn(&self, common: &Common, rejected: &[RejectedEdit]) {
        let lines: Vec<String> =
            RejectedEdit::all_in_file(rejected, &self.name, &self.text).iter().map(ToString::to_string).collect();
        lines.iter().for_each(|line| eprintln!("sprawl: warning: {line}"));
        // Each command makes one world.
        let _ = common.rejected.set(lines);
    }
}

/// Reads the cells of a painted map.
fn paint(
    map: &mut InfluenceMap,
    file: &Path,
    geographic: Option<&Geographic>,
    wrong: impl Fn(&str) -> FileError,
) -> Result<(), Fail> {
    let picture = raster::is_picture(file);
    if !picture && (map.corner.is_some() || map.cell.is_some() || map.black.is_some() || map.white.is_some()) {
        return Err(wrong("corner, cell, black and white are those of a picture; a grid says where it lies").into());
    }
    let raster = raster::read(file, Band::Influence, Holes::Value(0.0), geographic.is_some(), |_| {
        let (Some(corner), Some(cell), Some(white)) = (map.corner, map.cell, map.white) else {
            return Err(wrong(
                "a picture needs corner, cell and white: its place, the edge of a pixel, the cost of white",
            )
            .into());
        };
        Ok(PngPlace { corner, step: DVec2::splat(cell), black: map.black.unwrap_or(0.0), white })
    })?;
    map.paint(&match geographic {
        Some(geographic) => raster.projected(geographic),
        None => raster,
    });
    Ok(())
}
