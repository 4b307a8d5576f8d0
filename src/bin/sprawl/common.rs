//! Flags that commands share.

use crate::fail::Fail;
use crate::values::point;
use clap::Args;
use glam::DVec2;
use std::path::PathBuf;
use std::sync::OnceLock;

/// Flags of every command.
#[derive(Args)]
pub struct Common {
    /// Seed of the world [default: 0]
    #[arg(long, global = true, value_name = "N")]
    seed: Option<u64>,
    /// Settings of the world, a RON file
    #[arg(long, global = true, value_name = "FILE")]
    pub settings: Option<PathBuf>,
    /// Folder with `styles/*.ron` and `patches/*.ron` in place of the bundled ones
    #[arg(long, global = true, value_name = "DIR")]
    pub assets: Option<PathBuf>,
    /// Wishes for settlements, roads and patches, a RON file
    #[arg(long, global = true, value_name = "FILE")]
    pub edits: Option<PathBuf>,
    /// Most threads to work on [default: one per core]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Write one JSON object to stdout
    #[arg(long, global = true)]
    pub json: bool,
    /// The edits that the world cannot fulfil, known once the world is made with a file of edits.
    #[arg(skip)]
    pub rejected: OnceLock<Vec<String>>,
    /// The painted maps that the file of edits names, known once it is read.
    #[arg(skip)]
    pub maps: OnceLock<Vec<PathBuf>>,
}

/// A flag of [`Common`] that not every command uses.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Flag {
    Seed,
    Settings,
    Assets,
    Edits,
}

impl Common {
    /// The seed of the world.
    pub fn seed(&self) -> u64 {
        self.seed.unwrap_or(0)
    }

    /// Fails if one of these flags is given: the command has no use for it.
    pub fn refuse(&self, command: &str, unused: &[Flag]) -> Result<(), Fail> {
        let given = |flag: &Flag| match flag {
            Flag::Seed => self.seed.is_some(),
            Flag::Settings => self.settings.is_some(),
            Flag::Assets => self.assets.is_some(),
            Flag::Edits => self.edits.is_some(),
        };
        match unused.iter().find(|f| given(f)) {
            Some(flag) => Err(Fail::input(format!("{command} does not use {}", flag.name()))),
            None => Ok(()),
        }
    }

    /// The files that the flags name, those that these name, and those of the folder of assets.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let maps = self.maps.get().into_iter().flatten();
        let mut out: Vec<PathBuf> = self.settings.iter().chain(&self.edits).chain(maps).cloned().collect();
        for folder in self.assets.iter().flat_map(|dir| [dir.join("styles"), dir.join("patches")]) {
            // A folder that cannot be read is refused when the assets are.
            out.extend(std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()));
        }
        out
    }
}

impl Flag {
    fn name(self) -> &'static str {
        match self {
            Self::Seed => "--seed",
            Self::Settings => "--settings",
            Self::Assets => "--assets",
            Self::Edits => "--edits",
        }
    }
}

/// The middle of a square.
#[derive(Args)]
pub struct At {
    /// Middle of the square, metres east and north
    #[arg(long, value_name = "X,Y", default_value = "0,0", allow_hyphen_values = true, value_parser = point)]
    pub at: DVec2,
}
