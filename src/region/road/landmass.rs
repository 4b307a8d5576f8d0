//! Landmasses of a finite domain: which parts of the ground roads of a class can connect at all.
//!
//! Without them, the search for a path between two islands visits everything that it can reach before it gives up.

use super::cost::cost_over_water;
use super::inputs::Inputs;
use super::lattice::{DIRECTIONS, STENCIL};
use super::samples::Ground;
use super::tier_settings::TierSettings;
use super::window::Window;
use crate::layer::LayerError;
use crate::space::{Bounds, DisjointSets};
use glam::I64Vec2;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Marks a node that belongs to no landmass, because it lies in water.
const NONE: u32 = u32::MAX;

/// The landmasses of a domain on the coarse lattice of one tier.
pub(super) struct Landmasses {
    window: Window,
    /// Landmass of each node of the window; [`NONE`] in water.
    of: Vec<u32>,
}

/// The edges of a lattice in a window, with the ground at its nodes.
struct Edges<'a> {
    window: Window,
    ground: Vec<Ground>,
    lengths: [f64; DIRECTIONS],
    t: &'a TierSettings,
}

impl Edges<'_> {
    /// The neighbour of a node along a heading and the length of bridge to it, if the class may run there.
    fn next(&self, index: usize, heading: usize) -> Option<(usize, f64)> {
        let node = self.window.node(index) + STENCIL[heading];
        let next = self.window.contains(node).then(|| self.window.index(node))?;
        let length = self.lengths[heading];
        let (_, bridge) = cost_over_water(self.ground[index], self.ground[next], length, self.t)?;
        Some((next, length * bridge))
    }

    fn is_dry(&self, index: usize) -> bool {
        self.ground[index].depth <= 0.0
    }
}

impl Landmasses {
    /// The landmasses of `domain` for roads of a class, on the lattice of spacing `step`. Land that bridges of the class can
    /// connect belongs to one landmass.
    pub fn new(inputs: &Inputs, domain: Bounds, t: &TierSettings, step: i64) -> Result<Self, LayerError> {
        let window = inputs.window(domain, step);
        let mut samples = inputs.samples(&window, step);
        let ground = window.nodes().map(|n| samples.at(n)).collect::<Result<Vec<_>, _>>()?;
        let lengths = STENCIL.map(|s| s.as_dvec2().length() * step as f64);
        Ok(Self::of_edges(&Edges { window, ground, lengths, t }, step))
    }

    fn of_edges(edges: &Edges<'_>, step: i64) -> Self {
        let mut of = flood(edges);
        let mut connected = spread_over_water(edges, &mut of, edges.t.bridge_limit + step as f64);
        for (index, landmass) in of.iter_mut().enumerate() {
            *landmass = if edges.is_dry(index) { connected.find(*landmass) } else { NONE };
        }
        Self { window: edges.window, of }
    }

    /// Whether roads may lead from one node to another. Always true for nodes in water or outside the domain.
    pub fn may_join(&self, a: I64Vec2, b: I64Vec2) -> bool {
        let of = |n: I64Vec2| if self.window.contains(n) { self.of[self.window.index(n)] } else { NONE };
        let (a, b) = (of(a), of(b));
        a == b || a == NONE || b == NONE
    }
}

/// Numbers the parts of dry land that are connected without bridges.
fn flood(edges: &Edges<'_>) -> Vec<u32> {
    let mut of = vec![NONE; edges.ground.len()];
    let mut count = 0;
    for start in 0..of.len() {
        if of[start] != NONE || !edges.is_dry(start) {
            continue;
        }
        of[start] = count;
        let mut open = vec![start];
        while let Some(index) = open.pop() {
            for heading in 0..DIRECTIONS {
                if let Some((next, _)) = edges.next(index, heading).filter(|(n, _)| of[*n] == NONE && edges.is_dry(*n))
                {
                    of[next] = count;
                    open.push(next);
                }
            }
        }
        count += 1;
    }
    of
}

/// Gives each node in water to the nearest shore, by the length of bridge. Where the water of two shores meets, and a bridge of
/// at most `longest` metres leads from one to the other, their land is connected.
fn spread_over_water(edges: &Edges<'_>, of: &mut [u32], longest: f64) -> DisjointSets<u32> {
    let mut connected = DisjointSets::new();
    let mut lengths: Vec<f64> = of.iter().map(|l| if *l == NONE { f64::INFINITY } else { 0.0 }).collect();
    let mut open: BinaryHeap<_> = (0..of.len()).filter(|i| of[*i] != NONE).map(|i| Reverse((0u64, i))).collect();
    while let Some(Reverse((bits, index))) = open.pop() {
        let length = f64::from_bits(bits);
        if length > lengths[index] {
            continue;
        }
        for heading in 0..DIRECTIONS {
            let Some((next, bridge)) = edges.next(index, heading) else { continue };
            let whole = length + bridge;
            if of[next] != NONE && of[next] != of[index] && whole + lengths[next] <= longest {
                connected.union(of[index], of[next]);
            }
            if whole < lengths[next] && whole <= longest {
                (lengths[next], of[next]) = (whole, of[index]);
                open.push(Reverse((whole.to_bits(), next)));
            }
        }
    }
    connected
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    /// Land with straits of water from south to north: the first column of each strait, and the column after its last.
    fn landmasses(straits: &[(i64, i64)], bridge_limit: f64) -> Landmasses {
        let window = Window { min: I64Vec2::ZERO, size: I64Vec2::new(40, 12) };
        let ground = |n: I64Vec2| {
            let depth = if straits.iter().any(|(first, end)| (*first..*end).contains(&n.x)) { 3.0 } else { 0.0 };
            Ground { surface: 10.0, depth, vegetation: 0.0 }
        };
        let t = TierSettings { bridge_limit, ..TierSettings::minor() };
        let lengths = STENCIL.map(|s| DVec2::length(s.as_dvec2()) * 100.0);
        let edges = Edges { window, ground: window.nodes().map(ground).collect(), lengths, t: &t };
        Landmasses::of_edges(&edges, 100)
    }

    #[test]
    fn land_is_joined_by_land_and_by_bridges_that_are_short_enough() {
        let [west, middle, east] = [2, 20, 35].map(|x| I64Vec2::new(x, 5));
        let found = landmasses(&[(10, 12), (25, 31)], 250.0);
        assert!(found.may_join(west, middle) && !found.may_join(middle, east) && !found.may_join(west, east));
        // Nothing is known of nodes in water.
        assert!(found.may_join(I64Vec2::new(11, 3), east));
        assert!(landmasses(&[(10, 12), (25, 31)], 700.0).may_join(west, east));
        assert!(!landmasses(&[(10, 12)], 0.0).may_join(west, east));
        assert!(landmasses(&[], 0.0).may_join(west, east));
    }
}
