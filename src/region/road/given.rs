//! Values that a file may give or leave out.

use serde::{Deserialize, Deserializer};

/// A value that a file may give, written as the value itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Given<T>(Option<T>);

impl<T> Default for Given<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Given<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        T::deserialize(deserializer).map(|value| Self(Some(value)))
    }
}

impl<T: Copy> Given<T> {
    /// The value, if it is given.
    pub fn get(self) -> Option<T> {
        self.0
    }

    /// The value, or another where none is given.
    pub fn or(self, other: T) -> T {
        self.0.unwrap_or(other)
    }
}
