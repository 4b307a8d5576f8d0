//! From the pixels of roads to lines that meet in intersections.

use super::circle::Skeleton;
use super::options::MaskOptions;
use super::picture::{Picture, Pixel};
use crate::layer::FileError;
use crate::map::error::MapError;
use crate::space::math::angle_between;
use crate::space::{DisjointSets, line_length, simplify_line};
use glam::{DVec2, IVec2};
use image::{DynamicImage, GrayImage};
use skeletonize::{MarkingMethod, foreground, thin_image_edges};
use std::collections::{BTreeMap, VecDeque};

/// Distance in pixels from a line up to which its pixels are part of it.
const STRAIGHT: f64 = 1.1;

/// A road between two intersections or ends.
pub(super) struct RoadLine {
    /// Places in pixels, from the north-west corner of the picture.
    pub line: Vec<DVec2>,
    /// Width in pixels.
    pub width: f64,
}

/// What is found of roads.
pub(super) struct RoadLines {
    pub roads: Vec<RoadLine>,
    /// Roads that were too short, and so no roads.
    pub specks: usize,
}

/// Finds the lines of the roads in a picture.
pub(super) fn lines(file: &str, picture: &Picture, options: &MaskOptions) -> Result<RoadLines, MapError> {
    let skeleton = thinned(file, picture)?;
    let mut tracer = Tracer::new(&skeleton, depths(picture), options);
    tracer.trace();
    Ok(tracer.finish())
}

/// The roads thinned to lines of one pixel (Chen and Hsu 1988).
fn thinned(file: &str, picture: &Picture) -> Result<Skeleton, MapError> {
    // The thinning keeps the pixels at the border, so there is a margin without roads around the picture.
    let (width, height) = (picture.width as u32 + 2, picture.height as u32 + 2);
    let grey = |x: u32, y: u32| {
        let is_road = picture.at(i64::from(x) - 1, i64::from(y) - 1) == Pixel::Road;
        image::Luma([if is_road { 255 } else { 0 }])
    };
    let mut image = DynamicImage::ImageLuma8(GrayImage::from_fn(width, height, grey));
    thin_image_edges::<foreground::White>(&mut image, MarkingMethod::Modified, None)
        .map_err(|e| FileError::unreadable(file, format!("its roads cannot be thinned: {e}")))?;
    let grey = image.into_luma8();
    let pixels = (0..picture.height as u32).flat_map(|y| (0..picture.width as u32).map(move |x| (x + 1, y + 1)));
    let pixels = pixels.map(|(x, y)| grey.get_pixel(x, y).0[0] > 0).collect();
    Ok(Skeleton { width: picture.width as i32, height: picture.height as i32, pixels })
}

/// For each pixel how far it lies inside a road, in pixels: about the distance to the nearest pixel without one.
fn depths(picture: &Picture) -> Vec<f32> {
    let (width, height) = (picture.width as i64, picture.height as i64);
    let mut depths: Vec<f32> =
        picture.pixels.iter().map(|p| if *p == Pixel::Road { f32::INFINITY } else { 0.0 }).collect();
    let diagonal = std::f32::consts::SQRT_2;
    let mut pass = |order: &mut dyn Iterator<Item = (i64, i64)>, sign: i64| {
        for (x, y) in order {
            let index =
                |x: i64, y: i64| (x >= 0 && y >= 0 && x < width && y < height).then(|| (y * width + x) as usize);
            let Some(i) = index(x, y) else { continue };
            for (dx, dy, step) in [(-1, 0, 1.0), (0, -1, 1.0), (-1, -1, diagonal), (1, -1, diagonal)] {
                let beside = index(x + sign * dx, y + sign * dy).map_or(0.0, |k| depths[k]);
                depths[i] = depths[i].min(beside + step);
            }
        }
    };
    pass(&mut (0..height).flat_map(|y| (0..width).map(move |x| (x, y))), 1);
    pass(&mut (0..height).rev().flat_map(|y| (0..width).rev().map(move |x| (x, y))), -1);
    depths
}

