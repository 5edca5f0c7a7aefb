//! Ports of joints: their values and rates, and what efforts and rates at them are in τ and v̄.

use super::check::{Space, check_size};
use super::initial::CONSTRAINT_TOLERANCE;
use super::{Body, Mechanism, StateError};
use crate::joint::MOST_FREEDOMS;
use crate::time_function::Moment;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, DVector};

/// How small the smallest singular value of `P S̄` may be, next to the largest or to the rates of Q at unit speeds, for rates at ports to determine the speeds.
const DETERMINED: f64 = 1e-9;

impl Body {
    /// P at this joint's Q.
    pub(super) fn port_map(&self, q: &[f64]) -> DMatrix<f64> {
        let (joint, freedoms) = (self.joint(), self.ranges.freedoms.len());
        let mut transposed = DMatrix::zeros(freedoms, joint.ports().len());
        for (port, mut column) in transposed.column_iter_mut().enumerate() {
            joint.port_row(q, port, column.as_mut_slice());
        }
        transposed.transpose()
    }

    /// The largest rate of a stored scalar at unit speeds: what rates at ports are small beside, where the ports stand still.
    fn largest_rate(&self, q: &[f64], basis: &DMatrix<f64>) -> f64 {
        let mut rate = vec![0.0; q.len()];
        let mut largest = 0.0_f64;
        for velocity in basis.column_iter() {
            self.joint()
                .configuration_rate(q, velocity.clone_owned().as_slice(), &mut rate);
            largest = rate
                .iter()
                .fold(largest, |most, entry| most.max(entry.abs()));
        }
        largest
    }
}

impl Mechanism {
    /// The index of the port called `name` of the joint under `body`.
    pub fn port_index(&self, body: usize, name: &str) -> Option<usize> {
        let joint = self.bodies().get(body)?.joint();
        joint.ports().iter().position(|port| port.name == name)
    }

    /// P of the joint under `body` at its own configuration `q`: v to the rates of its ports, rad/s and m/s, a row for each.
    ///
    /// # Errors
    /// No such body; a configuration of the wrong size or off the joint's manifold.
    pub fn port_map(&self, body: usize, q: &[f64]) -> Result<DMatrix<f64>, StateError> {
        let body = self.body(body)?;
        body.check_configuration(q)?;
        Ok(body.port_map(q))
    }

    /// The values of the ports of the joint under `body` at its own configuration `q`, rad and m.
    ///
    /// # Errors
    /// As for [`Mechanism::port_map`].
    pub fn port_values(&self, body: usize, q: &[f64]) -> Result<Vec<f64>, StateError> {
        let body = self.body(body)?;
        body.check_configuration(q)?;
        let joint = body.joint();
        let ports = 0..joint.ports().len();
        Ok(ports.map(|port| joint.port_value(q, port)).collect())
    }

    /// The rates of the ports of the joint under `body` at the state of the mechanism, rad/s and m/s.
    ///
    /// # Errors
    /// No such body; a vector of the wrong size, or not finite.
    pub fn port_rates(
        &self,
        body: usize,
        q: &[f64],
        speeds: &[f64],
    ) -> Result<Vec<f64>, StateError> {
        let body = self.body(body)?;
        self.check_vector("configuration", Space::Configuration, q)?;
        self.check_vector("speeds", Space::Speeds, speeds)?;
        let q = body.configuration(q);
        let own = DVector::from_column_slice(&speeds[body.ranges.speeds.clone()]);
        let rates = body.port_map(q) * body.speed_basis(q) * own;
        Ok(rates.as_slice().to_vec())
    }

    /// The efforts `Pᵀ τ_p` of the joint under `body` at its own configuration `q`, for `efforts` τ_p at all of its ports, N·m and N.
    ///
    /// # Errors
    /// As for [`Mechanism::port_map`]; another number of efforts than of ports.
    pub fn efforts_from_ports(
        &self,
        body: usize,
        q: &[f64],
        efforts: &[f64],
    ) -> Result<Vec<f64>, StateError> {
        let map = self.port_map(body, q)?;
        let name = self.body(body)?.joint_name();
        check_size(name, "efforts at ports", map.nrows(), efforts.len())?;
        let own = map.tr_mul(&DVector::from_column_slice(efforts));
        Ok(own.as_slice().to_vec())
    }

