//! Where the two sides of a main street would have ports: evenly along it, and where streets are surveyed, in line with
//! those on the other sides of the main cell, so that streets run straight through.

use super::stub::Hand;
use crate::network::StreetId;
use crate::space::{Seed, point_at, segment_crossing};
use crate::style::{FieldKind, SeamRules, Style};
use crate::town::{CellSide, MainCell, Town};

/// Step in which a line follows a field whose headings change, in metres.
const STEP: f64 = 25.0;
/// Steps after which a line is given up.
const STEPS: usize = 60;
/// Least sine of the angle at which a line leaves a side and arrives at another.
const SQUARE: f64 = 0.7;
/// Gap between marks, in spacings, from which there is room for another.
const WIDE: f64 = 1.6;

/// A place where the cell on one side of a main street would have a port.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    /// Index of the street among the town's.
    pub main: usize,
    /// The side that the cell is on.
    pub hand: Hand,
    /// Metres along the street.
    pub along: f64,
}

/// The marks of a main cell, in order along each of its streets.
///
/// In styles on a grid or radial field, those of the longest side are even, and lines from there along the field mark the
/// other sides; where these have room left, the next longest goes on. Elsewhere all sides are even, each by itself.
pub(super) fn marks(seed: Seed, town: &Town, cell: &MainCell, style: &Style) -> Vec<Mark> {
    let rules = &style.seam;
    let mut sides: Vec<Side> = cell.sides.iter().filter_map(|side| Side::new(town, side)).collect();
    sides.sort_by(|a, b| b.length.total_cmp(&a.length).then((a.main, a.hand).cmp(&(b.main, b.hand))));
    sides.dedup_by_key(|s| (s.main, s.hand));
    let surveyed = matches!(style.main.field, FieldKind::Grid | FieldKind::Radial);
    let mut out: Vec<Mark> = Vec::new();
    for side in &sides {
        let on = |m: &&Mark| m.main == side.main && m.hand == side.hand;
        let mut given: Vec<f64> = out.iter().filter(on).map(|m| m.along).collect();
        given.sort_by(f64::total_cmp);
        let new = match given[..] {
            [] => even(seed, town.mains[side.main].street.id, side, style),
            _ => between(&given, side.length, rules),
        };
        for along in new {
            out.push(Mark { main: side.main, hand: side.hand, along });
            if surveyed && let Some(mark) = opposite(town, cell, side.main, side.hand, along) {
                let length = town.mains[mark.main].street.length();
                let ends = rules.min_spacing..=length - rules.min_spacing;
                let near = |m: &Mark| (m.along - mark.along).abs() < rules.min_spacing;
                let taken = out.iter().any(|m| m.main == mark.main && m.hand == mark.hand && near(m));
                if ends.contains(&mark.along) && !taken {
                    out.push(mark);
                }
            }
        }
    }
    out.sort_by(|a, b| (a.main, a.hand).cmp(&(b.main, b.hand)).then(a.along.total_cmp(&b.along)));
    out
}

/// A side of a main cell with a street.
struct Side {
    main: usize,
    hand: Hand,
    length: f64,
}

impl Side {
    fn new(town: &Town, side: &CellSide) -> Option<Self> {
        let main = side.main?;
        Some(Self { main, hand: Hand::of(side), length: town.mains[main].street.length() })
    }
}

/// Places evenly along a side, but for the style's jitter.
fn even(seed: Seed, street: StreetId, side: &Side, style: &Style) -> Vec<f64> {
    let rules = &style.seam;
    let mut stream = seed.stream("seam", &[street.0, side.hand as u64]);
    let usable = side.length - 2.0 * rules.min_spacing;
    if usable <= 0.0 {
        return Vec::new();
    }
    let count = (usable / rules.spacing).round().max(1.0);
    let step = usable / count;
    // Where streets were surveyed, both sides of a street count alike; elsewhere each has its own rhythm.
    let phase = if style.main.field == FieldKind::Organic { 0.3 * stream.signed() } else { 0.0 };
    let place = |i: usize| rules.min_spacing + (i as f64 + 0.5 + phase) * step;
    (0..count as usize).map(|i| place(i) + rules.jitter * rules.spacing * stream.signed()).collect()
}

/// Places in the wide gaps between marks, and between these and the ends of the street.
fn between(marks: &[f64], length: f64, rules: &SeamRules) -> Vec<f64> {
    let mut out = Vec::new();
    let mut last = 0.0;
    for next in marks.iter().copied().chain([length]) {
        let gap = next - last;
        if gap > WIDE * rules.spacing {
            let parts = (gap / rules.spacing).round();
            out.extend((1..parts as usize).map(|i| last + gap * i as f64 / parts));
        }
        last = next;
    }
    out
}

/// Where the line along the field from a place on one side of a cell meets another side squarely.
pub(super) fn opposite(town: &Town, cell: &MainCell, main: usize, hand: Hand, along: f64) -> Option<Mark> {
    let (mut at, direction) = point_at(&town.mains[main].street.line, along);
    let inward = match hand {
        Hand::Left => direction.perp(),
        Hand::Right => -direction.perp(),
    };
    let mut heading = town.field.along(at, inward);
    if heading.dot(inward) < SQUARE {
        return None;
    }
    let n = cell.border.len();
    let others = || {
        cell.sides.iter().filter(|s| !(s.main == Some(main) && Hand::of(s) == hand)).flat_map(|s| {
            (0..s.count).map(move |i| (s, i, cell.border[s.first + i], cell.border[(s.first + i + 1) % n]))
        })
    };
    for _ in 0..STEPS {
        let next = at + heading * STEP;
        let hit = others()
            .filter_map(|(s, i, a, b)| Some((segment_crossing(at, next, a, b)?, s, i, b - a)))
            .min_by(|a, b| a.0.t.total_cmp(&b.0.t));
        if let Some((x, s, i, edge)) = hit {
            let main = s.main?;
            if heading.perp_dot(edge).abs() < SQUARE * edge.length() {
                return None;
            }
            let line = &town.mains[main].street.line;
            let segment = if s.forward { i } else { s.count - 1 - i };
            let before: f64 = line[..=segment].windows(2).map(|w| w[0].distance(w[1])).sum();
            return Some(Mark { main, hand: Hand::of(s), along: before + line[segment].distance(x.at) });
        }
        at = next;
        heading = town.field.along(at, heading);
    }
    None
}