/// A line of pixels, with the intersections that it leads to.
struct Trace {
    pixels: Vec<IVec2>,
    ends: [Option<usize>; 2],
}

/// Follows thinned roads.
struct Tracer<'a> {
    skeleton: &'a Skeleton,
    depths: Vec<f32>,
    options: &'a MaskOptions,
    /// For each pixel the intersection that it belongs to.
    zone: Vec<Option<usize>>,
    /// Places of the intersections.
    places: Vec<DVec2>,
    traces: Vec<Trace>,
}

impl<'a> Tracer<'a> {
    fn new(skeleton: &'a Skeleton, depths: Vec<f32>, options: &'a MaskOptions) -> Self {
        let zone = vec![None; skeleton.pixels.len()];
        let mut tracer = Self { skeleton, depths, options, zone, places: Vec::new(), traces: Vec::new() };
        tracer.find_intersections();
        tracer
    }

    /// Pixels that hang together and at which the circle tells an intersection are one.
    fn find_intersections(&mut self) {
        let radius = self.options.circle;
        let is_road = |i: &usize| self.skeleton.pixels[*i];
        let counts: BTreeMap<usize, usize> = (0..self.skeleton.pixels.len())
            .filter(is_road)
            .map(|i| (i, self.skeleton.branches(self.skeleton.place(i), radius)))
            .filter(|(_, branches)| *branches > 2)
            .collect();
        for &first in counts.keys() {
            if self.zone[first].is_some() {
                continue;
            }
            let number = self.places.len();
            let mut pixels = vec![first];
            self.zone[first] = Some(number);
            let mut next = 0;
            while let Some(&i) = pixels.get(next) {
                next += 1;
                for q in self.skeleton.neighbours(self.skeleton.place(i)) {
                    let Some(k) = self.skeleton.index(q) else { continue };
                    if counts.contains_key(&k) && self.zone[k].is_none() {
                        self.zone[k] = Some(number);
                        pixels.push(k);
                    }
                }
            }
            // Where roads part, three pixels or more lie beside one.
            let parts = |i: &usize| self.skeleton.neighbours(self.skeleton.place(*i)).count() > 2;
            if pixels.iter().any(parts) {
                pixels.retain(parts);
            }
            let sum: DVec2 = pixels.iter().map(|i| middle(self.skeleton.place(*i))).sum();
            self.places.push(sum / pixels.len() as f64);
        }
    }

    /// Follows every road between intersections.
    fn trace(&mut self) {
        let mut seen = vec![false; self.skeleton.pixels.len()];
        for i in 0..seen.len() {
            if !self.skeleton.pixels[i] || self.zone[i].is_some() || seen[i] {
                continue;
            }
            let mut pixels = vec![i];
            seen[i] = true;
            let mut next = 0;
            while let Some(&k) = pixels.get(next) {
                next += 1;
                for q in self.skeleton.neighbours(self.skeleton.place(k)).filter_map(|q| self.skeleton.index(q)) {
                    if self.zone[q].is_none() && !std::mem::replace(&mut seen[q], true) {
                        pixels.push(q);
                    }
                }
            }
            self.trace_one(&pixels);
        }
        self.join_touching();
    }