    /// Adds the efforts at ports that are functions of time to τ, as `Pᵀ f`, at the configuration `q` of all joints. The tree has them among its elements; equations that
    /// were compiled are handed them. At joints whose motion is prescribed they do nothing.
    pub fn add_timed_port_efforts(&self, at: Moment, q: &[f64], efforts: &mut [f64]) {
        let elements = self.elements().iter();
        let timed = elements.filter_map(|element| element.timed_port_effort(at));
        for (body, port, effort) in timed.filter(|(body, ..)| !self.is_driven(*body)) {
            let Ok(own) = self.body(body) else { continue };
            let mut row = [0.0; MOST_FREEDOMS];
            let row = &mut row[..own.ranges().freedoms.len()];
            own.joint().port_row(own.configuration(q), port, row);
            let sums = efforts[own.ranges().freedoms.clone()].iter_mut();
            sums.zip(row)
                .for_each(|(sum, entry)| *sum += *entry * effort);
        }
    }

    /// Whether efforts at some port change with time.
    pub fn has_timed_port_efforts(&self) -> bool {
        let at = Moment::default();
        let mut elements = self.elements().iter();
        elements.any(|element| element.timed_port_effort(at).is_some())
    }

    /// The speeds v̄ at which some ports of the joint under `body`, at its own configuration `q`, have these `rates`: by index, rad/s and m/s.
    ///
    /// # Errors
    /// As for [`Mechanism::port_map`]; a rate that is not finite; rates that leave a speed open, or contradict each other, here.
    pub fn speeds_from_port_rates(
        &self,
        body: usize,
        q: &[f64],
        rates: &[(usize, f64)],
    ) -> Result<Vec<f64>, StateError> {
        let all = self.port_map(body, q)?;
        let body = self.body(body)?;
        let joint = || body.joint_name().into();
        let ports = body.joint().ports();
        for &(port, value) in rates {
            let (index, count) = (port, ports.len());
            let known = ports.get(port).ok_or_else(|| StateError::UnknownPort {
                joint: joint(),
                index,
                count,
            })?;
            body.check_finite("port rates", &[known.name], &[value])?;
        }
        let basis = body.speed_basis(q);
        let map = all.select_rows(rates.iter().map(|(port, _)| port)) * &basis;
        let target = DVector::from_iterator(rates.len(), rates.iter().map(|(_, rate)| *rate));
        let speeds = map.ncols();
        let (rank, solved) = least_squares(&map, &target, body.largest_rate(q, &basis));
        if rank < speeds {
            return Err(StateError::PortRatesLeaveOpen {
                joint: joint(),
                rank,
                speeds,
            });
        }
        let residual = (&map * &solved - &target).norm();
        let limit = CONSTRAINT_TOLERANCE * target.norm().max(1.0);
        if residual.is_nan() || residual > limit {
            return Err(StateError::PortRatesContradict {
                joint: joint(),
                residual,
                limit,
            });
        }
        Ok(solved.as_slice().to_vec())
    }
}

/// The rank of a matrix whose entries are of the order of `scale` or larger, and the shortest x with the least `|F x − r|`.
fn least_squares(matrix: &DMatrix<f64>, right: &DVector<f64>, scale: f64) -> (usize, DVector<f64>) {
    // Of nothing there is no decomposition.
    if matrix.is_empty() {
        return (0, DVector::zeros(matrix.ncols()));
    }
    let found = matrix.clone().svd(true, true);
    let values = &found.singular_values;
    let limit = DETERMINED * values.iter().copied().fold(scale, f64::max);
    let rank = values.iter().filter(|value| **value > limit).count();
    let solved = found.solve(right, limit);
    let solved = solved.unwrap_or_else(|_| DVector::repeat(matrix.ncols(), f64::NAN));
    (rank, solved)
}
