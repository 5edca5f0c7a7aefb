//! By which equations the rows of a sweep move.

use super::args::{Args, Equations};
use super::table;
use hamel::registry::JointRegistry;
use hamel_console::output::Failure;
use hamel_lanes::{Lanes, Plan, Ways};
use hamel_sweep::{ByTree, Cells, Movers, Sweep};

/// What moves the rows.
pub enum Moving<'a> {
    /// Side by side what can.
    Lanes(Box<Lanes<'a>>),
    /// One by one, and why, unless that was asked for.
    Tree(ByTree<'a>, Option<String>),
}

impl<'a> Moving<'a> {
    /// What the options ask for, of a table of `rows` rows.
    ///
    /// # Errors
    /// A table that cannot be read; rows that are to go side by side and cannot.
    pub fn new(
        args: &Args,
        sweep: &'a Sweep,
        registry: &'a JointRegistry,
        rows: u64,
    ) -> Result<Self, Failure> {
        let by_tree = ByTree { sweep, registry };
        if args.equations == Equations::Tree {
            return Ok(Self::Tree(by_tree, None));
        }
        let sample = match sweep.estimates() {
            true => vec![],
            false => sample(args, rows)?,
        };
        match Plan::new(sweep, registry, &sample) {
            Ok(plan) => Ok(Self::Lanes(Box::new(Lanes::new(sweep, registry, plan)))),
            Err(why) if args.equations == Equations::Lanes => Err(Failure::Options(format!(
                "no row can move by --equations lanes: {why}"
            ))),
            Err(why) => Ok(Self::Tree(by_tree, Some(why))),
        }
    }

    /// As rows are handed out.
    pub fn movers(&self) -> &dyn Movers {
        match self {
            Self::Lanes(lanes) => &**lanes,
            Self::Tree(tree, _) => tree,
        }
    }

    /// Rows of a part at least.
    pub fn least_block(&self) -> u64 {
        match self {
            Self::Lanes(lanes) => lanes.taken() as u64,
            Self::Tree(..) => 8,
        }
    }

    /// Which way the `moved` rows went.
    pub fn ways(&self, moved: u64) -> Ways {
        match self {
            Self::Lanes(lanes) => lanes.ways(),
            Self::Tree(_, why) => Ways {
                lanes: 0,
                tree: why
                    .iter()
                    .filter(|_| moved > 0)
                    .map(|why| (why.clone(), moved))
                    .collect(),
            },
        }
    }
}

/// The rows that decide which numbers differ from row to row, whatever has been moved already.
fn sample(args: &Args, rows: u64) -> Result<Vec<Cells>, Failure> {
    let mut table = table::Table::open(&args.over)?;
    let (mut sample, mut next) = (vec![], 0);
    for wanted in hamel_lanes::sample(rows) {
        while next < wanted {
            // No more in memory than of a block.
            let skipped = table.rows((wanted - next).min(5000))?.len() as u64;
            if skipped == 0 {
                return Ok(sample);
            }
            next += skipped;
        }
        let row = table.rows(1)?;
        next += row.len() as u64;
        sample.extend(row);
    }
    Ok(sample)
}
