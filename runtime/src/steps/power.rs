//! Second derivatives of the power of efforts at one joint under virtual speeds μ, `μᵀ S̄ᵀ τ(Q, v)`: dual numbers of dual numbers through the joint's own kernels.

use super::directions::constant;
use super::motion_gradient::have_sizes;
use super::second::VirtualState;
use super::{AtPort, RotorTerm, Steps};
use crate::erased::nan;
use crate::joint::{Joint, PortLaw, Products};
use crate::matrix::{
    by_rows, column, dot, entries, filled, map, product, set_column, transposed_product, zeros,
};
use crate::scalar::{Dual, Scalar};
use crate::spatial::{join, vee};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// What determines the efforts τ of something at one joint, as a function of Q and v.
#[derive(Clone, Copy, Debug)]
pub enum EffortLaw<'a> {
    /// τ itself, K entries.
    Constant(&'a [f64]),
    /// `τ = −c v`, entry by entry: c, K entries.
    Damper(&'a [f64]),
    /// That of a [`JointSpring`](crate::elements::JointSpring): Q at rest, N entries, and K×K by rows.
    Spring {
        /// Q at rest.
        rest: &'a [f64],
        /// K by rows.
        stiffness: &'a [f64],
    },
    /// That of a [`RotationSpring`](crate::elements::RotationSpring).
    RotationSpring {
        /// The rotation at rest.
        rest: &'a Matrix3<f64>,
        /// k, N·m.
        stiffness: f64,
    },
    /// `τ = Pᵀ f` of an effort f at a port, or at the only coordinate of Q, whose row P is 1.
    Axis {
        /// Index of the port; `None` for the only coordinate.
        port: Option<usize>,
        /// f at the state, and how it changes with the value y and the rate w.
        law: PortLaw<f64>,
        /// −∂²f/∂y∂w.
        product: f64,
    },
    /// `τ = −Σ_k γ_k v_k (a v)` of rotors with inertias a, K entries, at a holonomic joint.
    Rotors(&'a [f64]),
    /// `S̄ᵀτ = −a p̄ᵀ(p̄ v̄̇ + p̄̇ v̄)` of a rotor at a port.
    PortRotor {
        /// Index of the port.
        port: usize,
        /// a, kg m² or kg.
        inertia: f64,
    },
}

/// A number and its derivatives along two directions.
type HyperDual = Dual<Dual<f64>>;

/// A vector of which entry `outer` moves along the first direction, and entry `inner` along the second.
fn moved<const S: usize>(
    vector: &SVector<f64, S>,
    outer: Option<usize>,
    inner: Option<usize>,
) -> SVector<HyperDual, S> {
    let rate = |i, of| if Some(i) == of { 1.0 } else { 0.0 };
    entries(|i| {
        let value = Dual::new(vector[i], rate(i, outer));
        Dual::new(value, Dual::constant(rate(i, inner)))
    })
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Steps<'_, J, N, K, S, C>
where
    J: Joint<N, K, S, C>,
{
    /// First and second derivatives of the power of efforts under virtual speeds, as [`AnyJoint::power_hessian`](crate::erased::AnyJoint::power_hessian) says.
    pub(crate) fn power_hessian(
        &self,
        state: &VirtualState<f64, N, S>,
        law: &EffortLaw<'_>,
        mut out: [&mut [f64]; 5],
    ) {
        if !have_sizes(&mut out, [K, K * K, K * S, S * S, K * S]) {
            return;
        }
        let here = self.axis_here(state, law);
        let [gradient, by_local, mixed, by_speeds, by_accelerations] = out;
        // One loop over pairs of directions, so that the kernels in it are compiled once: ϕ, then v̄, then v̄̇.
        for inner in 0..K + S {
            for outer in 0..K + S + S {
                let (speed, of_speed) = (inner.checked_sub(K), outer.checked_sub(K));
                let of_acceleration = outer.checked_sub(K + S);
                if speed.is_some() && (of_speed.is_none() || of_acceleration.is_some()) {
                    continue;
                }
                let q = match of_speed {
                    None => self.moving(&state.q, outer),
                    Some(_) => constant(&state.q),
                };
                let moved = VirtualState {
                    q: match speed {
                        None => self.moving(&q, inner),
                        Some(_) => constant(&q),
                    },
                    speeds: moved(&state.speeds, of_speed, speed),
                    accelerations: moved(&state.accelerations, of_acceleration, None),
                    virtual_speeds: moved(&state.virtual_speeds, None, None),
                };
                let slope = self.virtual_power(&moved, law, here).derivative();
                let entry = match (speed, of_speed, of_acceleration) {
                    (Some(i), Some(j), _) => &mut by_speeds[i * S + j],
                    (_, _, Some(j)) => &mut by_accelerations[j * K + inner],
                    (_, Some(j), None) => &mut mixed[j * K + inner],
                    (_, None, None) => {
                        gradient[inner] = slope.value;
                        &mut by_local[inner * K + outer]
                    }
                };
                *entry = slope.derivative();
            }
        }
    }

    /// The value and the rate of what a law acts on.
    fn axis_here(&self, state: &VirtualState<f64, N, S>, law: &EffortLaw<'_>) -> [f64; 2] {
        match law {
            EffortLaw::Axis { port, .. } => {
                let (value, row) = self.axis(&state.q, *port);
                let velocity = self.0.velocity(&state.q, &state.speeds);
                [value, dot(&row, &velocity)]
            }
            _ => [0.0; 2],
        }
    }

    /// The value of a port, or of the only coordinate, and its row of P.
    fn axis<T: Scalar>(&self, q: &SVector<T, N>, port: Option<usize>) -> (T, SVector<T, K>) {
        match port {
            Some(port) => self.port(q, port),
            None => (
                q.data.0[0].first().copied().unwrap_or(nan()),
                filled(T::one()),
            ),
        }
    }

    /// `μᵀ S̄ᵀ τ`.
    fn virtual_power<T: Scalar>(
        &self,
        state: &VirtualState<T, N, S>,
        law: &EffortLaw<'_>,
        here: [f64; 2],
    ) -> T {
        let VirtualState {
            q,
            speeds,
            accelerations,
            virtual_speeds,
        } = state;
        if let EffortLaw::PortRotor { port, inertia } = *law {
            let needed = AtPort {
                port,
                term: RotorTerm::Needed,
            };
            let term = self.rotor_term((q, speeds, accelerations), needed);
            return -(T::from_f64(inertia) * dot(&term, virtual_speeds));
        }
        let velocity = self.0.velocity(q, speeds);
        let effort = self.effort(q, &velocity, law, here);
        dot(&self.0.velocity(q, virtual_speeds), &effort)
    }

    /// τ.
    fn effort<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        velocity: &SVector<T, K>,
        law: &EffortLaw<'_>,
        here: [f64; 2],
    ) -> SVector<T, K> {
        match law {
            EffortLaw::Constant(efforts) => lifted(efforts),
            EffortLaw::Damper(coefficients) => {
                let coefficients = lifted::<T, K>(coefficients);
                entries(|k| -(coefficients[k] * velocity[k]))
            }
            EffortLaw::Spring { rest, stiffness } => match stiffness.len() == K * K {
                true => {
                    let stiffness = map(&by_rows(stiffness), T::from_f64);
                    self.spring_effort((q, &self.stored(rest)), &stiffness)
                }
                false => filled(nan()),
            },
            EffortLaw::RotationSpring { rest, stiffness } => {
                let back = map(&rest.transpose(), T::from_f64);
                self.turn_effort(q, &back, T::from_f64(*stiffness))
            }
            EffortLaw::Axis { port, law, product } => {
                let (value, row) = self.axis(q, *port);
                let [effort, stiffness, damping] = [law.effort, law.stiffness, law.damping];
                let [here, here_rate] = here.map(T::from_f64);
                let (way, rate) = (value - here, dot(&row, velocity) - here_rate);
                let change = T::from_f64(stiffness) * way
                    + T::from_f64(damping) * rate
                    + T::from_f64(*product) * way * rate;
                row * (T::from_f64(effort) - change)
            }
            EffortLaw::Rotors(_) if const { J::STRUCTURES.gamma.is_zero() } => zeros(),
            EffortLaw::Rotors(inertia) => {
                let inertia = lifted::<T, K>(inertia);
                let momentum = entries(|k| velocity[k] * inertia[k]);
                -product(&self.0.gamma(q, velocity), &momentum)
            }
            EffortLaw::PortRotor { .. } => zeros(),
        }
    }

    /// A stored configuration, with zeros for what is idle.
    fn stored<T: Scalar>(&self, q: &[f64]) -> SVector<T, N> {
        match q.len() + self.0.idle() == N {
            true => entries(|i| T::from_f64(q.get(i).copied().unwrap_or(0.0))),
            false => filled(nan()),
        }
    }

    /// `−S₀⁻ᵀ D⁻ᵀ K ϕ` with Φ(rest, ϕ) = Q.
    pub(super) fn spring_effort<T: Scalar>(
        &self,
        (q, rest): (&SVector<T, N>, &SVector<T, N>),
        stiffness: &SMatrix<T, K, K>,
    ) -> SVector<T, K> {
        let phi = self.0.local(rest, q);
        let mut rates = self.0.velocity_map_inverse(q);
        for j in 0..K {
            let rate = column(&rates, j);
            let rate = self.0.retract_differential_inverse(rest, &phi, &rate);
            set_column(&mut rates, j, &rate);
        }
        -transposed_product(&rates, &product(stiffness, &phi))
    }

    /// The effort of a rotational spring, `back` being the transpose of the rotation at rest.
    pub(super) fn turn_effort<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        back: &Matrix3<T>,
        stiffness: T,
    ) -> SVector<T, K> {
        let turn = self.0.pose(q).rotation * back;
        let moment = join(&(vee(&turn) * -stiffness), &Vector3::zeros());
        transposed_product(&self.0.twist_map(q), &moment)
    }
}

/// Numbers of a law; NaN where they are of another size.
fn lifted<T: Scalar, const K: usize>(values: &[f64]) -> SVector<T, K> {
    match values.len() == K {
        true => entries(|i| T::from_f64(values[i])),
        false => filled(nan()),
    }
}
