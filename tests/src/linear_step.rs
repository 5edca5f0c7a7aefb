//! Linearised steps of the integrators against central differences of the steps themselves, through Φ and its inverse.

use crate::derivatives::Equipped;
use crate::differences::{STEP, derivative, local, moved};
use crate::figures::{Largest, difference, size};
use crate::random::Case;
use hamel::dynamics::{Dynamics, Recursive};
use hamel::elements::PointConstraint;
use hamel::integrate::{Form, LinearStep, Method, Options, State, integrate, no_observer};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::{DMatrix, DVector, Vector3};
use std::sync::Arc;

/// A step of which the terms of order 5 can be seen, s: 0.03⁵ = 2e-8 is far above the bound.
pub const DT: f64 = 1.0 / 32.0;

/// Both.
pub const FORMS: [Form; 2] = [Form::Lagrangian, Form::Hamiltonian];

/// One step of [`DT`].
pub const FIXED: Method = Method::rk4(DT);

/// A step of an integrator as a function of (q, y) and τ.
pub struct Stepping<'a> {
    mechanism: &'a Arc<Mechanism>,
    form: Form,
    method: Method,
    /// Step of the differences.
    pub change: f64,
}

impl Stepping<'_> {
    /// y of the state (q, v̄).
    fn y(&self, q: &[f64], speeds: &[f64]) -> Vec<f64> {
        let mut y = speeds.to_vec();
        if self.form == Form::Hamiltonian {
            let mut dynamics = Recursive::new(Arc::clone(self.mechanism));
            dynamics.momenta(q, speeds, &mut y).expect("sizes fit");
        }
        y
    }

    fn take(&self, q: &[f64], y: &[f64], efforts: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut dynamics = Recursive::new(Arc::clone(self.mechanism));
        let mut speeds = y.to_vec();
        if self.form == Form::Hamiltonian {
            let solved = dynamics.speeds(q, y, &mut speeds);
            solved.expect("every body has mass");
        }
        let completed = dynamics.complete_speeds(q, &mut speeds);
        completed.expect("determined");
        let initial = State {
            time: 0.0,
            configuration: q.to_vec(),
            speeds,
        };
        let options = Options {
            form: self.form,
            method: self.method,
            t_end: DT,
            samples: vec![],
        };
        let mut held = |_: f64, _: &[f64], _: &[f64], tau: &mut [f64]| tau.copy_from_slice(efforts);
        let solution = integrate(
            &mut dynamics,
            &initial,
            &options,
            &mut held,
            &mut no_observer,
        );
        let solution = solution.expect("a short step");
        assert_eq!(solution.statistics.steps, 1);
        let State {
            configuration,
            speeds,
            ..
        } = solution.state;
        let y = self.y(&configuration, &speeds);
        (configuration, y)
    }

    /// A unit of each speed as a change of y: a unit of momentum would make a light body fly.
    fn units(&self, q: &[f64]) -> DMatrix<f64> {
        let size = self.mechanism.layout().speeds;
        let unit = |j: usize| {
            let mut unit = vec![0.0; size];
            unit[j] = 1.0;
            DVector::from_vec(self.y(q, &unit))
        };
        let columns: Vec<_> = (0..size).map(unit).collect();
        DMatrix::from_columns(&columns)
    }

    /// `[A B]` by differences, its columns of y by [`Stepping::units`].
    fn differenced(&self, case: &Case) -> DMatrix<f64> {
        let (q, tau) = (&case.q, &case.efforts);
        let y = self.y(q, &case.speeds);
        let (reached, _) = self.take(q, &y, tau);
        let (freedoms, speeds, units) = (tau.len(), y.len(), self.units(q));
        let column = |j: usize| {
            derivative(self.change, |t| {
                let mut phi = vec![0.0; freedoms];
                let (mut y, mut tau) = (y.clone(), tau.clone());
                match j {
                    j if j < freedoms => phi[j] = t,
                    j if j < freedoms + speeds => {
                        let unit = units.column(j - freedoms);
                        y.iter_mut().zip(&unit).for_each(|(y, unit)| *y += unit * t);
                    }
                    j => tau[j - freedoms - speeds] += t,
                }
                let (q, y) = self.take(&moved(self.mechanism, q, &phi), &y, &tau);
                let mut found = local(self.mechanism, &reached, &q);
                found.extend(y);
                DMatrix::from_vec(freedoms + speeds, 1, found)
            })
        };
        let columns: Vec<DVector<f64>> = (0..2 * freedoms + speeds)
            .map(|j| column(j).column(0).into_owned())
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// `[A B]` as the library has it, in the same units; the state reached is that of the integrator.
    fn linearized(&self, case: &Case) -> DMatrix<f64> {
        let y = self.y(&case.q, &case.speeds);
        let tableau = self.method.scheme().tableau().expect("explicit");
        let mut step = LinearStep::new(self.mechanism, self.form, tableau);
        step.linearize(&case.q, &y, &case.efforts, DT)
            .expect("a short step");
        let (q, reached) = self.take(&case.q, &y, &case.efforts);
        // The integrator sums its stages with a residue and projects Q: rounding apart.
        let apart = difference(step.configuration(), &q) / size(&q).max(1.0);
        assert!(apart < 1e-13, "case {}: {apart:e}", case.seed);
        let apart = difference(step.y(), &reached) / size(&reached).max(1.0);
        assert!(apart < 1e-12, "case {}: {apart:e}", case.seed);
        let (mut a, b) = (step.by_state().matrix(), step.by_efforts().matrix());
        let (first, size) = (case.efforts.len(), y.len());
        let by_speeds = a.columns(first, size) * self.units(&case.q);
        a.columns_mut(first, size).copy_from(&by_speeds);
        let columns: Vec<_> = a
            .column_iter()
            .chain(b.column_iter())
            .map(|column| column.into_owned())
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// The error of `[A B]`, relative to its largest entry or to 1.
    ///
    /// # Panics
    /// Where the state reached is not the integrator's, or none is.
    pub fn error(&self, case: &Case) -> f64 {
        let (found, expected) = (self.linearized(case), self.differenced(case));
        let error = difference(found.as_slice(), expected.as_slice());
        error / size(expected.as_slice()).max(1.0)
    }
}

/// With the usual step of the differences.
pub fn stepping(case: &Case, form: Form, method: Method) -> Stepping<'_> {
    Stepping {
        mechanism: &case.mechanism,
        form,
        method,
        change: STEP,
    }
}

