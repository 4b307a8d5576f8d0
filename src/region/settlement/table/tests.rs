use super::*;
use proptest::prelude::*;

fn read(text: &str) -> Result<SettlementTable, FileError> {
    SettlementTable::from_csv("s.csv", text.as_bytes(), &SettlementSettings::default(), None)
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
    let read = |text: &str| SettlementTable::from_csv("s", text.as_bytes(), &SettlementSettings::default(), Some(&g));
    let table = read("name,lat,lon,sigma\nCorte,42.30956,9.14917,1\n").unwrap();
    let expected = g.to_plan(DVec2::new(9.14917, 42.30956));
    assert!(table.rows[0].settlement.centre.plan().distance(expected) < 1.0);
    assert_eq!(read("name,x,y,sigma\nCorte,9.14917,42.30956,1").unwrap().rows[0].settlement, table.rows[0].settlement);
    assert!(read("name,x,y,sigma\nCorte,400000,42.3,1").unwrap_err().to_string().contains("-180 to 360"));
    assert!(
        read("name,x,lon,y,sigma\n").unwrap_err().to_string().contains("lon gives the same value as an earlier column")
    );
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
            "s.csv:1:10: \"size\" is not a column; the columns are name x y sigma radius_m population",
        ),
        (change("radius_m", "y"), "s.csv:1:16: y gives the same value as an earlier column"),
        (change("sigma,radius_m", "radius_m"), "s.csv:1:1: the column sigma or population is missing"),
        (change(",5,", ","), "s.csv:3:1: this line has 4 fields; it needs one for each of the 5 columns"),
        (change(",5,", ",5,6,"), "s.csv:3:17: this line has 6 fields"),
        (change(",5,", ",five,"), "s.csv:3:9: x is \"five\"; it must be a number"),
        (change(",5,", ", inf,"), "s.csv:3:10: x is inf; allowed is -10000000000"),
        (change(",7,", ",nan,"), "s.csv:3:11: y is NaN; allowed is"),
        (change(",7,", ",,"), "s.csv:3:11: y is \"\"; it must be a number"),
        (change(",0,150", ",3,150"), "s.csv:3:13: sigma is \"3\"; it must be 0 (village), 1 (town) or 2 (city)"),
        (change("150", "15"), "s.csv:3:15: radius_m is 15; allowed is 120 to 5000"),
        (change("Île d'O", "Aix"), "s.csv:3:1: line 2 has the same name"),
        (change("5,7", "0.2,0"), "s.csv:3:9: line 2 has the same position"),
        (change("Île d'O", ""), "s.csv:3:1: name is \"\"; it must"),
        (change("Île d'O", "\"a\nb\""), "s.csv:3:1: name is \"a\\nb\"; it must"),
        (change("Île d'O", "\"Île d'O"), "s.csv:3:1: the quote that opens here is never closed"),
    ] {
        assert!(found.starts_with(expected), "{found}\n{expected}");
        assert!(!found.contains('\n') && found.len() < 160, "{found}");
    }
    let last = read("name,sigma,x,y\nAix,0,0,\nIle,0,1,1").unwrap_err().to_string();
    assert!(last.starts_with("s.csv:2:9: y is \"\""), "{last}");
    let latin = SettlementTable::from_csv("s.csv", b"name,x,y,sigma\n\xcele,0,0,1", &Default::default(), None);
    assert_eq!(latin.unwrap_err().to_string(), "s.csv:2:1: this is not UTF-8; save the file as UTF-8");
}

#[test]
fn inhabitants_make_size_classes() {
    let file = "name,x,y,population\nA,0,0,1999\nB,9,0,2000\nC,0,9,19999.5\nD,9,9,20000\n";
    let sizes = |table: SettlementTable| table.rows.iter().map(|r| r.settlement.size as u8).collect::<Vec<_>>();
    assert_eq!(sizes(read(file).unwrap()), [0, 1, 1, 2]);
    let few = Populations { town: 0.0, city: 2_000.0 };
    let by = SettlementTable::from_csv_by("s.csv", file.as_bytes(), &Default::default(), None, &few);
    assert_eq!(sizes(by.unwrap()), [1, 2, 2, 2]);
    let change = |from: &str, to: &str| read(&file.replacen(from, to, 1)).unwrap_err().to_string();
    for (found, expected) in [
        (change("2000\n", "\n"), "s.csv:3:7: population is \"\"; it must be a number from 0 to 100000000"),
        (change("2000\n", "2 000\n"), "s.csv:3:7: population is \"2 000\"; it must be a number"),
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
fn a_settlement_outside_of_the_domain_is_named() {
    let table = read("name,x,y,sigma\nAix,0,0,2\nIle,900,5,0").unwrap();
    assert_eq!(table.check_inside(Bounds::square(DVec2::ZERO, 1800.0)), Ok(()));
    let error = table.check_inside(Bounds::square(DVec2::ZERO, 1700.0)).unwrap_err().to_string();
    assert_eq!(
        error,
        "s.csv:3:5: \"Ile\" at 900,5 m lies outside of the domain; allowed is x -850 to 850, y -850 to 850"
    );
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = SettlementTable::from_csv("s", &bytes, &SettlementSettings::default(), None);
        let mut file = b"name,x,y,sigma\n".to_vec();
        file.extend(&bytes);
        let _ = SettlementTable::from_csv("s", &file, &SettlementSettings::default(), None);
    }

    #[test]
    fn any_text_of_fields_is_read_or_refused(text in "([a-c0-2\",; \r\n.-]|é){0,80}") {
        if let Ok(table) = read(&format!("name,x,y,sigma\n{text}")) {
            prop_assert!(table.rows.iter().all(|r| r.line > 1 && r.settlement.id.0 != 0));
        }
    }
}
