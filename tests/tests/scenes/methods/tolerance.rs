//! How errors follow the tolerance.

use super::super::motions::{cases, growth, reference, scene};
use super::{ALLOWED, CLEAR, MOST_STEPS, larger, run};
use hamel::integrate::{Form, IntegrateError, Method, Scheme};

/// Least slope and largest slope of the error over the tolerance, in logarithms.
const SLOPE: (f64, f64) = (0.8, 1.2);

/// The tolerances of a sweep, a decade apart. Steps of a method of order 2 are ten times as many two decades further.
fn tolerances(scheme: Scheme) -> impl Iterator<Item = f64> {
    let most = if scheme.order() == 2 { 8 } else { 12 };
    (4..=most).map(|digits| 10.0_f64.powi(-digits))
}

/// Slope of a line through points, by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let mean = |part: fn(&(f64, f64)) -> f64| points.iter().map(part).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let product: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    product / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// What is wrong with the errors of a method on a scene over all tolerances; nothing if all is well.
fn complaint(name: &str, scheme: Scheme, form: Form) -> Option<String> {
    let (scene, reference) = (scene(name), reference(name));
    let growth = growth(&reference);
    let floor = growth * 0.5 * f64::EPSILON;
    let mut worst = 0.0;
    let mut clear = Vec::new();
    for tolerance in tolerances(scheme) {
        let method = Method::controlled(scheme, tolerance);
        let run = match run(&scene, &reference, form, method) {
            Ok(Some(run)) => run,
            Ok(None) => return Some(format!("more than {MOST_STEPS} steps at {tolerance:e}")),
            // A scene that the method does not take.
            Err(IntegrateError::Scheme { .. }) => return None,
            Err(error) => return Some(format!("at {tolerance:e}: {error}")),
        };
        worst = larger(worst, run.error / floor.max(growth * tolerance));
        if run.error > CLEAR * floor {
            clear.push((tolerance.log10(), run.error.log10()));
        }
    }
    let steep = (clear.len() >= 3).then(|| slope(&clear));
    println!(
        "{name}, {}, {form:?}: {worst:.2} of what the tolerance allows, slope {steep:.2?}",
        scheme.name()
    );
    let is_steep = |slope: f64| (SLOPE.0..=SLOPE.1).contains(&slope);
    match (worst <= ALLOWED, steep.is_none_or(is_steep)) {
        (true, true) => None,
        (false, _) => Some(format!("{worst:.1} of what the tolerance allows")),
        (true, false) => Some(format!("slope {:.2}", steep.unwrap_or(f64::NAN))),
    }
}

/// Pairs of a scene and a method in the Lagrangian form that are known to miss it, with the reason.
const MISSES: [(&str, Scheme); 3] = [
    // 13 of what is allowed at 1e-4, at 37 steps for a motion of two seconds; 9 and less from 1e-5 on.
    ("plate_cart_arm_tilted", Scheme::DormandPrince),
    // A slope of 0.60: from 12 to 46 steps, whose errors scatter, at a hundredth of the tolerance and less.
    ("chaplygin_sleigh", Scheme::Verner9),
    // 16 of what is allowed at 1e-11: where the turning fades to less than the estimate may come to, steps pass over the rest of it.
    ("chaplygin_sleigh", Scheme::Radau5),
];

fn is_known(complaint: &str) -> bool {
    MISSES
        .iter()
        .any(|(name, scheme)| complaint.starts_with(&format!("{name}, {}:", scheme.name())))
}

/// What is wrong with the errors of a method on some scenes, in the first of its forms.
fn complaints(scheme: Scheme, cases: &[&str]) -> Vec<String> {
    let form = scheme.forms()[0];
    let told = |name: &&str| {
        let told = complaint(name, scheme, form)?;
        Some(format!("{name}, {}: {told}", scheme.name()))
    };
    cases.iter().filter_map(told).collect()
}

#[test]
fn errors_follow_the_tolerance() {
    let told = complaints(
        Scheme::Verner9,
        &[
            "free_generic",
            "top_lock",
            "top_slow",
            "chain_2",
            "plate_cart_arm_tilted",
            "chain_8",
            "falling_disk",
            "torsion_1e8",
        ],
    );
    assert!(told.is_empty(), "{told:#?}");
}

#[test]
fn errors_of_other_methods_follow_the_tolerance() {
    let common = [
        "chain_2",
        "plate_cart_arm_tilted",
        "falling_disk",
        "top_slow",
        "double_ball_pendulum",
    ];
    let explicit = [Scheme::DormandPrince, Scheme::DormandPrince8];
    let told = explicit
        .into_iter()
        .flat_map(|scheme| complaints(scheme, &common));
    let mut told: Vec<String> = told.filter(|told| !is_known(told)).collect();
    told.extend(complaints(Scheme::Radau5, &common));
    told.extend(complaints(
        Scheme::Radau5,
        &[
            "torsion_1e4_damped",
            "torsion_1e8_damped",
            "torsion_1e12_damped",
        ],
    ));
    assert!(told.is_empty(), "{told:#?}");
}

/// Of order 2, it takes ten times as many steps two decades further: this motion is short.
#[test]
fn errors_of_the_discrete_gradient_follow_the_tolerance() {
    let told = complaints(Scheme::DiscreteGradient, &["chaplygin_sleigh"]);
    assert!(told.is_empty(), "{told:#?}");
}

#[test]
#[ignore = "every scene and method: an hour; the lines printed are what counts, and cases that miss what is asked for fail it"]
fn errors_follow_the_tolerance_everywhere() {
    let mut complaints = Vec::new();
    let controlled = Scheme::ALL.into_iter().filter(Scheme::has_estimate);
    for scheme in controlled {
        for name in cases() {
            for form in [Form::Lagrangian, Form::Hamiltonian] {
                let told = complaint(&name, scheme, form);
                let told = told.map(|told| format!("{name}, {}, {form:?}: {told}", scheme.name()));
                complaints.extend(told);
            }
        }
    }
    assert!(complaints.is_empty(), "{complaints:#?}");
}

/// Every motion has a method whose errors follow the tolerance from 1e-4 to 1e-12.
#[test]
#[ignore = "every scene: half a minute, with --release"]
fn a_method_follows_the_tolerance_on_every_scene() {
    let in_turn = [
        Scheme::DormandPrince8,
        Scheme::Verner9,
        Scheme::DormandPrince,
        Scheme::Radau5,
        Scheme::Exponential,
    ];
    let told = |name: &String| {
        let mut told = Vec::new();
        for scheme in in_turn {
            let complaint = complaint(name, scheme, Form::Lagrangian)?;
            told.push(format!("{name}, {}: {complaint}", scheme.name()));
        }
        Some(told)
    };
    let told: Vec<Vec<String>> = cases().iter().filter_map(told).collect();
    assert!(told.is_empty(), "{told:#?}");
}
