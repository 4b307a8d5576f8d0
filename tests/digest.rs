//! Worlds stay what they are: hashes of a few chunks are compared with those stored in `tests/golden/digest.txt`, so that a
//! platform, a compiler or a change that makes another world is seen.

use bevy_sprawl::analysis::digest::{ChunkDigest, Digest, LAYERS};
use bevy_sprawl::edits::Edits;
use bevy_sprawl::layer::Cancel;
use bevy_sprawl::space::{ChunkCoord, Seed};
use bevy_sprawl::world::{Settings, World, WorldSource};
use std::fmt::Write;
use std::path::Path;

/// Set this variable to write the file anew.
const RENEW: &str = "SPRAWL_RENEW_GOLDEN";

/// A place: its name, the world, and chunks there.
type Place = (&'static str, WorldSource, [(i32, i32); 2]);

fn places() -> [Place; 4] {
    let plain = |seed: u64| WorldSource::new(Seed(seed));
    let crowded = include_str!("../assets/settings/conurbation.ron");
    let crowded = Settings::from_ron("conurbation.ron", crowded).expect("the bundled settings are valid");
    let edits = "(
        settlements: [Move(from: (4805, -1673), to: (4955, -1673))],
        influences: [(shape: Point((5600, -1200)), radius: 600, strength: 3)],
    )";
    let edits = Edits::from_ron("edits.ron", edits).expect("the edits are valid");
    [
        ("city", plain(5), [(19, -7), (20, -7)]),
        ("border", WorldSource { settings: crowded, ..plain(849_649_501) }, [(-12, -2), (-11, -2)]),
        ("far", plain(871_278_904), [(-271_095, -1_109_781), (-271_094, -1_109_781)]),
        ("edited", WorldSource { edits, ..plain(5) }, [(9, -4), (8, -4)]),
    ]
}

/// One line for each chunk and layer.
fn digests() -> String {
    let mut out = String::new();
    for (name, source, chunks) in places() {
        let world = World::new(source).expect("the inputs are valid");
        for (x, y) in chunks {
            let coord = ChunkCoord::new(x, y);
            let digest = ChunkDigest::new(&world, coord, &Cancel::new()).expect("nobody cancels");
            // As `sprawl digest` prints them for one chunk.
            for (layer, hash) in LAYERS.iter().zip(Digest::new([(coord, digest)]).layers) {
                // Writing to a string cannot fail.
                let _ = writeln!(out, "{name} {coord} {layer} {hash:016x}");
            }
        }
    }
    out
}

#[test]
fn worlds_are_those_that_are_stored() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/digest.txt");
    let made = digests();
    if std::env::var_os(RENEW).is_some() {
        std::fs::write(&file, made).expect("the folder of golden files can be written");
        return;
    }
    let stored = std::fs::read_to_string(&file).expect("the golden file can be read").replace("\r\n", "\n");
    let changed: Vec<&str> = made.lines().filter(|line| !stored.lines().any(|s| s == *line)).collect();
    assert!(
        changed.is_empty() && made == stored,
        "worlds are not what they were:\n{}\nIf no change to worlds was meant, find what differs here: layers depend on \
         those named before them. If it was, renew the file with\n  {RENEW}=1 cargo test --no-default-features --test \
         digest\nand say in CHANGELOG.md what changes.",
        changed.join("\n")
    );
}
