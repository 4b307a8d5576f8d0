//! Local streets by patches at the size of Teng & Bidarra 2017, Table 2: 4 km2 in 16 main cells of 500 m, the paper's
//! parameters, every bundled patch; with all tags and with curved, straight, loop and cul-de-sac patches left out; then by
//! area, by number of patches, and beside symbios-tensor. One thread; the best time of several rounds.

mod symbios;

use bevy_sprawl::layer::Cancel;
use bevy_sprawl::network::{JunctionId, StreetClass};
use bevy_sprawl::patch::{Patch, PatchDatabase, PatchSet, tag};
use bevy_sprawl::seam::CellPort;
use bevy_sprawl::space::{Seed, quantize};
use bevy_sprawl::streets::{CellBrief, CellFiller, CellStreets, PatchFiller, StreetOrigin};
use bevy_sprawl::style::{FieldKind, LocalRules, Style};
use bevy_sprawl::town::{CellId, DirectionField};
use glam::DVec2;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Instant;

/// Edge of a main cell, in metres.
const EDGE: f64 = 500.0;
/// Distance between ports, in metres, and how much it varies.
const SPACING: f64 = 90.0;
const JITTER: f64 = 12.0;
const SEED: Seed = Seed(2017);

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

/// The paper's parameters (section 4.1).
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
        ..LocalRules::default()
    };
    style
}

fn fill(cells: &[Cell], style: &Style, patches: &Arc<PatchDatabase>) -> Vec<CellStreets> {
    let filler = PatchFiller::new(patches.clone(), patches.weights());
    let field = DirectionField::uniform(0.0);
    let half = [Some(StreetClass::Main.half_width()); 4];
    let one = |cell: &Cell| {
        let brief = CellBrief {
            seed: SEED,
            id: cell.id,
            border: &cell.border,
            street_half_width: &half,
            ports: &cell.ports,
            field: &field,
            field_kind: style.main.field,
            rules: &style.local,
        };
        filler.fill(&brief, &Cancel::new()).expect("nobody cancels")
    };
    cells.iter().map(one).collect()
}

/// What it came to: the best time in milliseconds, and the streets.
fn timed(cells: &[Cell], style: &Style, patches: &Arc<PatchDatabase>, rounds: usize) -> (f64, Vec<CellStreets>) {
    let mut best = f64::INFINITY;
    let mut out = Vec::new();
    for _ in 0..rounds {
        let start = Instant::now();
        out = fill(cells, style, patches);
        best = best.min(start.elapsed().as_secs_f64() * 1000.0);
    }
    (best, out)
}

/// Figures of filled cells.
struct Figures {
    /// Patches whose streets are there, cell by cell.
    used: usize,
    /// Different ones among them, over all cells.
    unique: BTreeSet<Arc<str>>,
    /// Share of the length of local streets that patches made.
    share: f64,
    km: f64,
}

fn figures(out: &[CellStreets]) -> Figures {
    let mut f = Figures { used: 0, unique: BTreeSet::new(), share: 0.0, km: 0.0 };
    for cell in out {
        assert!(cell.unmet.is_empty(), "a port is not met");
        let mut here = BTreeSet::new();
        for s in &cell.streets {
            let length = s.street.length() / 1000.0;
            f.km += length;
            if let StreetOrigin::Piece(piece) = &s.made_by.origin {
                f.share += length;
                here.insert(piece.clone());
            }
        }
        f.used += here.len();
        f.unique.extend(here);
    }
    f.share /= f.km.max(1e-9);
    f
}

fn bundled() -> Vec<Arc<Patch>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/patches");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).expect("the bundled sets").map(|e| e.expect("an entry").path()).collect();
    files.sort();
    let read = |file: &std::path::PathBuf| {
        let text = std::fs::read_to_string(file).expect("a bundled set");
        PatchSet::from_ron(&file.to_string_lossy(), &text).expect("a bundled set is sound")
    };
    // Patches of several sets may have the same name.
    let with_set = |set: &str, patch: Patch| Arc::new(Patch { name: format!("{set}/{}", patch.name), ..patch });
    let of = |set: PatchSet| set.patches.into_iter().map(move |patch| with_set(&set.name, patch));
    files.iter().map(read).flat_map(of).collect()
}

fn main() {
    let all = bundled();
    let style = style();
    let town = cells(4);
    println!("4 km2, 16 main cells, one thread (Teng & Bidarra 2017, Table 2)");
    println!("without          available  unique  used  share    km      ms");
    for left_out in [None, Some(tag::CURVED), Some(tag::STRAIGHT), Some(tag::LOOP), Some(tag::CUL_DE_SAC)] {
        let usable = |p: &&Arc<Patch>| left_out.is_none_or(|t| !p.tags.contains(t));
        let patches = Arc::new(PatchDatabase::of(all.iter().filter(usable).cloned().collect()));
        let (ms, out) = timed(&town, &style, &patches, 7);
        let f = figures(&out);
        for p in &f.unique {
            let used = patches.patches.iter().find(|patch| *patch.name == **p).expect("a patch of the database");
            assert!(left_out.is_none_or(|t| !used.tags.contains(t)), "a tag that was left out");
        }
        let name = left_out.unwrap_or("nothing");
        println!(
            "{name:<16} {:>9}  {:>6}  {:>4}   {:.2}  {:>4.1}  {ms:>6.1}",
            patches.patches.len(),
            f.unique.len(),
            f.used,
            f.share,
            f.km
        );
    }
    let patches = Arc::new(PatchDatabase::of(all.clone()));
    println!("\nkm2        ms  ms/km2  (all {} patches)", all.len());
    for n in [2, 4, 8, 16] {
        let km2 = (n * n) as f64 * EDGE * EDGE / 1e6;
        let (ms, _) = timed(&cells(n), &style, &patches, if n < 8 { 5 } else { 2 });
        println!("{km2:>3} {ms:>9.1} {:>7.2}", ms / km2);
    }
    println!("\npatches    ms  (4 km2)");
    // 98 are as many as the paper's.
    for count in [all.len() / 8, all.len() / 4, all.len() / 2, 98.min(all.len()), all.len()] {
        // Every so-manieth, so that each set is drawn from alike.
        let some = (0..count).map(|i| all[i * all.len() / count].clone()).collect();
        let (ms, _) = timed(&town, &style, &Arc::new(PatchDatabase::of(some)), 5);
        println!("{count:>7} {ms:>5.1}");
    }
    beside_symbios(&all);
}

/// The streets of one square beside those of one tile of symbios-tensor, which makes blocks and lots too; its spacing makes
/// about as many kilometres. From 16 km2 on a tile takes minutes.
fn beside_symbios(all: &[Arc<Patch>]) {
    let (style, patches) = (style(), Arc::new(PatchDatabase::of(all.to_vec())));
    println!("\nkm2   ours ms    km  symbios-tensor ms    km  lots");
    for n in [2, 4] {
        let edge = n as f64 * EDGE;
        let (ours, out) = timed(&cells(n), &style, &patches, 3);
        let Some(tile) = symbios::tile(SEED.0, edge, (180.0, 60.0), (0, 0), |_, _, _| {}) else { continue };
        let (theirs, km, lots) = (tile.ms, tile.km, tile.lots);
        println!("{:>3} {ours:>9.1} {:>5.1} {theirs:>18.0} {km:>5.1} {lots:>5}", edge * edge / 1e6, figures(&out).km);
    }
}
