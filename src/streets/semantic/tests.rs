//! What streets of patches look like.

use super::prepared::PatchFiller;
use crate::layer::Cancel;
use crate::network::{JunctionId, PlanarGraph, StreetClass};
use crate::patch::{PatchDatabase, PatchSet};
use crate::seam::CellPort;
use crate::space::{Seed, centroid, distance_to_line, line_length, math::angle_between, segments};
use crate::streets::contract::defects;
use crate::streets::filler::{CellFiller, CellStreets, StreetOrigin};
use crate::style::{FieldKind, LocalRules, Style};
use crate::testing::{PortCell, patch_sets, styles};
use glam::DVec2;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A style with its patches.
pub struct Kit {
    pub style: Style,
    pub filler: PatchFiller,
}

impl Kit {
    /// Some of the bundled styles.
    pub fn all() -> Vec<Self> {
        let styles = styles();
        let sets = patch_sets(&styles);
        styles.into_iter().map(|style| Self::new(style, &sets)).collect()
    }

    /// A style with those of these sets that it names.
    pub fn new(style: Style, sets: &BTreeMap<String, Arc<PatchSet>>) -> Self {
        let sets: Vec<&PatchSet> = style.patch_sets.iter().map(|name| &*sets[name]).collect();
        let patches = PatchDatabase::new(&sets, &style.allow, &style.exclude);
        let weights = patches.weights();
        Self { style, filler: PatchFiller::new(Arc::new(patches), weights) }
    }

    /// A cell of this style.
    pub fn cell(&self, seed: u64) -> PortCell<'_> {
        PortCell::new(seed, std::slice::from_ref(&self.style))
    }

    /// Fills a cell.
    pub fn fill(&self, cell: &PortCell<'_>) -> CellStreets {
        self.filler.fill(&cell.brief(), &Cancel::new()).expect("nobody cancelled")
    }
}

/// Turns of streets between their ends, in radians, with how far each street is from straight, in metres.
fn turns(kit: &Kit) -> (Vec<f64>, Vec<f64>) {
    let (mut turns, mut off) = (Vec::new(), Vec::new());
    for seed in 2000..2040 {
        for s in &kit.fill(&kit.cell(seed)).streets {
            let line = &s.street.line;
            let chord = [line[0], line[line.len() - 1]];
            off.push(line.iter().map(|p| distance_to_line(*p, &chord)).fold(0.0, f64::max));
            turns.extend(line.windows(3).map(|w| PI - angle_between(w[0] - w[1], w[2] - w[1])));
        }
    }
    (turns, off)
}

#[test]
fn streets_of_grids_have_no_doglegs_and_those_of_old_towns_no_kinks() {
    for kit in &Kit::all() {
        let (turns, off) = turns(kit);
        if kit.style.main.field == FieldKind::Grid {
            let bent = off.iter().filter(|d| (0.5..16.0).contains(*d)).count();
            assert!(bent * 12 < off.len(), "{bent} of {} streets are nearly straight", off.len());
        } else if kit.style.local.rounding > 0.0 {
            let kinks = turns.iter().filter(|t| **t > 0.7).count();
            assert!(kinks * 12 < off.len(), "{}: {kinks} kinks in {} streets", kit.style.name, off.len());
        }
    }
}

#[test]
fn patches_make_half_of_the_streets() {
    let kits = Kit::all();
    for kit in &kits {
        let (mut patched, mut all, mut from_patches, mut streets) = (0.0, 0.0, 0, 0);
        for seed in 1000..1040 {
            for s in &kit.fill(&kit.cell(seed)).streets {
                let is = matches!(s.made_by.origin, StreetOrigin::Piece(_));
                let length = line_length(&s.street.line);
                all += length;
                patched += if is { length } else { 0.0 };
                from_patches += u32::from(is);
                streets += 1;
            }
        }
        let share = (patched / all, f64::from(from_patches) / f64::from(streets));
        assert!(share.0 > 0.5, "{}: {:.2} of the length is from patches", kit.style.name, share.0);
    }
}

/// The filler with the patches and patterns of such a set.
fn with_set(set: &str) -> PatchFiller {
    let set = PatchSet::from_ron("q.ron", set).unwrap_or_else(|e| panic!("{e}"));
    let patches = PatchDatabase::new(&[&set], &[], &[]);
    let weights = patches.weights();
    PatchFiller::new(Arc::new(patches), weights)
}

