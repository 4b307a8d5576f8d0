//! Figures that describe a street network, as urban analysts and the papers measure it.

use super::directions::{is_sharp, orientation_order};
use crate::network::{JunctionId, Network};
use crate::space::DisjointSets;
use glam::DVec2;
use serde::Serialize;
use std::collections::BTreeMap;

/// Figures of a network. Vertices of degree 1 are dead ends, those of degree 3 or more are junctions.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Measures {
    /// Total length of streets, in kilometres.
    pub street_km: f64,
    /// Vertices of degree 3 or more.
    pub junctions: usize,
    /// Vertices of degree 1.
    pub dead_ends: usize,
    /// Vertices by degree.
    pub degree: BTreeMap<usize, usize>,
    /// Connected node ratio: junctions / (junctions + dead ends) (Teng 2017, equation 2, after Dill 2004).
    pub cnr: f64,
    /// Mean length of the streets between vertices whose degree is not 2, in metres.
    pub mean_street_m: f64,
    /// Boeing's orientation order phi: 1 for one perfect grid, 0 for no order (36 bins, streets weighted by 1).
    pub orientation_order: f64,
    /// Total length over total straight distance between street ends, at least 1.
    pub circuity: f64,
    /// Share of junctions whose smallest angle is below 30 degrees.
    pub share_angle_below_30: f64,
    /// Connected components.
    pub components: usize,
}

/// Measures a network. Streets may end at junctions that are not listed: such a street counts with its length and at its other
/// end, so that a part of a network can be measured with the true degrees of its junctions.
pub fn measure(network: &Network) -> Measures {
    let ends: BTreeMap<JunctionId, usize> = network.junctions.iter().enumerate().map(|(i, j)| (j.id, i)).collect();
    let mut leaving: Vec<Vec<DVec2>> = vec![Vec::new(); network.junctions.len()];
    let mut components = DisjointSets::new();
    let mut touched = vec![false; network.junctions.len()];
    let (mut length, mut straight, mut inflexions) = (0.0, 0.0, 0usize);
    for street in &network.streets {
        let (line, n) = (&street.line, street.line.len());
        let beeline = line[n - 1] - line[0];
        length += street.length();
        straight += beeline.length();
        let (from, to) = (ends.get(&street.from).copied(), ends.get(&street.to).copied());
        for (end, outward) in [(from, line[1] - line[0]), (to, line[n - 2] - line[n - 1])] {
            if let Some(end) = end {
                leaving[end].push(outward);
                touched[end] = true;
            }
        }
        if let (Some(from), Some(to)) = (from, to) {
            components.union(from, to);
        }
    }
    let mut out = Measures { street_km: length / 1000.0, ..Default::default() };
    let mut sharp = 0;
    for around in leaving.iter().filter(|l| !l.is_empty()) {
        *out.degree.entry(around.len()).or_default() += 1;
        inflexions += usize::from(around.len() == 2);
        sharp += usize::from(is_sharp(around));
    }
    out.dead_ends = out.degree.get(&1).copied().unwrap_or(0);
    out.junctions = out.degree.range(3..).map(|(_, n)| n).sum();
    out.cnr = out.junctions as f64 / (out.junctions + out.dead_ends).max(1) as f64;
    out.mean_street_m = length / network.streets.len().saturating_sub(inflexions).max(1) as f64;
    out.circuity = if straight > 0.0 { length / straight } else { 1.0 };
    out.share_angle_below_30 = sharp as f64 / out.junctions.max(1) as f64;
    let beelines = network.streets.iter().map(|street| street.line[street.line.len() - 1] - street.line[0]);
    out.orientation_order = orientation_order(beelines);
    out.components = (0..touched.len()).filter(|i| touched[*i] && components.find(*i) == *i).count();
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Junction, Street, StreetClass, StreetId};

    #[test]
    fn a_cross_of_four_streets() {
        let id = |i: u64| JunctionId(i);
        let at = [DVec2::ZERO, DVec2::X * 100.0, DVec2::Y * 100.0, DVec2::X * -100.0, DVec2::Y * -100.0];
        let junctions = at.iter().enumerate().map(|(i, p)| Junction { id: id(i as u64), at: *p }).collect();
        let streets = (1..5)
            .map(|i| Street::new(StreetId(i), StreetClass::Local, id(0), id(i), vec![at[0], at[i as usize]]))
            .collect();
        let m = measure(&Network { junctions, streets });
        assert_eq!((m.junctions, m.dead_ends, m.components), (1, 4, 1));
        assert_eq!((m.cnr, m.street_km, m.mean_street_m, m.circuity), (0.2, 0.4, 100.0, 1.0));
        assert!((m.orientation_order - 1.0).abs() < 1e-12);
    }
}
