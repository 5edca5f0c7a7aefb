//! What a mechanism carries besides its bodies: elements, rotor inertias, drives, constraints that couple joints.

use super::armature::Armature;
use super::check::Space;
use super::{Mechanism, MechanismError, MechanismErrors, StateError};
use crate::dynamics::{EffortAtPort, Recursive};
use crate::elements::{
    Drive, Element, ElementError, JointFriction, JointStop, PointConstraint, TimedEffort,
};
use crate::joint::MOST_FREEDOMS;
use crate::time_function::{KinkError, Moment, TimeFunction, first_kink};
use alloc::format;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::DMatrix;

/// Elements, rotor inertias and drives of a mechanism.
#[derive(Clone, Debug, Default)]
pub(super) struct Actuation {
    pub(super) elements: Vec<Arc<dyn Element>>,
    pub(super) armature: Armature,
    pub(super) drives: Vec<Drive>,
    /// Whether the joint under each body is driven; empty where there are no drives.
    driven: Vec<bool>,
    timed_efforts: Vec<TimedEffort>,
    pub(super) constraints: Vec<PointConstraint>,
    /// The speeds that depend on the others, one a constraint.
    pub(super) dependent: Vec<usize>,
    pub(super) frictions: Vec<JointFriction>,
    pub(super) stops: Vec<JointStop>,
}

/// How small a pivot may be next to the largest to be preferred because its joint is nearer to the tips of the tree: the speeds that people
/// give are those of the base, and a hundredth costs two digits at most.
const PREFERENCE: f64 = 0.01;

/// How small a pivot of the constraints may be next to the largest for them to be taken for independent.
const INDEPENDENCE: f64 = 1e-9;

/// Speeds that a mechanism with constraints has at most: a matrix of their square takes 200 MB, and there are several.
const MOST_COUPLED: usize = 5000;

impl Mechanism {
    /// The mechanism with these elements instead of those it had.
    ///
    /// # Errors
    /// Every element that does not fit.
    pub fn with_elements(
        mut self,
        elements: Vec<Arc<dyn Element>>,
    ) -> Result<Self, MechanismErrors> {
        let failures = elements
            .iter()
            .filter_map(|element| element.check(&self).err());
        refuse(failures)?;
        self.actuation.elements = elements;
        Ok(self)
    }

    /// The mechanism with these drives instead of those it had.
    ///
    /// # Errors
    /// Every drive that does not fit; two drives of one joint; a joint whose speeds constraints already make depend on others.
    pub fn with_drives(mut self, drives: Vec<Drive>) -> Result<Self, MechanismErrors> {
        let mut driven = vec![false; self.bodies.len()];
        let mut dependent = vec![false; self.layout.speeds];
        for &speed in &self.actuation.dependent {
            dependent[speed] = true;
        }
        let failures = drives.iter().filter_map(|drive| {
            let twice = driven
                .get_mut(self.leader(drive.body))
                .is_some_and(|driven| core::mem::replace(driven, true));
            let twice = twice.then(|| ElementError::Joint {
                element: drive.name.clone(),
                joint: self
                    .bodies
                    .get(drive.body)
                    .map_or("", |body| body.joint_name())
                    .into(),
                reason: "is driven already",
            });
            let bound = self.bodies.get(drive.body);
            let bound = bound.filter(|body| dependent[body.ranges.speeds.clone()].contains(&true));
            let bound = bound.map(|body| ElementError::Joint {
                element: drive.name.clone(),
                joint: body.joint_name().into(),
                reason: "has speeds that constraints make depend on others: give drives before constraints",
            });
            drive.check(&self).err().or(twice).or(bound)
        });
        refuse(failures)?;
        self.actuation.drives = drives;
        self.actuation.driven = driven;
        Ok(self)
    }

