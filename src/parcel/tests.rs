//! Random cells, and what must hold in each.

use crate::layer::{Cancel, Ranged};
use crate::network::{JunctionId, Street, StreetClass, StreetId};
use crate::parcel::{BlockUse, CellParcels, Footprint, ParcelBrief, divide};
use crate::patch::PatchBuilding;
use crate::space::{
    Bounds, Origin, Seed, Stream, cross, point_in_polygon, quantize, segment_crossing, segment_distance, segments,
    signed_area,
};
use crate::style::ParcelRules;
use crate::terrain::GroundTiles;
use crate::testing::{BlockCell, Flat, block_cell, divided, divided_with};
use crate::town::CellId;
use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use std::sync::Arc;

/// Rules as styles state them, in one of four cases anything that is allowed.
fn rules(rng: &mut Stream) -> ParcelRules {
    let (row, usual) = (rng.chance(0.4), rng.chance(0.75));
    let pick = |rng: &mut Stream, of: (f64, f64), all: (f64, f64)| {
        let (low, high) = if usual { of } else { all };
        // Small values are likelier than large ones.
        low + (high - low) * rng.unit() * rng.unit()
    };
    let width = pick(rng, (8.0, 20.0), (4.0, 500.0));
    let setback = |rng: &mut Stream, most: f64| if row { 0.0 } else { pick(rng, (1.0, most), (0.1, 100.0)) };
    let rules = ParcelRules {
        lot_width: (width, (width * rng.range(1.0, 2.0)).min(500.0)),
        lot_depth: pick(rng, (18.0, 45.0), (8.0, 500.0)),
        min_area: pick(rng, (60.0, 200.0), (20.0, 5_000.0)),
        setback_front: setback(rng, 7.0),
        setback_side: setback(rng, 3.0),
        building_depth: pick(rng, (9.0, 16.0), (4.0, 200.0)),
        wings: 0.5,
        ..ParcelRules::default()
    };
    rules.check_ranges().unwrap();
    rules
}

fn edges(polygon: &[DVec2]) -> Vec<(DVec2, DVec2)> {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()])).collect()
}

fn check_simple(polygon: &[DVec2], what: &str) {
    let e = edges(polygon);
    assert!(polygon.len() >= 3 && signed_area(polygon) > 0.0, "{what} {polygon:?}");
    assert!(polygon.iter().all(|p| quantize(*p) == *p), "{what} off the grid");
    for i in 0..e.len() {
        assert!(e[i].0 != e[i].1, "{what} repeats a point");
        for j in i + 2..e.len() {
            let neighbours = i == 0 && j == e.len() - 1;
            assert!(neighbours || segment_crossing(e[i].0, e[i].1, e[j].0, e[j].1).is_none(), "{what} {polygon:?}");
        }
    }
}

fn shared_area(p: &[DVec2], q: &[DVec2]) -> f64 {
    let ring = |p: &[DVec2]| p.iter().map(|v| [v.x, v.y]).collect::<Vec<_>>();
    let shapes = ring(p).overlay(&ring(q), OverlayRule::Intersect, FillRule::NonZero);
    let area = |c: &Vec<[f64; 2]>| signed_area(&c.iter().map(|v| DVec2::new(v[0], v[1])).collect::<Vec<_>>());
    shapes.iter().flatten().map(area).sum()
}

