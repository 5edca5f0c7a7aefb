//! The makers of references against the references of 24 digits that others made: one set of equations vouches for the other.

use hamel_scene::{Scene, SceneDescription};
use hamel_tests::newton::{Extrapolation, Real, Record, World};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Digits of a reference after its first: numbers are given with 24, and attitudes near ±1 with one less behind the point.
const GIVEN: f64 = 1e-22;

const METHOD: Extrapolation = Extrapolation {
    columns: 9,
    tolerance: 1e-25,
};

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")
}

fn description(name: &str) -> SceneDescription {
    let file = format!("{name}.toml");
    let own = scenes().join("report").join(&file);
    let path = if own.exists() {
        own
    } else {
        scenes().join(&file)
    };
    let text = fs::read_to_string(&path).expect("a scene");
    Scene::from_toml(&text, &file).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A decimal number as the sum of two doubles.
fn real(text: &str) -> Real {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let mut exponent: i32 = exponent.parse().expect("an exponent");
    let mut value = Real::from(0.0);
    let mut behind = false;
    for c in mantissa.chars() {
        match c.to_digit(10) {
            Some(digit) => {
                value = value * Real::from(10.0) + Real::from(f64::from(digit));
                exponent -= i32::from(behind);
            }
            None => behind |= c == '.',
        }
    }
    let mut scale = Real::from(1.0);
    (0..exponent.unsigned_abs()).for_each(|_| scale *= Real::from(10.0));
    let size = if exponent < 0 {
        value / scale
    } else {
        value * scale
    };
    if mantissa.starts_with('-') {
        -size
    } else {
        size
    }
}

/// The lists that stand under a key in a text of JSON, in their order, with all their digits.
fn lists(text: &str, key: &str) -> Vec<Vec<Real>> {
    let opening = format!("\"{key}\": [");
    let after = text.split(&opening).skip(1);
    let inside = after.map(|rest| rest.split(']').next().expect("an end"));
    let lists = inside.map(|list| list.split(',').map(|number| real(number.trim())).collect());
    lists.collect()
}

/// The largest difference, relative to max(1, size).
fn gap(found: &[Real], expected: &[Real]) -> f64 {
    let size = expected
        .iter()
        .map(|&x| f64::from(x).abs())
        .fold(1.0, f64::max);
    let gaps = found
        .iter()
        .zip(expected)
        .map(|(&a, &b)| f64::from(a - b).abs() / size);
    gaps.fold(0.0, |m, x| if x <= m { m } else { x })
}

fn motion(world: &World, times: &[f64]) -> Vec<Record> {
    let rates = |state: &[Real], rates: &mut [Real]| world.system.rates(state, rates);
    let mut state = world.state.clone();
    let mut now = 0.0;
    let samples = times.iter().map(|&time| {
        if time > now {
            METHOD
                .advance(&rates, &mut state, now, time)
                .expect("steps stay large");
            now = time;
        }
        world.record(time, &state)
    });
    samples.collect()
}

/// What initial states of a scene and of its reference differ by, since each rounds where the other does not; the motion magnifies it.
fn check(name: &str) {
    let text =
        fs::read_to_string(scenes().join(format!("report/{name}.json"))).expect("a reference");
    let reference: Value = serde_json::from_str(&text).expect("JSON");
    let samples = reference["samples"].as_array().expect("samples");
    let times: Vec<f64> = samples
        .iter()
        .map(|sample| sample["t"].as_f64().expect("a time"))
        .collect();
    let world = World::new(&description(name)).unwrap_or_else(|error| panic!("{error:?}"));
    let keys = [
        "rotation_body_to_world_rowmajor",
        "position_com",
        "velocity_com_world",
        "angular_velocity_body",
    ];
    let expected = keys.map(|key| lists(&text, key));
    let bodies = reference["bodies"].as_array().expect("names").len();
    let mut start = 0.0;
    let mut end = 0.0;
    for (i, record) in motion(&world, &times).iter().enumerate() {
        for (j, body) in record.bodies.iter().enumerate() {
            let place = bodies * i + j;
            let found: [Vec<Real>; 4] = [
                body.rotation.transpose().iter().copied().collect(),
                body.position.iter().copied().collect(),
                body.velocity.iter().copied().collect(),
                body.rate.iter().copied().collect(),
            ];
            let gaps = found.iter().zip(&expected).map(|(a, b)| gap(a, &b[place]));
            let worst = gaps.fold(0.0, f64::max);
            match i {
                0 => start = worst.max(start),
                _ => end = worst.max(end),
            }
        }
    }
    let conditioning = reference["conditioning"]
        .as_f64()
        .expect("a number")
        .max(1.0);
    println!("{name}: {start:.1e} at the start, {end:.1e} later, conditioning {conditioning:.1e}");
    // Differences of the start, and of the last digits given, grow by the conditioning, which is a lower bound of what can grow.
    let allowed = 100.0 * conditioning * (start + GIVEN);
    assert!(end <= allowed, "{name}: {end:e} exceeds {allowed:e}");
    // A scene rounds its attitude to doubles, no more.
    assert!(
        start <= 4.0 * f64::EPSILON,
        "{name}: {start:e} at the start"
    );
}

#[test]
fn free_bodies_with_multipliers_move_as_references_of_24_digits_say() {
    [
        "gimbal_top",
        "chaplygin_sleigh",
        "rolling_disk",
        "double_ball_pendulum",
    ]
    .into_iter()
    .for_each(check);
}

#[test]
#[ignore = "minutes of extended precision"]
fn the_longer_references_as_well() {
    [
        "heavy_top",
        "torque_free_top",
        "ball_on_turntable",
        "plate_cart_arm_level",
        "ball_spring",
    ]
    .into_iter()
    .for_each(check);
}
