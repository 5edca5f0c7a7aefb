//! The rotation of a rigid body free of torques, in closed form.
//!
//! In principal axes the angular velocity is made of Jacobi's elliptic functions (L. D. Landau and E. M. Lifshitz, *Mechanics*, § 37). The attitude follows from it except for one
//! angle, that of the precession about the angular momentum. It is the integral of a periodic function, by its Fourier series. So a million turns cost what one costs.

use super::elliptic::Elliptic;
use alloc::boxed::Box;
use alloc::vec::Vec;
use core::f64::consts::PI;
use nalgebra::{Matrix3, Rotation3, Vector3};
use num_traits::Float;

/// Terms of the Fourier series at first and at most.
const FEWEST_TERMS: usize = 8;
const MOST_TERMS: usize = 1024;

/// Rotations that make a matrix diagonal at most: five of each pair of axes are enough for any.
const MOST_ROTATIONS: usize = 30;

/// The principal axes of a body and its moments of inertia.
#[derive(Clone, Debug)]
pub(super) struct Principal {
    /// The axes, column by column, right-handed.
    axes: Matrix3<f64>,
    /// In ascending order, as parts of the greatest.
    moments: Vector3<f64>,
}

/// The rotation of a body from a first angular velocity on.
#[derive(Clone, Debug)]
pub(super) struct Spin {
    /// Of [`Principal`].
    axes: Matrix3<f64>,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// With an angular velocity that stays, in principal axes.
    Steady(Vector3<f64>),
    Periodic(Box<Motion>),
}

/// Where a body is after a time.
#[derive(Clone, Debug)]
pub(super) struct Turned {
    /// Its axes, in its axes before.
    pub(super) rotation: Matrix3<f64>,
    /// Its angular velocity in its own axes, rad/s.
    pub(super) angular: Vector3<f64>,
}

impl Principal {
    /// Of a matrix of inertia, kg m². `None` where not all moments are above 0.
    pub(super) fn new(inertia: &Matrix3<f64>) -> Option<Self> {
        let (moments, vectors) = diagonalize(*inertia);
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| moments[i].total_cmp(&moments[j]));
        let [first, second, _] = order.map(|i| vectors.column(i).into_owned());
        let axes = Matrix3::from_columns(&[first, second, first.cross(&second)]);
        let moments = Vector3::from(order.map(|i| moments[i]));
        let is_solid = moments
            .iter()
            .all(|moment| *moment > 0.0 && moment.is_finite());
        is_solid.then(|| Self {
            axes,
            moments: moments / moments.z,
        })
    }

    /// The rotation from an angular velocity in the body's axes (rad/s) on. `None` near the unstable rotation about the middle axis, where the period is infinite.
    pub(super) fn spin(&self, angular: &Vector3<f64>) -> Option<Spin> {
        let own = self.axes.transpose() * angular;
        let kind = match self.is_steady(&own) {
            true => Kind::Steady(own),
            false => Kind::Periodic(Box::new(Motion::new(&self.moments, &own)?)),
        };
        let axes = self.axes;
        Some(Spin { axes, kind })
    }

    /// Whether an angular velocity in principal axes stays as it is: about one of them, or one of two with equal moments.
    fn is_steady(&self, angular: &Vector3<f64>) -> bool {
        let ([i1, i2, i3], [w1, w2, w3]) = (self.moments.into(), (*angular).into());
        let rates: [f64; 3] = [
            (i2 - i3) * w2 * w3,
            (i3 - i1) * w3 * w1,
            (i1 - i2) * w1 * w2,
        ];
        rates == [0.0; 3]
    }
}

impl Spin {
    /// After `time` seconds. `None` where it is not a number.
    pub(super) fn after(&self, time: f64) -> Option<Turned> {
        let turned = match &self.kind {
            Kind::Steady(angular) => Turned {
                rotation: Rotation3::from_scaled_axis(angular * time).into_inner(),
                angular: *angular,
            },
            Kind::Periodic(motion) => motion.after(time),
        };
        let mut entries = turned.rotation.iter().chain(&turned.angular);
        let is_finite = entries.all(|entry| entry.is_finite());
        is_finite.then(|| Turned {
            rotation: self.axes * turned.rotation * self.axes.transpose(),
            angular: self.axes * turned.angular,
        })
    }
}

