//! What is reported of one motion: its last state in columns, and how it ended.

use crate::columns::{Factor, Turns, coordinate_endings, speed_endings, suffix, turns};
use crate::track::Track;
use hamel::integrate::{GlobalError, Solution, State};
use hamel::mechanism::Mechanism;
use hamel::scene::Scene;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// How a motion ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// At the end of the time.
    Ended,
    /// At this event of the scene, which stops it.
    Event(String),
    /// Before it began, or on the way, for this reason.
    Failed(String),
}

/// `ended`, `event NAME` or `failed: CAUSE`.
impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ended => write!(f, "ended"),
            Self::Event(name) => write!(f, "event {name}"),
            Self::Failed(cause) => write!(f, "failed: {cause}"),
        }
    }
}

/// What [`Outcome`] writes, read again.
impl std::str::FromStr for Outcome {
    type Err = UnknownOutcome;

    fn from_str(text: &str) -> Result<Self, UnknownOutcome> {
        if text == "ended" {
            return Ok(Self::Ended);
        }
        if let Some(name) = text.strip_prefix("event ") {
            return Ok(Self::Event(name.to_owned()));
        }
        match text.strip_prefix("failed: ") {
            Some(cause) => Ok(Self::Failed(cause.to_owned())),
            None => Err(UnknownOutcome),
        }
    }
}

/// A text that is no outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownOutcome;

impl fmt::Display for UnknownOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "it is none of `ended`, `event NAME`, `failed: CAUSE`")
    }
}

impl std::error::Error for UnknownOutcome {}

/// What came of one row.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// How the motion ended.
    pub outcome: Outcome,
    /// One number for each of [`Sweep::results`](crate::Sweep::results); all NaN where the motion failed.
    pub numbers: Vec<f64>,
}

/// Names of what is reported of every motion.
const WHOLE: [&str; 4] = ["t_s", "energy_J", "kinetic_energy_J", "potential_energy_J"];
const WORK: [&str; 1] = ["steps"];
const ERROR: [&str; 2] = ["error", "error_is_reliable"];

/// The joint under a body, as results tell of it.
#[derive(Clone, Debug)]
struct Joint {
    body: usize,
    factors: Vec<Factor>,
    coordinates: &'static [&'static str],
    speeds: &'static [&'static str],
}

/// The columns of results.
#[derive(Clone, Debug)]
pub(crate) struct Results {
    names: Vec<String>,
    joints: Vec<Joint>,
    /// How many coordinates and speeds are reported of a state.
    state: usize,
    has_error: bool,
    /// When states are reported besides the last one, s.
    times: Vec<f64>,
}

impl Results {
    /// Those of motions of `mechanism`, with the estimate of their errors where `has_error`, and with states at `times`.
    pub fn new(mechanism: &Mechanism, has_error: bool, times: &[f64]) -> Self {
        let error = if has_error { &ERROR[..] } else { &[] };
        let fixed = WHOLE.iter().chain(&WORK).chain(error);
        let (mut state, mut joints) = (Vec::new(), Vec::new());
        for (index, body) in mechanism.joints() {
            let (joint, units) = (body.joint(), body.joint().units());
            let factors = Factor::all(joint);
            let endings = coordinate_endings(&factors, &units);
            for ending in endings.into_iter().chain(speed_endings(body, &units)) {
                let (owner, unit) = (body.joint_name(), suffix(ending.unit));
                state.push(format!("{owner}.{}{unit}", ending.name));
            }
            joints.push(Joint {
                body: index,
                factors,
                coordinates: joint.coordinates(),
                speeds: joint.speeds(),
            });
        }
        let mut names: Vec<String> = fixed.map(|name| (*name).to_owned()).collect();
        names.extend_from_slice(&state);
        for time in times {
            let time = label(*time);
            names.extend(state.iter().map(|name| format!("{name}@{time}")));
        }
        Self {
            names,
            joints,
            state: state.len(),
            has_error,
            times: times.to_vec(),
        }
    }

