//! All rows of a table, on many threads.

use crate::motion::Sweep;
use crate::results::Row;
use hamel::registry::JointRegistry;
use std::num::NonZero;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

/// Rows that a thread takes at once: few, so that all threads end a table together.
const TAKEN: usize = 4;

/// What moves rows on many threads.
pub trait Movers: Sync {
    /// What one thread moves them by.
    fn mover(&self) -> Box<dyn Mover + '_>;

    /// How many rows a thread takes at once.
    fn taken(&self) -> usize {
        TAKEN
    }
}

/// What moves rows on one thread.
pub trait Mover {
    /// The results of rows, as many as there are rows, each of which depends on its row alone; none where `watch` tells to stop. Says on the way how many are done.
    fn rows(&mut self, rows: &[Cells], watch: Watch<'_>) -> Option<Vec<Row>>;
}

/// Rows that move one by one, by the equations of the tree.
#[derive(Clone, Copy, Debug)]
pub struct ByTree<'a> {
    /// What moves.
    pub sweep: &'a Sweep,
    /// Its joints.
    pub registry: &'a JointRegistry,
}

impl Movers for ByTree<'_> {
    fn mover(&self) -> Box<dyn Mover + '_> {
        Box::new(*self)
    }
}

impl Mover for ByTree<'_> {
    fn rows(&mut self, rows: &[Cells], watch: Watch<'_>) -> Option<Vec<Row>> {
        let moved = rows.iter().map(|row| {
            let moved = self.sweep.motion_until(row, self.registry, watch.stop);
            (watch.done)(usize::from(moved.is_some()));
            moved
        });
        moved.collect()
    }
}

/// One row of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cells {
    /// One number for each column.
    pub numbers: Vec<f64>,
    /// Why it has no numbers, where it has none.
    pub fault: Option<String>,
}

impl<N: Into<Vec<f64>>> From<N> for Cells {
    fn from(numbers: N) -> Self {
        Self {
            numbers: numbers.into(),
            fault: None,
        }
    }
}

/// Rows that follow each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Place of the first among all rows of the table, from 0.
    pub first: u64,
    /// The rows.
    pub rows: Vec<Cells>,
}

/// What [`run`] tells and asks on the way.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Hears that so many rows more are done.
    pub done: &'a (dyn Fn(usize) + Sync),
    /// Whether no further block is to begin.
    pub pause: &'a (dyn Fn() -> bool + Sync),
    /// Whether motions are to end where they are, without results.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}

impl Watch<'_> {
    /// Nobody.
    pub const NONE: Self = Self {
        done: &|_| {},
        pause: &|| false,
        stop: &|| false,
    };
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch").finish_non_exhaustive()
    }
}

/// Takes a block with its results, in the order of its rows.
pub type Write<'a, E> = dyn Fn(&Block, &[Row]) -> Result<(), E> + Sync + 'a;

/// A block of which rows are being moved.
struct Open {
    block: Block,
    results: Mutex<(Vec<Option<Row>>, usize)>,
}

/// Where blocks come from, and the one whose rows are being taken.
struct Feed<N, E> {
    next: N,
    /// Rows that a thread takes at once.
    taken: usize,
    open: Option<(Arc<Open>, usize)>,
    /// Whether nothing more is to be taken, and what went wrong.
    is_over: bool,
    failure: Option<E>,
}

/// Moves the rows of the blocks that `next` gives, by `workers` threads (all cores where it is `None`), and gives each block with its results, in the order of its rows, to
/// `write`. Blocks may be written in another order than they come; no more of them are held than there are threads. A row's results depend on the row alone.
///
/// # Errors
/// The first that `next` or `write` has; nothing further is begun then.
pub fn run<E: Send>(
    sweep: &Sweep,
    registry: &JointRegistry,
    workers: Option<NonZero<usize>>,
    next: impl FnMut() -> Result<Option<Block>, E> + Send,
    write: &Write<'_, E>,
    watch: Watch<'_>,
) -> Result<(), E> {
    run_by(&ByTree { sweep, registry }, workers, next, write, watch)
}