#[test]
fn random_cells_keep_every_promise() {
    let (mut lots, mut footprints) = (0, 0);
    for seed in 0..80 {
        let mut rng = Seed(seed).stream("test", &[]);
        let (columns, rows) = (2 + rng.index(3), 2 + rng.index(3));
        let pitch = rng.range(55.0, 130.0);
        let cell = block_cell(&mut rng, columns, rows, pitch);
        let rules = rules(&mut rng);
        let parcels = divided(seed, &cell, &rules);
        assert_eq!(parcels, divided(seed, &cell, &rules));
        assert!(!parcels.blocks.is_empty());
        let clear = |polygon: &[DVec2], what: &str| {
            for street in &cell.streets {
                for (a, b) in segments(&street.line) {
                    let distance = edges(polygon).iter().map(|e| segment_distance(e.0, e.1, a, b)).fold(1e9, f64::min);
                    assert!(
                        distance >= street.class.half_width(),
                        "seed {seed}: {what} at {distance} {:?}",
                        street.class
                    );
                    assert!(!point_in_polygon(a, polygon), "seed {seed}: {what} on a street");
                }
            }
        };
        for block in &parcels.blocks {
            check_simple(&block.polygon, "block");
            clear(&block.polygon, "block");
            assert!(block.polygon.iter().all(|p| point_in_polygon(*p, &cell.border) || {
                edges(&cell.border).iter().any(|e| segment_distance(*p, *p, e.0, e.1) < 0.02)
            }));
            let own: Vec<_> = parcels.lots.iter().filter(|l| l.block == block.id).collect();
            assert_eq!(own.is_empty(), block.land_use == BlockUse::Park);
            let area: f64 = own.iter().map(|l| signed_area(&l.polygon)).sum();
            assert!(area <= signed_area(&block.polygon));
            for (i, lot) in own.iter().enumerate() {
                check_simple(&lot.polygon, "lot");
                let inside = shared_area(&lot.polygon, &block.polygon);
                assert!(signed_area(&lot.polygon) - inside < 0.2, "seed {seed}: lot leaves its block");
                for other in &own[..i] {
                    let shared = shared_area(&lot.polygon, &other.polygon);
                    assert!(shared < 0.5, "seed {seed}: {shared} m2 shared by {:?} {:?}", lot.polygon, other.polygon);
                }
                let street = cell.streets.iter().find(|s| s.id == lot.street).unwrap();
                let middle = (lot.polygon[0] + lot.polygon[1]) / 2.0;
                let off = crate::space::distance_to_line(middle, &street.line) - street.class.half_width();
                assert!((-0.01..3.0).contains(&off), "seed {seed}: frontage {off} m from its street");
            }
        }
        for footprint in &parcels.footprints {
            check_simple(&footprint.polygon, "footprint");
            clear(&footprint.polygon, "footprint");
            let lot = parcels.lots.iter().find(|l| l.id == footprint.lot).unwrap();
            let inside = edges(&lot.polygon)
                .iter()
                .all(|(a, b)| footprint.polygon.iter().all(|p| cross(*b - *a, *p - *a) > 0.0));
            assert!(inside, "seed {seed}: footprint leaves its lot");
            assert!((rules.storeys.0..=rules.storeys.1).contains(&footprint.storeys));
            let area = signed_area(&footprint.polygon);
            assert!(area >= 35.0);
        }
        let mut ids: Vec<u64> = parcels.lots.iter().map(|l| l.id).chain(parcels.blocks.iter().map(|b| b.id)).collect();
        ids.extend(parcels.footprints.iter().map(|f| f.id));
        let count = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), count, "seed {seed}: ids are unique");
        (lots, footprints) = (lots + parcels.lots.len(), footprints + parcels.footprints.len());
    }
    assert!(lots > 2500 && footprints > lots * 7 / 10, "{lots} lots, {footprints} footprints");
}

/// Houses that come with the streets of a cell, at random, but on a grid, so that none shares land with another.
fn houses(rng: &mut Stream, cell: &BlockCell) -> Vec<PatchBuilding> {
    let bounds = Bounds::of(cell.border.iter().copied());
    let count = (bounds.size() / 20.0).as_ivec2();
    let mut out = Vec::new();
    for (x, y) in (0..count.y).flat_map(|y| (0..count.x).map(move |x| (x, y))) {
        if rng.chance(0.4) {
            let at = bounds.min + 20.0 * DVec2::new(f64::from(x), f64::from(y));
            let size = DVec2::new(rng.range(5.0, 19.0), rng.range(5.0, 19.0));
            let outline = [DVec2::ZERO, size.with_y(0.0), size, size.with_x(0.0)].map(|p| at + p).to_vec();
            out.push(PatchBuilding { outline, height: rng.chance(0.5).then_some(7.5), storeys: Some(3) });
        }
    }
    out
}

