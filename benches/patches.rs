//! Local streets by patches at the size of Teng & Bidarra 2017, Table 2: 4 km2 in 16 main cells of 500 m, the paper's
//! parameters, every bundled patch that is drawn as one; with all tags, with curved, straight, loop and cul-de-sac patches excluded by the style,
//! and with each patch limited to one use; then by area, by number of patches, and beside symbios-tensor.
//!
//! As in the paper, every patch that is laid counts as used: initial ones, elements of patterns, and those of the
//! propagation. Times are of one thread, for filling the cells, without preparing the patches: the best of several rounds.

mod clock;
mod symbios;

use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::{JunctionId, StreetClass};
use bevy_sprawl::patch::{Patch, PatchSet, tag};
use bevy_sprawl::seam::CellPort;
use bevy_sprawl::space::{Seed, quantize};
use bevy_sprawl::streets::{CellBrief, CellFiller, CellStreets, CellToFill, Fillers, StreetOrigin};
use bevy_sprawl::style::{FieldKind, LocalRules, PatchCount, Style};
use bevy_sprawl::town::{CellId, DirectionField};
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Edge of a main cell, in metres.
const EDGE: f64 = 500.0;
/// Distance between ports, in metres, and how much it varies.
const SPACING: f64 = 90.0;
const JITTER: f64 = 12.0;
const SEED: Seed = Seed(2017);
/// What 4 km2 with 98 patches should take at most, in milliseconds: a thousandth of what they took in the paper.
const BAR_MS: f64 = 25.0;

/// A square main cell with its ports.
struct Cell {
    id: CellId,
    border: Vec<DVec2>,
    ports: Vec<CellPort>,
}

/// The cells of a square of `n` by `n`. The two cells at a main street have the same ports on it.
fn cells(n: i64) -> Vec<Cell> {
    let mut out = Vec::new();
    for (x, y) in (0..n).flat_map(|y| (0..n).map(move |x| (x, y))) {
        let corner = |dx: i64, dy: i64| DVec2::new((x + dx) as f64, (y + dy) as f64) * EDGE;
        let border: Vec<DVec2> = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)].into();
        // Each side as the main street that it is a part of: its lower end, and whether it runs east.
        let sides = [((x, y), true), ((x + 1, y), false), ((x, y + 1), true), ((x, y), false)];
        let mut ports = Vec::new();
        for (side, ((sx, sy), east)) in sides.into_iter().enumerate() {
            let key = [sx as u64, sy as u64, u64::from(east)];
            let mut rng = SEED.stream("ports", &key);
            let along = if east { DVec2::X } else { DVec2::Y };
            let inward = if side == 0 || side == 3 { along.perp() } else { -along.perp() };
            let inward = if east { inward } else { -inward };
            let count = (EDGE / SPACING) as usize;
            for i in 0..count {
                let place = EDGE * (i as f64 + 0.5) / count as f64 + rng.signed() * JITTER;
                let at = quantize(DVec2::new(sx as f64, sy as f64) * EDGE + along * place);
                let junction = JunctionId::of(&[key[0], key[1], key[2], i as u64]);
                ports.push(CellPort { junction, at, inward, class: StreetClass::Local });
            }
        }
        out.push(Cell { id: CellId((y * n + x) as u64), border, ports });
    }
    out
}

/// The paper's parameters (section 4.1). It has none for the width of blocks; the least is somewhat more than the clearance.
fn style() -> Style {
    let mut style = Style { name: "teng".into(), ..Style::default() };
    style.main.field = FieldKind::Grid;
    style.local = LocalRules {
        length: 50.0,
        deviation: 10.0,
        min_length: 20.0,
        degree: (4, 4),
        min_angle_deg: 70.0,
        angle_deviation_deg: 9.0,
        snap_radius: 20.0,
        clearance: 25.0,
        block_width: 30.0,
        ..LocalRules::default()
    };
    style
}

/// Patch sets by name.
type Sets = BTreeMap<String, Arc<PatchSet>>;

/// Main cells with what their briefs need, in one style.
struct Town<'a> {
    cells: &'a [Cell],
    style: &'a Style,
    field: DirectionField,
    half: [Option<f64>; 4],
}

impl<'a> Town<'a> {
    fn new(cells: &'a [Cell], style: &'a Style) -> Self {
        Self { cells, style, field: DirectionField::uniform(0.0), half: [Some(StreetClass::Main.half_width()); 4] }
    }

