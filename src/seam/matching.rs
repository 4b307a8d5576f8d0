//! Proposing ports on both sides of a main street, and matching them across it.

use super::stub::{Hand, Kerb, Spot, has_room};
use super::survey::{self, Mark};
use crate::network::{JunctionId, StreetClass, StreetId};
use crate::seam::{Port, Seam};
use crate::space::{QUANTUM, Seed, line_length};
use crate::style::Style;
use crate::town::{CellUse, MainCell, Town};
use glam::DVec2;

/// Step of the search for a place where a proposal has room, in metres.
const SEARCH_STEP: f64 = 4.0;
/// Least distance of a port from the ends of its street, in metres.
const LEAST_END: f64 = 30.0;

/// Least share of crossings (as [`crate::style::SeamRules::crossing`]) along borders: towns that touch have streets in common.
const BORDER_CROSSING: f64 = 0.4;

/// A place with what attaches to it.
#[derive(Clone, Copy, Debug)]
struct Attached {
    spot: Spot,
    left: Option<StreetClass>,
    right: Option<StreetClass>,
}

impl Attached {
    fn one(spot: Spot, hand: Hand, class: StreetClass) -> Self {
        match hand {
            Hand::Left => Self { spot, left: Some(class), right: None },
            Hand::Right => Self { spot, left: None, right: Some(class) },
        }
    }

    fn has(&self, hand: Hand) -> bool {
        match hand {
            Hand::Left => self.left.is_some(),
            Hand::Right => self.right.is_some(),
        }
    }

    /// Whether both may be ports of one street.
    fn suits(&self, other: &Self, least: f64) -> bool {
        (self.spot.along - other.spot.along).abs() >= least
            && [Hand::Left, Hand::Right]
                .into_iter()
                .all(|h| !(self.has(h) && other.has(h)) || self.spot.apart(&other.spot, h))
    }
}

/// A town on the other side of a border.
#[derive(Clone, Copy, Debug)]
pub struct Across<'a> {
    /// Its plan.
    pub town: &'a Town,
    /// The style of each of its main cells.
    pub styles: &'a [&'a Style],
}

/// The seams of a town, one for each of [`Town::mains`]. `styles` holds the style of each main cell, `across` the towns that
/// it shares borders with.
///
/// Both sides of a street propose ports, each from the style of its cell and a stream of its own; proposals are paired by
/// PatchCity's cost (section 3.1, equations 1 to 4, in the order along the seam), a pair moves half its distance to one
/// crossing, and what stays alone is a T. Cells that got fewer ports than their style asks for then get more where there is
/// room. Along a border each of the two towns proposes for its side from its own styles, and both find the same ports.
pub fn seams(seed: Seed, town: &Town, styles: &[&Style], across: &[Across<'_>]) -> Vec<Seam> {
    let towns: Vec<Surveyed> = std::iter::once((true, Across { town, styles }))
        .chain(across.iter().map(|a| (false, *a)))
        .map(|(own, of)| Surveyed::new(seed, of, own))
        .collect();
    let brinks: Vec<Brink> = (0..town.mains.len()).map(|main| Brink::new(&towns, main)).collect();
    let mut all: Vec<Vec<Attached>> = brinks.iter().map(seam).collect();
    supply_cells(towns[0].of, &brinks, &mut all);
    let port = |brink: &Brink, a: &Attached| {
        let [x, y] = (a.spot.at / QUANTUM).round().as_i64vec2().to_array().map(|v| v as u64);
        let junction = JunctionId::of(&[brink.street.0, 0x70, x, y]);
        Port { junction, along: a.spot.along, at: a.spot.at + brink.shift, left: a.left, right: a.right }
    };
    let seam = |(brink, list): (&Brink, Vec<Attached>)| Seam { ports: list.iter().map(|a| port(brink, a)).collect() };
    brinks.iter().zip(all).map(seam).collect()
}

/// A town with the marks of each of its cells.
struct Surveyed<'a> {
    of: Across<'a>,
    marks: Vec<Vec<Mark>>,
}