fn fill(filler: &PatchFiller, cell: &PortCell<'_>) -> CellStreets {
    let out = filler.fill(&cell.brief(), &Cancel::new()).expect("nobody cancelled");
    assert_eq!(defects(cell, &out), Vec::<String>::new(), "cell {}", cell.seed);
    out
}

#[test]
fn a_patch_that_only_its_main_street_connects_leaves_nothing_loose() {
    let filler = with_set(
        "(patches: [(name: \"two\", vertices: [(0, 0), (0, 70), (70, 0), (70, 70), (70, 140), (140, 70)],
            streets: [(0, 1), [2, 3, 4], (3, 5)], main: [(0, 2)])],
         patterns: [(name: \"row\", element: \"two\", repeat: (1, 3))])",
    );
    let (styles, mut used) = (styles(), 0);
    for seed in 0..60 {
        used += made_of(&fill(&filler, &PortCell::new(seed, &styles)), "two");
    }
    assert!(used > 60, "{used} streets are of the patch");
}

/// Number of streets that a patch of this set made the most of.
fn made_of(out: &CellStreets, patch: &str) -> usize {
    let is = |origin: &StreetOrigin| matches!(origin, StreetOrigin::Piece(name) if **name == *format!("q/{patch}"));
    out.streets.iter().filter(|s| is(&s.made_by.origin)).count()
}

/// What the streets of a cell enclose, as polygons.
fn faces(out: &CellStreets) -> Vec<Vec<DVec2>> {
    let mut graph: PlanarGraph<()> = PlanarGraph::new();
    let mut places = BTreeMap::new();
    for (a, b) in out.streets.iter().flat_map(|s| segments(&s.street.line)) {
        let [a, b] =
            [a, b].map(|p| *places.entry([p.x.to_bits(), p.y.to_bits()]).or_insert_with(|| graph.add_vertex(p)));
        graph.add_edge(a, b, ());
    }
    graph.faces().into_iter().filter(|f| f.area() > 0.0).map(|f| f.polygon).collect()
}

#[test]
fn roundabouts_stay_round_in_every_field() {
    let at = |k: u32, radius: f64| crate::space::math::direction(f64::from(k) * TAU / 12.0) * radius;
    let points = (0..12).map(|k| at(k, 18.0)).chain((0..4).map(|k| at(3 * k, 68.0)));
    let points: Vec<String> = points.map(|p| format!("({:.2}, {:.2})", p.x, p.y)).collect();
    let ring = "[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0], (0, 12), (3, 13), (6, 14), (9, 15)";
    let filler =
        with_set(&format!("(patches: [(name: \"ring\", vertices: [{}], streets: [{ring}])])", points.join(", ")));
    for field in FieldKind::ALL {
        for rounding in [0.0, 20.0] {
            let mut style = styles().remove(0);
            (style.main.field, style.local.rounding, style.local.min_length) = (field, rounding, 24.0);
            let mut rings = 0;
            for seed in 0..60 {
                let out = fill(&filler, &PortCell::new(seed, std::slice::from_ref(&style)));
                for face in faces(&out) {
                    // Blocks are larger.
                    let around = line_length(&face) + face[0].distance(face[face.len() - 1]);
                    if around > 140.0 {
                        continue;
                    }
                    let centre = centroid(&face);
                    let radii: Vec<f64> = face.iter().map(|p| p.distance(centre)).collect();
                    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
                    let off = radii.iter().map(|r| (r - mean).abs()).fold(0.0, f64::max);
                    assert!(off < 0.5 && (15.5..20.5).contains(&mean), "{field:?}, cell {seed}: {off} m off {mean} m");
                    rings += 1;
                }
            }
            assert!(rings > 10, "{field:?}: {rings} rings");
        }
    }
}

