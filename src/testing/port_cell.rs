//! Cells to test with: polygons of many shapes, with ports that keep the promises of the seam layer, in the bundled styles.

use crate::network::{JunctionId, StreetClass};
use crate::patch::PatchSet;
use crate::seam::{APPROACH_CLEARANCE, APPROACH_LENGTH, CellPort};
use crate::space::{Seed, Stream, math, point_at, point_in_polygon, quantize, segment_crossing, segment_distance};
use crate::streets::CellBrief;
use crate::style::{FieldKind, Style};
use crate::town::{CellId, DirectionField};
use glam::DVec2;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A cell with all that its brief needs.
pub(crate) struct PortCell<'a> {
    pub seed: u64,
    pub border: Vec<DVec2>,
    pub half: Vec<Option<f64>>,
    pub ports: Vec<CellPort>,
    pub field: DirectionField,
    pub style: &'a Style,
}

/// The bundled file of this path below the assets, without its extension.
fn read(path: &str) -> String {
    let file = format!("{}/assets/{path}.ron", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&file).expect("the bundled file is there")
}

/// Some of the bundled styles.
pub(crate) fn styles() -> Vec<Style> {
    let style = |name: &str| Style::from_ron(&format!("{name}.ron"), &read(&format!("styles/{name}"))).expect(name);
    ["grid", "european", "organic", "suburb", "village"].map(style).into()
}

/// All bundled styles, in the order of their names.
pub(crate) fn all_styles() -> Vec<Style> {
    let folder = format!("{}/assets/styles", env!("CARGO_MANIFEST_DIR"));
    let files = crate::layer::ron_files(std::path::Path::new(&folder)).expect("the bundled styles are there");
    let names = files.iter().filter_map(|file| file.file_stem()?.to_str().map(str::to_owned));
    names.map(|name| Style::from_ron(&format!("{name}.ron"), &read(&format!("styles/{name}"))).expect(&name)).collect()
}

/// The patch sets that these styles name.
pub(crate) fn patch_sets(styles: &[Style]) -> BTreeMap<String, Arc<PatchSet>> {
    let set = |name: &String| PatchSet::from_ron(name, &read(&format!("patches/{name}"))).expect(name);
    styles.iter().flat_map(|s| &s.patch_sets).map(|name| (name.clone(), Arc::new(set(name)))).collect()
}

impl<'a> PortCell<'a> {
    pub fn brief(&self) -> CellBrief<'_> {
        CellBrief {
            seed: Seed(self.seed),
            id: CellId(self.seed),
            border: &self.border,
            street_half_width: &self.half,
            ports: &self.ports,
            field: &self.field,
            field_kind: self.style.main.field,
            rules: &self.style.local,
        }
    }

    /// A cell whose shape, style and ports follow from `seed`.
    pub fn new(seed: u64, styles: &'a [Style]) -> Self {
        Self::sized(seed, styles, 1.0)
    }

    /// A cell as of [`new`](Self::new), `times` as large and with ports as far apart.
    pub fn sized(seed: u64, styles: &'a [Style], times: f64) -> Self {
        let mut s = Seed(seed).stream("sample cell", &[]);
        let style = &styles[s.index(styles.len())];
        let field = style.main.field;
        let corners = shape(&mut s, field == FieldKind::Grid, times);
        // A main street bends a little between its ends.
        let bends = if field == FieldKind::Grid { 0.0 } else { 0.06 };
        let mut sides: Vec<(Vec<DVec2>, Option<f64>)> = Vec::new();
        for i in 0..corners.len() {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            let n = (a.distance(b) / 70.0).floor() as usize;
            let off = (b - a).perp() * (s.signed() * bends);
            let bent = |t: f64| quantize(a.lerp(b, t) + off * (4.0 * t * (1.0 - t)));
            let line: Vec<DVec2> = (0..=n.max(1)).map(|k| bent(k as f64 / n.max(1) as f64)).collect();
            let class = if s.chance(0.25) { StreetClass::Arterial } else { StreetClass::Main };
            let half = if s.chance(0.1) { None } else { Some(class.half_width()) };
            sides.push((line, half));
        }
        if s.chance(0.25) {
            add_slit(&mut s, &mut sides);
        }
        let mut border = Vec::new();
        let mut half = Vec::new();
        for (line, h) in &sides {
            border.extend(&line[..line.len() - 1]);
            half.extend(std::iter::repeat_n(*h, line.len() - 1));
        }
        let mut ports: Vec<CellPort> = Vec::new();
        for (k, (line, h)) in sides.iter().enumerate() {
            if h.is_some() {
                add_ports(&mut s, style.seam.spacing, &sides, k, line, &border, &mut ports);
            }
        }
        let field = DirectionField::uniform(heading(&border) + s.signed() * 0.03);
        Self { seed, border, half, ports, field, style }
    }
}

