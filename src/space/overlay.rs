//! What polygons have in common.

use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;

/// The parts that two simple polygons have in common, counter-clockwise.
pub fn common_parts(a: &[DVec2], b: &[DVec2]) -> Vec<Vec<DVec2>> {
    let points = |polygon: &[DVec2]| -> Vec<[f64; 2]> { polygon.iter().map(|p| p.to_array()).collect() };
    let shapes = points(a).overlay(&points(b), OverlayRule::Intersect, FillRule::NonZero);
    let outer = shapes.into_iter().filter_map(|shape| shape.into_iter().next());
    outer.map(|ring| ring.into_iter().map(DVec2::from_array).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::signed_area;

    #[test]
    fn parts_are_those_in_both() {
        let rectangle = |x: f64, y: f64, w: f64, h: f64| {
            [(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| DVec2::new(x, y)).to_vec()
        };
        let u = [(0., 0.), (9., 0.), (9., 6.), (6., 6.), (6., 2.), (3., 2.), (3., 6.), (0., 6.)];
        let u: Vec<DVec2> = u.map(|(x, y)| DVec2::new(x, y)).to_vec();
        let areas = |a: &[DVec2], b: &[DVec2]| -> Vec<f64> {
            common_parts(a, b).iter().map(|p| (signed_area(p) * 1e6).round() / 1e6).collect()
        };
        assert_eq!(areas(&rectangle(0., 0., 4., 4.), &rectangle(2., 3., 9., 9.)), [2.0]);
        assert_eq!(areas(&u, &rectangle(-1., 4., 20., 1.)), [3.0, 3.0], "both arms");
        assert_eq!(areas(&u, &rectangle(20., 0., 1., 1.)), [0.0; 0]);
    }
}
