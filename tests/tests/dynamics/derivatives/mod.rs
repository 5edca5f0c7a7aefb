//! Derivatives of the dynamics by recursion against dual numbers, on random trees of all joints of the library and on real robots.

mod coupled;
mod coupled_momenta;
mod driven;
mod dual;
mod refusals;

pub use dual::{DualForm, Equipment};

use hamel::dynamics::{ForwardDerivatives, HamiltonianDerivatives, InverseDerivatives, Recursive};
use hamel::nalgebra::{DMatrix, DVector};
use hamel::scalar::Dual;
use hamel_tests::figures::{Largest, difference, size};
use hamel_tests::peers::{Reference, convert, numbers};
use hamel_tests::random::{self, Case, cases, library};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::path::Path;
use std::sync::Arc;

/// Two states of each.
const ROBOTS: [&str; 8] = [
    "pendulum", "panda7", "anymal", "g1", "rev8", "rev32", "ball8", "ball32",
];

/// Every size twice, every kind of joint at the root of some tree.
const TREES: u64 = 60;
const LARGEST: usize = 30;

/// What is asked of every derivative, relative to its largest entry; times the condition of M̄ where that is solved with.
const BOUND: f64 = 1e-12;

/// The first states of the reference robots, with efforts and accelerations of order 1.
fn robots() -> impl Iterator<Item = Case> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/robots");
    ROBOTS.into_iter().flat_map(move |robot| {
        let text = std::fs::read_to_string(own.join(format!("{robot}.json")));
        let reference = Reference::parse(&text.expect("the file is beside this crate"));
        let reference = reference.unwrap_or_else(|error| panic!("{robot}: {error}"));
        let mechanism = reference.model.mechanism();
        let mechanism = mechanism.unwrap_or_else(|error| panic!("{robot}: {error}"));
        let case = |(index, state): (usize, &serde_json::Value)| {
            let numbers = |name: &str| numbers(&state[name]).expect("a list of numbers");
            let mut random = ChaCha8Rng::seed_from_u64(index as u64);
            let layout = *mechanism.layout();
            Case {
                seed: index as u64,
                mechanism: Arc::clone(&mechanism),
                q: convert::configuration(&reference.model, &numbers("q")),
                speeds: convert::swap(&reference.model, &numbers("v")),
                rates: random::numbers(&mut random, layout.speeds),
                efforts: random::numbers(&mut random, layout.freedoms),
            }
        };
        let states = reference.states.iter().take(2).enumerate();
        states.map(case).collect::<Vec<_>>()
    })
}

/// A case with what the mechanism carries.
struct Equipped {
    case: Case,
    equipment: Equipment,
}

/// Bare, and those of up to ten bodies and the robots with all kinds of elements and rotors at every joint.
fn all() -> Vec<Equipped> {
    let kinds = library();
    let bare: Vec<Case> = cases(&kinds, LARGEST, TREES).chain(robots()).collect();
    let equipped = cases(&kinds, 10, TREES).chain(robots()).map(|case| {
        let equipment = Equipment::random(&case.mechanism, &case.q, case.seed);
        let mechanism = equipment.equip(&case.mechanism);
        let case = Case { mechanism, ..case };
        Equipped { case, equipment }
    });
    let bare = bare.into_iter().map(|case| Equipped {
        case,
        equipment: Equipment::default(),
    });
    bare.chain(equipped).collect()
}

fn derivatives(values: &[Dual<f64>]) -> Vec<f64> {
    values.iter().map(|value| value.derivative).collect()
}

fn values(values: &[Dual<f64>]) -> Vec<f64> {
    values.iter().map(|value| value.value).collect()
}

fn constants(values: &[f64]) -> Vec<Dual<f64>> {
    values.iter().map(|value| Dual::constant(*value)).collect()
}

/// `values` with the infinitesimal at one place.
fn seeded(values: &[f64], place: usize) -> Vec<Dual<f64>> {
    let mut seeded = constants(values);
    seeded[place].derivative = 1.0;
    seeded
}

fn matrix(rows: usize, columns: impl Iterator<Item = Vec<f64>>) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> = columns.map(DVector::from_vec).collect();
    match columns.is_empty() {
        true => DMatrix::zeros(rows, 0),
        false => DMatrix::from_columns(&columns),
    }
}

/// Relative to the largest entry, or to 1: states, forces and inertias are of order 1, and some derivatives vanish.
fn relative(found: &DMatrix<f64>, expected: &DMatrix<f64>) -> f64 {
    difference(found.as_slice(), expected.as_slice()) / size(expected.as_slice()).max(1.0)
}

/// What dual numbers say of a case.
struct Expected {
    form: DualForm,
    mass: DMatrix<f64>,
    rows: usize,
    freedoms: usize,
}

