//! All kernels of a joint at one case, in any scalar: lanes and dual numbers against doubles.

use super::Tracked;
use super::compare::Worst;
use super::definition::{Definition, numbers};
use super::points::{Case, Points, Range};
use super::program::Sheet;
use hamel::joint::Joint;
use hamel::nalgebra::{SMatrix, SVector};
use hamel::scalar::{Dual, F64x4, Scalar};
use hamel_codegen::derived::Derived;

/// The numbers of one kernel, in the order of storage.
pub type Output<T> = (&'static str, Vec<T>);

/// Arguments of kernels in a scalar.
pub(crate) struct Arguments<T, const N: usize, const K: usize, const S: usize> {
    q: SVector<T, N>,
    target: SVector<T, N>,
    phi: SVector<T, K>,
    v: SVector<T, K>,
    speeds: SVector<T, S>,
    wrench: SVector<T, 6>,
}

fn flat<T: Scalar, const R: usize, const C: usize>(m: &SMatrix<T, R, C>) -> Vec<T> {
    m.iter().copied().collect()
}

fn flat_all<T: Scalar, const R: usize, const C: usize, const K: usize>(
    slices: &[SMatrix<T, R, C>; K],
) -> Vec<T> {
    slices.iter().flat_map(flat).collect()
}

/// Every kernel by its name.
pub(crate) fn outputs<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    at: &Arguments<T, N, K, S>,
) -> Vec<Output<T>>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let mut all = formulas(joint, at);
    all.push(home(joint));
    all.push(moved(joint, at));
    all.extend(solutions(joint, at).map(|solution| solution()));
    all
}

/// The home configuration: numbers, or, where relations give it, found by Newton's method.
pub(crate) fn home<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
) -> Output<T>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    ("home", flat(&joint.home()))
}

/// Φ(Q, ϕ): a formula, or, where relations alone give it, found by Newton's method.
pub(crate) fn moved<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    at: &Arguments<T, N, K, S>,
) -> Output<T>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    ("retract", flat(&joint.retract(&at.q, &at.phi)))
}

/// Kernels that are solutions of equations where Φ is not exp: each is computed when it is asked for.
pub(crate) fn solutions<'a, T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &'a J,
    at: &'a Arguments<T, N, K, S>,
) -> [Box<dyn Fn() -> Output<T> + 'a>; 4]
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let Arguments {
        q, target, phi, v, ..
    } = at;
    [
        Box::new(|| ("local", flat(&joint.local(q, target)))),
        Box::new(|| {
            let differential = joint.retract_differential(q, phi);
            ("retract_differential", flat(&differential))
        }),
        Box::new(|| {
            let rate = joint.retract_differential_inverse(q, phi, v);
            ("retract_differential_inverse", flat(&rate))
        }),
        Box::new(|| ("project", flat(&joint.project(q)))),
    ]
}

/// The other kernels by their names.
pub(crate) fn formulas<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    at: &Arguments<T, N, K, S>,
) -> Vec<Output<T>>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let (q, v) = (&at.q, &at.v);
    let pose = joint.pose(q);
    vec![
        ("rotation", flat(&pose.rotation)),
        ("translation", flat(&pose.translation)),
        ("twist_map", flat(&joint.twist_map(q))),
        ("twist_map_child", flat(&joint.twist_map_child(q))),
        (
            "twist_map_child_gradient",
            flat_all(&joint.twist_map_child_gradient(q)),
        ),
        ("velocity_map", flat(&joint.velocity_map(q))),
        ("velocity_map_inverse", flat(&joint.velocity_map_inverse(q))),
        (
            "velocity_map_gradient",
            flat_all(&joint.velocity_map_gradient(q)),
        ),
        ("gamma", flat(&joint.gamma(q, v))),
        ("j22", flat(&joint.j22(q, v))),
        ("constraint", flat(&joint.constraint(q))),
        ("speed_basis", flat(&joint.speed_basis(q))),
        (
            "speed_basis_gradient",
            flat_all(&joint.speed_basis_gradient(q)),
        ),
        ("configuration_rate", flat(&joint.configuration_rate(q, v))),
        ("residual", vec![joint.residual(q)]),
        ("singularity", vec![joint.singularity(q)]),
        (
            "bias_acceleration",
            flat(&joint.bias_acceleration(q, &at.speeds)),
        ),
        (
            "bias_momentum",
            flat(&joint.bias_momentum(q, &at.speeds, &at.wrench)),
        ),
    ]
}

