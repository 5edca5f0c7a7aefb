//! Motions side by side, step by step.

use crate::machine::{Machine, WIDTH};
use crate::plan::Plan;
use hamel::integrate::{FixedSteps, State, Step};
use hamel::mechanism::Mechanism;
use hamel::scene::Scene;
use hamel_compiler::stepping::Position;
use hamel_sweep::columns::Turns;

/// The ϕ from which on a joint gets a new base point, as in the integrators of the tree.
const FAR: f64 = 0.5;
/// The ϕ beyond which a step says nothing: the tree judges what goes so fast.
const TOO_FAR: f64 = 1.0;
/// Steps after which somebody may want to stop.
const ASKED: usize = 64;

/// A motion that is to go with others.
pub struct Start<'a> {
    /// A scene with its mechanism and its time.
    pub scene: &'a Scene,
    /// Its state at time 0.
    pub state: State,
    /// The numbers of it that differ.
    pub numbers: &'a [f64],
    /// The length of its steps, s.
    pub dt: f64,
    /// What follows its angles.
    pub turns: Turns,
}

/// Where a motion ended.
pub struct End {
    /// The last state.
    pub state: State,
    /// How many steps it took.
    pub steps: usize,
    /// Its angles.
    pub turns: Turns,
}

/// Motions under way.
struct Block<'a> {
    plan: &'a Plan,
    starts: Vec<Start<'a>>,
    machine: Machine,
    /// Whether a motion is left to the tree.
    is_left: Vec<bool>,
    follows: bool,
    /// Joints whose base points move.
    bent: Vec<(usize, &'a Position)>,
}

/// Motions with steps of one length until one time.
struct Group {
    steps: FixedSteps,
    step: f64,
    count: usize,
    motions: Vec<usize>,
}

/// Moves at most [`WIDTH`] scenes to their ends. A motion without one is left to the tree; `None` where `stop` tells to stop.
pub fn moved<'a>(
    plan: &'a Plan,
    starts: Vec<Start<'a>>,
    stop: &dyn Fn() -> bool,
) -> Option<Vec<Option<End>>> {
    debug_assert!(starts.len() <= WIDTH);
    let mut ends: Vec<Option<End>> = starts.iter().map(|_| None).collect();
    let mut groups = groups(&starts);
    let mut block = Block::new(plan, starts);
    block.begin();
    for number in 1_usize.. {
        groups.retain_mut(|group| {
            let next = group.steps.next();
            match next {
                Some(step) if step != group.step => {
                    group.step = step;
                    for &motion in &group.motions {
                        block.machine.set(plan.places.step, motion, step);
                    }
                }
                Some(_) => {}
                None => {
                    for &motion in &group.motions {
                        ends[motion] = block.end(motion, group.steps.time(), group.count);
                    }
                    return false;
                }
            }
            group.count += 1;
            true
        });
        if groups.is_empty() {
            break;
        }
        if number.is_multiple_of(ASKED) && stop() {
            return None;
        }
        block.step(&groups);
    }
    (!stop()).then_some(ends)
}

