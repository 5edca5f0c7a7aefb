//! Whether compiled equations are those of a mechanism: their rates at one state beside those of the tree.

use super::states::poses_of;
use super::tree::{Compiled, CompiledError};
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{
    Dynamics, DynamicsError, ForwardDerivatives, ForwardSecondDerivatives, InverseDerivatives,
    InverseSecondDerivatives, MassMatrix, Refined,
};
use hamel_runtime::joint::MOST_FREEDOMS;
use hamel_runtime::mechanism::{Mechanism, StateError};
use nalgebra::Vector6;

/// Why two forms do not agree at one configuration.
enum Unlike {
    /// Rates differ.
    Rate {
        /// Which of the entries of v̄ it belongs to.
        entry: usize,
        expected: f64,
        found: f64,
    },
    /// Other numbers differ.
    Value {
        quantity: &'static str,
        expected: f64,
        found: f64,
    },
    /// The tree has no value there.
    NoValue(DynamicsError),
}

impl Unlike {
    /// What was said of an entry of v̄, of an entry of something else.
    fn of(self, quantity: &'static str) -> Self {
        match self {
            Self::Rate {
                expected, found, ..
            } => Self::Value {
                quantity,
                expected,
                found,
            },
            other => other,
        }
    }
}

impl From<StateError> for Unlike {
    fn from(cause: StateError) -> Self {
        Self::NoValue(cause.into())
    }
}

impl From<DynamicsError> for Unlike {
    fn from(cause: DynamicsError) -> Self {
        Self::NoValue(cause)
    }
}

/// How many configurations near home are tried where home has no value.
const NEAR_HOME: usize = 4;

/// How far rates may differ, relative to the largest: what conditioning leaves of doubles in the worst of tested robots
/// is 1e-8; another mass or length shows in the leading digits.
const AGREEMENT: f64 = 1e-6;

/// How many times as far from exact rates as those of the tree they may be, where conditioning leaves less: both lose as many digits, in different operations.
const AS_FAR: f64 = 10.0;

/// Rates of a mechanism by the tree in doubles, and to the last digit.
struct Rates {
    doubles: Vec<f64>,
    exact: Vec<f64>,
}

impl Rates {
    fn new(size: usize) -> Self {
        Self {
            doubles: vec![0.0; size],
            exact: vec![0.0; size],
        }
    }

    /// What doubles tell well enough.
    fn of(values: &[f64]) -> Self {
        Self {
            doubles: values.to_vec(),
            exact: values.to_vec(),
        }
    }

    /// The error unless all that was found is near the exact rates.
    fn meet(&self, found: &[f64]) -> Result<(), Unlike> {
        let largest = |values: &mut dyn Iterator<Item = f64>| {
            values.fold(0.0_f64, |most, value| most.max(value.abs()))
        };
        let pairs = self.doubles.iter().zip(&self.exact);
        let lost = largest(&mut pairs.map(|(doubles, exact)| doubles - exact));
        let limit = AGREEMENT * largest(&mut self.exact.iter().copied()) + AS_FAR * lost;
        let differs = |(found, exact): (&f64, &f64)| {
            let agrees = (found - exact).abs() <= limit;
            // So that NaN differs.
            !agrees
        };
        match found.iter().zip(&self.exact).position(differs) {
            None => Ok(()),
            Some(entry) => Err(Unlike::Rate {
                entry,
                expected: self.exact[entry],
                found: found[entry],
            }),
        }
    }
}

/// The error unless numbers that take no solution are near those of the tree.
fn meet((expected, found): (&[f64], &[f64]), quantity: &'static str) -> Result<(), Unlike> {
    let met = Rates::of(expected).meet(found);
    met.map_err(|unlike| unlike.of(quantity))
}

/// Numbers that differ among themselves.
fn numbers(count: usize) -> Vec<f64> {
    (0..count).map(|i| 0.1 + 0.01 * i as f64).collect()
}

