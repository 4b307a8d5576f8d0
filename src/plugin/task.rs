//! Questions that are answered in the background.

use crate::layer::{Cancel, LayerError};
use crate::world::World;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::Pin;
use std::task::{Context, Poll};

/// Why a question has no answer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoAnswer {
    /// There is no world yet.
    #[error("there is no world yet")]
    NoWorld,
    /// There is no such thing within reach.
    #[error("there is none within reach")]
    NotFound,
    /// [`SprawlTask::poll`] has given the answer already.
    #[error("the answer has been taken")]
    Taken,
    /// A defect of the generator, in one line.
    #[error("{0}")]
    Defect(String),
}

/// An answer that is worked out in the background. Poll it in a system, or await it in a task. Dropping it cancels the
/// work.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_sprawl::prelude::*;
/// # use bevy_sprawl::world::Route;
/// #[derive(Component)]
/// struct Planning(SprawlTask<Route>);
///
/// fn plan(mut commands: Commands, sprawl: Sprawl, idle: Query<(Entity, &Transform), Without<Planning>>) {
///     for (walker, transform) in &idle {
///         let way = sprawl.route(transform.translation, Vec3::new(400.0, 0.0, 250.0));
///         commands.entity(walker).insert(Planning(way));
///     }
/// }
///
/// fn follow(mut planning: Query<&mut Planning>) {
///     for mut planning in &mut planning {
///         match planning.0.poll() {
///             Some(Ok(route)) => println!("{:.0} m to go", route.length),
///             Some(Err(why)) => warn!("no route: {why}"),
///             None => {} // Not known yet.
///         }
///     }
/// }
/// ```
pub struct SprawlTask<T> {
    task: Option<Task<Result<T, NoAnswer>>>,
    cancel: Cancel,
}

impl<T: Send + 'static> SprawlTask<T> {
    /// Asks `question` of a world. A question that finds `None` has the answer [`NoAnswer::NotFound`].
    pub(super) fn new(
        world: Option<&World>,
        question: impl FnOnce(&World, &Cancel) -> Result<Option<T>, LayerError> + Send + 'static,
    ) -> Self {
        let (world, cancel) = (world.cloned(), Cancel::new());
        let token = cancel.clone();
        let task = AsyncComputeTaskPool::get().spawn(async move {
            let world = world.ok_or(NoAnswer::NoWorld)?;
            match without_panic(|| question(&world, &token)) {
                Ok(answer) => answer.ok_or(NoAnswer::NotFound),
                Err(BackgroundError::Cancelled) => Err(NoAnswer::NotFound),
                Err(BackgroundError::Defect(reason)) => Err(NoAnswer::Defect(reason)),
            }
        });
        Self { task: Some(task), cancel }
    }

    /// The answer, once it is known. `None` while the work goes on, and after the answer has been taken.
    pub fn poll(&mut self) -> Option<Result<T, NoAnswer>> {
        let answer = self.task.as_mut().and_then(check_ready)?;
        self.task = None;
        Some(answer)
    }
}

impl<T: Send + 'static> Future for SprawlTask<T> {
    type Output = Result<T, NoAnswer>;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        match &mut self.task {
            Some(task) => Pin::new(task).poll(context),
            None => Poll::Ready(Err(NoAnswer::Taken)),
        }
    }
}

impl<T> Drop for SprawlTask<T> {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}

/// Why background work has no result.
pub(super) enum BackgroundError {
    Cancelled,
    /// A defect of the generator, in one line.
    Defect(String),
}

/// Runs `work`. A defect of the generator, even a panic, costs one result and not the game.
pub(super) fn without_panic<T>(work: impl FnOnce() -> Result<T, LayerError>) -> Result<T, BackgroundError> {
    match catch_panic(work).map_err(BackgroundError::Defect)? {
        Ok(result) => Ok(result),
        Err(LayerError::Cancelled) => Err(BackgroundError::Cancelled),
        Err(error) => Err(BackgroundError::Defect(error.to_string())),
    }
}

/// Runs `work`. A panic becomes an error that says why, in one line.
pub(super) fn catch_panic<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
        format!("the generator panicked: {text}")
    })
}
