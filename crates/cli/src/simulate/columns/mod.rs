//! The columns of a trajectory: names, units, meanings and numbers in one list, of which CSV, Parquet and JSON are written.

mod forces;
mod header;
mod joint;
mod parts;
mod sample;

pub use hamel_sweep::columns::Turns;
pub use header::are_columns;
pub use parts::BODY;
pub use sample::JsonSample;

use super::plan::Plan;
use forces::Notes;
use hamel::dynamics::Recursive;
use hamel::integrate::Step;
use hamel::mechanism::{Kinematics, Mechanism};
use hamel::spatial::Pose;
use hamel_console::output::Failure;
use hamel_sweep::columns::{Ending, Turn, suffix};
use serde::Serialize;
use std::collections::HashMap;
use std::ops::Range;

/// One column.
#[derive(Clone, Debug, Serialize)]
pub struct Column {
    /// Its name in CSV and Parquet, with the unit.
    pub name: String,
    /// SI unit; `1` for a number without one, empty where the joint's spec does not determine it.
    pub unit: &'static str,
    /// What it is, in which axes.
    pub meaning: String,
    /// Where each of the `samples` of the JSON has it: a JSON pointer (RFC 6901).
    pub pointer: String,
}

/// What columns are read from.
#[derive(Clone, Copy)]
pub struct Moment<'m> {
    /// s.
    pub time: f64,
    /// Where all bodies are, and how they move.
    pub kinematics: &'m Kinematics,
    /// All joints' Q.
    pub configuration: &'m [f64],
    /// v̄ of all joints.
    pub speeds: &'m [f64],
    /// A controller's τ; empty without one.
    pub efforts: &'m [f64],
    /// What the joints carry, where that is asked for.
    pub carried: Option<&'m Recursive>,
    /// The angles that [`Turns`] follows, rad.
    pub angles: &'m [f64],
}

impl<'m> Moment<'m> {
    /// The end of `step`.
    pub fn of(
        step: &Step<'m>,
        kinematics: &'m Kinematics,
        efforts: &'m [f64],
        turns: &'m Turns,
    ) -> Self {
        Self {
            time: step.time,
            kinematics,
            configuration: step.configuration,
            speeds: step.speeds,
            efforts,
            carried: step.carried,
            angles: turns.angles(),
        }
    }
}

/// The lists of a JSON sample; quantities of the whole mechanism are in none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum List {
    Bodies,
    Frames,
    Joints,
    Efforts,
}

impl List {
    const ALL: [Self; 4] = [Self::Bodies, Self::Frames, Self::Joints, Self::Efforts];

    const fn key(self) -> &'static str {
        match self {
            Self::Bodies => "bodies",
            Self::Frames => "frames",
            Self::Joints => "joints",
            Self::Efforts => "efforts",
        }
    }

    /// The key of the entry's name.
    const fn label(self) -> &'static str {
        match self {
            Self::Efforts => "joint",
            _ => "name",
        }
    }
}

/// Appends numbers.
type Reader<'a> = Box<dyn Fn(&Moment<'_>, &mut Vec<f64>) + 'a>;

/// Columns that belong together: a key of JSON, whose value is a number or a list of them.
struct Quantity<'a> {
    key: &'static str,
    columns: Range<usize>,
    read: Reader<'a>,
}

/// All that is reported of one body, frame or joint, or of the mechanism.
struct Entry<'a> {
    list: Option<List>,
    name: &'a str,
    quantities: Vec<Quantity<'a>>,
}

impl Entry<'_> {
    /// What messages call it.
    fn called(&self) -> String {
        let kind = match self.list {
            None => return String::from("the mechanism"),
            Some(List::Bodies) => "body",
            Some(List::Frames) => "frame",
            Some(List::Joints | List::Efforts) => "joint",
        };
        format!("{kind} `{}`", self.name)
    }
}

/// The columns of a run, in their order.
pub struct Columns<'a> {
    list: Vec<Column>,
    entries: Vec<Entry<'a>>,
    turns: Vec<Turn>,
    notes: Notes,
}

impl<'a> Columns<'a> {
    /// Those of what is simulated: time and energies; bodies; named frames; coordinates and speeds of joints; efforts where
    /// there is a controller.
    ///
    /// # Errors
    /// Two columns of one name, as names that have dots may make them.
    pub fn new(plan: &'a Plan) -> Result<Self, Failure> {
        let mut columns = Self {
            list: Vec::new(),
            entries: Vec::new(),
            turns: Vec::new(),
            notes: Notes::default(),
        };
        let mechanism = &plan.scene.mechanism;
        columns.mechanism();
        columns.bodies(mechanism);
        columns.frames(mechanism);
        columns.joints(mechanism, plan.forces);
        if plan.control.is_some() {
            columns.efforts(mechanism);
        }
        columns.refuse_same()?;
        Ok(columns)
    }

