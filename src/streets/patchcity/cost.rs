//! The cost of a side between two tiles (Bustard and de Valmency 2015, equations 1 to 4).

use super::side::Crossing;

/// Distance in metres that costs as much as a street that becomes twice as wide: more than that at which streets stay alone, for main
/// streets are long.
const WIDER: f32 = 40.0;
/// Distance in metres that costs as much as a street that turns aside by a right angle on the side.
const BENT: f32 = 40.0;

/// Cost of two crossings of a side: the square of their distance, times the ratio of their widths, times their product. By these
/// equations streets of any width and direction go together where they meet exactly, as tiles do that were moved to fit; so widths
/// and directions that differ cost something by themselves.
pub fn pair_cost(a: Crossing, b: Crossing) -> f32 {
    let off = a.at - b.at;
    let (weight, unlike) = pair_weight(a, b);
    off * off * weight + unlike
}

/// What the square of the distance between two crossings is multiplied by in their cost, and what their widths and directions cost besides.
pub fn pair_weight(a: Crossing, b: Crossing) -> (f32, f32) {
    let ratio = a.width.max(b.width) / a.width.min(b.width);
    let wide = a.width * b.width;
    let bent = BENT * (a.slant - b.slant);
    (ratio * wide, (WIDER * WIDER * (ratio - 1.0) + bent * bent) * wide)
}

/// Cost of a side: that of the first crossings on both sides, of the second ones and so on (equation 1).
pub fn side_cost(a: &[Crossing], b: &[Crossing]) -> f32 {
    a.iter().zip(b).map(|(a, b)| pair_cost(*a, *b)).sum()
}

/// Number of crossings of a side for which no memory is allocated; few sides have more.
const FEW: usize = 31;

/// Cost of a side where crossings become one in [`pairs`] and the others stay alone.
pub fn paired_cost(a: &[Crossing], b: &[Crossing], alone: f32) -> f32 {
    let (mut few, mut many) = ([0.0f32; FEW + 1], Vec::new());
    // The least cost of the crossings of `a` so far with the first ones of `b`.
    let least = few.get_mut(..=b.len()).unwrap_or_else(|| {
        many.resize(b.len() + 1, 0.0);
        &mut many
    });
    for k in 0..b.len() {
        least[k + 1] = least[k] + alone_cost(b[k], alone);
    }
    for &x in a {
        let mut before = least[0];
        least[0] += alone_cost(x, alone);
        for (k, &y) in b.iter().enumerate() {
            let paired = before + pair_cost(x, y);
            before = least[k + 1];
            least[k + 1] = paired.min(before + alone_cost(x, alone)).min(least[k] + alone_cost(y, alone));
        }
    }
    least[b.len()]
}

/// Cost of a crossing that stays alone: as much as a pair `alone` metres apart.
fn alone_cost(c: Crossing, alone: f32) -> f32 {
    alone * alone * c.width * c.width
}

