//! Buildings of a mosaic: those of its tiles, each once, where they collide with nothing.
//!
//! Bustard and de Valmency 2015 leave out every building that a tile's side cuts, and propose to keep those that collide with
//! nothing (section 4). Here a building belongs to the tile that its middle lies in, and may reach out of it; where it would stand in a
//! building of the next tile, what lies in its own tile is left of it.

use super::mosaic::Mosaic;
use super::weave::Warp;
use super::window::turned;
use crate::patch::PatchBuilding;
use crate::space::{Bounds, centroid, common_parts, point_in_polygon, polygon_distance, signed_area};
use glam::DVec2;
use std::collections::BTreeMap;

/// Edge of the squares by which buildings are found, in metres.
const SQUARE: f64 = 50.0;
/// Buildings that share less than this stand side by side, in square metres.
const SHARED: f64 = 0.5;
/// How far a building of a tile may reach out of it and still count as within, in metres.
const WITHIN: f64 = 0.05;
/// The least part of a building that is kept where a tile's side cuts it: a share of its area, and square metres.
const LEAST_PART: (f64, f64) = (0.35, 16.0);
/// Least area of a part for each metre of its border: thinner parts are no buildings.
const LEAST_WIDTH: f64 = 1.1;

/// A building where its tile puts it.
pub struct Site {
    /// The building, in metres from the south-west corner of the mosaic.
    pub building: PatchBuilding,
    /// The square of its tile.
    tile: Bounds,
    /// The patch of its tile, as index into [`TileTable::patches`](super::table::TileTable::patches).
    pub patch: u32,
}

/// The buildings of all tiles of a mosaic.
pub fn sites(mosaic: &Mosaic<'_>, warps: &BTreeMap<(usize, usize), Warp>) -> Vec<Site> {
    let table = mosaic.table;
    let half = table.size / 2.0;
    let mut out = Vec::new();
    for (place, placed) in mosaic.places() {
        let (tile, middle) = (table.tile(placed.choice.tile), mosaic.middle(place.0, place.1));
        let Some(window) = &table.patches[tile.patch as usize].window else { continue };
        let at = |p: DVec2| turned(p, tile.turns) - placed.choice.shift;
        for building in &window.buildings {
            let own = at(centroid(&building.outline));
            // A building whose middle lies on a side is of one tile alone.
            if own.cmplt(DVec2::splat(-half)).any() || own.cmpge(DVec2::splat(half)).any() {
                continue;
            }
            let outline = building.outline.iter().map(|p| middle + warps[&place].of(at(*p))).collect();
            let building = PatchBuilding { outline, ..building.clone() };
            out.push(Site { building, tile: Bounds::square(middle, table.size), patch: tile.patch });
        }
    }
    out
}

/// The buildings that may stand: where `is_free` holds for an outline of a site, and where no other stands. Those within their tiles come
/// first, then the larger ones.
pub fn settle(sites: Vec<Site>, is_free: impl Fn(&Site, &[DVec2]) -> bool) -> Vec<PatchBuilding> {
    let mut standing = Standing::default();
    let (within, mut across): (Vec<Site>, Vec<Site>) = sites
        .into_iter()
        .partition(|site| site.tile.grown(WITHIN).encloses(Bounds::of(site.building.outline.iter().copied())));
    for site in within {
        // Those of one tile stand as they do in its map.
        if is_free(&site, &site.building.outline) {
            standing.add(site.building);
        }
    }
    across.sort_by(|a, b| signed_area(&b.building.outline).total_cmp(&signed_area(&a.building.outline)));
    for site in across {
        let stands = |outline: &[DVec2]| is_free(&site, outline) && !standing.collides(outline);
        if stands(&site.building.outline) {
            standing.add(site.building);
        } else if let Some(outline) = part(&site).filter(|outline| stands(outline)) {
            standing.add(PatchBuilding { outline, ..site.building });
        }
    }
    standing.buildings
}

/// The greatest part of a building that lies in its tile, if enough does.
fn part(site: &Site) -> Option<Vec<DVec2>> {
    let Bounds { min, max } = site.tile;
    let square = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
    let parts = common_parts(&site.building.outline, &square);
    let part = parts.into_iter().max_by(|a, b| signed_area(a).total_cmp(&signed_area(b)))?;
    let (area, whole) = (signed_area(&part), signed_area(&site.building.outline));
    let border: f64 = (0..part.len()).map(|i| part[i].distance(part[(i + 1) % part.len()])).sum();
    (area >= LEAST_PART.1.max(LEAST_PART.0 * whole) && area >= LEAST_WIDTH * border).then_some(part)
}

/// Whether a street runs through a building, or nearer to it than `gap` metres.
pub fn is_near(a: DVec2, b: DVec2, outline: &[DVec2], gap: f64) -> bool {
    polygon_distance(a, b, outline) < gap || point_in_polygon(a, outline)
}

