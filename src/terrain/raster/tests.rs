use super::*;
use crate::layer::RangeError;
use crate::space::{Bounds, Seed, Stream};
use crate::terrain::Terrain;
use glam::DVec2;
use proptest::prelude::*;

const ISLAND: &str = "ncols 4\nnrows 3\nxllcorner 100\nyllcorner -50\ncellsize 10\nNODATA_value -9999\n";

fn read(text: &str) -> Result<Raster, crate::layer::FileError> {
    Raster::from_ascii("f.asc", text.as_bytes(), Band::Height, Holes::Refuse)
}

fn error(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

/// A grid of random heights that are whole eighths, which 32 bits hold, and its file.
fn random(seed: u64) -> (Raster, String) {
    let mut s: Stream = Seed(seed).stream("test", &[]);
    let (columns, rows) = (2 + s.index(9), 2 + s.index(9));
    let step = DVec2::new(s.range(0.5, 300.0).round().max(0.5), s.range(0.5, 300.0).round().max(0.5));
    let corner = DVec2::new(s.signed(), s.signed()) * 1e5;
    let values: Vec<f32> = (0..columns * rows).map(|_| (s.signed() * 8000.0).round() as f32 / 8.0).collect();
    let mut text = format!(
        "NROWS {rows}\ndy {}\nYLLCENTER {}\nncols {columns}\r\nxllcorner {}\ndx {}\n",
        step.y,
        corner.y + step.y / 2.0,
        corner.x,
        step.x
    );
    for row in values.chunks(columns).rev() {
        text += &row.iter().map(|v| format!(" {v}")).collect::<String>();
        text += "\n";
    }
    (Raster::new(columns, rows, corner, step, values).unwrap(), text)
}

#[test]
fn a_written_grid_is_read_back_and_its_surface_passes_through_every_number() {
    for seed in 0..60 {
        let (raster, text) = random(seed);
        let back = read(&text).unwrap();
        assert_eq!(back.values, raster.values);
        assert!(back.corner.distance(raster.corner) < 1e-9 && back.step == raster.step);
        let terrain = RasterTerrain::new(back).unwrap();
        for (column, row) in (0..raster.columns()).flat_map(|c| (0..raster.rows()).map(move |r| (c, r))) {
            let expected = f64::from(raster.value(column, row).unwrap());
            assert!((terrain.height(raster.middle(column, row)) - expected).abs() < 1e-5);
        }
    }
}

#[test]
fn heights_and_slopes_go_on_across_the_lines_of_the_grid() {
    for seed in 0..20 {
        let (raster, _) = random(seed);
        let (step, b) = (raster.step(), raster.bounds());
        let terrain = RasterTerrain::new(raster.clone()).unwrap();
        let mut s = Seed(seed).stream("lines", &[]);
        for _ in 0..100 {
            let inner = DVec2::new(s.unit(), s.unit());
            let line = raster.middle(s.index(raster.columns()), s.index(raster.rows()));
            let e = step * 1e-6;
            for (p, d) in [
                (DVec2::new(line.x, b.min.y + b.size().y * inner.y), DVec2::X * e.x),
                (DVec2::new(b.min.x + b.size().x * inner.x, line.y), DVec2::Y * e.y),
            ] {
                let h = |k: f64| terrain.height(p + d * k);
                assert!((h(1.0) - h(-1.0)).abs() < 0.05, "a step at {p}");
                let (before, after) = ((h(0.0) - h(-1.0)) / 1e-6, (h(1.0) - h(0.0)) / 1e-6);
                assert!((before - after).abs() < 0.1, "a crease at {p}: {before} {after}");
            }
        }
    }
}

#[test]
fn a_slope_stays_a_slope_up_to_the_border_and_is_level_beyond() {
    let plane = |p: DVec2| 3.0 + 0.25 * p.x - 0.5 * p.y;
    let (columns, rows, step) = (7, 5, DVec2::new(16.0, 32.0));
    let empty = Raster::new(columns, rows, DVec2::ZERO, step, vec![0.0; columns * rows]).unwrap();
    let values = (0..columns * rows).map(|i| plane(empty.middle(i % columns, i / columns)) as f32).collect();
    let terrain = RasterTerrain::new(Raster { values, ..empty }).unwrap();
    let b = terrain.bounds();
    assert_eq!(b, Bounds::new(DVec2::ZERO, DVec2::new(112.0, 160.0)));
    let mut s = Seed(3).stream("test", &[]);
    for _ in 0..500 {
        let p = b.min + b.size() * DVec2::new(s.range(-1.0, 2.0), s.range(-1.0, 2.0));
        assert!((terrain.height(p) - plane(p.clamp(b.min, b.max))).abs() < 1e-9, "{p}");
    }
    assert!(terrain.height(DVec2::splat(1e300)).is_finite());
    assert!(terrain.sample(DVec2::NAN).height.is_finite());
}

#[test]
fn water_and_vegetation() {
    let grid = |values: Vec<f32>| Raster::new(4, 2, DVec2::ZERO, DVec2::splat(10.0), values).unwrap();
    let heights = || grid(vec![8.0; 8]);
    let dry = RasterTerrain::new(heights()).unwrap();
    let b = dry.bounds();
    let s = dry.sample(b.centre());
    assert!(s.water_level < s.height - 50.0 && s.vegetation == 0.0);

    let sea = dry.clone().with_sea_level(9.5).unwrap().sample(b.centre());
    assert_eq!((sea.depth(), sea.height), (1.5, 8.0));

    // A river of 3 m in the second column, woods in the west.
    let river = dry.with_water_depth(grid([0.0, 3.0, 0.0, 0.0].repeat(2))).unwrap();
    let river = river.with_vegetation(grid([1.0, 1.0, 0.0, 0.0].repeat(2))).unwrap();
    let at = |x: f64| river.sample(DVec2::new(x, 10.0));
    assert_eq!((at(15.0).height, at(15.0).water_level, at(15.0).vegetation), (5.0, 8.0, 0.0));
    assert_eq!((at(5.0).height, at(5.0).vegetation, at(35.0).vegetation), (8.0, 1.0, 0.0));
    let shores: Vec<i32> = (50..350).filter(|x| at(f64::from(*x) / 10.0).depth() > 0.0).collect();
    assert!((95..105).contains(&shores[0]) && (197..207).contains(&shores[shores.len() - 1]), "{shores:?}");
    for x in 0..400 {
        let (p, s) = (DVec2::new(f64::from(x) / 10.0, 7.0), at(f64::from(x) / 10.0));
        assert_eq!(river.height(p), river.sample(p).height);
        assert!(s.depth() > 0.0 || s.height == 8.0);
    }
    // Under the sea a river is a river up to its mouth only.
    let both = river.with_sea_level(9.0).unwrap().sample(DVec2::new(15.0, 10.0));
    assert_eq!((both.height, both.water_level), (5.0, 9.0));
}

#[test]
fn a_river_that_runs_from_corner_to_corner_is_one() {
    let depths: Vec<f32> = (0..36).map(|i| if i % 6 == i / 6 { 2.0 } else { 0.0 }).collect();
    let grid = |values| Raster::new(6, 6, DVec2::ZERO, DVec2::splat(8.0), values).unwrap();
    let terrain = RasterTerrain::new(grid(vec![5.0; 36])).unwrap().with_water_depth(grid(depths)).unwrap();
    for i in 0..480 {
        assert!(terrain.sample(DVec2::splat(f64::from(i) / 10.0)).depth() > 0.0, "{i}");
    }
    assert_eq!(terrain.sample(DVec2::new(36.0, 12.0)).depth(), 0.0);
}

#[test]
fn rasters_that_do_not_fit_are_refused() {
    let grid = |corner: f64, step: f64, v: f32| {
        Raster::new(2, 2, DVec2::splat(corner), DVec2::splat(step), vec![v; 4]).unwrap()
    };
    let reason = |r: Result<RasterTerrain, RangeError>| r.unwrap_err().to_string();
    assert!(reason(RasterTerrain::new(grid(1.4, 0.001, 1.0))).contains("degrees"));
    assert!(reason(RasterTerrain::new(grid(0.0, 9.0, f32::NAN))).contains("height is NaN"));
    let terrain = RasterTerrain::new(grid(0.0, 9.0, 1.0)).unwrap();
    assert!(reason(terrain.clone().with_water_depth(grid(500.0, 9.0, 1.0))).contains("0,0 to 18,18"));
    assert!(reason(terrain.clone().with_vegetation(grid(0.0, 9.0, 1.5))).contains("allowed is 0 to 1"));
    assert!(terrain.with_sea_level(f64::NAN).is_err());
    assert!(Raster::new(1, 9, DVec2::ZERO, DVec2::ONE, vec![0.0; 9]).is_err());
    assert!(Raster::new(3, 3, DVec2::ZERO, DVec2::ONE, vec![0.0; 8]).is_err());
    assert!(Raster::new(usize::MAX, 3, DVec2::ZERO, DVec2::ONE, vec![]).is_err());
}

#[test]
fn degrees_become_metres_around_the_middle() {
    let raster = Raster::new(20, 10, DVec2::new(1.4, 42.4), DVec2::splat(0.02), vec![900.0; 200]).unwrap();
    let g = raster.geographic().unwrap();
    let plan = raster.clone().projected(&g);
    assert!(plan.bounds().centre().length() < 1e-6);
    assert!(plan.step().x < 0.75 * plan.step().y, "{}", plan.step());
    for (column, row) in [(0, 0), (19, 9), (7, 3)] {
        assert!(plan.middle(column, row).distance(g.to_plan(raster.middle(column, row))) < 1e-6);
    }
    let metres = Raster { corner: DVec2::new(400_000.0, 4_600_000.0), ..raster };
    assert!(metres.geographic().unwrap_err().to_string().contains("latitude"));
}

#[test]
fn legal_files_of_all_kinds_are_read() {
    let rows = " 1 2 3 4\n 5 6 7 8\n 9 10 11 12\n";
    let raster = read(&format!("{ISLAND}{rows}")).unwrap();
    assert_eq!((raster.value(0, 0), raster.value(3, 2), raster.value(4, 0)), (Some(9.0), Some(4.0), None));
    assert_eq!(raster.bounds(), Bounds::new(DVec2::new(100.0, -50.0), DVec2::new(140.0, -20.0)));
    let same = |text: String| assert_eq!(read(&text).unwrap(), raster, "{text}");
    same(format!("{}{}", ISLAND.to_uppercase(), rows.replace('\n', "\r\n\r\n")));
    same(format!("\u{feff}{ISLAND}{}", rows.replace("1 2", "1e0\t+2.0")));
    same(format!("{ISLAND}{}", rows.replace('\n', " ")));
    same(format!("{ISLAND}{}", rows.replace(' ', "\n")));
    same(format!("{ISLAND}{rows}").replace("xllcorner 100", "xllcenter 105").replace("cellsize 10", "dx 10 dy 10"));
    // Without NODATA_value -9999 is missing.
    assert!(
        error(&format!("{ISLAND}{rows}").replace("NODATA_value -9999\n", "").replace(" 7 ", " -9999 "))
            .contains("row 2")
    );
}

#[test]
fn cells_without_a_value_are_known_in_every_spelling() {
    let rows = "1 2 3 4\n5 6 HOLE 8\n9 10 11 12\n";
    let header = |missing: &str| ISLAND.replace("NODATA_value -9999\n", missing);
    let read = |missing: &str, hole: &str| {
        let text = format!("{}{}", header(missing), rows.replace("HOLE", hole));
        Raster::from_ascii("f.asc", text.as_bytes(), Band::Height, Holes::Value(7.0))
    };
    let expected = read("", "7").unwrap();
    assert_eq!(expected.filled(), 0);
    for (missing, hole) in [
        ("", "-9999"),
        ("", "-9999.000"),
        ("NODATA_value -9999\n", "nan"),
        ("nodata -99.5\n", "NaN"),
        ("NoData_Value 1e3\n", "1000"),
        ("NODATA -1\n", "-nan(ind)"),
        ("NODATA_VALUE nan\n", "-1.#IND"),
        ("NODATA_value null\n", "null"),
        ("NODATA_value void\n", "VOID"),
        ("", "-32768"),
        ("NODATA_value -9999\n", "-32767.0"),
    ] {
        let raster = read(missing, hole).unwrap();
        assert_eq!((&raster.values, raster.filled()), (&expected.values, 1), "{missing} {hole}");
        let text = format!("{}{}", header(missing), rows.replace("HOLE", hole));
        let refused = error(&text);
        let cell = "row 2, column 3: this cell and 0 more of 12 cells have no height (this one holds ";
        assert!(refused.contains(cell) && refused.contains(hole), "{refused}");
        // Also as the first cell of all.
        let first =
            format!("{}{}", header(missing), rows.replace("HOLE", "7").replace("1 2 3", &format!("{hole} 2 3")));
        assert!(error(&first).contains("row 1, column 1: this cell"), "{}", error(&first));
    }
    let depths = format!("{ISLAND}{}", rows.replace("HOLE", "-32768"));
    let depths = Raster::from_ascii("f.asc", depths.as_bytes(), Band::Depth, Holes::Value(0.0));
    assert!(depths.unwrap_err().reason.contains("water depth is -32768"), "a void is a mark among heights alone");
}

#[test]
fn errors_say_where_and_what() {
    let rows = "1 2 3 4\n5 6 7 8\n9 10 11 12\n";
    let file = format!("{ISLAND}{rows}");
    let change = |from: &str, to: &str| error(&file.replacen(from, to, 1));
    for (found, expected) in [
        (error(""), "f.asc:1:1: the header ends without ncols"),
        (change("nrows", "rows"), "f.asc:2:1: \"rows\" is neither a number nor a key; the keys are ncols nrows "),
        (change("ncols 4", "ncols"), "f.asc:2:1: ncols needs a number, not \"nrows\""),
        (change("ncols 4\n", ""), "f.asc:6:1: the header ends without ncols"),
        (change("ncols 4", "ncols 4.5"), "f.asc:1:1: ncols is 4.5; it must be a whole number"),
        (change("ncols 4", "ncols -4"), "f.asc:1:1: ncols is -4; it must"),
        (
            change("nrows 3", "nrows 99999999"),
            "f.asc:2:1: size of the raster is 4 x 99999999 cells; allowed is at least 2 x 2 cells, and at most 67108864",
        ),
        (change("cellsize 10", "cellsize 0"), "f.asc:5:1: cellsize is 0; allowed is 0.000001 to 1000000"),
        (change("cellsize 10", "cellsize nan"), "f.asc:5:1: cellsize is NaN"),
        (change("cellsize 10", "dx 10"), "f.asc:7:1: the header ends without dy"),
        (change("cellsize 10", "cellsize 10 dy 10"), "f.asc:5:13: dy is given in addition to cellsize"),
        (change("cellsize", "nrows 3 cellsize"), "f.asc:5:1: nrows is given twice"),
        (change("yllcorner -50\n", ""), "f.asc:6:1: the header ends without yllcorner or yllcenter"),
        (change("xllcorner 100", "xllcorner inf"), "f.asc:3:1: xllcorner is inf; allowed is -10000000000"),
        (change(" 7 ", " "), "f.asc:8:1: row 2 has 3 numbers; ncols is 4"),
        (change(" 8", " 8 8"), "f.asc:8:1: row 2 has 5 numbers; ncols is 4"),
        (change(" 7 ", " abc "), "f.asc:8:5: row 2, column 3: \"abc\" is not a number"),
        (
            change(" 7 ", " 7,5 "),
            "f.asc:8:5: row 2, column 3: \"7,5\" is not a number; the file needs numbers separated by blanks; write a decimal point",
        ),
        (
            change("1 2", "1,0 2"),
            "f.asc:7:1: row 1, column 1: \"1,0\" is not a number; the file needs numbers separated by blanks; write",
        ),
        (
            change("cellsize 10", "cellsize ,1E+03"),
            "f.asc:5:10: cellsize needs a number, not \",1E+03\"; write a decimal point",
        ),
        (change(" 7 ", " 1e999 "), "f.asc:8:5: row 2, column 3: height is inf;"),
        (
            change(" 7 ", " -9999 "),
            "f.asc:8:5: row 2, column 3: this cell and 0 more of 12 cells have no height (this one holds -9999)",
        ),
        (change("9 10 11 12\n", ""), "f.asc:9:1: the file ends after 8 numbers (2 of 3 rows); it needs 12"),
        (change(" 11 12\n", ""), "f.asc:9:1: row 3 has 2 numbers; ncols is 4"),
        (change("11 12\n", "11 12\n1 2 3 4"), "f.asc:10:1: numbers continue after the 3 rows of 4"),
    ] {
        assert!(found.starts_with(expected), "{found}\n{expected}");
        assert!(!found.contains('\n') && found.len() < 200, "{found}");
    }
}

#[test]
fn cells_without_a_number_are_filled_when_asked() {
    let file = format!("{ISLAND}-9999 -9999 3 3\n-9999 -9999 3 3\n-9999 -9999 7 3\n");
    let read = |holes| Raster::from_ascii("f", file.as_bytes(), Band::Height, holes);
    assert!(read(Holes::Refuse).unwrap_err().to_string().contains("this cell and 5 more"));
    assert_eq!(read(Holes::Value(-20.0)).unwrap().value(0, 0), Some(-20.0));
    assert_eq!(read(Holes::Value(-20.0)).unwrap().filled(), 6);
    assert!(read(Holes::Value(f64::NAN)).is_err());
    assert!(read(Holes::Keep).unwrap().value(0, 0).is_some_and(f32::is_nan));
    let filled = read(Holes::FromNeighbours).unwrap();
    assert_eq!((filled.value(1, 2), filled.value(1, 0)), (Some(3.0), Some(5.0)));
    assert!(filled.values.iter().all(|v| (3.0..=7.0).contains(v)), "{filled:?}");
    let none = format!("{ISLAND}{}", "-9999 ".repeat(12));
    for holes in [Holes::FromNeighbours, Holes::Value(0.0)] {
        let error = Raster::from_ascii("f", none.as_bytes(), Band::Height, holes).unwrap_err();
        assert!(error.to_string().contains("no cell of this file"));
    }
    for band in [Band::Depth, Band::Vegetation, Band::Influence] {
        let mask = Raster::from_ascii("f", none.as_bytes(), band, Holes::Value(0.0)).unwrap();
        assert_eq!((mask.filled(), mask.value(0, 0)), (12, Some(0.0)));
    }
}

#[test]
fn tiles_are_joined_where_their_cells_fit() {
    let tile = |x: f64, y: f64, value: f32| {
        Raster::new(3, 3, DVec2::new(x, y), DVec2::splat(10.0), (0..9).map(|i| value + i as f32).collect()).unwrap()
    };
    // Two tiles that share a column, and one north of the first.
    let tiles = [tile(0.0, 0.0, 0.0), tile(20.0, 0.0, 100.0), tile(0.0, 30.0, 200.0)];
    let join = |tiles: &[Raster], holes| Raster::join(tiles, Band::Height, holes);
    let joined = join(&tiles, Holes::Value(-5.0)).unwrap();
    assert_eq!(joined.bounds(), Bounds::new(DVec2::ZERO, DVec2::new(50.0, 60.0)));
    let at = |column, row| joined.value(column, row).unwrap();
    assert_eq!([at(0, 0), at(2, 0), at(3, 0), at(0, 3), at(4, 5)], [0.0, 2.0, 101.0, 200.0, -5.0]);
    assert_eq!(joined.filled(), 6);
    // The shared column is 2, 5, 8 in the first and 100, 103, 106 in the second.
    assert_eq!(joined.disagreement(), Some(Disagreement { cells: 3, most: 98.0 }));
    assert_eq!(join(&[tiles[0].clone(), tiles[0].clone()], Holes::Refuse).unwrap().disagreement(), None);
    assert_eq!(
        join(&tiles, Holes::Refuse).unwrap_err().to_string(),
        "6 of 30 cells have no height in any tile, the first near 35,35; fill them, or say how to fill them (`--fill`)"
    );
    // A hole of one tile is filled by another.
    let mut with_hole = tiles[0].clone();
    with_hole.values[2] = f32::NAN;
    assert_eq!(join(&[with_hole, tiles[1].clone()], Holes::Refuse).unwrap().value(2, 0), Some(100.0));
    let off = tile(25.0, 0.0, 0.0);
    assert!(matches!(join(&[tiles[0].clone(), off], Holes::Refuse), Err(JoinError::Off { tile: 1, .. })));
    let coarse = Raster::new(2, 2, DVec2::ZERO, DVec2::splat(15.0), vec![0.0; 4]).unwrap();
    assert!(matches!(join(&[tiles[0].clone(), coarse], Holes::Refuse), Err(JoinError::Step { tile: 1, .. })));
    assert_eq!(join(&[], Holes::Refuse), Err(JoinError::Empty));
    assert!(matches!(join(&[tiles[0].clone(), tile(1e9, 0.0, 0.0)], Holes::Refuse), Err(JoinError::Range(_))));
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for holes in [Holes::Refuse, Holes::FromNeighbours] {
            let _ = Raster::from_ascii("f", &bytes, Band::Height, holes);
        }
    }

    #[test]
    fn a_file_with_any_change_is_read_or_refused(
        seed in any::<u64>(),
        at in any::<prop::sample::Index>(),
        cut in 0usize..20,
        put in "[ \\n0-9.,eE+naNifxyld-]{0,8}",
    ) {
        let (_, mut text) = random(seed);
        let from = at.index(text.len());
        text.replace_range(from..(from + cut).min(text.len()), &put);
        if let Ok(raster) = Raster::from_ascii("f", text.as_bytes(), Band::Height, Holes::FromNeighbours) {
            prop_assert!(raster.values.iter().all(|v| v.abs() <= 1e5));
        }
    }
}
