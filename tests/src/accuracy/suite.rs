//! Every kernel of a joint against its definition.

use super::compare::{Measured, Worst};
use super::definition::{AtZero, Definition, slopes, values};
use super::points::{Case, Points, Range};
use super::tracked::larger;
use super::{Grid, Tracked};
use hamel::joint::Joint;
use hamel::nalgebra::{SMatrix, SVector};
use hamel_codegen::derived::{Derived, KernelKind};
use hamel_codegen::expr::Expr;

/// A joint to measure.
struct Subject<'a, J> {
    joint: &'a J,
    definition: &'a Definition,
    relations: &'a [Expr],
}

/// The worst errors of `count` cases in numbers of type `T`.
///
/// # Panics
/// Where the joint of the library is not that of its spec.
pub fn measure<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    derived: &Derived,
    seed: u64,
    count: usize,
) -> Worst
where
    T: Measured,
    J: Joint<N, K, S, C>,
{
    let parameters: Vec<f64> = joint
        .parameters()
        .map(|(_, value)| T::round(value))
        .collect();
    let definition = Definition::new(derived.spec.clone(), &parameters);
    let relations = derived.kernel(KernelKind::Residual);
    let relations = relations.map_or(&[][..], |kernel| kernel.outputs[0].entries());
    let subject = Subject {
        joint,
        definition: &definition,
        relations,
    };
    let range = Range {
        smallest: T::SMALLEST,
        round: T::round,
    };
    let mut points = Points::new(&definition, range, seed);
    let mut worst = Worst::default();
    for _ in 0..count {
        subject.measure_case::<T, N, K, S, C>(&points.case(S), &mut worst);
    }
    worst
}

/// Holds every kernel to `bound` ulp.
///
/// # Panics
/// With the kernels that exceed it, and where.
pub fn check(name: &str, worst: &Worst, bound: f64) {
    let exceeding: Vec<String> = worst
        .errors
        .iter()
        .filter(|(_, (error, _))| error.is_nan() || *error > bound)
        .map(|(kernel, (error, place))| format!("{name}.{kernel}: {error:.1} ulp, {place}"))
        .collect();
    assert!(exceeding.is_empty(), "{}", exceeding.join("\n"));
}

fn vector<T: Measured, const M: usize>(values: &[f64]) -> SVector<T, M> {
    SVector::from_fn(|i, _| T::from_f64(values[i]))
}

fn column(values: &[f64]) -> Grid<Tracked> {
    Grid::column(values.iter().map(|value| Tracked::input(*value)).collect())
}

