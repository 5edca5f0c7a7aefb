//! A state of a mechanism at which compiled equations are held against the tree's.

use super::Functions;
use crate::random;
use chacha20::ChaCha8Rng;
use hamel::dynamics::{Dynamics, MassMatrix, Recursive, Reference};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::DMatrix;
use hamel_compiler::functions::{Kind, Loops};
use hamel_compiler::model::Model;
use rand::SeedableRng;
use std::sync::Arc;

/// The least bound of relative errors that is asked for.
pub(super) const BOUND: f64 = 1e-12;
/// Roundings of a solution with M̄ for each unit of its condition, as for the tree.
const ROUNDINGS: f64 = 10.0;

/// As by default, which is without loops in what is short, and with all that there are.
const BOTH: [Loops; 2] = [Loops::Long, Loops::Always];

/// Loops in every fourth case: few bodies of random trees are alike.
fn loops(seed: u64) -> &'static [Loops] {
    if seed.is_multiple_of(4) {
        &BOTH
    } else {
        &BOTH[..1]
    }
}

/// What gives the values of a compiled function at a state: [`Functions::evaluate`], or what stands in for it.
pub type Evaluate<'a> = &'a dyn Fn((Kind, Loops), &[f64], &[f64], &[f64]) -> Vec<f64>;

/// A state, and what the tree makes of it.
pub struct Point {
    place: String,
    /// How it is compiled.
    loops: &'static [Loops],
    pub(super) model: Model,
    pub(super) mechanism: Arc<Mechanism>,
    pub(super) q: Vec<f64>,
    pub(super) speeds: Vec<f64>,
    pub(super) inputs: Vec<f64>,
}

impl Point {
    /// At a random state.
    pub fn random(model: Model, mechanism: &Arc<Mechanism>, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let q = random::configuration(&mut random, mechanism);
        Self::with_speeds(model, mechanism, q, &mut random)
    }

    /// At a configuration, with random speeds and efforts.
    pub fn at(model: Model, mechanism: &Arc<Mechanism>, q: Vec<f64>, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        Self::with_speeds(model, mechanism, q, &mut random)
    }

    fn with_speeds(
        model: Model,
        mechanism: &Arc<Mechanism>,
        q: Vec<f64>,
        random: &mut ChaCha8Rng,
    ) -> Self {
        let layout = *mechanism.layout();
        Self {
            place: model.name.clone(),
            loops: &BOTH,
            model,
            q,
            speeds: random::numbers(random, layout.speeds),
            inputs: random::numbers(random, layout.freedoms),
            mechanism: Arc::clone(mechanism),
        }
    }

    /// A random case, on which gravity alone acts.
    pub fn bare(case: random::Case) -> Self {
        Self {
            place: format!("seed {}", case.seed),
            loops: loops(case.seed),
            model: super::model("random", &case.mechanism),
            mechanism: case.mechanism,
            q: case.q,
            speeds: case.speeds,
            inputs: case.efforts,
        }
    }

