//! Cells divided by crooked streets into blocks.

use crate::layer::Cancel;
use crate::network::{JunctionId, Street, StreetClass, StreetId};
use crate::parcel::{CellParcels, ParcelBrief, divide};
use crate::patch::PatchBuilding;
use crate::space::{Origin, Seed, Stream, left_normal, quantize};
use crate::style::ParcelRules;
use crate::terrain::GroundTiles;
use crate::testing::Flat;
use crate::town::CellId;
use glam::DVec2;
use std::sync::Arc;

/// A cell with its streets.
pub(crate) struct BlockCell {
    pub border: Vec<DVec2>,
    pub streets: Vec<Street>,
}

/// A bent line of `parts` segments from `a` to `b`.
fn bent(rng: &mut Stream, a: DVec2, b: DVec2, parts: usize) -> Vec<DVec2> {
    let bulge = left_normal(b - a) * rng.range(-0.12, 0.12);
    let at = |t: f64| quantize(a.lerp(b, t) + bulge * (4.0 * t * (1.0 - t)));
    (0..=parts).map(|i| at(i as f64 / parts as f64)).collect()
}

/// A cell of `columns` by `rows` crooked blocks of about `pitch` metres; some inner streets are missing, so that others
/// end dead, and one main street may end inside.
pub(crate) fn block_cell(rng: &mut Stream, columns: usize, rows: usize, pitch: f64) -> BlockCell {
    let place = |rng: &mut Stream, i: usize, j: usize| {
        quantize(
            DVec2::new(i as f64 + rng.signed() * 0.18, j as f64 + rng.signed() * 0.18) * pitch
                + DVec2::new(900., -300.),
        )
    };
    let mut at = vec![vec![DVec2::ZERO; rows + 1]; columns + 1];
    at.iter_mut().enumerate().for_each(|(i, c)| c.iter_mut().enumerate().for_each(|(j, p)| *p = place(rng, i, j)));
    let id = |i: usize, j: usize| JunctionId::of(&[i as u64, j as u64]);
    let mut streets = Vec::new();
    let street = |class, (i, j): (usize, usize), (k, l): (usize, usize), line| {
        let name = StreetId::of(&[i as u64, j as u64, k as u64, l as u64]);
        Street::new(name, class, id(i, j), id(k, l), line)
    };
    let corners = [(0, 0), (columns, 0), (columns, rows), (0, rows)];
    let mut border = Vec::new();
    let bare = rng.chance(0.3).then(|| rng.index(4));
    let slit = rng.chance(0.4);
    for side in 0..4 {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        let steps = from.0.abs_diff(to.0) + from.1.abs_diff(to.1);
        let step = |k: usize| {
            let go = |a: usize, b: usize| {
                if b > a {
                    a + k
                } else if a > b {
                    a - k
                } else {
                    a
                }
            };
            (go(from.0, to.0), go(from.1, to.1))
        };
        for k in 0..steps {
            let (p, q) = (step(k), step(k + 1));
            let line = bent(rng, at[p.0][p.1], at[q.0][q.1], 4);
            border.extend(&line[..line.len() - 1]);
            if bare != Some(side) {
                let class = if side == 0 { StreetClass::Arterial } else { StreetClass::Main };
                streets.push(street(class, p, q, line));
            }
            if side == 0 && k == 0 && slit {
                // A main street that ends in the cell.
                let (p, q) = (step(1), (1, 1));
                let line = bent(rng, at[p.0][p.1], at[q.0][q.1], 3);
                border.extend(line.iter().chain(line[1..line.len() - 1].iter().rev()));
                streets.push(street(StreetClass::Main, p, q, line));
            }
        }
    }
    for i in 0..=columns {
        for j in 0..=rows {
            let right = (i < columns && j > 0 && j < rows).then_some((i + 1, j));
            let up = (j < rows && i > 0 && i < columns && !(slit && (i, j) == (1, 0))).then_some((i, j + 1));
            for to in [right, up].into_iter().flatten() {
                let line = bent(rng, at[i][j], at[to.0][to.1], 5);
                if rng.chance(0.85) {
                    streets.push(street(StreetClass::Local, (i, j), to, line));
                }
            }
        }
    }
    BlockCell { border, streets }
}

/// The blocks, lots and buildings of a cell.
pub(crate) fn divided(seed: u64, cell: &BlockCell, rules: &ParcelRules) -> CellParcels {
    divided_with(seed, cell, rules, &[])
}

/// The same with buildings that come with the streets.
pub(crate) fn divided_with(
    seed: u64,
    cell: &BlockCell,
    rules: &ParcelRules,
    buildings: &[PatchBuilding],
) -> CellParcels {
    let streets: Vec<&Street> = cell.streets.iter().collect();
    let brief = ParcelBrief {
        seed: Seed(seed),
        id: CellId(seed),
        border: &cell.border,
        streets: &streets,
        buildings,
        rules,
        centrality: 0.5,
        ground: &GroundTiles::new(Arc::new(Flat), 1 << 16),
        origin: Origin::default(),
    };
    divide(&brief, &Cancel::new()).unwrap()
}