    /// The mechanism with these efforts as functions of time instead of those it had.
    ///
    /// # Errors
    /// All that do not fit.
    pub fn with_timed_efforts(
        mut self,
        efforts: Vec<TimedEffort>,
    ) -> Result<Self, MechanismErrors> {
        refuse(
            efforts
                .iter()
                .filter_map(|effort| effort.check(&self).err()),
        )?;
        self.actuation.timed_efforts = efforts;
        Ok(self)
    }

    /// The mechanism with these constraints that couple joints, Theorem 3, instead of those it had; drives are to be given before.
    ///
    /// At `q` the speeds that depend on the others are chosen, by pivoting: of those that the constraints determine well, the nearest to the
    /// tips of the tree.
    ///
    /// # Errors
    /// Every constraint that does not fit; more than 5000 speeds; a wrong size of `q`; every constraint that depends on the others at `q`.
    pub fn with_constraints(
        mut self,
        constraints: Vec<PointConstraint>,
        q: &[f64],
    ) -> Result<Self, MechanismErrors> {
        refuse(constraints.iter().filter_map(|c| c.check(&self).err()))?;
        let speeds = self.layout.speeds;
        if speeds > MOST_COUPLED && !constraints.is_empty() {
            let limit = MOST_COUPLED;
            return Err(MechanismError::Coupled { speeds, limit }.into());
        }
        self.check_configuration(q)
            .map_err(MechanismError::Configuration)?;
        self.actuation.constraints = constraints;
        self.actuation.dependent.clear();
        let matrix = Recursive::new(Arc::new(self.clone())).constraint_matrix(q);
        let driven = self.speeds_of(self.actuation.drives.iter().map(|drive| drive.body));
        let own = self.speeds_of(self.unilateral_joints());
        // Joints that may stick or hit a limit keep speeds of their own.
        let found = dependent_columns(matrix.clone(), |speed| driven[speed] || own[speed]);
        self.actuation.dependent = found.map_err(|rows| {
            let takes_theirs = dependent_columns(matrix, |speed| driven[speed]).is_ok();
            let refused = rows
                .into_iter()
                .map(|refused| self.refused(refused, takes_theirs));
            refused.collect::<MechanismErrors>()
        })?;
        Ok(self)
    }

    /// Which speeds are those of these bodies' joints.
    fn speeds_of(&self, bodies: impl Iterator<Item = usize>) -> Vec<bool> {
        let mut taken = vec![false; self.layout.speeds];
        for body in bodies {
            taken[self.bodies[body].ranges.speeds.clone()].fill(true);
        }
        taken
    }

    /// Bodies whose joints have friction or limits.
    fn unilateral_joints(&self) -> impl Iterator<Item = usize> {
        let frictions = self.actuation.frictions.iter().map(|own| own.body);
        frictions.chain(self.actuation.stops.iter().map(|own| own.body))
    }

    /// A constraint that is refused, with its pivot; perhaps only as joints with friction and limits keep their speeds.
    fn refused(&self, (row, ratio): (usize, f64), takes_theirs: bool) -> MechanismError {
        let constraint = self.actuation.constraints[row].name.clone();
        let joint = self.unilateral_joints().last();
        match joint.filter(|_| takes_theirs) {
            Some(body) => MechanismError::Element(ElementError::Joint {
                element: format!("constraint `{constraint}`"),
                joint: self.bodies[body].joint_name().into(),
                reason: "has friction or limits, and so a speed of its own, and the constraint leaves no joint without them whose speed could depend on the others",
            }),
            None => MechanismError::DependentConstraint {
                constraint,
                ratio,
                limit: INDEPENDENCE,
            },
        }
    }

    /// Constraints that couple joints.
    pub fn constraints(&self) -> &[PointConstraint] {
        &self.actuation.constraints
    }

    /// The speeds that constraints make depend on the others, one a constraint.
    pub fn dependent_speeds(&self) -> &[usize] {
        &self.actuation.dependent
    }

    /// What acts on the mechanism besides gravity and inputs.
    pub fn elements(&self) -> &[Arc<dyn Element>] {
        &self.actuation.elements
    }

