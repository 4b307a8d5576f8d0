//! How close the roads of a network lie to real ones, compared with straight lines between the same settlements.

use bevy_sprawl::map::{Map, MapReport};
use bevy_sprawl::region::RoadNetwork;
use bevy_sprawl::space::{resample, segments};
use glam::DVec2;
use rstar::primitives::Line;
use rstar::{PointDistance, RTree};
use serde_json::{Value, json};

/// Distance between the points that are measured along a line, in metres.
const SPACING: f64 = 50.0;
/// A point within this distance of a line is close to it, in metres.
const CLOSE: f64 = 500.0;

/// Distances from points along some lines to the nearest of other lines.
pub struct Distances {
    /// Distance of each point, and the length of line that the point stands for, in metres.
    measured: Vec<(f64, f64)>,
    /// Length of the lines in metres.
    length: f64,
}

impl Distances {
    /// From points along `lines` to the nearest of `to`.
    fn of(lines: &[Vec<DVec2>], to: &Lines) -> Self {
        let mut measured = Vec::new();
        for line in lines {
            let points = resample(line, SPACING);
            let pieces = segments(&points).map(|(a, b)| (a.lerp(b, 0.5), a.distance(b)));
            measured.extend(pieces.filter_map(|(middle, length)| Some((to.nearest(middle)?, length))));
        }
        let length = measured.iter().fold(0.0, |sum, (_, length)| sum + length);
        Self { measured, length }
    }

    /// Mean distance in metres; `None` of nothing.
    pub fn mean(&self) -> Option<f64> {
        let sum = self.measured.iter().fold(0.0, |sum, (distance, length)| sum + distance * length);
        (self.length > 0.0).then(|| sum / self.length)
    }

    /// Share of the length that is close, 0 to 1; `None` of nothing.
    pub fn share_close(&self) -> Option<f64> {
        let close = self.measured.iter().filter(|(distance, _)| *distance <= CLOSE);
        (self.length > 0.0).then(|| close.fold(0.0, |sum, (_, length)| sum + length) / self.length)
    }

    fn json(&self) -> Value {
        json!({
            "length_m": self.length.round(),
            "mean_m": self.mean().map(f64::round),
            "share_within_500_m": self.share_close().map(|share| (share * 1e3).round() / 1e3),
        })
    }

    fn words(&self) -> String {
        match self.mean().zip(self.share_close()) {
            Some((mean, share)) => format!("{mean:.0} m on average, {:.0} % within {CLOSE} m", 100.0 * share),
            None => "there are none".into(),
        }
    }
}

/// Segments of lines, indexed to find the nearest.
struct Lines(RTree<Line<[f64; 2]>>);

impl Lines {
    fn new(lines: &[Vec<DVec2>]) -> Self {
        let all = lines.iter().flat_map(|l| segments(l)).map(|(a, b)| Line::new(a.to_array(), b.to_array()));
        Self(RTree::bulk_load(all.collect()))
    }

    /// Distance to the nearest line; `None` if there is no line.
    fn nearest(&self, p: DVec2) -> Option<f64> {
        let p = p.to_array();
        Some(self.0.nearest_neighbor(p)?.distance_2(&p).sqrt())
    }
}

/// A network beside real roads.
pub struct Comparison {
    /// From the network's roads to the real ones.
    pub ours: Distances,
    /// From straight lines between linked settlements to the real roads.
    pub straight: Distances,
    /// From the real roads to the network's.
    pub real: Distances,
    /// From the real roads to the straight lines.
    pub real_straight: Distances,
    /// What was read of the real roads.
    pub report: MapReport,
}

impl Comparison {
    /// Compares a network with real roads that are clipped to its domain.
    pub fn new(network: &RoadNetwork, map: &Map) -> Self {
        let real: Vec<Vec<DVec2>> = map.streets.iter().map(|s| map.line(s)).collect();
        let ours: Vec<Vec<DVec2>> =
            network.roads.iter().map(|r| r.street.line.iter().map(|p| r.origin.to_plan(*p)).collect()).collect();
        let at = |id| network.settlements.iter().find(|s| s.id == id).map(|s| s.centre.plan());
        let straight: Vec<Vec<DVec2>> =
            network.links.iter().filter_map(|l| Some(vec![at(l.from)?, at(l.to)?])).collect();
        let [to_real, to_ours, to_straight] = [&real, &ours, &straight].map(|lines| Lines::new(lines));
        Self {
            ours: Distances::of(&ours, &to_real),
            straight: Distances::of(&straight, &to_real),
            real: Distances::of(&real, &to_ours),
            real_straight: Distances::of(&real, &to_straight),
            report: map.report.clone(),
        }
    }

    /// The comparison as the JSON report has it.
    pub fn json(&self) -> Value {
        let left_out: serde_json::Map<String, Value> =
            self.report.left_out.iter().map(|(reason, count)| (reason.key().into(), json!(count))).collect();
        json!({
            "file": self.report.file,
            "streets": self.report.streets,
            "share_inside": (self.report.share_inside() * 1e3).round() / 1e3,
            "left_out": left_out,
            "ours": self.ours.json(),
            "straight": self.straight.json(),
            "real_to_ours": self.real.json(),
            "real_to_straight": self.real_straight.json(),
        })
    }

    /// The comparison in lines for people.
    pub fn people(&self) -> String {
        let report = &self.report;
        let left_out = match report.left_out_in_words() {
            none if none.is_empty() => none,
            reasons => format!("; left out: {reasons}"),
        };
        format!(
            "\n{}: {} real roads, {:.1} km in the domain, {:.0} % of their length{left_out}\n\
             from these roads to real ones: {} (straight lines: {})\n\
             from real roads to these: {} (to straight lines: {})",
            report.file,
            report.streets,
            report.length_inside / 1000.0,
            100.0 * report.share_inside(),
            self.ours.words(),
            self.straight.words(),
            self.real.words(),
            self.real_straight.words(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_beside_another_lies_at_its_distance() {
        let line = |y: f64| vec![vec![DVec2::new(0.0, y), DVec2::new(2000.0, y)]];
        let far = Distances::of(&line(0.0), &Lines::new(&line(600.0)));
        assert!(far.mean().is_some_and(|m| (m - 600.0).abs() < 1e-6) && far.share_close() == Some(0.0));
        assert!((far.length - 2000.0).abs() < 1e-6);
        let close = Distances::of(&line(0.0), &Lines::new(&[line(600.0), line(-300.0)].concat()));
        assert!(close.mean().is_some_and(|m| (m - 300.0).abs() < 1e-6) && close.share_close() == Some(1.0));
        let nothing = Distances::of(&line(0.0), &Lines::new(&[]));
        assert_eq!((nothing.mean(), nothing.words().as_str()), (None, "there are none"));
    }
}
