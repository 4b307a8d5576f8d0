//! Parallel work whose result does not depend on the order of execution.

use super::task::NetworkTask;
use crate::layer::LayerError;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Runs `make` on every item, on as many threads as the task says. The results have the order of the items.
pub(super) fn each<T: Sync, R: Send>(
    task: &NetworkTask<'_>,
    what: &str,
    items: &[T],
    make: impl Fn(&T) -> Result<R, LayerError> + Sync,
) -> Result<Vec<R>, LayerError> {
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let take = || {
        let mut out = Vec::new();
        while let Some((i, item)) = Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, items.get(i)?))) {
            task.cancel.check()?;
            out.push((i, make(item)?));
            (task.progress)(what, done.fetch_add(1, Ordering::Relaxed) + 1, items.len());
        }
        Ok(out)
    };
    let threads = task.threads.clamp(1, items.len().max(1));
    let parts: Vec<Result<Vec<(usize, R)>, LayerError>> = if threads == 1 {
        vec![take()]
    } else {
        std::thread::scope(|scope| {
            let running: Vec<_> = (0..threads).map(|_| scope.spawn(take)).collect();
            let joined = running.into_iter().map(|t| t.join().unwrap_or_else(|e| std::panic::resume_unwind(e)));
            joined.collect()
        })
    };
    let mut all = Vec::with_capacity(items.len());
    for part in parts {
        all.extend(part?);
    }
    all.sort_by_key(|(i, _)| *i);
    Ok(all.into_iter().map(|(_, r)| r).collect())
}
