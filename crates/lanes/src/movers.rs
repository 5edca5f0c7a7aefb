//! Rows of a sweep, moved side by side where they can be, and by the tree where not.

use crate::joints::Joints;
use crate::machine::WIDTH;
use crate::motion::{End, Start, moved};
use crate::plan::Plan;
use crate::row::{Alone, Described, described};
use hamel::dynamics::Dynamics;
use hamel::integrate::State;
use hamel::registry::JointRegistry;
use hamel::scene::{Scene, Starts};
use hamel_sweep::{Cells, Mover, Movers, Outcome, Row, Sweep, Watch};
use std::borrow::Cow;
use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};

/// Why a motion that began side by side goes by the tree.
const LEFT: &str = "its numbers do not stay finite, or a joint turns far in one step";
/// Why a motion does not begin side by side.
const REFUSED: &str = "the equations of the tree refuse its first state";

/// Which way rows went that have a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ways {
    /// How many went side by side.
    pub lanes: u64,
    /// How many went by the tree, by reason.
    pub tree: BTreeMap<String, u64>,
}

/// A sweep whose rows go side by side where they can.
#[derive(Debug)]
pub struct Lanes<'a> {
    sweep: &'a Sweep,
    registry: &'a JointRegistry,
    plan: Arc<Plan>,
    ways: Mutex<Ways>,
}

impl<'a> Lanes<'a> {
    /// The rows of `sweep`, by the equations that were made for it.
    pub fn new(sweep: &'a Sweep, registry: &'a JointRegistry, plan: impl Into<Arc<Plan>>) -> Self {
        Self {
            sweep,
            registry,
            plan: plan.into(),
            ways: Mutex::default(),
        }
    }

    /// What the rows move by.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Which way the rows went that were moved so far.
    pub fn ways(&self) -> Ways {
        self.ways
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }
}

impl Movers for Lanes<'_> {
    fn mover(&self) -> Box<dyn Mover + '_> {
        Box::new(Own {
            lanes: self,
            joints: Joints::default(),
            last: None,
        })
    }

    fn taken(&self) -> usize {
        WIDTH
    }
}

/// What one thread has.
struct Own<'a> {
    lanes: &'a Lanes<'a>,
    joints: Joints,
    /// The last row that was built and went side by side: those that follow may differ from it in their starts alone.
    last: Option<Rc<Built>>,
}

/// A row that has been built.
struct Built {
    tree: RefCell<Tree>,
    row: Described,
    cells: Cells,
    /// The numbers of it that differ.
    numbers: Vec<f64>,
    /// Its joints, from the first row on that differs in their states alone.
    starts: OnceCell<Option<RefCell<Starts>>>,
}

/// The equations of a row by the tree, which judge the first state: steps side by side would divide by what is no more than rounding.
struct Tree {
    dynamics: Box<dyn Dynamics>,
    efforts: Vec<f64>,
    rates: Vec<f64>,
}

impl Tree {
    fn new(scene: &Scene) -> Self {
        let sizes = scene.mechanism.layout();
        Self {
            dynamics: scene.settings.arithmetic.dynamics(&scene.mechanism),
            efforts: vec![0.0; sizes.freedoms],
            rates: vec![0.0; sizes.speeds],
        }
    }

    /// Whether what is in this state has accelerations.
    fn accepts(&mut self, state: &State) -> bool {
        let (q, speeds) = (&state.configuration, &state.speeds);
        let found = self
            .dynamics
            .forward_dynamics(q, speeds, &self.efforts, &mut self.rates);
        found.is_ok()
    }
}

/// What is known of a row.
enum Known {
    /// Why the tree is to move it.
    Tree(Cow<'static, str>),
    /// Its result.
    Done(Row),
}

impl Mover for Own<'_> {
    fn rows(&mut self, rows: &[Cells], watch: Watch<'_>) -> Option<Vec<Row>> {
        let mut results = Vec::with_capacity(rows.len());
        for rows in rows.chunks(WIDTH) {
            results.extend(self.block(rows, watch)?);
        }
        Some(results)
    }
}

