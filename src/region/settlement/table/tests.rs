use super::*;
use crate::layer::FileError;
use crate::network::SizeClass;
use crate::region::settlement::settings::SettlementSettings;
use crate::space::{Bounds, Geographic, Origin};
use crate::terrain::{Terrain, TerrainSample};
use glam::DVec2;
use proptest::prelude::*;

fn read_as(text: &str, options: &TableOptions<'_>) -> Result<SettlementTable, FileError> {
    SettlementTable::from_csv("s.csv", text.as_bytes(), &SettlementSettings::default(), options)
}

fn read(text: &str) -> Result<SettlementTable, FileError> {
    read_as(text, &TableOptions::default())
}

/// What tables that mean the same have in common.
fn meaning(table: &SettlementTable) -> Vec<(String, [i64; 2], SizeClass)> {
    table.settlements().map(|s| (s.name.clone(), s.centre.0.to_array(), s.size)).collect()
}

#[test]
fn columns_come_in_any_order_and_classes_have_radii() {
    let table =
        read("sigma, x ,name,radius_m,y\r\n2,10.4,\"Aix, La \"\"Haute\"\"\",,-3.5\r\n\r\n0,-7,Île,150,1e3").unwrap();
    let [city, village] = [0, 1].map(|i| &table.rows[i]);
    assert_eq!(city.settlement.name, "Aix, La \"Haute\"");
    assert_eq!((city.settlement.centre, city.settlement.size), (Origin(glam::I64Vec2::new(10, -3)), SizeClass::City));
    assert_eq!((city.settlement.radius, village.settlement.radius), (1400.0, 150.0));
    assert_eq!((city.line, city.column, village.line, village.column), (2, 3, 4, 3));
    assert_eq!((city.settlement.style.as_str(), village.settlement.style.as_str()), ("grid", "village"));
    // Names alone make ids.
    let other = read("\u{feff}name,x,y,sigma\nÎle,0,0,1\n").unwrap();
    assert_eq!(other.rows[0].settlement.id, village.settlement.id);
    assert_ne!(city.settlement.id, village.settlement.id);
    assert_eq!(table.settlements().count(), 2);
}

#[test]
fn degrees_are_projected() {
    let g = Geographic::around(DVec2::new(9.0, 42.0)).unwrap();
    let read = |text: &str| read_as(text, &TableOptions { projection: Some(&g), ..TableOptions::default() });
    let table = read("name,lat,lon,sigma\nCorte,42.30956,9.14917,1\n").unwrap();
    let expected = g.to_plan(DVec2::new(9.14917, 42.30956));
    assert!(table.rows[0].settlement.centre.plan().distance(expected) < 1.0);
    assert_eq!(read("name,x,y,sigma\nCorte,9.14917,42.30956,1").unwrap().rows[0].settlement, table.rows[0].settlement);
    assert!(read("name,x,y,sigma\nCorte,400000,42.3,1").unwrap_err().to_string().contains("-180 to 360"));
    // As Azgaar's map generator writes them: the coordinates of the picture, and degrees.
    let burgs = "Id,Burg,State,Population,X,Y,Latitude,Longitude\n1,Corte,S,3000,500,500,42.30956,9.14917\n";
    let burgs = read(burgs).unwrap();
    assert_eq!(burgs.rows[0].settlement, table.rows[0].settlement);
    assert_eq!(burgs.report.columns_left_out, ["Id", "State", "X", "Y"]);
    assert_eq!(burgs.report.columns, ["Burg", "Population", "Latitude", "Longitude"]);
    let mixed = read("name,x,lat,sigma\nA,1,1,1\n").unwrap_err().to_string();
    assert_eq!(mixed, "s.csv:1:8: x and lat are no pair of coordinates");
}