    /// Whether each column has a name of its own; a reader of tables would take one for another.
    fn refuse_same(&self) -> Result<(), Failure> {
        let mut owners: HashMap<&str, &Entry<'_>> = HashMap::new();
        for entry in &self.entries {
            for column in entry.quantities.iter().flat_map(|own| own.columns.clone()) {
                let name = &self.list[column].name;
                if let Some(other) = owners.insert(name, entry) {
                    let (first, second) = (other.called(), entry.called());
                    return Err(Failure::Options(format!(
                        "two columns would be called `{name}`, one of {first} and one of {second}: one of them needs another name"
                    )));
                }
            }
        }
        Ok(())
    }

    /// All of them.
    pub fn list(&self) -> &[Column] {
        &self.list
    }

    /// Names of the columns.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.list.iter().map(|column| column.name.as_str())
    }

    /// What follows the angles among them over the motion.
    pub fn turns(&self) -> Turns {
        Turns::new(self.turns.clone())
    }

    /// What was found out about forces while their numbers were read.
    pub fn notes(&self) -> Vec<String> {
        self.notes.borrow().iter().cloned().collect()
    }

    /// Their numbers.
    pub fn row(&self, moment: &Moment<'_>) -> Vec<f64> {
        let mut row = Vec::with_capacity(self.list.len());
        for quantity in self.entries.iter().flat_map(|entry| &entry.quantities) {
            (quantity.read)(moment, &mut row);
        }
        row
    }

    fn mechanism(&mut self) {
        self.enter(None, "");
        for part in &parts::MECHANISM {
            self.add(part.key, part.endings(), move |moment, row| {
                let whole = parts::Whole::new(moment.time, moment.kinematics);
                (part.read)(&whole, row);
            });
        }
    }

    fn bodies(&mut self, mechanism: &'a Mechanism) {
        for (index, body) in mechanism.bodies().iter().enumerate() {
            self.enter(Some(List::Bodies), body.name());
            for part in &BODY {
                self.add(part.key, part.endings(), move |moment, row| {
                    (part.read)(&moment.kinematics.bodies[index], row);
                });
            }
        }
    }

    fn frames(&mut self, mechanism: &'a Mechanism) {
        for frame in mechanism.frames() {
            self.enter(Some(List::Frames), &frame.name);
            let pose = |moment: &Moment<'_>| -> Pose<f64> {
                match frame.body {
                    Some(body) => moment.kinematics.bodies[body].pose * frame.at,
                    None => frame.at,
                }
            };
            for part in &parts::FRAME {
                self.add(part.key, part.endings(), move |moment, row| {
                    (part.read)(&pose(moment), row);
                });
            }
        }
    }

    /// Begins an entry, to which quantities are added.
    fn enter(&mut self, list: Option<List>, name: &'a str) {
        self.entries.push(Entry {
            list,
            name,
            quantities: Vec::new(),
        });
    }

    /// Adds a quantity to the last entry.
    fn add(
        &mut self,
        key: &'static str,
        endings: Vec<Ending>,
        read: impl Fn(&Moment<'_>, &mut Vec<f64>) + 'a,
    ) {
        let first = self.list.len();
        let Some(index) = self.entries.len().checked_sub(1) else {
            return;
        };
        let (list, name) = (self.entries[index].list, self.entries[index].name);
        let before = |entry: &&Entry<'_>| entry.list == list;
        let number = self.entries[..index].iter().filter(before).count();
        for (place, ending) in endings.into_iter().enumerate() {
            let (owner, pointer) = match list {
                None => (String::new(), format!("/{key}")),
                Some(list) => (
                    format!("{name}."),
                    format!("/{}/{number}/{key}/{place}", list.key()),
                ),
            };
            let Ending {
                name,
                unit,
                meaning,
            } = ending;
            self.list.push(Column {
                name: format!("{owner}{name}{}", suffix(unit)),
                unit,
                meaning,
                pointer,
            });
        }
        self.entries[index].quantities.push(Quantity {
            key,
            columns: first..self.list.len(),
            read: Box::new(read),
        });
    }
}
