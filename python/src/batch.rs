//! Batches: the same evaluation for many states, on several threads, with the same bits on any number of them.
//!
//! Threads are started by the call and end with it: none outlives a fork of the process. Each takes one chunk of states after the other. While
//! they work the interpreter is released, and the calling thread hears its signals between its chunks.

use crate::arguments::{Argument, Rows, broadcast};
use crate::errors;
use crate::results::{Room, size};
use crate::workspace::{Workspace, Workspaces};
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use std::num::NonZero;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Batches of fewer states than this keep the interpreter: to release it would take longer than they do.
const FEW: usize = 4;

/// Speeds of all states of a chunk together: so many take a fraction of a millisecond.
const CHUNK: usize = 2048;

/// Dimensions of an array of results at most: those of arrays of numpy 1.
const MOST_DIMENSIONS: usize = 32;

/// Time between two looks at the signals of the process.
const LOOK: Duration = Duration::from_millis(20);

/// Threads that batches may take; 0 for as many as the machine runs at once.
static THREADS: AtomicUsize = AtomicUsize::new(0);

/// Sets how many threads a batch takes at most. Results do not depend on it.
///
/// Args:
///     count: how many; 0 or None for as many as the machine runs at once.
#[pyfunction]
#[pyo3(signature = (count=None))]
pub fn set_threads(py: Python<'_>, count: Option<i64>) -> PyResult<()> {
    let count = count.unwrap_or(0);
    let count = usize::try_from(count)
        .map_err(|_| errors::argument(py, format!("count is {count}: it must be at least 0")))?;
    THREADS.store(count, Ordering::Relaxed);
    Ok(())
}

fn threads() -> usize {
    match THREADS.load(Ordering::Relaxed) {
        0 => thread::available_parallelism().map_or(1, NonZero::get),
        count => count,
    }
}

/// Evaluates `each` for every state of the arguments, and gives an array for each of the shapes.
///
/// # Errors
/// Arguments that do not broadcast; the error of the first state that has one.
pub fn evaluate<'py, const N: usize, const M: usize>(
    py: Python<'py>,
    workspaces: &Workspaces,
    arguments: [Argument<'py>; N],
    shapes: [&[usize]; M],
    each: impl Fn(&mut Workspace, [&[f64]; N], [&mut [f64]; M]) -> Result<(), hamel::Error> + Sync,
) -> PyResult<[Bound<'py, PyArrayDyn<f64>>; M]> {
    let batch = broadcast(py, &arguments)?;
    let count = size(&batch).ok_or_else(errors::memory)?;
    let most = shapes.iter().map(|shape| shape.len()).max().unwrap_or(0);
    if batch.len() + most > MOST_DIMENSIONS {
        let allowed = MOST_DIMENSIONS - most;
        let message = format!(
            "arguments have {} dimensions before the last: they must have at most {allowed}",
            batch.len()
        );
        return Err(errors::argument(py, message));
    }
    let mut rooms = collect(shapes.map(|shape| Room::new(py, [&batch, shape].concat())))?;
    let is_of_q = arguments.first().is_some_and(Argument::is_configuration);
    let rows = arguments.each_ref().map(|argument| argument.rows(&batch));
    let slices = rooms.each_mut().map(Room::numbers);
    let work = Work {
        workspaces,
        is_of_q,
        rows,
        widths: shapes.map(|shape| shape.iter().product()),
        chunk: CHUNK.div_ceil(workspaces.speeds() + 1),
        rest: Mutex::new(Rest {
            slices,
            states: 0..count,
        }),
        failure: Mutex::new(None),
        is_over: AtomicBool::new(false),
        each,
    };
    let failure = match count < FEW {
        true => work.alone(),
        false => py.detach(|| work.on_threads(count)),
    };
    match failure {
        None => collect(rooms.map(|room| room.array(py))),
        Some(Failure::Interrupt(error)) => Err(error),
        Some(Failure::State(state, error)) => Err(errors::of_state(py, error, state, &batch)),
    }
}

/// All of them, or the first error.
fn collect<T, const M: usize>(all: [PyResult<T>; M]) -> PyResult<[T; M]> {
    let mut found = Vec::with_capacity(M);
    for one in all {
        found.push(one?);
    }
    match found.try_into() {
        Ok(found) => Ok(found),
        // As many went in as come out.
        Err(_) => unreachable!("{M} results of {M}"),
    }
}

/// Why a batch ends early.
enum Failure {
    /// A state that is refused, and its number.
    State(usize, hamel::Error),
    /// A signal, such as Ctrl-C.
    Interrupt(PyErr),
}

