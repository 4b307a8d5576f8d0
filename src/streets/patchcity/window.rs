//! The streets of a window, cut at its sides wherever it is moved.

use super::side::{Crossing, Side};
use crate::network::StreetClass;
use crate::patch::Patch;
use crate::space::{Bounds, distance_to_segment, stable_hash};
use glam::DVec2;
use std::sync::Arc;

/// The streets of a window and around it, in metres from its middle.
#[derive(Debug)]
pub struct Window {
    points: Vec<DVec2>,
    /// Number of streets at each point.
    degrees: Vec<u8>,
    edges: Vec<(u32, u32, StreetClass)>,
    /// Half of the window's edge.
    pub half: f64,
    /// How far it may be moved along either axis.
    pub margin: f64,
    /// Its middle in the map, in the window's own directions.
    pub place: DVec2,
    /// A number for each map.
    pub map: u32,
}

/// The windows of some patches, and the names of their maps by number.
pub fn windows(patches: &[Arc<Patch>]) -> (Vec<Window>, Vec<u64>) {
    let mut maps: Vec<(&str, f64)> = Vec::new();
    let mut out = Vec::with_capacity(patches.len());
    for patch in patches {
        let Some(window) = &patch.window else { continue };
        let map = (window.map.as_str(), window.turned);
        let number = maps.iter().position(|m| *m == map).unwrap_or_else(|| {
            maps.push(map);
            maps.len() - 1
        });
        let mut degrees = vec![0u8; patch.vertices.len()];
        for edge in &patch.edges {
            degrees[edge.a] = degrees[edge.a].saturating_add(1);
            degrees[edge.b] = degrees[edge.b].saturating_add(1);
        }
        out.push(Window {
            points: patch.vertices.iter().map(|v| *v - window.middle).collect(),
            degrees,
            edges: patch.edges.iter().map(|e| (e.a as u32, e.b as u32, e.class)).collect(),
            half: window.size / 2.0,
            margin: window.margin,
            place: crate::space::math::rotate(window.at, -window.turned),
            map: number as u32,
        });
    }
    let names = maps.into_iter().map(|(name, _)| stable_hash(&name.bytes().map(u64::from).collect::<Vec<_>>()));
    (out, names.collect())
}

/// The streets of a tile, cut at its sides. Positions are metres from its middle.
#[derive(Clone, Debug, Default)]
pub struct Cut {
    /// Points of streets.
    pub points: Vec<DVec2>,
    /// Streets between points.
    pub edges: Vec<(u32, u32, StreetClass)>,
    /// For each side the streets that cross it, in order, with the point there.
    pub sides: [Vec<(Crossing, u32)>; 4],
}

/// A vector turned counter-clockwise by quarter turns, without rounding.
pub fn turned(v: DVec2, turns: u8) -> DVec2 {
    match turns % 4 {
        0 => v,
        1 => v.perp(),
        2 => -v,
        _ => -v.perp(),
    }
}

impl Window {
    /// The streets in the window, turned and then moved over them by `shift`.
    pub fn cut(&self, turns: u8, shift: DVec2) -> Cut {
        let bounds = Bounds::square(DVec2::ZERO, 2.0 * self.half);
        let at = |v: u32| turned(self.points[v as usize], turns) - shift;
        let mut out = Cut::default();
        let mut numbers = vec![u32::MAX; self.points.len()];
        for &(v, w, class) in &self.edges {
            let (a, b) = (at(v), at(w));
            let Some((from, to)) = bounds.clip_segment(a, b) else { continue };
            let way = (b - a).normalize_or_zero();
            let mut end = |v: u32, is_whole: bool, at: DVec2| {
                let is_new = !is_whole || numbers[v as usize] == u32::MAX;
                if is_new {
                    out.points.push(at);
                    let point = out.points.len() as u32 - 1;
                    // A street that ends on a side leads on as well.
                    let leads_on = !is_whole || self.degrees[v as usize] == 1;
                    if let Some(side) = self.side_at(at).filter(|_| leads_on) {
                        let along = if way[side.axis()] < 0.0 { -way } else { way };
                        let crossing = Crossing {
                            at: at[1 - side.axis()] as f32,
                            width: class.carriageway() as f32,
                            slant: along[1 - side.axis()] as f32,
                        };
                        out.sides[side as usize].push((crossing, point));
                    }
                    if !is_whole {
                        return point;
                    }
                    numbers[v as usize] = point;
                }
                numbers[v as usize]
            };
            let first = end(v, from == 0.0, a + (b - a) * from);
            let last = end(w, to == 1.0, a + (b - a) * to);
            out.edges.push((first, last, class));
        }
        for side in &mut out.sides {
            side.sort_by(|x, y| x.0.at.total_cmp(&y.0.at).then(x.1.cmp(&y.1)));
        }
        out
    }

    /// Where streets cross the sides of the window, turned and then moved by `shift`.
    pub fn crossings(&self, turns: u8, shift: DVec2) -> [Vec<Crossing>; 4] {
        self.cut(turns, shift).sides.map(|side| side.into_iter().map(|(crossing, _)| crossing).collect())
    }

    /// Distance in metres from a point to the streets of the window, turned.
    pub fn distance(&self, turns: u8, p: DVec2) -> f64 {
        let p = turned(p, 4 - turns % 4);
        let at = |v: u32| self.points[v as usize];
        self.edges.iter().map(|(v, w, _)| distance_to_segment(p, at(*v), at(*w))).fold(f64::INFINITY, f64::min)
    }

    /// The side that a point lies on, if it lies on one.
    fn side_at(&self, p: DVec2) -> Option<Side> {
        const ON: f64 = 1e-6;
        let off = [p.x + self.half, self.half - p.x, p.y + self.half, self.half - p.y];
        let nearest = (0..4).min_by(|a, b| off[*a].abs().total_cmp(&off[*b].abs()))?;
        (off[nearest].abs() < ON).then(|| Side::ALL[nearest])
    }

    /// Bytes in memory, about.
    pub fn bytes(&self) -> usize {
        24 * self.points.len() + 12 * self.edges.len() + 80
    }
}
