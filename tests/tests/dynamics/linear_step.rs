//! Linearised steps of the integrators against central differences of the steps themselves, through Φ and its inverse.

use crate::derivatives::Equipment;
use hamel::dynamics::{Dynamics, Recursive};
use hamel::elements::{Drive, Law, PointConstraint};
use hamel::integrate::{
    Control, Form, LinearStep, Method, Options, Scheme, State, StepFailure, Tableau, integrate,
    no_observer,
};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::{DMatrix, DVector, Vector3};
use hamel_tests::differences::{STEP, derivative, local, moved};
use hamel_tests::figures::{Largest, difference, size};
use hamel_tests::peers::{Reference, convert, numbers};
use hamel_tests::random::{self, Case, cases, library};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::path::Path;
use std::sync::Arc;

/// A step of which the terms of order 5 can be seen, s: 0.03⁵ = 2e-8 is far above the bound.
const DT: f64 = 1.0 / 32.0;

const FORMS: [Form; 2] = [Form::Lagrangian, Form::Hamiltonian];

const FIXED: Method = Method::rk4(DT);

/// A pair that takes its first step whatever its error.
const fn unchecked(scheme: Scheme) -> Method {
    let control = Control {
        tolerance: Control::LARGEST_TOLERANCE,
        max_step: DT,
        first_step: Some(DT),
    };
    Method::Controlled { scheme, control }
}

/// A step of an integrator as a function of (q, y) and τ.
struct Stepping<'a> {
    mechanism: &'a Arc<Mechanism>,
    form: Form,
    method: Method,
    /// Step of the differences.
    change: f64,
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
    fn error(&self, case: &Case) -> f64 {
        let (found, expected) = (self.linearized(case), self.differenced(case));
        let error = difference(found.as_slice(), expected.as_slice());
        error / size(expected.as_slice()).max(1.0)
    }
}

fn stepping(case: &Case, form: Form, method: Method) -> Stepping<'_> {
    Stepping {
        mechanism: &case.mechanism,
        form,
        method,
        change: STEP,
    }
}

fn place(case: &Case) -> String {
    let root = case.mechanism.bodies()[0].joint().name();
    let count = case.mechanism.bodies().len();
    format!("case {} of {count} bodies on {root}", case.seed)
}

/// Differences of order 6 over 1/128 resolve 1e-13 of functions that vary over lengths of order 1 ([`STEP`]); a step of a tree of light and heavy
/// bodies bends a hundred times as much, and h⁶ f⁽⁷⁾ grows with it. What is left of an error in any term is far above: δD alone is of the order
/// of `DT²`.
const BOUND: f64 = 1e-9;

#[test]
fn random_trees() {
    for form in FORMS {
        let mut worst = Largest::new("A and B of a step of rk4");
        for case in cases(&library(), 6, 48) {
            worst.meet(stepping(&case, form, FIXED).error(&case), place(&case));
        }
        worst.assert_within(BOUND);
    }
}

/// Springs, dampers, wrenches and rotors of all kinds at every joint.
#[test]
fn equipped_trees() {
    for form in FORMS {
        let mut worst = Largest::new("A and B with elements and rotors");
        for case in cases(&library(), 4, 24) {
            let equipment = Equipment::random(&case.mechanism, &case.q, case.seed);
            let mechanism = equipment.equip(&case.mechanism);
            let case = Case { mechanism, ..case };
            worst.meet(stepping(&case, form, FIXED).error(&case), place(&case));
        }
        worst.assert_within(BOUND);
    }
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
    let (mechanism, mut speeds) = (Arc::new(mechanism), case.speeds.clone());
    let completed = Recursive::new(Arc::clone(&mechanism)).complete_speeds(&case.q, &mut speeds);
    completed.expect("determined");
    let fast = speeds.iter().any(|speed| speed.abs() > 5.0);
    (!fast).then(|| Case {
        mechanism,
        speeds,
        ..case
    })
}

