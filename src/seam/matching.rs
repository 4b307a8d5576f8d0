//! Matching the ports that both sides of a main street propose.

use super::clearance::has_room;
use super::edge::{SeamEdge, SeamSide, TownAndStyles, TownProposals};
use super::pairing::pair;
use super::point::StreetPoint;
use super::port::{Port, Seam};
use super::side::StreetSide;
use crate::network::{JunctionId, StreetClass};
use crate::space::{Seed, quantum_key};
use crate::style::Style;
use crate::town::{CellUse, Town};

/// Word that tells the names of ports from other names on a street.
const PORT_NAME: u64 = 0x70;

/// Step of the search for a point where a proposal has room, in metres.
const SEARCH_STEP: f64 = 4.0;
/// Least distance of a port from the ends of its street, in metres.
const LEAST_END: f64 = 30.0;

/// Least value of [`crate::style::SeamRules::crossing`] along borders: towns that touch have streets in common.
const BORDER_CROSSING: f64 = 0.4;

/// A point of a main street with the streets that attach there.
#[derive(Clone, Copy, Debug)]
struct Attachment {
    point: StreetPoint,
    left: Option<StreetClass>,
    right: Option<StreetClass>,
}

impl Attachment {
    /// A street from one side.
    fn single(point: StreetPoint, side: StreetSide, class: StreetClass) -> Self {
        let mut out = Self { point, left: None, right: None };
        out.attach(side, class);
        out
    }

    fn attach(&mut self, side: StreetSide, class: StreetClass) {
        match side {
            StreetSide::Left => self.left = Some(class),
            StreetSide::Right => self.right = Some(class),
        }
    }

    fn has(&self, side: StreetSide) -> bool {
        match side {
            StreetSide::Left => self.left.is_some(),
            StreetSide::Right => self.right.is_some(),
        }
    }

    /// Whether `self` and `other` are far enough apart to be ports of one street.
    fn agrees_with(&self, other: &Self, min_spacing: f64) -> bool {
        let clear = |side| !(self.has(side) && other.has(side)) || self.point.is_clear_of(&other.point, side);
        (self.point.along - other.point.along).abs() >= min_spacing && StreetSide::BOTH.into_iter().all(clear)
    }
}