    /// Joints whose motion is prescribed.
    pub fn drives(&self) -> &[Drive] {
        &self.actuation.drives
    }

    /// Efforts of joints as functions of time.
    pub fn timed_efforts(&self) -> &[TimedEffort] {
        &self.actuation.timed_efforts
    }

    /// Adds the efforts that are functions of time to τ.
    pub fn add_timed_efforts(&self, at: Moment, efforts: &mut [f64]) {
        for timed in &self.actuation.timed_efforts {
            let own = &mut efforts[self.bodies[timed.body].ranges.freedoms.clone()];
            for (effort, function) in own.iter_mut().zip(&timed.efforts) {
                *effort += function.value(at);
            }
        }
    }

    /// Adds efforts at ports to τ at the configuration `q` of all joints, as what they do on v: Pᵀ f, with w = P v the rate of a port.
    pub fn add_efforts_at_ports(&self, q: &[f64], at_ports: &[EffortAtPort], efforts: &mut [f64]) {
        for acting in at_ports {
            let body = &self.bodies[acting.body];
            let own = &mut efforts[body.ranges.freedoms.clone()];
            let mut row = [0.0; MOST_FREEDOMS];
            let row = &mut row[..own.len()];
            body.joint()
                .port_row(body.configuration(q), acting.port, row);
            for (effort, weight) in own.iter_mut().zip(row) {
                *effort += *weight * acting.effort;
            }
        }
    }

    /// Whether anything that acts on the mechanism, or moves it, changes with time.
    pub fn changes_with_time(&self) -> bool {
        self.time_functions().next().is_some()
    }

    /// The first time after `after`, up to `until`, at which an effort, a wrench or a prescribed acceleration may jump or bend.
    ///
    /// # Errors
    /// An expression whose switches cannot be followed.
    pub fn next_kink(&self, after: f64, until: f64) -> Result<Option<f64>, KinkError> {
        first_kink(self.time_functions(), after, until)
    }

    /// The end of a step of a motion in which no pulse of what acts lies unseen ([`TimeFunction::end_before_pulse`]): that of the step, or an earlier time.
    pub fn end_before_pulse(&self, [from, until]: [f64; 2], motion: [f64; 2]) -> f64 {
        let functions = self.time_functions();
        functions.fold(until, |until, function| {
            function.end_before_pulse([from, until], motion)
        })
    }

    fn time_functions(&self) -> impl Iterator<Item = &TimeFunction> {
        let Actuation {
            elements,
            drives,
            timed_efforts,
            ..
        } = &self.actuation;
        let elements = elements.iter().flat_map(|element| element.functions());
        let drives = drives.iter().flat_map(|drive| &drive.laws);
        let efforts = timed_efforts.iter().flat_map(|timed| &timed.efforts);
        elements.chain(drives).chain(efforts)
    }

    /// Whether the motion of the joint under `body` is prescribed.
    pub fn is_driven(&self, body: usize) -> bool {
        self.actuation
            .driven
            .get(self.leader(body))
            .is_some_and(|&driven| driven)
    }

    /// The speeds that drives prescribe at time `t`, into their entries of `speeds`.
    ///
    /// # Errors
    /// When `speeds` has the wrong size.
    pub fn set_driven_speeds(&self, t: f64, speeds: &mut [f64]) -> Result<(), StateError> {
        self.check_room("speeds", Space::Speeds, speeds)?;
        self.prescribe_speeds(t.into(), speeds);
        Ok(())
    }

    /// The accelerations v̄̇ that drives prescribe at time `t`, into the first entries of τ of their joints.
    ///
    /// # Errors
    /// When `efforts` has the wrong size.
    pub fn set_driven_accelerations(&self, t: f64, efforts: &mut [f64]) -> Result<(), StateError> {
        self.check_room("efforts", Space::Freedoms, efforts)?;
        self.prescribe_accelerations(t.into(), efforts);
        Ok(())
    }

