//! Streets cut into pieces that are short enough to be drawn by the chunk in which they lie.

use crate::network::Street;
use crate::space::{cut_line, point_at, quantize, segments};
use crate::surface::junction::junction_reach;
use glam::DVec2;

/// Greatest length of a piece, in metres.
pub const LONGEST_PIECE: f64 = 128.0;

/// Two points of a line count as one below this distance along it, in metres.
const SAME: f64 = 1e-3;

/// A street cut into pieces of equal length between the parts that belong to its junctions. A street keeps its id and its place
/// in the network; only what is drawn of it is cut. Lengths in metres along the centre line.
pub struct Pieces<'a> {
    street: &'a Street,
    /// Where the first piece begins.
    first: f64,
    /// Length of each piece.
    each: f64,
    count: usize,
}

impl<'a> Pieces<'a> {
    /// Cuts a street. A street is a single piece if its junctions leave no more than [`LONGEST_PIECE`] of it.
    pub fn new(street: &'a Street) -> Self {
        let (length, first) = (street.length(), junction_reach(street));
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

    /// The point in the middle of each piece, which names the chunk that draws the piece.
    pub fn middles(&self) -> impl Iterator<Item = DVec2> + '_ {
        let middle = |piece| self.first + (piece as f64 + 0.5) * self.each;
        (0..self.count).map(move |piece| self.rounded(point_at(&self.street.line, middle(piece)).0))
    }

    /// Rounds a point to the grid relative to the street's first point, so that every chunk gets the same point.
    fn rounded(&self, p: DVec2) -> DVec2 {
        let start = self.street.line[0];
        start + quantize(p - start)
    }

    /// The centre line between the parts that belong to the junctions, or from end to end if it is `whole`. It has a point
    /// wherever two pieces meet. Comes with the indices of the points at which pieces begin, and of the last point: piece `k`
    /// runs from point `at[k]` to point `at[k + 1]`.
    pub fn line(&self, whole: bool) -> (Vec<DVec2>, Vec<usize>) {
        let line = match whole {
            true => self.street.line.clone(),
            false => cut_line(&self.street.line, self.first, self.first + self.each * self.count as f64),
        };
        if self.count == 1 {
            let last = line.len() - 1;
            return (line, vec![0, last]);
        }
        let skipped = if whole { 0.0 } else { self.first };
        let mut borders = (1..self.count).map(|k| self.range(k)[0] - skipped).peekable();
        let (mut out, mut at, mut along) = (vec![line[0]], vec![0], 0.0);
        for (a, b) in segments(&line) {
            let length = a.distance(b);
            while let Some(border) = borders.next_if(|border| *border < along + length + SAME) {
                // A point of the line that is near enough serves.
                if border > along + SAME && border < along + length - SAME {
                    out.push(self.rounded(a.lerp(b, (border - along) / length)));
                } else if border >= along + length - SAME {
                    out.push(b);
                }
                at.push(out.len() - 1);
            }
            if out[out.len() - 1] != b {
                out.push(b);
            }
            along += length;
        }
        at.push(out.len() - 1);
        (out, at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{JunctionId, StreetClass, StreetId};
    use crate::space::{Seed, line_length};

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
            let street = street(line);
            let pieces = Pieces::new(&street);
            for whole in [false, true] {
                let (line, at) = pieces.line(whole);
                assert_eq!((at.len(), at[0], at[pieces.count()]), (pieces.count() + 1, 0, line.len() - 1), "{case}");
                assert!(line.windows(2).all(|w| w[0] != w[1]));
                let expected = if whole { street.length() } else { street.length() - 2.0 * junction_reach(&street) };
                assert!((line_length(&line) - expected).abs() < 0.05, "{case}");
                let lengths: Vec<f64> = at.windows(2).map(|w| line_length(&line[w[0]..=w[1]])).collect();
                let most = LONGEST_PIECE + if whole { 18.0 } else { 0.0 };
                assert!(lengths.iter().all(|l| *l > 0.0 && *l < most + 0.01), "{case}: {lengths:?}");
            }
            let moved = street.moved(DVec2::new(1536.0, -512.0));
            let far: Vec<DVec2> = Pieces::new(&moved).middles().map(|p| p - DVec2::new(1536.0, -512.0)).collect();
            assert_eq!(far, pieces.middles().collect::<Vec<_>>(), "every chunk finds the same middles");
        }
    }

    #[test]
    fn a_border_between_pieces_on_a_point_of_the_line_uses_the_point() {
        let street = street((0..=4).map(|k| DVec2::new(f64::from(k) * 100.0, 0.0)).collect());
        let pieces = Pieces::new(&street);
        let (line, at) = pieces.line(true);
        assert_eq!(pieces.count(), 3);
        assert_eq!((line.len(), at.len()), (7, 4), "two borders are added, none on a point");
        let even = Pieces { count: 2, each: 182.0, ..pieces };
        assert_eq!(even.line(false).1, [0, 2, 4]);
        assert_eq!(even.line(false).0[2], DVec2::new(200.0, 0.0));
    }
}
