//! Pairing streets across a seam by PatchCity's cost.

use crate::network::StreetClass;

/// PatchCity's cost of joining two streets across a seam (section 3.1, equations 2 to 4).
fn cost(a: (f64, StreetClass), b: (f64, StreetClass)) -> f64 {
    let (distance, width_a, width_b) = (a.0 - b.0, a.1.carriageway(), b.1.carriageway());
    let ratio = width_a.max(width_b) / width_a.min(width_b);
    distance * distance * ratio * width_a * width_b
}

/// The pairs of least total cost that keep the order along the seam, as indices into both lists. Staying alone costs half as
/// much as a pair at the distance `cutoff` (metres). Positions are metres along the street.
pub(super) fn pair(left: &[(f64, StreetClass)], right: &[(f64, StreetClass)], cutoff: f64) -> Vec<(usize, usize)> {
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
        // The difference in width makes a pair dearer.
        assert!(
            cost((0., StreetClass::Local), (20., StreetClass::Main))
                > cost((0., StreetClass::Local), (20., StreetClass::Local))
        );
    }
}
