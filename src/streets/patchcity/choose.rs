//! Which tile comes next: the one whose streets go on those of the tiles beside it (equations 5 to 7), moved in the neighbourhood
//! of its place in the map until they go on best.

use super::cost::{pair_weight, paired_cost, pairs, side_cost};
use super::side::{Crossing, Side};
use super::table::{Choice, TileTable};
use crate::space::Stream;
use glam::DVec2;

/// Number of tiles that are compared closely.
const CLOSE: usize = 8;
/// Distance in metres at which a crossing that stays alone costs as much as a pair.
pub const ALONE: f32 = 30.0;
/// Cost of showing a part of a map twice: as much as local streets that are 10 m off.
const SEEN_TWICE: f32 = 100.0 * 36.0;
/// Cost of going on in the map where a tile beside is from: what fits as well from elsewhere is new.
const SAME_PLACE: f32 = 1200.0;
/// Costs less than this apart are the same: streets that are off by centimetres.
const SAME: f32 = 4.0;
/// Where no tile with as many streets at its sides costs less than this, others are tried: as much as a local street that stays
/// alone.
const POOR: f32 = ALONE * ALONE * 36.0;
/// Greatest number of tiles with other numbers of streets that are tried.
const OTHERS: usize = 1500;

/// What is asked of a tile.
pub struct Asked<'a> {
    /// For each side where streets cross it, if the tile beside it is there.
    pub sides: [Option<&'a [Crossing]>; 4],
    /// Choices that go on in the map where a tile beside is from.
    pub onward: &'a [Choice],
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

    fn least(&self) -> f32 {
        self.0.first().map_or(f32::INFINITY, |best| best.0)
    }

    fn add(&mut self, cost: f32, tile: u32) {
        let place = self.0.partition_point(|x| x.0 <= cost);
        self.0.insert(place, (cost, tile));
        self.0.truncate(CLOSE);
    }
}