    /// Follows the pixels of one road.
    fn trace_one(&mut self, pixels: &[usize]) {
        let contacts = self.contacts(pixels);
        let way = |from: usize, to: usize| self.way(from, |k| k == to, |_| true);
        match contacts[..] {
            [] => {
                // A road by itself, or a ring.
                let Some(a) = self.farthest(pixels[0]) else { return };
                let Some(b) = self.farthest(a) else { return };
                let mut line = way(a, b);
                let inner: Vec<usize> = line.iter().skip(1).rev().skip(1).copied().collect();
                let back = self.way(b, |k| k == a, |k| !inner.contains(&k));
                line.extend(back.into_iter().skip(1));
                self.push(line, [None, None]);
            }
            [(from, zone)] => {
                if let Some(end) = self.farthest(from) {
                    self.push(way(from, end), [Some(zone), None]);
                }
            }
            [(from, first), ref others @ ..] => {
                let ways: Vec<_> = others.iter().map(|(to, zone)| (way(from, *to), *zone)).collect();
                ways.into_iter().for_each(|(line, zone)| self.push(line, [Some(first), Some(zone)]));
            }
        }
    }

    /// Where pixels of a road touch intersections: one pixel for each place.
    fn contacts(&self, pixels: &[usize]) -> Vec<(usize, usize)> {
        let mut out: Vec<(usize, usize)> = Vec::new();
        for &i in pixels {
            let at = self.skeleton.place(i);
            let zones = self.skeleton.neighbours(at).filter_map(|q| self.zone[self.skeleton.index(q)?]);
            for zone in zones {
                let same =
                    |(k, z): &(usize, usize)| *z == zone && (self.skeleton.place(*k) - at).abs().max_element() <= 2;
                if !out.iter().any(same) {
                    out.push((i, zone));
                }
            }
        }
        out
    }

    /// The shortest way over pixels outside of intersections.
    fn way(&self, from: usize, is_end: impl Fn(usize) -> bool, may_pass: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut before: BTreeMap<usize, usize> = BTreeMap::from([(from, from)]);
        let mut queue = VecDeque::from([from]);
        while let Some(i) = queue.pop_front() {
            if is_end(i) && i != from {
                let mut line = vec![i];
                let mut at = i;
                while at != from {
                    at = before.get(&at).copied().unwrap_or(from);
                    line.push(at);
                }
                line.reverse();
                return line;
            }
            for k in self.skeleton.neighbours(self.skeleton.place(i)).filter_map(|q| self.skeleton.index(q)) {
                if self.zone[k].is_none() && may_pass(k) && !before.contains_key(&k) {
                    before.insert(k, i);
                    queue.push_back(k);
                }
            }
        }
        vec![from]
    }

    /// The pixel of the same road that is the farthest from one of its pixels.
    fn farthest(&self, from: usize) -> Option<usize> {
        let last = std::cell::Cell::new(from);
        self.way(
            from,
            |k| {
                last.set(k);
                false
            },
            |_| true,
        );
        Some(last.get())
    }

    fn push(&mut self, line: Vec<usize>, ends: [Option<usize>; 2]) {
        let pixels = line.into_iter().map(|i| self.skeleton.place(i)).collect();
        self.traces.push(Trace { pixels, ends });
    }

    /// Intersections whose pixels touch are joined by a road without pixels of its own.
    fn join_touching(&mut self) {
        let mut pairs = std::collections::BTreeSet::new();
        for (i, zone) in self.zone.iter().enumerate() {
            let Some(zone) = zone else { continue };
            let beside = self.skeleton.neighbours(self.skeleton.place(i));
            let others = beside.filter_map(|q| self.zone[self.skeleton.index(q)?]).filter(|z| z > zone);
            pairs.extend(others.map(|other| (*zone, other)));
        }
        self.traces.extend(pairs.into_iter().map(|(a, b)| Trace { pixels: Vec::new(), ends: [Some(a), Some(b)] }));
    }