    fn briefs(&self) -> impl Iterator<Item = CellBrief<'_>> {
        self.cells.iter().map(|cell| CellBrief {
            seed: SEED,
            id: cell.id,
            border: &cell.border,
            street_half_width: &self.half,
            ports: &cell.ports,
            field: &self.field,
            field_kind: self.style.main.field,
            rules: &self.style.local,
        })
    }

    /// What fills the cells, prepared as in a world: the style's tags and counts choose among the patches of all sets.
    fn prepared(&self, sets: &Sets) -> Vec<Arc<dyn CellFiller>> {
        let style = Style { patch_sets: sets.keys().cloned().collect(), ..self.style.clone() };
        let shared = Arc::new(style.clone());
        let styles = [(shared.clone(), 1.0)];
        let to_fill = |brief| CellToFill { brief, style: &style, styles: &styles, pinned: Vec::new() };
        let fillers = Fillers::new(&BTreeMap::from([(style.name.clone(), shared)]), sets);
        let town = fillers.prepare(&[&style], self.briefs().map(to_fill).collect()).expect("nothing is cancelled");
        assert_eq!(town.short_counts, [], "nothing is asked for at least");
        town.fillers
    }

    /// The best time in milliseconds, and the streets.
    fn timed(&self, sets: &Sets, rounds: usize) -> (f64, Vec<CellStreets>) {
        let fillers = self.prepared(sets);
        let mut best = f64::INFINITY;
        let mut out = Vec::new();
        for _ in 0..rounds {
            let fill = || -> Vec<CellStreets> {
                let cells = self.briefs().zip(&fillers);
                cells.map(|(brief, filler)| filler.fill(&brief, &Cancel::new()).expect("nobody cancels")).collect()
            };
            let (time, streets) = clock::timed(fill);
            best = best.min(time.as_secs_f64() * 1000.0);
            out = streets;
        }
        (best, out)
    }
}

/// Figures of filled cells.
struct Figures {
    /// How often each patch was laid, by `set/patch`.
    laid: BTreeMap<Arc<str>, u32>,
    /// Share of the length of local streets that patches made.
    share: f64,
    km: f64,
}

impl Figures {
    fn of(out: &[CellStreets]) -> Self {
        let mut f = Self { laid: BTreeMap::new(), share: 0.0, km: 0.0 };
        for cell in out {
            assert!(cell.unmet.is_empty(), "a port is not met");
            for (patch, uses) in &cell.laid {
                *f.laid.entry(patch.clone()).or_insert(0) += uses;
            }
            for s in &cell.streets {
                let length = s.street.length() / 1000.0;
                f.km += length;
                if let StreetOrigin::Piece(patch) = &s.made_by.origin {
                    f.share += length;
                    assert!(f.laid.contains_key(patch), "a street of {patch}, which was not laid");
                }
            }
        }
        f.share /= f.km.max(1e-9);
        f
    }

    /// Number of patches that were laid.
    fn used(&self) -> u32 {
        self.laid.values().sum()
    }

    /// Number of these with a tag.
    fn used_with(&self, sets: &Sets, tag: &str) -> u32 {
        let patch = |name: &str| -> Option<&Patch> {
            let (set, patch) = name.split_once('/')?;
            sets.get(set)?.patches.iter().find(|p| p.name == patch)
        };
        let is = |name: &str| patch(name).expect("a patch of the sets").tags.contains(tag);
        self.laid.iter().filter(|(name, _)| is(name)).map(|(_, uses)| uses).sum()
    }
}

/// The bundled sets, without those of windows for the filler `PatchCity`.
fn bundled() -> Sets {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/patches");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).expect("the bundled sets").map(|e| e.expect("an entry").path()).collect();
    files.sort();
    let read = |file: &std::path::PathBuf| {
        let text = std::fs::read_to_string(file).expect("a bundled set");
        PatchSet::from_ron(&file.to_string_lossy(), &text).expect("a bundled set is sound")
    };
    let is_drawn = |set: &PatchSet| set.patches.iter().all(|p| p.window.is_none());
    files.iter().map(read).filter(is_drawn).map(|set| (set.name.clone(), Arc::new(set))).collect()
}

fn patches(sets: &Sets) -> impl Iterator<Item = &Patch> {
    sets.values().flat_map(|set| &set.patches)
}

/// Number of patches that a style may use.
fn available(sets: &Sets, style: &Style) -> usize {
    patches(sets).filter(|p| p.is_allowed(&style.allow, &style.exclude)).count()
}

