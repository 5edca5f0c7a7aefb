//! Every kernel of a joint against its definition.

use super::compare::{Measured, Worst};
use super::definition::Definition;
use super::points::{Case, Points, Range};
use super::program::Sheet;
use super::tracked::larger;
use super::{Grid, Tracked};
use hamel::joint::Joint;
use hamel::nalgebra::{SMatrix, SVector};
use hamel_codegen::derived::Derived;
use std::collections::BTreeSet;

/// A joint to measure.
struct Subject<'a, J> {
    joint: &'a J,
    definition: &'a Definition,
}

/// The worst errors of `count` cases in numbers of type `T`, of each group of kernels that are not all `known`; `progress` is told how
/// many cases have been met.
///
/// # Panics
/// Where the joint of the library is not that of its spec.
pub fn measure<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    derived: &Derived,
    count: usize,
    known: &BTreeSet<String>,
    progress: &dyn Fn(usize),
) -> Worst
where
    T: Measured,
    J: Joint<N, K, S, C>,
{
    let parameters: Vec<f64> = joint
        .parameters()
        .map(|(_, value)| T::round(value))
        .collect();
    let definition = Definition::new(derived, J::BODY, &parameters);
    let subject = Subject {
        joint,
        definition: &definition,
    };
    let range = Range {
        smallest: T::SMALLEST,
        normal: T::NORMAL,
        round: T::round,
    };
    let mut points = Points::new(&definition, range, 0);
    // What belongs to Q and v alone is measured with the first body.
    let groups = match J::BODY {
        0 => &GROUPS[..],
        _ => &[Group::AtZero],
    };
    // The first case shows which kernels a group has.
    let first = points.case();
    let mut worst = Worst::default();
    let wanted = groups.iter().copied().filter(|group| {
        let mut found = Worst::default();
        subject.measure_group::<T, N, K, S, C>(*group, &first, &mut found);
        let wanted = found.errors.keys().any(|kernel| !known.contains(*kernel));
        if wanted {
            worst.merge(found);
        }
        wanted
    });
    let wanted: Vec<Group> = wanted.collect();
    for done in 1..count {
        if wanted.is_empty() {
            break;
        }
        progress(done);
        let case = points.case();
        for group in &wanted {
            subject.measure_group::<T, N, K, S, C>(*group, &case, &mut worst);
        }
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

/// Kernels that are measured together.
#[derive(Clone, Copy, Debug)]
enum Group {
    /// Those at ϕ = 0.
    AtZero,
    /// The finite maps.
    Finite,
    /// Residual, projection, distance from a locus.
    Manifold,
}

const GROUPS: [Group; 3] = [Group::AtZero, Group::Finite, Group::Manifold];

/// What kernels are held against.
struct Against<'a> {
    at: &'a Sheet<Tracked>,
    worst: &'a mut Worst,
}

impl Against<'_> {
    fn matrix<T: Measured, const R: usize, const C: usize>(
        &mut self,
        kernel: &'static str,
        got: &SMatrix<T, R, C>,
        place: &dyn Fn() -> String,
    ) {
        self.worst.matrix(kernel, got, self.at.get(kernel), place);
    }

    fn slices<T: Measured, const R: usize, const C: usize>(
        &mut self,
        kernel: &'static str,
        got: &[SMatrix<T, R, C>],
        place: &dyn Fn() -> String,
    ) {
        for (k, (slice, want)) in got.iter().zip(self.at.all(kernel)).enumerate() {
            let place = || format!("slice {k}, {}", place());
            self.worst.matrix(kernel, slice, want, &place);
        }
    }
}

