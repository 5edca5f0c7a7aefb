//! What rows give.

use super::{PENDULUM, pendulums, rows};
use serde_json::Value;

/// Rows are the scene with their numbers: what `simulate` makes of it, bit for bit.
#[test]
fn a_row_moves_as_its_scene() {
    let place = pendulums(40);
    place.done("sweep pendulum.toml --over table.csv -o out --no-error-estimate --quiet");
    let results = rows(&place, "out");
    assert_eq!(results.len(), 40);
    for row in [1, 7, 40] {
        let words = format!("sweep pendulum.toml --over table.csv --scene-of {row}");
        let scene = place.run(&words);
        assert!(scene.status.success());
        place.write("row.toml", &String::from_utf8_lossy(&scene.stdout));
        // Samples on the way would shorten steps.
        let words = "simulate row.toml --at 0.3 --json --no-error-estimate --csv row.csv --force";
        let single = place.run(words);
        let told: Vec<&str> = results[row - 1].split(',').collect();
        let json: Value = serde_json::from_slice(&single.stdout).expect("JSON");
        if json["samples"] == Value::Array(Vec::new()) {
            let event = &json["events"][0];
            let time = event["t"].as_f64().expect("a time");
            assert_eq!(told[1..3], ["event bottom", &format!("{time:?}")]);
            continue;
        }
        let text = String::from_utf8(place.read("row.csv")).expect("text");
        let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let (names, last) = (lines.next().expect("names"), lines.next().expect("numbers"));
        let of = |name: &str| last[names.iter().position(|known| *known == name).expect(name)];
        assert_eq!(told[1], "ended");
        let wanted = ["t_s", "energy_J", "kinetic_energy_J", "potential_energy_J"];
        assert_eq!(told[2..6], wanted.map(of));
        assert_eq!(told[7..], ["pivot.q.q_rad", "pivot.v.q_rad_per_s"].map(of));
    }
}

/// Negative ones among them, as spreadsheets and pandas take them.
#[test]
fn the_summary_holds_numbers() {
    let place = pendulums(40);
    place.done("sweep pendulum.toml --over table.csv -o out --no-error-estimate --quiet");
    let summary = String::from_utf8(place.read("out/summary.csv")).expect("text");
    let cells = summary
        .lines()
        .skip(1)
        .flat_map(|line| line.split(',').skip(1));
    let numbers: Vec<f64> = cells.map(|cell| cell.parse().expect(cell)).collect();
    assert!(numbers.iter().any(|number| *number < 0.0));
}

#[test]
fn bits_do_not_depend_on_workers_and_blocks() {
    let place = pendulums(100);
    let mut all = Vec::new();
    for (out, options) in [
        ("a", "--workers 1 --block 100"),
        ("b", "--workers 5 --block 7"),
        ("c", "--workers 2"),
    ] {
        place.done(&format!(
            "sweep pendulum.toml --over table.csv -o {out} --quiet {options}"
        ));
        all.push(rows(&place, out));
        assert_eq!(
            place.read(&format!("{out}/summary.csv")),
            place.read("a/summary.csv")
        );
    }
    assert_eq!(all[0].len(), 100);
    assert_eq!(all[0], all[1]);
    assert_eq!(all[0], all[2]);
    let ended = |row: &&String| row.contains(",event bottom,");
    let count = all[0].iter().filter(ended).count();
    assert!(count > 10 && count < 90, "{count}");
}

