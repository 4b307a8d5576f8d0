//! Windows and doors: flat panes just in front of the walls, on every wall that no neighbour stands against.

use crate::mesh::buffers::{Coat, MeshBuffers, Rgb};
use crate::mesh::footing::Footing;
use crate::space::{Bounds, point_in_polygon, stable_hash};
use crate::texture::Texture;
use glam::DVec2;

const GLASS: Rgb = [0.040, 0.055, 0.075];
const DOORS: [Rgb; 4] = [[0.120, 0.050, 0.030], [0.045, 0.065, 0.095], [0.050, 0.080, 0.050], [0.180, 0.160, 0.140]];

/// Distance of a pane in front of its wall, in metres.
const PANE_OFFSET: f64 = 0.03;

/// Distance between the middles of neighbouring windows, in metres.
const PITCH: f64 = 2.7;

/// Length without windows at each end of a wall, in metres.
const WALL_END: f64 = 0.7;

/// Half the width of a window, in metres.
const HALF: f64 = 0.55;
/// Height of a window's sill above the floor, in metres.
const SILL: f64 = 0.9;
/// Height of a window, in metres.
const HEIGHT: f64 = 1.4;

/// Half the width and the height of a door, in metres.
const DOOR: (f64, f64) = (0.55, 2.1);

/// Buildings with this many storeys or more have a band of glass on each storey instead of windows.
const BANDED: u32 = 7;

/// The outside of a building.
pub(super) struct Facade<'a> {
    /// The footprint.
    pub plan: &'a [DVec2],
    /// Height of the ground floor, in metres.
    pub floor: f64,
    /// Number of storeys.
    pub storeys: u32,
    /// Height of a storey, in metres.
    pub storey_height: f64,
    /// Unit direction of the building's street, if it has one: the door is in the wall that runs along it.
    pub street: Option<DVec2>,
    /// Name of the building, from which the place of its door is drawn.
    pub id: u64,
}

/// Adds the windows and the door of a building. `neighbours` are the footprints around it with their boxes, its own included.
pub(super) fn windows(
    out: &mut MeshBuffers,
    facade: &Facade<'_>,
    neighbours: &[(Bounds, &[DVec2])],
    footing: &mut Footing<'_>,
) {
    let n = facade.plan.len();
    let door_wall = facade.street.and_then(|street| {
        let along = |i: usize| (facade.plan[(i + 1) % n] - facade.plan[i]).dot(street);
        (0..n).max_by(|i, j| along(*i).total_cmp(&along(*j)).then(j.cmp(i)))
    });
    for (i, &a) in facade.plan.iter().enumerate() {
        let b = facade.plan[(i + 1) % n];
        let length = a.distance(b);
        let count = ((length - 2.0 * WALL_END + PITCH - 2.0 * HALF) / PITCH).floor();
        if count < 1.0 {
            continue;
        }
        let u = (b - a) / length;
        let outwards = -u.perp();
        // A point outside the middle of the wall.
        let outside = (a + b) / 2.0 + outwards * 0.8;
        if neighbours.iter().any(|(bounds, plan)| bounds.contains(outside) && point_in_polygon(outside, plan)) {
            continue;
        }
        let mut pane = |out: &mut MeshBuffers, middle: DVec2, half: f64, low: f64, high: f64, colour: Rgb| {
            let (p, q) = (middle - u * half + outwards * PANE_OFFSET, middle + u * half + outwards * PANE_OFFSET);
            if low + 0.1 > footing.height(middle + outwards * PANE_OFFSET) {
                out.face(
                    &[p.extend(low), q.extend(low), q.extend(high), p.extend(high)],
                    Coat::new(Texture::Stone, colour),
                );
            }
        };
        if facade.storeys >= BANDED {
            for storey in 0..facade.storeys {
                let low = facade.floor + f64::from(storey) * facade.storey_height + SILL;
                pane(out, (a + b) / 2.0, length / 2.0 - WALL_END, low, low + HEIGHT, GLASS);
            }
            continue;
        }
        let door = (door_wall == Some(i)).then(|| (stable_hash(&[facade.id, 21]) % count as u64) as usize);
        for column in 0..count as usize {
            let middle = a + u * (length / 2.0 + (column as f64 - (count - 1.0) / 2.0) * PITCH);
            for storey in 0..facade.storeys {
                let floor = facade.floor + f64::from(storey) * facade.storey_height;
                let is_door = storey == 0 && door == Some(column);
                let (half, low, high) =
                    if is_door { (DOOR.0, floor, floor + DOOR.1) } else { (HALF, floor + SILL, floor + SILL + HEIGHT) };
                let colour = if is_door { DOORS[(facade.id % DOORS.len() as u64) as usize] } else { GLASS };
                pane(out, middle, half, low, high, colour);
            }
        }
    }
}