impl<'a> Surveyed<'a> {
    /// Of a town across a border only the cells at borders are surveyed.
    fn new(seed: Seed, of: Across<'a>, own: bool) -> Self {
        let at_border =
            |c: &MainCell| c.sides.iter().any(|s| s.main.is_some_and(|m| of.town.mains[m].border.is_some()));
        let marks = of.town.cells.iter().zip(of.styles).map(|(cell, style)| {
            let asked = cell.used_as == CellUse::Built && (own || at_border(cell));
            if asked { survey::marks(seed, of.town, cell, style) } else { Vec::new() }
        });
        Self { of, marks: marks.collect() }
    }

    /// One side of a main street of the town; `shift` is what to add to a place of the seam to make it local to the town.
    fn kerb(&self, main: usize, hand: Hand, shift: DVec2) -> Option<Kerb<'_>> {
        let cell = hand.cell(&self.of.town.mains[main]);
        let (style, marks) = (self.of.styles.get(cell)?, self.marks.get(cell)?);
        Some(Kerb { town: self.of.town, style, marks, main, hand, shift })
    }
}

/// A main street between its two sides. Along a border everything is local to the border, so that both towns find the same
/// bits.
struct Brink<'a> {
    street: StreetId,
    line: Vec<DVec2>,
    length: f64,
    left: Option<Kerb<'a>>,
    right: Option<Kerb<'a>>,
    /// What to add to a place of the seam to make it local to the town that asks.
    shift: DVec2,
    /// Whether it runs along a border.
    shared: bool,
}

impl<'a> Brink<'a> {
    /// Of the first of `towns`; the others share borders with it.
    fn new(towns: &'a [Surveyed], main: usize) -> Self {
        let own = &towns[0];
        let street = &own.of.town.mains[main];
        let id = street.street.id;
        let Some(border) = &street.border else {
            return Self {
                street: id,
                line: street.street.line.clone(),
                length: street.street.length(),
                left: own.kerb(main, Hand::Left, DVec2::ZERO),
                right: own.kerb(main, Hand::Right, DVec2::ZERO),
                shift: DVec2::ZERO,
                shared: false,
            };
        };
        let on = |hand: Hand| {
            let side = border.sides[usize::from(hand == Hand::Right)];
            let there = towns.iter().find(|t| t.of.town.settlement.id == side)?;
            let main = there.of.town.mains.iter().position(|m| m.street.id == id)?;
            there.kerb(main, hand, border.origin.offset_to(there.of.town.origin))
        };
        let origin = own.of.town.origin;
        let line = street.street.moved(origin.offset_to(border.origin)).line;
        Self {
            street: id,
            length: line_length(&line),
            line,
            left: on(Hand::Left),
            right: on(Hand::Right),
            shift: border.origin.offset_to(origin),
            shared: true,
        }
    }

    fn kerbs(&self) -> impl Iterator<Item = &Kerb<'a>> {
        self.left.iter().chain(&self.right)
    }
}

/// The ports of one street.
fn seam(brink: &Brink) -> Vec<Attached> {
    let of = |kerb: &Option<Kerb>| kerb.as_ref().map_or(Vec::new(), |kerb| proposals(brink, kerb));
    let (left, right) = (of(&brink.left), of(&brink.right));
    let place = |list: &[(Spot, StreetClass)]| list.iter().map(|(s, c)| (s.along, *c)).collect::<Vec<_>>();
    // Where two styles meet, the middle of both.
    let cutoff =
        brink.kerbs().map(|k| cutoff(k.style, brink.shared)).sum::<f64>() / brink.kerbs().count().max(1) as f64;
    let min_spacing = brink.kerbs().map(|k| k.style.seam.min_spacing).fold(0.0, f64::max);
    let pairs = pair(&place(&left), &place(&right), cutoff);
    let mut crossings = Vec::new();
    let (mut left_alone, mut right_alone) = (vec![true; left.len()], vec![true; right.len()]);
    for (i, j) in pairs {
        let ((a, class_left), (b, class_right)) = (left[i], right[j]);
        let middle = (a.along + b.along) / 2.0;
        let room = |s: &Spot| brink.kerbs().all(|kerb| has_room(kerb, s));
        let spread = (a.along - b.along).abs() / 2.0;
        if let Some(spot) = settle(brink, middle, spread, room) {
            crossings.push(Attached { spot, left: Some(class_left), right: Some(class_right) });
            (left_alone[i], right_alone[j]) = (false, false);
        }
    }
    let alone = |list: &[(Spot, StreetClass)], free: &[bool], hand: Hand| {
        let kept = list.iter().zip(free).filter(|(_, free)| **free);
        kept.map(|((spot, class), _)| Attached::one(*spot, hand, *class)).collect::<Vec<_>>()
    };
    let mut singles = alone(&left, &left_alone, Hand::Left);
    singles.extend(alone(&right, &right_alone, Hand::Right));
    singles.sort_by(|a, b| a.spot.along.total_cmp(&b.spot.along).then(b.has(Hand::Left).cmp(&a.has(Hand::Left))));
    // Where ports would stand too close, single ones go before pairs.
    let mut out: Vec<Attached> = Vec::new();
    for one in crossings.into_iter().chain(singles) {
        if out.iter().all(|other| other.suits(&one, min_spacing)) {
            out.push(one);
        }
    }
    sort(&mut out);
    out
}