    /// Lines in place of pixels; intersections that are near each other become one.
    fn finish(self) -> RoadLines {
        let mut one = DisjointSets::new();
        let length = |t: &Trace| t.pixels.len() as f64;
        for trace in &self.traces {
            if let [Some(a), Some(b)] = trace.ends
                && self.places[a].distance(self.places[b]) < self.options.apart
                && length(trace) < 2.0 * self.options.apart
            {
                one.union(a, b);
            }
        }
        let mut members: BTreeMap<usize, (DVec2, f64)> = BTreeMap::new();
        for (i, at) in self.places.iter().enumerate() {
            let sum = members.entry(one.find(i)).or_default();
            *sum = (sum.0 + *at, sum.1 + 1.0);
        }
        let mut out = RoadLines { roads: Vec::new(), specks: 0 };
        for trace in &self.traces {
            let ends = trace.ends.map(|end| end.map(|zone| one.find(zone)));
            let is_inside = ends[0].is_some() && ends[0] == ends[1] && length(trace) < 2.0 * self.options.apart;
            let place = |end: Option<usize>| Some(members.get(&end?)?).map(|(sum, count)| *sum / *count);
            let width = self.width(trace);
            let mut line: Vec<DVec2> = place(ends[0]).into_iter().collect();
            line.extend(self.bent(trace));
            line.extend(place(ends[1]));
            line.dedup();
            let free = ends.iter().filter(|end| end.is_none()).count();
            // Thinning leaves spurs where a road's end or side is uneven.
            let least = if free > 0 { self.options.circle.max(0.7 * width) } else { 0.0 };
            if is_inside || line.len() < 2 || line_length(&line) <= least {
                out.specks += usize::from(!is_inside);
                continue;
            }
            self.lengthen(&mut line, ends);
            out.roads.push(RoadLine { line, width });
        }
        out
    }

    /// The pixels of a trace as a line of few points, among them the bends that are sharper than the options say.
    fn bent(&self, trace: &Trace) -> Vec<DVec2> {
        let line: Vec<DVec2> = trace.pixels.iter().map(|p| middle(*p)).collect();
        let reach = self.options.circle.round() as usize;
        let most = self.options.turn_deg.to_radians();
        let angle = |i: usize| angle_between(line[i - reach] - line[i], line[i + reach] - line[i]);
        let inner = reach..line.len().saturating_sub(reach);
        let mut cuts = vec![0];
        for i in inner.clone().filter(|i| angle(*i) < most) {
            let around = i.saturating_sub(reach).max(inner.start)..(i + reach).min(inner.end);
            let sharpest = around.min_by(|a, b| angle(*a).total_cmp(&angle(*b)));
            if sharpest == Some(i) {
                cuts.push(i);
            }
        }
        cuts.push(line.len().saturating_sub(1));
        let mut out: Vec<DVec2> = Vec::new();
        for &[from, to] in cuts.array_windows() {
            if let Some(part) = line.get(from..=to) {
                out.extend(simplify_line(part, STRAIGHT));
            }
        }
        out.dedup();
        out
    }

    /// Width of a road in pixels: that in the middle of its sorted widths.
    fn width(&self, trace: &Trace) -> f64 {
        let depth = |p: &IVec2| self.skeleton.index(*p).map_or(0.0, |i| f64::from(self.depths[i]));
        let mut depths: Vec<f64> = trace.pixels.iter().map(depth).collect();
        depths.sort_by(f64::total_cmp);
        depths.get(depths.len() / 2).map_or(1.0, |depth| (2.0 * depth - 1.0).max(1.0))
    }

    /// Thinning shortens roads at their ends by half of their width, also at the border of the picture.
    fn lengthen(&self, line: &mut [DVec2], ends: [Option<usize>; 2]) {
        let n = line.len();
        for (end, inner, is_free) in [(0, 1, ends[0].is_none()), (n - 1, n - 2, ends[1].is_none())] {
            let at = line[end];
            let Some(i) = self.skeleton.index(at.floor().as_ivec2()).filter(|_| is_free) else { continue };
            let onward = (at - line[inner]).normalize_or_zero();
            line[end] = at + onward * (f64::from(self.depths[i]) - 0.5).max(0.0);
        }
    }
}

/// The middle of a pixel.
fn middle(p: IVec2) -> DVec2 {
    p.as_dvec2() + 0.5
}
