//! Compiled scenes as one of the programs that the peer harness measures: the protocol is in `tests/peers/README.md`.
//!
//! The example `peer_compiled` makes a project of this file, with a folder `models` of a module for each model.

#[allow(dead_code, reason = "not all of every module is called")]
mod models;

/// The harness's formats, as the suites read them.
#[allow(dead_code, reason = "states alone are read here")]
mod peers {
    mod model;
    mod states;
    pub use model::{JointKind, Model};
    pub use states::{States, convert};
}

use hamel::compiled::{Batch, Equations, LANES, Lanes};
use hamel::scalar::F64x4;
use peers::{Model, States, convert};
use std::error::Error;
use std::hint::black_box;
use std::io::{BufRead, Write};

/// States that the batched algorithms take in one call at most.
const BATCH: usize = 64;

/// What a module holds, behind pointers.
#[derive(Clone, Copy)]
pub struct Functions {
    equations: &'static Equations,
    bias_forces: Option<fn(&[f64], &[f64], &mut [f64])>,
    forward_x4: Option<Four>,
    inverse_x4: Option<Four>,
    /// Forward and inverse dynamics of eight states in C, by gcc and by clang.
    in_c: [Option<[InC; 2]>; 2],
}

/// A function of eight states side by side in C.
pub type InC = unsafe extern "C" fn(*const f64, *const f64, *const f64, *mut f64);

/// The algorithms of those.
const IN_C: [[&str; 2]; 2] = [["aba_x8_gcc", "rnea_x8_gcc"], ["aba_x8_clang", "rnea_x8_clang"]];

/// A function of four states side by side.
type Four = fn(&[F64x4], &[F64x4], &[F64x4], &mut [F64x4]);

/// The functions of a module; the names of those that it has stand behind its own.
#[macro_export]
macro_rules! functions {
    ($module:ident: $($function:ident)*) => {{
        let mut functions = $crate::Functions::new(&$module::EQUATIONS);
        $($crate::function!(functions, $module, $function);)*
        functions
    }};
}

/// One function of a module.
#[macro_export]
macro_rules! function {
    ($functions:ident, $module:ident, bias_forces) => {
        $functions.bias_forces = Some(|q, v, results| {
            if let (Some(q), Some(v)) = (q.first_chunk(), v.first_chunk()) {
                results.copy_from_slice(&$module::bias_forces::<f64>(q, v));
            }
        })
    };
    // The runtime's own call is what is measured.
    ($functions:ident, $module:ident, forward_dynamics_derivatives) => {};
    ($functions:ident, $module:ident, inverse_dynamics_derivatives) => {};
    ($functions:ident, $module:ident, mass_matrix) => {};
    ($functions:ident, $module:ident, inverse_mass_matrix) => {};
    ($functions:ident, $module:ident, forward_dynamics) => {
        $functions.forward_x4 = Some($crate::four!($module, forward_dynamics))
    };
    ($functions:ident, $module:ident, inverse_dynamics) => {
        $functions.inverse_x4 = Some($crate::four!($module, inverse_dynamics))
    };
}

/// A function of four states side by side.
#[macro_export]
macro_rules! four {
    ($module:ident, $function:ident) => {
        |q, v, u, results| {
            if let (Some(q), Some(v), Some(u)) = (q.first_chunk(), v.first_chunk(), u.first_chunk())
            {
                results.copy_from_slice(&$module::$function::<F64x4>(q, v, u));
            }
        }
    };
}

impl Functions {
    const fn new(equations: &'static Equations) -> Self {
        Self {
            equations,
            bias_forces: None,
            forward_x4: None,
            inverse_x4: None,
            in_c: [None; 2],
        }
    }

    /// The same with functions in C.
    const fn in_c(self, in_c: [Option<[InC; 2]>; 2]) -> Self {
        Self { in_c, ..self }
    }

    /// The function of an algorithm in C.
    fn of_c(&self, algorithm: &str) -> Option<InC> {
        let all = IN_C.iter().zip(&self.in_c);
        let mut all = all.filter_map(|(names, own)| Some((names, own.as_ref()?)));
        all.find_map(|(names, own)| {
            let place = names.iter().position(|name| *name == algorithm)?;
            Some(own[place])
        })
    }

