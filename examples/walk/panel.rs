//! The panel in the window: where the walker is, and figures of the streaming.

use crate::walker::Walker;
use bevy::math::DVec2;
use bevy::prelude::*;
use bevy_egui::{EguiContexts, egui};
use bevy_sprawl::prelude::*;

/// Asks to put the walker on a street near this plan point.
#[derive(Resource)]
pub struct Begin(pub DVec2);

/// What the panel remembers between frames.
#[derive(Resource, Default)]
pub struct Panel {
    seed: u64,
    place: String,
    looked_up: f32,
}

pub fn setup(mut commands: Commands, source: Res<SprawlSource>) {
    commands.insert_resource(Panel { seed: source.seed.0, ..default() });
}

/// Asks for a street near the wanted place.
pub fn begin(
    mut commands: Commands,
    wish: Option<Res<Begin>>,
    sprawl: Sprawl,
    walker: Single<(Entity, &mut Walker, &mut Transform)>,
) {
    let Some(wish) = wish else { return };
    let (entity, mut walker, mut transform) = walker.into_inner();
    walker.wait();
    transform.translation = sprawl.to_bevy(wish.0, 0.0);
    commands.entity(entity).insert(StartOnStreet::default());
    commands.remove_resource::<Begin>();
}

/// Lets the walker go once it stands on the street.
pub fn begun(_: On<Remove, StartOnStreet>, walker: Single<(&mut Walker, &Transform)>) {
    let (mut walker, transform) = walker.into_inner();
    walker.begin_at(transform);
}

pub fn show(
    mut contexts: EguiContexts,
    mut commands: Commands,
    mut panel: ResMut<Panel>,
    mut source: ResMut<SprawlSource>,
    mut gizmos: ResMut<GizmoConfigStore>,
    mut walker: Single<(&mut Walker, &Transform)>,
    (sprawl, stats, time): (Sprawl, Res<SprawlStats>, Res<Time<Real>>),
) -> Result {
    let at = walker.1.translation;
    let plan = sprawl.to_plan(at);
    panel.looked_up -= time.delta_secs();
    if panel.looked_up <= 0.0 {
        panel.looked_up = 0.3;
        let town = sprawl.settlement_at(at);
        panel.place = town.map_or("open country".into(), |s| format!("{} ({})", s.name, s.size.name()));
    }
    egui::Window::new("bevy_sprawl").default_width(230.0).show(contexts.ctx_mut()?, |ui| {
        egui::Grid::new("figures").num_columns(2).show(ui, |ui| {
            let mut row = |name: &str, value: String| {
                ui.label(name);
                ui.monospace(value);
                ui.end_row();
            };
            row("place", panel.place.clone());
            row("position", format!("{:.0}, {:.0} m", plan.x, plan.y));
            row("frame", format!("{:.1} ms", time.delta_secs() * 1000.0));
            row("plugin", format!("{:.2} ms", stats.main_thread_ms));
            row("chunks", format!("{} loaded, {} missing", stats.chunks_loaded, stats.chunks_missing));
            row("horizon", format!("{} tiles, {} missing", stats.tiles_loaded, stats.tiles_missing));
            row("made", format!("{} ({:.1} ms each)", stats.chunks_made, stats.chunk_ms));
            row("tasks", stats.tasks_in_flight.to_string());
        });
        ui.separator();
        ui.checkbox(&mut walker.0.flies, "fly (F)");
        ui.checkbox(&mut gizmos.config_mut::<SprawlGizmos>().0.enabled, "chunk borders, streets, ports");
        ui.horizontal(|ui| {
            ui.label("seed");
            ui.add(egui::DragValue::new(&mut panel.seed));
            if ui.button("go").clicked() {
                source.seed = Seed(panel.seed);
            }
            if ui.button("elsewhere").clicked() {
                commands.insert_resource(Begin(plan + DVec2::splat(3_000.0)));
            }
        });
        ui.small("Click to look around, Esc frees the mouse.\nWASD walks, Shift runs, F flies.");
    });
    Ok(())
}
