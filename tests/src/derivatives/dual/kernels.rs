//! The kernels of one joint in dual numbers.

use hamel::erased::AnyJoint;
use hamel::joint::{Joint, Member};
use hamel::nalgebra::{SMatrix, SVector, Vector3, Vector6};
use hamel::scalar::{Dual, Scalar};
use hamel::spatial::Pose;

/// The kernels of one joint in dual numbers.
pub trait Kernels<D = Dual<f64>> {
    /// The joint's name, which of its bodies it is the joint of, and the values of its parameters.
    fn identity(&self) -> (&'static str, usize, Vec<f64>);
    /// Φ(Q, ϕ).
    fn retract(&self, q: &[f64], phi: &[D]) -> Vec<D>;
    /// H.
    fn pose(&self, q: &[D]) -> Pose<D>;
    /// The columns of X̄^c.
    fn columns(&self, q: &[D]) -> Vec<Vector6<D>>;
    /// c.
    fn bias(&self, q: &[D], speeds: &[D]) -> Vector6<D>;
    /// Ẋ̄ᵀ h.
    fn bias_momentum(&self, q: &[D], speeds: &[D], h: &Vector6<D>) -> Vec<D>;
    /// S̄ᵀ τ.
    fn reduce(&self, q: &[D], efforts: &[D]) -> Vec<D>;
    /// S̄ v̄.
    fn velocity(&self, q: &[D], speeds: &[D]) -> Vec<D>;
    /// `−S₀⁻ᵀ D⁻ᵀ K ϕ` with Φ(rest, ϕ) = Q and K by rows.
    fn spring(&self, q: &[D], rest: &[f64], stiffness: &[f64]) -> Vec<D>;
    /// Efforts of a moment on the child that has the parent's axes.
    fn moment(&self, q: &[D], moment: &Vector3<D>) -> Vec<D>;
    /// How far a port is from `rest`, and its row of P.
    fn port(&self, q: &[D], port: usize, rest: f64) -> (D, Vec<D>);
    /// p̄ = P S̄ of a port, and how it changes with time at v̄.
    fn port_motion(&self, q: &[D], speeds: &[D], port: usize) -> [Vec<D>; 2];
    /// `Σ_k γ_k v_k (a v)`.
    fn rotors(&self, q: &[D], speeds: &[D], inertia: &[f64]) -> Vec<D>;
}

struct Of<J, const N: usize, const K: usize, const S: usize, const C: usize>(J);

fn vector<D: Scalar, const M: usize>(slice: &[D]) -> SVector<D, M> {
    SVector::from_column_slice(slice)
}

pub(super) fn constants<D: Scalar>(values: &[f64]) -> Vec<D> {
    values.iter().map(|value| D::from_f64(*value)).collect()
}

impl<J, D, const N: usize, const K: usize, const S: usize, const C: usize> Kernels<D>
    for Of<J, N, K, S, C>
where
    J: Joint<N, K, S, C>,
    D: Scalar,
{
    fn identity(&self) -> (&'static str, usize, Vec<f64>) {
        let parameters = self.0.parameters().map(|(_, value)| value);
        (J::NAME, J::BODY, parameters.collect())
    }

    fn retract(&self, q: &[f64], phi: &[D]) -> Vec<D> {
        let moved = self.0.retract(&vector::<D, N>(&constants(q)), &vector(phi));
        moved.iter().copied().collect()
    }

    fn pose(&self, q: &[D]) -> Pose<D> {
        self.0.pose(&vector(q))
    }

    fn columns(&self, q: &[D]) -> Vec<Vector6<D>> {
        let q = vector(q);
        let map: SMatrix<D, 6, S> = self.0.twist_map_child(&q) * self.0.speed_basis(&q);
        map.column_iter()
            .map(|column| column.into_owned())
            .collect()
    }

    fn bias(&self, q: &[D], speeds: &[D]) -> Vector6<D> {
        self.0.bias_acceleration(&vector(q), &vector(speeds))
    }

    fn bias_momentum(&self, q: &[D], speeds: &[D], h: &Vector6<D>) -> Vec<D> {
        let dual = self.0.bias_momentum(&vector(q), &vector(speeds), h);
        dual.iter().copied().collect()
    }

    fn reduce(&self, q: &[D], efforts: &[D]) -> Vec<D> {
        let reduced = self
            .0
            .speed_basis(&vector(q))
            .tr_mul(&vector::<D, K>(efforts));
        reduced.iter().copied().collect()
    }

    fn velocity(&self, q: &[D], speeds: &[D]) -> Vec<D> {
        let velocity = self.0.speed_basis(&vector(q)) * vector::<D, S>(speeds);
        velocity.iter().copied().collect()
    }

    fn spring(&self, q: &[D], rest: &[f64], stiffness: &[f64]) -> Vec<D> {
        let (q, rest) = (vector(q), vector(&constants::<D>(rest)));
        let phi = self.0.local(&rest, &q);
        let load = SMatrix::<f64, K, K>::from_row_slice(stiffness).map(D::from_f64) * phi;
        let inverse = self.0.velocity_map_inverse(&q);
        let effort = |column: SVector<D, K>| {
            let rate = self.0.retract_differential_inverse(&rest, &phi, &column);
            -rate.dot(&load)
        };
        let columns = inverse.column_iter().map(|column| column.into_owned());
        columns.map(effort).collect()
    }

    fn moment(&self, q: &[D], moment: &Vector3<D>) -> Vec<D> {
        let map = self.0.twist_map(&vector(q));
        let effort = map.fixed_rows::<3>(0).tr_mul(moment);
        effort.iter().copied().collect()
    }

    fn port(&self, q: &[D], port: usize, rest: f64) -> (D, Vec<D>) {
        let q = vector(q);
        let (values, map) = (self.0.port_values(&q), self.0.port_map(&q));
        let mut way = values.as_ref()[port] - D::from_f64(rest);
        if self.0.ports()[port].wraps {
            let (sin, cos) = way.sin_cos();
            way = sin.atan2(cos);
        }
        (way, map.as_ref()[port].to_vec())
    }

    fn port_motion(&self, q: &[D], speeds: &[D], port: usize) -> [Vec<D>; 2] {
        let q = vector::<D, N>(q);
        let velocity = self.0.speed_basis(&q) * vector::<D, S>(speeds);
        let rate = self.0.configuration_rate(&q, &velocity);
        let moving = SVector::<Dual<D>, N>::from_fn(|i, _| Dual::new(q[i], rate[i]));
        let row = SVector::<Dual<D>, K>::from(self.0.port_map(&moving).as_ref()[port]);
        let row = self.0.speed_basis(&moving).tr_mul(&row);
        [
            row.iter().map(|entry| entry.value).collect(),
            row.iter().map(|entry| entry.derivative()).collect(),
        ]
    }

    fn rotors(&self, q: &[D], speeds: &[D], inertia: &[f64]) -> Vec<D> {
        let v = vector::<D, K>(speeds);
        let momentum = v.component_mul(&vector::<D, K>(&constants(inertia)));
        let force = self.0.gamma(&vector(q), &v) * momentum;
        force.iter().copied().collect()
    }
}

/// The kernels of a joint.
pub fn of<J, D, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: J,
) -> Box<dyn Kernels<D>>
where
    J: Joint<N, K, S, C> + 'static,
    D: Scalar,
{
    Box::new(Of::<J, N, K, S, C>(joint))
}