/// What a row does wrong is its own.
#[test]
fn rows_fail_alone_and_for_a_cause() {
    let place = pendulums(0);
    place.write(
        "table.csv",
        "body.arm.mass, simulation.tol ,body.arm.initial.configuration.1\n\
         1,1e-8,0.1\n\
         -1,1e-8,0.1\n\
         heavy,1e-8,0.1\n\
         1,,0.1\n\
         1,1e-8\n\
         inf,1e-8,0.1\n\
         1,5,0.1\n\
         -2.5,1e-8,0.1\n\
         1,1e-8,1.6\n",
    );
    let output = place.run("sweep pendulum.toml --over table.csv -o out --json");
    assert!(output.status.success());
    let told: Vec<String> = rows(&place, "out");
    let outcome = |row: &String| {
        let mut reader = csv::ReaderBuilder::new();
        let mut reader = reader.has_headers(false).from_reader(row.as_bytes());
        let record = reader.records().next().expect("a row").expect("cells");
        record[1].to_owned()
    };
    let told: Vec<String> = told.iter().map(outcome).collect();
    assert_eq!(
        told,
        [
            "ended",
            "failed: body `arm`: mass is -1 kg: it must be at least 0 (column `body.arm.mass`)",
            "failed: column `body.arm.mass`: the cell `heavy` is no number",
            "failed: column `simulation.tol`: the cell is empty",
            "failed: the row has 2 cells, and the table 3 columns",
            "failed: body `arm`: `mass` is inf, not a finite number (column `body.arm.mass`)",
            "failed: `simulation.tol` is 5.0, but must be between 1e-16 and 0.1 (column `simulation.tol`)",
            "failed: body `arm`: mass is -2.5 kg: it must be at least 0 (column `body.arm.mass`)",
            "ended",
        ]
    );
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((&json["rows"], &json["ended"]), (&9.into(), &2.into()));
    let most = &json["failures"][0];
    assert_eq!((&most["count"], &most["row"]), (&2.into(), &2.into()));
    let names = json["columns"].as_array().expect("columns").iter();
    let time = names.map(|own| &own["name"]).position(|name| name == "t_s");
    assert_eq!(json["columns"][time.expect("time")]["count"], 2);
    let text = String::from_utf8(place.read("out/failures.csv")).expect("text");
    assert!(text.starts_with("cause,count,row\nbody `arm`: mass is -1 kg"));
    let page = String::from_utf8(place.read("out/summary.html")).expect("text");
    assert!(page.contains("<figcaption>pivot.q.q_rad</figcaption><svg") || page.contains("<svg"));
}

/// A whole number of the file stays one where it is one, and the text of the file is not touched elsewhere.
#[test]
fn the_scene_of_a_row_is_the_file_with_its_numbers() {
    let place = pendulums(0);
    place.write(
        "table.csv",
        "body.1.initial.speeds.1,gravity.3\n-3,1.25\n0.1,-0.0\n",
    );
    for (row, speed, gravity) in [(1, "-3", "1.25"), (2, "0.1", "-0.0")] {
        let words = format!("sweep pendulum.toml --over table.csv --scene-of {row}");
        let wanted = PENDULUM.replace("speeds = [0]", &format!("speeds = [{speed}]"));
        let wanted = wanted.replace("-9.81", gravity);
        let found = place.run(&words).stdout;
        assert_eq!(String::from_utf8_lossy(&found), wanted);
    }
}

/// A robot has the columns of the scene that `import` makes of it.
#[test]
fn robots_have_the_columns_of_their_scenes() {
    let place = pendulums(0);
    place.write("table.csv", "body.panda_link1.mass\n2.5\n3.0\n");
    place.done("sweep panda.urdf --over table.csv -o out --quiet --no-error-estimate");
    let results = rows(&place, "out");
    assert!(results.iter().all(|row| row.contains(",ended,1.0,")));
    assert_ne!(results[0], results[1]);
}

/// The example of the help and the pages.
#[test]
fn the_arm_with_tolerances_moves_in_all_rows() {
    let place = pendulums(0);
    place.take("scenes/sweep/arm.toml", "arm.toml");
    place.take("scenes/sweep/tolerances.csv", "tolerances.csv");
    let output = place.run("sweep arm.toml --over tolerances.csv -o arm --no-error-estimate");
    let told = String::from_utf8(output.stdout).expect("text");
    let first = "rows      200: 190 ended, 10 at the event table, 0 failed\n";
    assert!(told.starts_with(first), "{told}");
}

/// A folder has one level of instructions, and tells it.
#[test]
#[cfg(all(target_os = "linux", target_env = "gnu", target_arch = "x86_64"))]
fn the_level_of_instructions_is_fixed() {
    let place = pendulums(20);
    let sweep = |out: &str, level: &str| {
        place.run(&format!(
            "sweep pendulum.toml --over table.csv -o {out} --no-error-estimate --quiet {level}"
        ))
    };
    let level_of = |out: &str| -> String {
        let manifest = place.read(&format!("{out}/sweep.json"));
        let manifest: Value = serde_json::from_slice(&manifest).expect("JSON");
        manifest["level"].as_str().expect("a level").to_owned()
    };
    assert!(sweep("lowest", "--level x86-64").status.success());
    assert_eq!(level_of("lowest"), "x86-64");
    assert!(sweep("own", "").status.success());
    let own = level_of("own");
    let again = sweep("lowest", "");
    if own == "x86-64" {
        assert!(again.status.success());
        return;
    }
    assert_eq!(own, "x86-64-v3");
    assert_eq!(again.status.code(), Some(2));
    let told = String::from_utf8_lossy(&again.stderr);
    let difference = "the level of instructions was x86-64, and is x86-64-v3\n";
    assert!(told.contains(difference), "{told}");
    // At the level it had, the same command goes on.
    assert!(sweep("lowest", "--level x86-64").status.success());
}
