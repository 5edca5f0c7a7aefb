//! What a robot is asked about states: each function evaluates a batch.

use crate::arguments::{Argument, CONFIGURATION};
use crate::batch::evaluate;
use crate::errors;
use crate::robot::Robot;
use hamel::UnknownName;
use hamel::dynamics::{Frame, FrameReadings, Sensitivity};
use hamel::scene::suggest::nearest;
use hamel::spatial::{INERTIAL_PARAMETERS, Pose};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

/// An array of results.
pub type Results<'py> = Bound<'py, PyArrayDyn<f64>>;

type Given<'a, 'py> = &'a Bound<'py, PyAny>;

/// A frame or a body by its index.
#[derive(Clone, Copy)]
enum Place {
    Frame(usize),
    Body(usize),
}

impl Robot {
    fn q<'py>(&self, q: Given<'_, 'py>) -> PyResult<Argument<'py>> {
        Argument::read(CONFIGURATION, q, self.sizes().configuration)
    }

    fn of_speeds<'py>(&self, name: &'static str, value: Given<'_, 'py>) -> PyResult<Argument<'py>> {
        Argument::read(name, value, self.sizes().speeds)
    }

    fn tau<'py>(&self, tau: Given<'_, 'py>) -> PyResult<Argument<'py>> {
        Argument::read("tau", tau, self.sizes().freedoms)
    }

    /// v̄̇.
    pub fn accelerations<'py>(&self, [q, v, tau]: [Given<'_, 'py>; 3]) -> PyResult<Results<'py>> {
        let py = q.py();
        let arguments = [self.q(q)?, self.of_speeds("v", v)?, self.tau(tau)?];
        let speeds = self.sizes().speeds;
        let [rates] = evaluate(
            py,
            self.workspaces(),
            arguments,
            [&[speeds]],
            |own, [q, v, tau], [rates]| own.equations.forward_dynamics([q, v, tau], rates),
        )?;
        Ok(rates)
    }

    /// `S̄ᵀτ`.
    pub fn efforts<'py>(&self, [q, v, a]: [Given<'_, 'py>; 3]) -> PyResult<Results<'py>> {
        let py = q.py();
        let arguments = [self.q(q)?, self.of_speeds("v", v)?, self.of_speeds("a", a)?];
        let speeds = self.sizes().speeds;
        let [efforts] = evaluate(
            py,
            self.workspaces(),
            arguments,
            [&[speeds]],
            |own, [q, v, a], [efforts]| own.equations.inverse_dynamics([q, v, a], efforts),
        )?;
        Ok(efforts)
    }

    /// Inverse dynamics at v̄̇ = 0.
    pub fn bias<'py>(&self, [q, v]: [Given<'_, 'py>; 2]) -> PyResult<Results<'py>> {
        let arguments = [self.q(q)?, self.of_speeds("v", v)?];
        let speeds = self.sizes().speeds;
        let [bias] = evaluate(
            q.py(),
            self.workspaces(),
            arguments,
            [&[speeds]],
            |own, [q, v], [bias]| own.equations.bias_forces([q, v], bias),
        )?;
        Ok(bias)
    }

    /// M̄.
    pub fn mass<'py>(&self, q: Given<'_, 'py>) -> PyResult<Results<'py>> {
        let size = self.sizes().speeds;
        let [mass] = evaluate(
            q.py(),
            self.workspaces(),
            [self.q(q)?],
            [&[size, size]],
            |own, [q], [mass]| own.equations.mass_matrix(q, mass),
        )?;
        Ok(mass)
    }

    /// v̄̇, and its derivatives by ϕ, v̄ and τ.
    pub fn accelerations_and_derivatives<'py>(
        &self,
        [q, v, tau]: [Given<'_, 'py>; 3],
    ) -> PyResult<[Results<'py>; 4]> {
        let py = q.py();
        let arguments = [self.q(q)?, self.of_speeds("v", v)?, self.tau(tau)?];
        let (s, k) = (self.sizes().speeds, self.sizes().freedoms);
        let shapes: [&[usize]; 4] = [&[s], &[s, k], &[s, s], &[s, k]];
        evaluate(
            py,
            self.workspaces(),
            arguments,
            shapes,
            |own, [q, v, tau], results| {
                let (equations, found) = own.forward();
                equations.forward_derivatives([q, v, tau], found)?;
                let [rates, by_local, by_speeds, by_efforts] = results;
                rates.copy_from_slice(found.rates());
                copy(found.by_local(), by_local);
                copy(found.by_speeds(), by_speeds);
                copy(found.by_efforts(), by_efforts);
                Ok(())
            },
        )
    }

    /// The derivatives of inverse dynamics by ϕ and v̄.
    pub fn effort_derivatives<'py>(
        &self,
        [q, v, a]: [Given<'_, 'py>; 3],
    ) -> PyResult<[Results<'py>; 2]> {
        let py = q.py();
        let arguments = [self.q(q)?, self.of_speeds("v", v)?, self.of_speeds("a", a)?];
        let (s, k) = (self.sizes().speeds, self.sizes().freedoms);
        let shapes: [&[usize]; 2] = [&[s, k], &[s, s]];
        evaluate(
            py,
            self.workspaces(),
            arguments,
            shapes,
            |own, [q, v, a], [by_local, by_speeds]| {
                let (equations, found) = own.inverse();
                equations.inverse_derivatives([q, v, a], found)?;
                copy(found.by_local(), by_local);
                copy(found.by_speeds(), by_speeds);
                Ok(())
            },
        )
    }

    /// `λᵀ∂²v̄̇` over (ϕ, v̄, τ), by the tree.
    pub fn acceleration_hessians<'py>(
        &self,
        [q, v, tau, weights]: [Given<'_, 'py>; 4],
    ) -> PyResult<Results<'py>> {
        let py = q.py();
        let arguments = [
            self.q(q)?,
            self.of_speeds("v", v)?,
            self.tau(tau)?,
            self.of_speeds("weights", weights)?,
        ];
        let size = 2 * self.sizes().freedoms + self.sizes().speeds;
        let [hessians] = evaluate(
            py,
            self.workspaces(),
            arguments,
            [&[size, size]],
            |own, [q, v, tau, weights], [out]| {
                let (equations, found) = own.forward_second();
                let tree = equations.tree();
                tree.forward_dynamics_second_derivatives(q, v, tau, weights, found)?;
                copy(found.hessian(), out);
                Ok(())
            },
        )?;
        Ok(hessians)
    }

    /// `λᵀ∂²τ̄` over (ϕ, v̄, v̄̇), by the tree.
    pub fn effort_hessians<'py>(
        &self,
        [q, v, a, weights]: [Given<'_, 'py>; 4],
    ) -> PyResult<Results<'py>> {
        let py = q.py();
        let arguments = [
            self.q(q)?,
            self.of_speeds("v", v)?,
            self.of_speeds("a", a)?,
            self.of_speeds("weights", weights)?,
        ];
        let size = self.sizes().freedoms + 2 * self.sizes().speeds;
        let [hessians] = evaluate(
            py,
            self.workspaces(),
            arguments,
            [&[size, size]],
            |own, [q, v, a, weights], [out]| {
                let (equations, found) = own.inverse_second();
                let tree = equations.tree();
                tree.inverse_dynamics_second_derivatives(q, v, a, weights, found)?;
                copy(found.hessian(), out);
                Ok(())
            },
        )?;
        Ok(hessians)
    }

    /// Y and τ₀ with `τ̄ = Y π + τ₀`, by the tree.
    pub fn regressors<'py>(&self, [q, v, a]: [Given<'_, 'py>; 3]) -> PyResult<[Results<'py>; 2]> {
        let py = q.py();
        let arguments = [self.q(q)?, self.of_speeds("v", v)?, self.of_speeds("a", a)?];
        let speeds = self.sizes().speeds;
        let columns = INERTIAL_PARAMETERS * self.mechanism().bodies().len();
        let shapes: [&[usize]; 2] = [&[speeds, columns], &[speeds]];
        evaluate(
            py,
            self.workspaces(),
            arguments,
            shapes,
            |own, [q, v, a], [matrix, rest]| {
                let (equations, found) = own.regressor();
                equations.tree().joint_torque_regressor(q, v, a, found)?;
                rest.copy_from_slice(found.rest());
                for (column, entries) in found.entries().chunks_exact(speeds.max(1)).enumerate() {
                    for (row, entry) in entries.iter().enumerate() {
                        matrix[row * columns + column] = *entry;
                    }
                }
                Ok(())
            },
        )
    }

    /// The 6×S matrix that takes v̄ to the twist of a frame.
    pub fn jacobian_of<'py>(
        &self,
        q: Given<'_, 'py>,
        (frame, axes): (&str, &str),
    ) -> PyResult<Results<'py>> {
        let py = q.py();
        let (place, axes) = (self.place(py, frame)?, axes_named(py, axes)?);
        let speeds = self.sizes().speeds;
        let [jacobian] = evaluate(
            py,
            self.workspaces(),
            [self.q(q)?],
            [&[6, speeds]],
            |own, [q], [out]| {
                let readings = own.equations.tree().readings(q, &own.rest)?;
                place.of(&readings)?.jacobian(axes, &mut own.jacobian)?;
                for (column, entries) in own.jacobian.chunks_exact(6).enumerate() {
                    for (row, entry) in entries.iter().enumerate() {
                        out[row * speeds + column] = *entry;
                    }
                }
                Ok(())
            },
        )?;
        Ok(jacobian)
    }

    /// The twist of a frame.
    pub fn twist_of<'py>(
        &self,
        [q, v]: [Given<'_, 'py>; 2],
        (frame, axes): (&str, &str),
    ) -> PyResult<Results<'py>> {
        let py = q.py();
        let (place, axes) = (self.place(py, frame)?, axes_named(py, axes)?);
        let arguments = [self.q(q)?, self.of_speeds("v", v)?];
        let [twist] = evaluate(
            py,
            self.workspaces(),
            arguments,
            [&[6]],
            |own, [q, v], [out]| {
                let readings = own.equations.tree().readings(q, v)?;
                out.copy_from_slice(place.of(&readings)?.twist(axes).as_slice());
                Ok(())
            },
        )?;
        Ok(twist)
    }

    /// H of one frame.
    pub fn pose_of<'py>(&self, q: Given<'_, 'py>, frame: &str) -> PyResult<Results<'py>> {
        let py = q.py();
        let place = self.place(py, frame)?;
        let [pose] = evaluate(
            py,
            self.workspaces(),
            [self.q(q)?],
            [&[4, 4]],
            |own, [q], [out]| {
                let readings = own.equations.tree().readings(q, &own.rest)?;
                write_pose(&place.of(&readings)?.pose(), out);
                Ok(())
            },
        )?;
        Ok(pose)
    }

    /// H of all bodies.
    pub fn poses_of_bodies<'py>(&self, q: Given<'_, 'py>) -> PyResult<Results<'py>> {
        let bodies = self.mechanism().bodies().len();
        let [poses] = evaluate(
            q.py(),
            self.workspaces(),
            [self.q(q)?],
            [&[bodies, 4, 4]],
            |own, [q], [out]| own.equations.poses(q, &own.rest, out),
        )?;
        Ok(poses)
    }

    /// Kinetic and potential energy.
    pub fn energies<'py>(&self, [q, v]: [Given<'_, 'py>; 2]) -> PyResult<[Results<'py>; 2]> {
        let arguments = [self.q(q)?, self.of_speeds("v", v)?];
        evaluate(
            q.py(),
            self.workspaces(),
            arguments,
            [&[], &[]],
            |own, [q, v], [kinetic, potential]| {
                [kinetic[0], potential[0]] = own.equations.energies([q, v])?;
                Ok(())
            },
        )
    }

    /// Kinetic and potential energy together.
    pub fn total_energy<'py>(&self, [q, v]: [Given<'_, 'py>; 2]) -> PyResult<Results<'py>> {
        let arguments = [self.q(q)?, self.of_speeds("v", v)?];
        let [energy] = evaluate(
            q.py(),
            self.workspaces(),
            arguments,
            [&[]],
            |own, [q, v], [energy]| {
                let [kinetic, potential] = own.equations.energies([q, v])?;
                energy[0] = kinetic + potential;
                Ok(())
            },
        )?;
        Ok(energy)
    }

    /// The centre of mass of all bodies.
    pub fn center<'py>(&self, q: Given<'_, 'py>) -> PyResult<Results<'py>> {
        let [center] = evaluate(
            q.py(),
            self.workspaces(),
            [self.q(q)?],
            [&[3]],
            |own, [q], [out]| {
                let readings = own.equations.tree().readings(q, &own.rest)?;
                out.copy_from_slice(readings.center_of_mass().as_slice());
                Ok(())
            },
        )?;
        Ok(center)
    }

    /// The frame or the body of that name.
    fn place(&self, py: Python<'_>, name: &str) -> PyResult<Place> {
        let mechanism = self.mechanism();
        let frame = mechanism.frame_index(name).map(Place::Frame);
        let found = frame.or_else(|| mechanism.body_index(name).map(Place::Body));
        found.ok_or_else(|| {
            let known = self.model().frames().chain(self.model().bodies());
            errors::of(py, &unknown("frame or body", name, known).into())
        })
    }
}