/// Speeds at which no body turns or moves faster than at [`numbers`], rad/s and m/s relative to what carries its joint: behind a gear of ratio 1e7 other speeds make forces that leave no digit.
fn speeds_at(mechanism: &Mechanism, q: &[f64]) -> Vec<f64> {
    let mut speeds = numbers(mechanism.layout().speeds);
    let mut fastest = vec![1.0_f64; speeds.len()];
    let mut columns = [Vector6::zeros(); MOST_FREEDOMS];
    for body in mechanism.bodies() {
        let own = body.ranges().speeds.clone();
        let columns = &mut columns[..own.len()];
        body.joint().speed_map(body.configuration(q), columns);
        for (most, column) in fastest[own].iter_mut().zip(columns) {
            *most = most.max(column.amax());
        }
    }
    (speeds.iter_mut().zip(fastest)).for_each(|(speed, most)| *speed /= most);
    speeds
}

/// A configuration near home, another one in each round; none where a joint does not get there.
fn near_home(mechanism: &Mechanism, round: usize) -> Option<Vec<f64>> {
    // Multiples of the golden section lie without pattern, so that no joint stands as another does.
    let part = |freedom: usize| (0.618_034 * (freedom + round * 17) as f64) % 1.0;
    let mut near = mechanism.home();
    for (index, body) in mechanism.joints() {
        let ranges = body.ranges();
        let phi: Vec<f64> = ranges
            .freedoms
            .clone()
            .map(|i| 0.1 + 0.2 * part(i))
            .collect();
        let moved = mechanism.configuration_from_local(index, &phi).ok()?;
        near[ranges.configuration.clone()].copy_from_slice(&moved);
    }
    Some(near)
}

impl Compiled {
    /// Holds both forms against each other at the first place where the tree has a value.
    pub(super) fn compared(mut self, start: Option<&[f64]>) -> Result<Self, CompiledError> {
        let mechanism = Arc::clone(self.tree.mechanism());
        let start = start.map(|q| ("where the motion begins", q.to_vec()));
        let home = ("at home", mechanism.home());
        let near = (1..=NEAR_HOME).filter_map(|round| near_home(&mechanism, round));
        let near = near.map(|q| ("near home", q));
        let mut first = None;
        for (place, q) in start.into_iter().chain([home]).chain(near) {
            match self.compare(&q) {
                Ok(()) => return Ok(self),
                Err(Unlike::Rate {
                    entry,
                    expected,
                    found,
                }) => return Err(self.other(place, entry, expected, found)),
                Err(Unlike::Value {
                    quantity,
                    expected,
                    found,
                }) => {
                    return Err(CompiledError::Value {
                        scene: self.functions.scene,
                        place,
                        quantity,
                        expected,
                        found,
                    });
                }
                Err(Unlike::NoValue(cause)) => {
                    first.get_or_insert((place, cause));
                }
            }
        }
        match first {
            None => Ok(self),
            Some((place, cause)) => Err(CompiledError::NoValue {
                scene: self.functions.scene,
                place,
                cause,
            }),
        }
    }

    /// Holds the rates of both forms at `q` against each other, with speeds, momenta and efforts that differ among themselves.
    fn compare(&mut self, q: &[f64]) -> Result<(), Unlike> {
        let mechanism = Arc::clone(self.tree.mechanism());
        let mut speeds = speeds_at(&mechanism, q);
        let efforts = numbers(self.functions.freedoms);
        self.tree.complete_speeds(q, &mut speeds)?;
        let mut exact = Refined::new(Arc::clone(&mechanism));
        let mut rates = Rates::new(speeds.len());
        self.tree
            .forward_dynamics(q, &speeds, &efforts, &mut rates.doubles)?;
        exact.forward_dynamics(q, &speeds, &efforts, &mut rates.exact)?;
        if let Some(forward) = &self.functions.forward_dynamics {
            let mut found = vec![0.0; speeds.len()];
            let efforts = self.timed.added(&mechanism, q, &efforts);
            forward(q, &speeds, efforts, &mut found);
            rates.meet(&found)?;
        }
        if self.functions.forward_dynamics_derivatives.is_some() {
            let mut found = ForwardDerivatives::new(&mechanism);
            self.forward_dynamics_derivatives(q, &speeds, &efforts, &mut found)?;
            rates.meet(found.rates())?;
        }
        self.compare_inverse(q, &speeds)?;
        self.compare_inverse_derivatives(q, &speeds)?;
        self.compare_second_derivatives(q, &speeds, &efforts)?;
        self.compare_places(q, &speeds)?;
        self.compare_momenta((&mut exact, q), &mut speeds, &efforts)
    }

