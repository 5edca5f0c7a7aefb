//! Second derivatives of the power of efforts at one joint under virtual speeds μ, `μᵀ S̄ᵀ τ(Q, v)`: dual numbers of dual numbers through the joint's own kernels.

use super::directions::constant;
use super::second::VirtualState;
use super::{AtPort, RotorTerm, Steps};
use crate::erased::nan;
use crate::joint::{Joint, PortLaw, Products};
use crate::scalar::{Dual, Scalar};
use crate::spatial::vee;
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

/// First and second derivatives of a power at one joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PowerHessian<T, const K: usize, const S: usize> {
    /// `E_k`.
    pub(crate) gradient: SVector<T, K>,
    /// `E_l E_k`: row l, column k.
    pub(crate) by_local: SMatrix<T, K, K>,
    /// By ϕ and v̄.
    pub(crate) mixed: SMatrix<T, K, S>,
    /// By v̄.
    pub(crate) by_speeds: SMatrix<T, S, S>,
    /// By ϕ and v̄̇.
    pub(crate) by_accelerations: SMatrix<T, K, S>,
}

/// A number and its derivatives along two directions.
type HyperDual<T> = Dual<Dual<T>>;

/// Moves the number along the inner direction only where it is asked for.
fn inner<T: Scalar>(value: Dual<T>, moves: bool) -> HyperDual<T> {
    let rate = if moves { T::one() } else { T::zero() };
    Dual::new(value, Dual::constant(rate))
}

