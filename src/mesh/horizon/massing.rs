//! Towns from afar: boxes in place of buildings.

use super::tile::HorizonTile;
use crate::mesh::buffers::{Coat, MeshBuffers};
use crate::mesh::buildings::{ROOFS, WALLS};
use crate::parcel::STOREY_HEIGHT;
use crate::region::{Outline, Settlement};
use crate::space::{Bounds, Seed, math};
use crate::style::ParcelRules;
use crate::terrain::Terrain;
use glam::{DVec2, DVec3, I64Vec2};

/// A settlement as it is seen from afar.
#[derive(Clone, Copy, Debug)]
pub struct HorizonTown<'a> {
    /// The settlement.
    pub settlement: &'a Settlement,
    /// Its outline.
    pub outline: &'a Outline,
    /// What its style says of lots and buildings.
    pub parcels: &'a ParcelRules,
}

impl HorizonTown<'_> {
    /// Share of a settlement's land that buildings cover, about.
    fn cover(&self) -> f64 {
        let ParcelRules { lot_width, lot_depth, setback_side, building_depth, vacant, parks, .. } = *self.parcels;
        let width = (lot_width.0 + lot_width.1) / 2.0;
        let of_lot = (building_depth / lot_depth).min(1.0) * ((width - 2.0 * setback_side) / width).max(0.1);
        STREETS * of_lot * (1.0 - vacant) * (1.0 - parks)
    }

    /// Whether a plan point lies in the settlement.
    pub(super) fn contains(&self, plan: DVec2) -> bool {
        self.outline.bounds().contains(plan) && self.outline.contains(plan)
    }
}

/// Distance between boxes of level 1, in metres; those of each level stand half as far again apart as those below.
const SPACING: f64 = 46.0;

/// Distance that boxes keep from the outline, in metres.
const RIM: f64 = 12.0;

/// Share of a settlement's land that streets leave.
const STREETS: f64 = 0.75;

/// Depth of boxes in the ground, in metres.
const FOOT: f64 = 4.0;

/// Turn of a town's rows of boxes, for each of the few headings that rows have.
const HEADINGS: u64 = 7;

/// The boxes of all towns in a tile, from its south-west corner. Each box stands in one tile of a level.
pub(super) fn massing(
    tile: HorizonTile,
    chunk_size: i64,
    terrain: &dyn Terrain,
    towns: &[HorizonTown<'_>],
) -> MeshBuffers {
    let mut out = MeshBuffers::default();
    let square = tile.bounds(chunk_size);
    let spacing = (1..tile.level).fold(SPACING, |spacing, _| spacing * 1.5);
    let mut towns: Vec<&HorizonTown<'_>> = towns.iter().collect();
    towns.sort_by_key(|town| town.settlement.id);
    for town in towns {
        let bounds = town.outline.bounds();
        if !bounds.overlaps(square) {
            continue;
        }
        let centre = town.settlement.centre.plan();
        let heading = (town.settlement.id.0 % HEADINGS) as f64 * (std::f64::consts::FRAC_PI_2 / HEADINGS as f64);
        let (along, across) = (math::direction(heading), math::direction(heading).perp());
        // The part of the lattice around the tile, seen in the directions of the rows.
        let seen = Bounds::new(bounds.min.max(square.min), bounds.max.min(square.max)).moved(-centre);
        let corners = [seen.min, seen.max, DVec2::new(seen.min.x, seen.max.y), DVec2::new(seen.max.x, seen.min.y)];
        let cells = Bounds::of(corners.map(|p| DVec2::new(along.dot(p), across.dot(p)) / spacing));
        for y in cells.min.y.floor() as i64..=cells.max.y.ceil() as i64 {
            for x in cells.min.x.floor() as i64..=cells.max.x.ceil() as i64 {
                let plan = centre + (along * x as f64 + across * y as f64) * spacing;
                let inside = (0..2).all(|k| plan[k] >= square.min[k] && plan[k] < square.max[k]);
                if inside && town.outline.clearance(plan) > RIM {
                    let place = Place { plan, along, spacing, cell: I64Vec2::new(x, y) };
                    raise(&mut out, &place, town, terrain, square.min);
                }
            }
        }
    }
    out
}

/// A place of the lattice of boxes.
struct Place {
    plan: DVec2,
    along: DVec2,
    spacing: f64,
    cell: I64Vec2,
}

/// Raises a box, or none where the ground is wet or the draw leaves it open.
fn raise(out: &mut MeshBuffers, place: &Place, town: &HorizonTown<'_>, terrain: &dyn Terrain, corner: DVec2) {
    let ground = terrain.sample(place.plan);
    let (settlement, cell) = (town.settlement, place.cell);
    let key = [settlement.id.0, cell.x as u64, cell.y as u64, place.spacing.to_bits()];
    let mut rng = Seed(settlement.id.0).stream("horizon", &key);
    // From the middle to the rim, towns get lower and more open.
    let rim = (place.plan.distance(settlement.centre.plan()) / settlement.radius.max(1.0)).min(1.0);
    if ground.depth() > 0.0 || rng.chance(0.15 + 0.45 * rim * rim) {
        return;
    }
    // Places are left open, so the boxes are larger than that share of the spacing.
    let edge = place.spacing * (town.cover().clamp(0.02, 0.6) / 0.7).sqrt();
    let long = edge * rng.range(0.8, 1.5);
    let half = DVec2::new(long, (edge * edge / long).min(place.spacing)) / 2.0;
    let (low, high) = (f64::from(town.parcels.storeys.0), f64::from(town.parcels.storeys.1));
    let storeys = low + (high - low) * (1.0 - rim) * rng.range(0.5, 1.0);
    let (floor, top) = (ground.height - FOOT, ground.height + storeys.max(1.0) * STOREY_HEIGHT);
    let (x, y) = if rng.chance(0.5) { (place.along, place.along.perp()) } else { (place.along.perp(), -place.along) };
    let ring = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(a, b)| place.plan - corner + x * (a * half.x) + y * (b * half.y));
    let (wall, roof): (Coat, Coat) = (WALLS[rng.index(WALLS.len())], ROOFS[rng.index(ROOFS.len())]);
    for i in 0..4 {
        let (a, b) = (ring[i], ring[(i + 1) % 4]);
        out.face(&[a.extend(floor), b.extend(floor), b.extend(top), a.extend(top)], wall);
    }
    out.face(&ring.map(|p| -> DVec3 { p.extend(top) }), roof);
}
