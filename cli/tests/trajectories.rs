//! The files of one motion say the same: the CSV, the Parquet and the page, each read back.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use parquet::column::reader::ColumnReader;
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Positions of a page are f32: half a unit in the last place, relative to the largest coordinate.
const POSITION: f64 = 6e-8;
/// Attitudes of a page, rad: four entries of a quaternion of half the angle, each off by 3e-8 at most.
const ATTITUDE: f64 = 2e-7;

struct Files {
    csv: PathBuf,
    parquet: PathBuf,
    html: PathBuf,
}

/// Simulates a file of this repository into all formats, called after `name`.
fn simulate(file: &str, name: &str, options: &[&str]) -> Files {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = |ending: &str| {
        Path::new(env!("CARGO_TARGET_TMPDIR"))
            .join(name)
            .with_extension(ending)
    };
    let files = Files {
        csv: path("csv"),
        parquet: path("parquet"),
        html: path("html"),
    };
    let mut command = Command::new(env!("CARGO_BIN_EXE_hamel"));
    command
        .current_dir(root)
        .args(["simulate", file, "--quiet"]);
    command.arg("--csv").arg(&files.csv);
    command.arg("--parquet").arg(&files.parquet);
    command.arg("--html").arg(&files.html).args(options);
    let output = command.output().expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    files
}

type Columns = BTreeMap<String, Vec<f64>>;

fn read_csv(path: &Path) -> Columns {
    let mut reader = csv::Reader::from_path(path).expect("a CSV");
    let names = reader.headers().expect("names").clone();
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    for record in reader.records() {
        for (column, field) in columns.iter_mut().zip(&record.expect("a row")) {
            column.push(field.parse().expect("a number"));
        }
    }
    names.iter().map(String::from).zip(columns).collect()
}

fn read_parquet(path: &Path) -> Columns {
    let reader = SerializedFileReader::new(File::open(path).expect("a file")).expect("a Parquet");
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let mut columns = Columns::new();
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).expect("a group of rows");
        for (index, described) in schema.columns().iter().enumerate() {
            let ColumnReader::DoubleColumnReader(mut column) =
                group.get_column_reader(index).expect("a column")
            else {
                panic!("{} is no column of doubles", described.name());
            };
            let rows = group.metadata().num_rows() as usize;
            let values = columns.entry(described.name().to_owned()).or_default();
            column
                .read_records(rows, None, None, values)
                .expect("numbers");
        }
    }
    columns
}

/// A page taken apart.
struct Page {
    text: String,
    header: Value,
    bytes: Vec<u8>,
}

