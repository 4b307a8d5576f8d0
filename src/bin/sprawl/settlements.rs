//! `sprawl settlements`: the settlements of a square and the roads between them.

use crate::common::{At, Common};
use crate::crossings;
use crate::fail::Fail;
use crate::values::size;
use crate::work;
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::region::Settlement;
use clap::Args;
use serde_json::json;
use std::fmt::Write;
use std::sync::Arc;

#[derive(Args)]
pub struct SettlementsArgs {
    #[command(flatten)]
    pub at: At,
    /// Edge of the square in metres
    #[arg(long, value_name = "M", default_value = "20000", allow_hyphen_values = true, value_parser = size)]
    pub size: f64,
}

/// Runs the command: settlements centred in the square, connections with an end in it, and crossings of highways.
pub fn run(common: &Common, args: &SettlementsArgs) -> Result<(), Fail> {
    let world = work::world(common)?;
    let bounds = work::square(&world, &args.at, args.size)?;
    let settlements = world.settlements().centred_in(bounds)?;
    let links = world.roads().links(bounds, &Cancel::new())?;
    let unreached = world.roads().unreached(bounds, &Cancel::new())?;
    let names: Vec<&str> = unreached.iter().map(|s| s.name.as_str()).collect();
    work::warn_of_unreached(&names);
    let crossings = world.roads().crossings(bounds, &Cancel::new())?;
    let mut way_points = world.roads().way_points().to_vec();
    way_points.retain(|p| bounds.contains(p.centre.plan()));
    let hex = |id: u64| format!("{id:016x}");
    let mut report = json!({
        "settlements": settlements.iter().map(|s| {
            let at = s.centre.plan();
            json!({
                "id": hex(s.id.0), "x": at.x, "y": at.y, "radius_m": s.radius, "sigma": s.size as u8,
                "style": s.style, "name": s.name,
            })
        }).collect::<Vec<_>>(),
        "roads": links.iter().map(|l| json!({
            "id": hex(l.id.0), "from": hex(l.from.0), "to": hex(l.to.0), "class": l.class.name(),
            "length_m": l.length_m, "cost": l.cost, "bridges": l.bridges, "tunnels": l.tunnels,
        })).collect::<Vec<_>>(),
        "crossings": crossings::json(&crossings),
        "unreached": unreached.iter().map(|s| hex(s.id.0)).collect::<Vec<_>>(),
    });
    if !world.edits().way_points.is_empty() {
        let point = |p: &Arc<Settlement>| {
            let (at, junction) = (p.centre.plan(), world.roads().way_point_junction(p.id));
            json!({ "id": hex(p.id.0), "x": at.x, "y": at.y, "sigma": p.size as u8, "junction": hex(junction.0) })
        };
        report["way_points"] = way_points.iter().map(point).collect();
    }
    let mut people = String::new();
    let mut order: Vec<_> = settlements.iter().collect();
    order.sort_by(|a, b| b.size.cmp(&a.size).then_with(|| a.name.cmp(&b.name)).then(a.id.cmp(&b.id)));
    for s in order {
        let at = s.centre.plan();
        let size = format!("{:?}", s.size).to_lowercase();
        // Writing to a string cannot fail.
        let _ = writeln!(people, "{size:8}{:18} at {},{}  radius {:.0} m  {}", s.name, at.x, at.y, s.radius, s.style);
    }
    let name = |id| {
        settlements
            .iter()
            .chain(&way_points)
            .find(|s| s.id == id)
            .map_or_else(|| format!("{:016x}", id.0), |s| s.name.clone())
    };
    for l in &links {
        let ends = format!("{} - {}", name(l.from), name(l.to));
        let _ = write!(people, "{:8}{ends:34} {:.1} km", l.class.name(), l.length_m / 1000.0);
        for (count, one) in [(l.bridges, "bridge"), (l.tunnels, "tunnel")].into_iter().filter(|(n, _)| *n > 0) {
            let _ = write!(people, ", {count} {one}{}", if count == 1 { "" } else { "s" });
        }
        people.push('\n');
    }
    people += &crossings::people(&crossings);
    let _ = writeln!(people, "{} settlements, {} roads", settlements.len(), links.len());
    work::print(common, &report, &people)
}