#[test]
fn closed_patterns_are_built_and_the_cell_begins_opposite() {
    let mut filler = with_set(
        "(
            patches: [
                (name: \"tooth\", vertices: [(-40, 0), (0, 0), (40, 0), (0, 60)], main: [[0, 1, 2]], streets: [(1, 3)], dead_ends: [3]),
                (name: \"yard\", vertices: [(-40, 0), (0, 0), (40, 0), (0, 50), (45, 60)], main: [[0, 1, 2]], streets: [[1, 3, 4]]),
            ],
            patterns: [(name: \"row\", element: \"tooth\", scale: (0.6, 1.5), repeat: (2, 6))],
        )",
    );
    (filler.start.patterns_along, filler.start.initial_patches) = (1.0, 0.0);
    let styles = styles();
    let (mut rows, mut begun) = (0, 0);
    for seed in 0..60 {
        let out = fill(&filler, &PortCell::new(seed, &styles));
        if made_of(&out, "tooth") > 1 {
            rows += 1;
            begun += usize::from(made_of(&out, "yard") > 0);
        }
    }
    assert!(rows > 15 && 2 * begun > rows, "{rows} rows, {begun} cells begin on the other side");
}

/// A square cell with a port every `step` metres along its four main streets.
fn square(style: &Style, step: f64) -> PortCell<'_> {
    let corners = [(0.0, 0.0), (360.0, 0.0), (360.0, 360.0), (0.0, 360.0)].map(|(x, y)| DVec2::new(x, y));
    let mut cell = PortCell::new(0, std::slice::from_ref(style));
    cell.border = corners.to_vec();
    cell.half = vec![Some(StreetClass::Main.half_width()); 4];
    cell.ports.clear();
    for i in 0..4 {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        let way = (b - a) / 360.0;
        for k in 1..(320.0 / step) as u32 {
            let at = a + way * (f64::from(k) * step);
            let junction = JunctionId::of(&[at.x.to_bits(), at.y.to_bits()]);
            cell.ports.push(CellPort { junction, at, inward: way.perp(), class: StreetClass::Local });
        }
    }
    cell
}

#[test]
fn patches_with_several_roots_begin_cells_and_patterns() {
    let comb = "vertices: [(-60, 0), (0, 0), (60, 0), (-60, 70), (0, 70), (60, 70), (0, 130)], main: [[0, 1, 2]],
        streets: [[0, 3, 4, 5, 2], (1, 4), (4, 6)]";
    let pattern = "(name: \"row\", element: \"comb\", scale: (0.8, 1.2), repeat: (1, 3))";
    let mut style = styles().remove(0);
    style.local = LocalRules { length: 70.0, min_length: 30.0, block_width: 45.0, ..style.local };
    for (patterns, along) in [("", 0.0), (pattern, 1.0)] {
        let mut filler = with_set(&format!("(patches: [(name: \"comb\", {comb})], patterns: [{patterns}])"));
        (filler.start.initial_patches, filler.start.patterns_along) = (1.0 - along, along);
        // Ports at which a comb stands: three for each, and none where they are too far apart.
        let stands = |step: f64| {
            let cell = square(&style, step);
            let out = fill(&filler, &cell);
            let of_comb = out.streets.iter().filter(|s| matches!(s.made_by.origin, StreetOrigin::Piece(_)));
            let ends: Vec<JunctionId> = of_comb.flat_map(|s| [s.street.from, s.street.to]).collect();
            cell.ports.iter().filter(|p| ends.contains(&p.junction)).count()
        };
        assert!(stands(62.0) >= 3, "with patterns: {along}");
        assert!(stands(90.0) < 3, "with patterns: {along}");
    }
}

#[test]
fn patterns_of_any_size_keep_to_the_cell() {
    let styles = styles();
    for seed in 0..60 {
        let mut s = Seed(seed).stream("large patterns", &[]);
        let long = s.range(40.0, 4000.0);
        let (low, high) = (s.range(0.25, 4.0), s.range(0.25, 4.0));
        let scale = format!("({}, {})", low.min(high), low.max(high));
        let (side, depth) = (s.range(15.0, 900.0), s.range(20.0, 900.0));
        let mut filler = with_set(&format!(
            "(
                patches: [
                    (name: \"line\", vertices: [({0}, 0), ({1}, 0)], streets: [(0, 1)]),
                    (name: \"tooth\", vertices: [(-{side}, 0), (0, 0), ({side}, 0), (0, {depth})], main: [[0, 1, 2]], streets: [(1, 3)]),
                ],
                patterns: [
                    (name: \"far\", element: \"line\", scale: {scale}, repeat: (1, 100)),
                    (name: \"row\", element: \"tooth\", scale: {scale}, repeat: (1, 100)),
                ],
            )",
            -long / 2.0,
            long / 2.0
        ));
        (filler.start.patterns_along, filler.start.patterns_between, filler.start.patterns_onwards) = (1.0, 1.0, 1.0);
        fill(&filler, &PortCell::new(seed + 900, &styles));
    }
}
