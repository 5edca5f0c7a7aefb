//! `hamel sweep`: what rows give, what stops it, and what it refuses.

#[path = "../common/mod.rs"]
mod common;
mod equations;
#[path = "../files/place.rs"]
#[allow(dead_code, reason = "some of it is for other tests")]
mod place;
mod refused;
mod results;
mod samples;
#[cfg(unix)]
mod stopped;
mod tables;

use place::Place;

/// A pendulum on a damper, stopped where it passes the bottom.
const PENDULUM: &str = r#"hamel = 1
name = "pendulum"
gravity = [0.0, 0.0, -9.81]

[[body]]
name = "arm"
parent = "world"
mass = 1.5
inertia = [[0.01, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.02]]
joint = { type = "revolute", name = "pivot" }
at = { axis = [0.0, 1.0, 0.0] }
body_at = { position = [0.4, 0.0, 0.0] }
initial = { configuration = [0.2], speeds = [0] }
damping = 0.1

[[event]]
name = "bottom"
joint = "pivot"
coordinate = "q"
value = 1.5707963267948966
then = "stop"

[simulation]
t_end = 0.3
tol = 1e-9
"#;

/// A folder with `pendulum.toml` and `table.csv`, which has so many rows.
fn pendulums(rows: usize) -> Place {
    let place = Place::new();
    place.write("pendulum.toml", PENDULUM);
    let mut table = String::from("body.arm.mass,body.arm.initial.speeds.1,body.arm.damping\n");
    for row in 0..rows {
        // Evenly, in no order.
        let part = |step: f64| (row as f64 * step).fract();
        let (mass, speed) = (0.5 + part(2_f64.sqrt()), 8.0 * part(3_f64.sqrt()) - 2.0);
        table += &format!("{mass},{speed},{}\n", 0.2 * part(5_f64.sqrt()));
    }
    place.write("table.csv", &table);
    place
}

/// The rows of all parts of a folder, without the header of each.
fn rows(place: &Place, folder: &str) -> Vec<String> {
    let mut parts: Vec<_> = std::fs::read_dir(place.path(folder))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().into_string())
        .map(|name| name.expect("text"))
        .filter(|name| name.starts_with("part-"))
        .collect();
    parts.sort();
    let read = |name: &String| String::from_utf8(place.read(&format!("{folder}/{name}")));
    let texts = parts.iter().map(|name| read(name).expect("text"));
    let rows = texts.flat_map(|text| text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>());
    rows.collect()
}