    /// The algorithms that there are, by the harness's names.
    fn algorithms(&self) -> String {
        let equations = self.equations;
        let lanes = &equations.in_lanes;
        let all = [
            ("rnea", equations.inverse_dynamics.is_some()),
            ("nle", self.bias_forces.is_some()),
            ("crba", equations.mass_matrix.is_some()),
            ("minverse", equations.inverse_mass_matrix.is_some()),
            ("aba", equations.forward_dynamics.is_some()),
            ("rnea_deriv", equations.inverse_dynamics_derivatives.is_some()),
            ("aba_deriv", equations.forward_dynamics_derivatives.is_some()),
            ("aba_x4", self.forward_x4.is_some()),
            ("aba_x8", lanes.forward_dynamics.is_some()),
            ("aba_x8_rows", lanes.forward_dynamics.is_some()),
            ("rnea_x4", self.inverse_x4.is_some()),
            ("rnea_x8", lanes.inverse_dynamics.is_some()),
            ("rnea_x8_rows", lanes.inverse_dynamics.is_some()),
            ("rnea_deriv_x8", lanes.inverse_dynamics_derivatives.is_some()),
            ("aba_deriv_x8", lanes.forward_dynamics_derivatives.is_some()),
            ("crba_x8", lanes.mass_matrix.is_some()),
            ("minverse_x8", lanes.inverse_mass_matrix.is_some()),
        ];
        let there = all.iter().filter(|(_, there)| *there);
        let there = there.map(|(name, _)| *name);
        let in_c = IN_C.iter().flatten().copied();
        let there = there.chain(in_c.filter(|name| self.of_c(name).is_some()));
        there.map(|name| format!(" {name}")).collect()
    }
}

/// One model, loaded.
struct Loaded {
    model: Model,
    functions: Functions,
    batch: Batch,
    states: States,
    /// The same states one after the other.
    rows: [Vec<f64>; 3],
    /// The same in groups of four, entry by entry.
    fours: [Vec<F64x4>; 3],
    /// The same in groups of eight.
    eights: [Vec<Lanes>; 3],
    out: Vec<f64>,
    out_eight: Vec<Lanes>,
    out_four: Vec<F64x4>,
    mass: Vec<f64>,
    slopes: Vec<f64>,
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
        (["load", name, model, states], loaded) => {
            let new = Loaded::read(name, model, states)?;
            let algorithms = new.functions.algorithms();
            *loaded = Some(new);
            Ok(format!("ok{algorithms}"))
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
    let level = hamel::compiled::Level::default();
    format!("hamel, compiled scenes, {fused}; x8 by `Batch` at level {level:?} with states side by side, x8_rows with states in rows, x4 by `F64x4`")
}

impl Loaded {
    fn read(name: &str, model: &str, states: &str) -> Result<Self, Box<dyn Error>> {
        let functions = models::find(name)?;
        let model = Model::parse(&std::fs::read_to_string(model)?).map_err(|error| error.0)?;
        let states = States::parse(&model, &std::fs::read(states)?);
        let of = [&states.q, &states.v, &states.tau];
        let equations = functions.equations;
        Ok(Self {
            batch: Batch::new(equations),
            rows: of.map(|rows| rows.concat()),
            fours: of.map(|rows| rows.chunks_exact(4).flat_map(side_by_side).collect()),
            eights: of.map(|rows| Lanes::side_by_side(&rows.concat(), rows[0].len())),
            out: vec![0.0; BATCH * equations.speeds],
            // Rows of three matrices as wide as there are speeds, at most, and of the accelerations.
            out_eight: vec![Lanes::default(); BATCH / LANES * equations.speeds * (3 * equations.speeds + 1)],
            out_four: vec![F64x4::default(); equations.speeds],
            mass: vec![0.0; equations.speeds * equations.speeds],
            // Rows of three matrices as wide as there are speeds, at most, and of the accelerations.
            slopes: vec![0.0; equations.speeds * (3 * equations.speeds + 1)],
            functions,
            model,
            states,
        })
    }