#[test]
fn errors_say_where_and_what() {
    let file = "name,x,y,sigma,radius_m\nAix,0,0,2,\nÎle d'O,5,7,0,150\n";
    let change = |from: &str, to: &str| read(&file.replacen(from, to, 1)).unwrap_err().to_string();
    for (found, expected) in [
        (read("").unwrap_err().to_string(), "s.csv:1:1: the file is empty"),
        (read("name,x,y,sigma\n\n").unwrap_err().to_string(), "s.csv:3:1: the file has column names but no settlement"),
        (
            change("sigma", "size"),
            "s.csv:1:1: no column is called sigma or population; the columns are \"name\" \"x\" \"y\" \"size\" \"radius_m\"",
        ),
        (change("radius_m", "y"), "s.csv:1:16: there are two columns y; keep one of them"),
        (
            change("x,y", "lon,lat"),
            "s.csv:1:1: no column is called x, easting, east; there are degrees: for these the ground",
        ),
        (change("y,", "z,"), "s.csv:1:1: no column is called y, northing, north; the columns are "),
        (change("sigma,radius_m", "radius_m"), "s.csv:1:1: no column is called sigma or population"),
        (change(",5,", ","), "s.csv:3:1: this line has 4 fields; it needs one for each of the 5 columns"),
        (change(",5,", ",5,6,"), "s.csv:3:17: this line has 6 fields"),
        (change(",5,", ",five,"), "s.csv:3:9: x is \"five\"; it must be a number"),
        (change(",5,", ", inf,"), "s.csv:3:10: x is inf; allowed is -10000000000"),
        (change(",7,", ",nan,"), "s.csv:3:11: y is NaN; allowed is"),
        (
            change(",7,", ",,"),
            "s.csv:3:11: y of \"Île d'O\" is empty; fill it in, or leave such rows out (`--skip-bad`)",
        ),
        (change(",0,150", ",3,150"), "s.csv:3:13: sigma is \"3\"; it must be 0 (village), 1 (town) or 2 (city)"),
        (change("150", "15"), "s.csv:3:15: radius_m is 15; allowed is 120 to 5000"),
        (change("5,7", "0.2,0"), "s.csv:3:9: line 2 has the same position"),
        (change("Île d'O", ""), "s.csv:3:1: name is \"\"; it must"),
        (change("Île d'O", "\"a\nb\""), "s.csv:3:1: name is \"a\\nb\"; it must"),
        (change("Île d'O", "\"Île d'O"), "s.csv:3:1: the quote that opens here is never closed"),
    ] {
        assert!(found.starts_with(expected), "{found}\n{expected}");
        assert!(!found.contains('\n') && found.len() < 200, "{found}");
    }
    let last = read("name,sigma,x,y\nAix,0,0,\nIle,0,1,1").unwrap_err().to_string();
    assert!(last.starts_with("s.csv:2:9: y of \"Aix\" is empty"), "{last}");
    let latin = b"name,x,y,sigma\n\xcele,0,0,1";
    let latin = SettlementTable::from_csv("s.csv", latin, &Default::default(), &TableOptions::default());
    let expected = "s.csv:2:1: byte 0xce is not UTF-8; the file seems to be Latin-1 (Windows-1252): save it as UTF-8";
    assert_eq!(latin.unwrap_err().to_string(), expected);
}

#[test]
fn inhabitants_make_size_classes() {
    let file = "name,x,y,population\nA,0,0,1999\nB,9,0,2000\nC,0,9,19999.5\nD,9,9,20000\n";
    let sizes = |table: SettlementTable| table.rows.iter().map(|r| r.settlement.size as u8).collect::<Vec<_>>();
    assert_eq!(sizes(read(file).unwrap()), [0, 1, 1, 2]);
    let few = Populations { town: 0.0, city: 2_000.0 };
    let by = read_as(file, &TableOptions { populations: few, ..TableOptions::default() });
    assert_eq!(sizes(by.unwrap()), [1, 2, 2, 2]);
    assert_eq!(sizes(read(&file.replace("19999.5", "\"19,999\"")).unwrap()), [0, 1, 1, 2]);
    let change = |from: &str, to: &str| read(&file.replacen(from, to, 1)).unwrap_err().to_string();
    for (found, expected) in [
        (change("2000\n", "\n"), "s.csv:3:7: population of \"B\" is empty; fill it in, or leave such rows out"),
        (change("2000\n", "many\n"), "s.csv:3:7: population is \"many\"; it must be a number from 0 to 100000000"),
        (
            change("2000\n", "2.000\n"),
            "s.csv:3:7: population is \"2.000\"; it must be a number from 0 to 100000000; a point",
        ),
        (
            change("9,9,", "\"9,5\",9,"),
            "s.csv:5:3: x is \"9,5\"; it must be a number from -10000000000 to 10000000000, with",
        ),
        (change("2000\n", "-1\n"), "s.csv:3:7: population is -1; allowed is 0 to 100000000"),
        (change("2000\n", "nan\n"), "s.csv:3:7: population is NaN"),
        (change("x", "sigma"), "s.csv:1:14: population is given in addition to sigma; give only one of them"),
    ] {
        assert!(found.starts_with(expected), "{found}\n{expected}");
    }
}