/// Heading of the longest border edge, as towns plan their main streets along the field.
fn heading(border: &[DVec2]) -> f64 {
    let edges = (0..border.len()).map(|i| border[(i + 1) % border.len()] - border[i]);
    let longest = edges.reduce(|a, b| if b.length() > a.length() { b } else { a });
    math::angle_of(longest.unwrap_or_default())
}

/// Corners, counter-clockwise.
fn shape(s: &mut Stream, grid: bool, times: f64) -> Vec<DVec2> {
    let (w, h) = (times * s.range(120.0, 450.0), times * s.range(120.0, 450.0));
    let turn = s.range(0.0, 6.3);
    let wobble_by = if grid { 8.0 } else { 25.0 };
    let mut wobble = |p: (f64, f64)| {
        let p = DVec2::new(p.0 * w + s.signed() * wobble_by, p.1 * h + s.signed() * wobble_by);
        math::rotate(p, turn) + DVec2::new(1234.0, -987.0)
    };
    match if grid { (w * 7.0) as usize % 2 } else { (w * 7.0) as usize % 4 } {
        0 => [(0., 0.), (1., 0.), (1., 1.), (0., 1.)].map(&mut wobble).to_vec(),
        1 => [(0., 0.), (1.2, 0.), (1.2, 0.5), (0.55, 0.55), (0.5, 1.2), (0., 1.2)].map(&mut wobble).to_vec(),
        2 => [(0., 0.), (1.4, 0.1), (0.5, 1.3)].map(&mut wobble).to_vec(),
        _ => [(0.1, 0.), (0.8, -0.1), (1.1, 0.5), (0.7, 1.), (0.2, 1.1), (-0.1, 0.5)].map(&mut wobble).to_vec(),
    }
}

/// A main street from a corner to the middle of the cell, walked on both sides.
fn add_slit(s: &mut Stream, sides: &mut Vec<(Vec<DVec2>, Option<f64>)>) {
    let i = s.index(sides.len());
    let corner = sides[i].0[0];
    let middle = sides.iter().map(|x| x.0[0]).sum::<DVec2>() / sides.len() as f64;
    let n = 3;
    let there: Vec<DVec2> = (0..=n).map(|k| quantize(corner.lerp(middle, k as f64 / f64::from(n)))).collect();
    let back: Vec<DVec2> = there.iter().rev().copied().collect();
    let half = Some(StreetClass::Main.half_width());
    sides.insert(i, (back, half));
    sides.insert(i, (there, half));
}

fn add_ports(
    s: &mut Stream,
    spacing: f64,
    sides: &[(Vec<DVec2>, Option<f64>)],
    own: usize,
    line: &[DVec2],
    border: &[DVec2],
    ports: &mut Vec<CellPort>,
) {
    let length = crate::space::line_length(line);
    let mut along = s.range(38.0, 0.8 * spacing);
    while along < length - 38.0 {
        let (at, heading) = point_at(line, along);
        let (at, inward) = (quantize(at), heading.perp());
        let (from, to) = (at + inward * 0.5, at + inward * APPROACH_LENGTH);
        let clear_of = |other: &[DVec2]| {
            crate::space::segments(other).all(|(a, b)| segment_distance(from, to, a, b) >= APPROACH_CLEARANCE)
        };
        // A side walked back along the same street touches the port; it is not another side.
        let others = sides.iter().enumerate().filter(|(k, x)| *k != own && !x.0.iter().rev().eq(line.iter()));
        let clear = others.into_iter().all(|(_, x)| clear_of(&x.0));
        let crosses = crate::space::segments(line).any(|(a, b)| segment_crossing(from, to, a, b).is_some());
        let apart = ports.iter().all(|p| {
            let far = p.at + p.inward * APPROACH_LENGTH;
            p.at == at || segment_distance(from, to, p.at, far) >= APPROACH_CLEARANCE
        });
        if clear && apart && !crosses && point_in_polygon(to, border) {
            let junction = JunctionId::of(&[at.x.to_bits(), at.y.to_bits()]);
            ports.push(CellPort { junction, at, inward, class: StreetClass::Local });
        }
        along += spacing * s.range(0.8, 1.2);
    }
}
