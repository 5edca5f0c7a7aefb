//! Motions side by side, step by step.

use crate::machine::{Machine, WIDTH};
use crate::plan::Plan;
use hamel::erased::AnyJoint;
use hamel::integrate::{FixedSteps, State, Step};
use hamel::scene::Scene;
use hamel_compiler::stepping::Position;
use hamel_sweep::{Sweep, Track};
use std::ops::Range;

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
    /// What is kept of it on the way.
    pub track: Track,
}

/// Where a motion ended.
pub struct End {
    /// The last state.
    pub state: State,
    /// How many steps it took.
    pub steps: usize,
    /// What was kept of it.
    pub track: Track,
}

/// Motions under way.
struct Block<'a> {
    plan: &'a Plan,
    starts: Vec<Start<'a>>,
    machine: Machine,
    /// Whether a motion is left to the tree.
    is_left: Vec<bool>,
    /// Whether all steps of a motion are followed.
    follows: bool,
    /// For each motion, the sum of ϕ over the base points before the last, one entry per degree of freedom.
    passed: Vec<Vec<f64>>,
    /// Joints whose base points move.
    bent: Vec<(usize, &'a Position)>,
}

/// Motions with a fixed step size until one time.
struct Group {
    steps: FixedSteps,
    step: f64,
    count: usize,
    motions: Vec<usize>,
    /// When samples are taken, s, and the next of them.
    times: Vec<f64>,
    sample: usize,
}

impl Group {
    /// The sample that is taken at the end of the last step, if one is.
    fn sample(&mut self) -> Option<usize> {
        let is_due = self.steps.is_at(*self.times.get(self.sample)?);
        self.sample += usize::from(is_due);
        is_due.then(|| self.sample - 1)
    }
}

/// Moves at most [`WIDTH`] scenes to their ends. A motion without an end is left to the tree; `None` where `stop` tells to stop.
pub fn moved<'a>(
    plan: &'a Plan,
    starts: Vec<Start<'a>>,
    sweep: &Sweep,
    stop: &dyn Fn() -> bool,
) -> Option<Vec<Option<End>>> {
    debug_assert!(starts.len() <= WIDTH);
    let mut ends: Vec<Option<End>> = starts.iter().map(|_| None).collect();
    let mut groups = groups(&starts, sweep);
    let mut block = Block::new(plan, starts);
    block.begin(&mut groups);
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
        block.step(&mut groups);
    }
    (!stop()).then_some(ends)
}

fn groups(starts: &[Start<'_>], sweep: &Sweep) -> Vec<Group> {
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
                    times: sweep.times_until(end),
                    sample: 0,
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
            passed: (starts.iter())
                .map(|start| vec![0.0; start.scene.mechanism.layout().freedoms])
                .collect(),
            follows: starts.iter().any(|start| start.track.follows()),
            bent: bent.collect(),
            starts,
        }
    }

    /// Puts all numbers in their places; places without a motion hold those of the last one.
    fn begin(&mut self, groups: &mut [Group]) {
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
        self.follow_all(groups);
    }

    fn step(&mut self, groups: &mut [Group]) {
        let program = &self.plan.program;
        self.machine.run(&program.step, &program.numbers);
        self.move_bases();
        self.follow_all(groups);
    }

    /// Keeps what is to be kept of the states at which the groups have arrived.
    fn follow_all(&mut self, groups: &mut [Group]) {
        for group in groups {
            let sample = group.sample();
            if self.follows || sample.is_some() {
                for &motion in &group.motions {
                    self.follow(motion, (group.steps.time(), group.count), sample);
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
                let body = &start.scene.mechanism.bodies()[*body];
                let own = body.joint();
                let mut moved = Vec::with_capacity(joint.base.len());
                position(&self.machine, own, joint, motion, &mut moved);
                if size > TOO_FAR || own.project(&mut moved).is_err() {
                    self.is_left[motion] = true;
                }
                let passed = &mut self.passed[motion][body.ranges().freedoms.clone()];
                for (passed, row) in passed.iter_mut().zip(joint.offset.clone()) {
                    *passed += self.machine.get(row, motion);
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
        let mut q = Vec::with_capacity(mechanism.layout().configuration);
        for (joint, (_, body)) in places.joints.iter().zip(mechanism.joints()) {
            position(&self.machine, body.joint(), joint, motion, &mut q);
        }
        let speeds = places.speeds.clone();
        State {
            time,
            configuration: q,
            speeds: speeds.map(|row| self.machine.get(row, motion)).collect(),
        }
    }

    /// [`Step::travel`] of a motion.
    fn travel(&self, motion: usize) -> Vec<f64> {
        let start = &self.starts[motion];
        let mut travel = self.passed[motion].clone();
        let joints = start.scene.mechanism.joints();
        for (joint, (_, body)) in self.plan.places.joints.iter().zip(joints) {
            let own = &mut travel[body.ranges().freedoms.clone()];
            let begun = body.configuration(&start.state.configuration);
            for (i, travel) in own.iter_mut().enumerate() {
                *travel += match joint.adds {
                    true => self.machine.get(joint.base.start + i, motion) - begun[i],
                    false => self.machine.get(joint.offset.start + i, motion),
                };
            }
        }
        travel
    }

    /// Keeps what is to be kept of a motion.
    fn follow(&mut self, motion: usize, (time, number): (f64, usize), sample: Option<usize>) {
        let state = self.state(motion, time);
        let travel = self.travel(motion);
        let start = &mut self.starts[motion];
        let step = Step::of_state(&state, &travel, number, sample);
        start.track.follow(&start.scene.mechanism, &step);
    }

    /// Where a motion has come to; none where the tree is to tell.
    fn end(&self, motion: usize, time: f64, steps: usize) -> Option<End> {
        let state = self.state(motion, time);
        let mut numbers = state.configuration.iter().chain(&state.speeds);
        let is_told = !self.is_left[motion] && numbers.all(|number| number.is_finite());
        is_told.then(|| End {
            state,
            steps,
            track: self.starts[motion].track.clone(),
        })
    }
}

/// Appends Q of one joint.
fn position(
    machine: &Machine,
    own: &dyn AnyJoint,
    joint: &Position,
    motion: usize,
    all: &mut Vec<f64>,
) {
    let read = |rows: Range<usize>| rows.map(|row| machine.get(row, motion));
    let first = all.len();
    all.extend(read(joint.base.clone()));
    if joint.adds {
        return;
    }
    let base = all[first..].to_vec();
    let offset: Vec<f64> = read(joint.offset.clone()).collect();
    own.retract(&base, &offset, &mut all[first..]);
}
