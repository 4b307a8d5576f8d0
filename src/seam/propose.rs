//! The ports that a main cell proposes on its main streets: evenly along each, and in styles on a grid or radial field in line
//! with the ports on the cell's other sides, so that streets run straight through.

use super::side::StreetSide;
use crate::network::StreetId;
use crate::space::{Seed, point_at, segment_crossing};
use crate::style::{FieldKind, SeamRules, Style};
use crate::town::{CellSide, MainCell, Town};

/// Step in which a line follows the direction field, in metres.
const STEP: f64 = 25.0;
/// Steps after which a line is given up.
const STEPS: usize = 60;
/// Least sine of the angle at which a line leaves one side and arrives at another.
const SQUARE: f64 = 0.7;
/// Least gap between proposals, in spacings, that has room for another.
const LEAST_GAP: f64 = 1.6;

/// A point of a main street where the cell on one side proposes a port.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PortProposal {
    /// Index of the street among the town's.
    pub main: usize,
    /// The side that the cell is on.
    pub side: StreetSide,
    /// Metres along the street.
    pub along: f64,
}

/// The ports that a main cell proposes, in order along each of its streets.
///
/// In styles on a grid or radial field, the proposals of the longest side are even, and lines from there along the field lead to
/// proposals on the other sides. The next longest side then fills its wide gaps in the same way, and so on. In other styles
/// the proposals of every side are even by themselves.
pub(super) fn propose(seed: Seed, town: &Town, cell: &MainCell, style: &Style) -> Vec<PortProposal> {
    let rules = &style.seam;
    let mut sides: Vec<Side> = cell.sides.iter().filter_map(|side| Side::new(town, side)).collect();
    sides.sort_by(|a, b| b.length.total_cmp(&a.length).then((a.main, a.side).cmp(&(b.main, b.side))));
    sides.dedup_by_key(|s| (s.main, s.side));
    let surveyed = matches!(style.main.field, FieldKind::Grid | FieldKind::Radial);
    let mut out: Vec<PortProposal> = Vec::new();
    for side in &sides {
        let on = |p: &&PortProposal| p.main == side.main && p.side == side.side;
        let mut given: Vec<f64> = out.iter().filter(on).map(|p| p.along).collect();
        given.sort_by(f64::total_cmp);
        let new = match given[..] {
            [] => even(seed, town.mains[side.main].street.id, side, style),
            _ => between(&given, side.length, rules),
        };
        for along in new {
            out.push(PortProposal { main: side.main, side: side.side, along });
            if surveyed && let Some(facing) = opposite(town, cell, side.main, side.side, along) {
                let length = town.mains[facing.main].street.length();
                let inner = rules.min_spacing..=length - rules.min_spacing;
                let near = |p: &PortProposal| (p.along - facing.along).abs() < rules.min_spacing;
                let taken = out.iter().any(|p| p.main == facing.main && p.side == facing.side && near(p));
                if inner.contains(&facing.along) && !taken {
                    out.push(facing);
                }
            }
        }
    }
    out.sort_by(|a, b| (a.main, a.side).cmp(&(b.main, b.side)).then(a.along.total_cmp(&b.along)));
    out
}

/// A side of a main cell with a street.
struct Side {
    main: usize,
    side: StreetSide,
    length: f64,
}

impl Side {
    fn new(town: &Town, side: &CellSide) -> Option<Self> {
        let main = side.main?;
        Some(Self { main, side: StreetSide::of(side), length: town.mains[main].street.length() })
    }
}

/// Positions along a side, in metres along the street: even, except for the style's jitter.
fn even(seed: Seed, street: StreetId, side: &Side, style: &Style) -> Vec<f64> {
    let rules = &style.seam;
    let mut stream = seed.stream("seam", &[street.0, side.side as u64]);
    let usable = side.length - 2.0 * rules.min_spacing;
    if usable <= 0.0 {
        return Vec::new();
    }
    let count = (usable / rules.spacing).round().max(1.0);
    let step = usable / count;
    // In organic styles the two sides of a street have different rhythms.
    let phase = if style.main.field == FieldKind::Organic { 0.3 * stream.signed() } else { 0.0 };
    let position = |i: usize| rules.min_spacing + (i as f64 + 0.5 + phase) * step;
    (0..count as usize).map(|i| position(i) + rules.jitter * rules.spacing * stream.signed()).collect()
}

/// Positions in the wide gaps between `given` ones, and between these and the ends of the street.
fn between(given: &[f64], length: f64, rules: &SeamRules) -> Vec<f64> {
    let mut out = Vec::new();
    let mut last = 0.0;
    for next in given.iter().copied().chain([length]) {
        let gap = next - last;
        if gap > LEAST_GAP * rules.spacing {
            let parts = (gap / rules.spacing).round();
            out.extend((1..parts as usize).map(|i| last + gap * i as f64 / parts));
        }
        last = next;
    }
    out
}

/// The point where the line along the field from a point on one side of a cell meets another side, if the line meets both sides
/// squarely.
pub(super) fn opposite(
    town: &Town,
    cell: &MainCell,
    main: usize,
    from: StreetSide,
    along: f64,
) -> Option<PortProposal> {
    let (mut at, direction) = point_at(&town.mains[main].street.line, along);
    let inward = from.inward(direction);
    let mut heading = town.field.along(at, inward);
    if heading.dot(inward) < SQUARE {
        return None;
    }
    let n = cell.border.len();
    let others = || {
        cell.sides.iter().filter(|s| !(s.main == Some(main) && StreetSide::of(s) == from)).flat_map(|s| {
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
            return Some(PortProposal { main, side: StreetSide::of(s), along: before + line[segment].distance(x.at) });
        }
        at = next;
        heading = town.field.along(at, heading);
    }
    None
}
