//! Structs whose numbers have ranges. One walk over the numbers of a struct says which they are and what each may be; checks,
//! random draws and changes of single numbers all go that way.

use super::range::RangeError;
use crate::space::Stream;
use std::collections::BTreeMap;

/// A struct whose numbers have ranges.
pub trait Ranged: Clone {
    /// Shows every number to `walk`, with its range. A range may depend on numbers that the walk has seen before.
    ///
    /// An implementation takes the struct apart (`let Self { .. } = self` with the name of every field), so that a new field
    /// without a range does not compile.
    ///
    /// # Errors
    ///
    /// The error at which the walk ends.
    fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError>;

    /// Checks that every number lies in its range.
    ///
    /// # Errors
    ///
    /// Names the first number that is out of its range or NaN.
    fn check_ranges(&self) -> Result<(), RangeError> {
        self.clone().walk(&mut Walk::new(&mut |number| number.check()))
    }

    /// The path of every number and both ends of its range, beside the other numbers as they are.
    fn ends(&self) -> Vec<(String, [f64; 2])> {
        let mut ends = Vec::new();
        let mut visit = |number: &Number<'_>| {
            ends.push((number.path.to_owned(), [number.low, number.high]));
            Ok(number.value)
        };
        // What a struct refuses beside the ranges of its numbers ends the walk after them.
        let _ = self.clone().walk(&mut Walk::new(&mut visit));
        ends
    }

    /// Draws numbers from their ranges, each with probability `share`. Both ends of a range come up often. A number that is not
    /// drawn stays as it is, unless its range depends on others and leaves it out: then it is drawn, too. Gives the path and
    /// the new value of each number that changed.
    ///
    /// # Errors
    ///
    /// If a range is empty, or the struct refuses numbers that are in range one by one.
    fn draw(&mut self, share: f64, stream: &mut Stream) -> Result<Vec<(String, f64)>, RangeError> {
        let mut changed = Vec::new();
        let mut visit = |number: &Number<'_>| {
            let value =
                if stream.chance(share) || number.check().is_err() { number.draw(stream) } else { number.value };
            if value != number.value {
                changed.push((number.path.to_owned(), value));
            }
            Number { value, ..*number }.check()
        };
        self.walk(&mut Walk::new(&mut visit))?;
        Ok(changed)
    }

    /// Sets the numbers at some paths and checks all.
    ///
    /// # Errors
    ///
    /// Names the first number that is out of its range then, or a path that no number has.
    fn set(&mut self, values: &BTreeMap<String, f64>) -> Result<(), RangeError> {
        let mut left = values.clone();
        let mut visit = |number: &Number<'_>| {
            let value = left.remove(number.path).unwrap_or(number.value);
            Number { value, ..*number }.check()
        };
        self.walk(&mut Walk::new(&mut visit))?;
        left.pop_first().map_or(Ok(()), |(field, value)| {
            Err(RangeError { field, value: value.to_string(), allowed: "no number at this path".into() })
        })
    }
}

/// A number that a walk comes to.
#[derive(Clone, Copy, Debug)]
pub struct Number<'a> {
    /// Path from the struct where the walk began, such as `local.degree[1]`.
    pub path: &'a str,
    /// The number as it is.
    pub value: f64,
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
    /// Values are multiples of this; 0 if they may be anything between.
    pub step: f64,
}

impl Number<'_> {
    /// The value, if it is in range.
    fn check(&self) -> Result<f64, RangeError> {
        let Self { path, value, low, high, step } = *self;
        if step <= 1.0 || (value >= low && value <= high && value % step == 0.0) {
            return RangeError::check(path, value, low, high).map(|()| value);
        }
        let allowed = format!("a multiple of {step}, {low} to {high}");
        Err(RangeError { field: path.into(), value: value.to_string(), allowed })
    }

    /// A value from the range: an end of it, one near the value that it has, or any.
    fn draw(&self, stream: &mut Stream) -> f64 {
        let value = match stream.index(8) {
            0 => self.low,
            1 => self.high,
            2..=4 => self.value * stream.range(0.5, 2.0),
            _ => stream.range(self.low, self.high),
        };
        if self.step == 0.0 {
            return value.max(self.low).min(self.high);
        }
        let (low, high) = ((self.low / self.step).ceil(), (self.high / self.step).floor());
        (value / self.step).round().max(low).min(high) * self.step
    }
}

/// A walk over the numbers of a [`Ranged`] struct. What it visits them with gives the value that takes the place of each, or
/// ends the walk.
pub struct Walk<'a> {
    path: String,
    visit: &'a mut dyn FnMut(&Number<'_>) -> Result<f64, RangeError>,
}