/// The arguments of a case, each number made by `number` from all its values (one, or one a lane).
pub(crate) fn arguments<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    cases: &[Case],
    number: impl Fn(&[f64]) -> T,
) -> Arguments<T, N, K, S>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let pick = |field: fn(&Case) -> &Vec<f64>, i: usize| {
        let lanes: Vec<f64> = cases.iter().map(|case| field(case)[i]).collect();
        number(&lanes)
    };
    let q = SVector::from_fn(|i, _| pick(|case| &case.q, i));
    let phi = SVector::from_fn(|i, _| pick(|case| &case.phi, i));
    Arguments {
        target: joint.retract(&q, &phi),
        q,
        phi,
        v: SVector::from_fn(|i, _| pick(|case| &case.v, i)),
        speeds: SVector::from_fn(|i, _| pick(|case| &case.speeds, i)),
        wrench: SVector::from_fn(|i, _| pick(|case| &case.wrench, i)),
    }
}

/// Same number, or NaN both.
fn same(a: f64, b: f64) -> bool {
    a == b || (a.is_nan() && b.is_nan())
}

/// The cases of a joint whose parameters are doubles.
fn with_cases<J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    derived: &Derived,
    count: usize,
    mut each: impl FnMut(&Definition, &[Case]),
) where
    J: Joint<N, K, S, C>,
{
    let parameters: Vec<f64> = joint.parameters().map(|(_, value)| value).collect();
    let definition = Definition::new(derived, J::BODY, &parameters);
    let range = Range {
        smallest: -300.0,
        normal: f64::MIN_POSITIVE,
        round: |value| value,
    };
    let mut points = Points::new(&definition, range, 99);
    for _ in 0..count {
        let cases: Vec<Case> = (0..F64x4::LANES).map(|_| points.case()).collect();
        each(&definition, &cases);
    }
}

/// Every lane of every kernel is, to the last bit, what doubles give.
///
/// # Panics
/// With the kernel and the numbers, where a lane differs.
pub fn check_lanes<J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    derived: &Derived,
    count: usize,
) where
    J: Joint<N, K, S, C>,
{
    with_cases(joint, derived, count, |_, cases| {
        let number = |lanes: &[f64]| F64x4::new(std::array::from_fn(|i| lanes[i]));
        let together = outputs(joint, &arguments(joint, cases, number));
        for (lane, case) in cases.iter().enumerate() {
            let alone = arguments(joint, std::slice::from_ref(case), |x| x[0]);
            for ((kernel, numbers), (_, expected)) in together.iter().zip(outputs(joint, &alone)) {
                for (number, expected) in numbers.iter().zip(expected) {
                    let got = number.to_array()[lane];
                    assert!(
                        same(got, expected),
                        "{}.{kernel}, lane {lane}: {got:e} is not {expected:e} at {case:?}",
                        J::NAME
                    );
                }
            }
        }
    });
}

/// Dual numbers: every value is that of doubles, to the last bit; the derivatives of H, X, X^c and S̄ along a motion are those of
/// their definitions. Returns the worst of these in ulp.
///
/// # Panics
/// With the kernel and the numbers, where a value differs.
pub fn measure_duals<J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    derived: &Derived,
    count: usize,
) -> Worst
where
    J: Joint<N, K, S, C>,
{
    let mut worst = Worst::default();
    let mut program = None;
    with_cases(joint, derived, count, |definition, cases| {
        let case = &cases[0];
        let program = program.get_or_insert_with(|| definition.derivatives());
        let at = program.run(&numbers(&[&case.q[..], &case.v].concat()));
        let motion = at.get("motion");
        let alone = arguments(joint, std::slice::from_ref(case), |x| x[0]);
        let mut dual = arguments(joint, std::slice::from_ref(case), |x| Dual::constant(x[0]));
        dual.q = SVector::from_fn(|i, _| Dual::new(case.q[i], motion.at(i, 0).value.to_f64()));
        let found = outputs(joint, &dual);
        for ((kernel, numbers), (_, expected)) in found.iter().zip(outputs(joint, &alone)) {
            for (number, expected) in numbers.iter().zip(expected) {
                assert!(
                    same(number.value, expected),
                    "{}.{kernel}: {:e} is not {expected:e} at {case:?}",
                    J::NAME,
                    number.value
                );
            }
        }
        for (kernel, expected) in derivatives(&at) {
            let numbers = found.iter().find(|(name, _)| *name == kernel);
            for (number, expected) in numbers.iter().flat_map(|(_, n)| n).zip(&expected) {
                worst.meet(kernel, number.derivative(), expected, &|| {
                    format!("{case:?}")
                });
            }
        }
    });
    worst
}

/// The derivatives of definitions, in the order of storage.
fn derivatives(at: &Sheet<Tracked>) -> Vec<Output<Tracked>> {
    let kernels = [
        "rotation",
        "translation",
        "twist_map",
        "twist_map_child",
        "speed_basis",
    ];
    let found = kernels.iter().filter_map(|kernel| {
        let matrix = at.find(kernel)?;
        Some((*kernel, matrix.transpose().entries().to_vec()))
    });
    found.collect()
}