impl Place {
    fn of<'a>(
        self,
        readings: &hamel::dynamics::Readings<'a>,
    ) -> Result<FrameReadings<'a>, hamel::Error> {
        Ok(match self {
            Self::Frame(index) => readings.frame(index)?,
            Self::Body(index) => readings.body_frame(index)?,
        })
    }
}

/// A name that is none of those known.
pub fn unknown<'a>(
    kind: &'static str,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> UnknownName {
    UnknownName {
        kind,
        name: name.to_owned(),
        nearest: nearest(name, known).map(str::to_owned),
    }
}

fn axes_named(py: Python<'_>, name: &str) -> PyResult<Frame> {
    match name {
        "world_aligned" => Ok(Frame::WorldAligned),
        "body" => Ok(Frame::Body),
        "world" => Ok(Frame::World),
        _ => Err(errors::argument(
            py,
            format!("axes is `{name}`: it must be `world_aligned`, `body` or `world`"),
        )),
    }
}

fn copy(from: &Sensitivity, to: &mut [f64]) {
    to.copy_from_slice(from.entries());
}

/// A 4×4 matrix, row by row.
fn write_pose(pose: &Pose<f64>, out: &mut [f64]) {
    let matrix = pose.matrix();
    for (entry, place) in out.iter_mut().zip(0..16) {
        *entry = matrix[(place / 4, place % 4)];
    }
}
