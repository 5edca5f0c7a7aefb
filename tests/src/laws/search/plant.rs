//! Joints with wrong kernels, to show that the suite catches them.

use hamel::joint::{Joint, Patterns, Structures, VelocityFrame};
use hamel::nalgebra::{SMatrix, SVector};
use hamel::scalar::Scalar;
use hamel::spatial::Pose;

/// How wrong a planted value is where it is, in SI units.
const ERROR: f64 = 1e-3;

/// Every kernel, by its name in [`Joint`]; of the pose both parts.
pub const KERNELS: [&str; 24] = [
    "home",
    "rotation",
    "translation",
    "twist_map",
    "twist_map_child",
    "twist_map_child_gradient",
    "velocity_map",
    "velocity_map_inverse",
    "velocity_map_gradient",
    "gamma",
    "j22",
    "constraint",
    "speed_basis",
    "speed_basis_gradient",
    "configuration_rate",
    "retract",
    "local",
    "retract_differential",
    "retract_differential_inverse",
    "project",
    "residual",
    "singularity",
    "bias_acceleration",
    "bias_momentum",
];

/// Where a planted kernel is wrong.
#[derive(Clone, Copy, Debug)]
pub enum Where {
    /// Everywhere.
    Everywhere,
    /// Where the stored scalar with this number is larger than that.
    Beyond(usize, f64),
    /// Where the stored scalar with this number is negative: the other side of an exception.
    Side(usize),
    /// Where the stored scalar with this number is near a value: exp(−sharp (q − at)²) of the error.
    Narrow {
        /// The stored scalar.
        scalar: usize,
        /// The value.
        at: f64,
        /// Its inverse square is the width.
        sharp: f64,
    },
    /// Where the parameter with this number is below a value.
    Below(usize, f64),
}

/// A false kernel.
#[derive(Clone, Copy, Debug)]
pub struct Plant {
    /// The kernels that are wrong.
    pub kernels: &'static [&'static str],
    /// Where.
    pub place: Where,
}

/// A joint of which some kernels are wrong somewhere.
#[derive(Clone, Debug)]
pub struct Planted<J> {
    /// The true joint.
    pub joint: J,
    /// What is wrong.
    pub plant: Plant,
}

impl<J> Planted<J> {
    /// What is added to each entry of the kernel at Q.
    fn wrong<T, const N: usize, const K: usize, const S: usize, const C: usize>(
        &self,
        kernel: &str,
        q: &SVector<T, N>,
    ) -> T
    where
        T: Scalar,
        J: Joint<N, K, S, C>,
    {
        if !self.plant.kernels.contains(&kernel) {
            return T::zero();
        }
        let error = T::from_f64(ERROR);
        let number = T::from_f64;
        let size = |x: T| T::select(x.less(T::zero()), -x, x);
        match self.plant.place {
            Where::Everywhere => error,
            Where::Beyond(i, limit) => T::select(number(limit).less(size(q[i])), error, T::zero()),
            Where::Side(i) => T::select(q[i].less(T::zero()), error, T::zero()),
            Where::Narrow { scalar, at, sharp } => {
                let off = q[scalar] - number(at);
                error * (-(number(sharp) * off * off)).exp()
            }
            Where::Below(i, limit) => {
                let value = self
                    .joint
                    .parameters()
                    .nth(i)
                    .map_or(f64::NAN, |(_, value)| value);
                T::select(number(value).less(number(limit)), error, T::zero())
            }
        }
    }
}

/// Kernels whose value is one matrix.
macro_rules! plant_matrices {
    ($($kernel:ident($($argument:ident: $size:tt),*) -> $rows:tt, $columns:tt;)*) => {$(
        fn $kernel<T: Scalar>(&self, q: &SVector<T, N>, $($argument: &SVector<T, $size>),*) -> SMatrix<T, $rows, $columns> {
            let wrong = self.wrong::<T, N, K, S, C>(stringify!($kernel), q);
            self.joint.$kernel(q, $($argument),*).map(|entry| entry + wrong)
        }
    )*};
}

/// Kernels whose value is one matrix for each local coordinate.
macro_rules! plant_slices {
    ($($kernel:ident -> $rows:tt, $columns:tt;)*) => {$(
        fn $kernel<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, $rows, $columns>; K] {
            let wrong = self.wrong::<T, N, K, S, C>(stringify!($kernel), q);
            self.joint.$kernel(q).map(|slice| slice.map(|entry| entry + wrong))
        }
    )*};
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Joint<N, K, S, C>
    for Planted<J>
where
    J: Joint<N, K, S, C>,
{
    const NAME: &'static str = J::NAME;
    const COORDINATES: [&'static str; N] = J::COORDINATES;
    const FREEDOMS: [&'static str; K] = J::FREEDOMS;
    const SPEEDS: [&'static str; S] = J::SPEEDS;
    const VELOCITY_FRAME: VelocityFrame = J::VELOCITY_FRAME;
    const STRUCTURES: Structures = J::STRUCTURES;
    const PATTERNS: Patterns<K, S> = J::PATTERNS;
    const UNIDENTIFIABLE: &'static [[f64; 10]] = J::UNIDENTIFIABLE;
    const SINGULARITIES: &'static [&'static str] = J::SINGULARITIES;

    fn parameters(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.joint.parameters()
    }

    fn home<T: Scalar>(&self) -> SVector<T, N> {
        let home = self.joint.home();
        let wrong = self.wrong::<T, N, K, S, C>("home", &home);
        home.map(|entry| entry + wrong)
    }

    fn pose<T: Scalar>(&self, q: &SVector<T, N>) -> Pose<T> {
        let wrong = |kernel| self.wrong::<T, N, K, S, C>(kernel, q);
        let (turned, moved) = (wrong("rotation"), wrong("translation"));
        let pose = self.joint.pose(q);
        Pose {
            rotation: pose.rotation.map(|entry| entry + turned),
            translation: pose.translation.map(|entry| entry + moved),
        }
    }

    plant_matrices! {
        twist_map() -> 6, K;
        twist_map_child() -> 6, K;
        velocity_map() -> K, K;
        velocity_map_inverse() -> K, K;
        gamma(v: K) -> K, K;
        j22(p: K) -> K, K;
        constraint() -> K, C;
        speed_basis() -> K, S;
        configuration_rate(v: K) -> N, 1;
        retract(phi: K) -> N, 1;
        local(target: N) -> K, 1;
        retract_differential(phi: K) -> K, K;
        retract_differential_inverse(phi: K, rate: K) -> K, 1;
        project() -> N, 1;
        bias_acceleration(speeds: S) -> 6, 1;
        bias_momentum(speeds: S, h: 6) -> S, 1;
    }

    plant_slices! {
        twist_map_child_gradient -> 6, K;
        velocity_map_gradient -> K, K;
        speed_basis_gradient -> K, S;
    }

    fn residual<T: Scalar>(&self, q: &SVector<T, N>) -> T {
        self.joint.residual(q) + self.wrong::<T, N, K, S, C>("residual", q)
    }

    fn singularity<T: Scalar>(&self, q: &SVector<T, N>) -> T {
        self.joint.singularity(q) + self.wrong::<T, N, K, S, C>("singularity", q)
    }
}