/// Where the kernels behind an erased joint are found.
pub type Lookup<D = Dual<f64>> = fn(&dyn AnyJoint) -> Box<dyn Kernels<D>>;

/// The one of `all` that has the name and the parameters of an erased joint.
///
/// # Panics
/// Where there is none.
pub fn behind<D>(
    joint: &dyn AnyJoint,
    all: impl IntoIterator<Item = Box<dyn Kernels<D>>>,
) -> Box<dyn Kernels<D>> {
    let mut parameters = vec![];
    joint.parameters(&mut |_, value| parameters.push(value));
    let mut all = all.into_iter();
    let found = all.find(|own| own.identity() == (joint.name(), joint.body(), parameters.clone()));
    found.unwrap_or_else(|| panic!("no kernels of `{}` with {parameters:?}", joint.name()))
}

/// The joint of the library behind an erased one.
///
/// # Panics
/// Where it is another's, or has other parameters than [`crate::random::library`].
pub fn library_kernels<D: Scalar>(joint: &dyn AnyJoint) -> Box<dyn Kernels<D>> {
    let mut all = vec![];
    macro_rules! add {
        ($module:ident, $type:ty, $example:expr, $n:literal, $k:literal, $s:literal, $c:literal) => {
            all.push(of::<$type, D, $n, $k, $s, $c>($example));
        };
    }
    hamel_joints::for_each_joint!(add);
    macro_rules! add_body {
        ($module:ident, $type:ty, $example:expr, $b:literal, $n:literal, $k:literal, $s:literal, $c:literal) => {
            all.push(of::<Member<$type, $b>, D, $n, $k, $s, $c>(Member($example)));
        };
    }
    hamel_joints::for_each_body!(add_body);
    behind(joint, all)
}
