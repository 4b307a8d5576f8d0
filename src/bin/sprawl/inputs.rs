//! `sprawl soak --inputs`: worlds of random valid settings, styles, patch sets and edits, each checked within a time limit. Of the
//! inputs of a world with a fault those are named that the fault needs: others are left out for as long as it lasts.

use crate::common::Common;
use crate::fail::Fail;
use crate::random_edits;
use crate::soak::{City, MARGIN, SoakArgs, findings, unreached};
use crate::stats::{exceptions_json, exceptions_line};
use crate::towns;
use crate::work;
use bevy_sprawl::analysis::inputs::{DRAWN, Difference, InputError, Inputs};
use bevy_sprawl::analysis::{Exceptions, exceptions};
use bevy_sprawl::edits::{Edits, SettlementEdit};
use bevy_sprawl::layer::{Cancel, LayerError};
use bevy_sprawl::mesh::Detail;
use bevy_sprawl::space::{Bounds, ChunkCoord, Seed, Stream};
use bevy_sprawl::world::{World, WorldError};
use glam::DVec2;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Edge in metres of the square that is checked where a town and those that it touches need more.
const SQUARE: f64 = 2_000.0;
/// Greatest edge in metres of a square that is checked.
const LARGEST: f64 = 3_500.0;
/// Least and greatest radius of the town that is checked, in metres.
const RADIUS: (f64, f64) = (130.0, 850.0);
/// Greatest distance of the town from the origin along each axis, in metres.
const FAR: f64 = 200_000.0;
/// Places that are tried for the town.
const PLACES: usize = 40;
/// Worlds that are made at most to find what a fault needs, and for how many time limits they may take.
const TRIES: usize = 150;
const PATIENCE: u32 = 5;

/// What is checked, and where.
struct Case {
    seed: Seed,
    at: DVec2,
    differences: Vec<Difference>,
}

/// What became of a world.
enum Outcome {
    /// The inputs are refused, for this reason.
    Refused(String),
    Checked(City),
}

/// A fault, and what the first of a world needs.
struct Fault {
    what: String,
    at: DVec2,
    needs: Vec<String>,
}

/// All about one index.
struct Checked {
    /// Seed of the world.
    seed: Seed,
    outcome: Outcome,
    faults: Vec<Fault>,
}

thread_local! {
    /// Where and why this thread panicked last.
    static PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Runs the command. Faults make it fail with exit code 1.
pub fn run(common: &Common, args: &SoakArgs) -> Result<(), Fail> {
    let world = work::world(common)?;
    let mut usual = Inputs::new(world.settings().clone(), world.assets().clone());
    usual.edits = world.edits().clone();
    let first = args.inputs_from.unwrap_or(0);
    let count = u64::from(args.inputs.unwrap_or(0));
    let limit = Duration::from_secs(args.limit.unwrap_or(60).into());
    let indices: Vec<u64> = (first..first.saturating_add(count)).collect();
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map_or_else(String::new, |l| format!("{}:{}", l.file(), l.line()));
        let reason = panic.payload_as_str().unwrap_or_default().lines().next().unwrap_or_default().to_owned();
        PANIC.with(|last| *last.borrow_mut() = format!("Panic at {place}: {reason}"));
    }));
    let checked = work::each(common, "checking inputs", &indices, |index| {
        let name = format!("inputs {index} of seed {}", common.seed());
        let stream = Seed(common.seed()).stream("inputs to check", &[*index]);
        Ok(check(&usual, stream, &Watch { name, limit }))
    })?;
    let _ = std::panic::take_hook();
    report(common, &indices, &checked)
}