/// The same with rows that `movers` move.
///
/// # Errors
/// Those of [`run`].
///
/// # Panics
/// Where a mover gives fewer or more results than rows.
pub fn run_by<E: Send>(
    movers: &dyn Movers,
    workers: Option<NonZero<usize>>,
    next: impl FnMut() -> Result<Option<Block>, E> + Send,
    write: &Write<'_, E>,
    watch: Watch<'_>,
) -> Result<(), E> {
    let feed = Mutex::new(Feed {
        next,
        taken: movers.taken().max(1),
        open: None,
        is_over: false,
        failure: None,
    });
    let workers = workers.or_else(|| thread::available_parallelism().ok());
    thread::scope(|scope| {
        for _ in 1..workers.map_or(1, NonZero::get) {
            let work = || work(movers, &feed, write, watch);
            if thread::Builder::new().spawn_scoped(scope, work).is_err() {
                // Where the system has no more threads, those that there are do the work.
                break;
            }
        }
        work(movers, &feed, write, watch);
    });
    let feed = feed.into_inner().unwrap_or_else(PoisonError::into_inner);
    feed.failure.map_or(Ok(()), Err)
}

fn work<E: Send, N: FnMut() -> Result<Option<Block>, E> + Send>(
    movers: &dyn Movers,
    feed: &Mutex<Feed<N, E>>,
    write: &Write<'_, E>,
    watch: Watch<'_>,
) {
    let (mut mover, taken) = (movers.mover(), movers.taken().max(1));
    loop {
        // The lock is given back before anything moves.
        let next = locked(feed).take(watch.pause);
        let Some((open, first)) = next else {
            return;
        };
        let rows = &open.block.rows[first..];
        let rows = &rows[..rows.len().min(taken)];
        let Some(moved) = mover.rows(rows, watch) else {
            locked(feed).is_over = true;
            return;
        };
        assert_eq!(
            moved.len(),
            rows.len(),
            "a mover gives a result for each row"
        );
        if let Some(results) = open.put(first, moved)
            && let Err(error) = write(&open.block, &results)
        {
            locked(feed).fail(error);
        }
    }
}

impl<E, N: FnMut() -> Result<Option<Block>, E>> Feed<N, E> {
    /// Rows of a block, from a place on; a new block is begun where none is open.
    fn take(&mut self, pause: &dyn Fn() -> bool) -> Option<(Arc<Open>, usize)> {
        if self.is_over {
            return None;
        }
        if self.open.is_none() && !pause() {
            self.open = match (self.next)() {
                Ok(block) => block.map(|block| (Arc::new(Open::new(block)), 0)),
                Err(error) => {
                    self.fail(error);
                    None
                }
            };
        }
        let Some((open, first)) = self.open.take() else {
            self.is_over = true;
            return None;
        };
        let rest = first + self.taken;
        if rest < open.block.rows.len() {
            self.open = Some((Arc::clone(&open), rest));
        }
        Some((open, first))
    }

    fn fail(&mut self, error: E) {
        self.is_over = true;
        self.failure.get_or_insert(error);
    }
}

impl Open {
    fn new(block: Block) -> Self {
        let count = block.rows.len();
        Self {
            results: Mutex::new((vec![None; count], count)),
            block,
        }
    }

    /// Takes the results of rows from `first` on; gives all of the block where none is missing any more.
    fn put(&self, first: usize, moved: Vec<Row>) -> Option<Vec<Row>> {
        let mut results = locked(&self.results);
        let (rows, missing) = &mut *results;
        *missing -= moved.len();
        for (place, row) in rows[first..].iter_mut().zip(moved) {
            *place = Some(row);
        }
        match missing {
            0 => std::mem::take(rows).into_iter().collect(),
            _ => None,
        }
    }
}

/// A panic in another thread ends the program when its threads are joined.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
