//! The files of one motion say the same: the CSV, the Parquet and the page, each read back.

mod columns;
#[path = "../common/mod.rs"]
mod common;
mod forces;
mod joints;
mod meshes;
mod pictures;
mod recorded;

use nalgebra::Vector3;
use recorded::{ATTITUDE, Columns, POSITION, Page, attitude, read_csv, read_parquet, simulate};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Compares every pose of a page with the CSV.
fn check_poses(page: &Page, csv: &Columns) {
    let times = &csv["t_s"];
    let vector = |body: &str, ends: [&str; 3], row: usize| {
        Vector3::from(ends.map(|end| csv[&format!("{body}.{end}")][row]))
    };
    for frame in 0..page.frames() {
        let time = page.time(frame);
        let row = times.iter().position(|t| *t == time).expect("a sample");
        for (body, name) in page.names().into_iter().enumerate() {
            let (position, turned) = page.pose(frame, body);
            let wanted = vector(name, ["x_m", "y_m", "z_m"], row);
            let error = (position - wanted).amax();
            // The offset of the centre of mass turns with the attitude.
            let limit = POSITION * wanted.amax().max(1.0) * 4.0;
            assert!(error <= limit, "{name} at {time} s: {error:e} m");
            let error = turned.angle_to(&attitude(csv, name, row));
            assert!(error <= ATTITUDE, "{name} at {time} s: {error:e} rad");
        }
    }
}

#[test]
fn all_files_of_a_motion_say_the_same() {
    let files = simulate(
        "scenes/plate_cart_arm.toml",
        "plate_cart_arm",
        &["--t-end", "1"],
    );
    let (csv, table) = (read_csv(&files.csv), read_parquet(&files.parquet));
    assert_eq!(csv["t_s"].len(), 101);
    assert!(csv.keys().eq(table.keys()));
    for (name, column) in &csv {
        assert_eq!(table.get(name), Some(column), "{name}");
    }
    for name in [
        "kinetic_energy_J",
        "potential_energy_J",
        "plate_axis.q.q_rad",
        "plate_axis.v.q_rad_per_s",
        "wheels.q.x_m",
        "wheels.v.forward_m_per_s",
    ] {
        assert!(csv.contains_key(name), "{name} is not among {csv:?}");
    }
    for (row, energy) in csv["energy_J"].iter().enumerate() {
        let sum = table["kinetic_energy_J"][row] + table["potential_energy_J"][row];
        assert!(
            (sum - energy).abs() <= 1e-13 * energy.abs(),
            "{sum} {energy}"
        );
    }
    check_poses(&Page::read(&files.html), &csv);
}

#[test]
fn a_page_plots_what_the_tables_hold() {
    let files = simulate("scenes/snakeboard.toml", "snakeboard", &["--t-end", "2"]);
    let (page, table) = (Page::read(&files.html), read_parquet(&files.parquet));
    check_poses(&page, &read_csv(&files.csv));
    let columns = page.columns();
    let indices: Vec<usize> = columns.iter().map(|(.., index)| *index).collect();
    assert!(indices.iter().copied().eq(0..columns.len()));
    let find = |chart: &str, variant: &str, name: &str| {
        let found = columns
            .iter()
            .find(|found| (found.0, found.1, found.2) == (chart, variant, name));
        found
            .unwrap_or_else(|| panic!("no {chart}, {variant}, {name}"))
            .3
    };
    for (column, of) in [
        (find("Energy", "", "kinetic"), "kinetic_energy_J"),
        (find("Energy", "", "total"), "energy_J"),
        (find("Coordinates from home", "front", "q"), "front.q.q_rad"),
        (find("Speeds v̄", "front", "q"), "front.v.q_rad_per_s"),
    ] {
        for frame in 0..page.frames() {
            let row = table["t_s"]
                .iter()
                .position(|t| *t == page.time(frame))
                .expect("a sample");
            let (found, wanted) = (page.column(column, frame), table[of][row]);
            assert!(
                (found - wanted).abs() <= POSITION * wanted.abs(),
                "{of}: {found} {wanted}"
            );
        }
    }
    let (longest, shortest) = (
        find("Integration steps", "", "longest"),
        find("Integration steps", "", "shortest"),
    );
    for frame in 1..page.frames() {
        let [longest, shortest] = [longest, shortest].map(|column| page.column(column, frame));
        assert!(
            0.0 < shortest && shortest <= longest && longest <= 0.1,
            "{shortest} {longest}"
        );
    }
}

#[test]
fn a_page_needs_nothing_from_elsewhere() {
    let files = simulate(
        "scenes/rolling_disk.toml",
        "rolling_disk",
        &["--t-end", "0.5"],
    );
    let page = Page::read(&files.html);
    for outside in [
        "http:",
        "https:",
        "//cdn",
        "src=",
        "href=",
        "@import",
        "url(",
        "fetch(",
        "XMLHttpRequest",
        "import(",
    ] {
        assert!(!page.text.contains(outside), "the page has {outside}");
    }
    assert!(page.text.contains("default-src 'none'"));
    assert!(!page.text.contains("{{"), "a part of the page is missing");
    assert_eq!(page.header["shapes"][0]["kind"], "cylinder");
    assert_eq!(page.header["bodies"][0]["joint_type"], "falling_disk");
}

#[test]
fn a_page_of_ten_seconds_of_a_humanoid_is_small() {
    let robot = "tests/data/urdf/g1.urdf";
    let files = simulate(robot, "g1", &["--t-end", "10", "--dt", "0.005"]);
    let size = fs::metadata(&files.html).expect("a page").len();
    let page = Page::read(&files.html);
    assert_eq!(
        (page.names().len(), page.time(page.frames() - 1)),
        (29, 10.0)
    );
    // A frame for every second of samples that are 0.01 s apart, and the last one.
    assert_eq!(page.frames(), 501);
    assert!(size < 3_000_000, "{size} bytes");
}

#[test]
fn texts_of_a_scene_cannot_break_its_page() {
    let scene = format!("{}/odd.toml", env!("CARGO_TARGET_TMPDIR"));
    let text = fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/free_body.toml"),
    );
    let odd = r#"name = "</script><b>{{script}} & more""#;
    let text = text.expect("a scene").replace("name = \"free_body\"", odd);
    fs::write(&scene, text).expect("a folder for tests");
    let page = Page::read(&simulate(&scene, "odd", &["--t-end", "0.1"]).html);
    assert_eq!(page.header["name"], "</script><b>{{script}} & more");
    assert!(
        page.text
            .contains("<title>&lt;/script&gt;&lt;b&gt;{{script}} &amp; more · Hamel</title>")
    );
    assert_eq!(page.text.matches("</script>").count(), 3);
}

#[test]
fn what_cannot_be_written_is_told() {
    for option in [
        "--html",
        "--parquet",
        "--csv",
        "--picture",
        "--png",
        "--gif",
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_hamel"))
            .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
            .args([
                "simulate",
                "scenes/free_body.toml",
                "--t-end",
                "0",
                option,
                "none/x",
            ])
            .output()
            .expect("the program starts");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{option}");
        assert!(told.contains("cannot write none/x"), "{told}");
    }
}
