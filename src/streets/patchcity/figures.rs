//! What tiles hold, and what is missing: tiles that fit their neighbours by chance hold less than the map does, for where fewer
//! streets meet, less can be off. What too few tiles had becomes cheaper.

use super::window::Cut;
use crate::patch::PatchBuilding;
use crate::space::signed_area;

/// Number of figures of a tile.
const FIGURES: usize = 5;
/// Cost of a deviation of a tile for each deviation that all tiles together are off.
const COST: f32 = 110.0;
/// Greatest deviation of all tiles that counts.
const MOST: f32 = 8.0;
/// What is left of what is missing after each tile.
const LEFT: f32 = 0.97;

/// Figures of a tile: length of streets and of those that are not local, junctions, dead ends, and area of buildings. In a table
/// they are deviations from the mean of all its tiles, as multiples of the standard deviation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Figures([f32; FIGURES]);

impl Figures {
    /// The figures of a tile's streets and buildings.
    pub fn of(cut: &Cut, buildings: &[PatchBuilding], half: f64) -> Self {
        let mut degrees = vec![0u32; cut.points.len()];
        let (mut length, mut main) = (0.0, 0.0);
        for &(a, b, class) in &cut.edges {
            let long = cut.points[a as usize].distance(cut.points[b as usize]);
            length += long;
            main += if class.is_main() { long } else { 0.0 };
            degrees[a as usize] += 1;
            degrees[b as usize] += 1;
        }
        let inside = cut.points.iter().map(|p| p.abs().max_element() < half - 0.01);
        let count =
            |is: &dyn Fn(u32) -> bool| inside.clone().zip(&degrees).filter(|(i, d)| *i && is(**d)).count() as f32;
        let built: f64 = buildings.iter().map(|building| signed_area(&building.outline)).sum();
        Self([length as f32, main as f32, count(&|d| d > 2), count(&|d| d == 1), built as f32])
    }

    /// Length of streets in metres.
    pub fn length(&self) -> f32 {
        self.0[0]
    }

    /// Number of junctions, and of dead ends.
    pub fn ends(&self) -> (f32, f32) {
        (self.0[2], self.0[3])
    }

    /// Makes figures deviations from the mean of all, which count by `weights`.
    pub fn compare(all: &mut [Self], weights: &[f32]) {
        let whole = weights.iter().sum::<f32>().max(f32::MIN_POSITIVE);
        for i in 0..FIGURES {
            let of_all = |figure: &dyn Fn(f32) -> f32| -> f32 {
                all.iter().zip(weights).map(|(f, weight)| figure(f.0[i]) * weight).sum::<f32>() / whole
            };
            let mean = of_all(&|x| x);
            let variance = of_all(&|x| (x - mean) * (x - mean));
            let scale = if variance > 0.0 { 1.0 / variance.sqrt() } else { 0.0 };
            all.iter_mut().for_each(|f| f.0[i] = (f.0[i] - mean) * scale);
        }
    }
}

/// How much all tiles together are off the mean.
#[derive(Clone, Copy, Debug, Default)]
pub struct Balance([f32; FIGURES]);

impl Balance {
    /// Cost of a tile: less than 0 if it has what others lack.
    pub fn cost(&self, figures: Figures) -> f32 {
        let cost = |(off, own): (&f32, &f32)| off.clamp(-MOST, MOST) * own;
        COST * self.0.iter().zip(&figures.0).map(cost).sum::<f32>()
    }

    /// Counts a tile that is laid, in place of another if there was one.
    pub fn count(&mut self, figures: Figures, before: Option<Figures>) {
        for i in 0..FIGURES {
            let old = before.map_or(0.0, |before| before.0[i]);
            self.0[i] = if before.is_some() { self.0[i] } else { LEFT * self.0[i] } + figures.0[i] - old;
        }
    }
}