impl<J> Subject<'_, J> {
    fn measure_case<T, const N: usize, const K: usize, const S: usize, const C: usize>(
        &self,
        case: &Case,
        worst: &mut Worst,
    ) where
        T: Measured,
        J: Joint<N, K, S, C>,
    {
        let at = self.definition.at_zero(&case.q);
        self.velocity::<T, N, K, S, C>(case, &at, worst);
        self.gradients::<T, N, K, S, C>(case, &at, worst);
        self.speeds::<T, N, K, S, C>(case, &at, worst);
        self.finite::<T, N, K, S, C>(case, worst);
        self.manifold::<T, N, K, S, C>(case, worst);
    }

    /// Kernels of H, X and S.
    fn velocity<T, const N: usize, const K: usize, const S: usize, const C: usize>(
        &self,
        case: &Case,
        at: &AtZero,
        worst: &mut Worst,
    ) where
        T: Measured,
        J: Joint<N, K, S, C>,
    {
        let (joint, q) = (self.joint, vector::<T, N>(&case.q));
        let place = || format!("Q = {:?}", case.q);
        let pose = joint.pose(&q);
        worst.matrix("pose", &pose.rotation, &values(&at.rotation), &place);
        worst.matrix("pose", &pose.translation, &values(&at.translation), &place);
        worst.matrix(
            "twist_map",
            &joint.twist_map(&q),
            &values(&at.twist_map),
            &place,
        );
        worst.matrix(
            "twist_map_child",
            &joint.twist_map_child(&q),
            &values(&at.twist_map_child),
            &place,
        );
        worst.matrix(
            "velocity_map",
            &joint.velocity_map(&q),
            &at.velocity_map,
            &place,
        );
        worst.matrix(
            "velocity_map_inverse",
            &joint.velocity_map_inverse(&q),
            &at.inverse,
            &place,
        );
        let v = vector::<T, K>(&case.v);
        let place = || format!("Q = {:?}, v = {:?}", case.q, case.v);
        let exact = column(&case.v);
        worst.matrix("gamma", &joint.gamma(&q, &v), &at.gamma(&exact), &place);
        worst.matrix("j22", &joint.j22(&q, &v), &at.j22(&exact), &place);
        worst.matrix(
            "configuration_rate",
            &joint.configuration_rate(&q, &v),
            &at.configuration_rate(&exact),
            &place,
        );
    }

    /// Derivatives along ϕ.
    fn gradients<T, const N: usize, const K: usize, const S: usize, const C: usize>(
        &self,
        case: &Case,
        at: &AtZero,
        worst: &mut Worst,
    ) where
        T: Measured,
        J: Joint<N, K, S, C>,
    {
        let (joint, q) = (self.joint, vector::<T, N>(&case.q));
        let of_child = joint.twist_map_child_gradient(&q);
        let of_map = joint.velocity_map_gradient(&q);
        for k in 0..K {
            let place = || format!("slice {k}, Q = {:?}", case.q);
            worst.matrix(
                "twist_map_child_gradient",
                &of_child[k],
                &slopes(&at.twist_map_child, k),
                &place,
            );
            worst.matrix("velocity_map_gradient", &of_map[k], &at.slopes[k], &place);
        }
    }

    /// Kernels of A and S̄, and those of c.
    fn speeds<T, const N: usize, const K: usize, const S: usize, const C: usize>(
        &self,
        case: &Case,
        at: &AtZero,
        worst: &mut Worst,
    ) where
        T: Measured,
        J: Joint<N, K, S, C>,
    {
        let (joint, q) = (self.joint, vector::<T, N>(&case.q));
        let place = || {
            format!(
                "Q = {:?}, speeds = {:?}, h = {:?}",
                case.q, case.speeds, case.wrench
            )
        };
        let basis = joint.speed_basis(&q);
        match &at.constraint {
            Some(declared) if C > 0 => {
                worst.matrix("constraint", &joint.constraint(&q), declared, &place)
            }
            _ => self.forbidden::<T, K, S, C>(&joint.constraint(&q), &basis, worst),
        }
        let Some(declared) = &at.speed_basis else {
            return self.forbidden::<T, K, S, C>(&joint.constraint(&q), &basis, worst);
        };
        worst.matrix("speed_basis", &basis, &values(declared), &place);
        for (k, slice) in joint.speed_basis_gradient(&q).iter().enumerate() {
            worst.matrix("speed_basis_gradient", slice, &slopes(declared, k), &place);
        }
        let rate = at.twist_rate(declared, &column(&case.speeds));
        let speeds = vector::<T, S>(&case.speeds);
        let bias = joint.bias_acceleration(&q, &speeds);
        worst.matrix(
            "bias_acceleration",
            &bias,
            &rate.times(&column(&case.speeds)),
            &place,
        );
        let dual = joint.bias_momentum(&q, &speeds, &vector::<T, 6>(&case.wrench));
        worst.matrix(
            "bias_momentum",
            &dual,
            &rate.transpose().times(&column(&case.wrench)),
            &place,
        );
    }

    /// AᵀS̄ = 0 where one of both is derived and so not unique: in ulp of the largest entries, of which both are rounded.
    fn forbidden<T: Measured, const K: usize, const S: usize, const C: usize>(
        &self,
        a: &SMatrix<T, K, C>,
        basis: &SMatrix<T, K, S>,
        worst: &mut Worst,
    ) {
        let largest =
            |sizes: &mut dyn Iterator<Item = f64>| sizes.fold(0.0, |m: f64, x| larger(m, x.abs()));
        let sizes =
            largest(&mut a.iter().map(|x| x.wide())) * largest(&mut basis.iter().map(|x| x.wide()));
        for c in 0..C {
            for s in 0..S {
                let product = |k: usize| a[(k, c)].wide() * basis[(k, s)].wide();
                let sum: f64 = (0..K).map(product).sum();
                worst.error("constraint", sum.abs() / (T::ULP * sizes), || {
                    format!("A = {a:?}, S_bar = {basis:?}")
                });
            }
        }
    }

    /// Finite maps.
    fn finite<T, const N: usize, const K: usize, const S: usize, const C: usize>(
        &self,
        case: &Case,
        worst: &mut Worst,
    ) where
        T: Measured,
        J: Joint<N, K, S, C>,
    {
        let (joint, q) = (self.joint, vector::<T, N>(&case.q));
        let phi = vector::<T, K>(&case.phi);
        let place = || {
            format!(
                "Q = {:?}, phi = {:?}, rate = {:?}",
                case.q, case.phi, case.v
            )
        };
        let at = self.definition.at_phi(&case.q, &case.phi);
        let moved = joint.retract(&q, &phi);
        worst.matrix("retract", &moved, &Grid::column(at.moved.clone()), &place);
        let differential = joint.retract_differential(&q, &phi);
        worst.matrix(
            "retract_differential",
            &differential,
            &at.differential,
            &place,
        );
        let rate = joint.retract_differential_inverse(&q, &phi, &vector::<T, K>(&case.v));
        worst.matrix(
            "retract_differential_inverse",
            &rate,
            &at.inverse.times(&column(&case.v)),
            &place,
        );
        let target: Vec<f64> = moved.iter().map(|x| x.wide()).collect();
        let local = self.definition.local(&case.q, &target, &case.phi);
        worst.matrix("local", &joint.local(&q, &moved), &local, &place);
    }

    /// The manifold: residual, and projection of a rounded Q.
    fn manifold<T, const N: usize, const K: usize, const S: usize, const C: usize>(
        &self,
        case: &Case,
        worst: &mut Worst,
    ) where
        T: Measured,
        J: Joint<N, K, S, C>,
    {
        let (joint, q) = (self.joint, vector::<T, N>(&case.q));
        let place = || format!("Q = {:?}", case.q);
        let residual = self.definition.residual(self.relations, &case.q);
        worst.meet("residual", joint.residual(&q), &residual, &place);
        if let Some(least) = self.definition.singularity(&case.q) {
            worst.meet("singularity", joint.singularity(&q), &least, &place);
        }
        let nearest = self.definition.nearest(&case.q, &case.exact);
        worst.matrix(
            "project",
            &joint.project(&q),
            &Grid::column(nearest),
            &place,
        );
    }
}
