//! Evaluates the façade at states that come in as doubles on stdin, and writes its results as doubles to stdout: what the tests of the Python package compare with.
//!
//! `states FILE WHAT FRAME` reads q, v and τ, or accelerations, of one state after the other. `states FILE time` measures one call of forward dynamics, µs, for robots of revolute and prismatic joints.

use hamel::Model;
use hamel::integrate::State;
use std::error::Error;
use std::io::{Read, Write, stdin, stdout};
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, what, rest @ ..] = &*arguments else {
        return Err("states FILE WHAT [FRAME]".into());
    };
    let mut model = hamel::load(file)?;
    if what == "time" {
        return time(&mut model);
    }
    let frame = rest.first().map_or("", String::as_str);
    let mut bytes = Vec::new();
    stdin().read_to_end(&mut bytes)?;
    let (words, _) = bytes.as_chunks::<8>();
    let numbers: Vec<f64> = words.iter().map(|word| f64::from_le_bytes(*word)).collect();
    let sizes = *model.sizes();
    let mut results = Vec::new();
    let last = match what.starts_with("inverse") {
        true => sizes.speeds,
        false => sizes.freedoms,
    };
    for state in numbers.chunks(sizes.configuration + sizes.speeds + last) {
        let (q, rest) = state.split_at(sizes.configuration);
        let (v, tau) = rest.split_at(sizes.speeds);
        let state = State {
            time: 0.0,
            configuration: q.to_vec(),
            speeds: v.to_vec(),
        };
        results.extend(evaluate(&mut model, &state, tau, (what, frame))?);
    }
    let bytes: Vec<u8> = results.into_iter().flat_map(f64::to_le_bytes).collect();
    Ok(stdout().write_all(&bytes)?)
}

/// One result, row by row.
fn evaluate(
    model: &mut Model,
    state: &State,
    last: &[f64],
    (what, frame): (&str, &str),
) -> Result<Vec<f64>, Box<dyn Error>> {
    Ok(match what {
        "forward_dynamics" => model.forward_dynamics(state, last)?.as_slice().to_vec(),
        "inverse_dynamics" => model.inverse_dynamics(state, last)?.as_slice().to_vec(),
        "bias_forces" => model.bias_forces(state)?.as_slice().to_vec(),
        "mass_matrix" => model.mass_matrix(state)?.transpose().as_slice().to_vec(),
        "jacobian" => model
            .jacobian(state, frame)?
            .transpose()
            .as_slice()
            .to_vec(),
        "twist" => model.twist(state, frame)?.as_slice().to_vec(),
        "pose" => {
            let matrix = model.pose(state, frame)?.matrix();
            matrix.transpose().as_slice().to_vec()
        }
        "energy" => vec![model.energy(state)?],
        "center_of_mass" => model.center_of_mass(state)?.as_slice().to_vec(),
        "forward_dynamics_derivatives" => {
            let mut out = hamel::dynamics::ForwardDerivatives::new(model.mechanism());
            let (q, v) = (&state.configuration, &state.speeds);
            let dynamics = model.dynamics_mut();
            dynamics.forward_dynamics_derivatives(q, v, last, &mut out)?;
            let parts = [out.by_local(), out.by_speeds(), out.by_efforts()];
            let matrices = parts.into_iter().flat_map(|part| part.entries());
            out.rates().iter().chain(matrices).copied().collect()
        }
        "inverse_dynamics_derivatives" => {
            let mut out = hamel::dynamics::InverseDerivatives::new(model.mechanism());
            let (q, v) = (&state.configuration, &state.speeds);
            let dynamics = model.dynamics_mut();
            dynamics.inverse_dynamics_derivatives(q, v, last, &mut out)?;
            let parts = [out.by_local(), out.by_speeds()];
            parts
                .into_iter()
                .flat_map(|part| part.entries())
                .copied()
                .collect()
        }
        "motion" => {
            let motion = model
                .simulate()
                .starting_at(state.clone())
                .until(0.5)
                .run()?;
            let states = motion.samples.into_iter();
            let rows = states.flat_map(|at| [vec![at.time], at.configuration, at.speeds].concat());
            rows.collect()
        }
        what => return Err(format!("there is no `{what}`").into()),
    })
}

/// The time of one call, the least of several means.
fn time(model: &mut Model) -> Result<(), Box<dyn Error>> {
    const CALLS: usize = 1000;
    let mut state = model.state();
    state.configuration.fill(0.7);
    state.speeds.fill(-0.3);
    let efforts = vec![1.0; model.sizes().freedoms];
    let mut least = f64::INFINITY;
    for _ in 0..100 {
        let start = Instant::now();
        for _ in 0..CALLS {
            std::hint::black_box(model.forward_dynamics(std::hint::black_box(&state), &efforts)?);
        }
        least = least.min(start.elapsed().as_secs_f64() / CALLS as f64 * 1e6);
    }
    println!("{least:.3}");
    Ok(())
}