/// Speeds that a constraint makes depend on others follow them in every stage, and in the state reached.
#[test]
fn coupled_trees() {
    let cases: Vec<Case> = cases(&library(), 5, 30).filter_map(coupled).collect();
    assert!(cases.len() >= 20, "{} trees take an edge", cases.len());
    for form in FORMS {
        let mut worst = Largest::new("A and B where a constraint couples joints");
        for case in &cases {
            // Where a constraint nearly loses a speed, motions bend over lengths of a tenth: a fourth of the step takes h⁶ f⁽⁷⁾ down by 4096.
            let stepping = Stepping {
                change: STEP / 4.0,
                ..stepping(case, form, FIXED)
            };
            worst.meet(stepping.error(case), place(case));
        }
        worst.assert_within(BOUND);
    }
}

#[test]
fn every_pair() {
    let pairs = Scheme::ALL.into_iter();
    for pair in pairs.filter(|scheme| scheme.tableau().is_some() && scheme.has_estimate()) {
        let mut worst = Largest::new(pair.name());
        for (case, form) in cases(&library(), 4, 8).zip(FORMS.into_iter().cycle()) {
            let stepping = stepping(&case, form, unchecked(pair));
            worst.meet(stepping.error(&case), place(&case));
        }
        worst.assert_within(BOUND);
    }
}

/// The first state of a reference robot.
fn robot(name: &str) -> Case {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("data/robots/{name}.json"));
    let text = std::fs::read_to_string(own).expect("the file is beside this crate");
    let reference = Reference::parse(&text).expect("a reference");
    let mechanism = reference.model.mechanism().expect("a mechanism");
    let state = &reference.states[0];
    let numbers = |name: &str| numbers(&state[name]).expect("a list of numbers");
    let mut random = ChaCha8Rng::seed_from_u64(1);
    Case {
        seed: 0,
        q: convert::configuration(&reference.model, &numbers("q")),
        speeds: convert::swap(&reference.model, &numbers("v")),
        rates: vec![],
        efforts: random::numbers(&mut random, mechanism.layout().freedoms),
        mechanism,
    }
}

#[test]
fn robots() {
    for name in ["panda7", "anymal"] {
        let case = robot(name);
        for form in FORMS {
            let mut worst = Largest::new(name);
            worst.meet(
                stepping(&case, form, FIXED).error(&case),
                format!("{form:?}"),
            );
            worst.assert_within(BOUND);
        }
    }
}

#[test]
fn what_cannot_be_stepped_is_refused() {
    let case = cases(&library(), 1, 1).next().expect("one case");
    let mut step = LinearStep::new(&case.mechanism, Form::Lagrangian, &Tableau::RK4);
    for length in [0.0, -DT, f64::NAN, f64::INFINITY] {
        let refused = step.linearize(&case.q, &case.speeds, &case.efforts, length);
        assert!(
            matches!(refused, Err(StepFailure::Length { .. })),
            "{length}"
        );
    }
    let refused = step.linearize(&case.q, &case.speeds, &[], DT);
    let message = refused.expect_err("no efforts").to_string();
    assert!(message.contains("efforts"), "{message}");
    let mut off = case.q.clone();
    off[0] = f64::NAN;
    let refused = step.linearize(&off, &case.speeds, &case.efforts, DT);
    assert!(matches!(refused, Err(StepFailure::State(_))), "{refused:?}");
    let drive = Drive {
        name: "shaker".to_owned(),
        body: 0,
        laws: vec![Law::default(); case.speeds.len()],
    };
    let driven = (*case.mechanism).clone().with_drives(vec![drive]);
    let driven = Arc::new(driven.expect("it fits"));
    let mut step = LinearStep::new(&driven, Form::Lagrangian, &Tableau::RK4);
    let refused = step.linearize(&case.q, &case.speeds, &case.efforts, DT);
    let message = refused.expect_err("a function of time").to_string();
    assert!(message.contains("`shaker`"), "{message}");
}
