//! Cut and fill: how the ground meets the streets.

use crate::network::{Street, StreetId};
use crate::space::{Bounds, Measured};
use crate::surface::head::{Head, heads};
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

/// A street counts as straight, in plan and in height, while it stays this near to a straight line, in metres; but over this many
/// steps at most.
const TOLERANCE: f64 = 0.04;
const MOST_STEPS: usize = 8;

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
    start: DVec2,
    /// From the start to the end.
    by: DVec2,
    /// One over the square of the length.
    per: f64,
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
        let streets: Vec<(&Street, &Profile)> = streets.into_iter().collect();
        let heads = heads(streets.iter().map(|(street, _)| *street));
        for (street, profile) in streets {
            out.add(street, profile, bounds);
            for (end, along) in [(street.from, 0.0), (street.to, profile.length())] {
                if let Some(head) = heads.get(&end) {
                    out.add_head(head, street, profile.height(along), bounds);
                }
            }
        }
        out
    }

    fn add_head(&mut self, head: &Head, street: &Street, height: f64, bounds: Bounds) {
        let half = head.radius(CrossSection::of(street.class).outer);
        let near = Bounds::of([head.at]).grown(BANK_REACH + half);
        if near.overlaps(bounds) {
            let heights = [height + KERB_HEIGHT; 2];
            let (by, per) = (DVec2::ZERO, 0.0);
            self.keep(Stretch { street: street.id, start: head.at, by, per, heights, half, cut_only: false }, near);
        }
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
        let points: Vec<DVec2> = (0..=count).map(|i| measured.point_at(along(i))).collect();
        let heights: Vec<f64> = (0..=count).map(|i| profile.height(along(i))).collect();
        let on_deck = |i: usize| {
            let middle = (along(i) + along(i + 1)) / 2.0;
            street.bridge && middle > deck && middle < length - deck
        };
        let is_straight = |i: usize, k: usize| {
            (i + 1..k).all(|m| {
                let t = (m - i) as f64 / (k - i) as f64;
                let height = heights[i] + (heights[k] - heights[i]) * t;
                on_deck(m) == on_deck(i)
                    && points[m].distance(points[i].lerp(points[k], t)) < TOLERANCE
                    && (heights[m] - height).abs() < TOLERANCE
            })
        };
        let mut i = 0;
        while i < count {
            let mut k = i + 1;
            while k < count && k - i < MOST_STEPS && is_straight(i, k + 1) {
                k += 1;
            }
            let near = Bounds::of([origin + points[i], origin + points[k]]).grown(reach);
            if near.overlaps(bounds) {
                let cut_only = on_deck(i);
                let lift = if cut_only { -UNDER_DECK } else { raise };
                let by = points[k] - points[i];
                let stretch = Stretch {
                    street: street.id,
                    start: origin + points[i],
                    by,
                    per: 1.0 / by.length_squared().max(1e-12),
                    heights: [i, k].map(|m| heights[m] + lift),
                    half: section.outer,
                    cut_only,
                };
                self.keep(stretch, near);
            }
            i = k;
        }
    }

    /// Keeps a stretch in the buckets that its influence, `near`, comes into.
    fn keep(&mut self, stretch: Stretch, near: Bounds) {
        let index = self.stretches.len() as u32;
        self.stretches.push(stretch);
        let low = self.bucket(near.min).max(IVec2::ZERO);
        let high = self.bucket(near.max).min(IVec2::new(self.columns, self.rows) - 1);
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                self.buckets[(y * self.columns + x) as usize].push(index);
            }
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
            let from = p - stretch.start;
            let t = (from.dot(stretch.by) * stretch.per).clamp(0.0, 1.0);
            let (squared, farthest) = ((from - stretch.by * t).length_squared(), BANK_REACH + stretch.half);
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
