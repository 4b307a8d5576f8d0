//! Every command uses a flag that commands share, or refuses it.

use crate::support::{TOWNS, country, json, out, refused, road_mask};
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::OnceLock;

/// The flags that commands share, each with something to give it that cannot be used.
const SHARED: [(&str, &str); 6] = [
    ("--seed", "3"),
    ("--settings", "missing.ron"),
    ("--assets", "missing"),
    ("--edits", "missing.ron"),
    ("--threads", "0"),
    ("--json", ""),
];

/// A way to call the program, with those of the shared flags that it does not use.
type Call = (&'static str, &'static str);

const CALLS: [Call; 17] = [
    ("map --size 400 -o OUT.svg", ""),
    ("stats --size 400", ""),
    ("settlements --size 9000", ""),
    ("digest --chunks 0..1,0..1", ""),
    ("soak --seeds 0..1", "--seed"),
    ("soak --seeds 0..1 --edits-random", "--seed --edits"),
    ("soak --seeds 0..1 --windows", "--seed --edits"),
    ("soak --towns 1", ""),
    ("soak --inputs 1", ""),
    ("seams --km2 1 --most-difference 9 --most-peak 99", ""),
    ("towns --seeds 0..1 --style village --radius 150", "--seed"),
    ("expressive-range --networks 1", "--settings --assets --edits"),
    ("roads --terrain GRID --settlements TABLE -o OUT.svg", "--seed --assets"),
    ("patches draw assets/patches/grid.ron -o OUT.png", "--seed --settings --assets --edits"),
    ("patches check assets/patches/grid.ron", "--seed --settings --assets --edits"),
    ("patches extract MASK --metres-per-pixel 2 -o OUT.ron", "--seed --settings --assets --edits"),
    ("synth MASK --metres-per-pixel 2 --size 400 -o OUT.svg", "--settings --assets --edits"),
];

/// The arguments of a call; its files are those of this test.
fn arguments(call: &str) -> Vec<String> {
    static COUNTRY: OnceLock<[String; 2]> = OnceLock::new();
    let [grid, table] = COUNTRY.get_or_init(|| country("flags", TOWNS));
    let folder = env!("CARGO_TARGET_TMPDIR");
    let file = |word: &str| match word {
        "GRID" => grid.clone(),
        "TABLE" => table.clone(),
        "MASK" => road_mask("flags-mask.png"),
        _ => word.replace("OUT.", &format!("{folder}/flags.")),
    };
    call.split(' ').map(file).collect()
}

fn with(call: &str, more: &[&str]) -> Vec<String> {
    arguments(call).into_iter().chain(more.iter().map(ToString::to_string)).collect()
}

fn words(arguments: &[String]) -> Vec<&str> {
    arguments.iter().map(String::as_str).collect()
}

#[test]
fn every_command_is_called_with_every_shared_flag() {
    // The names at the beginning of the lines of a part of the help.
    let listed = |help: &str, heading: &str| -> BTreeSet<String> {
        let part = help.split(heading).nth(1).expect("the part is there").split("\n\n").next().unwrap_or_default();
        let first = |line: &str| line.split([' ', ',']).find(|word| !word.is_empty()).unwrap_or_default().to_owned();
        part.lines().map(first).filter(|word| !word.is_empty()).collect()
    };
    let help = out(&["--help"]);
    let mut commands = listed(&help, "Commands:");
    commands.remove("help");
    let called: BTreeSet<String> =
        CALLS.iter().map(|(call, _)| call.split(' ').next().unwrap_or_default().into()).collect();
    assert_eq!(called, commands);
    let mut flags = listed(&help, "Options:");
    flags.retain(|flag| flag.starts_with("--"));
    let known: BTreeSet<String> = SHARED.iter().map(|(flag, _)| flag.to_string()).collect();
    assert_eq!(flags, known);
}

#[test]
fn what_a_flag_gives_is_read_or_the_flag_is_refused() {
    for (call, unused) in CALLS {
        for (flag, value) in SHARED.into_iter().filter(|(_, value)| !value.is_empty()) {
            let is_unused = unused.split(' ').any(|name| name == flag);
            if flag == "--seed" && !is_unused {
                // Any seed is right; another test looks for what it changes.
                continue;
            }
            let line = refused(&words(&with(call, &[flag, value])));
            // A file that is missing is named by who reads it.
            let expected = if is_unused || flag == "--threads" { flag } else { value };
            assert!(line.contains(expected), "{call} {flag}: {line}");
        }
    }
}

/// What a call reports, without times.
fn report(call: &str, more: &[&str]) -> Value {
    let mut report = json(&words(&with(call, &[&["--threads", "1"], more].concat())));
    let fields = report.as_object_mut().expect("one object");
    fields.retain(|name, _| !name.contains("ms") && !name.contains("seconds"));
    report
}

#[test]
fn a_seed_that_is_used_changes_what_is_reported() {
    for (call, _) in CALLS.into_iter().filter(|(_, unused)| !unused.contains("--seed")) {
        let plain = report(call, &[]);
        assert!((1..6).any(|seed| report(call, &["--seed", &seed.to_string()]) != plain), "{call}");
    }
}