/// Eigenvalues and eigenvectors of a symmetric matrix, by Jacobi's rotations: small eigenvalues keep their digits beside large ones, and a diagonal matrix its axes.
fn diagonalize(mut matrix: Matrix3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
    let mut vectors = Matrix3::identity();
    for (i, j) in [(0, 1), (0, 2), (1, 2)]
        .into_iter()
        .cycle()
        .take(MOST_ROTATIONS)
    {
        let (own, other, coupling) = (matrix[(i, i)], matrix[(j, j)], matrix[(i, j)]);
        if coupling.abs() <= 0.5 * f64::EPSILON * Float::sqrt((own * other).abs()) {
            continue;
        }
        let ratio = (other - own) / (2.0 * coupling);
        let tangent = Float::signum(ratio) / (ratio.abs() + Float::hypot(ratio, 1.0));
        let cos = Float::hypot(tangent, 1.0).recip();
        let mut turn = Matrix3::identity();
        (turn[(i, i)], turn[(j, j)]) = (cos, cos);
        (turn[(i, j)], turn[(j, i)]) = (tangent * cos, -tangent * cos);
        matrix = turn.transpose() * matrix * turn;
        vectors *= turn;
    }
    (matrix.diagonal(), vectors)
}

/// A periodic motion. The third axis is the one about which the angular momentum goes round, that of the greatest moment or of the least; the second is always that of the
/// middle one.
#[derive(Clone, Debug)]
struct Motion {
    moments: Vector3<f64>,
    /// Principal axes in this order, as rows.
    order: Matrix3<f64>,
    angular: Vector3<f64>,
    /// Amplitudes of the angular velocity, with their signs: of cn, sn and dn.
    amplitudes: Vector3<f64>,
    elliptic: Elliptic,
    /// k² and k′².
    squares: [f64; 2],
    /// The argument of the elliptic functions over the time, 1/s.
    rate: f64,
    /// The amplitude at first.
    first: f64,
    precession: Precession,
}

impl Motion {
    /// `None` where the period is infinite.
    fn new(moments: &Vector3<f64>, angular: &Vector3<f64>) -> Option<Self> {
        // L² − 2T I₂, by which the angular momentum goes round the third axis or the first.
        let beyond = |i: usize| moments[i] * (moments[i] - moments[1]) * angular[i] * angular[i];
        let excess = beyond(0) + beyond(2);
        let order = match excess >= 0.0 {
            true => Matrix3::identity(),
            false => Matrix3::new(0.0, 0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0),
        };
        let moments = match excess >= 0.0 {
            true => *moments,
            false => Vector3::new(moments[2], moments[1], moments[0]),
        };
        let angular = order * angular;
        let [i1, i2, i3] = moments.into();
        let [d21, d31, d32] = [i2 - i1, i3 - i1, i3 - i2].map(Float::abs);
        // √|2T I₃ − L²| and √|L² − 2T I₁|, and their parts.
        let (first, second) = (
            Float::sqrt(i1 * d31) * angular.x,
            Float::sqrt(i2 * d32) * angular.y,
        );
        let across = Float::hypot(first, second);
        let along = Float::hypot(
            Float::sqrt(i2 * d21) * angular.y,
            Float::sqrt(i3 * d31) * angular.z,
        );
        let rate = Float::sqrt(d32 / (i1 * i2 * i3)) * along;
        let modulus = Float::sqrt(d21 / d32) * across / along;
        let complement = Float::sqrt(d31 / d32 * excess.abs()) / along;
        let squares = [modulus * modulus, complement * complement];
        let at_zeros = Float::hypot(
            complement,
            Float::sqrt(i2 * d31 / (i3 * d32)) * across / along,
        );
        let sense = Float::signum(angular.z) * Float::signum(i3 - i1);
        let amplitudes = Vector3::new(
            across / Float::sqrt(i1 * d31),
            sense * across / Float::sqrt(i2 * d32),
            Float::signum(angular.z) * along / Float::sqrt(i3 * d31),
        );
        Some(Self {
            elliptic: Elliptic::new(modulus.min(1.0), complement.min(1.0))?,
            precession: Precession::new(&moments, squares, (rate, at_zeros))?,
            first: Float::atan2(angular.y / amplitudes.y, angular.x / amplitudes.x),
            moments,
            order,
            angular,
            amplitudes,
            squares,
            rate,
        })
    }