/// What no thread has taken yet.
struct Rest<'a, const M: usize> {
    slices: [&'a mut [f64]; M],
    states: Range<usize>,
}

impl<'a, const M: usize> Rest<'a, M> {
    fn take(
        &mut self,
        count: usize,
        widths: &[usize; M],
    ) -> Option<(usize, usize, [&'a mut [f64]; M])> {
        let count = count.min(self.states.len());
        let first = self.states.start;
        self.states.start += count;
        let mut widths = widths.iter();
        let taken = self.slices.each_mut().map(|rest| {
            let width = widths.next().copied().unwrap_or(0);
            rest.split_off_mut(..count * width).unwrap_or_default()
        });
        (count > 0).then_some((first, count, taken))
    }
}

/// An evaluation for all states of a batch.
struct Work<'a, F, const N: usize, const M: usize> {
    workspaces: &'a Workspaces,
    /// Whether the first argument is q.
    is_of_q: bool,
    rows: [Rows<'a>; N],
    widths: [usize; M],
    chunk: usize,
    rest: Mutex<Rest<'a, M>>,
    failure: Mutex<Option<Failure>>,
    is_over: AtomicBool,
    each: F,
}

impl<F, const N: usize, const M: usize> Work<'_, F, N, M>
where
    F: Fn(&mut Workspace, [&[f64]; N], [&mut [f64]; M]) -> Result<(), hamel::Error> + Sync,
{
    fn alone(&self) -> Option<Failure> {
        self.chunks(|| None);
        self.outcome()
    }

    fn on_threads(&self, count: usize) -> Option<Failure> {
        let helpers = threads().min(count / self.chunk).saturating_sub(1);
        thread::scope(|scope| {
            for _ in 0..helpers {
                // Where the system has no more threads, those that there are do the work.
                _ = thread::Builder::new().spawn_scoped(scope, || self.chunks(|| None));
            }
            let mut last = Instant::now();
            self.chunks(|| {
                if last.elapsed() < LOOK {
                    return None;
                }
                last = Instant::now();
                Python::attach(|py| py.check_signals()).err()
            });
        });
        self.outcome()
    }

    /// Chunk after chunk, until none is left or a state fails.
    fn chunks(&self, mut interrupt: impl FnMut() -> Option<PyErr>) {
        let mut workspace = self.workspaces.take();
        while !self.is_over.load(Ordering::Relaxed) {
            let taken = lock(&self.rest).take(self.chunk, &self.widths);
            let Some((first, count, results)) = taken else {
                break;
            };
            if let Some((state, error)) = self.chunk(&mut workspace, first, count, results) {
                self.fail(Failure::State(state, error));
            } else if let Some(error) = interrupt() {
                self.fail(Failure::Interrupt(error));
            }
        }
        self.workspaces.give_back(workspace);
    }

    fn chunk(
        &self,
        workspace: &mut Workspace,
        first: usize,
        count: usize,
        mut results: [&mut [f64]; M],
    ) -> Option<(usize, hamel::Error)> {
        for state in first..first + count {
            let inputs = self.rows.each_ref().map(|rows| rows.row(state));
            let mut widths = self.widths.iter();
            let own = results.each_mut().map(|rest| {
                let width = widths.next().copied().unwrap_or(0);
                rest.split_off_mut(..width).unwrap_or_default()
            });
            let checked = match (self.is_of_q, inputs.first()) {
                (true, Some(q)) => self.workspaces.check_configuration(q),
                _ => Ok(()),
            };
            let done = checked.map_err(hamel::Error::from);
            if let Err(error) = done.and_then(|()| (self.each)(workspace, inputs, own)) {
                return Some((state, error));
            }
        }
        None
    }

    /// Keeps a failure: of several states the first one. Those before it have been taken by other threads, which end their chunks.
    fn fail(&self, failure: Failure) {
        self.is_over.store(true, Ordering::Relaxed);
        let mut known = lock(&self.failure);
        let is_first = match (&*known, &failure) {
            (None, _) | (_, Failure::Interrupt(_)) => true,
            (Some(Failure::State(known, _)), Failure::State(state, _)) => state < known,
            (Some(Failure::Interrupt(_)), _) => false,
        };
        if is_first {
            *known = Some(failure);
        }
    }

    fn outcome(&self) -> Option<Failure> {
        lock(&self.failure).take()
    }
}

/// What a lock holds is whole at all times.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
