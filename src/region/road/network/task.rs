//! How a network is built.

use crate::layer::Cancel;

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