    fn after(&self, time: f64) -> Turned {
        let argument = self.elliptic.integral(self.first) + self.rate * time;
        let to = self.elliptic.amplitude(argument);
        let momentum = self.moments.component_mul(&self.angular);
        let about = momentum.norm() * self.precession.between(time, self.first, to);
        let (sin, cos) = Float::sin_cos(to);
        let dn = Float::sqrt(self.squares[1] + self.squares[0] * cos * cos);
        let angular = self.amplitudes.component_mul(&Vector3::new(cos, sin, dn));
        let later = self.moments.component_mul(&angular);
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), about);
        let rotation = frame(&momentum).transpose() * turn.matrix() * frame(&later);
        Turned {
            rotation: self.order.transpose() * rotation * self.order,
            angular: self.order.transpose() * angular,
        }
    }
}

/// The integral over the time of `w = (I₁ω₁² + I₂ω₂²) / (I₁²ω₁² + I₂²ω₂²)`: the angle about the angular momentum, over its size.
///
/// It is that of 1/I of one of both moments, and a rest; of the two the one whose terms are smaller is taken. With roots `a² = I₁|I₃ − I₂|` and `b² = I₂|I₃ − I₁|` the rest is over
/// the amplitude, up to constant factors, `sin²φ / ((a² cos²φ + b² sin²φ) dn)` for I₁, and the same with cos²φ over it for I₂. At the zeros of its first factor in the complex plane
/// dn is `dn_p`; with that in its place the integral has a closed form, and what is left is `k² sin²φ / (dn (dn + dn_p))`, or with cos²φ, whose Fourier series is short.
#[derive(Clone, Debug)]
struct Precession {
    /// The moment of inertia.
    moment: f64,
    constant: f64,
    /// What the integral is over the amplitude on average.
    mean: f64,
    /// a, b, and what the angle with the tangent b/a tan φ counts.
    roots: [f64; 3],
    series: Vec<f64>,
}

impl Precession {
    /// With k² and k′², the rate of the argument (1/s) and `dn_p`. `None` where the Fourier series is too long, near the unstable rotation.
    fn new(
        moments: &Vector3<f64>,
        [k2, complement2]: [f64; 2],
        (rate, at_zeros): (f64, f64),
    ) -> Option<Self> {
        let [i1, i2, i3] = (*moments).into();
        let [a, b] = [i1 * (i3 - i2), i2 * (i3 - i1)].map(|part| Float::sqrt(part.abs()));
        let scale = (i3 * rate * at_zeros).recip();
        let ways = [
            (i1, (i1 - i3) / i1 * scale, -a / b),
            (i2, (i3 - i2) / i2 * scale, b / a),
        ];
        // Over half a turn of the amplitude, except for π.
        let sizes = ways.map(|(moment, constant, share)| {
            (moment * rate).recip() + 2.0 * constant.abs() * (1.0 + share.abs())
        });
        let is_first = sizes[0] <= sizes[1];
        let (moment, constant, share) = ways[usize::from(!is_first)];
        let series = cosine_series(&|phi: f64| {
            let (sin, cos) = Float::sin_cos(phi);
            let dn = Float::sqrt(complement2 + k2 * cos * cos);
            let part = if is_first { sin } else { cos };
            k2 * part * part / (dn * (dn + at_zeros))
        })?;
        let sign = if is_first { 1.0 } else { -1.0 };
        Some(Self {
            moment,
            constant,
            mean: sign + share + series[0],
            roots: [a, b, share],
            series,
        })
    }

