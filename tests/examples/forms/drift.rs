//! Energy over long motions.

use super::motion::{FORMS, MOST_STEPS, energy_error, run, scene};
use hamel::integrate::{Form, Method, Scheme};

const TIMES: [f64; 3] = [10.0, 100.0, 1000.0];

pub fn table() {
    let methods = [
        Method::rk4(1e-3),
        Method::dormand_prince(1e-8),
        Method::controlled(Scheme::Verner9, 1e-12),
    ];
    println!("## Drift of the energy\n");
    println!("| scene | method | form | 10 s | 100 s | 1000 s |");
    println!("|---|---|---|---|---|---|");
    for name in ["double_ball_pendulum", "heavy_top", "rolling_disk"] {
        let scene = scene(name);
        for method in methods {
            for form in FORMS {
                let (solution, _) = run(&scene, form, method, &TIMES, MOST_STEPS);
                let drifts = solution.samples.iter();
                let drifts = drifts.map(|state| format!("{:.1e}", energy_error(&scene, state)));
                let drifts = drifts.collect::<Vec<_>>().join(" | ");
                let letter = letter(form);
                println!(
                    "| {name} | {} | {letter} | {drifts} |",
                    method.scheme().name()
                );
            }
        }
    }
    println!();
}

pub fn letter(form: Form) -> char {
    match form {
        Form::Lagrangian => 'L',
        Form::Hamiltonian => 'H',
    }
}
