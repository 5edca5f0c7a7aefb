//! One reference: the motion in extended precision, what it is known to, and what it magnifies.

use super::frequency;
use super::nudge::nudged;
use hamel_scene::{Scene, SceneDescription, SpringEnergy};
use hamel_tests::newton::closed::Closed;
use hamel_tests::newton::{Extrapolation, Real, Record, World, decimal, distance};
use std::fmt::Write;
use std::path::Path;

/// What the figures are from.
const MAIN: Extrapolation = Extrapolation {
    columns: 10,
    tolerance: 1e-26,
};
/// What they are compared with.
const CHECK: Extrapolation = Extrapolation {
    columns: 8,
    tolerance: 1e-25,
};
/// Part by which initial velocities are changed to see what a motion magnifies: all alike…
const CHANGE: f64 = 1e-12;
/// …and in directions aside, by a part of the length of their vector that doubles can tell.
const NUDGE: f64 = 1e-10;
const DIRECTIONS: u32 = 2;
/// Energies below this part of a stiffness are not told.
const RESOLVED: f64 = 1e-6;
/// A reference must be known to this, in floors.
const KNOWN: f64 = 1e-3;

/// A reference, and what is told of it.
pub struct Made {
    pub text: String,
    pub summary: String,
}

struct Motion {
    source: String,
    names: Vec<String>,
    samples: Vec<Record>,
    energy: Option<Real>,
    conditioning: f64,
    crosscheck: f64,
    frequency: f64,
}

/// The reference of a scene.
pub fn reference(path: &Path) -> Result<Made, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let description =
        Scene::from_toml(&text, &path.to_string_lossy()).map_err(|errors| errors.to_string())?;
    let motion = match Closed::new(&description) {
        Ok(closed) => by_closed_form(&description, &closed),
        Err(_) => by_integration(&description)?,
    };
    let end = motion.samples.last().map_or(0.0, |sample| sample.time);
    let floor = motion.conditioning.max(motion.frequency * end).max(1.0) * 0.5 * f64::EPSILON;
    if motion.crosscheck > KNOWN * floor {
        return Err(format!(
            "{}: two orders differ by {:e}, the floor is {floor:e}",
            description.name, motion.crosscheck
        ));
    }
    Ok(Made {
        summary: format!(
            "conditioning {:.1e}, frequency {:.1e} rad/s, floor {floor:.1e}, crosscheck {:.1e}",
            motion.conditioning, motion.frequency, motion.crosscheck
        ),
        text: json(&motion),
    })
}

/// Sample times: multiples of the scene's step, from 0 to its end.
fn times(scene: &SceneDescription) -> Vec<f64> {
    let settings = &scene.settings;
    let count = (settings.t_end / settings.sample_step).round() as usize;
    let time = |i: usize| match i == count {
        true => settings.t_end,
        false => i as f64 * settings.sample_step,
    };
    (0..=count).map(time).collect()
}

fn by_closed_form(scene: &SceneDescription, closed: &Closed) -> Motion {
    let times = times(scene);
    let motion = |faster: f64| -> Vec<Record> {
        times
            .iter()
            .map(|&time| closed.record(time, faster))
            .collect()
    };
    let (samples, faster) = (motion(0.0), motion(CHANGE));
    Motion {
        source: "closed form in 256 bits".into(),
        names: vec![scene.bodies[0].name.value.clone()],
        conditioning: magnified(&samples, &faster, CHANGE),
        energy: closed.energy(),
        samples,
        crosscheck: 0.0,
        frequency: closed.frequency,
    }
}

