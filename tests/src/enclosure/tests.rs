//! The judge on joints that are true, on joints with a false kernel, and on functions without a value.

use super::{Point, Verdict, judge, judge_products};
use hamel_codegen::derived::{Derived, KernelKind};
use hamel_codegen::expr::Expr;
use hamel_codegen::matrix::Matrix;
use hamel_compiler::JointType;

/// Kernels that no law here evaluates: finite maps beside Φ, home, and what tells how far a configuration is from where it belongs.
const UNJUDGED: [KernelKind; 8] = [
    KernelKind::Home,
    KernelKind::Local,
    KernelKind::RetractDifferential,
    KernelKind::RetractDifferentialInverse,
    KernelKind::Relations,
    KernelKind::Project,
    KernelKind::Residual,
    KernelKind::Singularity,
];

fn at(chart: &[f64], parameters: &[f64]) -> Point {
    Point {
        parameters: parameters.to_vec(),
        chart: chart.to_vec(),
    }
}

/// The library at points near and far; parameters that all of its requirements allow. The judge knows joints of one body that declare Φ or have that of
/// their manifold; those of several bodies and of relations alone are held to their definitions by [`crate::accuracy`].
#[test]
fn the_library_holds() {
    let all = crate::spec_names().into_iter();
    let all = all.map(|name| (crate::derived(&name), name));
    for (derived, name) in all.filter(|(d, _)| d.more.is_empty() && d.spec.implicit.is_none()) {
        let count = super::dimensions(&derived.space);
        let parameters: Vec<f64> = (0..derived.spec.parameters.len())
            .map(|i| 1.5 / (1.0 + i as f64))
            .collect();
        for size in [0.3, 17.0] {
            let chart: Vec<f64> = (0..count).map(|i| size / (1.0 + 0.7 * i as f64)).collect();
            assert_eq!(
                judge(&derived, &at(&chart, &parameters)),
                Verdict::Holds,
                "{name}"
            );
            let joint = JointType::new(derived.clone()).expect("little work");
            assert_eq!(
                judge_products(&joint, &at(&chart, &parameters)),
                Verdict::Holds,
                "products of {name}"
            );
        }
    }
}

#[test]
fn a_false_product_is_told() {
    let mut joint = JointType::new(crate::derived("ellipsoid")).expect("little work");
    let mut moved = joint.products.twist_gradient.value.entries().to_vec();
    moved[0] += &Expr::integer(1);
    let (rows, columns) = joint.products.twist_gradient.value.shape();
    joint.products.twist_gradient.value =
        Matrix::from_fn(rows, columns, |i, k| moved[columns * i + k].clone());
    let verdict = judge_products(&joint, &at(&[0.3, 0.2, 0.1], &[1.0, 2.0, 3.0]));
    assert!(
        matches!(verdict, Verdict::Violated("twist_gradient", _)),
        "{verdict:?}"
    );
}

/// A column of X that is small as doubles go, with a zero that is known to some digits only beside it.
#[test]
fn small_columns_have_their_rank() {
    let source = "hamel = 1;
        joint narrow {
            config x: R1, y: R1;
            H = trans([x, y, 0]) * rot_z(1.5 * x);
            let g = exp(-x * x);
            X = [0, 0; sqrt(2) * sqrt(3) - sqrt(6), 0; 1.5 * g, 0; g * (1 + 1.5 * y), 0; -1.5 * x * g, 1; 0, 0];
        }";
    let derived = hamel_codegen::derive(source, "narrow.joint").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(judge(&derived, &at(&[-12.0, 0.25], &[])), Verdict::Holds);
    // 1/g is beyond what the digits of the zero allow to say.
    let far = judge(&derived, &at(&[-51.57, -7.5], &[]));
    assert_eq!(far, Verdict::Undecided("X S = J to first order"));
}

/// The joint with 1e-30 exp(−1e6 (x − 5)²) added to the first entry of one kernel.
fn with_false(derived: &Derived, kind: KernelKind) -> Option<Derived> {
    let mut falsified = derived.clone();
    let x = Expr::symbol(falsified.arguments.configuration.get(1)?);
    let off = &x - &Expr::integer(5);
    let tiny = Expr::fraction(1, 1_000_000_000_000_000).square();
    let bump = &tiny * &(&Expr::integer(-1_000_000) * &off.square()).exp();
    let mut kernel = falsified.kernel(kind)?.clone();
    let output = kernel.outputs.first_mut()?;
    if output.entries().is_empty() {
        return None;
    }
    let mut first = true;
    *output = output.map(|entry| match std::mem::take(&mut first) {
        true => entry + &bump,
        false => entry.clone(),
    });
    falsified.replace(kernel);
    Some(falsified)
}

#[test]
fn a_small_narrow_error_of_any_kernel_is_told() {
    let derived = crate::derived("knife_edge");
    let there = at(&[0.3, 5.0, 1.0], &[]);
    let mut judged = 0;
    for kernel in &derived.kernels {
        let Some(falsified) = with_false(&derived, kernel.kind) else {
            continue;
        };
        if UNJUDGED.contains(&kernel.kind) {
            continue;
        }
        let verdict = judge(&falsified, &there);
        assert!(
            matches!(verdict, Verdict::Violated(..)),
            "{:?}: {verdict:?}",
            kernel.kind
        );
        judged += 1;
    }
    assert!(judged >= 16, "{judged} kernels");
}

/// 1 / (x − 5) in H, which the generator does not accept: put into a derived joint.
#[test]
fn a_value_that_is_missing_is_told() {
    let mut derived = crate::derived("knife_edge");
    let x = Expr::symbol(&derived.arguments.configuration[1]);
    let pole = (&x - &Expr::integer(5)).recip().unwrap_or_default();
    let pose = &mut derived.spec.pose.value;
    pose.translation = pose.translation.map(|entry| entry + &pole);
    let verdict = judge(&derived, &at(&[0.3, 5.0, 1.0], &[]));
    assert!(matches!(verdict, Verdict::Undefined(_)), "{verdict:?}");
}

#[test]
fn points_beyond_ranges_and_exceptions_are_outside() {
    let gimbal = crate::derived("gimbal");
    assert_eq!(judge(&gimbal, &at(&[0.3, 2.0, 1.0], &[])), Verdict::Holds);
    let disk = crate::derived("falling_disk");
    // The identity: the disk lies flat.
    assert_eq!(
        judge(&disk, &at(&[0.0, 0.0, 0.0, 1.0, 2.0], &[0.5])),
        Verdict::Outside
    );
}
