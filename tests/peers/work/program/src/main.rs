//! Hamel as one of the programs whose motions `tests/peers/work` measures: reads commands on standard input, answers one line each. With `--compiled`, the
//! equations are those that the build script has compiled; else those of the tree.
//!
//! ```text
//! info                               -> free text
//! load SCENE.toml                    -> ok body METHOD:tol ...      or   skip REASON
//! run METHOD TOL T_END REPS MAX_S    -> ok SECONDS_LEAST SECONDS_MEDIAN REPETITIONS EVALUATIONS STEPS, then 18 numbers a body,   or   fail REASON
//! quit
//! ```
//!
//! The numbers of a body: position of its centre of mass, rotation to world by rows, velocity of the centre of mass, world axes, and angular velocity
//! in its own axes. Times are CPU times of this thread, of the integration alone.

#[allow(dead_code, reason = "not all of every module is called")]
mod compiled {
    include!(concat!(env!("OUT_DIR"), "/scenes.rs"));
}

use cpu_time::ThreadTime;
use hamel::compiled::{Compiled, Equations};
use hamel::dynamics::Dynamics;
use hamel::integrate::{
    Choice, Form, Integration, Method, Options, Sampling, Scheme, Solution, Wanted,
};
use hamel_scene::Scene;
use std::error::Error;
use std::io::{BufRead, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

/// What is measured: the choice that the library makes, and methods that a user might name.
const METHODS: [&str; 6] = [
    "auto",
    "dopri5",
    "dop853",
    "verner9",
    "radau5",
    "exponential",
];

type Answer = Result<String, Box<dyn Error>>;

/// A scene, and its equations where they are those that were compiled.
struct Loaded {
    scene: Scene,
    equations: Option<&'static Equations>,
}

impl Loaded {
    fn dynamics(&self) -> Result<Box<dyn Dynamics>, Box<dyn Error>> {
        let mechanism = Arc::clone(&self.scene.mechanism);
        Ok(match self.equations {
            Some(equations) => Box::new(Compiled::new(mechanism, equations)?),
            None => self.scene.settings.arithmetic.dynamics(&mechanism),
        })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let is_compiled = std::env::args().any(|word| word == "--compiled");
    let mut loaded: Option<Loaded> = None;
    let mut output = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let (answer, refusal) = match (words.as_slice(), &loaded) {
            (["quit"], _) => break,
            (["info"], _) => (Ok(info(is_compiled)), ""),
            (["load", path], _) => (load(path, is_compiled, &mut loaded), "skip"),
            (["run", method, tol, t_end, repetitions, most], Some(loaded)) => {
                let figures = [tol, t_end, repetitions, most].map(|text| text.parse());
                (run(loaded, method, figures), "fail")
            }
            _ => (Err(format!("no such command: {line}").into()), "fail"),
        };
        let answer = answer.unwrap_or_else(|error| format!("{refusal} {error}"));
        writeln!(output, "{}", answer.replace('\n', " "))?;
        output.flush()?;
    }
    Ok(())
}

fn info(is_compiled: bool) -> String {
    let equations = if is_compiled {
        "compiled scenes"
    } else {
        "interpreted tree"
    };
    format!("hamel {}, {equations}", env!("CARGO_PKG_VERSION"))
}

fn load(path: &str, is_compiled: bool, loaded: &mut Option<Loaded>) -> Answer {
    let stem = Path::new(path).file_stem().unwrap_or_default();
    let equations = match is_compiled {
        true => Some(compiled::find(&stem.to_string_lossy()).ok_or("not compiled")?),
        false => None,
    };
    let scene = Scene::load(path, &hamel_joints::registry())?;
    *loaded = Some(Loaded { scene, equations });
    let ways = METHODS.map(|method| format!("{method}:tol"));
    Ok(format!("ok body {}", ways.join(" ")))
}

fn run(
    loaded: &Loaded,
    method: &str,
    figures: [Result<f64, std::num::ParseFloatError>; 4],
) -> Answer {
    let [tolerance, t_end, repetitions, most] = figures;
    let scene = &loaded.scene;
    let (tolerance, t_end, repetitions, most) = (tolerance?, t_end?, repetitions?, most?);
    let method = Method::controlled(scheme(scene, method, tolerance, t_end)?, tolerance);
    let options = Options {
        form: Form::Lagrangian,
        method,
        t_end,
        samples: Vec::new(),
    };
    let (mut seconds, mut spent) = (Vec::new(), 0.0);
    let mut last = None;
    while seconds.len() < repetitions as usize && (seconds.is_empty() || spent < most) {
        let (solution, taken) = once(loaded, &options, most)?;
        if solution.stopped {
            return Ok("fail takes longer".into());
        }
        seconds.push(taken);
        spent += taken;
        last = Some(solution);
    }
    let solution = last.ok_or("no repetitions")?;
    seconds.sort_by(f64::total_cmp);
    let statistics = &solution.statistics;
    let figures = format!(
        "ok {} {} {} {} {}",
        seconds[0],
        seconds[seconds.len() / 2],
        seconds.len(),
        statistics.evaluations,
        statistics.steps
    );
    Ok(figures + &bodies(scene, &solution)?)
}

fn scheme(scene: &Scene, name: &str, tolerance: f64, span: f64) -> Result<Scheme, Box<dyn Error>> {
    if name != "auto" {
        return Scheme::named(name).ok_or_else(|| format!("no method {name}").into());
    }
    let wanted = Wanted {
        tolerance,
        span,
        is_bound: false,
    };
    Ok(Choice::new(&scene.mechanism, &scene.start(), wanted)?.scheme)
}

/// One integration, and its time, s.
fn once(loaded: &Loaded, options: &Options, most: f64) -> Result<(Solution, f64), Box<dyn Error>> {
    let mut dynamics = loaded.dynamics()?;
    let initial = loaded.scene.start();
    let start = ThreadTime::now();
    // A clock costs as much as a step of a small scene.
    let observer = |step: &hamel::integrate::Step<'_>| match step.number % 64 == 63
        && start.elapsed().as_secs_f64() > most
    {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let solution = Integration::new(dynamics.as_mut(), &initial, options)
        .sampling(Sampling::Landing)
        .observer(observer)
        .run()?;
    Ok((solution, start.elapsed().as_secs_f64()))
}

fn bodies(scene: &Scene, solution: &Solution) -> Answer {
    let state = &solution.state;
    let found = scene
        .mechanism
        .kinematics(&state.configuration, &state.speeds)?;
    let numbers = found.bodies.iter().flat_map(|body| {
        let rotation = body.pose.rotation.transpose();
        let mut numbers: Vec<f64> = body.position_com.iter().copied().collect();
        numbers.extend(rotation.iter());
        numbers.extend(body.velocity_com.iter());
        numbers.extend(body.angular_velocity_body().iter());
        numbers
    });
    Ok(numbers.map(|x| format!(" {x:e}")).collect())
}
