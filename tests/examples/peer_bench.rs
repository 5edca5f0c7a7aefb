//! Hamel as one of the programs that the peer harness (`tests/peers`) measures: reads commands on standard input, answers one line each.
//!
//! ```text
//! info                              -> free text
//! load NAME MODEL.txt STATES.bin    -> ok ALGO ALGO ...   or   skip REASON
//! bench ALGO MIN_MS                 -> nanoseconds a call, over all states in turn for at least MIN_MS
//! check ALGO K                      -> output for state K in Pinocchio's conventions, or: none
//! quit
//! ```

use hamel::dynamics::{
    Dynamics, ForwardDerivatives, InverseDerivatives, InverseMassMatrix, MassMatrix, Recursive,
};
use hamel::mechanism::Mechanism;
use hamel_tests::peers::{Model, States, convert};
use std::error::Error;
use std::hint::black_box;
use std::io::{BufRead, Write};
use std::sync::Arc;

/// What can be measured, by the harness's names.
const ALGORITHMS: [&str; 8] = [
    "fk",
    "rnea",
    "nle",
    "crba",
    "aba",
    "minverse",
    "rnea_deriv",
    "aba_deriv",
];

/// One model, loaded.
struct Loaded {
    model: Model,
    mechanism: Arc<Mechanism>,
    states: States,
    dynamics: Recursive,
    mass: MassMatrix,
    inverse_mass: InverseMassMatrix,
    inverse: InverseDerivatives,
    forward: ForwardDerivatives,
    out: Vec<f64>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut loaded: Option<Loaded> = None;
    let mut output = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.first() == Some(&"quit") {
            break;
        }
        let answer = answer(&words, &mut loaded);
        let answer = answer.unwrap_or_else(|error| format!("skip {error}"));
        writeln!(output, "{}", answer.replace('\n', " "))?;
        output.flush()?;
    }
    Ok(())
}

fn answer(words: &[&str], loaded: &mut Option<Loaded>) -> Result<String, Box<dyn Error>> {
    match (words, loaded) {
        (["info"], _) => Ok(info()),
        (["load", _name, model, states], loaded) => {
            *loaded = Some(Loaded::read(model, states)?);
            Ok(format!("ok {}", ALGORITHMS.join(" ")))
        }
        (["bench", algorithm, milliseconds], Some(loaded)) => {
            let time = loaded.bench(algorithm, milliseconds.parse()?)?;
            Ok(format!("{time:.4}"))
        }
        (["check", algorithm, state], Some(loaded)) => loaded.check(algorithm, state.parse()?),
        _ => Err("unknown command, or no model loaded".into()),
    }
}

fn info() -> String {
    let fused = match cfg!(target_feature = "fma") {
        true => "with fused multiply-add",
        false => "baseline instructions",
    };
    format!(
        "hamel {}, interpreted tree, {fused}",
        env!("CARGO_PKG_VERSION")
    )
}

impl Loaded {
    fn read(model: &str, states: &str) -> Result<Self, Box<dyn Error>> {
        let model = Model::parse(&std::fs::read_to_string(model)?).map_err(|error| error.0)?;
        let states = States::parse(&model, &std::fs::read(states)?);
        let mechanism = model.mechanism().map_err(|error| error.0)?;
        Ok(Self {
            dynamics: Recursive::new(Arc::clone(&mechanism)),
            mass: MassMatrix::new(&mechanism),
            inverse_mass: InverseMassMatrix::new(&mechanism),
            inverse: InverseDerivatives::new(&mechanism),
            forward: ForwardDerivatives::new(&mechanism),
            out: vec![0.0; mechanism.layout().speeds],
            mechanism,
            model,
            states,
        })
    }

    /// One call of `algorithm` on state `k`.
    fn call(&mut self, algorithm: &str, k: usize) -> Result<(), Box<dyn Error>> {
        let (q, v, tau) = (&self.states.q[k], &self.states.v[k], &self.states.tau[k]);
        let dynamics = &mut self.dynamics;
        match algorithm {
            "fk" => dynamics.set_configuration(q)?,
            "rnea" => dynamics.inverse_dynamics(q, v, tau, &mut self.out)?,
            "nle" => dynamics.bias_forces(q, v, &mut self.out)?,
            "crba" => dynamics.mass_matrix(q, &mut self.mass)?,
            "aba" => dynamics.forward_dynamics(q, v, tau, &mut self.out)?,
            "minverse" => dynamics.inverse_mass_matrix(q, &mut self.inverse_mass)?,
            "rnea_deriv" => {
                dynamics.inverse_dynamics_derivatives(q, v, tau, &mut self.inverse)?;
            }
            "aba_deriv" => {
                dynamics.forward_dynamics_derivatives(q, v, tau, &mut self.forward)?;
            }
            other => return Err(format!("no algorithm `{other}`").into()),
        }
        black_box(&self.out);
        Ok(())
    }

    fn bench(&mut self, algorithm: &str, milliseconds: f64) -> Result<f64, Box<dyn Error>> {
        let target = milliseconds * 1e6;
        let mut calls = 1;
        let mut time = self.time(algorithm, calls)?;
        while time < 0.2 * target {
            calls *= 2;
            time = self.time(algorithm, calls)?;
        }
        let calls = (target * calls as f64 / time) as usize + 1;
        Ok(self.time(algorithm, calls)? / calls as f64)
    }

    /// Nanoseconds of CPU time for `calls` calls over all states in turn.
    fn time(&mut self, algorithm: &str, calls: usize) -> Result<f64, Box<dyn Error>> {
        let count = self.states.q.len();
        let start = cpu_time::ThreadTime::now();
        for call in 0..calls {
            self.call(algorithm, call % count)?;
        }
        Ok(start.elapsed().as_nanos() as f64)
    }

    fn check(&mut self, algorithm: &str, k: usize) -> Result<String, Box<dyn Error>> {
        self.call(algorithm, k)?;
        let order = convert::order(&self.model);
        let numbers: Vec<f64> = match algorithm {
            "rnea" | "nle" | "aba" => order.iter().map(|&i| self.out[i]).collect(),
            "crba" | "minverse" => {
                let rows = order.iter();
                rows.flat_map(|&i| order.iter().map(move |&j| (i, j)))
                    .map(|(i, j)| match algorithm {
                        "crba" => self.mass.entry(i, j),
                        _ => self.inverse_mass.entry(i, j),
                    })
                    .collect()
            }
            _ => return Ok("none".to_owned()),
        };
        debug_assert_eq!(order.len(), self.mechanism.layout().speeds);
        let texts: Vec<String> = numbers.iter().map(|x| format!("{x:.17e}")).collect();
        Ok(texts.join(" "))
    }
}