    /// States of one call.
    fn together(&self, algorithm: &str) -> usize {
        let most = match algorithm {
            "aba_x4" | "rnea_x4" => 4,
            _ if algorithm.contains("_x8") => BATCH,
            _ => 1,
        };
        most.min(self.states.q.len())
    }

    /// One call of `algorithm` for the group of states `k`.
    fn call(&mut self, algorithm: &str, k: usize) -> Result<(), Box<dyn Error>> {
        let states = self.together(algorithm);
        let functions = self.functions;
        let equations = functions.equations;
        let missing = || format!("no algorithm `{algorithm}`");
        let size = equations.speeds;
        match algorithm {
            "aba_x4" | "rnea_x4" => {
                let function = match algorithm {
                    "aba_x4" => functions.forward_x4,
                    _ => functions.inverse_x4,
                };
                let [q, v, u] = group(&self.fours, &self.states, k, 1);
                function.ok_or_else(missing)?(q, v, u, &mut self.out_four);
            }
            _ if functions.of_c(algorithm).is_some() => {
                let rows = states / LANES;
                let [q, v, u] = group(&self.eights, &self.states, k, rows);
                let own = functions.of_c(algorithm).ok_or_else(missing)?;
                let widths = [q, v, u].map(|lanes| lanes.len() / rows);
                for (row, out) in self.out_eight.chunks_exact_mut(size).take(rows).enumerate() {
                    let [q, v, u] = [q, v, u].map(|lanes| lanes.as_ptr().cast::<f64>());
                    let at = |lanes: *const f64, i: usize| lanes.wrapping_add(row * widths[i] * LANES);
                    // SAFETY: groups of eight lie entry after entry; the function reads those of one group, and writes as many results as there are speeds.
                    unsafe { own(at(q, 0), at(v, 1), at(u, 2), out.as_mut_ptr().cast()) };
                }
            }
            _ if algorithm.ends_with("_x8") => {
                let rows = states / LANES;
                let [q, v, u] = group(&self.eights, &self.states, k, rows);
                let batch = self.batch;
                let width = self.width(algorithm);
                let out = &mut self.out_eight[..rows * width];
                match algorithm {
                    "aba_x8" => batch.forward_dynamics(q, v, u, out)?,
                    "rnea_x8" => batch.inverse_dynamics(q, v, u, out)?,
                    "aba_deriv_x8" => batch.forward_dynamics_derivatives(q, v, u, out)?,
                    "rnea_deriv_x8" => batch.inverse_dynamics_derivatives(q, v, u, out)?,
                    "crba_x8" => batch.mass_matrix(q, out)?,
                    _ => batch.inverse_mass_matrix(q, out)?,
                }
            }
            // The accelerations of inverse dynamics are the states' efforts.
            "aba_x8_rows" | "rnea_x8_rows" => {
                let [q, v, u] = group(&self.rows, &self.states, k, states);
                let out = &mut self.out[..states * size];
                match algorithm {
                    "aba_x8_rows" => self.batch.forward_dynamics(q, v, u, out)?,
                    _ => self.batch.inverse_dynamics(q, v, u, out)?,
                }
            }
            _ => {
                let (q, v, u) = (&self.states.q[k], &self.states.v[k], &self.states.tau[k]);
                let out = &mut self.out[..size];
                match algorithm {
                    "aba" => equations.forward_dynamics.ok_or_else(missing)?(q, v, u, out),
                    "rnea" => equations.inverse_dynamics.ok_or_else(missing)?(q, v, u, out),
                    "nle" => functions.bias_forces.ok_or_else(missing)?(q, v, out),
                    "rnea_deriv" => {
                        let slopes = equations.inverse_dynamics_derivatives;
                        slopes.ok_or_else(missing)?(q, v, u, &mut self.slopes);
                    }
                    "aba_deriv" => {
                        let slopes = equations.forward_dynamics_derivatives;
                        slopes.ok_or_else(missing)?(q, v, u, &mut self.slopes);
                    }
                    "crba" => equations.mass_matrix.ok_or_else(missing)?(q, v, u, &mut self.mass),
                    "minverse" => {
                        let inverse = equations.inverse_mass_matrix;
                        inverse.ok_or_else(missing)?(q, v, u, &mut self.mass);
                    }
                    _ => return Err(missing().into()),
                }
            }
        }
        black_box((&self.out, &self.out_four, &self.out_eight));
        black_box((&self.mass, &self.slopes));
        Ok(())
    }

