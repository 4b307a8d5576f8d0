//! Tests of what can be known of edits without a world.

use super::*;

fn refused(text: &str) -> String {
    Edits::from_ron("e.ron", text).unwrap_err().to_string()
}

#[test]
fn everything_may_be_left_out_and_is_read_back() {
    assert!(Edits::from_ron("e.ron", "()").unwrap().is_empty());
    let text = r#"(
        settlements: [Pin(at: (1, 2), size: City), Move(from: (0, 0), to: (9, 9)), Ban(at: (0, 0), radius: 5)],
        influences: [(shape: Point((1, 2)), radius: 100, strength: -0.5, classes: [Minor])],
        roads: [Keep(from: (0, 0), to: (1, 1)), Via(from: (0, 0), to: (1, 1), points: [(3, 4)]), Ban(from: (0, 0), to: (1, 1))],
    )"#;
    let edits = Edits::from_ron("e.ron", text).unwrap();
    assert_eq!([edits.settlements.len(), edits.influences.len(), edits.roads.len()], [3, 1, 3]);
    let again = ron::to_string(&edits).unwrap();
    assert_eq!(Edits::from_ron("e.ron", &again).unwrap(), edits);
}

#[test]
fn wrong_edits_are_found_at_their_line_and_column() {
    let cases = [
        ("(\n settlement: [],\n)", "e.ron:2:"),
        ("(\n settlements: [\n  Pin(at: (1, 2), size: Hamlet),\n ],\n)", "e.ron:3:"),
        ("(\n settlements: [\n  Pin(at: (1, 2), size: Town, colour: 3),\n ],\n)", "e.ron:3:"),
        (
            "(\n settlements: [\n  Ban(at: (0, 0), radius: 5),\n  Pin(at: (NaN, 2), size: Town),\n ],\n)",
            "e.ron:4:3: settlements[1]: at.x is NaN; allowed is -1",
        ),
        (
            "(settlements: [Pin(at: (1, 2), size: Town, radius: 50)])",
            "e.ron:1:16: settlements[0]: radius is 50; allowed is 120",
        ),
        (
            "(\n influences: [\n  (shape: Area([(0, 0), (9, 9), (9, 0), (0, 9)]), radius: 100, strength: 1)],\n)",
            "e.ron:3:3: influences[0]: the border of the area crosses itself at 4.5,4.5",
        ),
        ("(influences: [(shape: Curve([(0, 0)]), radius: 100, strength: 1)])", "shape has 1 points; allowed is 2 to"),
        ("(influences: [(shape: Point((0, 0)), radius: 0, strength: 1)])", "radius is 0; allowed is 10 to"),
        ("(influences: [(shape: Point((0, 0)), radius: 99, strength: 1, classes: [Local])])", "allowed are Highway"),
        ("(roads: [Via(from: (0, 0), to: (1, 1), points: [])])", "e.ron:1:10: roads[0]: points has 0 points"),
    ];
    for (text, expected) in cases {
        let error = refused(text);
        assert!(error.contains(expected), "{text}: {error}");
    }
}

#[test]
fn elements_are_found_among_strings_and_comments() {
    let text = r##"#![enable(implicit_some)]
/* roads: [ /* nested */ */
Edits( // roads: [a]
    settlements: [
        Pin(at: (1, 2), size: Town, name: "roads: [\"(", style: r#"],("#),
        /* ( */ Ban(at: (0, 0), radius: 5), // ]
    ],
    roads : [ Keep(from: (0, 0), to: (1, 1)),
        Ban(from: (0, 0), to: (1, 1)), ],
)"##;
    assert_eq!(Edits::from_ron("e.ron", text).map(|e| e.roads.len()), Ok(2));
    let place = |list: EditList, index: usize| {
        let error = RejectedEdit { list, index, reason: String::new() }.in_file("e.ron", text);
        (error.line, error.column)
    };
    assert_eq!([0, 1].map(|i| place(EditList::Settlements, i)), [(5, 9), (6, 17)]);
    assert_eq!([0, 1].map(|i| place(EditList::Roads, i)), [(8, 15), (9, 9)]);
}
