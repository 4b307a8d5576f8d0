//! Small rings of roads, which lose the last of their sides in rank.

use super::super::RoadSettings;
use super::connect::parts;
use super::feet::Feet;
use crate::space::math::angle_between;

/// Angle in radians between the two ways of a vertex below which a road comes back to where it was.
const BACK: f64 = 1.75;

/// Greatest sum of the sides of a ring that loses one, in metres.
fn small(settings: &RoadSettings) -> f64 {
    2.0 * settings.merge
}

impl Feet<'_> {
    /// Whether a way is the last in rank of the sides of a small triangle, or one of the two ways of a detour.
    pub(super) fn is_last(&self, edge: usize) -> bool {
        let net = self.net();
        let order = |e: usize| {
            let [a, b] = net.edges[e].ends.map(|n| net.nodes[n].key);
            (net.edges[e].rank, a.min(b), a.max(b))
        };
        let sides = |node: usize| net.nodes[node].ways.iter().copied().filter(move |e| *e != edge && self.is_plain(*e));
        let [a, b] = net.edges[edge].ends;
        let length = |e: usize| net.apart(net.edges[e].ends[0], net.edges[e].ends[1]);
        let is_small = |f: usize, g: usize| {
            net.far(f, a) == net.far(g, b)
                && length(edge) + length(f) + length(g) <= small(&self.rules.work.settings)
                && order(f) < order(edge)
                && order(g) < order(edge)
        };
        (self.is_plain(edge) && sides(a).any(|f| sides(b).any(|g| is_small(f, g)))) || self.detour(edge).is_some()
    }

    /// Whether a way goes.
    pub(super) fn goes(&self, edge: usize) -> bool {
        let ends = self.detour(edge).or_else(|| self.is_last(edge).then_some(self.net().edges[edge].ends));
        ends.is_some_and(|ends| ends.iter().all(|n| self.stays(*n) >= 2))
    }

    fn is_plain(&self, edge: usize) -> bool {
        self.net().edges[edge].level == 0 && !self.net().edges[edge].fixed
    }

    /// The ends of the detour that a way is half of: two ways by a vertex that has no others, there and back between two
    /// vertices that better ways join.
    fn detour(&self, edge: usize) -> Option<[usize; 2]> {
        let net = self.net();
        let by = |v: usize| {
            let [e, f] = net.nodes[v].ways.as_slice() else { return None };
            let [a, b] = [*e, *f].map(|e| net.far(e, v));
            let plain = self.is_plain(*e) && self.is_plain(*f) && a != b && parts(net.nodes[v].key).is_some();
            let back = angle_between(net.step(v, a), net.step(v, b)) < BACK;
            let left = small(&self.rules.work.settings) - net.apart(v, a) - net.apart(v, b);
            (plain && back && self.are_joined([a, b], [*e, *f], left)).then_some([a, b])
        };
        net.edges[edge].ends.into_iter().find_map(by)
    }

    /// Whether ways better than two others join two vertices over at most `most` metres.
    fn are_joined(&self, ends: [usize; 2], than: [usize; 2], most: f64) -> bool {
        let net = self.net();
        net.joins(ends, most, |e, _| self.is_plain(e) && than.iter().all(|t| net.edges[e].rank < net.edges[*t].rank))
    }
}