fn report(common: &Common, indices: &[u64], checked: &[Checked]) -> Result<(), Fail> {
    let (mut people, mut faults) = (String::new(), Vec::new());
    let mut refused: BTreeMap<&str, usize> = BTreeMap::new();
    let mut excepted = Exceptions::new();
    let (mut worlds, mut towns, mut streets, mut buildings, mut edits, mut rejected) = (0, 0, 0, 0, 0, 0);
    for (index, world) in indices.iter().zip(checked) {
        match &world.outcome {
            Outcome::Refused(reason) => *refused.entry(reason).or_default() += 1,
            Outcome::Checked(city) => {
                worlds += 1;
                towns += usize::from(city.streets > 0);
                streets += city.streets;
                buildings += city.buildings;
                edits += city.edits;
                rejected += city.rejected;
                for (kind, count) in &city.exceptions {
                    *excepted.entry(*kind).or_default() += count;
                }
            }
        }
        for Fault { what, at, needs } in &world.faults {
            // Writing to a string cannot fail.
            let _ =
                writeln!(people, "inputs {index}: {what} at {},{} in the world of seed {}", at.x, at.y, world.seed.0);
            needs.iter().for_each(|need| {
                let _ = writeln!(people, "    needs {need}");
            });
            let _ =
                writeln!(people, "    again: sprawl soak --seed {} --inputs-from {index} --inputs 1", common.seed());
            faults.push(
                json!({ "inputs": index, "seed": world.seed.0, "what": what, "x": at.x, "y": at.y, "needs": needs }),
            );
        }
    }
    for (reason, count) in &refused {
        let _ = writeln!(people, "refused {count:6} times: {reason}");
    }
    let counted = exceptions_json(&excepted);
    let _ = writeln!(people, "exceptions in {streets} streets: {}", exceptions_line(&counted));
    let _ = writeln!(people, "{edits} edits, {rejected} rejected");
    let refusals: usize = refused.values().sum();
    let _ = writeln!(
        people,
        "{} inputs, {refusals} refused, {worlds} worlds, {towns} with streets, {streets} streets, {buildings} buildings: {} faults",
        indices.len(),
        faults.len()
    );
    let found = faults.len();
    let refused: serde_json::Map<String, Value> =
        refused.into_iter().map(|(reason, count)| (reason.to_owned(), count.into())).collect();
    let report = json!({
        "inputs": indices.len(), "refused": refused, "worlds": worlds, "worlds_with_streets": towns, "streets": streets,
        "buildings": buildings, "edits": edits, "rejected": rejected, "exceptions": counted, "findings": faults,
    });
    work::print(common, &report, &people)?;
    match found {
        0 => Ok(()),
        n => Err(Fail::World(format!("{n} faults in {worlds} worlds"))),
    }
}

/// Limits the time of work.
struct Watch {
    name: String,
    limit: Duration,
}

impl Watch {
    /// Runs `work`. A panic and too long a time are findings like others. Work that does not even stop when it is cancelled
    /// ends the command.
    fn run(&self, work: impl FnOnce(&Cancel) -> Result<City, Refused>) -> Outcome {
        let cancel = Cancel::new();
        let (done, until) = channel::<()>();
        let begin = Instant::now();
        let made = std::thread::scope(|scope| {
            let (token, grace) = (cancel.clone(), self.limit * 4 + Duration::from_secs(30));
            scope.spawn(move || {
                if until.recv_timeout(self.limit) == Err(RecvTimeoutError::Timeout) {
                    token.cancel();
                    if until.recv_timeout(grace) == Err(RecvTimeoutError::Timeout) {
                        eprintln!("sprawl: {} do not stop after {:?}", self.name, begin.elapsed());
                        std::process::exit(1);
                    }
                }
            });
            let made = catch_unwind(AssertUnwindSafe(|| work(&cancel)));
            // The other end waits for this, or has given up.
            let _ = done.send(());
            made
        });
        let finding = |what: String| Outcome::Checked(City { findings: vec![(what, DVec2::ZERO)], ..City::default() });
        match made {
            Err(_) => finding(PANIC.with(|last| last.borrow().clone())),
            Ok(_) if begin.elapsed() > self.limit => finding("TooSlow".into()),
            Ok(Err(Refused::Layer(error))) => finding(error.to_string()),
            Ok(Err(Refused::Inputs(reason))) => Outcome::Refused(reason),
            Ok(Ok(city)) => Outcome::Checked(city),
        }
    }
}