    /// The same of the port-Hamiltonian form.
    fn compare_momenta(
        &mut self,
        (exact, q): (&mut Refined, &[f64]),
        speeds: &mut [f64],
        efforts: &[f64],
    ) -> Result<(), Unlike> {
        let functions = Arc::clone(&self.functions);
        let size = speeds.len();
        let [mut momenta, mut found] = [(); 2].map(|()| vec![0.0; size]);
        self.tree.momenta(q, speeds, &mut momenta)?;
        if let Some(map) = &functions.momenta {
            map(q, speeds, &[], &mut found);
            Rates::of(&momenta).meet(&found)?;
        }
        if let Some(map) = &functions.speeds_from_momenta {
            let mut expected = Rates::new(size);
            self.tree.speeds(q, &momenta, &mut expected.doubles)?;
            exact.speeds(q, &momenta, &mut expected.exact)?;
            map(q, &momenta, &[], &mut found);
            expected.meet(&found)?;
        }
        if let Some(momentum_rates) = &functions.momentum_rates {
            let mut expected = Rates::new(size);
            let mut given = |_: &[f64], tau: &mut [f64]| tau.copy_from_slice(efforts);
            self.tree
                .momentum_rates(q, &momenta, &mut given, speeds, &mut expected.doubles)?;
            exact.momentum_rates(q, &momenta, &mut given, speeds, &mut expected.exact)?;
            let mechanism = Arc::clone(self.tree.mechanism());
            let efforts = self.timed.added(&mechanism, q, efforts);
            let mut both = vec![0.0; 2 * size];
            momentum_rates(q, &momenta, efforts, &mut both);
            expected.meet(&both[size..])?;
        }
        Ok(())
    }

    /// The same of inverse dynamics, at accelerations that are the speeds, and of M̄.
    fn compare_inverse(&mut self, q: &[f64], speeds: &[f64]) -> Result<(), Unlike> {
        let functions = Arc::clone(&self.functions);
        let size = speeds.len();
        let [mut expected, mut found] = [(); 2].map(|()| vec![0.0; size]);
        if functions.inverse_dynamics.is_some() {
            self.tree
                .inverse_dynamics(q, speeds, speeds, &mut expected)?;
            self.inverse_dynamics(q, speeds, speeds, &mut found)?;
            meet((&expected, &found), "inverse dynamics")?;
        }
        if functions.bias_forces.is_some() {
            self.tree.bias_forces(q, speeds, &mut expected)?;
            self.bias_forces(q, speeds, &mut found)?;
            meet((&expected, &found), "the bias force")?;
        }
        if functions.mass_matrix.is_some() {
            let mut mass = MassMatrix::new(self.tree.mechanism());
            self.tree.mass_matrix(q, &mut mass)?;
            let entries = (0..size * size).map(|index| mass.entry(index / size, index % size));
            let expected: Vec<f64> = entries.collect();
            let mut found = vec![0.0; size * size];
            self.mass_matrix(q, &mut found)?;
            meet((&expected, &found), "the mass matrix")?;
        }
        Ok(())
    }

