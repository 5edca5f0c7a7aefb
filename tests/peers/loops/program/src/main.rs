//! Hamel as one of the programs that `tests/peers/loops` compares: reads commands on standard input, answers one line each. With `--compiled`, the equations are those
//! that the build script has compiled; else those of the tree.
//!
//! ```text
//! info                -> free text
//! load FOLDER NAME    -> ok fd   or   skip REASON
//! bench fd MIN_MS     -> nanoseconds a call, over all states in turn for at least MIN_MS
//! check fd K          -> v̇ of state K
//! quit
//! ```

#[allow(dead_code, reason = "not all of every module is called")]
mod compiled {
    include!(concat!(env!("OUT_DIR"), "/scenes.rs"));
}

/// Joints that the library does not have.
#[allow(dead_code, unused_imports, reason = "they are found by name")]
mod joints {
    include!(concat!(env!("OUT_DIR"), "/joints.rs"));
}

use cpu_time::ThreadTime;
use hamel::compiled::{Compiled, Equations};
use hamel::dynamics::{Dynamics, Recursive};
use hamel_scene::Scene;
use std::error::Error;
use std::hint::black_box;
use std::io::{BufRead, Write};
use std::sync::Arc;

type Answer = Result<String, Box<dyn Error>>;

/// What is called for v̇.
enum Way {
    Tree(Box<Recursive>),
    Compiled(&'static Equations),
}

/// One mechanism with its states.
struct Loaded {
    way: Way,
    states: Vec<[Vec<f64>; 3]>,
    rates: Vec<f64>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let is_compiled = std::env::args().any(|word| word == "--compiled");
    let mut loaded: Option<Loaded> = None;
    let mut output = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let words: Vec<&str> = line.split_whitespace().collect();
        if words == ["quit"] {
            break;
        }
        let answer = answer(&words, is_compiled, &mut loaded);
        let answer = answer.unwrap_or_else(|error| format!("skip {error}"));
        writeln!(output, "{}", answer.replace('\n', " "))?;
        output.flush()?;
    }
    Ok(())
}

fn answer(words: &[&str], is_compiled: bool, loaded: &mut Option<Loaded>) -> Answer {
    match (words, loaded) {
        (["info"], _) => Ok(info(is_compiled)),
        (["load", folder, name], loaded) => {
            *loaded = Some(Loaded::read(folder, name, is_compiled)?);
            Ok("ok fd".into())
        }
        (["bench", "fd", least], Some(loaded)) => {
            Ok(format!("{:.4}", loaded.bench(least.parse()?)?))
        }
        (["check", "fd", k], Some(loaded)) => {
            loaded.call(k.parse()?)?;
            let rates = loaded.rates.iter().map(|rate| format!("{rate:.17e}"));
            Ok(rates.collect::<Vec<_>>().join(" "))
        }
        _ => Err("unknown command, or nothing loaded".into()),
    }
}

fn info(is_compiled: bool) -> String {
    let equations = match is_compiled {
        true => "compiled scenes",
        false => "interpreted tree",
    };
    format!("hamel {}, {equations}", env!("CARGO_PKG_VERSION"))
}

impl Loaded {
    fn read(folder: &str, name: &str, is_compiled: bool) -> Result<Self, Box<dyn Error>> {
        let mut registry = hamel_joints::registry();
        registry.extend(joints::ENTRIES.iter().copied())?;
        let path = format!("{folder}/{name}.toml");
        let scene = Scene::load(&path, &registry)?;
        let layout = *scene.mechanism.layout();
        let bytes = std::fs::read(format!("{folder}/{name}.ours.bin"))?;
        let numbers = bytes.chunks_exact(8);
        let numbers: Vec<f64> = numbers
            .map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap_or_default()))
            .collect();
        let sizes = [layout.configuration, layout.speeds, layout.freedoms];
        let rows = numbers.chunks_exact(sizes.iter().sum());
        if !rows.remainder().is_empty() {
            return Err(format!("{name}: its states do not have {sizes:?} numbers").into());
        }
        let states = rows.map(|row| {
            let (q, rest) = row.split_at(sizes[0]);
            let (v, tau) = rest.split_at(sizes[1]);
            [q, v, tau].map(<[f64]>::to_vec)
        });
        let way = match is_compiled {
            true => {
                let equations = compiled::find(name)?;
                // Its sizes are those of the scene.
                Compiled::new(Arc::clone(&scene.mechanism), equations)?;
                Way::Compiled(equations)
            }
            false => Way::Tree(Box::new(Recursive::new(Arc::clone(&scene.mechanism)))),
        };
        Ok(Self {
            way,
            states: states.collect(),
            rates: vec![0.0; layout.speeds],
        })
    }

    fn call(&mut self, k: usize) -> Result<(), Box<dyn Error>> {
        let [q, v, tau] = &self.states[k];
        match &mut self.way {
            Way::Tree(dynamics) => dynamics.forward_dynamics(q, v, tau, &mut self.rates)?,
            Way::Compiled(equations) => {
                let run = equations
                    .forward_dynamics
                    .ok_or("it has no forward dynamics")?;
                run(q, v, tau, &mut self.rates);
            }
        }
        black_box(&self.rates);
        Ok(())
    }

    fn bench(&mut self, milliseconds: f64) -> Result<f64, Box<dyn Error>> {
        let target = milliseconds * 1e6;
        let mut calls = 1;
        let mut time = self.time(calls)?;
        while time < 0.2 * target {
            calls *= 2;
            time = self.time(calls)?;
        }
        let calls = (target * calls as f64 / time) as usize + 1;
        Ok(self.time(calls)? / calls as f64)
    }

    /// Nanoseconds of CPU time for `calls` calls over all states in turn.
    fn time(&mut self, calls: usize) -> Result<f64, Box<dyn Error>> {
        let count = self.states.len();
        let start = ThreadTime::now();
        for call in 0..calls {
            self.call(call % count)?;
        }
        Ok(start.elapsed().as_nanos() as f64)
    }
}
