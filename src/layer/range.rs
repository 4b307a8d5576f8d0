//! Values outside their allowed range.

use super::file::FileError;
use super::ron_text::error_at;

/// A value outside its allowed range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field} is {value}; allowed is {allowed}")]
pub struct RangeError {
    /// Dotted path of the field, as in the file.
    pub field: String,
    /// The value given.
    pub value: String,
    /// What is allowed.
    pub allowed: String,
}

impl RangeError {
    /// Fails unless `low <= value <= high` (so NaN fails).
    pub fn check(field: &str, value: f64, low: f64, high: f64) -> Result<(), Self> {
        if value >= low && value <= high {
            return Ok(());
        }
        Err(Self { field: field.into(), value: value.to_string(), allowed: format!("{low} to {high}") })
    }

    /// The same error with `parent.` before the field.
    pub fn within(self, parent: &str) -> Self {
        Self { field: format!("{parent}.{}", self.field), ..self }
    }

    /// The error at the place in `text`, read as RON, where the field is written.
    pub fn in_file(&self, file: &str, text: &str) -> FileError {
        error_at(file, text, &self.field, self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn range_errors_find_their_field() {
        let text = "(\n  roads: (slope: 1),\n  towns: (\n    slope: -2,\n  ),\n)";
        let error = RangeError::check("slope", -2.0, 0.0, 9.0).unwrap_err().within("towns").in_file("s.ron", text);
        assert_eq!(error.to_string(), "s.ron:4:5: towns.slope is -2; allowed is 0 to 9");
        assert!(RangeError::check("x", f64::NAN, 0.0, 1.0).is_err());
    }
}