/// Why no world was checked.
enum Refused {
    Inputs(String),
    Layer(LayerError),
}

impl From<InputError> for Refused {
    fn from(error: InputError) -> Self {
        Self::Inputs(match error {
            InputError::Range(e) => e.field,
            e => e.to_string(),
        })
    }
}

impl From<WorldError> for Refused {
    fn from(error: WorldError) -> Self {
        Self::Inputs(match error {
            WorldError::Range(e) => e.field,
            WorldError::NoPatches { .. } => "tags that leave no patch".into(),
            e => e.to_string(),
        })
    }
}

impl From<LayerError> for Refused {
    fn from(error: LayerError) -> Self {
        Self::Layer(error)
    }
}

/// Draws inputs, checks their world, and finds out what faults need.
fn check(usual: &Inputs, mut stream: Stream, watch: &Watch) -> Checked {
    let mut case = Case { seed: Seed(stream.bits()), at: DVec2::ZERO, differences: Vec::new() };
    let outcome = watch.run(|cancel| {
        case.differences = usual.draw_differences(&mut stream)?;
        place_town(usual, &mut case, &mut stream, cancel)?;
        city(usual, &case, &case.differences, cancel)
    });
    let mut faults: Vec<Fault> = Vec::new();
    if let Outcome::Checked(city) = &outcome {
        for (what, at) in &city.findings {
            if !faults.iter().any(|f| f.what == *what) {
                eprintln!("sprawl: {}: {what} at {},{}", watch.name, at.x, at.y);
                faults.push(Fault { what: what.clone(), at: *at, needs: Vec::new() });
            }
        }
    }
    // The others of a world mostly follow from the first, and what one needs takes a while to find.
    if let Some(first) = faults.first_mut() {
        first.needs = needs(usual, &case, &first.what, watch);
    }
    Checked { seed: case.seed, outcome, faults }
}

/// Pins a town of the drawn style on dry ground, and draws edits around it for some worlds.
fn place_town(usual: &Inputs, case: &mut Case, stream: &mut Stream, cancel: &Cancel) -> Result<(), Refused> {
    let radius = stream.range(RADIUS.0, RADIUS.1).round();
    let world = World::new(usual.with(&case.differences)?.source(case.seed))?;
    let is_dry = |at: DVec2| {
        let around = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
        around.into_iter().all(|off| world.terrain().sample(at + off * radius).depth() == 0.0)
    };
    for _ in 0..PLACES {
        case.at = (DVec2::new(stream.signed(), stream.signed()) * FAR).round();
        if is_dry(case.at) {
            break;
        }
    }
    let style = Some(DRAWN.to_owned());
    let pin =
        SettlementEdit::Pin { at: case.at, size: towns::size_of(radius), name: None, style, radius: Some(radius) };
    case.differences.push(Difference::Edit(Edits { settlements: vec![pin], ..Edits::default() }));
    if stream.chance(0.3) {
        let world = World::new(usual.with(&case.differences)?.source(case.seed))?;
        if let Some(town) = world.settlements().at(case.at)? {
            let drawn = random_edits::edits(&world, &town, cancel)?;
            case.differences.extend(random_edits::one_by_one(drawn).into_iter().map(Difference::Edit));
        }
    }
    Ok(())
}

