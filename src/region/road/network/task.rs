//! How a network is built.

use crate::layer::{Cancel, LayerError, each};

/// How a network is built. The result does not depend on it.
pub struct NetworkTask<'a> {
    /// Number of threads, at least 1.
    pub threads: usize,
    /// Cancels the work.
    pub cancel: Cancel,
    /// Receives the progress (the name of a step, and how many parts of how many are done), from any thread.
    pub progress: &'a (dyn Fn(&str, usize, usize) + Sync),
}

impl Default for NetworkTask<'_> {
    /// One thread, and no report of the progress.
    fn default() -> Self {
        Self { threads: 1, cancel: Cancel::new(), progress: &|_, _, _| () }
    }
}

impl NetworkTask<'_> {
    /// Runs `make` on every item, on as many threads as the task says; results come in the order of the items. `what` names
    /// the step in reports of the progress.
    pub(super) fn each<T: Sync, R: Send>(
        &self,
        what: &str,
        items: &[T],
        make: impl Fn(&T) -> Result<R, LayerError> + Sync,
    ) -> Result<Vec<R>, LayerError> {
        let checked = |item: &T| self.cancel.check().and_then(|()| make(item));
        each(self.threads, items, checked, |done| (self.progress)(what, done, items.len()))
    }
}
