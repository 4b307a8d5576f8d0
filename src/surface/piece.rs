//! Streets cut into pieces that are short enough to belong to the chunk in which they lie.

use crate::network::Street;
use crate::space::{point_at, quantize};
use crate::surface::junction::deck_reach;
use glam::DVec2;

/// Greatest length of a piece, in metres.
pub const LONGEST_PIECE: f64 = 128.0;

/// A street cut into pieces of equal length, a bridge between the parts that lie on the ground. A street keeps its id and its place
/// in the network. Lengths in metres along the centre line.
pub struct Pieces<'a> {
    street: &'a Street,
    /// Where the first piece begins.
    first: f64,
    /// Length of each piece.
    each: f64,
    count: usize,
}

impl<'a> Pieces<'a> {
    /// Cuts a street.
    pub fn new(street: &'a Street) -> Self {
        let (length, first) = (street.length(), if street.bridge { deck_reach(street) } else { 0.0 });
        let span = length - 2.0 * first;
        let count = (span / LONGEST_PIECE).ceil().max(1.0) as usize;
        Self { street, first, each: span / count as f64, count }
    }

    /// Number of pieces, at least 1.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Where a piece begins and ends.
    pub fn range(&self, piece: usize) -> [f64; 2] {
        [piece, piece + 1].map(|k| self.first + k as f64 * self.each)
    }

    /// The point in the middle of each piece, which names the chunk that the piece belongs to.
    pub fn middles(&self) -> impl Iterator<Item = DVec2> + '_ {
        let middle = |piece| self.first + (piece as f64 + 0.5) * self.each;
        (0..self.count).map(move |piece| self.rounded(point_at(&self.street.line, middle(piece)).0))
    }

    /// Rounds a point to the grid relative to the street's first point, so that every chunk gets the same point.
    fn rounded(&self, p: DVec2) -> DVec2 {
        let start = self.street.line[0];
        start + quantize(p - start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{JunctionId, StreetClass, StreetId};
    use crate::space::Seed;

    fn street(line: Vec<DVec2>) -> Street {
        Street::new(StreetId(1), StreetClass::Minor, JunctionId(1), JunctionId(2), line)
    }

    #[test]
    fn pieces_cover_a_street_once() {
        let mut rng = Seed(3).stream("pieces", &[]);
        for case in 0..300 {
            let mut line = vec![quantize(DVec2::new(rng.range(-900.0, 900.0), 40.0))];
            for _ in 0..1 + rng.index(30) {
                let step = DVec2::new(rng.range(0.5, 150.0), rng.range(-60.0, 60.0));
                line.push(quantize(line[line.len() - 1] + step));
            }
            let street = Street { bridge: case % 2 == 0, ..street(line) };
            let pieces = Pieces::new(&street);
            let ends = if street.bridge { deck_reach(&street) } else { 0.0 };
            let ranges: Vec<[f64; 2]> = (0..pieces.count()).map(|k| pieces.range(k)).collect();
            assert!((ranges[0][0] - ends).abs() < 1e-6, "{case}");
            assert!((ranges[ranges.len() - 1][1] - (street.length() - ends)).abs() < 1e-6, "{case}");
            assert!(ranges.windows(2).all(|w| (w[0][1] - w[1][0]).abs() < 1e-6), "{case}");
            assert!(ranges.iter().all(|r| r[1] - r[0] > 0.0 && r[1] - r[0] < LONGEST_PIECE + 0.01), "{case}");
            let moved = street.moved(DVec2::new(1536.0, -512.0));
            let far: Vec<DVec2> = Pieces::new(&moved).middles().map(|p| p - DVec2::new(1536.0, -512.0)).collect();
            assert_eq!(far, pieces.middles().collect::<Vec<_>>(), "every chunk finds the same middles");
        }
    }
}