    /// From one amplitude to another, which takes `time` seconds, 1/(kg m²) s.
    fn between(&self, time: f64, from: f64, to: f64) -> f64 {
        let [a, b, share] = self.roots;
        let periodic = |phi: f64| {
            let (sin, cos) = Float::sin_cos(phi);
            // What the angle with the tangent b/a tan φ is beyond φ.
            let beyond = Float::atan2((b - a) * sin * cos, a * cos * cos + b * sin * sin);
            let terms = self.series.iter().enumerate().skip(1).map(|(n, term)| {
                let n = 2.0 * n as f64;
                term * Float::sin(n * phi) / n
            });
            terms.sum::<f64>() + share * beyond
        };
        let rest = self.mean * (to - from) + periodic(to) - periodic(from);
        time / self.moment + self.constant * rest
    }
}

/// Coefficients of cos(2nφ) of an even function of period π, as many as count. `None` where these are too many.
fn cosine_series(function: &impl Fn(f64) -> f64) -> Option<Vec<f64>> {
    let mut count = FEWEST_TERMS;
    while count <= MOST_TERMS {
        let series = cosine_terms(function, count);
        let (head, tail) = series.split_at(count / 2);
        let most = |terms: &[f64]| {
            terms
                .iter()
                .fold(0.0_f64, |most, term| most.max(term.abs()))
        };
        if most(tail) <= f64::EPSILON * most(head) {
            return Some(series);
        }
        count *= 2;
    }
    None
}

/// Coefficients of cos(2nφ), n < `count`.
fn cosine_terms(function: &impl Fn(f64) -> f64, count: usize) -> Vec<f64> {
    let samples = 2 * count;
    let values: Vec<f64> = (0..samples)
        .map(|j| function(PI * j as f64 / samples as f64))
        .collect();
    let coefficient = |n: usize| {
        let angles = (0..samples).map(|j| 2.0 * PI * ((n * j) % samples) as f64 / samples as f64);
        let terms = values.iter().zip(angles);
        let sum = terms
            .map(|(value, angle)| value * Float::cos(angle))
            .sum::<f64>();
        sum * if n == 0 { 1.0 } else { 2.0 } / samples as f64
    };
    (0..count).map(coefficient).collect()
}

/// The axes that turn about the angular momentum, as rows: the third is along it, the second along the line of nodes.
fn frame(momentum: &Vector3<f64>) -> Matrix3<f64> {
    let along = momentum.normalize();
    let nodes = Vector3::new(-momentum.y, momentum.x, 0.0).normalize();
    Matrix3::from_rows(&[
        nodes.cross(&along).transpose(),
        nodes.transpose(),
        along.transpose(),
    ])
}

#[cfg(test)]
mod tests {
    use super::{Principal, Turned};
    use nalgebra::{Matrix3, Rotation3, Vector3};

    /// Inertias about axes that are turned, and angular velocities that go round the axis of the greatest moment and of the least; bodies that are almost or entirely
    /// symmetric.
    fn cases() -> Vec<(Principal, Matrix3<f64>, Vector3<f64>)> {
        let moments = [
            [1.0, 2.0, 2.5],
            [1.0, 1.0, 1.5],
            [0.5, 1.0, 1.0],
            [1.0, 1.0 + 1e-12, 1.0 + 2e-12],
            [1.0, 1.0, 1.0],
            [1e-6, 1.0, 1.0 + 1e-9],
        ];
        let speeds = [
            [0.3, 0.2, 1.0],
            [2.0, -0.1, 0.3],
            [-0.4, 1.0, -0.9],
            [0.0, 1e-9, -1.0],
            [0.0, 0.0, 3.0],
            [1.0, 0.7, 0.0],
        ];
        let axes = Rotation3::from_scaled_axis(Vector3::new(0.3, -0.5, 0.2)).into_inner();
        let mut all = Vec::new();
        for axes in [Matrix3::identity(), axes] {
            for moments in moments {
                let diagonal = Matrix3::from_diagonal(&Vector3::from(moments));
                let inertia = axes * diagonal * axes.transpose();
                let inertia = 0.5 * (inertia + inertia.transpose());
                let principal = Principal::new(&inertia).expect("solid");
                let turned = speeds.map(|speed| axes * Vector3::from(speed));
                all.extend(turned.map(|speed| (principal.clone(), inertia, speed)));
            }
        }
        all
    }

