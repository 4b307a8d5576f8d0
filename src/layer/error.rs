//! Cancelling work, and reading no further than declared.

use crate::space::Bounds;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Why a layer gave no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayerError {
    /// The [`Cancel`] token was set. Asking again with a fresh token is fine.
    #[error("cancelled")]
    Cancelled,
    /// A layer read outside the padding that it declares: a defect of that layer.
    #[error("layer `{layer}` reads outside its declared padding of {declared} m; it needs {needed:.1} m")]
    Padding {
        /// The layer that read.
        layer: &'static str,
        /// Its declared padding in metres.
        declared: f64,
        /// The padding that this read needs, in metres.
        needed: f64,
    },
    /// A settlement's style is not among the styles that the layers were given.
    #[error("no style is named `{0}`")]
    UnknownStyle(String),
}

/// A token that stops work nobody waits for any more. Clones share one flag.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<State>);

#[derive(Debug, Default)]
struct State {
    set: AtomicBool,
    /// Steps until the token sets itself.
    rest: Option<AtomicU64>,
}

impl Cancel {
    /// A token that is not set.
    pub fn new() -> Self {
        Self::default()
    }

    /// A token that sets itself once work has taken more than `steps` steps. Unlike a time, the number of steps of some work is
    /// about the same on every machine; a step is what happens between two [checks](Self::check).
    pub fn after(steps: u64) -> Self {
        Self(Arc::new(State { set: AtomicBool::new(false), rest: Some(AtomicU64::new(steps)) }))
    }

    /// Asks the work to stop.
    pub fn cancel(&self) {
        self.0.set.store(true, Ordering::Relaxed);
    }

    /// Whether the work should stop.
    pub fn is_cancelled(&self) -> bool {
        self.0.set.load(Ordering::Relaxed)
    }

    /// An error once the token is set; called between steps.
    pub fn check(&self) -> Result<(), LayerError> {
        if let Some(rest) = &self.0.rest
            && rest.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |r| r.checked_sub(1)).is_err()
        {
            self.cancel();
        }
        if self.is_cancelled() { Err(LayerError::Cancelled) } else { Ok(()) }
    }
}

/// What a layer may read while it makes one thing: the thing's own box, grown by the layer's declared padding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    layer: &'static str,
    own: Bounds,
    padding: f64,
}

impl Reach {
    /// The reach of `layer` around `own` (plan metres) with `padding` metres on every side.
    pub fn new(layer: &'static str, own: Bounds, padding: f64) -> Self {
        Self { layer, own, padding }
    }

    /// The box that may be read.
    pub fn bounds(&self) -> Bounds {
        self.own.grown(self.padding)
    }

    /// Returns `read` if it lies within reach, otherwise an error that says which padding would have been needed.
    pub fn check(&self, read: Bounds) -> Result<Bounds, LayerError> {
        if self.bounds().encloses(read) {
            return Ok(read);
        }
        let needed = (self.own.min - read.min).max(read.max - self.own.max).max_element();
        Err(LayerError::Padding { layer: self.layer, declared: self.padding, needed })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn a_read_too_far_names_layer_and_padding() {
        let reach = Reach::new("town", Bounds::square(DVec2::ZERO, 100.0), 20.0);
        assert!(reach.check(Bounds::square(DVec2::ZERO, 140.0)).is_ok());
        let error = reach.check(Bounds::square(DVec2::X * 10.0, 140.0)).unwrap_err();
        assert_eq!(error.to_string(), "layer `town` reads outside its declared padding of 20 m; it needs 30.0 m");
    }

    #[test]
    fn clones_of_a_token_cancel_together() {
        let token = Cancel::new();
        let clone = token.clone();
        token.cancel();
        assert_eq!(clone.check(), Err(LayerError::Cancelled));
        let bounded = Cancel::after(2);
        assert_eq!([0; 3].map(|_| bounded.check().is_ok()), [true, true, false]);
        assert!(bounded.is_cancelled());
    }
}
