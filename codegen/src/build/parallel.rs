//! Independent work on all cores, with results in the order of the items.

use std::cmp::Reverse;
use std::num::NonZero;
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Applies `work` to each item. Those of the largest size come first, so that no core waits for one of them at the end.
pub fn map<T: Send, U: Send>(
    items: Vec<T>,
    size: impl Fn(&T) -> usize,
    work: impl Fn(T) -> U + Sync,
) -> Vec<U> {
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let mut items: Vec<(usize, T)> = items.into_iter().enumerate().collect();
    items.sort_by_key(|(_, item)| Reverse(size(item)));
    let queue = Mutex::new(items.into_iter());
    let take = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    let run = || {
        let mut done = vec![];
        while let Some((place, item)) = take() {
            done.push((place, work(item)));
        }
        done
    };
    let mut results: Vec<(usize, U)> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(run)).collect();
        let joined = workers.into_iter().map(|worker| match worker.join() {
            Ok(done) => done,
            Err(panic) => std::panic::resume_unwind(panic),
        });
        joined.flatten().collect()
    });
    results.sort_by_key(|(place, _)| *place);
    results.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn results_keep_the_order_of_the_items() {
        let items: Vec<u32> = (0..100).collect();
        let doubled = super::map(items, |item| (item * 37 % 101) as usize, |item| 2 * item);
        assert!(
            doubled
                .iter()
                .enumerate()
                .all(|(place, value)| 2 * place == *value as usize)
        );
    }
}