impl Page {
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).expect("a page");
        let element = |id: &str| {
            let (_, rest) = text.split_once(&format!("id=\"{id}\">")).expect(id);
            rest.split_once("</script>").expect("its end").0
        };
        let header = serde_json::from_str(element("header")).expect("JSON");
        let bytes = STANDARD.decode(element("numbers")).expect("base64");
        Self {
            header,
            bytes,
            text,
        }
    }

    fn frames(&self) -> usize {
        self.header["frames"].as_u64().expect("a number") as usize
    }

    fn names(&self) -> Vec<&str> {
        let bodies = self.header["bodies"].as_array().expect("bodies").iter();
        bodies.filter_map(|body| body["name"].as_str()).collect()
    }

    fn time(&self, frame: usize) -> f64 {
        let (numbers, _) = self.bytes.as_chunks();
        f64::from_le_bytes(numbers[frame])
    }

    fn float(&self, place: usize) -> f64 {
        let (numbers, _) = self.bytes[8 * self.frames()..].as_chunks();
        f32::from_le_bytes(numbers[place]).into()
    }

    /// The columns as the header numbers them: chart, variant, column, index.
    fn columns(&self) -> Vec<(&str, &str, &str, usize)> {
        let list = |value: &'static str, of: &'_ Value| of[value].as_array().expect(value).len();
        let mut columns = Vec::new();
        for chart in 0..list("charts", &self.header) {
            let chart = &self.header["charts"][chart];
            for variant in 0..list("variants", chart) {
                let variant = &chart["variants"][variant];
                for column in 0..list("columns", variant) {
                    let column = &variant["columns"][column];
                    let text = |value: &'_ Value| value.as_str().map_or(0, str::len);
                    assert!(text(&column["name"]) > 0);
                    columns.push((
                        chart["title"].as_str().expect("a title"),
                        variant["name"].as_str().expect("a name"),
                        column["name"].as_str().expect("a name"),
                        column["index"].as_u64().expect("a number") as usize,
                    ));
                }
            }
        }
        columns
    }

    fn column(&self, index: usize, frame: usize) -> f64 {
        self.float(index * self.frames() + frame)
    }

    /// Position of a body's centre of mass, and its attitude.
    fn pose(&self, frame: usize, body: usize) -> (Vector3<f64>, UnitQuaternion<f64>) {
        let first = self.columns().len() * self.frames();
        let at = first + 7 * (frame * self.names().len() + body);
        let [x, y, z, w, i, j, k] = std::array::from_fn(|place| self.float(at + place));
        let attitude = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
        let com = &self.header["bodies"][body]["com"];
        let com = [0, 1, 2].map(|axis| com[axis].as_f64().expect("a number"));
        (
            Vector3::new(x, y, z) + attitude * Vector3::from(com),
            attitude,
        )
    }
}

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
            let (position, attitude) = page.pose(frame, body);
            let wanted = vector(name, ["x_m", "y_m", "z_m"], row);
            let error = (position - wanted).amax();
            // The offset of the centre of mass turns with the attitude.
            let limit = POSITION * wanted.amax().max(1.0) * 4.0;
            assert!(error <= limit, "{name} at {time} s: {error:e} m");
            let wanted = vector(name, ["rx_rad", "ry_rad", "rz_rad"], row);
            let error = attitude.angle_to(&UnitQuaternion::new(wanted));
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
    for (name, column) in &csv {
        assert_eq!(table.get(name), Some(column), "{name}");
    }
    let more: Vec<&str> = table
        .keys()
        .map(String::as_str)
        .filter(|name| !csv.contains_key(*name))
        .collect();
    for name in [
        "kinetic_energy_J",
        "potential_energy_J",
        "plate_axis.q.q",
        "plate_axis.v.q",
        "wheels.v.forward",
    ] {
        assert!(more.contains(&name), "{name} is not among {more:?}");
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
        (find("Coordinates ϕ from home", "front", "q"), "front.q.q"),
        (find("Speeds v̄", "front", "q"), "front.v.q"),
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
    for (name, body, [x, y, z, w, i, j, k]) in marks {
        let own = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
        for row in 0..csv["t_s"].len() {
            let read = |ends: [&str; 3], of: &str| {
                Vector3::from(ends.map(|end| csv[&format!("{of}.{end}")][row]))
            };
            let (place, attitude) =
                body.map_or((Vector3::zeros(), UnitQuaternion::identity()), |body| {
                    let (of, com) = (page.names()[body], &page.header["bodies"][body]["com"]);
                    let attitude = UnitQuaternion::new(read(["rx_rad", "ry_rad", "rz_rad"], of));
                    let com = [0, 1, 2].map(|axis| com[axis].as_f64().expect("a number"));
                    (
                        read(["x_m", "y_m", "z_m"], of) - attitude * Vector3::from(com),
                        attitude,
                    )
                });
            let [w, i, j, k] =
                ["qw", "qx", "qy", "qz"].map(|end| csv[&format!("{name}.{end}")][row]);
            let found = Quaternion::new(w, i, j, k);
            // Roundings of an arm of a metre.
            assert!(
                w >= 0.0 && (found.norm() - 1.0).abs() < 1e-15,
                "{name}: {found}"
            );
            let error = UnitQuaternion::new_unchecked(found).angle_to(&(attitude * own));
            assert!(error < 1e-14, "{name} in row {row}: {error:e} rad");
            let error =
                read(["x_m", "y_m", "z_m"], &name) - place - attitude * Vector3::new(x, y, z);
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
            .map(|name| table[*name][row] * table[&name.replace(".tau.", ".v.")][row]);
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
    let tau = &csv["slide_x.tau.q"];
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
    assert!(csv["cardan.tau.first"].iter().all(|force| *force == 0.0));
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
    let text =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/free_body.toml"));
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
    for option in ["--html", "--parquet", "--csv"] {
        let output = Command::new(env!("CARGO_BIN_EXE_hamel"))
            .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
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