    /// By many steps of the classical method of order 4 on Ṙ = R ω× and Euler's equations.
    fn followed(inertia: &Matrix3<f64>, angular: &Vector3<f64>, time: f64) -> Turned {
        const STEPS: u32 = 20_000;
        let inverse = inertia.try_inverse().expect("solid");
        let step = time / f64::from(STEPS);
        let rates = |(rotation, angular): &(Matrix3<f64>, Vector3<f64>)| {
            let cross = angular.cross_matrix();
            (
                rotation * cross,
                inverse * (inertia * angular).cross(angular),
            )
        };
        let mut state = (Matrix3::identity(), *angular);
        let along =
            |state: &(Matrix3<f64>, Vector3<f64>),
             rates: &(Matrix3<f64>, Vector3<f64>),
             step: f64| (state.0 + step * rates.0, state.1 + step * rates.1);
        for _ in 0..STEPS {
            let k1 = rates(&state);
            let k2 = rates(&along(&state, &k1, 0.5 * step));
            let k3 = rates(&along(&state, &k2, 0.5 * step));
            let k4 = rates(&along(&state, &k3, step));
            for (rates, weight) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
                state = along(&state, &rates, weight * step / 6.0);
            }
        }
        let (rotation, angular) = state;
        Turned { rotation, angular }
    }

    #[test]
    fn rotations_are_those_of_the_equations() {
        for (principal, inertia, angular) in cases() {
            let told = format!("{principal:?}, {angular:?}");
            let spin = principal.spin(&angular).expect(&told);
            let found = spin.after(3.0).expect(&told);
            let expected = followed(&inertia, &angular, 3.0);
            let error = (found.rotation - expected.rotation).norm();
            let error = error.max((found.angular - expected.angular).norm());
            // 2e4 roundings of the steps, and ten of the matrix of inertia times its condition.
            let condition = principal.moments.x.recip();
            let turned = 1.0 + 3.0 * angular.norm();
            let allowed = (2e4 + 10.0 * turned * condition) * f64::EPSILON;
            assert!(error < allowed, "{told}: {error:e}");
        }
    }

    /// A million turns one way and another, and the angular momentum in space, which stays.
    #[test]
    fn long_rotations_are_compositions_of_shorter_ones() {
        for (principal, inertia, angular) in cases() {
            let told = format!("{principal:?}, {angular:?}");
            let turn = |angular: &Vector3<f64>, time| {
                let spin = principal.spin(angular).expect(&told);
                spin.after(time).expect(&told)
            };
            let (first, all) = (turn(&angular, 2.5e6), turn(&angular, 6.3e6));
            let second = turn(&first.angular, 3.8e6);
            let error = (first.rotation * second.rotation - all.rotation).norm();
            // Roundings of angles of 1e7 rad, and of energies and momenta as many times over.
            assert!(error < 1e-7, "{told}: {error:e}");
            let momentum = inertia * angular;
            let drift = all.rotation * inertia * all.angular - momentum;
            assert!(drift.norm() < 1e-13 * momentum.norm(), "{told}: {drift}");
        }
    }

    #[test]
    fn the_unstable_axis_has_no_period() {
        let principal = Principal::new(&Matrix3::from_diagonal(&Vector3::new(2.0, 3.0, 6.0)));
        let principal = principal.expect("solid");
        // L² = 2T I₂.
        let angular = Vector3::new(3.0, 0.3, 1.0);
        assert!(principal.spin(&angular).is_none());
        let steady = principal.spin(&Vector3::new(0.0, 0.3, 0.0));
        let turned = steady.and_then(|spin| spin.after(1.0));
        assert!(turned.is_some_and(|turned| turned.angular.y == 0.3));
    }
}
