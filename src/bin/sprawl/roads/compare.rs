//! How near the roads of a network lie to real ones, and straight lines between the same settlements.

use bevy_sprawl::export::RoadLine;
use bevy_sprawl::region::RoadNetwork;
use bevy_sprawl::space::{Bounds, resample, segments};
use glam::DVec2;
use rstar::primitives::Line;
use rstar::{PointDistance, RTree};
use serde_json::{Value, json};

/// Points of lines lie this far apart, in metres.
const SPACING: f64 = 50.0;
/// Within this distance in metres a point lies near a line.
const NEAR: f64 = 500.0;

/// Distances of points along some lines to the nearest of others.
pub struct Distances {
    /// Distance of a point, and the length of the piece of line that it stands for, in metres; sorted.
    sorted: Vec<(f64, f64)>,
    /// Length in metres of the lines, as far as they lie in the domain.
    length: f64,
}

impl Distances {
    /// From points in `domain` along `lines` to the nearest of `to`.
    fn of(lines: &[Vec<DVec2>], to: &Lines, domain: Bounds) -> Self {
        let mut sorted = Vec::new();
        for line in lines {
            let points = resample(line, SPACING);
            let inside = segments(&points).map(|(a, b)| (a.lerp(b, 0.5), a.distance(b)));
            let inside = inside.filter(|(middle, _)| domain.contains(*middle));
            sorted.extend(inside.filter_map(|(middle, length)| Some((to.nearest(middle)?, length))));
        }
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let length = sorted.iter().map(|(_, length)| length).sum();
        Self { sorted, length }
    }

    /// Mean distance in metres.
    pub fn mean(&self) -> f64 {
        self.sorted.iter().map(|(distance, length)| distance * length).sum::<f64>() / self.length.max(1e-9)
    }

    /// Share of the length that lies near, 0 to 1.
    pub fn near(&self) -> f64 {
        let near = self.sorted.iter().filter(|(distance, _)| *distance <= NEAR);
        near.map(|(_, length)| length).sum::<f64>() / self.length.max(1e-9)
    }

    fn json(&self) -> Value {
        json!({
            "length_m": self.length.round(),
            "mean_m": self.mean().round(),
            "share_within_500_m": (self.near() * 1e3).round() / 1e3,
        })
    }
}

/// Segments of lines, to find the nearest.
struct Lines(RTree<Line<[f64; 2]>>);

impl Lines {
    fn new(lines: &[Vec<DVec2>]) -> Self {
        let all = lines.iter().flat_map(|l| segments(l)).map(|(a, b)| Line::new(a.to_array(), b.to_array()));
        Self(RTree::bulk_load(all.collect()))
    }

    /// Distance to the nearest line; `None` without any.
    fn nearest(&self, p: DVec2) -> Option<f64> {
        let p = p.to_array();
        Some(self.0.nearest_neighbor(p)?.distance_2(&p).sqrt())
    }
}

/// All that is compared.
pub struct Comparison {
    /// Our roads to real ones, and straight lines between linked settlements to real ones.
    pub ours: Distances,
    pub straight: Distances,
    /// Real roads to ours, and to the straight lines.
    pub real: Distances,
    pub real_straight: Distances,
}

impl Comparison {
    /// Compares in the domain of a network.
    pub fn new(network: &RoadNetwork, real: &[RoadLine]) -> Self {
        let real: Vec<Vec<DVec2>> = real.iter().map(|r| r.line.clone()).collect();
        let ours: Vec<Vec<DVec2>> =
            network.roads.iter().map(|r| r.street.line.iter().map(|p| r.origin.to_plan(*p)).collect()).collect();
        let at = |id| network.settlements.iter().find(|s| s.id == id).map(|s| s.centre.plan());
        let straight: Vec<Vec<DVec2>> =
            network.links.iter().filter_map(|l| Some(vec![at(l.from)?, at(l.to)?])).collect();
        let [to_real, to_ours, to_straight] = [&real, &ours, &straight].map(|lines| Lines::new(lines));
        let of = |lines: &[Vec<DVec2>], to: &Lines| Distances::of(lines, to, network.domain);
        Self {
            ours: of(&ours, &to_real),
            straight: of(&straight, &to_real),
            real: of(&real, &to_ours),
            real_straight: of(&real, &to_straight),
        }
    }

    /// As the report has it.
    pub fn json(&self) -> Value {
        json!({
            "ours": self.ours.json(),
            "straight": self.straight.json(),
            "real_to_ours": self.real.json(),
            "real_to_straight": self.real_straight.json(),
        })
    }

    /// In lines for people.
    pub fn people(&self) -> String {
        let of = |d: &Distances| format!("{:.0} m on average, {:.0} % within {NEAR} m", d.mean(), 100.0 * d.near());
        format!(
            "\nfrom these roads to real ones {} (straight lines: {})\nfrom {:.0} km of real roads to these {} (to \
             straight lines: {})",
            of(&self.ours),
            of(&self.straight),
            self.real.length / 1000.0,
            of(&self.real),
            of(&self.real_straight),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_beside_another_lies_at_its_distance() {
        let line = |y: f64| vec![vec![DVec2::new(0.0, y), DVec2::new(4000.0, y)]];
        let domain = Bounds::new(DVec2::new(0.0, -900.0), DVec2::new(2000.0, 900.0));
        let far = Distances::of(&line(0.0), &Lines::new(&line(600.0)), domain);
        assert!((far.mean() - 600.0).abs() < 1e-6 && far.near() == 0.0 && (far.length - 2000.0).abs() < 26.0);
        let near = Distances::of(&line(0.0), &Lines::new(&[line(600.0), line(-300.0)].concat()), domain);
        assert!((near.mean() - 300.0).abs() < 1e-6 && near.near() == 1.0);
    }
}