#[test]
fn buildings_that_come_with_the_streets_stand_on_lots_of_their_own() {
    let (mut stand, mut others, mut given) = (0, 0, 0);
    for seed in 0..40 {
        let mut rng = Seed(seed).stream("given", &[]);
        let cell = block_cell(&mut rng, 3, 3, 90.0);
        let sparse = seed % 2 == 0;
        let mut buildings = houses(&mut rng, &cell);
        if sparse {
            // Few in a block: others stand beside them.
            buildings.retain(|_| rng.chance(0.15));
        }
        let parcels = divided_with(seed, &cell, &rules(&mut rng), &buildings);
        given += buildings.len();
        let is_given = |f: &Footprint| parcels.lots.iter().any(|l| l.id == f.lot && l.polygon == f.polygon);
        for (i, footprint) in parcels.footprints.iter().enumerate() {
            check_simple(&footprint.polygon, "footprint");
            for other in &parcels.footprints[..i] {
                assert!(shared_area(&footprint.polygon, &other.polygon) < 0.1, "seed {seed}: two houses in one place");
            }
            for (a, b) in cell.streets.iter().flat_map(|s| segments(&s.line)) {
                assert!(edges(&footprint.polygon).iter().all(|e| segment_distance(e.0, e.1, a, b) > 4.9));
            }
            if !is_given(footprint) {
                others += 1;
                continue;
            }
            stand += 1;
            let area = signed_area(&footprint.polygon);
            let own = buildings.iter().filter(|b| shared_area(&b.outline, &footprint.polygon) > 0.99 * area);
            assert_eq!((own.count(), footprint.storeys), (1, 3));
            assert!(footprint.height == 7.5 || footprint.height == 9.5);
        }
        for (i, lot) in parcels.lots.iter().enumerate() {
            assert!(parcels.lots[..i].iter().all(|other| shared_area(&lot.polygon, &other.polygon) < 0.5));
        }
    }
    assert!(stand * 3 > given && others > 100, "{stand} of {given} stand, and {others} others");
}

#[test]
fn a_cell_of_slivers_or_without_streets_gives_nothing_to_build_on() {
    let triangle =
        BlockCell { border: [(0., 0.), (20., 0.), (0., 9.)].map(|(x, y)| DVec2::new(x, y)).to_vec(), streets: vec![] };
    assert_eq!(divided(1, &triangle, &ParcelRules::default()), CellParcels::default());
    let square = [(0., 0.), (90., 0.), (90., 90.), (0., 90.)].map(|(x, y)| DVec2::new(x, y)).to_vec();
    let parcels = divided(1, &BlockCell { border: square, streets: vec![] }, &ParcelRules::default());
    assert_eq!((parcels.blocks.len(), parcels.lots.len(), parcels.blocks[0].land_use), (1, 0, BlockUse::Park));
    assert_eq!(
        divided(1, &BlockCell { border: vec![], streets: vec![] }, &ParcelRules::default()),
        CellParcels::default()
    );
}

#[test]
fn a_ring_of_streets_inside_a_cell_leaves_no_hole() {
    let v = |x: f64, y: f64| DVec2::new(x, y);
    let border = vec![v(0., 0.), v(200., 0.), v(200., 200.), v(0., 200.)];
    let ring: Vec<DVec2> = vec![v(70., 70.), v(130., 70.), v(130., 130.), v(70., 130.), v(70., 70.)];
    let id = JunctionId::of(&[1]);
    let streets = vec![Street::new(StreetId::of(&[1]), StreetClass::Local, id, id, ring)];
    let parcels = divided(3, &BlockCell { border, streets }, &ParcelRules { parks: 0.0, ..ParcelRules::default() });
    assert_eq!(parcels.blocks.len(), 3);
    parcels.blocks.iter().for_each(|b| check_simple(&b.polygon, "block"));
    assert!(parcels.lots.len() > 8);
}

#[test]
fn a_cancelled_division_stops() {
    let cancel = Cancel::new();
    cancel.cancel();
    let rules = ParcelRules::default();
    let brief = ParcelBrief {
        seed: Seed(1),
        id: CellId(1),
        border: &[],
        streets: &[],
        buildings: &[],
        rules: &rules,
        centrality: 1.0,
        ground: &GroundTiles::new(Arc::new(Flat), 1 << 16),
        origin: Origin::default(),
    };
    assert!(divide(&brief, &cancel).is_err());
}
