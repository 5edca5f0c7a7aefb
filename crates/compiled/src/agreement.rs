//! Whether compiled equations are those of a mechanism: their rates at one state beside those of the tree.

use super::Equations;
use super::tree::{Compiled, CompiledError};
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{
    Dynamics, DynamicsError, ForwardDerivatives, InverseDerivatives, Refined,
};
use hamel_runtime::joint::MOST_FREEDOMS;
use hamel_runtime::mechanism::Mechanism;
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
    /// The tree has no value there.
    NoValue(DynamicsError),
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
                Err(Unlike::NoValue(cause)) => {
                    first.get_or_insert((place, cause));
                }
            }
        }
        match first {
            None => Ok(self),
            Some((place, cause)) => Err(CompiledError::NoValue {
                scene: self.equations.scene,
                place,
                cause,
            }),
        }
    }

    /// Holds the rates of both forms at `q` against each other, with speeds, momenta and efforts that differ among themselves.
    fn compare(&mut self, q: &[f64]) -> Result<(), Unlike> {
        let mechanism = Arc::clone(self.tree.mechanism());
        let mut speeds = speeds_at(&mechanism, q);
        let efforts = numbers(self.equations.freedoms);
        self.tree.complete_speeds(q, &mut speeds)?;
        let mut exact = Refined::new(Arc::clone(&mechanism));
        let mut rates = Rates::new(speeds.len());
        self.tree
            .forward_dynamics(q, &speeds, &efforts, &mut rates.doubles)?;
        exact.forward_dynamics(q, &speeds, &efforts, &mut rates.exact)?;
        if let Some(forward) = self.equations.forward_dynamics {
            let mut found = vec![0.0; speeds.len()];
            forward(q, &speeds, self.with_timed(q, &efforts), &mut found);
            rates.meet(&found)?;
        }
        if self.equations.forward_dynamics_derivatives.is_some() {
            let mut found = ForwardDerivatives::new(&mechanism);
            self.forward_dynamics_derivatives(q, &speeds, &efforts, &mut found)?;
            rates.meet(found.rates())?;
        }
        self.compare_inverse_derivatives(q, &speeds)?;
        self.compare_momenta((&mut exact, q), &mut speeds, &efforts)
    }

    /// The same of the port-Hamiltonian form.
    fn compare_momenta(
        &mut self,
        (exact, q): (&mut Refined, &[f64]),
        speeds: &mut [f64],
        efforts: &[f64],
    ) -> Result<(), Unlike> {
        let Equations {
            momenta: by_speeds,
            speeds_from_momenta: by_momenta,
            momentum_rates,
            ..
        } = *self.equations;
        let size = speeds.len();
        let [mut momenta, mut found] = [(); 2].map(|()| vec![0.0; size]);
        self.tree.momenta(q, speeds, &mut momenta)?;
        if let Some(map) = by_speeds {
            map(q, speeds, &mut found);
            Rates::of(&momenta).meet(&found)?;
        }
        if let Some(map) = by_momenta {
            let mut expected = Rates::new(size);
            self.tree.speeds(q, &momenta, &mut expected.doubles)?;
            exact.speeds(q, &momenta, &mut expected.exact)?;
            map(q, &momenta, &mut found);
            expected.meet(&found)?;
        }
        if let Some(momentum_rates) = momentum_rates {
            let mut expected = Rates::new(size);
            let mut given = |_: &[f64], tau: &mut [f64]| tau.copy_from_slice(efforts);
            self.tree
                .momentum_rates(q, &momenta, &mut given, speeds, &mut expected.doubles)?;
            exact.momentum_rates(q, &momenta, &mut given, speeds, &mut expected.exact)?;
            momentum_rates(q, &momenta, self.with_timed(q, efforts), speeds, &mut found);
            expected.meet(&found)?;
        }
        Ok(())
    }

    /// The same of the derivatives of inverse dynamics: how efforts change as all of ϕ and v̄ grow alike.
    fn compare_inverse_derivatives(&mut self, q: &[f64], speeds: &[f64]) -> Result<(), Unlike> {
        if self.equations.inverse_dynamics_derivatives.is_none() {
            return Ok(());
        }
        let mechanism = Arc::clone(self.tree.mechanism());
        let [mut found, mut expected] = [(); 2].map(|()| InverseDerivatives::new(&mechanism));
        self.tree
            .inverse_dynamics_derivatives(q, speeds, speeds, &mut expected)?;
        self.inverse_dynamics_derivatives(q, speeds, speeds, &mut found)?;
        // Beside the efforts themselves, so that what is 0 but for rounding is nothing.
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
            scene: self.equations.scene,
            place,
            joint,
            speed,
            expected,
            found,
        }
    }
}
