//! Hexagonal-bin plots of connectivity against density, as Figs. 9 and 10 of Teng 2017.

use crate::fail::Fail;
use bevy_sprawl::space::math::ln;
use plotters::prelude::*;
use std::collections::BTreeMap;

/// Size of a panel in pixels, where there are several and where there is one.
const PANEL: [(u32, u32); 2] = [(300, 230), (760, 560)];
/// What the axes show: density in km/km2, connectivity.
const DENSITY: std::ops::Range<f64> = 0.0..60.0;
const CNR: std::ops::Range<f64> = 0.4..1.0;
/// Width of a hexagon, as a share of the width of a panel.
const HEXAGON: f64 = 1.0 / 48.0;

/// Draws a panel for each named list of points (density, connectivity), so many in a row, as SVG.
pub fn panels(panels: &[(String, Vec<(f64, f64)>)], columns: usize) -> Result<String, Fail> {
    let (width, height) = PANEL[usize::from(panels.len() == 1)];
    let rows = panels.len().div_ceil(columns);
    let mut svg = String::new();
    let fail = |e: &dyn std::fmt::Display| Fail::World(e.to_string());
    {
        let root =
            SVGBackend::with_string(&mut svg, (width * columns as u32, height * rows as u32)).into_drawing_area();
        root.fill(&WHITE).map_err(|e| fail(&e))?;
        for ((title, points), area) in panels.iter().zip(root.split_evenly((rows, columns))) {
            let mut chart = ChartBuilder::on(&area)
                .margin(6)
                .margin_right(18)
                .caption(title, ("sans-serif", 15))
                .x_label_area_size(34)
                .y_label_area_size(42)
                .build_cartesian_2d(DENSITY, CNR)
                .map_err(|e| fail(&e))?;
            chart
                .configure_mesh()
                .disable_mesh()
                .x_labels(7)
                .y_labels(7)
                .x_desc("street km per km²")
                .y_desc("CNR")
                .draw()
                .map_err(|e| fail(&e))?;
            let bins = bins(points, f64::from(width) / f64::from(height));
            let most = bins.iter().map(|b| b.1).max().unwrap_or(1);
            let hexagons =
                bins.iter().map(|(corners, count)| Polygon::new(corners.clone(), shade(*count, most).filled()));
            chart.draw_series(hexagons).map_err(|e| fail(&e))?;
        }
        root.present().map_err(|e| fail(&e))?;
    }
    Ok(svg)
}

/// From light to dark by the logarithm of the count, as bins differ by orders of magnitude.
fn shade(count: usize, most: usize) -> RGBColor {
    let t = (ln(count as f64) / ln(most.max(2) as f64)).clamp(0.0, 1.0);
    let mix = |from: f64, to: f64| (from + (to - from) * t) as u8;
    RGBColor(mix(198.0, 8.0), mix(219.0, 48.0), mix(239.0, 107.0))
}

/// Hexagons that hold points: corners and number of points. `aspect` is that of a panel, so that hexagons look regular.
fn bins(points: &[(f64, f64)], aspect: f64) -> Vec<(Vec<(f64, f64)>, usize)> {
    // In units of the width of a hexagon; rows are apart by three quarters of its height.
    let (across, up) = ((DENSITY.end - DENSITY.start) * HEXAGON, (CNR.end - CNR.start) * HEXAGON * aspect);
    let row_step = 3f64.sqrt() / 2.0;
    let mut counts: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    for (density, cnr) in points {
        let (x, y) = (density / across, cnr / up);
        let nearest = [(y / row_step).floor(), (y / row_step).floor() + 1.0].map(|row| {
            let shift = 0.5 * row.rem_euclid(2.0);
            let column = (x - shift).round();
            let (dx, dy) = (x - shift - column, y - row * row_step);
            (dx * dx + dy * dy, (row as i64, column as i64))
        });
        let cell = if nearest[0].0 <= nearest[1].0 { nearest[0].1 } else { nearest[1].1 };
        *counts.entry(cell).or_default() += 1;
    }
    let corner = |row: i64, column: i64, k: usize| {
        let (x, y) = [(0.0, 2.0), (0.5, 1.0), (0.5, -1.0), (0.0, -2.0), (-0.5, -1.0), (-0.5, 1.0)][k];
        let middle = column as f64 + 0.5 * row.rem_euclid(2) as f64;
        ((middle + x) * across, (row as f64 * row_step + y / 12f64.sqrt()) * up)
    };
    counts.into_iter().map(|((row, column), n)| ((0..6).map(|k| corner(row, column, k)).collect(), n)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_is_in_one_bin() {
        let points: Vec<(f64, f64)> =
            (0..500).map(|i| (f64::from(i * 37 % 600) / 10.0, 0.4 + f64::from(i) * 0.0012)).collect();
        let bins = bins(&points, 1.3);
        assert_eq!(bins.iter().map(|b| b.1).sum::<usize>(), 500);
        assert!(bins.len() > 100 && bins.iter().all(|b| b.0.len() == 6));
    }
}
