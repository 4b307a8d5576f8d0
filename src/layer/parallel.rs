//! Work on many threads, in an order that does not show.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Runs `make` on every item, on at most `threads` threads (one at least). Items are taken in order, and results come in the order of
/// the items. After each item, `progress` is told how many are done.
///
/// # Errors
/// An error of `make`; items that other threads have begun by then are finished first.
pub fn each<T: Sync, R: Send, E: Send>(
    threads: usize,
    items: &[T],
    make: impl Fn(&T) -> Result<R, E> + Sync,
    progress: impl Fn(usize) + Sync,
) -> Result<Vec<R>, E> {
    // Threads take the next item from one counter: lists that are split beforehand end at different times.
    let (next, done, failed) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicBool::new(false));
    let take = || {
        let mut out = Vec::new();
        while !failed.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(index) else { break };
            let made = make(item).inspect_err(|_| failed.store(true, Ordering::Relaxed))?;
            out.push((index, made));
            progress(done.fetch_add(1, Ordering::Relaxed) + 1);
        }
        Ok(out)
    };
    let threads = threads.min(items.len()).max(1);
    let parts: Vec<Result<Vec<(usize, R)>, E>> = if threads == 1 {
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
    all.sort_by_key(|(index, _)| *index);
    Ok(all.into_iter().map(|(_, made)| made).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let items: Vec<usize> = (0..100).collect();
        for threads in [0, 1, 3, 500] {
            let done = AtomicUsize::new(0);
            let progress = |n| {
                done.fetch_max(n, Ordering::Relaxed);
            };
            let made = each(threads, &items, |i| Ok::<_, ()>(i * 2), progress);
            assert_eq!(made.map(|m| m[99]), Ok(198));
            assert_eq!(done.into_inner(), 100);
        }
        assert_eq!(each(2, &[], |_: &u8| Ok::<_, ()>(1), |_| ()), Ok(Vec::new()));
    }

    #[test]
    fn an_error_ends_the_work() {
        let items: Vec<usize> = (0..1000).collect();
        let made = AtomicUsize::new(0);
        let fail = |i: &usize| {
            made.fetch_add(1, Ordering::Relaxed);
            if *i == 3 { Err("no") } else { Ok(()) }
        };
        assert_eq!(each(1, &items, fail, |_| ()), Err("no"));
        assert_eq!(made.into_inner(), 4);
    }
}