/// Checks the town of a case with those that it touches, or the square where it should be, in a world of some of its
/// differences.
fn city(usual: &Inputs, case: &Case, differences: &[Difference], cancel: &Cancel) -> Result<City, Refused> {
    let world = World::new(usual.with(differences)?.source(case.seed))?;
    let town = world.settlements().at(case.at)?.filter(|town| town.centre.plan() == case.at);
    let mut settlements: Vec<_> = town.into_iter().collect();
    if let Some(town) = settlements.first().cloned() {
        settlements.extend(world.settlements().touching(&town)?);
    }
    let around = settlements.iter().map(|s| Bounds::square(s.centre.plan(), 2.0 * (s.radius + MARGIN)));
    let square = Bounds::square(case.at, SQUARE);
    let all = around.fold(square, Bounds::union);
    let is_whole = all.size().max_element() <= LARGEST;
    let area = world.area(if is_whole { all } else { square }, cancel)?;
    let mut found = findings(&area);
    // A town may hang together by way of one that it touches.
    found.retain(|(what, _)| is_whole || what != "Disconnected");
    if is_whole {
        for settlement in &settlements {
            found.extend(unreached(&world, &area, settlement)?);
        }
    }
    let chunk = ChunkCoord::containing(case.at, world.settings().chunk_size);
    world.mesh(chunk, Detail::Full, cancel)?;
    let edits = world.edits();
    Ok(City {
        streets: area.streets.len(),
        buildings: area.footprints.len(),
        edits: edits.settlements.len() + edits.influences.len() + edits.way_points.len() + edits.roads.len(),
        rejected: world.rejected_edits(cancel)?.len(),
        findings: found,
        exceptions: exceptions(&area),
        ..City::default()
    })
}

/// The differences without which there is no such fault.
fn needs(usual: &Inputs, case: &Case, what: &str, watch: &Watch) -> Vec<String> {
    let begin = Instant::now();
    let lasts = |differences: &[Difference]| {
        let outcome = watch.run(|cancel| city(usual, case, differences, cancel));
        matches!(outcome, Outcome::Checked(city) if city.findings.iter().any(|f| f.0 == what))
    };
    let is_over = |tries: usize| tries >= TRIES || begin.elapsed() > watch.limit * PATIENCE;
    let needed = without_the_rest(&case.differences, lasts, is_over);
    needed.iter().map(ToString::to_string).collect()
}

/// Leaves items out, many at once and then fewer, for as long as `lasts` holds for the rest.
fn without_the_rest<T: Clone>(
    items: &[T],
    mut lasts: impl FnMut(&[T]) -> bool,
    is_over: impl Fn(usize) -> bool,
) -> Vec<T> {
    let mut rest = items.to_vec();
    let mut size = rest.len().div_ceil(2);
    let mut tries = 0;
    while size > 0 {
        let (before, mut begin) = (rest.len(), 0);
        while begin < rest.len() {
            if is_over(tries) {
                return rest;
            }
            tries += 1;
            let end = (begin + size).min(rest.len());
            let fewer = [&rest[..begin], &rest[end..]].concat();
            if lasts(&fewer) { rest = fewer } else { begin = end }
        }
        // Once single items are left out, all are tried again until none can go.
        if size > 1 {
            size = size.div_ceil(2).min(size - 1);
        } else if rest.len() == before {
            break;
        }
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_fault_needs_is_all_that_is_left() {
        let items: Vec<u32> = (0..100).collect();
        for needed in [Vec::new(), vec![0], vec![99], vec![3, 50, 51], vec![10, 20, 30, 40, 50]] {
            let lasts = |rest: &[u32]| needed.iter().all(|n| rest.contains(n));
            assert_eq!(without_the_rest(&items, lasts, |_| false), needed);
        }
        assert_eq!(without_the_rest(&items, |_| true, |tries| tries == 1).len(), 50);
        assert!(without_the_rest(&[] as &[u32], |_| true, |_| false).is_empty());
    }

    #[test]
    fn what_takes_too_long_is_cancelled_and_found() {
        let watch = Watch { name: "a test".into(), limit: Duration::from_millis(1) };
        let outcome = watch.run(|cancel| {
            while cancel.check().is_ok() {
                std::thread::sleep(Duration::from_millis(1));
            }
            Err(Refused::Layer(LayerError::Cancelled))
        });
        assert!(matches!(outcome, Outcome::Checked(City { findings, .. }) if findings[0].0 == "TooSlow"));
        let watch = Watch { limit: Duration::from_secs(600), ..watch };
        let outcome = watch.run(|_| Err(Refused::Inputs("no".into())));
        assert!(matches!(outcome, Outcome::Refused(reason) if reason == "no"));
    }
}
