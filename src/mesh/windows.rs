//! Windows and doors: flat panes just before the walls, on every wall that no neighbour stands against.

use crate::mesh::buffers::{MeshBuffers, Rgb};
use crate::mesh::buildings::STOREY;
use crate::mesh::drape::Drape;
use crate::space::{Bounds, point_in_polygon, stable_hash};
use glam::DVec2;

const GLASS: Rgb = [0.040, 0.055, 0.075];
const DOORS: [Rgb; 4] = [[0.120, 0.050, 0.030], [0.045, 0.065, 0.095], [0.050, 0.080, 0.050], [0.180, 0.160, 0.140]];

/// Distance of panes before the wall, in metres.
const BEFORE: f64 = 0.03;

/// Distance from one window to the next, and what stays free at the ends of a wall.
const PITCH: f64 = 2.7;
const ENDS: f64 = 0.7;

/// Half the width of a window, height of its sill above the floor, and its own height.
const HALF: f64 = 0.55;
const SILL: f64 = 0.9;
const TALL: f64 = 1.4;

/// Half the width and the height of a door.
const DOOR: (f64, f64) = (0.55, 2.1);

/// Storeys from which a wall has one band of glass a storey instead of windows.
const BANDED: u32 = 7;

/// A building whose walls get windows.
pub(super) struct Storeys<'a> {
    pub plan: &'a [DVec2],
    pub floor: f64,
    pub count: u32,
    /// Direction of the street, where the building has one: the door is in a wall along it.
    pub street: Option<DVec2>,
    pub id: u64,
}

/// Adds the windows and the door of a building. `neighbours` are the plans around it with their boxes, its own among them.
pub(super) fn windows(
    out: &mut MeshBuffers,
    of: &Storeys<'_>,
    neighbours: &[(Bounds, &[DVec2])],
    drape: &mut Drape<'_>,
) {
    let n = of.plan.len();
    let door_wall = of.street.and_then(|street| {
        let along = |i: usize| (of.plan[(i + 1) % n] - of.plan[i]).dot(street);
        (0..n).max_by(|i, j| along(*i).total_cmp(&along(*j)).then(j.cmp(i)))
    });
    for (i, &a) in of.plan.iter().enumerate() {
        let b = of.plan[(i + 1) % n];
        let length = a.distance(b);
        let count = ((length - 2.0 * ENDS + PITCH - 2.0 * HALF) / PITCH).floor();
        if count < 1.0 {
            continue;
        }
        let u = (b - a) / length;
        let outwards = -u.perp();
        let beside = (a + b) / 2.0 + outwards * 0.8;
        if neighbours.iter().any(|(bounds, plan)| bounds.contains(beside) && point_in_polygon(beside, plan)) {
            continue;
        }
        let mut pane = |out: &mut MeshBuffers, middle: DVec2, half: f64, low: f64, high: f64, colour: Rgb| {
            let (p, q) = (middle - u * half + outwards * BEFORE, middle + u * half + outwards * BEFORE);
            if low + 0.1 > drape.height(middle + outwards * BEFORE) {
                out.face(&[p.extend(low), q.extend(low), q.extend(high), p.extend(high)], colour);
            }
        };
        if of.count >= BANDED {
            for storey in 0..of.count {
                let low = of.floor + f64::from(storey) * STOREY + SILL;
                pane(out, (a + b) / 2.0, length / 2.0 - ENDS, low, low + TALL, GLASS);
            }
            continue;
        }
        let door = (door_wall == Some(i)).then(|| (stable_hash(&[of.id, 21]) % count as u64) as usize);
        for column in 0..count as usize {
            let middle = a + u * (length / 2.0 + (column as f64 - (count - 1.0) / 2.0) * PITCH);
            for storey in 0..of.count {
                let floor = of.floor + f64::from(storey) * STOREY;
                let is_door = storey == 0 && door == Some(column);
                let (half, low, high) =
                    if is_door { (DOOR.0, floor, floor + DOOR.1) } else { (HALF, floor + SILL, floor + SILL + TALL) };
                let colour = if is_door { DOORS[(of.id % DOORS.len() as u64) as usize] } else { GLASS };
                pane(out, middle, half, low, high, colour);
            }
        }
    }
}
