//! Columns of named frames and of controllers.

use super::recorded::{POSITION, Page, attitude, read_csv, read_parquet, simulate};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;

/// The frames of a page's header: which body carries each, and its pose there.
fn marks(page: &Page) -> Vec<(String, Option<usize>, [f64; 7])> {
    let marks = page.header["marks"].as_array().expect("marks").iter();
    let mark = |mark: &Value| {
        let pose: [f64; 7] =
            std::array::from_fn(|place| mark["pose"][place].as_f64().expect("a number"));
        let body = mark["body"].as_u64().map(|body| body as usize);
        (
            mark["name"].as_str().expect("a name").to_owned(),
            body,
            pose,
        )
    };
    marks.map(mark).collect()
}

#[test]
fn frames_stand_where_their_bodies_carry_them() {
    let scene = "scenes/panda7_tracking.toml";
    let files = simulate(scene, "frames", &["--t-end", "0.2", "--tol", "1e-6"]);
    let (csv, table, page) = (
        read_csv(&files.csv),
        read_parquet(&files.parquet),
        Page::read(&files.html),
    );
    let marks = marks(&page);
    assert_eq!(marks.len(), 6);
    for (name, body, [x, y, z, i, j, k, w]) in marks {
        let own = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
        for (row, _) in csv["t_s"].iter().enumerate() {
            let read = |ends: [&str; 3], of: &str| {
                Vector3::from(ends.map(|end| csv[&format!("{of}.{end}")][row]))
            };
            let (place, turned) =
                body.map_or((Vector3::zeros(), UnitQuaternion::identity()), |body| {
                    let (of, com) = (page.names()[body], &page.header["bodies"][body]["com"]);
                    let turned = attitude(&csv, of, row);
                    let com = [0, 1, 2].map(|axis| com[axis].as_f64().expect("a number"));
                    (
                        read(["x_m", "y_m", "z_m"], of) - turned * Vector3::from(com),
                        turned,
                    )
                });
            // Roundings of an arm of a metre.
            let error = attitude(&csv, &name, row).angle_to(&(turned * own));
            assert!(error < 1e-14, "{name} in row {row}: {error:e} rad");
            let error = read(["x_m", "y_m", "z_m"], &name) - place - turned * Vector3::new(x, y, z);
            assert!(
                error.amax() < 1e-14,
                "{name} in row {row}: {:e} m",
                error.amax()
            );
        }
        let column = format!("{name}.x_m");
        assert_eq!(csv[&column], table[&column]);
    }
}

/// The column of the speed with which an effort that turns does work.
fn speed_of(effort: &str) -> String {
    let speed = effort.replace(".tau.", ".v.");
    speed.replace("_N_m", "_rad_per_s")
}

/// What the efforts of a controller do is the energy that the mechanism gains.
#[test]
fn efforts_of_a_controller_do_the_work() {
    let scene = "scenes/ball_pendulum_upright.toml";
    let files = simulate(
        scene,
        "work",
        &["--t-end", "0.1", "--sample-step", "0.0001"],
    );
    let (table, csv) = (read_parquet(&files.parquet), read_csv(&files.csv));
    let freedoms: Vec<&String> = table
        .keys()
        .filter(|name| name.starts_with("pivot.tau."))
        .collect();
    assert_eq!(freedoms.len(), 3);
    let power = |row: usize| -> f64 {
        let terms = freedoms
            .iter()
            .map(|name| table[*name][row] * table[&speed_of(name)][row]);
        terms.sum()
    };
    let rows = table["t_s"].len();
    // Simpson's rule.
    let weight = |row: usize| match row {
        0 => 1.0,
        row if row + 1 == rows => 1.0,
        row => [2.0, 4.0][row % 2],
    };
    let work: f64 = (0..rows).map(|row| weight(row) * power(row)).sum::<f64>() * 0.0001 / 3.0;
    let gained = table["energy_J"][rows - 1] - table["energy_J"][0];
    // The rule misses (hλ)⁴/180 of what moves at the rate λ, of which the fastest here is the spin, 160 1/s and twice that in the power: 6e-9.
    assert!(
        (work - gained).abs() < 1e-7 * gained.abs(),
        "{work} {gained}"
    );
    for name in freedoms {
        assert_eq!(table[name], csv[name]);
    }
}

#[test]
fn efforts_that_are_held_change_with_the_period_alone() {
    let scene = "scenes/balance_mpc.toml";
    let files = simulate(scene, "held", &["--t-end", "0.4"]);
    let (csv, page) = (read_csv(&files.csv), Page::read(&files.html));
    let tau = &csv["slide_x.tau.q_N"];
    let changes: Vec<f64> = (1..tau.len())
        .filter(|&row| tau[row] != tau[row - 1])
        .map(|row| csv["t_s"][row])
        .collect();
    assert!(changes.len() >= 5, "{changes:?}");
    for time in changes {
        let periods = time / 0.04;
        assert!((periods - periods.round()).abs() < 1e-9, "{time}");
    }
    assert!(tau[0] != 0.0 && tau.iter().all(|force| force.abs() <= 8.0));
    assert!(
        csv["cardan.tau.first_N_m"]
            .iter()
            .all(|force| *force == 0.0)
    );
    let columns = page.columns();
    let column = columns
        .iter()
        .find(|found| found.0 == "Controller’s efforts τ" && found.1 == "slide_x");
    let (.., column) = column.expect("a plot of efforts");
    for frame in 0..page.frames() {
        let row = csv["t_s"].iter().position(|t| *t == page.time(frame));
        let wanted = tau[row.expect("a sample")];
        assert!((page.column(*column, frame) - wanted).abs() <= POSITION * wanted.abs());
    }
}
