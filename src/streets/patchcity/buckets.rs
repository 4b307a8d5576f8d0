//! The edges of a graph by place: squares of a grid, each with the edges that may overlap it.

use crate::network::{EdgeIx, PlanarGraph};
use crate::space::Bounds;
use glam::{DVec2, I64Vec2};

/// Edge of a square in metres.
const SQUARE: f64 = 60.0;

/// Edges by place.
pub struct Buckets {
    corner: DVec2,
    size: I64Vec2,
    squares: Vec<Vec<EdgeIx>>,
}

impl Buckets {
    /// The edges of a graph.
    pub fn of<E: Clone>(graph: &PlanarGraph<E>) -> Self {
        let bounds = Bounds::of(graph.edges().flat_map(|(e, _)| <[DVec2; 2]>::from(graph.segment(e)))).grown(1.0);
        let corner = if bounds.min.is_finite() { bounds.min } else { DVec2::ZERO };
        let size = if bounds.min.is_finite() { (bounds.size() / SQUARE).ceil().as_i64vec2() } else { I64Vec2::ONE };
        let squares = vec![Vec::new(); (size.x * size.y) as usize];
        let mut buckets = Self { corner, size, squares };
        let edges: Vec<EdgeIx> = graph.edges().map(|(e, _)| e).collect();
        edges.into_iter().for_each(|e| buckets.add(graph, e));
        buckets
    }

    /// Adds an edge.
    pub fn add<E: Clone>(&mut self, graph: &PlanarGraph<E>, edge: EdgeIx) {
        let (a, b) = graph.segment(edge);
        for square in self.squares_of(Bounds::of([a, b])) {
            self.squares[square].push(edge);
        }
    }

    /// The edges that are there and whose boxes overlap a box, by number.
    pub fn near<E: Clone>(&self, graph: &PlanarGraph<E>, bounds: Bounds) -> Vec<EdgeIx> {
        let overlaps = |e: &EdgeIx| {
            graph.is_live(*e) && {
                let (a, b) = graph.segment(*e);
                bounds.overlaps(Bounds::of([a, b]))
            }
        };
        let mut out: Vec<EdgeIx> =
            self.squares_of(bounds).flat_map(|square| &self.squares[square]).copied().filter(overlaps).collect();
        out.sort_unstable();
        out.dedup();
        out
    }

    fn squares_of(&self, bounds: Bounds) -> impl Iterator<Item = usize> + use<> {
        let last = self.size - I64Vec2::ONE;
        let square = |p: DVec2| ((p - self.corner) / SQUARE).floor().as_i64vec2().clamp(I64Vec2::ZERO, last);
        let (from, to, columns) = (square(bounds.min), square(bounds.max), self.size.x);
        (from.y..=to.y).flat_map(move |y| (from.x..=to.x).map(move |x| (y * columns + x) as usize))
    }
}