impl Expected {
    fn new(equipped: &Equipped) -> Self {
        let case = &equipped.case;
        let form = DualForm::new(&case.mechanism, equipped.equipment.clone());
        let rows = case.speeds.len();
        let (q, rest) = (constants(&case.q), constants(&vec![0.0; rows]));
        let column = |j: usize| {
            let mut unit = rest.clone();
            unit[j].value = 1.0;
            values(&form.inverse(&q, &rest, &unit, false))
        };
        Self {
            mass: matrix(rows, (0..rows).map(column)),
            freedoms: case.mechanism.layout().freedoms,
            form,
            rows,
        }
    }

    fn condition(&self) -> f64 {
        let symmetric = (&self.mass + self.mass.transpose()) * 0.5;
        let eigenvalues = symmetric.symmetric_eigenvalues();
        (eigenvalues.max() / eigenvalues.min()).max(1.0)
    }

    fn solve(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let factors = self.mass.clone().cholesky().expect("every body has mass");
        factors.solve(right)
    }

    /// ∂τ̄/∂ϕ and ∂τ̄/∂v̄.
    fn inverse(&self, case: &Case, rates: &[f64]) -> [DMatrix<f64>; 2] {
        let (form, q) = (&self.form, constants(&case.q));
        let (v, a) = (constants(&case.speeds), constants(rates));
        let along = |k| derivatives(&form.inverse(&form.moved(&case.q, k), &v, &a, true));
        let faster = |j| derivatives(&form.inverse(&q, &seeded(&case.speeds, j), &a, true));
        [
            matrix(self.rows, (0..self.freedoms).map(along)),
            matrix(self.rows, (0..self.rows).map(faster)),
        ]
    }

    /// ∂(S̄ᵀτ)/∂ϕ and S̄ᵀ.
    fn inputs(&self, case: &Case) -> [DMatrix<f64>; 2] {
        let (form, tau) = (&self.form, constants(&case.efforts));
        let along = |k| derivatives(&form.reduced(&form.moved(&case.q, k), &tau));
        let q = constants(&case.q);
        let unit = |k| derivatives(&form.reduced(&q, &seeded(&case.efforts, k)));
        [
            matrix(self.rows, (0..self.freedoms).map(along)),
            matrix(self.rows, (0..self.freedoms).map(unit)),
        ]
    }

    /// ∂p̄̇/∂ϕ and ∂p̄̇/∂p̄, with v̄ moving along with either.
    fn rates_of_momenta(
        &self,
        case: &Case,
        by_local: &DMatrix<f64>,
        by_momenta: &DMatrix<f64>,
    ) -> [DMatrix<f64>; 2] {
        let along = |k: usize| {
            let rate = by_local.column(k);
            self.momentum_rates(case, self.form.moved(&case.q, k), rate.as_slice())
        };
        let faster = |j: usize| {
            let rate = by_momenta.column(j);
            self.momentum_rates(case, constants(&case.q), rate.as_slice())
        };
        [
            matrix(self.rows, (0..self.freedoms).map(along)),
            matrix(self.rows, (0..self.rows).map(faster)),
        ]
    }

    /// p̄̇ with v̄ moving along with ϕ or p̄.
    fn momentum_rates(&self, case: &Case, q: Vec<Dual<f64>>, speed_rate: &[f64]) -> Vec<f64> {
        let mut state = self.form.state(&case.q, &case.speeds, &case.efforts);
        state.q = q;
        for (speed, rate) in state.speeds.iter_mut().zip(speed_rate) {
            speed.derivative = *rate;
        }
        derivatives(&self.form.momentum_rates(&state))
    }
}

fn place(Equipped { case, .. }: &Equipped) -> String {
    let bodies = case.mechanism.bodies();
    let root = bodies[0].joint().name();
    let elements = case.mechanism.elements().len();
    let count = bodies.len();
    format!(
        "case {} of {count} bodies on {root}, {elements} elements",
        case.seed
    )
}