    /// A random case with elements of all kinds, of odd seeds with driven joints, of every third with constraints that couple joints.
    pub fn with_elements(case: random::Case) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(case.seed);
        let mut geared = super::geared(&mut random, &case.mechanism);
        if case.seed % 2 == 1 {
            geared = super::driven(&mut random, &geared);
        }
        if case.seed % 3 == 2 {
            geared = super::coupled(&mut random, geared, &case.q);
        }
        let mut model = super::model("random", &geared);
        model.elements = super::elements(&mut random, &geared);
        Self {
            place: format!("seed {}, with elements", case.seed),
            loops: loops(case.seed),
            mechanism: super::equipped(&geared, &model.elements),
            model,
            q: case.q,
            speeds: case.speeds,
            inputs: case.efforts,
        }
    }

    /// With loops or without, as said.
    pub fn compiled_with(self, loops: &'static [Loops]) -> Self {
        Self { loops, ..self }
    }

    /// How derivatives are compiled: loops over pairs of joints hold for all joints, whether bodies are alike or not.
    pub(super) fn loops_of_derivatives(&self) -> Vec<Loops> {
        match self.loops {
            [Loops::Long] => vec![Loops::Long],
            _ => vec![Loops::Never, Loops::Long, Loops::Always],
        }
    }

    /// All functions have the values of the tree.
    ///
    /// # Panics
    /// Where one has not.
    pub fn agrees(self) {
        let model = self.model.clone();
        self.agrees_with(&Functions::new(&model));
    }

    /// The same of functions that are kept for further states.
    ///
    /// # Panics
    /// Where one has not.
    pub fn agrees_with(self, functions: &Functions<'_>) {
        self.agrees_by(&|how, q, speeds, inputs| functions.evaluate(how, q, speeds, inputs));
    }

    /// What `by` gives agrees, however it is compiled.
    fn agree(&self, by: Evaluate<'_>, kind: Kind, inputs: &[f64], expected: &[f64], bound: f64) {
        for &loops in self.loops {
            let how = (kind, loops);
            let found = by(how, &self.q, &self.speeds, inputs);
            self.close(&format!("{how:?}"), &found, expected, bound);
        }
    }

    /// The same of what stands in for them.
    ///
    /// # Panics
    /// Where one has not.
    pub fn agrees_by(mut self, by: Evaluate<'_>) {
        let mut tree = Recursive::new(Arc::clone(&self.mechanism));
        tree.complete_speeds(&self.q, &mut self.speeds)
            .expect("constraints determine them");
        let (q, speeds) = (&self.q, &self.speeds);
        let mut expected = vec![0.0; speeds.len()];
        let rates = &self.inputs[..speeds.len()];

        let mut mass = MassMatrix::new(&self.mechanism);
        tree.mass_matrix(q, &mut mass).expect("sizes fit");
        let mass = mass.matrix();
        let rows: Vec<f64> = mass.transpose().iter().copied().collect();
        self.agree(by, Kind::MassMatrix, &[], &rows, BOUND);

        tree.inverse_dynamics(q, speeds, rates, &mut expected)
            .expect("sizes fit");
        self.agree(by, Kind::InverseDynamics, rates, &expected, BOUND);
        tree.bias_forces(q, speeds, &mut expected)
            .expect("sizes fit");
        self.agree(by, Kind::BiasForces, &[], &expected, BOUND);

        tree.forward_dynamics(q, speeds, &self.inputs, &mut expected)
            .expect("M̄ is regular");
        let bound = of_solutions(mass);
        self.agree(by, Kind::ForwardDynamics, &self.inputs, &expected, bound);
        self.forms_agree(by, &mut tree, bound);
        self.places_agree(by);
    }

    /// Both forms have the values of the reference form.
    ///
    /// # Panics
    /// Where one has not.
    pub fn agrees_with_reference(self) {
        let (q, speeds) = (&self.q, &self.speeds);
        let mut mass = MassMatrix::new(&self.mechanism);
        let mut tree = Recursive::new(Arc::clone(&self.mechanism));
        tree.mass_matrix(q, &mut mass).expect("sizes fit");
        let bound = of_solutions(mass.matrix());
        let mut reference = Reference::new(Arc::clone(&self.mechanism));
        let mut expected = vec![0.0; speeds.len()];
        reference
            .forward_dynamics(q, speeds, &self.inputs, &mut expected)
            .expect("M̄ is regular");
        let inputs = &self.inputs;
        let functions = Functions::new(&self.model);
        let by: Evaluate<'_> = &|how, q, v, u| functions.evaluate(how, q, v, u);
        self.agree(by, Kind::ForwardDynamics, inputs, &expected, bound);
        self.forms_agree(by, &mut reference, bound);
    }

    /// The port-Hamiltonian form; `bound` is that of solutions with M̄.
    fn forms_agree(&self, by: Evaluate<'_>, tree: &mut dyn Dynamics, bound: f64) {
        let (q, speeds) = (&self.q, &self.speeds);
        let mut momenta = vec![0.0; speeds.len()];
        tree.momenta(q, speeds, &mut momenta).expect("sizes fit");
        let (mut back, mut rates) = (speeds.clone(), momenta.clone());
        let mut efforts = |_: &[f64], tau: &mut [f64]| tau.copy_from_slice(&self.inputs);
        tree.momentum_rates(q, &momenta, &mut efforts, &mut back, &mut rates)
            .expect("M̄ is regular");
        let energy = tree.hamiltonian(q, &momenta).expect("M̄ is regular");
        for &loops in self.loops {
            let evaluate = |kind, state: &[f64]| by((kind, loops), q, state, &self.inputs);
            self.close("momenta", &evaluate(Kind::Momenta, speeds), &momenta, BOUND);
            let found = evaluate(Kind::Speeds, &momenta);
            self.close("speeds", &found, speeds, bound);
            let found = evaluate(Kind::MomentumRates, &momenta);
            let (found_speeds, found_rates) = found.split_at(speeds.len());
            self.close("speeds with rates", found_speeds, &back, bound);
            self.close("momentum rates", found_rates, &rates, bound);

            let energies = evaluate(Kind::Energies, speeds);
            let scale = energies
                .iter()
                .fold(energy.abs(), |most, part| most.max(part.abs()));
            let relative = |found: f64| vec![(found - energy) / scale + 1.0];
            self.close("energies", &relative(energies.iter().sum()), &[1.0], BOUND);
            let hamiltonian = evaluate(Kind::Hamiltonian, &momenta);
            self.close("hamiltonian", &relative(hamiltonian[0]), &[1.0], bound);
        }
    }

    fn places_agree(&self, by: Evaluate<'_>) {
        let kinematics = self.mechanism.kinematics(&self.q, &self.speeds);
        let kinematics = kinematics.expect("sizes fit");
        let expected = kinematics.bodies.iter().flat_map(|body| {
            let rotation: Vec<f64> = body.pose.rotation.transpose().iter().copied().collect();
            [rotation, body.pose.translation.as_slice().to_vec()].concat()
        });
        let expected: Vec<f64> = expected.collect();
        self.agree(by, Kind::Poses, &[], &expected, BOUND);
    }

    fn close(&self, what: &str, found: &[f64], expected: &[f64], bound: f64) {
        self.close_beside(f64::MIN_POSITIVE, what, found, expected, bound);
    }

    /// Errors are relative to the largest value, or to what it is made of where that is larger.
    pub(super) fn close_beside(
        &self,
        terms: f64,
        what: &str,
        found: &[f64],
        expected: &[f64],
        bound: f64,
    ) {
        let largest = expected
            .iter()
            .fold(terms, |most, entry| most.max(entry.abs()));
        let error = found.iter().zip(expected).fold(0.0_f64, |most, (a, b)| {
            // NaN is the largest of all.
            let error = (a - b).abs() / largest;
            if error <= most { most } else { error }
        });
        assert_eq!(found.len(), expected.len());
        assert!(
            error <= bound,
            "{}, {what}: {error:e} > {bound:e}",
            self.place
        );
    }
}

/// The bound of errors of solutions with M̄.
pub(super) fn of_solutions(mass: DMatrix<f64>) -> f64 {
    BOUND.max(ROUNDINGS * condition(mass) * f64::EPSILON)
}

/// The condition of M̄.
pub(super) fn condition(mass: DMatrix<f64>) -> f64 {
    let eigenvalues = mass.symmetric_eigenvalues();
    eigenvalues.max() / eigenvalues.min()
}
