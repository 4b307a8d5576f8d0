//! Tasks in flight.

use crate::layer::{Cancel, LayerError};
use crate::plugin::task::{BackgroundError, without_panic};
use bevy::platform::time::Instant;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};

/// What a task has made.
pub(super) struct Made<T> {
    pub value: T,
    /// Seconds that the task took.
    pub seconds: f64,
}

/// A task in flight.
pub(super) struct Job<T> {
    cancel: Cancel,
    task: Task<Result<Made<T>, BackgroundError>>,
}

/// A cancelled task that may occupy a thread for a moment.
pub(super) struct Stopping(Box<dyn FnMut() -> bool + Send + Sync>);

impl<T: Send + 'static> Job<T> {
    /// Starts `work` on a background thread.
    pub fn start(work: impl FnOnce(&Cancel) -> Result<T, LayerError> + Send + 'static) -> Self {
        let cancel = Cancel::new();
        let token = cancel.clone();
        let task = AsyncComputeTaskPool::get().spawn(async move {
            let start = Instant::now();
            let value = without_panic(|| token.check().and_then(|()| work(&token)))?;
            Ok(Made { value, seconds: start.elapsed().as_secs_f64() })
        });
        Self { cancel, task }
    }

    /// The result, once.
    pub fn poll(&mut self) -> Option<Result<Made<T>, BackgroundError>> {
        check_ready(&mut self.task)
    }

    /// Cancels the task.
    pub fn stop(self) -> Stopping {
        let Self { cancel, mut task } = self;
        cancel.cancel();
        Stopping(Box::new(move || check_ready(&mut task).is_some()))
    }
}

impl Stopping {
    /// Whether the task has stopped.
    pub fn is_over(&mut self) -> bool {
        self.0()
    }
}
