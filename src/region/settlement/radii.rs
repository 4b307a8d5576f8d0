//! Evening out the radii of a star-shaped region, given on rays that are spread evenly around its centre.

use std::f64::consts::TAU;

/// Greatest change of the radius per radian, as a share of the radius. It rules out spikes and notches.
const MOST_CHANGE: f64 = 0.85;

/// Removes spikes: afterwards no radius is much greater than its neighbours. No radius grows.
pub(in crate::region) fn even_out(radii: &mut [f64]) {
    even_out_free(radii, &vec![false; radii.len()]);
}

/// The same, but leaves the radii that are `fixed` as they are.
pub(in crate::region) fn even_out_free(radii: &mut [f64], fixed: &[bool]) {
    let n = radii.len();
    let growth = 1.0 + MOST_CHANGE * TAU / n as f64;
    let limit = |radii: &mut [f64]| {
        // Twice around in each direction, so that a limit carries over the start.
        for i in 0..2 * n {
            if !fixed[(i + 1) % n] {
                radii[(i + 1) % n] = radii[(i + 1) % n].min(radii[i % n] * growth);
            }
        }
        for i in (0..2 * n).rev() {
            if !fixed[i % n] {
                radii[i % n] = radii[i % n].min(radii[(i + 1) % n] * growth);
            }
        }
    };
    limit(radii);
    for _ in 0..3 {
        let before = radii.to_vec();
        for i in (0..n).filter(|i| !fixed[*i]) {
            let mean = (before[(i + n - 1) % n] + 2.0 * before[i] + before[(i + 1) % n]) / 4.0;
            radii[i] = radii[i].min(mean);
        }
    }
    limit(radii);
}