    /// The same of energies and poses.
    fn compare_places(&mut self, q: &[f64], speeds: &[f64]) -> Result<(), Unlike> {
        let functions = Arc::clone(&self.functions);
        if functions.energies.is_some() {
            let tree = self.tree.mechanism().kinematics(q, speeds)?;
            let expected = [tree.kinetic_energy(), tree.potential_energy()];
            let found = self.energies(q, speeds)?;
            meet((&expected, &found), "the energy")?;
        }
        if functions.poses.is_some() {
            let expected = poses_of(self.tree.mechanism(), q)?;
            let mut found = vec![0.0; expected.len()];
            self.poses(q, &mut found)?;
            meet((&expected, &found), "a pose")?;
        }
        Ok(())
    }

    /// The same of the derivatives of inverse dynamics: how efforts change as all of ϕ and v̄ grow alike.
    fn compare_inverse_derivatives(&mut self, q: &[f64], speeds: &[f64]) -> Result<(), Unlike> {
        if self.functions.inverse_dynamics_derivatives.is_none() {
            return Ok(());
        }
        let mechanism = Arc::clone(self.tree.mechanism());
        let [mut found, mut expected] = [(); 2].map(|()| InverseDerivatives::new(&mechanism));
        self.tree
            .inverse_dynamics_derivatives(q, speeds, speeds, &mut expected)?;
        self.inverse_dynamics_derivatives(q, speeds, speeds, &mut found)?;
        // Beside the efforts themselves, so that what is 0 up to rounding is nothing.
        let mut efforts = vec![0.0; speeds.len()];
        let given = self.tree.inverse_dynamics(q, speeds, speeds, &mut efforts);
        given.map_err(DynamicsError::from)?;
        let changed = |by: &InverseDerivatives| -> Vec<f64> {
            let rows = efforts.iter().enumerate();
            rows.map(|(row, effort)| effort + by.sum_of_row(row))
                .collect()
        };
        Rates::of(&changed(&expected)).meet(&changed(&found))
    }

    /// The same of second derivatives; λ of forward dynamics is such that virtual speeds are the speeds.
    fn compare_second_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
    ) -> Result<(), Unlike> {
        let functions = Arc::clone(&self.functions);
        let mechanism = Arc::clone(self.tree.mechanism());
        if functions.inverse_dynamics_second_derivatives.is_some() {
            let mut expected = InverseSecondDerivatives::new(&mechanism);
            self.tree.inverse_dynamics_second_derivatives(
                q,
                speeds,
                speeds,
                speeds,
                &mut expected,
            )?;
            let expected = expected.hessian().entries();
            let mut found = vec![0.0; expected.len()];
            self.inverse_dynamics_second_derivatives(q, speeds, speeds, speeds, &mut found)?;
            meet((expected, &found), "the Hessian of inverse dynamics")?;
        }
        if functions.forward_dynamics_second_derivatives.is_some() {
            let mut weights = vec![0.0; speeds.len()];
            self.tree.momenta(q, speeds, &mut weights)?;
            let mut expected = ForwardSecondDerivatives::new(&mechanism);
            self.tree.forward_dynamics_second_derivatives(
                q,
                speeds,
                efforts,
                &weights,
                &mut expected,
            )?;
            let expected = expected.hessian().entries();
            let mut found = vec![0.0; expected.len()];
            self.forward_dynamics_second_derivatives(q, speeds, efforts, &weights, &mut found)?;
            meet((expected, &found), "the Hessian of forward dynamics")?;
        }
        Ok(())
    }

    fn other(&self, place: &'static str, entry: usize, expected: f64, found: f64) -> CompiledError {
        let bodies = self.tree.mechanism().bodies().iter();
        let mut named = bodies
            .filter(|body| body.ranges().speeds.contains(&entry))
            .map(|body| {
                let own = entry - body.ranges().speeds.start;
                let speed = body.joint().speeds().get(own).copied();
                (String::from(body.joint_name()), speed.unwrap_or_default())
            });
        let (joint, speed) = named.next().unwrap_or_default();
        CompiledError::Other {
            scene: self.functions.scene,
            place,
            joint,
            speed,
            expected,
            found,
        }
    }
}