/// The sets with a tag for all patches but `count` of them, each so-manieth, so that each set is drawn from alike.
fn with_rest(sets: &Sets, count: usize, rest: &str) -> Sets {
    let all = patches(sets).count();
    let kept: BTreeSet<usize> = (0..count).map(|i| i * all / count).collect();
    let mut out = sets.clone();
    for (index, patch) in out.values_mut().flat_map(|set| &mut Arc::make_mut(set).patches).enumerate() {
        if !kept.contains(&index) {
            patch.tags.insert(rest.to_owned());
        }
    }
    out
}

fn main() {
    let sets = bundled();
    table_2(&sets);
    let (all, style) = (patches(&sets).count(), style());
    println!("\nkm2        ms  ms/km2  (all {all} patches)");
    for n in [2, 4, 8, 16] {
        let km2 = (n * n) as f64 * EDGE * EDGE / 1e6;
        let (ms, _) = Town::new(&cells(n), &style).timed(&sets, if n < 8 { 5 } else { 2 });
        println!("{km2:>3} {ms:>9.1} {:>7.2}", ms / km2);
    }
    println!("\npatches    ms  used  (4 km2; the bar for the paper's 98 patches is {BAR_MS} ms)");
    let town = cells(4);
    for count in [all / 8, all / 4, all / 2, 98.min(all), all] {
        let style = Style { exclude: vec!["rest".into()], ..style.clone() };
        let sets = with_rest(&sets, count, "rest");
        assert_eq!(available(&sets, &style), count);
        let (ms, out) = Town::new(&town, &style).timed(&sets, 5);
        let f = Figures::of(&out);
        assert_eq!(f.used_with(&sets, "rest"), 0, "patches that the style excludes are used");
        println!("{count:>7} {ms:>5.1} {:>5}", f.used());
    }
    beside_symbios(&sets);
}

/// The paper's table, and its three observations (section 4.3).
fn table_2(sets: &Sets) {
    println!("4 km2, 16 main cells, one thread (Teng & Bidarra 2017, Table 2)");
    println!("without          available  unique  used  share    km      ms");
    let town = cells(4);
    let row = |name: &str, style: &Style| {
        let (ms, out) = Town::new(&town, style).timed(sets, 7);
        let (f, available) = (Figures::of(&out), available(sets, style));
        let (unique, used) = (f.laid.len(), f.used());
        println!("{name:<16} {available:>9}  {unique:>6}  {used:>4}   {:.2}  {:>4.1}  {ms:>6.1}", f.share, f.km);
        // There are always patches that suit fewer places than others.
        assert!(unique < available, "{name}: {unique} of {available} patches are used");
        f
    };
    let plain = row("nothing", &style());
    for left_out in [tag::CURVED, tag::STRAIGHT, tag::LOOP, tag::CUL_DE_SAC] {
        let f = row(left_out, &Style { exclude: vec![left_out.into()], ..style() });
        assert_eq!(f.used_with(sets, left_out), 0, "patches that the style excludes are used");
        let (with, used, all) = (plain.used_with(sets, left_out), f.used(), plain.used());
        assert!(100 * with > all, "{with} of {all} patches are {left_out} where they may be");
        // Fewer kinds of patches make about as many of them.
        assert!(2 * used > all && 2 * used < 3 * all, "without {left_out}: {used} patches, else {all}");
    }
    let once = |p: &Patch| PatchCount { patch: p.name.clone(), at_least: 0, at_most: Some(1), weight: 1.0 };
    let f = row("second uses", &Style { patches: patches(sets).map(once).collect(), ..style() });
    assert!(f.laid.values().all(|uses| *uses == 1), "a patch is used twice");
    assert!(f.laid.len() > plain.laid.len() && f.used() < plain.used(), "fewer uses leave more kinds");
}

/// The streets of one square beside those of one tile of symbios-tensor, which makes blocks and lots too; its spacing makes
/// about as many kilometres. From 16 km2 on a tile takes minutes.
fn beside_symbios(sets: &Sets) {
    let style = style();
    println!("\nkm2   ours ms    km  symbios-tensor ms    km  lots");
    for n in [2, 4] {
        let edge = n as f64 * EDGE;
        let (ours, out) = Town::new(&cells(n), &style).timed(sets, 3);
        let Some(tile) = symbios::tile(SEED.0, edge, (180.0, 60.0), (0, 0), |_, _, _| {}) else { continue };
        let (theirs, km, lots) = (tile.ms, tile.km, tile.lots);
        println!(
            "{:>3} {ours:>9.1} {:>5.1} {theirs:>18.0} {km:>5.1} {lots:>5}",
            edge * edge / 1e6,
            Figures::of(&out).km
        );
    }
}
