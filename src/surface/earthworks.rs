//! Cut and fill: how the ground meets the streets.

use crate::network::{Street, StreetId};
use crate::space::{Bounds, Measured, closest_on_segment};
use crate::surface::junction::{deck_reach, has_surface};
use crate::surface::profile::Profile;
use crate::surface::section::{CrossSection, KERB_HEIGHT};
use glam::{DVec2, IVec2};

/// Slope of the banks beside streets, rise over run.
const BANK: f64 = 0.6;

/// Distance from the edge of a street within which it shapes the ground, in metres. In the outer part its influence fades.
pub const BANK_REACH: f64 = 30.0;
const FADE: f64 = 18.0;

/// Least height of a deck's carriageway above the ground below it, in metres.
const UNDER_DECK: f64 = 0.4;

/// Distance between the points at which a profile is looked up, in metres.
const STEP: f64 = 8.0;

/// Edge of a bucket of the index, in metres.
const BUCKET: f64 = 32.0;

/// The ground as streets shape it. At the edge of a street the ground has the street's height; from there, banks of an even slope
/// lead up or down to the natural ground. Under the deck of a bridge the ground is cut, but not filled.
///
/// Heights depend only on streets within [`BANK_REACH`] of a point, and are the same in every local frame whose origin lies a
/// multiple of 32 m away, if the streets come in the same order.
pub struct Earthworks {
    min: DVec2,
    columns: i32,
    rows: i32,
    buckets: Vec<Vec<u32>>,
    stretches: Vec<Stretch>,
}

/// A straight stretch of a street.
struct Stretch {
    street: StreetId,
    ends: [DVec2; 2],
    heights: [f64; 2],
    half: f64,
    cut_only: bool,
}

impl Earthworks {
    /// The works of streets with their profiles, for points in `bounds` (local metres).
    pub fn new<'a>(streets: impl IntoIterator<Item = (&'a Street, &'a Profile)>, bounds: Bounds) -> Self {
        let min = (bounds.min / BUCKET).floor() * BUCKET;
        let size = ((bounds.max - min) / BUCKET).floor().as_ivec2() + 1;
        let buckets = vec![Vec::new(); (size.x.max(1) * size.y.max(1)) as usize];
        let mut out = Self { min, columns: size.x.max(1), rows: size.y.max(1), buckets, stretches: Vec::new() };
        for (street, profile) in streets {
            out.add(street, profile, bounds);
        }
        out
    }

    fn add(&mut self, street: &Street, profile: &Profile, bounds: Bounds) {
        let section = CrossSection::of(street.class);
        let reach = BANK_REACH + section.outer;
        if !has_surface(street) || !street.bounds().grown(reach).overlaps(bounds) {
            return;
        }
        let origin = street.line[0];
        let line: Vec<DVec2> = street.line.iter().map(|p| *p - origin).collect();
        let measured = Measured::new(&line);
        let length = measured.length();
        let count = (length / STEP).ceil().max(1.0) as usize;
        let raise = if section.paved { KERB_HEIGHT } else { 0.0 };
        let deck = deck_reach(street);
        let along = |i: usize| length * i as f64 / count as f64;
        let mut a = origin + measured.point_at(0.0);
        for i in 0..count {
            let b = origin + measured.point_at(along(i + 1));
            let near = Bounds::of([a, b]).grown(reach);
            if near.overlaps(bounds) {
                let middle = (along(i) + along(i + 1)) / 2.0;
                let cut_only = street.bridge && middle > deck && middle < length - deck;
                let lift = if cut_only { -UNDER_DECK } else { raise };
                let heights = [i, i + 1].map(|k| profile.height(along(k)) + lift);
                let index = self.stretches.len() as u32;
                self.stretches.push(Stretch {
                    street: street.id,
                    ends: [a, b],
                    heights,
                    half: section.outer,
                    cut_only,
                });
                let low = self.bucket(near.min).max(IVec2::ZERO);
                let high = self.bucket(near.max).min(IVec2::new(self.columns, self.rows) - 1);
                for y in low.y..=high.y {
                    for x in low.x..=high.x {
                        self.buckets[(y * self.columns + x) as usize].push(index);
                    }
                }
            }
            a = b;
        }
    }

    fn bucket(&self, p: DVec2) -> IVec2 {
        ((p - self.min) / BUCKET).floor().as_ivec2()
    }

    /// Height of the ground at a local point whose natural height is `natural`, both in metres.
    pub fn height(&self, p: DVec2, natural: f64) -> f64 {
        let at = self.bucket(p);
        if at.min_element() < 0 || at.x >= self.columns || at.y >= self.rows {
            return natural;
        }
        let (mut change, mut weights) = (0.0, 0.0);
        // The nearest stretch of the street at hand: its id, and the distance and height there.
        let mut nearest: Option<(StreetId, f64, f64, bool)> = None;
        let mut settle = |(_, distance, height, cut_only): (StreetId, f64, f64, bool)| {
            let bank = BANK * distance;
            let target = natural.min(height + bank);
            let target = if cut_only { target } else { target.max(height - bank) };
            let fade = ((BANK_REACH - distance) / (BANK_REACH - FADE)).clamp(0.0, 1.0);
            let weight = 1.0 / (distance * distance + 0.1);
            change += weight * fade * (target - natural);
            weights += weight;
        };
        for index in &self.buckets[(at.y * self.columns + at.x) as usize] {
            let stretch = &self.stretches[*index as usize];
            let (t, q) = closest_on_segment(p, stretch.ends[0], stretch.ends[1]);
            let (squared, farthest) = (q.distance_squared(p), BANK_REACH + stretch.half);
            if squared >= farthest * farthest {
                continue;
            }
            let distance = (squared.sqrt() - stretch.half).max(0.0);
            let height = stretch.heights[0] + (stretch.heights[1] - stretch.heights[0]) * t;
            let found = (stretch.street, distance, height, stretch.cut_only);
            match &nearest {
                Some(best) if best.0 == stretch.street => {
                    if distance < best.1 {
                        nearest = Some(found);
                    }
                }
                _ => {
                    if let Some(best) = nearest.replace(found) {
                        settle(best);
                    }
                }
            }
        }
        if let Some(best) = nearest {
            settle(best);
        }
        if weights > 0.0 { natural + change / weights } else { natural }
    }
}