fn sort(ports: &mut [Attached]) {
    ports.sort_by(|a, b| a.spot.along.total_cmp(&b.spot.along));
}

/// Proposals of one side, in order along the street, all with room for their stubs.
fn proposals(brink: &Brink, kerb: &Kerb) -> Vec<(Spot, StreetClass)> {
    let (rules, hand) = (&kerb.style.seam, kerb.hand);
    let mut out: Vec<(Spot, StreetClass)> = Vec::new();
    for mark in kerb.marks.iter().filter(|m| m.main == kerb.main && m.hand == hand) {
        let clear = |s: &Spot| {
            let last = out.last().is_none_or(|(o, _)| s.along >= o.along + rules.min_spacing && s.apart(o, hand));
            last && has_room(kerb, s)
        };
        if let Some(spot) = settle(brink, mark.along, 0.4 * rules.spacing, clear) {
            out.push((spot, StreetClass::Local));
        }
    }
    out
}

/// The place nearest to `along`, at most `reach` metres from it, that is `good`.
fn settle(brink: &Brink, along: f64, reach: f64, good: impl Fn(&Spot) -> bool) -> Option<Spot> {
    let steps = (reach / SEARCH_STEP).floor() as usize;
    let tries = std::iter::once(along).chain((1..=steps).flat_map(|i| {
        let d = i as f64 * SEARCH_STEP;
        [along + d, along - d]
    }));
    let inner = |s: &Spot| s.along >= LEAST_END && s.along <= brink.length - LEAST_END;
    tries
        .filter(|s| *s > 0.0 && *s < brink.length)
        .find_map(|s| Spot::near(&brink.line, s).filter(|spot| inner(spot) && good(spot)))
}

/// Distance along the street up to which proposals of the two sides become one crossing; `shared` along a border.
fn cutoff(style: &Style, shared: bool) -> f64 {
    let least = if shared { BORDER_CROSSING } else { 0.0 };
    style.seam.crossing.max(least) * style.seam.spacing
}

/// PatchCity's cost of joining two streets across a seam (section 3.1, equations 2 to 4).
fn cost(a: (f64, StreetClass), b: (f64, StreetClass)) -> f64 {
    let (distance, wide, narrow) = (a.0 - b.0, a.1.carriageway(), b.1.carriageway());
    let ratio = wide.max(narrow) / wide.min(narrow);
    distance * distance * ratio * wide * narrow
}