    /// Numbers of one state's results.
    fn width(&self, algorithm: &str) -> usize {
        let equations = self.functions.equations;
        let size = equations.speeds;
        match algorithm {
            "crba_x8" | "minverse_x8" => size * size,
            "rnea_deriv_x8" => size * (equations.freedoms + size),
            "aba_deriv_x8" => equations.forward_slopes,
            _ => size,
        }
    }

    /// Nanoseconds of one state.
    fn bench(&mut self, algorithm: &str, milliseconds: f64) -> Result<f64, Box<dyn Error>> {
        let target = milliseconds * 1e6;
        let mut calls = 1;
        let mut time = self.time(algorithm, calls)?;
        while time < 0.2 * target {
            calls *= 2;
            time = self.time(algorithm, calls)?;
        }
        let calls = (target * calls as f64 / time) as usize + 1;
        let states = calls * self.together(algorithm);
        Ok(self.time(algorithm, calls)? / states as f64)
    }

    /// Nanoseconds of CPU time for `calls` calls over all states in turn.
    fn time(&mut self, algorithm: &str, calls: usize) -> Result<f64, Box<dyn Error>> {
        let groups = self.states.q.len() / self.together(algorithm);
        let start = cpu_time::ThreadTime::now();
        for call in 0..calls {
            self.call(algorithm, call % groups)?;
        }
        Ok(start.elapsed().as_nanos() as f64)
    }

    fn check(&mut self, algorithm: &str, k: usize) -> Result<String, Box<dyn Error>> {
        if algorithm.contains("_deriv") {
            return Ok("none".to_owned());
        }
        let states = self.together(algorithm);
        self.call(algorithm, k / states)?;
        let order = convert::order(&self.model);
        let size = order.len();
        let lane = k % states;
        let numbers: Vec<f64> = match algorithm {
            "crba" | "minverse" => {
                let pairs = order.iter().flat_map(|&i| order.iter().map(move |&j| (i, j)));
                pairs.map(|(i, j)| self.mass[i * size + j]).collect()
            }
            "crba_x8" | "minverse_x8" => {
                let matrix = &self.out_eight[lane / LANES * size * size..];
                let pairs = order.iter().flat_map(|&i| order.iter().map(move |&j| (i, j)));
                pairs.map(|(i, j)| matrix[i * size + j].0[lane % LANES]).collect()
            }
            "aba_x4" | "rnea_x4" => {
                let lanes = order.iter().map(|&i| self.out_four[i].to_array());
                lanes.map(|lanes| lanes[lane]).collect()
            }
            _ if algorithm.contains("_x8") && !algorithm.ends_with("_rows") => {
                let row = &self.out_eight[lane / LANES * size..];
                order.iter().map(|&i| row[i].0[lane % LANES]).collect()
            }
            _ => order.iter().map(|&i| self.out[lane * size + i]).collect(),
        };
        let texts: Vec<String> = numbers.iter().map(|x| format!("{x:.17e}")).collect();
        Ok(texts.join(" "))
    }
}

/// Four rows, entry by entry.
fn side_by_side(rows: &[Vec<f64>]) -> Vec<F64x4> {
    let entries = 0..rows[0].len();
    entries
        .map(|i| F64x4::new([0, 1, 2, 3].map(|lane| rows[lane][i])))
        .collect()
}

/// The numbers of group `k` of `count` rows in each of the states' vectors.
fn group<'a, T>(all: &'a [Vec<T>; 3], states: &States, k: usize, count: usize) -> [&'a [T]; 3] {
    let sizes = [&states.q, &states.v, &states.tau].map(|rows| count * rows[0].len());
    [0, 1, 2].map(|i| &all[i][k * sizes[i]..(k + 1) * sizes[i]])
}