impl<J> Subject<'_, J> {
    fn measure_group<T, const N: usize, const K: usize, const S: usize, const C: usize>(
        &self,
        group: Group,
        case: &Case,
        worst: &mut Worst,
    ) where
        T: Measured,
        J: Joint<N, K, S, C>,
    {
        match group {
            Group::AtZero => {
                let at = self
                    .definition
                    .kernels(&case.q, &case.v, &case.speeds, &case.wrench);
                self.velocity::<T, N, K, S, C>(case, &at, worst);
                self.gradients::<T, N, K, S, C>(case, &at, worst);
                self.speeds::<T, N, K, S, C>(case, &at, worst);
            }
            Group::Finite => self.finite::<T, N, K, S, C>(case, worst),
            Group::Manifold => self.manifold::<T, N, K, S, C>(case, worst),
        }
    }

    /// Kernels of H, X and S.
    fn velocity<T, const N: usize, const K: usize, const S: usize, const C: usize>(
        &self,
        case: &Case,
        at: &Sheet<Tracked>,
        worst: &mut Worst,
    ) where
        T: Measured,
        J: Joint<N, K, S, C>,
    {
        let (joint, q) = (self.joint, vector::<T, N>(&case.q));
        let place = || format!("Q = {:?}", case.q);
        let pose = joint.pose(&q);
        let want: Vec<&Grid<Tracked>> = at.all("pose").collect();
        worst.matrix("pose", &pose.rotation, want[0], &place);
        worst.matrix("pose", &pose.translation, want[1], &place);
        let mut hold = Against { at, worst };
        hold.matrix("twist_map", &joint.twist_map(&q), &place);
        hold.matrix("twist_map_child", &joint.twist_map_child(&q), &place);
        hold.matrix("velocity_map", &joint.velocity_map(&q), &place);
        let inverse = joint.velocity_map_inverse(&q);
        hold.matrix("velocity_map_inverse", &inverse, &place);
        let v = vector::<T, K>(&case.v);
        let place = || format!("Q = {:?}, v = {:?}", case.q, case.v);
        hold.matrix("gamma", &joint.gamma(&q, &v), &place);
        hold.matrix("j22", &joint.j22(&q, &v), &place);
        let rate = joint.configuration_rate(&q, &v);
        hold.matrix("configuration_rate", &rate, &place);
    }

    /// Derivatives along ϕ.
    fn gradients<T, const N: usize, const K: usize, const S: usize, const C: usize>(
        &self,
        case: &Case,
        at: &Sheet<Tracked>,
        worst: &mut Worst,
    ) where
        T: Measured,
        J: Joint<N, K, S, C>,
    {
        let (joint, q) = (self.joint, vector::<T, N>(&case.q));
        let place = || format!("Q = {:?}", case.q);
        let mut hold = Against { at, worst };
        let of_child = joint.twist_map_child_gradient(&q);
        hold.slices("twist_map_child_gradient", &of_child, &place);
        let of_map = joint.velocity_map_gradient(&q);
        hold.slices("velocity_map_gradient", &of_map, &place);
    }

    /// Kernels of A and S̄, and those of c.
    fn speeds<T, const N: usize, const K: usize, const S: usize, const C: usize>(
        &self,
        case: &Case,
        at: &Sheet<Tracked>,
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
        let (basis, a) = (joint.speed_basis(&q), joint.constraint(&q));
        match at.find("constraint") {
            Some(declared) => worst.matrix("constraint", &a, declared, &place),
            None => self.forbidden::<T, K, S, C>(&a, &basis, worst),
        }
        if at.find("speed_basis").is_none() {
            return self.forbidden::<T, K, S, C>(&a, &basis, worst);
        }
        let mut hold = Against { at, worst };
        hold.matrix("speed_basis", &basis, &place);
        let slopes = joint.speed_basis_gradient(&q);
        hold.slices("speed_basis_gradient", &slopes, &place);
        let speeds = vector::<T, S>(&case.speeds);
        let bias = joint.bias_acceleration(&q, &speeds);
        hold.matrix("bias_acceleration", &bias, &place);
        let wrench = vector::<T, 6>(&case.wrench);
        let dual = joint.bias_momentum(&q, &speeds, &wrench);
        hold.matrix("bias_momentum", &dual, &place);
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
        let local = self.definition.local(&at, &case.q, &target, &case.phi);
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
        let residual = self.definition.residual(&case.q);
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