/// The seams of a town, one for each of [`Town::mains`]. `styles` holds the style of each main cell, `across` the towns that
/// share borders with the town.
///
/// Both sides of a street propose ports, each from the style of its cell and a random stream of its own. Proposals are paired by
/// PatchCity's cost (section 3.1, equations 1 to 4, in the order along the seam). The two of a pair move half their distance
/// and become one crossing; a proposal that stays alone becomes a T. Cells with fewer ports than their style asks for then get
/// more where there is room. Along a border each of the two towns proposes for its side from its own styles, and both find
/// the same ports.
pub fn seams(seed: Seed, town: &Town, styles: &[&Style], across: &[TownAndStyles<'_>]) -> Vec<Seam> {
    let own = TownAndStyles { town, styles };
    let towns: Vec<TownProposals> = std::iter::once(TownProposals::of_own(seed, own))
        .chain(across.iter().map(|other| TownProposals::of_neighbour(seed, *other)))
        .collect();
    let edges: Vec<SeamEdge> = (0..town.mains.len()).map(|main| SeamEdge::new(&towns, main)).collect();
    let mut all: Vec<Vec<Attachment>> = edges.iter().map(attachments).collect();
    supply_cells(own, &edges, &mut all);
    let port = |edge: &SeamEdge, a: &Attachment| {
        let [x, y] = quantum_key(a.point.at);
        let junction = JunctionId::of(&[edge.street.0, PORT_NAME, x, y]);
        Port { junction, along: a.point.along, at: a.point.at + edge.shift, left: a.left, right: a.right }
    };
    let seam =
        |(edge, list): (&SeamEdge, Vec<Attachment>)| Seam { ports: list.iter().map(|a| port(edge, a)).collect() };
    edges.iter().zip(all).map(seam).collect()
}

/// Where streets attach to one main street.
fn attachments(edge: &SeamEdge) -> Vec<Attachment> {
    let proposed = |side| edge.side(side).map_or(Vec::new(), |side| proposals(edge, side));
    let (left, right) = (proposed(StreetSide::Left), proposed(StreetSide::Right));
    let along = |list: &[(StreetPoint, StreetClass)]| list.iter().map(|(p, c)| (p.along, *c)).collect::<Vec<_>>();
    // Where two styles meet, the mean of both cutoffs holds.
    let cutoff =
        edge.sides().map(|s| cutoff(s.style, edge.on_border)).sum::<f64>() / edge.sides().count().max(1) as f64;
    let min_spacing = edge.sides().map(|s| s.style.seam.min_spacing).fold(0.0, f64::max);
    let pairs = pair(&along(&left), &along(&right), cutoff);
    let mut crossings = Vec::new();
    let (mut left_alone, mut right_alone) = (vec![true; left.len()], vec![true; right.len()]);
    for (i, j) in pairs {
        let ((a, class_left), (b, class_right)) = (left[i], right[j]);
        let middle = (a.along + b.along) / 2.0;
        let room = |p: &StreetPoint| edge.sides().all(|side| has_room(side, p));
        let reach = (a.along - b.along).abs() / 2.0;
        if let Some(point) = nearest_good(edge, middle, reach, room) {
            crossings.push(Attachment { point, left: Some(class_left), right: Some(class_right) });
            (left_alone[i], right_alone[j]) = (false, false);
        }
    }
    let alone = |list: &[(StreetPoint, StreetClass)], free: &[bool], side: StreetSide| {
        let kept = list.iter().zip(free).filter(|(_, free)| **free);
        kept.map(|((point, class), _)| Attachment::single(*point, side, *class)).collect::<Vec<_>>()
    };
    let mut singles = alone(&left, &left_alone, StreetSide::Left);
    singles.extend(alone(&right, &right_alone, StreetSide::Right));
    singles.sort_by(|a, b| {
        let by_side = || b.has(StreetSide::Left).cmp(&a.has(StreetSide::Left));
        a.point.along.total_cmp(&b.point.along).then_with(by_side)
    });
    // Where ports would stand too close, single streets give way to crossings.
    let mut out: Vec<Attachment> = Vec::new();
    for attachment in crossings.into_iter().chain(singles) {
        if out.iter().all(|other| other.agrees_with(&attachment, min_spacing)) {
            out.push(attachment);
        }
    }
    sort(&mut out);
    out
}

fn sort(attachments: &mut [Attachment]) {
    attachments.sort_by(|a, b| a.point.along.total_cmp(&b.point.along));
}

/// Proposals of one side, in order along the street, all with room for their approaches.
fn proposals(edge: &SeamEdge, seam: &SeamSide) -> Vec<(StreetPoint, StreetClass)> {
    let (rules, side) = (&seam.style.seam, seam.side);
    let mut out: Vec<(StreetPoint, StreetClass)> = Vec::new();
    for proposal in seam.proposals.iter().filter(|p| p.main == seam.main && p.side == side) {
        let good = |p: &StreetPoint| {
            let clear =
                |(o, _): &(StreetPoint, StreetClass)| p.along >= o.along + rules.min_spacing && p.is_clear_of(o, side);
            out.last().is_none_or(clear) && has_room(seam, p)
        };
        if let Some(point) = nearest_good(edge, proposal.along, 0.4 * rules.spacing, good) {
            out.push((point, StreetClass::Local));
        }
    }
    out
}

/// The `good` point nearest to `along`, at most `reach` metres from it.
fn nearest_good(edge: &SeamEdge, along: f64, reach: f64, good: impl Fn(&StreetPoint) -> bool) -> Option<StreetPoint> {
    let steps = (reach / SEARCH_STEP).floor() as usize;
    let tries = std::iter::once(along).chain((1..=steps).flat_map(|i| {
        let d = i as f64 * SEARCH_STEP;
        [along + d, along - d]
    }));
    let inner = |p: &StreetPoint| p.along >= LEAST_END && p.along <= edge.length - LEAST_END;
    tries
        .filter(|s| *s > 0.0 && *s < edge.length)
        .find_map(|s| StreetPoint::near(&edge.line, s).filter(|point| inner(point) && good(point)))
}

/// Greatest distance along the street at which proposals of the two sides become one crossing, in metres.
fn cutoff(style: &Style, on_border: bool) -> f64 {
    let least = if on_border { BORDER_CROSSING } else { 0.0 };
    style.seam.crossing.max(least) * style.seam.spacing
}

/// Adds ports to cells that have fewer than their style asks for, where there is room: a new T, or else the second arm of a T
/// from the other side. Borders stay as they are, since the other town would have to know.
fn supply_cells(own: TownAndStyles<'_>, edges: &[SeamEdge], all: &mut [Vec<Attachment>]) {
    let town = own.town;
    for (cell, style) in town.cells.iter().zip(own.styles).filter(|(cell, _)| cell.cell_use == CellUse::Built) {
        let mut sides: Vec<(usize, StreetSide)> =
            cell.sides.iter().filter_map(|s| Some((s.main?, StreetSide::of(s)))).collect();
        sides.sort_by(|a, b| {
            let length = |s: &(usize, StreetSide)| town.mains[s.0].street.length();
            length(b).total_cmp(&length(a)).then(a.0.cmp(&b.0))
        });
        let count = |all: &[Vec<Attachment>]| -> usize {
            sides.iter().map(|(main, side)| all[*main].iter().filter(|a| a.has(*side)).count()).sum()
        };
        for &(main, side) in sides.iter().chain(&sides) {
            if count(all) >= style.seam.least as usize {
                break;
            }
            let edge = &edges[main];
            if let Some(seam) = edge.side(side).filter(|_| !edge.on_border) {
                supply(edge, seam, style.seam.min_spacing, &mut all[main]);
            }
        }
    }
}

/// Adds a street to one side of a main street, if there is room for it.
fn supply(edge: &SeamEdge, seam: &SeamSide, min_spacing: f64, attachments: &mut Vec<Attachment>) {
    let side = seam.side;
    let good = |p: &StreetPoint| {
        let new = Attachment::single(*p, side, StreetClass::Local);
        p.along >= min_spacing
            && p.along <= edge.length - min_spacing
            && attachments.iter().all(|a| a.agrees_with(&new, min_spacing))
            && has_room(seam, p)
    };
    if let Some(point) = nearest_good(edge, edge.length / 2.0, edge.length / 2.0, good) {
        attachments.push(Attachment::single(point, side, StreetClass::Local));
        sort(attachments);
        return;
    }
    let arm = attachments.iter().position(|a| {
        let mut others = attachments.iter().filter(|b| b.has(side));
        !a.has(side) && others.all(|b| b.point.is_clear_of(&a.point, side)) && has_room(seam, &a.point)
    });
    if let Some(arm) = arm {
        attachments[arm].attach(side, StreetClass::Local);
    }
}