fn by_integration(scene: &SceneDescription) -> Result<Motion, String> {
    let world = World::new(scene).map_err(|error| error.0)?;
    let times = times(scene);
    let motion = |start: Vec<Real>, method: &Extrapolation| {
        motion(&world, start, method, &times)
            .ok_or_else(|| format!("{}: steps shrink to nothing", scene.name))
    };
    let lost = rounding(scene);
    let [main, check] = [MAIN, CHECK].map(|method| Extrapolation {
        tolerance: method.tolerance * lost,
        ..method
    });
    let samples = motion(world.state.clone(), &main)?;
    let other = motion(world.state.clone(), &check)?;
    let faster = motion(world.faster(CHANGE), &check)?;
    let mut conditioning = magnified(&other, &faster, CHANGE);
    for number in 0..DIRECTIONS {
        let aside = World::new(&nudged(scene, NUDGE, number)).map_err(|error| error.0)?;
        let moved = motion(aside.state, &check)?;
        conditioning = conditioning.max(magnified(&other, &moved, NUDGE));
    }
    let pairs = samples.iter().zip(&other);
    Ok(Motion {
        source: "Newton's and Euler's equations of free bodies with multipliers, in double-double numbers, by extrapolated midpoint steps of \
                 order 20, against order 16"
            .into(),
        conditioning,
        crosscheck: pairs.map(|(a, b)| distance(a, b)).fold(0.0, f64::max),
        energy: energy(scene, &world),
        frequency: frequency::highest(scene)?,
        names: world.names.clone(),
        samples,
    })
}

/// What multipliers lose of their digits where a heavy body hangs on a light one: the square root of the largest ratio, a mean of what accelerations
/// of the one and of the other lose.
fn rounding(scene: &SceneDescription) -> f64 {
    let ratios = scene.bodies.iter().filter_map(|body| {
        let parent = &scene.bodies[body.parent?];
        Some(body.mass.mass / parent.mass.mass)
    });
    ratios.fold(1.0, f64::max).sqrt()
}

fn motion(
    world: &World,
    mut state: Vec<Real>,
    method: &Extrapolation,
    times: &[f64],
) -> Option<Vec<Record>> {
    let rates = |state: &[Real], rates: &mut [Real]| world.system.rates(state, rates);
    let mut samples = vec![world.record(0.0, &state)];
    for pair in times.windows(2) {
        method.advance(&rates, &mut state, pair[0], pair[1])?;
        samples.push(world.record(pair[1], &state));
    }
    Some(samples)
}

/// Change of the final state per unit change of the initial velocities.
fn magnified(samples: &[Record], changed: &[Record], change: f64) -> f64 {
    let ends = samples.last().zip(changed.last());
    ends.map_or(0.0, |(a, b)| distance(b, a) / change)
}

/// The energy, where it stays.
fn energy(scene: &SceneDescription, world: &World) -> Option<Real> {
    let kept = scene.bodies.iter().all(|body| {
        let forces = &body.forces;
        forces.damping.is_none() && forces.effort.is_none() && forces.motion.is_none()
    });
    let (kinetic, potential) = world.energies(&world.state);
    let energy = kinetic + potential;
    // Doubles round the energy of a spring by its stiffness: next to its rest they cannot tell it.
    let told = f64::from(energy).abs() > RESOLVED * stiffest(scene);
    (kept && told).then_some(energy)
}

/// The largest stiffness of a spring at a ball joint, N m/rad; 0 without springs.
fn stiffest(scene: &SceneDescription) -> f64 {
    let springs = scene
        .bodies
        .iter()
        .filter_map(|body| body.forces.spring.as_ref());
    let stiffnesses = springs.map(|spring| match spring.value.energy {
        SpringEnergy::Trace(stiffness) => stiffness,
        _ => 0.0,
    });
    stiffnesses.fold(0.0, f64::max)
}

fn json(motion: &Motion) -> String {
    let mut text = String::from("{\n");
    let names: Vec<String> = motion
        .names
        .iter()
        .map(|name| format!("{name:?}"))
        .collect();
    let energy = motion.energy.map_or("null".into(), decimal);
    let samples: Vec<String> = motion.samples.iter().map(Record::json).collect();
    let lines = [
        ("source", format!("{:?}", motion.source)),
        (
            "units",
            "\"SI; rotation from body to world, row by row; velocities of the centres of mass in world axes, angular velocities in body axes\"".into(),
        ),
        ("total_energy", energy),
        ("conditioning", format!("{:e}", motion.conditioning)),
        ("frequency", format!("{:e}", motion.frequency)),
        ("crosscheck", format!("{:e}", motion.crosscheck)),
        ("bodies", format!("[{}]", names.join(", "))),
    ];
    for (key, value) in lines {
        // Writing to a string does not fail.
        let _ = writeln!(text, "  \"{key}\": {value},");
    }
    let _ = writeln!(text, "  \"samples\": [\n{}\n  ]\n}}", samples.join(",\n"));
    text
}