/// A vector of which entry `j` is moved along the outer direction.
fn outer<T: Scalar, const S: usize>(
    vector: &SVector<T, S>,
    j: Option<usize>,
) -> SVector<Dual<T>, S> {
    let rate = |i| if Some(i) == j { T::one() } else { T::zero() };
    SVector::from_fn(|i, _| Dual::new(vector[i], rate(i)))
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Steps<'_, J, N, K, S, C>
where
    J: Joint<N, K, S, C>,
{
    /// First and second derivatives of the power of efforts under virtual speeds.
    pub(crate) fn power_hessian(
        &self,
        state: &VirtualState<f64, N, S>,
        law: &EffortLaw<'_>,
    ) -> PowerHessian<f64, K, S> {
        let mut hessian = PowerHessian {
            gradient: SVector::zeros(),
            by_local: SMatrix::zeros(),
            mixed: SMatrix::zeros(),
            by_speeds: SMatrix::zeros(),
            by_accelerations: SMatrix::zeros(),
        };
        let here = self.axis_here(state, law);
        let (q, speeds, rates) = (&state.q, &state.speeds, &state.accelerations);
        let (still, v, a) = (constant(q), outer(speeds, None), outer(rates, None));
        let power = |q: &SVector<HyperDual<f64>, N>,
                     speeds: &SVector<HyperDual<f64>, S>,
                     rates: &SVector<Dual<f64>, S>| {
            let state = VirtualState {
                q: *q,
                speeds: *speeds,
                accelerations: constant(rates),
                virtual_speeds: constant(&constant(&state.virtual_speeds)),
            };
            self.virtual_power(&state, law, here).derivative()
        };
        for k in 0..K {
            for l in 0..K {
                let moved = self.moving(&self.moving(q, l), k);
                let slope = power(&moved, &constant(&v), &a);
                hessian.by_local[(l, k)] = slope.derivative();
                hessian.gradient[k] = slope.value;
            }
            let moved = self.moving(&still, k);
            for l in 0..S {
                let faster = constant(&outer(speeds, Some(l)));
                hessian.mixed[(k, l)] = power(&moved, &faster, &a).derivative();
                let (speeds, rates) = (constant(&v), outer(rates, Some(l)));
                hessian.by_accelerations[(k, l)] = power(&moved, &speeds, &rates).derivative();
            }
        }
        let still = constant(&still);
        for k in 0..S {
            for l in 0..S {
                let faster = outer(speeds, Some(l));
                let both = SVector::from_fn(|i, _| inner(faster[i], i == k));
                hessian.by_speeds[(k, l)] = power(&still, &both, &a).derivative();
            }
        }
        hessian
    }

    /// The value and the rate of what a law acts on.
    fn axis_here(&self, state: &VirtualState<f64, N, S>, law: &EffortLaw<'_>) -> [f64; 2] {
        match law {
            EffortLaw::Axis { port, .. } => {
                let (value, row) = self.axis(&state.q, *port);
                let velocity = self.0.velocity(&state.q, &state.speeds);
                [value, row.dot(&velocity)]
            }
            _ => [0.0; 2],
        }
    }

    /// The value of a port, or of the only coordinate, and its row of P.
    fn axis<T: Scalar>(&self, q: &SVector<T, N>, port: Option<usize>) -> (T, SVector<T, K>) {
        match port {
            Some(port) => self.port(q, port),
            None => (
                q.get(0).copied().unwrap_or(nan()),
                SVector::repeat(T::one()),
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
            return -(T::from_f64(inertia) * term.dot(virtual_speeds));
        }
        let velocity = self.0.velocity(q, speeds);
        let effort = self.effort(q, &velocity, law, here);
        self.0.velocity(q, virtual_speeds).dot(&effort)
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
                -lifted::<T, K>(coefficients).component_mul(velocity)
            }
            EffortLaw::Spring { rest, stiffness } => match stiffness.len() == K * K {
                true => {
                    let stiffness = SMatrix::<f64, K, K>::from_row_slice(stiffness);
                    self.spring_effort((q, &self.stored(rest)), &stiffness.map(T::from_f64))
                }
                false => SVector::repeat(nan()),
            },
            EffortLaw::RotationSpring { rest, stiffness } => {
                let back = rest.transpose().map(T::from_f64);
                self.turn_effort(q, &back, T::from_f64(*stiffness))
            }
            EffortLaw::Axis { port, law, product } => {
                let (value, row) = self.axis(q, *port);
                let [effort, stiffness, damping] = [law.effort, law.stiffness, law.damping];
                let [here, here_rate] = here.map(T::from_f64);
                let (way, rate) = (value - here, row.dot(velocity) - here_rate);
                let change = T::from_f64(stiffness) * way
                    + T::from_f64(damping) * rate
                    + T::from_f64(*product) * way * rate;
                row * (T::from_f64(effort) - change)
            }
            EffortLaw::Rotors(inertia) => {
                -(self.0.gamma(q, velocity) * velocity.component_mul(&lifted(inertia)))
            }
            EffortLaw::PortRotor { .. } => SVector::zeros(),
        }
    }

    /// A stored configuration, with zeros for what is idle.
    fn stored<T: Scalar>(&self, q: &[f64]) -> SVector<T, N> {
        match q.len() + self.0.idle() == N {
            true => SVector::from_fn(|i, _| T::from_f64(q.get(i).copied().unwrap_or(0.0))),
            false => SVector::repeat(nan()),
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
            let rate = rates.column(j).into_owned();
            rates.set_column(j, &self.0.retract_differential_inverse(rest, &phi, &rate));
        }
        -rates.tr_mul(&(stiffness * phi))
    }

    /// The effort of a rotational spring, `back` being the transpose of the rotation at rest.
    pub(super) fn turn_effort<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        back: &Matrix3<T>,
        stiffness: T,
    ) -> SVector<T, K> {
        let turn = self.0.pose(q).rotation * back;
        let moment: Vector3<T> = vee(&turn) * -stiffness;
        self.0.twist_map(q).fixed_rows::<3>(0).tr_mul(&moment)
    }
}

/// Numbers of a law; NaN where they are of another size.
fn lifted<T: Scalar, const K: usize>(values: &[f64]) -> SVector<T, K> {
    match values.len() == K {
        true => SVector::from_fn(|i, _| T::from_f64(values[i])),
        false => SVector::repeat(nan()),
    }
}
