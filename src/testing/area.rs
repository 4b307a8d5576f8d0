//! The content of a square: a small town on hilly ground.

use crate::export::Plan;
use crate::network::{Junction, JunctionId, Side, SizeClass, Street, StreetClass, StreetId};
use crate::parcel::{Block, BlockUse, Footprint, Lot, STOREY_HEIGHT};
use crate::region::{Outline, Settlement, SettlementId};
use crate::space::{Bounds, ChunkCoord, Origin, math, quantize};
use crate::stack::PlacedStreet;
use crate::streets::{MadeBy, StreetOrigin};
use crate::terrain::{Terrain, TerrainSample};
use crate::world::{Area, Owned};
use glam::DVec2;
use std::sync::Arc;

/// An area with everything that a map of it reads.
pub(crate) struct AreaCase {
    pub area: Area,
    pub outlines: Vec<Arc<Outline>>,
    pub terrain: Hills,
}

/// Rolling hills around a point, with lakes where they are low and woods where they are high.
pub(crate) struct Hills(DVec2);

impl Terrain for Hills {
    fn sample(&self, p: DVec2) -> TerrainSample {
        let p = p - self.0;
        let height = 30.0 * math::sin(p.x / 300.0) * math::cos(p.y / 240.0) + 8.0 * math::sin((p.x + 2.0 * p.y) / 90.0);
        TerrainSample { height, water_level: -18.0, vegetation: (height / 30.0).clamp(0.0, 1.0) }
    }
}

impl AreaCase {
    pub fn plan(&self) -> Plan<'_> {
        let (area, outlines, terrain) = (&self.area, &self.outlines[..], &self.terrain);
        Plan { area, outlines, terrain, chunk_size: 512, driving: Side::Right, real: None, projection: None }
    }
}

/// A grid of 5 by 5 junctions, 80 m apart, with bent streets, blocks, lots and buildings, crossed by a road on a bridge.
pub(crate) fn area(centre: DVec2) -> AreaCase {
    const N: usize = 5;
    let origin = Origin::at(centre);
    let chunk = |at: DVec2| ChunkCoord::containing(origin.to_plan(at), 512);
    let at = |i: usize, j: usize| quantize(DVec2::new(i as f64 - 2.0, j as f64 - 2.0) * 80.3);
    let name = |i: usize, j: usize| JunctionId::of(&[i as u64, j as u64]);
    let (mut junctions, mut streets) = (Vec::new(), Vec::new());
    let mut put = |street: Street, made_by: Option<MadeBy>| {
        streets.push(Owned { chunk: chunk(street.line[0]), item: PlacedStreet { street, made_by } });
    };
    for (i, j) in (0..N * N).map(|k| (k % N, k / N)) {
        junctions.push(Owned { chunk: chunk(at(i, j)), item: Junction { id: name(i, j), at: at(i, j) } });
        for (k, l) in [(i + 1, j), (i, j + 1)] {
            if k < N && l < N {
                let edge = [i, j, k, l].map(|w| w as u64);
                let main = (i == k && i == 2) || (j == l && j == 2);
                let class = if main { StreetClass::Main } else { StreetClass::Local };
                let bend = quantize((at(i, j) + at(k, l)) / 2.0 + (at(k, l) - at(i, j)).perp() * 0.05);
                let line = vec![at(i, j), bend, at(k, l)];
                let origins = [StreetOrigin::Piece("set/tee".into()), StreetOrigin::Growth, StreetOrigin::Repair];
                let made_by = MadeBy { filler: "SemanticPatches", origin: origins[(i + 2 * j) % 3].clone() };
                put(Street::new(StreetId::of(&edge), class, name(i, j), name(k, l), line), (!main).then_some(made_by));
            }
        }
    }
    let (west, east) = (DVec2::new(-380.0, -130.0), DVec2::new(380.0, -110.5));
    let (from, to) = (JunctionId::of(&[100]), JunctionId::of(&[101]));
    for (id, at) in [(from, west), (to, east)] {
        junctions.push(Owned { chunk: chunk(at), item: Junction { id, at } });
    }
    let mut road = Street::new(StreetId::of(&[100]), StreetClass::Major, from, to, vec![west, east]);
    (road.level, road.bridge) = (1, true);
    put(road, None);

    let square = |centre: DVec2, half: f64| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| quantize(centre + DVec2::new(x, y) * half))
            .to_vec()
    };
    let (mut blocks, mut lots, mut footprints) = (Vec::new(), Vec::new(), Vec::new());
    for (k, street) in streets.iter().enumerate().take((N - 1) * (N - 1)) {
        let middle = (at(k % (N - 1), k / (N - 1)) + at(k % (N - 1) + 1, k / (N - 1) + 1)) / 2.0;
        let (chunk, id) = (chunk(middle), k as u64 + 1000);
        let land_use = if k == 5 { BlockUse::Park } else { BlockUse::Built };
        blocks.push(Owned { chunk, item: Block { id, polygon: square(middle, 28.0), land_use } });
        for (n, side) in [(0, -14.0), (1, 14.0)] {
            let (id, at) = (id * 10 + n, middle + DVec2::new(side, side));
            let street = street.item.street.id;
            lots.push(Owned { chunk, item: Lot { id, block: k as u64 + 1000, polygon: square(at, 14.0), street } });
            let (polygon, storeys) = (square(at, 8.0), 2 + n as u32);
            let (base, height) = (5.0, f64::from(storeys) * STOREY_HEIGHT);
            let building = Footprint { id: id + 50_000, lot: id, polygon, storeys, base, height };
            footprints.push(Owned { chunk, item: building });
        }
    }
    junctions.sort_by_key(|j| j.item.id);
    streets.sort_by_key(|s| s.item.street.id);
    let settlement = Settlement {
        id: SettlementId(77),
        centre: origin,
        radius: 300.0,
        size: SizeClass::Town,
        style: "grid".into(),
        name: "Sample & Sons".into(),
    };
    let ring =
        (0..24).map(|k| quantize(math::direction(f64::from(k) * std::f64::consts::TAU / 24.0) * 260.0)).collect();
    let outline = Arc::new(Outline { origin, polygon: ring, shared: Vec::new(), river: None });
    let area = Area {
        origin,
        bounds: Bounds::square(centre, 800.0),
        streets,
        junctions,
        blocks,
        lots,
        footprints,
        settlements: vec![Arc::new(settlement)],
        outlines: vec![outline.clone()],
        unmet_ports: 0,
        exceptions: Vec::new(),
        short_counts: Vec::new(),
        missing: Vec::new(),
    };
    AreaCase { area, outlines: vec![outline], terrain: Hills(origin.plan()) }
}
