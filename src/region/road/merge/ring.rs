//! Small rings of roads, which lose the last of their sides in rank.

use super::net::Net;
use crate::region::road::settings::RoadSettings;
use crate::space::math::angle_between;

/// Two edges of a vertex that meet at a smaller angle, in radians, lead back to where the road came from.
const BACK: f64 = 1.75;

/// The small rings of a net.
pub(super) struct Rings<'a> {
    net: &'a Net,
    /// Greatest sum in metres of the sides of a ring that loses one.
    longest: f64,
}

impl<'a> Rings<'a> {
    pub fn new(net: &'a Net, settings: &RoadSettings) -> Self {
        Self { net, longest: 2.0 * settings.merge }
    }

    /// Whether an edge is the last in rank of the sides of a small triangle, or one of the two edges of a detour.
    pub fn is_last(&self, edge: usize) -> bool {
        let net = self.net;
        let order = |e: usize| {
            let [a, b] = net.edges[e].ends.map(|n| net.nodes[n].key);
            (net.edges[e].rank, a.min(b), a.max(b))
        };
        let rank = net.edges[edge].rank;
        let is_side = move |e: &usize| *e != edge && self.is_plain(*e) && !net.is_closed_to(*e, rank);
        let sides = |node: usize| net.nodes[node].ways.iter().copied().filter(is_side);
        let [a, b] = net.edges[edge].ends;
        let length = |e: usize| net.apart(net.edges[e].ends[0], net.edges[e].ends[1]);
        let is_small = |f: usize, g: usize| {
            net.far(f, a) == net.far(g, b)
                && length(edge) + length(f) + length(g) <= self.longest
                && order(f) < order(edge)
                && order(g) < order(edge)
        };
        (self.is_plain(edge) && sides(a).any(|f| sides(b).any(|g| is_small(f, g)))) || self.detour(edge).is_some()
    }

    /// The ends of the detour that an edge is half of: two edges over a vertex that has no others, out and back between two
    /// vertices that better edges join.
    pub fn detour(&self, edge: usize) -> Option<[usize; 2]> {
        let net = self.net;
        let by = |v: usize| {
            let [e, f] = net.nodes[v].ways.as_slice() else { return None };
            let [a, b] = [*e, *f].map(|e| net.far(e, v));
            let plain = self.is_plain(*e) && self.is_plain(*f) && a != b && net.nodes[v].key.ground_parts().is_some();
            let back = angle_between(net.step(v, a), net.step(v, b)) < BACK;
            let left = self.longest - net.apart(v, a) - net.apart(v, b);
            (plain && back && self.are_joined([a, b], [*e, *f], left)).then_some([a, b])
        };
        net.edges[edge].ends.into_iter().find_map(by)
    }

    /// Whether edges better than two others join two vertices over at most `most` metres.
    fn are_joined(&self, ends: [usize; 2], than: [usize; 2], most: f64) -> bool {
        let net = self.net;
        net.joins(ends, most, |e, _| self.is_plain(e) && than.iter().all(|t| net.is_better(e, net.edges[*t].rank)))
    }

    fn is_plain(&self, edge: usize) -> bool {
        self.net.edges[edge].level == 0 && !self.net.edges[edge].fixed
    }
}