/// The order-preserving pairs of least total cost; to stay alone costs half of what a pair at the cut-off distance does.
fn pair(left: &[(f64, StreetClass)], right: &[(f64, StreetClass)], cutoff: f64) -> Vec<(usize, usize)> {
    let alone = |p: (f64, StreetClass)| cost(p, (p.0 + cutoff, p.1)) / 2.0;
    let (n, m) = (left.len(), right.len());
    let mut best = vec![vec![0.0; m + 1]; n + 1];
    for i in 0..=n {
        for j in 0..=m {
            let mut least = if i + j == 0 { 0.0 } else { f64::INFINITY };
            if i > 0 {
                least = best[i - 1][j] + alone(left[i - 1]);
            }
            if j > 0 {
                least = least.min(best[i][j - 1] + alone(right[j - 1]));
            }
            if i > 0 && j > 0 {
                least = least.min(best[i - 1][j - 1] + cost(left[i - 1], right[j - 1]));
            }
            best[i][j] = least;
        }
    }
    let (mut i, mut j, mut out) = (n, m, Vec::new());
    while i > 0 && j > 0 {
        if best[i][j] == best[i - 1][j] + alone(left[i - 1]) {
            i -= 1;
        } else if best[i][j] == best[i][j - 1] + alone(right[j - 1]) {
            j -= 1;
        } else {
            (i, j) = (i - 1, j - 1);
            out.push((i, j));
        }
    }
    out.reverse();
    out
}

/// Gives cells with fewer ports than their style asks for more, where there is room: a T, or else the other arm of one. Not
/// on borders, where the other town would have to know.
fn supply_cells(own: Across<'_>, brinks: &[Brink], all: &mut [Vec<Attached>]) {
    let town = own.town;
    for (cell, style) in town.cells.iter().zip(own.styles).filter(|(cell, _)| cell.used_as == CellUse::Built) {
        let mut sides: Vec<(usize, Hand)> = cell.sides.iter().filter_map(|s| Some((s.main?, Hand::of(s)))).collect();
        sides.sort_by(|a, b| {
            let length = |s: &(usize, Hand)| town.mains[s.0].street.length();
            length(b).total_cmp(&length(a)).then(a.0.cmp(&b.0))
        });
        let count = |all: &[Vec<Attached>]| -> usize {
            sides.iter().map(|(main, hand)| all[*main].iter().filter(|a| a.has(*hand)).count()).sum()
        };
        for &(main, hand) in sides.iter().chain(&sides) {
            if count(all) >= style.seam.least as usize {
                break;
            }
            let (brink, length) = (&brinks[main], brinks[main].length);
            let kerb = match hand {
                Hand::Left => &brink.left,
                Hand::Right => &brink.right,
            };
            let Some(kerb) = kerb.as_ref().filter(|_| !brink.shared) else {
                continue;
            };
            let end = style.seam.min_spacing;
            let good = |s: &Spot| {
                let new = Attached::one(*s, hand, StreetClass::Local);
                s.along >= end
                    && s.along <= length - end
                    && all[main].iter().all(|a| a.suits(&new, end))
                    && has_room(kerb, s)
            };
            if let Some(spot) = settle(brink, length / 2.0, length / 2.0, good) {
                all[main].push(Attached::one(spot, hand, StreetClass::Local));
                sort(&mut all[main]);
                continue;
            }
            let arm = (0..all[main].len()).find(|i| {
                let a = &all[main][*i];
                let others = || all[main].iter().filter(|b| b.has(hand));
                !a.has(hand) && others().all(|b| b.spot.apart(&a.spot, hand)) && has_room(kerb, &a.spot)
            });
            if let Some(a) = arm.map(|i| &mut all[main][i]) {
                match hand {
                    Hand::Left => a.left = Some(StreetClass::Local),
                    Hand::Right => a.right = Some(StreetClass::Local),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_near_ordered_and_of_least_cost() {
        let local = |s: &[f64]| s.iter().map(|x| (*x, StreetClass::Local)).collect::<Vec<_>>();
        assert_eq!(pair(&local(&[50., 150., 250.]), &local(&[60., 240.]), 45.0), [(0, 0), (2, 1)]);
        assert_eq!(pair(&local(&[50.]), &local(&[100.]), 45.0), []);
        // The nearer of two wins.
        assert_eq!(pair(&local(&[50., 85.]), &local(&[80.]), 45.0), [(1, 0)]);
        assert_eq!(pair(&[], &local(&[80.]), 45.0), []);
        // A wide street insists on a wide one; width makes both the pair and staying alone dearer.
        assert!(
            cost((0., StreetClass::Local), (20., StreetClass::Main))
                > cost((0., StreetClass::Local), (20., StreetClass::Local))
        );
    }
}
