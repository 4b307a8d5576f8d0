//! The command line of the example.

use bevy::math::DVec2;
use std::path::PathBuf;

pub const HELP: &str = "\
Walk through an endless world of towns.

  --seed N            the world [42]
  --at X,Y            begin near this plan point, metres east and north [0,0]
  --headless          no window: walk through a town by itself, and leave a map, screenshots and a report
  --seconds S         length of that walk in seconds [40]
  --speed M           its speed in metres per second [fits the town]
  --horizon M         how far the land is seen, in metres; 0 shows nothing beyond the chunks [12000]
  --laps N            how often to walk the same way, to and fro [1]
  --screenshots DIR   where screenshots and the map go [target/walk]
  --report FILE       where the report goes [target/walk/report.json]

Without a display or a graphics adapter it is headless by itself.";

/// The arguments of the command line.
#[derive(Clone, Debug, PartialEq)]
pub struct Args {
    pub seed: u64,
    pub at: DVec2,
    pub headless: bool,
    pub seconds: f64,
    pub speed: Option<f64>,
    pub horizon: f32,
    pub laps: u32,
    pub screenshots: PathBuf,
    pub report: PathBuf,
}

impl Default for Args {
    fn default() -> Self {
        Self {
            seed: 42,
            at: DVec2::ZERO,
            headless: false,
            seconds: 40.0,
            speed: None,
            horizon: 12_000.0,
            laps: 1,
            screenshots: "target/walk".into(),
            report: "target/walk/report.json".into(),
        }
    }
}

/// Reads the arguments; `Ok(None)` if they ask for help.
pub fn parse(args: impl IntoIterator<Item = String>) -> Result<Option<Args>, String> {
    let mut out = Args::default();
    let mut args = args.into_iter();
    while let Some(arg) = args.next() {
        let (name, given) = match arg.split_once('=') {
            Some((name, value)) => (name.to_owned(), Some(value.to_owned())),
            None => (arg, None),
        };
        match name.as_str() {
            "--help" | "-h" => return Ok(None),
            "--headless" if given.is_none() => {
                out.headless = true;
                continue;
            }
            "--seed" | "--at" | "--seconds" | "--speed" | "--horizon" | "--laps" | "--screenshots" | "--report" => {}
            _ => return Err(format!("unknown argument `{name}`; --help lists them")),
        }
        let value = given.or_else(|| args.next()).ok_or_else(|| format!("{name} needs a value"))?;
        let wrong = |wanted: &str| format!("{name} is `{value}`; it must be {wanted}");
        match name.as_str() {
            "--seed" => out.seed = value.parse().map_err(|_| wrong("a whole number, 0 or more"))?,
            "--at" => out.at = point(&value).ok_or_else(|| wrong("two numbers X,Y, up to 1000000000000 each"))?,
            "--seconds" => out.seconds = within(&value, 1.0, 86_400.0).ok_or_else(|| wrong("1 to 86400"))?,
            "--speed" => out.speed = Some(within(&value, 0.5, 500.0).ok_or_else(|| wrong("0.5 to 500"))?),
            "--horizon" => out.horizon = within(&value, 0.0, 50_000.0).ok_or_else(|| wrong("0 to 50000"))? as f32,
            "--laps" => {
                out.laps = value.parse().ok().filter(|n| (1..=1000).contains(n)).ok_or_else(|| wrong("1 to 1000"))?
            }
            "--screenshots" => out.screenshots = value.into(),
            _ => out.report = value.into(),
        }
    }
    Ok(Some(out))
}

fn within(text: &str, low: f64, high: f64) -> Option<f64> {
    text.parse().ok().filter(|v| (low..=high).contains(v))
}

fn point(text: &str) -> Option<DVec2> {
    let (x, y) = text.split_once(',')?;
    let number = |t: &str| within(t.trim(), -1e12, 1e12);
    Some(DVec2::new(number(x)?, number(y)?))
}