impl<'a> Walk<'a> {
    fn new(visit: &'a mut dyn FnMut(&Number<'_>) -> Result<f64, RangeError>) -> Self {
        Self { path: String::new(), visit }
    }

    /// A number from `low` to `high`.
    pub fn number<T: Numeric>(&mut self, name: &str, value: &mut T, low: f64, high: f64) -> Result<(), RangeError> {
        self.steps(name, value, T::STEP, (low, high))
    }

    /// Two numbers from `low` to `high`, the lesser first.
    pub fn pair<T: Numeric>(&mut self, name: &str, pair: &mut (T, T), low: f64, high: f64) -> Result<(), RangeError> {
        self.number(&format!("{name}[0]"), &mut pair.0, low, high)?;
        self.number(&format!("{name}[1]"), &mut pair.1, pair.0.as_f64(), high)
    }

    /// A multiple of `step` in a range.
    pub fn steps<T: Numeric>(
        &mut self,
        name: &str,
        value: &mut T,
        step: f64,
        (low, high): (f64, f64),
    ) -> Result<(), RangeError> {
        let found = self
            .inside(name, |walk| (walk.visit)(&Number { path: &walk.path, value: value.as_f64(), low, high, step }))?;
        *value = T::from_f64(found);
        Ok(())
    }

    /// One of the values that a type has; its number is its place among them.
    pub fn choice<T: Choice>(&mut self, name: &str, value: &mut T) -> Result<(), RangeError> {
        let mut index = T::CHOICES.iter().position(|choice| choice == value).unwrap_or(0) as u32;
        self.number(name, &mut index, 0.0, T::CHOICES.len().saturating_sub(1) as f64)?;
        *value = T::CHOICES.get(index as usize).copied().unwrap_or(*value);
        Ok(())
    }

    /// The numbers of a part.
    pub fn within(&mut self, name: &str, part: &mut impl Ranged) -> Result<(), RangeError> {
        self.inside(name, |walk| part.walk(walk))
    }

    /// What `walk` visits lies below `name`.
    pub fn inside<R>(&mut self, name: &str, walk: impl FnOnce(&mut Self) -> R) -> R {
        let outside = self.path.len();
        if outside > 0 {
            self.path.push('.');
        }
        self.path.push_str(name);
        let out = walk(self);
        self.path.truncate(outside);
        out
    }
}

/// Types of numbers.
pub trait Numeric: Copy {
    /// What values are multiples of; 0 if they may be anything.
    const STEP: f64;

    /// The value.
    fn as_f64(self) -> f64;

    /// The value of this type that is nearest to a multiple of the step.
    fn from_f64(value: f64) -> Self;
}

impl Numeric for f64 {
    const STEP: f64 = 0.0;

    fn as_f64(self) -> f64 {
        self
    }

    fn from_f64(value: f64) -> Self {
        value
    }
}

impl Numeric for u32 {
    const STEP: f64 = 1.0;

    fn as_f64(self) -> f64 {
        self.into()
    }

    fn from_f64(value: f64) -> Self {
        value as Self
    }
}

impl Numeric for i64 {
    const STEP: f64 = 1.0;

    fn as_f64(self) -> f64 {
        self as f64
    }

    fn from_f64(value: f64) -> Self {
        value as Self
    }
}

/// Types that have few values.
pub trait Choice: Copy + PartialEq + 'static {
    /// All of them.
    const CHOICES: &'static [Self];
}

impl Choice for bool {
    const CHOICES: &'static [Self] = &[false, true];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Seed;

    #[derive(Clone, Debug, PartialEq)]
    struct Wall {
        height: f64,
        gates: (u32, u32),
        stones: i64,
        is_round: bool,
    }

    impl Ranged for Wall {
        fn walk(&mut self, walk: &mut Walk<'_>) -> Result<(), RangeError> {
            let Self { height, gates, stones, is_round } = self;
            walk.number("height", height, 2.0, 20.0)?;
            walk.inside("front", |walk| walk.pair("gates", gates, 1.0, *height))?;
            walk.steps("stones", stones, 64.0, (64.0, 512.0))?;
            walk.choice("is_round", is_round)
        }
    }

    const WALL: Wall = Wall { height: 8.0, gates: (2, 8), stones: 128, is_round: false };

    #[test]
    fn checks_name_the_path_and_what_is_allowed() {
        let error = |wall: Wall| wall.check_ranges().unwrap_err().to_string();
        assert_eq!(WALL.check_ranges(), Ok(()));
        assert_eq!(error(Wall { height: f64::NAN, ..WALL }), "height is NaN; allowed is 2 to 20");
        assert_eq!(error(Wall { gates: (3, 2), ..WALL }), "front.gates[1] is 2; allowed is 3 to 8");
        assert_eq!(error(Wall { height: 7.5, ..WALL }), "front.gates[1] is 8; allowed is 2 to 7.5");
        assert_eq!(error(Wall { stones: 100, ..WALL }), "stones is 100; allowed is a multiple of 64, 64 to 512");
    }

    #[test]
    fn draws_are_valid_and_reach_both_ends() {
        let mut stream = Seed(4).stream("test", &[]);
        let mut drawn = Vec::new();
        for _ in 0..300 {
            let mut wall = WALL;
            let changed = wall.draw(0.5, &mut stream).unwrap();
            assert_eq!(wall.check_ranges(), Ok(()));
            // The changes alone make the same of what was there before.
            let mut again = WALL;
            again.set(&changed.into_iter().collect()).unwrap();
            assert_eq!(again, wall);
            drawn.push(wall);
        }
        assert!(drawn.iter().any(|w| w.height == 2.0 && w.gates.1 == 2) && drawn.iter().any(|w| w.height == 20.0));
        assert!(drawn.iter().any(|w| w.is_round) && drawn.iter().any(|w| w.stones == 512));
        assert!(drawn.iter().filter(|w| w.height == WALL.height).count() > 100, "half of the numbers stay");
    }

    #[test]
    fn a_number_is_set_only_within_its_range() {
        let mut wall = WALL;
        let to = |values: &[(&str, f64)]| values.iter().map(|(path, value)| (path.to_string(), *value)).collect();
        assert!(wall.set(&to(&[("height", 4.0)])).is_err(), "8 gates are too many");
        assert_eq!(wall.set(&to(&[("height", 4.0), ("front.gates[1]", 3.0)])), Ok(()));
        assert_eq!(wall.set(&to(&[("heigth", 4.0)])).unwrap_err().field, "heigth");
        assert_eq!(wall, Wall { height: 4.0, gates: (2, 3), ..WALL });
    }
}
