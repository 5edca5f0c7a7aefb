//! What the compiler leaves out costs nothing: instructions of a compiled pendulum beside those of its equations written by hand, by callgrind.
//!
//! The test binary runs itself under valgrind, with two numbers of calls; the difference leaves start and end out.

use hamel::scalar::Scalar;
use hamel_emitted::pendulum;
use std::hint::black_box;
use std::process::Command;

/// Names what is called, and how often: `NAME COUNT`.
const VARIABLE: &str = "HAMEL_TEST_CALLS";

/// What is asked: hand-written equations and compiled ones differ by the order of a sum and how a call passes its numbers.
const ALLOWED: f64 = 0.1;

/// kg, kg m² about the axis, m, m/s²: those of the scene, whose centre of mass stands at (0.05, −0.4) m from the axis where q = 0.
const MASS: f64 = 1.2;
const INERTIA: f64 = 0.018 + MASS * (ALONG * ALONG + BELOW * BELOW);
const ALONG: f64 = 0.05;
const BELOW: f64 = -0.4;
const GRAVITY: f64 = 9.81;

type Equation = fn(&[f64; 1], &[f64; 1], &[f64; 1]) -> [f64; 1];

/// The torque of gravity about the axis, N m.
fn gravity_torque(q: f64) -> f64 {
    let ([sine], [cosine]) = f64::sin_cos_all(&[q]);
    MASS * GRAVITY * (ALONG * cosine) - MASS * GRAVITY * (BELOW * sine)
}

fn acceleration(q: &[f64; 1], _: &[f64; 1], tau: &[f64; 1]) -> [f64; 1] {
    [(tau[0] + gravity_torque(q[0])) * (1.0 / INERTIA)]
}

fn effort(q: &[f64; 1], _: &[f64; 1], a: &[f64; 1]) -> [f64; 1] {
    [INERTIA * a[0] - gravity_torque(q[0])]
}

const EQUATIONS: [(&str, Equation, Equation); 2] = [
    ("forward", pendulum::forward_dynamics::<f64>, acceleration),
    ("inverse", pendulum::inverse_dynamics::<f64>, effort),
];

#[test]
fn hand_written_equations_are_those_of_the_scene() {
    for (name, compiled, by_hand) in EQUATIONS {
        for i in -20..20 {
            let (q, u) = ([0.37 * f64::from(i)], [1.5 - 0.2 * f64::from(i)]);
            let (found, expected) = (compiled(&q, &[0.7], &u)[0], by_hand(&q, &[0.7], &u)[0]);
            // Some roundings of terms up to 50.
            assert!(
                (found - expected).abs() < 1e-13,
                "{name}: {found} {expected}"
            );
        }
    }
}

/// Called under valgrind by the test below, which tells it what to do.
#[test]
fn calls() {
    let Ok(asked) = std::env::var(VARIABLE) else {
        return;
    };
    let words: Vec<&str> = asked.split(' ').collect();
    let found = EQUATIONS.iter().find(|(name, ..)| *name == words[0]);
    let &(_, compiled, by_hand) = found.expect("one of the equations");
    let function = if words[1] == "compiled" {
        compiled
    } else {
        by_hand
    };
    let count: usize = words[2].parse().expect("a number of calls");
    let mut angle = 0.0;
    for _ in 0..count {
        angle += 1e-4;
        black_box(black_box(function)(
            black_box(&[angle]),
            black_box(&[0.7]),
            black_box(&[0.1]),
        ));
    }
}

/// Instructions of this program under valgrind, running one test with a variable set to `value`.
pub fn of_test(test: &str, variable: &str, value: &str) -> f64 {
    let own = std::env::current_exe().expect("a path");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(own)
        .args(["--exact", test, "--test-threads=1"])
        .env(variable, value)
        .output()
        .expect("valgrind, which counts instructions");
    let told = String::from_utf8_lossy(&output.stderr);
    let collected = told
        .lines()
        .find_map(|line| line.split_once("Collected : "));
    let (_, number) = collected.unwrap_or_else(|| panic!("no count: {told}"));
    number.trim().parse().expect("a number")
}

/// Instructions of the whole program.
fn instructions(name: &str, which: &str, count: usize) -> f64 {
    of_test(
        "instructions::calls",
        VARIABLE,
        &format!("{name} {which} {count}"),
    )
}

#[test]
#[ignore = "takes valgrind, and --release"]
fn a_pendulum_takes_the_instructions_of_its_equations() {
    for (name, ..) in EQUATIONS {
        let [compiled, by_hand] = ["compiled", "by_hand"].map(|which| {
            let [few, many] = [100_000, 200_000].map(|count| instructions(name, which, count));
            (many - few) / 1e5
        });
        println!("{name}: {compiled} instructions a call, {by_hand} by hand");
        assert!((compiled / by_hand - 1.0).abs() <= ALLOWED, "{name}");
    }
}
