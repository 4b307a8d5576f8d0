//! The command line: maps, figures, settlements and digests of a world, roads of a finite domain, and checks of patch sets.

mod args;
mod beside;
mod digest;
mod drawn;
mod expressive;
mod fail;
mod map;
mod patches;
mod roads;
mod seams;
mod settlements;
mod soak;
mod stats;
mod towns;
mod windows;
mod work;

use args::{Cli, Command};
use clap::Parser;
use clap::error::ErrorKind;
use fail::Fail;
use std::process::ExitCode;

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
    let result = match &cli.command {
        Command::Map(args) => map::run(&cli.common, args),
        Command::Stats(args) => stats::run(&cli.common, args),
        Command::Settlements(args) => settlements::run(&cli.common, args),
        Command::Digest(args) => digest::run(&cli.common, args),
        Command::Soak(args) if args.windows => windows::run(&cli.common, args),
        Command::Soak(args) => soak::run(&cli.common, args),
        Command::Seams(args) => seams::run(&cli.common, args),
        Command::Towns(args) => towns::run(&cli.common, args),
        Command::ExpressiveRange(args) => expressive::run(&cli.common, args),
        Command::Roads(args) => roads::run(&cli.common, args),
        Command::Patches(args) => patches::run(&cli.common, args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(fail) => fail.report(),
    }
}
