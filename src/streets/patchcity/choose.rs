//! Which tile comes next: the one whose streets go on those of the tiles beside it (equations 5 to 7), moved in the neighbourhood
//! of its place in the map until they go on best.

use super::cost::{pairs, side_cost};
use super::side::{Crossing, Side};
use super::table::TileTable;
use crate::space::Stream;
use glam::DVec2;

/// Number of tiles that are compared closely.
const CLOSE: usize = 8;
/// Distance in metres at which a crossing that stays alone costs as much as a pair.
pub const ALONE: f32 = 60.0;
/// Cost of showing a part of a map twice: as much as local streets that are 10 m off.
const SEEN_TWICE: f32 = 100.0 * 36.0;
/// Costs less than this apart are the same: streets that are off by centimetres.
const SAME: f32 = 4.0;

/// A tile and how it is moved over its map, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Number of the tile.
    pub tile: u32,
    /// How far its window is moved.
    pub shift: DVec2,
}

/// What is asked of a tile.
pub struct Asked<'a> {
    /// For each side where streets cross it, if the tile beside it is there.
    pub sides: [Option<&'a [Crossing]>; 4],
    /// Cost of a tile besides its sides, such as for ports that it should reach.
    pub also: &'a dyn Fn(u32) -> f32,
    /// How a tile would be seen twice here: 0 not at all, 1 in part, 2 as a whole.
    pub repeats: &'a dyn Fn(u32) -> u8,
}

/// Tiles with the least costs, the least first.
struct Best(Vec<(f32, u32)>);

impl Best {
    /// The greatest cost that still counts.
    fn bar(&self) -> f32 {
        if self.0.len() < CLOSE { f32::INFINITY } else { self.0[CLOSE - 1].0 }
    }

    fn add(&mut self, cost: f32, tile: u32) {
        let place = self.0.partition_point(|x| x.0 <= cost);
        self.0.insert(place, (cost, tile));
        self.0.truncate(CLOSE);
    }
}

/// The tile that fits best; `None` if the table has no tile.
pub fn choose(table: &TileTable, asked: &Asked<'_>, rng: &mut Stream) -> Option<Choice> {
    let count = |side: Side| asked.sides[side as usize].map(<[Crossing]>::len);
    let same_counts = table.with_counts(count(Side::West), count(Side::South));
    let all = table.with_counts(None, None);
    let mut best = Best(Vec::new());
    // Streets that do not go on rather than a tile that is seen twice.
    for (tiles, most_repeats) in [(same_counts, 1), (all, 1), (all, 2)] {
        if best.0.is_empty() {
            // Of tiles that cost the same, those that come first are kept: no place in a map may always come first.
            let (before, after) = tiles.split_at(rng.index(tiles.len().max(1)));
            gather(table, after.iter().chain(before), asked, most_repeats, &mut best);
        }
    }
    let mut choices: Vec<(f32, Choice)> = best.0.iter().map(|(_, tile)| moved(table, asked, *tile)).collect();
    choices.sort_by(|a, b| a.0.total_cmp(&b.0));
    let least = choices.first()?.0;
    let equal = choices.iter().take_while(|c| c.0 <= least + SAME).count();
    choices.get(rng.index(equal)).map(|c| c.1)
}

/// Compares tiles that are no more repeats than allowed.
fn gather<'a>(
    table: &TileTable,
    tiles: impl Iterator<Item = &'a u32>,
    asked: &Asked<'_>,
    most_repeats: u8,
    best: &mut Best,
) {
    for &tile in tiles {
        let mut cost = 0.0;
        for side in Side::ALL {
            if let Some(fixed) = asked.sides[side as usize] {
                cost += cost_of_side(fixed, table.side(tile, side));
            }
        }
        if cost >= best.bar() {
            continue;
        }
        let repeats = (asked.repeats)(tile);
        cost += if repeats > 0 { SEEN_TWICE } else { 0.0 };
        if repeats <= most_repeats && cost < best.bar() {
            cost += (asked.also)(tile);
            if cost < best.bar() {
                best.add(cost, tile);
            }
        }
    }
}

/// Cost of a side, also where the numbers of streets differ.
fn cost_of_side(fixed: &[Crossing], own: &[Crossing]) -> f32 {
    if fixed.len() == own.len() {
        return side_cost(fixed, own);
    }
    let together = pairs(fixed, own, ALONE);
    let paired: f32 = together.iter().map(|(i, k)| side_cost(&fixed[*i..=*i], &own[*k..=*k])).sum();
    let alone = |side: &[Crossing], is_paired: &dyn Fn(usize) -> bool| -> f32 {
        let left = side.iter().enumerate().filter(|(i, _)| !is_paired(*i));
        left.map(|(_, c)| ALONE * ALONE * c.width * c.width).sum()
    };
    paired
        + alone(fixed, &|i| together.iter().any(|pair| pair.0 == i))
        + alone(own, &|k| together.iter().any(|pair| pair.1 == k))
}

/// A tile with its cost, moved within its margin so that its streets go on those beside it, if that makes the cost less: the search
/// in the neighbourhood of a tile's place in the map that the paper proposes (section 4).
fn moved(table: &TileTable, asked: &Asked<'_>, tile: u32) -> (f32, Choice) {
    let cost = |sides: &[&[Crossing]; 4]| -> f32 {
        let fixed = asked.sides.iter().zip(sides);
        fixed.filter_map(|(fixed, own)| Some(cost_of_side((*fixed)?, own))).sum()
    };
    let also = (asked.also)(tile);
    let own = Side::ALL.map(|side| table.side(tile, side));
    let unmoved = (cost(&own) + also, Choice { tile, shift: DVec2::ZERO });
    let window = table.window(tile);
    let mut shift = DVec2::ZERO;
    for axis in 0..2 {
        // Along the sides that lie across the other axis.
        let (mut sum, mut weight) = (0.0, 0.0);
        for side in Side::ALL.into_iter().filter(|side| side.axis() != axis) {
            let Some(fixed) = asked.sides[side as usize] else { continue };
            for (i, k) in pairs(fixed, own[side as usize], ALONE) {
                let (a, b) = (fixed[i], own[side as usize][k]);
                let wide = a.width * b.width;
                sum += (b.at - a.at) * wide;
                weight += wide;
            }
        }
        shift[axis] = if weight > 0.0 { f64::from(sum / weight).clamp(-window.margin, window.margin) } else { 0.0 };
    }
    if shift.abs().max_element() < 0.05 {
        return unmoved;
    }
    let sides = window.crossings(table.tile(tile).turns, shift);
    let moved = (cost(&[&sides[0], &sides[1], &sides[2], &sides[3]]) + also, Choice { tile, shift });
    if moved.0 < unmoved.0 { moved } else { unmoved }
}