impl Built {
    /// The state at time 0 of a row that differs from this one in that alone.
    fn start(&self, lanes: &Lanes<'_>, cells: &Cells) -> Option<State> {
        let Lanes {
            sweep, registry, ..
        } = lanes;
        if !sweep.differ_in_starts_alone(&self.cells, cells) {
            return None;
        }
        let starts = || self.row.description.starts(registry).map(RefCell::new);
        let mut starts = self.starts.get_or_init(starts).as_ref()?.borrow_mut();
        sweep.start(&mut starts, cells)
    }

    /// The row from this state on.
    fn starting_at(self: Rc<Self>, state: State) -> Result<(Rc<Self>, State), Known> {
        let is_accepted = self.tree.borrow_mut().accepts(&state);
        match is_accepted {
            true => Ok((self, state)),
            false => Err(Known::Tree(REFUSED.into())),
        }
    }
}

impl Own<'_> {
    /// What goes side by side, and its first state.
    fn start(&mut self, cells: &Cells) -> Result<(Rc<Built>, State), Known> {
        let Lanes {
            sweep,
            registry,
            plan,
            ..
        } = self.lanes;
        if let Some(built) = &self.last
            && let Some(state) = built.start(self.lanes, cells)
        {
            return Rc::clone(built).starting_at(state);
        }
        let row = described(sweep, registry, &self.joints, cells).map_err(|alone| match alone {
            Alone::Refused(row) => Known::Done(row),
            Alone::Tree(reason) => Known::Tree(reason.into()),
        })?;
        let numbers = plan.numbers(&row);
        let numbers = numbers.map_err(|reason| Known::Tree(reason.into()))?;
        let state = row.scene.start();
        let built = Rc::new(Built {
            tree: RefCell::new(Tree::new(&row.scene)),
            row,
            cells: cells.clone(),
            numbers,
            starts: OnceCell::new(),
        });
        self.last = Some(Rc::clone(&built));
        built.starting_at(state)
    }

    fn block(&mut self, rows: &[Cells], watch: Watch<'_>) -> Option<Vec<Row>> {
        let lanes = self.lanes;
        let (mut going, mut states) = (vec![], vec![]);
        let mut known = Vec::with_capacity(rows.len());
        for (place, cells) in rows.iter().enumerate() {
            known.push(match self.start(cells) {
                Ok((built, state)) => {
                    going.push((place, built));
                    states.push(state);
                    // The tree's until it has a result.
                    Known::Tree(LEFT.into())
                }
                Err(known) => known,
            });
        }
        let refused = known.iter().filter(|row| matches!(row, Known::Done(_)));
        (watch.done)(refused.count());
        let starts = going.iter().zip(states).map(|((_, built), state)| Start {
            scene: &built.row.scene,
            state,
            numbers: &built.numbers,
            dt: built.row.dt,
            track: lanes.sweep.track(),
        });
        let ends = moved(&lanes.plan, starts.collect(), lanes.sweep, watch.stop)?;
        let mut moved_here = 0;
        for ((place, built), end) in going.iter().zip(ends) {
            let Some(End {
                state,
                steps,
                track,
            }) = end
            else {
                continue;
            };
            let row = lanes.sweep.ended(&built.row.scene, &state, steps, &track);
            if row.outcome == Outcome::Ended {
                (watch.done)(1);
                moved_here += 1;
                known[*place] = Known::Done(row);
            }
        }
        let mut counted = Ways::default();
        let results = known.into_iter().zip(rows).map(|(row, cells)| {
            let reason = match row {
                Known::Done(row) => return Some(row),
                Known::Tree(reason) => reason,
            };
            *counted.tree.entry(reason.into_owned()).or_default() += 1;
            let row = lanes
                .sweep
                .motion_until(cells, lanes.registry, watch.stop)?;
            (watch.done)(1);
            Some(row)
        });
        let results = results.collect::<Option<Vec<Row>>>()?;
        counted.lanes = moved_here;
        lanes.count(counted);
        Some(results)
    }
}

impl Lanes<'_> {
    fn count(&self, own: Ways) {
        let mut ways = self.ways.lock().unwrap_or_else(PoisonError::into_inner);
        ways.lanes += own.lanes;
        for (reason, count) in own.tree {
            *ways.tree.entry(reason).or_default() += count;
        }
    }
}