    /// [`Mechanism::set_driven_speeds`] into speeds of the right size.
    pub fn prescribe_speeds(&self, at: Moment, speeds: &mut [f64]) {
        for drive in &self.actuation.drives {
            let own = &mut speeds[self.bodies[drive.body].ranges.speeds.clone()];
            for (speed, law) in own.iter_mut().zip(&drive.laws) {
                *speed = law.value(at);
            }
        }
    }

    /// [`Mechanism::set_driven_accelerations`] into efforts of the right size.
    pub fn prescribe_accelerations(&self, at: Moment, efforts: &mut [f64]) {
        for drive in &self.actuation.drives {
            let own = &mut efforts[self.bodies[drive.body].ranges.freedoms.clone()];
            for (effort, law) in own.iter_mut().zip(&drive.laws) {
                *effort = law.slope(at);
            }
        }
    }
}

pub(super) fn refuse(failures: impl Iterator<Item = ElementError>) -> Result<(), MechanismErrors> {
    MechanismErrors::check(failures.map(MechanismError::Element).collect())
}

/// A pivot as a share of the largest entry; 0 where all are.
fn share(pivot: f64, largest: f64) -> f64 {
    match largest > 0.0 {
        true => pivot.abs() / largest,
        false => 0.0,
    }
}

/// Which speeds constraints make depend on the others: one column of `matrix` for each of its rows, by elimination with pivoting among the columns
/// that are not `taken`, in the order of the rows. Of the columns whose pivots are good enough the last is chosen.
///
/// # Errors
/// All rows that depend on the others, each with the ratio of its largest remainder to the largest entry of `matrix`.
pub fn dependent_columns(
    mut matrix: DMatrix<f64>,
    taken: impl Fn(usize) -> bool,
) -> Result<Vec<usize>, Vec<(usize, f64)>> {
    let largest = matrix.amax();
    let limit = INDEPENDENCE * largest;
    let mut rows: Vec<usize> = (0..matrix.nrows()).collect();
    let mut columns: Vec<usize> = (0..matrix.ncols()).filter(|&j| !taken(j)).collect();
    let mut chosen = Vec::new();
    while !rows.is_empty() {
        let size = |&(i, j): &(usize, usize)| matrix[(i, j)].abs();
        let of_row = |i: usize| columns.iter().map(move |&j| (i, j));
        let remainder = |i: usize| of_row(i).map(|entry| size(&entry)).max_by(f64::total_cmp);
        let best = rows.iter().filter_map(|&i| remainder(i));
        let best = best.max_by(f64::total_cmp).unwrap_or(0.0);
        let entries = rows.iter().flat_map(|&i| of_row(i));
        let good = entries.filter(|entry| size(entry) >= PREFERENCE * best && size(entry) > limit);
        let deepest = good.max_by(|a, b| a.1.cmp(&b.1).then(size(a).total_cmp(&size(b))));
        let Some((row, column)) = deepest else {
            let refused = rows
                .iter()
                .map(|&i| (i, share(remainder(i).unwrap_or(0.0), largest)));
            return Err(refused.collect());
        };
        rows.retain(|&i| i != row);
        columns.retain(|&j| j != column);
        chosen.push((row, column));
        eliminate(&mut matrix, &rows, (row, column));
    }
    chosen.sort_unstable();
    Ok(chosen.into_iter().map(|(_, column)| column).collect())
}

/// Takes as much of the pivot's row off each of `rows` as makes its entry in the pivot's column 0.
fn eliminate(matrix: &mut DMatrix<f64>, rows: &[usize], (row, column): (usize, usize)) {
    let pivot_row = matrix.row(row).into_owned();
    for &i in rows {
        let factor = matrix[(i, column)] / pivot_row[column];
        for j in 0..matrix.ncols() {
            matrix[(i, j)] -= factor * pivot_row[j];
        }
    }
}
