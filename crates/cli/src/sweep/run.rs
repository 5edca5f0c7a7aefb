//! The command itself: checks all that can be checked before anything moves, moves what is missing, and tells the summary.

use super::args::{Args, Format};
use super::equations::Moving;
use super::folder::Folder;
use super::manifest::{Input, Manifest, Options};
use super::progress::Progress;
use super::summary::Summary;
use super::{level, parquet, table};
use crate::input;
use fnv::FnvHasher;
use hamel::registry::JointRegistry;
use hamel_console::interrupt::{self, Heed};
use hamel_console::output::{self, Failure};
use hamel_sweep::{Block, Movers, Sweep, SweepError, Watch};
use std::hash::Hasher;
use std::path::Path;
use std::time::Instant;

/// Numbers of a part at most, 16 MB of them, unless `--block` says otherwise.
const MOST_CELLS: u64 = 2_000_000;

/// Sweeps the scene of `args` over its table.
///
/// # Errors
/// Mistakes in the scene, the columns or the options; files that cannot be read or written; an interrupt.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    if let Some(wanted) = &args.level {
        level::ensure(wanted)?;
    }
    let input = input::Input::read(&args.scene, &args.robot)?;
    let text = input.scene_text()?;
    let table = table::Table::open(&args.over)?;
    let sweep = sweep(args, &text, input.name(), table.names(), registry)?;
    if let Some(row) = args.scene_of {
        return print_scene(&sweep, table, row.get(), &args.over);
    }
    let Some(output) = &args.output else {
        return Err(Failure::Options("--output is missing".into()));
    };
    let rows = table.count()?;
    let moving = Moving::new(args, &sweep, registry, rows)?;
    let size = (rows, moving.least_block());
    let mut folder = folder(args, &text, size, (&sweep, output))?;
    let start = Instant::now();
    let moved = move_missing(args, &sweep, &folder, moving.movers())?;
    let work = (moved, start.elapsed(), moving.ways(moved));
    if moved > 0 {
        folder.tell(work.2.clone())?;
    }
    let summary = Summary::of(&folder, &sweep, work)?;
    summary.write(&folder)?;
    match (args.json, args.quiet) {
        (true, _) => output::print_json(&summary.told()),
        (false, true) => Ok(()),
        (false, false) => output::print(&summary.to_string()),
    }
}

fn sweep(
    args: &Args,
    text: &str,
    name: &str,
    columns: &[String],
    registry: &JointRegistry,
) -> Result<Sweep, Failure> {
    if columns.is_empty() {
        let shown = args.over.display();
        return Err(Failure::Options(format!("{shown} has no columns")));
    }
    let sweep = Sweep::new(text, name, columns, registry);
    let sweep = match args.no_error_estimate {
        true => sweep,
        false => sweep.and_then(|sweep| sweep.estimating(registry)),
    };
    let sweep = sweep.and_then(|sweep| match args.sample_step {
        Some(step) => sweep.sampling_every(step, registry),
        None => sweep.sampling(&args.at, registry),
    });
    sweep.map_err(|error| match error {
        SweepError::Scene(mistakes) => mistakes.into(),
        SweepError::Columns(refused) | SweepError::Times(refused) => {
            Failure::Options(refused.join("\nerror: "))
        }
        other => Failure::Options(other.to_string()),
    })
}

/// The folder for the results, new or resumed.
fn folder(
    args: &Args,
    scene: &str,
    (rows, least_block): (u64, u64),
    (sweep, output): (&Sweep, &Path),
) -> Result<Folder, Failure> {
    if rows == 0 {
        let shown = args.over.display();
        return Err(Failure::Options(format!("{shown} has no rows")));
    }
    let format = match args.format {
        Some(format) => format,
        None => table::format(&args.over)?,
    };
    if format == Format::Parquet {
        parquet::check()?;
    }
    let (sum, bytes) = table::sum_of(&args.over)?;
    let inputs = [
        Input {
            name: name(&args.scene),
            sum: sum_of(scene),
            bytes: scene.len() as u64,
        },
        Input {
            name: name(&args.over),
            sum,
            bytes,
        },
    ];
    let columns = sweep.results().len();
    let usual = || usual_block(rows, least_block, columns);
    let block = args.block.map_or_else(usual, |block| block.get());
    let options = Options {
        format,
        error_estimate: !args.no_error_estimate,
        equations: args.equations,
        times: sweep.times(),
    };
    let manifest = Manifest::new(inputs, rows, block, options);
    Folder::open(output, manifest, format, args.block.is_none())
}