#[test]
fn many_rows_keep_their_lines_and_take_no_time() {
    let rows: String = (0..20_000).map(|i| format!("n{i},{i},0,0\n")).collect();
    let table = read(&format!("name,x,y,sigma\n{rows}")).unwrap();
    assert!(table.rows.iter().enumerate().all(|(i, r)| r.line == i + 2 && r.column == 3 + i.to_string().len()));
}

#[test]
fn tables_come_with_any_separator_further_columns_and_empty_rows() {
    let plain = read("name,x,y,population\nA,500,500,10\nB,1500,1500,3000\n").unwrap();
    for text in [
        "name;x;y;population\nA;500;500;10\nB;1500;1500;3000\n",
        "name\tx\ty\tpopulation\r\nA\t500\t500\t10\r\nB\t1500\t1500\t3000",
        "sep=;\nname;x;y;population\nA;500;500;10\nB;1500;1500;\"3,000\"\n",
        "\u{feff}name,x,y,population\n\nA,500,500,10,,\n,,,\n  \nB,1500,1500,3 000\n,,,\n",
        "id,City, Pop ,Easting,Northing,note\n1,A,10,500,500,\"a, b\"\n2,B,3'000,1500,1500,\n",
        "name , x,y,population \nA ,500 , 500,10\t\nB,1500,1500,3000  \n",
    ] {
        let table = read(text).unwrap();
        assert_eq!(meaning(&table), meaning(&plain), "{text}");
        let of = |name: &str| table.settlements().find(|s| s.name == name).map(|s| s.id);
        assert_eq!(of("B"), Some(plain.rows[1].settlement.id));
    }
    let report = read("id,name,x,y,sigma\n,,,,\n1,A,0,0,0\n").unwrap().report;
    assert_eq!((report.columns_left_out, report.empty_rows), (vec!["id".to_owned()], 1));
    // The line and column of an error count what was skipped.
    let wrong = read("sep=;\nname;x;y;sigma\n\n;;;\nA;0;\"1\n\";7\n").unwrap_err().to_string();
    assert_eq!(wrong, "s.csv:6:3: sigma is \"7\"; it must be 0 (village), 1 (town) or 2 (city)");
}

#[test]
fn settlements_of_one_name_are_told_apart_wherever_their_rows_stand() {
    let rows = ["Newton,500,500,0", "Newton,1500,1500,1", "Aix,9,9,0"];
    let ids = |order: [usize; 3]| {
        let table = read(&format!("name,x,y,sigma\n{}", order.map(|i| rows[i]).join("\n"))).unwrap();
        assert_eq!(table.report.repeated_names, 1);
        let mut ids: Vec<_> = table.settlements().map(|s| (s.size, s.centre.0.x, s.id)).collect();
        ids.sort();
        ids
    };
    let first = ids([0, 1, 2]);
    assert_eq!((&first, &first), (&ids([2, 1, 0]), &ids([1, 2, 0])));
    assert_ne!(first[1].2, first[2].2);
    let alone = read("name,x,y,sigma\nAix,0,0,1").unwrap();
    assert!(first.iter().any(|(_, _, id)| *id == alone.rows[0].settlement.id), "others keep the ids of their names");
    let same = read("name,x,y,sigma\nNewton,5,5,0\nNewton,5,5,1").unwrap_err().to_string();
    assert_eq!(same, "s.csv:3:8: line 2 has the same position; each position may occur once");
}

