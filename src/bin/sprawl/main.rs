//! The command line: maps, figures, settlements and digests of a world, roads of a finite domain, and checks of patch sets.

mod beside;
mod common;
mod crossings;
mod digest;
mod edits;
mod expressive;
mod extract;
mod fail;
mod inputs;
mod map;
mod mask;
mod output;
mod patches;
mod random_edits;
mod raster;
mod roads;
mod seams;
mod settlements;
mod soak;
mod stats;
mod synth;
mod text;
mod towns;
mod values;
mod windows;
mod work;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use common::Common;
use digest::DigestArgs;
use expressive::ExpressiveArgs;
use fail::Fail;
use map::MapArgs;
use patches::PatchesArgs;
use roads::RoadsArgs;
use seams::SeamsArgs;
use settlements::SettlementsArgs;
use soak::SoakArgs;
use stats::StatsArgs;
use std::process::ExitCode;
use synth::SynthArgs;
use towns::TownsArgs;

/// Endless worlds of towns: maps, figures and checks.
#[derive(Parser)]
#[command(name = "sprawl", version, max_term_width = 100)]
struct Cli {
    #[command(flatten)]
    common: Common,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Draw or export a square of the world
    Map(MapArgs),
    /// Figures of the streets, blocks and buildings of a square
    Stats(StatsArgs),
    /// Settlements of a square and the roads between them
    Settlements(SettlementsArgs),
    /// A hash per layer and chunk, to compare worlds bit for bit
    Digest(DigestArgs),
    /// Check a city of each of many worlds: ends, crossings, loose pieces, buildings on streets
    Soak(SoakArgs),
    /// Count streets near chunk borders and away from them: nothing may tell where the borders are
    Seams(SeamsArgs),
    /// Measure towns of every style, and hold them against real ones
    Towns(TownsArgs),
    /// What the parametric generator can make: connectivity against density of many networks
    ExpressiveRange(ExpressiveArgs),
    /// Roads between given settlements on given ground
    Roads(Box<RoadsArgs>),
    /// Check or draw patch sets, or extract them from real maps
    Patches(PatchesArgs),
    /// Make a square from real maps by texture synthesis, without a world
    Synth(Box<SynthArgs>),
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {
            // Printing help to a closed pipe is no failure.
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
        Err(error) => return Fail::from(error).report(),
    };
    output::clean_up_when_stopped();
    let result = match &cli.command {
        Command::Map(args) => map::run(&cli.common, args),
        Command::Stats(args) => stats::run(&cli.common, args),
        Command::Settlements(args) => settlements::run(&cli.common, args),
        Command::Digest(args) => digest::run(&cli.common, args),
        Command::Soak(args) if args.windows => windows::run(&cli.common, args),
        Command::Soak(args) if args.inputs.is_some() => inputs::run(&cli.common, args),
        Command::Soak(args) => soak::run(&cli.common, args),
        Command::Seams(args) => seams::run(&cli.common, args),
        Command::Towns(args) => towns::run(&cli.common, args),
        Command::ExpressiveRange(args) => expressive::run(&cli.common, args),
        Command::Roads(args) => roads::run(&cli.common, args),
        Command::Patches(args) => patches::run(&cli.common, args),
        Command::Synth(args) => synth::run(&cli.common, args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(fail) => fail.report(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use glam::DVec2;
    use values::ChunkRange;

    #[test]
    fn the_flags_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn negative_numbers_work_in_both_forms() {
        for flags in [&["--at", "-5,7.5"][..], &["--at=-5,7.5"]] {
            let all = [&["sprawl", "stats"][..], flags, &["--seed", "18446744073709551615"]].concat();
            let cli = Cli::try_parse_from(all).unwrap();
            assert_eq!(cli.common.seed(), u64::MAX);
            let Command::Stats(stats) = cli.command else { panic!() };
            assert_eq!(stats.at.at, DVec2::new(-5.0, 7.5));
        }
        for flags in [&["--chunks", "-2..1,-9..-8"][..], &["--chunks=-2..1,-9..-8"]] {
            let cli = Cli::try_parse_from([&["sprawl", "digest"][..], flags].concat()).unwrap();
            let Command::Digest(digest) = cli.command else { panic!() };
            assert_eq!(digest.chunks, ChunkRange { x: -2..1, y: -9..-8 });
        }
    }
}
