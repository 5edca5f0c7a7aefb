//! Linearised steps of the integrators against central differences of the steps themselves, through Φ and its inverse.

use chacha20::ChaCha8Rng;
use hamel::elements::Drive;
use hamel::integrate::{Form, LinearStep, Method, Scheme, StepControl, StepFailure, Tableau};
use hamel::time_function::Law;
use hamel_tests::differences::FINE;
use hamel_tests::figures::Largest;
use hamel_tests::linear_step::{self, BOUND, DT, FIXED, FORMS, place, stepping};
use hamel_tests::peers::{Reference, convert, numbers};
use hamel_tests::random::{self, Case, cases, without_knots};
use rand::SeedableRng;
use std::path::Path;
use std::sync::Arc;

/// A pair that takes its first step whatever its error.
const fn unchecked(scheme: Scheme) -> Method {
    let control = StepControl {
        tolerance: StepControl::LARGEST_TOLERANCE,
        max_step: DT,
        first_step: Some(DT),
    };
    Method::Controlled { scheme, control }
}

#[test]
fn random_trees() {
    linear_step::bare(cases(&without_knots(), 6, 48), FINE);
}

#[test]
fn equipped_trees() {
    linear_step::equipped(cases(&without_knots(), 4, 24), FINE);
}

#[test]
fn coupled_trees() {
    linear_step::constrained(cases(&without_knots(), 5, 30), 20, FINE);
}

#[test]
fn every_pair() {
    let pairs = Scheme::ALL.into_iter();
    for pair in pairs.filter(|scheme| scheme.tableau().is_some() && scheme.has_estimate()) {
        let mut worst = Largest::new(pair.name());
        for (case, form) in cases(&without_knots(), 4, 8).zip(FORMS.into_iter().cycle()) {
            let stepping = stepping(&case, form, unchecked(pair));
            worst.meet(stepping.error(&case), place(&case));
        }
        worst.assert_within(BOUND);
    }
}

/// The first state of a reference robot.
fn robot(name: &str) -> Case {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("data/robots/{name}.json"));
    let text = std::fs::read_to_string(own).expect("the file is beside this crate");
    let reference = Reference::parse(&text).expect("a reference");
    let mechanism = reference.model.mechanism().expect("a mechanism");
    let state = &reference.states[0];
    let numbers = |name: &str| numbers(&state[name]).expect("a list of numbers");
    let mut random = ChaCha8Rng::seed_from_u64(1);
    Case {
        seed: 0,
        q: convert::configuration(&reference.model, &numbers("q")),
        speeds: convert::swap(&reference.model, &numbers("v")),
        rates: vec![],
        efforts: random::numbers(&mut random, mechanism.layout().freedoms),
        mechanism,
    }
}

#[test]
fn robots() {
    for name in ["panda7", "anymal"] {
        let case = robot(name);
        for form in FORMS {
            let mut worst = Largest::new(name);
            worst.meet(
                stepping(&case, form, FIXED).error(&case),
                format!("{form:?}"),
            );
            worst.assert_within(BOUND);
        }
    }
}

#[test]
fn what_cannot_be_stepped_is_refused() {
    let case = cases(&without_knots(), 1, 1).next().expect("one case");
    let mut step = LinearStep::new(&case.mechanism, Form::Lagrangian, &Tableau::RK4);
    for length in [0.0, -DT, f64::NAN, f64::INFINITY] {
        let refused = step.linearize(&case.q, &case.speeds, &case.efforts, length);
        assert!(
            matches!(refused, Err(StepFailure::Length { .. })),
            "{length}"
        );
    }
    let refused = step.linearize(&case.q, &case.speeds, &[], DT);
    let message = refused.expect_err("no efforts").to_string();
    assert!(message.contains("efforts"), "{message}");
    let mut off = case.q.clone();
    off[0] = f64::NAN;
    let refused = step.linearize(&off, &case.speeds, &case.efforts, DT);
    assert!(matches!(refused, Err(StepFailure::State(_))), "{refused:?}");
    let drive = Drive {
        name: "shaker".to_owned(),
        body: 0,
        laws: vec![Law::default().into(); case.speeds.len()],
    };
    let driven = (*case.mechanism).clone().with_drives(vec![drive]);
    let driven = Arc::new(driven.expect("it fits"));
    let mut step = LinearStep::new(&driven, Form::Lagrangian, &Tableau::RK4);
    let refused = step.linearize(&case.q, &case.speeds, &case.efforts, DT);
    let message = refused.expect_err("a function of time").to_string();
    assert!(message.contains("`shaker`"), "{message}");
}
