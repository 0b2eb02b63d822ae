//! Threads that read files.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::Error;

/// Works on every item, on as many threads as there are workers, and returns the results in the order of the items.
///
/// The threads are no workers of a pool: one that waits for the pool of a decoder would be given the next file on the
/// same stack.
pub(super) fn in_order<T: Sync, R: Send>(
    items: &[T],
    threads: usize,
    work: impl Fn(&T) -> R + Sync,
) -> Result<Vec<R>, Error> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(index) else {
                return done;
            };
            done.push((index, work(item)));
        }
    };
    let mut done = thread::scope(|scope| {
        let workers = (0..threads.max(1).min(items.len()))
            .map(|_| thread::Builder::new().spawn_scoped(scope, worker))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|problem| Error::Thread { problem })?;
        let results = workers.into_iter().map(|worker| {
            let result = worker.join();
            result.unwrap_or_else(|cause| std::panic::resume_unwind(cause))
        });
        Ok::<_, Error>(results.flatten().collect::<Vec<_>>())
    })?;
    done.sort_by_key(|(index, _)| *index);
    Ok(done.into_iter().map(|(_, result)| result).collect())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_the_order_of_the_items() {
        let items: Vec<usize> = (0..1000).collect();
        assert_eq!(in_order(&items, 3, |item| *item).unwrap(), items);
        assert!(
            in_order(&[] as &[usize], 3, |item| *item)
                .unwrap()
                .is_empty()
        );
    }
}