/// A 64th of the rows, so that a kill of a small sweep of long motions loses little, and not so many that a large one holds much in memory; a multiple of those that go side by side.
fn usual_block(rows: u64, least: u64, columns: usize) -> u64 {
    let most = (MOST_CELLS / columns.max(1) as u64).min(5000);
    let block = rows.div_ceil(64).clamp(least, most.max(least));
    block.next_multiple_of(least)
}

fn name(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

fn sum_of(text: &str) -> String {
    let mut hasher = FnvHasher::default();
    hasher.write(text.as_bytes());
    format!("{:016x}", hasher.finish())
}

/// Moves the rows of all parts that are not there, and tells how many.
fn move_missing(
    args: &Args,
    sweep: &Sweep,
    folder: &Folder,
    movers: &dyn Movers,
) -> Result<u64, Failure> {
    let is_missing = |part: &u64| !folder.part(*part).exists();
    let missing = (0..folder.parts()).filter(is_missing);
    let rows: u64 = missing.map(|part| folder.rows_of(part)).sum();
    if rows == 0 {
        return Ok(0);
    }
    let progress = Progress::new(folder.manifest.rows, rows, args.quiet);
    let heed = Heed::keys();
    let mut table = table::Table::open(&args.over)?;
    let mut part = 0;
    let next = || {
        while part < folder.parts() {
            let (own, count) = (part, folder.rows_of(part));
            part += 1;
            let rows = table.rows(count)?;
            if rows.len() as u64 != count {
                let why = "its rows have become fewer meanwhile";
                return Err(table::unreadable(&args.over, &why));
            }
            if is_missing(&own) {
                let first = own * folder.manifest.block;
                return Ok(Some(Block { first, rows }));
            }
        }
        Ok(None)
    };
    let watch = Watch {
        done: &|rows| progress.done(rows),
        pause: &interrupt::is_requested,
        ..Watch::NONE
    };
    let write = |block: &Block, rows: &[_]| folder.write(sweep.results(), block, rows);
    let moved = hamel_sweep::run_by(movers, args.workers, next, &write, watch);
    progress.finish();
    drop(heed);
    moved?;
    let left: u64 = (0..folder.parts())
        .filter(is_missing)
        .map(|part| folder.rows_of(part))
        .sum();
    match left {
        0 => Ok(rows),
        left => Err(Failure::Interrupted(format!(
            "the results of {} of {} rows are in {}; the same command goes on from there",
            folder.manifest.rows - left,
            folder.manifest.rows,
            folder.path().display()
        ))),
    }
}

/// Prints the scene of a row, from 1.
fn print_scene(
    sweep: &Sweep,
    mut table: table::Table,
    row: u64,
    path: &Path,
) -> Result<(), Failure> {
    let mut left = row;
    // No more in memory than of a block.
    while left > 1 {
        let skipped = table.rows((left - 1).min(5000))?.len() as u64;
        if skipped == 0 {
            break;
        }
        left -= skipped;
    }
    let found = table.rows(1)?.pop().filter(|_| left == 1);
    let cells = found.ok_or_else(|| {
        let before = row - left;
        Failure::Options(format!(
            "--scene-of is {row}, and {} has {before} rows",
            path.display()
        ))
    })?;
    let scene = sweep.scene_of(&cells);
    let scene = scene.ok_or_else(|| {
        let why = cells.fault.unwrap_or_default();
        Failure::Refused(format!("row {row} has no scene: {why}"))
    })?;
    output::print(&scene)
}
