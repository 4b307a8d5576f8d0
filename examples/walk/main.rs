//! Walk through an endless world of towns.
//!
//! `cargo run --example walk` opens a window: WASD and the mouse, Shift runs, F flies, Esc frees the mouse. Without a
//! display or a graphics adapter it walks through a town by itself and leaves a map, screenshots and a report under
//! `target/walk`; `-- --headless` does that anywhere, `-- --help` lists the rest.

mod args;
mod headless;
mod map;
mod panel;
mod report;
mod scene;
mod shots;
mod tour;
mod walker;

use bevy::prelude::*;
use bevy::render::renderer::initialize_renderer;
use bevy::render::settings::{RenderCreation, WgpuSettings};
use bevy::tasks::block_on;
use shots::Draws;
use std::panic::{catch_unwind, set_hook, take_hook};

fn main() -> AppExit {
    let args = match args::parse(std::env::args().skip(1)) {
        Ok(Some(args)) => args,
        Ok(None) => {
            println!("{}", args::HELP);
            return AppExit::Success;
        }
        Err(error) => {
            eprintln!("error: {error}");
            return AppExit::from_code(2);
        }
    };
    let adapter = adapter();
    let draws = adapter.as_ref().map_or(Draws::Not, |(_, draws)| *draws);
    let why = match draws {
        _ if args.headless => None,
        _ if !has_display() => Some("there is no display"),
        Draws::Not => Some("there is no graphics adapter"),
        Draws::InSoftware | Draws::WithCard => return walker::window(args, draws),
    };
    if let Some(why) = why {
        println!("No window, since {why}: the walk goes by itself (--help lists its options).");
    }
    headless::run(args, adapter.map(|(creation, _)| creation), draws)
}

fn has_display() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    !cfg!(target_os = "linux") || set("DISPLAY") || set("WAYLAND_DISPLAY")
}

/// A device to draw with, if there is an adapter. Bevy panics if there is none, so the panic is caught.
fn adapter() -> Option<(RenderCreation, Draws)> {
    let settings = WgpuSettings::default();
    let backends = settings.backends?;
    let hook = take_hook();
    set_hook(Box::new(|_| {}));
    let made = catch_unwind(|| block_on(initialize_renderer(backends, None, &settings)));
    set_hook(hook);
    let resources = made.ok()?;
    // The type itself belongs to `wgpu`, which the example does not depend on.
    let in_software = format!("{:?}", resources.2.device_type) == "Cpu";
    let draws = if in_software { Draws::InSoftware } else { Draws::WithCard };
    Some((RenderCreation::Manual(resources), draws))
}
