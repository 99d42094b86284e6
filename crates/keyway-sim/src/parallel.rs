//! Parallel work on several threads, for simulations, experiments and pictures.
//!
//! Results never depend on the number of threads: items do not share state, and results come in
//! the order of the items.

use std::sync::{Mutex, PoisonError, mpsc};
use std::thread::Builder;

/// Number of threads that this computer runs concurrently.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Processes every item, on at most this many threads. An idle thread takes the next item, in
/// order. If fewer threads are available, they process all items.
///
/// # Panics
/// Panics if the work panics.
pub fn for_each<T: Send>(
    items: impl IntoIterator<Item = T, IntoIter: Send>,
    jobs: usize,
    work: impl Fn(T) + Sync,
) {
    let items = Mutex::new(items.into_iter());
    // A poisoned lock still holds the remaining items.
    let next = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
    let all = || {
        while let Some(item) = next() {
            work(item);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..jobs {
            if Builder::new().spawn_scoped(scope, all).is_err() {
                break;
            }
        }
        all();
    });
}

/// Processes every item, on at most this many other threads, while this thread receives the
/// results as they come. The first error of `receive` ends the work: items that have begun are
/// finished, and their results are dropped.
///
/// # Errors
/// Returns the error of `receive`.
///
/// # Panics
/// Panics if the work panics.
pub fn receive_each<T, R: Send, E>(
    items: impl IntoIterator<Item = T, IntoIter: Send>,
    jobs: usize,
    work: impl Fn(T) -> R + Sync,
    mut receive: impl FnMut(R) -> Result<(), E>,
) -> Result<(), E> {
    let items = Mutex::new(items.into_iter());
    let next = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
    let (sender, receiver) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..jobs {
            let sender = sender.clone();
            let all = || {
                let sender = sender;
                while let Some(item) = next() {
                    // The receiver is gone after an error.
                    if sender.send(work(item)).is_err() {
                        break;
                    }
                }
            };
            if Builder::new().spawn_scoped(scope, all).is_err() {
                break;
            }
        }
        drop(sender);
        for result in receiver {
            receive(result)?;
        }
        // Only if there was no other thread.
        while let Some(item) = next() {
            receive(work(item))?;
        }
        Ok(())
    })
}

/// Maps every item with at most this many threads, and returns the results in the order of the
/// items.
///
/// # Panics
/// Panics if the work panics.
pub fn in_parallel<T: Sync, R: Send>(
    items: &[T],
    jobs: usize,
    work: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    let mut results: Vec<Option<R>> = items.iter().map(|_| None).collect();
    let places = items.iter().zip(&mut results);
    for_each(places, jobs.min(items.len()), |(item, result)| *result = Some(work(item)));
    // All items are processed: otherwise the work has panicked, and so has the scope.
    results.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn results_come_in_order_on_any_number_of_threads() {
        let items: Vec<u64> = (0..100).collect();
        let expected: Vec<u64> = items.iter().map(|item| item * item).collect();
        for jobs in [0, 1, 2, 7, 200] {
            assert_eq!(in_parallel(&items, jobs, |item| item * item), expected, "{jobs}");
        }
        assert!(in_parallel(&[0; 0], 3, |_| 1).is_empty());
    }

    #[test]
    fn every_item_is_worked_on_once() {
        let mut items = vec![0; 1000];
        for_each(&mut items, 4, |item| *item += 1);
        assert!(items.iter().all(|&item| item == 1));
    }

    #[test]
    fn results_are_received_until_the_first_error() {
        for jobs in [0, 1, 3] {
            let mut sum = 0;
            let all = receive_each(
                1..=10,
                jobs,
                |item| item * item,
                |square| {
                    sum += square;
                    Ok::<(), ()>(())
                },
            );
            assert_eq!((all, sum), (Ok(()), 385), "{jobs}");
            let worked = AtomicUsize::new(0);
            let work = |item: usize| {
                worked.fetch_add(1, Ordering::Relaxed);
                item
            };
            let mut received = 0;
            let stopped = receive_each(0..1_000_000, jobs, work, |_| {
                received += 1;
                if received < 5 { Ok(()) } else { Err(received) }
            });
            assert_eq!(stopped, Err(5));
            assert!(worked.load(Ordering::Relaxed) < 1_000_000, "{jobs}");
        }
    }

    #[test]
    fn a_panic_is_not_lost() {
        let seen = AtomicUsize::new(0);
        let work = |item: &u32| {
            seen.fetch_add(1, Ordering::Relaxed);
            assert_ne!(*item, 3);
        };
        let panicked = std::panic::catch_unwind(|| in_parallel(&[1, 2, 3, 4, 5], 2, work));
        assert!(panicked.is_err() && seen.load(Ordering::Relaxed) >= 3);
    }
}
