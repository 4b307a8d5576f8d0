//! Ports as cells see them, and main streets divided at their ports.

use super::port::{CellPort, Port, Seam};
use crate::network::{Junction, Network, Street, StreetId};
use crate::space::{Origin, left_normal, point_at, segments};
use crate::town::{MainStreet, Town};
use glam::DVec2;
use std::collections::BTreeMap;

/// The ports of the cell with index `cell` in [`Town::cells`], in order around its border.
pub fn cell_ports(town: &Town, seams: &[Seam], cell: usize) -> Vec<CellPort> {
    let mut out = Vec::new();
    let Some(cell) = town.cells.get(cell) else { return out };
    for side in &cell.sides {
        let Some((street, seam)) = side.main.and_then(|m| Some((town.mains.get(m)?, seams.get(m)?))) else { continue };
        let line = &street.street.line;
        let from = out.len();
        out.extend(seam.ports.iter().filter_map(|port| {
            let left = left_normal(point_at(line, port.along).1);
            let (class, inward) = if side.forward { (port.left?, left) } else { (port.right?, -left) };
            Some(CellPort { junction: port.junction, at: port.at, inward, class })
        }));
        if !side.forward {
            out[from..].reverse();
        }
    }
    out
}

/// The main streets divided at the ports, with all their junctions.
pub fn main_network(town: &Town, seams: &[Seam]) -> Network {
    let mut network = Network { junctions: town.junctions.clone(), streets: Vec::new() };
    for (main, seam) in town.mains.iter().zip(seams) {
        network.junctions.extend(seam.ports.iter().map(|p| Junction { id: p.junction, at: p.at }));
        network.streets.extend(divided(main, &seam.ports));
    }
    network
}

/// The streets of [`main_network`] that run along a border, with the origin of that border.
pub fn shared_streets(town: &Town, seams: &[Seam]) -> BTreeMap<StreetId, Origin> {
    let along = town.mains.iter().zip(seams).filter_map(|(main, seam)| Some((main.border.as_ref()?, main, seam)));
    along
        .flat_map(|(border, main, seam)| divided(main, &seam.ports).into_iter().map(|s| (s.id, border.origin)))
        .collect()
}

/// A main street cut at its ports; the street itself where it has none.
fn divided(main: &MainStreet, ports: &[Port]) -> Vec<Street> {
    let whole = &main.street;
    if ports.is_empty() {
        return vec![whole.clone()];
    }
    let (first, last) = (whole.line[0], whole.line[whole.line.len() - 1]);
    let stops: Vec<_> = std::iter::once((0.0, whole.from, first))
        .chain(ports.iter().map(|p| (p.along, p.junction, p.at)))
        .chain([(f64::INFINITY, whole.to, last)])
        .collect();
    // The street's own points of inflexion, with the metres along the street.
    let mut run = 0.0;
    let bends: Vec<(f64, DVec2)> = segments(&whole.line)
        .map(|(a, b)| {
            run += a.distance(b);
            (run, b)
        })
        .take(whole.line.len() - 2)
        .collect();
    stops
        .windows(2)
        .map(|w| {
            let ((start, from, a), (end, to, b)) = (w[0], w[1]);
            let mut line = vec![a];
            line.extend(bends.iter().filter(|(s, _)| *s > start && *s < end).map(|(_, p)| *p));
            line.push(b);
            let id = StreetId::of(&[whole.id.0, from.0, to.0]);
            Street { id, from, to, line, ..whole.clone() }
        })
        .collect()
}
