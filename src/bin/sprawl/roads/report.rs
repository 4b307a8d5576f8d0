//! What `sprawl roads` says of a network.

use crate::crossings;
use bevy_sprawl::network::StreetClass;
use bevy_sprawl::region::{RoadNetwork, SettlementId};
use bevy_sprawl::space::Geographic;
use serde_json::{Value as Json, json};

fn hex(id: u64) -> String {
    format!("{id:016x}")
}

/// The report on a network.
pub fn json(network: &RoadNetwork) -> Json {
    let of = |class: StreetClass| {
        let links: Vec<_> = network.links.iter().filter(|l| l.class == class).collect();
        let pieces = network.roads.iter().filter(|r| r.street.class == class);
        json!({
            "roads": links.len(),
            "length_m": pieces.fold(0.0, |sum, r| sum + r.street.length()),
            "cost": links.iter().fold(0.0, |sum, l| sum + l.cost),
        })
    };
    let classes = [StreetClass::Highway, StreetClass::Major, StreetClass::Minor];
    json!({
        "settlements": network.settlements.iter().map(|s| {
            let at = s.centre.plan();
            json!({
                "id": hex(s.id.0), "x": at.x, "y": at.y, "radius_m": s.radius, "sigma": s.size as u8, "name": s.name,
            })
        }).collect::<Vec<_>>(),
        "roads": network.links.iter().map(|l| json!({
            "id": hex(l.id.0), "from": hex(l.from.0), "to": hex(l.to.0), "class": l.class.name(),
            "length_m": l.length_m, "cost": l.cost, "bridges": l.bridges, "tunnels": l.tunnels,
        })).collect::<Vec<_>>(),
        "totals": {
            "settlements": network.settlements.len(),
            "roads": network.links.len(),
            "pieces": network.roads.len(),
            "junctions": network.junctions(bevy_sprawl::space::Origin::at(network.domain.centre())).len(),
            "length_m": network.length(),
            "bridges": network.links.iter().map(|l| l.bridges).sum::<usize>(),
            "tunnels": network.links.iter().map(|l| l.tunnels).sum::<usize>(),
            "classes": classes.into_iter().map(|c| (c.name().to_owned(), of(c))).collect::<serde_json::Map<_, _>>(),
        },
        "crossings": crossings::json(&network.crossings),
        "unreached": network.unreached.iter().map(|id| name(network, *id)).collect::<Vec<_>>(),
    })
}

/// How degrees became plan metres: a place at `x`,`y` metres lies at `middle + (x, y) / metres_per_degree` degrees.
pub fn projection(projection: &Geographic) -> Json {
    json!({
        "kind": "local equirectangular",
        "middle": projection.middle().to_array(),
        "metres_per_degree": projection.metres_per_degree().to_array(),
    })
}

/// The name of a settlement.
pub fn name(network: &RoadNetwork, id: SettlementId) -> String {
    let found = network.settlements.iter().find(|s| s.id == id);
    found.map_or_else(|| hex(id.0), |s| s.name.clone())
}

/// The line for people.
pub fn people(network: &RoadNetwork, report: &Json) -> String {
    let totals = &report["totals"];
    let km = |v: &Json| v.as_f64().unwrap_or(0.0) / 1000.0;
    let classes = ["highway", "major", "minor"].map(|c| {
        let of = &totals["classes"][c];
        format!("{} {c} ({:.0} km)", of["roads"], km(&of["length_m"]))
    });
    let ms = |key: &str| report["timing_ms"][key].as_f64().unwrap_or(0.0) / 1000.0;
    format!(
        "{}: {} settlements, {} roads of {:.0} km: {} ({:.2} s; reading {:.2} s, drawing {:.2} s)",
        report["file"].as_str().unwrap_or_default(),
        network.settlements.len(),
        network.links.len(),
        km(&totals["length_m"]),
        classes.join(", "),
        ms("build"),
        ms("read"),
        ms("write"),
    )
}