#[test]
fn bad_rows_are_left_out_and_named_when_asked() {
    let text = "name,x,y,population\nA,0,0,10\nB,1,1,\nC,two,2,10\nA,0,0,5\nD,3,3,10\n";
    let table = read_as(text, &TableOptions { skip_bad: true, ..TableOptions::default() }).unwrap();
    assert_eq!(table.settlements().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["A", "D"]);
    let left_out: Vec<(usize, usize)> = table.report.rows_left_out.iter().map(|e| (e.line, e.column)).collect();
    assert_eq!(left_out, [(3, 7), (4, 3), (5, 3)]);
    let none = read_as("name,x,y,sigma\nA,0,0,9", &TableOptions { skip_bad: true, ..TableOptions::default() });
    assert_eq!(
        none.unwrap_err().to_string(),
        "s.csv:2:8: every row is left out; line 2: sigma is \"9\"; it must be 0 (village), 1 (town) or 2 (city)"
    );
}

/// Land in the west of x = 1000, water in the east.
struct Coast;

impl Terrain for Coast {
    fn sample(&self, p: DVec2) -> TerrainSample {
        TerrainSample { height: (1000.0 - p.x) / 10.0, water_level: 0.0, vegetation: 0.0 }
    }
}

#[test]
fn settlements_that_cannot_stand_where_they_are_are_named_together() {
    let text = "name,x,y,sigma\nAix,0,0,2\nIle,1300,5,0\nDeep,1900,0,0\nFar,5000,0,1";
    let domain = Bounds::square(DVec2::ZERO, 4000.0);
    let table = read(text).unwrap();
    assert_eq!(
        table.check_places(domain, &Coast).unwrap_err().to_string(),
        "s.csv:3:5: \"Ile\" at 1300,5 m lies under 30.0 m of water; a settlement needs dry ground; nor can \"Deep\" (line 4), \
         \"Far\" (line 5)"
    );
    assert_eq!(
        table.check_places(Bounds::square(DVec2::ZERO, 400.0), &Coast).unwrap_err().to_string(),
        "s.csv:3:5: \"Ile\" at 1300,5 m lies outside of the domain; allowed is x -200 to 200, y -200 to 200; nor can \
         \"Deep\" (line 4), \"Far\" (line 5)"
    );
    let mut moved = table.clone();
    moved.move_to_land(domain, &Coast, 500.0);
    assert_eq!(moved.report.moved.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["Ile"]);
    let land = moved.rows[1].settlement.centre.plan();
    assert!(Coast.sample(land).depth() <= 0.0 && land.distance(DVec2::new(1300.0, 5.0)) < 1.06 * 300.0 + 4.0, "{land}");
    assert_eq!(moved.rows[2], table.rows[2]);
    moved.leave_out_misplaced(domain, &Coast);
    assert_eq!(moved.settlements().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["Aix", "Ile"]);
    assert_eq!(moved.report.rows_left_out.iter().map(|e| e.line).collect::<Vec<_>>(), [4, 5]);
    assert_eq!(moved.check_places(domain, &Coast), Ok(()));
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let read = |bytes: &[u8]| {
            let options = TableOptions { skip_bad: bytes.len().is_multiple_of(2), ..TableOptions::default() };
            SettlementTable::from_csv("s", bytes, &SettlementSettings::default(), &options)
        };
        let _ = read(&bytes);
        let mut file = b"name,x,y,sigma\n".to_vec();
        file.extend(&bytes);
        let _ = read(&file);
    }

    #[test]
    fn any_text_of_fields_is_read_or_refused(text in "([a-c0-2\",; \r\n.-]|é){0,80}") {
        if let Ok(table) = read(&format!("name,x,y,sigma\n{text}")) {
            prop_assert!(table.rows.iter().all(|r| r.line > 1 && r.settlement.id.0 != 0));
        }
    }
}
