//! Kernels with exponentials as they are compiled, also far beyond where the exponentials overflow: in every scalar, against their
//! expressions in high precision.

use hamel::joint::{Joint, Products};
use hamel::scalar::{Dual, Extended, F64x4, Scalar};
use hamel_codegen::derived::{Derived, KernelKind};
use hamel_codegen::expr::{Expr, Symbol};
use hamel_codegen::precise::Precise;
use hamel_downstream::held_out::SoftSteps;
use hamel_tests::accuracy::check_lanes;
use nalgebra::{SMatrix, SVector};

/// Bundles of four points.
const LANES: usize = 200;
/// Terms of order 1 cancel to what is below the smallest double, 2⁻¹⁰⁷⁴, with 900 bits left.
const BITS: usize = 2048;
/// Roundings, as for the kernels of the library.
const BOUND: f64 = 16.0;
const LIFT: f64 = 0.75;
/// Widths and places that are numbers of single precision, too, and divide exactly.
const WIDTHS: [f64; 4] = [0.0078125, 0.5, 1.0, 4.0];

fn places() -> impl Iterator<Item = f64> {
    let sizes = [0.0, 1e-9, 1.0, 7.2, 720.0, 1e4];
    let both = sizes.into_iter().flat_map(|size| [size, -size]);
    both.map(|place| f64::from(place as f32))
}

fn derived() -> Derived {
    let source = include_str!("../../../../codegen/tests/held-out/soft_steps.joint");
    hamel_codegen::derive(source, "soft_steps.joint").unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn lanes_have_the_bits_of_doubles() {
    let joint = SoftSteps::new(0.7, 0.85);
    check_lanes::<_, 1, 1, 1, 0>(&joint, &derived(), LANES);
}

/// X^c and its first two derivatives, as kernels.
fn kernels<T: Scalar>(width: f64, place: T) -> [SMatrix<T, 6, 1>; 3] {
    let joint = SoftSteps::new(width, LIFT);
    let (q, speed) = (SVector::from([place]), SVector::from([T::one()]));
    [
        joint.twist_map_child(&q),
        joint.twist_gradient(&q, &speed),
        joint.bias_acceleration_gradient(&q, &speed),
    ]
}

/// The same from their expressions: the place is what ϕ is added to, and c is ∂X^c/∂ϕ at a speed of 1.
fn expected(derived: &Derived, width: f64, place: f64) -> [Vec<Precise>; 3] {
    let value = |symbol: &Symbol| {
        let value = match symbol.name() {
            "width" => width,
            "lift" => LIFT,
            "x" => place,
            _ => 1.0,
        };
        Precise::from_f64(value, BITS)
    };
    let place = &derived.arguments.configuration[0];
    let output = |kind: KernelKind| {
        let kernel = derived.kernel(kind).expect("the joint has the kernel");
        kernel.expanded().swap_remove(0)
    };
    let map = output(KernelKind::TwistMapChild);
    let bias = output(KernelKind::BiasAcceleration);
    [map.clone(), map.derivative(place), bias.derivative(place)].map(|matrix| {
        let entries = matrix.entries().iter();
        let number = |entry: &Expr| entry.evaluate(&Precise::integer(1, BITS), &value);
        entries.map(number).collect()
    })
}

/// Every kernel within the bound in units of `epsilon`: each derivative is larger by 1 + 2/width, for what turns by π/2 and rises.
fn check<T: Scalar>(epsilon: f64, number: impl Fn(f64) -> T, exact: impl Fn(T) -> Precise) {
    let derived = derived();
    for width in WIDTHS {
        for place in places() {
            let expected = expected(&derived, width, place);
            let found = kernels(width, number(place));
            let mut size = 1.0;
            for (kernel, (found, expected)) in found.iter().zip(&expected).enumerate() {
                size *= 1.0 + 2.0 / width;
                for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
                    let error = (&exact(*found) - expected).abs().to_f64();
                    let expected = expected.to_f64();
                    assert!(
                        error <= BOUND * epsilon * size,
                        "kernel {kernel}, entry {i} at {place}, width {width}: {found:?} for {expected:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn doubles_are_right_far_from_the_step() {
    check(f64::EPSILON, |x| x, |x| Precise::from_f64(x, BITS));
}

#[test]
fn single_precision_is_right_far_from_the_step() {
    let exact = |x: f32| Precise::from_f64(x.into(), BITS);
    check(f32::EPSILON.into(), |x| x as f32, exact);
}

#[test]
fn numbers_of_106_bits_are_right_far_from_the_step() {
    let part = |part: f64| Precise::from_f64(part, BITS);
    let exact = |x: Extended| &part(x.high()) + &part(x.low());
    // The circle constant is a double in every scalar.
    check(f64::EPSILON, Extended::from, exact);
}

#[test]
fn lanes_and_dual_numbers_are_those_of_doubles_far_from_the_step() {
    for width in WIDTHS {
        for place in places() {
            let own = kernels(width, place);
            let lanes = kernels(width, F64x4::from_f64(place));
            let duals = kernels(width, Dual::variable(place));
            for i in 0..3 {
                let lanes = lanes[i].map(|entry| entry.to_array()[3]);
                let duals = duals[i].map(|entry| entry.value);
                assert_eq!((lanes, duals), (own[i], own[i]), "{place}, width {width}");
            }
            // The derivative of X^c is what the kernel of its derivative gives.
            let slope = duals[0].map(|entry| entry.derivative());
            let size = (1.0 + 2.0 / width) * (1.0 + 2.0 / width);
            let error = (slope - own[1]).amax();
            assert!(
                error <= BOUND * f64::EPSILON * size,
                "{place}, width {width}: {slope} {}",
                own[1]
            );
        }
    }
}