#[test]
fn inverse_dynamics() {
    let mut worst = ["∂τ̄/∂ϕ", "∂τ̄/∂v̄"].map(Largest::new);
    for equipped in all() {
        let case = &equipped.case;
        let expected = Expected::new(&equipped).inverse(case, &case.rates);
        let mut found = InverseDerivatives::new(&case.mechanism);
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        dynamics
            .inverse_dynamics_derivatives(&case.q, &case.speeds, &case.rates, &mut found)
            .expect("nothing else acts");
        let found = [found.by_local().matrix(), found.by_speeds().matrix()];
        for ((worst, found), expected) in worst.iter_mut().zip(&found).zip(&expected) {
            worst.meet(relative(found, expected), place(&equipped));
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

#[test]
fn forward_dynamics() {
    let mut worst = ["∂v̄̇/∂ϕ", "∂v̄̇/∂v̄", "∂v̄̇/∂τ"].map(Largest::new);
    for equipped in all() {
        let case = &equipped.case;
        let oracle = Expected::new(&equipped);
        let mut found = ForwardDerivatives::new(&case.mechanism);
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        dynamics
            .forward_dynamics_derivatives(&case.q, &case.speeds, &case.efforts, &mut found)
            .expect("nothing else acts");
        let [by_local, by_speeds] = oracle.inverse(case, found.rates());
        let [inputs, basis] = oracle.inputs(case);
        let expected = [
            oracle.solve(&(inputs - by_local)),
            oracle.solve(&-by_speeds),
            oracle.solve(&basis),
        ];
        let condition = oracle.condition();
        let found = [found.by_local(), found.by_speeds(), found.by_efforts()];
        for ((worst, found), expected) in worst.iter_mut().zip(found).zip(&expected) {
            worst.meet(
                relative(&found.matrix(), expected) / condition,
                place(&equipped),
            );
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

#[test]
fn port_hamiltonian_form() {
    let laws = ["∂v̄/∂ϕ", "∂v̄/∂p̄", "∂p̄̇/∂ϕ", "∂p̄̇/∂p̄", "∂p̄̇/∂τ"];
    let mut worst = laws.map(Largest::new);
    for equipped in all() {
        let case = &equipped.case;
        let oracle = Expected::new(&equipped);
        let (form, rows) = (&oracle.form, oracle.rows);
        let p = &oracle.mass * DVector::from_column_slice(&case.speeds);
        let mut found = HamiltonianDerivatives::new(&case.mechanism);
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        dynamics
            .hamiltonian_derivatives(&case.q, p.as_slice(), &case.efforts, &mut found)
            .expect("nothing else acts");
        let (still, v) = (constants(&vec![0.0; rows]), constants(&case.speeds));
        let momenta = |k| {
            let q = form.moved(&case.q, k);
            derivatives(&form.inverse(&q, &still, &v, false))
        };
        let by_local = oracle.solve(&-matrix(rows, (0..oracle.freedoms).map(momenta)));
        let by_momenta = oracle.solve(&DMatrix::identity(rows, rows));
        let [along, faster] = oracle.rates_of_momenta(case, &by_local, &by_momenta);
        let [_, basis] = oracle.inputs(case);
        let expected = [by_local, by_momenta, along, faster, basis];
        let condition = oracle.condition();
        let found = [
            found.speeds_by_local(),
            found.speeds_by_momenta(),
            found.rates_by_local(),
            found.rates_by_momenta(),
            found.rates_by_efforts(),
        ];
        for ((worst, found), expected) in worst.iter_mut().zip(found).zip(&expected) {
            worst.meet(
                relative(&found.matrix(), expected) / condition,
                place(&equipped),
            );
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

#[test]
fn energies() {
    let mut worst = ["∂V/∂ϕ", "∂K/∂ϕ"].map(Largest::new);
    for equipped in all() {
        let case = &equipped.case;
        let form = DualForm::new(&case.mechanism, Equipment::default());
        let freedoms = case.mechanism.layout().freedoms;
        let mut found = [vec![0.0; freedoms], vec![0.0; freedoms]];
        let [potential, kinetic] = &mut found;
        Recursive::new(Arc::clone(&case.mechanism))
            .energy_gradients(&case.q, &case.speeds, potential, kinetic)
            .expect("sizes fit");
        let v = constants(&case.speeds);
        let along = |k| form.energies(&form.moved(&case.q, k), &v);
        let (kinetic, potential): (Vec<_>, Vec<_>) = (0..freedoms).map(along).unzip();
        let expected = [derivatives(&potential), derivatives(&kinetic)];
        for ((worst, found), expected) in worst.iter_mut().zip(&found).zip(&expected) {
            worst.meet(
                difference(found, expected) / size(expected).max(1.0),
                place(&equipped),
            );
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(BOUND));
}

/// What was filled in for one state leaves nothing behind for the next.
#[test]
fn results_are_used_again() {
    for Equipped { case, .. } in all().into_iter().step_by(7) {
        let still = vec![0.0; case.speeds.len()];
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let mut entries = |speeds: &[&[f64]]| {
            let mut inverse = InverseDerivatives::new(&case.mechanism);
            let mut forward = ForwardDerivatives::new(&case.mechanism);
            let mut hamiltonian = HamiltonianDerivatives::new(&case.mechanism);
            let (q, tau) = (&case.q, &case.efforts);
            for v in speeds {
                dynamics
                    .inverse_dynamics_derivatives(q, v, &case.rates, &mut inverse)
                    .expect("covered");
                dynamics
                    .forward_dynamics_derivatives(q, v, tau, &mut forward)
                    .expect("covered");
                dynamics
                    .hamiltonian_derivatives(q, v, tau, &mut hamiltonian)
                    .expect("covered");
            }
            let matrices = [
                inverse.by_local(),
                inverse.by_speeds(),
                forward.by_local(),
                forward.by_speeds(),
                forward.by_efforts(),
                hamiltonian.speeds_by_local(),
                hamiltonian.speeds_by_momenta(),
                hamiltonian.rates_by_local(),
                hamiltonian.rates_by_momenta(),
                hamiltonian.rates_by_efforts(),
            ];
            matrices.map(|matrix| matrix.entries().to_vec())
        };
        let once = entries(&[&still]);
        let again = entries(&[&case.speeds, &still]);
        assert!(once == again, "case {}", case.seed);
    }
}