    pub fn names(&self) -> &[String] {
        &self.names
    }

    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Places among the names of what is reported of the last state, and of each sample behind it.
    pub fn states(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let first = self.names.len() - self.state * (self.times.len() + 1);
        (0..=self.times.len()).map(move |number| {
            let first = first + number * self.state;
            first..first + self.state
        })
    }

    /// Whether the same is reported of the motions of `mechanism`: numbers decide which coordinates of a loop are reported.
    pub fn fit(&self, mechanism: &Mechanism) -> bool {
        let mut own = self.joints.iter();
        let fits = mechanism.joints().all(|(body, joint)| {
            own.next().is_some_and(|own| {
                let joint = joint.joint();
                own.body == body
                    && own.coordinates == joint.coordinates()
                    && own.speeds == joint.speeds()
            })
        });
        fits && own.next().is_none()
    }

    /// What follows the angles over a motion.
    pub fn turns(&self) -> Turns {
        let all = self.joints.iter();
        Turns::new(
            all.flat_map(|joint| turns(joint.body, &joint.factors))
                .collect(),
        )
    }

    /// Appends coordinates and speeds of all joints.
    pub fn read(
        &self,
        mechanism: &Mechanism,
        (q, speeds): (&[f64], &[f64]),
        turns: &Turns,
        numbers: &mut Vec<f64>,
    ) {
        let mut angles = turns.angles().iter();
        for joint in &self.joints {
            let body = &mechanism.bodies()[joint.body];
            let own = body.configuration(q);
            for factor in &joint.factors {
                let angle = factor.kind.turn().and_then(|_| angles.next());
                factor.read(own, angle.copied().unwrap_or(f64::NAN), numbers);
            }
            numbers.extend(&speeds[body.ranges().speeds.clone()]);
        }
    }

    /// What a motion came to: its last state, its steps and its error, and its samples, NaN where they were not reached.
    ///
    /// # Errors
    /// A last state that has no finite energy.
    pub fn row(
        &self,
        mechanism: &Arc<Mechanism>,
        state: &State,
        (steps, error): (usize, Option<&GlobalError>),
        track: &Track,
    ) -> Result<Vec<f64>, String> {
        let (q, speeds) = (&*state.configuration, &*state.speeds);
        let found = mechanism.kinematics(q, speeds);
        let found = found.map_err(|error| error.to_string())?;
        let mut numbers = Vec::with_capacity(self.names.len());
        let energies = [
            found.energy(),
            found.kinetic_energy(),
            found.potential_energy(),
        ];
        if let Some(energy) = energies.iter().find(|energy| !energy.is_finite()) {
            return Err(format!(
                "its last state has an energy of {energy} J, which is beyond the range of numbers"
            ));
        }
        numbers.push(state.time);
        numbers.extend(energies);
        numbers.push(steps as f64);
        if self.has_error {
            numbers.push(error.map_or(f64::NAN, |error| error.end.total()));
            let is_reliable = error.is_some_and(|error| error.doubt.is_none());
            numbers.push(f64::from(u8::from(is_reliable)));
        }
        self.read(mechanism, (q, speeds), track.turns(), &mut numbers);
        numbers.extend(track.samples());
        numbers.resize(self.names.len(), f64::NAN);
        Ok(numbers)
    }

    /// What is reported of a motion that failed.
    pub fn failure(&self, cause: String) -> Row {
        Row {
            outcome: Outcome::Failed(cause),
            numbers: vec![f64::NAN; self.names.len()],
        }
    }
}

/// A time in 15 digits, without what rounding adds to products of steps.
pub(crate) fn label(time: f64) -> String {
    let rounded: f64 = format!("{time:.14e}").parse().unwrap_or(time);
    rounded.to_string()
}

/// A motion that the scene stops ends at the last crossing of an event that does so.
pub(crate) fn outcome(scene: &Scene, solution: &Solution) -> Outcome {
    let stops = |name: &str| {
        let mut events = scene.events.iter();
        events.any(|event| event.stops && event.name == name)
    };
    let mut crossings = solution.events.iter().rev();
    let last = crossings.find(|crossing| solution.stopped && stops(&crossing.name));
    last.map_or(Outcome::Ended, |crossing| {
        Outcome::Event(crossing.name.to_string())
    })
}