/// For messages.
pub fn place(case: &Case) -> String {
    let root = case.mechanism.bodies()[0].joint().name();
    let count = case.mechanism.bodies().len();
    format!("case {} of {count} bodies on {root}", case.seed)
}

/// Differences of order 6 over 1/128 resolve 1e-13 of functions that vary over lengths of order 1 ([`STEP`]); a step of a tree of light and heavy
/// bodies bends a hundred times as much, and h⁶ f⁽⁷⁾ grows with it. What is left of an error in any term is far above: δD alone is of the order
/// of `DT²`.
pub const BOUND: f64 = 1e-9;

/// Steps of rk4 from the given cases in both forms, with `change` for the step of the differences.
///
/// # Panics
/// With the figure and the case, where the bound does not hold.
pub fn steps_of_rk4(law: &'static str, cases: &[Case], change: f64) {
    for form in FORMS {
        let mut worst = Largest::new(law);
        for case in cases {
            let stepping = Stepping {
                change,
                ..stepping(case, form, FIXED)
            };
            worst.meet(stepping.error(case), place(case));
        }
        worst.assert_within(BOUND);
    }
}

/// Bare trees; `change` as in [`steps_of_rk4`].
///
/// # Panics
/// As [`steps_of_rk4`].
pub fn bare(cases: impl Iterator<Item = Case>, change: f64) {
    let cases: Vec<Case> = cases.collect();
    steps_of_rk4("A and B of a step of rk4", &cases, change);
}

/// Springs, dampers, wrenches and rotors of all kinds at every joint.
///
/// # Panics
/// As [`steps_of_rk4`].
pub fn equipped(cases: impl Iterator<Item = Case>, change: f64) {
    let equipped = cases.map(|case| Equipped::fully(case).case);
    let cases: Vec<Case> = equipped.collect();
    steps_of_rk4("A and B with elements and rotors", &cases, change);
}

/// Speeds that a constraint makes depend on others follow them in every stage, and in the state reached. At least `least` of the cases take one.
///
/// # Panics
/// As [`steps_of_rk4`], and where fewer do.
pub fn constrained(cases: impl Iterator<Item = Case>, least: usize, change: f64) {
    let cases: Vec<Case> = cases.filter_map(coupled).collect();
    let count = cases.len();
    assert!(count >= least, "{count} trees take an edge");
    // Where a constraint nearly loses a speed, motions bend over lengths of a tenth: `change` is a fourth of the usual step or less, which takes h⁶ f⁽⁷⁾ down by 4096.
    let title = "A and B where a constraint couples joints";
    steps_of_rk4(title, &cases, change);
}

/// The tree of a case with an edge on its last body; `None` where its joints allow nothing that the edge forbids, or where it hardly determines a speed,
/// so that this one is large.
fn coupled(case: Case) -> Option<Case> {
    let edge = PointConstraint {
        name: "edge".to_owned(),
        body: case.mechanism.bodies().len() - 1,
        point: Vector3::new(0.3, -0.2, 0.5),
        direction: Vector3::new(0.6, 0.5, -0.4),
    };
    let mechanism = (*case.mechanism).clone();
    let mechanism = mechanism.with_constraints(vec![edge], &case.q).ok()?;
    let mechanism = Arc::new(mechanism);
    let completed = |mut speeds: Vec<f64>| {
        let completed =
            Recursive::new(Arc::clone(&mechanism)).complete_speeds(&case.q, &mut speeds);
        completed.expect("determined");
        speeds
    };
    let unit = |j: usize| {
        let mut unit = vec![0.0; case.speeds.len()];
        unit[j] = 1.0;
        completed(unit)
    };
    let speeds = completed(case.speeds.clone());
    // In a sum over several speeds what is large may cancel.
    let units = (0..speeds.len()).flat_map(unit);
    let fast = units.chain(speeds.clone()).any(|speed| speed.abs() > 5.0);
    (!fast).then(|| Case {
        mechanism,
        speeds,
        ..case
    })
}