/// Buildings that stand, by place.
#[derive(Default)]
struct Standing {
    buildings: Vec<PatchBuilding>,
    bounds: Vec<Bounds>,
    squares: BTreeMap<(i64, i64), Vec<u32>>,
}

impl Standing {
    fn squares_of(bounds: Bounds) -> impl Iterator<Item = (i64, i64)> {
        let (low, high) = ((bounds.min / SQUARE).floor().as_i64vec2(), (bounds.max / SQUARE).floor().as_i64vec2());
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| (x, y)))
    }

    fn add(&mut self, building: PatchBuilding) {
        let bounds = Bounds::of(building.outline.iter().copied());
        let number = self.buildings.len() as u32;
        for square in Self::squares_of(bounds) {
            self.squares.entry(square).or_default().push(number);
        }
        self.bounds.push(bounds);
        self.buildings.push(building);
    }

    /// Whether an outline shares land with a building that stands.
    fn collides(&self, outline: &[DVec2]) -> bool {
        let bounds = Bounds::of(outline.iter().copied());
        let mut near: Vec<u32> =
            Self::squares_of(bounds).filter_map(|s| self.squares.get(&s)).flatten().copied().collect();
        near.sort_unstable();
        near.dedup();
        near.retain(|i| self.bounds[*i as usize].overlaps(bounds));
        let shared = |i: &u32| -> f64 {
            let parts = common_parts(&self.buildings[*i as usize].outline, outline);
            parts.iter().map(|part| signed_area(part)).sum()
        };
        near.iter().any(|i| shared(i) > SHARED)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;

    fn rectangle(corner: DVec2, size: DVec2) -> Vec<DVec2> {
        let DVec2 { x, y } = corner;
        [(x, y), (x + size.x, y), (x + size.x, y + size.y), (x, y + size.y)].map(DVec2::from).to_vec()
    }

    fn site(tile: f64, outline: Vec<DVec2>) -> Site {
        let tile = Bounds::square(DVec2::new(tile, 0.0), 100.0);
        Site { building: PatchBuilding { outline, height: None, storeys: None }, tile, patch: 0 }
    }

    fn areas(buildings: &[PatchBuilding]) -> Vec<f64> {
        buildings.iter().map(|b| (signed_area(&b.outline) * 1e3).round() / 1e3).collect()
    }

    #[test]
    fn a_building_across_a_side_stands_once_and_others_are_cut_where_they_meet_it() {
        let v = DVec2::new;
        let sites = || {
            vec![
                site(-50.0, rectangle(v(-12.0, 0.0), v(20.0, 10.0))),
                site(50.0, rectangle(v(-4.0, 5.0), v(12.0, 10.0))),
                site(50.0, rectangle(v(-4.0, 40.0), v(12.0, 10.0))),
                site(50.0, rectangle(v(5.0, 7.0), v(30.0, 20.0))),
            ]
        };
        // The large house within its tile comes first, then the one of 200 m2 is cut at the side; the third meets nothing.
        let stands = areas(&settle(sites(), |_, _| true));
        assert_eq!(stands, [600.0, 120.0, 120.0], "the house of 120 m2 that both of them meet has too little left");
        let none = settle(sites(), |site, _| site.tile.centre().x < 0.0);
        assert_eq!(areas(&none), [200.0], "whole where nothing else is");
    }

    #[test]
    fn no_two_buildings_share_land_wherever_tiles_put_them() {
        let mut rng = Seed(5).stream("buildings", &[]);
        for _ in 0..60 {
            let off = rng.range(-2.0, 2.0);
            let sites: Vec<Site> = (0..40)
                .flat_map(|i| {
                    // In rows within each tile, so that those of one tile share nothing.
                    let tile = if i % 2 == 0 { -50.0 } else { 50.0 };
                    let y = f64::from(i / 2) * 5.0 - 50.0;
                    let x = if i % 2 == 0 { -rng.range(2.0, 30.0) } else { rng.range(-10.0, 5.0) };
                    let size = DVec2::new(rng.range(6.0, 30.0), rng.range(3.0, 4.9));
                    let outline = rectangle(DVec2::new(x, y + off * f64::from(i % 2)), size);
                    let own = Bounds::square(DVec2::new(tile, 0.0), 100.0).contains(centroid(&outline));
                    own.then(|| site(tile, outline))
                })
                .collect();
            let count = sites.len();
            let stands = settle(sites, |_, _| true);
            assert!(stands.len() * 3 > count && stands.len() <= count);
            for (i, a) in stands.iter().enumerate() {
                for b in &stands[..i] {
                    let shared: f64 = common_parts(&a.outline, &b.outline).iter().map(|p| signed_area(p)).sum();
                    assert!(shared <= SHARED, "{shared} m2");
                }
            }
        }
    }
}
