//! The values of flags: numbers, places, ranges.

use bevy_sprawl::region::Populations;
use glam::DVec2;
use std::ops::Range;

/// Longest edge of a square, in metres.
const MOST: f64 = 200_000.0;

/// A finite number.
pub fn number(text: &str) -> Result<f64, String> {
    let number = any_number(text)?;
    if number.is_finite() { Ok(number) } else { Err("a finite number is needed".into()) }
}

/// A number that may be infinite or none at all.
fn any_number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| format!("`{text}` is no number"))
}

/// A finite number of 0 or more.
pub fn least_zero(text: &str) -> Result<f64, String> {
    let number = number(text)?;
    if number >= 0.0 { Ok(number) } else { Err("0 or more is allowed".into()) }
}

pub fn point(text: &str) -> Result<DVec2, String> {
    let (x, y) = text.split_once(',').ok_or("two numbers with a comma between them are needed, such as -5,7")?;
    Ok(DVec2::new(number(x)?, number(y)?))
}

pub fn gamma(text: &str) -> Result<f64, String> {
    let gamma = any_number(text)?;
    if gamma >= 1.01 { Ok(gamma) } else { Err("1.01 or more is allowed, or inf".into()) }
}

pub fn populations(text: &str) -> Result<Populations, String> {
    let (town, city) =
        text.split_once(',').ok_or("two numbers with a comma between them are needed, such as 2000,20000")?;
    let both = Populations { town: number(town)?, city: number(city)? };
    let rising = both.town >= 0.0 && both.town <= both.city && both.city.is_finite();
    if rising { Ok(both) } else { Err("0 or more is allowed for a town, and no less for a city".into()) }
}

/// An angle in degrees, or none for `auto`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn(pub Option<f64>);

pub fn turn(text: &str) -> Result<Turn, String> {
    if text == "auto" { Ok(Turn(None)) } else { number(text).map(|degrees| Turn(Some(degrees))) }
}

/// A colour, as `#0000ff` or `0000ff`.
pub fn colour(text: &str) -> Result<[u8; 3], String> {
    let digits = text.trim().trim_start_matches('#');
    let channel = |i: usize| u8::from_str_radix(digits.get(2 * i..2 * i + 2)?, 16).ok();
    match (digits.len(), channel(0), channel(1), channel(2)) {
        (6, Some(red), Some(green), Some(blue)) => Ok([red, green, blue]),
        _ => Err("six hexadecimal digits are needed, such as #0000ff".into()),
    }
}

pub fn size(text: &str) -> Result<f64, String> {
    let size = number(text)?;
    if size > 0.0 && size <= MOST { Ok(size) } else { Err(format!("more than 0 and at most {MOST} m is allowed")) }
}

pub fn radius(text: &str) -> Result<f64, String> {
    let radius = number(text)?;
    if (120.0..=5000.0).contains(&radius) { Ok(radius) } else { Err("120 to 5000 m is allowed".into()) }
}

pub fn seed_range(text: &str) -> Result<Range<u64>, String> {
    let (from, to) = text.split_once("..").ok_or("a range is needed, such as 0..100")?;
    let whole = |t: &str| t.trim().parse::<u64>().map_err(|_| format!("`{t}` is no whole number"));
    let range = whole(from)?..whole(to)?;
    match range.end.saturating_sub(range.start) {
        0 => Err(format!("{text} holds no seed: its end is excluded")),
        1..=1_000_000 => Ok(range),
        _ => Err("more than a million seeds".into()),
    }
}

/// Columns and rows of chunks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChunkRange {
    pub x: Range<i32>,
    pub y: Range<i32>,
}

pub fn chunk_range(text: &str) -> Result<ChunkRange, String> {
    let range = |text: &str| {
        let (from, to) = text.split_once("..").ok_or("two ranges are needed, such as -2..3,0..4")?;
        let whole = |t: &str| t.trim().parse::<i32>().map_err(|_| format!("`{t}` is no whole number of 32 bits"));
        let range = whole(from)?..whole(to)?;
        if range.is_empty() { Err(format!("{text} holds no chunk: its end is excluded")) } else { Ok(range) }
    };
    let (x, y) = text.split_once(',').ok_or("two ranges with a comma between them are needed, such as -2..3,0..4")?;
    let out = ChunkRange { x: range(x)?, y: range(y)? };
    let count = |r: &Range<i32>| i64::from(r.end) - i64::from(r.start);
    if count(&out.x).saturating_mul(count(&out.y)) > 1_000_000 {
        return Err("more than a million chunks".into());
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_values_are_refused() {
        for bad in ["0", "-1", "NaN", "inf", "200000.1", "x", ""] {
            assert!(size(bad).is_err(), "{bad}");
        }
        for bad in ["1", "1,", "a,2", "NaN,0", "0,inf", "1,2,3"] {
            assert!(point(bad).is_err(), "{bad}");
        }
        for bad in ["0..1", "1..1,0..1", "2..1,0..1", "0..1,0", "0..2000,0..2000", "-2147483648..2147483647,0..1"] {
            assert!(chunk_range(bad).is_err(), "{bad}");
        }
        assert_eq!(size("200000"), Ok(200_000.0));
        assert_eq!((colour("#0010fF"), colour("ff0000")), (Ok([0, 16, 255]), Ok([255, 0, 0])));
        assert!(["", "#fff", "#00gg00", "#0000ff0", "bläulich"].iter().all(|bad| colour(bad).is_err()));
    }
}