fn groups(starts: &[Start<'_>]) -> Vec<Group> {
    let mut groups: Vec<([u64; 2], Group)> = vec![];
    for (motion, start) in starts.iter().enumerate() {
        let (end, dt) = (start.scene.settings.t_end, start.dt);
        let key = [end.to_bits(), dt.to_bits()];
        match groups.iter_mut().find(|(known, _)| *known == key) {
            Some((_, group)) => group.motions.push(motion),
            None => {
                let group = Group {
                    steps: FixedSteps::until(end, dt),
                    step: f64::NAN,
                    count: 0,
                    motions: vec![motion],
                };
                groups.push((key, group));
            }
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

impl<'a> Block<'a> {
    fn new(plan: &'a Plan, starts: Vec<Start<'a>>) -> Self {
        let joints = plan.places.joints.iter();
        let bodies: Vec<usize> = starts.first().map_or(vec![], |start| {
            let joints = start.scene.mechanism.joints();
            joints.map(|(index, _)| index).collect()
        });
        let bent = bodies
            .into_iter()
            .zip(joints)
            .filter(|(_, joint)| !joint.adds);
        Self {
            plan,
            machine: Machine::new(&plan.program),
            is_left: vec![false; starts.len()],
            follows: starts.iter().any(|start| !start.turns.angles().is_empty()),
            bent: bent.collect(),
            starts,
        }
    }

    /// Puts all numbers in their places; places without a motion hold those of the last one.
    fn begin(&mut self) {
        let places = &self.plan.places;
        for lane in 0..WIDTH {
            let Some(start) = self.starts.get(lane).or(self.starts.last()) else {
                return;
            };
            for joint in &places.joints {
                let q = &start.state.configuration[joint.share.configuration.clone()];
                for (place, number) in joint.base.clone().zip(q) {
                    self.machine.set(place, lane, *number);
                }
            }
            for (place, number) in places.speeds.clone().zip(&start.state.speeds) {
                self.machine.set(place, lane, *number);
            }
            for (place, number) in (places.numbers..).zip(start.numbers) {
                self.machine.set(place, lane, *number);
            }
        }
        let program = &self.plan.program;
        self.machine.run(&program.once, &program.numbers);
        for motion in 0..self.starts.len() {
            self.follow(motion, 0.0, 0);
        }
    }

    fn step(&mut self, groups: &[Group]) {
        let program = &self.plan.program;
        self.machine.run(&program.step, &program.numbers);
        self.move_bases();
        if self.follows {
            for group in groups {
                for &motion in &group.motions {
                    self.follow(motion, group.steps.time(), group.count);
                }
            }
        }
    }

    /// Joints whose ϕ has grown get a new base point.
    fn move_bases(&mut self) {
        for (body, joint) in &self.bent {
            let is_near = self.machine.largest(joint.offset.clone()) <= FAR;
            if is_near {
                continue;
            }
            for (motion, start) in self.starts.iter().enumerate() {
                let offset = || {
                    joint
                        .offset
                        .clone()
                        .map(|row| self.machine.get(row, motion).abs())
                };
                let size = offset().fold(0.0, f64::max);
                if size <= FAR || self.is_left[motion] {
                    continue;
                }
                let mut moved =
                    position(&self.machine, &start.scene.mechanism, *body, joint, motion);
                let body = &start.scene.mechanism.bodies()[*body];
                if size > TOO_FAR || body.joint().project(&mut moved).is_err() {
                    self.is_left[motion] = true;
                }
                for (row, number) in joint.base.clone().zip(moved) {
                    self.machine.set(row, motion, number);
                }
                for row in joint.offset.clone().chain(joint.rest.clone()) {
                    self.machine.set(row, motion, 0.0);
                }
            }
        }
    }

    /// The state of a motion.
    fn state(&self, motion: usize, time: f64) -> State {
        let places = &self.plan.places;
        let mechanism = &self.starts[motion].scene.mechanism;
        let joints = places.joints.iter().zip(mechanism.joints());
        let q = joints
            .flat_map(|(joint, (body, _))| position(&self.machine, mechanism, body, joint, motion));
        State {
            time,
            configuration: q.collect(),
            speeds: places
                .speeds
                .clone()
                .map(|row| self.machine.get(row, motion))
                .collect(),
        }
    }

    /// Follows the angles of a motion.
    fn follow(&mut self, motion: usize, time: f64, number: usize) {
        if !self.follows {
            return;
        }
        let state = self.state(motion, time);
        let start = &mut self.starts[motion];
        let step = Step {
            time,
            number,
            configuration: &state.configuration,
            speeds: &state.speeds,
            momenta: None,
            sample: None,
            is_within: false,
            carried: None,
        };
        start.turns.follow(&start.scene.mechanism, &step);
    }

    /// Where a motion has come to; none where the tree is to tell.
    fn end(&self, motion: usize, time: f64, steps: usize) -> Option<End> {
        let state = self.state(motion, time);
        let mut numbers = state.configuration.iter().chain(&state.speeds);
        let is_told = !self.is_left[motion] && numbers.all(|number| number.is_finite());
        is_told.then(|| End {
            state,
            steps,
            turns: self.starts[motion].turns.clone(),
        })
    }
}

/// Q of one joint.
fn position(
    machine: &Machine,
    mechanism: &Mechanism,
    body: usize,
    joint: &Position,
    motion: usize,
) -> Vec<f64> {
    let read = |rows: std::ops::Range<usize>| -> Vec<f64> {
        rows.map(|row| machine.get(row, motion)).collect()
    };
    let base = read(joint.base.clone());
    if joint.adds {
        return base;
    }
    let mut moved = vec![0.0; base.len()];
    let own = mechanism.bodies()[body].joint();
    own.retract(&base, &read(joint.offset.clone()), &mut moved);
    moved
}