/// The tile that fits best, with its cost; `None` if the table has no tile.
pub fn choose(table: &TileTable, asked: &Asked<'_>, rng: &mut Stream) -> Option<(f32, Choice)> {
    let count = |side: Side| asked.sides[side as usize].map(<[Crossing]>::len);
    let same_counts = table.with_counts(count(Side::West), count(Side::South));
    let all = table.with_counts(None, None);
    let onward = asked.onward.iter().filter(|choice| (asked.repeats)(choice.tile) < 2);
    let mut choices: Vec<(f32, Choice)> =
        onward.map(|choice| (cost(table, asked, *choice) + SAME_PLACE, *choice)).collect();
    let goes_on = choices.iter().any(|choice| choice.0 < POOR);
    let mut best = Best(Vec::new());
    // Streets that do not go on rather than a tile that is seen twice.
    for (tiles, most, most_repeats) in [(same_counts, same_counts.len(), 1), (all, OTHERS, 1), (all, OTHERS, 2)] {
        let is_enough = if most_repeats > 1 { !best.0.is_empty() || goes_on } else { best.least() < POOR || goes_on };
        if best.0.is_empty() && most_repeats == 1 && most != OTHERS || !is_enough {
            // Of tiles that cost the same, those that come first are kept: no place in a map may always come first.
            let (before, after) = tiles.split_at(rng.index(tiles.len().max(1)));
            gather(table, after.iter().chain(before).take(most), asked, most_repeats, &mut best);
        }
    }
    choices.extend(best.0.iter().map(|(_, tile)| moved(table, asked, *tile)));
    choices.sort_by(|a, b| a.0.total_cmp(&b.0));
    let least = choices.first()?.0;
    let equal = choices.iter().take_while(|c| c.0 <= least + SAME).count();
    choices.get(rng.index(equal)).copied()
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
        // Those that are kept cost the same already.
        if best.bar() <= SAME {
            break;
        }
        // To pair the streets of sides with different numbers of them takes long, and few tiles are so good.
        if estimate(table, asked, tile, least_cost_of_side) >= best.bar() {
            continue;
        }
        let mut cost = estimate(table, asked, tile, cost_of_side);
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

/// How streets along sides are off along an axis: what a move of the tile does to their cost.
#[derive(Clone, Copy, Default)]
struct Off {
    weight: f32,
    sum: f32,
    squares: f32,
}

impl Off {
    fn add(&mut self, fixed: Crossing, own: Crossing, weight: f32) {
        let off = own.at - fixed.at;
        self.weight += weight;
        self.sum += weight * off;
        self.squares += weight * off * off;
    }

    /// The move within `margin` metres that makes the cost least.
    fn shift(&self, margin: f32) -> f32 {
        if self.weight > 0.0 { (self.sum / self.weight).clamp(-margin, margin) } else { 0.0 }
    }

    /// The cost after that move.
    fn least(&self, margin: f32) -> f32 {
        let shift = self.shift(margin);
        (self.squares - 2.0 * shift * self.sum + shift * shift * self.weight).max(0.0)
    }
}

/// The cost of a tile's sides once it is moved as well as it may be, as if its streets crossed the sides at right angles.
/// `unlike` is the cost of a side that has another number of streets.
fn estimate(table: &TileTable, asked: &Asked<'_>, tile: u32, unlike: impl Fn(&[Crossing], &[Crossing]) -> f32) -> f32 {
    let mut off = [Off::default(); 2];
    let mut rest = 0.0;
    for side in Side::ALL {
        let Some(fixed) = asked.sides[side as usize] else { continue };
        let own = table.side(tile, side);
        if fixed.len() != own.len() {
            rest += unlike(fixed, own);
            continue;
        }
        for (a, b) in fixed.iter().zip(own) {
            let (weight, besides) = pair_weight(*a, *b);
            off[1 - side.axis()].add(*a, *b, weight);
            rest += besides;
        }
    }
    let margin = table.window(tile).margin as f32;
    rest + off[0].least(margin) + off[1].least(margin)
}

/// What a side where the numbers of streets differ costs at least: some of the longer side stay alone.
fn least_cost_of_side(fixed: &[Crossing], own: &[Crossing]) -> f32 {
    let (short, long) = if fixed.len() < own.len() { (fixed, own) } else { (own, fixed) };
    let narrowest = long.iter().map(|c| c.width).fold(f32::INFINITY, f32::min);
    (long.len() - short.len()) as f32 * ALONE * ALONE * narrowest * narrowest
}

/// Cost of a side, also where the numbers of streets differ.
pub fn cost_of_side(fixed: &[Crossing], own: &[Crossing]) -> f32 {
    if fixed.len() == own.len() {
        return side_cost(fixed, own);
    }
    paired_cost(fixed, own, ALONE)
}

/// Cost of a choice.
fn cost(table: &TileTable, asked: &Asked<'_>, choice: Choice) -> f32 {
    let sides = table.window(choice.tile).crossings(table.tile(choice.tile).turns, choice.shift);
    let fixed = asked.sides.iter().zip(&sides);
    let cost: f32 = fixed.filter_map(|(fixed, own)| Some(cost_of_side((*fixed)?, own))).sum();
    let repeats = if (asked.repeats)(choice.tile) > 0 { SEEN_TWICE } else { 0.0 };
    cost + repeats + (asked.also)(choice.tile)
}

/// A tile with its cost, moved within its margin so that its streets go on those beside it, if that makes the cost less: the search
/// in the neighbourhood of a tile's place in the map that the paper proposes (section 4).
fn moved(table: &TileTable, asked: &Asked<'_>, tile: u32) -> (f32, Choice) {
    let unmoved = Choice { tile, shift: DVec2::ZERO };
    let unmoved = (cost(table, asked, unmoved), unmoved);
    let mut off = [Off::default(); 2];
    for side in Side::ALL {
        let Some(fixed) = asked.sides[side as usize] else { continue };
        let own = table.side(tile, side);
        for (i, k) in pairs(fixed, own, ALONE) {
            off[1 - side.axis()].add(fixed[i], own[k], pair_weight(fixed[i], own[k]).0);
        }
    }
    let margin = table.window(tile).margin as f32;
    let shift = DVec2::new(f64::from(off[0].shift(margin)), f64::from(off[1].shift(margin)));
    if shift.abs().max_element() < 0.05 {
        return unmoved;
    }
    let moved = Choice { tile, shift };
    let moved = (cost(table, asked, moved), moved);
    if moved.0 < unmoved.0 { moved } else { unmoved }
}