/// The pairs of crossings on both sides that become one, in order, so that their cost is the least; a crossing may stay alone at
/// the cost of a pair `alone` metres apart. Where both sides have as many, they pair in order, as in the paper.
pub fn pairs(a: &[Crossing], b: &[Crossing], alone: f32) -> Vec<(usize, usize)> {
    if a.len() == b.len() {
        return (0..a.len()).map(|i| (i, i)).collect();
    }
    let left = |c: Crossing| alone_cost(c, alone);
    // The least cost of the first crossings, and whether the last two pair.
    let width = b.len() + 1;
    let mut least = vec![0.0f32; (a.len() + 1) * width];
    for i in 0..=a.len() {
        for k in 0..=b.len() {
            let at = |i: usize, k: usize| i * width + k;
            least[at(i, k)] = match (i, k) {
                (0, 0) => 0.0,
                (0, k) => least[at(0, k - 1)] + left(b[k - 1]),
                (i, 0) => least[at(i - 1, 0)] + left(a[i - 1]),
                (i, k) => (least[at(i - 1, k - 1)] + pair_cost(a[i - 1], b[k - 1]))
                    .min(least[at(i - 1, k)] + left(a[i - 1]))
                    .min(least[at(i, k - 1)] + left(b[k - 1])),
            };
        }
    }
    let (mut i, mut k) = (a.len(), b.len());
    let mut out = Vec::new();
    while i > 0 && k > 0 {
        let here = least[i * width + k];
        if here == least[(i - 1) * width + k - 1] + pair_cost(a[i - 1], b[k - 1]) {
            out.push((i - 1, k - 1));
            (i, k) = (i - 1, k - 1);
        } else if here == least[(i - 1) * width + k] + left(a[i - 1]) {
            i -= 1;
        } else {
            k -= 1;
        }
    }
    out.reverse();
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crossing(at: f32, width: f32) -> Crossing {
        Crossing { at, width, slant: 0.0 }
    }

    #[test]
    fn the_cost_is_that_of_the_paper() {
        assert_eq!(pair_cost(crossing(3.0, 6.0), crossing(7.0, 6.0)), 16.0 * 36.0);
        assert_eq!(pair_cost(crossing(3.0, 6.0), crossing(7.0, 12.0)), (16.0 * 2.0 + WIDER * WIDER) * 72.0);
        let (a, b) = ([crossing(0.0, 6.0), crossing(9.0, 6.0)], [crossing(1.0, 6.0), crossing(7.0, 6.0)]);
        assert_eq!(side_cost(&a, &b), 36.0 + 4.0 * 36.0);
    }

    #[test]
    fn a_street_that_bends_on_a_side_costs_more_than_one_that_goes_straight_on() {
        let slanted = |at: f32, slant: f32| Crossing { at, width: 6.0, slant };
        assert_eq!(pair_cost(slanted(3.0, 0.7), slanted(3.0, 0.7)), 0.0, "a diagonal goes on");
        assert!(pair_cost(slanted(3.0, 0.7), slanted(3.0, 0.0)) > pair_cost(slanted(3.0, 0.7), slanted(12.0, 0.7)));
    }

    #[test]
    fn crossings_pair_in_order_and_one_too_many_stays_alone() {
        let side = |places: &[f32]| -> Vec<Crossing> { places.iter().map(|at| crossing(*at, 6.0)).collect() };
        assert_eq!(pairs(&side(&[0.0, 50.0]), &side(&[40.0, 90.0]), 60.0), [(0, 0), (1, 1)]);
        assert_eq!(pairs(&side(&[0.0, 50.0]), &side(&[48.0]), 60.0), [(1, 0)]);
        assert_eq!(pairs(&side(&[-80.0, 2.0, 70.0]), &side(&[0.0, 71.0]), 60.0), [(1, 0), (2, 1)]);
        assert_eq!(pairs(&side(&[]), &side(&[0.0]), 60.0), []);
    }

    #[test]
    fn the_cost_of_a_side_is_that_of_its_pairs_and_of_what_stays_alone() {
        let mut rng = crate::space::Seed(5).stream("crossings", &[]);
        for round in 0..300 {
            let [a, b] = [0, 1].map(|_| {
                let count = rng.index(if round < 290 { 9 } else { 50 });
                let mut side: Vec<Crossing> =
                    (0..count).map(|_| crossing(rng.range(-90.0, 90.0) as f32, rng.range(5.0, 14.0) as f32)).collect();
                side.sort_by(|x, y| x.at.total_cmp(&y.at));
                side
            });
            if a.len() == b.len() {
                continue;
            }
            let pairs = pairs(&a, &b, 30.0);
            let paired: f32 = pairs.iter().map(|(i, k)| pair_cost(a[*i], b[*k])).sum();
            let left = |side: &[Crossing], paired: Vec<usize>| -> f32 {
                let alone = side.iter().enumerate().filter(|(i, _)| !paired.contains(i));
                alone.map(|(_, c)| alone_cost(*c, 30.0)).sum()
            };
            let expected = paired
                + left(&a, pairs.iter().map(|pair| pair.0).collect())
                + left(&b, pairs.iter().map(|pair| pair.1).collect());
            let cost = paired_cost(&a, &b, 30.0);
            assert!((cost - expected).abs() <= 1e-3 * expected, "{round}: {cost} and {expected}");
        }
    }
}
